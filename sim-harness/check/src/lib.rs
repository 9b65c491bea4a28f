//! What the recorder of a train did to its logs: found, measured, put right before anything else looks at them.
//!
//! ```text
//! recordings -> clock -> locations -> agreement, run by run -> pooled by recorder -> put right
//! ```
//!
//! | question | module |
//! |---|---|
//! | did the clock jump, pause? | [`clock`], `clock_set` |
//! | are rows stamped when they arrive, several at once? | `bursts` |
//! | does it lose seconds? | [`lost_seconds`] |
//! | did the odometer wrap, begin again? | [`odometer`] |
//! | which locations stand for none? | [`placeholders`] |
//! | are single locations wild? | `spikes` |
//! | which readings stay the same? | [`stuck_rows`] |
//! | does the location stand still? | `stuck_locations` |
//! | and the speed? | `stuck_speeds`, `stuck_speed_by_location` |
//! | does it end at a largest value? | `saturated` |
//! | did the train go there and back in one log? | `two_directions` |
//! | which way do the locations grow, how far does a train go between rows? | [`ways`] |
//! | how far may a train go between two rows? | `reach` |
//! | are single readings missing or impossible? | [`readings`] |
//! | which step do the readings have? | [`steps`] |
//! | are speeds counted in one unit and written in steps of another? | `written` |
//! | is a run unlike the others of its recorder? | [`mod@own`] |
//! | does the wheel change? | `wheel_change` |
//! | does it creep while it powers? | `creep` |
//! | does the speed read zero below a threshold? | [`dead_zone`] |
//! | what does the rounding of held speeds do? | `rounding` |
//! | does the speed repeat old values? | [`held`] |
//! | does the speed change in stairs? | `stairs` |
//! | and the effort? | `effort::stairs` |
//! | do whole km/h come late? | `dead_band` |
//! | do the wheels slip or slide? | `slips` |
//! | are rows no readings, but between them? | `interpolated` |
//! | does a straight line bridge what was not received? | `bridged` |
//! | does the effort stand still? | `effort::held` |
//! | is it cut off at a maximum? | `effort::cut` |
//! | do speeds trail behind the train in a filter? | `trailing` |
//! | are speeds means over some seconds? | `smoothed` |
//! | what does an age of the speed add to the way besides? | `second_order` |
//! | is the effort older than the speed? | `effort::age` |
//! | is it what acts, or what the lever asks for? | `effort::demanded` |
//! | have small efforts the gain of large ones? | `effort::small` |
//! | is the effort of a run unlike that of the others? | `effort::unlike` |
//! | what does it have for trains that coast? | `effort::coasting` |
//! | is its zero one? | `effort::zero` |
//! | do trains exceed what is described of them? | [`limits`] |
//! | is a log another one again, whole or in part? | [`same`] |
//! | does the location drift between corrections? | `drifting` |
//! | do the locations grow as the described stops have it? | [`line_scale`] |
//! | do all runs count their locations from the same place? | [`chainage`] |
//! | do speed and location agree: scale, offset, skew? | [`mod@agreement`] |
//! | what was found, and what was done? | [`finding`] |
//! | what does a run, a recorder, a set of runs say with all that? | `run`, `recorder`, `diagnosis` |
//! | do the described gradients explain how trains coast? | [`gradients`] |
//! | was the run held up by something outside the train? | [`perturbed`] |
//!
//! Offset and scale are one fit, and never decided by a run that cannot tell them apart. A step is called truncated or
//! rounded only where the offset says so.
//!
//! ```
//! use rundown_check::{check, finding::Kind};
//! use rundown_files::recording::Recording;
//! use rundown_files::sample::Sample;
//!
//! // Half a quantum is lost in each reading of a run between 5 and 35 m/s.
//! let row = |i: u32| {
//!     let t = f64::from(i);
//!     let (speed, location_m) = (20.0 - 15.0 * (t / 200.0).cos(), 20.0 * t - 3000.0 * (t / 200.0).sin());
//!     Sample { time_s: t, location_m: Some(location_m), speed_mps: Some((3.6 * speed).floor() / 3.6), ..Sample::default() }
//! };
//! let mut recordings = [Recording { name: "run".into(), rows: (0..3000).map(row).collect(), ..Recording::default() }];
//! let found = check(&mut recordings);
//! assert!(found.recorders[0].findings.iter().any(|finding| finding.kind == Kind::TruncatedSpeed));
//! assert!((3.6 * recordings[0].rows[500].speed_mps.unwrap() % 1.0 - 0.5).abs() < 1e-6); // put right: the middle of its step
//! ```
#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod agreement;
mod braking;
mod bridged;
mod bursts;
pub mod chainage;
pub mod clock;
mod clock_set;
pub mod compared;
mod correction;
mod creep;
mod dead_band;
pub mod dead_zone;
mod diagnosis;
mod drifting;
pub mod effort;
pub mod figure;
pub mod finding;
pub mod gradients;
pub mod held;
mod interpolated;
mod late_rows;
pub mod limits;
pub mod line_scale;
pub mod lost_seconds;
pub mod odometer;
mod of_most;
mod of_speed;
pub mod own;
mod parts;
pub mod perturbed;
pub mod placeholders;
mod profile;
mod reach;
pub mod readings;
mod recorder;
mod rounding;
pub mod row_step;
mod run;
pub mod same;
mod saturated;
mod second_order;
mod slips;
mod smoothed;
mod spikes;
mod stairs;
pub mod steps;
mod stuck_locations;
pub mod stuck_rows;
mod stuck_speed_by_location;
pub mod stuck_speeds;
mod trailing;
mod two_directions;
pub mod ways;
mod wheel_change;
mod written;

