//! `parameters.csv`: what is known of the vehicle after each run, what this run's train was, and how often each cause occurred.

use rundown::model::{state::resistance_sd, units::KmPerHour};
use rundown::{filter::gaussian::Gaussian, model::direction::Direction};
use rundown_files::replay::ReplayedRun;
use rundown_files::table::{Cell, Record};

/// The names of the three Davis coefficients, N/kg, N/(kg m/s), N/(kg (m/s)²).
const COEFFICIENTS: [&str; 3] = ["r0", "r1", "r2"];

/// Speeds at which it is said what a run taught, km/h.
const TAUGHT_KMH: [f64; 4] = [20.0, 60.0, 100.0, 140.0];

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
    record.extend(foresight(run));
    record.extend(counters(run));
    record
}

/// Whether the vehicle's resistance would be published, how its coasts were foreseen, and what this run taught about r at some speeds.
pub fn foresight(run: &ReplayedRun) -> Record {
    let foresight = &run.summary.foresight;
    let coasts = foresight.trust.coasts;
    let kmh = |squares_mps: f64| Cell::from((coasts > 0.0).then(|| 3.6 * (squares_mps / coasts).sqrt()));
    let mut record = vec![
        ("published".to_owned(), Cell::from(run.learned.as_str())),
        ("coasts".to_owned(), Cell::from(coasts)),
        ("coast_error_kmh".to_owned(), kmh(foresight.learned_mps)),
        ("coast_error_described_kmh".to_owned(), kmh(foresight.described_mps)),
        ("coast_scatter".to_owned(), Cell::from(run.trust.inflation().sqrt())),
    ];
    let sd = |davis: &Gaussian<3>, speed_kmh: f64| resistance_sd(davis, KmPerHour(speed_kmh).to_mps());
    record.extend(TAUGHT_KMH.map(|speed_kmh| {
        let ratio = sd(&run.vehicle_before, speed_kmh) / sd(&run.vehicle_after, speed_kmh);
        let bits = ratio.is_finite().then(|| ratio.log2());
        (format!("bits_{speed_kmh}_kmh"), Cell::from(bits))
    }));
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
