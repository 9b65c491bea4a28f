//! More resistance below a temperature (stiff grease), full 2 °C below it.

use super::{EffectError, Expect, Law, Moment, Setting};
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Frost {
    pub below_c: f64,
    pub drag_n_per_kg: f64,
}

impl Law for Frost {
    fn check(&self, expect: &Expect) -> Result<(), EffectError> {
        expect.finite("below_c", self.below_c)?;
        expect.finite("drag_n_per_kg", self.drag_n_per_kg)
    }

    fn extra_n_per_kg(&self, _setting: &Setting, at: &Moment) -> f64 {
        self.drag_n_per_kg * ((self.below_c - at.temperature_c) / 2.0).clamp(0.0, 1.0)
    }

    fn unknown_coordinate(&self) -> Option<&'static str> {
        Some("temperature")
    }
}
