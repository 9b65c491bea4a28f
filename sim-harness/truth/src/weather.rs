//! Ambient temperature: by season, by hour, by run, and drifting within a run.

use rand::Rng;
use rand_distr::{Distribution, Normal};
use std::f64::consts::PI;

const DAY_S: f64 = 86_400.0;
const YEAR_DAYS: f64 = 365.2425;
/// Warmest day of the year and hour of the day (UTC).
const WARMEST_DAY: f64 = 201.0;
const WARMEST_HOUR: f64 = 14.0;

/// How the temperature is distributed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Climate {
    /// Mean of the year, °C.
    pub mean_c: f64,
    /// Amplitude over the year, °C.
    pub yearly_c: f64,
    /// Amplitude over the day, °C.
    pub daily_c: f64,
    /// Standard deviation between runs on top of season and hour, °C.
    pub run_sd_c: f64,
    /// Standard deviation of the drift within a run, °C/h.
    pub drift_sd_c_per_h: f64,
}

impl Default for Climate {
    /// Near the sea, 52 degrees north.
    fn default() -> Self {
        Self { mean_c: 10.5, yearly_c: 7.5, daily_c: 3.0, run_sd_c: 3.0, drift_sd_c_per_h: 1.5 }
    }
}

/// The temperature of one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weather {
    /// At the start of the log, °C.
    pub start_c: f64,
    /// Drift, °C/h.
    pub drift_c_per_h: f64,
}

impl Climate {
    /// The weather of a run that departs this many seconds after 1970-01-01 UTC.
    pub fn draw(&self, departure_s: i64, rng: &mut impl Rng) -> Weather {
        let unit = Normal::new(0.0, 1.0).expect("constant");
        let days = departure_s as f64 / DAY_S;
        let season = (2.0 * PI * (days - WARMEST_DAY) / YEAR_DAYS).cos();
        let hour = (2.0 * PI * (days - WARMEST_HOUR / 24.0)).cos();
        Weather {
            start_c: self.mean_c + self.yearly_c * season + self.daily_c * hour + self.run_sd_c * unit.sample(rng),
            drift_c_per_h: self.drift_sd_c_per_h * unit.sample(rng),
        }
    }
}

impl Weather {
    /// Temperature so long after the start of the log, °C.
    pub fn temperature_c(&self, time_s: f64) -> f64 {
        self.start_c + self.drift_c_per_h * time_s / 3600.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn july_is_warm_and_january_is_cold() {
        let climate = Climate { run_sd_c: 0.0, drift_sd_c_per_h: 2.0, ..Climate::default() };
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        // 2024-07-20 and 2024-01-20, 14:00 UTC.
        let (summer, winter) = (1_721_484_000, 1_705_759_200);
        let warm = climate.draw(summer, &mut rng);
        let cold = climate.draw(winter, &mut rng);
        assert!((warm.start_c - 21.0).abs() < 0.1, "{warm:?}");
        assert!((cold.start_c - 6.0).abs() < 0.1, "{cold:?}");
        assert!((warm.temperature_c(1800.0) - warm.start_c - warm.drift_c_per_h / 2.0).abs() < 1e-12);
    }
}
