//! A figure as inline SVG: panels one above the other on a common x axis.
//!
//! In: a [`Figure`], which says what is drawn and not how. Out: `<svg>` for the body of an HTML page, without a name space
//! (so it names no address), with `viewBox`, title and description for those who hear the page.
//!
//! A value that is not there or not finite is a gap. The SVG back end has whole coordinates, so the canvas is about twice as fine
//! as the screen; more points than it has columns are thinned to first, least, largest and last of each column.

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use rundown::Real;
use std::ops::Range;

/// Width of the canvas.
const WIDTH: u32 = 2000;
/// Height of the line above a panel with its label and legend.
const HEADER: u32 = 52;
/// Height of each further row of the legend.
const LEGEND_ROW: u32 = 36;
/// Space for the y labels; the same in all figures, so that they align.
const LEFT: u32 = 130;
/// Space for the last x label, or the labels of a right axis.
const RIGHT: u32 = 50;
/// Space for x labels and the axis' name.
const BOTTOM: u32 = 86;
/// Space below a panel that has another below it.
const BETWEEN: u32 = 14;
/// Size of text on the canvas, about 13 px on the screen. The back end divides by 1.24.
const TEXT: u32 = 30;
/// Columns to which series are thinned.
const COLUMNS: Real = 900.0;

const GRID: RGBColor = RGBColor(228, 228, 228);
const AXIS: RGBColor = RGBColor(110, 110, 110);
const INK: RGBColor = RGBColor(30, 30, 30);

type Canvas<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Plot<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
type DrawingError = DrawingAreaErrorKind<std::io::Error>;

/// A picture with one x axis.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Its name, also for those who hear the page.
    pub title: String,
    /// What can be seen, in a sentence.
    pub description: String,
    /// Name of the x axis with its unit.
    pub x_label: String,
    /// Ends of the x axis; widened when empty.
    pub x: Range<Real>,
    /// From top to bottom.
    pub panels: Vec<Panel>,
}

/// One plot of a figure.
#[derive(Clone, Debug)]
pub struct Panel {
    /// Name of the y axis with its unit.
    pub label: String,
    /// Height of the plot on the canvas.
    pub height: u32,
    /// Ends of the y axis; none: what the layers need.
    pub y: Option<Range<Real>>,
    /// How the y axis is labelled.
    pub axes: Axes,
    /// From back to front.
    pub layers: Vec<Layer>,
    /// Said in the plot when it has no values.
    pub empty: String,
}

/// Where a panel has y labels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Axes {
    /// On the left.
    #[default]
    Left,
    /// On both sides, in the same scale.
    Both,
    /// Nowhere: the heights mean nothing.
    Strip,
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stroke {
    /// Solid, thick.
    Solid,
    /// Solid, thin.
    Thin,
    /// Dashed.
    Dashed,
    /// Dotted.
    Dotted,
}

/// A place in the plot.
pub type Point = (Real, Real);

/// A name in the legend; empty: none.
pub type Legend = String;

/// A part of a panel.
#[derive(Clone, Debug)]
pub enum Layer {
    /// Points joined by a line; none is a gap.
    Line {
        /// Name.
        legend: Legend,
        /// Colour.
        colour: RGBColor,
        /// Solid, dashed or dotted.
        stroke: Stroke,
        /// Where it goes.
        points: Vec<Option<Point>>,
    },
    /// The area between two heights (x, lower, upper); none is a gap.
    Band {
        /// Name.
        legend: Legend,
        /// Colour.
        colour: RGBColor,
        /// 0 to 1.
        opacity: Real,
        /// Where it goes.
        points: Vec<Option<(Real, Real, Real)>>,
    },
    /// Lines of one legend entry for each colour.
    Pieces {
        /// Name and colour.
        legends: Vec<(Legend, RGBColor)>,
        /// The lines.
        pieces: Vec<(RGBColor, Vec<Point>)>,
    },
    /// Background over the whole height.
    Spans {
        /// Name.
        legend: Legend,
        /// Colour.
        colour: RGBColor,
        /// Opacity.
        opacity: Real,
        /// From, to.
        spans: Vec<Range<Real>>,
    },
    /// Crosses.
    Marks {
        /// Name.
        legend: Legend,
        /// Colour.
        colour: RGBColor,
        /// Where they are.
        points: Vec<Point>,
    },
    /// Rectangles between two heights.
    Bars {
        /// Name.
        legend: Legend,
        /// Colour.
        colour: RGBColor,
        /// From, to.
        spans: Vec<Range<Real>>,
        /// Lower and upper edge.
        heights: Range<Real>,
    },
    /// A word at the left end, above a height.
    Word {
        /// What it says.
        text: String,
        /// Height of its lower edge.
        y: Real,
    },
}

