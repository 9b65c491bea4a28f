//! The layers of a panel, drawn.

use crate::chart::scale::{Finite, range_of, thinned, unbroken, widened};
use crate::chart::{DrawingError, INK, Layer, Panel, Plot, Point, Stroke, TEXT};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use rundown::Real;
use std::ops::Range;

impl Layer {
    /// Heights of everything in it.
    pub fn heights(&self) -> Vec<Real> {
        match self {
            Self::Line { points, .. } => points.iter().flatten().map(|p| p.1).collect(),
            Self::Band { points, .. } => points.iter().flatten().flat_map(|p| [p.1, p.2]).collect(),
            Self::Pieces { pieces, .. } => pieces.iter().flat_map(|(_, points)| points).map(|p| p.1).collect(),
            Self::Marks { points, .. } | Self::Dots { points, .. } => points.iter().map(|p| p.1).collect(),
            Self::Threads { lines, .. } => lines.iter().flatten().flatten().map(|p| p.1).collect(),
            Self::Histogram { bins, .. } => bins.iter().map(|(_, count)| *count).chain([0.0]).collect(),
            Self::Cells { cells, .. } => cells.iter().flat_map(|(_, y, _)| [y.start, y.end]).collect(),
            Self::Verticals { .. } | Self::Spans { .. } | Self::Bars { .. } | Self::Word { .. } => Vec::new(),
        }
    }

    pub(super) fn draw(&self, plot: &mut Plot, x: &Range<Real>, y: &Range<Real>) -> Result<(), DrawingError> {
        match self {
            Self::Line { colour, stroke, points, .. } => {
                for points in unbroken(points) {
                    draw_line(plot, &thinned(&points, x), *colour, *stroke)?;
                }
            }
            Self::Band { colour, opacity, points, .. } => {
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
            Self::Spans { colour, opacity, spans, .. } => draw_bars(plot, spans, x, y, colour.mix(*opacity))?,
            Self::Bars { colour, spans, heights, .. } => draw_bars(plot, spans, x, heights, colour.mix(1.0))?,
            Self::Marks { colour, points, .. } => {
                let finite = points.iter().copied().filter(Finite::is_finite);
                let points = thinned(&finite.collect::<Vec<Point>>(), x);
                let marks = points.iter().map(|point| Cross::new(*point, 8, colour.stroke_width(3)));
                plot.draw_series(marks)?;
            }
            Self::Dots { colour, opacity, points, .. } => {
                let finite = points.iter().filter(|point| point.is_finite());
                let style = colour.mix(*opacity).filled();
                plot.draw_series(finite.map(|point| Circle::new(*point, 5, style)))?;
            }
            Self::Threads { colour, opacity, lines, .. } => {
                let style = colour.mix(*opacity).stroke_width(2);
                for points in lines.iter().flat_map(|line| unbroken(line)) {
                    plot.draw_series([PathElement::new(thinned(&points, x), style)])?;
                }
            }
            Self::Verticals { colour, stroke, at, .. } => {
                for at in at.iter().filter(|at| x.contains(at)) {
                    let line = [(*at, y.start), (*at, y.end)];
                    draw_line(plot, &line, *colour, *stroke)?;
                }
            }
            Self::Histogram { colour, opacity, bins, .. } => {
                draw_columns(plot, bins, colour.mix(*opacity).filled(), colour.stroke_width(2))?;
            }
            Self::Cells { colour, cells, .. } => {
                let cell = |(x, y, strength): &(Range<Real>, Range<Real>, Real)| {
                    Rectangle::new([(x.start, y.start), (x.end, y.end)], colour.mix(*strength).filled())
                };
                plot.draw_series(cells.iter().map(cell))?;
            }
            Self::Word { text, y } => {
                let style = ("sans-serif", TEXT).into_font().color(&INK).pos(Pos::new(HPos::Left, VPos::Bottom));
                let indent = 0.005 * (x.end - x.start);
                plot.draw_series([Text::new(text.clone(), (x.start + indent, *y), style)])?;
            }
        }
        Ok(())
    }
}

impl Panel {
    pub(super) fn is_empty(&self) -> bool {
        let drawn = |layer: &Layer| match layer {
            // A limit or the manufacturer's value alone says nothing of the run.
            Layer::Line { stroke, points, .. } => {
                *stroke != Stroke::Dashed && points.iter().flatten().any(Finite::is_finite)
            }
            Layer::Bars { spans, .. } => !spans.is_empty(),
            Layer::Histogram { bins, .. } => bins.iter().any(|(_, count)| *count > 0.0),
            Layer::Spans { .. } | Layer::Verticals { .. } | Layer::Word { .. } => false,
            Layer::Band { .. }
            | Layer::Pieces { .. }
            | Layer::Marks { .. }
            | Layer::Dots { .. }
            | Layer::Threads { .. }
            | Layer::Cells { .. } => layer.heights().iter().any(|height| height.is_finite()),
        };
        !self.layers.iter().any(drawn)
    }

