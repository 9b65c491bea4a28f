//! All runs, in chunks, through the estimator of the board in two modes, in bounded memory.
//!
//! ```text
//! source -> chunk of runs -> paper mode: each run for itself      -> views -> tallies, a row a run, some runs kept for figures
//!                         -> gated mode: each unit from run to run
//! ```
//!
//! The paper's filter begins each run with the manufacturer's values, as the paper does; the gated mode carries each
//! unit's vehicle. What is kept does not grow with the number of runs: [`DRAWN`] runs for figures at most, evenly
//! spread, and one vehicle for each unit.

use super::case::{Case, CaseTruth};
use super::tallies::{LIMIT_KMH, Tallies};
use super::view::{NOTHING, Seen, ViewOutcome};
use super::{Refused, moments::Moments, source::RunSource};
use crate::logs::Failed;
use rayon::prelude::*;
use rundown::estimator::config::{Config, Mode};
use rundown::{
    estimator::Estimator, filter::gaussian::Gaussian, model::resistance::Davis, model::track::Track,
    model::train::Train, tick::bounds::ConfigError, tick::memory::Vehicle,
};
use rundown_check::Check;
use rundown_files::column::{Column, record};
use rundown_files::recording::Recording;
use rundown_files::replay::{ReplayedRun, Tick, replay_apart_by, replay_units_by};
use rundown_files::sample::Sample;
use rundown_files::table::Record;
use std::collections::HashMap;

/// Traction, cruise, coast and brake of the run of Figs. 3, 5 and 6, shares of its time (section 4.3).
pub const PAPERS_RUN: [f64; 4] = [0.164, 0.17, 0.57, 0.093];
/// Its brake stays below this share of the largest (section 4.2).
pub const PAPERS_LARGEST_BRAKE: f64 = 0.59;
/// It runs as fast as the line permits: section 4.2 reads shares of the resistance from it that are those at 140 km/h.
const PAPERS_TOP_KMH: f64 = 138.0;
/// Longer than this between two rows is a hole in a picture of a run, s: no recorder of the study writes so seldom.
const HOLE_S: f64 = 60.0;
/// Speed at which resistances are compared, m/s: 100 km/h, the middle of the speeds of these runs.
const COMPARED_MPS: f64 = 100.0 / 3.6;
/// Runs that the page lists, and that have pages of their own: more would be slow to open, and `runs.csv` has all.
pub const LISTED: usize = 2000;
/// Runs whose points are drawn.
pub const DRAWN: usize = 200;

#[derive(Clone, Debug)]
pub struct Estimators {
    pub paper: Estimator,
    pub gated: Estimator,
}

