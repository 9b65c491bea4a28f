//! The gap itself: recorded runs simulated with a model, against what was measured.
//!
//! In: runs that took no part in the analysis, the believed model, the effects that were found. Out: the error of the simulated speed before and after, and
//! the noise floor: what a perfect model would leave with these sensors.
//!
//! Windows of [`WINDOW_S`] begin at a measured speed; in them the train is driven by the recorded effort (measured, or zero while coasting), or by the limits of the
//! model where it pulls with full power. Resistance and limits of the effects come from [`rundown::model::effects`], the code of the board.

use super::analysis::Findings;
use super::calibrate::Own;
use super::own_wind::own_wind;
use super::rows::{Believed, Row};
use super::runs::Interval;
use super::share::{LEAST_REMOVABLE, Share, Squares};
use core::ops::Range;
use rundown::model::effects::{Effect, Effects, Limits, Moment, SteadyWind};
use rundown::model::line::Line;
use std::collections::BTreeMap;

/// Length of a window, s.
pub const WINDOW_S: f64 = 120.0;
/// Step of the integration, s.
const STEP_S: f64 = 1.0;

/// A simulated speed beside the measured one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compared {
    /// Index of the run.
    pub run: usize,
    /// Time, s.
    pub time_s: f64,
    /// Time since its window began at the measured speed, s; 0: no window but an interval of full power, or the mean speed between two locations.
    pub since_s: f64,
    /// Location, m.
    pub location_m: f64,
    /// Measured, m/s.
    pub measured_mps: f64,
    /// Simulated less measured with the believed model, m/s.
    pub before_mps: f64,
    /// The same with the effects.
    pub after_mps: f64,
    /// Variance of the difference with a perfect model, (m/s)².
    pub floor: f64,
}

/// Root mean squares over all that was compared.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gap {
    /// With the believed model, m/s.
    pub before_mps: f64,
    /// With the effects, m/s.
    pub after_mps: f64,
    /// What a perfect model would leave, m/s.
    pub floor_mps: f64,
    /// Share of the removable gap that is gone, 0 to 1; 1 where there was none.
    pub removed_share: f64,
    /// Its 95 % interval from whole runs drawn anew; none where nothing was to be removed, or with too few runs.
    pub removed_95: Option<(f64, f64)>,
    /// Runs with speeds that were compared.
    pub runs: usize,
}

impl Gap {
    /// There was something to remove.
    pub fn is_removable(&self) -> bool {
        let floor = self.floor_mps.powi(2);
        self.before_mps.powi(2) - floor > LEAST_REMOVABLE * floor
    }

    /// Share of the removable gap that is gone; `None` where there was none.
    pub fn removed(&self) -> Option<f64> {
        self.is_removable().then_some(self.removed_share)
    }

    /// The repaired model is further off than the believed one.
    pub fn is_worse(&self) -> bool {
        self.after_mps > self.before_mps
    }

    /// Over speeds compared.
    pub fn of(compared: &[Compared]) -> Self {
        let share = Share::of(&of_runs(compared));
        Self {
            before_mps: share.before,
            after_mps: share.after,
            floor_mps: share.floor,
            removed_share: share.removed.unwrap_or(1.0),
            removed_95: share.removed_95,
            runs: share.runs,
        }
    }
}

/// Sums of squares, run by run.
fn of_runs(compared: &[Compared]) -> Vec<Squares> {
    let mut runs: BTreeMap<usize, Squares> = BTreeMap::new();
    for c in compared {
        let of_run = runs.entry(c.run).or_default();
        *of_run = of_run.and(&Squares::of(c.before_mps, c.after_mps, c.floor));
    }
    runs.into_values().collect()
}

/// Windows of adjacent rows.
pub fn windows(rows: &[Row]) -> Vec<Range<usize>> {
    let end_s = |row: &Row| row.interval.begin_s + row.interval.dt_s;
    let mut windows = Vec::new();
    let mut begin = 0;
    while begin < rows.len() {
        let mut end = begin + 1;
        while end < rows.len()
            && rows[end].interval.follows
            && rows[end].interval.run == rows[begin].interval.run
            && (rows[end].interval.begin_s - end_s(&rows[end - 1])).abs() < 1e-6
            && end_s(&rows[end]) - rows[begin].interval.begin_s <= WINDOW_S
        {
            end += 1;
        }
        windows.push(begin..end);
        begin = end;
    }
    windows
}

/// The repaired model in one window.
#[derive(Clone, Debug)]
pub struct Model {
    /// With the wind of this run, if winds are the effect.
    pub effects: Effects,
    /// What the run has for itself, which no model of other runs can know.
    own: Own,
}

impl Model {
    /// Resistance by the run's own constant, wind and mass, one standard deviation of each, N/kg.
    pub fn own_n_per_kg(&self, findings: &Findings, row: &Row) -> [f64; 3] {
        let (r2, speed) = (findings.believed_r2, row.interval.mean_speed_mps());
        [
            self.own.constant_n_per_kg,
            2.0 * r2 * speed * self.own.wind_mps,
            (row.effort_n_per_kg - r2 * speed * speed) * self.own.mass,
        ]
    }
}

