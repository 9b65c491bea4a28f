//! Tunnel: the air that the train pushes before it can escape only along the train, so the aerodynamic term is larger inside.
//!
//! ```text
//! extra = k v² x share of the train inside                 k in N/(kg (m/s)²)
//! ```
//!
//! The share grows over one train length at either portal. Pressure waves of short tunnels are left out.

use super::EffectError;
use super::error::within;
use super::section;
use crate::Real;
use serde::{Deserialize, Serialize};

/// More air resistance in a tunnel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TunnelDrag {
    /// Where it begins, m.
    pub from_m: Real,
    /// Where it ends, m.
    pub to_m: Real,
    /// What the tunnel adds to r2, N/(kg (m/s)²).
    pub k: Real,
}

impl TunnelDrag {
    /// Its name.
    pub const NAME: &'static str = "tunnel_drag";

    pub(super) fn check(&self) -> Result<(), EffectError> {
        section::check(Self::NAME, self.from_m, self.to_m)?;
        within(Self::NAME, "k", self.k, -1e-3, 1e-3)
    }

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
