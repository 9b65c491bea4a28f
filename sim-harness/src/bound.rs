//! How well any unbiased estimator can know the resistance from these readings: the Cramér-Rao bound.
//!
//! In: the true motion at the samples of the runs of a vehicle, what the sensors are worth, and what was known before.
//! Out: the smallest possible covariance of r0, r1, r2.
//!
//! ```text
//! x = (s, v, r0, r1, r2, gain, wind)            dv/dt = gain u - r0 - r1 v - r2 (v + wind)² - g
//! d(δs)/dt = δv,  d(δv)/dt = -(r1 + 2 r2 v) δv - (1, v, v², -u, 2 r2 v) (δr0, δr1, δr2, δgain, δwind)
//! P <- F P Fᵀ + Q between samples,  P <- (I - K H) P at each:  the covariance of a Kalman filter along the true motion
//! ```
//!
//! s and v are unknown where a stretch begins: consecutive intervals in which the effort is known, zero while coasting,
//! or measured. The wind is another one in each run. Q is what white noise of the measured effort does. What is rounded
//! counts as having normal noise of quantum/√12, and slow noise of the location as white; where speeds change slowly,
//! intervals of rounding say more, and then an estimator may come below the bound. That the gradient changes with an
//! error of the location is left out: 4 m move it by nothing.

use nalgebra::{Matrix3, SMatrix, SVector};
use rundown::estimator::config::Mode;
use rundown_truth::sensors::{Sample, Sensors, SpeedReading, TruthSample};

/// s, v, r0, r1, r2, gain, wind.
const SIZE: usize = 7;
const GAIN: usize = 5;
const WIND: usize = 6;
const STEP_S: f64 = 0.5;
/// Slower trains stand, m/s.
const STANDING_MPS: f64 = 1e-6;
/// A mean effort below this is that of an interval of coasting, N/kg.
const NO_EFFORT_N_PER_KG: f64 = 1e-12;
/// Variances of what is not known at all, m² and (m/s)².
const UNKNOWN: [f64; 2] = [1e10, 1e4];

type Covariance = SMatrix<f64, SIZE, SIZE>;

/// Where the effort is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Known {
    /// Where it is zero: while coasting.
    Coasting,
    /// Everywhere but at standstill, up to a constant gain.
    Measured,
}

impl Known {
    /// To an estimator in this mode.
    pub fn of(mode: Mode) -> Self {
        if mode == Mode::Measured { Self::Measured } else { Self::Coasting }
    }
}

/// What the readings are worth, as variances in m² and (m/s)², and as a share of the effort.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Worth {
    pub location: f64,
    pub speed: f64,
    /// White noise of the measured effort, as a share of it and as a variance in (N/kg)².
    pub effort_share: f64,
    pub effort: f64,
}

impl Worth {
    /// Of these sensors.
    pub fn of(sensors: &Sensors) -> Self {
        let quantum_kmh: f64 = match sensors.speed {
            SpeedReading::Exact => 0.0,
            SpeedReading::Rounded | SpeedReading::Truncated => sensors.speed_quantum_kmh,
        };
        let step = |quantum: f64| quantum.powi(2) / 12.0;
        let kmh2 = step(quantum_kmh) + sensors.speed_noise_kmh.powi(2);
        let walk_m = sensors.location_walk.map_or(0.0, |walk| walk.sd_m);
        let location = sensors.location_noise_m.powi(2) + walk_m.powi(2) + step(sensors.location_step_m);
        Self {
            location: location.max(1e-12),
            speed: (kmh2 / 3.6_f64.powi(2)).max(1e-12),
            effort_share: sensors.effort_noise_share,
            effort: sensors.effort_noise_n_per_kg.powi(2) + step(sensors.effort_step_n_per_kg),
        }
    }
}

/// What can be known of a vehicle so far.
#[derive(Clone, Debug)]
pub struct Bound {
    known: Known,
    worth: Worth,
    wind_sd_mps: f64,
    covariance: Covariance,
}

impl Bound {
    /// Before the first run: covariance of r0, r1, r2, standard deviations of the gain and of the wind of a run.
    pub fn new(known: Known, worth: Worth, davis: Matrix3<f64>, gain_sd: f64, wind_sd_mps: f64) -> Self {
        let mut covariance = Covariance::zeros();
        covariance.fixed_view_mut::<3, 3>(2, 2).copy_from(&davis);
        covariance[(GAIN, GAIN)] = gain_sd * gain_sd;
        Self { known, worth, wind_sd_mps, covariance }
    }

