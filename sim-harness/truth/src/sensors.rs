//! What the recorder on board makes of the truth: samples with noise, rounding, delay and gaps.
//!
//! In: the trace of a run. Out: samples, and the truth at the same times, row by row.
//!
//! A reading at time t shows the train at t - latency. Noise comes before the rounding. A standing train reads 0 km/h
//! without noise.

use crate::regime::Regime;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, Normal};
use serde::Deserialize;

/// How the speed is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SpeedReading {
    /// To the nearest km/h (or other quantum).
    #[default]
    Rounded,
    /// To the km/h (or other quantum) below.
    Truncated,
    /// With all digits.
    Exact,
}

/// Gaps of more than one sample: GPS and speed are both lost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bursts {
    /// That one begins at a sample.
    pub probability: f64,
    /// Least and most samples.
    pub samples: [usize; 2],
}

/// Gauss-Markov noise: a slow drift of the location.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocationWalk {
    /// Standard deviation, m.
    pub sd_m: f64,
    /// Time constant, s.
    pub tau_s: f64,
}

impl LocationWalk {
    /// With the usual time constant of 60 s.
    pub fn of(sd_m: f64) -> Self {
        Self { sd_m, tau_s: 60.0 }
    }
}

/// The recorder.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensors {
    /// Time between samples, s; a multiple of the integration step.
    pub sampling_s: f64,
    /// How the speed is shown.
    pub speed: SpeedReading,
    /// White noise of the speed before rounding, standard deviation, km/h.
    pub speed_noise_kmh: f64,
    /// Shown over true speed, 1 for none: a worn wheel reads high.
    pub speed_gain: f64,
    /// White noise of the location, standard deviation, m.
    pub location_noise_m: f64,
    /// Slow noise of the location.
    pub location_walk: Option<LocationWalk>,
    /// Each reading is lost on its own with this probability.
    pub dropout_probability: f64,
    /// Longer gaps.
    pub bursts: Option<Bursts>,
    /// Age of location and speed when they are stamped, s.
    pub latency_s: f64,
    /// How much older the location is than that, s: a slow receiver.
    pub location_lag_s: f64,
    /// How much older the speed is than that, least and most, s; drawn where a run is simulated.
    pub speed_lag_s: [f64; 2],
    /// The step of a location that is cut off, m; 0 for none.
    pub location_step_m: f64,
    /// The location is the distance that the wheel of the speed has run, with its gain, from the true place of
    /// departure.
    pub location_by_wheel: bool,
    /// The location stands still now and then.
    pub location_stuck: Option<Bursts>,
    /// The clock of the recorder loses a second after each so many, s; 0 for never.
    pub lost_second_every_s: f64,
    /// Whether there are rows while the speed, as old as it is, is zero; the first of a standstill there always is.
    pub standing_rows: bool,
    /// The clock shows seconds of the day and begins the run between these, s; drawn where a run is simulated.
    pub day_clock_s: Option<[f64; 2]>,
    /// The step of a speed that is rounded or truncated, km/h.
    pub speed_quantum_kmh: f64,
    /// Shown over true effort, 1 for none.
    pub effort_gain: f64,
    /// The same of a braking effort, beside that.
    pub brake_gain: f64,
    /// The effort at the moment of the sample instead of the mean since the sample before.
    pub effort_momentary: bool,
    /// How much this gain differs from run to run, standard deviation; drawn where a run is simulated.
    pub effort_gain_sd: f64,
    /// White noise of the effort, standard deviation, N/kg.
    pub effort_noise_n_per_kg: f64,
    /// The same as a share of the effort.
    pub effort_noise_share: f64,
    /// The step to which the effort is rounded, N/kg; 0 for none.
    pub effort_step_n_per_kg: f64,
    /// Age of the effort when it is stamped, s.
    pub effort_lag_s: f64,
    /// Shown less true location, along the line, m.
    pub location_offset_m: f64,
}

