//! The odometer shows that many times the true speed, to the driver as well.

use super::*;

parameters!(SpeedScale { measured_over_true: f64 });

impl Law for SpeedScale {
    fn alter(&self, world: &mut Altered) {
        world.speed_scale *= self.measured_over_true;
    }
}