    pub(super) fn height_range(&self) -> Range<Real> {
        let heights = self.layers.iter().flat_map(Layer::heights);
        let range = widened(&range_of(heights), 0.06);
        let counts = |layer: &Layer| matches!(layer, Layer::Histogram { .. });
        if self.layers.iter().any(counts) {
            // Columns stand on the axis.
            return 0.0..range.end;
        }
        range
    }
}

fn draw_line(plot: &mut Plot, points: &[Point], colour: RGBColor, stroke: Stroke) -> Result<(), DrawingError> {
    if let [point] = points {
        // Between two gaps: a line of one point would not be seen.
        plot.draw_series([Circle::new(*point, 4, colour.filled())])?;
        return Ok(());
    }
    let points = points.iter().copied();
    match stroke {
        Stroke::Solid => plot.draw_series(LineSeries::new(points, colour.stroke_width(5)))?,
        Stroke::Thin => plot.draw_series(LineSeries::new(points, colour.stroke_width(3)))?,
        Stroke::Dashed => plot.draw_series(DashedLineSeries::new(points, 18, 12, colour.stroke_width(4)))?,
        Stroke::Dotted => plot.draw_series(DashedLineSeries::new(points, 4, 8, colour.stroke_width(5)))?,
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

fn draw_columns(
    plot: &mut Plot,
    bins: &[(Range<Real>, Real)],
    fill: ShapeStyle,
    edge: ShapeStyle,
) -> Result<(), DrawingError> {
    for (bin, count) in bins.iter().filter(|(_, count)| *count > 0.0) {
        let corners = [(bin.start, 0.0), (bin.end, *count)];
        plot.draw_series([Rectangle::new(corners, fill), Rectangle::new(corners, edge)])?;
    }
    Ok(())
}

fn draw_bars(
    plot: &mut Plot,
    spans: &[Range<Real>],
    x: &Range<Real>,
    heights: &Range<Real>,
    colour: RGBAColor,
) -> Result<(), DrawingError> {
    // A single sample must still be seen, and what is closer than that is not distinguishable.
    let least = 0.0015 * (x.end - x.start);
    let mut merged: Vec<Range<Real>> = Vec::new();
    for span in spans.iter().filter(|span| (span.start, span.end).is_finite()) {
        let (start, end) = (span.start.min(span.end), span.start.max(span.end));
        let end = end.max(start + least);
        match merged.last_mut() {
            Some(last) if start >= last.start && start - last.end < 0.3 * least => {
                last.end = last.end.max(end);
            }
            _ => merged.push(start..end),
        }
    }
    let bar =
        |span: Range<Real>| Rectangle::new([(span.start, heights.start), (span.end, heights.end)], colour.filled());
    plot.draw_series(merged.into_iter().map(bar))?;
    Ok(())
}
