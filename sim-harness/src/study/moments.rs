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

/// Of x and y; none without spread.
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
    fn four_values_have_these_moments() {
        let mut moments = Moments::default();
        [2.0, 4.0, 4.0, 6.0].into_iter().for_each(|value| moments.add(value));
        assert_eq!((moments.mean(), moments.skewness()), (Some(4.0), Some(0.0)));
        assert!((moments.sd().unwrap() - (8.0_f64 / 3.0).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn one_value_at_a_time_is_all_at_once() {
        let values: Vec<f64> = (0..200).map(|i| f64::from(i * i % 97).sqrt() + 1e3).collect();
        let mut moments = Moments::default();
        values.iter().for_each(|value| moments.add(*value));
        moments.add(f64::NAN);
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
        let mut same = Moments::default();
        same.add(3.0);
        same.add(3.0);
        assert_eq!((same.sd(), same.skewness()), (Some(0.0), None));
    }
}
