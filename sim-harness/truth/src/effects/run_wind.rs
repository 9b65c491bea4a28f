//! Wind along the line that differs from run to run.

use super::*;

parameters!(RunWind { sd_mps: f64 });

impl Law for RunWind {
    fn alter(&self, world: &mut Altered) {
        world.headwind_mps += world.up_sign * self.sd_mps * world.unit_normal();
    }
}
