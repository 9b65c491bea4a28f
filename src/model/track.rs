//! The track: gradient averaged over the length of the train.
//!
//! In: a list of (from, gradient), sorted, at most [`MAX_GRADIENTS`]. Out: mean gradient under a train, in either direction: a search for its
//! front, O(log n), and a walk over the few pieces under it.
//!
//! ```text
//! mean gradient = (h(front) - h(tail)) / length        uphill in the direction of travel is positive
//! ```
//!
//! Heights h are summed once, at construction. Before the first entry the height is 0 (flat); the last gradient goes on.

use crate::Real;
use crate::model::curves::Curves;
pub use crate::model::curves::{Curve, MAX_CURVES};
use crate::model::direction::Direction;
use crate::model::table::Table;
use crate::model::targets::Targets;
pub use crate::model::targets::{MAX_TARGETS, Target};
use heapless::Vec;
use rundown_wire::errors;
use serde::{Deserialize, Serialize};

/// Capacity of a track. The steepest real line at hand (5.8 km of Zurich's suburban railway) has 221 entries.
pub const MAX_GRADIENTS: usize = 512;

/// One entry of the gradient table: from here on, `permille`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gradient {
    /// Location where it begins, m.
    pub from_m: Real,
    /// Uphill in the `up` direction positive.
    pub permille: Real,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct Piece {
    from_m: Real,
    slope: Real,
    height_m: Real,
}

/// A track of fixed capacity. Made by [`Track::try_new`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Track {
    length_m: Real,
    /// The first is the flat start, so every location lies in a piece.
    pieces: Vec<Piece, { MAX_GRADIENTS + 1 }>,
    /// Not written where there are none, so that the digest of a track without curves is what it always was.
    #[serde(skip_serializing_if = "Curves::is_empty")]
    pub(crate) curves: Curves,
    /// The same.
    #[serde(skip_serializing_if = "Targets::is_empty")]
    pub(crate) targets: Targets,
}