impl Default for Sensors {
    /// The case study: every 10 s, rounded to 1 km/h, 4 m.
    fn default() -> Self {
        Self {
            sampling_s: 10.0,
            speed: SpeedReading::Rounded,
            speed_noise_kmh: 0.0,
            speed_gain: 1.0,
            location_noise_m: 4.0,
            location_walk: None,
            dropout_probability: 0.0,
            bursts: None,
            latency_s: 0.0,
            location_lag_s: 0.0,
            speed_lag_s: [0.0; 2],
            location_step_m: 0.0,
            location_by_wheel: false,
            location_stuck: None,
            lost_second_every_s: 0.0,
            standing_rows: true,
            day_clock_s: None,
            speed_quantum_kmh: 1.0,
            effort_gain: 1.0,
            brake_gain: 1.0,
            effort_momentary: false,
            effort_gain_sd: 0.0,
            effort_noise_n_per_kg: 0.0,
            effort_noise_share: 0.0,
            effort_step_n_per_kg: 0.0,
            effort_lag_s: 0.0,
            location_offset_m: 0.0,
        }
    }
}

/// What the estimator may see.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "the units are in the names")]
pub struct Sample {
    pub time_s: f64,
    pub location_m: Option<f64>,
    pub speed_kmh: Option<f64>,
    /// Mean effort since the sample before as the train's computer reports it, times the gain, plus noise, N/kg of
    /// described rotating mass. 0 in the first sample.
    pub effort_n_per_kg: f64,
    /// Ambient temperature to 0.1 °C.
    pub temperature_c: f64,
}

/// What was true at the end of an integration step, which may be the time of a sample. A standing train has the regime
/// standstill, also in the step that stopped it.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[expect(missing_docs, reason = "the units are in the names")]
pub struct TruthSample {
    pub time_s: f64,
    pub location_m: f64,
    pub speed_mps: f64,
    /// At the wheels, held over the step that ended here, N/kg.
    pub effort_n_per_kg: f64,
    /// Mean since the row before, N/kg.
    pub mean_effort_n_per_kg: f64,
    /// What the train's computer makes of the effort, N/kg of described rotating mass; in no file.
    #[serde(skip)]
    pub reported_n_per_kg: f64,
    /// In the step that ended here.
    pub regime: Regime,
    /// At this speed, with this wind and all effects, gravity not, N/kg.
    pub resistance_n_per_kg: f64,
    /// What of it is due to effects other than wind, mass and Davis parameters, N/kg.
    pub extra_n_per_kg: f64,
    /// Gravity along the track, positive uphill in the direction of travel, N/kg.
    pub gravity_n_per_kg: f64,
    #[serde(rename = "ambient_temperature_c")]
    pub temperature_c: f64,
}

