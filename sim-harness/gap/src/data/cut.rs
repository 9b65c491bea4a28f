//! Runs cut into intervals of about 10 s.
//!
//! In: a [`Run`], the believed train and track. Out: [`Interval`]s: the change of speed over each, the path travelled in it, the effort if it was measured. Faster logs
//! are thinned to intervals of that length, for within less the rounding of the speed hides everything.

use crate::config::IntervalConfig;
use crate::data::believed::{Context, believed_load};
use crate::data::interval::{Interval, POINTS, Point};
use crate::data::runs::{EffortReading, Run, usual_step_s};
use rundown::model::line::Line;
use rundown_files::sample::Sample;
use rundown_files::statistics::median;
use std::collections::BTreeSet;

/// A reading of location, speed and effort at one time.
#[derive(Clone, Copy, Debug)]
struct Node {
    time_s: f64,
    location_m: f64,
    speed_mps: f64,
    sample: usize,
}

pub fn all(context: &Context<'_>, runs: &[Run], effort: EffortReading) -> Vec<Vec<Interval>> {
    let config = &context.config.interval;
    let names: BTreeSet<&str> =
        runs.iter().map(|run| run.recorded.unit.as_str()).filter(|unit| !unit.is_empty()).collect();
    let of = |(i, run): (usize, &Run)| {
        let unit = names.iter().position(|unit| *unit == run.recorded.unit);
        Cut { run, unit, line: context.believed.line(run.direction), effort, config }.intervals(i)
    };
    runs.iter().enumerate().map(of).collect()
}

struct Cut<'a> {
    run: &'a Run,
    unit: Option<usize>,
    line: &'a Line<'a>,
    effort: EffortReading,
    config: &'a IntervalConfig,
}

