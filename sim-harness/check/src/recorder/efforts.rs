//! What is the matter with the efforts of a recorder: left out, moved, averaged before anything is learned from them.

use crate::effort::age::Asked;
use crate::effort::coasting::{MovingStretch, effort_of_coasts, moving_stretches};
use crate::effort::gap::Gap;
use crate::effort::zero::{Stretches, Zero};
use crate::figure::Figure;
use crate::finding::{Done, Finding, Kind};
use crate::recorder::diagnosis::RecorderCheck;
use crate::rows::steps;
use crate::run::RunCheck;
use crate::{Known, SURE, effort, limits, read_of, speed};
use rundown::model::line::Line;
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;

/// A younger effort is what the estimator learns of its column, s ...
const LEAST_AGE_S: f64 = 1.5;
/// ... and with rows farther apart it cannot be moved, s.
const MOVED_STEP_S: f64 = 2.0;
/// Larger steps of an effort are left out, N/kg: half of one is a fifth of the resistance of a train at 100 km/h, and
/// stays while the speed is held. Simulated fleets learn with steps of 0.01 as with none, and with 0.02 and more worse
/// than from coasts alone.
const LARGEST_EFFORT_STEP_N_PER_KG: f64 = 0.0125;
/// What else a zero may be that only trains that coast, or only trains that stand, show.
const MAY_ACT: &str = "; motors that drag while coasting, or a brake that holds standing trains, look so";
const DOUBTED: &str = ": r is doubted by as much";
/// Runs that the age of the effort is asked of.
const AGED: usize = 12;

impl RecorderCheck {
    /// Judges the efforts and what is described of the train. Call it when the speeds are put right.
    pub(crate) fn efforts(&mut self, recordings: &mut [Recording], runs: &mut [RunCheck], known: &Known) {
        // What is cut off above looks like what a lever asks for.
        self.cut_efforts(recordings, runs, known);
        self.demanded_efforts(recordings, runs, known);
        // First the single runs: one in another unit spoils what all say together.
        self.held_efforts(recordings, runs);
        self.unlike_efforts(recordings, runs);
        self.exceeds(recordings, runs, known);
        self.unfit_efforts(recordings, runs);
        if !self.has(Kind::EffortApart) {
            let moving = self.zeros_of_runs(recordings, runs, known);
            self.effort_zero(recordings, runs, known, moving);
            self.small_efforts(recordings, runs, known);
        }
        self.trailing_speeds(recordings, runs, known);
        self.smoothed_speeds(recordings, runs, known);
        self.effort_age(recordings, runs, known);
    }

