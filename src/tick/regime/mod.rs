//! Driving regime, section 3.2.

mod recogniser;

pub use recogniser::{Evidence, Recognised, Recogniser, RecogniserConfig};
pub use rundown_wire::Regime;

use crate::Real;
use crate::tick::bounds::settings;

settings! {
    /// Thresholds of the paper's rule.
    PaperRule in "paper_rule" {
        /// Half-width of the coasting band, N/kg; about 5 % of the largest effort (section 3.2).
        coast_n_per_kg: Real = 0.025, 0.0 to 10.0;
        /// Half-width of the cruising band, m/s²; 2 km/h in 10 s (section 3.2).
        cruise_mps2: Real = 0.06, 0.0 to 10.0;
    }
}

impl PaperRule {
    /// Section 3.2: effort first, its band includes both edges; acceleration only outside it. It knows no standstill.
    ///
    /// ```
    /// use rundown::tick::regime::{PaperRule, Regime};
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
