//! What the recorder of a train did to its logs: found, measured, put right before anything else looks at them.
//!
//! ```text
//! recordings -> clock -> places -> agreement, run by run -> pooled by recorder -> put right
//! ```
//!
//! | question | module |
//! |---|---|
//! | did the clock jump, pause? | [`clock`] |
//! | does it lose seconds? | [`lost_seconds`] |
//! | did the location wrap, begin again, stand still? | [`places`] |
//! | are single readings missing or impossible? | [`readings`] |
//! | which step do the readings have? | [`steps`] |
//! | is a run unlike the others of its recorder? | [`mod@own`] |
//! | does the wheel change? | `wheel_change` |
//! | does the speed read zero below a threshold? | [`dead_zone`] |
//! | what does the rounding of held speeds do? | `rounding` |
//! | does the speed repeat old values? | [`held`] |
//! | are rows no readings, but between them? | `interpolated` |
//! | does the effort stand still? | `effort_held` |
//! | are speeds means over some seconds? | `smoothed` |
//! | is the effort older than the speed? | `effort_age` |
//! | is the effort of a run unlike that of the others? | `effort_unlike` |
//! | is its zero one? | `effort_zero` |
//! | do trains exceed what is described of them? | [`limits`] |
//! | is a log another one again, whole or in part? | [`same`] |
//! | do the locations grow as the described stops have it? | [`line_scale`] |
//! | do all runs count their locations from the same place? | [`chainage`] |
//! | do speed and location agree: scale, offset, skew? | [`mod@agreement`] |
//! | what was found, and what was done? | [`finding`] |
//! | do the described gradients explain how trains coast? | [`gradients`] |
//! | was the run held up by something outside the train? | [`perturbed`] |
//!
//! Offset and scale are one fit, and never decided by a run that cannot tell them apart. A step is called truncated or rounded only where the offset says so.
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
pub mod chainage;
pub mod clock;
pub mod compared;
pub mod dead_zone;
pub mod effort;
mod effort_age;
mod effort_held;
mod effort_unlike;
mod effort_zero;
pub mod finding;
pub mod gradients;
pub mod held;
mod interpolated;
pub mod limits;
pub mod line_scale;
pub mod lost_seconds;
pub mod own;
pub mod perturbed;
pub mod places;
mod profile;
pub mod readings;
mod recorder;
mod rounding;
pub mod same;
mod smoothed;
pub mod steps;
mod wheel_change;

use agreement::{Agreement, Figure};
use compared::{Compared, Differences, Row};
use finding::{Done, Finding, Kind};
use perturbed::Perturbation;
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;
use rundown_files::units;
use same::{Seen, Shared};
use serde::Serialize;
use std::collections::BTreeMap;

/// What is the matter with one run.
#[derive(Clone, Debug, Serialize)]
pub struct RunCheck {
    /// Name of the run.
    pub name: String,
    /// Whose recorder it was.
    pub unit: String,
    /// Rows of the log.
    pub rows: usize,
    /// Usual time between rows, s.
    pub step_s: f64,
    /// By how much the speed is older than the location, s; none where too little moves.
    pub skew_s: Option<Figure>,
    /// White noise of the location, standard deviation, m.
    pub location_noise_m: Option<f64>,
    /// Speed over location when this run alone is asked, the recorder's offset known.
    pub scale: Option<Figure>,
    /// What was found.
    pub findings: Vec<Finding>,
    /// What says so, where it is more than a figure: by what was found.
    pub evidence: BTreeMap<Kind, String>,
    /// What outside the train held the run up, beside the other runs in its direction.
    pub perturbations: Vec<Perturbation>,
}

