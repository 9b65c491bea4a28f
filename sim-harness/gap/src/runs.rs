//! Recorded runs as the gap workflow sees them, and their intervals.
//!
//! In: a [`Run`] (samples with times), the believed train and track. Out: [`Interval`]s of about 10 s: the change of speed over each, the path
//! travelled in it, the effort if it was measured. Faster logs are thinned to intervals of that length, for within less the rounding of the
//! speed hides everything.

use super::rows::believed_load;
use rundown::model::direction::Direction;
use rundown::model::line::Line;

/// Wanted length of an interval, s.
const INTERVAL_S: f64 = 10.0;
/// Samples further apart than this many usual ones are a gap, and nothing is concluded across it.
const GAP: f64 = 2.5;
/// Half the window over which the speed of a fast log is read, s.
const READING_S: f64 = 2.5;
/// Points along the path of an interval at which laws are evaluated.
pub const POINTS: usize = 10;
/// A measured effort below this is a brake application, N/kg.
const BRAKED_N_PER_KG: f64 = -0.05;
/// What a brake test takes off the mean effort of 10 s at least, N/kg: 10 km/h less in the middle of an acceleration is 0.3.
const TEST_N_PER_KG: f64 = 0.12;

/// One sample. What was not recorded is `None`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Time, s.
    pub time_s: f64,
    /// Location of the front along the track, m.
    pub location_m: Option<f64>,
    /// Speed reading, m/s.
    pub speed_mps: Option<f64>,
    /// Measured applied effort, N/kg.
    pub effort_n_per_kg: Option<f64>,
    /// Ambient temperature, °C.
    pub temperature_c: Option<f64>,
}

/// One recorded run.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Name in every output.
    pub name: String,
    /// Direction of travel.
    pub direction: Direction,
    /// Day of the departure, since 1970-01-01 UTC, if the index knows it.
    pub day: Option<f64>,
    /// Samples, times increasing.
    pub samples: Vec<Sample>,
}

/// How the effort column is to be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EffortReading {
    /// At the moment of its sample.
    Momentary,
    /// Mean since the sample before.
    MeanSinceLast,
}

/// Corrections of the readings, found from location against speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Readings {
    /// Measured over true speed.
    pub speed_scale: f64,
    /// To be added to a speed reading, m/s: half a quantum if the recorder truncates.
    pub speed_offset_mps: f64,
    /// The step of the speed readings, m/s; 0 if there is none.
    pub speed_quantum_mps: f64,
    /// The location reading is this old, s.
    pub location_lag_s: f64,
    /// How the effort is read.
    pub effort: EffortReading,
}

impl Readings {
    /// The true speed of a moving train from a reading, m/s.
    pub fn true_speed_mps(&self, read_mps: f64) -> f64 {
        (read_mps + self.speed_offset_mps) / self.speed_scale
    }
}

impl Default for Readings {
    fn default() -> Self {
        Self {
            speed_scale: 1.0,
            speed_offset_mps: 0.0,
            speed_quantum_mps: 0.0,
            location_lag_s: 0.0,
            effort: EffortReading::Momentary,
        }
    }
}

/// A point on the path of an interval.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Location of the front, m.
    pub location_m: f64,
    /// Speed, m/s.
    pub speed_mps: f64,
    /// Time since the train first moved, s.
    pub since_departure_s: f64,
}

/// From one reading of the speed to the next.
#[derive(Clone, Debug, PartialEq)]
pub struct Interval {
    /// Index of its run.
    pub run: usize,
    /// Begins at this time, s.
    pub begin_s: f64,
    /// Lasts this long, s.
    pub dt_s: f64,
    /// Speed at both ends, m/s.
    pub speed_mps: [f64; 2],
    /// Mean effort over the interval, N/kg.
    pub effort_n_per_kg: Option<f64>,
    /// How much the effort changes within it beyond what is understood, N/kg, not negative.
    pub effort_change_n_per_kg: f64,
    /// Effort at the end less effort at the beginning, N/kg.
    pub effort_step_n_per_kg: f64,
    /// Temperature, °C.
    pub temperature_c: Option<f64>,
    /// Day, since 1970-01-01 UTC.
    pub day: Option<f64>,
    /// The brake has been applied since the departure.
    pub braked: bool,
    /// Shares its first reading with the interval before it.
    pub follows: bool,
    /// The path.
    pub path: [Point; POINTS],
}

