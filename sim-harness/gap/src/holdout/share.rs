//! The share of a gap that is gone, and how sure that is.
//!
//! ```text
//! removed = (before - after) / (before - floor)        mean squares: errors of model and sensors add up in them
//! ```
//!
//! Values of one run are not independent, so the 95 % interval comes from a bootstrap over whole runs, from a fixed
//! seed.

use crate::config::HoldoutConfig;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rundown_files::statistics::{quantile, sorted};

/// Sums of squares of one run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Squares {
    /// The sum of their weights.
    pub weight: f64,
    /// Errors with the believed model.
    pub before: f64,
    /// Errors with the repaired one.
    pub after: f64,
    /// What a perfect model would leave.
    pub floor: f64,
    /// Products of the error with the believed model and what the repaired one takes off it.
    pub product: f64,
    /// Squares of what the repaired model takes off.
    pub taken: f64,
}

impl Squares {
    /// Of one value: its errors, and the variance that a perfect model would leave.
    pub fn of(before: f64, after: f64, floor: f64) -> Self {
        Self::weighed(before, after, floor, 1.0)
    }

    /// The same with a weight.
    pub fn weighed(before: f64, after: f64, floor: f64, weight: f64) -> Self {
        let taken = before - after;
        Self {
            weight,
            before: weight * before * before,
            after: weight * after * after,
            floor: weight * floor,
            product: weight * before * taken,
            taken: weight * taken * taken,
        }
    }

    /// Both together.
    pub fn and(self, other: &Self) -> Self {
        Self {
            weight: self.weight + other.weight,
            before: self.before + other.before,
            after: self.after + other.after,
            floor: self.floor + other.floor,
            product: self.product + other.product,
            taken: self.taken + other.taken,
        }
    }

    /// The share that is gone; `None` where there was nothing to remove. Negative: worse than before.
    pub fn removed(&self, config: &HoldoutConfig) -> Option<f64> {
        let removable = self.before - self.floor;
        (removable > config.least_removable * self.floor && removable > 0.0)
            .then(|| (self.before - self.after) / removable)
    }
}

/// Root mean squares over all runs, and the share of the gap that is gone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Share {
    /// Runs with values.
    pub runs: usize,
    /// With the believed model.
    pub before: f64,
    /// With the repaired one.
    pub after: f64,
    /// What a perfect model would leave.
    pub floor: f64,
    /// Share of the removable gap that is gone, 0 to 1; `None` where there was none.
    pub removed: Option<f64>,
    /// Its 95 % interval.
    pub removed_95: Option<(f64, f64)>,
}

impl Share {
    /// Over runs.
    ///
    /// ```
    /// use rundown_gap::config::HoldoutConfig;
    /// use rundown_gap::holdout::share::{Share, Squares};
    ///
    /// // Six runs, each off by 2 before and by 1 after, where a perfect model would be off by 1.
    /// let share = Share::of(&[Squares::of(2.0, 1.0, 1.0); 6], &HoldoutConfig::default());
    /// assert_eq!((share.before, share.after, share.floor), (2.0, 1.0, 1.0));
    /// assert_eq!((share.removed, share.removed_95), (Some(1.0), Some((1.0, 1.0))));
    /// ```
    pub fn of(runs: &[Squares], config: &HoldoutConfig) -> Self {
        let runs: Vec<&Squares> = runs.iter().filter(|r| r.weight > 0.0).collect();
        let all = runs.iter().fold(Squares::default(), |sum, r| sum.and(r));
        let root = |sum: f64| if all.weight > 0.0 { (sum / all.weight).sqrt() } else { 0.0 };
        let within = |share: f64| share.clamp(0.0, 1.0);
        Self {
            runs: runs.len(),
            before: root(all.before),
            after: root(all.after),
            floor: root(all.floor),
            removed: all.removed(config).map(within),
            removed_95: all
                .removed(config)
                .and_then(|_| bootstrap(&runs, config, |sum| sum.removed(config)))
                .map(|(low, high)| (within(low), within(high))),
        }
    }

    /// The same where the residuals show nothing but the effects and noise. Then a `multiple` m of what the effects
    /// take off is the gap, and its rest (m - 1)/m of it:
    ///
    /// ```text
    /// removed = 1 - ((m - 1)/m)²
    /// ```
    ///
    /// What is left beside that is the floor, which the noise between two readings may have taken for too low. Nothing
    /// changes where the multiple may be none.
    pub fn beside_noise_alone(self, multiple: Option<Multiple>) -> Self {
        let of = |multiple: f64| 1.0 - ((multiple - 1.0) / multiple).powi(2);
        let Some((value, (low, high))) = multiple.filter(|(_, (low, _))| self.removed.is_some() && *low > 0.0) else {
            return self;
        };
        let removed = of(value).max(0.0);
        let ends = [low, high].map(|end| of(end).max(0.0));
        let most = if (low..=high).contains(&1.0) { 1.0 } else { ends[0].max(ends[1]) };
        let squares = [self.before, self.after].map(|root| root * root);
        let floor = (squares[0] - (squares[0] - squares[1]) / removed).max(0.0).sqrt();
        let floor = if removed > 0.0 { floor.max(self.floor) } else { self.floor };
        Self { removed: Some(removed), removed_95: Some((ends[0].min(ends[1]), most)), floor, ..self }
    }

