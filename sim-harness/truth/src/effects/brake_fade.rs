//! Share of the brake that is missing at 140 km/h, growing linearly from `from_kmh` on.

use super::{EffectError, Expect, Law};
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BrakeFade {
    pub fade_at_140: f64,
    pub from_kmh: f64,
}

impl Law for BrakeFade {
    fn check(&self, expect: &Expect) -> Result<(), EffectError> {
        expect.within("fade_at_140", self.fade_at_140, 0.0, 0.8)?;
        expect.that((0.0..140.0).contains(&self.from_kmh), "from_kmh", "0 to below 140", self.from_kmh)
    }

    fn brake_share(&self, speed_mps: f64) -> f64 {
        let beyond = (3.6 * speed_mps - self.from_kmh).max(0.0) / (140.0 - self.from_kmh);
        (1.0 - self.fade_at_140 * beyond).max(0.05)
    }
}
