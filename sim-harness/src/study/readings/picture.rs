//! The comparison as a picture: what each reading gives over the skew of speed and location.

use super::comparison::Compared;
use super::outcome::columns;
use super::remarks::COUNT;
use crate::study::figures::Picture;
use crate::study::tallies::R0_BAND;
use rundown::tick::paper::Difference;
use rundown_files::column::filled;
use rundown_pages::chart::{Figure, Grid, Layer, Panel, Stroke, range_of};
use rundown_pages::colours;
use rundown_truth::sensors::SpeedReading;

type Value = dyn Fn(&Compared) -> Option<f64>;

/// `of`: what the values are of.
pub fn picture(all: &[Compared], of: &str) -> Picture {
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