impl Sensors {
    /// Reads the trace, whose first row is time 0 and whose rows are `step_s` apart. Location and speed draw from
    /// `rng`, the effort from `effort_rng`, what differs from run to run and where the location stands still from
    /// `run_rng`. The times of samples and truth are the recorder's.
    ///
    /// # Panics
    /// If the sampling is not a multiple of the step.
    pub fn read(
        &self,
        trace: &[TruthSample],
        step_s: f64,
        rng: &mut impl Rng,
        effort_rng: &mut impl Rng,
        run_rng: &mut impl Rng,
    ) -> (Vec<Sample>, Vec<TruthSample>) {
        let stride = (self.sampling_s / step_s).round() as usize;
        assert!(
            stride > 0 && (stride as f64 * step_s - self.sampling_s).abs() < 1e-9,
            "sampling {} s must be a multiple of the step {step_s} s",
            self.sampling_s
        );
        let unit = Normal::new(0.0, 1.0).expect("constant");
        let mut walk_m = self.location_walk.map_or(0.0, |walk| walk.sd_m * unit.sample(rng));
        let mut lost = 0_usize;
        let mut samples = Vec::new();
        let mut truth = Vec::new();
        let drawn = |[least, most]: [f64; 2], share: f64| least + share * (most - least);
        let [lag_share, clock_share]: [f64; 2] = std::array::from_fn(|_| run_rng.random());
        let speed_age_s = self.latency_s + drawn(self.speed_lag_s, lag_share);
        let clock = Clock {
            stride,
            sampling_s: self.sampling_s,
            each_second: 1.0 / step_s,
            loses_every_s: self.lost_second_every_s,
            day_s: self.day_clock_s.map(|range| drawn(range, clock_share).floor()),
        };
        let (mut last_row, mut stands) = (0, false);
        let (mut held, mut held_m) = (0_usize, 0.0);
        for tick in 0.. {
            let row = clock.row(tick);
            let Some(at) = trace.get(row) else {
                break;
            };
            // All draws are made whatever is used, so that one option does not move the noise of another.
            let [speed_unit, location_unit, walk_unit] = std::array::from_fn(|_| unit.sample(rng));
            let [drop_location, drop_speed, burst, extent]: [f64; 4] = std::array::from_fn(|_| rng.random());
            if row > 0
                && let Some(walk) = self.location_walk
            {
                let keep = (-self.sampling_s / walk.tau_s).exp();
                walk_m = keep * walk_m + walk.sd_m * (1.0 - keep * keep).sqrt() * walk_unit;
            }
            if let Some(bursts) = self.bursts.filter(|b| lost == 0 && burst < b.probability) {
                let [least, most] = bursts.samples;
                lost = least + (extent * (most - least + 1) as f64) as usize;
            }
            let (_, speed_mps) = delayed(trace, row, speed_age_s / step_s);
            let location_age_s = self.latency_s + self.location_lag_s;
            let (location_m, _) = delayed(trace, row, location_age_s / step_s);
            let heard = lost == 0;
            let read_m = location_m + self.location_offset_m + walk_m + self.location_noise_m * location_unit;
            let location_m = self.shown_m(read_m, trace[0].location_m);
            if let Some(stuck) = self.location_stuck {
                let [begins, extent]: [f64; 2] = std::array::from_fn(|_| run_rng.random());
                if held == 0 && begins < stuck.probability {
                    let [least, most] = stuck.samples;
                    (held, held_m) = (least + (extent * (most - least + 1) as f64) as usize, location_m);
                }
            }
            let location_m = if held > 0 { held_m } else { location_m };
            held = held.saturating_sub(1);
            let speed_kmh = self.shown_kmh(speed_mps, speed_unit);

            let begun = last_row + 1..=row.max(1);
            let mean = |effort: fn(&TruthSample) -> f64, old: usize| {
                if row == 0 {
                    return 0.0;
                }
                let aged = begun.clone().map(|i| effort(&trace[i.saturating_sub(old)]));
                aged.sum::<f64>() / (row - last_row).max(1) as f64
            };
            let mean_effort_n_per_kg = mean(|s| s.effort_n_per_kg, 0);
            let old = (self.effort_lag_s / step_s).round() as usize;
            let reported_n_per_kg = if self.effort_momentary {
                trace[row.saturating_sub(old)].reported_n_per_kg
            } else {
                mean(|s| s.reported_n_per_kg, old)
            };
            let effort_unit = if row == 0 { 0.0 } else { unit.sample(effort_rng) };
            let read_n_per_kg =
                self.gain(reported_n_per_kg) * reported_n_per_kg * (1.0 + self.effort_noise_share * effort_unit)
                    + self.effort_noise_n_per_kg * effort_unit;
            last_row = row;
            lost = lost.saturating_sub(1);
            let stood = std::mem::replace(&mut stands, speed_mps == 0.0);
            if stood && stands && !self.standing_rows {
                continue;
            }
            let time_s = clock.shown_s(tick, at.time_s);
            samples.push(Sample {
                time_s,
                location_m: (heard && drop_location >= self.dropout_probability).then_some(location_m),
                speed_kmh: (heard && drop_speed >= self.dropout_probability).then_some(speed_kmh),
                effort_n_per_kg: self.shown_n_per_kg(read_n_per_kg),
                temperature_c: (10.0 * at.temperature_c).round() / 10.0,
            });
            truth.push(TruthSample { time_s, mean_effort_n_per_kg, ..*at });
        }
        (samples, truth)
    }

    fn shown_n_per_kg(&self, effort_n_per_kg: f64) -> f64 {
        let step = self.effort_step_n_per_kg;
        if step > 0.0 { (effort_n_per_kg / step).round() * step } else { effort_n_per_kg }
    }

    /// Shown over true effort.
    fn gain(&self, effort_n_per_kg: f64) -> f64 {
        self.effort_gain * if effort_n_per_kg < 0.0 { self.brake_gain } else { 1.0 }
    }

    /// A location as it is shown, of a run that began at `begin_m`.
    fn shown_m(&self, location_m: f64, begin_m: f64) -> f64 {
        let location_m =
            if self.location_by_wheel { begin_m + self.speed_gain * (location_m - begin_m) } else { location_m };
        let step = self.location_step_m;
        if step > 0.0 { step * (location_m / step).floor() } else { location_m }
    }