/// What is the matter with all runs of one recorder.
#[derive(Clone, Debug, Serialize)]
pub struct RecorderCheck {
    /// The unit, as the index names it.
    pub unit: String,
    /// Runs that moved long enough to compare speed and location.
    pub compared: usize,
    /// Runs.
    pub runs: usize,
    /// Step of the speeds, km/h.
    pub speed_step_kmh: Option<f64>,
    /// Step of the locations, m.
    pub location_step_m: Option<f64>,
    /// Step of the efforts, N/kg.
    pub effort_step_n_per_kg: Option<f64>,
    /// Measured over true speed; with the offset known where that is decided.
    pub scale: Option<Figure>,
    /// That scale is a wheel's: it matters, and nothing else explains it.
    #[serde(skip)]
    pub is_wheel: bool,
    /// True less read speed, km/h.
    pub offset_kmh: Option<Figure>,
    /// By how much the speed is older than the location, s: median over the runs.
    pub skew_s: Option<Figure>,
    /// How much that differs from run to run, s.
    pub skew_spread_s: Option<f64>,
    /// How surely it is known that its clock loses no seconds beside a wheel that hides them: of the height of such steps, standard deviation, s.
    pub lost_second_sd_s: Option<f64>,
    /// What was put right in its speeds.
    pub correction: Correction,
    /// What was found.
    pub findings: Vec<Finding>,
    /// What says so, where it is more than a figure: by what was found.
    pub evidence: BTreeMap<Kind, String>,
}

/// What is put right in the speeds of a recorder.
///
/// ```text
/// read = scale v - offset        v = (read + offset)/scale
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Correction {
    /// True less read speed, m/s: half a step where the recorder truncates.
    pub offset_mps: f64,
    /// Measured over true speed.
    pub scale: f64,
}

impl Correction {
    /// Nothing is put right.
    pub const NONE: Self = Self { offset_mps: 0.0, scale: 1.0 };

    /// The true speed from a reading, m/s. A standing train reads zero, whatever the recorder does.
    pub fn true_mps(&self, read_mps: f64) -> f64 {
        if read_mps > 0.0 { (read_mps + self.offset_mps) / self.scale } else { read_mps }
    }

    /// The reading of a true speed, m/s.
    ///
    /// ```
    /// use rundown_check::Correction;
    ///
    /// let wheel = Correction { offset_mps: 0.5 / 3.6, scale: 1.013 };
    /// assert!((wheel.true_mps(wheel.read_mps(20.0)) - 20.0).abs() < 1e-9);
    /// ```
    pub fn read_mps(&self, true_mps: f64) -> f64 {
        if true_mps > 0.0 { (true_mps * self.scale - self.offset_mps).max(0.0) } else { true_mps }
    }
}

impl Default for Correction {
    fn default() -> Self {
        Self::NONE
    }
}

/// The diagnosis of a set of runs.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Check {
    /// By recorder, in the order in which the units appear.
    pub recorders: Vec<RecorderCheck>,
    /// By run.
    pub runs: Vec<RunCheck>,
    /// Runs among which perturbed ones cannot be recognised: too few others pass where they do, or they have no timetable in common.
    pub not_compared: usize,
    /// The described gradients look wrong. None where they do not, or where train and track were not given.
    pub gradients: Option<gradients::Doubt>,
}

/// Findings of single runs that [`Check::notes`] has.
const NOTED: usize = 8;

impl Check {
    /// Runs that are not to be used.
    pub fn refused(&self) -> impl Iterator<Item = &RunCheck> {
        self.runs.iter().filter(|run| run.refusal().is_some())
    }

    /// Runs of which nothing of their own was found, and that nothing outside the train held up.
    pub fn clean(&self) -> usize {
        self.runs.iter().filter(|run| run.findings.is_empty() && run.perturbations.is_empty()).count()
    }

    /// The perturbed runs with their reasons, as one line; none where there are none.
    pub fn perturbed_note(&self) -> Option<String> {
        let perturbed: Vec<&RunCheck> = self.runs.iter().filter(|run| !run.perturbations.is_empty()).collect();
        let first =
            perturbed.iter().take(NOTED).map(|run| format!("{}: {}", run.name, run.perturbed().unwrap_or_default()));
        let named: Vec<String> = first.collect();
        let more = perturbed.len() - named.len();
        let rest = if more > 0 { format!("; {more} more, all by `rundown check`") } else { String::new() };
        let (count, all) = (perturbed.len(), self.runs.len());
        (count > 0).then(|| format!("perturbed runs: {count} of {all}: {}{rest}", named.join("; ")))
    }

