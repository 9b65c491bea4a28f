//! Draws a set by seed: train, line, drivers, sensors, and what is hidden.

use crate::gap_bench::nuisance::{DrawnNuisance, Nuisance};
use crate::simulation;
use crate::simulation::believed::{TRAIN_NAME, corridor, train_file};
use crate::simulation::folder::FolderError;
use crate::simulation::scenario_file::Simulation;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rundown::model::{effects::EffectKind, resistance::Davis};
pub use rundown_gap::HiddenSize as Size;
use rundown_gap::{Hide, candidates};
use rundown_truth::line::{Curve, Line as TrueLine};
use rundown_truth::train::{DavisTruth, TrainTruth};
use rundown_truth::{
    effects::Effect,
    habits::DriverKind,
    plan::Headings,
    scenario::{Scenario, UnscheduledStop},
    sensors::LocationWalk,
};
use serde::Serialize;
use std::path::Path;

/// All sizes.
pub const SIZES: [Size; 3] = [Size::Clear, Size::Medium, Size::Faint];

/// Names of hidden effects: those of the catalogue, then those that are in none.
pub fn kinds() -> impl Iterator<Item = &'static str> {
    EffectKind::ALL.into_iter().flat_map(|kind| candidates::of(kind).hidden_names())
}

/// What a set is to be; the seed draws the rest.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SetRequest {
    /// Of [`kinds`]: none, one or several.
    pub kinds: Vec<&'static str>,
    /// How large.
    pub size: Size,
    /// With an effort column.
    pub effort: bool,
    /// Correlated location noise, dropouts, a late location, small load changes.
    pub dirty: bool,
    /// Drivers of all kinds, signals, a little wind, and momentary efforts of sensors that differ from run to run.
    pub rough: bool,
    /// Who drives, whatever the seed draws.
    pub driver: Option<DriverKind>,
    /// What else is wrong with the recorder or the description, and no effect.
    pub nuisance: Option<Nuisance>,
    /// How many runs.
    pub runs: usize,
    /// Seed.
    pub seed: u64,
}

/// One set, with its key.
#[derive(Clone, Debug)]
pub struct Set {
    /// What it was to be.
    pub request: SetRequest,
    /// All that is simulated, what is hidden included.
    pub scenario: Scenario,
    /// The nuisance with its size.
    pub drawn: Option<DrawnNuisance>,
}

impl Set {
    /// Draws a set.
    ///
    /// # Errors
    /// Names a kind that cannot be hidden.
    pub fn draw(request: SetRequest) -> Result<Self, String> {
        let mut rng = ChaCha8Rng::seed_from_u64(request.seed ^ 0xA5A5);
        let mut scenario = Scenario::default();
        if rng.random_bool(0.6) {
            scenario.train = train(&mut rng);
        }
        if rng.random_bool(0.5) {
            scenario.line = TrueLine::hilly(request.seed);
        }
        scenario.line.set_curves(curves(&mut rng));
        if rng.random_bool(0.3) {
            scenario.driver = DriverKind::ShortHop;
        }
        let bump = request.kinds.contains(&"location_bump");
        // Seen in one direction, bad track is a wrong gradient.
        if rng.random_bool(0.5) || bump {
            scenario.headings = Headings::Both;
        }
        if rng.random_bool(0.25) {
            scenario.sensors.sampling_s = 1.0;
        }
        scenario.sensors.effort_momentary = rng.random_bool(0.5);
        if request.dirty {
            scenario.sensors.location_noise_m = 2.0;
            scenario.sensors.location_walk = Some(LocationWalk::of(6.0));
            scenario.sensors.dropout_probability = 0.03;
            scenario.sensors.location_lag_s = 0.7;
            scenario.load_sd = 0.02;
        }
        if request.rough {
            rough(request.seed, &mut scenario);
        }
        scenario.driver = request.driver.unwrap_or(scenario.driver);
        let one = |kind: &&str| effect(kind, request.size, &scenario.train, &mut rng);
        scenario.effects = request.kinds.iter().map(one).collect::<Result<_, String>>()?;
        let drawn = request.nuisance.map(|nuisance| nuisance.draw(request.seed, &mut scenario));
        Ok(Self { request, scenario, drawn })
    }

    /// Writes the set as `rundown simulate` does: the key is in its folder `truth`.
    ///
    /// # Errors
    /// [`FolderError`] names the file or the run.
    pub fn write(&self, folder: &Path) -> Result<(), FolderError> {
        let mut track = corridor(&self.scenario.line, "line".to_owned());
        if let Some(drawn) = &self.drawn {
            drawn.described(&mut track);
        }
        let simulation = Simulation {
            name: format!("set {}", self.request.seed),
            track,
            train: train_file(TRAIN_NAME, &self.scenario.train),
            scenario: self.scenario.clone(),
            runs: self.request.runs,
            seed: self.request.seed,
            unit: "1".to_owned(),
            effort_column: self.request.effort,
            temperature_column: true,
            text: String::new(),
            file: None,
        };
        simulation::folder::write(&simulation, folder, true, || ()).map(drop)
    }
}

/// What a service has that the case study has not, and no effect. From a stream of its own: the rest of the set stays
/// what it is.
fn rough(seed: u64, scenario: &mut Scenario) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0x40_06);
    scenario.driver =
        [DriverKind::CaseStudy, DriverKind::ShortHop, DriverKind::HopAndCoast][rng.random_range(0..3_usize)];
    scenario.cycle_share = rng.random_range(0.2..0.9);
    scenario.brake_test_share = rng.random_range(0.0..0.5);
    let at_m = rng.random_range(3_000.0..25_000.0);
    scenario.unscheduled_stop =
        Some(UnscheduledStop { at_m, dwell_s: rng.random_range(20.0..120.0), share: rng.random_range(0.1..0.3) });
    scenario.wind_sd_mps = rng.random_range(0.2..0.8);
    scenario.load_sd = rng.random_range(0.005..0.02);
    let sensors = &mut scenario.sensors;
    sensors.speed_noise_kmh = rng.random_range(0.1..0.3);
    sensors.effort_momentary = rng.random_bool(0.8);
    sensors.effort_gain_sd = rng.random_range(0.004..0.015);
    sensors.effort_noise_n_per_kg = rng.random_range(0.002..0.005);
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

/// The hidden effect of a name of [`kinds`].
///
/// # Errors
/// There is none of this name, or the simulator does not know it.
fn effect(name: &str, size: Size, train: &TrainTruth, rng: &mut ChaCha8Rng) -> Result<Effect, String> {
    let from_m: f64 = rng.random_range(16_000.0..26_000.0);
    let to_m = from_m + rng.random_range(1_500.0..4_000.0);
    let sign = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
    let DavisTruth { r0, r1, r2 } = train.davis;
    let davis = Davis { r0, r1, r2 };
    let mut hide = Hide { size, section_m: [from_m, to_m], sign, davis, length_m: train.length_m, rng };
    let mut of = EffectKind::ALL.into_iter().map(|kind| candidates::of(kind));
    let candidate = of.find(|candidate| candidate.hidden_names().contains(&name));
    let hidden = candidate.and_then(|candidate| candidate.hidden(name, &mut hide));
    let mut hidden = hidden.ok_or_else(|| format!("{name}: no candidate hides it"))?;
    hidden["name"] = name.into();
    serde_json::from_value(hidden).map_err(|error| format!("{name}: {error}"))
}
