//! Seasonal drift: r0 changes slowly over the dates of the runs (wear, seasons, an overhaul to come).
//!
//! ```text
//! extra = dr0_over_period x (day - reference_day) / period_days        the fraction within 0 to 1
//! ```
//!
//! Outside the period it stays as at its end: a line is not drawn beyond what was seen. Without a date nothing is added.

use super::EffectError;
use super::error::within;
use crate::Real;
use serde::{Deserialize, Serialize};

/// r0 drifts over the dates of the runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SeasonalDrift {
    /// Change of r0 from the beginning to the end of the period, N/kg.
    pub dr0_over_period: Real,
    /// Length of the period, days; a year if it is not stated.
    #[serde(default = "a_year")]
    pub period_days: Real,
    /// When the period begins, days on the calendar of [`Moment::day`](super::Moment::day); its origin if it is not stated.
    #[serde(default)]
    pub reference_day: Real,
}

impl SeasonalDrift {
    /// Its name.
    pub const NAME: &'static str = "seasonal_drift";

    pub(super) fn check(&self) -> Result<(), EffectError> {
        within(Self::NAME, "dr0_over_period", self.dr0_over_period, -0.1, 0.1)?;
        within(Self::NAME, "period_days", self.period_days, 0.01, 1e5)?;
        within(Self::NAME, "reference_day", self.reference_day, -1e6, 1e6)
    }

    /// Extra resistance in N/kg on a day.
    ///
    /// ```
    /// use rundown::model::effects::SeasonalDrift;
    ///
    /// let wear = SeasonalDrift { dr0_over_period: 2e-3, period_days: 100.0, reference_day: 20_000.0 };
    /// assert_eq!(wear.resistance_n_per_kg(Some(20_050.0)), 1e-3);
    /// assert_eq!(wear.resistance_n_per_kg(Some(21_000.0)), 2e-3);
    /// assert_eq!(wear.resistance_n_per_kg(None), 0.0);
    /// ```
    pub fn resistance_n_per_kg(&self, day: Option<Real>) -> Real {
        day.map_or(0.0, |day| self.dr0_over_period * ((day - self.reference_day) / self.period_days).clamp(0.0, 1.0))
    }
}

const fn a_year() -> Real {
    365.0
}
