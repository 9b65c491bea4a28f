//! The location is late.

use super::*;

parameters!(LocationLag { lag_s: f64 });

impl Law for LocationLag {
    /// A location of later is in no log.
    fn check(&self, expect: &Expect) -> Result<(), EffectError> {
        expect.within("lag_s", self.lag_s, 0.0, 60.0)
    }

    fn alter(&self, world: &mut Altered) {
        world.location_lag_s += self.lag_s;
    }
}
