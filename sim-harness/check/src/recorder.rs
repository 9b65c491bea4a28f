//! What all runs of one recorder say together: how the speed is shown, its scale, its age; what it leaves out and holds; what the runs exceed.

use crate::agreement::{Agreement, Figure, Pooled, pooled};
use crate::finding::{Done, Finding, Kind};
use crate::own::Grown;
use crate::wheel_change::OfRun;
use crate::{Correction, Known, LEAST_SCALE, OfSpeed, RecorderCheck, RunCheck, SURE};
use crate::{
    dead_zone, effort, effort_age, effort_held, effort_unlike, effort_zero, held, limits, lost_seconds, own, put_right,
    smoothed, steps, wheel_change, with_evidence,
};
use nalgebra::{Matrix2, Vector2};
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;
use rundown_files::statistics::spread;
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// A smaller skew is not named, s.
const LEAST_SKEW_S: f64 = 0.3;
/// A younger effort is what the estimator learns of its column, s ...
const LEAST_AGE_S: f64 = 1.5;
/// ... and with rows farther apart it cannot be moved, s.
const MOVED_STEP_S: f64 = 2.0;
/// Larger steps of an effort are left out, N/kg: half of one is a fifth of the resistance of a train at 100 km/h, and stays while the speed is held. Simulated
/// fleets learn with steps of 0.01 as with none, and with 0.02 and more worse than from coasts alone.
const LARGEST_EFFORT_STEP_N_PER_KG: f64 = 0.0125;
/// Runs that the age of the effort is asked of.
const AGED: usize = 12;
/// Share of the step by which the offset of a truncating recorder may miss the half of it.
const NEAR_HALF: f64 = 0.12;
/// One of two offsets is decided where it is nearer than this share of the distance to the other.
const CLEARLY: f64 = 0.5;

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

/// A scale beside an offset that is 0 or half a step, and not known which: half of what that makes is a doubt of the scale.
fn between(scale: Figure, [rounded, truncated]: [Figure; 2]) -> Figure {
    Figure { sd: scale.sd.hypot(0.5 * (truncated.value - rounded.value)), ..scale }
}

/// Judges the recorder of these runs, and puts right what is beyond doubt.
pub(crate) fn of(
    unit: String,
    recordings: &mut [Recording],
    runs: &mut [RunCheck],
    of_speeds: &[Option<OfSpeed>],
    known: &Known,
) -> RecorderCheck {
    let of_unit: Vec<usize> = (0..runs.len()).filter(|i| runs[*i].unit == unit).collect();
    let sought = lost_seconds::put_right(&of_unit, recordings, runs);
    // Readings in another unit have another step.
    let of_usable = || of_unit.iter().filter(|i| runs[**i].refusal().is_none());
    let rows = || of_usable().flat_map(|i| &recordings[*i].rows);
    let speed_step_kmh = steps::of_speed_kmh(rows());
    let location_step_m = steps::of_location_m(rows());
    let step_kmh = speed_step_kmh.unwrap_or(0.0);
    let mut judged = |i: &usize| {
        let mut of_speed = of_speeds[*i].clone()?;
        if sought.moved {
            of_speed = OfSpeed::of(&recordings[*i].rows, runs[*i].step_s)?;
        }
        of_one(of_speed, &recordings[*i].rows, &mut runs[*i], step_kmh, known)
    };
    let (mut agreements, mut grown): (Vec<Option<Agreement>>, Vec<Grown>) =
        of_unit.iter().map(|i| judged(i).map_or((None, Grown::NOT), |(one, grown)| (Some(one), grown))).unzip();
    let compared: Vec<Agreement> = agreements.iter().flatten().cloned().collect();
    let mut recorder = RecorderCheck {
        unit,
        compared: compared.len(),
        runs: of_unit.len(),
        speed_step_kmh,
        location_step_m,
        effort_step_n_per_kg: None,
        scale: None,
        is_wheel: false,
        offset_kmh: None,
        skew_s: None,
        skew_spread_s: None,
        lost_second_sd_s: sought.step_sd_s,
        correction: Correction::NONE,
        findings: Vec::new(),
        evidence: BTreeMap::new(),
    };
    let is_usable = |run: &RunCheck| run.refusal().is_none();
    let usable: Vec<usize> = of_unit.iter().copied().filter(|i| is_usable(&runs[*i])).collect();
    recorder.dead_zone(recordings, &usable);
    recorder.held_speeds(recordings, &usable);
    let Some(mut all) = pooled(&compared) else {
        return recorder;
    };
    if let Some((after, ratio)) = recorder.changes(&agreements, &of_unit, recordings, known, &all) {
        for at in after {
            agreements[at] = agreements[at].take().map(|agreement| agreement.rescaled(ratio));
            grown[at].all = ratio;
        }
        all = pooled(&agreements.iter().flatten().cloned().collect::<Vec<_>>()).unwrap_or(all);
    }
    let values = recorder.decide(&all, known);
    let of_runs = || of_unit.iter().copied().zip(agreements.iter().zip(&grown));
    for (i, (agreement, grown)) in of_runs() {
        if let Some(agreement) = agreement {
            own::judged(&mut runs[i], (agreement, grown.all), &values);
        }
    }
    recorder.skews(runs, known);
    for (i, (agreement, grown)) in of_runs() {
        let own = own::of(&recorder, &mut runs[i], (agreement.as_ref(), *grown), known);
        own.put_right(&mut recordings[i].rows);
    }
    recorder
}

