//! Train length error: the gradient was averaged over the wrong length (coaches added or taken off).
//!
//! ```text
//! extra = g / γ (mean gradient under the true length - mean gradient under the believed length)
//! ```
//!
//! Shows at the edges of gradients only. The location is that of the front. Other effects keep the believed length: their sections are blurred by a train length anyway.

use super::EffectError;
use super::error::within;
use crate::Real;
use serde::{Deserialize, Serialize};

/// The described length is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainLengthError {
    /// True length, m.
    pub true_length_m: Real,
}

impl TrainLengthError {
    /// Its name.
    pub const NAME: &'static str = "train_length_error";

    pub(super) fn check(&self) -> Result<(), EffectError> {
        within(Self::NAME, "true_length_m", self.true_length_m, 1.0, 5000.0)
    }

    /// Extra resistance in N/kg; gradients in m/m, uphill in the direction of travel positive, `gravity_n_per_kg` is g / γ.
    ///
    /// ```
    /// use rundown::model::effects::TrainLengthError;
    ///
    /// let coupled = TrainLengthError { true_length_m: 324.0 };
    /// assert!((coupled.resistance_n_per_kg(10.0, 0.001, 0.003) + 0.02).abs() < 1e-15);
    /// ```
    pub fn resistance_n_per_kg(
        &self,
        gravity_n_per_kg: Real,
        gradient_under_true_length: Real,
        gradient_under_believed_length: Real,
    ) -> Real {
        gravity_n_per_kg * (gradient_under_true_length - gradient_under_believed_length)
    }
}
