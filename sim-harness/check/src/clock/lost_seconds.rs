//! A clock that loses a second at even intervals: from then on the locations are one second further than the distance
//! by speed.
//!
//! ```text
//! Δx - ∫ v_r dt = (1/s - 1) ∫ v_r dt + (o/s) Δt + τ Δv_r + n v · 1 s + noise       n: lost seconds between the two rows
//! ```
//!
//! A wheel, truncation and an old speed are in the model beside it, so that a ramp is no staircase. The steps lie at
//! `phase + k period` of the recorder's clock: the period is one of the recorder, the phase one of each run. Single
//! steps may drown in the noise of the location; some dozens at even intervals do not.

use crate::agreement::compared::{BRAKES_MPS2, Compared, Differences, PAIR_S};
use crate::agreement::parts::differences;
use crate::figure::Figure;
use crate::finding::{Done, Finding, Kind};
use crate::rows::ways;
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;
use rundown_files::statistics::{span, spread};

/// Periods that are looked for, s. A longer one does less than a wheel that matters.
const PERIODS_S: [f64; 2] = [40.0, 800.0];
/// Where the location is usually off by a smaller share of the distance, no clock is slow, unless a wheel hides it:
/// then single steps stand out on one side, by so many standard deviations.
const LEAST_EXCESS: f64 = 0.0008;
const STANDS_OUT: f64 = 3.0;
/// The same, share of the usual way in a second, is too much for that.
const NOISY: f64 = 0.3;
/// A period with which the height of the steps is asked where none is found, s.
const USUAL_PERIOD_S: f64 = 106.0;
/// Runs that the period is looked for in: the longest ones. So many more confirm it.
const ASKED: usize = 3;
const CONFIRM: usize = 3;
/// Phases that are tried for a period, at first.
const PHASES: usize = 24;
/// Nats by which the staircases of all asked runs must beat the model without them, beyond the choice of period and
/// phases.
const LEAST_GAIN: f64 = 12.0;
/// The steps must be a second high, within this, s, and so many standard deviations from none.
const NEAR_SECOND_S: f64 = 0.25;
const SURE: f64 = 6.0;
/// Nats by which the phase of a run must beat the opposite one.
const LEAST_PHASE_GAIN: f64 = 4.0;

/// Seconds are lost at these times of the recorder's clock.
#[derive(Clone, Copy, Debug)]
struct Comb {
    period_s: f64,
    phase_s: f64,
}

impl Comb {
    /// Seconds that were lost up to a time, but for a constant.
    fn lost(&self, time_s: f64) -> f64 {
        ((time_s - self.phase_s) / self.period_s).floor()
    }
}

/// A run as the comb sees it.
impl Compared {
    fn duration_s(&self) -> f64 {
        let ends = &self.differences.end_s;
        ends.last().zip(ends.first()).map_or(0.0, |(last, first)| last - first)
    }

    /// Metres that the lost seconds add to each difference.
    fn steps_m(&self, comb: Comb) -> Vec<f64> {
        let Differences { by_speed, dt, end_s, .. } = &self.differences;
        let step_m = |i: usize| (comb.lost(end_s[i]) - comb.lost(end_s[i] - dt[i])) * by_speed[i] / dt[i];
        (0..dt.len()).map(step_m).collect()
    }

    /// What the data say of the height of the steps, s, and the nats by which steps of that height beat none; the noise
    /// as without them. Beside a good odometer each step is an outlier, and drawn in: the height is right where the
    /// second is taken off already.
    fn height_s(&self, comb: Comb) -> (Figure, f64) {
        self.beside(&self.steps_m(comb)).unwrap_or((Figure { value: 0.0, sd: f64::INFINITY }, 0.0))
    }

