//! What stands as one picture in a page.

use super::{Figure, Grid};

/// A picture of a page: as SVG by [`Drawing::to_svg`], as data of its live form by [`Drawing::live`].
#[derive(Clone, Debug)]
pub enum Drawing {
    /// Panels on one x axis.
    One(Figure),
    /// The same panels over two axes, between which the reader may switch. The SVG has the first.
    Switched {
        /// The name of the axis and the figure over it, shown first.
        first: (&'static str, Figure),
        /// The other axis.
        second: (&'static str, Figure),
    },
    /// Figures side by side.
    Grid(Grid),
}

impl From<Figure> for Drawing {
    fn from(figure: Figure) -> Self {
        Self::One(figure)
    }
}

impl From<Grid> for Drawing {
    fn from(grid: Grid) -> Self {
        Self::Grid(grid)
    }
}

impl Drawing {
    /// Inline SVG.
    pub fn to_svg(&self) -> String {
        match self {
            Self::One(figure) | Self::Switched { first: (_, figure), .. } => figure.to_svg(),
            Self::Grid(grid) => grid.to_svg(),
        }
    }

    /// Its name.
    pub fn title(&self) -> &str {
        match self {
            Self::One(figure) | Self::Switched { first: (_, figure), .. } => &figure.title,
            Self::Grid(grid) => &grid.title,
        }
    }
}