impl Estimators {
    /// Both modes of one configuration.
    pub fn try_new(config: Config, train: Train, track: &Track) -> Result<Self, ConfigError> {
        let of = |mode| Estimator::try_new(Config { mode, ..config }, train, track.clone());
        Ok(Self { paper: of(Mode::Paper)?, gated: of(Mode::Gated)? })
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Drawn {
    pub recording: Recording,
    /// What the recorder wrote, where it is something else.
    pub as_recorded: Option<Recording>,
    pub paper: Seen,
    pub gated: Seen,
    pub truth: Option<Seen>,
}

impl Drawn {
    pub fn name(&self) -> &str {
        &self.recording.name
    }

    /// What the recorder wrote.
    pub fn read(&self) -> &Recording {
        self.as_recorded.as_ref().unwrap_or(&self.recording)
    }

    /// Measured location in m and speed in km/h; none where one is missing.
    pub fn profile(&self) -> impl Iterator<Item = Option<(f64, f64)>> {
        self.recording.rows.iter().map(|row| Some((row.location_m?, 3.6 * row.speed_mps?)))
    }
}

#[derive(Clone, Debug)]
pub struct Example {
    /// The paper's loop on what the recorder wrote.
    pub paper: ReplayedRun,
    /// The same on readings that were put right, where some were: regimes and features are of these.
    pub put_right: Option<ReplayedRun>,
    pub gated: ReplayedRun,
    pub truth: Option<CaseTruth>,
}

impl Example {
    /// `looped`: the paper's loop on what the recorder wrote, where that is something else than the first run was made
    /// of.
    fn of([features, gated]: [ReplayedRun; 2], looped: Option<ReplayedRun>, truth: Option<CaseTruth>) -> Self {
        let (paper, put_right) = match looped {
            Some(looped) => (looped, Some(features)),
            None => (features, None),
        };
        Self { paper, put_right, gated, truth }
    }

    /// The run of the paper's mode from which regimes and features are taken.
    pub fn features(&self) -> &ReplayedRun {
        self.put_right.as_ref().unwrap_or(&self.paper)
    }
}

#[derive(Clone, Debug, Default)]
pub struct Gathered {
    pub paper: Tallies,
    pub gated: Tallies,
    /// As it was; its `runs` are those whose truth is known.
    pub truth: Tallies,
    /// Largest measured speed of each run, km/h.
    pub top_kmh: Moments,
    /// Runs that were measured above [`LIMIT_KMH`].
    pub over_limit: u64,
    /// Runs that were above it, of those whose truth is known.
    pub truly_over_limit: u64,
    /// From the first location of each run to its last, m.
    pub travelled_m: Moments,
    /// Mean time between the readings of each run, s.
    pub interval_s: Moments,
    /// As described; none where nothing was gathered.
    pub track: Option<Track>,
    pub rows: u64,
    pub drawn: Vec<Drawn>,
    /// The first [`LISTED`] runs.
    pub listed: Vec<Listed>,
    pub example: Option<Example>,
    /// What held it up, where it is set aside.
    pub example_aside: Option<String>,
    /// How far it is from the paper's run.
    pub example_off: f64,
    /// What the gated mode knows of each unit after its last run, by name.
    pub units: Vec<(String, Gaussian<3>)>,
    pub failed: Vec<Failed>,
    /// Perturbed runs: they have a row in `runs.csv`, and no part in anything else.
    pub set_aside: usize,
    /// What a person must know of recorded runs.
    pub notes: Vec<String>,
    /// What the recorders did to recorded runs, a diagnosis for each chunk.
    pub checks: Vec<Check>,
}

/// A run in the page's table.
#[derive(Clone, Debug)]
pub struct Listed {
    pub name: String,
    pub unit: String,
    /// Largest measured speed, km/h.
    pub top_kmh: f64,
    /// As the gated mode saw it.
    pub gated: ViewOutcome,
}

/// Runs of a chunk with their rows of results.
pub struct Rows<'a> {
    /// All of them in their order, those that are set aside, too.
    pub all: &'a [&'a LookedAt],
    /// Those that are not set aside.
    pub used: &'a [LookedAt],
    /// Of all.
    pub records: &'a [Record],
}

/// What happens with the runs of a chunk.
pub type Sink<'a> = dyn FnMut(&Rows) -> std::io::Result<()> + 'a;

