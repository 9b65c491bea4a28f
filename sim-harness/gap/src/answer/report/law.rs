//! The law of each effect over the data: mean residuals over the variable that the law depends on, with the fitted law
//! through them.

use super::binned::{Bin, Value, binned, width};
use super::maps::{LEAST_RUNS, colour};
use crate::answer::whole::Answer;
use crate::axis::Axis;
use crate::candidates;
use crate::data::rows::Row;
use crate::explained::{acts, extra};
use crate::named::Named;
use crate::wording::plain;
use rundown::model::direction::Direction;
use rundown_check::figure::HALF_95;
use rundown_pages::chart::{Drawing, Figure, Layer, Panel, Stroke, range_of};
use rundown_pages::colours;
use std::ops::Range;

const MOST_BINS: usize = 24;
/// Beside a table, whose steps may be a kilometre apart.
const MOST_BINS_BESIDE_STEPS: usize = 96;
/// Legend of the law.
const AS_FITTED: &str = "law as fitted";

/// Picture and caption of each effect that has a law over the residuals.
pub(super) fn laws(answer: &Answer, explained: &[f64]) -> Vec<(Drawing, String)> {
    let each = answer.found.named.iter();
    each.filter_map(|one| match one.per_run.is_empty() {
        false => winds(one),
        true => law(answer, one, explained),
    })
    .collect()
}

/// A row with where it lies, what is left for this effect, and what its law says.
struct At {
    direction: Direction,
    run: usize,
    x: f64,
    left: f64,
    law: f64,
    weight: f64,
}

/// The rows over which the law of an effect is drawn.
fn rows(answer: &Answer, one: &Named, axis: &Axis<'_>, explained: &[f64]) -> Vec<At> {
    let believed = answer.context().believed;
    let findings = &answer.found.findings;
    let of_row = |((row, explained), spread): ((&Row, &f64), &f64)| {
        let acts = acts(one, &answer.input.runs, row);
        if !acts && !axis.run_by_run {
            return None;
        }
        let law = if acts { extra(&believed, &one.effect, row) } else { 0.0 };
        let per = axis.per.map_or(1.0, |per| per(row));
        Some(At {
            direction: row.direction,
            x: (axis.x)(row)?,
            // What the other effects explain is taken off.
            left: (row.residual_n_per_kg - explained + law) / per,
            law: law / per,
            // Outliers count as little as they do in the fit.
            weight: (per / spread).powi(2),
            run: row.interval.run,
        })
    };
    findings.rows.iter().zip(explained).zip(&findings.calibrated.spread).filter_map(of_row).collect()
}

fn law(answer: &Answer, one: &Named, explained: &[f64]) -> Option<(Drawing, String)> {
    let context = answer.context();
    let axis = candidates::of_effect(&one.effect).axis(one, &context)?;
    let rows = rows(answer, one, &axis, explained);
    if rows.is_empty() {
        return None;
    }
    let x = range_of(rows.iter().map(|at| at.x));
    let bins = if axis.run_by_run {
        (1.0, 1)
    } else {
        let enough = answer.input.runs.len() / (2 * LEAST_RUNS);
        let most = match axis.table.is_empty() {
            _ if axis.of_run => MOST_BINS.min(enough.max(1)),
            true => MOST_BINS,
            false => MOST_BINS_BESIDE_STEPS,
        };
        (width(&x, most), LEAST_RUNS.min(answer.input.runs.len()))
    };
    let travelled = |d: &Direction| rows.iter().any(|at| at.direction == *d);
    let groups: Vec<Option<Direction>> = match axis.by_direction {
        true => [Direction::Up, Direction::Down].into_iter().filter(travelled).map(Some).collect(),
        false => vec![None],
    };
    let of_group = |(i, group): (usize, Option<Direction>)| {
        let rows: Vec<&At> = rows.iter().filter(|at| group.is_none_or(|g| g == at.direction)).collect();
        layers_of(&rows, group, bins, i == 0)
    };
    let mut layers: Vec<Layer> = groups.into_iter().enumerate().flat_map(of_group).collect();
    let points = layers.iter().flat_map(|layer| match layer {
        Layer::Dots { points, .. } => points.as_slice(),
        _ => &[],
    });
    // Where a mean stands, and a little beside it.
    let x = range_of(points.map(|(x, _)| *x));
    let beside = 0.02 * (x.end - x.start);
    let x = x.start - beside..x.end + beside;
    if !axis.table.is_empty() {
        // Means of bins would draw a step over a kilometre as a slope of two.
        layers.retain(|layer| !matches!(layer, Layer::Line { .. }));
        let points = within(&axis.table, &x).into_iter().map(Some).collect();
        layers.push(Layer::line(AS_FITTED, colours::ESTIMATED, Stroke::Solid, points));
    }
    let y_label = match axis.per {
        Some(_) => "lacking share of the braking effort",
        None => "residual, N/kg",
    };
    let name = match one.coordinate() {
        Some(_) => "unknown effect".to_owned(),
        None => plain(one.effect.name()),
    };
    let figure = Figure::new(
        format!("The law of the {name} over the data"),
        format!("Mean {y_label}, over {}", axis.x_label),
        axis.x_label,
        x,
        [Panel::new(y_label, 380, layers, "no intervals")],
    );
    let figure = if axis.run_by_run { figure.over_counts() } else { figure };
    let bars = match axis.run_by_run {
        true => "one dot a run",
        false => "bars: 95 % intervals of the means from the spread between runs",
    };
    let fitted = match axis.table.is_empty() {
        true => "on the very same intervals",
        false => "point by point of its table",
    };
    Some((
        figure.into(),
        format!(
            "The law of the {name} through the data: mean residuals less what the other effects explain ({bars}), and the law as fitted, {fitted}."
        ),
    ))
}

