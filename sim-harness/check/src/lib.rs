//! What the recorder of a train did to its logs: found, measured, put right before anything else looks at them.
//!
//! ```text
//! recordings -> clock -> locations -> agreement, run by run -> pooled by recorder -> put right
//! ```
//!
//! Each folder begins with a table of its questions, and each question has a file.
//!
//! | question | folder | files |
//! |---|---|---|
//! | what do rows hold, whatever column is asked? | [`rows`] | [`times`](rows::times), [`steps`](rows::steps), [`ways`](rows::ways), `reach`, `interpolated`, `readings`, `wild`, `stuck`, `stairs`, `profile`, [`same`](rows::same) |
//! | what is wrong with their times? | [`clock`] | [`jumps`](clock::jumps), `set`, `bursts`, `lost_seconds` |
//! | what is wrong with the locations? | [`location`] | [`odometer`](location::odometer), [`placeholders`](location::placeholders), `spikes`, `stuck`, `bridged`, `two_directions`, `drifting`, [`line_scale`](location::line_scale), [`chainage`](location::chainage) |
//! | how is the speed shown, and what does that leave out? | [`speed`] | [`stuck`](speed::stuck), `stuck_by_location`, `saturated`, `dead_zone`, `held`, `stairs`, `dead_band`, `trailing`, `smoothed`, `written` |
//! | do speed and location agree: scale, offset, skew? | `agreement` | `parts`, `compared`, `late_rows`, `rounding`, `of_most` |
//! | what do the wheels do? | `wheel` | `change`, `creep`, `slips`, `braking` |
//! | has the effort to do with the train, and what is wrong with it? | `effort` | `stairs`, `held`, `cut`, `age`, `demanded`, `small`, `gap`, `unlike`, `coasting`, `zero`, `driven` |
//! | do trains exceed what is described of them? | | [`limits`] |
//! | was the run held up by something outside the train? | [`perturbed`] | `stops`, `slow` |
//! | do the described gradients explain how trains coast? | [`gradients`] | `stretch`, `mixture`, `places`, `by_efforts` and what they are doubted by |
//! | what does a run say with all that? | `run` | `of_speed` |
//! | and a recorder, and a set of runs? | `recorder` | `diagnosis`, `correction`, `second_order`, `each_brake`, `own`, `efforts` |
//! | what was found, how surely, and what was done? | | [`finding`], [`figure`] |
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

mod agreement;
pub mod clock;
mod effort;
pub mod figure;
pub mod finding;
pub mod gradients;
pub mod limits;
pub mod location;
pub mod perturbed;
mod recorder;
pub mod rows;
mod run;
pub mod speed;
mod wheel;

use figure::Figure;
use finding::{Done, Kind};
use location::line_scale::RunStops;
use rows::same::Seen;
use run::of_speed::{OfSpeed, Taken};
use rundown::model::{direction::Direction, line::Line, track::Track};
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;
use std::collections::HashSet;

pub use agreement::compared::Row;
pub use agreement::parts::parts;
pub use recorder::correction::Correction;
pub use recorder::diagnosis::{Check, RecorderCheck};
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
    let written = speed::written::put_right(recordings);
    let ends_mps = speed::saturated::of_units(recordings);
    let of_run = |one: &mut Recording| run::beside(one, ends_mps.get(&one.unit).copied(), seen);
    let (mut runs, mut of_speeds): (Vec<RunCheck>, Vec<Option<OfSpeed>>) = recordings.iter_mut().map(of_run).unzip();
    let units = units(&runs);
    let mut before = vec![(None, Vec::new(), None); units.len()];
    for (unit, (drift, slipping, sliding)) in units.iter().zip(&mut before) {
        let usable = read_of(unit, &runs);
        *drift = location::drifting::put_right(recordings, &usable);
        let moved = |i: &usize| Some((*i, of_speeds[*i].as_ref()?.agreement.moved_s()));
        *slipping = wheel::slips::leave_out(recordings, &usable.iter().filter_map(moved).collect::<Vec<_>>());
        if drift.is_some() || !slipping.is_empty() {
            compare(recordings, &runs, &usable, &mut of_speeds);
        }
        let compared: Vec<(usize, f64)> = usable.iter().map(|i| (*i, runs[*i].step_s)).collect();
        *sliding = recorder::each_brake::take_off(recordings, &compared, &mut of_speeds);
        recorder::second_order::take_off(recordings, &compared, &mut of_speeds);
    }
    let described_m = if known.scale { &[] } else { known.stops_m.as_slice() };
    let stops_of = |(run, recording): (&mut RunCheck, &Recording)| {
        let stops = run.is_usable().then(|| location::line_scale::of_run(recording, described_m)).flatten()?;
        if let Some((factor, count)) = stops.other_unit(described_m) {
            run.is_in_other_unit(factor, count);
        }
        Some(stops)
    };
    let stops: Vec<Option<RunStops>> = runs.iter_mut().zip(recordings.iter()).map(stops_of).collect();
    let of_unit = |(unit, (drift, slipping, sliding)): (String, Before)| {
        let usable = usable_of(&unit, &runs);
        let scaled = location::line_scale::put_right(recordings, &usable, &stops, described_m);
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
    for (run, off) in runs.iter_mut().zip(location::chainage::find(recordings, &is_usable, &known.stops_m)) {
        off.into_iter().for_each(|off| run.is_off(off));
    }
    let not_compared = held_up(recordings, &mut runs, &known.stops_m);
    Check { recorders, runs, not_compared, ..Check::default() }
}

/// What of a recorder is found before speed and location are compared: its drift, its slips, and by how much the wheels
/// slide in each brake, %.
type Before = (Option<location::drifting::Drift>, Vec<wheel::slips::Slips>, Option<Figure>);

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
