//! Rows that an exporter put between those of the recorder, on straight lines.
//!
//! In: rows of a run. Out: the rows of the recorder alone, each with the mean of the efforts since the last one.
//!
//! ```text
//! k_i = |x_(i+1) - 2 x_i + x_(i-1)|     of locations at even times: 0 between two readings, but for the digits that are written
//! ```
//!
//! Where nearly all that is left of k lies at every n-th row, the rows between are no readings: they double nothing but
//! the confidence, and make steps of the acceleration where the train has none.

use crate::figure::Figure;
use crate::finding::{Done, Finding, Kind};
use crate::rows::times::usual_step_s;
use rundown_files::sample::Sample;
use rundown_files::statistics::{mean_of, median};

/// Rows of the recorder are looked for at every second row to every 60th.
const MOST_ROWS: i64 = 60;
/// A bend that is so many times the usual one, and the smallest one that can be written, is more than digits.
const BEND: f64 = 2.2;
/// Less is digits in any case, m.
const LEAST_BEND_M: f64 = 1e-6;
/// Such a share of the bends is at these rows ...
const AT_READINGS: f64 = 0.9;
/// ... so many of them have one ...
const LEAST_BENDS: usize = 20;
/// ... and such a share: a train that holds its speed has none there.
const LEAST_SHARE: f64 = 0.3;

/// A bend of the way, m, and the number of its row.
struct Bend {
    at: i64,
    metres: f64,
}

/// Leaves out the rows between readings.
pub(crate) fn leave_out(rows: &mut Vec<Sample>, findings: &mut Vec<Finding>) {
    let step_s = usual_step_s(rows);
    let Some(first_s) = rows.first().map(|row| row.time_s) else { return };
    let number = |row: &Sample| ((row.time_s - first_s) / step_s).round() as i64;
    let Some((each, phase)) = readings(&bends(rows, step_s, number)) else { return };
    let is_reading = |row: &Sample| number(row).rem_euclid(each) == phase;
    let before = rows.len();
    let line = rows.iter().find(|row| !is_reading(row)).map_or(0, |row| row.line);
    let mut efforts: Vec<Option<f64>> = Vec::new();
    rows.retain_mut(|row| {
        efforts.push(row.effort_n_per_kg);
        let is_kept = is_reading(row);
        if is_kept {
            let known: Option<Vec<f64>> = efforts.drain(..).collect();
            row.effort_n_per_kg = known.map(mean_of);
        }
        is_kept
    });
    let figure = Figure { value: each as f64 * step_s, sd: 0.0 };
    let (kind, done, count) = (Kind::Interpolated, Done::LeftOut, before - rows.len());
    findings.push(Finding { kind, figure, unit: "s", count, line, done });
}

fn bends(rows: &[Sample], step_s: f64, number: impl Fn(&Sample) -> i64) -> Vec<Bend> {
    let of = |three: &[Sample]| {
        let [a, b, c] = [three[0], three[1], three[2]];
        let is_even = |a: &Sample, b: &Sample| ((b.time_s - a.time_s) / step_s - 1.0).abs() < 1e-3;
        let metres = (c.location_m? - 2.0 * b.location_m? + a.location_m?).abs();
        // A standing train shows nothing, but where it starts.
        let moves = a.location_m != c.location_m;
        (is_even(&a, &b) && is_even(&b, &c) && moves).then(|| Bend { at: number(&b), metres })
    };
    rows.windows(3).filter_map(of).collect()
}

