//! A value and how surely it is known.

/// Half a 95 % interval in standard deviations: the 97.5 % point of the normal distribution. All intervals have this
/// width.
pub const HALF_95: f64 = 1.96;

/// A value and its standard deviation.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Figure {
    /// The value.
    pub value: f64,
    /// Its standard deviation.
    pub sd: f64,
}

impl Figure {
    /// Bounds of the 95 % interval.
    pub fn interval(&self) -> [f64; 2] {
        [self.value - HALF_95 * self.sd, self.value + HALF_95 * self.sd]
    }

    /// With its 95 % interval, in so many decimals.
    pub fn with_interval(&self, decimals: usize) -> String {
        let [low, high] = self.interval();
        format!("{:.decimals$} [{low:.decimals$}, {high:.decimals$}]", self.value)
    }

    /// So many standard deviations from this value.
    pub fn away_from(&self, value: f64) -> f64 {
        (self.value - value).abs() / self.sd
    }

    /// The mean of what runs say, each by its own noise; they may differ by more, and then it is as sure as they agree.
    /// Nothing of none.
    pub fn mean_of(runs: &[Self]) -> Option<Self> {
        let weight = |one: &Self| one.sd.powi(-2);
        let sum: f64 = runs.iter().map(weight).sum();
        let value = runs.iter().map(|one| weight(one) * one.value).sum::<f64>() / sum;
        let scatter: f64 = runs.iter().map(|one| weight(one) * (one.value - value).powi(2)).sum();
        // Of one run the scatter is what rounding leaves.
        let grown = (scatter / (runs.len() as f64 - 1.0).max(1.0)).max(1.0);
        (!runs.is_empty()).then(|| Self { value, sd: (grown / sum).sqrt() })
    }

    /// The value of one of many, drawn to the usual one by what is known of both. `spread`: standard deviation of many
    /// such figures.
    pub fn drawn(&self, usual: f64, spread: f64) -> f64 {
        let between = (spread * spread - self.sd * self.sd).max(0.0);
        usual + (self.value - usual) * between / (between + self.sd * self.sd).max(f64::MIN_POSITIVE)
    }
}
