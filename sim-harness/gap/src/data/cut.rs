//! Runs cut into intervals of about 10 s, of 3 s after a start.
//!
//! In: a [`Run`], the believed train and track. Out: [`Interval`]s: the change of speed over each, the path travelled
//! in it, the effort if it was measured.

use crate::config::IntervalConfig;
use crate::data::believed::{Context, believed_load};
use crate::data::efforts::Efforts;
use crate::data::interval::{Interval, POINTS, Point};
use crate::data::nodes::{Node, Nodes};
use crate::data::runs::{EffortReading, Run, usual_step_s};
use rundown::model::line::Line;
use rundown_files::sample::Sample;
use rundown_files::statistics::median;
use std::collections::BTreeSet;

pub fn all(context: &Context<'_>, runs: &[Run], effort: EffortReading) -> Vec<Vec<Interval>> {
    let config = &context.config.interval;
    let names: BTreeSet<&str> =
        runs.iter().map(|run| run.recorded.unit.as_str()).filter(|unit| !unit.is_empty()).collect();
    let of = |(i, run): (usize, &Run)| {
        let unit = names.iter().position(|unit| *unit == run.recorded.unit);
        let efforts = Efforts { samples: &run.samples, reading: effort, config };
        Cut { run, unit, line: context.believed.line(run.direction), efforts, config }.intervals(i)
    };
    runs.iter().enumerate().map(of).collect()
}

struct Cut<'a> {
    run: &'a Run,
    unit: Option<usize>,
    line: &'a Line<'a>,
    efforts: Efforts<'a>,
    config: &'a IntervalConfig,
}

