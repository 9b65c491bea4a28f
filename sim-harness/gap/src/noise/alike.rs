//! Runs that are driven alike, as by an automatic train, are rounded alike: at the same place and the same speed the
//! error of a reading is the same in each.
//!
//! In: rows, and the step of their speeds. Out: how many times as wide each counts, and what such errors look like in
//! the rows.
//!
//! Readings of two runs at one place are equal with a probability that says by how much the speeds differ, and these
//! what the errors of rounding have in common:
//!
//! ```text
//! P(equal) = 1 - E|d|/q        d ~ N(0, σ²): E|d| = 0.8 σ        correlation = exp(-2π² σ²/q²)
//! ```
//!
//! Of n rows whose errors have the correlation ρ each says 1/(1 + (n - 1) ρ) of what it would say alone.
//!
//! Where the same speed is read over a long way, as where it is held, its error changes slowly from place to place: one
//! error holds for a share of that way.

use crate::config::NoiseConfig;
use crate::data::{believed::Context, rows::Row};
use crate::noise::whitening::Noise;
use core::f64::consts::PI;
use rundown::model::direction::Direction;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

/// A mean of the size of a normal number, in its standard deviations.
const MEAN_SIZE: f64 = 0.8;

/// A reading at an end of a row: direction, place, and speed in whole steps.
type ReadAt = (bool, i64, i64);

/// Which readings have one error: the first place of a part of the way over which the speed is read.
struct Parts(HashMap<ReadAt, i64>);

impl Parts {
    /// Of all readings.
    fn of(readings: impl Iterator<Item = ReadAt>, config: &NoiseConfig) -> Self {
        let mut places: BTreeMap<(bool, i64), BTreeSet<i64>> = BTreeMap::new();
        readings.for_each(|(up, place, steps)| _ = places.entry((up, steps)).or_default().insert(place));
        let mut parts = HashMap::new();
        for ((up, steps), places) in places {
            let places: Vec<i64> = places.into_iter().collect();
            // A place without a reading is no end.
            for way in places.chunk_by(|before, place| place - before <= 2) {
                let length_m = (way[way.len() - 1] - way[0] + 1) as f64 * config.alike_m;
                let part_m = (config.alike_share * length_m).min(config.alike_most_m);
                let part = (part_m / config.alike_m).floor().max(1.0) as i64;
                parts.extend(way.iter().map(|place| ((up, *place, steps), way[0] + (place - way[0]) / part * part)));
            }
        }
        Self(parts)
    }

    fn part(&self, (up, place, steps): ReadAt) -> ReadAt {
        (up, self.0.get(&(up, place, steps)).copied().unwrap_or(place), steps)
    }
}

/// What rows have alike by the rounding of their speeds.
pub struct Alike<'a> {
    context: &'a Context<'a>,
    rows: &'a [Row],
    /// Correlation of the errors of rounding with those of other runs at the place of each row.
    correlation: Vec<f64>,
    parts: Parts,
}

/// Where an end of a row is, and what was read there.
fn node(row: &Row, end: usize, config: &NoiseConfig, step_mps: f64) -> ReadAt {
    let path = &row.interval.path;
    let at_m = [path[0], path[path.len() - 1]][end].location_m;
    let place = (at_m / config.alike_m).floor() as i64;
    (row.direction == Direction::Up, place, (row.interval.speed_mps[end] / step_mps).round() as i64)
}

impl<'a> Alike<'a> {
    /// `None`: the speeds have no step, or the runs are not driven alike.
    pub fn of(context: &'a Context<'a>, rows: &'a [Row]) -> Option<Self> {
        let (config, step_mps) = (&context.config.noise, context.conditions.speed_step_mps);
        if step_mps <= 0.0 {
            return None;
        }
        // By direction, longer place, and whether the speed changes fast: then readings at one place differ however
        // alike the runs are, and their errors are many.
        let group = |row: &Row, (up, place, _): ReadAt| {
            let longer = (place as f64 * config.alike_m / config.alike_over_m).floor() as i64;
            let change_mps = (row.interval.speed_mps[1] - row.interval.speed_mps[0]).abs();
            (up, longer, change_mps > config.alike_steps * step_mps)
        };
        // Pairs of runs, and among them those with equal readings.
        let mut pairs: BTreeMap<(bool, i64, bool), [u32; 2]> = BTreeMap::new();
        let mut at: HashMap<(bool, i64, bool), Vec<(usize, i64)>> = HashMap::new();
        for row in rows {
            let read = node(row, 0, config, step_mps);
            let of_row @ (up, _, is_fast) = group(row, read);
            let (_, place, steps) = read;
            let here = at.entry((up, place, is_fast)).or_default();
            let [all, equal] = pairs.entry(of_row).or_default();
            for (_, other) in here.iter().filter(|(run, _)| *run != row.interval.run) {
                *all += 1;
                *equal += u32::from(*other == steps);
            }
            here.push((row.interval.run, steps));
        }
        let correlation_of = |[all, equal]: [u32; 2]| {
            let apart = (1.0 - f64::from(equal) / f64::from(all.max(1))) / MEAN_SIZE;
            let correlation = (-2.0 * PI * PI * apart * apart).exp();
            if all >= config.alike_pairs && correlation >= config.least_alike { correlation } else { 0.0 }
        };
        let of_row = |row: &Row| {
            pairs.get(&group(row, node(row, 0, config, step_mps))).map_or(0.0, |pairs| correlation_of(*pairs))
        };
        let correlation: Vec<f64> = rows.iter().map(of_row).collect();
        let alike = correlation.iter().filter(|one| **one > 0.0).count();
        (alike as f64 > config.alike_rows * rows.len() as f64).then(|| {
            let readings = rows.iter().flat_map(|row| [0, 1].map(|end| node(row, end, config, step_mps)));
            Self { context, rows, correlation, parts: Parts::of(readings, config) }
        })
    }

