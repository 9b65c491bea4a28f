//! All that coasts and measured efforts say of the described gradients and resistance, and by how much an estimator
//! doubts the track for it.

use super::length::OtherLength;
use super::locations::OffFromRunToRun;
use super::{Coasts, Doubt, LEAST_RUNS_SMALL, OtherUnits, SeenBy};
use crate::figure::Figure;
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
    /// A resistance acts at places.
    pub resists: Option<ResistsAtPlaces>,
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
    /// What they follow; none where each place has its own.
    pub follows: Option<Follows>,
}

/// A resistance that nobody described acts at places, alike in both directions, as in curves and tunnels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResistsAtPlaces {
    /// Standard deviation over the line, N/kg.
    pub sd_n_per_kg: f64,
    /// What shows it.
    pub seen_by: SeenBy,
}

impl fmt::Display for ResistsAtPlaces {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { sd_n_per_kg, seen_by } = self;
        write!(
            f,
            "by {} a resistance acts at places, alike in both directions, as of curves or tunnels that are not \
             described: {sd_n_per_kg:.4} N/kg (standard deviation over the line). What is learned is r of this line, and its \
             interval is wide enough for straight track",
            seen_by.words()
        )
    }
}

/// What errors of gradients follow along the line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Follows {
    /// All slopes act so many times as described.
    Steepness(Figure),
    /// They act as on a train so many times as long as described.
    Length(Figure),
    /// They come early or late from run to run, by so many metres, standard deviation.
    Locations(Figure),
}

impl SmallErrors {
    /// Of slopes that act so many times as described: errors that are independent from place to place and leave as much
    /// in r. `climbs_n_per_kg`: force of the described climbs, root mean square.
    pub(super) fn of_steepness(steep: Figure, climbs_n_per_kg: f64, seen_by: SeenBy, train: &Train) -> Self {
        let off_n_per_kg = (steep.value - 1.0).abs() * climbs_n_per_kg;
        Self::following(Follows::Steepness(steep), off_n_per_kg, seen_by, train)
    }

    /// Of a train that is not as long as described, in the same way.
    pub(super) fn of_length(length: OtherLength, seen_by: SeenBy, train: &Train) -> Self {
        Self::following(Follows::Length(length.times), length.off_n_per_kg, seen_by, train)
    }

    /// Of locations that are off from run to run, in the same way.
    pub(super) fn of_locations(off: OffFromRunToRun, seen_by: SeenBy, train: &Train) -> Self {
        Self::following(Follows::Locations(off.metres), off.off_n_per_kg, seen_by, train)
    }

    fn following(follows: Follows, off_n_per_kg: f64, seen_by: SeenBy, train: &Train) -> Self {
        let sd_permille = FOLLOWS_SLOPES * 1e3 * off_n_per_kg / train.gravity_n_per_kg();
        Self { sd_permille, seen_by, follows: Some(follows) }
    }

    /// The largest one of several.
    pub(super) fn largest(found: impl IntoIterator<Item = Option<Self>>) -> Option<Self> {
        found.into_iter().flatten().max_by(|a, b| a.sd_permille.total_cmp(&b.sd_permille))
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
        let small = may_be_small.then(|| self.small_errors(train, track, &described)).flatten();
        // Beside slopes of another line, and of few runs, what is left at a place is no resistance.
        let may_resist = gradients.is_none() && resistance.is_none() && self.runs >= LEAST_RUNS_SMALL;
        let resists = described
            .efforts
            .filter(|_| may_resist)
            .and_then(|efforts| efforts.resists)
            .map(|found| ResistsAtPlaces { sd_n_per_kg: found.sd_n_per_kg, seen_by: SeenBy::Efforts });
        Answer { gradients, resistance, small, resists }
    }
}

impl Answer {
    /// Beside effects that are described: lengths and places may be theirs.
    pub fn beside_effects(self) -> Self {
        let of_slopes =
            |small: &SmallErrors| !matches!(small.follows, Some(Follows::Length(_) | Follows::Locations(_)));
        Self { small: self.small.filter(of_slopes), resists: None, ..self }
    }

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
        let (sd, what) = (self.sd_permille, self.seen_by.words());
        let taken = format!("gradients are taken to be off by {sd:.2} permille (standard deviation)");
        let otherwise = "gradient_sd_permille in the track's file says otherwise";
        match self.follows {
            Some(Follows::Steepness(times)) => write!(
                f,
                "by {what} all slopes act {} times as described, as beside a rotating mass or a wheel that is off: \
                 {taken}; {otherwise}",
                times.with_interval(3)
            ),
            Some(Follows::Length(times)) => write!(
                f,
                "by {what} slopes act as on a train {} times as long as described; is length_m right, and \
                 the location that of its front? Until it is, {taken}; {otherwise}",
                times.with_interval(2)
            ),
            Some(Follows::Locations(metres)) => write!(
                f,
                "by {what} slopes come early or late from run to run, as if locations were off by {} m (standard deviation): \
                 {taken}; {otherwise}",
                metres.with_interval(0)
            ),
            None => write!(f, "{taken}, on which {what} of different runs agree at their places; {otherwise}"),
        }
    }
}
