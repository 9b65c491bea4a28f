//! Where the runs of a study come from, chunk by chunk: simulated, folders of logs, or Parquet files.

use super::case::{Case, FleetUnit};
use super::{Refused, truth_folder::TruthFolder};
use crate::logs::{self, Failed};
use crate::parquet_runs::ParquetRuns;
use crate::simulation::scenario_file::Simulation;
use rayon::prelude::*;
use rundown::{model::track::Track, model::train::Train};
use rundown_check::gradients::{Answer, Coasts};
use rundown_check::{Check, Known, rows::same::Seen};
use rundown_files::run_set::{RunFile, RunSet};
use rundown_files::{map_matching::CentreLine, recording::DirectionChoice, run_log::BadRows};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

use crate::replaying::CHUNK;

#[derive(Debug)]
pub enum RunSource {
    Simulated(Box<Simulated>),
    Recorded(Box<Recorded>),
}

/// Recorded runs, diagnosed chunk by chunk: a recorder is judged by its runs of a chunk, so that memory does not grow
/// and a wheel may wear.
#[derive(Debug)]
pub struct Recorded {
    of: Files,
    files: Vec<PathBuf>,
    /// Nothing is diagnosed nor put right.
    as_recorded: bool,
    /// What an estimator puts right by itself.
    known: Known,
    /// Perturbed runs count as the others do.
    keep_perturbed: bool,
    /// What was found, a diagnosis for each chunk so far.
    found: Vec<Check>,
    /// Logs that were read: one that comes again in a later chunk is left out, too.
    seen: Seen,
    /// The first chunk, where it was read to judge the track.
    ahead: Option<Vec<Result<Case, Failed>>>,
    /// What is to be said of the track.
    of_descriptions: Option<String>,
}

#[derive(Debug)]
enum Files {
    Logs(StudyLogs),
    Parquet(ParquetRuns),
}

/// Simulated runs. Diagnosed as recorded ones are, but that the paper's loop gets what the recorder wrote.
#[derive(Debug)]
pub struct Simulated {
    simulation: Simulation,
    seed: u64,
    runs: usize,
    next: usize,
    as_recorded: bool,
    found: Vec<Check>,
}

#[derive(Clone, Debug)]
struct StudyLogs {
    files: Vec<RunFile>,
    line: Option<CentreLine>,
    /// By the folder of the logs.
    truths: HashMap<PathBuf, TruthFolder>,
    next: usize,
}

impl RunSource {
    /// So many runs; a unit for each as many as the simulation says. `as_recorded`: nothing is diagnosed nor put right.
    pub fn simulated(simulation: Simulation, seed: u64, runs: usize, as_recorded: bool) -> Self {
        Self::Simulated(Box::new(Simulated { simulation, seed, runs, next: 0, as_recorded, found: Vec::new() }))
    }

    /// Recorded runs, diagnosed but for what is `known` of their recorders; none of it: taken as recorded.
    ///
    /// These are Parquet files, folders of them (also deeper, in the order of their paths), or else logs and folders of
    /// logs. Where the truth of logs lies beside them, as `rundown simulate` writes it, the runs have it. What a person
    /// may want to know is handed to `note`.
    pub fn recorded(
        arguments: &[PathBuf],
        line: Option<CentreLine>,
        known: Option<Known>,
        keep_perturbed: bool,
        note: impl Fn(&str),
    ) -> Result<Self, Refused> {
        let (of, files) = Files::open(arguments, line, note)?;
        let (as_recorded, known) = (known.is_none(), known.unwrap_or_default());
        let (found, seen) = (Vec::new(), Seen::default());
        let (ahead, of_descriptions) = (None, None);
        let recorded = Recorded { of, files, as_recorded, known, keep_perturbed, found, seen, ahead, of_descriptions };
        Ok(Self::Recorded(Box::new(recorded)))
    }

