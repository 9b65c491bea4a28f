//! The track: gradient and curves averaged over the length of the train, stops and permitted speeds.
//!
//! In: gradients, and where they are known curves and targets. Out: mean gradient and mean of Roeckl's formula under a
//! train, in either direction; the next target ahead of it.
//!
//! ```text
//! mean gradient = (h(front) - h(tail)) / length        uphill in the direction of travel is positive
//! ```

use crate::Real;
use crate::model::bounds::FAR_M;
use crate::model::curves::Curves;
pub use crate::model::curves::{Curve, MAX_CURVES};
use crate::model::direction::Direction;
pub use crate::model::profile::{Gradient, MAX_GRADIENTS};
use crate::model::profile::{Profile, UnderTrain};
use crate::model::table::Table;
use crate::model::targets::Targets;
pub use crate::model::targets::{MAX_TARGETS, Target};
use crate::plain::{Bytes, Plain};
use rundown_wire::errors;
use serde::Serialize;

/// A track of fixed capacity. Made by [`Track::try_new`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Track {
    length_m: Real,
    pub(super) profile: Profile,
    /// Not written where there are none, so that the digest of a track without curves is what it always was.
    #[serde(skip_serializing_if = "Curves::is_empty")]
    pub(crate) curves: Curves,
    /// The same.
    #[serde(skip_serializing_if = "Targets::is_empty")]
    pub(crate) targets: Targets,
}

errors! {
    /// Why a track was refused. The old one stays in force.
    #[non_exhaustive]
    pub enum TrackError {
        Length { found: Real } => "length_m: expected above 0, found {found}",
        /// More entries than [`MAX_GRADIENTS`].
        TooMany { found: usize } => "gradient: expected at most {MAX_GRADIENTS}, found {found}",
        BadGradient { index: usize } => "gradient[{index}]: expected finite numbers within 200 permille, found another",
        NotSorted { index: usize } => "gradient[{index}].from_m: expected beyond that of the entry before, found less",
        /// Curve `index` is none (ends, radius), begins before the one before it, or is one more than [`MAX_CURVES`].
        BadCurve { index: usize } =>
            "curve[{index}]: expected one of at most {MAX_CURVES}, sorted, of a radius above 0 and ending beyond its beginning, found another",
        /// Target `index` is none (location, permitted speed), lies before the one before it, or is one more than
        /// [`MAX_TARGETS`].
        BadTarget { index: usize } =>
            "target[{index}]: expected one of at most {MAX_TARGETS}, sorted, a stop or a permitted speed above 0, found another",
    }
}

impl Track {
    /// Checks the entries and sums the heights.
    ///
    /// # Errors
    /// [`TrackError`] names the first entry that is wrong.
    ///
    /// ```
    /// use rundown::model::direction::Direction;
    /// use rundown::model::track::{Gradient, Track};
    ///
    /// let track = Track::try_new(1000.0, [
    ///     Gradient { from_m: 0.0, permille: 0.0 },
    ///     Gradient { from_m: 500.0, permille: 10.0 },
    /// ])?;
    /// // Half of a 100 m train stands on the 10 permille.
    /// assert!((track.mean_gradient(550.0, 100.0, Direction::Up) - 0.005).abs() < 1e-15);
    /// assert!((track.mean_gradient(450.0, 100.0, Direction::Down) + 0.005).abs() < 1e-15);
    /// # Ok::<(), rundown::model::track::TrackError>(())
    /// ```
    pub fn try_new(length_m: Real, gradients: impl IntoIterator<Item = Gradient>) -> Result<Self, TrackError> {
        let mut track = Self::empty();
        track.restart(length_m)?;
        for gradient in gradients {
            track.push(gradient)?;
        }
        Ok(track)
    }

    /// No track.
    pub(crate) const fn empty() -> Self {
        Self { length_m: 0.0, profile: Profile::NONE, curves: Curves::NONE, targets: Targets::NONE }
    }

