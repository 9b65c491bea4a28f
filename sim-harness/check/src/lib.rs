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
//! use rundown::model::direction::Direction;
//!
//! // Half a quantum is lost in each reading of a run between 5 and 35 m/s.
//! let row = |i: u32| {
//!     let t = f64::from(i);
//!     let (speed, location_m) = (20.0 - 15.0 * (t / 200.0).cos(), 20.0 * t - 3000.0 * (t / 200.0).sin());
//!     Sample { time_s: t, location_m: Some(location_m), speed_mps: Some((3.6 * speed).floor() / 3.6), ..Sample::default() }
//! };
//! let mut recordings = [Recording {
//!     name: "run".into(), path: "run.csv".into(), unit: String::new(), driver: String::new(), direction: Direction::Up,
//!     day: None, rows: (0..3000).map(row).collect(), perturbed: None, warnings: vec![],
//! }];
//! let found = check(&mut recordings);
//! assert!(found.recorders[0].findings.iter().any(|finding| finding.kind == Kind::TruncatedSpeed));
//! assert!((3.6 * recordings[0].rows[500].speed_mps.unwrap() % 1.0 - 0.5).abs() < 1e-6); // put right: the middle of its step
//! ```
#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod agreement;
pub mod clock;
pub mod finding;
pub mod gradients;
pub mod lost_seconds;
pub mod own;
pub mod perturbed;
pub mod places;
pub mod readings;
pub mod steps;

use agreement::{Agreement, Figure, Pooled, Row, agreement, pooled, spread};
use finding::{Done, Finding, Kind};
use nalgebra::Vector2;
use perturbed::Perturbation;
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;
use rundown_files::units;
use serde::Serialize;

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
    /// What was put right in its speeds.
    pub correction: Correction,
    /// What was found.
    pub findings: Vec<Finding>,
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
#[derive(Clone, Debug, Serialize)]
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
                matches!(finding.kind, Kind::Reset | Kind::Skew | Kind::SpeedOffset | Kind::MissingReadings)
            }
        };
        let of_recorder = self.recorders.iter().flat_map(|recorder| {
            let name = if recorder.unit.is_empty() { "all runs" } else { &recorder.unit };
            recorder.findings.iter().filter(spoils).map(move |finding| format!("{name}: {finding}"))
        });
        let mut notes: Vec<String> = of_recorder.collect();
        let usable = self.runs.iter().filter(|run| run.refusal().is_none());
        let of_run = usable
            .flat_map(|run| run.findings.iter().filter(spoils).map(move |finding| format!("{}: {finding}", run.name)));
        let of_run: Vec<String> = of_run.collect();
        let more = of_run.len().saturating_sub(NOTED);
        notes.extend(of_run.into_iter().take(NOTED));
        if more > 0 {
            notes.push(format!("{more} more findings of single runs, all by `rundown check`"));
        }
        notes
    }
}

impl RunCheck {
    /// Why the run is not to be used.
    pub fn refusal(&self) -> Option<&Finding> {
        self.findings.iter().find(|finding| finding.done == Done::Refused)
    }

    /// What held the run up, in words; none where nothing did.
    pub fn perturbed(&self) -> Option<String> {
        let words: Vec<String> = self.perturbations.iter().map(ToString::to_string).collect();
        (!words.is_empty()).then(|| words.join("; "))
    }
}

/// A scale that matters: a wheel wears by 10 % over its life, and 0.3 % is less than what platforms and lines are off by.
const LEAST_SCALE: f64 = 0.003;
/// So many standard deviations are beyond doubt where something is put right.
const SURE: f64 = 4.0;
/// A smaller skew is not named, s.
const LEAST_SKEW_S: f64 = 0.3;
/// Share of the step by which the offset of a truncating recorder may miss the half of it.
const NEAR_HALF: f64 = 0.12;
/// One of two offsets is decided where it is nearer than this share of the distance to the other.
const CLEARLY: f64 = 0.5;

/// What is known already: of the recorder, where it is put right elsewhere, and of the line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Known {
    /// It truncates: the configuration says so.
    pub truncates: bool,
    /// Its scale: an effect of the model says so.
    pub scale: bool,
    /// Where the track describes stops, m.
    pub stops_m: Vec<f64>,
    /// Locations are moved to the age of the speed. Not for a model that asks for the lag itself.
    pub moves_locations: bool,
}

/// Diagnoses runs and puts right what is beyond doubt.
pub fn check(recordings: &mut [Recording]) -> Check {
    check_beside(recordings, &Known::default())
}

