//! Recorders with defects of known size, and what is found in their logs.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rundown::model::track::Track;
use rundown::model::train::Train;
use rundown_check::finding::{Finding, Kind};
use rundown_check::limits::Described;
use rundown_check::{Check, Known, check, check_beside};
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;

/// Steps of a true run, s.
const DT: f64 = 0.1;

/// Time, location and speed of a train from stop to stop.
pub struct Trace {
    location_m: Vec<f64>,
    speed_mps: Vec<f64>,
}

impl Trace {
    fn drive(random: &mut ChaCha8Rng, stops: usize) -> Self {
        let mut trace = Self { location_m: vec![0.0], speed_mps: vec![0.0] };
        for _ in 0..stops {
            let top_mps = random.random_range(12.0..40.0);
            let hold_s = random.random_range(60.0..400.0);
            let coast_s = random.random_range(20.0..200.0);
            let up = random.random_range(0.25..0.8);
            let brake = random.random_range(0.35..0.8);
            trace.until(|v, _| v >= top_mps, |v, _| up * (1.2 - v / top_mps));
            trace.until(|_, s| s >= hold_s, |_, s| 0.03 * (s / 25.0).sin());
            trace.until(|v, s| s >= coast_s || v < 6.0, |v, _| -0.02 - 4e-5 * v * v);
            trace.until(|v, _| v <= 0.0, |_, _| -brake);
            trace.until(|_, s| s >= 45.0, |_, _| 0.0);
        }
        trace
    }

    /// A train that holds each of its speeds exactly, for tens of km.
    fn hold(random: &mut ChaCha8Rng, held_kmh: &[f64]) -> Self {
        let mut trace = Self { location_m: vec![0.0], speed_mps: vec![0.0] };
        let wait_s = random.random_range(15.0..35.0);
        trace.until(|_, s| s >= wait_s, |_, _| 0.0);
        for kmh in held_kmh {
            let held_mps = kmh / 3.6;
            let hold_s = random.random_range(400.0..1200.0);
            let rises = trace.speed() < held_mps;
            let acceleration = if rises { 0.15 } else { -0.2 };
            trace.until(|v, _| (v < held_mps) != rises, |_, _| acceleration);
            trace.until(|_, s| s >= hold_s, |v, _| (held_mps - v).clamp(-0.2, 0.2));
        }
        trace.until(|v, _| v <= 0.0, |_, _| -0.3);
        trace
    }

    /// Stops every few km: starts at full power, a held speed, a short coast, a brake.
    fn hop(random: &mut ChaCha8Rng, hops: usize) -> Self {
        let mut trace = Self { location_m: vec![0.0], speed_mps: vec![0.0] };
        for _ in 0..hops {
            let top_mps = random.random_range(31.0..34.0);
            let (hold_s, coast_s) = (random.random_range(60.0..150.0), random.random_range(20.0..60.0));
            let brake = random.random_range(0.5..0.8);
            trace.until(|v, _| v >= top_mps, |v, _| 0.8_f64.min(12.0 / v.max(1.0)) - 0.01);
            trace.until(|_, s| s >= hold_s, |v, _| (top_mps - v).clamp(-0.2, 0.2));
            trace.until(|_, s| s >= coast_s, |v, _| -0.01 - 4e-5 * v * v);
            trace.until(|v, _| v <= 0.0, |_, _| -brake);
            trace.until(|_, s| s >= 40.0, |_, _| 0.0);
        }
        trace
    }

    /// A tram: stops every few hundred metres, most of the way powering, coasting or braking.
    fn tram(random: &mut ChaCha8Rng, hops: usize) -> Self {
        let mut trace = Self { location_m: vec![0.0], speed_mps: vec![0.0] };
        for _ in 0..hops {
            let top_mps = random.random_range(11.0..15.0);
            let coast_s = random.random_range(8.0..30.0);
            let brake = random.random_range(0.7..1.1);
            trace.until(|v, _| v >= top_mps, |v, _| 1.0_f64.min(8.0 / v.max(1.0)) - 0.03);
            trace.until(|v, s| s >= coast_s || v < 6.0, |v, _| -0.03 - 1e-4 * v * v);
            trace.until(|v, _| v <= 0.0, |_, _| -brake);
            trace.until(|_, s| s >= 25.0, |_, _| 0.0);
        }
        trace
    }

    /// A tram that holds its speed between hands that turn at once.
    fn steady_tram(random: &mut ChaCha8Rng, hops: usize) -> Self {
        let mut trace = Self { location_m: vec![0.0], speed_mps: vec![0.0] };
        for _ in 0..hops {
            let (hold_s, brake) = (random.random_range(15.0..45.0), random.random_range(0.6..1.1));
            trace.until(|v, _| v >= 14.0, |v, _| 1.0_f64.min(10.0 / v.max(1.0)));
            trace.until(|_, s| s >= hold_s, |_, _| 0.0);
            trace.until(|v, _| v <= 0.0, |_, _| -brake);
            trace.until(|_, s| s >= 25.0, |_, _| 0.0);
        }
        trace
    }

