//! A resistance that swings with the time since the departure, N/kg.
//!
//! ```text
//! extra = amplitude sin(2π t / period)
//! ```

use super::{EffectError, Expect, Law, Moment, Setting};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PeriodicDrag {
    pub amplitude: f64,
    pub period_s: f64,
}

impl Law for PeriodicDrag {
    fn check(&self, expect: &Expect) -> Result<(), EffectError> {
        expect.finite("amplitude", self.amplitude)?;
        expect.positive("period_s", self.period_s)
    }

    fn extra_n_per_kg(&self, _setting: &Setting, at: &Moment) -> f64 {
        self.amplitude * (2.0 * PI * at.since_departure_s / self.period_s).sin()
    }

    fn unknown_coordinate(&self) -> Option<&'static str> {
        Some("time")
    }
}
