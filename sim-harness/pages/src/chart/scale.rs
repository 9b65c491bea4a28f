//! Numbers of a chart: ranges that are never empty, tick labels, gaps, thinning.

use crate::chart::Point;
use rundown::Real;
use std::ops::Range;

/// Columns to which series are thinned.
const COLUMNS: Real = 900.0;

/// All numbers of a point can be drawn.
pub(super) trait Finite {
    fn is_finite(&self) -> bool;
}

impl Finite for Point {
    fn is_finite(&self) -> bool {
        self.0.is_finite() && self.1.is_finite()
    }
}

impl Finite for (Real, Real, Real) {
    fn is_finite(&self) -> bool {
        self.0.is_finite() && self.1.is_finite() && self.2.is_finite()
    }
}

/// The stretches without a gap.
pub(super) fn unbroken<P: Copy + Finite>(points: &[Option<P>]) -> Vec<Vec<P>> {
    points
        .split(|point| !point.is_some_and(|point| point.is_finite()))
        .map(|stretch| stretch.iter().flatten().copied().collect::<Vec<P>>())
        .filter(|stretch| !stretch.is_empty())
        .collect()
}

/// First, least, largest and last point of each column, in their order, where there are more points than columns.
pub(super) fn thinned(points: &[Point], x: &Range<Real>) -> Vec<Point> {
    if points.len() as Real <= 4.0 * COLUMNS {
        return points.to_vec();
    }
    let column = |point: &Point| (COLUMNS * (point.0 - x.start) / (x.end - x.start)).floor();
    let mut kept = Vec::new();
    for points in points.chunk_by(|a, b| column(a) == column(b)) {
        let by_height = |a: &(usize, &Point), b: &(usize, &Point)| a.1.1.total_cmp(&b.1.1);
        let least = points.iter().enumerate().min_by(by_height);
        let largest = points.iter().enumerate().max_by(by_height);
        let mut indexes = vec![0, points.len() - 1];
        indexes.extend(least.into_iter().chain(largest).map(|(index, _)| index));
        indexes.sort_unstable();
        indexes.dedup();
        kept.extend(indexes.into_iter().map(|index| points[index]));
    }
    kept
}

/// Least and largest of the finite values; 0 to 1 when there is none.
pub fn range_of(values: impl IntoIterator<Item = Real>) -> Range<Real> {
    values
        .into_iter()
        .filter(|value| value.is_finite())
        .map(|value| value..value)
        .reduce(|a, b| a.start.min(b.start)..a.end.max(b.end))
        .unwrap_or(0.0..1.0)
}

/// With some air, and never empty.
pub(super) fn widened(range: &Range<Real>, air: Real) -> Range<Real> {
    let (start, end) = (range.start.min(range.end), range.start.max(range.end));
    if !(start, end).is_finite() {
        return 0.0..1.0;
    }
    let least = 1e-9 * start.abs().max(end.abs());
    let margin = if end - start > least { air * (end - start) } else { (0.05 * start.abs()).max(1e-6) };
    start - margin..end + margin
}

/// Whole numbers in a range, at least 1: as many labels as an axis of counts may have.
pub(super) fn whole_numbers(range: &Range<Real>) -> usize {
    (range.end.floor() - range.start.ceil() + 1.0).max(1.0) as usize
}

/// A number of an axis, without zeros that say nothing.
pub(super) fn tick(value: Real, digits: usize) -> String {
    let text = format!("{value:.digits$}");
    let text = match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.'),
        false => &text,
    };
    if text == "-0" { "0".to_owned() } else { text.replace('-', "\u{2212}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_the_ends_and_the_peaks() {
        let mut points: Vec<Point> = (0..100_000).map(|i| (Real::from(i), 0.0)).collect();
        points[54_321].1 = 7.0;
        points[54_322].1 = -7.0;
        let thin = thinned(&points, &(0.0..1e5));
        assert!(thin.len() < 3000, "{}", thin.len());
        for index in [0, 54_321, 54_322, 99_999] {
            assert!(thin.contains(&points[index]), "{index}");
        }
        assert!(thin.is_sorted_by(|a, b| a.0 < b.0));
        assert_eq!(thinned(&points[..50], &(0.0..1e5)), points[..50]);
    }

    #[test]
    fn a_range_is_never_empty() {
        assert_eq!(range_of([Real::NAN]), 0.0..1.0);
        assert_eq!(range_of([2.0, Real::INFINITY, -1.0]), -1.0..2.0);
        for range in [0.0..0.0, 5.0..5.0, 7.38..7.38 + 1e-15, Real::NAN..1.0] {
            let wide = widened(&range, 0.1);
            assert!(wide.end - wide.start > 1e-7, "{range:?}");
        }
    }

    #[test]
    fn ticks_have_no_needless_digits() {
        assert_eq!(tick(0.30000000000000004, 3), "0.3");
        assert_eq!(tick(120.0, 0), "120");
        assert_eq!(tick(-0.0001, 2), "0");
        assert_eq!(tick(-0.25, 2), "\u{2212}0.25");
    }
}
