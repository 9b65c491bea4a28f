//! What the driver does.

use serde::{Deserialize, Serialize};

/// True label of a step. Its words are those of the estimator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Regime {
    /// Speed 0.
    #[default]
    Standstill,
    /// Power to gain speed.
    Traction,
    /// Speed held, by power or on a downgrade by the brake.
    Cruise,
    /// Effort exactly 0.
    Coast,
    /// Brake to lose speed.
    Brake,
}

impl Regime {
    /// The word in files.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Standstill => "standstill",
            Self::Traction => "traction",
            Self::Cruise => "cruise",
            Self::Coast => "coast",
            Self::Brake => "brake",
        }
    }
}
