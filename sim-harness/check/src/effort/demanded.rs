//! An effort column that holds what the lever asks for, not what acts: above the speed at which the power limits a
//! train, it asks for more than there is.
//!
//! In: rows of all runs of a unit, put right, and the line with the train as described. Out: the share of its efforts
//! that the motion of the fast train needs, over that of the slow one.
//!
//! ```text
//! ratio = (Δv/Δt + g + r) / e          where e is large and steady; r as described
//! ```
//!
//! A column in another unit, another mass or a wheel put the same factor into both. An r that is taken too small puts
//! the fast train's ratio too low: so half of r more must not explain it.

use crate::SURE;
use crate::effort::stretches;
use crate::figure::Figure;
use rundown::model::line::Line;
use rundown_files::sample::Sample;
use rundown_files::statistics::{extremes, mean_of, median, sd_of_median, spread, upper_quantile};

/// Windows are at least so long, s.
const WINDOW_S: f64 = 10.0;
/// Efforts of this share of the largest are large; that is the one that a tenth of all exceed.
const LARGE: f64 = 0.4;
const LARGEST: f64 = 0.9;
/// An effort that changes by less than this share of it within a window is steady: its age does not matter.
const STEADY: f64 = 0.2;
/// A slower train starts, m/s.
const MOVES_MPS: f64 = 2.0;
/// So many windows of the slow and of the fast train.
const LEAST_WINDOWS: usize = 20;
/// The fast train is so many times as fast as the slow one, or the power limits both.
const FASTER: f64 = 1.4;
/// r may be so many times the described one.
const MOST_R: f64 = 1.5;
/// A larger share is what readings leave. Judgement: true columns have 1 and more, for r is not as large as it may be.
const MOST_SHARE: f64 = 0.92;

/// One window of a train under power.
pub(crate) struct Powered {
    mps: f64,
    /// Its effort, N/kg.
    pub(crate) effort: f64,
    /// Δv/Δt + g, and r as described, N/kg.
    pub(crate) gained: f64,
    pub(crate) resistance: f64,
}

/// Share of its efforts that the motion of the fast train needs, over that of the slow one, where it is surely less
/// than all: a unit with its runs, each with its line.
pub(crate) fn share<'a>(runs: impl Iterator<Item = (&'a [Sample], Line<'a>)>) -> Option<Figure> {
    let mut windows: Vec<Powered> = runs.flat_map(|(rows, line)| powered(rows, &line)).collect();
    let largest = upper_quantile(windows.iter().map(|window| window.effort), LARGEST)?;
    windows.retain(|window| window.effort > LARGE * largest);
    windows.sort_by(|a, b| a.mps.total_cmp(&b.mps));
    let third = windows.len() / 3;
    let (slow, fast) = (&windows[..third], &windows[windows.len() - third..]);
    let middle_mps = |part: &[Powered]| median(part.iter().map(|window| window.mps));
    if third < LEAST_WINDOWS || middle_mps(fast)? < FASTER * middle_mps(slow)? {
        return None;
    }
    let over_slow = |times_r: f64| {
        let (slow, fast) = (ratio(slow, times_r)?, ratio(fast, times_r)?);
        let value = fast.value / slow.value;
        Some(Figure { value, sd: value * (slow.sd / slow.value).hypot(fast.sd / fast.value) })
    };
    let share = over_slow(1.0)?;
    (over_slow(MOST_R)?.value + SURE * share.sd < MOST_SHARE).then_some(share)
}

/// What the motion needs of the efforts, with so many times the described r.
fn ratio(windows: &[Powered], times_r: f64) -> Option<Figure> {
    let of = |window: &Powered| (window.gained + times_r * window.resistance) / window.effort;
    let value = median(windows.iter().map(of)).filter(|value| *value > 0.0)?;
    let scatter = spread(windows.iter().map(|window| of(window) - value));
    Some(Figure { value, sd: sd_of_median(scatter, windows.len()) })
}

/// Windows in which the effort is above zero and steady.
pub(crate) fn powered(rows: &[Sample], line: &Line<'_>) -> Vec<Powered> {
    let of = |rows: &[Sample]| {
        let (first, last) = (rows.first()?, rows.last()?);
        let speeds = [first.speed_mps?, last.speed_mps?];
        let mps = 0.5 * (speeds[0] + speeds[1]);
        let efforts = || rows.iter().filter_map(|row| row.effort_n_per_kg);
        let (low, high) = extremes(efforts());
        let is_steady = low > 0.0 && high - low < STEADY * high && speeds[0].min(speeds[1]) > MOVES_MPS;
        let gradient = mean_of(rows.iter().filter_map(|row| Some(line.gradient_n_per_kg(row.location_m?))));
        let gained = (speeds[1] - speeds[0]) / (last.time_s - first.time_s) + gradient;
        let resistance = line.train.davis().resistance_n_per_kg(mps);
        (is_steady && gained.is_finite()).then(|| Powered { mps, effort: mean_of(efforts()), gained, resistance })
    };
    stretches(rows, WINDOW_S).into_iter().filter_map(of).collect()
}
