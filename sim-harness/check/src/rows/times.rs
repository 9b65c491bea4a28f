//! The time between rows of a log.

use rundown_files::sample::Sample;
use rundown_files::statistics::median;

/// Over more a train may start or brake between two rows, and runs another way than the mean of both speeds says, s.
pub const MOST_MEAN_S: f64 = 15.0;

/// Usual time between rows, s.
pub fn usual_step_s(rows: &[Sample]) -> f64 {
    usual_s(rows.iter())
}

/// Usual time between rows with a location, s.
pub(crate) fn located_step_s(rows: &[Sample]) -> f64 {
    usual_s(rows.iter().filter(|row| row.location_m.is_some()))
}

fn usual_s<'a>(rows: impl Iterator<Item = &'a Sample> + Clone) -> f64 {
    let steps = rows.clone().skip(1).zip(rows).map(|(next, row)| next.time_s - row.time_s);
    median(steps.filter(|step| *step > 0.0)).unwrap_or(1.0)
}

/// Rows follow each other, none between them missing, where no more passes, s.
pub(crate) fn next_row_s(usual_s: f64) -> f64 {
    1.5 * usual_s
}

/// Rows are missing where more passes between two of them, s.
pub(crate) fn longest_step_s(usual_s: f64) -> f64 {
    (3.5 * usual_s).max(10.0)
}
