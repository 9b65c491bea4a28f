//! The track: gradient averaged over the length of the train.
//!
//! In: a list of (from, gradient), sorted, at most [`MAX_GRADIENTS`]. Out: mean gradient under a train, in either direction, in O(log n).
//!
//! ```text
//! mean gradient = (h(front) - h(tail)) / length        uphill in the direction of travel is positive
//! ```
//!
//! Heights h are summed once, at construction. Before the first entry the height is 0 (flat); the last gradient goes on.

use crate::Real;
use core::fmt;
use heapless::Vec;

/// Capacity of a track. The steepest real line at hand (5.8 km of Zurich's suburban railway) has 221 entries.
pub const MAX_GRADIENTS: usize = 512;

/// Direction of travel along the track's locations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Direction {
    /// Locations grow.
    #[default]
    Up,
    /// Locations fall.
    Down,
}

impl Direction {
    /// +1 for up, -1 for down.
    pub const fn sign(self) -> Real {
        match self {
            Self::Up => 1.0,
            Self::Down => -1.0,
        }
    }
}

/// One entry of the gradient table: from here on, `permille`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gradient {
    /// Location where it begins, m.
    pub from_m: Real,
    /// Uphill in the `up` direction positive.
    pub permille: Real,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Piece {
    from_m: Real,
    slope: Real,
    height_m: Real,
}

/// A track of fixed capacity. Made by [`Track::try_new`].
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    length_m: Real,
    pieces: Vec<Piece, MAX_GRADIENTS>,
}

/// Why a track was refused. The old one stays in force.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum TrackError {
    /// `length_m` was not a finite number above 0.
    Length {
        /// What stood there.
        found: Real,
    },
    /// More entries than [`MAX_GRADIENTS`].
    TooMany {
        /// How many there were.
        found: usize,
    },
    /// Entry `index` is not finite, or its gradient is beyond ±200 ‰.
    BadGradient {
        /// Which entry, counted from 0.
        index: usize,
    },
    /// Entry `index` does not begin after the one before it.
    NotSorted {
        /// Which entry, counted from 0.
        index: usize,
    },
}

impl fmt::Display for TrackError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length { found } => write!(f, "track: length_m must be above 0, found {found}"),
            Self::TooMany { found } => {
                write!(f, "track: at most {MAX_GRADIENTS} gradients, found {found}")
            }
            Self::BadGradient { index } => write!(
                f,
                "track: gradient {index} must be finite and within 200 permille"
            ),
            Self::NotSorted { index } => write!(
                f,
                "track: gradient {index} must begin after the one before it"
            ),
        }
    }
}

impl core::error::Error for TrackError {}

impl Track {
    /// Checks the entries and sums the heights.
    ///
    /// # Errors
    /// [`TrackError`] names the first entry that is wrong.
    ///
    /// ```
    /// use rundown::track::{Direction, Gradient, Track};
    ///
    /// let track = Track::try_new(1000.0, [
    ///     Gradient { from_m: 0.0, permille: 0.0 },
    ///     Gradient { from_m: 500.0, permille: 10.0 },
    /// ])?;
    /// // Half of a 100 m train stands on the 10 permille.
    /// assert!((track.mean_gradient(550.0, 100.0, Direction::Up) - 0.005).abs() < 1e-15);
    /// assert!((track.mean_gradient(450.0, 100.0, Direction::Down) + 0.005).abs() < 1e-15);
    /// # Ok::<(), rundown::track::TrackError>(())
    /// ```
    pub fn try_new(
        length_m: Real,
        gradients: impl IntoIterator<Item = Gradient>,
    ) -> Result<Self, TrackError> {
        if !(length_m.is_finite() && length_m > 0.0) {
            return Err(TrackError::Length { found: length_m });
        }
        let mut pieces: Vec<Piece, MAX_GRADIENTS> = Vec::new();
        for (index, gradient) in gradients.into_iter().enumerate() {
            // Also refuses NaN.
            let plausible = gradient.from_m.is_finite() && gradient.permille.abs() <= 200.0;
            if !plausible {
                return Err(TrackError::BadGradient { index });
            }
            let height_m = match pieces.last() {
                Some(last) if gradient.from_m <= last.from_m => {
                    return Err(TrackError::NotSorted { index });
                }
                Some(last) => last.height_m + (gradient.from_m - last.from_m) * last.slope,
                None => 0.0,
            };
            let piece = Piece {
                from_m: gradient.from_m,
                slope: gradient.permille / 1000.0,
                height_m,
            };
            pieces
                .push(piece)
                .map_err(|_| TrackError::TooMany { found: index + 1 })?;
        }
        Ok(Self { length_m, pieces })
    }

