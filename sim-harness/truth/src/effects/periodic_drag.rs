//! A resistance that swings with the time since the departure, N/kg.
//!
//! ```text
//! extra = amplitude sin(2π t / period)
//! ```

use super::*;
use std::f64::consts::PI;

parameters!(PeriodicDrag { amplitude: f64, period_s: f64 });

impl Law for PeriodicDrag {
    fn check(&self, expect: &Expect) -> Result<(), EffectError> {
        expect.above_zero("period_s", self.period_s)
    }

    fn extra_n_per_kg(&self, _setting: &Setting, at: &Moment) -> f64 {
        self.amplitude * (2.0 * PI * at.since_departure_s / self.period_s).sin()
    }

    fn unknown_coordinate(&self) -> Option<&'static str> {
        Some("time")
    }
}
