//! The gap itself: recorded runs simulated with a model, against what was measured.
//!
//! In: hold-out runs, the believed model, the effects that were found. Out: the error of the simulated speed before and
//! after, and the noise floor: what a perfect model would leave with these sensors.
//!
//! Windows of up to 120 s begin at a measured speed; in them the train is driven by the recorded effort (measured, or
//! zero while coasting), or by the limits of the model where it powers fully. Resistance and limits of the effects come
//! from [`rundown::model::effects`], the code of the board.

use crate::config::HoldoutConfig;
use crate::data::believed::{Believed, Context, wind_n_per_kg};
use crate::data::interval::{Interval, Point, SAME_TIME_S};
use crate::data::rows::Row;
use crate::holdout::multiples::is_simulated;
use crate::holdout::share::{Multiple, Share, Squares, is_denied, multiple};
use crate::named::Named;
use crate::noise::calibrate::{Calibrated, Own};
use crate::noise::own_wind::own_wind;
use core::ops::Range;
use rundown::model::effects::{Effect, EffectError, Effects, Limits, SteadyWind};
use rundown::model::line::Line;
use std::collections::BTreeMap;

/// Step of the integration, s.
const STEP_S: f64 = 1.0;

/// A simulated speed beside the measured one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compared {
    pub run: usize,
    pub time_s: f64,
    /// Time since its window began at the measured speed, s; 0: no window but an interval of full power, or the mean
    /// speed between two locations.
    pub since_s: f64,
    pub location_m: f64,
    pub measured_mps: f64,
    /// Simulated less measured with the believed model, m/s.
    pub before_mps: f64,
    /// The same with the effects.
    pub after_mps: f64,
    /// Variance of the difference with a perfect model, (m/s)².
    pub floor: f64,
    /// The same with all that drivers may have done between two readings: by its inverse the speed weighs.
    pub variance: f64,
}

impl Compared {
    /// What the speed counts for: by how well a perfect model would foresee it.
    pub fn weight(&self, config: &HoldoutConfig) -> f64 {
        1.0 / self.variance.max(config.least_sd_mps.powi(2))
    }
}

/// Root mean squares over speeds compared, and the share of the gap that is gone: each counts by how well a perfect
/// model would foresee it.
pub fn gap(compared: &[Compared], config: &HoldoutConfig) -> Share {
    Share::of(&of_runs(compared.iter(), config), config)
}

/// The same of the speeds that the effects touch: where both models differ by a share of what a perfect one would
/// leave. `None`: hardly any.
pub fn touched(compared: &[Compared], config: &HoldoutConfig) -> Option<Touched> {
    let touches = |c: &&Compared| (c.after_mps - c.before_mps).powi(2) > config.touches.powi(2) * c.floor;
    let count = compared.iter().filter(touches).count();
    (count >= config.least_touched).then(|| {
        let runs = of_runs(compared.iter().filter(touches), config);
        Touched { count, share: Share::of(&runs, config), multiple: multiple(&runs, config) }
    })
}

/// What the effects touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touched {
    /// How many speeds.
    pub count: usize,
    /// The gap in them.
    pub share: Share,
    /// How many times as much as the effects foresee the measured speeds differ from the believed model, with the ends
    /// of its 95 % interval. It needs no floor.
    pub multiple: Option<Multiple>,
}

impl Touched {
    /// The multiple where it is surely less than what a name would leave.
    pub fn denying(&self, config: &HoldoutConfig) -> Option<Multiple> {
        self.multiple.filter(|multiple| is_denied(multiple, config))
    }
}

/// Sums of squares, run by run.
fn of_runs<'a>(compared: impl Iterator<Item = &'a Compared>, config: &HoldoutConfig) -> Vec<Squares> {
    let mut runs: BTreeMap<usize, Squares> = BTreeMap::new();
    for c in compared {
        let of_run = runs.entry(c.run).or_default();
        *of_run = of_run.and(&Squares::weighed(c.before_mps, c.after_mps, c.floor, c.weight(config)));
    }
    runs.into_values().collect()
}

/// Windows of adjacent rows.
pub fn windows(rows: &[Row], config: &HoldoutConfig) -> Vec<Range<usize>> {
    let end_s = |row: &Row| row.interval.begin_s + row.interval.dt_s;
    let mut windows = Vec::new();
    let mut begin = 0;
    while begin < rows.len() {
        let mut end = begin + 1;
        while end < rows.len()
            && rows[end].interval.follows
            && rows[end].interval.run == rows[begin].interval.run
            && (rows[end].interval.begin_s - end_s(&rows[end - 1])).abs() < SAME_TIME_S
            && end_s(&rows[end]) - rows[begin].interval.begin_s <= config.window_s
        {
            end += 1;
        }
        windows.push(begin..end);
        begin = end;
    }
    windows
}

/// The repaired model and the noise that it was found in.
#[derive(Clone, Copy)]
pub struct Repaired<'a> {
    pub context: &'a Context<'a>,
    pub calibrated: &'a Calibrated,
    pub measured: bool,
}

