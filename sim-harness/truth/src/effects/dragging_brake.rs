//! Constant extra resistance after the first application of the brake.

use super::{Affected, EffectError, Expect, Law, Moment, Setting, Together};
use serde::{Deserialize, Serialize};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DraggingBrake {
    pub drag_n_per_kg: f64,
    pub runs: Affected,
}

impl Law for DraggingBrake {
    fn check(&self, expect: &Expect) -> Result<(), EffectError> {
        expect.finite("drag_n_per_kg", self.drag_n_per_kg)?;
        expect.runs(&self.runs)
    }

    fn extra_n_per_kg(&self, setting: &Setting, at: &Moment) -> f64 {
        if at.braked { setting.described_over_true_mass * self.drag_n_per_kg } else { 0.0 }
    }

    fn affected(&self) -> Option<(&Affected, Together)> {
        Some((&self.runs, Together::Nothing))
    }
}