impl Figure {
    /// The picture. What cannot be drawn says so in its place.
    pub fn to_svg(&self) -> String {
        let height: u32 = self
            .panels
            .iter()
            .map(|p| p.header() + p.height + BETWEEN)
            .sum();
        let size = (WIDTH, height + BOTTOM);
        let mut drawing = String::new();
        let drawn = {
            let root = SVGBackend::with_string(&mut drawing, size).into_drawing_area();
            self.draw(&root, size).and_then(|()| root.present())
        };
        // The back end's own first tag is replaced, its last one is there after `present`.
        let body = match (drawn, drawing.split_once('>')) {
            (Ok(()), Some((_, body))) => body.to_owned(),
            (Ok(()), None) => "</svg>".to_owned(),
            (Err(error), _) => format!(
                "<text x=\"20\" y=\"60\" font-size=\"26\">This figure could not be drawn: {}</text></svg>",
                escaped(&error.to_string())
            ),
        };
        let (title, description) = (escaped(&self.title), escaped(&self.description));
        let (width, height) = size;
        format!(
            "<svg viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{title}. {description}\">\n\
             <title>{title}</title><desc>{description}</desc>{body}"
        )
    }

    fn draw(&self, root: &Canvas, (width, _): (u32, u32)) -> Result<(), DrawingError> {
        root.fill(&WHITE)?;
        let x = widened(&self.x, 0.0);
        let mut top = 0;
        for (index, panel) in self.panels.iter().enumerate() {
            let is_last = index + 1 == self.panels.len();
            let below = if is_last { BOTTOM } else { BETWEEN };
            let area = root
                .clone()
                .shrink((0, top), (width, panel.header() + panel.height + below));
            self.draw_panel(&area, panel, x.clone(), is_last)?;
            top += (panel.header() + panel.height + BETWEEN) as i32;
        }
        Ok(())
    }

