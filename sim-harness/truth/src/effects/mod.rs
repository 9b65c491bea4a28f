//! Named effects that the believed description does not have, as they act in the truth.
//!
//! In: an effect, and where, when and how fast the train is. Out: what it adds to the resistance, what it leaves of traction and brake.
//!
//! | acts on | where |
//! |---|---|
//! | resistance | [`resistance`]: extra N/kg against travel |
//! | traction and brake | [`limits`]: caps and what of the demanded brake arrives |
//! | line, train, wind, temperature, readings | [`World`](crate::world::World), which is built with them |
//! | which runs | [`affected`] |
//!
//! Locations are those of the `up` direction, as in the track file. The last six effects are in no catalogue: a workflow that looks for named
//! effects must say that it does not know them.

pub mod affected;
mod check;
pub mod limits;
pub mod resistance;

pub use affected::Affected;
pub use check::EffectError;

use serde::{Deserialize, Serialize};

/// An effect with its parameters. Names and units are those of the model files.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "name", rename_all = "snake_case", deny_unknown_fields)]
#[allow(missing_docs)]
pub enum Effect {
    /// + k v² for the part of the train inside; k in N/(kg (m/s)²) of the described train.
    TunnelDrag { from_m: f64, to_m: f64, k: f64 },
    /// So many times Roeckl's formula of the curves of the line.
    CurveResistance { coefficient_roeckl: f64 },
    /// The true gradient is that much steeper than described, uphill in the `up` direction positive.
    GradientError { from_m: f64, to_m: f64, delta_permille: f64 },
    /// Headwind in the `up` direction in every run.
    SteadyWind { wind_mps: f64 },
    /// Wind along the line that differs from run to run.
    RunWind { sd_mps: f64 },
    /// True over described mass, minus 1.
    MassError { relative: f64 },
    /// Constant extra resistance after the first application of the brake.
    DraggingBrake { drag_n_per_kg: f64, runs: Affected },
    /// Tractive power is capped in a section of the line, in all runs unless said; the front of the train counts.
    PowerLimitSection {
        from_m: f64,
        to_m: f64,
        factor: f64,
        #[serde(default = "all")]
        runs: Affected,
    },
    /// Largest effort and power are others everywhere.
    TractionScale { factor: f64 },
    /// Tractive effort is capped at low speed, on some days.
    LowAdhesion { factor: f64, below_kmh: f64, runs: Affected },
    /// The odometer shows that many times the true speed, to the driver as well.
    SpeedScale { measured_over_true: f64 },
    /// The location is late.
    LocationLag { lag_s: f64 },
    /// r0 depends on the ambient temperature.
    TemperatureResistance {
        #[serde(rename = "dr0_per_degC")]
        dr0_per_deg_c: f64,
        ref_c: f64,
    },
    /// r0 changes linearly from 0 at the first run to this at the last.
    SeasonalDrift { dr0_over_period: f64 },
    /// Share of the brake that is missing at 140 km/h, growing linearly from `from_kmh` on.
    BrakeFade { fade_at_140: f64, from_kmh: f64 },
    /// The train has another length than described.
    TrainLengthError { true_length_m: f64 },
    /// amplitude exp(-t/tau) since the departure, N/kg.
    WarmUp { amplitude: f64, tau_s: f64 },
    /// The described Davis parameters are wrong by these.
    DavisError { dr0: f64, dr1: f64, dr2: f64 },

    /// Not in the catalogue: a v³ term, k in N/(kg (m/s)³).
    CubicDrag { k: f64 },
    /// Not in the catalogue: more resistance around a speed (bogies that hunt), a raised cosine of this half-width.
    SpeedBump { at_kmh: f64, half_width_kmh: f64, drag_n_per_kg: f64 },
    /// Not in the catalogue: bad track, a raised cosine between two locations, the same in both directions and at every speed.
    LocationBump { from_m: f64, to_m: f64, drag_n_per_kg: f64 },
    /// Not in the catalogue: amplitude sin(2π t / period) since the departure, N/kg.
    PeriodicDrag { amplitude: f64, period_s: f64 },
    /// Not in the catalogue: more resistance below a temperature (stiff grease), full 2 °C below it.
    Frost { below_c: f64, drag_n_per_kg: f64 },
    /// Not in the catalogue: more resistance from a day on (a worn bearing); `from_share` of the period of the runs.
    DayStep { from_share: f64, drag_n_per_kg: f64 },
}

