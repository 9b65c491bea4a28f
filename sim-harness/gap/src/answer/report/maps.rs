//! The map of the disagreement: mean residuals over each coordinate, and what the effects explain of them.

use super::binned::{Bin, Value, binned, width};
use crate::answer::whole::Answer;
use crate::axis::Axis;
use crate::data::rows::Row;
use plotters::style::RGBColor;
use rundown::model::direction::Direction;
use rundown_check::figure::HALF_95;
use rundown_pages::chart::{Drawing, Figure, Grid, Layer, Panel, Stroke, range_of};
use rundown_pages::colours;

/// A mean of fewer runs is not drawn.
pub(super) const LEAST_RUNS: usize = 5;
/// Most bins of the location.
const MOST_PLACES: usize = 80;

/// The axes of the maps beside the location, each with its most bins.
fn others(answer: &Answer) -> [(Axis<'static>, usize); 4] {
    let first_day = answer.found.findings.conditions.first_day;
    [(Axis::speed(), 30), (Axis::time(), 30), (Axis::temperature(), 15), (Axis::day(first_day), 15)]
}

pub(super) fn maps(answer: &Answer, explained: &[f64]) -> Vec<(Drawing, String)> {
    let directions = directions(answer);
    let location = (Axis::location(), MOST_PLACES);
    let by_location = Grid::new(
        "Residual over location",
        "Mean residual of all runs over location, with the sections found",
        1,
        directions.iter().map(|d| figure(answer, explained, &location, &[*d])).collect(),
    );
    let known = |(axis, _): &&(Axis<'_>, usize)| {
        let at = || answer.found.findings.rows.iter().filter_map(|row| (axis.x)(row));
        let range = range_of(at());
        at().count() > 0 && range.end > range.start
    };
    let by_others = Grid::new(
        "Residual over speed, time and more",
        "Mean residual of all runs over each coordinate",
        2,
        others(answer).iter().filter(known).map(|c| figure(answer, explained, c, &directions)).collect(),
    );
    let found = if answer.found.named.is_empty() {
        ""
    } else {
        " Dashed: what the effects that were found explain on the very same intervals; where it lies in the band they explain all."
    };
    let sections = answer.found.named.iter().any(|n| n.effect.section_m().is_some());
    let grey = if sections { " Grey background: the section found." } else { "" };
    vec![
        (
            by_location.into(),
            format!(
                "Mean residual over location, band: 95 % interval of the mean from the spread between runs; places with fewer than {LEAST_RUNS} runs are left out.{found}{grey}"
            ),
        ),
        (
            by_others.into(),
            "The same over other coordinates. One cause shows in several of them, because speed, place and time go together in a timetable.".to_owned(),
        ),
    ]
}

fn directions(answer: &Answer) -> Vec<Direction> {
    let all = [Direction::Up, Direction::Down];
    let travelled = |d: &Direction| answer.found.findings.rows.iter().any(|r| r.direction == *d);
    all.into_iter().filter(travelled).collect()
}

/// Points in their order with a gap wherever `parted` says so of two of them.
pub(super) fn joined<T, P>(all: &[T], parted: impl Fn(&T, &T) -> bool, of: impl Fn(&T) -> Option<P>) -> Vec<Option<P>> {
    let gap = |i: usize| (i > 0 && parted(&all[i - 1], &all[i])).then_some(None);
    all.iter().enumerate().flat_map(|(i, one)| gap(i).into_iter().chain([of(one)])).collect()
}

pub(super) fn colour(direction: Direction) -> RGBColor {
    match direction {
        Direction::Up => colours::MEASURED,
        Direction::Down => colours::GRADIENT,
    }
}

fn figure(
    answer: &Answer,
    explained: &[f64],
    (axis, most_bins): &(Axis<'_>, usize),
    directions: &[Direction],
) -> Figure {
    let findings = &answer.found.findings;
    let x = range_of(findings.rows.iter().filter_map(|row| (axis.x)(row)));
    let enough = answer.input.runs.len() / (directions.len().max(1) * LEAST_RUNS);
    let width = width(&x, if axis.of_run { (*most_bins).min(enough.max(1)) } else { *most_bins });
    let bins = |direction: Direction, of: &dyn Fn(usize, &Row) -> f64| -> Vec<Bin> {
        let rows = findings.rows.iter().zip(&findings.calibrated.spread);
        let values = rows.enumerate().filter(|(_, (r, _))| r.direction == direction);
        let values = values.filter_map(|(i, (row, spread))| {
            // Outliers count as little as they do in the fit.
            Some(Value { run: row.interval.run, at: (axis.x)(row)?, value: of(i, row), weight: spread.powi(-2) })
        });
        let mut bins = binned(&values.collect::<Vec<_>>(), width);
        bins.retain(|bin| bin.runs >= LEAST_RUNS.min(answer.input.runs.len()));
        bins
    };
    // A bin without values breaks the line.
    let apart = |a: &Bin, b: &Bin| b.at - a.at > 1.5 * width;
    let mean = |bin: &Bin| Some((bin.at, bin.mean));
    let band = |bin: &Bin| {
        let half = HALF_95 * bin.se?;
        Some((bin.at, bin.mean - half, bin.mean + half))
    };
    let is_map = *most_bins == MOST_PLACES;
    let mut layers: Vec<Layer> = is_map.then(|| sections(answer)).into_iter().collect();
    for direction in directions {
        let (residuals, colour) = (bins(*direction, &|_, row| row.residual_n_per_kg), colour(*direction));
        let legend = format!("measured, {} the line", direction.as_str());
        layers.push(Layer::band("", colour, 0.18, joined(&residuals, apart, band)));
        layers.push(Layer::line(legend, colour, Stroke::Thin, joined(&residuals, apart, mean)));
    }
    let found = directions.iter().enumerate().filter(|_| !answer.found.named.is_empty());
    layers.extend(found.map(|(i, direction)| {
        let law = bins(*direction, &|i, _| explained.get(i).copied().unwrap_or(f64::NAN));
        let legend = if i == 0 { "explained" } else { "" };
        Layer::line(legend, colours::ESTIMATED, Stroke::Dashed, joined(&law, apart, mean))
    }));
    let panel = Panel::new("residual, N/kg", if is_map { 400 } else { 340 }, layers, "no intervals");
    Figure::in_grid(axis.x_label, x, panel)
}

/// Background of the sections that effects act in.
pub(super) fn sections(answer: &Answer) -> Layer {
    let found = answer.found.named.iter().filter_map(|one| one.effect.section_m());
    let spans: Vec<_> = found.map(|(from, to)| from / 1000.0..to / 1000.0).collect();
    Layer::spans(if spans.is_empty() { "" } else { "section found" }, colours::LIMIT, 0.12, spans)
}