    /// All of it, for a digest: that of a track without curves is what it always was.
    pub(crate) fn pass(&mut self, bytes: &mut Bytes<'_>) {
        self.length_m.pass(bytes);
        self.profile.pass(bytes);
        if !self.curves.is_empty() {
            self.curves.pass(bytes);
        }
        if !self.targets.is_empty() {
            self.targets.pass(bytes);
        }
    }

    /// Begins with nothing but a length, in place.
    pub(crate) fn restart(&mut self, length_m: Real) -> Result<(), TrackError> {
        if !(length_m.is_finite() && length_m > 0.0) {
            return Err(TrackError::Length { found: length_m });
        }
        self.length_m = length_m;
        self.profile.restart(length_m);
        self.curves.clear();
        self.targets.clear();
        Ok(())
    }

    /// Appends an entry.
    ///
    /// # Errors
    /// [`TrackError`]; the track is as before.
    pub(crate) fn push(&mut self, gradient: Gradient) -> Result<(), TrackError> {
        let index = self.entries();
        // Also refuses NaN.
        let plausible = gradient.from_m.abs() <= FAR_M && gradient.permille.abs() <= 200.0;
        if !plausible {
            return Err(TrackError::BadGradient { index });
        }
        if gradient.from_m <= self.profile.last_m() {
            return Err(TrackError::NotSorted { index });
        }
        self.profile.push(gradient).then_some(()).ok_or(TrackError::TooMany { found: index + 1 })
    }

    /// The same track with these curves, sorted.
    ///
    /// # Errors
    /// [`TrackError::BadCurve`] names the first curve that is wrong.
    ///
    /// ```
    /// use rundown::model::direction::Direction;
    /// use rundown::model::track::{Curve, Track};
    ///
    /// let track = Track::try_new(1000.0, [])?.with_curves([Curve { from_m: 500.0, to_m: 700.0, radius_m: 705.0 }])?;
    /// // Half of a 100 m train stands in a curve of 705 m, which by Roeckl costs 1 permille of the weight.
    /// assert!((track.mean_roeckl(550.0, 100.0, Direction::Up) - 0.0005).abs() < 1e-9);
    /// # Ok::<(), rundown::model::track::TrackError>(())
    /// ```
    pub fn with_curves(mut self, curves: impl IntoIterator<Item = Curve>) -> Result<Self, TrackError> {
        self.curves.refill(curves).map_err(|index| TrackError::BadCurve { index })?;
        Ok(self)
    }

    /// The same track with these stops and permitted speeds, sorted.
    ///
    /// # Errors
    /// [`TrackError::BadTarget`] names the first one that is wrong.
    ///
    /// ```
    /// use rundown::model::direction::Direction;
    /// use rundown::model::track::{Target, Track};
    ///
    /// let places = [(0.0, Some(20.0)), (900.0, Some(10.0)), (1000.0, None)];
    /// let track = Track::try_new(1000.0, [])?.with_targets(places.map(|(at_m, limit_mps)| Target { at_m, limit_mps }))?;
    /// assert_eq!(track.next_target(Direction::Up, 100.0, 50.0), Some(Target { at_m: 900.0, limit_mps: Some(10.0) }));
    /// # Ok::<(), rundown::model::track::TrackError>(())
    /// ```
    pub fn with_targets(mut self, targets: impl IntoIterator<Item = Target>) -> Result<Self, TrackError> {
        self.targets.refill(targets).map_err(|index| TrackError::BadTarget { index })?;
        Ok(self)
    }

    /// Number of stops and permitted speeds.
    pub fn targets(&self) -> usize {
        self.targets.len()
    }

    /// The next stop or fall of the permitted speed further than `beyond_m` ahead, with the speed permitted behind it.
    pub fn next_target(&self, direction: Direction, location_m: Real, beyond_m: Real) -> Option<Target> {
        self.targets.next(direction, location_m, beyond_m)
    }

    /// Mean of Roeckl's formula ([`roeckl`](crate::model::curves::roeckl), a share of the weight) under a train whose
    /// front is at `front_m`.
    pub fn mean_roeckl(&self, front_m: Real, train_length_m: Real, direction: Direction) -> Real {
        let rear_m = front_m - direction.sign() * train_length_m;
        let integral_m = self.curves.integral_m(front_m) - self.curves.integral_m(rear_m);
        direction.sign() * integral_m / train_length_m
    }

