//! The figures of section 4: each a picture, and the very numbers it draws as a table.
//!
//! | module | figure |
//! |---|---|
//! | [`profiles`] | 2: all speed profiles over location |
//! | [`run`] | 3: six panels of one run, 5: stacked resistance, 6: regimes |
//! | [`histograms`] | 4: r0, r1, r2; 7: cruise speed, final coast, final brake |
//! | [`brake`] | 8: brake rate over speed by ATB-EG step |
//! | [`power`] | 9: tractive power over speed |
//! | [`slope`] | none of the paper: estimated over true deviation |

pub(crate) mod brake;
pub(crate) mod histograms;
pub(crate) mod power;
pub(crate) mod profiles;
pub(crate) mod run;
pub(crate) mod slope;

use super::{gather::Drawn, view::Seen};
use rundown_files::column::Filled;
use rundown_pages::chart::Drawing;

#[derive(Clone, Debug)]
pub struct Picture {
    pub name: String,
    pub caption: String,
    pub drawing: Drawing,
    /// What it draws, as its CSV has it.
    pub numbers: Filled,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Eyes {
    Paper,
    Gated,
}

impl Eyes {
    pub const BOTH: [Self; 2] = [Self::Paper, Self::Gated];

    pub const fn word(self) -> &'static str {
        self.pick("paper", "gated")
    }

    /// What these eyes see, of what each sees.
    pub const fn pick<T: Copy>(self, paper: T, gated: T) -> T {
        match self {
            Self::Paper => paper,
            Self::Gated => gated,
        }
    }

    pub fn of(self, run: &Drawn) -> &Seen {
        self.pick(&run.paper, &run.gated)
    }
}

/// Why a true number is missing.
pub(super) const NO_TRUTH: &str = "the truth is not known";
