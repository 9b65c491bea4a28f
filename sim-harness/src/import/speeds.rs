//! The speed at each row, where it is not read in each: location and speed may have rows of their own.
//!
//! Straight between readings, and as the nearest one before the first and behind the last.

use rundown_check::rows::times::MOST_MEAN_S;
use rundown_files::sample::Sample;
use rundown_files::statistics::span;

/// A train that is slower stands, m/s, as long as no location is further off, m.
pub const STANDS_MPS: f64 = 0.3;
const STAYS_M: f64 = 60.0;
/// A location further away than so many rows is none of this place.
const SEARCHED: usize = 1000;
/// No train runs faster, m/s.
pub const FASTEST_MPS: f64 = 140.0;

/// Row by row.
pub fn at_rows(rows: &[Sample]) -> Vec<Option<f64>> {
    let mut speeds: Vec<Option<f64>> = rows.iter().map(|row| row.speed_mps).collect();
    let read: Vec<(usize, f64)> = rows.iter().enumerate().filter_map(|(i, row)| Some((i, row.speed_mps?))).collect();
    let (Some(first), Some(last)) = (read.first(), read.last()) else { return speeds };
    for pair in read.windows(2) {
        let [(a, a_mps), (b, b_mps)] = [pair[0], pair[1]];
        let long_s = rows[b].time_s - rows[a].time_s;
        let is_near = (f64::MIN_POSITIVE..=MOST_MEAN_S).contains(&long_s);
        if is_near || long_s > 0.0 && a_mps.max(b_mps) < STANDS_MPS && stays(rows, [a, b]) {
            for i in a + 1..b {
                let share = ((rows[i].time_s - rows[a].time_s) / long_s).clamp(0.0, 1.0);
                speeds[i] = Some(a_mps + share * (b_mps - a_mps));
            }
        }
    }
    for (nearest, beyond) in [(first, 0..first.0), (last, last.0 + 1..rows.len())] {
        for i in beyond {
            let away_s = (rows[i].time_s - rows[nearest.0].time_s).abs();
            speeds[i] = (away_s <= MOST_MEAN_S).then_some(nearest.1);
        }
    }
    speeds
}

/// No location from before row `a` to behind row `b` is elsewhere.
fn stays(rows: &[Sample], [a, b]: [usize; 2]) -> bool {
    let is_located = |row: &Sample| row.location_m.is_some();
    let from = rows[..=a].iter().rev().take(SEARCHED).position(is_located).map_or(a, |before| a - before);
    let to = rows[b..].iter().take(SEARCHED).position(is_located).map_or(b, |behind| b + behind);
    (0.0..STAYS_M).contains(&span(rows[from..=to].iter().filter_map(|row| row.location_m)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_speed_is_straight_between_readings_that_are_near_and_unknown_between_others() {
        let row = |(time_s, speed_mps): (f64, Option<f64>)| Sample { time_s, speed_mps, ..Sample::default() };
        let read = [(0.0, None), (2.0, Some(10.0)), (3.0, None), (6.0, Some(14.0)), (20.0, None), (40.0, Some(1.0))];
        let rows: Vec<Sample> = read.into_iter().map(row).collect();
        assert_eq!(at_rows(&rows), [Some(10.0), Some(10.0), Some(11.0), Some(14.0), None, Some(1.0)]);
        assert_eq!(at_rows(&rows[..1]), [None]);
    }
}
