//! What effects add to the resistance, interval by interval: the law as the board runs it, comparable with a residual.

use crate::data::{believed::Believed, rows::Row, runs::Run};
use crate::named::Named;
use rundown::model::effects::{Effect, Limits};

/// Extra resistance of all effects along each row, N/kg.
pub fn explained(believed: &Believed<'_>, named: &[Named], runs: &[Run], rows: &[Row]) -> Vec<f64> {
    let of_row = |row: &Row| {
        let acting = named.iter().filter(|one| acts(one, runs, row));
        acting.map(|one| extra(believed, &one.effect, row)).sum()
    };
    rows.iter().map(of_row).collect()
}

/// The rows with what the effects leave of their residuals.
pub fn repaired(believed: &Believed<'_>, named: &[Named], runs: &[Run], rows: &[Row]) -> Vec<Row> {
    let left =
        |(row, explained): (&Row, f64)| Row { residual_n_per_kg: row.residual_n_per_kg - explained, ..row.clone() };
    rows.iter().zip(explained(believed, named, runs, rows)).map(left).collect()
}

/// The effect acts in the run of this row.
pub fn acts(one: &Named, runs: &[Run], row: &Row) -> bool {
    let name = runs.get(row.interval.run).map(|run| run.name.as_str());
    one.runs.is_empty() || one.runs.iter().any(|r| Some(r.as_str()) == name)
}

/// Extra resistance of one effect along a row, N/kg.
pub fn extra(believed: &Believed<'_>, effect: &Effect, row: &Row) -> f64 {
    let line = believed.line(row.direction);
    let davis = line.train.davis();
    let limits = Limits::of(line.train);
    row.interval.mean(|point| {
        let resistance = effect.resistance_n_per_kg(line, &davis, &row.moment(point));
        // A brake that fades gives less than was recorded: what is lost looks like less resistance.
        if row.effort_n_per_kg < 0.0 {
            let left = effect.limit(&limits, point.location_m, point.speed_mps);
            let share = left.brake_n_per_kg / limits.brake_n_per_kg;
            resistance + row.effort_n_per_kg * (1.0 - share)
        } else {
            resistance
        }
    })
}
