//! How the effort column is read, and how late it is.
//!
//! In: runs with an effort column. Out: the reading (momentary, or the mean since the sample before), the age of the
//! effort at its time stamp, and the runs with their efforts moved to where they belong.
//!
//! ```text
//! largest over reading, d and q:   -n ln(mean |y|) - d²/2 sd²        y = q u(d) - dv/dt - r - g: residual with the effort that is shown d later
//! ```
//!
//! where q is the gain of the column, for where the power limits an effort that reads too much looks like one that is
//! too old: it falls as the speed rises. n counts the intervals in which the effort changes: only these tell. Efforts
//! are resampled, not differentiated: a sample of 10 s is no small delay. An effect that is looked for is a tenth of a
//! switch of the regime.

use crate::config::NuisanceConfig;
use crate::data::believed::{Context, believed_load};
use crate::data::runs::{EffortReading, Run, usual_step_s};
use crate::data::{cut, interval::Interval};
use crate::readings::brakes::is_braked;
use rundown_check::figure::Figure;
use rundown_files::sample::Sample;
use rundown_files::statistics::{median, squares_about};

/// How the column is read, and how old it is.
#[derive(Clone, Copy, Debug, Default)]
pub struct Delay {
    pub reading: EffortReading,
    /// Age of the effort at its time stamp, s; put right in the runs if it is more than chance, told if it
    /// [matters](Self::matters).
    pub delay_s: Option<Figure>,
    /// Gain of log-likelihood over none.
    pub gain: f64,
    /// Usual time between samples, s.
    pub usual_s: f64,
}

impl Delay {
    /// It is beyond doubt, and large enough to be told.
    pub fn matters(&self, config: &NuisanceConfig, enough: f64) -> Option<Figure> {
        let sure = |delay: &Figure| delay.value.abs() > config.least_delay_s && delay.away_from(0.0) > config.sure;
        self.age_s(config).filter(|delay| sure(delay) && self.gain > enough)
    }

    /// The age as it is reported, s. Nothing smooths a speed for long: what is read best as a mean of long after is a
    /// momentary value that stands for the time around it.
    pub fn age_s(&self, config: &NuisanceConfig) -> Option<Figure> {
        let is_momentary =
            |mean: &Figure| self.reading == EffortReading::MeanSinceLast && mean.value < -config.most_early_s;
        let later = |age: Figure| Figure { value: age.value + 0.5 * self.usual_s, ..age };
        self.delay_s.map(|age| if is_momentary(&age) { later(age) } else { age })
    }

    /// How much later efforts are to be read, s, if that is more than chance. Half a second that no one need be told is
    /// 0.02 N/kg where the power limits a train that gains speed: a mean over the second before is that old.
    pub fn put_right_s(&self, enough: f64) -> Option<f64> {
        let late_s = self.delay_s.map(|delay| delay.value);
        late_s.filter(|late_s| *late_s != 0.0 && self.gain > enough)
    }
}

/// Residuals under one reading and delay, run by run: sum of their sizes, and how many there are.
type Sizes = Vec<(f64, f64)>;

