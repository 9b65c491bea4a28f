//! The train has another length than described.

use super::{Altered, EffectError, Expect, Law};
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainLengthError {
    pub true_length_m: f64,
}

impl Law for TrainLengthError {
    fn check(&self, expect: &Expect) -> Result<(), EffectError> {
        expect.positive("true_length_m", self.true_length_m)
    }

    fn alter(&self, world: &mut Altered) {
        world.train.length_m = self.true_length_m;
    }
}
