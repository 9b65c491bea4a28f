//! What all runs of one recorder say together: how the speed is shown, its scale, its age; what it leaves out and
//! holds; what the runs exceed.
//!
//! | question | module |
//! |---|---|
//! | what is known of it, and of all recorders? | `diagnosis` |
//! | what is put right in its speeds? | `correction` |
//! | what does an age of the speed add to the way besides? | `second_order` |
//! | do its wheels slide in each brake? | `each_brake` |
//! | is a run unlike the others? | `own` |
//! | what do its efforts say? | `efforts` |

pub(crate) mod correction;
pub(crate) mod diagnosis;
pub(crate) mod each_brake;
mod efforts;
mod own;
pub(crate) mod second_order;

use crate::agreement::of_most::OfMost;
use crate::agreement::{Agreement, Pooled, pooled, share_bends};
use crate::figure::Figure;
use crate::finding::{Done, Finding, Kind};
use crate::location::drifting::Drift;
use crate::rows::steps;
use crate::run::RunCheck;
use crate::run::of_speed::{OfSpeed, Taken};
use crate::wheel::change::OfRun;
use crate::wheel::creep::Creep;
use crate::{Known, LEAST_SCALE, SURE, clock, put_right, read_of, speed, usable_of, wheel};
use correction::Correction;
use diagnosis::RecorderCheck;
use nalgebra::{Matrix2, Vector2};
use own::Grown;
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;
use rundown_files::statistics::{sd_of_median, spread};
use std::cmp::Ordering;

/// A smaller skew is not named, s.
const LEAST_SKEW_S: f64 = 0.3;
/// Share of the step by which the offset of a truncating recorder may miss the half of it.
const NEAR_HALF: f64 = 0.12;
/// One of two offsets is decided where it is nearer than this share of the distance to the other.
const CLEARLY: f64 = 0.5;

/// Creep is taken off where it is so many standard deviations from none: what the rounding of a held speed looks like
/// is less.
const CREEP_SURE: f64 = 6.0;

/// How the speeds are shown.
#[derive(Clone, Copy, PartialEq)]
enum Shown {
    Exact,
    Rounded,
    Truncated,
    /// To the step above.
    RoundedUp,
    NotKnown,
}

/// What is true less read beside a step, in steps.
const OF_STEP: [(Shown, f64); 3] = [(Shown::Rounded, 0.0), (Shown::Truncated, 0.5), (Shown::RoundedUp, -0.5)];

impl Shown {
    /// True less read speed where the step decides it, km/h.
    fn offset_kmh(self, step_kmh: f64) -> Option<f64> {
        OF_STEP.iter().find(|(shown, _)| *shown == self).map(|(_, steps)| steps * step_kmh)
    }
}

/// An offset of all readings that is put right: it is larger than what places of the location on the train make, and
/// further from zero.
const LEAST_OFFSET_KMH: f64 = 0.5;
const OFFSET_SURE: f64 = 8.0;
const LEAST_OFFSET_RUNS: usize = 4;

/// Beside such an offset a scale is a wheel's, if it is no larger: wheels wear by a few per cent, and more is a speed
/// that is no straight line.
const MOST_BESIDE_OFFSET: f64 = 0.05;

fn is_beyond(offset_kmh: Figure) -> bool {
    offset_kmh.value.abs() > LEAST_OFFSET_KMH && offset_kmh.away_from(0.0) > OFFSET_SURE
}

fn shown(step_kmh: Option<f64>, offset_kmh: Figure) -> Shown {
    let Some(step_kmh) = step_kmh else {
        return Shown::Exact;
    };
    let off = |value: f64| (offset_kmh.value - value).abs();
    let near = |value: f64| off(value) < 2.0 * offset_kmh.sd + NEAR_HALF * step_kmh;
    let mut ways = OF_STEP.map(|(shown, steps)| (shown, steps * step_kmh));
    ways.sort_by(|(_, a), (_, b)| off(*a).total_cmp(&off(*b)));
    let [(shown, nearest), (_, next), _] = ways;
    if near(nearest) && !near(next) && off(nearest) < CLEARLY * off(next) { shown } else { Shown::NotKnown }
}

