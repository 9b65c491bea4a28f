//! Where a receiver stands still.
//!
//! In: rows with fixes, and speeds by them. Out: speeds of 0 where the train stands.
//!
//! Fixes of a train that stands wander by some metres, and the size of a slope is never below zero: it seems to go at 2
//! to 5 km/h. But over 20 s they stay within a few metres, where a train at walking pace is out of them.

use super::geo;
use super::stretch::fix;
use rundown_files::sample::Sample;

/// Fixes within so many metres from south to north and from west to east, over so long, are of one place: a train that
/// goes on at 3 km/h leaves it.
const PLACE_M: f64 = 16.0;
const STANDS_S: f64 = 20.0;
/// A train that comes to a stop, or leaves, is within it for a few seconds as well: at the ends of a standstill rows
/// faster than this, m/s, within so long, s, are none of it.
const MOVES_MPS: f64 = 0.8;
const MOVES_S: f64 = 8.0;
/// Rows further apart than so many usual steps have a gap between them.
const GAP_STEPS: f64 = 2.5;

/// Which of these rows, with a fix and a speed each, are of a train that stands.
pub(super) fn stands(rows: &[Sample], step_s: f64) -> Vec<bool> {
    let mut stands = vec![false; rows.len()];
    for begin in 0..rows.len() {
        let end = begin + rows[begin..].iter().take_while(|row| row.time_s <= rows[begin].time_s + STANDS_S).count();
        let window = &rows[begin..end];
        let long_s = window[window.len() - 1].time_s - window[0].time_s;
        let has_gap = window.windows(2).any(|pair| pair[1].time_s - pair[0].time_s > GAP_STEPS * step_s);
        if long_s > STANDS_S - 1.5 * step_s && window.len() > 2 && !has_gap && is_one_place(window) {
            stands[begin..end].fill(true);
        }
    }
    let mut begin = 0;
    while begin < rows.len() {
        let end = begin + stands[begin..].iter().take_while(|stands| **stands).count();
        let moving = |rows: &mut dyn Iterator<Item = &Sample>, from_s: f64| {
            let near = rows.take_while(|row| (row.time_s - from_s).abs() <= MOVES_S);
            near.take_while(|row| row.speed_mps.is_none_or(|mps| mps > MOVES_MPS)).count()
        };
        if begin < end {
            let still = &rows[begin..end];
            let first = moving(&mut still.iter(), still[0].time_s);
            let last = moving(&mut still.iter().rev(), still[still.len() - 1].time_s);
            // Before the first row and after the last one nothing comes or leaves.
            if begin > 0 {
                stands[begin..begin + first].fill(false);
            }
            if end < rows.len() {
                stands[end - last..end].fill(false);
            }
        }
        begin = end.max(begin + 1);
    }
    stands
}

fn is_one_place(rows: &[Sample]) -> bool {
    let Some(from) = rows.first().and_then(fix) else { return false };
    let [mut low, mut high] = [(0.0_f64, 0.0_f64); 2];
    for row in rows {
        let Some(to) = fix(row) else { return false };
        let (north, east) = geo::offset_m(from, to);
        low = (low.0.min(north), low.1.min(east));
        high = (high.0.max(north), high.1.max(east));
    }
    high.0 - low.0 <= PLACE_M && high.1 - low.1 <= PLACE_M
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_train_stands_from_its_first_row_to_its_last() {
        // A speed by a few fixes is a noisy one there.
        let noisy = |(row, _)| Sample { speed_mps: Some(1.5), ..row };
        let rows: Vec<Sample> = fixes(90.0, 1.0).into_iter().skip(45).take(80).map(noisy).collect();
        assert!(stands(&rows, 1.0).iter().all(|stands| *stands));
    }

    /// Comes at a speed, brakes at 0.5 m/s², stands for so long, leaves; fixes wander by 3 m (standard deviation), half
    /// of it from second to second.
    fn fixes(stands_s: f64, seed: f64) -> Vec<(Sample, bool)> {
        let noise = |t: f64, k: f64| 2.1 * (f64::sin(k * t) + f64::sin(0.13 * k * t + seed));
        (0..(160 + stands_s as usize))
            .map(|second| {
                let t = second as f64;
                let (comes, leaves) = ((40.0 - t).max(0.0), (t - 40.0 - stands_s).max(0.0));
                let north = 0.25 * (leaves * leaves - comes * comes);
                let place = geo::moved((51.0, 5.0), (north + noise(t, 1.9), noise(t, 2.3)));
                let speed_mps = Some((0.5 * (comes + leaves)).hypot(0.6));
                let row = Sample { time_s: t, speed_mps, ..Sample::default() };
                let row = Sample { latitude_deg: Some(place.0), longitude_deg: Some(place.1), ..row };
                (row, comes + leaves == 0.0)
            })
            .collect()
    }

    #[test]
    fn a_train_that_stands_is_recognized_within_seconds() {
        for seed in 0..10 {
            let (rows, truth): (Vec<_>, Vec<_>) = fixes(60.0, f64::from(seed)).into_iter().unzip();
            let found = stands(&rows, 1.0);
            let wrong = found.iter().zip(&truth).filter(|(found, truth)| found != truth).count();
            assert!(wrong <= 4, "{seed}: {wrong} rows");
        }
    }

    #[test]
    fn nothing_stands_that_goes_on() {
        for seed in 0..10 {
            let (mut rows, _): (Vec<_>, Vec<_>) = fixes(0.0, f64::from(seed)).into_iter().unzip();
            assert_eq!(stands(&rows, 1.0).iter().filter(|stands| **stands).count(), 0, "{seed}");
            // At 4 km/h.
            for (second, row) in rows.iter_mut().enumerate() {
                let (north, _) = geo::moved((51.0, 5.0), (1.1 * second as f64, 0.0));
                (row.latitude_deg, row.speed_mps) = (Some(north), Some(1.1));
            }
            assert!(stands(&rows, 1.0).iter().all(|stands| !stands), "{seed}");
        }
    }
}