/// The same, but for what is put right elsewhere.
pub fn check_beside(recordings: &mut [Recording], known: &Known) -> Check {
    let mut runs: Vec<RunCheck> = Vec::new();
    let mut agreements: Vec<Option<Agreement>> = Vec::new();
    for recording in recordings.iter_mut() {
        let (run, agreement) = of_run(recording);
        runs.push(run);
        agreements.push(agreement);
    }
    let mut units: Vec<String> = Vec::new();
    for run in &runs {
        if !units.contains(&run.unit) {
            units.push(run.unit.clone());
        }
    }
    let mut recorders = Vec::new();
    for unit in units {
        let of_unit: Vec<usize> = (0..runs.len()).filter(|i| runs[*i].unit == unit).collect();
        if lost_seconds::put_right(&of_unit, recordings, &mut runs) {
            for i in &of_unit {
                agreements[*i] = agreements[*i].and_then(|_| agreement_of(&recordings[*i].rows, runs[*i].step_s));
            }
        }
        recorders.push(of_recorder(unit, &of_unit, recordings, &mut runs, &agreements, known));
    }
    let is_usable: Vec<bool> = runs.iter().map(|run| run.refusal().is_none()).collect();
    let compared = perturbed::find(recordings, &is_usable, &known.stops_m);
    for ((run, recording), perturbations) in runs.iter_mut().zip(recordings).zip(compared.runs) {
        run.perturbations = perturbations;
        recording.perturbed = run.perturbed();
    }
    Check { recorders, runs, not_compared: compared.not_compared, gradients: None }
}

fn of_run(recording: &mut Recording) -> (RunCheck, Option<Agreement>) {
    let mut findings = Vec::new();
    let rows = &mut recording.rows;
    clock::put_right(rows, &mut findings);
    // In another unit readings may be beyond what any train has.
    other_unit(rows, &mut findings);
    readings::impossible(rows, &mut findings);
    readings::missing(rows, &mut findings);
    let is_usable = |findings: &[Finding]| findings.iter().all(|finding| finding.done != Done::Refused);
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
    let agreement = if is_usable(&findings) { agreement_of(rows, step_s) } else { None };
    let run = RunCheck {
        name: recording.name.clone(),
        unit: recording.unit.clone(),
        rows: rows.len(),
        step_s,
        skew_s: None,
        location_noise_m: agreement.map(|agreement| agreement.location_noise_m),
        scale: None,
        findings,
        perturbations: Vec::new(),
    };
    (run, agreement)
}