    fn draw_panel(
        &self,
        area: &Canvas,
        panel: &Panel,
        x: Range<Real>,
        is_last: bool,
    ) -> Result<(), DrawingError> {
        draw_header(area, panel)?;
        let y = match &panel.y {
            Some(y) => widened(y, 0.0),
            None => panel.height_range(),
        };
        let right = if panel.axes == Axes::Both {
            LEFT
        } else {
            RIGHT
        };
        let mut builder = ChartBuilder::on(area);
        builder
            .margin_top(panel.header())
            .set_label_area_size(LabelAreaPosition::Left, LEFT)
            .set_label_area_size(
                LabelAreaPosition::Bottom,
                if is_last { BOTTOM } else { BETWEEN },
            )
            .set_label_area_size(LabelAreaPosition::Right, right);
        let mut plot = builder
            .build_cartesian_2d(x.clone(), y.clone())?
            .set_secondary_coord(x.clone(), y.clone());
        let y_labels = if panel.height > 300 { 9 } else { 5 };
        let digits = |range: &Range<Real>, labels: Real| {
            let step = (range.end - range.start) / labels;
            (1.0 - step.log10()).ceil().clamp(0.0, 12.0) as usize
        };
        let (x_digits, y_digits) = (digits(&x, 12.0), digits(&y, y_labels as Real));
        let has_y = panel.axes != Axes::Strip;
        let x_text = |value: &Real| {
            if is_last {
                tick(*value, x_digits)
            } else {
                String::new()
            }
        };
        let y_text = |value: &Real| {
            if has_y {
                tick(*value, y_digits)
            } else {
                String::new()
            }
        };
        let text = ("sans-serif", TEXT).into_font().color(&INK);
        let mut mesh = plot.configure_mesh();
        mesh.x_labels(12)
            .y_labels(y_labels)
            .max_light_lines(0)
            .bold_line_style(GRID.stroke_width(2))
            .axis_style(AXIS.stroke_width(2))
            .label_style(text.clone())
            .x_label_formatter(&x_text)
            .y_label_formatter(&y_text);
        if !has_y {
            mesh.disable_y_mesh()
                .set_tick_mark_size(LabelAreaPosition::Left, 0);
        }
        if is_last {
            mesh.x_desc(self.x_label.as_str())
                .axis_desc_style(text.clone());
        }
        mesh.draw()?;
        if panel.axes == Axes::Both {
            plot.configure_secondary_axes()
                .y_labels(y_labels)
                .axis_style(AXIS.stroke_width(2))
                .label_style(text)
                .y_label_formatter(&y_text)
                .draw()?;
        }
        if has_y && y.start < 0.0 && y.end > 0.0 {
            let zero = [(x.start, 0.0), (x.end, 0.0)];
            plot.draw_series([PathElement::new(zero, AXIS.stroke_width(2))])?;
        }
        for layer in &panel.layers {
            layer.draw(&mut plot, &x, &y)?;
        }
        if panel.is_empty() {
            let middle = (0.5 * (x.start + x.end), 0.5 * (y.start + y.end));
            let style = ("sans-serif", TEXT)
                .into_font()
                .color(&AXIS)
                .pos(Pos::new(HPos::Center, VPos::Center));
            plot.draw_series([Text::new(panel.empty.clone(), middle, style)])?;
        }
        Ok(())
    }
}

/// The panel's label, then the legend.
fn draw_header(area: &Canvas, panel: &Panel) -> Result<(), DrawingError> {
    let style = |weight| {
        ("sans-serif", TEXT, weight)
            .into_font()
            .color(&INK)
            .pos(Pos::new(HPos::Left, VPos::Center))
    };
    let label = Text::new(
        panel.label.clone(),
        (LEFT as i32, middle_of(0)),
        style(FontStyle::Bold),
    );
    area.draw(&label)?;
    for entry in panel.entries() {
        let (left, middle, colour) = (entry.left, middle_of(entry.row), entry.colour);
        match entry.swatch {
            Swatch::Line(Stroke::Dashed) => {
                for dash in 0..3 {
                    let start = left + 20 * dash;
                    let line = [(start, middle), (start + 13, middle)];
                    area.draw(&PathElement::new(line, colour.stroke_width(4)))?;
                }
            }
            Swatch::Line(Stroke::Dotted) => {
                for dot in 0..6 {
                    let start = left + 10 * dot;
                    let line = [(start, middle), (start + 4, middle)];
                    area.draw(&PathElement::new(line, colour.stroke_width(5)))?;
                }
            }
            Swatch::Line(_) => {
                let line = [(left, middle), (left + SWATCH, middle)];
                area.draw(&PathElement::new(line, colour.stroke_width(5)))?;
            }
            Swatch::Area(opacity) => area.draw(&Rectangle::new(
                [(left, middle - 12), (left + SWATCH, middle + 12)],
                colour.mix(opacity).filled(),
            ))?,
            Swatch::Mark => area.draw(&Cross::new(
                (left + SWATCH / 2, middle),
                9,
                colour.stroke_width(4),
            ))?,
        }
        let place = (left + SWATCH + 10, middle);
        area.draw(&Text::new(
            entry.legend.to_owned(),
            place,
            style(FontStyle::Normal),
        ))?;
    }
    Ok(())
}

/// Width of the sample of a line or area in a legend.
const SWATCH: i32 = 54;

/// Middle of a row of the header.
fn middle_of(row: u32) -> i32 {
    (row * LEGEND_ROW + HEADER / 2 + 6) as i32
}

