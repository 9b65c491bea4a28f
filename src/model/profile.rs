//! The heights along a track, and a train that stands on them.
//!
//! In: gradients from somewhere on, sorted, at most [`MAX_GRADIENTS`]. Out: heights, and the rise under a train: a
//! search for its front, O(log n), among the pieces that begin in the same cell of the line, mostly one or none; and a
//! walk over the few pieces under it. Heights are summed once, at construction. Before the first entry the height is 0
//! (flat); the last gradient goes on.

use crate::Real;
use crate::model::direction::Direction;
use crate::model::pieces::whole;
use crate::plain::{Bytes, Plain, plain};
use heapless::Vec;
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

plain! {
    struct Gradient { from_m, permille }
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct Piece {
    from_m: Real,
    slope: Real,
    height_m: Real,
}

plain! {
    struct Piece { from_m, slope, height_m }
}

const FLAT_START: Piece = Piece {
    // Not -∞, which makes NaN of a height.
    from_m: Real::MIN,
    slope: 0.0,
    height_m: 0.0,
};

/// Equal parts of a line in which a search begins. Lines have some dozens of gradients; more parts have no room beside
/// the records of the board in the emulator.
const CELLS: usize = 40;

/// The pieces of a track.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Profile {
    /// The first is the flat start, so every location lies in a piece.
    pieces: Vec<Piece, { MAX_GRADIENTS + 1 }>,
    /// Cells in a metre.
    #[serde(skip)]
    cells_per_m: Real,
    /// The last piece that begins before each cell; behind them, the last one.
    #[serde(skip)]
    before_cell: [u16; CELLS + 1],
}

impl Profile {
    pub(crate) const NONE: Self = Self { pieces: Vec::new(), cells_per_m: 0.0, before_cell: [0; CELLS + 1] };

    /// For a digest alone: the cells, which follow from the pieces and the length of the line, are left out.
    pub(crate) fn pass(&mut self, bytes: &mut Bytes<'_>) {
        self.pieces.pass(bytes);
    }

    /// To the flat start of a line of this length, which is above 0.
    pub(crate) fn restart(&mut self, length_m: Real) {
        self.cells_per_m = CELLS as Real / length_m;
        self.before_cell.fill(0);
        self.pieces.clear();
        // An empty list has room.
        let _first = self.pieces.push(FLAT_START).is_ok();
    }

    /// Number of gradients.
    pub(crate) fn len(&self) -> usize {
        // The flat beginning is none.
        self.pieces.len().saturating_sub(1)
    }

    /// Where the last gradient begins.
    pub(crate) fn last_m(&self) -> Real {
        self.pieces.last().unwrap_or(&FLAT_START).from_m
    }

    /// False: there is no room. The gradient begins beyond [`Profile::last_m`].
    pub(crate) fn push(&mut self, gradient: Gradient) -> bool {
        let last = self.pieces.last().unwrap_or(&FLAT_START);
        let piece = Piece {
            from_m: gradient.from_m,
            slope: gradient.permille / 1000.0,
            height_m: last.height_at_m(gradient.from_m),
        };
        let (cell, index) = (self.cell(gradient.from_m), self.pieces.len() as u16);
        let has_room = self.pieces.push(piece).is_ok();
        if has_room && let Some(later) = self.before_cell.get_mut(cell + 1..) {
            later.fill(index);
        }
        has_room
    }

    /// Where a search for a location begins: it never falls where the location rises, so what begins in an earlier cell
    /// lies behind it, and what begins in a later one ahead. Off the line it is the first or the last; the first for
    /// what is no number.
    #[inline]
    fn cell(&self, location_m: Real) -> usize {
        (whole(location_m * self.cells_per_m) as usize).min(CELLS - 1)
    }

    pub(crate) fn height_m(&self, location_m: Real) -> Real {
        self.search(location_m).height_m
    }

    pub(crate) fn height_integral_m2(&self, front_m: Real, train_length_m: Real, direction: Direction) -> Real {
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
        let cell = self.cell(location_m);
        let (mut index, mut last) = (usize::from(self.before_cell[cell]), usize::from(self.before_cell[cell + 1]));
        while index < last {
            let middle = (index + last).div_ceil(2);
            if self.begin_m(middle) <= location_m {
                index = middle;
            } else {
                last = middle - 1;
            }
        }
        self.point(index, location_m)
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
        let (piece, end_m) = match self.pieces.get(index..) {
            Some([piece, next, ..]) => (piece, next.from_m),
            Some([last]) => (last, Real::INFINITY),
            _ => (&FLAT_START, Real::INFINITY),
        };
        let behind_m = location_m - piece.from_m;
        let before_m = end_m - location_m;
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
    profile: &'a Profile,
    front: TrackPoint,
    tail: TrackPoint,
}

impl<'a> UnderTrain<'a> {
    /// Finds front and tail. `train_length_m` above 0.
    #[inline(always)]
    pub(crate) fn new(profile: &'a Profile, front_m: Real, train_length_m: Real, direction: Direction) -> Self {
        let front = profile.search(front_m);
        let to_tail_m = match direction {
            Direction::Up => -train_length_m,
            Direction::Down => train_length_m,
        };
        Self { profile, front, tail: profile.walk(&front, to_tail_m) }
    }

