//! Direction of travel along the track.

use crate::Real;
use crate::plain::plain;
use serde::{Deserialize, Serialize};

/// Direction of travel along the track's locations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Direction {
    /// Locations grow.
    #[default]
    Up,
    /// Locations fall.
    Down,
}

plain! {
    enum Direction { Up, Down }
}

impl Direction {
    /// +1 for up, -1 for down.
    pub const fn sign(self) -> Real {
        match self {
            Self::Up => 1.0,
            Self::Down => -1.0,
        }
    }

    /// The word used in every file.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Up => "up",
            Self::Down => "down",
        }
    }
}
