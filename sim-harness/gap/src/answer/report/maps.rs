//! The map of the disagreement: mean residuals over each coordinate, and what the effects explain of them.

use super::binned::{Bin, Value, binned, width};
use crate::answer::whole::Answer;
use crate::data::rows::Row;
use crate::findings::Findings;
use crate::fit::HALF_95;
use plotters::style::RGBColor;
use rundown::model::direction::Direction;
use rundown_pages::chart::{Axes, Figure, Grid, Layer, Panel, Stroke, range_of};
use rundown_pages::colours;

/// A mean of fewer runs is not drawn.
const LEAST_RUNS: usize = 5;

/// A coordinate of the maps.
struct Coordinate {
    label: &'static str,
    most_bins: usize,
    /// A run has one value of it, about.
    of_run: bool,
    of: fn(&Findings, &Row) -> Option<f64>,
}

const LOCATION: Coordinate = Coordinate {
    label: "location of the train's front, km",
    most_bins: 80,
    of_run: false,
    of: |_, row| Some(row.interval.middle().location_m / 1000.0),
};

const OTHERS: [Coordinate; 4] = [
    Coordinate {
        label: "speed, km/h",
        most_bins: 30,
        of_run: false,
        of: |_, row| Some(3.6 * row.interval.mean_speed_mps()),
    },
    Coordinate {
        label: "time since departure, min",
        most_bins: 30,
        of_run: false,
        of: |_, row| Some(row.interval.middle().since_departure_s / 60.0),
    },
    Coordinate {
        label: "ambient temperature, \u{b0}C",
        most_bins: 15,
        of_run: true,
        of: |_, row| row.interval.temperature_c,
    },
    Coordinate {
        label: "days since the first run",
        most_bins: 15,
        of_run: true,
        of: |findings, row| Some(row.interval.day? - findings.conditions.first_day),
    },
];

/// Pictures and captions.
pub(super) fn maps(answer: &Answer, explained: &[f64]) -> Vec<(String, String)> {
    let directions = directions(answer);
    let one = |coordinate, direction| figure(answer, explained, coordinate, &[direction]);
    let by_location = Grid {
        title: "Residual over location".to_owned(),
        description: "Mean residual of all runs over location, with the sections found".to_owned(),
        columns: 1,
        figures: directions.iter().map(|d| one(&LOCATION, *d)).collect(),
    };
    let known = |coordinate: &&Coordinate| {
        let findings = &answer.found.findings;
        let at = || findings.rows.iter().filter_map(|row| (coordinate.of)(findings, row));
        let range = range_of(at());
        at().count() > 0 && range.end > range.start
    };
    let by_others = Grid {
        title: "Residual over speed, time and more".to_owned(),
        description: "Mean residual of all runs over each coordinate".to_owned(),
        columns: 2,
        figures: OTHERS.iter().filter(known).map(|c| figure(answer, explained, c, &directions)).collect(),
    };
    let found = if answer.found.named.is_empty() {
        ""
    } else {
        " Dashed: what the effects that were found explain on the very same intervals; where it lies in the band they explain all."
    };
    let sections = answer.found.named.iter().any(|n| n.effect.section_m().is_some());
    let grey = if sections { " Grey background: the section found." } else { "" };
    vec![
        (
            by_location.to_svg(),
            format!(
                "Mean residual over location, band: 95 % interval of the mean from the spread between runs; places with fewer than {LEAST_RUNS} runs are left out.{found}{grey}"
            ),
        ),
        (
            by_others.to_svg(),
            "The same over other coordinates. One cause shows in several of them, because speed, place and time go together in a timetable.".to_owned(),
        ),
    ]
}

fn directions(answer: &Answer) -> Vec<Direction> {
    let all = [Direction::Up, Direction::Down];
    let travelled = |d: &Direction| answer.found.findings.rows.iter().any(|r| r.direction == *d);
    all.into_iter().filter(travelled).collect()
}

pub(super) fn word(direction: Direction) -> &'static str {
    match direction {
        Direction::Up => "up",
        Direction::Down => "down",
    }
}

