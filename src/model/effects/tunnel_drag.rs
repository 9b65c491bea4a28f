//! Tunnel: the air that the train pushes before it can escape only along the train, so the aerodynamic term is larger
//! inside.
//!
//! ```text
//! extra = k v² x share of the train inside                 k in N/(kg (m/s)²)
//! ```
//!
//! The share grows over one train length at either portal. Pressure waves of short tunnels are left out.

use super::{Law, Situation, TunnelDrag};
use crate::Real;

impl TunnelDrag {
    /// Extra resistance in N/kg at a speed, with this share (0 to 1) of the train inside.
    ///
    /// ```
    /// use rundown::model::effects::TunnelDrag;
    ///
    /// let tunnel = TunnelDrag { from_m: 1000.0, to_m: 3000.0, k: 1e-5 };
    /// assert!((tunnel.resistance_n_per_kg(30.0, 0.5) - 4.5e-3).abs() < 1e-15);
    /// ```
    pub fn resistance_n_per_kg(&self, speed_mps: Real, share_inside: Real) -> Real {
        self.k * speed_mps * speed_mps * share_inside
    }
}

impl Law for TunnelDrag {
    fn extra_n_per_kg(&self, at: &Situation<'_>) -> Real {
        self.resistance_n_per_kg(at.moment.speed_mps, at.share_inside(self.from_m, self.to_m))
    }
}