fn read_later(run: &Run, reading: EffortReading, delay_s: f64, gap: f64) -> Run {
    let longest_s = gap * usual_step_s(run);
    let known: Vec<(f64, f64)> =
        run.samples.iter().filter_map(|sample| Some((sample.time_s, sample.effort_n_per_kg?))).collect();
    let at = |time_s: f64| {
        let after = known.partition_point(|(t, _)| *t < time_s);
        let (t1, u1) = *known.get(after)?;
        if t1 == time_s {
            return Some(u1);
        }
        let (t0, u0) = *known.get(after.checked_sub(1)?)?;
        (t1 - t0 <= longest_s).then(|| u0 + (u1 - u0) * (time_s - t0) / (t1 - t0))
    };
    // Impulse since the first sample: the mean since the one before, times that time.
    let mut impulse = 0.0;
    let impulses: Vec<(f64, f64)> = known
        .iter()
        .scan(None, |before: &mut Option<f64>, (t, u)| {
            impulse += before.map_or(0.0, |t0| u * (t - t0));
            *before = Some(*t);
            Some((*t, impulse))
        })
        .collect();
    let given = |time_s: f64| {
        let after = impulses.partition_point(|(t, _)| *t < time_s);
        let (t1, i1) = *impulses.get(after)?;
        if t1 == time_s {
            return Some(i1);
        }
        let (t0, i0) = *impulses.get(after.checked_sub(1)?)?;
        (t1 - t0 <= longest_s).then(|| i0 + (i1 - i0) * (time_s - t0) / (t1 - t0))
    };
    let mut before_s = None;
    let read = |sample: &Sample| {
        let time_s = sample.time_s + delay_s;
        let since_s: Option<f64> = before_s.replace(time_s);
        let effort_n_per_kg = match reading {
            EffortReading::Momentary => at(time_s),
            EffortReading::MeanSinceLast => since_s.and_then(|since_s| {
                let mean = (given(time_s)? - given(since_s)?) / (time_s - since_s);
                (time_s - since_s <= longest_s).then_some(mean)
            }),
        };
        Sample { effort_n_per_kg, ..*sample }
    };
    Run { samples: run.samples.iter().map(read).collect(), ..run.clone() }
}

/// The runs with their efforts read `delay_s` later.
pub fn put_right(context: &Context<'_>, runs: &[Run], reading: EffortReading, delay_s: f64) -> Vec<Run> {
    let gap = context.config.interval.gap;
    runs.iter().map(|run| read_later(run, reading, delay_s, gap)).collect()
}

/// Residuals of all moving intervals, with the gain that makes them smallest; of those in which trains brake not where
/// the readings of the brake are none.
fn sizes(context: &Context<'_>, runs: &[Run], reading: EffortReading, delay_s: f64, brakes: bool) -> Sizes {
    let moved: Vec<Run>;
    let runs = if delay_s == 0.0 {
        runs
    } else {
        moved = put_right(context, runs, reading, delay_s);
        &moved
    };
    let slowest_mps = context.config.interval.slowest_mps;
    let cut = cut::all(context, runs, reading);
    let of_run = |(run, intervals): (&Run, Vec<Interval>)| -> Vec<[f64; 2]> {
        let line = context.believed.line(run.direction);
        let moves = |i: &&Interval| i.speed_mps[0].min(i.speed_mps[1]) > slowest_mps;
        let moving = intervals.iter().filter(moves).filter(|i| brakes || !is_braked(context, run, i));
        let given = |i: &Interval| Some([i.effort_n_per_kg?, i.acceleration_mps2() + believed_load(line, i)]);
        moving.filter_map(given).collect()
    };
    let given: Vec<Vec<[f64; 2]>> = runs.iter().zip(cut).map(of_run).collect();
    let nuisance = &context.config.nuisance;
    let gain = gain(given.iter().flatten(), nuisance.most_sd * nuisance.effort_gain_sd);
    let of_run = |of_run: &Vec<[f64; 2]>| {
        let left: Vec<f64> = of_run.iter().map(|[effort, needed]| gain * effort - needed).collect();
        // What acts all through a run, such as its wind, is no age.
        let usual = median(&left).unwrap_or(0.0);
        (left.iter().map(|left| (left - usual).abs()).sum(), left.len() as f64)
    };
    given.iter().map(of_run).collect()
}

/// The multiple of the efforts that is nearest to those needed, in the mean of the distances: the median of the ratios,
/// weighed by the efforts.
fn gain<'a>(given: impl Iterator<Item = &'a [f64; 2]>, most: f64) -> f64 {
    let ratio = |[effort, needed]: &[f64; 2]| (*effort != 0.0).then(|| (needed / effort, effort.abs()));
    let mut ratios: Vec<(f64, f64)> = given.filter_map(ratio).collect();
    ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * ratios.iter().map(|(_, weight)| weight).sum::<f64>();
    let mut below = 0.0;
    let middle = ratios.iter().find(|(_, weight)| {
        below += weight;
        below >= half
    });
    middle.map_or(1.0, |(ratio, _)| ratio.clamp(1.0 - most, 1.0 + most))
}

