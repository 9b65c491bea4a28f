//! Stiff bearings in the first minutes, N/kg.
//!
//! ```text
//! extra = amplitude exp(-t / tau)          t since the departure
//! ```

use super::{EffectError, Expect, Law, Moment, Setting};
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WarmUp {
    pub amplitude: f64,
    pub tau_s: f64,
}

impl Law for WarmUp {
    fn check(&self, expect: &Expect) -> Result<(), EffectError> {
        expect.finite("amplitude", self.amplitude)?;
        expect.positive("tau_s", self.tau_s)
    }

    fn extra_n_per_kg(&self, _setting: &Setting, at: &Moment) -> f64 {
        self.amplitude * (-at.since_departure_s / self.tau_s).exp()
    }
}