    fn until(&mut self, over: impl Fn(f64, f64) -> bool, acceleration: impl Fn(f64, f64) -> f64) {
        let mut s = 0.0;
        while !over(self.speed(), s) && s < 3000.0 {
            let before = self.speed();
            let now = (before + DT * acceleration(before, s)).max(0.0);
            self.location_m.push(self.location_m[self.location_m.len() - 1] + 0.5 * DT * (before + now));
            self.speed_mps.push(now);
            s += DT;
        }
    }

    fn speed(&self) -> f64 {
        self.speed_mps[self.speed_mps.len() - 1]
    }

    /// Where it stands.
    fn stops_m(&self) -> Vec<f64> {
        let standing = self.location_m.iter().zip(&self.speed_mps).filter(|(_, mps)| **mps == 0.0);
        let mut stops_m: Vec<f64> = standing.map(|(at_m, _)| *at_m).collect();
        stops_m.dedup_by(|a, b| (*a - *b).abs() < 1.0);
        stops_m
    }

    /// Location and speed at a time.
    fn at(&self, time_s: f64) -> (f64, f64) {
        let i = ((time_s / DT).round().max(0.0) as usize).min(self.location_m.len() - 1);
        (self.location_m[i], self.speed_mps[i])
    }

    fn duration_s(&self) -> f64 {
        DT * (self.location_m.len() - 1) as f64
    }
}

/// A recorder; its default is that of a clean log.
#[derive(Clone, Copy)]
pub struct Recorder {
    pub step_s: f64,
    pub quantum_kmh: f64,
    pub truncates: bool,
    pub scale: f64,
    /// From this share of the time on the scale is another one.
    pub turned_at: f64,
    pub turned: f64,
    pub skew_s: f64,
    pub skew_sd_s: f64,
    pub noise_m: f64,
    pub drift_m: f64,
    pub odometer_m: f64,
    /// The location is that of each row that this divides.
    pub located_each: u32,
    pub loses_each_s: f64,
}

impl Default for Recorder {
    fn default() -> Self {
        Self {
            step_s: 1.0,
            quantum_kmh: 1.0,
            truncates: false,
            scale: 1.0,
            turned_at: 1.0,
            turned: 1.0,
            skew_s: 0.0,
            skew_sd_s: 0.0,
            noise_m: 4.0,
            drift_m: 0.0,
            odometer_m: 0.0,
            located_each: 1,
            loses_each_s: 0.0,
        }
    }
}

impl Recorder {
    fn rows(&self, trace: &Trace, random: &mut ChaCha8Rng) -> Vec<Sample> {
        let mut normal = |sd: f64| -> f64 { sd * Distribution::<f64>::sample(&StandardNormal, random) };
        let skew_s = self.skew_s + normal(self.skew_sd_s);
        let mut drift_m = normal(self.drift_m);
        let mut lost_s = 0.0;
        let count = (trace.duration_s() / self.step_s) as u32;
        let mut rows = Vec::new();
        for i in 0..count {
            let clock_s = f64::from(i) * self.step_s;
            if self.loses_each_s > 0.0 {
                lost_s = (clock_s / self.loses_each_s).floor();
            }
            let true_s = clock_s + lost_s;
            let (location_m, _) = trace.at(true_s);
            let (_, speed_mps) = trace.at(true_s - skew_s);
            let keep = (-self.step_s / 60.0).exp();
            drift_m = keep * drift_m + normal(self.drift_m * (1.0 - keep * keep).sqrt());
            let mut read_m = location_m + drift_m + normal(self.noise_m);
            if self.odometer_m > 0.0 {
                read_m = (read_m / self.odometer_m).floor() * self.odometer_m;
            }
            if i % self.located_each > 0 {
                read_m = rows.last().and_then(|row: &Sample| row.location_m).unwrap_or(read_m);
            }
            let is_turned = f64::from(i) >= self.turned_at * f64::from(count);
            let kmh = 3.6 * self.scale * if is_turned { self.turned } else { 1.0 } * speed_mps;
            let steps = kmh / self.quantum_kmh;
            let shown = if self.truncates { steps.floor() } else { steps.round() } * self.quantum_kmh;
            rows.push(Sample {
                line: u64::from(i) + 2,
                time_s: clock_s,
                location_m: Some(read_m),
                speed_mps: Some(shown / 3.6),
                ..Sample::default()
            });
        }
        rows
    }

    pub fn runs(&self, seed: u64, runs: usize, stops: usize) -> Vec<Recording> {
        self.of(seed, runs, |random| Trace::drive(random, stops))
    }

    /// Runs that hold speeds exactly, tens of km each. `held_kmh`: those of a run.
    pub fn holding(&self, seed: u64, runs: usize, held_kmh: impl Fn(&mut ChaCha8Rng) -> Vec<f64>) -> Vec<Recording> {
        self.of(seed, runs, |random| {
            let held_kmh = held_kmh(random);
            Trace::hold(random, &held_kmh)
        })
    }