fn mean(sizes: &Sizes, left_out: Option<usize>, groups: usize) -> f64 {
    let kept = sizes.iter().enumerate().filter(|(i, _)| left_out != Some(i % groups));
    let (sum, count) = kept.fold((0.0, 0.0), |(sum, count), (_, (s, c))| (sum + s, count + c));
    sum / f64::max(count, 1.0)
}

/// Runs from which the delay is found: more take time and say the same.
const MOST_RUNS: usize = 24;
/// Parts of the runs of which each is left out once.
const GROUPS: usize = 6;

/// Finds reading and delay. `brakes`: whether the readings of the brake count.
pub fn delay(context: &Context<'_>, runs: &[Run], brakes: bool) -> Delay {
    let (config, effort) = (&context.config.nuisance, &context.config.effort);
    let enough = context.config.search.enough;
    let every = runs.len().div_ceil(MOST_RUNS).max(1);
    let some: Vec<Run> = runs.iter().step_by(every).cloned().collect();
    let usual_s = median(some.iter().map(usual_step_s)).unwrap_or(10.0);
    let of = |reading, delay_s: f64| (delay_s, sizes(context, &some, reading, delay_s, brakes));
    let telling = telling(context, &some);
    let likelihood =
        |mean: f64, delay_s: f64| -telling * mean.max(1e-9).ln() - 0.5 * (delay_s / config.effort_delay_sd_s).powi(2);
    let most_s = config.most_sd * config.effort_delay_sd_s;
    let coarse_s = usual_s.clamp(1.0, 10.0) / 2.0;
    let best = |tried: &[(f64, Sizes)], left_out: Option<usize>| -> Option<(f64, f64)> {
        let each = tried.iter().map(|(d, sizes)| (*d, likelihood(mean(sizes, left_out, GROUPS), *d)));
        each.max_by(|a, b| a.1.total_cmp(&b.1))
    };
    let found = |reading: EffortReading| {
        let steps = (most_s / coarse_s).floor() as i32;
        // Efforts come late; early they are where the speed is late.
        let mut tried: Vec<(f64, Sizes)> = (-steps / 2..=steps).map(|i| of(reading, f64::from(i) * coarse_s)).collect();
        let (near_s, _) = best(&tried, None)?;
        let fine = (coarse_s / config.delay_step_s.max(0.01)).round() as i32;
        let around = (1 - fine..fine).filter(|i| *i != 0).map(|i| near_s + f64::from(i) * config.delay_step_s);
        tried.extend(around.map(|delay_s| of(reading, delay_s)));
        let (value, reached) = best(&tried, None)?;
        let parts = (0..GROUPS).filter_map(|part| best(&tried, Some(part))).map(|(d, _)| d);
        let scatter = squares_about(value, parts);
        let jackknife = (scatter * (GROUPS as f64 - 1.0) / GROUPS as f64).sqrt();
        let sd = jackknife.hypot(0.5 * config.delay_step_s);
        let none =
            tried.iter().find(|(d, _)| *d == 0.0).map_or(reached, |(_, s)| likelihood(mean(s, None, GROUPS), 0.0));
        Some((Delay { reading, delay_s: Some(Figure { value, sd }), gain: reached - none, usual_s }, reached))
    };
    let (Some((momentary, a)), Some((since_last, b))) =
        (found(EffortReading::Momentary), found(EffortReading::MeanSinceLast))
    else {
        return Delay::default();
    };
    // A mean that is half a sample late is a momentary value that is a whole one late, to the last digit but for
    // constant power; readings far apart miss so much that either may be the better guess.
    let is_fast = usual_s < effort.fast_s;
    let clearly = if is_fast { enough } else { -effort.mean_share.ln() * telling };
    // A mean in time is likelier than a momentary value that is just half a sample late.
    let needs_age = |delay: &Delay| delay.put_right_s(enough).is_some();
    let in_time = needs_age(&momentary) && !needs_age(&since_last) && b - since_last.gain + enough > a;
    if b - a > clearly || in_time { since_last } else { momentary }
}