    /// A recorder has a finding of this kind.
    pub fn has(&self, kind: Kind) -> bool {
        self.recorders.iter().any(|recorder| recorder.has(kind))
    }

    /// The recorder of a unit.
    pub fn recorder(&self, unit: &str) -> Option<&RecorderCheck> {
        self.recorders.iter().find(|recorder| recorder.unit == unit)
    }

    /// What a person must know, a line each: whatever changed a reading, and what spoils results and was not changed.
    pub fn notes(&self) -> Vec<String> {
        let spoils = |finding: &&Finding| match finding.done {
            Done::PutRight | Done::LeftOut => true,
            Done::Refused => false,
            Done::Said => {
                use Kind::{
                    AboveBrake, AboveSpeedLimit, AboveTraction, CoarseClock, EffortApart, EffortLate, EffortSteps,
                };
                use Kind::{
                    MissingReadings, OtherChainage, Reset, SharedRows, Skew, SpeedOffset, TurnedChainage, WheelChange,
                };
                matches!(
                    finding.kind,
                    AboveBrake
                        | AboveSpeedLimit
                        | AboveTraction
                        | CoarseClock
                        | EffortApart
                        | EffortLate
                        | EffortSteps
                        | MissingReadings
                        | OtherChainage
                        | Reset
                        | SharedRows
                        | Skew
                        | SpeedOffset
                        | TurnedChainage
                        | WheelChange
                )
            }
        };
        let of_recorder = self.recorders.iter().flat_map(|recorder| {
            let name = if recorder.unit.is_empty() { "all runs" } else { &recorder.unit };
            recorder.findings.iter().filter(spoils).map(move |finding| format!("{name}: {}", recorder.said(finding)))
        });
        let mut notes: Vec<String> = of_recorder.collect();
        let usable = self.runs.iter().filter(|run| run.refusal().is_none());
        let of_run = usable.flat_map(|run| {
            run.findings.iter().filter(spoils).map(|finding| format!("{}: {}", run.name, run.said(finding)))
        });
        let of_run: Vec<String> = of_run.collect();
        let more = of_run.len().saturating_sub(NOTED);
        notes.extend(of_run.into_iter().take(NOTED));
        if more > 0 {
            notes.push(format!("{more} more findings of single runs, all by `rundown check`"));
        }
        notes
    }
}

impl RecorderCheck {
    /// Scale and lost seconds are not distinguishable: the noise of the location hides steps of a second.
    pub fn hides_lost_seconds(&self) -> bool {
        self.lost_second_sd_s.is_some_and(|sd_s| sd_s > lost_seconds::NOT_SEEN_S)
    }
}

impl RunCheck {
    fn of(recording: &Recording, step_s: f64, findings: Vec<Finding>) -> Self {
        Self {
            name: recording.name.clone(),
            unit: recording.unit.clone(),
            rows: recording.rows.len(),
            step_s,
            skew_s: None,
            location_noise_m: None,
            scale: None,
            findings,
            evidence: BTreeMap::new(),
            perturbations: Vec::new(),
        }
    }

    /// Why the run is not to be used.
    pub fn refusal(&self) -> Option<&Finding> {
        self.findings.iter().find(|finding| finding.done == Done::Refused)
    }

    /// Something is the matter with the whole of it.
    pub(crate) fn found(&mut self, kind: Kind, figure: Figure, unit: &'static str, done: Done) {
        self.findings.push(Finding { kind, figure, unit, count: 1, line: 0, done });
    }

    /// Some of its rows are those of another log; where most are, it is not used.
    fn shares(&mut self, shared: &Shared) {
        let figure = Figure { value: 100.0 * shared.share, sd: 0.0 };
        let done = if shared.share > MOST_SHARED { Done::Refused } else { Done::Said };
        self.found(Kind::SharedRows, figure, "% of the rows", done);
        self.evidence.insert(Kind::SharedRows, format!("those of {}", shared.with));
    }