    /// Runs of short hops.
    pub fn hopping(&self, seed: u64, runs: usize, hops: usize) -> Vec<Recording> {
        self.of(seed, runs, |random| Trace::hop(random, hops))
    }

    /// Runs of a tram.
    pub fn trams(&self, seed: u64, runs: usize, hops: usize) -> Vec<Recording> {
        self.of(seed, runs, |random| Trace::tram(random, hops))
    }

    /// Runs of a tram that holds its speed.
    pub fn steady_trams(&self, seed: u64, runs: usize, hops: usize) -> Vec<Recording> {
        self.of(seed, runs, |random| Trace::steady_tram(random, hops))
    }

    /// Runs that stop at the same places, of a wheel that gives both location and speed; and those places.
    pub fn with_one_wheel(&self, seed: u64, runs: usize, stops: usize) -> (Vec<Recording>, Vec<f64>) {
        let drive = || Trace::drive(&mut ChaCha8Rng::seed_from_u64(seed), stops);
        let mut recordings = self.of(seed, runs, |_| drive());
        let rows = recordings.iter_mut().flat_map(|recording| &mut recording.rows);
        rows.filter_map(|row| row.location_m.as_mut()).for_each(|at_m| *at_m *= self.scale);
        (recordings, drive().stops_m())
    }

    fn of(&self, seed: u64, runs: usize, drive: impl Fn(&mut ChaCha8Rng) -> Trace) -> Vec<Recording> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let one = |i| recording(&format!("run{i:02}"), self.rows(&drive(&mut random), &mut random));
        (0..runs).map(one).collect()
    }

    pub fn check(&self, seed: u64, runs: usize, stops: usize) -> (Check, Vec<Recording>) {
        let mut recordings = self.runs(seed, runs, stops);
        (check(&mut recordings), recordings)
    }
}

pub fn recording(name: &str, rows: Vec<Sample>) -> Recording {
    Recording { name: name.to_owned(), path: name.into(), rows, ..Recording::default() }
}

pub fn all(check: &Check) -> Vec<&Finding> {
    let runs = check.runs.iter().flat_map(|run| &run.findings);
    check.recorders.iter().flat_map(|recorder| &recorder.findings).chain(runs).collect()
}

/// The first finding of a kind, of recorders or of runs.
pub fn find(check: &Check, kind: Kind) -> Option<&Finding> {
    all(check).into_iter().find(|finding| finding.kind == kind)
}

/// The same, which must be there.
#[track_caller]
pub fn found(check: &Check, kind: Kind) -> &Finding {
    find(check, kind).unwrap_or_else(|| panic!("{kind:?} is not found: {:?}", all(check)))
}

/// As a replay asks it.
pub fn check_for_replay(recordings: &mut [Recording]) -> Check {
    check_beside(recordings, &Known { moves_locations: true, ..Known::default() })
}

pub fn kinds(check: &Check) -> Vec<Kind> {
    let mut kinds: Vec<Kind> = all(check).iter().map(|finding| finding.kind).collect();
    kinds.sort();
    kinds.dedup();
    kinds
}

pub fn one(mut rows: Vec<Sample>, spoil: impl FnOnce(&mut Vec<Sample>)) -> (Check, Vec<Sample>) {
    spoil(&mut rows);
    let mut recordings = [recording("run", rows)];
    let found = check(&mut recordings);
    let [recording] = recordings;
    (found, recording.rows)
}

/// A clean run of a satellite receiver, 1 s.
pub fn clean(seed: u64) -> Vec<Sample> {
    Recorder::default().runs(seed, 1, 5).remove(0).rows
}

#[track_caller]
pub fn only(check: &Check, kind: Kind) -> Finding {
    let others = [Kind::RoundedSpeed, Kind::SteppedSpeed];
    let mut left: Vec<&Finding> = all(check).into_iter().filter(|finding| !others.contains(&finding.kind)).collect();
    assert!(left.iter().all(|finding| finding.kind == kind), "{left:?}");
    left.pop().unwrap_or_else(|| panic!("{kind:?} is not found")).clone()
}

/// What is found of the efforts of trains that are described so, of these kinds; and how many rows keep theirs.
pub fn found_of_efforts(
    mut recordings: Vec<Recording>,
    train: Train,
    track: Track,
    kinds: &[Kind],
) -> (Vec<Finding>, usize) {
    let known = Known {
        limits: Described::of(Some(train), None),
        track: Some(track),
        moves_locations: true,
        ..Known::default()
    };
    let check = check_beside(&mut recordings, &known);
    let findings = check.recorders.iter().flat_map(|recorder| &recorder.findings);
    let findings = findings.filter(|finding| kinds.contains(&finding.kind)).cloned().collect();
    let kept = recordings.iter().flat_map(|one| &one.rows).filter(|row| row.effort_n_per_kg.is_some()).count();
    (findings, kept)
}
