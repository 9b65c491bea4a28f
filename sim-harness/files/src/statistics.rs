//! Mean, quantiles, spread and extremes of lists; line and correlation of pairs.
//!
//! ```
//! use rundown_files::statistics::*;
//!
//! assert_eq!(sorted([2.0, -1.0]), [-1.0, 2.0]);
//! assert_eq!(extremes([2.0, -1.0, 1.0]), (-1.0, 2.0));
//! assert_eq!(span([2.0, -1.0, 1.0]), 3.0);
//! assert_eq!(mean([1.0, 2.0, 6.0]), Some(3.0));
//! assert_eq!(mean([0.0; 0]), None);
//! assert_eq!(mean_of(&[1.0, 2.0, 6.0]), 3.0);
//! assert_eq!(rms([1.0, -7.0]), 5.0);
//! assert_eq!(squares_about(2.0, [1.0, 5.0]), 10.0);
//! assert_eq!(midmean([9.0, 1.0, 2.0, -40.0]), Some(1.5));
//! assert_eq!(midmean([3.0]), Some(3.0));
//! assert_eq!(midmean([0.0; 0]), None);
//! assert_eq!(upper_quantile([4.0, 1.0, 3.0, 2.0], 0.75), Some(4.0));
//! assert_eq!(quantile(&[1.0, 2.0, 4.0], 0.75), Some(3.0));
//! assert_eq!(quantile(&[], 0.5), None);
//! assert_eq!(median([4.0, 1.0, 2.0, 3.0]), Some(3.0));
//! assert_eq!(median_of(&[4.0, 1.0, 2.0]), 2.0);
//! assert_eq!(mean_median([4.0, 1.0, 2.0, 3.0]), Some(2.5));
//! assert_eq!(mean_median([4.0, 1.0, 2.0]), Some(2.0));
//! assert_eq!(mean_median([0.0; 0]), None);
//! assert_eq!(spread([0.0, -1.0, 90.0]), MEDIAN_TO_SD);
//! let line = [(0.0, 1.0), (1.0, 3.0), (2.0, 5.0)];
//! let pairs = Pairs::of(&line);
//! assert_eq!((pairs.slope(), pairs.offset(), pairs.left(&line)), (2.0, 1.0, 0.0));
//! assert_eq!(correlation(&[(1.0, 5.0), (2.0, 3.0)]), Some(-1.0));
//! assert_eq!(correlation(&[(1.0, 5.0), (1.0, 3.0)]), None);
//! ```

use core::borrow::Borrow;

/// In rising order.
pub fn sorted(values: impl IntoIterator<Item = impl Borrow<f64>>) -> Vec<f64> {
    let mut values: Vec<f64> = values.into_iter().map(|value| *value.borrow()).collect();
    values.sort_by(f64::total_cmp);
    values
}

/// The smallest and the largest; of none infinity and its negative.
pub fn extremes(values: impl IntoIterator<Item = impl Borrow<f64>>) -> (f64, f64) {
    let wider = |(low, high): (f64, f64), value: f64| (low.min(value), high.max(value));
    values.into_iter().map(|value| *value.borrow()).fold((f64::INFINITY, f64::NEG_INFINITY), wider)
}

/// From the smallest to the largest; of none infinitely below 0.
pub fn span(values: impl IntoIterator<Item = impl Borrow<f64>>) -> f64 {
    let (low, high) = extremes(values);
    high - low
}

/// Sum over count.
pub fn mean(values: impl IntoIterator<Item = impl Borrow<f64>>) -> Option<f64> {
    // From -0 on, as `sum` does.
    let (count, sum) = values.into_iter().fold((0_u64, -0.0), |(count, sum), value| (count + 1, sum + value.borrow()));
    (count > 0).then(|| sum / count as f64)
}

/// The same; NaN of none.
pub fn mean_of(values: impl IntoIterator<Item = impl Borrow<f64>>) -> f64 {
    mean(values).unwrap_or(f64::NAN)
}

/// Root of the mean square; NaN of none.
pub fn rms(values: impl IntoIterator<Item = impl Borrow<f64>>) -> f64 {
    mean_of(values.into_iter().map(|value| value.borrow().powi(2))).sqrt()
}

