//! The data of a live figure: JSON that `assets/pages/figures.js` draws with uPlot.
//!
//! In: a [`Drawing`]. Out: its figures as they are, with numbers in single precision, which is finer than a screen
//! zoomed in a thousand times. Each array stands once: the panels of a run share their x, and the two forms of a figure
//! over location and over time share their heights. A value that is not there or not finite is `null`, where the line
//! is broken.

use super::scale::widened;
use super::{Axes, Drawing, Figure, Layer, Panel, Point, Stroke};
use crate::colours::css;
use plotters::style::RGBColor;
use rundown::Real;
use serde::Serialize;
use std::collections::HashMap;
use std::ops::Range;

#[derive(Serialize)]
struct Live<'a> {
    title: &'a str,
    columns: usize,
    views: Vec<View<'a>>,
    arrays: Vec<Vec<Option<f32>>>,
}

#[derive(Serialize)]
struct View<'a> {
    name: &'a str,
    figures: Vec<LiveFigure<'a>>,
}

#[derive(Serialize)]
struct LiveFigure<'a> {
    x_label: &'a str,
    x: [f32; 2],
    /// Only whole numbers on the x axis.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    is_count: bool,
    panels: Vec<LivePanel<'a>>,
}

#[derive(Serialize)]
struct LivePanel<'a> {
    label: &'a str,
    height: u32,
    y: [f32; 2],
    axes: &'static str,
    #[serde(skip_serializing_if = "str::is_empty")]
    empty: &'a str,
    layers: Vec<LiveLayer<'a>>,
}

/// `x`, `y`, `to`, `high` and `strength` are places in the arrays.
#[derive(Default, Serialize)]
struct LiveLayer<'a> {
    kind: &'static str,
    #[serde(skip_serializing_if = "str::is_empty")]
    legend: &'a str,
    #[serde(skip_serializing_if = "String::is_empty")]
    colour: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    opacity: Option<f32>,
    #[serde(skip_serializing_if = "str::is_empty")]
    stroke: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    x: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    y: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    to: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    high: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    heights: Option<[f32; 2]>,
    /// Many lines or cells of one name: no single value belongs to a place.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    many: bool,
    /// How strong the colour of each cell is.
    #[serde(skip_serializing_if = "Option::is_none")]
    strength: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    word: Option<(&'a str, f32)>,
}

/// Arrays of numbers, each once.
#[derive(Default)]
struct Arrays {
    all: Vec<Vec<Option<f32>>>,
    places: HashMap<Vec<Option<u32>>, usize>,
}

fn single(value: Real) -> Option<f32> {
    let value = value as f32;
    // Without the sign of a zero, which says nothing.
    value.is_finite().then_some(value + 0.0)
}

impl Arrays {
    fn place(&mut self, values: impl IntoIterator<Item = Option<Real>>) -> Option<usize> {
        let values: Vec<Option<f32>> = values.into_iter().map(|value| value.and_then(single)).collect();
        let bits = values.iter().map(|value| value.map(f32::to_bits)).collect();
        let next = self.all.len();
        let place = *self.places.entry(bits).or_insert(next);
        if place == next {
            self.all.push(values);
        }
        Some(place)
    }
}

impl Drawing {
    /// JSON, fit to stand within a page.
    pub fn live(&self) -> String {
        let mut arrays = Arrays::default();
        let mut view = |name, figures: &mut dyn Iterator<Item = _>| View {
            name,
            figures: figures.map(|figure| live_figure(figure, &mut arrays)).collect(),
        };
        let mut one = |name, figure| view(name, &mut std::iter::once(figure));
        let (columns, views) = match self {
            Self::One(figure) => (1, vec![one("", figure)]),
            Self::Switched { first, second } => (1, vec![one(first.0, &first.1), one(second.0, &second.1)]),
            Self::Grid(grid) => (grid.columns.max(1), vec![view("", &mut grid.figures.iter())]),
        };
        let live = Live { title: self.title(), columns, views, arrays: arrays.all };
        // Texts and finite numbers can always be written. A name must not end the script that the data stands in.
        serde_json::to_string(&live).unwrap_or_default().replace('<', "\\u003c")
    }
}

fn ends(range: &Range<Real>) -> [f32; 2] {
    [range.start as f32, range.end as f32]
}

fn live_figure<'a>(figure: &'a Figure, arrays: &mut Arrays) -> LiveFigure<'a> {
    let panels = figure.panels.iter().map(|panel| live_panel(panel, arrays)).collect();
    LiveFigure { x_label: &figure.x_label, x: ends(&widened(&figure.x, 0.0)), is_count: figure.is_count, panels }
}

fn live_panel<'a>(panel: &'a Panel, arrays: &mut Arrays) -> LivePanel<'a> {
    let y = panel.y.as_ref().map_or_else(|| panel.height_range(), |y| widened(y, 0.0));
    LivePanel {
        label: &panel.label,
        height: panel.height,
        y: ends(&y),
        axes: match panel.axes {
            Axes::Left => "left",
            Axes::Both => "both",
            Axes::Strip => "strip",
        },
        empty: if panel.is_empty() { &panel.empty } else { "" },
        layers: panel.layers.iter().flat_map(|layer| live_layers(layer, arrays)).collect(),
    }
}