/// A place in the legend.
struct Entry<'a> {
    legend: &'a str,
    colour: RGBColor,
    swatch: Swatch,
    left: i32,
    row: u32,
}

/// Nobody here knows the reader's font: an estimate on the wide side.
fn text_width(text: &str, stretch: Real) -> i32 {
    (text.chars().count() as Real * 13.2 * stretch) as i32
}

enum Swatch {
    Line(Stroke),
    Area(Real),
    Mark,
}

impl Layer {
    fn legends(&self) -> Vec<(&str, RGBColor, Swatch)> {
        let all = match self {
            Self::Line {
                legend,
                colour,
                stroke,
                ..
            } => vec![(legend.as_str(), *colour, Swatch::Line(*stroke))],
            Self::Band {
                legend,
                colour,
                opacity,
                ..
            }
            | Self::Spans {
                legend,
                colour,
                opacity,
                ..
            } => vec![(legend.as_str(), *colour, Swatch::Area(*opacity))],
            Self::Pieces { legends, .. } => legends
                .iter()
                .map(|(legend, colour)| (legend.as_str(), *colour, Swatch::Line(Stroke::Solid)))
                .collect(),
            Self::Marks { legend, colour, .. } => vec![(legend.as_str(), *colour, Swatch::Mark)],
            Self::Bars { legend, colour, .. } => {
                vec![(legend.as_str(), *colour, Swatch::Area(1.0))]
            }
            Self::Word { .. } => Vec::new(),
        };
        all.into_iter()
            .filter(|(legend, ..)| !legend.is_empty())
            .collect()
    }

    /// Heights of everything in it.
    fn heights(&self) -> Vec<Real> {
        match self {
            Self::Line { points, .. } => points.iter().flatten().map(|p| p.1).collect(),
            Self::Band { points, .. } => points.iter().flatten().flat_map(|p| [p.1, p.2]).collect(),
            Self::Pieces { pieces, .. } => pieces
                .iter()
                .flat_map(|(_, points)| points)
                .map(|p| p.1)
                .collect(),
            Self::Marks { points, .. } => points.iter().map(|p| p.1).collect(),
            Self::Spans { .. } | Self::Bars { .. } | Self::Word { .. } => Vec::new(),
        }
    }

    fn draw(&self, plot: &mut Plot, x: &Range<Real>, y: &Range<Real>) -> Result<(), DrawingError> {
        match self {
            Self::Line {
                colour,
                stroke,
                points,
                ..
            } => {
                for points in unbroken(points) {
                    draw_line(plot, &thinned(&points, x), *colour, *stroke)?;
                }
            }
            Self::Band {
                colour,
                opacity,
                points,
                ..
            } => {
                for points in unbroken(points) {
                    draw_band(plot, &points, x, colour.mix(*opacity))?;
                }
            }
            Self::Pieces { pieces, .. } => {
                for (colour, points) in pieces {
                    let points: Vec<_> = points.iter().copied().map(Some).collect();
                    for points in unbroken(&points) {
                        draw_line(plot, &thinned(&points, x), *colour, Stroke::Solid)?;
                    }
                }
            }
            Self::Spans {
                colour,
                opacity,
                spans,
                ..
            } => draw_bars(plot, spans, x, y, colour.mix(*opacity))?,
            Self::Bars {
                colour,
                spans,
                heights,
                ..
            } => draw_bars(plot, spans, x, heights, colour.mix(1.0))?,
            Self::Marks { colour, points, .. } => {
                let finite = points.iter().copied().filter(Finite::is_finite);
                let points = thinned(&finite.collect::<Vec<Point>>(), x);
                let marks = points
                    .iter()
                    .map(|point| Cross::new(*point, 8, colour.stroke_width(3)));
                plot.draw_series(marks)?;
            }
            Self::Word { text, y } => {
                let style = ("sans-serif", TEXT)
                    .into_font()
                    .color(&INK)
                    .pos(Pos::new(HPos::Left, VPos::Bottom));
                let indent = 0.005 * (x.end - x.start);
                plot.draw_series([Text::new(text.clone(), (x.start + indent, *y), style)])?;
            }
        }
        Ok(())
    }
}

