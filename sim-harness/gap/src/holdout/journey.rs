//! Running time and energy at the wheel of hold-out runs, with and without the effects.
//!
//! | compared | how |
//! |---|---|
//! | running time | each window of up to 120 s begins at the measured speed and place; the train is driven by the recorded effort, place by place. The time until it is where the window ends, less the time that was measured, summed over a run |
//! | energy | what the traction has to give at the wheel on the speeds that were measured: the effort that each model needs, times the distance, over the intervals in which the train powered, less what the effort column says |
//!
//! Both are errors: zero is right. Floor: what the noise of these sensors, and per-run random effects, leave of them
//! with a perfect model.

use crate::config::HoldoutConfig;
use crate::data::interval::{Point, SAME_TIME_S};
use crate::data::{believed::Believed, rows::Row};
use crate::explained::extra;
use crate::holdout::forward::{Repaired, RepairedModel, acceleration_mps2, begin_m, end_m, windows};
use crate::holdout::share::{Share, Squares};
use rundown::model::effects::{EffectError, Effects};
use rundown_files::statistics::{quantile, sorted};

/// Step of the integration, s.
const STEP_S: f64 = 1.0;

/// A measured value of one run, and the errors of both models in it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Error {
    pub measured: f64,
    /// Believed model less measured.
    pub before: f64,
    /// Repaired model less measured.
    pub after: f64,
    /// Variance of the difference with a perfect model.
    pub floor: f64,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Journey {
    /// Index of the run among those compared.
    pub run: usize,
    /// Running time over its windows, s.
    pub time_s: Error,
    pub windows: usize,
    /// Windows in which a simulated train did not arrive; they count in neither model.
    pub stalled: usize,
    /// Energy at the wheel for each kg of rotating mass, J/kg; none without an effort column, or where the train never
    /// powered.
    pub energy_j_per_kg: Option<Error>,
}

fn lasts_s(window: &[Row]) -> f64 {
    let ends = window.first().zip(window.last());
    ends.map_or(0.0, |(first, last)| last.interval.begin_s + last.interval.dt_s - first.interval.begin_s)
}

/// Time until a train with these effects is where the window ends, s.
fn covers_in(believed: &Believed<'_>, effects: &Effects, window: &[Row], config: &HoldoutConfig) -> Option<f64> {
    let first = window.first()?;
    let line = believed.line(first.direction);
    let sign = line.direction.sign();
    let ends_m: Vec<f64> = window.iter().map(|row| end_m(&row.interval, sign)).collect();
    let end_m = *ends_m.last()?;
    let (mut location_m, mut speed) = (begin_m(&first.interval, sign), first.interval.speed_mps[0]);
    let since_s = first.interval.path[0].since_departure_s;
    let (mut at, mut time_s) = (0, 0.0);
    let most_s = config.most_time * lasts_s(window);
    while sign * (end_m - location_m) > 0.0 {
        // The driver does at each place what was done there.
        while at + 1 < window.len() && sign * (location_m - ends_m[at]) >= 0.0 {
            at += 1;
        }
        let point = Point { location_m, speed_mps: speed, since_departure_s: since_s + time_s };
        let acceleration = acceleration_mps2(line, effects, &window[at], &point);
        let next_mps = speed + acceleration * STEP_S;
        let step_m = STEP_S * (speed + 0.5 * acceleration * STEP_S);
        let left_m = sign * (end_m - location_m);
        if next_mps < config.stalled_mps || time_s > most_s {
            return None;
        }
        if step_m >= left_m {
            // Within a step the speed is nearly the same: its mean over what is left.
            let mean_mps = speed + 0.5 * acceleration * STEP_S * left_m / step_m;
            return Some(time_s + left_m / mean_mps.max(config.stalled_mps));
        }
        location_m += sign * step_m;
        speed = next_mps;
        time_s += STEP_S;
    }
    (time_s > 0.0).then_some(time_s)
}

