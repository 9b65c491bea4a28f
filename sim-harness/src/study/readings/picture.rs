//! The comparison as pictures: what each reading gives over the skew of speed and location; the efforts as the rest is
//! printed, and both ways of reading gradient and Table 1 beside each other.

use super::comparison::Compared;
use super::outcome::columns;
use super::reading::{Combination, Gradient, Initial, SigmaPoints};
use super::remarks::COUNT;
use crate::study::figures::Picture;
use crate::study::tallies::R0_BAND;
use plotters::style::RGBColor;
use rundown::tick::paper::Difference;
use rundown_files::column::filled;
use rundown_pages::chart::{Figure, Grid, Layer, Panel, Stroke, range_of};
use rundown_pages::colours;
use rundown_truth::sensors::SpeedReading;

type Value = dyn Fn(&Compared) -> Option<f64>;

/// `of`: what the values are of.
pub fn pictures(all: &[Compared], of: &str) -> [Picture; 2] {
    [printed(all, of), crossed(all, of)]
}

fn printed(all: &[Compared], of: &str) -> Picture {
    let r0 = |end: usize| move |one: &Compared| one.moments(|j| j.r0_ends[end]).mean().map(|r0| 1e3 * r0);
    let mut ends = unnamed(lines(all, &r0(0)));
    ends.extend(unnamed(lines(all, &r0(1))));
    let x = x(all);
    ends.extend(
        [("where the paper finds r0", *R0_BAND.start()), ("", *R0_BAND.end())]
            .map(|(legend, r0)| Layer::level(legend, colours::LIMIT, Stroke::Dotted, &x, 1e3 * r0)),
    );
    let count = all.first().map_or(COUNT, Compared::of_remarks);
    let figures = vec![
        panel(
            &format!("remarks of section 4.2 that hold, of {count}"),
            &x,
            lines(all, &|one| Some(one.remarks())),
            Some(0.0..count as f64),
        ),
        panel(
            "best initial deviations, nats a sample (log10)",
            &x,
            unnamed(lines(all, &|one| Some(one.gains().mean()?.max(1e-3).log10()))),
            None,
        ),
        panel(
            "filtered less read speed, km/h, rms",
            &x,
            unnamed(lines(all, &|one| one.moments(|j| j.rms_kmh).mean())),
            None,
        ),
        panel("r0, 1 % and 99 % quantile, 10\u{207b}\u{b3} N/kg", &x, ends, None),
    ];
    Picture {
        name: "readings".to_owned(),
        caption: format!(
            "Readings of the paper over the skew of the recorder, {of}: gradient under the train, Table 1 as deviations. A positive skew is a speed older than the location."
        ),
        drawing: Grid::new(
            "Readings of the paper compared",
            "Four panels over the skew of speed and location",
            2,
            figures,
        )
        .into(),
        numbers: filled(columns(), all),
    }
}

/// Gradients and readings of Table 1, with their colours.
const CROSSED: [(Gradient, Initial, &str, RGBColor); 4] = [
    (Gradient::UnderTrain, Initial::Deviations, "mean gradient, deviations", colours::MEASURED),
    (Gradient::Point, Initial::Deviations, "point, deviations", colours::ESTIMATED),
    (Gradient::UnderTrain, Initial::Variances, "mean, variances", colours::TRUTH),
    (Gradient::Point, Initial::Variances, "point, variances", colours::HELD),
];

/// A row of panels for each quantity, a column for each effort.
fn crossed(all: &[Compared], of: &str) -> Picture {
    let is_crossed = |one: &&Compared| one.combination.reading.points == SigmaPoints::Printed;
    let shown: Vec<&Compared> = all.iter().filter(is_crossed).collect();
    // Skews at which one way alone was read say nothing of the others.
    let is_point = |one: &&&Compared| one.combination.reading.gradient == Gradient::Point;
    let crossed_s: Vec<f64> = shown.iter().filter(is_point).map(|one| one.combination.recorder.skew_s).collect();
    let shown: Vec<&Compared> =
        shown.into_iter().filter(|one| crossed_s.contains(&one.combination.recorder.skew_s)).collect();
    let x = range_of(crossed_s.iter().copied());
    let x = x.start - 0.5..x.end + 0.5;
    let count = all.first().map_or(COUNT, Compared::of_remarks);
    let quantities: [(String, &Value); 4] = [
        (format!("remarks that hold, of {count}"), &|one| Some(one.remarks())),
        ("filtered less read speed, km/h, rms".to_owned(), &|one| one.moments(|j| j.rms_kmh).mean()),
        ("r0, 1 % quantile, 10\u{207b}\u{b3} N/kg".to_owned(), &|one| {
            one.moments(|j| j.r0_ends[0]).mean().map(|r0| 1e3 * r0)
        }),
        ("log-likelihood a sample, its size (log10)".to_owned(), &|one| {
            Some(one.moments(|j| j.log_likelihood_per_sample).mean()?.abs().max(1e-3).log10())
        }),
    ];
    let mut figures = Vec::new();
    for (row, (label, value)) in quantities.into_iter().enumerate() {
        for (difference, effort) in [(Difference::Backward, "backward"), (Difference::Forward, "forward")] {
            let layers = crossed_lines(&shown, difference, value);
            let is_first = row == 0 && difference == Difference::Backward;
            figures.push(panel(
                &format!("{effort}: {label}"),
                &x,
                if is_first { layers } else { unnamed(layers) },
                None,
            ));
        }
    }
    let rows: Vec<Compared> = shown.into_iter().cloned().collect();
    Picture {
        name: "readings_crossed".to_owned(),
        caption: format!(
            "Gradient and Table 1, each read in both ways, {of}: the gradient under the train (mean) or that of its front (point), Table 1 as deviations or as variances. Solid: rounded speeds, dashed: truncated ones. Likelihoods are negative: the lower the line, the more likely the readings."
        ),
        drawing: Grid::new(
            "Gradient and Table 1, each read in both ways",
            "A row of panels for each quantity, a column for each effort, over the skew of speed and location",
            2,
            figures,
        )
        .into(),
        numbers: filled(columns(), &rows),
    }
}