    /// Smallest possible covariance of r0, r1, r2.
    pub fn davis(&self) -> Matrix3<f64> {
        self.covariance.fixed_view::<3, 3>(2, 2).into_owned()
    }

    /// The gain of the next run is another one.
    pub fn another_gain(&mut self, sd: f64) {
        self.forget(GAIN, sd * sd);
    }

    /// Adds a run with the coefficients that it has.
    pub fn run(&mut self, truth: &[TruthSample], samples: &[Sample], davis: [f64; 3]) {
        self.forget(WIND, self.wind_sd_mps * self.wind_sd_mps);
        let mut goes_on = false;
        for (motion, readings) in truth.windows(2).zip(samples.windows(2)) {
            let (before, now) = (&motion[0], &motion[1]);
            let moves = before.speed_mps > STANDING_MPS && now.speed_mps > STANDING_MPS;
            let is_known = match self.known {
                Known::Coasting => now.mean_effort_n_per_kg.abs() < NO_EFFORT_N_PER_KG,
                Known::Measured => true,
            };
            if !(moves && is_known) {
                goes_on = false;
                continue;
            }
            if !goes_on {
                UNKNOWN.into_iter().enumerate().for_each(|(i, variance)| self.forget(i, variance));
                self.read(&readings[0]);
            }
            goes_on = true;
            self.advance(before, now, davis);
            self.read(&readings[1]);
        }
    }

    /// Nothing is known of it any more but how large it may be.
    fn forget(&mut self, index: usize, variance: f64) {
        self.covariance.row_mut(index).fill(0.0);
        self.covariance.column_mut(index).fill(0.0);
        self.covariance[(index, index)] = variance;
    }

    fn advance(&mut self, before: &TruthSample, now: &TruthSample, davis: [f64; 3]) {
        let dt_s = now.time_s - before.time_s;
        let effort = now.mean_effort_n_per_kg;
        let steps = (dt_s / STEP_S).ceil().max(1.0);
        let h = dt_s / steps;
        let mut change = Covariance::identity();
        for step in 0..steps as usize {
            let part = (step as f64 + 0.5) / steps;
            let v = before.speed_mps + part * (now.speed_mps - before.speed_mps);
            let damping = davis[1] + 2.0 * davis[2] * v;
            let by = SVector::<f64, SIZE>::from([0.0, 0.0, 1.0, v, v * v, -effort, 2.0 * davis[2] * v]);
            let speed = change.row(1).into_owned();
            // Implicit midpoint: the equation is linear.
            let next = (speed * (1.0 - 0.5 * h * damping) - h * by.transpose()) / (1.0 + 0.5 * h * damping);
            let location = change.row(0) + 0.5 * h * (speed + next);
            change.set_row(0, &location);
            change.set_row(1, &next);
        }
        self.covariance = change * self.covariance * change.transpose();
        if self.known == Known::Measured {
            let mut moved = SVector::<f64, SIZE>::zeros();
            (moved[0], moved[1]) = (0.5 * dt_s * dt_s, dt_s);
            let noise = (self.worth.effort_share * effort).powi(2) + self.worth.effort;
            self.covariance += moved * moved.transpose() * noise;
        }
    }

