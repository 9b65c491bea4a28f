//! r0 depends on the ambient temperature.

use super::{EffectError, Expect, Law, Moment, Setting};
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TemperatureResistance {
    #[serde(rename = "dr0_per_degC")]
    pub dr0_per_deg_c: f64,
    pub ref_c: f64,
}

impl Law for TemperatureResistance {
    fn check(&self, expect: &Expect) -> Result<(), EffectError> {
        expect.finite("dr0_per_degC", self.dr0_per_deg_c)?;
        expect.finite("ref_c", self.ref_c)
    }

    fn extra_n_per_kg(&self, _setting: &Setting, at: &Moment) -> f64 {
        self.dr0_per_deg_c * (at.temperature_c - self.ref_c)
    }
}
