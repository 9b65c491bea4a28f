//! Draws a set by seed: train, line, drivers, sensors, and what is hidden.

use crate::simulation;
use crate::simulation::believed::{corridor, train_file};
use crate::simulation::folder::FolderError;
use crate::simulation::scenario_file::{Simulation, TrainTable};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rundown_truth::effects::*;
use rundown_truth::habits::DriverKind;
use rundown_truth::line::{Curve, Line as TrueLine};
use rundown_truth::plan::Headings;
use rundown_truth::scenario::Scenario;
use rundown_truth::sensors::LocationWalk;
use rundown_truth::train::{DavisTruth, TrainTruth};
use serde::Serialize;
use std::path::Path;

/// How large the hidden effect is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case")]
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

/// Kinds of hidden effects: those of the catalogue, then those of none.
pub const KINDS: [&str; 24] = [
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
    "periodic_drag",
    "frost",
    "day_step",
];

/// What is asked of a set; the seed draws the rest.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ask {
    /// Of [`KINDS`]: none, one or several.
    pub kinds: Vec<&'static str>,
    /// How large.
    pub size: Size,
    /// With an effort column.
    pub effort: bool,
    /// Correlated location noise, dropouts, a late location, small load changes.
    pub dirty: bool,
    /// How many runs.
    pub runs: usize,
    /// Seed.
    pub seed: u64,
}

/// One set, with its key.
#[derive(Clone, Debug)]
pub struct Set {
    /// What was asked.
    pub ask: Ask,
    /// All that is simulated, what is hidden included.
    pub scenario: Scenario,
}

impl Set {
    /// Draws a set.
    pub fn draw(ask: Ask) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(ask.seed ^ 0xA5A5);
        let mut scenario = Scenario::default();
        if rng.random_bool(0.6) {
            scenario.train = train(&mut rng);
        }
        if rng.random_bool(0.5) {
            scenario.line = TrueLine::hilly(ask.seed);
        }
        scenario.line.set_curves(curves(&mut rng));
        if rng.random_bool(0.3) {
            scenario.driver = DriverKind::ShortHop;
        }
        let bump = ask.kinds.contains(&"location_bump");
        // Seen in one direction, bad track is a wrong gradient.
        if rng.random_bool(0.5) || bump {
            scenario.headings = Headings::Both;
        }
        if rng.random_bool(0.25) {
            scenario.sensors.sampling_s = 1.0;
        }
        scenario.sensors.effort_momentary = rng.random_bool(0.5);
        if ask.dirty {
            scenario.sensors.location_noise_m = 2.0;
            scenario.sensors.location_walk = Some(LocationWalk::of(6.0));
            scenario.sensors.dropout_probability = 0.03;
            scenario.sensors.location_lag_s = 0.7;
            scenario.load_sd = 0.02;
        }
        let one = |kind: &&str| effect(kind, ask.size, &scenario.train, &mut rng);
        scenario.effects = ask.kinds.iter().map(one).collect();
        Self { ask, scenario }
    }

    /// Writes the set as `rundown simulate` does: the key is in its folder `truth`.
    ///
    /// # Errors
    /// [`FolderError`] names the file or the run.
    pub fn write(&self, folder: &Path) -> Result<(), FolderError> {
        let simulation = Simulation {
            name: format!("set {}", self.ask.seed),
            track: corridor(&self.scenario.line, "line".to_owned()),
            train: train_file(&TrainTable::of(&self.scenario.train)),
            scenario: self.scenario.clone(),
            runs: self.ask.runs,
            seed: self.ask.seed,
            unit: "1".to_owned(),
            effort_column: self.ask.effort,
            temperature_column: true,
            text: String::new(),
        };
        simulation::folder::write(&simulation, folder, true, || ()).map(drop)
    }
}

/// A train between a short regional unit and a long train behind a locomotive.
fn train(rng: &mut ChaCha8Rng) -> TrainTruth {
    let length_m = rng.random_range(60.0..280.0);
    let mass_kg = length_m * rng.random_range(1_700.0..2_400.0);
    TrainTruth {
        mass_kg,
        gamma: rng.random_range(1.04..1.10),
        length_m,
        davis: DavisTruth {
            r0: rng.random_range(5e-3..1.1e-2),
            r1: rng.random_range(8e-5..2.5e-4),
            // The head counts more on a short train.
            r2: rng.random_range(1.6e-5..2.4e-5) * (1.0 + 70.0 / length_m),
        },
        max_tractive_effort_n: mass_kg * rng.random_range(0.45..0.9),
        max_power_w: mass_kg * rng.random_range(5.5..10.0),
        max_brake_mps2: rng.random_range(0.6..0.9),
    }
}

fn curves(rng: &mut ChaCha8Rng) -> Vec<Curve> {
    let mut curves: Vec<Curve> = (0..12)
        .map(|_| {
            let from_m = rng.random_range(1_000.0..30_000.0);
            Curve { from_m, to_m: from_m + rng.random_range(300.0..900.0), radius_m: rng.random_range(400.0..1_500.0) }
        })
        .collect();
    curves.sort_by(|a, b| a.from_m.total_cmp(&b.from_m));
    curves.dedup_by(|b, a| b.from_m < a.to_m);
    curves
}