fn crossed_lines(shown: &[&Compared], difference: Difference, value: &Value) -> Vec<Layer> {
    let mut layers = Vec::new();
    for (gradient, initial, name, colour) in CROSSED {
        for (speed, stroke) in [(SpeedReading::Rounded, Stroke::Solid), (SpeedReading::Truncated, Stroke::Dashed)] {
            let is_so = |one: &&&Compared| {
                let Combination { reading, recorder } = one.combination;
                let of_reading = (reading.difference, reading.gradient, reading.initial);
                of_reading == (difference, gradient, initial) && recorder.speed == speed
            };
            let point = |one: &&Compared| Some((one.combination.recorder.skew_s, value(one)?));
            let mut points: Vec<(f64, f64)> = shown.iter().filter(is_so).filter_map(point).collect();
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            let legend = if stroke == Stroke::Solid { name } else { "" };
            layers.push(match points.as_slice() {
                [] => continue,
                [_] => Layer::dots(legend, colour, 1.0, points),
                _ => Layer::line(legend, colour, stroke, points.into_iter().map(Some).collect()),
            });
        }
    }
    layers
}

fn x(all: &[Compared]) -> std::ops::Range<f64> {
    let ends = range_of(all.iter().map(|one| one.combination.recorder.skew_s));
    ends.start - 0.5..ends.end + 0.5
}

fn lines(all: &[Compared], value: &Value) -> Vec<Layer> {
    let mut layers = Vec::new();
    for (difference, colour) in [(Difference::Backward, colours::MEASURED), (Difference::Forward, colours::ESTIMATED)] {
        for (speed, stroke) in [(SpeedReading::Rounded, Stroke::Solid), (SpeedReading::Truncated, Stroke::Dashed)] {
            let of = |one: &&Compared| {
                let combination = one.combination;
                combination.is_printed()
                    && combination.reading.difference == difference
                    && combination.recorder.speed == speed
            };
            let mut points: Vec<(f64, f64)> =
                all.iter().filter(of).filter_map(|one| Some((one.combination.recorder.skew_s, value(one)?))).collect();
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            let effort = if difference == Difference::Backward { "backward" } else { "forward" };
            let how = if speed == SpeedReading::Rounded { "rounded" } else { "truncated" };
            layers.push(match points.as_slice() {
                [] => continue,
                // One recorder makes no line.
                [_] => Layer::dots(effort, colour, 1.0, points),
                _ => Layer::line(format!("{effort}, {how}"), colour, stroke, points.into_iter().map(Some).collect()),
            });
        }
    }
    layers
}

/// The same lines without an entry in the legend: one panel has it for all.
fn unnamed(layers: Vec<Layer>) -> Vec<Layer> {
    let without = |layer| match layer {
        Layer::Line { colour, stroke, points, .. } => Layer::line("", colour, stroke, points),
        Layer::Dots { colour, opacity, points, .. } => Layer::dots("", colour, opacity, points),
        other => other,
    };
    layers.into_iter().map(without).collect()
}

fn panel(label: &str, x: &std::ops::Range<f64>, layers: Vec<Layer>, y: Option<std::ops::Range<f64>>) -> Figure {
    let panel = Panel::new(label, 420, layers, "no seed");
    Figure::in_grid(
        "speed older than location by, s",
        x.clone(),
        match y {
            Some(y) => panel.within(y),
            None => panel,
        },
    )
}
