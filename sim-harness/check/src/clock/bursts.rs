//! Rows that are stamped when they arrive, several at once: recorded evenly, their times are not those of their
//! readings.
//!
//! In: rows of a run. Out: the same, spread evenly over the time between two bursts, where speed and location agree
//! only so.
//!
//! ```text
//! stamps  5.02  5.04  5.06  5.08  5.10      10.01  10.03 ...        recorded at 1, 2, 3, 4, 5      6, 7 ...
//! ```

use crate::figure::Figure;
use crate::finding::{Done, Finding, Kind};
use rundown_files::sample::Sample;
use rundown_files::statistics::{median, upper_quantile};
use std::ops::{Range, RangeInclusive};

/// Rows of one burst are nearer than this share of the mean time between rows, or they are of two.
const NEAR: f64 = 0.3;
/// Fewer bursts are chance, and so many of them have the usual number of rows.
const LEAST_BURSTS: usize = 20;
const ALIKE: f64 = 0.9;
/// Of all rows so many may have the time of the row before.
const MOST_SAME: f64 = 0.05;
/// Between bursts pass such shares of the usual time, in so many of them.
const EVEN: RangeInclusive<f64> = 0.8..=1.25;
/// Nine of ten rows that are spread rightly miss less than this share of their way, and of what they miss as stamped.
const MISSED: f64 = 0.2;
/// Share by which the even times of bursts are drawn to their stamps.
const DRAWN: f64 = 0.02;
/// Slower ones say little, m/s.
const LEAST_MPS: f64 = 5.0;

/// Names the bursts, and spreads their rows where these were recorded evenly.
pub(crate) fn spread(rows: &mut [Sample], findings: &mut Vec<Finding>) {
    let Some((bursts, usual, each_s)) = found(rows) else { return };
    let mut times_s: Vec<f64> = rows.iter().map(|row| row.time_s).collect();
    // Stamps scatter by the way of the rows; where no burst is missing, they have come at even times.
    let mut last_s: Option<f64> = None;
    for burst in &bursts {
        let arrives_s = rows[burst.end - 1].time_s;
        let even_s = last_s.map(|last_s| last_s + each_s).filter(|even_s| (even_s - arrives_s).abs() < NEAR * each_s);
        // Drawn to the stamps slowly, for the clock of a recorder is none of theirs.
        let ends_s = even_s.map_or(arrives_s, |even_s| even_s + DRAWN * (arrives_s - even_s));
        let step_s = each_s / usual as f64;
        for (i, row) in burst.clone().enumerate() {
            times_s[row] = ends_s - (burst.len() - 1 - i) as f64 * step_s;
        }
        last_s = Some(ends_s);
    }
    let stamped: Vec<f64> = rows.iter().map(|row| row.time_s).collect();
    let is_right = times_s.windows(2).all(|pair| pair[1] > pair[0])
        && missed(rows, &times_s)
            .zip(missed(rows, &stamped))
            .is_some_and(|(as_spread, as_stamped)| as_spread < MISSED && as_spread < MISSED * as_stamped);
    let figure = Figure { value: usual as f64, sd: 0.0 };
    let done = if is_right { Done::PutRight } else { Done::Said };
    let (kind, line) = (Kind::Bursts, rows[bursts[0].start].line);
    findings.push(Finding { kind, figure, unit: "rows", count: bursts.len(), line, done });
    if is_right {
        rows.iter_mut().zip(times_s).for_each(|(row, time_s)| row.time_s = time_s);
    }
}