/// Every how many rows there is a reading, and the first of them; none where all are.
fn readings(bends: &[Bend]) -> Option<(i64, i64)> {
    if bends.len() < LEAST_BENDS {
        return None;
    }
    let metres = || bends.iter().map(|bend| bend.metres);
    let written_m = metres().filter(|metres| *metres > LEAST_BEND_M).min_by(f64::total_cmp).unwrap_or(LEAST_BEND_M);
    let usual_m = median(metres())?;
    let digits_m = BEND * usual_m.max(written_m);
    let bent: Vec<Bend> = bends
        .iter()
        .filter(|bend| bend.metres > digits_m)
        .map(|bend| Bend { metres: bend.metres - digits_m, ..*bend })
        .collect();
    let all: f64 = bent.iter().map(|bend| bend.metres).sum();
    // The largest bend is at a reading.
    let largest = bent.iter().max_by(|a, b| a.metres.total_cmp(&b.metres))?;
    let is_each = |each: &i64| {
        let is_there = |bend: &&Bend| (bend.at - largest.at) % each == 0;
        let (mut count, mut there) = (0, 0.0);
        for bend in bent.iter().filter(is_there) {
            (count, there) = (count + 1, there + bend.metres);
        }
        count >= LEAST_BENDS
            && there / all >= AT_READINGS
            && count as f64 >= LEAST_SHARE * bends.iter().filter(is_there).count() as f64
    };
    let each = (2..=MOST_ROWS).rev().find(is_each)?;
    Some((each, largest.at.rem_euclid(each)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// Every second a train that powers, holds its speed, coasts and brakes, as a recorder with so much noise writes
    /// it.
    fn log(seed: u64, noise_m: f64) -> Vec<Sample> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let (mut at_m, mut mps) = (0.0, 0.0_f64);
        let row = |i: u32| {
            let effort = match i % 400 {
                0..70 => 0.5,
                70..200 => 0.02,
                200..330 => 0.0,
                _ => -0.5,
            };
            mps = (mps + effort - 0.01 - 2e-5 * mps * mps).max(0.0);
            at_m += mps;
            let read_m: f64 = at_m + random.random_range(-noise_m..=noise_m);
            Sample {
                line: u64::from(i) + 2,
                time_s: f64::from(i),
                location_m: Some((10.0 * read_m).round() / 10.0),
                speed_mps: Some(mps),
                effort_n_per_kg: Some(effort),
                ..Sample::default()
            }
        };
        (0..2400).map(row).collect()
    }

    /// What an exporter makes of every `each`-th row.
    fn between(rows: &[Sample], each: usize) -> Vec<Sample> {
        let of = |i: usize| {
            let (from, share) = (i - i % each, (i % each) as f64 / each as f64);
            let to = rows.get(from + each).unwrap_or(&rows[from]);
            let at_m = rows[from].location_m.unwrap() * (1.0 - share) + to.location_m.unwrap() * share;
            let mps = rows[from].speed_mps.unwrap() * (1.0 - share) + to.speed_mps.unwrap() * share;
            Sample { location_m: Some((10.0 * at_m).round() / 10.0), speed_mps: Some(mps), ..rows[i] }
        };
        (0..rows.len()).map(of).collect()
    }

    #[test]
    fn rows_between_readings_are_left_out_and_readings_are_not() {
        for (seed, noise_m) in (0..20).flat_map(|seed| [0.0, 0.3, 4.0].map(|noise_m| (seed, noise_m))) {
            let own = log(seed, noise_m);
            for each in [2, 5, 10] {
                let (mut rows, mut findings) = (between(&own, each), Vec::new());
                leave_out(&mut rows, &mut findings);
                assert_eq!(findings.len(), 1, "{seed}, {noise_m} m, every {each} s");
                assert_eq!((findings[0].figure.value, findings[0].line), (each as f64, 3), "{seed}, {noise_m} m");
                assert_eq!(rows.len(), own.len().div_ceil(each));
                let kept = &rows[40];
                assert_eq!(kept.location_m, own[40 * each].location_m);
                let efforts = own[39 * each + 1..=40 * each].iter().filter_map(|row| row.effort_n_per_kg);
                assert!((kept.effort_n_per_kg.unwrap() - efforts.sum::<f64>() / each as f64).abs() < 1e-12);
            }
            let (mut rows, mut findings) = (own.clone(), Vec::new());
            leave_out(&mut rows, &mut findings);
            assert_eq!((rows.len(), findings.len()), (own.len(), 0), "{seed}, {noise_m} m");
        }
    }

    /// A receiver that is asked more often than it knows repeats its location, and odometers count whole metres: no row
    /// is between two readings.
    #[test]
    fn locations_that_are_repeated_or_whole_metres_are_readings() {
        for seed in 0..20 {
            let own = log(seed, 0.3);
            let repeated = (0..own.len()).map(|i| Sample { location_m: own[i - i % 5].location_m, ..own[i] });
            let whole = own.iter().map(|row| Sample { location_m: row.location_m.map(f64::round), ..*row });
            let tens = own.iter().map(|row| {
                let read_m = |m: f64| 10.0 * (m / 10.0).floor();
                Sample { location_m: row.location_m.map(read_m), ..*row }
            });
            for mut rows in [repeated.collect::<Vec<_>>(), whole.collect(), tens.collect()] {
                let mut findings = Vec::new();
                leave_out(&mut rows, &mut findings);
                assert_eq!((rows.len(), findings.len()), (own.len(), 0), "{seed}");
            }
        }
    }
}