    fn shown_kmh(&self, speed_mps: f64, unit: f64) -> f64 {
        if speed_mps == 0.0 {
            return 0.0;
        }
        let kmh = (3.6 * speed_mps * self.speed_gain + self.speed_noise_kmh * unit).max(0.0);
        let step = self.speed_quantum_kmh;
        match self.speed {
            SpeedReading::Rounded => step * (kmh / step).round(),
            SpeedReading::Truncated => step * (kmh / step).floor(),
            SpeedReading::Exact => kmh,
        }
    }
}

/// The clock of a recorder.
struct Clock {
    /// Rows of the trace between samples.
    stride: usize,
    sampling_s: f64,
    /// Rows of the trace in a second.
    each_second: f64,
    loses_every_s: f64,
    /// Time of the day at which the run begins.
    day_s: Option<f64>,
}

impl Clock {
    /// Row of the trace at a sample.
    fn row(&self, tick: usize) -> usize {
        let lost_s = match self.loses_every_s {
            every_s if every_s > 0.0 => (tick as f64 * self.sampling_s / every_s).floor(),
            _ => 0.0,
        };
        tick * self.stride + (lost_s * self.each_second).round() as usize
    }

    /// The time that is shown at a sample; the true one where the clock has no fault.
    fn shown_s(&self, tick: usize, true_s: f64) -> f64 {
        let gone_s = if self.loses_every_s > 0.0 { tick as f64 * self.sampling_s } else { true_s };
        self.day_s.map_or(gone_s, |begin_s| (begin_s + gone_s).rem_euclid(86_400.0))
    }
}