use figure::Figure;
use finding::{Done, Kind};
use line_scale::RunStops;
use of_speed::{OfSpeed, Taken};
use rundown::model::{direction::Direction, line::Line, track::Track};
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;
use same::Seen;
use std::collections::HashSet;

pub use correction::Correction;
pub use diagnosis::{Check, RecorderCheck};
pub use parts::parts;
pub use run::RunCheck;

/// A scale that matters: a wheel wears by 10 % over its life, and 0.3 % is less than what platforms and lines are off
/// by.
const LEAST_SCALE: f64 = 0.003;
/// So many standard deviations are beyond doubt where something is put right.
const SURE: f64 = 4.0;

fn put_right(here: bool) -> Done {
    if here { Done::PutRight } else { Done::Said }
}

/// What is known already: of the recorder, where it is put right elsewhere, and of the line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Known {
    /// It truncates: the configuration says so.
    pub truncates: bool,
    /// Its scale: an effect of the model says so.
    pub scale: bool,
    /// Where the track describes stops, m.
    pub stops_m: Vec<f64>,
    /// Limits of train and line.
    pub limits: limits::Described,
    /// The track, for its gradients.
    pub track: Option<Track>,
    /// Locations are moved to the age of the speed, and efforts that are not the train's are left out. Not for a model
    /// that asks for lag and efforts itself.
    pub moves_locations: bool,
}

impl Known {
    /// The line under a run; none where train or track is not described.
    fn line(&self, direction: Direction) -> Option<Line<'_>> {
        let described = self.limits.train.as_ref().zip(self.track.as_ref());
        described.map(|(train, track)| Line { train, track, direction })
    }
}

/// Diagnoses runs and puts right what is beyond doubt.
pub fn check(recordings: &mut [Recording]) -> Check {
    check_beside(recordings, &Known::default())
}

/// The same, but for what is put right elsewhere.
pub fn check_beside(recordings: &mut [Recording], known: &Known) -> Check {
    check_after(recordings, known, &mut Seen::default())
}