/// The repaired model in one window.
#[derive(Clone, Debug)]
pub struct RepairedModel {
    /// With the wind of this run, if winds are the effect.
    pub effects: Effects,
    /// Random effects of the run, which no model of other runs can know.
    own: Own,
}

impl Repaired<'_> {
    /// The repaired model in one window: where winds differ from run to run, with the wind that the run's other windows
    /// show.
    pub fn model(&self, effects: &Effects, rows: &[Row], window: Range<usize>) -> Result<RepairedModel, EffectError> {
        let mut own = self.calibrated.own;
        let spread_mps =
            effects.iter().find_map(|e| if let Effect::RunWind(wind) = e { Some(wind.sd_mps) } else { None });
        let (Some(spread_mps), Some(first)) = (spread_mps, rows.get(window.start)) else {
            return Ok(RepairedModel { effects: effects.clone(), own });
        };
        let others = rows[..window.start].iter().chain(&rows[window.end..]);
        let others = others.filter(|row| row.interval.run == first.interval.run);
        let noise = &self.calibrated.noise;
        let (headwind_mps, sd) = own_wind(others, &self.context.believed, effects, noise, spread_mps);
        own.wind_mps = sd;
        Ok(RepairedModel { effects: in_wind(effects, first.direction.sign() * headwind_mps)?, own })
    }

    /// Resistance by the run's own constant, wind and mass, one standard deviation of each, N/kg.
    pub fn own_n_per_kg(&self, model: &RepairedModel, row: &Row) -> [f64; 3] {
        let (r2, speed) = (self.context.believed.train().davis().r2, row.interval.mean_speed_mps());
        [
            model.own.constant_n_per_kg,
            2.0 * r2 * speed * model.own.wind_mps,
            (row.effort_n_per_kg - r2 * speed * speed) * model.own.mass,
        ]
    }

    /// Variances that a perfect model would leave of the speed at the end of each row of a window, (m/s)²: without what
    /// drivers may have done between two readings, and with all of it. The second is too much where a reading makes
    /// good what the one before missed.
    fn floors(&self, model: &RepairedModel, window: &[Row]) -> Vec<[f64; 2]> {
        let reading = 2.0 * self.calibrated.noise.reading_mps.powi(2);
        let (mut walks, mut own) = ([0.0; 2], [0.0; 3]);
        let floors = |row: &Row| {
            let dt_s = row.interval.dt_s;
            let disturbances =
                [self.calibrated.noise.disturbance(&row.interval), self.calibrated.disturbance(self.context, row)];
            walks.iter_mut().zip(disturbances).for_each(|(walk, disturbance)| *walk += disturbance * dt_s * dt_s);
            for (sum, force) in own.iter_mut().zip(self.own_n_per_kg(model, row)) {
                *sum += force * dt_s;
            }
            walks.map(|walk| reading + walk + own.iter().map(|sum| sum * sum).sum::<f64>())
        };
        window.iter().map(floors).collect()
    }

    /// Simulates each window of adjacent rows with and without the effects.
    pub fn resisted(&self, effects: &Effects, rows: &[Row]) -> Result<Vec<Compared>, EffectError> {
        let believed = &self.context.believed;
        let mut compared = Vec::new();
        for range in windows(rows, &self.context.config.holdout) {
            let window = &rows[range.clone()];
            let model = self.model(effects, rows, range)?;
            let before = simulate(believed, &Effects::NONE, window);
            let after = simulate(believed, &model.effects, window);
            for (i, (row, [floor, variance])) in window.iter().zip(self.floors(&model, window)).enumerate() {
                let interval = &row.interval;
                compared.push(Compared {
                    run: interval.run,
                    time_s: interval.begin_s + interval.dt_s,
                    since_s: interval.begin_s + interval.dt_s - window[0].interval.begin_s,
                    location_m: interval.path[interval.path.len() - 1].location_m,
                    measured_mps: interval.speed_mps[1],
                    before_mps: before[i] - interval.speed_mps[1],
                    after_mps: after[i] - interval.speed_mps[1],
                    floor,
                    variance,
                });
            }
        }
        Ok(compared)
    }
}

/// The same effects and this wind, in the `up` direction; a storm that no board takes is none: something else is wrong
/// in the run, and the effects are right or not.
fn in_wind(effects: &Effects, wind_mps: f64) -> Result<Effects, EffectError> {
    let steady = effects.iter().find_map(|e| if let Effect::SteadyWind(wind) = e { Some(wind.wind_mps) } else { None });
    let blowing = |wind_mps: f64| Effect::SteadyWind(SteadyWind { wind_mps: wind_mps + steady.unwrap_or(0.0) });
    let both = Some(blowing(wind_mps)).filter(|wind| wind.check().is_ok()).unwrap_or_else(|| blowing(0.0));
    let others = effects.iter().filter(|effect| !matches!(effect, Effect::SteadyWind(_) | Effect::RunWind(_)));
    Effects::try_new(std::iter::once(both).chain(others.cloned()))
}

