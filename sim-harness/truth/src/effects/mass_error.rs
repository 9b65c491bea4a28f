//! True over described mass, minus 1.

use super::*;

parameters!(MassError { relative: f64 });

impl Law for MassError {
    fn alter(&self, world: &mut Altered) {
        world.train = world.train.heavier(1.0 + self.relative);
    }
}
