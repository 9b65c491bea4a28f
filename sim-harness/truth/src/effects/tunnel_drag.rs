//! Tunnel: more air drag for the part of the train inside.
//!
//! ```text
//! extra = k v² x share inside         k in N/(kg (m/s)²) of the described train
//! ```

use super::{EffectError, Expect, Law, Moment, Setting};
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TunnelDrag {
    pub from_m: f64,
    pub to_m: f64,
    pub k: f64,
}

impl Law for TunnelDrag {
    fn check(&self, expect: &Expect) -> Result<(), EffectError> {
        expect.section(self.from_m, self.to_m)?;
        expect.finite("k", self.k)
    }

    fn extra_n_per_kg(&self, setting: &Setting, at: &Moment) -> f64 {
        let v = at.motion.speed_mps;
        let front_m = at.motion.location_m;
        let tail_m = front_m - setting.train.length_m;
        let inside_m = (front_m.min(self.to_m) - tail_m.max(self.from_m)).max(0.0);
        let share = inside_m / setting.train.length_m;
        setting.described_over_true_mass * self.k * v * v * share
    }

    fn section_mut(&mut self) -> Option<[&mut f64; 2]> {
        Some([&mut self.from_m, &mut self.to_m])
    }
}
