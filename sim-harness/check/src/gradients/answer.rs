//! All that coasts and measured efforts say of the described gradients and resistance, and by how much an estimator
//! doubts the track for it.

use super::{Coasts, Doubt, OtherUnits, SeenBy};
use crate::agreement::Figure;
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

/// Errors that follow the slopes do not average out over the line, as the estimator takes errors to do, and the gain of
/// the efforts follows them, too: they count as so many times as large. Measured: beside efforts r is within its
/// interval in 51 of 54 fresh sets, and with 1 in fewer; by coasts in all that were found (docs/check.md).
pub(super) const FOLLOWS_SLOPES: f64 = 2.0;

/// Described gradients are off by little: what coasts of different runs have in common at their places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmallErrors {
    /// Standard deviation, permille.
    pub sd_permille: f64,
    /// What shows them.
    pub seen_by: SeenBy,
    /// All slopes act so many times as described, where that is the error.
    pub steepness: Option<Figure>,
}

impl SmallErrors {
    /// Of slopes that act so many times as described: errors that are independent from place to place and leave as much
    /// in r. `climbs_n_per_kg`: force of the described climbs, root mean square.
    pub(super) fn of_steepness(steep: Figure, climbs_n_per_kg: f64, seen_by: SeenBy, train: &Train) -> Self {
        let off_n_per_kg = (steep.value - 1.0).abs() * climbs_n_per_kg;
        let sd_permille = FOLLOWS_SLOPES * 1e3 * off_n_per_kg / train.gravity_n_per_kg();
        Self { sd_permille, seen_by, steepness: Some(steep) }
    }

    /// The larger one of two.
    pub(super) fn larger(one: Option<Self>, other: Option<Self>) -> Option<Self> {
        one.into_iter().chain(other).max_by(|a, b| a.sd_permille.total_cmp(&b.sd_permille))
    }
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
        if let Some(steep) = self.steepness {
            let act = steep.with_interval(3);
            return write!(
                f,
                "by {what} all slopes act {act} times as described, as beside a rotating mass or a wheel that is off: gradients \
                 are taken to be off by {sd:.2} permille (standard deviation); gradient_sd_permille in the track's file \
                 says otherwise"
            );
        }
        write!(
            f,
            "gradients are taken to be off by {sd:.2} permille (standard deviation), on which {what} of different runs \
             agree at their places; gradient_sd_permille in the track's file says otherwise"
        )
    }
}