impl Panel {
    /// The legend from left to right, on a new row where the canvas ends.
    fn entries(&self) -> Vec<Entry<'_>> {
        let beside_label = LEFT as i32 + text_width(&self.label, 1.08) + 50;
        let (mut left, mut row) = (beside_label, 0);
        let mut entries = Vec::new();
        for (legend, colour, swatch) in self.layers.iter().flat_map(Layer::legends) {
            let width = SWATCH + 10 + text_width(legend, 1.0);
            if left + width > WIDTH as i32 && left > beside_label {
                (left, row) = (beside_label, row + 1);
            }
            entries.push(Entry {
                legend,
                colour,
                swatch,
                left,
                row,
            });
            left += width + 40;
        }
        entries
    }

    fn header(&self) -> u32 {
        let rows = self.entries().last().map_or(0, |entry| entry.row);
        HEADER + rows * LEGEND_ROW
    }

    fn is_empty(&self) -> bool {
        let drawn = |layer: &Layer| match layer {
            // A limit or the manufacturer's value alone says nothing of the run.
            Layer::Line { stroke, points, .. } => {
                *stroke != Stroke::Dashed && points.iter().flatten().any(Finite::is_finite)
            }
            Layer::Bars { spans, .. } => !spans.is_empty(),
            Layer::Spans { .. } | Layer::Word { .. } => false,
            other => other.heights().iter().any(|height| height.is_finite()),
        };
        !self.layers.iter().any(drawn)
    }

    fn height_range(&self) -> Range<Real> {
        let heights = self.layers.iter().flat_map(Layer::heights);
        widened(&range_of(heights), 0.06)
    }
}

fn draw_line(
    plot: &mut Plot,
    points: &[Point],
    colour: RGBColor,
    stroke: Stroke,
) -> Result<(), DrawingError> {
    if let [point] = points {
        // Between two gaps: a line of one point would not be seen.
        plot.draw_series([Circle::new(*point, 4, colour.filled())])?;
        return Ok(());
    }
    let points = points.iter().copied();
    match stroke {
        Stroke::Solid => plot.draw_series(LineSeries::new(points, colour.stroke_width(5)))?,
        Stroke::Thin => plot.draw_series(LineSeries::new(points, colour.stroke_width(3)))?,
        Stroke::Dashed => plot.draw_series(DashedLineSeries::new(
            points,
            18,
            12,
            colour.stroke_width(4),
        ))?,
        Stroke::Dotted => {
            plot.draw_series(DashedLineSeries::new(points, 4, 8, colour.stroke_width(5)))?
        }
    };
    Ok(())
}

fn draw_band(
    plot: &mut Plot,
    points: &[(Real, Real, Real)],
    x: &Range<Real>,
    colour: RGBAColor,
) -> Result<(), DrawingError> {
    let edge = |pick: fn(&(Real, Real, Real)) -> Real| -> Vec<Point> {
        let edge: Vec<Point> = points.iter().map(|point| (point.0, pick(point))).collect();
        thinned(&edge, x)
    };
    let (lower, upper) = (edge(|p| p.1), edge(|p| p.2));
    if let ([lower], [upper]) = (lower.as_slice(), upper.as_slice()) {
        let line = PathElement::new([*lower, *upper], colour.stroke_width(8));
        plot.draw_series([line])?;
        return Ok(());
    }
    let outline: Vec<Point> = lower.into_iter().chain(upper.into_iter().rev()).collect();
    plot.draw_series([Polygon::new(outline, colour)])?;
    Ok(())
}