impl Repaired<'_> {
    /// Of the rows of one run. `None`: no window could be covered.
    pub fn journey(&self, effects: &Effects, rows: &[Row]) -> Result<Option<Journey>, EffectError> {
        let Some(first) = rows.first() else {
            return Ok(None);
        };
        let mut journey =
            Journey { run: first.interval.run, energy_j_per_kg: self.energy(effects, rows)?, ..Journey::default() };
        let (believed, config) = (&self.context.believed, &self.context.config.holdout);
        // Of the run's own constant, wind and mass: the same in all its windows, so these add up before they are
        // squared.
        let mut own = [0.0; 3];
        for range in windows(rows, config) {
            let window = &rows[range.clone()];
            let model = self.model(effects, rows, range)?;
            let before = covers_in(believed, &Effects::NONE, window, config);
            let after = covers_in(believed, &model.effects, window, config);
            let (Some(before_s), Some(after_s)) = (before, after) else {
                journey.stalled += 1;
                continue;
            };
            let measured_s = lasts_s(window);
            journey.windows += 1;
            journey.time_s.measured += measured_s;
            journey.time_s.before += before_s - measured_s;
            journey.time_s.after += after_s - measured_s;
            journey.time_s.floor += self.time_floor(&model, window, &mut own);
        }
        journey.time_s.floor += own.iter().map(|sum| sum * sum).sum::<f64>();
        Ok((journey.windows > 0).then_some(journey))
    }

    /// Variance of the time over a window without the run's random effects, which are added to `own`. A change of speed
    /// at t moves the end of the window by (T - t) times it.
    fn time_floor(&self, model: &RepairedModel, window: &[Row], own: &mut [f64; 3]) -> f64 {
        let noise = &self.calibrated.noise;
        let Some(last) = window.last() else {
            return 0.0;
        };
        let per_m = 1.0 / last.interval.speed_mps[1].max(self.context.config.holdout.stalled_mps);
        let end_s = last.interval.begin_s + last.interval.dt_s;
        let mut variance = (noise.reading_mps * lasts_s(window) * per_m).powi(2);
        for row in window {
            let interval = &row.interval;
            let lever_s = end_s - interval.begin_s - 0.5 * interval.dt_s;
            let time_of = |acceleration: f64| acceleration * interval.dt_s * lever_s * per_m;
            variance += time_of(noise.disturbance(interval).sqrt()).powi(2);
            for (sum, force) in own.iter_mut().zip(self.own_n_per_kg(model, row)) {
                *sum += time_of(force);
            }
        }
        // Where the window stands is known to about a metre, for locations are means over many readings: that is
        // nothing beside the error of its first speed.
        variance
    }

    /// Over the rows in which the train powers.
    fn energy(&self, effects: &Effects, rows: &[Row]) -> Result<Option<Error>, EffectError> {
        if !self.measured {
            return Ok(None);
        }
        let noise = &self.calibrated.noise;
        let mut sum = Error::default();
        let mut own = [0.0; 3];
        for range in windows(rows, &self.context.config.holdout) {
            let model = self.model(effects, rows, range.clone())?;
            let powering = |row: &&Row| row.effort_n_per_kg > 0.0;
            // The error of a reading raises one interval by what it lowers the next: only those at the ends of a
            // stretch are left.
            let mut last_end_s = f64::NEG_INFINITY;
            for row in rows[range].iter().filter(powering) {
                let interval = &row.interval;
                let distance_m = interval.mean_speed_mps() * interval.dt_s;
                let effects = model.effects.iter();
                let extra: f64 = effects.map(|effect| extra(&self.context.believed, effect, row)).sum();
                sum.measured += row.effort_n_per_kg * distance_m;
                sum.before -= row.residual_n_per_kg * distance_m;
                sum.after += (extra - row.residual_n_per_kg) * distance_m;
                sum.floor += noise.disturbance(interval) * distance_m * distance_m;
                if interval.begin_s > last_end_s + SAME_TIME_S {
                    sum.floor += 2.0 * (noise.reading_mps * interval.mean_speed_mps()).powi(2);
                }
                last_end_s = interval.begin_s + interval.dt_s;
                for (sum, force) in own.iter_mut().zip(self.own_n_per_kg(&model, row)) {
                    *sum += force * distance_m;
                }
            }
        }
        sum.floor += own.iter().map(|sum| sum * sum).sum::<f64>();
        Ok((sum.measured > 0.0).then_some(sum))
    }
}

/// Errors of all runs together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Root mean squares, and the share that is gone.
    pub share: Share,
    pub measured: f64,
    pub before: Spread,
    pub after: Spread,
}

/// How the errors of the runs lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    pub mean: f64,
    /// A tenth of the runs, half, and nine tenths lie below.
    pub quantiles: [f64; 3],
    /// Sum of the errors over the sum of what was measured.
    pub relative: f64,
}

impl Summary {
    /// `None` without a run.
    pub fn of(errors: &[Error], config: &HoldoutConfig) -> Option<Self> {
        let measured: f64 = errors.iter().map(|e| e.measured).sum();
        let spread = |of: fn(&Error) -> f64| {
            let sorted = sorted(errors.iter().map(of));
            let sum: f64 = sorted.iter().sum();
            Some(Spread {
                mean: sum / sorted.len() as f64,
                quantiles: [quantile(&sorted, 0.1)?, quantile(&sorted, 0.5)?, quantile(&sorted, 0.9)?],
                relative: sum / measured,
            })
        };
        let squares = |e: &Error| Squares::of(e.before, e.after, e.floor);
        let mut share = Share::of(&errors.iter().map(squares).collect::<Vec<_>>(), config);
        // One value a run: what so few of them exceed the floor by chance is no gap.
        let chance = (1.0 + config.one_sided * (2.0 / errors.len() as f64).sqrt()).sqrt();
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
    fn errors_of_both_signs_count_and_what_noise_leaves_is_no_gap() {
        let summary = Summary::of(&errors(3.0, 1.0), &HoldoutConfig::default()).unwrap();
        assert_eq!(summary.share.before, 3.0);
        assert_eq!(summary.share.removed, Some(1.0));
        assert_eq!((summary.before.mean, summary.measured), (0.0, 1000.0));
        assert_eq!(summary.before.quantiles, [-3.0, 0.0, 3.0]);
        // Ten runs exceed their floor by a tenth in two cases of five.
        let chance = Summary::of(&errors(1.1, 1.0), &HoldoutConfig::default()).unwrap();
        assert_eq!(chance.share.removed, None);
        assert_eq!(Summary::of(&[], &HoldoutConfig::default()), None);
    }
}
