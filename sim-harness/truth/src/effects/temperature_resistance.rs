//! r0 depends on the ambient temperature.

use super::*;

parameters!(TemperatureResistance {
    #[serde(rename = "dr0_per_degC")]
    dr0_per_deg_c: f64,
    ref_c: f64
});

impl Law for TemperatureResistance {
    fn extra_n_per_kg(&self, _setting: &Setting, at: &Moment) -> f64 {
        self.dr0_per_deg_c * (at.temperature_c - self.ref_c)
    }
}
