//! `parameters.csv`: what is known of the vehicle after each run, what this run's train was, and how often each cause occurred.

use rundown::{filter::gaussian::Gaussian, model::direction::Direction};
use rundown_files::replay::ReplayedRun;
use rundown_files::table::{Cell, Record};

/// The names of the three Davis coefficients, N/kg, N/(kg m/s), N/(kg (m/s)²).
const COEFFICIENTS: [&str; 3] = ["r0", "r1", "r2"];

pub const fn direction_word(direction: Direction) -> &'static str {
    match direction {
        Direction::Up => "up",
        Direction::Down => "down",
    }
}

/// One row: run, the vehicle after it, the run's own train (`run_*`: wind and load of the day included), rows and counters.
pub fn record(run: &ReplayedRun) -> Record {
    let mut record: Record = vec![("run".to_owned(), Cell::from(run.name.as_str()))];
    record.extend(coefficients("", &run.vehicle_after));
    record.extend(coefficients("run_", &run.summary.run_davis));
    record.push(("unit".to_owned(), Cell::from(run.unit.as_str())));
    record.push(("direction".to_owned(), Cell::from(direction_word(run.direction))));
    record.push(("rows".to_owned(), Cell::from(run.rows)));
    record.push(("steps".to_owned(), Cell::from(run.estimates.len())));
    let learned = run.estimates.iter().filter(|estimate| estimate.learning).count();
    record.push(("learning_steps".to_owned(), Cell::from(learned)));
    record.extend(counters(run));
    record
}

pub fn counters(run: &ReplayedRun) -> Record {
    let counters = &run.summary.counters;
    let dropped = ("time_not_increasing".to_owned(), Cell::from(counters.time_not_increasing));
    let causes = counters.iter().map(|(cause, count)| (cause.as_str().to_owned(), Cell::from(count)));
    std::iter::once(dropped).chain(causes).collect()
}

pub fn coefficients(prefix: &str, davis: &Gaussian<3>) -> Record {
    let means =
        COEFFICIENTS.iter().zip(davis.mean.iter()).map(|(name, mean)| (format!("{prefix}{name}"), Cell::from(*mean)));
    let sds = COEFFICIENTS
        .iter()
        .enumerate()
        .map(|(index, name)| (format!("{prefix}sd_{name}"), Cell::from(davis.sd(index))));
    means.chain(sds).collect()
}
