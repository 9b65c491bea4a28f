//! The gap itself: recorded runs simulated with a model, against what was measured.
//!
//! In: runs that took no part in the analysis, the believed model, the effects that were found. Out: the error of the simulated speed before and after, and
//! the noise floor: what a perfect model would leave with these sensors.
//!
//! Windows of [`WINDOW_S`] begin at a measured speed; in them the train is driven by the recorded effort (measured, or zero while coasting), or by the limits of the
//! model where it pulls with full power. Resistance and limits of the effects come from [`rundown::effects`], the code of the board.

use super::analysis::Findings;
use super::caps::{self, Pull};
use super::own_wind::own_wind;
use super::rows::{Believed, Row};
use rundown::effects::{Effect, Effects, Limits, Moment, SteadyWind};
use rundown::track::Direction;

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

    /// Over speeds compared.
    pub fn of(compared: &[Compared]) -> Self {
        let n = compared.len().max(1) as f64;
        let mean = |of: &dyn Fn(&Compared) -> f64| compared.iter().map(of).sum::<f64>() / n;
        let before = mean(&|c| c.before_mps * c.before_mps);
        let after = mean(&|c| c.after_mps * c.after_mps);
        let floor = mean(&|c| c.floor);
        // In mean squares: errors of model and sensors add up in them.
        let removable = before - floor;
        let removed_share = if removable > LEAST_REMOVABLE * floor {
            ((before - after) / removable).clamp(0.0, 1.0)
        } else {
            1.0
        };
        Self {
            before_mps: before.sqrt(),
            after_mps: after.sqrt(),
            floor_mps: floor.sqrt(),
            removed_share,
        }
    }
}

/// A gap above the noise floor by a smaller share of it is none, in mean squares.
const LEAST_REMOVABLE: f64 = 0.02;