/// Location and speed `delay` steps before a row, between rows in proportion; before the start, the start.
fn delayed(trace: &[TruthSample], row: usize, delay: f64) -> (f64, f64) {
    let place = (row as f64 - delay).max(0.0);
    let before = trace[place as usize];
    let after = trace[(place as usize + 1).min(trace.len() - 1)];
    let part = place.fract();
    let between = |a: f64, b: f64| a + part * (b - a);
    (between(before.location_m, after.location_m), between(before.speed_mps, after.speed_mps))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    fn steady(rows: usize) -> Vec<TruthSample> {
        let at = |i: usize| TruthSample {
            time_s: i as f64 * 0.1,
            location_m: i as f64 * 3.0,
            speed_mps: 30.0,
            effort_n_per_kg: i as f64,
            mean_effort_n_per_kg: i as f64,
            reported_n_per_kg: i as f64,
            regime: Regime::Cruise,
            resistance_n_per_kg: 0.05,
            extra_n_per_kg: 0.0,
            gravity_n_per_kg: 0.0,
            temperature_c: 10.04,
        };
        (0..rows).map(at).collect()
    }

    fn read(sensors: &Sensors, rows: usize) -> Vec<Sample> {
        let [mut a, mut b, mut c] = [3, 4, 5].map(ChaCha8Rng::seed_from_u64);
        sensors.read(&steady(rows), 0.1, &mut a, &mut b, &mut c).0
    }

    #[test]
    fn latency_shows_an_older_location() {
        let sensors = Sensors { sampling_s: 1.0, location_noise_m: 0.0, latency_s: 0.25, ..Sensors::default() };
        let samples = read(&sensors, 31);
        assert_eq!(samples[0].location_m, Some(0.0));
        assert!((samples[2].location_m.unwrap() - (60.0 - 7.5)).abs() < 1e-9);
    }

    #[test]
    fn a_late_location_stands_beside_a_speed_of_now() {
        let sensors = Sensors { sampling_s: 1.0, location_noise_m: 0.0, location_lag_s: 2.0, ..Sensors::default() };
        let samples = read(&sensors, 51);
        assert!((samples[4].location_m.unwrap() - (120.0 - 60.0)).abs() < 1e-9);
    }

    #[test]
    fn noise_of_the_effort_has_its_size_and_moves_nothing_else() {
        let noisy = Sensors { sampling_s: 0.1, effort_noise_n_per_kg: 0.02, ..Sensors::default() };
        let clean = Sensors { effort_noise_n_per_kg: 0.0, ..noisy.clone() };
        let (a, b) = (read(&noisy, 20_000), read(&clean, 20_000));
        let errors = a.iter().zip(&b).map(|(a, b)| a.effort_n_per_kg - b.effort_n_per_kg);
        let sd = (errors.map(|e| e * e).sum::<f64>() / 20_000.0).sqrt();
        assert!((sd - 0.02).abs() < 0.001, "{sd}");
        assert!(a.iter().zip(&b).all(|(a, b)| a.location_m == b.location_m));
    }

    #[test]
    fn effort_is_the_mean_since_the_sample_before() {
        let sensors = Sensors { sampling_s: 1.0, effort_gain: 2.0, ..Sensors::default() };
        let samples = read(&sensors, 31);
        assert_eq!(samples[0].effort_n_per_kg, 0.0);
        assert!((samples[1].effort_n_per_kg - 2.0 * 5.5).abs() < 1e-12);
        assert!((samples[2].effort_n_per_kg - 2.0 * 15.5).abs() < 1e-12);
    }

    #[test]
    fn braking_efforts_have_a_gain_of_their_own_beside_that_of_all() {
        let sensors = Sensors { effort_gain: 1.1, brake_gain: 0.5, ..Sensors::default() };
        assert!((sensors.gain(0.2) - 1.1).abs() < 1e-12);
        assert!((sensors.gain(-0.2) - 0.55).abs() < 1e-12);
    }

    #[test]
    fn an_effort_that_is_late_shows_the_train_of_that_time_and_moves_nothing_else() {
        for effort_momentary in [true, false] {
            let of_now = Sensors { sampling_s: 1.0, effort_momentary, ..Sensors::default() };
            let late = Sensors { effort_lag_s: 2.0, ..of_now.clone() };
            let (now, late) = (read(&of_now, 61), read(&late, 61));
            assert_eq!(late[5].effort_n_per_kg, now[3].effort_n_per_kg);
            assert!(now.iter().zip(&late).all(|(a, b)| a.location_m == b.location_m));
        }
    }

    #[test]
    fn locations_that_are_off_are_off_by_the_same_everywhere() {
        let right = Sensors { sampling_s: 1.0, ..Sensors::default() };
        let off = Sensors { location_offset_m: -60.0, ..right.clone() };
        let pairs = read(&right, 61).into_iter().zip(read(&off, 61));
        assert!(pairs.into_iter().all(|(a, b)| (a.location_m.unwrap() - b.location_m.unwrap() - 60.0).abs() < 1e-9));
    }

    #[test]
    fn speed_is_shown_as_the_recorder_does() {
        let shown = |speed, mps| Sensors { speed, ..Sensors::default() }.shown_kmh(mps, 0.0);
        assert_eq!(shown(SpeedReading::Rounded, 10.0 / 3.6 + 0.2), 11.0);
        assert_eq!(shown(SpeedReading::Truncated, 10.0 / 3.6 + 0.2), 10.0);
        assert!((shown(SpeedReading::Exact, 10.0) - 36.0).abs() < 1e-12);
        let half = Sensors { speed_quantum_kmh: 0.5, ..Sensors::default() };
        assert_eq!(half.shown_kmh(10.3 / 3.6, 0.0), 10.5);
    }

    #[test]
    fn a_clock_that_loses_seconds_shows_two_in_one_row_and_a_day_begins_again_at_midnight() {
        let exact = Sensors { sampling_s: 1.0, location_noise_m: 0.0, ..Sensors::default() };
        let slow = read(&Sensors { lost_second_every_s: 10.0, ..exact.clone() }, 401);
        let steps = slow.windows(2).map(|pair| pair[1].location_m.unwrap() - pair[0].location_m.unwrap());
        let long: Vec<usize> = steps.enumerate().filter(|(_, m)| (m - 60.0).abs() < 1e-6).map(|(i, _)| i).collect();
        assert_eq!(long, [9, 19, 29]);
        assert!(slow.windows(2).all(|pair| pair[1].time_s - pair[0].time_s == 1.0));
        let night = read(&Sensors { day_clock_s: Some([86_390.0; 2]), ..exact }, 401);
        let times: Vec<f64> = [9, 10, 30].map(|i: usize| night[i].time_s.round()).to_vec();
        assert_eq!(times, [86_399.0, 0.0, 20.0]);
    }

    #[test]
    fn an_odometer_runs_with_the_wheel_of_the_speed_in_whole_metres() {
        let odometer =
            Sensors { location_by_wheel: true, location_step_m: 1.0, speed_gain: 1.013, ..Sensors::default() };
        assert_eq!(odometer.shown_m(1100.5, 100.0), 1113.0);
    }

    #[test]
    fn a_standing_train_is_recorded_once_if_at_all_and_a_location_that_stands_still_says_the_same() {
        let mut trace = steady(401);
        trace[100..201].iter_mut().for_each(|row| row.speed_mps = 0.0);
        let sensors = Sensors { sampling_s: 1.0, standing_rows: false, ..Sensors::default() };
        let [mut a, mut b, mut c] = [3, 4, 5].map(ChaCha8Rng::seed_from_u64);
        let (samples, truth) = sensors.read(&trace, 0.1, &mut a, &mut b, &mut c);
        let times: Vec<f64> = samples.iter().map(|sample| sample.time_s.round()).collect();
        assert_eq!((samples.len(), times[10], times[11]), (31, 10.0, 21.0));
        assert!(truth.iter().zip(&samples).all(|(truth, sample)| truth.time_s == sample.time_s));

        // A speed that is late stands later, and its last row says so.
        let late = Sensors { speed_lag_s: [2.0, 2.0], ..sensors };
        let [mut a, mut b, mut c] = [3, 4, 5].map(ChaCha8Rng::seed_from_u64);
        let (samples, _) = late.read(&trace, 0.1, &mut a, &mut b, &mut c);
        let times: Vec<f64> = samples.iter().map(|sample| sample.time_s.round()).collect();
        assert_eq!((samples.len(), times[12], times[13], samples[12].speed_kmh), (31, 12.0, 23.0, Some(0.0)));

        let stuck = Some(Bursts { probability: 0.05, samples: [4, 6] });
        let samples = read(&Sensors { location_stuck: stuck, sampling_s: 0.1, ..sensors }, 5_000);
        let same: Vec<usize> = samples.chunk_by(|a, b| a.location_m == b.location_m).map(<[_]>::len).collect();
        assert!(same.iter().filter(|length| (4..=6).contains(*length)).count() > 100);
        assert!(same.iter().filter(|length| **length > 1).all(|length| *length >= 4));
    }

    #[test]
    fn the_speed_of_each_run_is_late_by_its_own() {
        let mut trace = steady(401);
        trace.iter_mut().for_each(|row| row.speed_mps = row.time_s);
        let sensors =
            Sensors { sampling_s: 1.0, speed: SpeedReading::Exact, speed_lag_s: [0.2, 4.0], ..Sensors::default() };
        let late_s = |seed| {
            let [mut a, mut b, mut c] = [3, 4, seed].map(ChaCha8Rng::seed_from_u64);
            let (samples, _) = sensors.read(&trace, 0.1, &mut a, &mut b, &mut c);
            30.0 - samples[30].speed_kmh.unwrap() / 3.6
        };
        let late: Vec<f64> = (0..20).map(late_s).collect();
        assert!(late.iter().all(|s| (0.2..4.0).contains(s)), "{late:?}");
        assert!(late.iter().any(|s| *s < 1.5) && late.iter().any(|s| *s > 2.5), "{late:?}");
    }

    #[test]
    fn noise_and_gaps_have_the_stated_size() {
        let sensors = Sensors {
            sampling_s: 0.1,
            speed: SpeedReading::Exact,
            speed_noise_kmh: 1.0,
            location_walk: Some(LocationWalk { sd_m: 3.0, tau_s: 1.0 }),
            dropout_probability: 0.1,
            ..Sensors::default()
        };
        let samples = read(&sensors, 50_000);
        let sd = |errors: &[f64]| (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
        let speed: Vec<f64> = samples.iter().filter_map(|s| Some(s.speed_kmh? - 108.0)).collect();
        let location: Vec<f64> = samples.iter().filter_map(|s| Some(s.location_m? - 30.0 * s.time_s)).collect();
        assert!((sd(&speed) - 1.0).abs() < 0.02);
        assert!((sd(&location) - 5.0).abs() < 0.1);
        assert!((speed.len() as f64 / 50_000.0 - 0.9).abs() < 0.01);
    }

    #[test]
    fn bursts_lose_both_readings_for_the_stated_number_of_samples() {
        let sensors = Sensors {
            sampling_s: 0.1,
            bursts: Some(Bursts { probability: 0.001, samples: [4, 6] }),
            ..Sensors::default()
        };
        let samples = read(&sensors, 50_000);
        let lost: Vec<bool> = samples.iter().map(|s| s.location_m.is_none() && s.speed_kmh.is_none()).collect();
        let lengths: Vec<usize> = lost.chunk_by(|a, b| a == b).filter(|c| c[0]).map(|c| c.len()).collect();
        assert!(lengths.len() > 20);
        assert!(lengths.iter().filter(|l| (4..=6).contains(*l)).count() + 2 > lengths.len(), "{lengths:?}");
    }
}