const fn word(stroke: Stroke) -> &'static str {
    match stroke {
        Stroke::Solid => "solid",
        Stroke::Thin => "thin",
        Stroke::Dashed => "dashed",
        Stroke::Dotted => "dotted",
    }
}

/// Lines one after the other, a gap between two.
fn joined<'a>(lines: impl Iterator<Item = &'a [Option<(Real, Real)>]>) -> Vec<Option<(Real, Real)>> {
    let mut all = Vec::new();
    for line in lines {
        if !all.is_empty() {
            all.push(None);
        }
        all.extend_from_slice(line);
    }
    all
}

fn line<'a>(
    legend: &'a str,
    colour: String,
    stroke: Stroke,
    points: &[Option<(Real, Real)>],
    arrays: &mut Arrays,
) -> LiveLayer<'a> {
    LiveLayer {
        kind: "line",
        legend,
        colour,
        stroke: word(stroke),
        x: arrays.place(points.iter().map(|point| point.map(|p| p.0))),
        y: arrays.place(points.iter().map(|point| point.map(|p| p.1))),
        ..LiveLayer::default()
    }
}

fn points<'a>(kind: &'static str, legend: &'a str, points: &[(Real, Real)], arrays: &mut Arrays) -> LiveLayer<'a> {
    let x = arrays.place(points.iter().map(|p| Some(p.0)));
    let y = arrays.place(points.iter().map(|p| Some(p.1)));
    LiveLayer { kind, legend, x, y, ..LiveLayer::default() }
}

fn bars<'a>(legend: &'a str, colour: String, spans: &[Range<Real>], arrays: &mut Arrays) -> LiveLayer<'a> {
    let finite = || spans.iter().filter(|span| span.start.is_finite() && span.end.is_finite());
    let x = arrays.place(finite().map(|span| Some(span.start)));
    let to = arrays.place(finite().map(|span| Some(span.end)));
    LiveLayer { kind: "bars", legend, colour, x, to, ..LiveLayer::default() }
}

fn pieces<'a>(
    (legend, colour): &'a (String, RGBColor),
    all: &[(RGBColor, Vec<Point>)],
    arrays: &mut Arrays,
) -> LiveLayer<'a> {
    let same = all.iter().filter(|piece| piece.0 == *colour);
    let lines: Vec<Vec<_>> = same.map(|(_, points)| points.iter().copied().map(Some).collect()).collect();
    line(legend, css(*colour), Stroke::Solid, &joined(lines.iter().map(Vec::as_slice)), arrays)
}

fn band<'a>(legend: &'a str, points: &[Option<(Real, Real, Real)>], arrays: &mut Arrays) -> LiveLayer<'a> {
    let mut place =
        |of: fn((Real, Real, Real)) -> Real| arrays.place(points.iter().map(|point| point.filter(is_whole).map(of)));
    let (x, y, high) = (place(|p| p.0), place(|p| p.1), place(|p| p.2));
    LiveLayer { kind: "band", legend, x, y, high, ..LiveLayer::default() }
}

fn columns<'a>(legend: &'a str, bins: &[(Range<Real>, Real)], arrays: &mut Arrays) -> LiveLayer<'a> {
    let x = arrays.place(bins.iter().map(|(bin, _)| Some(bin.start)));
    let to = arrays.place(bins.iter().map(|(bin, _)| Some(bin.end)));
    let y = arrays.place(bins.iter().map(|(_, count)| Some(*count)));
    LiveLayer { kind: "columns", legend, x, to, y, ..LiveLayer::default() }
}

fn cells<'a>(
    legend: &'a str,
    colour: RGBColor,
    cells: &[(Range<Real>, Range<Real>, Real)],
    arrays: &mut Arrays,
) -> LiveLayer<'a> {
    LiveLayer {
        kind: "cells",
        legend,
        colour: css(colour),
        many: true,
        x: arrays.place(cells.iter().map(|(x, ..)| Some(x.start))),
        to: arrays.place(cells.iter().map(|(x, ..)| Some(x.end))),
        y: arrays.place(cells.iter().map(|(_, y, _)| Some(y.start))),
        high: arrays.place(cells.iter().map(|(_, y, _)| Some(y.end))),
        strength: arrays.place(cells.iter().map(|(.., strength)| Some(*strength))),
        ..LiveLayer::default()
    }
}

