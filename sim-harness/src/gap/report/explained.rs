//! What the effects that were found add to the resistance, row by row: the law over the data.

use super::Page;
use crate::gap::named::Named;
use crate::gap::rows::Row;
use rundown::effects::{Effect, Limits, Moment};

/// Extra resistance of all effects along each row, N/kg; comparable with the row's residual.
pub(super) fn explained(page: &Page<'_>) -> Vec<f64> {
    let rows = &page.found.findings.rows;
    rows.iter()
        .map(|row| {
            let name = page.runs.get(row.interval.run).map(|run| run.name.as_str());
            let acts = |one: &&Named| {
                one.runs.is_empty() || one.runs.iter().any(|r| Some(r.as_str()) == name)
            };
            let acting = page.found.named.iter().filter(acts);
            acting.map(|one| extra(page, &one.effect, row)).sum()
        })
        .collect()
}

fn extra(page: &Page<'_>, effect: &Effect, row: &Row) -> f64 {
    let line = page.believed.line(row.direction);
    let davis = line.train.davis();
    let believed = Limits::of(line.train);
    row.interval.mean(|point| {
        let moment = Moment {
            location_m: point.location_m,
            speed_mps: point.speed_mps,
            effort_n_per_kg: row.effort_n_per_kg,
            since_departure_s: point.since_departure_s,
            braked: row.interval.braked,
            temperature_c: row.interval.temperature_c,
            day: row.interval.day,
        };
        let resistance = effect.resistance_n_per_kg(line, &davis, &moment);
        // A brake that fades gives less than was recorded: what is lost looks like less resistance.
        if row.effort_n_per_kg < 0.0 {
            let limits = effect.limit(&believed, point.location_m, point.speed_mps);
            let share = limits.brake_n_per_kg / believed.brake_n_per_kg;
            resistance + row.effort_n_per_kg * (1.0 - share)
        } else {
            resistance
        }
    })
}