    /// Says what of the descriptions its runs exceed, and an effort column that is not theirs. Call it when the
    /// readings are put right.
    fn exceeds(&mut self, recordings: &[Recording], runs: &[RunCheck], known: &Known) {
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
            self.found_by(Kind::EffortApart, correlation, "", done, evidence);
        } else if let Some(step) = self.effort_step_n_per_kg.filter(|step| *step > LARGEST_EFFORT_STEP_N_PER_KG) {
            self.found(Kind::EffortSteps, Figure { value: step, sd: 0.0 }, "N/kg", Done::LeftOut);
        }
    }

    /// Leaves out efforts that do not go with its trains, or have steps too large: nothing may be learned from them.
    fn unfit_efforts(&self, recordings: &mut [Recording], runs: &[RunCheck]) {
        let is_unfit = |kind| matches!(kind, Kind::EffortApart | Kind::EffortSteps);
        if !self.findings.iter().any(|one| is_unfit(one.kind) && one.done == Done::LeftOut) {
            return;
        }
        let own = recordings.iter_mut().zip(runs).filter(|(_, run)| self.has_usable(run));
        own.for_each(|(recording, _)| without_efforts(&mut recording.rows));
    }

    /// Leaves out efforts at the most that the column has, where trains had more.
    fn cut_efforts(&mut self, recordings: &mut [Recording], runs: &[RunCheck], known: &Known) {
        let own = self.usable(runs);
        let Some(cut) = effort::cut::of(with_lines(&own, recordings, known)) else { return };
        let leave_out = |i: usize| effort::cut::leave_out(&mut recordings[i].rows, &cut);
        let count: usize = own.into_iter().map(leave_out).sum();
        let text = format!("{:.3} N/kg in {count} rows, which are left out with those beside them", cut.most_n_per_kg);
        self.found_by(Kind::EffortCut, cut.times, "", Done::LeftOut, text);
    }

    /// Leaves out efforts that do not act.
    fn demanded_efforts(&mut self, recordings: &mut [Recording], runs: &[RunCheck], known: &Known) {
        let own = self.usable(runs);
        let Some(share) = effort::demanded::share(with_lines(&own, recordings, known)) else { return };
        self.found(Kind::EffortDemanded, share, "", Done::LeftOut);
        own.into_iter().for_each(|i| without_efforts(&mut recordings[i].rows));
    }

    /// Leaves out efforts of which those that hold a speed have a gain of their own: where it changes is not known.
    fn small_efforts(&mut self, recordings: &mut [Recording], runs: &[RunCheck], known: &Known) {
        let own = self.usable(runs);
        let Some(small) = effort::small::of(with_lines(&own, recordings, known)) else { return };
        let text = format!("below {:.2} N/kg", small.below_n_per_kg);
        self.found_by(Kind::EffortSmall, small.times, "", Done::LeftOut, text);
        own.into_iter().for_each(|i| without_efforts(&mut recordings[i].rows));
    }

    /// Leaves out efforts that are old ones.
    fn held_efforts(&mut self, recordings: &mut [Recording], runs: &[RunCheck]) {
        let own = self.usable(runs);
        let rows: Vec<&[Sample]> = own.iter().map(|i| recordings[*i].rows.as_slice()).collect();
        let Some(held) = effort::held::of(&rows) else {
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
    fn unlike_efforts(&self, recordings: &mut [Recording], runs: &mut [RunCheck]) {
        let own = self.usable(runs);
        let brakes: Vec<Option<[usize; 2]>> = own.iter().map(|i| effort::brakes(&recordings[*i].rows)).collect();
        let without_sign = |place: &usize| brakes[*place].is_some_and(|[against, all]| 3 * against > 2 * all);
        let odd: Vec<usize> = (0..own.len()).filter(without_sign).collect();
        // Where all runs have it, it is the column that is said to have nothing to do with the train.
        if odd.len() < brakes.iter().flatten().count() {
            for place in odd {
                if let Some(windows) = brakes[place] {
                    runs[own[place]].brakes_without_sign(windows);
                    without_efforts(&mut recordings[own[place]].rows);
                }
            }
        }
        let answers: Vec<Option<Figure>> = own.iter().map(|i| effort::unlike::of_run(&recordings[*i].rows)).collect();
        for (place, figure) in effort::unlike::unlike(&answers) {
            runs[own[place]].answers_otherwise(figure);
            without_efforts(&mut recordings[own[place]].rows);
        }
    }

    /// Sends efforts through the filter that the speeds are behind.
    fn trailing_speeds(&mut self, recordings: &mut [Recording], runs: &[RunCheck], known: &Known) {
        let own = read_of(&self.unit, runs);
        let step_s = own.iter().map(|i| runs[*i].step_s).fold(0.0, f64::max);
        if !known.moves_locations || step_s > MOVED_STEP_S || self.has(Kind::EffortApart) {
            return;
        }
        let ask = |i: usize| asked(&recordings[i], runs[i].step_s, known);
        let runs_asked: Vec<Asked<'_>> = own.iter().take(2 * AGED).map(|i| ask(*i)).collect();
        let Some(constant_s) = speed::trailing::of(&runs_asked) else { return };
        let text = "the efforts go through the same filter".to_owned();
        self.found_by(Kind::TrailingSpeed, constant_s, "s", Done::PutRight, text);
        for i in own {
            let efforts = speed::trailing::filtered(&asked(&recordings[i], runs[i].step_s, known), constant_s.value);
            recordings[i].rows.iter_mut().zip(efforts).for_each(|(row, effort)| row.effort_n_per_kg = effort);
        }
    }

    /// Makes momentary efforts means over as long as the speeds are, or leaves them out where that is too long.
    fn smoothed_speeds(&mut self, recordings: &mut [Recording], runs: &[RunCheck], known: &Known) {
        let is_coarse = self.speed_step_kmh.is_some_and(|step| step > speed::smoothed::MOST_STEP_KMH);
        // Where the wheels slide in each brake the way by the speeds is bent as that of means.
        if is_coarse || self.has(Kind::TrailingSpeed) || self.has(Kind::Slides) {
            return;
        }
        let own = read_of(&self.unit, runs);
        let rows: Vec<&[Sample]> = own.iter().map(|i| recordings[*i].rows.as_slice()).collect();
        let Some(long_s) = speed::smoothed::of(&rows) else {
            return;
        };
        let is_short = long_s.value <= speed::smoothed::MOST_S;
        let averaged = speed::smoothed::averaged_efforts(&rows, long_s.value);
        let has_efforts = rows.iter().copied().flatten().any(|row| row.effort_n_per_kg.is_some());
        let (done, text) = match (&averaged, is_short) {
            (Some(_), true) => {
                (Done::PutRight, "the efforts are averaged over as long, and explain the accelerations better so")
            }
            // Efforts that are means over as long go with the speeds, and so short ones do little harm.
            (None, true) => return,
            (None, false) if !has_efforts || !known.moves_locations => {
                (Done::Said, "or the receiver's filter is as slow")
            }
            (_, false) => (Done::LeftOut, "the efforts are: gradients are no means over so long"),
        };
        self.found_by(Kind::SmoothedSpeed, long_s, "s", done, text.to_owned());
        if done == Done::Said {
            return;
        }
        for (place, i) in own.iter().enumerate() {
            let means = averaged.as_ref().filter(|_| is_short).map(|efforts| &efforts[place]);
            for (at, row) in recordings[*i].rows.iter_mut().enumerate() {
                row.effort_n_per_kg = means.and_then(|means| means[at]);
            }
        }
    }

    /// Brings the zeros of runs that differ to one. Out: the stretches of moving trains, as they are then.
    fn zeros_of_runs(&mut self, recordings: &mut [Recording], runs: &[RunCheck], known: &Known) -> Vec<MovingStretch> {
        let own = self.usable(runs);
        let moving = |recordings: &[Recording]| moving_stretches(own.iter().map(|i| &recordings[*i]), known);
        let as_read = moving(recordings);
        let zeros = effort::zero::of_run::differing(&as_read, own.len(), self.effort_step_n_per_kg);
        let Some(zeros) = zeros else { return as_read };
        let figure = Figure { value: zeros.spread_n_per_kg, sd: 0.0 };
        let kind = Kind::EffortZerosDiffer;
        if !zeros.is_sure {
            self.effort_doubt_n_per_kg = zeros.doubt_n_per_kg();
            let text = format!("or drivers leave a little power while coasting{DOUBTED}");
            self.found_by(kind, figure, "N/kg", Done::Said, text);
            return as_read;
        }
        let unseen = zeros.of_runs.iter().filter(|zero| zero.is_none()).count();
        let left_out = if unseen > 0 {
            format!("; {unseen} runs show none, and their efforts are left out")
        } else {
            String::new()
        };
        let text = format!("each run's own is taken from its coasts{left_out}");
        self.found_by(kind, figure, "N/kg", Done::PutRight, text);
        for (i, zero) in own.iter().zip(&zeros.of_runs) {
            let rows = &mut recordings[*i].rows;
            match zero {
                Some(zero) => {
                    let efforts = rows.iter_mut().filter_map(|row| row.effort_n_per_kg.as_mut());
                    efforts.for_each(|effort| *effort -= zero - zeros.middle_n_per_kg);
                }
                None => without_efforts(rows),
            }
        }
        moving(recordings)
    }

    /// Takes the zero of the effort from trains that coast or stand, and leaves out zeros that are no effort of 0.
    fn effort_zero(
        &mut self,
        recordings: &mut [Recording],
        runs: &[RunCheck],
        known: &Known,
        moving: Vec<MovingStretch>,
    ) {
        let own =
            || recordings.iter().zip(runs).filter(|(_, run)| self.has_usable(run)).map(|(recording, _)| recording);
        let standing = effort::zero::at_standstill(own());
        let coasts = effort_of_coasts(moving, self.effort_step_n_per_kg);
        let seen = effort::zero::decided(standing, coasts);
        let zeros = effort::zero::zeros(own(), known);
        let rows = recordings.iter_mut().zip(runs).filter(|(_, run)| self.has_usable(run));
        let rows: Vec<&mut [Sample]> = rows.map(|(recording, _)| recording.rows.as_mut_slice()).collect();
        let is_seen = seen.is_some();
        if let Some(Zero { figure: zero, doubt_n_per_kg, may_act, seen }) =
            seen.filter(|one| effort::zero::is_off(one.figure))
        {
            self.effort_doubt_n_per_kg = self.effort_doubt_n_per_kg.max(doubt_n_per_kg);
            let doubt = if may_act { [MAY_ACT, DOUBTED].concat() } else { String::new() };
            let text = format!("{seen}, and so taken from all{doubt}");
            self.found_by(Kind::EffortOffset, zero, "N/kg", Done::PutRight, text);
            let efforts = rows.into_iter().flatten().filter_map(|row| row.effort_n_per_kg.as_mut());
            efforts.for_each(|effort| *effort -= zero.value);
            return;
        }
        let of = |stretches: Stretches, what: &str| {
            format!("{} of {} stretches in which the train {what}", stretches.with_zeros, stretches.all)
        };
        let gap = || effort::gap::of(rows.iter().flat_map(|rows| rows.iter()));
        let (why, leave_out): (String, fn(&mut [Sample]) -> usize) = if zeros.drop_what_is_small() {
            (of(zeros.holds, "holds its speed: all efforts of 0"), effort::zero::leave_out_zeros)
        } else if zeros.never_show_a_brake() {
            let what = "brakes to a stop, and no effort is below 0: all efforts of 0";
            (of(zeros.stops, what), effort::zero::leave_out_zeros)
        } else if zeros.keep_some()
            && let Some(Gap { least_n_per_kg, rows }) = gap()
        {
            let why = format!(
                "the train keeps its speed in {} stretches of 20 s with none, and no effort is between 0 and \
                 {least_n_per_kg:.4} N/kg, beside {rows} of up to twice as much: all efforts of 0",
                zeros.kept
            );
            (why, effort::zero::leave_out_zeros)
        } else if zeros.lack_the_brake() {
            (of(zeros.brakes, "brakes: its efforts while it brakes"), effort::zero::leave_out_brakes)
        } else {
            if !is_seen && zeros.are_of_many() {
                let runs = Figure { value: self.usable(runs).len() as f64, sd: 0.0 };
                self.found(Kind::EffortZeroUnseen, runs, "runs", Done::Said);
            }
            return;
        };
        let count: usize = rows.into_iter().map(leave_out).sum();
        let figure = Figure { value: count as f64, sd: 0.0 };
        self.found_by(Kind::EffortZeros, figure, "rows", Done::LeftOut, why);
    }

    /// Says that the effort is older than the speed, and brings it to its age where the rows are near enough in time.
    /// Where they are not, an effort that is late by more than half a row is not what a later tick makes of it, and
    /// left out.
    fn effort_age(&mut self, recordings: &mut [Recording], runs: &[RunCheck], known: &Known) {
        let has_effort = |rows: &[Sample]| rows.iter().any(|row| row.effort_n_per_kg.is_some());
        let own = (0..runs.len()).filter(|i| self.has_usable(&runs[*i]) && has_effort(&recordings[*i].rows));
        let own: Vec<usize> = own.collect();
        if own.is_empty() || self.has(Kind::EffortApart) {
            return;
        }
        let ask = |i: &usize| asked(&recordings[*i], runs[*i].step_s, known);
        let asked_of: Vec<Asked<'_>> = own.iter().take(AGED).map(ask).collect();
        let Some(usual) = effort::age::usual(&asked_of) else { return };
        let age_s = usual.age_s;
        if age_s.value.abs() < LEAST_AGE_S || age_s.away_from(0.0) < SURE {
            return;
        }
        let step_s = own.iter().map(|i| runs[*i].step_s).fold(0.0, f64::max);
        let (done, said) = match step_s {
            _ if !known.moves_locations => (Done::Said, "asked for beside its gain".to_owned()),
            ..=MOVED_STEP_S => (Done::PutRight, format!("it differs by {:.1} s from run to run", usual.spread_s)),
            _ if let Some(by) = usual.whole_rows(step_s) => (Done::PutRight, format!("by whole rows: {by}")),
            _ if age_s.value.abs() <= 0.5 * step_s => {
                (Done::Said, format!("within half of the {step_s:.0} s of a row"))
            }
            _ => (Done::LeftOut, format!("the efforts; rows are {step_s:.0} s apart, too far to move them")),
        };
        self.found_by(Kind::EffortLate, age_s, "s", done, said);
        for i in own {
            let line = known.line(recordings[i].direction);
            let rows = &mut recordings[i].rows;
            match done {
                Done::PutRight => match usual.whole_rows(step_s).filter(|_| step_s > MOVED_STEP_S) {
                    Some(by) => effort::age::move_by_rows(rows, runs[i].step_s, by),
                    None => effort::age::move_efforts(rows, runs[i].step_s, line, &usual),
                },
                Done::LeftOut => without_efforts(rows),
                Done::Said | Done::Refused => (),
            }
        }
    }
}

/// The runs at these places whose line is known.
fn with_lines<'a>(
    own: &'a [usize],
    recordings: &'a [Recording],
    known: &'a Known,
) -> impl Iterator<Item = (&'a [Sample], Line<'a>)> {
    own.iter().filter_map(|i| {
        let recording = &recordings[*i];
        Some((recording.rows.as_slice(), known.line(recording.direction)?))
    })
}

fn without_efforts(rows: &mut [Sample]) {
    rows.iter_mut().for_each(|row| row.effort_n_per_kg = None);
}

fn asked<'a>(run: &'a Recording, step_s: f64, known: &'a Known) -> Asked<'a> {
    Asked { rows: &run.rows, step_s, line: known.line(run.direction) }
}
