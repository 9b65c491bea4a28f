//! True over described mass, minus 1.

use super::{Altered, EffectError, Expect, Law};
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MassError {
    pub relative: f64,
}

impl Law for MassError {
    fn check(&self, expect: &Expect) -> Result<(), EffectError> {
        expect.within("relative", self.relative, -0.5, 1.0)
    }

    fn alter(&self, world: &mut Altered) {
        world.train = world.train.heavier(1.0 + self.relative);
    }
}