pub(super) fn colour(direction: Direction) -> RGBColor {
    match direction {
        Direction::Up => colours::MEASURED,
        Direction::Down => colours::GRADIENT,
    }
}

fn figure(answer: &Answer, explained: &[f64], coordinate: &Coordinate, directions: &[Direction]) -> Figure {
    let findings = &answer.found.findings;
    let at = |row: &Row| (coordinate.of)(findings, row);
    let x = range_of(findings.rows.iter().filter_map(at));
    let enough = answer.input.runs.len() / (directions.len().max(1) * LEAST_RUNS);
    let bins = if coordinate.of_run { coordinate.most_bins.min(enough.max(1)) } else { coordinate.most_bins };
    let width = width(&x, bins);
    let bins = |direction: Direction, of: &dyn Fn(usize, &Row) -> f64| -> Vec<Bin> {
        let rows = findings.rows.iter().zip(&findings.calibrated.spread);
        let values = rows.enumerate().filter(|(_, (r, _))| r.direction == direction);
        let values = values.filter_map(|(i, (row, spread))| {
            Some(Value {
                run: row.interval.run,
                at: at(row)?,
                value: of(i, row),
                // Outliers count as little as they do in the fit.
                weight: spread.powi(-2),
            })
        });
        let mut bins = binned(&values.collect::<Vec<_>>(), width);
        bins.retain(|bin| bin.runs >= LEAST_RUNS.min(answer.input.runs.len()));
        bins
    };
    let mut layers = Vec::new();
    if coordinate.label == LOCATION.label {
        layers.push(sections(answer));
    }
    let joined = |bins: &[Bin]| -> Vec<Option<(f64, f64)>> {
        let mut points = Vec::new();
        for (i, bin) in bins.iter().enumerate() {
            // A bin without values breaks the line.
            if i > 0 && bin.at - bins[i - 1].at > 1.5 * width {
                points.push(None);
            }
            points.push(Some((bin.at, bin.mean)));
        }
        points
    };
    for direction in directions {
        let residuals = bins(*direction, &|_, row| row.residual_n_per_kg);
        let band = |bin: &Bin| {
            let half = HALF_95 * bin.se?;
            Some((bin.at, bin.mean - half, bin.mean + half))
        };
        let mut bands = Vec::new();
        for (i, bin) in residuals.iter().enumerate() {
            if i > 0 && bin.at - residuals[i - 1].at > 1.5 * width {
                bands.push(None);
            }
            bands.push(band(bin));
        }
        layers.push(Layer::Band { legend: String::new(), colour: colour(*direction), opacity: 0.18, points: bands });
        layers.push(Layer::Line {
            legend: format!("measured, {} the line", word(*direction)),
            colour: colour(*direction),
            stroke: Stroke::Thin,
            points: joined(&residuals),
        });
    }
    if !answer.found.named.is_empty() {
        for (i, direction) in directions.iter().enumerate() {
            let law = bins(*direction, &|i, _| explained.get(i).copied().unwrap_or(f64::NAN));
            let legend = if i == 0 { "explained" } else { "" };
            layers.push(Layer::Line {
                legend: legend.to_owned(),
                colour: colours::ESTIMATED,
                stroke: Stroke::Dashed,
                points: joined(&law),
            });
        }
    }
    Figure {
        title: String::new(),
        description: String::new(),
        x_label: coordinate.label.to_owned(),
        x,
        panels: vec![Panel {
            label: "residual, N/kg".to_owned(),
            height: if coordinate.most_bins > 40 { 400 } else { 340 },
            y: None,
            axes: Axes::Left,
            layers,
            empty: "no intervals".to_owned(),
        }],
    }
}

/// Background of the sections that effects act in.
pub(super) fn sections(answer: &Answer) -> Layer {
    let found = answer.found.named.iter().filter_map(|one| one.effect.section_m());
    let spans: Vec<_> = found.map(|(from, to)| from / 1000.0..to / 1000.0).collect();
    Layer::Spans {
        legend: if spans.is_empty() { "" } else { "section found" }.to_owned(),
        colour: colours::LIMIT,
        opacity: 0.12,
        spans,
    }
}
