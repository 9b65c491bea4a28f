//! The odometer shows that many times the true speed, to the driver as well.

use super::{Altered, EffectError, Expect, Law};
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpeedScale {
    pub measured_over_true: f64,
}

impl Law for SpeedScale {
    fn check(&self, expect: &Expect) -> Result<(), EffectError> {
        expect.within("measured_over_true", self.measured_over_true, 0.5, 2.0)
    }

    fn alter(&self, world: &mut Altered) {
        world.speed_scale *= self.measured_over_true;
    }
}
