//! Location and speed from the readings alone: what is known while the effort is not.
//!
//! In: judged readings. Out: location and speed with their covariance, independent of any resistance. The speed is the
//! reading; the location is carried on by the mean speed and corrected by the location reading. Without a speed the
//! last one is carried on; its standard deviation grows by 0.3 m/s² x time, what a driver may do meanwhile. As much may
//! lie between two readings that are far apart: a train may have stopped there. Where for some
//! seconds nothing but the location is read it is its reading, for what the carried speed misses has one sign.

use crate::Real;
use crate::extremes::Extremes;
use crate::filter::gaussian::Gaussian;
use crate::plain::plain;
use crate::tick::sensor::SensorConfig;
use nalgebra::{Matrix2, Vector2};

/// What a driver may do to the speed while nobody reads it, m/s².
const UNKNOWN_ACCELERATION_MPS2: Real = 0.3;
/// A carried speed that may be off by more says nothing beside a location, m/s.
const MOST_CARRIED_MPS: Real = 1.0;
/// Rows farther apart may have a stop between them, s.
const FAR_APART_S: Real = 15.0;
/// Share by which a distance by speed may be wrong (worn wheels).
const DISTANCE_SHARE: Real = 0.01;

/// Location and speed by dead reckoning.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Kinematics {
    location_m: Real,
    location_variance: Real,
    speed_mps: Real,
    speed_sd_mps: Real,
}

plain! {
    struct Kinematics { location_m, location_variance, speed_mps, speed_sd_mps }
}

impl Kinematics {
    /// Zeros, as by default.
    pub(crate) const ZEROED: Self = Self { location_m: 0.0, location_variance: 0.0, speed_mps: 0.0, speed_sd_mps: 0.0 };

    /// Begins; a missing location or speed begins at 0 with a standard deviation that says so.
    pub fn begin(sensor: &SensorConfig, location_m: Option<Real>, speed_mps: Option<Real>) -> Self {
        let location_sd_m = location_m.map_or(1e5, |_| sensor.location_sd_m);
        let speed_sd_mps = speed_mps.map_or(30.0, |_| sensor.speed_sd_mps());
        Self {
            location_m: location_m.unwrap_or(0.0),
            location_variance: location_sd_m * location_sd_m,
            speed_mps: speed_mps.unwrap_or(0.0),
            speed_sd_mps,
        }
    }

    /// One tick. `sign` is +1 where locations grow.
    pub fn step(
        &mut self,
        sensor: &SensorConfig,
        sign: Real,
        dt_s: Real,
        location_m: Option<Real>,
        speed_mps: Option<Real>,
    ) {
        let (before_mps, before_sd_mps) = (self.speed_mps, self.speed_sd_mps);
        let grown_mps = UNKNOWN_ACCELERATION_MPS2 * dt_s;
        match speed_mps {
            Some(speed_mps) => {
                self.speed_mps = speed_mps;
                self.speed_sd_mps = sensor.speed_sd_mps();
            }
            // Bounded: no train is further from its last speed than this.
            None => self.speed_sd_mps = (before_sd_mps + grown_mps).at_most(30.0),
        }
        let run_m = 0.5 * (before_mps + self.speed_mps) * dt_s;
        self.location_m += sign * run_m;
        let wrong_m = if dt_s > FAR_APART_S { 0.125 * grown_mps * dt_s } else { DISTANCE_SHARE * run_m };
        let speeds = before_sd_mps * before_sd_mps + self.speed_sd_mps * self.speed_sd_mps;
        let reading = if run_m == 0.0 { 0.0 } else { 0.25 * speeds * dt_s * dt_s };
        self.location_variance = self.location_variance + wrong_m * wrong_m + reading;
        if let Some(location_m) = location_m {
            if speed_mps.is_none() && self.speed_sd_mps > MOST_CARRIED_MPS {
                return self.anchor(sensor, location_m);
            }
            let sensor_variance = sensor.location_sd_m * sensor.location_sd_m;
            let gain = self.location_variance / (self.location_variance + sensor_variance);
            self.location_m += gain * (location_m - self.location_m);
            self.location_variance *= 1.0 - gain;
        }
    }

    /// The location is taken from its reading after a jump that turned out to be true.
    // Once in the image.
    #[inline(never)]
    pub fn anchor(&mut self, sensor: &SensorConfig, location_m: Real) {
        self.location_m = location_m;
        self.location_variance = sensor.location_sd_m * sensor.location_sd_m;
    }

    /// Location and speed, independent of each other.
    pub fn belief(&self) -> Gaussian<2> {
        Gaussian {
            mean: Vector2::new(self.location_m, self.speed_mps),
            covariance: Matrix2::from_diagonal(&Vector2::new(
                self.location_variance,
                self.speed_sd_mps * self.speed_sd_mps,
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn begun(location_m: Real, speed_mps: Real) -> (SensorConfig, Kinematics) {
        let sensor = SensorConfig::default();
        (sensor, Kinematics::begin(&sensor, Some(location_m), Some(speed_mps)))
    }

    #[test]
    fn without_a_speed_the_location_is_its_reading() {
        let (sensor, mut moving) = begun(0.0, 20.0);
        // It has begun to brake.
        let located = |t: Real| 20.0 * t - 0.25 * t * t;
        for second in 1..=10 {
            moving.step(&sensor, 1.0, 1.0, Some(located(Real::from(second))), None);
        }
        let belief = moving.belief();
        assert_eq!((belief.mean[0], belief.sd(0)), (located(10.0), sensor.location_sd_m));
        assert!((belief.sd(1) - sensor.speed_sd_mps() - 3.0).abs() < 1e-9, "{}", belief.sd(1));
        // A reading of the speed ends that, and is believed of the way up to it as little as the speed before.
        moving.step(&sensor, 1.0, 1.0, None, Some(15.0));
        assert!(moving.belief().sd(0) > 1.5 && moving.belief().sd(1) == sensor.speed_sd_mps());
    }

    #[test]
    fn a_train_may_have_stopped_between_rows_that_are_far_apart() {
        // It stood for most of 49 s, and went 5 m: by the mean speed it would have gone 90 m.
        let (sensor, mut moving) = begun(0.0, 1.8);
        moving.step(&sensor, 1.0, 49.0, None, Some(1.8));
        assert!((80.0..100.0).contains(&moving.belief().sd(0)), "{}", moving.belief().sd(0));
        moving.step(&sensor, 1.0, 1.0, Some(6.8), Some(2.0));
        assert!((moving.belief().mean[0] - 6.8).abs() < 15.0, "{}", moving.belief().mean[0]);
        let (sensor, mut moving) = begun(0.0, 25.0);
        moving.step(&sensor, 1.0, 10.0, None, Some(25.0));
        assert!(
            moving.belief().sd(0) < 1.2 * sensor.location_sd_m,
            "rows of 10 s show stops: {}",
            moving.belief().sd(0)
        );
    }
}
