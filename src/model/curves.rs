//! Curves of a track, ready for the mean of Roeckl's formula under a train.
//!
//! In: a list of (from, to, radius), sorted, at most [`MAX_CURVES`]. Out: the integral of the formula along the track,
//! O(log n).
//!
//! Where two curves overlap the first one counts. The sums are made once, at construction. Single precision, for the
//! board has two tracks in RAM: 16 bytes a curve, 0.01 m at 100 km, 1e-6 of the resistance.

use crate::Real;
use crate::extremes::Extremes;
use crate::model::bounds::FAR_M;
use crate::model::table::Table;
use crate::plain::plain;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Capacity of a track.
pub const MAX_CURVES: usize = 256;

/// One curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Curve {
    /// Location where it begins, m.
    pub from_m: Real,
    /// Location where it ends, m.
    pub to_m: Real,
    /// Radius, m.
    pub radius_m: Real,
}

plain! {
    struct Curve { from_m, to_m, radius_m }
}

/// Smallest radius that the formula is asked for, m: its pole is at 30 m, and no main line is tighter.
const LEAST_RADIUS_M: Real = 50.0;

/// Roeckl's formula: resistance of a curve as a share of the weight. A radius below 50 m counts as 50 m.
///
/// ```
/// use rundown::model::curves::roeckl;
///
/// assert!((roeckl(705.0) - 0.001).abs() < 1e-15);
/// assert!((roeckl(280.0) - 0.002).abs() < 1e-15);
/// ```
pub fn roeckl(radius_m: Real) -> Real {
    if radius_m >= 300.0 { 0.650 / (radius_m - 55.0) } else { 0.500 / (radius_m.at_least(LEAST_RADIUS_M) - 30.0) }
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct Bend {
    from_m: f32,
    to_m: f32,
    roeckl: f32,
    /// Integral of the formula over all curves before this one, m.
    before_m: f32,
}

plain! {
    struct Bend { from_m, to_m, roeckl, before_m }
}

/// The curves of a track.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Curves {
    bends: Vec<Bend, MAX_CURVES>,
    /// Where the last curve was said to begin: where it overlaps the one before, its bend begins later.
    begun_m: Real,
}

plain! {
    struct Curves { bends, begun_m }
}

impl Curves {
    pub(crate) const NONE: Self = Self { bends: Vec::new(), begun_m: 0.0 };

    pub(crate) fn is_empty(&self) -> bool {
        self.bends.is_empty()
    }

    /// Integral of Roeckl's formula from the beginning of the track to a location, m.
    pub(crate) fn integral_m(&self, location_m: Real) -> Real {
        let location_m = location_m as f32;
        let begun = self.bends.partition_point(|bend| bend.from_m <= location_m);
        let last = begun.checked_sub(1).and_then(|index| self.bends.get(index));
        last.map_or(0.0, |bend| Real::from(bend.integral_m(location_m)))
    }
}

impl Table for Curves {
    type Entry = Curve;

    fn len(&self) -> usize {
        self.bends.len()
    }

    fn clear(&mut self) {
        self.bends.clear();
        self.begun_m = 0.0;
    }

    fn push(&mut self, curve: Curve) -> bool {
        let last = self.bends.last();
        let last_begin_m = last.map_or(Real::NEG_INFINITY, |_| self.begun_m);
        let last_end_m = last.map_or(Real::NEG_INFINITY, |last| Real::from(last.to_m));
        let before_m = last.map_or(0.0, |last| last.integral_m(last.to_m));
        let from_m = curve.from_m.at_least(last_end_m);
        // Also refuses NaN.
        let good = curve.from_m >= -FAR_M
            && curve.to_m <= FAR_M
            && curve.from_m >= last_begin_m
            && curve.to_m > curve.from_m
            && curve.radius_m > 0.0;
        let bend = Bend {
            from_m: from_m as f32,
            // Inside the one before it: of no length, so that curves keep their numbers.
            to_m: curve.to_m.at_least(from_m) as f32,
            roeckl: roeckl(curve.radius_m) as f32,
            before_m,
        };
        let taken = good && self.bends.push(bend).is_ok();
        if taken {
            self.begun_m = curve.from_m;
        }
        taken
    }
}

impl Bend {
    fn integral_m(&self, location_m: f32) -> f32 {
        self.before_m + (location_m.at_most(self.to_m) - self.from_m) * self.roeckl
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(from_m: Real, to_m: Real, radius_m: Real) -> Curve {
        Curve { from_m, to_m, radius_m }
    }

    #[test]
    fn the_integral_is_the_sum_over_the_curves() {
        let mut curves = Curves::NONE;
        assert!(curves.push(curve(100.0, 300.0, 705.0)));
        assert!(curves.push(curve(150.0, 200.0, 280.0)), "inside");
        assert!(curves.push(curve(290.0, 400.0, 280.0)), "overlaps");
        for (location_m, sum_m) in [(0.0, 0.0), (100.0, 0.0), (200.0, 0.1), (300.0, 0.2), (350.0, 0.3), (9e3, 0.4)] {
            assert!((curves.integral_m(location_m) - sum_m).abs() < 1e-6, "{location_m}");
        }
    }

    #[test]
    fn what_is_no_curve_is_refused() {
        let mut curves = Curves::NONE;
        assert!(curves.push(curve(100.0, 300.0, 705.0)));
        for wrong in [
            curve(50.0, 90.0, 500.0),
            curve(400.0, 400.0, 500.0),
            curve(400.0, Real::INFINITY, 500.0),
            curve(400.0, 1e30, 500.0),
            curve(-3.5e38, 500.0, 500.0),
            curve(Real::NAN, 500.0, 500.0),
            curve(400.0, 500.0, 0.0),
            curve(400.0, 500.0, Real::NAN),
        ] {
            assert!(!curves.push(wrong), "{wrong:?}");
        }
        assert_eq!(curves.len(), 1);
    }
}
