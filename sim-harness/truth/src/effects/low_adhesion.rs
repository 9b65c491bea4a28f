//! Tractive effort is capped at low speed, on some days.

use super::*;

parameters!(LowAdhesion { factor: f64, below_kmh: f64, runs: Affected });

impl Law for LowAdhesion {
    fn cap(&self, left: &mut Capability, at: Motion) {
        if 3.6 * at.speed_mps < self.below_kmh {
            left.effort_cap = left.effort_cap.min(self.factor);
        }
    }

    fn affected(&self) -> Option<(&Affected, Together)> {
        Some((&self.runs, Together::Day))
    }
}
