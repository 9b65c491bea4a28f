//! Stiff bearings in the first minutes, N/kg.
//!
//! ```text
//! extra = amplitude exp(-t / tau)          t since the departure
//! ```

use super::*;

parameters!(WarmUp { amplitude: f64, tau_s: f64 });

impl Law for WarmUp {
    fn extra_n_per_kg(&self, _setting: &Setting, at: &Moment) -> f64 {
        self.amplitude * (-at.since_departure_s / self.tau_s).exp()
    }
}