    /// The same train, shifted along the track's locations: found by walking, without a search.
    pub fn shifted(&self, shift_m: Real) -> Self {
        Self {
            profile: self.profile,
            front: self.profile.walk(&self.front, shift_m),
            tail: self.profile.walk(&self.tail, shift_m),
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
    #[inline(always)]
    pub fn rise_change_m(&self, shift_m: Real) -> Real {
        self.profile.rise_m(&self.front, shift_m) - self.profile.rise_m(&self.tail, shift_m)
    }

    /// Slope of the rise where neither front nor tail crosses an edge.
    #[inline]
    pub fn rise_slope(&self) -> Real {
        self.front.slope - self.tail.slope
    }

    /// What a pair of shifts by ±√`epsilon_m2` sees beyond that slope: change = ± √ε (slope + odd) + even. `None`: no
    /// edge is that near.
    #[inline]
    pub fn rise_over_edges(&self, epsilon_m2: Real) -> Option<(Real, Real)> {
        let within = |room_m: Real| epsilon_m2 <= room_m * room_m;
        if within(self.front.room_m) && within(self.tail.room_m) {
            return None;
        }
        Some(self.beyond_edges(crate::roots::square_root(epsilon_m2)))
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

    fn profile() -> Profile {
        let mut profile = Profile::NONE;
        profile.restart(1000.0);
        for (from_m, permille) in [(100.0, 4.0), (300.0, -6.0), (310.0, 0.0), (900.0, 10.0)] {
            assert!(profile.push(Gradient { from_m, permille }));
        }
        profile
    }

    #[test]
    fn height_is_the_sum_of_the_pieces() {
        let profile = profile();
        for (location_m, height_m) in [(-50.0, 0.0), (100.0, 0.0), (200.0, 0.4), (305.0, 0.77), (1000.0, 1.74)] {
            assert!((profile.height_m(location_m) - height_m).abs() < 1e-12, "{location_m}");
        }
    }

    #[test]
    fn a_search_finds_the_last_piece_that_has_begun() {
        let mut profile = Profile::NONE;
        assert_eq!(profile.search(10.0).index, 0);
        // Some pieces a cell and many; a line that ends before its gradients and one that goes on; before its start.
        for (length_m, apart_m) in [(700.0, 10.0), (5000.0, 10.0), (100.0, 10.0), (64.0, 0.25), (1e7, 0.1)] {
            profile.restart(length_m);
            for pieces in 1..70_u32 {
                for location_m in (0..720).map(|i| 0.1 * apart_m * (Real::from(i) - 105.0)) {
                    let begun = profile.pieces.partition_point(|piece| piece.from_m <= location_m);
                    assert_eq!(profile.search(location_m).index, begun - 1, "{pieces} pieces, {location_m}");
                }
                assert_eq!(profile.search(Real::NAN).index, 0);
                assert_eq!(profile.search(Real::NEG_INFINITY).index, 0);
                assert_eq!(profile.search(Real::INFINITY).index, profile.len());
                let from_m = apart_m * (Real::from(pieces) - 10.0);
                assert!(profile.push(Gradient { from_m, permille: 1.0 }));
            }
        }
    }

    #[test]
    fn a_full_track_is_searched_to_its_end() {
        let mut profile = Profile::NONE;
        profile.restart(1000.0);
        let mut full = (0..MAX_GRADIENTS as u32).map(|i| Gradient { from_m: 2.0 * Real::from(i), permille: 1.0 });
        assert!(full.all(|gradient| profile.push(gradient)));
        assert!(!profile.push(Gradient { from_m: 1e6, permille: 1.0 }));
        assert_eq!(profile.search(1e6).index, MAX_GRADIENTS);
        assert_eq!(profile.search(1.0).index, 1);
    }

    #[test]
    fn the_integral_of_the_height_is_its_mean_times_the_length() {
        let profile = profile();
        for direction in [Direction::Up, Direction::Down] {
            for front_m in [-20.0, 160.0, 305.0, 400.0, 950.0, 1900.0] {
                let steps = 12_000;
                let each_m = 120.0 / Real::from(steps);
                let sum_m2: Real = (0..steps)
                    .map(|i| front_m - direction.sign() * each_m * (Real::from(i) + 0.5))
                    .map(|location_m| each_m * profile.height_m(location_m))
                    .sum();
                let found_m2 = profile.height_integral_m2(front_m, 120.0, direction);
                assert!((found_m2 - sum_m2).abs() < 1e-4, "{front_m}: {found_m2} {sum_m2}");
            }
        }
        for odd_m in [Real::NAN, Real::INFINITY, Real::NEG_INFINITY, Real::MAX] {
            let _ends = profile.height_integral_m2(odd_m, 120.0, Direction::Up);
        }
    }

    #[test]
    fn a_shift_changes_the_mean_as_two_lookups_do() {
        let profile = profile();
        for direction in [Direction::Up, Direction::Down] {
            for front_m in [-20.0, 100.0, 160.0, 305.0, 310.0, 899.9, 950.0, 1900.0] {
                let here = UnderTrain::new(&profile, front_m, 120.0, direction);
                for shift_m in [-700.0, -40.0, -10.0, -1e-3, 0.0, 1e-3, 5.0, 10.0, 650.0] {
                    let there = UnderTrain::new(&profile, front_m + shift_m, 120.0, direction);
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
        let profile = profile();
        let odd = [Real::NAN, Real::INFINITY, Real::NEG_INFINITY, Real::MAX];
        for direction in [Direction::Up, Direction::Down] {
            for odd_m in odd {
                let there = UnderTrain::new(&profile, odd_m, 120.0, direction);
                let here = UnderTrain::new(&profile, 305.0, 120.0, direction);
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
}
