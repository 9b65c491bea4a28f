//! Perturbed runs of known truth: how many are recognised, and how many calm ones are accused.
//!
//! ```text
//! line, seed -> runs, a seventh of them disturbed -> what each disturbance cost -> comparison of the runs -> found? where? clean ones accused?
//! ```
//!
//! Each disturbed run is driven a second time without its disturbance: the difference of the arrivals is what it lost.

use crate::accuracy_bench::fleets::{self, Fleet};
use crate::study::case::Case;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use rundown_check::check;
use rundown_files::recording::Recording;
use rundown_truth::plan::{RunPlan, plan};
use rundown_truth::scenario::{DriveError, Scenario, UnscheduledStop, simulate_planned};
use serde::Serialize;

/// Runs of a set.
const RUNS: usize = 40;
/// Share of them that is disturbed.
const DISTURBED: f64 = 1.0 / 7.0;
/// A run that lost less was disturbed in name only, s.
const FELT_S: f64 = 20.0;
/// A place counts as found within this, m.
const NEAR_M: f64 = 1_000.0;
/// Lines and drivers, by the names of the accuracy bench.
const FLEETS: [&str; 6] = ["wind", "hills", "on-off", "suburban", "metro", "tram"];

/// What holds a run up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Disturbance {
    RedSignal,
    Restriction,
    Caution,
    Creeping,
}

impl Disturbance {
    const ALL: [Self; 4] = [Self::RedSignal, Self::Restriction, Self::Caution, Self::Creeping];

    fn words(self) -> &'static str {
        match self {
            Self::RedSignal => "a stop of 20 to 240 s at a red signal",
            Self::Restriction => "30 to 60 % of the top speed over 0.5 to 3 km",
            Self::Caution => "30 to 50 % of it over 200 to 400 m",
            Self::Creeping => "5 km/h over 100 to 200 m",
        }
    }

    /// The scenario with it, and where it is, m along the distance travelled.
    fn on(self, scenario: &Scenario, random: &mut ChaCha8Rng) -> (Scenario, [f64; 2]) {
        let (length_m, top_kmh) = (scenario.line.length_m(), 3.6 * scenario.line.top_mps());
        // On the open line: a disturbance within a station is the station's.
        let calls = || [0.0, length_m].into_iter().chain(scenario.line.calls_m().iter().copied());
        let open_m = 0.2 * length_m / calls().count().max(2) as f64;
        let mut at_m = random.random_range(0.1..0.9) * length_m;
        while calls().any(|call_m| (call_m - at_m).abs() < open_m.max(0.25 * 500.0)) {
            at_m = random.random_range(0.1..0.9) * length_m;
        }
        let mut to = |from: f64, to: f64| random.random_range(from..to);
        let (over_m, kmh) = match self {
            Self::RedSignal => {
                let red = UnscheduledStop { at_m, dwell_s: to(20.0, 240.0), share: 1.0 };
                return (Scenario { unscheduled_stop: Some(red), ..scenario.clone() }, [at_m; 2]);
            }
            Self::Restriction => (to(500.0, 3_000.0), to(0.3, 0.6) * top_kmh),
            Self::Caution => (to(200.0, 400.0), to(0.3, 0.5) * top_kmh),
            Self::Creeping => (to(100.0, 200.0), 5.0),
        };
        let line = scenario.line.with_restriction(at_m, at_m + over_m, kmh);
        (Scenario { line, ..scenario.clone() }, [at_m, at_m + over_m])
    }
}

/// One run of a set.
struct DrivenRun {
    recording: Recording,
    /// What disturbed it, where, m, and what that cost, s.
    disturbed: Option<(Disturbance, [f64; 2], f64)>,
}

/// Disturbances of one kind.
#[derive(Clone, Debug, Serialize)]
pub struct PerturbedRow {
    /// What it was.
    pub what: &'static str,
    /// Runs that lost at least 20 s by it.
    pub felt: usize,
    /// Those that were recognised, with a place within 1 km.
    pub found: usize,
}

/// Runs of one line.
#[derive(Clone, Debug, Serialize)]
pub struct LineRow {
    /// Which.
    pub what: &'static str,
    /// Runs that lost at least 20 s.
    pub felt: usize,
    /// Those that were recognised with their place.
    pub found: usize,
    /// Runs without a disturbance.
    pub clean: usize,
    /// Those that were called perturbed, in words.
    pub accused: Vec<String>,
}

/// What came of all sets.
#[derive(Clone, Debug, Serialize)]
pub struct PerturbedBench {
    /// By disturbance.
    pub disturbances: Vec<PerturbedRow>,
    /// By line.
    pub lines: Vec<LineRow>,
}

/// Of `perturbed.json`: path, unit, meaning, null rule.
pub const FIELDS: &[[&str; 4]] = &[
    ["disturbances[].what", "", "what held the runs up", ""],
    ["disturbances[].felt", "", "runs that lost at least 20 s by it", ""],
    ["disturbances[].found", "", "those that were recognised, with a place within 1 km", ""],
    ["lines[].what", "", "line and train", ""],
    ["lines[].felt", "", "runs that lost at least 20 s by a disturbance", ""],
    ["lines[].found", "", "those that were recognised, with a place within 1 km", ""],
    ["lines[].clean", "", "runs without a disturbance", ""],
    ["lines[].accused[]", "", "what was said of each of those that was called perturbed", ""],
];