fn draw_bars(
    plot: &mut Plot,
    spans: &[Range<Real>],
    x: &Range<Real>,
    heights: &Range<Real>,
    colour: RGBAColor,
) -> Result<(), DrawingError> {
    // A single sample must still be seen, and what is closer than that cannot be told apart.
    let least = 0.0015 * (x.end - x.start);
    let mut merged: Vec<Range<Real>> = Vec::new();
    for span in spans
        .iter()
        .filter(|span| (span.start, span.end).is_finite())
    {
        let (start, end) = (span.start.min(span.end), span.start.max(span.end));
        let end = end.max(start + least);
        match merged.last_mut() {
            Some(last) if start >= last.start && start - last.end < 0.3 * least => {
                last.end = last.end.max(end);
            }
            _ => merged.push(start..end),
        }
    }
    let bar = |span: Range<Real>| {
        Rectangle::new(
            [(span.start, heights.start), (span.end, heights.end)],
            colour.filled(),
        )
    };
    plot.draw_series(merged.into_iter().map(bar))?;
    Ok(())
}

/// All numbers of a point can be drawn.
trait Finite {
    fn is_finite(&self) -> bool;
}

impl Finite for Point {
    fn is_finite(&self) -> bool {
        self.0.is_finite() && self.1.is_finite()
    }
}

impl Finite for (Real, Real, Real) {
    fn is_finite(&self) -> bool {
        self.0.is_finite() && self.1.is_finite() && self.2.is_finite()
    }
}

/// The stretches without a gap.
fn unbroken<P: Copy + Finite>(points: &[Option<P>]) -> Vec<Vec<P>> {
    points
        .split(|point| !point.is_some_and(|point| point.is_finite()))
        .map(|stretch| stretch.iter().flatten().copied().collect::<Vec<P>>())
        .filter(|stretch| !stretch.is_empty())
        .collect()
}

/// First, least, largest and last point of each column, in their order, where there are more points than columns.
fn thinned(points: &[Point], x: &Range<Real>) -> Vec<Point> {
    if points.len() as Real <= 4.0 * COLUMNS {
        return points.to_vec();
    }
    let column = |point: &Point| (COLUMNS * (point.0 - x.start) / (x.end - x.start)).floor();
    let mut kept = Vec::new();
    for points in points.chunk_by(|a, b| column(a) == column(b)) {
        let by_height = |a: &(usize, &Point), b: &(usize, &Point)| a.1.1.total_cmp(&b.1.1);
        let least = points.iter().enumerate().min_by(by_height);
        let largest = points.iter().enumerate().max_by(by_height);
        let mut indexes = vec![0, points.len() - 1];
        indexes.extend(least.into_iter().chain(largest).map(|(index, _)| index));
        indexes.sort_unstable();
        indexes.dedup();
        kept.extend(indexes.into_iter().map(|index| points[index]));
    }
    kept
}

/// Least and largest of the finite values; 0 to 1 when there is none.
pub fn range_of(values: impl IntoIterator<Item = Real>) -> Range<Real> {
    values
        .into_iter()
        .filter(|value| value.is_finite())
        .map(|value| value..value)
        .reduce(|a, b| a.start.min(b.start)..a.end.max(b.end))
        .unwrap_or(0.0..1.0)
}

/// With some air, and never empty.
fn widened(range: &Range<Real>, air: Real) -> Range<Real> {
    let (start, end) = (range.start.min(range.end), range.start.max(range.end));
    if !(start, end).is_finite() {
        return 0.0..1.0;
    }
    let least = 1e-9 * start.abs().max(end.abs());
    let margin = if end - start > least {
        air * (end - start)
    } else {
        (0.05 * start.abs()).max(1e-6)
    };
    start - margin..end + margin
}

/// A number of an axis, without zeros that say nothing.
fn tick(value: Real, digits: usize) -> String {
    let text = format!("{value:.digits$}");
    let text = match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.'),
        false => &text,
    };
    if text == "-0" {
        "0".to_owned()
    } else {
        text.replace('-', "\u{2212}")
    }
}