    /// Length, m.
    pub fn length_m(&self) -> Real {
        self.length_m
    }

    /// Mean gradient (m/m) under a train whose front is at `front_m`, uphill in the direction of travel positive.
    pub fn mean_gradient(&self, front_m: Real, train_length_m: Real, direction: Direction) -> Real {
        UnderTrain::new(self, front_m, train_length_m, direction).mean_gradient()
    }

    /// Height above the first entry, m.
    pub fn height_m(&self, location_m: Real) -> Real {
        self.point(location_m).height_m
    }

    #[inline]
    fn point(&self, location_m: Real) -> Point {
        // The number of pieces that begin at or before the location; 0 means the flat start.
        let piece = self.pieces.partition_point(|p| p.from_m <= location_m);
        let flat = Piece {
            from_m: Real::NEG_INFINITY,
            slope: 0.0,
            height_m: 0.0,
        };
        let begun = self.begun(piece).copied().unwrap_or(flat);
        let mut point = Point {
            location_m,
            piece,
            height_m: 0.0,
            begun,
            until_m: self.pieces.get(piece).map_or(Real::INFINITY, |p| p.from_m),
        };
        point.height_m = point.height_in_piece_m(location_m);
        point
    }

    /// As [`Track::point`]; no search when the location lies in the piece of `near`.
    #[inline]
    fn point_near(&self, near: &Point, location_m: Real) -> Point {
        if near.begun.from_m <= location_m && location_m < near.until_m {
            Point {
                location_m,
                height_m: near.height_in_piece_m(location_m),
                ..*near
            }
        } else {
            self.point(location_m)
        }
    }

    /// The piece in which a point with `count` begun pieces lies.
    #[inline]
    fn begun(&self, count: usize) -> Option<&Piece> {
        self.pieces.get(count.wrapping_sub(1))
    }

    /// Height gained from a point over a distance of either sign, m: summed piece by piece, so that it is exact
    /// to rounding of the distance even where the height is large and the distance tiny.
    #[inline]
    fn rise_m(&self, from: &Point, distance_m: Real) -> Real {
        let end_m = from.location_m + distance_m;
        if from.begun.from_m <= end_m && end_m <= from.until_m {
            return distance_m * from.begun.slope;
        }
        self.rise_over_edges_m(from, distance_m)
    }

    fn rise_over_edges_m(&self, from: &Point, distance_m: Real) -> Real {
        let end_m = from.location_m + distance_m;
        let mut piece = from.piece;
        let mut at_m = from.location_m;
        let mut rest_m = distance_m;
        let mut rise_m = 0.0;
        loop {
            let begun = self.begun(piece);
            let slope = begun.map_or(0.0, |p| p.slope);
            let edge_m = if distance_m >= 0.0 {
                self.pieces
                    .get(piece)
                    .map(|p| p.from_m)
                    .filter(|edge| *edge < end_m)
            } else {
                begun.map(|p| p.from_m).filter(|edge| *edge > end_m)
            };
            let Some(edge_m) = edge_m else {
                return rise_m + rest_m * slope;
            };
            rise_m += (edge_m - at_m) * slope;
            rest_m -= edge_m - at_m;
            at_m = edge_m;
            piece = if distance_m >= 0.0 {
                piece + 1
            } else {
                piece - 1
            };
        }
    }
}

#[derive(Clone, Copy, Debug)]
struct Point {
    location_m: Real,
    piece: usize,
    height_m: Real,
    /// The piece and where it ends; kept here because most shifts stay within it.
    begun: Piece,
    until_m: Real,
}

impl Point {
    #[inline]
    fn height_in_piece_m(&self, location_m: Real) -> Real {
        if self.piece == 0 {
            return 0.0;
        }
        self.begun.height_m + (location_m - self.begun.from_m) * self.begun.slope
    }

