//! `rundown.convert`.

use crate::error::{refused, unread};
use pyo3::prelude::*;
use sim_harness::converting;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// A train or track file that another tool's file became.
#[pyclass(frozen, module = "rundown")]
pub struct Converted {
    /// The file that was written.
    #[pyo3(get)]
    file: PathBuf,
    done: converting::Converted,
}

#[pymethods]
impl Converted {
    /// "train" or "track".
    #[getter]
    fn kind(&self) -> &str {
        self.done.kind
    }

    /// Every field that is not kept, or read in a certain sense.
    #[getter]
    fn notes(&self) -> Vec<String> {
        crate::said::messages(&self.done.notes)
    }

    fn __repr__(&self) -> String {
        format!("<rundown.Converted: {} {}>", self.done.kind, self.file.display())
    }
}

/// Turns a train or track of SUMO, OSRD, TrainRuns, ALTRIOS or SFERA into a train or track file, as `rundown convert`
/// does.
///
/// `out`: the file to write, which must not exist. `set`: values of a train that the format has no place for, or that
/// replace the file's, by their names in a train file.
///
/// >>> import pathlib, rundown, tempfile
/// >>> folder = pathlib.Path(tempfile.mkdtemp())
/// >>> made = rundown.simulate(folder / "made", runs=3, seed=7)
/// >>> rundown.replay(made.runs, train=made.train, track=made.track).write(folder / "learned")
/// >>> exported = rundown.export(
/// ...     folder / "learned", train=made.train, to="trainruns", max_speed=140, out=folder / "out"
/// ... )
/// >>> converted = rundown.convert(
/// ...     folder / "out" / "trainruns.yaml", out=folder / "train.toml", set={"max_brake_mps2": 0.66}
/// ... )
/// >>> converted.kind, converted.file.name
/// ('train', 'train.toml')
#[pyfunction]
#[pyo3(signature = (file, *, out, set=None))]
pub fn convert(py: Python<'_>, file: PathBuf, out: PathBuf, set: Option<BTreeMap<String, f64>>) -> PyResult<Converted> {
    let field = |(name, value): (String, f64)| match value.is_finite() {
        true => converting::field(&name).map(|field| (field, value)),
        false => Err(format!("{name}: expected a finite number, found {value}")),
    };
    let set = set.unwrap_or_default().into_iter().map(field).collect::<Result<BTreeMap<_, _>, _>>();
    let set = set.map_err(|wrong| refused(format!("set: {wrong}")))?;
    let done = py.detach(|| converting::convert(&file, &set)).map_err(unread)?;
    if out.exists() {
        return Err(refused(format!("out: expected a new file, found one that exists: {}", out.display())));
    }
    done.write(&out).map_err(refused)?;
    Ok(Converted { file: out, done })
}