/// The same of runs that are read after others.
pub fn check_after(recordings: &mut [Recording], known: &Known, seen: &mut Seen) -> Check {
    let written = written::put_right(recordings);
    let ends_mps = saturated::of_units(recordings);
    let of_run = |one: &mut Recording| run::beside(one, ends_mps.get(&one.unit).copied(), seen);
    let (mut runs, mut of_speeds): (Vec<RunCheck>, Vec<Option<OfSpeed>>) = recordings.iter_mut().map(of_run).unzip();
    let units = units(&runs);
    let mut before = vec![(None, Vec::new(), None); units.len()];
    for (unit, (drift, slipping, sliding)) in units.iter().zip(&mut before) {
        let usable = read_of(unit, &runs);
        *drift = drifting::put_right(recordings, &usable);
        let moved = |i: &usize| Some((*i, of_speeds[*i].as_ref()?.agreement.moved_s()));
        *slipping = slips::leave_out(recordings, &usable.iter().filter_map(moved).collect::<Vec<_>>());
        if drift.is_some() || !slipping.is_empty() {
            compare(recordings, &runs, &usable, &mut of_speeds);
        }
        let compared: Vec<(usize, f64)> = usable.iter().map(|i| (*i, runs[*i].step_s)).collect();
        *sliding = slips::each_brake::take_off(recordings, &compared, &mut of_speeds);
        second_order::take_off(recordings, &compared, &mut of_speeds);
    }
    let described_m = if known.scale { &[] } else { known.stops_m.as_slice() };
    let stops_of = |(run, recording): (&mut RunCheck, &Recording)| {
        let stops = run.is_usable().then(|| line_scale::of_run(recording, described_m)).flatten()?;
        if let Some((factor, count)) = stops.other_unit(described_m) {
            run.is_in_other_unit(factor, count);
        }
        Some(stops)
    };
    let stops: Vec<Option<RunStops>> = runs.iter_mut().zip(recordings.iter()).map(stops_of).collect();
    let of_unit = |(unit, (drift, slipping, sliding)): (String, Before)| {
        let usable = usable_of(&unit, &runs);
        let scaled = line_scale::put_right(recordings, &usable, &stops, described_m);
        if !scaled.is_empty() {
            compare(recordings, &runs, &usable, &mut of_speeds);
        }
        // Of two the stops leave most open of the one that is known worse.
        let located = scaled.iter().map(|scaled| scaled.scale).max_by(|a, b| a.sd.total_cmp(&b.sd));
        let written = written.get(&unit);
        let mut recorder = recorder::of(unit, (located, drift), recordings, &mut runs, &of_speeds, known);
        if let Some(written) = written {
            let unit = Figure { value: written.unit_kmh, sd: 0.0 };
            recorder.found_by(Kind::RewrittenSpeed, unit, "km/h", Done::PutRight, written.evidence());
        }
        for scaled in scaled {
            recorder.found_by(Kind::LocationScale, scaled.scale, "", Done::PutRight, scaled.evidence());
        }
        for slips in slipping {
            let (finding, evidence) = (slips.finding(), slips.evidence(recorder.runs));
            recorder.evidence.insert(finding.kind, evidence);
            recorder.findings.push(finding);
        }
        if let Some(percent) = sliding {
            let text = "in each brake; speed and location are compared without them";
            recorder.found_by(Kind::Slides, percent, "%", Done::Said, text.to_owned());
        }
        recorder.efforts(recordings, &mut runs, known);
        recorder
    };
    let recorders = units.into_iter().zip(before).map(of_unit).collect();
    let is_usable: Vec<bool> = runs.iter().map(RunCheck::is_usable).collect();
    for (run, off) in runs.iter_mut().zip(chainage::find(recordings, &is_usable, &known.stops_m)) {
        off.into_iter().for_each(|off| run.is_off(off));
    }
    let not_compared = held_up(recordings, &mut runs, &known.stops_m);
    Check { recorders, runs, not_compared, ..Check::default() }
}

/// What of a recorder is found before speed and location are compared: its drift, its slips, and by how much the wheels
/// slide in each brake, %.
type Before = (Option<drifting::Drift>, Vec<slips::Slips>, Option<Figure>);

/// Compares speed and location of these runs again, once their readings are others.
fn compare(recordings: &[Recording], runs: &[RunCheck], usable: &[usize], of_speeds: &mut [Option<OfSpeed>]) {
    for i in usable {
        let taken = of_speeds[*i].as_ref().map_or(Taken::default(), |of_speed| of_speed.taken);
        of_speeds[*i] = OfSpeed::of(&recordings[*i].rows, runs[*i].step_s, taken);
    }
}

/// In the order in which they appear.
fn units(runs: &[RunCheck]) -> Vec<String> {
    let mut seen = HashSet::new();
    runs.iter().filter(|run| seen.insert(&run.unit)).map(|run| run.unit.clone()).collect()
}

/// The places of the runs of a unit that are used.
fn usable_of(unit: &str, runs: &[RunCheck]) -> Vec<usize> {
    (0..runs.len()).filter(|i| runs[*i].is_usable_of(unit)).collect()
}

/// Those of them whose speeds were read.
fn read_of(unit: &str, runs: &[RunCheck]) -> Vec<usize> {
    usable_of(unit, runs).into_iter().filter(|i| !runs[*i].speed_is_computed).collect()
}

/// Says what held runs up. Out: of how many it cannot be said.
fn held_up(recordings: &mut [Recording], runs: &mut [RunCheck], stops_m: &[f64]) -> usize {
    // Of what drove at unknown speeds nobody knows whether it was held up.
    let has_speeds = |rows: &[Sample]| 2 * rows.iter().filter(|row| row.speed_mps.is_some()).count() > rows.len();
    let is_readable: Vec<bool> =
        runs.iter().zip(recordings.iter()).map(|(run, one)| run.is_usable() && has_speeds(&one.rows)).collect();
    let found = perturbed::find(recordings, &is_readable, stops_m);
    for ((run, recording), perturbations) in runs.iter_mut().zip(recordings).zip(found.runs) {
        run.perturbations = perturbations;
        recording.perturbed = run.perturbed();
    }
    found.not_compared
}
