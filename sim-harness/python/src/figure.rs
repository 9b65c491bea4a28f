//! Pictures, as the reports have them.

use crate::error::refused;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use rundown_pages::chart::standalone;
use std::path::PathBuf;

/// A picture as SVG: a notebook shows it, `save` writes it.
#[pyclass(frozen, module = "rundown")]
pub struct Figure {
    /// The picture as a file of its own.
    #[pyo3(get)]
    svg: String,
}

impl Figure {
    /// Of a picture of a page.
    pub fn of(svg: &str) -> Self {
        Self::whole(standalone(svg))
    }

    /// Of a file of its own.
    pub const fn whole(svg: String) -> Self {
        Self { svg }
    }
}

#[pymethods]
impl Figure {
    /// Writes the picture to a file, as SVG.
    fn save(&self, path: PathBuf) -> PyResult<()> {
        if path.extension().is_some_and(|end| !end.eq_ignore_ascii_case("svg")) {
            let found = path.display();
            return Err(refused(format!(
                "path: expected a name that ends with .svg, as the picture is SVG, found {found}"
            )));
        }
        let failed = |error| PyOSError::new_err(format!("{}: cannot be written: {error}", path.display()));
        std::fs::write(&path, &self.svg).map_err(failed)
    }

    /// What a notebook shows.
    fn _repr_svg_(&self) -> &str {
        &self.svg
    }

    fn __repr__(&self) -> String {
        format!("<rundown.Figure: {} bytes of SVG>", self.svg.len())
    }
}