/// A scale that is known no better says nothing of wheel and offset, of the recorder or of a run: trams that hold one
/// speed, with bends in all else.
const VAGUE: f64 = 0.05;

/// A scale beside an offset that is 0 or half a step, and not known which: half of what that makes is a doubt of the
/// scale.
fn between(scale: Figure, [rounded, truncated]: [Figure; 2]) -> Figure {
    Figure { sd: scale.sd.hypot(0.5 * (truncated.value - rounded.value)), ..scale }
}

/// Judges the recorder of these runs, and puts right what is beyond doubt. `located`: by which factor their locations
/// were, `drift`: how they did between corrections.
pub(crate) fn of(
    unit: String,
    (located, drift): (Option<Figure>, Option<Drift>),
    recordings: &mut [Recording],
    runs: &mut [RunCheck],
    of_speeds: &[Option<OfSpeed>],
    known: &Known,
) -> RecorderCheck {
    // Speeds that were computed from the locations are none of the recorder.
    let (of_unit, computed): (Vec<usize>, Vec<usize>) =
        (0..runs.len()).filter(|i| runs[*i].unit == unit).partition(|i| !runs[*i].speed_is_computed);
    let timed: Vec<(usize, f64)> =
        of_unit.iter().filter(|i| runs[**i].is_usable()).map(|i| (*i, runs[*i].step_s)).collect();
    let (sought, found) = clock::lost_seconds::put_right(&timed, recordings);
    found.into_iter().for_each(|(i, finding)| runs[i].findings.push(finding));
    // Readings in another unit have another step.
    let usable = read_of(&unit, runs);
    let speed_step_kmh = steps::of_speed_kmh(usable.iter().flat_map(|i| &recordings[*i].rows));
    let location_step_m = steps::of_location_m(usable_of(&unit, runs).iter().flat_map(|i| &recordings[*i].rows));
    let step_kmh = speed_step_kmh.unwrap_or(0.0);
    let behind = leave_out_behind(recordings, &usable, step_kmh);
    let is_other = sought.period_s.is_some() || behind.is_some();
    let (again, creep) = compared_again(&of_unit, recordings, runs, of_speeds, is_other);
    let judged = |(i, of_speed): (&usize, Option<OfSpeed>)| {
        let (one, grown) = of_one(of_speed?, &recordings[*i].rows, &mut runs[*i], step_kmh, known)?;
        Some((Some(one), grown))
    };
    let judged = of_unit.iter().zip(again).map(judged).map(|one| one.unwrap_or((None, Grown::NOT)));
    let (mut agreements, mut grown): (Vec<Option<Agreement>>, Vec<Grown>) = judged.unzip();
    share_bends(&mut agreements);
    let compared: Vec<Agreement> = agreements.iter().flatten().cloned().collect();
    let mut recorder = RecorderCheck {
        unit,
        compared: compared.len(),
        runs: of_unit.len() + computed.len(),
        speed_step_kmh,
        location_step_m,
        located,
        lost_second_sd_s: sought.step_sd_s,
        ..RecorderCheck::default()
    };
    recorder.computes(&computed);
    drift.into_iter().for_each(|drift| recorder.drifts(&drift));
    if let Some((behind_kmh, rows)) = behind {
        let band = Figure { value: step_kmh, sd: 0.0 };
        let text = format!("{rows} rows; where it rises or falls they are {behind_kmh:.2} km/h behind");
        recorder.found_by(Kind::Stairs, band, "km/h", Done::LeftOut, text);
    }
    recorder.dead_zone(recordings, &usable);
    recorder.held_speeds(recordings, &usable);
    let Some(mut all) = pooled(&compared) else {
        return recorder;
    };
    creep.into_iter().for_each(|creep| recorder.creeps(creep, &all));
    if let Some((after, ratio)) = recorder.changes(&agreements, &of_unit, recordings, known, &all) {
        for at in after {
            agreements[at] = agreements[at].take().map(|agreement| agreement.rescaled(ratio));
            grown[at].all = ratio;
        }
        all = pooled(&agreements.iter().flatten().cloned().collect::<Vec<_>>()).unwrap_or(all);
    }
    let values = recorder.decide(&all, known);
    recorder.of_most = OfMost::of(&agreements, values.0[1]);
    let of_runs = || of_unit.iter().copied().zip(agreements.iter().zip(&grown));
    for (i, (agreement, grown)) in of_runs() {
        if let Some(agreement) = agreement {
            own::judged(&recorder, &mut runs[i], (agreement, grown.all), &values);
        }
    }
    recorder.skews(runs, known);
    for (i, (agreement, grown)) in of_runs() {
        let own = own::of(&recorder, &mut runs[i], (agreement.as_ref(), *grown), known);
        own.put_right(&mut recordings[i].rows);
    }
    recorder
}

