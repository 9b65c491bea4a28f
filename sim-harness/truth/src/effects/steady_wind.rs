//! Headwind in the `up` direction in every run.

use super::{Altered, EffectError, Expect, Law};
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SteadyWind {
    pub wind_mps: f64,
}

impl Law for SteadyWind {
    fn check(&self, expect: &Expect) -> Result<(), EffectError> {
        expect.within("wind_mps", self.wind_mps, -40.0, 40.0)
    }

    fn alter(&self, world: &mut Altered) {
        world.headwind_mps += world.up_sign * self.wind_mps;
    }
}