fn escaped(text: &str) -> String {
    maud::Render::render(text).into_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure(layers: Vec<Layer>) -> Figure {
        Figure {
            title: "a < b".to_owned(),
            description: "\"quoted\" & more".to_owned(),
            x_label: "location, km".to_owned(),
            x: 0.0..10.0,
            panels: vec![Panel {
                label: "speed, km/h".to_owned(),
                height: 200,
                y: None,
                axes: Axes::Left,
                layers,
                empty: "no estimate: no samples".to_owned(),
            }],
        }
    }

    fn line(points: Vec<Option<Point>>) -> Layer {
        Layer::Line {
            legend: "estimated".to_owned(),
            colour: RGBColor(1, 2, 3),
            stroke: Stroke::Solid,
            points,
        }
    }

    fn count(text: &str, needle: &str) -> usize {
        text.matches(needle).count()
    }

    #[test]
    fn a_gap_breaks_the_line_and_a_lonely_point_is_a_dot() {
        let nan = Real::NAN;
        let points = [
            (0.0, 1.0),
            (1.0, 2.0),
            (2.0, nan),
            (3.0, 1.0),
            (nan, 1.0),
            (5.0, 1.0),
            (6.0, 2.0),
        ];
        let svg = figure(vec![line(points.map(Some).to_vec())]).to_svg();
        let mine = "stroke=\"#010203\"";
        assert_eq!(
            count(&svg, &format!("opacity=\"1\" {mine}")),
            3,
            "legend and two lines"
        );
        assert_eq!(count(&svg, "<circle"), 1);
        assert!(!svg.contains("NaN"));
    }

    #[test]
    fn without_values_the_reason_stands_in_the_plot() {
        for layers in [
            vec![],
            vec![line(vec![None])],
            vec![line(vec![Some((Real::NAN, 1.0))])],
        ] {
            let svg = figure(layers).to_svg();
            assert!(svg.contains("no estimate: no samples"));
            assert!(!svg.contains("NaN") && !svg.contains("inf"));
        }
        let svg = figure(vec![line(vec![Some((1.0, 1.0))])]).to_svg();
        assert!(!svg.contains("no estimate"));
    }

    #[test]
    fn the_picture_names_no_address_and_is_well_formed() {
        let svg = figure(vec![line(vec![Some((0.0, 0.0)), Some((1.0, 1.0))])]).to_svg();
        assert!(!svg.contains("http"));
        assert!(svg.contains("<title>a &lt; b</title><desc>&quot;quoted&quot; &amp; more</desc>"));
        assert!(svg.starts_with("<svg viewBox") && svg.trim_end().ends_with("</svg>"));
        assert_eq!(count(&svg, "<svg"), 1);
        assert_eq!(count(&svg, "</svg>"), 1);
    }

    #[test]
    fn thinning_keeps_the_ends_and_the_peaks() {
        let mut points: Vec<Point> = (0..100_000).map(|i| (Real::from(i), 0.0)).collect();
        points[54_321].1 = 7.0;
        points[54_322].1 = -7.0;
        let thin = thinned(&points, &(0.0..1e5));
        assert!(thin.len() < 3000, "{}", thin.len());
        for index in [0, 54_321, 54_322, 99_999] {
            assert!(thin.contains(&points[index]), "{index}");
        }
        assert!(thin.is_sorted_by(|a, b| a.0 < b.0));
        assert_eq!(thinned(&points[..50], &(0.0..1e5)), points[..50]);
    }

    #[test]
    fn a_range_is_never_empty() {
        assert_eq!(range_of([Real::NAN]), 0.0..1.0);
        assert_eq!(range_of([2.0, Real::INFINITY, -1.0]), -1.0..2.0);
        for range in [0.0..0.0, 5.0..5.0, 7.38..7.38 + 1e-15, Real::NAN..1.0] {
            let wide = widened(&range, 0.1);
            assert!(wide.end - wide.start > 1e-7, "{range:?}");
        }
    }

    #[test]
    fn ticks_have_no_needless_digits() {
        assert_eq!(tick(0.30000000000000004, 3), "0.3");
        assert_eq!(tick(120.0, 0), "120");
        assert_eq!(tick(-0.0001, 2), "0");
        assert_eq!(tick(-0.25, 2), "\u{2212}0.25");
    }
}
