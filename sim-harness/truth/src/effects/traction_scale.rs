//! Largest effort and power are others everywhere.

use super::{Capability, EffectError, Expect, Law};
use crate::motion::Motion;
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TractionScale {
    pub factor: f64,
}

impl Law for TractionScale {
    fn check(&self, expect: &Expect) -> Result<(), EffectError> {
        expect.positive("factor", self.factor)
    }

    fn cap(&self, left: &mut Capability, _at: Motion) {
        left.scale *= self.factor;
    }
}
