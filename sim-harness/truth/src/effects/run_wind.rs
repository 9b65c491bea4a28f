//! Wind along the line that differs from run to run.

use super::{Altered, EffectError, Expect, Law};
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunWind {
    pub sd_mps: f64,
}

impl Law for RunWind {
    fn check(&self, expect: &Expect) -> Result<(), EffectError> {
        expect.within("sd_mps", self.sd_mps, 0.0, 20.0)
    }

    fn alter(&self, world: &mut Altered) {
        world.headwind_mps += world.up_sign * self.sd_mps * world.unit_normal();
    }
}