/// Compares so many sets of runs on each line.
///
/// # Errors
/// [`DriveError`] where a run could not be simulated.
pub fn bench(sets: u64, seed: u64, done: impl Fn() + Sync) -> Result<PerturbedBench, DriveError> {
    let mut disturbances: Vec<PerturbedRow> =
        Disturbance::ALL.iter().map(|one| PerturbedRow { what: one.words(), felt: 0, found: 0 }).collect();
    let mut lines = Vec::new();
    for fleet in fleets::all().iter().filter(|fleet| FLEETS.contains(&fleet.name)) {
        let set = |number: u64| {
            let outcome = driven(fleet, seed.wrapping_add(7919 * number));
            done();
            outcome
        };
        let sets = (0..sets).into_par_iter().map(set).collect::<Result<Vec<_>, _>>()?;
        lines.push(judged(fleet.what, sets, &mut disturbances));
    }
    Ok(PerturbedBench { disturbances, lines })
}

/// Steps of [`bench()`].
pub const fn steps(sets: u64) -> u64 {
    FLEETS.len() as u64 * sets
}

fn driven(fleet: &Fleet, seed: u64) -> Result<Vec<DrivenRun>, DriveError> {
    let mut random = ChaCha8Rng::seed_from_u64(seed ^ 0x9E57);
    let scenario = Scenario { wind_sd_mps: 2.0, load_sd: 0.03, ..fleet.scenario.clone() };
    let run = |plan: &RunPlan| {
        let name = format!("run{:02}", plan.number);
        let calm = simulate_planned(&scenario, plan)?;
        if !random.random_bool(DISTURBED) {
            return Ok(DrivenRun { recording: Case::simulated(name, String::new(), calm).recording, disturbed: None });
        }
        let what = Disturbance::ALL[random.random_range(0..Disturbance::ALL.len())];
        let (disturbed, place_m) = what.on(&scenario, &mut random);
        let run = simulate_planned(&disturbed, plan)?;
        let lost_s = run.facts.stop.time_s - calm.facts.stop.time_s;
        let recording = Case::simulated(name, String::new(), run).recording;
        Ok(DrivenRun { recording, disturbed: Some((what, place_m, lost_s)) })
    };
    plan(&scenario, RUNS, seed).iter().map(run).collect()
}

fn judged(what: &'static str, sets: Vec<Vec<DrivenRun>>, disturbances: &mut [PerturbedRow]) -> LineRow {
    let mut row = LineRow { what, felt: 0, found: 0, clean: 0, accused: Vec::new() };
    for set in sets {
        let truths: Vec<_> = set.iter().map(|driven| driven.disturbed).collect();
        let mut recordings: Vec<Recording> = set.into_iter().map(|driven| driven.recording).collect();
        let found = check(&mut recordings);
        for (run, truth) in found.runs.iter().zip(truths) {
            let Some((kind, [from_m, to_m], lost_s)) = truth else {
                row.clean += 1;
                row.accused.extend(run.perturbed());
                continue;
            };
            if lost_s < FELT_S {
                continue;
            }
            let is_there = run.perturbations.iter().any(|one| one.from_m < to_m + NEAR_M && one.to_m > from_m - NEAR_M);
            row.felt += 1;
            row.found += usize::from(is_there);
            if let Some(of_kind) = disturbances.iter_mut().find(|row| row.what == kind.words()) {
                of_kind.felt += 1;
                of_kind.found += usize::from(is_there);
            }
        }
    }
    row
}

impl PerturbedBench {
    /// As in `docs/check.md`.
    pub fn table(&self) -> String {
        let mut text = String::from("| disturbance | recognised, with its place |\n|---|---|\n");
        for PerturbedRow { what, felt, found } in &self.disturbances {
            text += &format!("| {what} | {found} of {felt} |\n");
        }
        text += "\n| line | recognised, with its place | runs without a disturbance that are called perturbed |\n|---|---|---|\n";
        for LineRow { what, felt, found, clean, accused } in &self.lines {
            text += &format!("| {what} | {found} of {felt} | {} of {clean} |\n", accused.len());
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn most_perturbed_runs_are_recognised_and_few_calm_ones_accused() {
        let bench = bench(1, 4711, || ()).unwrap();
        println!("{}", bench.table());
        let sum = |count: fn(&LineRow) -> usize| bench.lines.iter().map(count).sum::<usize>();
        let (felt, found, clean) = (sum(|row| row.felt), sum(|row| row.found), sum(|row| row.clean));
        let accused: Vec<&String> = bench.lines.iter().flat_map(|row| &row.accused).collect();
        assert!(felt >= 15, "{felt} felt it");
        assert!(10 * found >= 8 * felt, "{found} of {felt}\n{}", bench.table());
        assert!(100 * accused.len() <= 2 * clean, "{} of {clean}: {accused:#?}", accused.len());
    }
}
