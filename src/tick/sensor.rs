//! What the readings are worth.

use crate::Real;
use serde::{Deserialize, Serialize};

/// How the recorder turns a speed into a reading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Rounding {
    /// To the nearest whole quantum.
    #[default]
    Rounded,
    /// Down to the whole quantum below.
    Truncated,
}

/// What the readings are worth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SensorConfig {
    /// Step of the speed reading, km/h.
    pub speed_quantum_kmh: Real,
    /// How the reading falls into its step.
    pub rounding: Rounding,
    /// Standard deviation of the speed beyond its rounding, km/h.
    pub speed_noise_kmh: Real,
    /// Standard deviation of the location, m.
    pub location_sd_m: Real,
}

impl Default for SensorConfig {
    /// Location with ten times the paper's 4 m: costs little, and a wrong speed scale or a late fix then reaches the resistance far less.
    fn default() -> Self {
        Self { speed_quantum_kmh: 1.0, rounding: Rounding::Rounded, speed_noise_kmh: 0.05, location_sd_m: 40.0 }
    }
}

impl SensorConfig {
    /// Middle of the interval that a reading stands for, m/s. Zero stays zero: a standing train is not rounded.
    pub fn centre_mps(&self, reading_mps: Real) -> Real {
        match self.rounding {
            Rounding::Truncated if reading_mps > 0.0 => reading_mps + 0.5 * self.speed_quantum_kmh / 3.6,
            _ => reading_mps,
        }
    }

    /// Standard deviation of a speed reading, m/s: that of the interval (quantum / √12) and the noise.
    pub fn speed_sd_mps(&self) -> Real {
        let quantum_mps = self.speed_quantum_kmh / 3.6;
        let noise_mps = self.speed_noise_kmh / 3.6;
        libm::sqrt(quantum_mps * quantum_mps / 12.0 + noise_mps * noise_mps)
    }
}
