//! What an effort column has for trains that coast.
//!
//! In: rows of all runs of a unit, put right. Out: the small effort that recurs while trains move.
//!
//! Trains that stand show the zero of a column only where nothing but friction holds them; many hold the brake. But a
//! train that coasts has the same effort at any speed, on any slope, in each run, and none that powers, brakes or holds
//! its speed has: means over 20 s of an effort crowd at that value. Noise makes the crowd wider, so it is sought in
//! intervals of growing width. Efforts that hold a speed lie densely as well, but no denser than around them.

use crate::agreement::Figure;
use crate::effort::stretches;
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;
use rundown_files::statistics::spread;

/// Means over so long, s.
const STRETCH_S: f64 = 20.0;
/// A slower train may be about to stand, m/s.
const SLOWEST_MPS: f64 = 1.0;
/// Half the width of the interval, N/kg: an effort without noise, up to a noise by which nothing would be learned.
const HALF_WIDTHS_N_PER_KG: [f64; 5] = [2e-4, 4e-4, 8e-4, 1.6e-3, 3.2e-3];
/// A larger effort is none of a coast, N/kg.
const MOST_N_PER_KG: f64 = 0.02;
/// So many stretches, this share of all of moving trains, in so many runs.
const LEAST: usize = 20;
const LEAST_SHARE: f64 = 0.04;
const LEAST_RUNS: usize = 3;
/// Intervals beside it, in half-widths on either side, in which all together this many times fewer stretches are: a
/// density of 12 times as much. In the densest intervals of simulated trains that hold their speed, whose zero is
/// right, it is 1 to 5 times as much.
const BESIDE: f64 = 5.0;
const DENSER: usize = 3;
/// An effort of 0 is that of some coasts, where so many times fewer are there.
const ZEROS: usize = 10;

/// The effort of trains that coast, N/kg, and in how many stretches; nothing where none recurs.
pub(crate) fn effort_of_coasts<'a>(recordings: impl Iterator<Item = &'a Recording>) -> Option<(Figure, usize)> {
    let mut means: Vec<(f64, usize)> = Vec::new();
    for (run, recording) in recordings.enumerate() {
        let moves = |rows: &&[Sample]| rows.iter().all(|row| row.speed_mps > Some(SLOWEST_MPS));
        let mean = |rows: &[Sample]| {
            let efforts = rows.iter().filter_map(|row| row.effort_n_per_kg);
            (efforts.sum::<f64>() / rows.len() as f64, run)
        };
        means.extend(stretches(&recording.rows, STRETCH_S).into_iter().filter(moves).map(mean));
    }
    means.sort_by(|a, b| a.0.total_cmp(&b.0));
    HALF_WIDTHS_N_PER_KG.into_iter().find_map(|half_width| recurring(&means, half_width))
}

/// The densest of the intervals of small efforts, where it is far denser than what is beside it. `means`: sorted, with
/// the number of the run.
fn recurring(means: &[(f64, usize)], half_width: f64) -> Option<(Figure, usize)> {
    let within = |low: f64, high: f64| {
        let begin = means.partition_point(|(mean, _)| *mean < low);
        begin..means.partition_point(|(mean, _)| *mean <= high)
    };
    let is_small = |(mean, _): &&(f64, usize)| mean.abs() < MOST_N_PER_KG;
    let from = means.iter().filter(is_small).map(|(mean, _)| within(*mean, mean + 2.0 * half_width));
    let densest = from.max_by_key(ExactSizeIterator::len)?;
    let inside = &means[densest];
    let efforts: Vec<f64> = inside.iter().map(|(mean, _)| *mean).collect();
    let count = inside.len();
    // Of rounded efforts the median would be one of few values.
    let value = efforts.iter().sum::<f64>() / count as f64;
    let mut runs: Vec<usize> = inside.iter().map(|(_, run)| *run).collect();
    runs.sort_unstable();
    runs.dedup();
    let is_enough = count >= LEAST && count as f64 >= LEAST_SHARE * means.len() as f64 && runs.len() >= LEAST_RUNS;
    let centre = 0.5 * (efforts[0] + efforts[count - 1]);
    let beside = within(centre - BESIDE * half_width, centre + BESIDE * half_width).len() - count;
    let zeros = within(-half_width, half_width).len();
    let has_zeros = centre.abs() > 2.0 * half_width && ZEROS * zeros > count;
    let sd = spread(efforts.iter().map(|effort| effort - value)) / (count as f64).sqrt();
    (is_enough && count >= DENSER * beside && !has_zeros).then_some((Figure { value, sd }, count))
}
