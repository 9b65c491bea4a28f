//! Readings of the described gradients.

use serde::{Serialize, Serializer};
use std::fmt;

/// A reading of the described gradients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Version {
    /// As described.
    Described,
    /// Uphill taken for downhill.
    SignTurned,
    /// Per cent taken for permille: ten times as steep.
    PerCent,
    /// Ten times less steep.
    TenthOfIt,
    /// Twice as steep.
    TwiceOfIt,
    /// Half as steep.
    HalfOfIt,
    /// So many times as steep, as measured efforts have it.
    Times(f64),
    /// A level line: the described gradients belong to another one.
    Level,
    /// As coasts at each place have them, run after run: in a shape that is not known.
    ByPlace,
    /// Described from the other end.
    OtherEnd,
    /// The chainage of the runs plus so many metres is that of the gradients.
    Shifted(f64),
}

impl Version {
    /// In one word, for programs.
    pub fn word(self) -> &'static str {
        match self {
            Self::Described => "described",
            Self::SignTurned => "sign_turned",
            Self::PerCent => "per_cent",
            Self::TenthOfIt => "tenth_of_it",
            Self::TwiceOfIt => "twice_of_it",
            Self::HalfOfIt => "half_of_it",
            Self::Times(_) => "times",
            Self::Level => "level",
            Self::ByPlace => "by_place",
            Self::OtherEnd => "other_end",
            Self::Shifted(_) => "shifted",
        }
    }

    /// Less steep than described, or level.
    pub fn is_gentler(self) -> bool {
        matches!(self, Self::TenthOfIt | Self::HalfOfIt | Self::Level)
    }

    /// By how much, where it is shifted, m.
    pub fn shift_m(self) -> Option<f64> {
        match self {
            Self::Shifted(by_m) => Some(by_m),
            _ => None,
        }
    }

    /// How many times as steep, where that was estimated.
    pub fn times(self) -> Option<f64> {
        match self {
            Self::Times(times) => Some(times),
            _ => None,
        }
    }
}

impl Serialize for Version {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.word())
    }
}

impl fmt::Display for Version {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Described => write!(f, "as described"),
            Self::SignTurned => write!(f, "with the sign turned (downhill where uphill is described)"),
            Self::PerCent => write!(f, "ten times as steep (per cent written as permille)"),
            Self::TenthOfIt => write!(f, "a tenth as steep (permille multiplied by ten)"),
            Self::TwiceOfIt => write!(f, "twice as steep"),
            Self::HalfOfIt => write!(f, "half as steep"),
            Self::Times(times) => write!(f, "{times:.2} times as steep"),
            Self::Level => write!(f, "without any (they are those of another line)"),
            Self::ByPlace => write!(f, "as coasts at each place have them, run after run,"),
            Self::OtherEnd => write!(f, "described from the other end of the line"),
            Self::Shifted(by_m) => write!(f, "moved by {:+.1} km along the line", -by_m / 1000.0),
        }
    }
}
