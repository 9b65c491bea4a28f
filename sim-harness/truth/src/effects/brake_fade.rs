//! Share of the brake that is missing at 140 km/h, growing linearly from `from_kmh` on.

use super::*;

parameters!(BrakeFade { fade_at_140: f64, from_kmh: f64 });

impl Law for BrakeFade {
    fn brake_share(&self, speed_mps: f64) -> f64 {
        let beyond = (3.6 * speed_mps - self.from_kmh).max(0.0) / (140.0 - self.from_kmh);
        (1.0 - self.fade_at_140 * beyond).max(0.05)
    }
}
