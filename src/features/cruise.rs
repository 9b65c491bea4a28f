//! Cruise speed of a run, section 3.3: median of the speeds at the highest speed level that was held.
//!
//! In: stretches of time in which the speed was held, as straight lines of speed over time. Out: median, mean, standard
//! deviation.
//!
//! - Held means: cruising, or coasting and re-accelerating in turns without changing the speed by more than
//!   `cruise_cycle_kmh` (section 4.2 shows both techniques). A final coast or an acceleration changes it by more.
//! - The level: from the fastest held speed down over `cruise_band_kmh`. So 40 km/h held in a station zone does not
//!   count when 140 km/h is held later, for however short a time; but less than a tenth of the held time is no level
//!   (one sample at the end of an acceleration).
//!
//! Memory is fixed: a histogram of time with bins of 0.5 km/h up to 360 km/h, each centred on a whole or half km/h (so
//! that readings in whole km/h fall on centres); the median is interpolated inside its bin. Times are kept in whole ms.
//! `count` is seconds.

use super::Statistic;
use super::statistic::WeightedMoments;
use crate::Real;
use crate::extremes::Extremes;
use crate::model::pieces::whole;
use crate::model::units::KmPerHour;
use crate::plain::{Bytes, Plain};
use crate::tick::snapshot::InPlace;

const BINS: usize = 721;
const BINS_PER_KMH: Real = 2.0;

/// Histogram of the held speeds.
#[derive(Clone, Debug)]
pub(super) struct HeldSpeeds {
    time_ms: [u32; BINS],
}

impl Plain for HeldSpeeds {
    const START: Self = Self { time_ms: [0; BINS] };

    fn pass(&mut self, bytes: &mut Bytes<'_>) {
        bytes.counts(&mut self.time_ms);
    }
}

impl InPlace for HeldSpeeds {
    const ZEROED: Self = Self::START;

    fn clear_fields(&mut self) {
        self.time_ms.fill(0);
    }
}

impl HeldSpeeds {
    /// Adds a stretch in which the speed went from one value to the other in a straight line.
    pub(super) fn add(&mut self, from_mps: Real, to_mps: Real, dt_s: Real) {
        // In bins; bin i reaches from i to i + 1.
        let bin = |mps: Real| (mps * 3.6 * BINS_PER_KMH + 0.5).clamp(0.0, BINS as Real - 0.5);
        let (a, b) = (bin(from_mps), bin(to_mps));
        let (low, high) = (a.at_most(b), a.at_least(b));
        let (first, last) = (whole(low) as usize, whole(high) as usize);
        let dt_ms = dt_s * 1000.0;
        for (i, time_ms) in self.time_ms.iter_mut().enumerate().take(last + 1).skip(first) {
            let left = low.at_least(i as Real);
            let right = high.at_most(i as Real + 1.0);
            let share = if high - low > 1e-6 { (right - left) / (high - low) } else { 1.0 };
            *time_ms = time_ms.saturating_add(whole(dt_ms * share + 0.5));
            if share == 1.0 {
                return;
            }
        }
    }

    /// Bins of the highest level, none when no speed was held.
    fn level(&self, band_kmh: Real) -> Option<&[u32]> {
        let width = whole(band_kmh * BINS_PER_KMH) as usize + 1;
        let total: u64 = sum(&self.time_ms);
        if total == 0 {
            return None;
        }
        // The time in the band below `top`, kept up to date from one top to the next.
        let mut band = sum(self.time_ms.get(BINS.saturating_sub(width)..)?);
        let mut top = BINS - 1;
        while 10 * band < total {
            band -= u64::from(*self.time_ms.get(top)?);
            let lowest = top.checked_sub(width);
            band += u64::from(lowest.and_then(|i| self.time_ms.get(i)).copied().unwrap_or(0));
            top = top.checked_sub(1)?;
        }
        // The band may have caught the level with its lower end only: put its upper end on the fastest speed in it.
        let to_top = self.time_ms.get(..=top)?;
        let fastest = to_top.iter().rposition(|time_ms| *time_ms != 0)?;
        to_top.get(..=fastest)
    }

    /// Median and statistic of the level, m/s.
    pub(super) fn cruise_speed(&self, band_kmh: Real) -> Option<(Real, Statistic)> {
        let to_top = self.level(band_kmh)?;
        let width = whole(band_kmh * BINS_PER_KMH) as usize + 1;
        let below = to_top.len().saturating_sub(width);
        let centre_mps = |bin: Real| KmPerHour(bin / BINS_PER_KMH).to_mps();
        let total = sum(to_top.get(below..)?) as Real;
        let (mut passed, mut median) = (0.0, None);
        let mut moments = WeightedMoments::ZEROED;
        for (i, time_ms) in to_top.iter().enumerate().skip(below) {
            if *time_ms == 0 {
                continue;
            }
            let time_ms = Real::from(*time_ms);
            if median.is_none() && passed + time_ms >= 0.5 * total {
                let inside = (0.5 * total - passed) / time_ms;
                median = Some(centre_mps(i as Real + inside - 0.5));
            }
            passed += time_ms;
            moments.add(centre_mps(i as Real), time_ms);
        }
        let statistic = Statistic { count: whole(total / 1000.0), mean: moments.mean(), sd: moments.sd(1.0) };
        Some((median?, statistic))
    }
}

fn sum(bins: &[u32]) -> u64 {
    bins.iter().map(|time_ms| u64::from(*time_ms)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn median_kmh(held: &[(Real, Real, Real)]) -> Option<Real> {
        let mut speeds = HeldSpeeds::ZEROED;
        for &(from_kmh, to_kmh, dt_s) in held {
            speeds.add(from_kmh / 3.6, to_kmh / 3.6, dt_s);
        }
        speeds.cruise_speed(10.0).map(|(median_mps, _)| median_mps * 3.6)
    }

    #[test]
    fn whole_kmh_are_given_back() {
        assert!((median_kmh(&[(136.0, 136.0, 300.0)]).unwrap() - 136.0).abs() < 1e-9);
        assert_eq!(median_kmh(&[]), None);
        assert!((median_kmh(&[(500.0, 500.0, 10.0)]).unwrap() - 360.0).abs() < 0.5);
        assert!((median_kmh(&[(0.0, 0.0, 10.0)]).unwrap()).abs() < 0.26);
    }

    #[test]
    fn the_highest_level_counts() {
        let zone_then_line = [(40.0, 41.0, 200.0), (138.0, 138.0, 60.0)];
        assert!((median_kmh(&zone_then_line).unwrap() - 138.0).abs() < 0.01);
        // One sample at the top of an acceleration is no level.
        let sample = [(100.0, 100.0, 300.0), (129.0, 130.0, 10.0)];
        assert!((median_kmh(&sample).unwrap() - 100.0).abs() < 0.01);
    }

    #[test]
    fn cycles_about_a_speed_have_it_as_median() {
        let cycles = [(133.0, 139.0, 40.0), (139.0, 133.0, 100.0), (133.0, 139.0, 40.0), (139.0, 133.0, 100.0)];
        assert!((median_kmh(&cycles).unwrap() - 136.0).abs() < 0.1);
        let mut speeds = HeldSpeeds::ZEROED;
        speeds.add(133.0 / 3.6, 139.0 / 3.6, 120.0);
        let (_, statistic) = speeds.cruise_speed(10.0).unwrap();
        assert!((statistic.mean * 3.6 - 136.0).abs() < 0.05);
        assert!((statistic.sd * 3.6 - 6.0 / libm::sqrt(12.0)).abs() < 0.1); // of a uniform distribution
        assert!((119..=121).contains(&statistic.count));
    }
}
