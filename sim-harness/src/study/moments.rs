//! Running statistics of many values in a few numbers: the study never holds all samples of all runs.

use serde::Serialize;

/// Count, mean, spread, skewness, least and largest of the values added so far.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Moments {
    pub count: u64,
    pub least: f64,
    pub largest: f64,
    mean: f64,
    squares: f64,
    cubes: f64,
}

impl Default for Moments {
    fn default() -> Self {
        Self { count: 0, least: f64::INFINITY, largest: f64::NEG_INFINITY, mean: 0.0, squares: 0.0, cubes: 0.0 }
    }
}

impl FromIterator<f64> for Moments {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        let mut moments = Self::default();
        values.into_iter().for_each(|value| moments.add(value));
        moments
    }
}

impl Moments {
    /// Adds a value; one that is not finite is left out.
    pub fn add(&mut self, value: f64) {
        if !value.is_finite() {
            return;
        }
        // Central moments of order 2 and 3, updated one value at a time (Welford; Pébay 2008).
        self.count += 1;
        let n = self.count as f64;
        let delta = value - self.mean;
        let step = delta / n;
        let term = delta * step * (n - 1.0);
        self.mean += step;
        self.cubes += term * step * (n - 2.0) - 3.0 * step * self.squares;
        self.squares += term;
        self.least = self.least.min(value);
        self.largest = self.largest.max(value);
    }

    pub fn mean(&self) -> Option<f64> {
        (self.count > 0).then_some(self.mean)
    }

    /// Standard deviation with n - 1 in the denominator; none with fewer than two values.
    pub fn sd(&self) -> Option<f64> {
        (self.count > 1).then(|| (self.squares.max(0.0) / (self.count - 1) as f64).sqrt())
    }

    /// Third standardised moment; none without spread.
    pub fn skewness(&self) -> Option<f64> {
        let n = self.count as f64;
        let found = n.sqrt() * self.cubes / self.squares.powf(1.5);
        found.is_finite().then_some(found)
    }

    /// Coefficient of variation: standard deviation over mean.
    pub fn variation(&self) -> Option<f64> {
        Some(self.sd()? / self.mean()?).filter(|share| share.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_values_have_these_moments() {
        let moments: Moments = [2.0, 4.0, 4.0, 6.0].into_iter().collect();
        assert_eq!((moments.mean(), moments.skewness()), (Some(4.0), Some(0.0)));
        assert!((moments.sd().unwrap() - (8.0_f64 / 3.0).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn one_value_at_a_time_is_all_at_once() {
        let values: Vec<f64> = (0..200).map(|i| f64::from(i * i % 97).sqrt() + 1e3).collect();
        let moments: Moments = values.iter().copied().chain([f64::NAN]).collect();
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let central = |power: i32| values.iter().map(|v| (v - mean).powi(power)).sum::<f64>();
        assert_eq!(moments.count, 200);
        assert!((moments.mean().unwrap() - mean).abs() < 1e-9);
        assert!((moments.sd().unwrap() - (central(2) / (n - 1.0)).sqrt()).abs() < 1e-9);
        let skewness = n.sqrt() * central(3) / central(2).powf(1.5);
        assert!((moments.skewness().unwrap() - skewness).abs() < 1e-6);
    }

    #[test]
    fn without_values_nothing_is_said() {
        let none = Moments::default();
        assert_eq!((none.mean(), none.sd(), none.variation()), (None, None, None));
        let same: Moments = [3.0, 3.0].into_iter().collect();
        assert_eq!((same.sd(), same.skewness()), (Some(0.0), None));
    }
}
