//! The line above a panel: its label, and the legend from left to right.

use crate::chart::{Canvas, DrawingError, HEADER, INK, LEFT, LEGEND_ROW, Layer, Panel, Stroke, TEXT};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use rundown::Real;

/// The panel's label, then the legend.
pub(super) fn draw_header(area: &Canvas, panel: &Panel, width: u32) -> Result<(), DrawingError> {
    let style = |weight| ("sans-serif", TEXT, weight).into_font().color(&INK).pos(Pos::new(HPos::Left, VPos::Center));
    let label = Text::new(panel.label.clone(), (LEFT as i32, middle_of(0)), style(FontStyle::Bold));
    area.draw(&label)?;
    for entry in panel.entries(width) {
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
            Swatch::Shades => {
                let width = SWATCH / SHADES;
                for step in 0..SHADES {
                    let corners = [(left + step * width, middle - 12), (left + (step + 1) * width, middle + 12)];
                    let strength = 1.0 - Real::from(step) / Real::from(SHADES);
                    area.draw(&Rectangle::new(corners, colour.mix(strength).filled()))?;
                }
            }
            Swatch::Dot => area.draw(&Circle::new((left + SWATCH / 2, middle), 6, colour.filled()))?,
            Swatch::Mark => area.draw(&Cross::new((left + SWATCH / 2, middle), 9, colour.stroke_width(4)))?,
        }
        let place = (left + SWATCH + 10, middle);
        area.draw(&Text::new(entry.legend.to_owned(), place, style(FontStyle::Normal)))?;
    }
    Ok(())
}

/// Width of the sample of a line or area in a legend.
const SWATCH: i32 = 54;

/// Height of a letter on the canvas: the back end divides the size by 1.24.
const SIZE: Real = TEXT as Real / 1.24;

/// Steps of the sample of a map, from strong to none.
const SHADES: i32 = 9;

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

/// The reader's font is unknown: an estimate on the wide side, that of DejaVu Sans.
pub(super) fn text_width(text: &str, stretch: Real) -> i32 {
    // In heights of a letter.
    let width = |letter: char| match letter {
        'i' | 'j' | 'l' | '.' | ',' | ':' | ';' | '\'' | '|' | ' ' => 0.33,
        'f' | 't' | 'r' | '(' | ')' | '[' | ']' | '-' | '/' => 0.41,
        'm' | 'w' | 'M' | 'W' | '%' | '\u{2212}' | '=' | '+' | '<' | '>' => 0.96,
        'A'..='Z' => 0.72,
        _ => 0.63,
    };
    (text.chars().map(width).sum::<Real>() * SIZE * stretch) as i32
}

enum Swatch {
    Line(Stroke),
    Area(Real),
    Shades,
    Mark,
    Dot,
}

impl Layer {
    fn legends(&self) -> Vec<(&str, RGBColor, Swatch)> {
        let all = match self {
            Self::Line { legend, colour, stroke, .. } => vec![(legend.as_str(), *colour, Swatch::Line(*stroke))],
            Self::Band { legend, colour, opacity, .. } | Self::Spans { legend, colour, opacity, .. } => {
                vec![(legend.as_str(), *colour, Swatch::Area(*opacity))]
            }
            Self::Pieces { legends, .. } => {
                legends.iter().map(|(legend, colour)| (legend.as_str(), *colour, Swatch::Line(Stroke::Solid))).collect()
            }
            Self::Threads { legend, colour, .. } => {
                vec![(legend.as_str(), *colour, Swatch::Line(Stroke::Thin))]
            }
            Self::Verticals { legend, colour, stroke, .. } => vec![(legend.as_str(), *colour, Swatch::Line(*stroke))],
            Self::Histogram { legend, colour, opacity, .. } => vec![(legend.as_str(), *colour, Swatch::Area(*opacity))],
            Self::Dots { legend, colour, .. } => vec![(legend.as_str(), *colour, Swatch::Dot)],
            Self::Marks { legend, colour, .. } => vec![(legend.as_str(), *colour, Swatch::Mark)],
            Self::Bars { legend, colour, .. } => {
                vec![(legend.as_str(), *colour, Swatch::Area(1.0))]
            }
            Self::Cells { legend, colour, .. } => vec![(legend.as_str(), *colour, Swatch::Shades)],
            Self::Word { .. } => Vec::new(),
        };
        all.into_iter().filter(|(legend, ..)| !legend.is_empty()).collect()
    }
}

impl Panel {
    /// The legend from left to right, on a new row where the canvas ends: beside the label, or below it where there is
    /// no room.
    fn entries(&self, canvas: u32) -> Vec<Entry<'_>> {
        let beside_label = LEFT as i32 + text_width(&self.label, 1.12) + 50;
        let width_of = |legend: &str| SWATCH + 10 + text_width(legend, 1.0);
        let legends = || self.layers.iter().flat_map(Layer::legends);
        let fits = |legend: &str| beside_label + width_of(legend) <= canvas as i32;
        let is_below = !legends().all(|(legend, ..)| fits(legend));
        let begin = if is_below { LEFT as i32 } else { beside_label };
        let (mut left, mut row) = (begin, u32::from(is_below));
        let mut entries = Vec::new();
        for (legend, colour, swatch) in legends() {
            let width = width_of(legend);
            if left + width > canvas as i32 && left > begin {
                (left, row) = (begin, row + 1);
            }
            entries.push(Entry { legend, colour, swatch, left, row });
            left += width + 40;
        }
        entries
    }

    pub(super) fn header(&self, width: u32) -> u32 {
        let rows = self.entries(width).last().map_or(0, |entry| entry.row);
        HEADER + rows * LEGEND_ROW
    }
}