    /// Puts the times of a run right, and says so.
    fn finding(&self, period_s: f64, rows: &mut [Sample], step_s: f64) -> Finding {
        let found = self.comb(period_s);
        let share = |period_s: f64| 100.0 * step_s / period_s;
        let figure = match &found {
            Some((comb, sd_s)) => {
                Figure { value: share(comb.period_s), sd: share(comb.period_s) * sd_s / comb.period_s }
            }
            None => Figure { value: share(period_s), sd: 0.02 * share(period_s) },
        };
        let (count, line, done) = match found {
            Some((comb, _)) => {
                let lost = lost_at(rows, comb);
                move_times(rows, &lost);
                (lost.len(), lost.first().map_or(0, |i| rows[*i].line), Done::PutRight)
            }
            None => ((self.duration_s() / period_s) as usize, 0, Done::Said),
        };
        Finding { kind: Kind::LostSeconds, figure, unit: "% of the rows", count, line, done }
    }

    /// Where this run loses its seconds, and the standard deviation of its period, s; none where that is not known.
    fn comb(&self, period_s: f64) -> Option<(Comb, f64)> {
        let spacing_s = spacing_s(period_s, self.duration_s().max(period_s)).min(0.02 * period_s);
        let tried = |periods: Vec<f64>| -> Vec<(Comb, f64)> {
            periods.into_iter().map(|period_s| self.phase(period_s, phases(period_s))).collect()
        };
        let best = |tried: &[(Comb, f64)]| tried.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1));
        let coarse = tried(around(period_s, spacing_s));
        let (near, gain) = best(&coarse)?;
        // Within two standard deviations the likelihood falls by two nats.
        let range_s = span(coarse.iter().filter(|(_, other)| *other > gain - 2.0).map(|(comb, _)| comb.period_s));
        let sd_s = (0.25 * range_s).max(0.125 * spacing_s);
        // As the runs are pooled, what is left of the choice must not be the same in all of them.
        let (comb, gain) = best(&tried(around(near.period_s, 0.125 * spacing_s)))?;
        let opposite = Comb { phase_s: comb.phase_s + 0.5 * comb.period_s, ..comb };
        (gain - self.height_s(opposite).1 > LEAST_PHASE_GAIN).then_some((comb, sd_s))
    }

    /// The best phase for a period, with its nats.
    fn phase(&self, period_s: f64, phases: usize) -> (Comb, f64) {
        let at = |i: usize| Comb { period_s, phase_s: period_s * i as f64 / phases as f64 };
        let tried = (0..phases).map(at).map(|comb| (comb, self.height_s(comb).1));
        tried.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((at(0), 0.0))
    }
}

/// What came of the search.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sought {
    /// The clock loses a second each time so long has passed, s; none where it does not.
    pub(crate) period_s: Option<f64>,
    /// How surely the height of steps at the usual intervals is known beside a wheel, standard deviation, s; none where
    /// nothing is compared.
    pub(crate) step_sd_s: Option<f64>,
}

/// A step is known less surely than this, s: a clock that loses seconds beside a wheel that hides it is not seen.
pub(crate) const NOT_SEEN_S: f64 = 1.0 / SURE;

/// Looks for a clock that loses seconds in the runs of one recorder, and puts their times right: what is to be said of
/// which of them. `usable`: places and times between rows, s.
pub(crate) fn put_right(usable: &[(usize, f64)], recordings: &mut [Recording]) -> (Sought, Vec<(usize, Finding)>) {
    let sought = sought(usable, recordings);
    let Some(period_s) = sought.period_s else {
        return (sought, Vec::new());
    };
    let put = |(i, step_s): &(usize, f64)| {
        let rows = &mut recordings[*i].rows;
        let compared = Compared::fitted(differences(rows, *step_s))?;
        Some((*i, compared.finding(period_s, rows, *step_s)))
    };
    (sought, usable.iter().filter_map(put).collect())
}

/// The same, but nothing is put right. `usable`: places and times between rows, s.
pub(crate) fn sought(usable: &[(usize, f64)], recordings: &[Recording]) -> Sought {
    let mut longest: Vec<(&(usize, f64), f64)> =
        usable.iter().map(|run| (run, length_m(&recordings[run.0].rows))).collect();
    longest.sort_by(|(_, a), (_, b)| b.total_cmp(a));
    let of = |((i, step_s), _): &(&(usize, f64), f64)| differences(&recordings[*i].rows, *step_s);
    let asked: Vec<Differences> = longest.iter().take(ASKED).map(of).filter(Differences::are_enough).collect();
    let is_ahead = excess(&asked).abs() > LEAST_EXCESS;
    let mut asked: Vec<Compared> = asked.into_iter().filter_map(Compared::fitted).collect();
    let step_sd_s = step_sd_s(&asked);
    if !is_ahead && !steps_stand_out(&asked) {
        return Sought { period_s: None, step_sd_s };
    }
    let period_s = likely_period_s(&asked).filter(|period_s| {
        asked.extend(longest.iter().skip(ASKED).take(CONFIRM).map(of).filter_map(Compared::fitted));
        is_confirmed(&asked, *period_s)
    });
    Sought { period_s, step_sd_s }
}

