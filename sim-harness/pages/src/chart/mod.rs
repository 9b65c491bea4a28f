//! A figure as inline SVG: panels one above the other on a common x axis, or a [`Grid`] of such figures.
//!
//! In: a [`Figure`], which says what is drawn and not how. Out: `<svg>` for the body of an HTML page, without a name
//! space (so it names no address), with `viewBox`, title and description for those who hear the page.
//!
//! A value that is not there or not finite is a gap. The SVG back end has whole coordinates, so the canvas is about
//! twice as fine as the screen; more points than it has columns are thinned to first, least, largest and last of each
//! column.

mod build;
mod drawing;
mod header;
mod layers;
mod live;
mod names;
mod scale;

pub use drawing::Drawing;
pub use scale::range_of;

use header::{draw_header, text_width};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::{coord::Shift, coord::types::RangedCoordf64};
use rundown::Real;
use scale::{tick, whole_numbers, widened};
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
const RIGHT: u32 = 60;

/// Space for x labels and the axis' name.
const BOTTOM: u32 = 86;

/// Space below a panel that has another below it.
const BETWEEN: u32 = 14;

/// Size of text on the canvas, about 13 px on the screen. The back end divides by 1.24.
const TEXT: u32 = 30;

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
    /// Kinds on the x axis of the SVG, in place of numbers: where each stands, and its name.
    pub names: Vec<(Real, String)>,
    /// What the x axis counts has no halves: only whole numbers stand on it.
    pub is_count: bool,
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
#[expect(missing_docs, reason = "as it looks")]
pub enum Stroke {
    Solid,
    Thin,
    Dashed,
    Dotted,
}

/// A place in the plot.
pub type Point = (Real, Real);

/// A part of a panel; [`Layer::line`] and its sisters make one.
///
/// `legend` is its name, none where it is empty; `opacity` is 0 to 1; no point is a gap.
#[derive(Clone, Debug)]
#[expect(missing_docs, reason = "the same few fields in each")]
pub enum Layer {
    /// Points joined by a line.
    Line { legend: String, colour: RGBColor, stroke: Stroke, points: Vec<Option<Point>> },
    /// The area between two heights (x, lower, upper).
    Band { legend: String, colour: RGBColor, opacity: Real, points: Vec<Option<(Real, Real, Real)>> },
    /// Lines of one legend entry for each colour.
    Pieces { legends: Vec<(String, RGBColor)>, pieces: Vec<(RGBColor, Vec<Point>)> },
    /// Background over the whole height.
    Spans { legend: String, colour: RGBColor, opacity: Real, spans: Vec<Range<Real>> },
    /// Crosses.
    Marks { legend: String, colour: RGBColor, points: Vec<Point> },
    /// Rectangles between two heights.
    Bars { legend: String, colour: RGBColor, spans: Vec<Range<Real>>, heights: Range<Real> },
    /// A dot for each point, without a line; many at one place are darker.
    Dots { legend: String, colour: RGBColor, opacity: Real, points: Vec<Point> },
    /// Many thin lines of one name and colour; where many go it is darker.
    Threads { legend: String, colour: RGBColor, opacity: Real, lines: Vec<Vec<Option<Point>>> },
    /// Vertical lines over the whole height.
    Verticals { legend: String, colour: RGBColor, stroke: Stroke, at: Vec<Real> },
    /// Columns from zero up: from, to and count of each bin.
    Histogram { legend: String, colour: RGBColor, opacity: Real, bins: Vec<(Range<Real>, Real)> },
    /// A map of heights in one colour: from and to on both axes, and how strong it is there, 0 to 1.
    Cells { legend: String, colour: RGBColor, cells: Vec<(Range<Real>, Range<Real>, Real)> },
    /// A word at the left end, above a height.
    Word { text: String, y: Real },
}

/// Figures side by side, each with its own x axis.
#[derive(Clone, Debug)]
pub struct Grid {
    /// Its name, also for those who hear the page.
    pub title: String,
    /// What can be seen, in a sentence.
    pub description: String,
    /// How many stand in a row, at least 1.
    pub columns: usize,
    /// From left to right, row by row. Their own titles and descriptions are not shown.
    pub figures: Vec<Figure>,
}

