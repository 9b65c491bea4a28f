//! Mean, middle, spread and correlation of lists.

fn sorted(values: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Sum over count.
pub fn mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.into_iter().fold((0_u64, 0.0), |(count, sum), value| (count + 1, sum + value));
    (count > 0).then(|| sum / count as f64)
}

/// Mean of the middle half of all values.
pub fn midmean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let values = sorted(values);
    let out = values.len() / 4;
    mean(values[out..values.len() - out].iter().copied())
}

/// Middle value in any order, the upper one of two.
pub fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let values = sorted(values);
    values.get(values.len() / 2).copied()
}

/// The same of a list that is not empty.
pub fn median_of(values: &[f64]) -> f64 {
    let values = sorted(values.iter().copied());
    values[values.len() / 2]
}

/// Middle value, the mean of two.
pub fn mean_median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let values = sorted(values);
    let last = values.len().checked_sub(1)?;
    Some(0.5 * (values[last / 2] + values[last.div_ceil(2)]))
}

/// Standard deviation of a normal distribution over the median of its sizes.
pub const MEDIAN_TO_SD: f64 = 1.4826;

/// Standard deviation by the median of the sizes, which a few exceptions do not move; 0 of none.
pub fn spread(off: impl IntoIterator<Item = f64>) -> f64 {
    median(off.into_iter().map(f64::abs)).map_or(0.0, |size| MEDIAN_TO_SD * size)
}

/// Standard deviation of the median of so many values with this [`spread`].
pub fn sd_of_median(spread: f64, count: usize) -> f64 {
    1.2533 * spread / (count as f64).sqrt()
}

/// Correlation of x and y; none without spread.
pub fn correlation(pairs: &[(f64, f64)]) -> Option<f64> {
    let n = pairs.len() as f64;
    let x = pairs.iter().map(|p| p.0).sum::<f64>() / n;
    let y = pairs.iter().map(|p| p.1).sum::<f64>() / n;
    let sum = |f: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(f).sum::<f64>();
    let xy = sum(&|p| (p.0 - x) * (p.1 - y));
    let scale = (sum(&|p| (p.0 - x).powi(2)) * sum(&|p| (p.1 - y).powi(2))).sqrt();
    (scale > 0.0).then(|| xy / scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_midmean_leaves_the_ends_out() {
        assert_eq!(midmean([9.0, 1.0, 2.0, -40.0]), Some(1.5));
        assert_eq!(midmean([3.0]), Some(3.0));
        assert_eq!(midmean([]), None);
    }

    #[test]
    fn a_median_is_between_the_halves() {
        assert_eq!(mean_median([4.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(mean_median([4.0, 1.0, 2.0, 3.0]), Some(2.5));
        assert_eq!(mean_median([]), None);
    }
}
