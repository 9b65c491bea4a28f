//! The Python module `rundown`: the commands as functions, their tables as Arrow.
//!
//! | question | module |
//! |---|---|
//! | how do the commands look from Python? | `import_logs`, `replay`, `simulate`, `check`, `gap`, `export`, `convert` |
//! | how does a table reach pandas, polars, pyarrow or DuckDB? | `table` |
//! | how does one of theirs come as runs? | `runs` |
//! | how are pictures seen? | `figure` |
//! | how is a refusal raised? | `error` |
//! | how does a message name an argument? | `options` |
//! | how is progress said? | `progress` |
//!
//! Nothing is calculated here: every number is that of `sim-harness`, as the command `rundown` has it. What is
//! documented for Python stands in `rundown/__init__.pyi`, and in the docstrings that Python shows.
#![deny(unsafe_code)]
#![warn(missing_docs)]

mod check;
mod convert;
mod error;
mod export;
mod figure;
mod gap;
mod import_logs;
mod options;
mod paths;
mod progress;
mod replay;
mod resistance;
mod runs;
mod said;
mod simulate;
mod table;
mod table_html;

/// What `rundown/__init__.py` hands on.
#[pyo3::pymodule]
mod _rundown {
    #[pymodule_export]
    use crate::check::{Check, check};
    #[pymodule_export]
    use crate::convert::{Converted, convert};
    #[pymodule_export]
    use crate::error::RundownError;
    #[pymodule_export]
    use crate::export::{Exported, export};
    #[pymodule_export]
    use crate::figure::Figure;
    #[pymodule_export]
    use crate::gap::{Gap, gap};
    #[pymodule_export]
    use crate::import_logs::{Imported, Preview, import_logs, preview_logs};
    #[pymodule_export]
    use crate::replay::{Replay, replay};
    #[pymodule_export]
    use crate::simulate::{Simulated, simulate};
    #[pymodule_export]
    use crate::table::Table;
    use pyo3::prelude::*;

    #[pymodule_init]
    fn version(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
