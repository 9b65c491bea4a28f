//! Brake fade: the friction of hot blocks and pads falls with speed.
//!
//! ```text
//! maximum brake = described x (1 - fade_at_140 (v - from) / (140 km/h - from))        above from_kmh; not below 0
//! ```
//!
//! Linear from `from_kmh` on and beyond 140 km/h. How long the brake has been on is left out.

use super::{BrakeFade, Law, Limits};
use crate::Real;
use crate::extremes::Extremes;

impl BrakeFade {
    /// Brake effort at a speed over the one at low speed, 0 to 1.
    ///
    /// ```
    /// use rundown::model::effects::BrakeFade;
    ///
    /// let fade = BrakeFade { fade_at_140: 0.3, from_kmh: 80.0 };
    /// assert_eq!(fade.factor(80.0 / 3.6), 1.0);
    /// assert!((fade.factor(110.0 / 3.6) - 0.85).abs() < 1e-12);
    /// assert!((fade.factor(140.0 / 3.6) - 0.7).abs() < 1e-12);
    /// ```
    pub fn factor(&self, speed_mps: Real) -> Real {
        let way = (3.6 * speed_mps - self.from_kmh) / (140.0 - self.from_kmh);
        (1.0 - self.fade_at_140 * way.at_least(0.0)).at_least(0.0)
    }

    /// The limits at a speed.
    pub fn limit(&self, limits: &Limits, speed_mps: Real) -> Limits {
        Limits { brake_n_per_kg: limits.brake_n_per_kg * self.factor(speed_mps), ..*limits }
    }
}

impl Law for BrakeFade {
    fn limits_left(&self, limits: &Limits, _location_m: Real, speed_mps: Real) -> Limits {
        self.limit(limits, speed_mps)
    }
}
