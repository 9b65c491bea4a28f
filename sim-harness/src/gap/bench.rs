//! Hidden effects: the workflow on sets whose answer is known, blind.
//!
//! Scenarios are drawn by seed over effect, size, data and sensors. The workflow gets runs, the believed train and the believed track; the key stays here.

use crate::simulation;
use crate::simulation::believed::{corridor, train_file};
use crate::simulation::folder::FolderError;
use crate::simulation::scenario_file::{Simulation, TrainTable};
use crate::truth::effects::{Affected, Effect};
use crate::truth::habits::DriverKind;
use crate::truth::line::Line as TrueLine;
use crate::truth::plan::Headings;
use crate::truth::scenario::Scenario;
use crate::truth::sensors::LocationWalk;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::path::Path;

/// How large the hidden effect is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// Nobody would miss it.
    Clear,
    /// In between.
    Medium,
    /// At the limit.
    Faint,
}

impl Size {
    /// All.
    pub const ALL: [Self; 3] = [Self::Clear, Self::Medium, Self::Faint];

    fn of(self, values: [f64; 3]) -> f64 {
        values[self as usize]
    }
}

/// One set.
#[derive(Clone, Debug)]
pub struct Set {
    /// What is hidden.
    pub hidden: Vec<Effect>,
    /// How large.
    pub size: Size,
    /// With an effort column.
    pub effort: bool,
    /// Dirty sensors.
    pub dirty: bool,
    /// All that is simulated.
    pub scenario: Scenario,
    /// How many runs.
    pub runs: usize,
    /// Seed.
    pub seed: u64,
}

/// Kinds of effects, by number.
pub const KINDS: [&str; 24] = [
    "none",
    "tunnel_drag",
    "curve_resistance",
    "gradient_error",
    "steady_wind",
    "run_wind",
    "mass_error",
    "dragging_brake",
    "power_limit_section",
    "traction_scale",
    "low_adhesion",
    "speed_scale",
    "location_lag",
    "temperature_resistance",
    "seasonal_drift",
    "brake_fade",
    "train_length_error",
    "warm_up",
    "davis_error",
    "cubic_drag",
    "speed_bump",
    "location_bump",
    "frost",
    "day_step",
];

