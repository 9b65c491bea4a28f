//! Runs that ask more of the board than the reference run: every kind of model at once, and a day.

use crate::accuracy::{description, measurements};
use crate::coasting::with_targets;
use crate::prelude::*;
use crate::target::{Same, compare};
use emulator::Settings;
use rundown::model::effects::*;
use rundown_truth::line::Line;
use std::error::Error;

/// The description of a board, and its readings.
pub struct Play {
    /// For messages.
    pub name: &'static str,
    /// Of train and track.
    pub description: Description,
    /// The readings of each run.
    pub runs: Vec<Vec<Measurement>>,
}

/// A run of the case study with seven effects in the model, curves, limits and a stop.
pub fn seven_effects() -> Play {
    with_effects("seven_effects", Mode::Gated, [], 1)
}

/// Three such runs in the `measured` mode, with as many effects as a model has.
pub fn measured() -> Play {
    let starting = StartingResistance { amplitude: 0.04, decay_kmh: 3.6, standing_min: 10.0, cold_per_deg_c: 0.02 };
    with_effects("measured", Mode::Measured, [Effect::StartingResistance(starting)], 3)
}

fn with_effects<const N: usize>(name: &'static str, mode: Mode, more: [Effect; N], runs: u64) -> Play {
    let scenario = Scenario::default();
    let curve = |from_m| Curve { from_m, to_m: from_m + 300.0, radius_m: 600.0 };
    let effects = [
        Effect::TunnelDrag(TunnelDrag { from_m: 8e3, to_m: 14e3, k: 1e-5 }),
        Effect::CurveResistance(CurveResistance { coefficient_roeckl: 0.8 }),
        Effect::SteadyWind(SteadyWind { wind_mps: 2.0 }),
        Effect::MassError(MassError { relative: 0.1 }),
        Effect::WarmUp(WarmUp { amplitude: 3e-3, tau_s: 300.0 }),
        Effect::SpeedScale(SpeedScale { measured_over_true: 1.01 }),
        Effect::Unknown(Unknown {
            coordinate: Coordinate::Speed,
            table: [(10.0, 0.0), (38.0, 1e-3)].into_iter().collect(),
        }),
    ];
    let description = Description {
        curves: (0..20).map(|i| curve(1000.0 * f64::from(i))).collect(),
        effects: Effects::try_new(effects.into_iter().chain(more)).expect("eight act at most"),
        ..with_targets(Config { mode, ..Config::default() }, &scenario)
    };
    Play { name, description, runs: (3..3 + runs).map(|seed| measurements(&simulate(&scenario, seed))).collect() }
}

/// Between two hops of the day, s.
const STANDING_S: f64 = 300.0;
const DAY_S: f64 = 86_400.0;
const HOP_M: f64 = 32e3;

/// A day of hops over 32 km each, one behind the other on a long level line, in one run of the board.
pub fn day() -> Play {
    let line = Line::new(HOP_M, vec![(0.0, 0.0)], vec![(0.0, 140.0)]);
    let scenario = Scenario { line, ..Scenario::default() };
    let mut log: Vec<Measurement> = Vec::new();
    let mut hops = 0_u32;
    while log.last().is_none_or(|row| row.time_s < DAY_S) {
        let begin_s = log.last().map_or(0.0, |row| row.time_s + 10.0);
        let begin_m = HOP_M * f64::from(hops);
        let hop = measurements(&simulate(&scenario, u64::from(hops) + 1));
        log.extend(hop.into_iter().map(|row| Measurement {
            time_s: begin_s + row.time_s,
            location_m: row.location_m.map(|at_m| begin_m + at_m),
            ..row
        }));
        hops += 1;
        let last = log.last().copied();
        let standing = (1..).map(|step| 10.0 * f64::from(step)).take_while(|after_s| *after_s < STANDING_S);
        log.extend(last.into_iter().flat_map(|last| {
            standing.clone().map(move |after_s| Measurement {
                time_s: last.time_s + after_s,
                speed_mps: Some(0.0),
                ..last
            })
        }));
    }
    log.retain(|row| row.time_s < DAY_S);
    let stops = (1..=hops).map(|hop| Target { at_m: HOP_M * f64::from(hop), limit_mps: None });
    let description = Description {
        track_length_m: HOP_M * f64::from(hops),
        targets: stops.collect(),
        ..description(Config::default(), &scenario)
    };
    Play { name: "day", description, runs: vec![log] }
}

impl Play {
    /// All of it, through the firmware in the emulator and the task on the host.
    ///
    /// # Errors
    /// As [`compare`].
    pub fn compare(&self, settings: &Settings) -> Result<Same, Box<dyn Error>> {
        let runs: Vec<&[Measurement]> = self.runs.iter().map(Vec::as_slice).collect();
        compare(settings, &self.description, Direction::Up, &runs)
    }
}