impl Cut<'_> {
    fn intervals(&self, index: usize) -> Vec<Interval> {
        let usual_s = usual_step_s(self.run);
        let nodes = Nodes { run: self.run, line: self.line, efforts: self.efforts }.read(usual_s);
        let Some(departure_s) = self.departure_s() else {
            return Vec::new();
        };
        let mut intervals = Vec::with_capacity(nodes.len());
        let mut braked = false;
        let longest_s = self.config.gap * usual_s.max(self.config.length_s);
        let stood_s = self.stood_s();
        let mut last_end = None;
        for pair in nodes.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            if to.time_s - from.time_s > longest_s {
                last_end = None;
                continue;
            }
            let mut interval = self.interval(index, &from, &to, departure_s);
            interval.stood_s = stood_s[from.sample];
            interval.follows = last_end == Some(from.sample);
            braked = braked || self.brakes(&interval, &from, &to);
            interval.braked = braked;
            intervals.push(interval);
            last_end = Some(to.sample);
        }
        if self.efforts.reading == EffortReading::Momentary {
            self.doubt_coasts(&mut intervals);
        }
        intervals
    }

    /// Between two momentary readings of nothing a handle may have been moved and moved back. What the motion of such
    /// an interval asks for tells: it is further from that of its stretch of coasting than an effort may change, or,
    /// where hardly another one follows, from nothing. Its effort is then not known.
    fn doubt_coasts(&self, intervals: &mut [Interval]) {
        let coasts = |i: &Interval| {
            let least = self.config.coasting_n_per_kg;
            i.effort_change_n_per_kg <= least && i.effort_n_per_kg.is_some_and(|effort| effort.abs() <= least)
        };
        let follows = |before: &Interval, next: &Interval| next.follows && coasts(before) == coasts(next);
        for stretch in intervals.chunk_by_mut(follows).filter(|stretch| coasts(&stretch[0])) {
            let asks = |i: &Interval| i.acceleration_mps2() + believed_load(self.line, i);
            let usual =
                median(stretch.iter().map(asks)).filter(|_| stretch.len() >= self.config.least_coast).unwrap_or(0.0);
            for interval in stretch {
                if (asks(interval) - usual).abs() > self.config.most_change_n_per_kg {
                    interval.effort_n_per_kg = None;
                }
            }
        }
    }

    fn interval(&self, run: usize, from: &Node, to: &Node, departure_s: f64) -> Interval {
        let dt_s = to.time_s - from.time_s;
        let sign = self.line.direction.sign();
        let by_speed_m = 0.5 * dt_s * (from.speed_mps + to.speed_mps);
        // What is left between the distance by speed and by location goes evenly over the interval.
        let rest_m = (to.location_m - from.location_m) - sign * by_speed_m;
        let path = core::array::from_fn(|i| {
            let share = (i as f64 + 0.5) / POINTS as f64;
            let t = share * dt_s;
            let acceleration = (to.speed_mps - from.speed_mps) / dt_s;
            Point {
                location_m: from.location_m + sign * (from.speed_mps * t + 0.5 * acceleration * t * t) + share * rest_m,
                speed_mps: from.speed_mps + acceleration * t,
                since_departure_s: (from.time_s + t - departure_s).max(0.0),
            }
        });
        let effort = self.efforts.mean_and_change(from.sample, to.sample).map(|(mean, change)| {
            let held = self.held(from, to, &path);
            (mean + 0.5 * held, change + held.abs())
        });
        // Of fewer than two readings within an interval it would be that of neighbours.
        let bends = to.effort_change_n_per_kg.zip(from.effort_change_n_per_kg).filter(|_| to.sample >= from.sample + 3);
        let bend = bends.map_or(0.0, |(end, begin)| end - begin);
        Interval {
            run,
            unit: self.unit,
            begin_s: from.time_s,
            dt_s,
            speed_mps: [from.speed_mps, to.speed_mps],
            effort_n_per_kg: effort.map(|(mean, _)| mean),
            effort_change_n_per_kg: effort.map_or(0.0, |(_, change)| change),
            effort_step_n_per_kg: to.effort_n_per_kg - from.effort_n_per_kg,
            effort_bend_n_per_kg: bend,
            temperature_c: self.run.samples[to.sample].temperature_c,
            wind_mps: self.wind_mps(from.sample, to.sample),
            day: self.run.day,
            stood_s: None,
            braked: false,
            follows: false,
            path,
        }
    }

    /// Mean of the measured headwind from one sample to another, if each of them has it.
    fn wind_mps(&self, from: usize, to: usize) -> Option<f64> {
        let samples = &self.run.samples[from..=to];
        let sum = samples.iter().try_fold(0.0, |sum, sample| Some(sum + sample.headwind_mps?))?;
        Some(sum / samples.len() as f64)
    }

    /// The brake was applied in an interval. A brake test of some seconds may lie between two readings of the effort:
    /// the speed shows that it was less than both.
    fn brakes(&self, interval: &Interval, from: &Node, to: &Node) -> bool {
        // One that is not measured at all may be anywhere: any run may have braked.
        let Some(effort) = interval.effort_n_per_kg else {
            return true;
        };
        let by_speed = || interval.acceleration_mps2() + believed_load(self.line, interval);
        let least = self.efforts.at(from.sample).min(self.efforts.at(to.sample));
        effort < self.config.braked_n_per_kg || by_speed() < least.max(0.0) - self.config.brake_test_n_per_kg
    }

    /// A driver who holds the speed follows the gradient with the effort: between two momentary readings it is u - g
    /// that changes evenly. What this adds to the mean effort, N/kg. Whether the driver did is not known: half of it is
    /// added, and the mean counts as that much less certain.
    fn held(&self, from: &Node, to: &Node, path: &[Point; POINTS]) -> f64 {
        let (before, after) = (self.efforts.at(from.sample), self.efforts.at(to.sample));
        let powered = before > 0.0 && after > 0.0;
        let held = (to.speed_mps - from.speed_mps).abs() < self.config.held_mps;
        if self.efforts.reading != EffortReading::Momentary || to.sample != from.sample + 1 || !powered || !held {
            return 0.0;
        }
        let along = path.iter().map(|p| self.line.gradient_n_per_kg(p.location_m)).sum::<f64>() / POINTS as f64;
        let ends = [from, to].map(|node| self.line.gradient_n_per_kg(node.location_m));
        let steeper = ends[1] - ends[0];
        if (after - before - steeper).abs() > self.config.held_share * steeper.abs()
            && steeper.abs() > self.config.held_least_n_per_kg
        {
            // The effort did not follow the gradient.
            return 0.0;
        }
        along - 0.5 * (ends[0] + ends[1])
    }

    /// When the train first moves, s.
    fn departure_s(&self) -> Option<f64> {
        let moving = |sample: &&Sample| sample.speed_mps.is_some_and(|v| v > self.config.departed_mps);
        self.run.samples.iter().find(moving).map(|sample| sample.time_s)
    }

    /// How long the train had stood before its last start, or stands already, at each sample, s; `None`: since before
    /// the run.
    fn stood_s(&self) -> Vec<Option<f64>> {
        let (mut departed, mut since_s, mut stood_s) = (false, None, None);
        let of = |sample: &Sample| {
            let moves = sample.speed_mps.map(|v| v > self.config.departed_mps);
            departed |= moves == Some(true);
            if departed && moves == Some(false) {
                stood_s = Some(sample.time_s - *since_s.get_or_insert(sample.time_s));
            } else if moves == Some(true) {
                since_s = None;
            }
            stood_s
        };
        self.run.samples.iter().map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::believed::tests::on_a_level_line;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, Normal};

    const NOISE_N_PER_KG: f64 = 0.01;

    /// What an effort that falls by 0.025 N/kg from row to row says.
    fn falling_n_per_kg(row: usize) -> f64 {
        0.6 - 0.025 * row as f64
    }

    /// Intervals of runs at 20 m/s with such an effort and noise.
    fn intervals(effort: EffortReading) -> Vec<Interval> {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let noise = Normal::new(0.0, NOISE_N_PER_KG).unwrap();
        let mut sample = |row: usize| {
            let time_s = 10.0 * row as f64;
            Sample {
                time_s,
                location_m: Some(20.0 * time_s),
                speed_mps: Some(20.0),
                effort_n_per_kg: Some(falling_n_per_kg(row) + noise.sample(&mut rng)),
                ..Sample::default()
            }
        };
        let mut run = || Run { samples: (0..20).map(&mut sample).collect(), ..Run::default() };
        let runs: Vec<Run> = (0..200).map(|_| run()).collect();
        on_a_level_line(runs.len(), |context| all(context, &runs, effort)).concat()
    }

    /// Noise of an interval's effort.
    fn noise_n_per_kg(interval: &Interval) -> f64 {
        interval.effort_n_per_kg.unwrap() - falling_n_per_kg((interval.begin_s / 10.0).round() as usize + 1)
    }

    #[test]
    fn the_noise_of_a_mean_is_in_neither_its_change_nor_its_step() {
        // The last of a run has none after it.
        let mut intervals = intervals(EffortReading::MeanSinceLast);
        intervals.retain(|interval| interval.begin_s < 175.0);
        let count = intervals.len() as f64;
        let with_step: f64 = intervals.iter().map(|i| noise_n_per_kg(i) * (i.effort_step_n_per_kg + 0.025)).sum();
        assert!((with_step / count / NOISE_N_PER_KG.powi(2)).abs() < 0.05, "{with_step}");
        let steady = intervals.iter().filter(|interval| interval.effort_change_n_per_kg < 0.025);
        let noise: Vec<f64> = steady.map(noise_n_per_kg).collect();
        assert!(noise.len() as f64 > 0.2 * count, "{}", noise.len());
        let mean = noise.iter().sum::<f64>() / noise.len() as f64;
        assert!(mean.abs() < 0.1 * NOISE_N_PER_KG, "{mean}");
    }

    /// Of a train that coasts and, between two momentary readings of nothing in each of the given rows, brakes.
    fn coasts(braked: &[usize]) -> Vec<Option<f64>> {
        on_a_level_line(1, |context| {
            let resistance = |mps: f64| context.believed.train().davis().resistance_n_per_kg(mps);
            let mut speed_mps = 30.0;
            let sample = |row: usize| {
                let brake = if braked.contains(&row) { 0.08 } else { 0.0 };
                speed_mps -= 10.0 * (resistance(speed_mps) + brake);
                let time_s = 10.0 * row as f64;
                let at = [Some(20.0 * time_s), Some(speed_mps), Some(0.0)];
                let [location_m, speed_mps, effort_n_per_kg] = at;
                Sample { time_s, location_m, speed_mps, effort_n_per_kg, ..Sample::default() }
            };
            let run = Run { samples: (0..12).map(sample).collect(), ..Run::default() };
            let intervals = all(context, &[run], EffortReading::Momentary).concat();
            intervals.iter().map(|interval| interval.effort_n_per_kg).collect()
        })
    }

    #[test]
    fn a_brake_between_two_readings_of_nothing_leaves_the_effort_unknown() {
        let known = |braked: &[usize]| coasts(braked).iter().map(Option::is_some).collect::<Vec<bool>>();
        assert_eq!(known(&[]), [true; 11]);
        let mut but_one = [true; 11];
        but_one[4] = false;
        assert_eq!(known(&[5]), but_one);
        // What all of a coast have is an effect.
        assert_eq!(known(&(1..12).collect::<Vec<usize>>()), [true; 11]);
    }

    /// Effort less acceleration, and step, of the intervals of a train without resistance whose handle moves to and
    /// fro, read every second; its efforts are so old.
    fn beside_age(age_s: f64) -> Vec<(f64, f64)> {
        let of = |i: &Interval| (i.effort_n_per_kg.unwrap() - i.acceleration_mps2(), i.effort_step_n_per_kg / i.dt_s);
        to_and_fro(1.0, age_s).iter().map(of).collect()
    }

    /// The intervals of that train, read every `step_s`.
    fn to_and_fro(step_s: f64, age_s: f64) -> Vec<Interval> {
        let effort = |time_s: f64| 0.4 * (time_s / 3.0).sin();
        let sample = |row: i32| {
            let time_s = step_s * f64::from(row);
            Sample {
                time_s,
                location_m: Some(20.0 * time_s),
                speed_mps: Some(20.0 - 1.2 * (time_s / 3.0).cos()),
                effort_n_per_kg: Some(effort(time_s - age_s)),
                ..Sample::default()
            }
        };
        let run = Run { samples: (0..(120.0 / step_s) as i32).map(sample).collect(), ..Run::default() };
        let mut intervals = on_a_level_line(1, |context| all(context, &[run], EffortReading::Momentary)).concat();
        intervals.retain(|i| i.begin_s > 5.0 && i.begin_s < 105.0);
        intervals
    }

    #[test]
    fn an_effort_bends_where_two_readings_and_more_lie_within_an_interval() {
        let bends = |step_s| to_and_fro(step_s, 0.0).iter().filter(|i| i.effort_bend_n_per_kg != 0.0).count();
        assert!(bends(1.0) > 8 && bends(3.0) > 6);
        assert_eq!(bends(5.0), 0);
    }

    /// Speeds are read beside what the efforts give, so an age of these is in the speeds, too.
    #[test]
    fn a_step_is_all_that_an_age_of_the_effort_takes_also_from_the_speeds() {
        let (age_s, in_time) = (0.1, beside_age(0.0));
        for ((late, _), (right, step)) in beside_age(age_s).into_iter().zip(&in_time) {
            assert!((late - right + age_s * step).abs() < 1.5e-4, "{late} {right} {step}");
        }
        assert!(in_time.len() > 8 && in_time.iter().any(|(_, step)| step.abs() > 0.02));
    }

    #[test]
    fn a_step_is_what_a_delay_takes() {
        for (effort, step) in [(EffortReading::Momentary, -0.025), (EffortReading::MeanSinceLast, -0.025)] {
            let intervals = intervals(effort);
            let mean = intervals.iter().map(|i| i.effort_step_n_per_kg).sum::<f64>() / intervals.len() as f64;
            assert!((mean - step).abs() < 1e-3, "{effort:?}: {mean}");
        }
    }
}
