//! Running time and energy at the wheel of runs that took no part, with and without the effects.
//!
//! | compared | how |
//! |---|---|
//! | running time | each window of up to 120 s begins at the measured speed and place; the train is driven by the recorded effort, place by place. The time until it is where the window ends, less the time that was measured, summed over a run |
//! | energy | what the traction has to give at the wheel on the speeds that were measured: the effort that each model needs, times the way, over the intervals in which the train pulled, less what the effort column says |
//!
//! Both are errors: zero is right. Floor: what the noise of these sensors, and what each run has for itself, leaves of them with a perfect model.

use super::analysis::Findings;
use super::explained::extra;
use super::forward::{Model, acceleration_mps2, begin_m, end_m, model_of, moment_at, windows};
use super::rows::{Believed, Row};
use super::share::{Share, Squares, quantile};
use rundown::model::effects::Effects;

/// A simulated train slower than this does not arrive, m/s.
const STALLED_MPS: f64 = 0.5;
/// Nor one that takes this many times as long as was measured.
const MOST_TIME: f64 = 3.0;
const STEP_S: f64 = 1.0;
/// 95 % point of the normal distribution.
const ONE_SIDED: f64 = 1.64;

/// A measured value of one run, and the errors of both models in it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Error {
    /// As measured.
    pub measured: f64,
    /// Believed model less measured.
    pub before: f64,
    /// Repaired model less measured.
    pub after: f64,
    /// Variance of the difference with a perfect model.
    pub floor: f64,
}

/// One run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Journey {
    /// Index of the run among those compared.
    pub run: usize,
    /// Running time over its windows, s.
    pub time_s: Error,
    /// Windows in it.
    pub windows: usize,
    /// Windows in which a simulated train did not arrive; they count in neither model.
    pub stalled: usize,
    /// Energy at the wheel for each kg of rotating mass, J/kg; none without an effort column, or where the train never pulled.
    pub energy_j_per_kg: Option<Error>,
}

/// Of the rows of one run. `None`: no window could be covered.
pub fn journey(believed: &Believed<'_>, findings: &Findings, effects: &Effects, rows: &[Row]) -> Option<Journey> {
    let mut journey = Journey {
        run: rows.first()?.interval.run,
        energy_j_per_kg: energy(believed, findings, effects, rows),
        ..Journey::default()
    };
    // Of the run's own constant, wind and mass: the same in all its windows, so these add up before they are squared.
    let mut own = [0.0; 3];
    for range in windows(rows) {
        let window = &rows[range.clone()];
        let model = model_of(believed, findings, effects, rows, range);
        let before = covers_in(believed, &Effects::NONE, window);
        let after = covers_in(believed, &model.effects, window);
        let (Some(before_s), Some(after_s)) = (before, after) else {
            journey.stalled += 1;
            continue;
        };
        let measured_s = lasts_s(window);
        journey.windows += 1;
        journey.time_s.measured += measured_s;
        journey.time_s.before += before_s - measured_s;
        journey.time_s.after += after_s - measured_s;
        journey.time_s.floor += time_floor(findings, &model, window, &mut own);
    }
    journey.time_s.floor += own.iter().map(|sum| sum * sum).sum::<f64>();
    (journey.windows > 0).then_some(journey)
}

fn lasts_s(window: &[Row]) -> f64 {
    let ends = window.first().zip(window.last());
    ends.map_or(0.0, |(first, last)| last.interval.begin_s + last.interval.dt_s - first.interval.begin_s)
}

/// Time until a train with these effects is where the window ends, s.
fn covers_in(believed: &Believed<'_>, effects: &Effects, window: &[Row]) -> Option<f64> {
    let first = window.first()?;
    let line = believed.line(first.direction);
    let sign = line.direction.sign();
    let ends_m: Vec<f64> = window.iter().map(|row| end_m(&row.interval, sign)).collect();
    let end_m = *ends_m.last()?;
    let (mut location_m, mut speed) = (begin_m(&first.interval, sign), first.interval.speed_mps[0]);
    let since_s = first.interval.path[0].since_departure_s;
    let (mut at, mut time_s) = (0, 0.0);
    let most_s = MOST_TIME * lasts_s(window);
    while sign * (end_m - location_m) > 0.0 {
        // The driver does at each place what was done there.
        while at + 1 < window.len() && sign * (location_m - ends_m[at]) >= 0.0 {
            at += 1;
        }
        let moment = moment_at(&window[at], location_m, speed, since_s + time_s);
        let acceleration = acceleration_mps2(line, effects, &moment);
        let next_mps = speed + acceleration * STEP_S;
        let way_m = STEP_S * (speed + 0.5 * acceleration * STEP_S);
        let left_m = sign * (end_m - location_m);
        if next_mps < STALLED_MPS || time_s > most_s {
            return None;
        }
        if way_m >= left_m {
            // Within a step the speed is nearly the same: its mean over what is left.
            let mean_mps = speed + 0.5 * acceleration * STEP_S * left_m / way_m;
            return Some(time_s + left_m / mean_mps.max(STALLED_MPS));
        }
        location_m += sign * way_m;
        speed = next_mps;
        time_s += STEP_S;
    }
    (time_s > 0.0).then_some(time_s)
}

