//! The described Davis parameters are wrong by these.

use super::{Altered, EffectError, Expect, Law};
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DavisError {
    pub dr0: f64,
    pub dr1: f64,
    pub dr2: f64,
}

impl Law for DavisError {
    fn check(&self, expect: &Expect) -> Result<(), EffectError> {
        expect.finite("dr0", self.dr0)?;
        expect.finite("dr1", self.dr1)?;
        expect.finite("dr2", self.dr2)
    }

    fn alter(&self, world: &mut Altered) {
        world.train.davis.r0 += self.dr0;
        world.train.davis.r1 += self.dr1;
        world.train.davis.r2 += self.dr2;
    }
}