    /// Whether the described gradients and resistance explain how the trains of the first chunk coast; if they look
    /// wrong, the notes say so. Of simulated runs it is not asked. `said_permille`: how far the gradients may be off as
    /// track or configuration say, standard deviation.
    ///
    /// # Errors
    /// The runs cannot be read.
    pub fn of_descriptions(
        &mut self,
        train: &Train,
        track: &Track,
        said_permille: Option<f64>,
    ) -> Result<Answer, Refused> {
        let Self::Recorded(recorded) = self else { return Ok(Answer::default()) };
        let first = recorded.next_chunk()?;
        let mut coasts = Coasts::default();
        first.iter().flatten().for_each(|case| coasts.add(std::slice::from_ref(&case.recording), train));
        recorded.ahead = Some(first);
        let answer = coasts.answer(train, track, said_permille);
        let units = || answer.resistance.map(|units| units.to_string());
        recorded.of_descriptions = answer.gradients.map(|doubt| doubt.to_string()).or_else(units);
        Ok(answer)
    }

    /// A run that is no part of the statistics: it was perturbed.
    pub fn sets_aside(&self, case: &Case) -> bool {
        matches!(self, Self::Recorded(recorded) if !recorded.keep_perturbed) && case.recording.perturbed.is_some()
    }

    /// What a person must know of the recorders and of perturbed runs, as far as they have been read.
    pub fn notes(&self) -> Vec<String> {
        let Self::Recorded(recorded) = self else {
            return self.found().iter().flat_map(Check::notes).collect();
        };
        let done = if recorded.keep_perturbed { "kept" } else { "set aside; --keep-perturbed keeps them" };
        let of_chunk = |check: &Check| {
            let perturbed = check.perturbed_note().map(|note| format!("{note}; {done}"));
            check.notes().into_iter().chain(perturbed).collect::<Vec<String>>()
        };
        recorded.found.iter().flat_map(of_chunk).chain(recorded.of_descriptions.clone()).collect()
    }

    pub fn total(&self) -> usize {
        match self {
            Self::Simulated(simulated) => simulated.runs,
            Self::Recorded(recorded) => match &recorded.of {
                Files::Logs(logs) => logs.files.len(),
                Files::Parquet(runs) => runs.runs(),
            },
        }
    }

    /// The files that are read.
    pub fn files(&self) -> Vec<PathBuf> {
        match self {
            Self::Simulated(simulated) => simulated.simulation.file.iter().cloned().collect(),
            Self::Recorded(recorded) => recorded.files.clone(),
        }
    }

    /// What the recorders of the runs did to them, as far as they have been read: a diagnosis for each chunk.
    pub fn found(&self) -> &[Check] {
        match self {
            Self::Simulated(simulated) => &simulated.found,
            Self::Recorded(recorded) => &recorded.found,
        }
    }

    /// The next runs, at most [`CHUNK`]; none after the last. Logs that cannot be read come before the others of their
    /// chunk.
    pub fn next_chunk(&mut self) -> Result<Option<Vec<Result<Case, Failed>>>, Refused> {
        let chunk = match self {
            Self::Simulated(simulated) => simulated.next_chunk(),
            Self::Recorded(recorded) => recorded.next_chunk()?,
        };
        Ok((!chunk.is_empty()).then_some(chunk))
    }
}

impl Files {
    fn open(
        arguments: &[PathBuf],
        line: Option<CentreLine>,
        note: impl Fn(&str),
    ) -> Result<(Self, Vec<PathBuf>), Refused> {
        if let Some(runs) = ParquetRuns::open(arguments, line.as_ref())? {
            let files = runs.files().to_vec();
            return Ok((Self::Parquet(runs), files));
        }
        let set = RunSet::find(arguments)?;
        set.notes.iter().for_each(|text| note(text));
        let mut truths = HashMap::new();
        for file in &set.files {
            let folder = folder_of(file);
            if !truths.contains_key(folder)
                && let Some(truth) = TruthFolder::beside(folder)?
            {
                truths.insert(folder.to_owned(), truth);
            }
        }
        let files = set.paths();
        Ok((Self::Logs(StudyLogs { files: set.files, line, truths, next: 0 }), files))
    }

