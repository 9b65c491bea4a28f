//! `parameters.csv`: what is known of the vehicle after each run, what this run's train was, and how often each cause
//! occurred.

use rundown::filter::gaussian::Gaussian;
use rundown::model::state::{SPEED, resistance_sd};
use rundown::model::units::KmPerHour;
use rundown::tick::estimate::{Cause, Counters};
use rundown::tick::foresight::Foresight;
use rundown_files::column::Column;
use rundown_files::replay::ReplayedRun;

/// The three Davis coefficients with their units.
const COEFFICIENTS: [(&str, &str); 3] = [("r0", "N/kg"), ("r1", "N/kg per m/s"), ("r2", "N/kg per (m/s)²")];

/// Speeds at which it is said what a run taught, km/h.
const TAUGHT_KMH: [f64; 4] = [20.0, 60.0, 100.0, 140.0];

/// The columns of the file: run, the vehicle after it, the run's own train (`run_*`: wind and load of the day
/// included), rows and counters.
pub fn columns() -> Vec<Column<ReplayedRun>> {
    let mut columns = vec![run_name()];
    let vehicle = coefficients("", "the vehicle after the run");
    columns.extend(vehicle.into_iter().map(|column| column.of_part(|run: &ReplayedRun| &run.vehicle_after)));
    let of_run = coefficients("run_", "the train of this run alone, with the wind and load of the day");
    columns.extend(of_run.into_iter().map(|column| column.of_part(|run: &ReplayedRun| &run.summary.run_davis)));
    columns.extend([
        unit(),
        direction(),
        Column::count("rows", "rows of the log", |run: &ReplayedRun| run.rows),
        Column::count("steps", "ticks with an estimate", |run: &ReplayedRun| run.estimates.len()),
        Column::count("learning_steps", "ticks from which the resistance was learned", learning_steps),
    ]);
    columns.extend(foresight());
    columns.extend(counters().into_iter().map(|column| column.of_part(|run: &ReplayedRun| &run.summary.counters)));
    columns
}

/// Ticks from which the resistance was learned.
pub(super) fn learning_steps(run: &ReplayedRun) -> usize {
    run.estimates.iter().filter(|estimate| estimate.learning).count()
}

/// Least and largest speed at which the resistance was learned, km/h.
pub(super) fn learned_kmh(run: &ReplayedRun) -> Option<[f64; 2]> {
    let learning = run.estimates.iter().filter(|estimate| estimate.learning);
    let speeds_kmh = learning.map(|estimate| 3.6 * estimate.belief.mean[SPEED]).map(|kmh| [kmh, kmh]);
    speeds_kmh.reduce(|all, one| [all[0].min(one[0]), all[1].max(one[1])])
}

/// Whether the vehicle's resistance would be published, how the run's coasts were foreseen, and what it taught about r
/// at some speeds.
pub(super) fn foresight() -> Vec<Column<ReplayedRun>> {
    let published = "whether the board would publish the vehicle's resistance between runs: `learned`, or why not; `not_yet`, \
                     too, where what it does not compare says otherwise: falls before brakes, or coasts beside efforts";
    let scatter =
        "errors of predicted coasts over what is expected of them, rms over the last tens of runs, at least 1";
    let mut columns = vec![
        Column::text("published", published, |run: &ReplayedRun| run.learned.as_str()),
        Column::count("coasts", "coasts that were predicted", |run: &ReplayedRun| {
            run.summary.foresight.trust.coasts as usize
        }),
        coast_error("coast_error_kmh", "by what had been learned", |foresight| foresight.learned_mps),
        coast_error("coast_error_described_kmh", "by the description", |foresight| foresight.described_mps),
        Column::number("coast_scatter", "1", scatter, |run: &ReplayedRun| run.trust.inflation().sqrt()),
    ];
    columns.extend(TAUGHT_KMH.map(taught));
    columns
}

fn coast_error(name: &str, whose: &str, squares_mps: fn(&Foresight) -> f64) -> Column<ReplayedRun> {
    let meaning = format!("rms error of the speed at the end of a coast, as predicted {whose}");
    Column::number(name, "km/h", &meaning, move |run: &ReplayedRun| {
        let foresight = &run.summary.foresight;
        let coasts = foresight.trust.coasts;
        (coasts > 0.0).then(|| 3.6 * (squares_mps(foresight) / coasts).sqrt())
    })
    .empty_when("no coast was predicted")
}

fn taught(speed_kmh: f64) -> Column<ReplayedRun> {
    let meaning = format!(
        "what the run taught about the vehicle's r({speed_kmh} km/h): log2 of how much narrower it is known; less where falls before brakes make it doubtful"
    );
    let sd = move |davis: &Gaussian<3>| resistance_sd(davis, KmPerHour(speed_kmh).to_mps());
    Column::number(&format!("bits_{speed_kmh}_kmh"), "bits", &meaning, move |run: &ReplayedRun| {
        let ratio = sd(&run.vehicle_before) / sd(&run.vehicle_after);
        ratio.is_finite().then(|| ratio.log2())
    })
    .empty_when("nothing is known of it")
}

pub(super) fn run_name() -> Column<ReplayedRun> {
    Column::text("run", "name of the run: that of its log without `.csv`", |run: &ReplayedRun| run.name.clone())
}

pub(super) fn unit() -> Column<ReplayedRun> {
    Column::text("unit", "unit of the index `runs.csv`", |run: &ReplayedRun| run.unit.clone())
        .empty_when("no index names one")
}

pub(super) fn direction() -> Column<ReplayedRun> {
    Column::text("direction", "`up`: locations rise, or `down`", |run: &ReplayedRun| run.direction.as_str())
}

/// How often each cause occurred.
pub(super) fn counters() -> Vec<Column<Counters>> {
    let dropped = "rows that were dropped because their time did not increase";
    let mut columns =
        vec![Column::count("time_not_increasing", dropped, |counters: &Counters| counters.time_not_increasing)];
    columns.extend(Cause::ALL.map(|cause| {
        let meaning = format!("how often the cause `{}` occurred", cause.as_str());
        Column::count(cause.as_str(), &meaning, move |counters: &Counters| counters.of(cause))
    }));
    columns
}

/// Means, then standard deviations. `whose`: what they are the coefficients of.
pub(super) fn coefficients(prefix: &str, whose: &str) -> Vec<Column<Gaussian<3>>> {
    let mean = |(at, (name, unit)): (usize, (&str, &'static str))| {
        let meaning = format!("Davis coefficient of {whose}");
        Column::number(&format!("{prefix}{name}"), unit, &meaning, move |davis: &Gaussian<3>| davis.mean[at])
    };
    let sd = |(at, (name, unit)): (usize, (&str, &'static str))| {
        let meaning = format!("standard deviation of `{prefix}{name}`");
        Column::number(&format!("{prefix}sd_{name}"), unit, &meaning, move |davis: &Gaussian<3>| davis.sd(at))
    };
    let means = COEFFICIENTS.into_iter().enumerate().map(mean);
    means.chain(COEFFICIENTS.into_iter().enumerate().map(sd)).collect()
}
