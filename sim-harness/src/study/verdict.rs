//! What is said of a claim.

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    Reproduced,
    Not,
    /// Not reproduced either: the change is smaller than what a reader of the paper could see.
    NotVisible,
    /// These runs have no data on it.
    NoData,
    /// It has numbers of the paper's own line, train or drivers, and these runs are others.
    Elsewhere,
}

impl Verdict {
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Reproduced => "reproduced",
            Self::Not => "not reproduced",
            Self::NotVisible => "not visible",
            Self::NoData => "no data",
            Self::Elsewhere => "not judged",
        }
    }
}

impl From<bool> for Verdict {
    fn from(holds: bool) -> Self {
        if holds { Self::Reproduced } else { Self::Not }
    }
}
