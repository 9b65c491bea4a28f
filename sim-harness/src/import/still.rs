//! Where a receiver stands still.
//!
//! In: rows with fixes, and speeds by them. Out: speeds of 0 where the train stands.
//!
//! Fixes of a train that stands wander by some metres, and the size of a slope is never below zero: it seems to go at 2
//! to 5 km/h. But over 20 s they stay within a few metres, where a train at walking pace is out of them.

use super::geo;
use super::stretch::fix;
use rundown_files::sample::Sample;
use rundown_files::statistics::mean;
use std::ops::Range;

/// Fixes within so many metres in every direction, over so long, are of one place: a train that goes on at 3 km/h
/// leaves it. The clock of rows jitters, s.
const PLACE_M: f64 = 16.0;
const STANDS_S: f64 = 20.0;
const JITTER_S: f64 = 0.5;
/// Nor does a train stand for longer than this, s, that goes on by so much all the time, m/s: fixes wander by less.
const CRAWLS_MPS: f64 = 0.25;
const CRAWLS_S: f64 = 60.0;
/// A train that comes to a stop, or leaves, is within it for a few seconds as well: at the ends of a standstill rows
/// faster than this, m/s, within so long, s, are none of it.
const MOVES_MPS: f64 = 0.8;
const MOVES_S: f64 = 8.0;
/// Rows further apart than so many usual steps have a gap between them.
const GAP_STEPS: f64 = 2.5;

/// A receiver that has lost its satellites repeats its last fix; so many rows of it.
const LEAST_FROZEN: usize = 4;
const SAME_M: f64 = 1.0;
/// A train that begins to move is no further off by the next row than at this acceleration, m/s², and so many metres.
const STARTS_MPS2: f64 = 1.4;
const LEAPS_M: f64 = 60.0;

/// The rows, but the first each time, that repeat a fix until it leaps: no train stood there.
pub(super) fn frozen(rows: &[Sample]) -> Vec<usize> {
    let fixes: Vec<(usize, geo::Fix)> = rows.iter().enumerate().filter_map(|(i, row)| Some((i, fix(row)?))).collect();
    let repeats = fixes.chunk_by(|a, b| geo::distance_m(a.1, b.1) < SAME_M);
    let mut end = 0;
    let leaps = repeats.filter(|same| {
        end += same.len();
        let (Some((last, from)), Some((next, to))) = (same.last(), fixes.get(end)) else { return false };
        let seconds = rows[*next].time_s - rows[*last].time_s;
        same.len() >= LEAST_FROZEN && geo::distance_m(*from, *to) > LEAPS_M + 0.5 * STARTS_MPS2 * seconds * seconds
    });
    leaps.flat_map(|same| same[1..].iter().map(|(i, _)| *i)).collect()
}

/// Which of these rows, with a fix and a speed each, are of a train that stands.
pub(super) fn stands(rows: &[Sample], step_s: f64) -> Vec<bool> {
    let mut stands = vec![false; rows.len()];
    for begin in 0..rows.len() {
        let within =
            rows[begin..].iter().take_while(|row| row.time_s < rows[begin].time_s + STANDS_S - JITTER_S).count();
        // With the row behind it no window is shorter, whatever the step.
        let end = (begin + within + 1).min(rows.len());
        let window = &rows[begin..end];
        let long_s = window[window.len() - 1].time_s - window[0].time_s;
        let has_gap = window.windows(2).any(|pair| pair[1].time_s - pair[0].time_s > GAP_STEPS * step_s);
        if long_s > STANDS_S - JITTER_S && window.len() > 2 && !has_gap && is_one_place(window) {
            stands[begin..end].fill(true);
        }
    }
    let moving = |rows: &mut dyn Iterator<Item = &Sample>, from_s: f64| {
        let near = rows.take_while(|row| (row.time_s - from_s).abs() <= MOVES_S);
        near.take_while(|row| row.speed_mps.is_none_or(|mps| mps > MOVES_MPS)).count()
    };
    for Range { start, end } in standstills(&stands) {
        let still = &rows[start..end];
        let first = moving(&mut still.iter(), still[0].time_s);
        let last = moving(&mut still.iter().rev(), still[still.len() - 1].time_s);
        // Before the first row and after the last one nothing comes or leaves.
        if start > 0 {
            stands[start..start + first].fill(false);
        }
        if end < rows.len() {
            stands[end - last..end].fill(false);
        }
    }
    without_crawls(rows, &mut stands);
    stands
}

