//! What the readings are worth.

use crate::Real;
use crate::model::bounds::{Range, field_name};
use crate::plain::plain;
use crate::tick::bounds::{Check, settings};
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

plain! {
    enum Rounding { Rounded, Truncated }
}

settings! {
    /// What the readings are worth.
    SensorConfig in "sensor" {
        /// Step of the speed reading, km/h.
        speed_quantum_kmh: Real = 1.0, 0.0 to 20.0;
        /// How the reading falls into its step.
        rounding: Rounding = Rounding::Rounded;
        /// Standard deviation of the speed beyond its rounding, km/h.
        speed_noise_kmh: Real = 0.05, 0.0 to 20.0;
        /// Standard deviation of the location, m. Ten times the paper's 4 m: costs little, and a wrong speed scale or a
        /// late fix then reaches the resistance far less.
        location_sd_m: Real = 40.0, 0.01 to 1e4;
    }
}

impl SensorConfig {
    pub(crate) fn check(&self, check: &mut Check) {
        const SUM: &[Range] = &[Range::new(field_name("sensor.speed_quantum_kmh + speed_noise_kmh"), 1e-3, 40.0)];
        self.check_ranges(check);
        check.begin(SUM);
        check.next(&[self.speed_quantum_kmh + self.speed_noise_kmh]);
    }

    /// Middle of the interval that a reading stands for, m/s. Zero stays zero: a standing train is not rounded.
    pub fn centre_mps(&self, reading_mps: Real) -> Real {
        match self.rounding {
            Rounding::Truncated if reading_mps > 0.0 => reading_mps + 0.5 * self.speed_quantum_kmh / 3.6,
            Rounding::Truncated | Rounding::Rounded => reading_mps,
        }
    }

    /// Standard deviation of a speed reading, m/s: that of the interval (quantum / √12) and the noise.
    pub fn speed_sd_mps(&self) -> Real {
        let quantum_mps = self.speed_quantum_kmh / 3.6;
        let noise_mps = self.speed_noise_kmh / 3.6;
        crate::roots::square_root(quantum_mps * quantum_mps / 12.0 + noise_mps * noise_mps)
    }
}
