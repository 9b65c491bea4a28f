//! One measurement as the recorder gives it.

use crate::Real;
use crate::plain::plain;
use serde::{Deserialize, Serialize};

/// One sample. A field that was not sent is `None`, never a zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Measurement {
    /// Time on any monotonic clock, s.
    pub time_s: Real,
    /// Location of the front along the track, m.
    pub location_m: Option<Real>,
    /// Speed reading, m/s, as rounded or truncated by the recorder.
    pub speed_mps: Option<Real>,
    /// Measured applied effort per rotating mass, N/kg, traction positive, brake negative.
    pub effort_n_per_kg: Option<Real>,
}

plain! {
    struct Measurement { time_s, location_m, speed_mps, effort_n_per_kg }
}