/// What the effort of a row leaves at a point after resistance, gradient and effects; a brake gives what the effects
/// leave of it.
pub fn acceleration_mps2(line: &Line<'_>, effects: &Effects, row: &Row, point: &Point) -> f64 {
    let moment = &row.moment(point);
    let (location_m, speed) = (moment.location_m, moment.speed_mps);
    let davis = line.train.davis();
    let effort = if moment.effort_n_per_kg < 0.0 {
        let limits = effects.limits(line.train, location_m, speed);
        moment.effort_n_per_kg * limits.brake_n_per_kg / Limits::of(line.train).brake_n_per_kg
    } else {
        moment.effort_n_per_kg
    };
    let in_still_air = effort
        - davis.resistance_n_per_kg(speed)
        - line.gradient_n_per_kg(location_m)
        - effects.resistance_n_per_kg(line, &davis, moment);
    row.interval.wind_mps.map_or(in_still_air, |wind_mps| in_still_air - wind_n_per_kg(line, speed, wind_mps))
}

/// Where an interval begins, m. `sign`: of its direction. The points of its path are the middles of its parts.
pub fn begin_m(interval: &Interval, sign: f64) -> f64 {
    let part_s = interval.dt_s / interval.path.len() as f64;
    interval.path[0].location_m - sign * interval.speed_mps[0] * 0.5 * part_s
}

/// Where it ends, m.
pub fn end_m(interval: &Interval, sign: f64) -> f64 {
    let part_s = interval.dt_s / interval.path.len() as f64;
    interval.path[interval.path.len() - 1].location_m + sign * interval.speed_mps[1] * 0.5 * part_s
}

/// Speeds at the ends of the rows of a window, driven by their efforts.
fn simulate(believed: &Believed<'_>, effects: &Effects, window: &[Row]) -> Vec<f64> {
    let line = believed.line(window[0].direction);
    let sign = line.direction.sign();
    let mut speed = window[0].interval.speed_mps[0];
    let mut location_m = begin_m(&window[0].interval, sign);
    let mut speeds = Vec::with_capacity(window.len());
    for row in window {
        let interval = &row.interval;
        let steps = (interval.dt_s / STEP_S).ceil().max(1.0);
        let dt = interval.dt_s / steps;
        for k in 0..steps as usize {
            let since_departure_s = interval.path[k * interval.path.len() / steps as usize].since_departure_s;
            let point = Point { location_m, speed_mps: speed, since_departure_s };
            let acceleration = acceleration_mps2(line, effects, row, &point);
            location_m += sign * (speed * dt + 0.5 * acceleration * dt * dt);
            speed = (speed + acceleration * dt).max(0.0);
        }
        speeds.push(speed);
    }
    speeds
}

/// The effects that act on motion or limits, as the board takes them; readings are put right before anything is
/// compared.
pub fn effects<'a>(named: impl IntoIterator<Item = &'a Named>) -> Result<Effects, EffectError> {
    Effects::try_new(named.into_iter().filter(|one| is_simulated(&one.effect)).map(|one| one.effect.clone()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_speed_that_would_be_foreseen_without_any_error_weighs_no_more_than_the_best() {
        let one = |variance: f64| Compared {
            run: 0,
            time_s: 0.0,
            since_s: 0.0,
            location_m: 0.0,
            measured_mps: 20.0,
            before_mps: 0.2,
            after_mps: 0.0,
            floor: variance,
            variance,
        };
        let share = gap(&[one(0.0), one(1e-4)], &HoldoutConfig::default());
        assert!((share.before - 0.2).abs() < 1e-12 && (share.floor - 0.5_f64.sqrt() * 0.01).abs() < 1e-12, "{share:?}");
    }

    #[test]
    fn a_run_whose_wind_would_be_a_storm_has_none_of_its_own() {
        let effects = Effects::try_new([Effect::SteadyWind(SteadyWind { wind_mps: 2.0 })]).unwrap();
        let wind_mps = |own_mps: f64| {
            let effects = in_wind(&effects, own_mps).unwrap();
            effects
                .iter()
                .map(|effect| serde_json::to_value(effect).unwrap()["wind_mps"].as_f64().unwrap())
                .sum::<f64>()
        };
        assert_eq!(wind_mps(-5.0), -3.0);
        assert_eq!(wind_mps(-43.87), 2.0, "and no refusal that speaks of a wind");
    }

    #[test]
    fn a_ninth_effect_is_an_error_and_readings_are_no_effects_of_the_motion() {
        let named = |effect: Effect| Named::plain(effect, Vec::new(), 9.0, 30.0);
        let winds = |count| (0..count).map(|_| named(SteadyWind { wind_mps: 1.0 }.into())).collect::<Vec<_>>();
        let wheel = named(rundown::model::effects::SpeedScale { measured_over_true: 1.01 }.into());
        assert!(effects(winds(8).iter().chain([&wheel])).is_ok_and(|effects| effects.iter().count() == 8));
        assert!(matches!(effects(&winds(9)), Err(EffectError::TooMany { most: 8 })));
    }
}