/// Intervals between whose ends the effort changes.
fn telling(context: &Context<'_>, runs: &[Run]) -> f64 {
    let least = context.config.effort.telling_change_n_per_kg;
    let cut = cut::all(context, runs, EffortReading::Momentary);
    cut.iter().flatten().filter(|interval| interval.effort_step_n_per_kg.abs() > least).count() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::believed::tests::on_a_level_line;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rundown::model::direction::Direction;

    /// Runs of a train that powers, coasts and brakes by turns, read every `step` s. The effort column is `age` samples
    /// old.
    fn runs(context: &Context<'_>, step: usize, age: usize, reading: EffortReading) -> Vec<Run> {
        runs_rounded(context, 1.0, step, age, reading)
    }

    /// The same with speeds in steps of so many km/h.
    fn runs_rounded(context: &Context<'_>, kmh: f64, step: usize, age: usize, reading: EffortReading) -> Vec<Run> {
        let line = context.believed.line(Direction::Up);
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let one = |index: usize| {
            let (mut speed, mut location_m, mut until, mut effort) = (20.0, 2_000.0, 0, 0.0);
            let each: Vec<(f64, f64, f64)> = (0..1_200)
                .map(|second| {
                    if second >= until {
                        until = second + rng.random_range(25..70);
                        let power = if speed < 25.0 { 0.25 } else { -0.2 };
                        effort = if effort == 0.0 { power } else { 0.0 };
                    }
                    if effort > 0.0 {
                        // Of constant power.
                        effort = 6.0 / speed;
                    }
                    let shown = (speed, location_m, effort);
                    speed += effort - line.train.davis().resistance_n_per_kg(speed);
                    location_m += speed;
                    shown
                })
                .collect();
            let sample = |second: usize| {
                let now = second.saturating_sub(age * step);
                let past = &each[now.saturating_sub(step)..=now];
                let of_effort = match reading {
                    EffortReading::Momentary => each[now].2,
                    EffortReading::MeanSinceLast => past.iter().map(|(.., u)| u).sum::<f64>() / past.len() as f64,
                };
                Sample {
                    time_s: second as f64,
                    location_m: Some(each[second].1),
                    speed_mps: Some((3.6 * each[second].0 / kmh).round() * kmh / 3.6),
                    effort_n_per_kg: Some(of_effort),
                    ..Sample::default()
                }
            };
            Run {
                name: index.to_string(),
                direction: Direction::Up,
                day: None,
                samples: (0..1_200).step_by(step).map(sample).collect(),
                recorded: crate::data::runs::Recorded::default(),
            }
        };
        (0..12).map(one).collect()
    }

    #[test]
    fn an_effort_that_is_late_is_reported_and_one_that_is_not_is_left() {
        on_a_level_line(12, |context| {
            // What drives a second of these trains stands at its beginning: half a second early.
            for (step, late) in [(10, 1), (1, 3)] {
                for age in [0, late] {
                    let found = delay(context, &runs(context, step, age, EffortReading::Momentary), true);
                    let told = found.matters(&context.config.nuisance, context.config.search.enough);
                    assert_eq!(told.is_some(), age > 0, "{step} s, {found:?}");
                    let late_s = told.map_or(0.0, |delay| delay.value);
                    assert!((late_s - (age * step) as f64).abs() <= 0.5, "{step} s, {found:?}");
                    assert_eq!(found.reading, EffortReading::Momentary, "{step} s");
                }
            }
        });
    }

    #[test]
    fn a_mean_of_long_after_is_read_as_a_momentary_value() {
        let told = |reading, value| {
            let found = Delay { reading, delay_s: Some(Figure { value, sd: 0.2 }), gain: 50.0, usual_s: 10.0 };
            found.matters(&NuisanceConfig::default(), 5.0).map(|age| age.value)
        };
        use EffortReading::{MeanSinceLast, Momentary};
        // No speed is 6 s late; one that is a second late makes both a second early.
        for (reading, value, expected) in
            [(MeanSinceLast, -6.0, -1.0), (MeanSinceLast, -1.0, -1.0), (Momentary, -6.0, -6.0)]
        {
            assert_eq!(told(reading, value), Some(expected));
        }
        assert_eq!(told(MeanSinceLast, -5.0), None);
    }

    #[test]
    fn an_effort_that_reads_too_much_or_too_little_is_as_old_as_it_is() {
        on_a_level_line(12, |context| {
            for reading in [EffortReading::MeanSinceLast, EffortReading::Momentary] {
                let age = |gain: f64| {
                    let mut runs = runs(context, 10, 0, reading);
                    let samples = runs.iter_mut().flat_map(|run| &mut run.samples);
                    samples.filter_map(|s| s.effort_n_per_kg.as_mut()).for_each(|effort| *effort *= gain);
                    delay(context, &runs, true).delay_s.unwrap().value
                };
                assert_eq!([0.9, 0.95, 1.05, 1.1].map(age), [age(1.0); 4], "{reading:?}");
            }
        });
    }

    #[test]
    fn a_mean_since_the_sample_before_is_recognised_however_late_it_is() {
        on_a_level_line(12, |context| {
            for age in [0, 1] {
                let runs = runs(context, 10, age, EffortReading::MeanSinceLast);
                let found = delay(context, &runs, true);
                assert_eq!(found.reading, EffortReading::MeanSinceLast);
                assert!((found.delay_s.unwrap().value - 10.0 * age as f64).abs() <= 0.5, "{found:?}");
            }
        });
    }

    /// The same trains with more or less resistance in each run, or more in all, and the effort of the second before
    /// each sample: a momentary value that is half a second late would do nearly as well.
    #[test]
    fn a_mean_in_time_stays_one_beside_another_resistance() {
        on_a_level_line(12, |context| {
            for more_n_per_kg in [[0.01, -0.01], [0.015, 0.015]] {
                let mut runs = runs(context, 1, 1, EffortReading::Momentary);
                for (index, run) in runs.iter_mut().enumerate() {
                    for effort in run.samples.iter_mut().filter_map(|sample| sample.effort_n_per_kg.as_mut()) {
                        *effort -= more_n_per_kg[index % 2];
                    }
                }
                let found = delay(context, &runs, true);
                let right_s = found.put_right_s(context.config.search.enough);
                assert_eq!((found.reading, right_s), (EffortReading::MeanSinceLast, None), "{found:?}");
            }
        });
    }

    /// At 10 s so much is missed between two readings that this is left to the momentary ones.
    #[test]
    fn every_second_a_late_mean_is_no_momentary_value_that_is_half_a_second_later() {
        on_a_level_line(12, |context| {
            for age in [2, 3] {
                // The effort of a whole second before.
                let found = delay(context, &runs_rounded(context, 0.5, 1, age, EffortReading::Momentary), true);
                assert_eq!(found.reading, EffortReading::MeanSinceLast, "{found:?}");
                assert!((found.delay_s.unwrap().value - (age - 1) as f64).abs() <= 0.25, "{found:?}");
            }
        });
    }

    #[test]
    fn a_delay_of_a_whole_sample_moves_each_effort_by_one_row() {
        on_a_level_line(12, |context| {
            for reading in [EffortReading::Momentary, EffortReading::MeanSinceLast] {
                let [now, late] = [0, 1].map(|age| runs(context, 10, age, reading));
                let right = put_right(context, &late, reading, 10.0);
                let efforts = |runs: &[Run]| -> Vec<Option<f64>> {
                    runs[0].samples[2..100].iter().map(|sample| sample.effort_n_per_kg).collect()
                };
                for (a, b) in efforts(&right).into_iter().zip(efforts(&now)) {
                    assert!((a.unwrap() - b.unwrap()).abs() < 1e-9);
                }
            }
        });
    }
}