/// What these runs say, once more where their readings are others now, `is_other`; and by how much their speeds read
/// more while they rise than while they fall, where that contradicts one wheel.
fn compared_again(
    of_unit: &[usize],
    recordings: &[Recording],
    runs: &[RunCheck],
    of_speeds: &[Option<OfSpeed>],
    is_other: bool,
) -> (Vec<Option<OfSpeed>>, Option<Figure>) {
    let again = |i: &usize| {
        let of_speed = of_speeds[*i].clone()?;
        if is_other { OfSpeed::of(&recordings[*i].rows, runs[*i].step_s, of_speed.taken) } else { Some(of_speed) }
    };
    let mut again: Vec<Option<OfSpeed>> = of_unit.iter().map(again).collect();
    let creep = Creep::sure(again.iter().flatten().filter_map(|of_speed| of_speed.creep.as_ref()));
    if let Some((_, falls)) = creep.filter(|(figure, _)| figure.away_from(0.0) > CREEP_SURE) {
        for (i, of_speed) in of_unit.iter().zip(&mut again) {
            let taken = of_speed.as_ref().map(|of_speed| Taken { creep: Some(falls), ..of_speed.taken });
            *of_speed = taken.and_then(|taken| OfSpeed::of(&recordings[*i].rows, runs[*i].step_s, taken));
        }
    }
    if creep.is_some() {
        // What contradicts itself all the way shows no place from which on the wheel is another one.
        again.iter_mut().flatten().for_each(|of_speed| of_speed.change = None);
    }
    (again, creep.map(|(figure, _)| figure))
}

/// Leaves out repeats of speeds that are written again only once they have changed by a step: by how much they are
/// behind, km/h, and how many rows.
fn leave_out_behind(recordings: &mut [Recording], usable: &[usize], step_kmh: f64) -> Option<(f64, usize)> {
    let behind = speed::dead_band::behind_kmh(usable.iter().map(|i| recordings[*i].rows.as_slice()), step_kmh)?;
    let left_out = usable.iter().map(|i| speed::dead_band::leave_out_repeats(&mut recordings[*i].rows));
    Some((behind.value, left_out.sum()))
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
        of_speed = OfSpeed::of(&undone, run.step_s, of_speed.taken)?;
    }
    Some((of_speed.agreement.with_rounding(rounding_mps, run.step_s), grown))
}

