//! The true gradient is that much steeper than described, uphill in the `up` direction positive.

use super::{Altered, EffectError, Expect, Law};
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GradientError {
    pub from_m: f64,
    pub to_m: f64,
    pub delta_permille: f64,
}

impl Law for GradientError {
    fn check(&self, expect: &Expect) -> Result<(), EffectError> {
        expect.section(self.from_m, self.to_m)?;
        expect.within("delta_permille", self.delta_permille, -100.0, 100.0)
    }

    fn alter(&self, world: &mut Altered) {
        world.line = world.line.with_extra_gradient(self.from_m, self.to_m, self.delta_permille);
    }
}
