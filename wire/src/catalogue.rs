//! The catalogue of effects: what a believed model of train and track may lack, one entry for each kind. All that needs
//! to know the kinds is generated from it.

/// Hands the catalogue to a macro: `effects_catalogue!(callback arguments..)` expands to
/// `callback! { arguments.. entries.. }`. `effects_catalogue!(named: callback ..)` leaves out the kind whose parameters
/// are a table.
///
/// An entry has the number on the wire and in the store (a number once given stays), the type, the name in files (also
/// that of the modules with its laws), where it acts (`everywhere`, or in a `section` whose ends stand before the
/// parameters; a `table` is brought point by point), a summary, and for each parameter its field (`as` its name in
/// files, where that is no field's name), least and most accepted value, meaning and unit as a display shows them.
///
/// ```
/// macro_rules! names {
///     ($($number:literal $Kind:ident $name:ident $place:ident $summary:literal $parameters:tt)*) => { [$(stringify!($name)),*] };
/// }
/// let names = rundown_wire::effects_catalogue!(names);
/// assert_eq!(names[..2], ["tunnel_drag", "curve_resistance"]);
/// ```
#[macro_export]
macro_rules! effects_catalogue {
    (named: $callback:ident $($argument:tt)*) => {
        $crate::effects_catalogue! { @entries $callback [$($argument)*] [] }
    };
    (@entries $callback:ident [$($argument:tt)*] [$($table:tt)*]) => {
        $callback! { $($argument)*
            1 TunnelDrag tunnel_drag section "More air resistance in a tunnel." {
                k: -1e-3 to 1e-3, "k", "N/kg per (m/s)²";
            }
            2 CurveResistance curve_resistance everywhere "Resistance of curves." {
                coefficient_roeckl: -10.0 to 10.0, "times Roeckl's formula", "";
            }
            3 GradientError gradient_error section "The described gradient is wrong on a section." {
                delta_permille: -50.0 to 50.0, "true minus described", "‰";
            }
            4 SteadyWind steady_wind everywhere "A wind that blows in every run." {
                wind_mps: -40.0 to 40.0, "headwind in the up direction", "m/s";
            }
            5 RunWind run_wind everywhere "A wind that differs from run to run." {
                sd_mps: 0.0 to 20.0, "s.d. between runs", "m/s";
            }
            6 MassError mass_error everywhere "The described mass is wrong." {
                relative: -0.5 to 1.0, "true over described mass, minus 1", "";
            }
            7 DraggingBrake dragging_brake everywhere "A brake that does not release." {
                drag_n_per_kg: 0.0 to 1.0, "drag", "N/kg";
            }
            8 PowerLimitSection power_limit_section section "Less power in a feeding section." {
                factor: 0.01 to 2.0, "share of the power", "";
            }
            9 TractionScale traction_scale everywhere "Another maximum of effort and power everywhere." {
                factor: 0.05 to 3.0, "share of effort and power", "";
            }
            10 LowAdhesion low_adhesion everywhere "Wheels slip at low speed." {
                factor: 0.01 to 1.0, "share of the effort", "";
                below_kmh: 1.0 to 400.0, "below", "km/h";
            }
            11 SpeedScale speed_scale everywhere "The odometer reads too much or too little." {
                measured_over_true: 0.8 to 1.25, "measured over true speed", "";
            }
            12 LocationLag location_lag everywhere "The location comes late." {
                lag_s: -60.0 to 60.0, "age of the location", "s";
            }
            13 TemperatureResistance temperature_resistance everywhere "r0 depends on the ambient temperature." {
                dr0_per_deg_c as "dr0_per_degC": -0.01 to 0.01, "r0", "N/kg per °C";
                ref_c: -60.0 to 80.0, "from", "°C";
            }
            14 SeasonalDrift seasonal_drift everywhere "r0 drifts over the dates of the runs." {
                dr0_over_period: -0.1 to 0.1, "r0 over the period", "N/kg";
                #[serde(default = "a_year")]
                period_days: 0.01 to 1e5, "period", "days";
                #[serde(default)]
                reference_day: -1e6 to 1e6, "from day", "";
            }
            15 BrakeFade brake_fade everywhere "The brake weakens with speed." {
                fade_at_140: 0.0 to 1.0, "share lost at 140 km/h", "";
                from_kmh: 0.0 to 139.0, "from", "km/h";
            }
            16 TrainLengthError train_length_error everywhere "The described length is wrong." {
                true_length_m: 1.0 to 5000.0, "true length", "m";
            }
            17 WarmUp warm_up everywhere "r0 is larger in the first minutes." {
                amplitude: -0.5 to 0.5, "at the departure", "N/kg";
                tau_s: 1.0 to 36000.0, "time constant", "s";
            }
            18 DavisError davis_error everywhere "The described Davis coefficients are wrong." {
                dr0: -0.1 to 0.1, "r0", "N/kg";
                dr1: -0.01 to 0.01, "r1", "N/kg per m/s";
                dr2: -1e-3 to 1e-3, "r2", "N/kg per (m/s)²";
            }
            $($table)*
            20 StartingResistance starting_resistance everywhere "Extra resistance after standing." {
                amplitude: 0.0 to 0.5, "at a start after long standing", "N/kg";
                decay_kmh: 0.5 to 50.0, "37 % left at", "km/h";
                standing_min: 0.01 to 1e4, "63 % of it after standing for", "min";
                #[serde(default)]
                cold_per_deg_c as "cold_per_degC": 0.0 to 0.2, "share more for each degree below 10 °C", "per °C";
            }
        }
    };
    ($callback:ident $($argument:tt)*) => {
        $crate::effects_catalogue! { @entries $callback [$($argument)*] [
            19 Unknown unknown table "None of the named effects: a table over one coordinate." {
                coordinate: 0.0 to 4.0, "over", "coordinate";
                points: 1.0 to 24.0, "points", "";
                least_n_per_kg: -1.0 to 1.0, "least", "N/kg";
                most_n_per_kg: -1.0 to 1.0, "most", "N/kg";
            }
        ] }
    };
}