fn live_layers<'a>(layer: &'a Layer, arrays: &mut Arrays) -> Vec<LiveLayer<'a>> {
    let one = match layer {
        Layer::Line { legend, colour, stroke, points } => line(legend, css(*colour), *stroke, points, arrays),
        Layer::Threads { legend, colour, opacity, lines } => {
            let points = joined(lines.iter().map(Vec::as_slice));
            let opacity = single(*opacity);
            LiveLayer { many: true, opacity, ..line(legend, css(*colour), Stroke::Thin, &points, arrays) }
        }
        Layer::Pieces { legends, pieces: all } => {
            return legends.iter().map(|named| pieces(named, all, arrays)).collect();
        }
        Layer::Band { legend, colour, opacity, points } => {
            LiveLayer { colour: css(*colour), opacity: single(*opacity), ..band(legend, points, arrays) }
        }
        Layer::Spans { legend, colour, opacity, spans } => {
            LiveLayer { opacity: single(*opacity), ..bars(legend, css(*colour), spans, arrays) }
        }
        Layer::Bars { legend, colour, spans, heights } => {
            LiveLayer { heights: Some(ends(heights)), ..bars(legend, css(*colour), spans, arrays) }
        }
        Layer::Marks { legend, colour, points: all } => {
            LiveLayer { colour: css(*colour), ..points("marks", legend, all, arrays) }
        }
        Layer::Dots { legend, colour, opacity, points: all } => {
            LiveLayer { colour: css(*colour), opacity: single(*opacity), ..points("dots", legend, all, arrays) }
        }
        Layer::Verticals { legend, colour, stroke, at } => {
            let x = arrays.place(at.iter().map(|at| Some(*at)));
            let (colour, stroke) = (css(*colour), word(*stroke));
            LiveLayer { kind: "verticals", legend, colour, stroke, x, ..LiveLayer::default() }
        }
        Layer::Histogram { legend, colour, opacity, bins } => {
            LiveLayer { colour: css(*colour), opacity: single(*opacity), ..columns(legend, bins, arrays) }
        }
        Layer::Cells { legend, colour, cells: all } => cells(legend, *colour, all, arrays),
        Layer::Word { text, y } => {
            LiveLayer { kind: "word", word: single(*y).map(|y| (text.as_str(), y)), ..LiveLayer::default() }
        }
    };
    vec![one]
}

fn is_whole(point: &(Real, Real, Real)) -> bool {
    point.0.is_finite() && point.1.is_finite() && point.2.is_finite()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Value;

    const BLUE: RGBColor = RGBColor(0, 84, 190);

    fn figure(x: [Real; 3], layers: Vec<Layer>) -> Figure {
        Figure::new("speed", "", "location, km", x[0]..x[2], [Panel::new("speed, km/h", 200, layers, "none")])
    }

    fn line(x: [Real; 3]) -> Layer {
        let points = [(x[0], 1.0), (x[1], Real::NAN), (x[2], 3.0)].map(Some);
        Layer::line("measured", BLUE, Stroke::Dotted, points.to_vec())
    }

    fn parsed(drawing: &Drawing) -> Value {
        serde_json::from_str(&drawing.live()).unwrap()
    }

    #[test]
    fn both_axes_share_their_heights_and_a_gap_is_null() {
        let [first, second] = [("location", [0.0, 1.0, 2.0]), ("time", [0.0, 50.0, 90.0])]
            .map(|(name, x)| (name, figure(x, vec![line(x)])));
        let live = parsed(&Drawing::Switched { first, second });
        let layer = |view: usize| &live["views"][view]["figures"][0]["panels"][0]["layers"][0];
        assert_eq!(layer(0)["y"], layer(1)["y"]);
        assert_ne!(layer(0)["x"], layer(1)["x"]);
        assert_eq!(live["arrays"].as_array().unwrap().len(), 3);
        assert_eq!(live["arrays"][layer(0)["y"].as_u64().unwrap() as usize], serde_json::json!([1.0, null, 3.0]));
        assert_eq!(live["views"][1]["name"], "time");
    }

    #[test]
    fn names_cannot_end_the_script_they_stand_in() {
        let mut figure = figure([0.0, 1.0, 2.0], vec![]);
        figure.title = "</script><b>".to_owned();
        let drawing = Drawing::from(figure);
        assert!(!drawing.live().contains('<'));
        assert_eq!(parsed(&drawing)["title"], "</script><b>");
        assert_eq!(parsed(&drawing)["views"][0]["figures"][0]["panels"][0]["empty"], "none");
    }

    #[test]
    fn pieces_of_a_colour_are_one_line_with_gaps() {
        let red = RGBColor(200, 0, 0);
        let pieces = vec![
            (BLUE, vec![(0.0, 1.0), (1.0, 2.0)]),
            (red, vec![(1.0, 2.0), (2.0, 2.0)]),
            (BLUE, vec![(2.0, 2.0), (3.0, 1.0)]),
        ];
        let legends = vec![("coast".to_owned(), BLUE), ("brake".to_owned(), red)];
        let live = parsed(&figure([0.0, 1.0, 3.0], vec![Layer::Pieces { legends, pieces }]).into());
        let layers = live["views"][0]["figures"][0]["panels"][0]["layers"].as_array().unwrap();
        assert_eq!(
            layers.iter().map(|layer| layer["legend"].as_str().unwrap()).collect::<Vec<_>>(),
            ["coast", "brake"]
        );
        let x = &live["arrays"][layers[0]["x"].as_u64().unwrap() as usize];
        assert_eq!(*x, serde_json::json!([0.0, 1.0, null, 2.0, 3.0]));
    }
}