    /// Its locations are those of another unit.
    fn is_in_other_unit(&mut self, factor: f64, stops: usize) {
        self.found(Kind::OtherUnit, Figure { value: factor, sd: 0.0 }, "", Done::Refused);
        self.evidence.insert(
            Kind::OtherUnit,
            format!("{stops} of its stops are described ones once locations are divided by it"),
        );
    }

    /// The train answers otherwise to its effort than in the other runs.
    fn answers_otherwise(&mut self, figure: Figure) {
        self.found(Kind::EffortUnlike, figure, "", Done::LeftOut);
        let evidence = match figure.value {
            0.0 => "the column stands still".to_owned(),
            value if value > 0.0 => format!("as of a column that reads {:.2} of the effort", 1.0 / value),
            _ => "as of a column with the sign turned".to_owned(),
        };
        self.evidence.insert(Kind::EffortUnlike, evidence);
    }

    /// The train brakes with efforts above zero, in so many of its windows of braking.
    fn brakes_without_sign(&mut self, [against, all]: [usize; 2]) {
        let figure = Figure { value: 100.0 * against as f64 / all as f64, sd: 0.0 };
        self.found(Kind::UnsignedBrake, figure, "%", Done::LeftOut);
        self.evidence
            .insert(Kind::UnsignedBrake, format!("in {against} of {all} windows of 10 s, unlike in other runs"));
    }

    /// Its wheel changes on the way.
    fn changes(&mut self, change: &wheel_change::Change, rows: &[Sample], done: Done) {
        let (at_m, line) = change.place(rows);
        self.findings.push(Finding { kind: Kind::WheelChange, figure: change.ratio, unit: "", count: 1, line, done });
        let place = at_m.map_or_else(String::new, |at_m| format!("near km {:.1}, ", at_m / 1000.0));
        self.evidence.insert(Kind::WheelChange, format!("{place}{:.0} s", change.time_s));
    }

    /// Its locations are not on the chainage of the others.
    fn is_off(&mut self, off: chainage::Off) {
        let kind = if off.is_turned { Kind::TurnedChainage } else { Kind::OtherChainage };
        let done = if off.is_decided { Done::Refused } else { Done::Said };
        self.found(kind, off.figure, "m", done);
        self.evidence.insert(kind, off.evidence);
    }

    /// A finding of this run as a sentence, with its evidence.
    pub fn said(&self, finding: &Finding) -> String {
        with_evidence(finding, &self.evidence)
    }

    /// What held the run up, in words; none where nothing did.
    pub fn perturbed(&self) -> Option<String> {
        let words: Vec<String> = self.perturbations.iter().map(ToString::to_string).collect();
        (!words.is_empty()).then(|| words.join("; "))
    }
}

fn with_evidence(finding: &Finding, evidence: &BTreeMap<Kind, String>) -> String {
    match evidence.get(&finding.kind) {
        Some(evidence) => format!("{finding} ({evidence})"),
        None => finding.to_string(),
    }
}