    fn node(&self, row: &Row, end: usize) -> ReadAt {
        self.parts.part(node(row, end, &self.context.config.noise, self.context.conditions.speed_step_mps))
    }

    /// By which factor the standard deviation of each row is wider, so that all of them say together what they know.
    pub fn wider(&self, noise: &Noise) -> Vec<f64> {
        let mut runs: HashMap<[ReadAt; 2], HashSet<usize>> = HashMap::new();
        let ends = |row: &Row| [0, 1].map(|end| self.node(row, end));
        for row in self.rows {
            runs.entry(ends(row)).or_default().insert(row.interval.run);
        }
        let of_row = |(row, correlation): (&Row, &f64)| {
            let read = 2.0 * (noise.reading_mps / row.interval.dt_s).powi(2);
            let share = read / (read + noise.disturbance(&row.interval)).max(f64::MIN_POSITIVE);
            let others = runs.get(&ends(row)).map_or(0, |runs| runs.len() - 1);
            (1.0 + others as f64 * correlation * share).sqrt()
        };
        self.rows.iter().zip(&self.correlation).map(of_row).collect()
    }

    /// One standard deviation of the common error of each reading, as the acceleration has it in the rows before and
    /// behind it, N/kg.
    pub fn forces(&self) -> Vec<Vec<f64>> {
        let reading_mps = self.context.conditions.speed_step_mps / 12.0_f64.sqrt();
        let mut all: BTreeMap<ReadAt, Vec<(usize, f64)>> = BTreeMap::new();
        for (i, (row, correlation)) in self.rows.iter().zip(&self.correlation).enumerate() {
            let force = correlation.sqrt() * reading_mps / row.interval.dt_s;
            if force > 0.0 {
                all.entry(self.node(row, 0)).or_default().push((i, force));
                all.entry(self.node(row, 1)).or_default().push((i, -force));
            }
        }
        let column = |entries: Vec<(usize, f64)>| {
            let mut column = vec![0.0; self.rows.len()];
            entries.into_iter().for_each(|(i, force)| column[i] += force);
            column
        };
        all.into_values().map(column).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::believed::{Conditions, tests::on_a_level_line};
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, Normal};

    const STEP_MPS: f64 = 1.0 / 3.6;
    const RUNS: usize = 20;
    const NOISE: Noise = Noise { reading_mps: 0.08, acceleration_mps2: 0.0, change_share: 0.0 };

    /// Rows of 10 s of runs that coast down from speeds which differ by so much, standard deviation, m/s. Out: the
    /// rows, and the mean of what rounding makes of each row's acceleration.
    fn rows(apart_mps: f64) -> (Vec<Row>, Vec<f64>) {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let apart = Normal::new(0.0, apart_mps).unwrap();
        let (mut rows, mut errors) = (Vec::new(), vec![0.0; 60]);
        for run in 0..RUNS {
            let (mut at_m, mut speed_mps) = (0.0, 30.0 + apart.sample(&mut random));
            for error in &mut errors {
                let after_mps = speed_mps - 0.2 - 0.002 * speed_mps;
                let read = |mps: f64| (mps / STEP_MPS).round() * STEP_MPS;
                let mut row = Row::coasting(Direction::Up, at_m, read(speed_mps));
                row.interval.run = run;
                row.interval.speed_mps[1] = read(after_mps);
                let to_m = at_m + 5.0 * (speed_mps + after_mps);
                let points = row.interval.path.len() - 1;
                for (i, point) in row.interval.path.iter_mut().enumerate() {
                    point.location_m = at_m + (to_m - at_m) * i as f64 / points as f64;
                }
                *error += (row.interval.speed_mps[1] - read(speed_mps) - after_mps + speed_mps) / 10.0 / RUNS as f64;
                rows.push(row);
                (at_m, speed_mps) = (to_m, after_mps);
            }
        }
        (rows, errors)
    }