fn all() -> Affected {
    Affected::Share(1.0)
}

impl Effect {
    /// Its name in files.
    pub fn name(&self) -> &'static str {
        match self {
            Self::TunnelDrag { .. } => "tunnel_drag",
            Self::CurveResistance { .. } => "curve_resistance",
            Self::GradientError { .. } => "gradient_error",
            Self::SteadyWind { .. } => "steady_wind",
            Self::RunWind { .. } => "run_wind",
            Self::MassError { .. } => "mass_error",
            Self::DraggingBrake { .. } => "dragging_brake",
            Self::PowerLimitSection { .. } => "power_limit_section",
            Self::TractionScale { .. } => "traction_scale",
            Self::LowAdhesion { .. } => "low_adhesion",
            Self::SpeedScale { .. } => "speed_scale",
            Self::LocationLag { .. } => "location_lag",
            Self::TemperatureResistance { .. } => "temperature_resistance",
            Self::SeasonalDrift { .. } => "seasonal_drift",
            Self::BrakeFade { .. } => "brake_fade",
            Self::TrainLengthError { .. } => "train_length_error",
            Self::WarmUp { .. } => "warm_up",
            Self::DavisError { .. } => "davis_error",
            Self::CubicDrag { .. } => "cubic_drag",
            Self::SpeedBump { .. } => "speed_bump",
            Self::LocationBump { .. } => "location_bump",
            Self::PeriodicDrag { .. } => "periodic_drag",
            Self::Frost { .. } => "frost",
            Self::DayStep { .. } => "day_step",
        }
    }

    /// For an effect that is in no catalogue: the coordinate it depends on.
    pub fn unknown_coordinate(&self) -> Option<&'static str> {
        match self {
            Self::CubicDrag { .. } | Self::SpeedBump { .. } => Some("speed"),
            Self::LocationBump { .. } => Some("location"),
            Self::PeriodicDrag { .. } => Some("time"),
            Self::Frost { .. } => Some("temperature"),
            Self::DayStep { .. } => Some("day"),
            _ => None,
        }
    }

    /// The same effect for a train that travels the line of this length from its end: sections in metres from there.
    pub fn mirrored(mut self, length_m: f64) -> Self {
        match &mut self {
            Self::TunnelDrag { from_m, to_m, .. }
            | Self::PowerLimitSection { from_m, to_m, .. }
            | Self::LocationBump { from_m, to_m, .. } => {
                (*from_m, *to_m) = (length_m - *to_m, length_m - *from_m);
            }
            // The line itself carries the others, and is reversed as a whole.
            _ => {}
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_is_the_one_in_files() {
        let effect = Effect::TemperatureResistance { dr0_per_deg_c: -1e-4, ref_c: 10.0 };
        let text = toml::to_string(&effect).unwrap();
        assert_eq!(text, "name = \"temperature_resistance\"\ndr0_per_degC = -0.0001\nref_c = 10.0\n");
        assert_eq!(toml::from_str::<Effect>(&text).unwrap(), effect);
    }

    #[test]
    fn a_section_seen_from_the_other_end() {
        let bump = Effect::LocationBump { from_m: 100.0, to_m: 300.0, drag_n_per_kg: 0.01 };
        let mirrored = Effect::LocationBump { from_m: 700.0, to_m: 900.0, drag_n_per_kg: 0.01 };
        assert_eq!(bump.clone().mirrored(1000.0), mirrored);
        assert_eq!(mirrored.mirrored(1000.0), bump);
    }
}
