//! Tables for other tools: the residuals of the believed model, and simulated beside measured speed.

use crate::answer::whole::Answer;
use crate::data::rows::Row;
use crate::holdout::forward::Compared;
use crate::traction::powering::SteadyPower;
use rundown_files::column::{Column, Filled, filled, write_csv};
use std::{borrow::Borrow, io};

const RUN: &str = "number of the run in the order in which it was read, from 1";
const NO_COLUMN: &str = "no log has it";

/// `residuals.csv`: each interval's residual; location, speed and time since departure are those of its middle.
pub fn residuals() -> Vec<Column<Row>> {
    let direction = "1 with rising location, -1 against it";
    let effort = "effort over the interval, measured or known to be zero";
    let residual = "resistance that the believed model lacks";
    vec![
        Column::count("run", RUN, |row: &Row| row.interval.run + 1),
        Column::number("time_s", "s", "begin of the interval", |row: &Row| row.interval.begin_s),
        Column::number("duration_s", "s", "its duration", |row: &Row| row.interval.dt_s),
        Column::number("since_departure_s", "s", "time since departure", |row: &Row| {
            row.interval.middle().since_departure_s
        }),
        Column::number("direction", "", direction, |row: &Row| row.direction.sign()),
        Column::number("location_m", "m", "location of the front", |row: &Row| row.interval.middle().location_m),
        Column::number("speed_kmh", "km/h", "mean speed", |row: &Row| 3.6 * row.interval.mean_speed_mps()),
        Column::number("effort_n_per_kg", "N/kg", effort, |row: &Row| row.effort_n_per_kg),
        Column::number("temperature_c", "°C", "ambient temperature", |row: &Row| row.interval.temperature_c)
            .empty_when(NO_COLUMN),
        Column::number("day", "d", "day of the departure, from any day on", |row: &Row| row.interval.day)
            .empty_when("no index has departures"),
        Column::number("residual_n_per_kg", "N/kg", residual, |row: &Row| row.residual_n_per_kg),
    ]
}

/// `powering.csv`: the intervals of steady power while trains gain speed, beside the believed limit.
pub fn powering() -> Vec<Column<SteadyPower>> {
    let by_power = "`true` where the power is what limits, `false` where it is the effort";
    vec![
        Column::count("run", RUN, |p: &SteadyPower| p.run + 1),
        Column::count("phase", "number of the powering phase in its run, from 1", |p: &SteadyPower| p.number + 1),
        Column::number("location_m", "m", "location of the front", |p: &SteadyPower| p.location_m),
        Column::number("speed_kmh", "km/h", "speed", |p: &SteadyPower| 3.6 * p.speed_mps),
        Column::number("ratio", "1", "effort over the believed limit", |p: &SteadyPower| p.ratio),
        Column::number("sd", "1", "standard deviation of `ratio`", |p: &SteadyPower| p.sd),
        Column::text("by_power", by_power, |p: &SteadyPower| p.by_power.to_string()),
    ]
}

/// A measured speed of a hold-out run beside the simulated ones.
#[derive(Clone, Copy, Debug)]
pub struct BeforeAfter {
    run: usize,
    compared: Compared,
}

/// `before_after.csv`: measured and simulated speed of the hold-out runs.
pub fn before_after() -> Vec<Column<BeforeAfter>> {
    let simulated =
        |of: fn(&Compared) -> f64| move |row: &BeforeAfter| 3.6 * (row.compared.measured_mps + of(&row.compared));
    vec![
        Column::count("run", RUN, |row: &BeforeAfter| row.run + 1),
        Column::number("time_s", "s", "time of the sample", |row: &BeforeAfter| row.compared.time_s),
        Column::number("location_m", "m", "location of the front", |row: &BeforeAfter| row.compared.location_m),
        Column::number("measured_kmh", "km/h", "measured speed", |row: &BeforeAfter| 3.6 * row.compared.measured_mps),
        Column::number("before_kmh", "km/h", "speed simulated with the believed model", simulated(|c| c.before_mps)),
        Column::number("after_kmh", "km/h", "speed simulated with the effects found", simulated(|c| c.after_mps)),
    ]
}

impl Answer {
    fn before_after(&self) -> impl Iterator<Item = BeforeAfter> + '_ {
        let found = &self.found;
        found.compared.iter().map(|compared| BeforeAfter { run: found.held_out[compared.run], compared: *compared })
    }

    /// The table of `residuals.csv`.
    pub fn residuals(&self) -> Filled {
        filled(residuals(), &self.found.findings.rows)
    }

    /// The table of `powering.csv`.
    pub fn powering(&self) -> Filled {
        filled(powering(), self.found.findings.powering.iter().flatten())
    }

    /// The table of `before_after.csv`.
    pub fn compared(&self) -> Filled {
        filled(before_after(), self.before_after())
    }
}

/// The files with these tables.
///
/// # Errors
/// None is known: what a cell holds can be written.
pub fn files(answer: &Answer) -> io::Result<[(&'static str, Vec<u8>); 3]> {
    let found = &answer.found.findings;
    Ok([
        ("residuals.csv", csv(&residuals(), &found.rows)?),
        ("powering.csv", csv(&powering(), found.powering.iter().flatten())?),
        ("before_after.csv", csv(&before_after(), answer.before_after())?),
    ])
}

fn csv<R>(columns: &[Column<R>], rows: impl IntoIterator<Item: Borrow<R>>) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    write_csv(&mut bytes, columns, rows)?;
    Ok(bytes)
}