    fn read(&mut self, sample: &Sample) {
        let readings =
            [(sample.location_m.is_some(), self.worth.location), (sample.speed_kmh.is_some(), self.worth.speed)];
        for (index, (_, variance)) in readings.into_iter().enumerate().filter(|(_, (is_there, _))| *is_there) {
            let column = self.covariance.column(index).into_owned();
            let gain = column / (column[index] + variance);
            // Joseph's form: what is unknown is 10 orders beside what is known.
            let mut rest = Covariance::identity();
            (0..SIZE).for_each(|row| rest[(row, index)] -= gain[row]);
            self.covariance = rest * self.covariance * rest.transpose() + gain * gain.transpose() * variance;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rundown_truth::regime::Regime;

    /// A train that coasts against a constant resistance: v = v0 - r0 t, s = s0 + v0 t - r0 t²/2.
    fn coasting(count: usize, effort_n_per_kg: f64) -> (Vec<TruthSample>, Vec<Sample>) {
        let truth = (0..count).map(|i| {
            let t = 10.0 * i as f64;
            TruthSample {
                time_s: t,
                location_m: 40.0 * t - 0.015 * t * t,
                speed_mps: 40.0 - 0.03 * t,
                effort_n_per_kg,
                mean_effort_n_per_kg: effort_n_per_kg,
                reported_n_per_kg: effort_n_per_kg,
                regime: Regime::Coast,
                resistance_n_per_kg: 0.03,
                extra_n_per_kg: 0.0,
                gravity_n_per_kg: 0.0,
                temperature_c: 10.0,
            }
        });
        let samples = (0..count).map(|i| Sample {
            time_s: 10.0 * i as f64,
            location_m: Some(0.0),
            speed_kmh: Some(0.0),
            effort_n_per_kg,
            temperature_c: 10.0,
        });
        (truth.collect(), samples.collect())
    }

    const UNKNOWN_DAVIS: f64 = 1e4;

    /// What one run tells of r0 where nothing else is unknown: the inverse of its variance.
    fn told(known: Known, gain_sd: f64, worth: Worth, (truth, samples): &(Vec<TruthSample>, Vec<Sample>)) -> f64 {
        let prior = Matrix3::from_diagonal(&nalgebra::Vector3::new(UNKNOWN_DAVIS, 0.0, 0.0));
        let mut bound = Bound::new(known, worth, prior, gain_sd, 0.0);
        bound.run(truth, samples, [0.03, 0.0, 0.0]);
        1.0 / bound.davis()[(0, 0)]
    }

    #[test]
    fn the_slope_of_a_straight_line_is_known_as_well_as_least_squares_say() {
        // The location is worth nothing: what is left is a line through 11 speeds.
        let worth = Worth { location: 1e16, speed: 0.04, effort_share: 0.0, effort: 0.0 };
        let spread: f64 = (0..11).map(|i| (10.0 * f64::from(i) - 50.0).powi(2)).sum();
        let found = told(Known::Coasting, 0.0, worth, &coasting(11, 0.0));
        assert!((found / (spread / 0.04) - 1.0).abs() < 1e-4, "{found}");
    }

    #[test]
    fn only_coasting_teaches_where_the_effort_is_unknown() {
        let powered = coasting(11, 0.1);
        let worth = Worth::of(&Sensors::default());
        assert_eq!(told(Known::Coasting, 0.0, worth, &powered), 1.0 / UNKNOWN_DAVIS);
        let known = |gain_sd| told(Known::Measured, gain_sd, worth, &powered);
        // A constant effort of unknown gain is confounded with r0.
        assert!(known(0.0) > 100.0 * known(0.1));
        for noisy in [Worth { effort_share: 0.1, ..worth }, Worth { effort: 1e-4, ..worth }] {
            assert!(told(Known::Measured, 0.0, noisy, &powered) < 0.5 * known(0.0));
        }
    }

    /// A wind of each run is averaged over runs, a gain of the vehicle is not.
    #[test]
    fn what_is_another_one_in_each_run_is_known_better_after_many() {
        let (truth, samples) = coasting(200, 0.0);
        let worth = Worth::of(&Sensors { location_noise_m: 0.1, ..Sensors::default() });
        let davis = [0.01, 0.0, 2e-5];
        let sd_after = |runs: usize, wind_sd_mps: f64| {
            let prior = Matrix3::from_diagonal(&nalgebra::Vector3::new(0.0, 1e-4, 0.0));
            let mut bound = Bound::new(Known::Coasting, worth, prior, 0.0, wind_sd_mps);
            (0..runs).for_each(|_| bound.run(&truth, &samples, davis));
            bound.davis()[(1, 1)].sqrt()
        };
        // 2 r2 w v beside r1 v.
        assert!((sd_after(1, 2.0) / (2.0 * 2e-5 * 2.0) - 1.0).abs() < 0.05, "{}", sd_after(1, 2.0));
        assert!((sd_after(16, 2.0) / sd_after(1, 2.0) * 4.0 - 1.0).abs() < 0.05);
        assert!(sd_after(1, 0.0) < 0.1 * sd_after(1, 2.0));
    }

    #[test]
    fn rounding_is_noise_of_its_own() {
        let worth = Worth::of(&Sensors::default());
        assert!((worth.speed.sqrt() - 1.0 / 3.6 / 12.0_f64.sqrt()).abs() < 1e-12);
        assert_eq!(worth.location, 16.0);
        let odometer = Sensors { location_noise_m: 0.0, location_step_m: 1.0, ..Sensors::default() };
        assert_eq!(Worth::of(&odometer).location, 1.0 / 12.0);
    }
}
