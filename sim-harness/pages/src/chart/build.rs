//! Figures and their parts, each in one line.

use super::{Axes, Figure, Grid, Layer, Panel, Point, Stroke};
use plotters::style::RGBColor;
use rundown::Real;
use std::ops::Range;

impl Figure {
    /// A picture of these panels, from top to bottom.
    pub fn new(
        title: impl Into<String>,
        description: impl Into<String>,
        x_label: impl Into<String>,
        x: Range<Real>,
        panels: impl Into<Vec<Panel>>,
    ) -> Self {
        let [title, description, x_label] = [title.into(), description.into(), x_label.into()];
        Self { title, description, x_label, x, names: Vec::new(), is_count: false, panels: panels.into() }
    }

    /// Over what is counted, such as runs.
    pub fn over_counts(self) -> Self {
        Self { is_count: true, ..self }
    }

    /// One of a [`Grid`], whose title and description stand for it.
    pub fn in_grid(x_label: impl Into<String>, x: Range<Real>, panel: Panel) -> Self {
        Self::new("", "", x_label, x, [panel])
    }
}

impl Grid {
    /// Figures in rows of `columns`.
    pub fn new(title: impl Into<String>, description: impl Into<String>, columns: usize, figures: Vec<Figure>) -> Self {
        Self { title: title.into(), description: description.into(), columns, figures }
    }
}

impl Panel {
    /// With y labels on the left and a y axis that holds its layers.
    pub fn new(label: impl Into<String>, height: u32, layers: impl Into<Vec<Layer>>, empty: impl Into<String>) -> Self {
        Self { label: label.into(), height, y: None, axes: Axes::Left, layers: layers.into(), empty: empty.into() }
    }

    /// With this y axis.
    pub fn within(self, y: Range<Real>) -> Self {
        Self { y: Some(y), ..self }
    }

    /// With y labels there.
    pub fn labelled(self, axes: Axes) -> Self {
        Self { axes, ..self }
    }
}

impl Layer {
    /// [`Layer::Line`].
    pub fn line(legend: impl Into<String>, colour: RGBColor, stroke: Stroke, points: Vec<Option<Point>>) -> Self {
        Self::Line { legend: legend.into(), colour, stroke, points }
    }

    /// A level line from end to end.
    pub fn level(legend: impl Into<String>, colour: RGBColor, stroke: Stroke, x: &Range<Real>, height: Real) -> Self {
        Self::line(legend, colour, stroke, vec![Some((x.start, height)), Some((x.end, height))])
    }

    /// [`Layer::Band`].
    pub fn band(
        legend: impl Into<String>,
        colour: RGBColor,
        opacity: Real,
        points: Vec<Option<(Real, Real, Real)>>,
    ) -> Self {
        Self::Band { legend: legend.into(), colour, opacity, points }
    }

    /// [`Layer::Spans`].
    pub fn spans(legend: impl Into<String>, colour: RGBColor, opacity: Real, spans: Vec<Range<Real>>) -> Self {
        Self::Spans { legend: legend.into(), colour, opacity, spans }
    }

    /// [`Layer::Marks`].
    pub fn marks(legend: impl Into<String>, colour: RGBColor, points: Vec<Point>) -> Self {
        Self::Marks { legend: legend.into(), colour, points }
    }

    /// [`Layer::Dots`].
    pub fn dots(legend: impl Into<String>, colour: RGBColor, opacity: Real, points: Vec<Point>) -> Self {
        Self::Dots { legend: legend.into(), colour, opacity, points }
    }

    /// [`Layer::Threads`].
    pub fn threads(legend: impl Into<String>, colour: RGBColor, opacity: Real, lines: Vec<Vec<Option<Point>>>) -> Self {
        Self::Threads { legend: legend.into(), colour, opacity, lines }
    }

    /// [`Layer::Verticals`].
    pub fn verticals(legend: impl Into<String>, colour: RGBColor, stroke: Stroke, at: Vec<Real>) -> Self {
        Self::Verticals { legend: legend.into(), colour, stroke, at }
    }

    /// [`Layer::Cells`].
    pub fn cells(legend: impl Into<String>, colour: RGBColor, cells: Vec<(Range<Real>, Range<Real>, Real)>) -> Self {
        Self::Cells { legend: legend.into(), colour, cells }
    }

    /// [`Layer::Histogram`].
    pub fn histogram(
        legend: impl Into<String>,
        colour: RGBColor,
        opacity: Real,
        bins: Vec<(Range<Real>, Real)>,
    ) -> Self {
        Self::Histogram { legend: legend.into(), colour, opacity, bins }
    }
}
