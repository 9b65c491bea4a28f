//! More resistance around a speed (bogies that hunt), a raised cosine of this half-width.

use super::{EffectError, Expect, Law, Moment, Setting, raised_cosine};
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpeedBump {
    pub at_kmh: f64,
    pub half_width_kmh: f64,
    pub drag_n_per_kg: f64,
}

impl Law for SpeedBump {
    fn check(&self, expect: &Expect) -> Result<(), EffectError> {
        expect.finite("at_kmh", self.at_kmh)?;
        expect.positive("half_width_kmh", self.half_width_kmh)?;
        expect.finite("drag_n_per_kg", self.drag_n_per_kg)
    }

    fn extra_n_per_kg(&self, _setting: &Setting, at: &Moment) -> f64 {
        self.drag_n_per_kg * raised_cosine((3.6 * at.motion.speed_mps - self.at_kmh) / self.half_width_kmh)
    }

    fn unknown_coordinate(&self) -> Option<&'static str> {
        Some("speed")
    }
}