/// A scale that matters: a wheel wears by 10 % over its life, and 0.3 % is less than what platforms and lines are off by.
const LEAST_SCALE: f64 = 0.003;
/// A log that has more of its rows in common with another one teaches the same again.
const MOST_SHARED: f64 = 0.8;
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
    /// Locations are moved to the age of the speed, and efforts that are not the train's are left out. Not for a model that asks for lag and efforts itself.
    pub moves_locations: bool,
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
    let mut runs: Vec<RunCheck> = Vec::new();
    let mut agreements: Vec<Option<OfSpeed>> = Vec::new();
    for recording in recordings.iter_mut() {
        let (run, agreement) = match seen.earlier(recording) {
            Some(earlier) => (copy_of(recording, earlier), None),
            None => {
                let shared = seen.shared(recording);
                let (mut run, agreement) = of_run(recording);
                shared.into_iter().for_each(|shared| run.shares(&shared));
                (run, agreement)
            }
        };
        runs.push(run);
        agreements.push(agreement);
    }
    let described_m = if known.scale { &[] } else { known.stops_m.as_slice() };
    let mut stops: Vec<Option<line_scale::RunStops>> = Vec::new();
    for (run, recording) in runs.iter_mut().zip(recordings.iter()) {
        let of_run = run.refusal().is_none().then(|| line_scale::of_run(recording, described_m)).flatten();
        if let Some((factor, stops)) = of_run.as_ref().and_then(|of_run| of_run.other_unit(described_m)) {
            run.is_in_other_unit(factor, stops);
        }
        stops.push(of_run);
    }
    let mut units: Vec<String> = Vec::new();
    for run in &runs {
        if !units.contains(&run.unit) {
            units.push(run.unit.clone());
        }
    }
    let of_unit = |unit: String| {
        let usable: Vec<usize> =
            (0..runs.len()).filter(|i| runs[*i].unit == unit && runs[*i].refusal().is_none()).collect();
        let scaled = line_scale::put_right(recordings, &usable, &stops, described_m);
        if scaled.is_some() {
            usable.iter().for_each(|i| agreements[*i] = OfSpeed::of(&recordings[*i].rows, runs[*i].step_s));
        }
        let mut recorder = recorder::of(unit, recordings, &mut runs, &agreements, known);
        if let Some(scaled) = scaled {
            recorder.found(Kind::LocationScale, scaled.scale, "", Done::PutRight);
            recorder.evidence.insert(Kind::LocationScale, scaled.evidence());
        }
        // First the single runs: one in another unit spoils what all say together.
        recorder.held_efforts(recordings, &runs);
        recorder.unlike_efforts(recordings, &mut runs);
        recorder.exceeds(recordings, &runs, known);
        recorder.unfit_efforts(recordings, &runs);
        recorder.effort_zero(recordings, &runs);
        recorder.smoothed_speeds(recordings, &runs);
        recorder.effort_age(recordings, &runs, known);
        recorder
    };
    let recorders = units.into_iter().map(of_unit).collect();
    let is_usable = |runs: &[RunCheck]| runs.iter().map(|run| run.refusal().is_none()).collect::<Vec<bool>>();
    let chainages = chainage::find(recordings, &is_usable(&runs), &known.stops_m);
    for (run, off) in runs.iter_mut().zip(chainages) {
        off.into_iter().for_each(|off| run.is_off(off));
    }
    // Of what drove at unknown speeds nobody knows whether it was held up.
    let has_speeds = |rows: &[Sample]| 2 * rows.iter().filter(|row| row.speed_mps.is_some()).count() > rows.len();
    let readable = is_usable(&runs).into_iter().zip(recordings.iter()).map(|(is, one)| is && has_speeds(&one.rows));
    let compared = perturbed::find(recordings, &readable.collect::<Vec<bool>>(), &known.stops_m);
    for ((run, recording), perturbations) in runs.iter_mut().zip(recordings).zip(compared.runs) {
        run.perturbations = perturbations;
        recording.perturbed = run.perturbed();
    }
    Check { recorders, runs, not_compared: compared.not_compared, gradients: None }
}

/// A log that holds the same rows as an earlier one is not looked at further.
fn copy_of(recording: &Recording, earlier: &str) -> RunCheck {
    let rows = recording.rows.len();
    let figure = Figure { value: rows as f64, sd: 0.0 };
    let (kind, done) = (Kind::SameRows, Done::Refused);
    let finding = Finding { kind, figure, unit: "rows", count: 1, line: 0, done };
    let evidence = BTreeMap::from([(kind, format!("those of {earlier}"))]);
    RunCheck { evidence, ..RunCheck::of(recording, clock::usual_step_s(&recording.rows), vec![finding]) }
}

fn is_usable(findings: &[Finding]) -> bool {
    findings.iter().all(|finding| finding.done != Done::Refused)
}

