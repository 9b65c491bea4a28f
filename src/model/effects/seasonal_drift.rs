//! Seasonal drift: r0 changes slowly over the dates of the runs (wear, seasons, an overhaul to come).
//!
//! ```text
//! extra = dr0_over_period x (day - reference_day) / period_days        the fraction within 0 to 1
//! ```
//!
//! The period begins on a day of the calendar of [`Moment::day`](super::Moment::day): its origin, and a year is its
//! length, where that is not stated. Outside the period it stays as at its end: a line is not drawn beyond what was
//! seen. Without a date nothing is added.

use super::{Law, SeasonalDrift, Situation};
use crate::Real;

impl SeasonalDrift {
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

impl Law for SeasonalDrift {
    fn extra_n_per_kg(&self, at: &Situation<'_>) -> Real {
        self.resistance_n_per_kg(at.moment.day)
    }
}