/// Fixes that all lie in a square of this size, whichever way it is turned.
fn is_one_place(rows: &[Sample]) -> bool {
    let Some(from) = rows.first().and_then(fix) else { return false };
    let [mut low, mut high] = [[0.0_f64; 4]; 2];
    for row in rows {
        let Some(to) = fix(row) else { return false };
        let (north, east) = geo::offset_m(from, to);
        let diagonal = std::f64::consts::FRAC_1_SQRT_2;
        let along = [north, east, diagonal * (north + east), diagonal * (north - east)];
        low = [0, 1, 2, 3].map(|i| low[i].min(along[i]));
        high = [0, 1, 2, 3].map(|i| high[i].max(along[i]));
    }
    (0..4).all(|i| high[i] - low[i] <= PLACE_M)
}

/// Takes back what goes on, slowly: the mean fix of its last seconds is elsewhere than that of its first.
fn without_crawls(rows: &[Sample], stands: &mut [bool]) {
    for range in standstills(stands) {
        let still = &rows[range.clone()];
        let [first_s, last_s] = [still[0].time_s, still[still.len() - 1].time_s];
        let third_s = (last_s - first_s) / 3.0;
        let first = mean_fix(still.iter().take_while(|row| row.time_s <= first_s + third_s));
        let last = mean_fix(still.iter().rev().take_while(|row| row.time_s >= last_s - third_s));
        let gone_m = first.zip(last).map_or(0.0, |(first, last)| geo::distance_m(first, last));
        // Between the middles of the thirds.
        if 3.0 * third_s > CRAWLS_S && gone_m > CRAWLS_MPS * 2.0 * third_s {
            stands[range].fill(false);
        }
    }
}

/// The rows of each standstill.
fn standstills(stands: &[bool]) -> Vec<Range<usize>> {
    let mut end = 0;
    let alike = stands.chunk_by(|a, b| a == b).map(|rows| {
        end += rows.len();
        (rows[0], end - rows.len()..end)
    });
    alike.filter(|(stands, _)| *stands).map(|(_, range)| range).collect()
}

fn mean_fix<'a>(rows: impl Iterator<Item = &'a Sample>) -> Option<geo::Fix> {
    let fixes: Vec<geo::Fix> = rows.filter_map(fix).collect();
    Some((mean(fixes.iter().map(|fix| fix.0))?, mean(fixes.iter().map(|fix| fix.1))?))
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

    /// A receiver in a tunnel for 40 s, and a train that stands as long before a receiver without noise.
    #[test]
    fn a_fix_that_is_repeated_until_it_leaps_is_that_of_no_standstill() {
        let fixes = |north_m: &dyn Fn(f64) -> f64| -> Vec<Sample> {
            let row = |second: u32| {
                let place = geo::moved((51.0, 5.0), (north_m(f64::from(second)), 0.0));
                let (latitude_deg, longitude_deg) = (Some(place.0), Some(place.1));
                Sample { time_s: f64::from(second), latitude_deg, longitude_deg, ..Sample::default() }
            };
            (0..120).map(row).collect()
        };
        let in_tunnel = |t: f64| if (40.0..80.0).contains(&t) { 30.0 * 40.0 } else { 30.0 * t };
        assert_eq!(frozen(&fixes(&in_tunnel)), (41..80).collect::<Vec<_>>());
        let stands = |t: f64| if t < 80.0 { 0.0 } else { 0.5 * (t - 80.0).powi(2) };
        assert_eq!(frozen(&fixes(&stands)), Vec::<usize>::new());
    }

    #[test]
    fn nothing_stands_that_goes_on() {
        for seed in 0..10 {
            let (mut rows, _): (Vec<_>, Vec<_>) = fixes(0.0, f64::from(seed)).into_iter().unzip();
            assert_eq!(stands(&rows, 1.0).iter().filter(|stands| **stands).count(), 0, "{seed}");
            // At 4 km/h to the north and to the north-east, and at 1.5 km/h for minutes.
            for (north, east) in [(1.1, 0.0), (0.78, 0.78), (0.3, 0.3)] {
                for (second, row) in rows.iter_mut().enumerate() {
                    let gone_s = second as f64;
                    let (latitude, longitude) = geo::moved((51.0, 5.0), (north * gone_s, east * gone_s));
                    (row.latitude_deg, row.longitude_deg) = (Some(latitude), Some(longitude));
                    row.speed_mps = Some(f64::hypot(north, east));
                }
                assert!(stands(&rows, 1.0).iter().all(|stands| !stands), "{seed} {north} {east}");
                // Rows further apart.
                let rows: Vec<Sample> = rows.iter().copied().step_by(7).collect();
                assert!(stands(&rows, 7.0).iter().all(|stands| !stands), "{seed} {north} {east}");
            }
        }
    }
}
