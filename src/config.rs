//! Everything that can be set, with the defaults and their sources. A configuration file holds exactly these names.

use crate::Real;
use crate::coast_ahead::CoastConfig;
use crate::features::FeatureConfig;
use crate::learning::LearningConfig;
use crate::memory::MemoryConfig;
use crate::motion::Evaluate;
use crate::plausibility::PlausibilityConfig;
use crate::regime::{PaperRule, RecogniserConfig};
use crate::ukf::Spread;
use core::fmt;
use serde::{Deserialize, Serialize};

/// Where the applied effort comes from, and what may be learned from it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// The paper: effort calculated from the change of speed; it drives the next step.
    Paper,
    /// Effort known to be zero while coasting is established; learning only then.
    #[default]
    Gated,
    /// Effort measured, with a slowly learned gain.
    Measured,
}

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

/// Over which difference of speeds the calculated effort acts (the `paper` mode).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Difference {
    /// The difference up to a sample drives the step after it: the reading that gives the paper's figures.
    #[default]
    Backward,
    /// The difference over a step drives that very step.
    Forward,
}

/// Table 1 and what section 4.2 says about noise: the filter of the `paper` mode.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PaperConfig {
    /// Sigma-point spread α, β, κ.
    pub spread: Spread,
    /// Initial standard deviation of the location, m.
    pub initial_location_sd_m: Real,
    /// Initial standard deviation of the speed, km/h.
    pub initial_speed_sd_kmh: Real,
    /// Initial standard deviations of r0, r1, r2, SI units.
    pub initial_davis_sd: [Real; 3],
    /// Measurement noise of the location, m.
    pub location_sd_m: Real,
    /// Measurement noise of the speed, km/h.
    pub speed_sd_kmh: Real,
    /// Standard deviation of the acceleration noise, m/s² (Q); zero in the paper.
    pub acceleration_noise_mps2: Real,
    /// Form the gain from the propagated points, which leave Q out, as Eq. (12)-(15) are printed.
    pub reuse_points: bool,
    /// Difference of the calculated effort.
    pub difference: Difference,
    /// Where in a step Eq. (5) is evaluated.
    pub evaluate: Evaluate,
    /// Longest sub-step, s; longer than the sampling time means the single step of Eq. (4).
    pub sub_step_s: Real,
}

impl Default for PaperConfig {
    fn default() -> Self {
        Self {
            spread: Spread::PAPER,
            initial_location_sd_m: 1.0,
            initial_speed_sd_kmh: 0.0018,
            initial_davis_sd: [1e-6, 1e-8, 1e-9],
            location_sd_m: 4.0,
            speed_sd_kmh: 1.0,
            acceleration_noise_mps2: 0.0,
            reuse_points: true,
            difference: Difference::Backward,
            evaluate: Evaluate::Beginning,
            sub_step_s: 1e9,
        }
    }
}

/// The whole configuration; `Config::default()` is the `gated` mode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    /// Source of the effort.
    pub mode: Mode,
    /// What the readings are worth, outside the `paper` mode.
    pub sensor: SensorConfig,
    /// Filter of the `paper` mode.
    pub paper: PaperConfig,
    /// Learning of the `gated` and `measured` modes.
    pub learning: LearningConfig,
    /// What is carried from run to run.
    pub memory: MemoryConfig,
    /// The paper's regime rule, in force in the `paper` mode.
    pub paper_rule: PaperRule,
    /// The recogniser of the other modes.
    pub recogniser: RecogniserConfig,
    /// Windows and thresholds of the features.
    pub features: FeatureConfig,
    /// When a reading is not believed.
    pub plausibility: PlausibilityConfig,
    /// Coast-ahead prediction.
    pub coast: CoastConfig,
}

impl Config {
    /// The default values in this mode.
    pub fn with_mode(mode: Mode) -> Self {
        Self { mode, ..Self::default() }
    }

    /// Checks every value that could do harm.
    ///
    /// # Errors
    /// [`ConfigError`] names the first field that is out of range.
    pub fn check(&self) -> Result<(), ConfigError> {
        let sensor = &self.sensor;
        let paper = &self.paper;
        between("sensor.speed_quantum_kmh", sensor.speed_quantum_kmh, 0.0, 20.0)?;
        between("sensor.speed_noise_kmh", sensor.speed_noise_kmh, 0.0, 20.0)?;
        between(
            "sensor speed_quantum_kmh + speed_noise_kmh",
            sensor.speed_quantum_kmh + sensor.speed_noise_kmh,
            1e-3,
            40.0,
        )?;
        between("sensor.location_sd_m", sensor.location_sd_m, 0.01, 1e4)?;
        between("paper.initial_location_sd_m", paper.initial_location_sd_m, 1e-6, 1e5)?;
        between("paper.initial_speed_sd_kmh", paper.initial_speed_sd_kmh, 1e-6, 1e3)?;
        for sd in paper.initial_davis_sd {
            between("paper.initial_davis_sd", sd, 1e-15, 1.0)?;
        }
        between("paper.location_sd_m", paper.location_sd_m, 1e-3, 1e5)?;
        between("paper.speed_sd_kmh", paper.speed_sd_kmh, 1e-3, 1e3)?;
        between("paper.acceleration_noise_mps2", paper.acceleration_noise_mps2, 0.0, 10.0)?;
        between("paper.sub_step_s", paper.sub_step_s, 0.1, 1e12)?;
        between("paper_rule.coast_n_per_kg", self.paper_rule.coast_n_per_kg, 0.0, 10.0)?;
        between("paper_rule.cruise_mps2", self.paper_rule.cruise_mps2, 0.0, 10.0)?;
        self.learning.check()?;
        self.memory.check()?;
        self.recogniser.check()?;
        self.plausibility.check()?;
        self.coast.check()?;
        self.features.check().map_err(ConfigError::Features)
    }
}

/// Why a configuration was refused. The old one stays in force.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ConfigError {
    /// `field` was `found`, outside `least..=most`.
    OutOfRange {
        /// Name of the field as in the configuration file.
        field: &'static str,
        /// Smallest accepted value.
        least: Real,
        /// Largest accepted value.
        most: Real,
        /// What stood there.
        found: Real,
    },
    /// A window of the features.
    Features(crate::features::FeatureConfigError),
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfRange { field, least, most, found } => {
                write!(f, "configuration: {field} must be {least} to {most}, found {found}")
            }
            Self::Features(error) => write!(f, "configuration: {error}"),
        }
    }
}

impl core::error::Error for ConfigError {}

/// `found` lies within `least..=most`; NaN does not.
pub(crate) fn between(field: &'static str, found: Real, least: Real, most: Real) -> Result<(), ConfigError> {
    if (least..=most).contains(&found) { Ok(()) } else { Err(ConfigError::OutOfRange { field, least, most, found }) }
}