    fn with_step<T>(then: impl FnOnce(&Context<'_>) -> T) -> T {
        on_a_level_line(RUNS, |context| {
            let conditions = Conditions { speed_step_mps: STEP_MPS, ..context.conditions };
            then(&Context { conditions, ..*context })
        })
    }

    fn mean_square(values: &[f64]) -> f64 {
        values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64
    }

    #[test]
    fn runs_that_are_one_run_again_and_again_say_what_one_says() {
        let (rows, errors) = rows(0.001);
        with_step(|context| {
            let alike = Alike::of(context, &rows).unwrap();
            let variances: Vec<f64> = alike.wider(&NOISE).iter().map(|wider| wider * wider).collect();
            let mean = variances.iter().sum::<f64>() / variances.len() as f64;
            assert!((0.7 * RUNS as f64..=RUNS as f64).contains(&mean), "{mean}");
            // As large as the errors that all runs have.
            let forces = alike.forces();
            let drawn: Vec<f64> =
                (0..60).map(|i| forces.iter().map(|force| force[i] * force[i]).sum::<f64>()).collect();
            let share = drawn.iter().sum::<f64>() / 60.0 / mean_square(&errors);
            assert!((0.6..1.7).contains(&share), "{share}");
        });
    }

    /// Rows of 10 s of runs that hold 30 m/s, as well as a controller does on slopes; each begins at another place.
    /// Out: the rows, and by place what rounding makes of the acceleration over a way of 1.2 km, mean squares.
    fn held() -> (Vec<Row>, f64) {
        let speed_mps = |at_m: f64| 30.0 + 0.08 * (at_m / 900.0).sin() + 0.05 * (at_m / 370.0).cos();
        let mut rows = Vec::new();
        for run in 0..RUNS {
            for i in 0..60 {
                let at_m = 15.0 * run as f64 + 300.0 * f64::from(i);
                let mut row = Row::coasting(Direction::Up, at_m, 30.0);
                row.interval.run = run;
                row.interval.speed_mps =
                    [0.0, 300.0].map(|on_m| (speed_mps(at_m + on_m) / STEP_MPS).round() * STEP_MPS);
                let points = row.interval.path.len() - 1;
                for (i, point) in row.interval.path.iter_mut().enumerate() {
                    point.location_m = at_m + 300.0 * i as f64 / points as f64;
                }
                rows.push(row);
            }
        }
        let error = |at_m: f64| (speed_mps(at_m) / STEP_MPS).round() * STEP_MPS - speed_mps(at_m);
        let over = |at_m: f64| (error(at_m + 1_200.0) - error(at_m)) / 40.0;
        (rows, mean_square(&(0..150).map(|i| over(100.0 * f64::from(i))).collect::<Vec<_>>()))
    }

    #[test]
    fn runs_that_gather_speed_and_then_hold_it_are_alike_where_they_hold_it() {
        let mut rows = held().0;
        rows.retain(|row| row.interval.path[0].location_m < 3_000.0);
        let held = rows.len();
        for run in 0..RUNS {
            for i in 0..8 {
                let at_m = 4_000.0 + 13.0 * run as f64 + 25.0 * f64::from(i);
                let mut row = Row::coasting(Direction::Up, at_m, 30.0);
                row.interval.run = run;
                row.interval.speed_mps = [0.0, 100.0].map(|on_m| 10.0 + 0.04 * (at_m - 4_000.0 + on_m));
                row.interval.path.iter_mut().for_each(|point| point.location_m = at_m);
                rows.push(row);
            }
        }
        with_step(|context| {
            let correlation = Alike::of(context, &rows).unwrap().correlation;
            let mean = |of: &[f64]| of.iter().sum::<f64>() / of.len() as f64;
            assert!(mean(&correlation[..held]) > 0.8, "{}", mean(&correlation[..held]));
            assert!(mean(&correlation[held..]) < 0.1, "{}", mean(&correlation[held..]));
        });
    }

    #[test]
    fn a_speed_that_is_held_has_one_error_for_a_long_way() {
        let (rows, truth) = held();
        with_step(|context| {
            let forces = Alike::of(context, &rows).unwrap().forces();
            // The mean of all rows within a way of 1.2 km, as the errors that are drawn make it.
            let drawn = (0..40).map(|i| {
                let from_m = 400.0 * f64::from(i);
                let within = |row: &Row| (from_m..from_m + 1_200.0).contains(&row.interval.path[0].location_m);
                let of: Vec<usize> = (0..rows.len()).filter(|i| within(&rows[*i])).collect();
                let mean = |force: &Vec<f64>| of.iter().map(|i| force[*i]).sum::<f64>() / of.len() as f64;
                forces.iter().map(|force| mean(force).powi(2)).sum::<f64>()
            });
            let drawn = drawn.sum::<f64>() / 40.0;
            assert!((0.4..2.5).contains(&(drawn / truth)), "{}", drawn / truth);
        });
    }

    #[test]
    fn runs_of_which_each_is_another_stay_as_they_are() {
        for apart_mps in [0.3, 1.0, 3.0] {
            let (rows, errors) = rows(apart_mps);
            assert!(mean_square(&errors).sqrt() < 0.5 * STEP_MPS / 6.0_f64.sqrt() / 10.0, "{apart_mps} m/s");
            with_step(|context| assert!(Alike::of(context, &rows).is_none(), "{apart_mps} m/s"));
        }
        on_a_level_line(RUNS, |context| assert!(Alike::of(context, &self::rows(0.001).0).is_none(), "no step"));
    }
}
