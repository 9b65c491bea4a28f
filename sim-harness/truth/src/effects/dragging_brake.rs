//! Constant extra resistance after the first application of the brake.

use super::*;

parameters!(DraggingBrake { drag_n_per_kg: f64, runs: Affected });

impl Law for DraggingBrake {
    fn extra_n_per_kg(&self, setting: &Setting, at: &Moment) -> f64 {
        if at.braked { setting.described_over_true_mass * self.drag_n_per_kg } else { 0.0 }
    }

    fn affected(&self) -> Option<(&Affected, Together)> {
        Some((&self.runs, Together::Nothing))
    }
}