impl RecorderCheck {
    /// Asks whether the wheel changes from one run on, in the order of their days. Out: the places of the runs after
    /// it, and their scale over that before.
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
        let decided_kmh = shown(self.speed_step_kmh, all.offset_kmh()).offset_kmh(step_kmh);
        let (offset_mps, offset_is_free) = decided_kmh.map_or((all.values[1], true), |kmh| (kmh / 3.6, false));
        let of_run = |at: &usize| OfRun::at(agreements[*at].as_ref()?, offset_mps);
        let (mut order, of_runs): (Vec<usize>, Vec<OfRun>) =
            order.into_iter().filter_map(|at| Some((at, of_run(&at)?))).unzip();
        // Nobody turns a wheel between two runs of a day.
        let date = |from: usize| day(order[from]).map(f64::floor);
        let may_change = |from: usize| date(from).is_none() || date(from) != date(from - 1);
        let found = wheel::change::between(&of_runs, may_change).filter(|_| !self.has(Kind::Creep))?;
        let after = order.split_off(found.from);
        let named = &recordings[of_unit[after[0]]].name;
        // A step's offset is that of the recorder. Where nothing decides it, it may change as the scale may.
        if offset_is_free {
            let of_side =
                |side: &[usize]| pooled(&side.iter().filter_map(|at| agreements[*at].clone()).collect::<Vec<_>>());
            let [before, since] = [of_side(&order)?, of_side(&after)?];
            if !wheel::change::is_wheel(&before, &since) {
                if let Some(offset_kmh) = wheel::change::other_offset_kmh(&before, &since) {
                    let first = before.offset_kmh().with_interval(2);
                    let text =
                        format!("from {named} on, {first} before: no wheel, but speeds that are found otherwise");
                    self.found_by(Kind::SpeedOffset, offset_kmh, "km/h", Done::Said, text);
                }
                return None;
            }
        }
        // What the scale itself is, before, is judged once all runs have one.
        let text = format!("from {named} on, in {} runs; {} before", after.len(), order.len());
        self.found_by(Kind::WheelChange, found.ratio(), "", put_right(!known.scale), text);
        Some((after, found.ratio().value))
    }

    /// Decides how the speed is shown, then the scale with what that says. Out: 1/s - 1 and o/s, m/s, with their
    /// covariance, as the skews are judged with.
    fn decide(&mut self, all: &Pooled, known: &Known) -> (Vector2<f64>, Matrix2<f64>) {
        let offset_kmh = all.offset_kmh();
        let is_vague = all.scale().sd > VAGUE;
        self.offset_kmh = (!is_vague).then_some(offset_kmh);
        let step_kmh = self.speed_step_kmh.unwrap_or(0.0);
        let shown = if is_vague && self.speed_step_kmh.is_some() {
            Shown::NotKnown
        } else {
            shown(self.speed_step_kmh, offset_kmh)
        };
        let (kind, done) = match shown {
            Shown::Exact => (None, Done::Said),
            Shown::Rounded => (Some(Kind::RoundedSpeed), Done::Said),
            Shown::Truncated => (Some(Kind::TruncatedSpeed), put_right(!known.truncates)),
            Shown::RoundedUp => (Some(Kind::RoundedUpSpeed), put_right(!known.truncates)),
            Shown::NotKnown => (Some(Kind::SteppedSpeed), Done::Said),
        };
        if let Some(kind) = kind {
            self.found(kind, Figure { value: step_kmh, sd: 0.0 }, "km/h", done);
        }
        let offset_mps = shown.offset_kmh(step_kmh).unwrap_or_default() / 3.6;
        // The offset of a step is 0 or a half of it: what is decided is known, and leaves the scale sharper.
        let decided = is_vague || shown.offset_kmh(step_kmh).is_some();
        let beside_locations = match shown {
            _ if is_vague => all.scale_at(0.0),
            Shown::Rounded | Shown::Truncated | Shown::RoundedUp => all.scale_at(offset_mps),
            Shown::Exact => all.scale(),
            Shown::NotKnown => between(all.scale(), [0.0, 0.5 * step_kmh / 3.6].map(|offset| all.scale_at(offset))),
        };
        let scale = self.beside_the_line(beside_locations);
        self.scale = (!is_vague).then_some(scale);
        let odd = !decided && offset_kmh.away_from(0.0) > SURE && offset_kmh.value.abs() > 0.1_f64.max(0.6 * step_kmh);
        // Where one wheel gives both, the stops have decided: the speeds follow the locations.
        let sure = if self.has_one_wheel(scale) { beside_locations } else { scale };
        let creeps = self.has(Kind::Creep);
        let matters = !is_vague && !creeps && (scale.value - 1.0).abs() > LEAST_SCALE && sure.away_from(1.0) > SURE;
        let is_plain = odd && !creeps && all.runs >= LEAST_OFFSET_RUNS && is_beyond(offset_kmh) && !known.truncates;
        // A small offset beside a scale is none of a recorder: the model does not fit, and its scale is no wheel.
        self.is_wheel = matters && (!odd || is_plain && (scale.value - 1.0).abs() < MOST_BESIDE_OFFSET);
        let is_plain = is_plain && (self.is_wheel || !matters);
        if odd && !self.has(Kind::SpeedOffset) {
            self.found(Kind::SpeedOffset, offset_kmh, "km/h", put_right(is_plain));
        }
        let offset_mps = if is_plain { offset_kmh.value / 3.6 } else { offset_mps };
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
        if odd {
            // Beside such an offset the scale is what it is found to be, surely or not.
            let found =
                Correction { offset_mps: offset_kmh.value / 3.6, scale: if known.scale { 1.0 } else { scale.value } };
            self.left_open = found.beside(&self.correction);
        }
        let values = Vector2::new(1.0 / scale.value - 1.0, if decided { offset_mps } else { all.values[1] });
        // The skews are those beside the locations, whatever these are off by.
        let of_scale = (beside_locations.sd / scale.value.powi(2)).powi(2);
        let of_scale = Matrix2::from_diagonal(&Vector2::new(of_scale, 0.0));
        (values, if decided { of_scale } else { all.covariance })
    }

    /// The scale is another one while the speed rises than while it falls, by so much: that of the whole is no wheel's.
    fn creeps(&mut self, creep: Figure, all: &Pooled) {
        let percent = Figure { value: 100.0 * creep.value, sd: 100.0 * creep.sd };
        let less = if creep.value < 0.0 {
            "less while it rises, so no wheel creeps, but speed and way disagree there; "
        } else {
            ""
        };
        let whole = all.scale().with_interval(4);
        let text = format!("{less}read over true is {whole} on the whole, which may be no wheel's");
        self.found_by(Kind::Creep, percent, "%", Done::Said, text);
    }

    /// The speeds of these runs are not compared.
    fn computes(&mut self, computed: &[usize]) {
        if !computed.is_empty() {
            let figure = Figure { value: computed.len() as f64, sd: 0.0 };
            self.found(Kind::ComputedSpeed, figure, "runs", Done::Said);
        }
    }

    /// Its locations were brought back between their corrections.
    fn drifts(&mut self, drift: &Drift) {
        let figure = Figure { value: 100.0 * drift.share, sd: 0.0 };
        let (kind, count, done) = (Kind::DriftingLocation, drift.leaps, Done::PutRight);
        self.findings.push(Finding { kind, figure, unit: "%", count, line: 0, done });
        self.evidence.insert(kind, drift.evidence());
    }

    /// Leaves out readings of zero that are no standstill. Call it while the speeds are as read.
    fn dead_zone(&mut self, recordings: &mut [Recording], usable: &[usize]) {
        let rows = usable.iter().map(|i| recordings[*i].rows.as_slice());
        let Some(found) = speed::dead_zone::of(rows, self.speed_step_kmh.unwrap_or(0.0)) else {
            return;
        };
        let left_out = usable.iter().map(|i| found.leave_out(&mut recordings[*i].rows));
        let count: usize = left_out.map(|(count, _)| count).sum();
        let speed::dead_zone::DeadZone { passes, floor_kmh, .. } = found;
        let floor = if floor_kmh > 0.0 { format!("{floor_kmh:.1}") } else { "0".to_owned() };
        let text =
            format!("no reading between {floor} and that at {passes} starts and stops; {count} readings of {floor}");
        self.found_by(Kind::DeadZone, found.threshold_kmh, "km/h", Done::LeftOut, text);
    }

    /// Leaves out speeds that are old ones. Call it while the speeds are as read.
    fn held_speeds(&mut self, recordings: &mut [Recording], usable: &[usize]) {
        let step_mps = self.speed_step_kmh.unwrap_or(0.0) / 3.6;
        let of_runs: Vec<speed::held::Held> =
            usable.iter().map(|i| speed::held::of(&recordings[*i].rows, step_mps)).collect();
        let Some([rows, asked]) = speed::held::beyond_chance(&of_runs) else {
            return;
        };
        let share = rows as f64 / asked as f64;
        let figure = Figure { value: 100.0 * share, sd: 100.0 * (share * (1.0 - share) / asked as f64).sqrt() };
        let (unit, text) = ("% of the rows whose speed changes fast", format!("{rows} of {asked} such rows"));
        self.found_by(Kind::HeldSpeeds, figure, unit, Done::LeftOut, text);
        for (i, held) in usable.iter().zip(&of_runs) {
            held.rows.iter().for_each(|row| recordings[*i].rows[*row].speed_mps = None);
        }
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
        let sd = sd_of_median(spread_s, skews.len()).max(middle.sd / (skews.len() as f64).sqrt());
        let skew_s = Figure { value: middle.value, sd };
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

    /// 67 runs of short hops, of which the offset came out in the middle of the two that a step may have: 0.26 km/h of
    /// 0 or 0.5.
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