    /// How far it may be shifted to either side within its piece.
    #[inline]
    fn room_m(&self) -> Real {
        (self.location_m - self.begun.from_m).min(self.until_m - self.location_m)
    }
}

/// A train standing on a track: two searches at construction, none afterwards.
#[derive(Clone, Copy, Debug)]
pub struct UnderTrain<'a> {
    track: &'a Track,
    front: Point,
    tail: Point,
    train_length_m: Real,
}

impl<'a> UnderTrain<'a> {
    /// Finds front and tail. `train_length_m` above 0.
    #[inline]
    pub fn new(
        track: &'a Track,
        front_m: Real,
        train_length_m: Real,
        direction: Direction,
    ) -> Self {
        let front = track.point(front_m);
        Self {
            track,
            front,
            tail: track.point_near(&front, front_m - direction.sign() * train_length_m),
            train_length_m,
        }
    }

    /// Mean gradient (m/m), uphill in the direction of travel positive.
    pub fn mean_gradient(&self) -> Real {
        (self.front.height_m - self.tail.height_m) / self.train_length_m
    }

    /// Change of the mean gradient when the train is shifted by `shift_m` along the track's locations.
    ///
    /// A difference of its own, because two mean gradients subtracted would leave nothing but rounding for the
    /// millimetre shifts of the paper's sigma points (α = 0.001).
    #[inline]
    pub fn mean_gradient_change(&self, shift_m: Real) -> Real {
        let front_m = self.track.rise_m(&self.front, shift_m);
        let tail_m = self.track.rise_m(&self.tail, shift_m);
        (front_m - tail_m) / self.train_length_m
    }

    /// The same for a pair of shifts by ±√`epsilon_m2`: change = ± √ε odd + even. Returns odd and even.
    #[inline]
    pub fn mean_gradient_of_pair(&self, epsilon_m2: Real) -> (Real, Real) {
        let room_m = self.front.room_m().min(self.tail.room_m());
        if epsilon_m2 <= room_m * room_m {
            let bend = self.front.begun.slope - self.tail.begun.slope;
            return (bend / self.train_length_m, 0.0);
        }
        let root_m = libm::sqrt(epsilon_m2);
        let ahead = self.mean_gradient_change(root_m);
        let behind = self.mean_gradient_change(-root_m);
        ((ahead - behind) / (2.0 * root_m), 0.5 * (ahead + behind))
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
        for (location_m, height_m) in [
            (-50.0, 0.0),
            (100.0, 0.0),
            (200.0, 0.4),
            (305.0, 0.77),
            (1000.0, 1.74),
        ] {
            assert!(
                (track.height_m(location_m) - height_m).abs() < 1e-12,
                "{location_m}"
            );
        }
    }

    #[test]
    fn a_shift_changes_the_mean_as_two_lookups_do() {
        let track = track();
        for direction in [Direction::Up, Direction::Down] {
            for front_m in [-20.0, 100.0, 160.0, 305.0, 310.0, 899.9, 950.0, 1900.0] {
                let here = UnderTrain::new(&track, front_m, 120.0, direction);
                for shift_m in [-700.0, -40.0, -10.0, -1e-3, 0.0, 1e-3, 5.0, 10.0, 650.0] {
                    let change = track.mean_gradient(front_m + shift_m, 120.0, direction)
                        - here.mean_gradient();
                    let error = here.mean_gradient_change(shift_m) - change;
                    assert!(error.abs() < 1e-15, "{front_m} {shift_m} {error}");
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
            Track::try_new(
                1.0,
                entries
                    .iter()
                    .map(|&(from_m, permille)| Gradient { from_m, permille }),
            )
            .unwrap_err()
        };
        assert_eq!(
            refused(&[(0.0, 1.0), (0.0, 2.0)]),
            TrackError::NotSorted { index: 1 }
        );
        assert_eq!(
            refused(&[(0.0, Real::NAN)]),
            TrackError::BadGradient { index: 0 }
        );
        assert_eq!(
            Track::try_new(0.0, []),
            Err(TrackError::Length { found: 0.0 })
        );
        let endless = (0..).map(|i| Gradient {
            from_m: i as Real,
            permille: 0.0,
        });
        assert_eq!(
            Track::try_new(1.0, endless),
            Err(TrackError::TooMany {
                found: MAX_GRADIENTS + 1
            })
        );
    }
}