/// The hidden effect of a kind.
fn effect(kind: &str, size: Size, train: &TrainTruth, rng: &mut ChaCha8Rng) -> Effect {
    let from_m: f64 = rng.random_range(16_000.0..26_000.0);
    let to_m = from_m + rng.random_range(1_500.0..4_000.0);
    let sign = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
    match kind {
        "tunnel_drag" => {
            Effect::TunnelDrag(TunnelDrag { from_m, to_m, k: train.davis.r2 * size.of([0.36, 0.18, 0.09]) })
        }
        "curve_resistance" => Effect::CurveResistance(CurveResistance { coefficient_roeckl: size.of([1.0, 0.6, 0.3]) }),
        "gradient_error" => {
            Effect::GradientError(GradientError { from_m, to_m, delta_permille: sign * size.of([2.0, 1.0, 0.5]) })
        }
        "steady_wind" => Effect::SteadyWind(SteadyWind { wind_mps: sign * size.of([5.0, 2.5, 1.2]) }),
        "run_wind" => Effect::RunWind(RunWind { sd_mps: size.of([4.0, 2.5, 1.2]) }),
        "mass_error" => Effect::MassError(MassError { relative: sign * size.of([0.10, 0.05, 0.025]) }),
        "dragging_brake" => Effect::DraggingBrake(DraggingBrake {
            drag_n_per_kg: size.of([0.01, 0.006, 0.003]),
            runs: Affected::Share(0.25),
        }),
        "power_limit_section" => Effect::PowerLimitSection(PowerLimitSection {
            from_m: rng.random_range(1_500.0..3_000.0),
            to_m: rng.random_range(6_000.0..12_000.0),
            factor: size.of([0.5, 0.65, 0.8]),
            runs: Affected::Share(1.0),
        }),
        "traction_scale" => Effect::TractionScale(TractionScale { factor: size.of([0.75, 0.85, 0.92]) }),
        "low_adhesion" => Effect::LowAdhesion(LowAdhesion {
            factor: size.of([0.4, 0.5, 0.65]),
            below_kmh: rng.random_range(35.0..60.0),
            runs: Affected::Share(0.25),
        }),
        "speed_scale" => {
            Effect::SpeedScale(SpeedScale { measured_over_true: 1.0 + sign * size.of([0.03, 0.015, 0.007]) })
        }
        "location_lag" => Effect::LocationLag(LocationLag { lag_s: size.of([5.0, 3.0, 2.0]) }),
        "temperature_resistance" => Effect::TemperatureResistance(TemperatureResistance {
            dr0_per_deg_c: -size.of([3e-4, 1.5e-4, 7e-5]),
            ref_c: 10.0,
        }),
        "seasonal_drift" => {
            Effect::SeasonalDrift(SeasonalDrift { dr0_over_period: sign * size.of([3e-3, 1.5e-3, 8e-4]) })
        }
        "brake_fade" => Effect::BrakeFade(BrakeFade {
            fade_at_140: size.of([0.45, 0.3, 0.15]),
            from_kmh: rng.random_range(40.0..80.0),
        }),
        "train_length_error" => {
            Effect::TrainLengthError(TrainLengthError { true_length_m: train.length_m * size.of([0.5, 0.67, 0.8]) })
        }
        "warm_up" => {
            Effect::WarmUp(WarmUp { amplitude: size.of([6e-3, 3e-3, 1.5e-3]), tau_s: rng.random_range(150.0..600.0) })
        }
        "davis_error" => {
            let share = sign * size.of([0.2, 0.1, 0.05]);
            let mut part = |of: f64| of * share * rng.random_range(0.6..1.4);
            Effect::DavisError(DavisError {
                dr0: part(train.davis.r0),
                dr1: part(train.davis.r1),
                dr2: part(train.davis.r2),
            })
        }
        "cubic_drag" => Effect::CubicDrag(CubicDrag { k: size.of([3e-7, 1.5e-7, 7e-8]) }),
        "speed_bump" => Effect::SpeedBump(SpeedBump {
            at_kmh: rng.random_range(65.0..100.0),
            half_width_kmh: rng.random_range(10.0..25.0),
            drag_n_per_kg: size.of([0.012, 0.006, 0.003]),
        }),
        "location_bump" => {
            Effect::LocationBump(LocationBump { from_m, to_m, drag_n_per_kg: size.of([0.02, 0.01, 0.005]) })
        }
        "periodic_drag" => Effect::PeriodicDrag(PeriodicDrag {
            amplitude: size.of([0.01, 0.005, 0.0025]),
            period_s: rng.random_range(300.0..900.0),
        }),
        "frost" => {
            Effect::Frost(Frost { below_c: rng.random_range(2.0..5.0), drag_n_per_kg: size.of([5e-3, 2.5e-3, 1.2e-3]) })
        }
        _ => Effect::DayStep(DayStep {
            from_share: rng.random_range(0.3..0.7),
            drag_n_per_kg: size.of([4e-3, 2e-3, 1e-3]),
        }),
    }
}
