//! A point of a run: when, where, how fast.

use crate::Real;
use crate::plain::plain;
use serde::{Deserialize, Serialize};

/// A point of the run: when, where, how fast.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Time, s.
    pub time_s: Real,
    /// Location, m.
    pub location_m: Real,
    /// Speed, m/s.
    pub speed_mps: Real,
}

plain! {
    struct Point { time_s, location_m, speed_mps }
}
