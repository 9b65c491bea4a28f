//! The law of each effect over the data: mean residuals over the variable that the law depends on, with the fitted law through them.

use super::binned::{Bin, Value, binned, width};
use super::maps::{colour, word};
use crate::answer::whole::Answer;
use crate::candidates;
use crate::data::rows::Row;
use crate::explained::{acts, extra};
use crate::fit::HALF_95;
use crate::named::Named;
use crate::wording::plain;
use rundown::model::direction::Direction;
use rundown_pages::chart::{Axes, Figure, Layer, Panel, Stroke, range_of};
use rundown_pages::colours;

/// Points of a law.
const MOST_BINS: usize = 24;
/// A mean of fewer runs is not drawn.
const LEAST_RUNS: usize = 5;

/// Picture and caption of each effect that has a law over the residuals.
pub(super) fn laws(answer: &Answer, explained: &[f64]) -> Vec<(String, String)> {
    let each = answer.found.named.iter();
    each.filter_map(|one| match one.per_run.is_empty() {
        false => winds(one),
        true => law(answer, one, explained),
    })
    .collect()
}

/// A row with where it lies, what is left for this effect, and what its law says.
struct At {
    run: usize,
    x: f64,
    left: f64,
    law: f64,
    weight: f64,
}

fn law(answer: &Answer, one: &Named, explained: &[f64]) -> Option<(String, String)> {
    let context = answer.context();
    let axis = candidates::of_effect(&one.effect).axis(one, &context)?;
    let findings = &answer.found.findings;
    let rows = findings.rows.iter().zip(explained);
    let rows = rows.zip(&findings.calibrated.spread);
    let of_row = |((row, explained), spread): ((&Row, &f64), &f64)| {
        if !acts(one, &answer.input.runs, row) && !axis.run_by_run {
            return None;
        }
        let law = if acts(one, &answer.input.runs, row) { extra(&context.believed, &one.effect, row) } else { 0.0 };
        let per = axis.per.map_or(1.0, |per| per(row));
        Some((
            row.direction,
            At {
                x: (axis.x)(row)?,
                // What the other effects explain is taken off.
                left: (row.residual_n_per_kg - explained + law) / per,
                law: law / per,
                // Outliers count as little as they do in the fit.
                weight: (per / spread).powi(2),
                run: row.interval.run,
            },
        ))
    };
    let rows: Vec<(Direction, At)> = rows.filter_map(of_row).collect();
    if rows.is_empty() {
        return None;
    }
    let x = range_of(rows.iter().map(|(_, at)| at.x));
    let (width, least) = if axis.run_by_run {
        (1.0, 1)
    } else {
        let enough = answer.input.runs.len() / (2 * LEAST_RUNS);
        let most = if axis.of_run { MOST_BINS.min(enough.max(1)) } else { MOST_BINS };
        (width(&x, most), LEAST_RUNS.min(answer.input.runs.len()))
    };
    let mut layers = Vec::new();
    let groups: Vec<Option<Direction>> = if axis.by_direction {
        let travelled = |d: &Direction| rows.iter().any(|(direction, _)| direction == d);
        let all = [Direction::Up, Direction::Down].into_iter();
        all.filter(travelled).map(Some).collect()
    } else {
        vec![None]
    };
    for (i, group) in groups.into_iter().enumerate() {
        let of_group = rows.iter().filter(|(d, _)| group.is_none_or(|g| g == *d));
        let of_group: Vec<&At> = of_group.map(|(_, at)| at).collect();
        layers.extend(layers_of(&of_group, group, (width, least), i == 0));
    }
    let points = layers.iter().flat_map(|layer| match layer {
        Layer::Dots { points, .. } => points.as_slice(),
        _ => &[],
    });
    // Where a mean stands, and a little beside it.
    let x = range_of(points.map(|(x, _)| *x));
    let beside = 0.02 * (x.end - x.start);
    let x = x.start - beside..x.end + beside;
    let y_label = match axis.per {
        Some(_) => "lacking share of the braking effort",
        None => "residual, N/kg",
    };
    let name = match one.coordinate() {
        Some(_) => "unknown effect".to_owned(),
        None => plain(one.effect.name()),
    };
    let figure = Figure {
        title: format!("The law of the {name} over the data"),
        description: format!("Mean {y_label}, over {}", axis.x_label),
        x_label: axis.x_label.to_owned(),
        x,
        panels: vec![Panel {
            label: y_label.to_owned(),
            height: 380,
            y: None,
            axes: Axes::Left,
            layers,
            empty: "no intervals".to_owned(),
        }],
    };
    let bars = match axis.run_by_run {
        true => "one dot a run",
        false => "bars: 95 % intervals of the means from the spread between runs",
    };
    Some((
        figure.to_svg(),
        format!(
            "The law of the {name} through the data: mean residuals less what the other effects explain ({bars}), and the law as fitted, on the very same intervals."
        ),
    ))
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
    let legend = if first { "law as fitted" } else { "" }.to_owned();
    let law = if least == 1 {
        // Between one run and the next there is nothing.
        Layer::Marks { legend, colour: colours::ESTIMATED, points: law.iter().map(point).collect() }
    } else {
        Layer::Line {
            legend,
            colour: colours::ESTIMATED,
            stroke: Stroke::Solid,
            points: law.iter().map(|p| Some(point(p))).collect(),
        }
    };
    vec![
        Layer::Threads {
            legend: String::new(),
            colour: dots,
            opacity: 0.7,
            lines: data.iter().filter_map(bar).collect(),
        },
        Layer::Dots {
            legend: match group {
                Some(direction) => format!("measured, {} the line", word(direction)),
                None => "measured".to_owned(),
            },
            colour: dots,
            opacity: 1.0,
            points: data.iter().map(point).collect(),
        },
        law,
    ]
}

/// Each run's own wind.
fn winds(one: &Named) -> Option<(String, String)> {
    let at = |i: usize| i as f64 + 1.0;
    let each = || one.per_run.iter().enumerate();
    let bar = |(i, (_, wind, sd)): (usize, &(String, f64, f64))| {
        let end = |by: f64| Some((at(i), wind + by));
        vec![end(-HALF_95 * sd), end(HALF_95 * sd)]
    };
    let figure = Figure {
        title: "The wind of each run".to_owned(),
        description: "Wind against the direction up the line, run by run".to_owned(),
        x_label: "number of the run".to_owned(),
        x: 0.0..at(one.per_run.len()),
        panels: vec![Panel {
            label: "headwind up the line, m/s".to_owned(),
            height: 340,
            y: None,
            axes: Axes::Left,
            layers: vec![
                Layer::Threads {
                    legend: String::new(),
                    colour: colours::MEASURED,
                    opacity: 0.7,
                    lines: each().map(bar).collect(),
                },
                Layer::Dots {
                    legend: "wind of a run".to_owned(),
                    colour: colours::MEASURED,
                    opacity: 1.0,
                    points: each().map(|(i, (_, wind, _))| (at(i), *wind)).collect(),
                },
            ],
            empty: "no runs".to_owned(),
        }],
    };
    let caption = "The wind of each run from its own residuals, against travel up the line; bars: 95 % intervals.";
    Some((figure.to_svg(), caption.to_owned()))
}
