//! Names under an x axis of kinds, broken into lines that fit.

use super::{BOTTOM, Canvas, DrawingError, Figure, INK, LEFT, Plot, RIGHT};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use rundown::Real;

/// Size of a name on the canvas, and the height of a line of them.
const SIZE: u32 = 24;
const LINE: u32 = 26;
/// Width of a letter, an estimate on the wide side.
const LETTER: Real = 11.0;
/// Space between axis and names.
const AIR: i32 = 10;

impl Figure {
    /// With kinds on its x axis: where each stands, and its name.
    pub fn with_names(self, names: Vec<(Real, String)>) -> Self {
        Self { names, ..self }
    }

    /// Letters that fit beside those of the next name on a canvas of this width.
    fn letters(&self, width: u32) -> usize {
        let places = self.names.windows(2).map(|pair| (pair[1].0 - pair[0].0).abs());
        let whole = self.x.end - self.x.start;
        let part = places.reduce(Real::min).map_or(1.0, |least| least / whole);
        (part * Real::from(width.saturating_sub(LEFT + RIGHT)) / LETTER).max(1.0) as usize
    }

    /// Space below the last panel.
    pub(super) fn bottom(&self, width: u32) -> u32 {
        let letters = self.letters(width);
        let lines = self.names.iter().map(|(_, name)| lines(name, letters).len()).max().unwrap_or(0);
        BOTTOM + LINE * lines.saturating_sub(1) as u32
    }

    /// Draws them below a plot whose heights begin at `foot`.
    pub(super) fn draw_names(&self, area: &Canvas, plot: &Plot, foot: Real) -> Result<(), DrawingError> {
        let style = ("sans-serif", SIZE).into_font().color(&INK).pos(Pos::new(HPos::Center, VPos::Top));
        let (letters, base) = (self.letters(area.dim_in_pixel().0), area.get_base_pixel());
        for (x, name) in &self.names {
            let (left, axis) = plot.backend_coord(&(*x, foot));
            for (line, row) in lines(name, letters).into_iter().zip(0..) {
                let place = (left - base.0, axis - base.1 + AIR + row * LINE as i32);
                area.draw(&Text::new(line, place, style.clone()))?;
            }
        }
        Ok(())
    }
}

/// A name in lines of so many letters; a longer word has a line of its own.
fn lines(name: &str, letters: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in name.split(' ') {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= letters => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::super::{Layer, Panel};
    use super::*;
    use plotters::style::RGBColor;

    #[test]
    fn names_stand_on_the_axis_in_place_of_numbers() {
        let dots = Layer::dots("", RGBColor(1, 2, 3), 1.0, vec![(1.0, 5.0), (2.0, 6.0)]);
        let figure = Figure::in_grid("train", 0.5..2.5, Panel::new("error, %", 200, vec![dots], ""));
        assert!(figure.to_svg().contains("\n2\n"));
        let long = "a diesel whose lever has eight notches and an engineer who knows them all by heart and uses each, on a wet day";
        let named = figure.with_names(vec![(1.0, "tram".to_owned()), (2.0, long.to_owned())]);
        let svg = named.to_svg();
        assert!(svg.contains("\ntram\n") && svg.contains("eight notches"), "{svg}");
        assert!(!svg.contains("\n2\n") && !svg.contains("\n1\n") && !svg.contains(long));
        assert!(named.bottom(2000) > BOTTOM);
    }

    #[test]
    fn a_name_is_broken_between_words() {
        assert_eq!(lines("70 % on 40 % of the days", 12), ["70 % on 40 %", "of the days"]);
        assert_eq!(lines("electromagnetic", 3), ["electromagnetic"]);
    }
}
