//! Largest effort and power are others everywhere.

use super::*;

parameters!(TractionScale { factor: f64 });

impl Law for TractionScale {
    fn cap(&self, left: &mut Capability, _at: Motion) {
        left.scale *= self.factor;
    }
}