/// The repaired model in one window: where winds differ from run to run, with the wind that the run's other windows tell.
pub fn model_of(
    believed: &Believed<'_>,
    findings: &Findings,
    effects: &Effects,
    rows: &[Row],
    window: Range<usize>,
) -> Model {
    let mut own = findings.calibrated.own;
    let spread_mps = effects.iter().find_map(|effect| match effect {
        Effect::RunWind(wind) => Some(wind.sd_mps),
        _ => None,
    });
    let (Some(spread_mps), Some(first)) = (spread_mps, rows.get(window.start)) else {
        return Model { effects: effects.clone(), own };
    };
    let others = rows[..window.start].iter().chain(&rows[window.end..]);
    let others = others.filter(|row| row.interval.run == first.interval.run);
    let noise = &findings.calibrated.noise;
    let (headwind_mps, sd) = own_wind(others, believed, effects, noise, spread_mps);
    own.wind_mps = sd;
    Model { effects: in_wind(effects, first.direction.sign() * headwind_mps), own }
}

/// Simulates each window of adjacent rows with and without the effects.
pub fn resisted(believed: &Believed<'_>, findings: &Findings, effects: &Effects, rows: &[Row]) -> Vec<Compared> {
    let noise = &findings.calibrated.noise;
    let mut compared = Vec::new();
    for range in windows(rows) {
        let window = &rows[range.clone()];
        let model = model_of(believed, findings, effects, rows, range);
        let before = simulate(believed, &Effects::NONE, window);
        let after = simulate(believed, &model.effects, window);
        let (mut walk, mut own) = (0.0, [0.0; 3]);
        for (i, row) in window.iter().enumerate() {
            let interval = &row.interval;
            let change = noise.change_share * interval.effort_change_n_per_kg;
            walk += (noise.acceleration_mps2.powi(2) + change * change) * interval.dt_s * interval.dt_s;
            for (sum, force) in own.iter_mut().zip(model.own_n_per_kg(findings, row)) {
                *sum += force * interval.dt_s;
            }
            let own = own.iter().map(|sum| sum * sum).sum::<f64>();
            compared.push(Compared {
                run: interval.run,
                time_s: interval.begin_s + interval.dt_s,
                since_s: interval.begin_s + interval.dt_s - window[0].interval.begin_s,
                location_m: interval.path[interval.path.len() - 1].location_m,
                measured_mps: interval.speed_mps[1],
                before_mps: before[i] - interval.speed_mps[1],
                after_mps: after[i] - interval.speed_mps[1],
                floor: 2.0 * noise.reading_mps * noise.reading_mps + walk + own,
            });
        }
    }
    compared
}

/// The same effects and this wind, in the `up` direction.
fn in_wind(effects: &Effects, wind_mps: f64) -> Effects {
    let steady = effects.iter().find_map(|effect| match effect {
        Effect::SteadyWind(wind) => Some(wind.wind_mps),
        _ => None,
    });
    let both = Effect::SteadyWind(SteadyWind { wind_mps: wind_mps + steady.unwrap_or(0.0) });
    let mut all = Effects::NONE;
    let others = effects.iter().filter(|effect| !matches!(effect, Effect::SteadyWind(_) | Effect::RunWind(_)));
    for effect in std::iter::once(both).chain(others.cloned()) {
        // There were as many before.
        if all.push(effect).is_err() {
            break;
        }
    }
    all
}

/// A train at this place and speed, driven as it was in this row.
pub fn moment_at(row: &Row, location_m: f64, speed_mps: f64, since_departure_s: f64) -> Moment {
    Moment {
        location_m,
        speed_mps,
        effort_n_per_kg: row.effort_n_per_kg,
        since_departure_s,
        stood_s: None,
        braked: row.interval.braked,
        temperature_c: row.interval.temperature_c,
        day: row.interval.day,
    }
}

/// What the effort leaves after resistance, gradient and effects; a brake gives what the effects leave of it.
pub fn acceleration_mps2(line: &Line<'_>, effects: &Effects, moment: &Moment) -> f64 {
    let (location_m, speed) = (moment.location_m, moment.speed_mps);
    let davis = line.train.davis();
    let effort = if moment.effort_n_per_kg < 0.0 {
        let limits = effects.limits(line.train, location_m, speed);
        moment.effort_n_per_kg * limits.brake_n_per_kg / Limits::of(line.train).brake_n_per_kg
    } else {
        moment.effort_n_per_kg
    };
    effort
        - davis.resistance_n_per_kg(speed)
        - line.gradient_n_per_kg(location_m)
        - effects.resistance_n_per_kg(line, &davis, moment)
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
            let since_s = interval.path[k * interval.path.len() / steps as usize].since_departure_s;
            let moment = moment_at(row, location_m, speed, since_s);
            let acceleration = acceleration_mps2(line, effects, &moment);
            location_m += sign * (speed * dt + 0.5 * acceleration * dt * dt);
            speed = (speed + acceleration * dt).max(0.0);
        }
        speeds.push(speed);
    }
    speeds
}

/// The effects that act on motion or limits, as the board takes them.
pub fn effects(named: &[super::named::Named]) -> Effects {
    let mut effects = Effects::NONE;
    for one in named {
        // Readings were put right before anything was compared.
        if matches!(one.effect, Effect::SpeedScale(_) | Effect::LocationLag(_)) {
            continue;
        }
        // A list that is full takes no more; the largest come first.
        if effects.push(one.effect.clone()).is_err() {
            break;
        }
    }
    effects
}