#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GatherError {
    #[error("{0}")]
    Runs(#[from] Refused),
    #[error("{0}")]
    Sink(#[from] std::io::Error),
}

/// Replays all runs of a source. `sink` gets a row for each run, chunk by chunk in order; `done` is called with the
/// runs of each chunk. `wanted` is the name of the run of Figs. 3, 5 and 6; without one, that which is nearest to the
/// paper's in what section 4 says of it: its regimes in the paper's mode, its largest speed, its largest brake rate.
///
/// # Errors
/// [`GatherError`] when runs cannot be read or rows cannot be written. A single bad log is no error: it is in `failed`.
pub fn gather(
    source: &mut RunSource,
    estimators: &Estimators,
    wanted: Option<&str>,
    sink: &mut Sink,
    done: impl Fn(usize),
) -> Result<Gathered, GatherError> {
    let mut gathered = Gathered::default();
    let mut vehicles: HashMap<String, Vehicle> = HashMap::new();
    // One run in so many is drawn.
    let stride = source.total().div_ceil(DRAWN).max(1);
    let mut index = 0;
    let of_run = columns();
    let train = estimators.paper.train();
    while let Some(loaded) = source.next_chunk()? {
        let count = loaded.len();
        let mut cases = Vec::with_capacity(count);
        for case in loaded {
            match case {
                Ok(case) => cases.push(case),
                Err(failed) => gathered.failed.push(failed),
            }
        }
        let is_aside: Vec<bool> = cases.iter().map(|case| source.sets_aside(case)).collect();
        let mut marks = is_aside.iter();
        let (aside, cases): (Vec<Case>, Vec<Case>) = cases.into_iter().partition(|_| marks.next() == Some(&true));
        gathered.set_aside += aside.len();
        // They teach no vehicle, and know none of the runs beside them.
        let mut before = if aside.is_empty() { HashMap::new() } else { vehicles.clone() };
        let aside = looked_at(estimators, aside, &mut before);
        let chunk = looked_at(estimators, cases, &mut vehicles);
        let (mut apart, mut used) = (aside.iter(), chunk.iter());
        let next = |is_aside: bool| if is_aside { apart.next() } else { used.next() };
        let all: Vec<&LookedAt> = is_aside.into_iter().filter_map(next).collect();
        let records: Vec<Record> = all.iter().map(|one| record(&of_run, one)).collect();
        sink(&Rows { all: &all, used: &chunk, records: &records })?;
        for one in chunk {
            gathered.add(one, index % stride == 0, wanted, train);
            index += 1;
        }
        gathered.show_aside(aside, wanted);
        done(count);
    }
    gathered.track = Some(estimators.paper.track().clone());
    gathered.checks = source.found().to_vec();
    gathered.notes = source.notes();
    let known = vehicles.into_iter();
    gathered.units = known.map(|(name, vehicle)| (name, vehicle.davis())).collect();
    gathered.units.sort_by(|a, b| a.0.cmp(&b.0));
    Ok(gathered)
}

/// A case through every pair of eyes: the paper's mode, the gated one, the truth.
pub struct LookedAt {
    case: Case,
    runs: [ReplayedRun; 2],
    /// The paper's loop on what the recorder wrote, where that is something else.
    looped: Option<ReplayedRun>,
    seen: [Seen; 2],
    truth: Option<Seen>,
}

fn looked_at(estimators: &Estimators, cases: Vec<Case>, vehicles: &mut HashMap<String, Vehicle>) -> Vec<LookedAt> {
    let Estimators { paper, gated } = estimators;
    let train = paper.train();
    let recordings: Vec<&Recording> = cases.iter().map(|case| &case.recording).collect();
    let read: Vec<&Recording> = cases.iter().filter_map(|case| case.as_recorded.as_ref()).collect();
    let apart = |recordings: &[&Recording]| replay_apart_by(&|_| paper, recordings, Tick::EverySample, || ());
    let ((apart, looped), carried) = rayon::join(
        || (apart(&recordings), apart(&read)),
        || replay_units_by(&|_| gated, &recordings, Tick::EverySample, vehicles, || ()),
    );
    let mut looped = looped.into_iter();
    let with_loop = |case: Case| {
        let looped = case.as_recorded.is_some().then(|| looped.next()).flatten();
        (case, looped)
    };
    let cases: Vec<(Case, Option<ReplayedRun>)> = cases.into_iter().map(with_loop).collect();
    let look = |((case, looped), runs): ((Case, Option<ReplayedRun>), [ReplayedRun; 2])| {
        let [features, gated] = runs.each_ref().map(|run| Seen::of_replay(run, train));
        let paper = match &looped {
            Some(looped) => features.with_filter(Seen::of_replay(looped, train)),
            None => features,
        };
        let truth = case.truth.as_ref().map(|truth| Seen::of_truth(truth, train));
        LookedAt { seen: [paper, gated], truth, case, runs, looped }
    };
    let runs: Vec<[ReplayedRun; 2]> = apart.into_iter().zip(carried).map(Into::into).collect();
    cases.into_par_iter().zip(runs).map(look).collect()
}

impl LookedAt {
    /// What the estimator got.
    pub fn recording(&self) -> &Recording {
        &self.case.recording
    }

    /// What was true of it.
    pub fn truth(&self) -> Option<&CaseTruth> {
        self.case.truth.as_ref()
    }

    /// What the gated mode says of it.
    pub fn gated(&self) -> &ReplayedRun {
        &self.runs[1]
    }

    /// One that nobody knows, where the truth is not there.
    fn true_outcome(&self) -> &ViewOutcome {
        self.truth.as_ref().map_or(&NOTHING, |truth| &truth.outcome)
    }
}

/// The columns of `runs.csv` and `runs.parquet`: the same for every run, so that a table of recorded and simulated runs
/// is one.
pub fn columns() -> Vec<Column<LookedAt>> {
    let mut columns = vec![
        Column::text("run", "name of the run", |one: &LookedAt| one.case.recording.name.clone()),
        Column::text("unit", "unit whose vehicle is carried", |one: &LookedAt| one.case.recording.unit.clone())
            .empty_when("no index names one"),
        Column::text("driver", "who drove", |one: &LookedAt| one.case.recording.driver.clone())
            .empty_when("no index names one"),
        Column::count("rows", "rows of the log", |one: &LookedAt| one.case.recording.rows.len()),
        Column::number("top_kmh", "km/h", "largest measured speed", |one: &LookedAt| top_kmh(one.case.read())),
        Column::text("perturbed", "what outside the train held the run up", |one: &LookedAt| {
            one.case.recording.perturbed.clone().unwrap_or_default()
        })
        .empty_when("nothing did, or nobody looked"),
    ];
    for (index, (prefix, by)) in
        [("paper", "by the paper's mode"), ("gated", "by the gated mode")].into_iter().enumerate()
    {
        let seen = ViewOutcome::columns(prefix, by).into_iter();
        columns.extend(seen.map(|column| column.of_part(move |one: &LookedAt| &one.seen[index].outcome)));
    }
    columns.extend(
        ViewOutcome::columns("true", "in truth").into_iter().map(|column| column.of_part(LookedAt::true_outcome)),
    );
    columns
}

impl Gathered {
    /// A run that is set aside is shown where it is asked for by its name; of what is said of all runs it is no part.
    fn show_aside(&mut self, aside: Vec<LookedAt>, wanted: Option<&str>) {
        let Some(one) = aside.into_iter().find(|one| Some(one.case.recording.name.as_str()) == wanted) else { return };
        self.example_aside.clone_from(&one.case.recording.perturbed);
        let LookedAt { case, runs, looped, .. } = one;
        self.example = Some(Example::of(runs, looped, case.truth));
    }

    fn add(&mut self, one: LookedAt, is_drawn: bool, wanted: Option<&str>, train: &Train) {
        let top_kmh = top_kmh(one.case.read());
        let LookedAt { case: Case { recording, as_recorded, truth: case_truth }, runs, looped, seen, truth } = one;
        let [paper, gated] = seen;
        self.paper.add(&paper);
        self.gated.add(&gated);
        if let Some(truth) = &truth {
            self.truth.add(truth);
        }
        if let Some(truth) = &case_truth {
            let truly_kmh = truth.samples.iter().map(|sample| 3.6 * sample.speed_mps).fold(0.0, f64::max);
            self.truly_over_limit += u64::from(truly_kmh > LIMIT_KMH);
            self.add_resistance_errors(truth, [&paper.outcome, &gated.outcome], &train.davis());
        }
        self.add_extent(&recording);
        self.rows += recording.rows.len() as u64;
        self.top_kmh.add(top_kmh);
        self.over_limit += u64::from(top_kmh > LIMIT_KMH);
        let holes = holes(&recording.rows);
        let off = holes as f64 + off_papers_run(&paper.outcome, top_kmh, train.description().max_brake_mps2);
        let is_nearer = self.example.is_none() || off < self.example_off;
        if wanted.map_or(is_nearer, |name| recording.name == name) {
            self.example_off = off;
            self.example = Some(Example::of(runs, looped, case_truth));
        }
        if self.listed.len() < LISTED {
            let (name, unit) = (recording.name.clone(), recording.unit.clone());
            self.listed.push(Listed { name, unit, top_kmh, gated: gated.outcome.clone() });
        }
        if is_drawn {
            self.drawn.push(Drawn { recording, as_recorded, paper, gated, truth });
        }
    }

    fn add_extent(&mut self, recording: &Recording) {
        let mut locations_m = recording.rows.iter().filter_map(|row| row.location_m);
        if let Some(first_m) = locations_m.next() {
            let last_m = locations_m.next_back().unwrap_or(first_m);
            self.travelled_m.add((last_m - first_m).abs());
        }
        if let (Some(first), Some(last)) = (recording.rows.first(), recording.rows.last())
            && recording.rows.len() > 1
        {
            let intervals = (recording.rows.len() - 1) as f64;
            self.interval_s.add((last.time_s - first.time_s) / intervals);
        }
    }

    /// How far r(100 km/h) is from the truth, whoever says it: both modes after the run, and the description.
    fn add_resistance_errors(&mut self, truth: &CaseTruth, [paper, gated]: [&ViewOutcome; 2], described: &Davis) {
        let of = |davis: [f64; 3]| davis[0] + davis[1] * COMPARED_MPS + davis[2] * COMPARED_MPS.powi(2);
        let true_davis = &truth.facts.davis;
        let was = of([true_davis.r0, true_davis.r1, true_davis.r2]);
        let square = |davis| (of(davis) / was - 1.0).powi(2);
        self.paper.resistance_error2.add(square(paper.davis));
        self.gated.resistance_error2.add(square(gated.davis));
        self.truth.resistance_error2.add(square([described.r0, described.r1, described.r2]));
    }
}

/// How far a run is from that of Figs. 3, 5 and 6: root of the sum of squares of the shares, and 1 more for each thing
/// that section 4.2 says of it and that is not so.
fn off_papers_run(paper: &ViewOutcome, top_kmh: f64, max_brake_mps2: f64) -> f64 {
    let Some(shares) = paper.shares else {
        return f64::INFINITY;
    };
    let squares = shares.iter().zip(PAPERS_RUN).map(|(share, papers)| (share - papers).powi(2));
    let is_fast = top_kmh >= PAPERS_TOP_KMH;
    let brakes_gently = paper.largest_brake_mps2.is_some_and(|rate| rate < PAPERS_LARGEST_BRAKE * max_brake_mps2);
    let unlike = [is_fast, brakes_gently].into_iter().filter(|is_like| !is_like).count();
    squares.sum::<f64>().sqrt() + unlike as f64
}

/// Holes of a run: one that cannot be drawn whole is shown where there is no other.
fn holes(rows: &[Sample]) -> usize {
    rows.windows(2).filter(|pair| pair[1].time_s - pair[0].time_s > HOLE_S).count()
}

fn top_kmh(recording: &Recording) -> f64 {
    let speeds = recording.rows.iter().filter_map(|row| row.speed_mps);
    // Back from m/s: a reading of 140 must not lie above 140.
    let kmh = speeds.map(|speed_mps| (3.6e6 * speed_mps).round() / 1e6);
    kmh.fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_minute_without_a_row_is_a_hole() {
        let row = |time_s| Sample { time_s, ..Sample::default() };
        assert_eq!(holes(&[0.0, 10.0, 70.0, 80.0].map(row)), 0);
        assert_eq!(holes(&[0.0, 61.0, 62.0, 200.0].map(row)), 2);
    }
}