fn agreement_of(rows: &[Sample], step_s: f64) -> Option<Agreement> {
    agreement(&parts(rows, step_s).iter().map(Vec::as_slice).collect::<Vec<_>>())
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

/// Distance by location over distance by speed far from 1: the run is not used.
fn other_unit(rows: &[Sample], findings: &mut Vec<Finding>) {
    if let Some(value) = units::far_ratio(rows) {
        let figure = Figure { value, sd: 0.0 };
        findings.push(Finding { kind: Kind::OtherUnit, figure, unit: "", count: 1, line: 0, done: Done::Refused });
    }
}

/// How the speeds are shown.
#[derive(Clone, Copy, PartialEq)]
enum Shown {
    Exact,
    Rounded,
    Truncated,
    NotKnown,
}

fn shown(step_kmh: Option<f64>, offset_kmh: Figure) -> Shown {
    let Some(step_kmh) = step_kmh else {
        return Shown::Exact;
    };
    let off = |value: f64| (offset_kmh.value - value).abs();
    let near = |value: f64| off(value) < 2.0 * offset_kmh.sd + NEAR_HALF * step_kmh;
    let (rounded, truncated) = (0.0, 0.5 * step_kmh);
    match (near(rounded), near(truncated)) {
        (true, false) if off(rounded) < CLEARLY * off(truncated) => Shown::Rounded,
        (false, true) if off(truncated) < CLEARLY * off(rounded) => Shown::Truncated,
        _ => Shown::NotKnown,
    }
}

fn of_recorder(
    unit: String,
    of_unit: &[usize],
    recordings: &mut [Recording],
    runs: &mut [RunCheck],
    agreements: &[Option<Agreement>],
    known: &Known,
) -> RecorderCheck {
    let rows = || of_unit.iter().flat_map(|i| &recordings[*i].rows);
    let speed_step_kmh = steps::of_speed_kmh(rows());
    let location_step_m = steps::of_location_m(rows());
    let step_kmh = speed_step_kmh.unwrap_or(0.0);
    let rounded = |i: usize| {
        let held_mps = steps::held_mps(&recordings[i].rows, step_kmh);
        Some(agreements[i]?.with_rounding(steps::rounding_mps(step_kmh), held_mps, runs[i].step_s))
    };
    let agreements: Vec<Option<Agreement>> = of_unit.iter().map(|i| rounded(*i)).collect();
    let compared: Vec<Agreement> = agreements.iter().flatten().copied().collect();
    let mut recorder = RecorderCheck {
        unit,
        compared: compared.len(),
        runs: of_unit.len(),
        speed_step_kmh,
        location_step_m,
        scale: None,
        is_wheel: false,
        offset_kmh: None,
        skew_s: None,
        skew_spread_s: None,
        correction: Correction::NONE,
        findings: Vec::new(),
    };
    let Some(all) = pooled(&compared) else {
        return recorder;
    };
    let values = recorder.decide(&all, known);
    for (i, agreement) in of_unit.iter().zip(&agreements) {
        if let Some(agreement) = agreement {
            own::judged(&mut runs[*i], agreement, values);
        }
    }
    recorder.skews(runs, known);
    for (i, agreement) in of_unit.iter().copied().zip(&agreements) {
        own::of(&recorder, &mut runs[i], agreement.as_ref(), known).put_right(&mut recordings[i].rows);
    }
    recorder
}

fn put_right(here: bool) -> Done {
    if here { Done::PutRight } else { Done::Said }
}

impl RecorderCheck {
    /// True less read speed as the step decides it: half of it where the recorder truncates, 0 where it rounds; else as measured. In km/h.
    pub fn decided_offset_kmh(&self) -> Option<f64> {
        let has = |kind| self.findings.iter().any(|finding| finding.kind == kind);
        match (has(Kind::RoundedSpeed), has(Kind::TruncatedSpeed)) {
            (true, _) => Some(0.0),
            (_, true) => self.speed_step_kmh.map(|step_kmh| 0.5 * step_kmh),
            _ => self.offset_kmh.map(|offset| offset.value),
        }
    }

    /// Decides how the speed is shown, then the scale with what that says. Out: 1/s - 1 and o/s, m/s, as the skews are judged with.
    fn decide(&mut self, all: &Pooled, known: &Known) -> Vector2<f64> {
        let offset_kmh = all.offset_kmh();
        self.offset_kmh = Some(offset_kmh);
        let step_kmh = self.speed_step_kmh.unwrap_or(0.0);
        let shown = shown(self.speed_step_kmh, offset_kmh);
        let (kind, done) = match shown {
            Shown::Exact => (None, Done::Said),
            Shown::Rounded => (Some(Kind::RoundedSpeed), Done::Said),
            Shown::Truncated => (Some(Kind::TruncatedSpeed), put_right(!known.truncates)),
            Shown::NotKnown => (Some(Kind::SteppedSpeed), Done::Said),
        };
        if let Some(kind) = kind {
            self.said(kind, Figure { value: step_kmh, sd: 0.0 }, "km/h", done);
        }
        let offset_mps = if shown == Shown::Truncated { 0.5 * step_kmh / 3.6 } else { 0.0 };
        // The offset of a step is 0 or a half of it: what is decided is known, and leaves the scale sharper.
        let decided = matches!(shown, Shown::Rounded | Shown::Truncated);
        let scale = if decided { all.scale_at(offset_mps) } else { all.scale() };
        self.scale = Some(scale);
        let odd = !decided && offset_kmh.away_from(0.0) > SURE && offset_kmh.value.abs() > 0.1_f64.max(0.6 * step_kmh);
        if odd {
            self.said(Kind::SpeedOffset, offset_kmh, "km/h", Done::Said);
        }
        let matters = (scale.value - 1.0).abs() > LEAST_SCALE && scale.away_from(1.0) > SURE;
        // No recorder has such an offset: the model does not fit, and its scale is no wheel.
        self.is_wheel = matters && !odd;
        if matters {
            self.said(Kind::SpeedScale, scale, "", put_right(!known.scale && self.is_wheel));
        }
        self.correction = Correction {
            offset_mps: if known.truncates { 0.0 } else { offset_mps },
            scale: if self.is_wheel && !known.scale { scale.value } else { 1.0 },
        };
        Vector2::new(1.0 / scale.value - 1.0, if decided { offset_mps } else { all.values[1] })
    }

    fn said(&mut self, kind: Kind, figure: Figure, unit: &'static str, done: Done) {
        self.findings.push(Finding { kind, figure, unit, count: 1, line: 0, done });
    }

    /// The usual skew, and how much it differs from run to run.
    fn skews(&mut self, runs: &[RunCheck], known: &Known) {
        let usable = runs.iter().filter(|run| run.unit == self.unit && run.refusal().is_none());
        let mut skews: Vec<Figure> = usable.filter_map(|run| run.skew_s).collect();
        skews.sort_by(|a, b| a.value.total_cmp(&b.value));
        let Some(middle) = skews.get(skews.len() / 2).copied() else {
            return;
        };
        let off: Vec<f64> = skews.iter().map(|skew| skew.value - middle.value).collect();
        let spread_s = spread(&off);
        let n = (skews.len() as f64).sqrt();
        let skew_s = Figure { value: middle.value, sd: (1.2533 * spread_s / n).max(middle.sd / n) };
        (self.skew_s, self.skew_spread_s) = (Some(skew_s), Some(spread_s));
        // Few runs that differ leave their median uncertain, and each may be beyond doubt by itself.
        let late = |sign: f64| {
            let beyond = |skew: &&Figure| sign * skew.value > LEAST_SKEW_S.max(SURE * skew.sd);
            2 * skews.iter().filter(beyond).count() > skews.len()
        };
        let usual = skew_s.value.abs() > LEAST_SKEW_S && skew_s.away_from(0.0) > SURE;
        if usual || (skews.len() > 1 && (late(1.0) || late(-1.0))) {
            self.said(Kind::Skew, skew_s, "s", put_right(known.moves_locations));
        }
    }
}