impl Interval {
    /// Change of speed over time, m/s².
    pub fn acceleration_mps2(&self) -> f64 {
        (self.speed_mps[1] - self.speed_mps[0]) / self.dt_s
    }

    /// Mean speed, m/s.
    pub fn mean_speed_mps(&self) -> f64 {
        0.5 * (self.speed_mps[0] + self.speed_mps[1])
    }

    /// The mean of a law along the path.
    pub fn mean(&self, law: impl Fn(&Point) -> f64) -> f64 {
        self.path.iter().map(law).sum::<f64>() / POINTS as f64
    }

    /// The middle of the path.
    pub fn middle(&self) -> &Point {
        &self.path[POINTS / 2]
    }
}

/// A reading of location, speed and effort at one time.
#[derive(Clone, Copy, Debug)]
struct Node {
    time_s: f64,
    location_m: f64,
    speed_mps: f64,
    /// Index of its sample.
    sample: usize,
}

fn effort_at(run: &Run, sample: usize) -> f64 {
    run.samples[sample].effort_n_per_kg.unwrap_or(0.0)
}

/// A driver who holds the speed follows the gradient with the effort: between two momentary readings it is u - g that changes evenly. What this adds to
/// the mean effort, N/kg. Whether the driver did is not known: half of it is added, and the mean counts as that much less certain.
fn held(run: &Run, line: &Line<'_>, readings: &Readings, from: &Node, to: &Node, path: &[Point; POINTS]) -> f64 {
    const HELD_MPS: f64 = 0.35;
    let (before, after) = (effort_at(run, from.sample), effort_at(run, to.sample));
    let powered = before > 0.0 && after > 0.0;
    let held = (to.speed_mps - from.speed_mps).abs() < HELD_MPS;
    if readings.effort != EffortReading::Momentary || to.sample != from.sample + 1 || !powered || !held {
        return 0.0;
    }
    let along = path.iter().map(|p| line.gradient_n_per_kg(p.location_m)).sum::<f64>() / POINTS as f64;
    let ends = [from, to].map(|node| line.gradient_n_per_kg(node.location_m));
    let steeper = ends[1] - ends[0];
    if (after - before - steeper).abs() > 0.6 * steeper.abs() && steeper.abs() > 0.004 {
        // The effort did not follow the gradient.
        return 0.0;
    }
    along - 0.5 * (ends[0] + ends[1])
}

/// Cuts a run into intervals. `line` has the run's direction.
pub fn intervals(index: usize, run: &Run, line: &Line<'_>, readings: &Readings) -> Vec<Interval> {
    let usual_s = usual_step_s(run);
    let nodes = nodes(run, line, readings, usual_s);
    let Some(departure_s) = departure_s(run) else {
        return Vec::new();
    };
    let sign = line.direction.sign();
    let mut intervals = Vec::with_capacity(nodes.len());
    let mut braked = false;
    let longest_s = GAP * usual_s.max(INTERVAL_S);
    let mut last_end = None;
    for pair in nodes.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let dt_s = to.time_s - from.time_s;
        let effort = mean_effort(run, readings, from.sample, to.sample);
        if dt_s > longest_s {
            last_end = None;
            continue;
        }
        let way_m = 0.5 * dt_s * (from.speed_mps + to.speed_mps);
        // What is left between the way by speed and the way by location goes evenly over the interval.
        let rest_m = (to.location_m - from.location_m) - sign * way_m;
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
        let effort = effort.map(|(mean, change)| {
            let held = held(run, line, readings, &from, &to, &path);
            (mean + 0.5 * held, change + held.abs())
        });
        let mut interval = Interval {
            run: index,
            begin_s: from.time_s,
            dt_s,
            speed_mps: [from.speed_mps, to.speed_mps],
            effort_n_per_kg: effort.map(|(mean, _)| mean),
            effort_change_n_per_kg: effort.map_or(0.0, |(_, change)| change),
            effort_step_n_per_kg: effort_at(run, to.sample) - effort_at(run, from.sample),
            temperature_c: run.samples[to.sample].temperature_c,
            day: run.day,
            braked,
            follows: last_end == Some(from.sample),
            path,
        };
        braked = braked
            || match interval.effort_n_per_kg {
                // A brake test of some seconds may lie between two readings of the effort: the speed shows that it was less than both.
                Some(effort) => {
                    let by_speed = || interval.acceleration_mps2() + believed_load(line, &interval);
                    let least = effort_at(run, from.sample).min(effort_at(run, to.sample));
                    effort < BRAKED_N_PER_KG || by_speed() < least.max(0.0) - TEST_N_PER_KG
                }
                // One that is not measured at all may be anywhere: any run may have braked.
                None => true,
            };
        interval.braked = braked;
        intervals.push(interval);
        last_end = Some(to.sample);
    }
    intervals
}