    /// The repaired model is further off than the believed one, by more than chance rounding.
    pub fn is_worse(&self, config: &HoldoutConfig) -> bool {
        self.after > config.worse * self.before
    }
}

/// A factor with the ends of its 95 % interval.
pub type Multiple = (f64, (f64, f64));

/// Where the multiple is surely less than what a right name would leave.
pub fn is_denied(multiple: &Multiple, config: &HoldoutConfig) -> bool {
    multiple.1.1 < config.denied
}

/// How many times as much as the repaired model takes off the errors have, by least squares, and its 95 % interval.
///
/// ```
/// use rundown_gap::config::HoldoutConfig;
/// use rundown_gap::holdout::share::{Squares, multiple};
///
/// // The model takes off 1 where the error is 2, so half of it.
/// let (multiple, _) = multiple(&[Squares::of(2.0, 1.0, 1.0); 6], &HoldoutConfig::default()).unwrap();
/// assert_eq!(multiple, 2.0);
/// ```
pub fn multiple(runs: &[Squares], config: &HoldoutConfig) -> Option<Multiple> {
    let of = |sum: &Squares| (sum.taken > 0.0).then(|| sum.product / sum.taken);
    let runs: Vec<&Squares> = runs.iter().collect();
    let all = runs.iter().fold(Squares::default(), |sum, r| sum.and(r));
    Some((of(&all)?, bootstrap(&runs, config, of)?))
}

fn bootstrap(runs: &[&Squares], config: &HoldoutConfig, of: impl Fn(&Squares) -> Option<f64>) -> Option<(f64, f64)> {
    if runs.len() < config.least_resampled {
        return None;
    }
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let draw = |_| {
        let drawn = (0..runs.len()).map(|_| runs[rng.random_range(0..runs.len())]);
        of(&drawn.fold(Squares::default(), |sum, r| sum.and(r)))
    };
    let shares = sorted((0..config.resamples).filter_map(draw));
    if (config.resamples - shares.len()) as f64 > config.most_without * config.resamples as f64 {
        return None;
    }
    Some((quantile(&shares, 0.025)?, quantile(&shares, 0.975)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_that_differ_give_a_wide_interval_and_few_runs_none() {
        let runs: Vec<Squares> = (0..12).map(|i| Squares::of(2.0, if i % 2 == 0 { 1.0 } else { 1.8 }, 1.0)).collect();
        let share = Share::of(&runs, &HoldoutConfig::default());
        let (low, high) = share.removed_95.unwrap();
        let removed = share.removed.unwrap();
        assert!(low < removed - 0.1 && removed + 0.1 < high, "{share:?}");
        assert_eq!(Share::of(&runs[..4], &HoldoutConfig::default()).removed_95, None);
        assert!(Share::of(&runs[..4], &HoldoutConfig::default()).removed.is_some());
    }

    #[test]
    fn where_there_was_no_gap_nothing_is_removed() {
        let share = Share::of(&[Squares::of(1.0, 1.5, 1.0); 6], &HoldoutConfig::default());
        assert_eq!((share.removed, share.removed_95), (None, None));
    }

    /// Errors of 1 either way that the floor knows nothing of, beside a gap of which so much is taken off.
    fn beside_noise(gap: f64, taken: f64) -> Share {
        let config = HoldoutConfig::default();
        let of = |sign: f64| Squares::of(gap + sign, gap + sign - taken, 0.01);
        let runs: Vec<Squares> = (0..12).map(|_| of(1.0).and(&of(-1.0))).collect();
        let share = Share::of(&runs, &config);
        assert!(share.removed.unwrap() < 0.85 * (1.0 - (1.0 - taken / gap).powi(2)), "{share:?}");
        share.beside_noise_alone(multiple(&runs, &config))
    }

    #[test]
    fn noise_that_the_floor_does_not_know_is_no_gap() {
        for (taken, removed) in [(2.0, 1.0), (1.0, 0.75), (2.5, 0.9375)] {
            let share = beside_noise(2.0, taken);
            assert!((share.removed.unwrap() - removed).abs() < 1e-9, "{share:?}");
            assert!((share.floor - 1.0).abs() < 1e-9, "{share:?}");
        }
    }
}