/// The bursts, how many rows they usually have, and the time between two.
fn found(rows: &[Sample]) -> Option<(Vec<Range<usize>>, usize, f64)> {
    let all_s = rows.last()?.time_s - rows.first()?.time_s;
    let near_s = NEAR * all_s / rows.len() as f64;
    let mut bursts = Vec::new();
    let mut from = 0;
    for i in 1..=rows.len() {
        if rows.get(i).is_none_or(|row| row.time_s - rows[i - 1].time_s > near_s) {
            bursts.push(from..i);
            from = i;
        }
    }
    let usual = median(bursts.iter().map(|burst| burst.len() as f64))? as usize;
    let steps_s: Vec<f64> =
        bursts.windows(2).map(|pair| rows[pair[1].end - 1].time_s - rows[pair[0].end - 1].time_s).collect();
    let each_s = median(&steps_s)?;
    let is_usual = |burst: &&Range<usize>| burst.len() == usual;
    let alike = bursts.iter().filter(is_usual).count() as f64 > ALIKE * bursts.len() as f64;
    let even = steps_s.iter().filter(|step_s| EVEN.contains(&(*step_s / each_s))).count() as f64
        > ALIKE * steps_s.len() as f64;
    // Equal times are those of a coarse clock, which is asked elsewhere.
    let same = rows.windows(2).filter(|pair| pair[1].time_s == pair[0].time_s).count();
    let is_fine = (same as f64) < MOST_SAME * rows.len() as f64;
    (is_fine && usual > 1 && bursts.len() >= LEAST_BURSTS && alike && even).then_some((bursts, usual, each_s))
}

/// Share of the way from row to row by which speed and location miss each other with these times, in nine of ten rows
/// by less.
fn missed(rows: &[Sample], times_s: &[f64]) -> Option<f64> {
    let of = |(pair, times_s): (&[Sample], &[f64])| {
        let mps = 0.5 * (pair[0].speed_mps? + pair[1].speed_mps?);
        let way_m = (pair[1].location_m? - pair[0].location_m?).abs();
        (mps > LEAST_MPS && way_m > 0.0).then(|| (way_m - mps * (times_s[1] - times_s[0])).abs() / way_m)
    };
    upper_quantile(rows.windows(2).zip(times_s.windows(2)).filter_map(of), ALIKE)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1000 s of a train, a row a second, five rows of which arrive at once.
    fn log(is_even: bool) -> Vec<Sample> {
        let mut at_m = 0.0;
        let row = |i: u32| {
            let mps = |s: f64| 20.0 - 10.0 * (s / 60.0).cos();
            let of_s = if is_even { f64::from(i) } else { f64::from(i) + if i % 5 > 2 { 2.0 } else { 0.0 } };
            at_m = 20.0 * of_s - 600.0 * (of_s / 60.0).sin();
            let late_s = 0.08 * (f64::from(i / 5) * 1.7).sin().abs();
            let time_s = 5.0 * f64::from(i / 5 + 1) + late_s + 0.02 * f64::from(i % 5);
            Sample { time_s, location_m: Some(at_m), speed_mps: Some(mps(of_s)), ..Sample::default() }
        };
        (0..1000).map(row).collect()
    }

    #[test]
    fn rows_that_arrive_five_at_once_are_spread_where_they_are_even() {
        let (mut rows, mut findings) = (log(true), Vec::new());
        spread(&mut rows, &mut findings);
        assert_eq!((findings[0].kind, findings[0].figure.value, findings[0].count), (Kind::Bursts, 5.0, 200));
        assert_eq!(findings[0].done, Done::PutRight);
        let off_s = rows.windows(2).map(|pair| (pair[1].time_s - pair[0].time_s - 1.0).abs());
        assert!(off_s.fold(0.0, f64::max) < 0.03);
        let (mut rows, mut findings) = (log(false), Vec::new());
        let before = rows.clone();
        spread(&mut rows, &mut findings);
        assert_eq!((findings[0].kind, findings[0].done), (Kind::Bursts, Done::Said));
        assert_eq!(rows, before);
    }

    #[test]
    fn rows_at_even_times_or_twice_in_turn_are_no_bursts() {
        for each in [1, 2] {
            let mut rows = log(true);
            for (i, row) in rows.iter_mut().enumerate() {
                row.time_s = (i + i / each) as f64;
            }
            let mut findings = Vec::new();
            spread(&mut rows, &mut findings);
            assert_eq!(findings, []);
        }
    }
}