const FLAT_START: Piece = Piece {
    // Not -∞, which makes NaN of a height.
    from_m: Real::MIN,
    slope: 0.0,
    height_m: 0.0,
};

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
        /// Target `index` is none (location, permitted speed), lies before the one before it, or is one more than [`MAX_TARGETS`].
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
        Self { length_m: 0.0, pieces: Vec::new(), curves: Curves::NONE, targets: Targets::NONE }
    }

    /// Begins with nothing but a length, in place.
    pub(crate) fn restart(&mut self, length_m: Real) -> Result<(), TrackError> {
        if !(length_m.is_finite() && length_m > 0.0) {
            return Err(TrackError::Length { found: length_m });
        }
        self.length_m = length_m;
        self.pieces.clear();
        self.curves.clear();
        self.targets.clear();
        // An empty list has room.
        let _first = self.pieces.push(FLAT_START).is_ok();
        Ok(())
    }

    /// Appends an entry.
    ///
    /// # Errors
    /// [`TrackError`]; the track is as before.
    pub(crate) fn push(&mut self, gradient: Gradient) -> Result<(), TrackError> {
        let index = self.entries();
        // Also refuses NaN.
        let plausible = gradient.from_m.is_finite() && gradient.permille.abs() <= 200.0;
        if !plausible {
            return Err(TrackError::BadGradient { index });
        }
        let last = self.pieces.last().unwrap_or(&FLAT_START);
        if gradient.from_m <= last.from_m {
            return Err(TrackError::NotSorted { index });
        }
        let piece = Piece {
            from_m: gradient.from_m,
            slope: gradient.permille / 1000.0,
            height_m: last.height_at_m(gradient.from_m),
        };
        self.pieces.push(piece).map_err(|_| TrackError::TooMany { found: index + 1 })
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

    /// Mean of Roeckl's formula ([`roeckl`](crate::model::curves::roeckl), a share of the weight) under a train whose front is at `front_m`.
    pub fn mean_roeckl(&self, front_m: Real, train_length_m: Real, direction: Direction) -> Real {
        let rear_m = front_m - direction.sign() * train_length_m;
        let integral_m = self.curves.integral_m(front_m) - self.curves.integral_m(rear_m);
        direction.sign() * integral_m / train_length_m
    }

    /// Number of entries.
    pub(crate) fn entries(&self) -> usize {
        // The flat beginning is none.
        self.pieces.len().saturating_sub(1)
    }

    /// Length, m.
    pub fn length_m(&self) -> Real {
        self.length_m
    }

    /// Mean gradient (m/m) under a train whose front is at `front_m`, uphill in the direction of travel positive.
    pub fn mean_gradient(&self, front_m: Real, train_length_m: Real, direction: Direction) -> Real {
        UnderTrain::new(self, front_m, train_length_m, direction).rise_m() / train_length_m
    }

    /// Height above the first entry, m.
    pub fn height_m(&self, location_m: Real) -> Real {
        self.search(location_m).height_m
    }

    /// Integral of the height over a train whose front is at `front_m`, m²: over its length its mean height, times g its potential energy.
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
        let low_m = match direction {
            Direction::Up => front_m - train_length_m,
            Direction::Down => front_m,
        };
        let low = self.search(low_m);
        let end_m = low_m + train_length_m;
        let (mut at_m, mut height_m, mut integral_m2) = (low_m, low.height_m, 0.0);
        let mut index = low.index;
        loop {
            let edge_m = self.begin_m(index + 1);
            let slope = self.piece(index).slope;
            let crossed = edge_m < end_m;
            let piece_m = if crossed { edge_m } else { end_m } - at_m;
            integral_m2 += piece_m * (height_m + 0.5 * piece_m * slope);
            if !crossed {
                return integral_m2;
            }
            height_m += piece_m * slope;
            at_m = edge_m;
            index += 1;
        }
    }

    /// The point at a location.
    #[inline]
    fn search(&self, location_m: Real) -> TrackPoint {
        let begun = self.pieces.partition_point(|p| p.from_m <= location_m);
        self.point(begun.saturating_sub(1), location_m)
    }

    /// The point at a distance of either sign, found by walking from here.
    #[inline]
    fn walk(&self, from: &TrackPoint, distance_m: Real) -> TrackPoint {
        let location_m = from.location_m + distance_m;
        let mut index = from.index;
        if distance_m < 0.0 {
            while index > 0 && location_m < self.begin_m(index) {
                index -= 1;
            }
        } else {
            while index + 1 < self.pieces.len() && self.begin_m(index + 1) <= location_m {
                index += 1;
            }
        }
        self.point(index, location_m)
    }

    #[inline]
    fn point(&self, index: usize, location_m: Real) -> TrackPoint {
        let piece = self.piece(index);
        let behind_m = location_m - piece.from_m;
        let before_m = self.begin_m(index + 1) - location_m;
        TrackPoint {
            location_m,
            index,
            slope: piece.slope,
            height_m: piece.height_at_m(location_m),
            room_m: if behind_m < before_m { behind_m } else { before_m },
        }
    }

    #[inline]
    fn piece(&self, index: usize) -> &Piece {
        self.pieces.get(index).unwrap_or(&FLAT_START)
    }

    /// Where a piece begins; behind the last one, never.
    #[inline]
    fn begin_m(&self, index: usize) -> Real {
        self.pieces.get(index).map_or(Real::INFINITY, |p| p.from_m)
    }

    /// Height gained from a point over a distance of either sign, m: summed piece by piece, so that it is exact
    /// to rounding of the distance even where the height is large and the distance tiny.
    fn rise_m(&self, from: &TrackPoint, distance_m: Real) -> Real {
        let end_m = from.location_m + distance_m;
        let mut index = from.index;
        let mut at_m = from.location_m;
        let mut rest_m = distance_m;
        let mut rise_m = 0.0;
        loop {
            let slope = self.piece(index).slope;
            let (edge_m, next, crossed) = if distance_m >= 0.0 {
                let edge_m = self.begin_m(index + 1);
                (edge_m, index + 1, edge_m < end_m)
            } else {
                let edge_m = self.begin_m(index);
                (edge_m, index.saturating_sub(1), edge_m > end_m)
            };
            if !crossed || next == index {
                return rise_m + rest_m * slope;
            }
            rise_m += (edge_m - at_m) * slope;
            rest_m -= edge_m - at_m;
            at_m = edge_m;
            index = next;
        }
    }
}

