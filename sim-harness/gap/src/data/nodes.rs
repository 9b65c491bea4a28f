//! Where the intervals of a run begin and end: readings of location and speed.
//!
//! Faster logs are thinned to intervals of 10 s, for within less the rounding of the speed hides everything; but where
//! an effort column shows a start second by second its first intervals are shorter.

use crate::data::efforts::Efforts;
use crate::data::interval::SAME_TIME_S;
use crate::data::runs::Run;
use rundown::model::line::Line;
use rundown_files::sample::Sample;
use rundown_files::statistics::midmean;

/// A reading of location and speed at one time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub(super) time_s: f64,
    pub(super) location_m: f64,
    pub(super) speed_mps: f64,
    pub(super) sample: usize,
    /// Effort, and its change from one momentary reading to the next, around the sample as the speed is read around it.
    pub(super) effort_n_per_kg: f64,
    pub(super) effort_change_n_per_kg: Option<f64>,
}

/// The readings of a run.
pub(super) struct Nodes<'a> {
    pub(super) run: &'a Run,
    pub(super) line: &'a Line<'a>,
    pub(super) efforts: Efforts<'a>,
}

impl Nodes<'_> {
    pub(super) fn read(&self, usual_s: f64) -> Vec<Node> {
        let config = self.efforts.config;
        let with_speed: Vec<(usize, f64)> = self
            .run
            .samples
            .iter()
            .enumerate()
            .filter_map(|(index, sample)| Some((index, sample.speed_mps?)))
            .collect();
        let every_s = if usual_s > 0.5 * config.length_s { 0.0 } else { config.length_s };
        let impulses = self.impulses();
        let fine = self.sees_starts(usual_s);
        let mut nodes: Vec<Node> = Vec::new();
        let (mut next_s, mut stands, mut started_s) = (f64::NEG_INFINITY, false, f64::NEG_INFINITY);
        for (place, &(sample, speed_mps)) in with_speed.iter().enumerate() {
            let time_s = self.run.samples[sample].time_s;
            stands |= speed_mps <= config.departed_mps;
            let starts = fine && stands && speed_mps >= config.slowest_mps;
            if starts {
                (stands, started_s) = (false, time_s);
            } else if time_s < next_s {
                continue;
            }
            let fresh = time_s + config.start_length_s <= started_s + config.start_s + SAME_TIME_S;
            let length_s = if fresh { config.start_length_s } else { every_s };
            next_s = time_s + length_s - 0.25 * usual_s;
            nodes.push(if every_s > 0.0 {
                self.read_around(&with_speed, &impulses, place)
            } else {
                self.node(sample, speed_mps)
            });
        }
        self.locate(&with_speed, &mut nodes);
        nodes
    }

    /// An effort is known from row to row, so that a start is seen as it goes.
    fn sees_starts(&self, usual_s: f64) -> bool {
        usual_s <= 0.5 * self.efforts.config.start_length_s && self.efforts.are_there()
    }

    /// What effort and gradient have given since the begin, m/s, with the number of the stretch in which they are known
    /// without a gap. A log without an effort column has the gradient alone.
    fn impulses(&self) -> Vec<Option<(usize, f64)>> {
        let with_effort = self.efforts.are_there();
        let gradient = |sample: &Sample| {
            let late_m = self.run.recorded.location_lag_s * sample.speed_mps?;
            Some(self.line.gradient_n_per_kg(sample.location_m? + self.line.direction.sign() * late_m))
        };
        let given = |index: usize| {
            let effort = match self.efforts.mean_and_change(index - 1, index) {
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

    /// By what stands in one row.
    fn node(&self, sample: usize, speed_mps: f64) -> Node {
        Node {
            time_s: self.run.samples[sample].time_s,
            location_m: f64::NAN,
            speed_mps,
            sample,
            effort_n_per_kg: self.efforts.around(sample),
            effort_change_n_per_kg: self.efforts.change_at(sample),
        }
    }

    /// Speed of a fast log: a straight line through the readings around the moment. What effort and gradient give
    /// between them is taken out first where it is known: a line is then right beside a switch of the regime too, and a
    /// change of the gradient is not smeared, which would look like a longer train. By an effort that is late too much
    /// is taken out: by as much more as the line through the efforts says, not the one of the moment.
    fn read_around(&self, with_speed: &[(usize, f64)], impulses: &[Option<(usize, f64)>], place: usize) -> Node {
        let (here, reading) = with_speed[place];
        let own = self.node(here, reading);
        // A train that stands is held, and what effort and gradient give does not move it.
        let near = |&&(sample, speed): &&(usize, f64)| {
            (self.run.samples[sample].time_s - own.time_s).abs() <= self.efforts.config.reading_s + SAME_TIME_S
                && speed > self.efforts.config.departed_mps
        };
        let before = with_speed[..place].iter().rev().take_while(near);
        let after = with_speed[place..].iter().take_while(near);
        let around: Vec<(usize, f64)> = before.chain(after).copied().collect();
        if around.len() < 3 || reading == 0.0 {
            return own;
        }
        let line = |of: &dyn Fn(usize, f64) -> Option<f64>| {
            let since_s = |sample: usize| self.run.samples[sample].time_s - own.time_s;
            let points = around.iter().map(|&(sample, speed)| Some((since_s(sample), of(sample, speed)?)));
            points.collect::<Option<Vec<(f64, f64)>>>().and_then(|points| at_zero(&points))
        };
        let given = |sample: usize| {
            let (stretch, zero) = impulses[here]?;
            impulses[sample].filter(|(of, _)| *of == stretch).map(|(_, sum)| sum - zero)
        };
        let beside_effort = line(&|sample, speed| Some(speed - given(sample)?));
        let Some(speed_mps) = beside_effort.or_else(|| line(&|_, speed| Some(speed))) else { return own };
        let speed_mps = speed_mps.max(0.0);
        match beside_effort {
            Some(_) => Node {
                speed_mps,
                effort_n_per_kg: line(&|sample, _| Some(self.efforts.around(sample))).unwrap_or(own.effort_n_per_kg),
                effort_change_n_per_kg: line(&|sample, _| self.efforts.change_at(sample)),
                ..own
            },
            None => Node { speed_mps, ..own },
        }
    }

    /// Gives each node a location: the distance by speed, shifted by what the location readings around it say.
    fn locate(&self, with_speed: &[(usize, f64)], nodes: &mut [Node]) {
        let around_s = self.efforts.config.located_s;
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
            // Neither outliers nor single readings count much.
            let middle = midmean(around.iter().map(|s| s.1)).unwrap_or(f64::NAN);
            node.location_m = sign * distance_m[node.sample] + middle;
        }
    }
}

/// Where the straight line through points is at 0; none through fewer than two places.
fn at_zero(points: &[(f64, f64)]) -> Option<f64> {
    let sum = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>();
    let (n, t1, t2) = (points.len() as f64, sum(|p| p.0), sum(|p| p.0 * p.0));
    let (v0, v1) = (sum(|p| p.1), sum(|p| p.0 * p.1));
    let determinant = n * t2 - t1 * t1;
    (determinant > 0.0).then(|| (t2 * v0 - t1 * v1) / determinant)
}

#[cfg(test)]
mod tests {
    use crate::data::believed::tests::on_a_level_line;
    use crate::data::cut::all;
    use crate::data::interval::Interval;
    use crate::data::runs::{EffortReading, Run};
    use rundown_files::sample::Sample;

    /// Of a train that is held until a time, while its effort is there already, then gains so many m/s²: read every
    /// `step_s`.
    fn start(step_s: f64, with_effort: bool, held_s: f64, gains: f64) -> Vec<Interval> {
        on_a_level_line(1, |context| {
            let train = context.believed.train();
            let sample = |row: i32| {
                let time_s = f64::from(row) * step_s;
                let moving_s = (time_s - held_s).max(0.0);
                let speed_mps = gains * moving_s;
                let effort = gains + train.davis().resistance_n_per_kg(speed_mps);
                Sample {
                    time_s,
                    location_m: Some(100.0 + 0.5 * gains * moving_s * moving_s),
                    speed_mps: Some(speed_mps),
                    effort_n_per_kg: with_effort.then_some(effort),
                    ..Sample::default()
                }
            };
            let run = Run { samples: (0..=(50.0 / step_s) as i32).map(sample).collect(), ..Run::default() };
            all(context, &[run], EffortReading::Momentary).concat()
        })
    }

    /// Lengths of the intervals of a train that moves, s.
    fn lengths(intervals: &[Interval]) -> Vec<f64> {
        intervals.iter().filter(|i| i.speed_mps[0] >= 2.0).map(|i| i.dt_s).collect()
    }

    #[test]
    fn a_start_is_seen_in_intervals_of_3_s_where_an_effort_column_shows_it() {
        // The first row at 2 m/s and above is 4 s after the start.
        assert_eq!(lengths(&start(1.0, true, 20.0, 0.6)), [3.0, 3.0, 3.0, 3.0, 10.0]);
        assert_eq!(lengths(&start(1.0, false, 20.0, 0.6)), [10.0, 10.0]);
        assert_eq!(lengths(&start(5.0, true, 20.0, 0.6)), [10.0, 10.0]);
    }

    #[test]
    fn a_train_that_stands_is_in_no_straight_line_of_one_that_starts() {
        let intervals = start(1.0, true, 20.5, 1.5);
        for interval in intervals.iter().filter(|i| i.speed_mps[0] >= 2.0) {
            assert!((interval.acceleration_mps2() - 1.5).abs() < 2e-3, "{interval:?}");
        }
    }
}