impl Grid {
    /// The picture. What cannot be drawn says so in its place.
    pub fn to_svg(&self) -> String {
        let columns = self.columns.max(1);
        let width = WIDTH / columns as u32;
        let rows = || self.figures.chunks(columns);
        let height_of = |row: &[Figure]| row.iter().map(|f| f.height(width)).max().unwrap_or(0);
        let height = rows().map(height_of).sum();
        svg(&self.title, &self.description, (WIDTH, height), |root| {
            let mut top = 0;
            for row in rows() {
                for (column, figure) in row.iter().enumerate() {
                    let size = (width, figure.height(width));
                    let left = (column as u32 * width) as i32;
                    figure.draw(&root.clone().shrink((left, top), size), size)?;
                }
                top += height_of(row) as i32;
            }
            Ok(())
        })
    }
}

/// A picture of this size by what draws it, with its names for those who hear the page.
fn svg(
    title: &str,
    description: &str,
    (width, height): (u32, u32),
    draw: impl FnOnce(&Canvas) -> Result<(), DrawingError>,
) -> String {
    let mut drawing = String::new();
    let drawn = {
        let root = SVGBackend::with_string(&mut drawing, (width, height)).into_drawing_area();
        root.fill(&WHITE).and_then(|()| draw(&root)).and_then(|()| root.present())
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
    let (title, description) = (escaped(title), escaped(description));
    format!(
        "<svg viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{title}. {description}\">\n\
         <title>{title}</title><desc>{description}</desc>{body}"
    )
}

/// The same picture as a file of its own, which needs the name space that a page does without.
pub fn standalone(svg: &str) -> String {
    let named = "<svg xmlns=\"http://www.w3.org/2000/svg\" ";
    format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{}\n", svg.replacen("<svg ", named, 1).trim_end())
}

impl Figure {
    /// The picture. What cannot be drawn says so in its place.
    pub fn to_svg(&self) -> String {
        let size = (WIDTH, self.height(WIDTH));
        svg(&self.title, &self.description, size, |root| self.draw(root, size))
    }

    fn height(&self, width: u32) -> u32 {
        let of_panel = |p: &Panel| p.header(width) + p.height + BETWEEN;
        self.panels.iter().map(of_panel).sum::<u32>() + self.bottom(width)
    }

    fn draw(&self, root: &Canvas, (width, _): (u32, u32)) -> Result<(), DrawingError> {
        let x = widened(&self.x, 0.0);
        let mut top = 0;
        for (index, panel) in self.panels.iter().enumerate() {
            let is_last = index + 1 == self.panels.len();
            let below = if is_last { self.bottom(width) } else { BETWEEN };
            let area = root.clone().shrink((0, top), (width, panel.header(width) + panel.height + below));
            self.draw_panel(&area, panel, x.clone(), is_last)?;
            top += (panel.header(width) + panel.height + BETWEEN) as i32;
        }
        Ok(())
    }

    fn draw_panel(&self, area: &Canvas, panel: &Panel, x: Range<Real>, is_last: bool) -> Result<(), DrawingError> {
        let width = area.dim_in_pixel().0;
        draw_header(area, panel, width)?;
        let y = match &panel.y {
            Some(y) => widened(y, 0.0),
            None => panel.height_range(),
        };
        let right = if panel.axes == Axes::Both { LEFT } else { RIGHT };
        let mut builder = ChartBuilder::on(area);
        builder
            .margin_top(panel.header(width))
            .set_label_area_size(LabelAreaPosition::Left, LEFT)
            .set_label_area_size(LabelAreaPosition::Bottom, if is_last { self.bottom(width) } else { BETWEEN })
            .set_label_area_size(LabelAreaPosition::Right, right);
        let mut plot = builder.build_cartesian_2d(x.clone(), y.clone())?.set_secondary_coord(x.clone(), y.clone());
        let y_labels = if panel.height > 300 { 9 } else { 5 };
        let digits = |range: &Range<Real>, labels: Real| {
            let step = (range.end - range.start) / labels;
            (1.0 - step.log10()).ceil().clamp(0.0, 12.0) as usize
        };
        // A narrow plot has room for fewer numbers.
        let x_labels = (12 * width as usize / WIDTH as usize).max(6);
        let x_labels = if self.is_count { x_labels.min(whole_numbers(&x)) } else { x_labels };
        // Numbers of many digits need more of it.
        let room = width.saturating_sub(LEFT + right) as i32;
        let takes = |labels: usize| {
            let digits = digits(&x, labels as Real);
            let wide = [x.start, x.end].map(|value| text_width(&format!("{value:.digits$} "), 1.0));
            labels as i32 * wide[0].max(wide[1])
        };
        let x_labels = (2..=x_labels).rev().find(|labels| takes(*labels) <= room).unwrap_or(x_labels.min(2));
        let (x_digits, y_digits) = (digits(&x, x_labels as Real), digits(&y, y_labels as Real));
        let has_y = panel.axes != Axes::Strip;
        let x_text = |value: &Real| {
            let is_shown = is_last && self.names.is_empty() && (!self.is_count || value.fract() == 0.0);
            if is_shown { tick(*value, x_digits) } else { String::new() }
        };
        let y_text = |value: &Real| {
            if has_y { tick(*value, y_digits) } else { String::new() }
        };
        let text = ("sans-serif", TEXT).into_font().color(&INK);
        let mut mesh = plot.configure_mesh();
        mesh.x_labels(x_labels)
            .y_labels(y_labels)
            .max_light_lines(0)
            .bold_line_style(GRID.stroke_width(2))
            .axis_style(AXIS.stroke_width(2))
            .label_style(text.clone())
            .x_label_formatter(&x_text)
            .y_label_formatter(&y_text);
        if !has_y {
            mesh.disable_y_mesh().set_tick_mark_size(LabelAreaPosition::Left, 0);
        }
        if !self.names.is_empty() {
            mesh.disable_x_mesh().set_tick_mark_size(LabelAreaPosition::Bottom, 0);
        }
        if is_last {
            mesh.x_desc(self.x_label.as_str()).axis_desc_style(text.clone());
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
        panel.draw_layers(&mut plot, &x, &y)?;
        if is_last { self.draw_names(area, &plot, y.start) } else { Ok(()) }
    }
}

impl Panel {
    fn draw_layers(&self, plot: &mut Plot, x: &Range<Real>, y: &Range<Real>) -> Result<(), DrawingError> {
        if self.axes != Axes::Strip && y.start < 0.0 && y.end > 0.0 {
            let zero = [(x.start, 0.0), (x.end, 0.0)];
            plot.draw_series([PathElement::new(zero, AXIS.stroke_width(2))])?;
        }
        for layer in &self.layers {
            layer.draw(plot, x, y)?;
        }
        if self.is_empty() {
            let middle = (0.5 * (x.start + x.end), 0.5 * (y.start + y.end));
            let style = ("sans-serif", TEXT).into_font().color(&AXIS).pos(Pos::new(HPos::Center, VPos::Center));
            plot.draw_series([Text::new(self.empty.clone(), middle, style)])?;
        }
        Ok(())
    }
}

fn escaped(text: &str) -> String {
    maud::Render::render(text).into_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure(layers: Vec<Layer>) -> Figure {
        Figure::new(
            "a < b",
            "\"quoted\" & more",
            "location, km",
            0.0..10.0,
            [Panel::new("speed, km/h", 200, layers, "no estimate: no samples")],
        )
    }

    fn line(points: Vec<Option<Point>>) -> Layer {
        Layer::line("estimated", RGBColor(1, 2, 3), Stroke::Solid, points)
    }

    fn count(text: &str, needle: &str) -> usize {
        text.matches(needle).count()
    }

    #[test]
    fn a_gap_breaks_the_line_and_a_lonely_point_is_a_dot() {
        let nan = Real::NAN;
        let points = [(0.0, 1.0), (1.0, 2.0), (2.0, nan), (3.0, 1.0), (nan, 1.0), (5.0, 1.0), (6.0, 2.0)];
        let svg = figure(vec![line(points.map(Some).to_vec())]).to_svg();
        let stroke = "stroke=\"#010203\"";
        assert_eq!(count(&svg, &format!("opacity=\"1\" {stroke}")), 3, "legend and two lines");
        assert_eq!(count(&svg, "<circle"), 1);
        assert!(!svg.contains("NaN"));
    }

    #[test]
    fn without_values_the_reason_stands_in_the_plot() {
        for layers in [vec![], vec![line(vec![None])], vec![line(vec![Some((Real::NAN, 1.0))])]] {
            let svg = figure(layers).to_svg();
            assert!(svg.contains("no estimate: no samples"));
            assert!(!svg.contains("NaN") && !svg.contains("inf"));
        }
        let svg = figure(vec![line(vec![Some((1.0, 1.0))])]).to_svg();
        assert!(!svg.contains("no estimate"));
    }

    #[test]
    fn numbers_of_an_axis_stand_apart() {
        for x in [2.79935..2.80045, 7.3735..7.3845, 0.0..145.0, 1e5..2e5] {
            let figure = Figure::new("a", "b", "r2", x.clone(), [Panel::new("samples", 300, vec![line(vec![])], "")]);
            let svg = Grid::new("a", "b", 3, vec![figure; 3]).to_svg();
            let lines: Vec<&str> = svg.lines().collect();
            let number = |pair: &[&str]| {
                let value: Real = pair[1].parse().ok().filter(|value| x.contains(value))?;
                let from = pair[0].split("x=\"").nth(1)?.split('"').next()?.parse::<Real>().ok()?;
                Some((from, value, pair[1].len() as Real))
            };
            let numbers: Vec<(Real, Real, Real)> = lines.windows(2).filter_map(number).collect();
            // Those of the other axis stand above each other.
            let rising = |pair: &&[(Real, Real, Real)]| pair[1].1 > pair[0].1 && pair[1].0 != pair[0].0;
            for pair in numbers.windows(2).filter(rising) {
                let digits = 0.5 * (pair[0].2 + pair[1].2);
                assert!(pair[1].0 - pair[0].0 >= 14.0 * digits, "{x:?}: {pair:?}");
            }
            assert!(numbers.len() >= 6, "{x:?}: {numbers:?}");
        }
    }

    #[test]
    fn what_is_counted_has_whole_numbers_on_its_axis() {
        for last in [1, 2, 3, 7, 40] {
            let points = (1..=last).map(|run| Some((Real::from(run), 1.0))).collect();
            let panel = Panel::new("r, N/kg", 200, vec![line(points)], "").within(100.25..100.75);
            let over = Figure::new("a", "b", "run", 0.5..Real::from(last) + 0.5, [panel]);
            let texts = |svg: &str| -> Vec<Real> {
                svg.lines().filter_map(|line| line.parse().ok()).filter(|x| *x < 100.0).collect()
            };
            let counted = texts(&over.clone().over_counts().to_svg());
            assert!(!counted.is_empty() && counted.iter().all(|x| x.fract() == 0.0), "{last}: {counted:?}");
            assert!(counted.len() >= last.min(4) as usize, "{last}: {counted:?}");
            if last < 4 {
                assert!(texts(&over.to_svg()).iter().any(|x| x.fract() != 0.0), "{last}: the test sees halves");
            }
        }
    }

    #[test]
    fn a_legend_ends_within_its_figure() {
        let of = |legend: &str| Layer::line(legend, RGBColor(1, 2, 3), Stroke::Solid, vec![Some((0.0, 0.0))]);
        let layers = vec![of("tunnel"), of("measured, up the line"), of("law as fitted")];
        let label = "r0 of the paper's mode, with less without the tunnel, %";
        let panel = Panel::new(label, 300, layers, "");
        let figures = [1, 2].map(|_| Figure::in_grid("location, km", 0.0..1.0, panel.clone()));
        let svg = Grid::new("a", "b", 2, figures.to_vec()).to_svg();
        // Each text stands behind its tag, whose x is where it begins.
        let begins = |text: &str| -> Vec<i32> {
            let lines: Vec<&str> = svg.lines().collect();
            let tags = lines.windows(2).filter(|pair| pair[1] == text).map(|pair| pair[0]);
            tags.map(|tag| tag.split("x=\"").nth(1).unwrap().split('"').next().unwrap().parse().unwrap()).collect()
        };
        for text in ["tunnel", "measured, up the line", "law as fitted"] {
            let width = 15 * text.len() as i32;
            let [left, right] = begins(text)[..] else { panic!("{text}: {:?}", begins(text)) };
            assert!(left + width <= 1000 && right + width <= 2000, "{text}: {left}, {right}");
        }
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
}