/// What a run says with the rounding of its speeds, brought to its first scale where its wheel changes.
fn of_one(
    mut of_speed: OfSpeed,
    rows: &[Sample],
    run: &mut RunCheck,
    step_kmh: f64,
    known: &Known,
) -> Option<(Agreement, Grown)> {
    let rounding_mps = steps::rounding_mps(step_kmh);
    let mut grown = Grown::NOT;
    if let Some(change) = of_speed.change.and_then(|change| change.sure(rounding_mps)) {
        run.changes(&change, rows, put_right(!known.scale));
        grown.after = Some((change.time_s, change.ratio.value));
        let mut undone = rows.to_vec();
        grown.undo(&mut undone);
        of_speed = OfSpeed::of(&undone, run.step_s)?;
    }
    Some((of_speed.agreement.with_rounding(rounding_mps, run.step_s), grown))
}

impl RecorderCheck {
    /// A finding of this recorder as a sentence, with its evidence.
    pub fn said(&self, finding: &Finding) -> String {
        with_evidence(finding, &self.evidence)
    }

    /// True less read speed as the step decides it: half of it where the recorder truncates, 0 where it rounds; else as measured. In km/h.
    pub fn decided_offset_kmh(&self) -> Option<f64> {
        match (self.has(Kind::RoundedSpeed), self.has(Kind::TruncatedSpeed)) {
            (true, _) => Some(0.0),
            (_, true) => self.speed_step_kmh.map(|step_kmh| 0.5 * step_kmh),
            _ => self.offset_kmh.map(|offset| offset.value),
        }
    }

    /// Asks whether the wheel changes from one run on, in the order of their days. Out: the places of the runs after it, and their scale over that before.
    fn changes(
        &mut self,
        agreements: &[Option<Agreement>],
        of_unit: &[usize],
        recordings: &[Recording],
        known: &Known,
        all: &Pooled,
    ) -> Option<(Vec<usize>, f64)> {
        let mut order: Vec<usize> = (0..of_unit.len()).filter(|at| agreements[*at].is_some()).collect();
        let day = |at: usize| recordings[of_unit[at]].day;
        if order.iter().all(|at| day(*at).is_some()) {
            order.sort_by(|a, b| day(*a).partial_cmp(&day(*b)).unwrap_or(Ordering::Equal));
        }
        let step_kmh = self.speed_step_kmh.unwrap_or(0.0);
        let (offset_mps, offset_is_free) = match shown(self.speed_step_kmh, all.offset_kmh()) {
            Shown::Rounded => (0.0, false),
            Shown::Truncated => (0.5 * step_kmh / 3.6, false),
            Shown::Exact | Shown::NotKnown => (all.values[1], true),
        };
        let of_run = |at: &usize| OfRun::at(agreements[*at].as_ref()?, offset_mps);
        let (mut order, of_runs): (Vec<usize>, Vec<OfRun>) =
            order.into_iter().filter_map(|at| Some((at, of_run(&at)?))).unzip();
        // Nobody turns a wheel between two runs of a day.
        let date = |from: usize| day(order[from]).map(f64::floor);
        let may_change = |from: usize| date(from).is_none() || date(from) != date(from - 1);
        let found = wheel_change::between(&of_runs, may_change)?;
        let after = order.split_off(found.from);
        let named = &recordings[of_unit[after[0]]].name;
        // A step's offset is that of the recorder. Where nothing decides it, it may change as the scale may.
        if offset_is_free {
            let of_side =
                |side: &[usize]| pooled(&side.iter().filter_map(|at| agreements[*at].clone()).collect::<Vec<_>>());
            let [before, since] = [of_side(&order)?, of_side(&after)?];
            if !wheel_change::is_wheel(&before, &since) {
                if let Some(offset_kmh) = wheel_change::other_offset_kmh(&before, &since) {
                    self.found(Kind::SpeedOffset, offset_kmh, "km/h", Done::Said);
                    let first = before.offset_kmh().with_interval(2);
                    let text =
                        format!("from {named} on, {first} before: no wheel, but speeds that are found otherwise");
                    self.evidence.insert(Kind::SpeedOffset, text);
                }
                return None;
            }
        }
        self.found(Kind::WheelChange, found.ratio(), "", put_right(!known.scale));
        let [first, since] = found.sides.map(|side| side.with_interval(4));
        let (runs, before) = (after.len(), order.len());
        let text = format!("from {named} on: {since} in {runs} runs, {first} in {before} before");
        self.evidence.insert(Kind::WheelChange, text);
        Some((after, found.ratio().value))
    }