/// Variance of the time over a window without what the run has for itself, which is added to `own`. A change of speed at t moves the end of the way by (T - t) times it.
fn time_floor(findings: &Findings, model: &Model, window: &[Row], own: &mut [f64; 3]) -> f64 {
    let noise = &findings.calibrated.noise;
    let Some(last) = window.last() else {
        return 0.0;
    };
    let per_m = 1.0 / last.interval.speed_mps[1].max(STALLED_MPS);
    let end_s = last.interval.begin_s + last.interval.dt_s;
    let mut variance = (noise.reading_mps * lasts_s(window) * per_m).powi(2);
    for row in window {
        let interval = &row.interval;
        let lever_s = end_s - interval.begin_s - 0.5 * interval.dt_s;
        let time_of = |acceleration: f64| acceleration * interval.dt_s * lever_s * per_m;
        let change = noise.change_share * interval.effort_change_n_per_kg;
        variance += time_of(noise.acceleration_mps2).powi(2) + time_of(change).powi(2);
        for (sum, force) in own.iter_mut().zip(model.own_n_per_kg(findings, row)) {
            *sum += time_of(force);
        }
    }
    // Where the window stands is known to about a metre, for locations are means over many readings: that is nothing beside the error of its first speed.
    variance
}

/// Over the rows in which the train pulled.
fn energy(believed: &Believed<'_>, findings: &Findings, effects: &Effects, rows: &[Row]) -> Option<Error> {
    if !findings.measured {
        return None;
    }
    let noise = &findings.calibrated.noise;
    let mut sum = Error::default();
    let mut own = [0.0; 3];
    for range in windows(rows) {
        let model = model_of(believed, findings, effects, rows, range.clone());
        let pulling = |row: &&Row| row.effort_n_per_kg > 0.0;
        // The error of a reading raises one interval by what it lowers the next: only those at the ends of a stretch are left.
        let mut last_end_s = f64::NEG_INFINITY;
        for row in rows[range].iter().filter(pulling) {
            let interval = &row.interval;
            let way_m = interval.mean_speed_mps() * interval.dt_s;
            let effects = model.effects.iter();
            let extra: f64 = effects.map(|effect| extra(believed, effect, row)).sum();
            sum.measured += row.effort_n_per_kg * way_m;
            sum.before -= row.residual_n_per_kg * way_m;
            sum.after += (extra - row.residual_n_per_kg) * way_m;
            let change = noise.change_share * interval.effort_change_n_per_kg;
            sum.floor += (noise.acceleration_mps2.powi(2) + change * change) * way_m * way_m;
            if interval.begin_s > last_end_s + 1e-6 {
                sum.floor += 2.0 * (noise.reading_mps * interval.mean_speed_mps()).powi(2);
            }
            last_end_s = interval.begin_s + interval.dt_s;
            for (sum, force) in own.iter_mut().zip(model.own_n_per_kg(findings, row)) {
                *sum += force * way_m;
            }
        }
    }
    sum.floor += own.iter().map(|sum| sum * sum).sum::<f64>();
    (sum.measured > 0.0).then_some(sum)
}

/// Errors of all runs together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Root mean squares, and the share that is gone.
    pub share: Share,
    /// Sum of what was measured.
    pub measured: f64,
    /// Of the believed model.
    pub before: Spread,
    /// Of the repaired model.
    pub after: Spread,
}

/// How the errors of the runs lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Mean error of a run.
    pub mean: f64,
    /// A tenth of the runs, half, and nine tenths lie below.
    pub quantiles: [f64; 3],
    /// Sum of the errors over the sum of what was measured.
    pub relative: f64,
}

impl Summary {
    /// `None` without a run.
    pub fn of(errors: &[Error]) -> Option<Self> {
        let measured: f64 = errors.iter().map(|e| e.measured).sum();
        let spread = |of: fn(&Error) -> f64| {
            let mut sorted: Vec<f64> = errors.iter().map(of).collect();
            sorted.sort_by(f64::total_cmp);
            let sum: f64 = sorted.iter().sum();
            Some(Spread {
                mean: sum / sorted.len() as f64,
                quantiles: [quantile(&sorted, 0.1)?, quantile(&sorted, 0.5)?, quantile(&sorted, 0.9)?],
                relative: sum / measured,
            })
        };
        let squares = |e: &Error| Squares::of(e.before, e.after, e.floor);
        let mut share = Share::of(&errors.iter().map(squares).collect::<Vec<_>>());
        // One value a run: what so few of them exceed the floor by chance is no gap.
        let chance = (1.0 + ONE_SIDED * (2.0 / errors.len() as f64).sqrt()).sqrt();
        if share.before < chance * share.floor {
            (share.removed, share.removed_95) = (None, None);
        }
        Some(Self { share, measured, before: spread(|e| e.before)?, after: spread(|e| e.after)? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn errors(before: f64, floor: f64) -> Vec<Error> {
        let sign = |i: i32| if i % 2 == 0 { 1.0 } else { -1.0 };
        let error = |i| Error { measured: 100.0, before: sign(i) * before, after: sign(i), floor };
        (0..10).map(error).collect()
    }

    #[test]
    fn errors_of_both_signs_count_and_what_chance_leaves_is_no_gap() {
        let told = Summary::of(&errors(3.0, 1.0)).unwrap();
        assert_eq!(told.share.before, 3.0);
        assert_eq!(told.share.removed, Some(1.0));
        assert_eq!((told.before.mean, told.measured), (0.0, 1000.0));
        assert_eq!(told.before.quantiles, [-3.0, 0.0, 3.0]);
        // Ten runs exceed their floor by a tenth in two cases of five.
        let chance = Summary::of(&errors(1.1, 1.0)).unwrap();
        assert_eq!(chance.share.removed, None);
        assert_eq!(Summary::of(&[]), None);
    }
}