/// Sum of the squares of the distances from a value.
pub fn squares_about(middle: f64, values: impl IntoIterator<Item = impl Borrow<f64>>) -> f64 {
    values.into_iter().map(|value| (value.borrow() - middle).powi(2)).sum()
}

/// Mean of the middle half of all values.
pub fn midmean(values: impl IntoIterator<Item = impl Borrow<f64>>) -> Option<f64> {
    let values = sorted(values);
    let out = values.len() / 4;
    mean(&values[out..values.len() - out])
}

/// The value below which this share of all lies; of two values the upper one.
pub fn upper_quantile(values: impl IntoIterator<Item = impl Borrow<f64>>, share: f64) -> Option<f64> {
    let values = sorted(values);
    values.get((share * values.len() as f64) as usize).copied()
}

/// The same of sorted values; between two values in proportion.
pub fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let at = share.clamp(0.0, 1.0) * sorted.len().checked_sub(1)? as f64;
    let (low, high) = (sorted.get(at.floor() as usize)?, sorted.get(at.ceil() as usize)?);
    Some(low + (high - low) * at.fract())
}

/// Middle value, the upper one of two.
pub fn median(values: impl IntoIterator<Item = impl Borrow<f64>>) -> Option<f64> {
    upper_quantile(values, 0.5)
}

/// The same; NaN of none.
pub fn median_of(values: impl IntoIterator<Item = impl Borrow<f64>>) -> f64 {
    median(values).unwrap_or(f64::NAN)
}

/// Middle value, the mean of two.
pub fn mean_median(values: impl IntoIterator<Item = impl Borrow<f64>>) -> Option<f64> {
    let values = sorted(values);
    let last = values.len().checked_sub(1)?;
    Some(0.5 * (values[last / 2] + values[last.div_ceil(2)]))
}

/// Standard deviation of a normal distribution over the median of its sizes.
pub const MEDIAN_TO_SD: f64 = 1.4826;

/// Standard deviation by the median of the sizes, which a few exceptions do not move; 0 of none.
pub fn spread(off: impl IntoIterator<Item = impl Borrow<f64>>) -> f64 {
    median(off.into_iter().map(|value| value.borrow().abs())).map_or(0.0, |size| MEDIAN_TO_SD * size)
}

/// Standard deviation of the median of so many values with this [`spread`].
pub fn sd_of_median(spread: f64, count: usize) -> f64 {
    1.2533 * spread / (count as f64).sqrt()
}

/// Pairs (x, y): means, and sums of squares and products about them; NaN of none.
#[derive(Clone, Copy, Debug)]
pub struct Pairs {
    /// Mean of x.
    pub x: f64,
    /// Mean of y.
    pub y: f64,
    /// Sum of the squares of x.
    pub xx: f64,
    /// Sum of the products.
    pub xy: f64,
    /// Sum of the squares of y.
    pub yy: f64,
}

impl Pairs {
    /// Of all of them.
    pub fn of(pairs: &[(f64, f64)]) -> Self {
        let (all_x, all_y) = (pairs.iter().map(|p| p.0), pairs.iter().map(|p| p.1));
        let (x, y) = (mean_of(all_x.clone()), mean_of(all_y.clone()));
        let xy = pairs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
        Self { x, y, xx: squares_about(x, all_x), xy, yy: squares_about(y, all_y) }
    }

    /// Of y over x by least squares; NaN where all x are one.
    pub fn slope(&self) -> f64 {
        self.xy / self.xx
    }

    /// Of that line at x = 0.
    pub fn offset(&self) -> f64 {
        self.y - self.slope() * self.x
    }

    /// Sum of the squares that the line leaves of y.
    pub fn left(&self, pairs: &[(f64, f64)]) -> f64 {
        let (offset, slope) = (self.offset(), self.slope());
        pairs.iter().map(|p| (p.1 - offset - slope * p.0).powi(2)).sum()
    }
}

/// Correlation of x and y; none without spread.
pub fn correlation(pairs: &[(f64, f64)]) -> Option<f64> {
    let Pairs { xx, xy, yy, .. } = Pairs::of(pairs);
    let scale = (xx * yy).sqrt();
    (scale > 0.0).then(|| xy / scale)
}
