//! Temperature: grease and oil are stiffer in the cold, so r0 depends on the ambient temperature.
//!
//! ```text
//! extra = dr0_per_degC (T - ref_c)
//! ```
//!
//! Without a temperature nothing is added. Air density (2 % of r2 in 6 °C) is left out.

use super::{Law, Situation, TemperatureResistance};
use crate::Real;

impl TemperatureResistance {
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

impl Law for TemperatureResistance {
    fn extra_n_per_kg(&self, at: &Situation<'_>) -> Real {
        self.resistance_n_per_kg(at.moment.temperature_c)
    }
}
