//! `rundown.simulate`.

use crate::error::{refused, unread};
use crate::paths::chosen;
use crate::progress::{Progress, Wanted};
use pyo3::prelude::*;
use rundown_files::refusal::ReadError;
use rundown_truth::recorders::Recorder;
use sim_harness::simulation::folder;
use sim_harness::simulation::scenario_file::{EXAMPLE, HIDDEN_EFFECT, Simulation};
use std::path::{Path, PathBuf};

/// A data set on disk: logs, descriptions, and the truth apart from them.
#[pyclass(frozen, get_all, module = "rundown")]
pub struct Simulated {
    folder: PathBuf,
    train: PathBuf,
    track: PathBuf,
    runs: PathBuf,
    truth: PathBuf,
}

#[pymethods]
impl Simulated {
    fn __repr__(&self) -> String {
        format!("<rundown.Simulated: {}>", self.folder.display())
    }
}

#[derive(Clone, Copy)]
enum Example {
    CaseStudy,
    HiddenEffect,
}

/// Simulates runs with known truth into the folder `out`, as `rundown simulate` does; the same scenario and seed give
/// the same bytes.
///
/// `scenario` is a scenario file; without it `example` is taken: "case_study" with the loads and winds of everyday,
/// "hidden_effect" with a tunnel that the described track lacks, or None for the case study in still air with the
/// described load. `seed`, `runs` (how many) and `recorder` ("event_recorder", "phone", "tram_gnss", "jru") replace
/// those of the scenario. `force=True` takes the place of an earlier set.
///
/// >>> import rundown, tempfile
/// >>> made = rundown.simulate(tempfile.mkdtemp(), runs=2, seed=7)
/// >>> sorted(path.name for path in made.runs.iterdir())
/// ['run001.csv', 'run002.csv', 'runs.csv']
#[pyfunction]
#[pyo3(signature = (out, *, scenario=None, example=None, seed=None, runs=None, recorder=None, force=false, progress=None))]
#[expect(clippy::too_many_arguments, reason = "they have names in Python")]
pub fn simulate(
    py: Python<'_>,
    out: PathBuf,
    scenario: Option<PathBuf>,
    example: Option<&str>,
    seed: Option<u64>,
    runs: Option<u32>,
    recorder: Option<&str>,
    force: bool,
    progress: Option<Wanted>,
) -> PyResult<Simulated> {
    if scenario.is_some() && example.is_some() {
        return Err(refused("scenario, example: expected one of them, found both"));
    }
    let recorders = Recorder::ALL.map(|recorder| (recorder.name(), recorder));
    let recorder = recorder.map(|name| chosen("recorder", name, &recorders)).transpose()?;
    let examples = [("case_study", Example::CaseStudy), ("hidden_effect", Example::HiddenEffect)];
    let example = example.map(|name| chosen("example", name, &examples)).transpose()?;
    let mut simulation = read(scenario.as_deref(), example, recorder).map_err(unread)?;
    simulation.seed = seed.unwrap_or(simulation.seed);
    if let Some(runs) = runs {
        if runs == 0 {
            return Err(refused("runs: expected at least 1, found 0"));
        }
        simulation.runs = runs as usize;
    }
    let said = Progress::new(progress, simulation.runs);
    let written = said.during(py, || folder::write(&simulation, &out, force, || said.one_more()))?;
    written.map_err(refused)?;
    let at = |name: &str| out.join(name);
    Ok(Simulated {
        train: at("train.toml"),
        track: at("track.toml"),
        runs: at("runs"),
        truth: at("truth"),
        folder: out,
    })
}

fn read(path: Option<&Path>, example: Option<Example>, recorder: Option<Recorder>) -> Result<Simulation, ReadError> {
    if let Some(path) = path {
        return Simulation::read_with(path, recorder);
    }
    let text = match example {
        None => "",
        Some(Example::CaseStudy) => EXAMPLE,
        Some(Example::HiddenEffect) => HIDDEN_EFFECT,
    };
    Simulation::parse_with(Path::new("scenario"), text, recorder)
}