/// How surely the height of steps at the usual intervals is known, all these runs together, s.
fn step_sd_s(asked: &[Compared]) -> Option<f64> {
    let of = |run: &Compared| {
        let (height_s, _) = run.height_s(Comb { period_s: USUAL_PERIOD_S, phase_s: 0.5 * USUAL_PERIOD_S });
        height_s.sd.powi(-2) * run.independent()
    };
    let information: f64 = asked.iter().map(of).sum();
    (information > 0.0).then(|| information.sqrt().recip())
}

/// More locations are ahead than behind by what noise does at times, beyond chance: so a wheel and lost seconds look
/// that hide each other in the mean. Where noise hides single steps, only their even intervals show them.
fn steps_stand_out(asked: &[Compared]) -> bool {
    let [mut ahead, mut behind] = [0.0, 0.0];
    let mut is_noisy = false;
    for run in asked {
        let left_m = run.left_m();
        let sd_m = spread(&left_m);
        ahead += left_m.iter().filter(|metres| **metres > STANDS_OUT * sd_m).count() as f64;
        behind += left_m.iter().filter(|metres| **metres < -STANDS_OUT * sd_m).count() as f64;
        let Differences { by_speed, dt, .. } = &run.differences;
        is_noisy |= sd_m > NOISY * by_speed.iter().sum::<f64>() / dt.iter().sum::<f64>();
    }
    is_noisy || ahead - behind > STANDS_OUT * (ahead + behind + 1.0).sqrt()
}

/// How far the locations reach, m.
fn length_m(rows: &[Sample]) -> f64 {
    span(rows.iter().filter_map(|row| row.location_m))
}

/// By which share of the way the locations run ahead of the speeds.
fn excess(runs: &[Differences]) -> f64 {
    let sum = |of: fn(&Differences) -> &Vec<f64>| -> f64 { runs.iter().flat_map(of).sum() };
    sum(|differences| &differences.y) / sum(|differences| &differences.by_speed).max(1.0)
}

/// The period that these runs like best; none where no staircase is better than none. How much the locations run ahead
/// does not bound it: a wheel that reads high takes from that what the lost seconds add.
fn likely_period_s(asked: &[Compared]) -> Option<f64> {
    let [shortest_s, longest_s] = PERIODS_S;
    let duration_s = asked.iter().map(Compared::duration_s).fold(longest_s, f64::max);
    let nats = |period_s: f64, phases| asked.iter().map(|run| run.phase(period_s, phases).1).sum::<f64>();
    let spacing_s = |period_s: f64| spacing_s(period_s, duration_s);
    let next = |period_s: &f64| Some(period_s + spacing_s(*period_s)).filter(|next| *next < longest_s);
    let coarse: Vec<f64> = std::iter::successors(Some(shortest_s), next).collect();
    let best = |periods: &[f64], phases| {
        let tried = periods.iter().map(|period_s| (*period_s, nats(*period_s, phases)));
        tried.max_by(|a, b| a.1.total_cmp(&b.1))
    };
    let (near_s, gain) = best(&coarse, PHASES)?;
    if gain < LEAST_GAIN {
        return None;
    }
    // Every second or third step of a staircase is one, too, and half a step in between is better than none; from every
    // second one it is found in another round.
    let refined = |from_s: f64| {
        let parts = [1.0 / 3.0, 0.5, 2.0 / 3.0, 1.0, 2.0, 3.0].map(|part| from_s / part);
        let within = parts.into_iter().filter(|part_s| (shortest_s..=longest_s).contains(part_s));
        let near: Vec<f64> = within.flat_map(|part_s| around(part_s, spacing_s(part_s))).collect();
        best(&near, phases(3.0 * from_s)).map(|(period_s, _)| period_s)
    };
    refined(near_s).and_then(refined)
}