/// Simulates each window of adjacent rows with and without the effects.
pub fn resisted(
    believed: &Believed<'_>,
    findings: &Findings,
    effects: &Effects,
    rows: &[Row],
) -> Vec<Compared> {
    let none = Effects::NONE;
    let spread_mps = effects.iter().find_map(|effect| match effect {
        Effect::RunWind(wind) => Some(wind.sd_mps),
        _ => None,
    });
    let mut compared = Vec::new();
    let mut begin = 0;
    while begin < rows.len() {
        let mut end = begin + 1;
        let duration = |end: usize| {
            let last: &Row = &rows[end];
            last.interval.begin_s + last.interval.dt_s - rows[begin].interval.begin_s
        };
        while end < rows.len()
            && rows[end].interval.follows
            && rows[end].interval.run == rows[begin].interval.run
            && (rows[end].interval.begin_s
                - rows[end - 1].interval.begin_s
                - rows[end - 1].interval.dt_s)
                .abs()
                < 1e-6
            && duration(end) <= WINDOW_S
        {
            end += 1;
        }
        let window = &rows[begin..end];
        let noise = &findings.calibrated.noise;
        // What a run has for itself, no model of other runs can know.
        let mut own = findings.calibrated.own;
        let before = simulate(believed, &none, window);
        // But its wind, if winds are the effect: from its other windows.
        let after = if let Some(spread_mps) = spread_mps {
            let run = window[0].interval.run;
            let others = rows[..begin].iter().chain(&rows[end..]);
            let others = others.filter(|row| row.interval.run == run);
            let (headwind_mps, sd) = own_wind(others, believed, effects, noise, spread_mps);
            own.wind_mps = sd;
            let wind_mps = window[0].direction.sign() * headwind_mps;
            simulate(believed, &in_wind(effects, wind_mps), window)
        } else {
            simulate(believed, effects, window)
        };
        let (mut walk, mut by_wind, mut by_mass, mut by_constant) = (0.0, 0.0, 0.0, 0.0);
        for (i, row) in window.iter().enumerate() {
            let interval = &row.interval;
            let change = noise.change_share * interval.effort_change_n_per_kg;
            walk +=
                (noise.acceleration_mps2.powi(2) + change * change) * interval.dt_s * interval.dt_s;
            let (r2, speed) = (findings.believed_r2, interval.mean_speed_mps());
            by_wind += 2.0 * r2 * speed * own.wind_mps * interval.dt_s;
            by_mass += (row.effort_n_per_kg - r2 * speed * speed) * own.mass * interval.dt_s;
            by_constant += own.constant_n_per_kg * interval.dt_s;
            let own = by_wind * by_wind + by_mass * by_mass + by_constant * by_constant;
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
        begin = end;
    }
    compared
}

/// The same effects and this wind, in the `up` direction.
fn in_wind(effects: &Effects, wind_mps: f64) -> Effects {
    let steady = effects.iter().find_map(|effect| match effect {
        Effect::SteadyWind(wind) => Some(wind.wind_mps),
        _ => None,
    });
    let both = Effect::SteadyWind(SteadyWind {
        wind_mps: wind_mps + steady.unwrap_or(0.0),
    });
    let mut all = Effects::NONE;
    let others = effects
        .iter()
        .filter(|effect| !matches!(effect, Effect::SteadyWind(_) | Effect::RunWind(_)));
    for effect in std::iter::once(both).chain(others.cloned()) {
        // There were as many before.
        if all.push(effect).is_err() {
            break;
        }
    }
    all
}

/// Speeds at the ends of the rows of a window, driven by their efforts.
fn simulate(believed: &Believed<'_>, effects: &Effects, window: &[Row]) -> Vec<f64> {
    let line = believed.line(window[0].direction);
    let davis = line.train.davis();
    let sign = line.direction.sign();
    let first = &window[0].interval;
    let mut speed = first.speed_mps[0];
    let mut location_m =
        first.path[0].location_m - sign * speed * 0.5 * first.dt_s / first.path.len() as f64;
    let mut speeds = Vec::with_capacity(window.len());
    for row in window {
        let interval = &row.interval;
        let steps = (interval.dt_s / STEP_S).ceil().max(1.0);
        let dt = interval.dt_s / steps;
        for k in 0..steps as usize {
            let since = interval.path[k * interval.path.len() / steps as usize].since_departure_s;
            let moment = Moment {
                location_m,
                speed_mps: speed,
                effort_n_per_kg: row.effort_n_per_kg,
                since_departure_s: since,
                braked: interval.braked,
                temperature_c: interval.temperature_c,
                day: interval.day,
            };
            let effort = if row.effort_n_per_kg < 0.0 {
                let limits = effects.limits(line.train, location_m, speed);
                row.effort_n_per_kg * limits.brake_n_per_kg / Limits::of(line.train).brake_n_per_kg
            } else {
                row.effort_n_per_kg
            };
            let acceleration = effort
                - davis.resistance_n_per_kg(speed)
                - line.gradient_n_per_kg(location_m)
                - effects.resistance_n_per_kg(line, &davis, &moment);
            location_m += sign * (speed * dt + 0.5 * acceleration * dt * dt);
            speed = (speed + acceleration * dt).max(0.0);
        }
        speeds.push(speed);
    }
    speeds
}

/// Pulling at full power: the change of speed that limit and driver's share foresee, against the one that was.
pub fn pulled(
    believed: &Believed<'_>,
    direction: Direction,
    effects: &Effects,
    pulls: &[Pull],
    dt_s: f64,
) -> Vec<Compared> {
    let train = believed.line(direction).train;
    let none = Effects::NONE;
    let limit = |effects: &Effects, pull: &Pull| {
        effects
            .limits(train, pull.location_m, pull.speed_mps)
            .traction_n_per_kg(pull.speed_mps)
            / train.max_effort_n_per_kg(pull.speed_mps)
    };
    // What the driver asks for in this pull: what it shows where no limit of the effects holds it back. Held back all the way, it was some share between
    // what the train gives and everything.
    let asked = |parts: &[&Pull]| {
        let free = parts.iter().filter(|part| {
            let limit = limit(effects, part);
            limit > 0.99 && limit < 1.01 || part.ratio < limit - 2.0 * part.sd
        });
        let mut ratios: Vec<f64> = free.map(|part| part.ratio).collect();
        ratios.sort_by(f64::total_cmp);
        match ratios.get(ratios.len() * 4 / 5) {
            Some(ratio) => *ratio,
            None => {
                let given = parts.iter().map(|part| limit(effects, part));
                let given = given.fold(1.0, f64::min);
                given.max(0.5 * (1.0 + given))
            }
        }
    };
    let mut compared = Vec::new();
    for parts in caps::by_number(pulls) {
        for by_power in [false, true] {
            let parts: Vec<&Pull> = parts.iter().filter(|p| p.by_power() == by_power).collect();
            if parts.is_empty() {
                continue;
            }
            let asked = asked(&parts);
            compared.extend(parts.into_iter().map(|pull| {
                let most = train.max_effort_n_per_kg(pull.speed_mps);
                let error = |effects: &Effects| {
                    (asked.min(limit(effects, pull)) - pull.ratio) * most * dt_s
                };
                Compared {
                    run: pull.run,
                    time_s: 0.0,
                    since_s: 0.0,
                    location_m: pull.location_m,
                    measured_mps: pull.speed_mps,
                    before_mps: error(&none),
                    after_mps: error(effects),
                    floor: (pull.sd * most * dt_s).powi(2),
                }
            }));
        }
    }
    compared
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
