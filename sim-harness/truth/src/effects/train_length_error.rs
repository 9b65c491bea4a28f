//! The train has another length than described.

use super::*;

parameters!(TrainLengthError { true_length_m: f64 });

impl Law for TrainLengthError {
    fn alter(&self, world: &mut Altered) {
        world.train.length_m = self.true_length_m;
    }
}