/// The part of a table that lies in a range: straight between its points, level beyond them, as the board has it.
fn within(table: &[(f64, f64)], x: &Range<f64>) -> Vec<(f64, f64)> {
    let at = |place: f64| {
        let next = table.iter().position(|(x, _)| place < *x).unwrap_or(table.len());
        match (next.checked_sub(1).and_then(|before| table.get(before)), table.get(next)) {
            (Some((x0, y0)), Some((x1, y1))) => y0 + (y1 - y0) * (place - x0) / (x1 - x0),
            (Some((_, y)), None) | (None, Some((_, y))) => *y,
            (None, None) => 0.0,
        }
    };
    let inner = table.iter().copied().filter(|(place, _)| x.start < *place && *place < x.end);
    let end = |place: f64| std::iter::once((place, at(place)));
    end(x.start).chain(inner).chain(end(x.end)).collect()
}

/// `least`: a mean of fewer runs is not drawn.
fn layers_of(rows: &[&At], group: Option<Direction>, (width, least): (f64, usize), first: bool) -> Vec<Layer> {
    let bins = |of: &dyn Fn(&At) -> f64| -> Vec<Bin> {
        let value = |at: &&At| Value { run: at.run, at: at.x, value: of(at), weight: at.weight };
        binned(&rows.iter().map(value).collect::<Vec<_>>(), width)
    };
    // The same rows make the same bins: each stands at the mean of its rows.
    let (places, data, law) = (bins(&|at| at.x), bins(&|at| at.left), bins(&|at| at.law));
    let pairs = |of: &[Bin]| -> Vec<(Bin, Bin)> {
        let pairs = places.iter().cloned().zip(of.iter().cloned());
        pairs.filter(|(_, bin)| bin.runs >= least).collect()
    };
    let (data, law) = (pairs(&data), pairs(&law));
    let bar = |(place, bin): &(Bin, Bin)| {
        let half = HALF_95 * bin.se?;
        let end = |by: f64| Some((place.mean, bin.mean + by));
        Some(vec![end(-half), end(half)])
    };
    let point = |(place, bin): &(Bin, Bin)| (place.mean, bin.mean);
    let dots = group.map_or(colours::MEASURED, colour);
    let legend = if first { AS_FITTED } else { "" };
    let law: Vec<(f64, f64)> = law.iter().map(point).collect();
    let law = match least {
        // Between one run and the next there is nothing.
        1 => Layer::marks(legend, colours::ESTIMATED, law),
        _ => Layer::line(legend, colours::ESTIMATED, Stroke::Solid, law.into_iter().map(Some).collect()),
    };
    let measured =
        group.map_or("measured".to_owned(), |direction| format!("measured, {} the line", direction.as_str()));
    vec![
        Layer::threads("", dots, 0.7, data.iter().filter_map(bar).collect()),
        Layer::dots(measured, dots, 1.0, data.iter().map(point).collect()),
        law,
    ]
}

fn winds(one: &Named) -> Option<(Drawing, String)> {
    let at = |i: usize| i as f64 + 1.0;
    let each = || one.per_run.iter().enumerate();
    let bar = |(i, (_, wind, sd)): (usize, &(String, f64, f64))| {
        let end = |by: f64| Some((at(i), wind + by));
        vec![end(-HALF_95 * sd), end(HALF_95 * sd)]
    };
    let winds = each().map(|(i, (_, wind, _))| (at(i), *wind)).collect();
    let layers = [
        Layer::threads("", colours::MEASURED, 0.7, each().map(bar).collect()),
        Layer::dots("wind of a run", colours::MEASURED, 1.0, winds),
    ];
    let figure = Figure::new(
        "The wind of each run",
        "Wind against the direction up the line, run by run",
        "number of the run",
        0.0..at(one.per_run.len()),
        [Panel::new("headwind up the line, m/s", 340, layers, "no runs")],
    );
    let caption = "The wind of each run from its own residuals, against travel up the line; bars: 95 % intervals.";
    Some((figure.over_counts().into(), caption.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_drawn_with_its_steps_and_level_beyond_them() {
        let step = [(11.999, 0.0), (12.0, 5e-3), (13.4, 5e-3), (13.401, 0.0)];
        let ends = |from, to| [vec![(from, 0.0)], step.to_vec(), vec![(to, 0.0)]].concat();
        assert_eq!(within(&step, &(0.0..30.0)), ends(0.0, 30.0));
        let part = within(&step, &(12.5..30.0));
        assert_eq!(part, [(12.5, 5e-3), (13.4, 5e-3), (13.401, 0.0), (30.0, 0.0)]);
        assert_eq!(within(&[(0.0, 1.0), (10.0, 2.0)], &(-5.0..5.0)), [(-5.0, 1.0), (0.0, 1.0), (5.0, 1.5)]);
    }
}
