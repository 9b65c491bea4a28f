//! Tractive effort is capped at low speed, on some days.

use super::{Affected, Capability, EffectError, Expect, Law, Together};
use crate::motion::Motion;
use serde::{Deserialize, Serialize};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LowAdhesion {
    pub factor: f64,
    pub below_kmh: f64,
    pub runs: Affected,
}

impl Law for LowAdhesion {
    fn check(&self, expect: &Expect) -> Result<(), EffectError> {
        expect.positive("factor", self.factor)?;
        expect.positive("below_kmh", self.below_kmh)?;
        expect.runs(&self.runs)
    }

    fn cap(&self, left: &mut Capability, at: Motion) {
        if 3.6 * at.speed_mps < self.below_kmh {
            left.effort_cap = left.effort_cap.min(self.factor);
        }
    }

    fn affected(&self) -> Option<(&Affected, Together)> {
        Some((&self.runs, Together::Day))
    }
}
