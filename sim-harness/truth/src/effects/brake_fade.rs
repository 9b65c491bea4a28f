//! Share of the brake that is missing at 140 km/h, growing linearly from `from_kmh` on.

use super::*;

parameters!(BrakeFade { fade_at_140: f64, from_kmh: f64 });

impl Law for BrakeFade {
    /// Tighter than the catalogue: whether drivers stop at the mark beyond this is untried.
    fn check(&self, expect: &Expect) -> Result<(), EffectError> {
        expect.within("fade_at_140", self.fade_at_140, 0.0, 0.8)
    }

    fn brake_share(&self, speed_mps: f64) -> f64 {
        let beyond = (3.6 * speed_mps - self.from_kmh).max(0.0) / (140.0 - self.from_kmh);
        (1.0 - self.fade_at_140 * beyond).max(0.05)
    }
}
