//! Everything that can be set, with the defaults and their sources. A configuration file holds exactly these names.

use crate::coast_ahead::CoastConfig;
use crate::features::FeatureConfig;
use crate::plain::{Bytes, Plain as _, plain};
use crate::tick::bounds::{Check, ConfigError, settings};
use crate::tick::effort_reading::EffortReadingConfig;
use crate::tick::learning::LearningConfig;
use crate::tick::memory::MemoryConfig;
use crate::tick::paper::{PaperConfig, PaperDriftConfig};
use crate::tick::plausibility::PlausibilityConfig;
use crate::tick::regime::{PaperRule, RecogniserConfig};
use crate::tick::sensor::SensorConfig;
use crate::tick::short_hops::ShortHopConfig;
use crate::tick::track_doubt::TrackDoubtConfig;
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

plain! {
    enum Mode { Paper, Gated, Measured }
}

/// The whole configuration; `Config::default()` is the `gated` mode.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
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
    /// What may come without a MAC.
    pub security: SecurityConfig,
    /// What is expected of an effort column, in the `measured` mode.
    pub effort_reading: EffortReadingConfig,
    /// Learning on short hops, in the `gated` mode.
    pub short_hops: ShortHopConfig,
    /// How far the described gradients may be off.
    pub track_doubt: TrackDoubtConfig,
    /// What the `paper` mode lets change during a run.
    pub paper_drift: PaperDriftConfig,
}

settings! {
    /// What may come without a MAC.
    SecurityConfig in "security" {
        /// Measurements are taken secured only: one that comes open is refused, `not_secured`. Else whoever reaches the
        /// line can send them.
        secured_measurements: bool = false;
    }
}

impl Default for Config {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Config {
    /// The default values. Constants, for the board copies them out of its flash: to compute each of them where it is
    /// written takes twice as much.
    pub const DEFAULT: Self = Self {
        mode: Mode::Gated,
        sensor: SensorConfig::DEFAULT,
        paper: PaperConfig::DEFAULT,
        learning: LearningConfig::DEFAULT,
        memory: MemoryConfig::DEFAULT,
        paper_rule: PaperRule::DEFAULT,
        recogniser: RecogniserConfig::DEFAULT,
        features: FeatureConfig::DEFAULT,
        plausibility: PlausibilityConfig::DEFAULT,
        coast: CoastConfig::DEFAULT,
        security: SecurityConfig::DEFAULT,
        effort_reading: EffortReadingConfig::DEFAULT,
        short_hops: ShortHopConfig::DEFAULT,
        track_doubt: TrackDoubtConfig::DEFAULT,
        paper_drift: PaperDriftConfig::DEFAULT,
    };

    /// All of it, for a digest: that of a configuration which leaves the later sections as they are by default is what
    /// it always was.
    pub(crate) fn pass(&mut self, bytes: &mut Bytes<'_>) {
        self.mode.pass(bytes);
        self.sensor.pass(bytes);
        self.paper.pass(bytes);
        self.learning.pass(bytes);
        self.memory.pass(bytes);
        self.paper_rule.pass(bytes);
        self.recogniser.pass(bytes);
        self.features.pass(bytes);
        self.plausibility.pass(bytes);
        self.coast.pass(bytes);
        if self.security != SecurityConfig::default() {
            self.security.pass(bytes);
        }
        if self.effort_reading != EffortReadingConfig::default() {
            self.effort_reading.pass(bytes);
        }
        if self.short_hops != ShortHopConfig::default() {
            self.short_hops.pass(bytes);
        }
        if self.track_doubt != TrackDoubtConfig::default() {
            self.track_doubt.pass(bytes);
        }
        if self.paper_drift != PaperDriftConfig::default() {
            self.paper_drift.pass(bytes);
        }
    }

    /// The default values in this mode.
    pub fn with_mode(mode: Mode) -> Self {
        Self { mode, ..Self::default() }
    }

    /// Checks every value that could do harm.
    ///
    /// # Errors
    /// [`ConfigError`] names the first field that is out of range.
    pub fn check(&self) -> Result<(), ConfigError> {
        let mut check = Check::default();
        self.sensor.check(&mut check);
        self.paper.check_ranges(&mut check);
        self.paper_rule.check_ranges(&mut check);
        self.learning.check_ranges(&mut check);
        self.memory.check_ranges(&mut check);
        self.recogniser.check_ranges(&mut check);
        self.plausibility.check_ranges(&mut check);
        self.coast.check_ranges(&mut check);
        self.security.check_ranges(&mut check);
        self.effort_reading.check_ranges(&mut check);
        self.short_hops.check_ranges(&mut check);
        self.track_doubt.check_ranges(&mut check);
        self.paper_drift.check_ranges(&mut check);
        check.result()?;
        self.features.check()
    }
}