impl Set {
    /// Draws a set.
    pub fn draw(kind: &str, size: Size, effort: bool, dirty: bool, seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0xA5A5);
        let mut scenario = Scenario::default();
        let hilly = rng.random_bool(0.5);
        if hilly {
            scenario.line = TrueLine::hilly(seed);
        }
        if rng.random_bool(0.3) {
            scenario.driver = DriverKind::ShortHop;
        }
        scenario.sensors.effort_momentary = rng.random_bool(0.5);
        if rng.random_bool(0.5) {
            scenario.headings = Headings::Both;
        }
        if rng.random_bool(0.25) {
            scenario.sensors.sampling_s = 1.0;
        }
        let curves: Vec<crate::truth::line::Curve> = (0..12)
            .map(|_| {
                let from_m = rng.random_range(1_000.0..30_000.0);
                crate::truth::line::Curve {
                    from_m,
                    to_m: from_m + rng.random_range(300.0..900.0),
                    radius_m: rng.random_range(400.0..1_500.0),
                }
            })
            .collect();
        let mut sorted = curves;
        sorted.sort_by(|a, b| a.from_m.total_cmp(&b.from_m));
        sorted.dedup_by(|b, a| b.from_m < a.to_m);
        scenario.line.set_curves(sorted);
        if dirty {
            scenario.sensors.location_noise_m = 2.0;
            scenario.sensors.location_walk = Some(LocationWalk::of(6.0));
            scenario.sensors.dropout_probability = 0.03;
            scenario.sensors.location_lag_s = 0.7;
            scenario.load_sd = 0.02;
        }
        let from_m: f64 = rng.random_range(16_000.0..26_000.0);
        let to_m = from_m + rng.random_range(1_500.0..4_000.0);
        let sign = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
        let davis = |s: f64, rng: &mut ChaCha8Rng| {
            let one = |b: f64, rng: &mut ChaCha8Rng| b * s * rng.random_range(0.6..1.4);
            (one(7.38e-3, rng), one(1.6e-4, rng), one(2.8e-5, rng))
        };
        let hidden = match kind {
            "none" => vec![],
            "tunnel_drag" => vec![Effect::TunnelDrag {
                from_m,
                to_m,
                k: size.of([1e-5, 5e-6, 2.5e-6]),
            }],
            "curve_resistance" => vec![Effect::CurveResistance {
                coefficient_roeckl: size.of([1.0, 0.6, 0.3]),
            }],
            "gradient_error" => vec![Effect::GradientError {
                from_m,
                to_m,
                delta_permille: sign * size.of([2.0, 1.0, 0.5]),
            }],
            "steady_wind" => vec![Effect::SteadyWind {
                wind_mps: sign * size.of([5.0, 2.5, 1.2]),
            }],
            "run_wind" => vec![Effect::RunWind {
                sd_mps: size.of([4.0, 2.5, 1.2]),
            }],
            "mass_error" => vec![Effect::MassError {
                relative: sign * size.of([0.10, 0.05, 0.025]),
            }],
            "dragging_brake" => vec![Effect::DraggingBrake {
                drag_n_per_kg: size.of([0.01, 0.006, 0.003]),
                runs: Affected::Share(0.25),
            }],
            "power_limit_section" => vec![Effect::PowerLimitSection {
                from_m: rng.random_range(1_500.0..3_000.0),
                to_m: rng.random_range(6_000.0..12_000.0),
                factor: size.of([0.5, 0.65, 0.8]),
                runs: Affected::Share(1.0),
            }],
            "traction_scale" => vec![Effect::TractionScale {
                factor: size.of([0.75, 0.85, 0.92]),
            }],
            "low_adhesion" => vec![Effect::LowAdhesion {
                factor: size.of([0.4, 0.5, 0.65]),
                below_kmh: 45.0,
                runs: Affected::Share(0.25),
            }],
            "speed_scale" => vec![Effect::SpeedScale {
                measured_over_true: 1.0 + sign * size.of([0.03, 0.015, 0.007]),
            }],
            "location_lag" => vec![Effect::LocationLag {
                lag_s: size.of([5.0, 3.0, 2.0]),
            }],
            "temperature_resistance" => vec![Effect::TemperatureResistance {
                dr0_per_deg_c: -size.of([3e-4, 1.5e-4, 7e-5]),
                ref_c: 10.0,
            }],
            "seasonal_drift" => vec![Effect::SeasonalDrift {
                dr0_over_period: sign * size.of([3e-3, 1.5e-3, 8e-4]),
            }],
            "brake_fade" => vec![Effect::BrakeFade {
                fade_at_140: size.of([0.45, 0.3, 0.15]),
                from_kmh: 60.0,
            }],
            "train_length_error" => vec![Effect::TrainLengthError {
                true_length_m: size.of([81.0, 108.0, 130.0]),
            }],
            "warm_up" => vec![Effect::WarmUp {
                amplitude: size.of([6e-3, 3e-3, 1.5e-3]),
                tau_s: 300.0,
            }],
            "davis_error" => {
                let (dr0, dr1, dr2) = davis(sign * size.of([0.2, 0.1, 0.05]), &mut rng);
                vec![Effect::DavisError { dr0, dr1, dr2 }]
            }
            "cubic_drag" => vec![Effect::CubicDrag {
                k: size.of([3e-7, 1.5e-7, 7e-8]),
            }],
            "speed_bump" => vec![Effect::SpeedBump {
                at_kmh: 100.0,
                half_width_kmh: 20.0,
                drag_n_per_kg: size.of([0.012, 0.006, 0.003]),
            }],
            "location_bump" => {
                scenario.headings = Headings::Both;
                vec![Effect::LocationBump {
                    from_m,
                    to_m,
                    drag_n_per_kg: size.of([0.02, 0.01, 0.005]),
                }]
            }
            "frost" => vec![Effect::Frost {
                below_c: 3.0,
                drag_n_per_kg: size.of([5e-3, 2.5e-3, 1.2e-3]),
            }],
            _ => vec![Effect::DayStep {
                from_share: 0.6,
                drag_n_per_kg: size.of([4e-3, 2e-3, 1e-3]),
            }],
        };
        scenario.effects = hidden.clone();
        Self {
            hidden,
            size,
            effort,
            dirty,
            scenario,
            runs: 67,
            seed,
        }
    }

    /// Writes the set as `rundown simulate` does.
    ///
    /// # Errors
    /// [`FolderError`] names the file or the run.
    pub fn write(&self, folder: &Path) -> Result<(), FolderError> {
        let simulation = Simulation {
            name: format!("set {}", self.seed),
            track: corridor(&self.scenario.line, "line".to_owned()),
            train: train_file(&TrainTable::default()),
            scenario: self.scenario.clone(),
            runs: self.runs,
            seed: self.seed,
            unit: "1".to_owned(),
            effort_column: self.effort,
            temperature_column: true,
            text: String::new(),
        };
        simulation::folder::write(&simulation, folder, true, || ()).map(drop)
    }

    /// The names that the key has, unknown things as `unknown`.
    pub fn key(&self) -> Vec<&'static str> {
        self.hidden
            .iter()
            .map(|e| {
                if e.unknown_coordinate().is_some() {
                    "unknown"
                } else {
                    e.name()
                }
            })
            .collect()
    }
}