impl Piece {
    #[inline]
    fn height_at_m(&self, location_m: Real) -> Real {
        self.height_m + (location_m - self.from_m) * self.slope
    }
}

/// A location and what is found there.
#[derive(Clone, Copy, Debug)]
struct TrackPoint {
    location_m: Real,
    /// The piece.
    index: usize,
    slope: Real,
    height_m: Real,
    /// Distance to the nearer edge of the piece.
    room_m: Real,
}

/// A train standing on a track: searched once, at construction.
#[derive(Clone, Copy, Debug)]
pub struct UnderTrain<'a> {
    track: &'a Track,
    front: TrackPoint,
    tail: TrackPoint,
}

impl<'a> UnderTrain<'a> {
    /// Finds front and tail. `train_length_m` above 0.
    #[inline(always)]
    pub fn new(track: &'a Track, front_m: Real, train_length_m: Real, direction: Direction) -> Self {
        let front = track.search(front_m);
        let to_tail_m = match direction {
            Direction::Up => -train_length_m,
            Direction::Down => train_length_m,
        };
        Self { track, front, tail: track.walk(&front, to_tail_m) }
    }

    /// The same train, shifted along the track's locations: found by walking, without a search.
    pub fn shifted(&self, shift_m: Real) -> Self {
        Self {
            track: self.track,
            front: self.track.walk(&self.front, shift_m),
            tail: self.track.walk(&self.tail, shift_m),
        }
    }

    /// Height of the front above the tail, m: over the length of the train it is the mean gradient.
    #[inline]
    pub fn rise_m(&self) -> Real {
        self.front.height_m - self.tail.height_m
    }

    /// Change of the rise when the train is shifted by `shift_m` along the track's locations.
    ///
    /// A difference of its own, because two rises subtracted would leave nothing but rounding for the
    /// millimetre shifts of the paper's sigma points (α = 0.001).
    pub fn rise_change_m(&self, shift_m: Real) -> Real {
        self.track.rise_m(&self.front, shift_m) - self.track.rise_m(&self.tail, shift_m)
    }

    /// Slope of the rise where neither front nor tail crosses an edge.
    #[inline]
    pub fn rise_slope(&self) -> Real {
        self.front.slope - self.tail.slope
    }

    /// What a pair of shifts by ±√`epsilon_m2` sees beyond that slope: change = ± √ε (slope + odd) + even. `None`: no edge is that near.
    #[inline]
    pub fn rise_over_edges(&self, epsilon_m2: Real) -> Option<(Real, Real)> {
        let within = |room_m: Real| epsilon_m2 <= room_m * room_m;
        if within(self.front.room_m) && within(self.tail.room_m) {
            return None;
        }
        Some(self.beyond_edges(libm::sqrt(epsilon_m2)))
    }