/// The runs are clearly better off without the seconds, which are seconds.
fn is_confirmed(asked: &[Compared], period_s: f64) -> bool {
    let choices = phases(period_s) as f64 * PERIODS_S[1] / PERIODS_S[0];
    let (mut gain, mut by_brakes, mut score, mut information) = (0.0, 0.0, 0.0, 0.0);
    for run in asked {
        let comb = run.comb(period_s).map_or_else(|| run.phase(period_s, phases(period_s)).0, |(comb, _)| comb);
        let Some(without) = run.without(&run.steps_m(comb)) else {
            return false;
        };
        gain += without.fit.log_likelihood - run.fit.log_likelihood - choices.ln();
        let braked_m = run.differences.way_where(|mps2| mps2 < BRAKES_MPS2);
        by_brakes += run.beside(&braked_m).map_or(0.0, |(_, nats)| nats);
        let (left_s, _) = without.height_s(comb);
        let weight = left_s.sd.powi(-2);
        (score, information) = (score + weight * (1.0 + left_s.value), information + weight);
    }
    let height_s = Figure { value: score / information, sd: information.sqrt().recip() };
    // Wheels that slide in each brake lose as much of the way, at intervals that are those of the stops.
    gain > LEAST_GAIN.max(by_brakes) && (height_s.value - 1.0).abs() < NEAR_SECOND_S && height_s.away_from(0.0) > SURE
}

/// How far apart periods are tried, s: at the ends of a run of this duration the staircase is off by an eighth of its
/// period at most.
fn spacing_s(period_s: f64, duration_s: f64) -> f64 {
    period_s * period_s / (2.0 * duration_s)
}

/// Periods around one, as far as its neighbours.
fn around(period_s: f64, spacing_s: f64) -> Vec<f64> {
    (-8..=8).map(|i| period_s + spacing_s * f64::from(i) / 8.0).collect()
}

/// Phases that differ by no less than the rows that are compared.
fn phases(period_s: f64) -> usize {
    (period_s / PAIR_S).ceil() as usize
}

/// Rows that hold a lost second: where the staircase says, or, if one nearby stands out, there.
fn lost_at(rows: &[Sample], comb: Comb) -> Vec<usize> {
    let sign = ways::heading(rows);
    // Metres by location beyond those by speed, and the speed.
    let beyond: Vec<Option<[f64; 2]>> = rows
        .windows(2)
        .map(|pair| {
            let speed_mps = 0.5 * (pair[0].speed_mps? + pair[1].speed_mps?);
            let by_location_m = sign * (pair[1].location_m? - pair[0].location_m?);
            Some([by_location_m - speed_mps * (pair[1].time_s - pair[0].time_s), speed_mps])
        })
        .collect();
    let metres: Vec<f64> = beyond.iter().flatten().map(|[metres, _]| *metres).collect();
    let sd_m = spread(&metres);
    let stands_out = |i: usize| {
        let [metres, speed_mps] = beyond.get(i.checked_sub(1)?).copied().flatten()?;
        (metres > 0.5 * speed_mps && metres > 3.0 * sd_m).then_some(metres)
    };
    let predicted = (1..rows.len()).filter(|i| comb.lost(rows[*i].time_s) > comb.lost(rows[i - 1].time_s));
    let mut lost: Vec<usize> = predicted
        .map(|at| {
            let near = |i: &usize| (rows[*i].time_s - rows[at].time_s).abs() <= PAIR_S;
            let around = (at.saturating_sub(8)..(at + 9).min(rows.len())).filter(near);
            let seen = around.filter_map(|i| Some((i, stands_out(i)?)));
            seen.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(at, |(i, _)| i)
        })
        .collect();
    lost.dedup();
    lost
}

/// From each of these rows on a second later.
fn move_times(rows: &mut [Sample], lost: &[usize]) {
    for (i, row) in rows.iter_mut().enumerate() {
        row.time_s += lost.partition_point(|at| *at <= i) as f64;
    }
}
