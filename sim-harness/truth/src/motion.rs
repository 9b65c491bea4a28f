//! Location and speed, and how they change in one short step.
//!
//! In: an acceleration as a function of motion and time. Out: the motion at the end of the step.
//!
//! ```text
//! ds/dt = v        dv/dt = a(s, v, t)
//! ```
//!
//! Classical Runge-Kutta of fourth order; a train that would roll back stands instead.

/// Location of the front along the way travelled, and speed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// m.
    pub location_m: f64,
    /// m/s, never negative.
    pub speed_mps: f64,
}

impl Motion {
    /// One step. `acceleration_mps2` gets a motion and the time since the begin of the step, s.
    /// A train that stops within the step stands at its end, held by the brake.
    ///
    /// ```
    /// use rundown_truth::motion::Motion;
    ///
    /// let start = Motion { location_m: 0.0, speed_mps: 10.0 };
    /// let end = start.advance(2.0, |_, _| -0.5);
    /// assert!((end.speed_mps - 9.0).abs() < 1e-12 && (end.location_m - 19.0).abs() < 1e-12);
    /// ```
    pub fn advance(self, step_s: f64, acceleration_mps2: impl Fn(Motion, f64) -> f64) -> Motion {
        let slope = |m: Motion, t: f64| (m.speed_mps, acceleration_mps2(m, t));
        let along = |(ds, dv): (f64, f64), t: f64| Motion {
            location_m: self.location_m + ds * t,
            speed_mps: self.speed_mps + dv * t,
        };
        let k1 = slope(self, 0.0);
        let k2 = slope(along(k1, step_s / 2.0), step_s / 2.0);
        let k3 = slope(along(k2, step_s / 2.0), step_s / 2.0);
        let k4 = slope(along(k3, step_s), step_s);
        let mean = |f: fn((f64, f64)) -> f64| (f(k1) + 2.0 * f(k2) + 2.0 * f(k3) + f(k4)) / 6.0;
        let (ds, dv) = (mean(|k| k.0), mean(|k| k.1));
        let end = along((ds, dv), step_s);
        if end.speed_mps > 0.0 {
            return end;
        }
        // v²/(2|a|) with the mean deceleration of the step.
        let rest_m = if dv < 0.0 { self.speed_mps * self.speed_mps / (-2.0 * dv) } else { 0.0 };
        Motion { location_m: self.location_m + rest_m, speed_mps: 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(start: Motion, steps: usize, acceleration: impl Fn(Motion, f64) -> f64) -> Motion {
        (0..steps).fold(start, |m, _| m.advance(0.1, &acceleration))
    }

    #[test]
    fn coasting_against_a_constant_resistance_follows_the_closed_form() {
        let start = Motion { location_m: 100.0, speed_mps: 38.0 };
        let end = after(start, 6000, |_, _| -0.03);
        let t = 600.0;
        assert!((end.speed_mps - (38.0 - 0.03 * t)).abs() < 1e-9);
        assert!((end.location_m - (100.0 + 38.0 * t - 0.015 * t * t)).abs() < 1e-6);
    }

    #[test]
    fn coasting_against_air_alone_follows_the_closed_form() {
        // dv/dt = -r2 v²  =>  1/v = 1/v0 + r2 t
        let start = Motion { location_m: 0.0, speed_mps: 38.0 };
        let end = after(start, 6000, |m, _| -2.8e-5 * m.speed_mps * m.speed_mps);
        let expected = 1.0 / (1.0 / 38.0 + 2.8e-5 * 600.0);
        assert!((end.speed_mps - expected).abs() < 1e-9);
        assert!((end.location_m - (38.0_f64 / expected).ln() / 2.8e-5).abs() < 1e-6);
    }

    #[test]
    fn time_within_the_step_counts() {
        // dv/dt = -t within one step: v = v0 - t²/2, exact for this order.
        let start = Motion { location_m: 0.0, speed_mps: 10.0 };
        let end = start.advance(2.0, |_, t| -t);
        assert!((end.speed_mps - 8.0).abs() < 1e-12);
        assert!((end.location_m - (20.0 - 8.0 / 6.0)).abs() < 1e-12);
    }

    #[test]
    fn a_braked_train_stops_after_the_closed_form_distance_and_stands() {
        let start = Motion { location_m: 0.0, speed_mps: 10.03 };
        let end = after(start, 1000, |_, _| -0.5);
        assert_eq!(end.speed_mps, 0.0);
        assert!((end.location_m - 10.03 * 10.03).abs() < 1e-9);
    }
}
