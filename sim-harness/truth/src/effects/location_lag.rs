//! The location is late.

use super::{Altered, EffectError, Expect, Law};
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LocationLag {
    pub lag_s: f64,
}

impl Law for LocationLag {
    fn check(&self, expect: &Expect) -> Result<(), EffectError> {
        expect.within("lag_s", self.lag_s, 0.0, 60.0)
    }

    fn alter(&self, world: &mut Altered) {
        world.location_lag_s += self.lag_s;
    }
}