impl Cut<'_> {
    fn intervals(&self, index: usize) -> Vec<Interval> {
        let usual_s = usual_step_s(self.run);
        let nodes = self.nodes(usual_s);
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
        if self.effort == EffortReading::Momentary {
            self.doubt_coasts(&mut intervals);
        }
        intervals
    }

    /// Between two momentary readings of nothing a handle may have been moved and moved back. What the motion of such an interval asks for tells: it is further
    /// from that of its stretch of coasting than an effort may change, or, where hardly another one follows, from nothing. Its effort is then not known.
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
        let effort = self.mean_effort(from.sample, to.sample).map(|(mean, change)| {
            let held = self.held(from, to, &path);
            (mean + 0.5 * held, change + held.abs())
        });
        Interval {
            run,
            unit: self.unit,
            begin_s: from.time_s,
            dt_s,
            speed_mps: [from.speed_mps, to.speed_mps],
            effort_n_per_kg: effort.map(|(mean, _)| mean),
            effort_change_n_per_kg: effort.map_or(0.0, |(_, change)| change),
            effort_step_n_per_kg: self.step(from.sample, to.sample),
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

    /// The brake was applied in an interval. A brake test of some seconds may lie between two readings of the effort: the speed shows that it was less than both.
    fn brakes(&self, interval: &Interval, from: &Node, to: &Node) -> bool {
        // One that is not measured at all may be anywhere: any run may have braked.
        let Some(effort) = interval.effort_n_per_kg else {
            return true;
        };
        let by_speed = || interval.acceleration_mps2() + believed_load(self.line, interval);
        let least = self.effort_at(from.sample).min(self.effort_at(to.sample));
        effort < self.config.braked_n_per_kg || by_speed() < least.max(0.0) - self.config.brake_test_n_per_kg
    }

    fn effort_at(&self, sample: usize) -> f64 {
        self.run.samples[sample].effort_n_per_kg.unwrap_or(0.0)
    }

    /// A driver who holds the speed follows the gradient with the effort: between two momentary readings it is u - g that changes evenly. What this adds to
    /// the mean effort, N/kg. Whether the driver did is not known: half of it is added, and the mean counts as that much less certain.
    fn held(&self, from: &Node, to: &Node, path: &[Point; POINTS]) -> f64 {
        let (before, after) = (self.effort_at(from.sample), self.effort_at(to.sample));
        let powered = before > 0.0 && after > 0.0;
        let held = (to.speed_mps - from.speed_mps).abs() < self.config.held_mps;
        if self.effort != EffortReading::Momentary || to.sample != from.sample + 1 || !powered || !held {
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

    /// How long the train had stood before its last start, or stands already, at each sample, s; `None`: since before the run.
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

    fn nodes(&self, usual_s: f64) -> Vec<Node> {
        let with_speed: Vec<(usize, f64)> = self
            .run
            .samples
            .iter()
            .enumerate()
            .filter_map(|(index, sample)| Some((index, sample.speed_mps?)))
            .collect();
        let every_s = if usual_s > 0.5 * self.config.length_s { 0.0 } else { self.config.length_s };
        let impulses = self.impulses();
        let mut nodes: Vec<Node> = Vec::new();
        let mut next_s = f64::NEG_INFINITY;
        for (place, &(sample, speed_mps)) in with_speed.iter().enumerate() {
            let time_s = self.run.samples[sample].time_s;
            if time_s < next_s {
                continue;
            }
            next_s = time_s + every_s - 0.25 * usual_s;
            let speed_mps = if every_s > 0.0 { self.read_speed(&with_speed, &impulses, place) } else { speed_mps };
            nodes.push(Node { time_s, location_m: f64::NAN, speed_mps, sample });
        }
        self.locate(&with_speed, &mut nodes);
        nodes
    }

    /// What effort and gradient have given since the begin, m/s, with the number of the stretch in which they are known without a gap. A log without an effort column
    /// has the gradient alone.
    fn impulses(&self) -> Vec<Option<(usize, f64)>> {
        let with_effort = self.run.samples.iter().any(|s| s.effort_n_per_kg.is_some());
        let gradient = |sample: &Sample| {
            let late_m = self.run.recorded.location_lag_s * sample.speed_mps?;
            Some(self.line.gradient_n_per_kg(sample.location_m? + self.line.direction.sign() * late_m))
        };
        let given = |index: usize| {
            let effort = match self.mean_effort(index - 1, index) {
                Some((mean, _)) => mean,
                None if with_effort => return None,
                None => 0.0,
            };
            let (before, now) = (&self.run.samples[index - 1], &self.run.samples[index]);
            let gradient = 0.5 * (gradient(before)? + gradient(now)?);
            Some((effort - gradient) * (now.time_s - before.time_s))
        };
        let mut impulses = vec![None; self.run.samples.len()];
        let (mut stretch, mut sum_mps) = (0, 0.0);
        for index in 1..self.run.samples.len() {
            match given(index) {
                Some(impulse_mps) => {
                    impulses[index - 1].get_or_insert((stretch, sum_mps));
                    sum_mps += impulse_mps;
                    impulses[index] = Some((stretch, sum_mps));
                }
                None => stretch += 1,
            }
        }
        impulses
    }

    /// Speed of a fast log: a straight line through the readings around the moment. What effort and gradient give between them is taken out first where it is known:
    /// a line is then right beside a switch of the regime too, and a change of the gradient is not smeared, which would look like a longer train.
    fn read_speed(&self, with_speed: &[(usize, f64)], impulses: &[Option<(usize, f64)>], place: usize) -> f64 {
        let (here, reading) = with_speed[place];
        let at_s = self.run.samples[here].time_s;
        let near = |&&(sample, _): &&(usize, f64)| {
            (self.run.samples[sample].time_s - at_s).abs() <= self.config.reading_s + 1e-6
        };
        let before = with_speed[..place].iter().rev().take_while(near);
        let after = with_speed[place..].iter().take_while(near);
        let around: Vec<(usize, f64)> = before.chain(after).copied().collect();
        let given = |sample: usize| {
            let (own, zero) = impulses[here]?;
            let (stretch, sum) = impulses[sample]?;
            (stretch == own).then_some(sum - zero)
        };
        let known = around.iter().all(|(sample, _)| given(*sample).is_some());
        let (mut n, mut t1, mut t2, mut v0, mut v1) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for &(sample, speed) in &around {
            let t = self.run.samples[sample].time_s - at_s;
            let speed = if known { speed - given(sample).unwrap_or(0.0) } else { speed };
            n += 1.0;
            t1 += t;
            t2 += t * t;
            v0 += speed;
            v1 += speed * t;
        }
        let determinant = n * t2 - t1 * t1;
        if n < 3.0 || determinant <= 0.0 || reading == 0.0 {
            return reading;
        }
        ((t2 * v0 - t1 * v1) / determinant).max(0.0)
    }

    /// Gives each node a location: the distance by speed, shifted by what the location readings around it say.
    fn locate(&self, with_speed: &[(usize, f64)], nodes: &mut [Node]) {
        let around_s = self.config.located_s;
        let sign = self.line.direction.sign();
        // Distance by speed at each sample that has one.
        let mut distance_m = vec![f64::NAN; self.run.samples.len()];
        let mut speed_of = vec![0.0; self.run.samples.len()];
        let mut sum = 0.0;
        let mut last: Option<(usize, f64)> = None;
        for &(sample, speed) in with_speed {
            if let Some((before, slower)) = last {
                let dt = self.run.samples[sample].time_s - self.run.samples[before].time_s;
                sum += 0.5 * dt * (speed + slower);
            }
            distance_m[sample] = sum;
            speed_of[sample] = speed;
            last = Some((sample, speed));
        }
        let shifts: Vec<(f64, f64)> = self
            .run
            .samples
            .iter()
            .enumerate()
            .filter(|(index, _)| !distance_m[*index].is_nan())
            .filter_map(|(index, sample)| {
                let late_m = speed_of[index] * self.run.recorded.location_lag_s;
                Some((sample.time_s, sample.location_m? - sign * (distance_m[index] - late_m)))
            })
            .collect();
        if shifts.is_empty() {
            return;
        }
        for node in nodes {
            let from = shifts.partition_point(|s| s.0 < node.time_s - around_s);
            let to = shifts.partition_point(|s| s.0 <= node.time_s + around_s);
            let around = if from < to {
                &shifts[from..to]
            } else {
                let nearest = from.min(shifts.len() - 1);
                &shifts[nearest..=nearest]
            };
            let mut values: Vec<f64> = around.iter().map(|s| s.1).collect();
            values.sort_by(f64::total_cmp);
            // The mean of the middle half: neither outliers nor single readings count much.
            let (low, high) = (values.len() / 4, values.len() - values.len() / 4);
            let middle = &values[low..high];
            node.location_m = sign * distance_m[node.sample] + middle.iter().sum::<f64>() / middle.len() as f64;
        }
    }

    /// Mean effort between two momentary readings. Under power it is the power that changes evenly: the straight line between two efforts would be too high by
    /// up to 7e-4 N/kg at 10 s.
    fn between(&self, a: f64, b: f64, pair: &[Sample]) -> f64 {
        match (pair[0].speed_mps, pair[1].speed_mps) {
            (Some(v0), Some(v1)) if a > 0.0 && b > 0.0 && v0.min(v1) > self.config.by_power_mps => {
                let at = |i: usize| {
                    let t = (i as f64 + 0.5) / POINTS as f64;
                    (a * v0 + (b * v1 - a * v0) * t) / (v0 + (v1 - v0) * t)
                };
                (0..POINTS).map(at).sum::<f64>() / POINTS as f64
            }
            _ => 0.5 * (a + b),
        }
    }

    /// Change of the effort from one sample to another beyond what constant power explains.
    fn change_between(&self, from: usize, to: usize) -> Option<f64> {
        let [before, after] = [from, to].map(|sample| &self.run.samples[sample]);
        let (a, b) = (before.effort_n_per_kg?, after.effort_n_per_kg?);
        Some(match (before.speed_mps, after.speed_mps) {
            (Some(v0), Some(v1)) if a > 0.0 && b > 0.0 && v0.min(v1) > self.config.by_power_mps => {
                let at_power = (b * v1 - a * v0) / (0.5 * (v0 + v1));
                if at_power.abs() < (b - a).abs() { at_power } else { b - a }
            }
            _ => b - a,
        })
    }

    /// Effort at the end of an interval less that at its beginning. A mean lies half a row back, so that of means the middles of neighbours are taken: the
    /// noise of the interval's own effort, which would be taken for a delay, is not in it.
    fn step(&self, from: usize, to: usize) -> f64 {
        if self.mean_after(to).is_none() {
            return self.effort_at(to) - self.effort_at(from);
        }
        let middle = |sample: usize| 0.5 * (self.effort_at(sample) + self.effort_at(sample + 1));
        middle(to) - middle(from)
    }

    /// The sample after one of a column of means, unless a gap lies between.
    fn mean_after(&self, sample: usize) -> Option<usize> {
        let samples = &self.run.samples;
        let next = samples.get(sample + 1).filter(|next| next.effort_n_per_kg.is_some())?;
        let [before, now] = [sample - 1, sample].map(|sample| samples[sample].time_s);
        let is_mean = self.effort == EffortReading::MeanSinceLast;
        (is_mean && next.time_s - now < self.config.gap * (now - before)).then_some(sample + 1)
    }

    /// How much the effort changes up to a sample, not negative. A mean is judged by those around it: the noise of a mean is in its change, too, so that those
    /// which count because they hardly change would be too high wherever the effort falls.
    fn change(&self, sample: usize) -> Option<f64> {
        let own = self.change_between(sample - 1, sample)?.abs();
        let is_zero = |sample: usize| self.effort_at(sample).abs() <= self.config.coasting_n_per_kg;
        let coasts = is_zero(sample - 1) && is_zero(sample);
        let next = self.mean_after(sample).filter(|_| !coasts);
        let Some(around) = next.and_then(|next| self.change_between(sample - 1, next)) else {
            return Some(own);
        };
        Some((0.5 * around).abs().max(self.apart(sample)))
    }

    /// How far the effort of a sample is from the middle of those around it, or their power.
    fn apart(&self, sample: usize) -> f64 {
        let around = [sample - 1, sample, sample + 1].map(|sample| &self.run.samples[sample]);
        let [a, b, c] = around.map(|sample| sample.effort_n_per_kg.unwrap_or(0.0));
        let apart = (b - 0.5 * (a + c)).abs();
        match around.map(|sample| sample.speed_mps) {
            [Some(v0), Some(v1), Some(v2)] if a > 0.0 && c > 0.0 && v0.min(v2) > self.config.by_power_mps => {
                apart.min((b - 0.5 * (a * v0 + c * v2) / v1.max(self.config.by_power_mps)).abs())
            }
            _ => apart,
        }
    }

    /// Mean and change of the effort between two samples.
    fn mean_effort(&self, from: usize, to: usize) -> Option<(f64, f64)> {
        let samples = &self.run.samples[from..=to];
        let (mut sum, mut time_s, mut change) = (0.0, 0.0, 0.0);
        let mut last = samples[0].effort_n_per_kg;
        for (index, pair) in samples.windows(2).enumerate() {
            let dt_s = pair[1].time_s - pair[0].time_s;
            let now = pair[1].effort_n_per_kg;
            let mean = match (self.effort, last, now) {
                (EffortReading::Momentary, Some(a), Some(b)) => self.between(a, b, pair),
                (EffortReading::MeanSinceLast, _, Some(b)) => b,
                _ => return None,
            };
            // Over many samples the steps inside an interval are seen, and only their own halves are uncertain.
            change += self.change(from + index + 1).unwrap_or(0.0) * dt_s;
            sum += mean * dt_s;
            time_s += dt_s;
            last = now;
        }
        (time_s > 0.0).then(|| (sum / time_s, change / time_s))
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

    #[test]
    fn a_step_is_what_a_delay_takes() {
        for (effort, step) in [(EffortReading::Momentary, -0.025), (EffortReading::MeanSinceLast, -0.025)] {
            let intervals = intervals(effort);
            let mean = intervals.iter().map(|i| i.effort_step_n_per_kg).sum::<f64>() / intervals.len() as f64;
            assert!((mean - step).abs() < 1e-3, "{effort:?}: {mean}");
        }
    }
}
