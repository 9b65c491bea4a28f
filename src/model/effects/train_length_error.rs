//! Train length error: the gradient was averaged over the wrong length (coaches added or taken off).
//!
//! ```text
//! extra = g / γ (mean gradient under the true length - mean gradient under the believed length)
//! ```
//!
//! Shows at the edges of gradients only. The location is that of the front. Other effects keep the believed length:
//! their sections are blurred by a train length anyway.

use super::{Law, Situation, TrainLengthError};
use crate::Real;

impl TrainLengthError {
    /// Extra resistance in N/kg; gradients in m/m, uphill in the direction of travel positive, `gravity_n_per_kg` is g
    /// / γ.
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

impl Law for TrainLengthError {
    fn extra_n_per_kg(&self, at: &Situation<'_>) -> Real {
        let mean = |length_m| at.line.track.mean_gradient(at.moment.location_m, length_m, at.line.direction);
        let believed = mean(at.line.train.length_m());
        self.resistance_n_per_kg(at.gravity_n_per_kg(), mean(self.true_length_m), believed)
    }
}