    /// Taken by value: a train that nobody points at may live in registers.
    #[cold]
    fn beyond_edges(self, shift_m: Real) -> (Real, Real) {
        let ahead_m = self.rise_change_m(shift_m);
        let behind_m = self.rise_change_m(-shift_m);
        let odd = (ahead_m - behind_m) / (2.0 * shift_m) - self.rise_slope();
        (odd, 0.5 * (ahead_m + behind_m))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track() -> Track {
        Track::try_new(
            2000.0,
            [(100.0, 4.0), (300.0, -6.0), (310.0, 0.0), (900.0, 10.0)]
                .map(|(from_m, permille)| Gradient { from_m, permille }),
        )
        .unwrap()
    }

    #[test]
    fn height_is_the_sum_of_the_pieces() {
        let track = track();
        for (location_m, height_m) in [(-50.0, 0.0), (100.0, 0.0), (200.0, 0.4), (305.0, 0.77), (1000.0, 1.74)] {
            assert!((track.height_m(location_m) - height_m).abs() < 1e-12, "{location_m}");
        }
    }

    #[test]
    fn the_integral_of_the_height_is_its_mean_times_the_length() {
        let track = track();
        for direction in [Direction::Up, Direction::Down] {
            for front_m in [-20.0, 160.0, 305.0, 400.0, 950.0, 1900.0] {
                let steps = 12_000;
                let each_m = 120.0 / Real::from(steps);
                let sum_m2: Real = (0..steps)
                    .map(|i| front_m - direction.sign() * each_m * (Real::from(i) + 0.5))
                    .map(|location_m| each_m * track.height_m(location_m))
                    .sum();
                let found_m2 = track.height_integral_m2(front_m, 120.0, direction);
                assert!((found_m2 - sum_m2).abs() < 1e-4, "{front_m}: {found_m2} {sum_m2}");
            }
        }
        for odd_m in [Real::NAN, Real::INFINITY, Real::NEG_INFINITY, Real::MAX] {
            let _ends = track.height_integral_m2(odd_m, 120.0, Direction::Up);
        }
    }

    #[test]
    fn a_shift_changes_the_mean_as_two_lookups_do() {
        let track = track();
        for direction in [Direction::Up, Direction::Down] {
            for front_m in [-20.0, 100.0, 160.0, 305.0, 310.0, 899.9, 950.0, 1900.0] {
                let here = UnderTrain::new(&track, front_m, 120.0, direction);
                for shift_m in [-700.0, -40.0, -10.0, -1e-3, 0.0, 1e-3, 5.0, 10.0, 650.0] {
                    let there = UnderTrain::new(&track, front_m + shift_m, 120.0, direction);
                    let change_m = there.rise_m() - here.rise_m();
                    let error = here.rise_change_m(shift_m) - change_m;
                    assert!(error.abs() < 1e-13, "{front_m} {shift_m} {error}");
                    let shifted = here.shifted(shift_m);
                    assert_eq!(shifted.front.index, there.front.index);
                    assert_eq!(shifted.tail.index, there.tail.index);
                    assert!((shifted.rise_m() - there.rise_m()).abs() < 1e-13);
                    if shift_m > 0.0 {
                        let pair = here.rise_over_edges(shift_m * shift_m);
                        let (odd, even) = pair.unwrap_or((0.0, 0.0));
                        for (shift_m, change_m) in [shift_m, -shift_m].map(|s| (s, here.rise_change_m(s))) {
                            let error = shift_m * (here.rise_slope() + odd) + even - change_m;
                            assert!(error.abs() < 1e-13, "{front_m} {shift_m} {error}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn a_location_that_is_none_ends_every_walk() {
        let track = track();
        let odd = [Real::NAN, Real::INFINITY, Real::NEG_INFINITY, Real::MAX];
        for direction in [Direction::Up, Direction::Down] {
            for odd_m in odd {
                let there = UnderTrain::new(&track, odd_m, 120.0, direction);
                let here = UnderTrain::new(&track, 305.0, 120.0, direction);
                assert!(here.shifted(odd_m).front.index <= 4);
                for shift_m in odd.iter().chain(&[-10.0, 10.0]) {
                    assert!(there.shifted(*shift_m).tail.index <= 4);
                    for under_train in [&there, &here] {
                        let _ends = under_train.rise_change_m(*shift_m);
                    }
                }
            }
        }
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
