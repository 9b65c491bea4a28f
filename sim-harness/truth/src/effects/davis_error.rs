//! The described Davis parameters are wrong by these.

use super::*;

parameters!(DavisError { dr0: f64, dr1: f64, dr2: f64 });

impl Law for DavisError {
    fn alter(&self, world: &mut Altered) {
        world.train.davis.r0 += self.dr0;
        world.train.davis.r1 += self.dr1;
        world.train.davis.r2 += self.dr2;
    }
}
