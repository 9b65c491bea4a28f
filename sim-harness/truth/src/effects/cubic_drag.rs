//! A v³ term, k in N/(kg (m/s)³).

use super::{EffectError, Expect, Law, Moment, Setting};
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CubicDrag {
    pub k: f64,
}

impl Law for CubicDrag {
    fn check(&self, expect: &Expect) -> Result<(), EffectError> {
        expect.finite("k", self.k)
    }

    fn extra_n_per_kg(&self, _setting: &Setting, at: &Moment) -> f64 {
        let v = at.motion.speed_mps;
        self.k * v * v * v
    }

    fn unknown_coordinate(&self) -> Option<&'static str> {
        Some("speed")
    }
}
