//! Everything that can be set, with the defaults and their sources. A configuration file holds exactly these names.

use crate::coast_ahead::CoastConfig;
use crate::features::FeatureConfig;
use crate::tick::bounds::{ConfigError, between};
use crate::tick::learning::LearningConfig;
use crate::tick::memory::MemoryConfig;
use crate::tick::paper::PaperConfig;
use crate::tick::plausibility::PlausibilityConfig;
use crate::tick::regime::{PaperRule, RecogniserConfig};
use crate::tick::sensor::SensorConfig;
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
        self.features.check()
    }
}
