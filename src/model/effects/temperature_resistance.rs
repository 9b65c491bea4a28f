//! Temperature: grease and oil are stiffer in the cold, so r0 depends on the ambient temperature.
//!
//! ```text
//! extra = dr0_per_degC (T - ref_c)
//! ```
//!
//! Without a temperature nothing is added. Air density (2 % of r2 in 6 °C) is left out.

use super::EffectError;
use super::error::within;
use crate::Real;
use serde::{Deserialize, Serialize};

/// r0 depends on the ambient temperature.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TemperatureResistance {
    /// Change of r0 with the temperature, N/(kg °C); negative: heavier in the cold.
    #[serde(rename = "dr0_per_degC")]
    pub dr0_per_deg_c: Real,
    /// Temperature at which r0 is as described, °C.
    pub ref_c: Real,
}

impl TemperatureResistance {
    /// Its name.
    pub const NAME: &'static str = "temperature_resistance";

    pub(super) fn check(&self) -> Result<(), EffectError> {
        within(Self::NAME, "dr0_per_degC", self.dr0_per_deg_c, -0.01, 0.01)?;
        within(Self::NAME, "ref_c", self.ref_c, -60.0, 80.0)
    }

    /// Extra resistance in N/kg at an ambient temperature.
    ///
    /// ```
    /// use rundown::model::effects::TemperatureResistance;
    ///
    /// let grease = TemperatureResistance { dr0_per_deg_c: -1e-4, ref_c: 15.0 };
    /// assert!((grease.resistance_n_per_kg(Some(-5.0)) - 2e-3).abs() < 1e-15);
    /// assert_eq!(grease.resistance_n_per_kg(None), 0.0);
    /// ```
    pub fn resistance_n_per_kg(&self, temperature_c: Option<Real>) -> Real {
        temperature_c.map_or(0.0, |temperature_c| self.dr0_per_deg_c * (temperature_c - self.ref_c))
    }
}