    /// Decides how the speed is shown, then the scale with what that says. Out: 1/s - 1 and o/s, m/s, with their covariance, as the skews are judged with.
    fn decide(&mut self, all: &Pooled, known: &Known) -> (Vector2<f64>, Matrix2<f64>) {
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
            self.found(kind, Figure { value: step_kmh, sd: 0.0 }, "km/h", done);
        }
        let offset_mps = if shown == Shown::Truncated { 0.5 * step_kmh / 3.6 } else { 0.0 };
        // The offset of a step is 0 or a half of it: what is decided is known, and leaves the scale sharper.
        let decided = matches!(shown, Shown::Rounded | Shown::Truncated);
        let scale = match shown {
            Shown::Rounded | Shown::Truncated => all.scale_at(offset_mps),
            Shown::Exact => all.scale(),
            Shown::NotKnown => between(all.scale(), [0.0, 0.5 * step_kmh / 3.6].map(|offset| all.scale_at(offset))),
        };
        self.scale = Some(scale);
        let odd = !decided && offset_kmh.away_from(0.0) > SURE && offset_kmh.value.abs() > 0.1_f64.max(0.6 * step_kmh);
        if odd && !self.has(Kind::SpeedOffset) {
            self.found(Kind::SpeedOffset, offset_kmh, "km/h", Done::Said);
        }
        let matters = (scale.value - 1.0).abs() > LEAST_SCALE && scale.away_from(1.0) > SURE;
        // No recorder has such an offset: the model does not fit, and its scale is no wheel.
        self.is_wheel = matters && !odd;
        if matters {
            self.found(Kind::SpeedScale, scale, "", put_right(!known.scale && self.is_wheel));
            if let Some(sd_s) = self.lost_second_sd_s.filter(|_| self.hides_lost_seconds()) {
                let text = format!("seconds that the clock loses may be a part of it: a step is known to {sd_s:.2} s");
                self.evidence.insert(Kind::SpeedScale, text);
            }
        }
        self.correction = Correction {
            offset_mps: if known.truncates { 0.0 } else { offset_mps },
            scale: if self.is_wheel && !known.scale { scale.value } else { 1.0 },
        };
        let values = Vector2::new(1.0 / scale.value - 1.0, if decided { offset_mps } else { all.values[1] });
        let of_scale = Matrix2::from_diagonal(&Vector2::new((scale.sd / scale.value.powi(2)).powi(2), 0.0));
        (values, if decided { of_scale } else { all.covariance })
    }

    /// Leaves out readings of zero that are no standstill. Call it while the speeds are as read.
    fn dead_zone(&mut self, recordings: &mut [Recording], usable: &[usize]) {
        let rows = usable.iter().map(|i| recordings[*i].rows.as_slice());
        let Some(found) = dead_zone::of(rows, self.speed_step_kmh.unwrap_or(0.0)) else {
            return;
        };
        let left_out = usable.iter().map(|i| found.leave_out(&mut recordings[*i].rows));
        let count: usize = left_out.map(|(count, _)| count).sum();
        self.found(Kind::DeadZone, found.threshold_kmh, "km/h", Done::LeftOut);
        let passes = found.passes;
        let text = format!("no reading between 0 and that at {passes} starts and stops; {count} readings of zero");
        self.evidence.insert(Kind::DeadZone, text);
    }

    /// Leaves out speeds that are old ones. Call it while the speeds are as read.
    fn held_speeds(&mut self, recordings: &mut [Recording], usable: &[usize]) {
        let step_mps = self.speed_step_kmh.unwrap_or(0.0) / 3.6;
        let of_runs: Vec<held::Held> = usable.iter().map(|i| held::of(&recordings[*i].rows, step_mps)).collect();
        let Some([rows, asked]) = held::beyond_chance(&of_runs) else {
            return;
        };
        let share = rows as f64 / asked as f64;
        let figure = Figure { value: 100.0 * share, sd: 100.0 * (share * (1.0 - share) / asked as f64).sqrt() };
        self.found(Kind::HeldSpeeds, figure, "% of the rows whose speed changes fast", Done::LeftOut);
        self.evidence.insert(Kind::HeldSpeeds, format!("{rows} of {asked} such rows"));
        for (i, held) in usable.iter().zip(&of_runs) {
            held.rows.iter().for_each(|row| recordings[*i].rows[*row].speed_mps = None);
        }
    }

    /// Says what of the descriptions its runs exceed, and an effort column that is not theirs. Call it when the readings are put right.
    pub(crate) fn exceeds(&mut self, recordings: &[Recording], runs: &[RunCheck], known: &Known) {
        let own = recordings.iter().zip(runs).filter(|(_, run)| self.has_usable(run));
        let own: Vec<&Recording> = own.map(|(recording, _)| recording).collect();
        for limits::Excess { kind, percent: figure, rows: count, evidence } in
            limits::exceeded(own.iter().copied(), &known.limits)
        {
            self.findings.push(Finding { kind, figure, unit: "% of the rows", count, line: 0, done: Done::Said });
            self.evidence.insert(kind, evidence);
        }
        self.effort_step_n_per_kg = steps::of_effort_n_per_kg(own.iter().flat_map(|recording| &recording.rows));
        if let Some(effort::Apart { correlation, evidence, .. }) = effort::apart(own.iter().copied()) {
            let done = if known.moves_locations { Done::LeftOut } else { Done::Said };
            self.found(Kind::EffortApart, correlation, "", done);
            self.evidence.insert(Kind::EffortApart, evidence);
        } else if let Some(step) = self.effort_step_n_per_kg.filter(|step| *step > LARGEST_EFFORT_STEP_N_PER_KG) {
            self.found(Kind::EffortSteps, Figure { value: step, sd: 0.0 }, "N/kg", Done::LeftOut);
        }
    }

    /// Leaves out efforts that do not go with its trains, or have steps too large: nothing may be learned from them.
    pub(crate) fn unfit_efforts(&self, recordings: &mut [Recording], runs: &[RunCheck]) {
        let is_unfit = |kind| matches!(kind, Kind::EffortApart | Kind::EffortSteps);
        if !self.findings.iter().any(|one| is_unfit(one.kind) && one.done == Done::LeftOut) {
            return;
        }
        let own = recordings.iter_mut().zip(runs).filter(|(_, run)| self.has_usable(run));
        own.flat_map(|(recording, _)| &mut recording.rows).for_each(|row| row.effort_n_per_kg = None);
    }

    /// Leaves out efforts that are old ones.
    pub(crate) fn held_efforts(&mut self, recordings: &mut [Recording], runs: &[RunCheck]) {
        let own = self.usable(runs);
        let rows: Vec<&[Sample]> = own.iter().map(|i| recordings[*i].rows.as_slice()).collect();
        let Some(held) = effort_held::of(&rows) else {
            return;
        };
        let figure = Figure { value: held.mean_s, sd: 0.0 };
        let kind = Kind::EffortHeld;
        self.findings.push(Finding { kind, figure, unit: "s", count: held.stretches, line: 0, done: Done::LeftOut });
        let concerned = held.rows.iter().filter(|rows| !rows.is_empty()).count();
        let (stretches, shown) = (held.stretches, held.shown);
        let text = format!("{stretches} times in {concerned} runs; {shown} times the train shows it");
        self.evidence.insert(kind, text);
        for (i, ranges) in own.iter().zip(held.rows) {
            // The first of them was true.
            let old = ranges.into_iter().flat_map(|range| range.skip(1));
            old.for_each(|row| recordings[*i].rows[row].effort_n_per_kg = None);
        }
    }

    /// Leaves out the efforts of runs in which the train answers otherwise to them than in the others.
    pub(crate) fn unlike_efforts(&self, recordings: &mut [Recording], runs: &mut [RunCheck]) {
        let own = self.usable(runs);
        let brakes: Vec<Option<[usize; 2]>> = own.iter().map(|i| effort::brakes(&recordings[*i].rows)).collect();
        let without_sign = |place: &usize| brakes[*place].is_some_and(|[against, all]| 3 * against > 2 * all);
        let odd: Vec<usize> = (0..own.len()).filter(without_sign).collect();
        // Where all runs have it, it is the column that is said to have nothing to do with the train.
        if odd.len() < brakes.iter().flatten().count() {
            for place in odd {
                if let Some(windows) = brakes[place] {
                    runs[own[place]].brakes_without_sign(windows);
                    recordings[own[place]].rows.iter_mut().for_each(|row| row.effort_n_per_kg = None);
                }
            }
        }
        let answers: Vec<Option<Figure>> = own.iter().map(|i| effort_unlike::of_run(&recordings[*i].rows)).collect();
        for (place, figure) in effort_unlike::unlike(&answers) {
            runs[own[place]].answers_otherwise(figure);
            recordings[own[place]].rows.iter_mut().for_each(|row| row.effort_n_per_kg = None);
        }
    }

    /// Makes momentary efforts means over as long as the speeds are.
    pub(crate) fn smoothed_speeds(&mut self, recordings: &mut [Recording], runs: &[RunCheck]) {
        if self.speed_step_kmh.is_some_and(|step| step > smoothed::MOST_STEP_KMH) {
            return;
        }
        let own = self.usable(runs);
        let rows: Vec<&[Sample]> = own.iter().map(|i| recordings[*i].rows.as_slice()).collect();
        let found = smoothed::of(&rows).and_then(|s| Some((s, smoothed::averaged_efforts(&rows, s.value)?)));
        let Some((long_s, efforts)) = found else {
            return;
        };
        let is_short = long_s.value <= smoothed::MOST_S;
        let (done, text) = if is_short {
            (Done::PutRight, "the efforts are averaged over as long, and explain the accelerations better so")
        } else {
            (Done::LeftOut, "the efforts are, for averaged ones explain the accelerations better, and are not enough")
        };
        self.found(Kind::SmoothedSpeed, long_s, "s", done);
        self.evidence.insert(Kind::SmoothedSpeed, text.to_owned());
        for (i, efforts) in own.iter().zip(efforts) {
            let rows = recordings[*i].rows.iter_mut().zip(efforts);
            rows.for_each(|(row, effort)| row.effort_n_per_kg = effort.filter(|_| is_short));
        }
    }

    /// Takes the zero of the effort from trains that stand, and leaves out zeros that are no effort of 0.
    pub(crate) fn effort_zero(&mut self, recordings: &mut [Recording], runs: &[RunCheck]) {
        let own =
            || recordings.iter().zip(runs).filter(|(_, run)| self.has_usable(run)).map(|(recording, _)| recording);
        if self.has(Kind::EffortApart) {
            return;
        }
        let offset = effort_zero::at_standstill(own());
        let zeros = effort_zero::zeros(own());
        let rows = recordings.iter_mut().zip(runs).filter(|(_, run)| self.has_usable(run));
        let rows: Vec<&mut [Sample]> = rows.map(|(recording, _)| recording.rows.as_mut_slice()).collect();
        if let Some((figure, count)) = offset {
            self.found(Kind::EffortOffset, figure, "N/kg", Done::PutRight);
            self.evidence.insert(Kind::EffortOffset, format!("in {count} rows, and so taken from all"));
            let efforts = rows.into_iter().flatten().filter_map(|row| row.effort_n_per_kg.as_mut());
            efforts.for_each(|effort| *effort -= figure.value);
            return;
        }
        let (stretches, what, leave_out): (_, _, fn(&mut [Sample]) -> usize) = if zeros.drop_what_is_small() {
            (zeros.holds, "holds its speed: all efforts of 0", effort_zero::leave_out_zeros)
        } else if zeros.lack_the_brake() {
            (zeros.brakes, "brakes: its efforts while it brakes", effort_zero::leave_out_brakes)
        } else {
            return;
        };
        let count: usize = rows.into_iter().map(leave_out).sum();
        let figure = Figure { value: count as f64, sd: 0.0 };
        let kind = Kind::EffortZeros;
        self.findings.push(Finding { kind, figure, unit: "rows", count: 1, line: 0, done: Done::LeftOut });
        let of = format!("{} of {} stretches in which the train {what}", stretches.with_zeros, stretches.all);
        self.evidence.insert(kind, of);
    }

    /// Says that the effort is older than the speed, and brings it to its age where the rows are near enough in time. Where they are not, an effort that is late
    /// by more than half a row is not what a later tick makes of it, and left out.
    pub(crate) fn effort_age(&mut self, recordings: &mut [Recording], runs: &[RunCheck], known: &Known) {
        let has_effort = |rows: &[Sample]| rows.iter().any(|row| row.effort_n_per_kg.is_some());
        let own = (0..runs.len()).filter(|i| self.has_usable(&runs[*i]) && has_effort(&recordings[*i].rows));
        let own: Vec<usize> = own.collect();
        if own.is_empty() || self.has(Kind::EffortApart) {
            return;
        }
        let asked = own.iter().take(AGED).map(|i| (recordings[*i].rows.as_slice(), runs[*i].step_s));
        let Some(usual) = effort_age::usual(asked) else { return };
        let age_s = usual.age_s;
        if age_s.value.abs() < LEAST_AGE_S || age_s.away_from(0.0) < SURE {
            return;
        }
        let step_s = own.iter().map(|i| runs[*i].step_s).fold(0.0, f64::max);
        let (done, said) = match step_s {
            _ if !known.moves_locations => (Done::Said, "asked for beside its gain".to_owned()),
            ..=MOVED_STEP_S => (Done::PutRight, format!("it differs by {:.1} s from run to run", usual.spread_s)),
            _ if age_s.value.abs() <= 0.5 * step_s => {
                (Done::Said, format!("within half of the {step_s:.0} s of a row"))
            }
            _ => (Done::LeftOut, format!("the efforts; rows are {step_s:.0} s apart, too far to move them")),
        };
        self.found(Kind::EffortLate, age_s, "s", done);
        self.evidence.insert(Kind::EffortLate, said);
        for i in own {
            let rows = &mut recordings[i].rows;
            match done {
                Done::PutRight => effort_age::move_efforts(rows, runs[i].step_s, &usual),
                Done::LeftOut => rows.iter_mut().for_each(|row| row.effort_n_per_kg = None),
                Done::Said | Done::Refused => (),
            }
        }
    }

    /// Whether a run is one of this recorder, and is used.
    fn has_usable(&self, run: &RunCheck) -> bool {
        run.unit == self.unit && run.refusal().is_none()
    }

    /// The places of these.
    fn usable(&self, runs: &[RunCheck]) -> Vec<usize> {
        (0..runs.len()).filter(|i| self.has_usable(&runs[*i])).collect()
    }

    pub(crate) fn has(&self, kind: Kind) -> bool {
        self.findings.iter().any(|finding| finding.kind == kind)
    }

    pub(crate) fn found(&mut self, kind: Kind, figure: Figure, unit: &'static str, done: Done) {
        self.findings.push(Finding { kind, figure, unit, count: 1, line: 0, done });
    }

    /// The usual skew, and how much it differs from run to run.
    fn skews(&mut self, runs: &[RunCheck], known: &Known) {
        let usable = runs.iter().filter(|run| self.has_usable(run));
        let mut skews: Vec<Figure> = usable.filter_map(|run| run.skew_s).collect();
        skews.sort_by(|a, b| a.value.total_cmp(&b.value));
        let Some(middle) = skews.get(skews.len() / 2).copied() else {
            return;
        };
        let spread_s = spread(skews.iter().map(|skew| skew.value - middle.value));
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
            self.found(Kind::Skew, skew_s, "s", put_right(known.moves_locations));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 67 runs of short hops, of which the offset came out in the middle of the two that a step may have: 0.26 km/h of 0 or 0.5.
    #[test]
    fn a_scale_that_an_offset_may_make_is_not_sure() {
        let figure = |value| Figure { value, sd: 5e-4 };
        let scales = [1.0, 1.0064].map(figure);
        assert!(figure(1.0032).away_from(1.0) > SURE);
        assert!(between(figure(1.0032), scales).away_from(1.0) < SURE);
        let wheel = scales.map(|scale| Figure { value: scale.value + 0.02, ..scale });
        assert!(between(figure(1.0232), wheel).away_from(1.0) > SURE);
    }
}