    fn next_chunk(&mut self) -> Result<Vec<Result<Case, Failed>>, Refused> {
        match self {
            Self::Logs(logs) => {
                let range = advance(&mut logs.next, logs.files.len());
                let logs = &*logs;
                Ok(logs.files[range].par_iter().map(|file| logs.read(file)).collect())
            }
            Self::Parquet(runs) => {
                let chunk = runs.next_chunk(CHUNK)?.into_iter();
                Ok(chunk.map(|recording| Ok(Case { recording, as_recorded: None, truth: None })).collect())
            }
        }
    }
}

impl Simulated {
    fn next_chunk(&mut self) -> Vec<Result<Case, Failed>> {
        let range = advance(&mut self.next, self.runs);
        let (simulation, seed) = (&self.simulation, self.seed);
        // A unit's runs are planned together: once a chunk, not once a run.
        let runs = FleetUnit::runs(simulation);
        let first = range.start / runs;
        let units = first..range.end.div_ceil(runs);
        let units: Vec<FleetUnit> = units.map(|unit| FleetUnit::new(simulation, seed, unit)).collect();
        let run = |index: usize| {
            let unit = &units[index / runs - first];
            unit.drive(index % runs).map_err(|error| Failed {
                file: PathBuf::from(&simulation.name),
                error: error.to_string(),
                refusal: None,
            })
        };
        let mut chunk: Vec<Result<Case, Failed>> = range.into_par_iter().map(run).collect();
        if !self.as_recorded {
            let cases: Vec<&mut Case> = chunk.iter_mut().flatten().collect();
            if !cases.is_empty() {
                self.found.push(put_right(cases));
            }
        }
        chunk
    }
}

/// Diagnoses simulated runs and puts right what is beyond doubt; a run that would be refused stays as it is.
fn put_right(cases: Vec<&mut Case>) -> Check {
    let recordings = cases.iter().map(|case| case.recording.clone()).collect();
    let known = Known { moves_locations: true, ..Known::default() };
    let (each, found) = logs::diagnosed_each(recordings, &known, &mut Seen::default());
    for (case, diagnosed) in cases.into_iter().zip(each) {
        if let Some(diagnosed) = diagnosed.ok().filter(|diagnosed| diagnosed.rows != case.recording.rows) {
            case.as_recorded = Some(case.recording.clone());
            case.recording.rows = diagnosed.rows;
        }
    }
    found
}

impl Recorded {
    fn next_chunk(&mut self) -> Result<Vec<Result<Case, Failed>>, Refused> {
        if let Some(ahead) = self.ahead.take() {
            return Ok(ahead);
        }
        let read = self.of.next_chunk()?;
        if self.as_recorded || read.is_empty() {
            return Ok(read);
        }
        let (mut recordings, mut truths, mut chunk) = (Vec::new(), Vec::new(), Vec::new());
        for case in read {
            match case {
                Ok(Case { recording, truth, .. }) => {
                    recordings.push(recording);
                    truths.push(truth);
                }
                Err(failed) => chunk.push(Err(failed)),
            }
        }
        let (diagnosed, found) = logs::diagnosed_each(recordings, &self.known, &mut self.seen);
        let with_truth = diagnosed.into_iter().zip(truths);
        chunk.extend(with_truth.map(|(recording, truth)| Ok(Case { recording: recording?, as_recorded: None, truth })));
        self.found.push(found);
        Ok(chunk)
    }
}

fn advance(next: &mut usize, end: usize) -> std::ops::Range<usize> {
    let from = *next;
    *next = (from + CHUNK).min(end);
    from..*next
}

impl StudyLogs {
    fn read(&self, file: &RunFile) -> Result<Case, Failed> {
        let recording = logs::read(file, BadRows::Refuse, self.line.as_ref(), DirectionChoice::Auto)?;
        let failed = |error| Failed { file: file.path.clone(), error, refusal: None };
        let truth = match self.truths.get(folder_of(file)) {
            Some(folder) => folder.of(&file.path, &recording.rows).map_err(failed)?,
            None => None,
        };
        Ok(Case { recording, as_recorded: None, truth })
    }
}

fn folder_of(file: &RunFile) -> &Path {
    file.path.parent().unwrap_or(Path::new(""))
}
