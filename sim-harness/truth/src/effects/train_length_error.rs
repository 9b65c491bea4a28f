//! The train has another length than described, in all runs unless said.

use super::*;

parameters!(TrainLengthError {
    true_length_m: f64,
    #[serde(default = "Affected::all")]
    runs: Affected
});

impl Law for TrainLengthError {
    fn alter(&self, world: &mut Altered) {
        world.train.length_m = self.true_length_m;
    }

    fn affected(&self) -> Option<(&Affected, Together)> {
        Some((&self.runs, Together::Nothing))
    }
}
