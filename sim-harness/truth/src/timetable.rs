//! Direction and dates of runs.

use serde::Deserialize;

/// Direction of a run on the line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Heading {
    /// Locations grow.
    #[default]
    Up,
    /// Locations fall.
    Down,
}

impl Heading {
    /// The word in files.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Up => "up",
            Self::Down => "down",
        }
    }
}

/// Directions of the runs of a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Headings {
    /// All up.
    #[default]
    Up,
    /// All down.
    Down,
    /// In turns, up first.
    Both,
}

/// When the runs are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dates {
    /// First day, 0 h UTC, in seconds after 1970-01-01.
    pub start_s: i64,
    /// The runs are spread over this many days.
    pub days: f64,
}

impl Default for Dates {
    /// Two months from 2024-01-08.
    fn default() -> Self {
        Self { start_s: 1_704_672_000, days: 60.0 }
    }
}