    /// Number of entries.
    pub(crate) fn entries(&self) -> usize {
        self.profile.len()
    }

    /// Length, m.
    pub fn length_m(&self) -> Real {
        self.length_m
    }

    /// Mean gradient (m/m) under a train whose front is at `front_m`, uphill in the direction of travel positive.
    pub fn mean_gradient(&self, front_m: Real, train_length_m: Real, direction: Direction) -> Real {
        UnderTrain::new(&self.profile, front_m, train_length_m, direction).rise_m() / train_length_m
    }

    /// Height above the first entry, m.
    pub fn height_m(&self, location_m: Real) -> Real {
        self.profile.height_m(location_m)
    }

    /// Integral of the height over a train whose front is at `front_m`, m²: over its length its mean height, times g
    /// its potential energy.
    ///
    /// ```
    /// use rundown::model::direction::Direction;
    /// use rundown::model::track::{Gradient, Track};
    ///
    /// let hill = [Gradient { from_m: 0.0, permille: 0.0 }, Gradient { from_m: 500.0, permille: 10.0 }];
    /// let track = Track::try_new(1000.0, hill)?;
    /// // 50 m of it stand on the hill, 0.25 m high on average.
    /// assert!((track.height_integral_m2(550.0, 100.0, Direction::Up) - 12.5).abs() < 1e-12);
    /// assert!((track.height_integral_m2(450.0, 100.0, Direction::Down) - 12.5).abs() < 1e-12);
    /// # Ok::<(), rundown::model::track::TrackError>(())
    /// ```
    pub fn height_integral_m2(&self, front_m: Real, train_length_m: Real, direction: Direction) -> Real {
        self.profile.height_integral_m2(front_m, train_length_m, direction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plain;
    use crate::tick::digest;

    fn track() -> Track {
        Track::try_new(
            2000.0,
            [(100.0, 4.0), (300.0, -6.0), (310.0, 0.0), (900.0, 10.0)]
                .map(|(from_m, permille)| Gradient { from_m, permille }),
        )
        .unwrap()
    }

    #[test]
    fn the_digest_of_a_track_is_that_of_its_postcard_bytes() {
        let mut track = track();
        let digest = |track: &mut Track| plain::digest(|bytes| track.pass(bytes));
        assert_eq!(digest(&mut track), digest::of(&track));
        assert!(track.curves.push(Curve { from_m: 100.0, to_m: 200.0, radius_m: 300.0 }));
        assert_eq!(digest(&mut track), digest::of(&track));
        assert!(track.targets.push(Target { at_m: 900.0, limit_mps: None }));
        assert_eq!(digest(&mut track), digest::of(&track));
    }

    #[test]
    fn directions_see_the_same_hill_with_opposite_sign() {
        let track = track();
        let up = track.mean_gradient(400.0, 150.0, Direction::Up);
        let down = track.mean_gradient(250.0, 150.0, Direction::Down);
        assert_eq!(up, -down);
    }

    #[test]
    fn refusals_name_the_entry() {
        let refused = |entries: &[(Real, Real)]| {
            Track::try_new(1.0, entries.iter().map(|&(from_m, permille)| Gradient { from_m, permille })).unwrap_err()
        };
        assert_eq!(refused(&[(0.0, 1.0), (0.0, 2.0)]), TrackError::NotSorted { index: 1 });
        assert_eq!(refused(&[(0.0, Real::NAN)]), TrackError::BadGradient { index: 0 });
        assert_eq!(Track::try_new(0.0, []), Err(TrackError::Length { found: 0.0 }));
        let endless = (0..).map(|i| Gradient { from_m: i as Real, permille: 0.0 });
        assert_eq!(Track::try_new(1.0, endless), Err(TrackError::TooMany { found: MAX_GRADIENTS + 1 }));
    }
}