/// What speed and location of a run say.
#[derive(Clone)]
pub(crate) struct OfSpeed {
    agreement: Agreement,
    change: Option<wheel_change::Change>,
}

fn of_run(recording: &mut Recording) -> (RunCheck, Option<OfSpeed>) {
    let mut findings = Vec::new();
    let rows = &mut recording.rows;
    clock::sort(rows, &mut findings);
    clock::coarse(rows, &mut findings);
    clock::put_right(rows, &mut findings);
    interpolated::leave_out(rows, &mut findings);
    // In another unit readings may be beyond what any train has.
    if is_usable(&findings) {
        other_unit(rows, &mut findings);
    }
    readings::impossible(rows, &mut findings);
    readings::missing(rows, &mut findings);
    if is_usable(&findings) {
        readings::speed_spikes(rows, &mut findings);
        places::stuck_locations(rows, &mut findings);
        places::spikes(rows, &mut findings);
        places::join(rows, &mut findings);
        // Only beside locations that are right is a speed known to stand still.
        places::stuck_speeds(rows, &mut findings);
        places::two_directions(rows, &mut findings);
    }
    clock::gaps(rows, &mut findings);
    let step_s = clock::usual_step_s(rows);
    let of_speed = if is_usable(&findings) { OfSpeed::of(rows, step_s) } else { None };
    let location_noise_m = of_speed.as_ref().map(|found| found.agreement.location_noise_m);
    (RunCheck { location_noise_m, ..RunCheck::of(recording, step_s, findings) }, of_speed)
}

/// With rows farther apart a train that starts or brakes between two of them runs another way than the mean of both speeds says, s.
const MOST_STEP_S: f64 = 15.0;

impl OfSpeed {
    fn of(rows: &[Sample], step_s: f64) -> Option<Self> {
        if step_s > MOST_STEP_S {
            return None;
        }
        let compared = Compared::fitted(differences(rows, step_s))?;
        Some(Self { agreement: compared.agreement(), change: wheel_change::within(&compared) })
    }
}

fn differences(rows: &[Sample], step_s: f64) -> Differences {
    let parts = parts(rows, step_s);
    Differences::of(&parts.iter().map(Vec::as_slice).collect::<Vec<_>>())
}

/// Rows with time, location and speed, the location growing, cut where the time or the location does not go on as usual.
///
/// `step_s`: usual time between rows, s.
pub fn parts(rows: &[Sample], step_s: f64) -> Vec<Vec<Row>> {
    let sign = places::heading(rows);
    let longest_s = (3.5 * step_s).max(10.0);
    let mut parts: Vec<Vec<Row>> = vec![Vec::new()];
    for row in rows {
        let (Some(location_m), Some(speed_mps)) = (row.location_m, row.speed_mps) else {
            continue;
        };
        let row = Row { time_s: row.time_s, location_m: sign * location_m, speed_mps };
        let last = parts.last().and_then(|part| part.last()).copied();
        if let Some(last) = last {
            let dt = row.time_s - last.time_s;
            if dt <= 0.0 {
                continue;
            }
            let jump_m = row.location_m - last.location_m - 0.5 * dt * (row.speed_mps + last.speed_mps);
            if dt > longest_s || jump_m.abs() > 300.0 {
                parts.push(Vec::new());
            }
        }
        if let Some(part) = parts.last_mut() {
            part.push(row);
        }
    }
    parts
}

/// Distance by location over distance by speed far from 1, in the whole log or from a line on: the run is not used. Wild speeds are no matter of units.
fn other_unit(rows: &[Sample], findings: &mut Vec<Finding>) {
    let mut calm = rows.to_vec();
    readings::speed_spikes(&mut calm, &mut Vec::new());
    if let Some((value, line)) = units::far(&calm) {
        let figure = Figure { value, sd: 0.0 };
        findings.push(Finding { kind: Kind::OtherUnit, figure, unit: "", count: 1, line, done: Done::Refused });
    }
}
