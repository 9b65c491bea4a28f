//! Tractive power is capped in a section of the line, in all runs unless said; the front of the train counts.

use super::{Affected, Capability, EffectError, Expect, Law, Together};
use crate::motion::Motion;
use serde::{Deserialize, Serialize};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PowerLimitSection {
    pub from_m: f64,
    pub to_m: f64,
    pub factor: f64,
    #[serde(default = "Affected::all")]
    pub runs: Affected,
}

impl Law for PowerLimitSection {
    fn check(&self, expect: &Expect) -> Result<(), EffectError> {
        expect.section(self.from_m, self.to_m)?;
        expect.positive("factor", self.factor)?;
        expect.runs(&self.runs)
    }

    fn cap(&self, left: &mut Capability, at: Motion) {
        if (self.from_m..=self.to_m).contains(&at.location_m) {
            left.power_cap = left.power_cap.min(self.factor);
        }
    }

    fn affected(&self) -> Option<(&Affected, Together)> {
        Some((&self.runs, Together::Nothing))
    }

    fn section_mut(&mut self) -> Option<[&mut f64; 2]> {
        Some([&mut self.from_m, &mut self.to_m])
    }
}