/// Median time between samples, s.
pub fn usual_step_s(run: &Run) -> f64 {
    let mut steps: Vec<f64> = run.samples.windows(2).map(|pair| pair[1].time_s - pair[0].time_s).collect();
    if steps.is_empty() {
        return INTERVAL_S;
    }
    steps.sort_by(f64::total_cmp);
    steps[steps.len() / 2]
}

/// When the train first moves, s.
fn departure_s(run: &Run) -> Option<f64> {
    let moving = |sample: &&Sample| sample.speed_mps.is_some_and(|v| v > 0.5);
    run.samples.iter().find(moving).map(|sample| sample.time_s)
}

fn nodes(run: &Run, line: &Line<'_>, readings: &Readings, usual_s: f64) -> Vec<Node> {
    let with_speed: Vec<(usize, f64)> = run
        .samples
        .iter()
        .enumerate()
        .filter_map(|(index, sample)| {
            let speed = sample.speed_mps?;
            let true_mps = if speed > 0.0 { readings.true_speed_mps(speed) } else { 0.0 };
            Some((index, true_mps))
        })
        .collect();
    let every_s = if usual_s > 0.5 * INTERVAL_S { 0.0 } else { INTERVAL_S };
    let impulses = impulses(run, line, readings);
    let mut nodes: Vec<Node> = Vec::new();
    let mut next_s = f64::NEG_INFINITY;
    for (place, &(sample, speed_mps)) in with_speed.iter().enumerate() {
        let time_s = run.samples[sample].time_s;
        if time_s < next_s {
            continue;
        }
        next_s = time_s + every_s - 0.25 * usual_s;
        let speed_mps = if every_s > 0.0 { read_speed(run, &with_speed, &impulses, place) } else { speed_mps };
        nodes.push(Node { time_s, location_m: f64::NAN, speed_mps, sample });
    }
    locate(run, line, readings, &with_speed, &mut nodes);
    nodes
}

