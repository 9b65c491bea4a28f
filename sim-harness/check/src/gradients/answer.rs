//! All that coasts and measured efforts say of the described gradients and resistance, and by how much an estimator
//! doubts the track for it.

use super::{Coasts, Doubt, OtherUnits, SeenBy};
use rundown::model::{track::Track, train::Train};
use rundown::tick::track_doubt::TrackDoubtConfig;
use rundown_files::track_file::MOST_SD_PERMILLE;
use std::fmt;

/// What coasts and efforts say of the descriptions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Answer {
    /// The described gradients look wrong.
    pub gradients: Option<Doubt>,
    /// The described resistance looks as if in other units.
    pub resistance: Option<OtherUnits>,
    /// The described gradients are off by little.
    pub small: Option<SmallErrors>,
}

/// Described gradients are off by little: what coasts of different runs have in common at their places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmallErrors {
    /// Standard deviation, permille.
    pub sd_permille: f64,
    /// What shows them.
    pub seen_by: SeenBy,
}

impl Coasts {
    /// All of it. `said_permille`: how far gradients may be off as track or configuration say, standard deviation;
    /// small errors are only looked for where neither says anything.
    pub fn answer(&self, train: &Train, track: &Track, said_permille: Option<f64>) -> Answer {
        let described = self.as_described(train, track);
        let (gradients, resistance) = self.doubts_of(&described, train, track, said_permille.unwrap_or(0.0));
        // A resistance in other units leaves at each place what it is off by at the speeds there.
        let may_be_small = said_permille.is_none() && gradients.is_none() && resistance.is_none();
        let small = may_be_small.then(|| self.small_errors(train, &described)).flatten();
        Answer { gradients, resistance, small }
    }
}

impl Answer {
    /// Until the gradients are put right they are taken to be off by as much.
    pub fn raise(&self, doubt: &mut TrackDoubtConfig) {
        if let Some(gradients) = &self.gradients {
            gradients.raise(doubt);
        }
        if let Some(small) = &self.small {
            doubt.gradient_sd_permille = small.sd_permille.min(MOST_SD_PERMILLE);
        }
    }
}

impl fmt::Display for SmallErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sd = self.sd_permille;
        let what = match self.seen_by {
            SeenBy::Efforts => "the accelerations beside the efforts",
            SeenBy::Coasts => "coasts",
        };
        write!(
            f,
            "gradients are taken to be off by {sd:.2} permille (standard deviation), on which {what} of different runs \
             agree at their places; gradient_sd_permille in the track's file says otherwise"
        )
    }
}
