//! Tractive power is capped in a section of the line, in all runs unless said; the front of the train counts.

use super::*;

parameters!(PowerLimitSection {
    from_m: f64,
    to_m: f64,
    factor: f64,
    #[serde(default = "Affected::all")]
    runs: Affected
});

impl Law for PowerLimitSection {
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