/// What effort and gradient have given since the begin, m/s, with the number of the stretch in which they are known without a gap. A log without an effort column
/// has the gradient alone.
fn impulses(run: &Run, line: &Line<'_>, readings: &Readings) -> Vec<Option<(usize, f64)>> {
    let with_effort = run.samples.iter().any(|s| s.effort_n_per_kg.is_some());
    let gradient = |sample: &Sample| {
        let late_m = readings.location_lag_s * sample.speed_mps?;
        Some(line.gradient_n_per_kg(sample.location_m? + line.direction.sign() * late_m))
    };
    let given = |index: usize| {
        let effort = match mean_effort(run, readings, index - 1, index) {
            Some((mean, _)) => mean,
            None if with_effort => return None,
            None => 0.0,
        };
        let (before, now) = (&run.samples[index - 1], &run.samples[index]);
        let gradient = 0.5 * (gradient(before)? + gradient(now)?);
        Some((effort - gradient) * (now.time_s - before.time_s))
    };
    let mut impulses = vec![None; run.samples.len()];
    let (mut stretch, mut sum_mps) = (0, 0.0);
    for index in 1..run.samples.len() {
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
fn read_speed(run: &Run, with_speed: &[(usize, f64)], impulses: &[Option<(usize, f64)>], place: usize) -> f64 {
    let (here, reading) = with_speed[place];
    let at_s = run.samples[here].time_s;
    let near = |&&(sample, _): &&(usize, f64)| (run.samples[sample].time_s - at_s).abs() <= READING_S + 1e-6;
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
        let t = run.samples[sample].time_s - at_s;
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

/// Gives each node a location: the way by speed, shifted by what the location readings around it say.
fn locate(run: &Run, line: &Line<'_>, readings: &Readings, with_speed: &[(usize, f64)], nodes: &mut [Node]) {
    const AROUND_S: f64 = 45.0;
    let sign = line.direction.sign();
    // Way by speed at each sample that has one.
    let mut way_m = vec![f64::NAN; run.samples.len()];
    let mut speed_of = vec![0.0; run.samples.len()];
    let mut sum = 0.0;
    let mut last: Option<(usize, f64)> = None;
    for &(sample, speed) in with_speed {
        if let Some((before, slower)) = last {
            let dt = run.samples[sample].time_s - run.samples[before].time_s;
            sum += 0.5 * dt * (speed + slower);
        }
        way_m[sample] = sum;
        speed_of[sample] = speed;
        last = Some((sample, speed));
    }
    let shifts: Vec<(f64, f64)> = run
        .samples
        .iter()
        .enumerate()
        .filter(|(index, _)| !way_m[*index].is_nan())
        .filter_map(|(index, sample)| {
            let late_m = speed_of[index] * readings.location_lag_s;
            Some((sample.time_s, sample.location_m? - sign * (way_m[index] - late_m)))
        })
        .collect();
    if shifts.is_empty() {
        return;
    }
    for node in nodes {
        let from = shifts.partition_point(|s| s.0 < node.time_s - AROUND_S);
        let to = shifts.partition_point(|s| s.0 <= node.time_s + AROUND_S);
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
        node.location_m = sign * way_m[node.sample] + middle.iter().sum::<f64>() / middle.len() as f64;
    }
}

/// Mean effort between two momentary readings. Under power it is the power that changes evenly: the straight line between two efforts would be too high by
/// up to 7e-4 N/kg at 10 s.
fn between(a: f64, b: f64, pair: &[Sample]) -> f64 {
    match (pair[0].speed_mps, pair[1].speed_mps) {
        (Some(v0), Some(v1)) if a > 0.0 && b > 0.0 && v0.min(v1) > 5.0 => {
            let at = |i: usize| {
                let t = (i as f64 + 0.5) / POINTS as f64;
                (a * v0 + (b * v1 - a * v0) * t) / (v0 + (v1 - v0) * t)
            };
            (0..POINTS).map(at).sum::<f64>() / POINTS as f64
        }
        _ => 0.5 * (a + b),
    }
}

/// Change of the effort beyond what constant power explains.
fn change_between(a: f64, b: f64, pair: &[Sample]) -> f64 {
    match (pair[0].speed_mps, pair[1].speed_mps) {
        (Some(v0), Some(v1)) if a > 0.0 && b > 0.0 && v0.min(v1) > 5.0 => {
            let at_power = (b * v1 - a * v0) / (0.5 * (v0 + v1));
            if at_power.abs() < (b - a).abs() { at_power } else { b - a }
        }
        _ => b - a,
    }
}

/// Mean and change of the effort between two samples.
fn mean_effort(run: &Run, readings: &Readings, from: usize, to: usize) -> Option<(f64, f64)> {
    let samples = &run.samples[from..=to];
    let (mut sum, mut time_s, mut change) = (0.0, 0.0, 0.0);
    let mut last = samples[0].effort_n_per_kg;
    for pair in samples.windows(2) {
        let dt_s = pair[1].time_s - pair[0].time_s;
        let now = pair[1].effort_n_per_kg;
        let mean = match (readings.effort, last, now) {
            (EffortReading::Momentary, Some(a), Some(b)) => between(a, b, pair),
            (EffortReading::MeanSinceLast, _, Some(b)) => b,
            _ => return None,
        };
        if let (Some(a), Some(b)) = (last, now) {
            // Over many samples the steps inside an interval are seen, and only their own halves are uncertain.
            change += change_between(a, b, pair).abs() * dt_s;
        }
        sum += mean * dt_s;
        time_s += dt_s;
        last = now;
    }
    (time_s > 0.0).then(|| (sum / time_s, change / time_s))
}
