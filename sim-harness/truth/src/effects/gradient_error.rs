//! The true gradient is that much steeper than described, uphill in the `up` direction positive.

use super::*;

parameters!(GradientError { from_m: f64, to_m: f64, delta_permille: f64 });

impl Law for GradientError {
    fn alter(&self, world: &mut Altered) {
        world.line = world.line.with_extra_gradient(self.from_m, self.to_m, self.delta_permille);
    }
}
