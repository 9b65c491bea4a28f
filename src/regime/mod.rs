//! Driving regime, section 3.2.

mod recogniser;

pub use recogniser::{Evidence, Recognised, Recogniser, RecogniserConfig};

use crate::Real;
use serde::{Deserialize, Serialize};

/// What the driver does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Regime {
    /// The train stands.
    #[default]
    Standstill,
    /// Effort applied to gain speed.
    Traction,
    /// Effort applied to hold the speed.
    Cruise,
    /// No effort applied.
    Coast,
    /// Brake applied.
    Brake,
}

impl Regime {
    /// All regimes, in the order of their frames and of arrays indexed by `as usize`.
    pub const ALL: [Self; 5] = [
        Self::Standstill,
        Self::Traction,
        Self::Cruise,
        Self::Coast,
        Self::Brake,
    ];

    /// The word used in every output.
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

impl core::fmt::Display for Regime {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.pad(self.as_str())
    }
}

/// Thresholds of the paper's rule.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PaperRule {
    /// Half-width of the coasting band, N/kg; about 5 % of the largest effort (section 3.2).
    pub coast_n_per_kg: Real,
    /// Half-width of the cruising band, m/s²; 2 km/h in 10 s (section 3.2).
    pub cruise_mps2: Real,
}

impl Default for PaperRule {
    fn default() -> Self {
        Self {
            coast_n_per_kg: 0.025,
            cruise_mps2: 0.06,
        }
    }
}

impl PaperRule {
    /// Section 3.2: effort first, its band includes both edges; acceleration only outside it. It knows no standstill.
    ///
    /// ```
    /// use rundown::regime::{PaperRule, Regime};
    ///
    /// let rule = PaperRule::default();
    /// assert_eq!(rule.recognise(0.025, 0.5), Regime::Coast);
    /// assert_eq!(rule.recognise(0.05, 0.05), Regime::Cruise);
    /// assert_eq!(rule.recognise(-0.2, -0.2), Regime::Brake);
    /// ```
    pub fn recognise(&self, effort_n_per_kg: Real, acceleration_mps2: Real) -> Regime {
        if effort_n_per_kg.abs() <= self.coast_n_per_kg {
            Regime::Coast
        } else if acceleration_mps2.abs() < self.cruise_mps2 {
            Regime::Cruise
        } else if effort_n_per_kg > 0.0 {
            Regime::Traction
        } else {
            Regime::Brake
        }
    }
}
