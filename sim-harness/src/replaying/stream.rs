//! A replay without a row for each tick: run after run is read, replayed, written and forgotten, so that memory does
//! not grow with them.
//!
//! Logs are read unit by unit, so the rows of a unit follow each other. A recorder is diagnosed by its runs among
//! [`CHUNK`] at a time.

use super::{Opened, ReplayError, Summary, learned};
use crate::advice::{Advice, before_brakes::BeforeBrakes};
use crate::output::tables::Table;
use crate::output::{features, files, json, parameters};
use rundown::estimator::config::Mode;
use rundown_files::WriteError;
use rundown_files::folder;
use rundown_files::off_track::OffTrack;
use rundown_files::recording::Recording;
use rundown_files::replay::{ReplayedRun, replay_apart_by, replay_units_by};
use std::collections::{HashMap, HashSet};
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Runs that are in memory at a time.
pub const CHUNK: usize = 256;

/// Why nothing was written.
#[derive(Debug, Error)]
#[error(transparent)]
#[expect(missing_docs, reason = "said by the messages")]
pub enum StreamError {
    Replay(#[from] ReplayError),
    Write(#[from] WriteError),
    /// No run could be used, or something is to be warned of and nothing may be.
    #[error("no run could be used")]
    Nothing(Box<Summary>),
}

/// Tables of a row a run, and `replay.json`.
struct Outputs {
    features: Table<ReplayedRun>,
    parameters: Table<ReplayedRun>,
    switches: Table<features::Switch>,
    json: json::Stream<BufWriter<File>>,
    json_path: PathBuf,
}

impl Opened {
    /// Replays the logs and writes the tables of a row a run and `replay.json` into the folder `out`; `done` is called
    /// once for each run, `seen` gets the runs as they come.
    ///
    /// # Errors
    /// [`StreamError`]: nothing was written then.
    pub fn stream(
        mut self,
        out: &Path,
        done: impl Fn() + Sync,
        mut seen: impl FnMut(&[ReplayedRun]),
    ) -> Result<Summary, StreamError> {
        let provenance = self.provenance.clone();
        self.source.by_unit();
        folder::write("replay", out, &provenance, |folder| {
            let mut outputs = Outputs::begin(&self, folder)?;
            let mut vehicles = HashMap::new();
            let mut advice = Advice::default();
            let mut before_brakes = BeforeBrakes::default();
            let mut summary = Summary { notes: self.first_notes(), ..Summary::default() };
            let mut off = self.off_track();
            while let Some(chunk) = self.next_chunk(CHUNK)? {
                let mut recordings = self.diagnosed(chunk, &mut summary).map_err(StreamError::from)?;
                self.leave_out_beyond(&mut off, &mut recordings);
                if summary.runs == 0 {
                    // The descriptions are judged by the first runs: what these teach must rest on the same doubt as
                    // all.
                    self.doubt_descriptions(&recordings, &mut summary)?;
                }
                let own = self.own_estimators(&recordings).map_err(ReplayError::from)?;
                let model = |recording: &Recording| own.get(&recording.name).unwrap_or(&self.estimator);
                let mut runs = if self.request.carried {
                    replay_units_by(&model, &recordings, self.request.tick, &mut vehicles, &done)
                } else {
                    replay_apart_by(&model, &recordings, self.request.tick, &done)
                };
                self.judge(&recordings, &own, &mut runs, (&mut before_brakes, &mut advice));
                drop(recordings);
                summary.count(&runs, self.config.mode);
                outputs.add(&runs)?;
                seen(&runs);
            }
            summary.notes.extend(self.of_no_run());
            summary.first(&off);
            summary.notes.extend(advice.notes(&self.estimator, summary.says_gradients()));
            summary.notes.extend(before_brakes.notes());
            let mut said = HashSet::new();
            summary.notes.retain(|note| said.insert(note.clone()));
            if summary.runs == 0 || self.request.strict && summary.said() > 0 {
                return Err(StreamError::Nothing(Box::new(summary)));
            }
            outputs.end(&summary, self.config.track_doubt.gradient_sd_permille)?;
            Ok(summary)
        })
    }
}

impl Summary {
    /// The weightiest note of all, where there is anything to be said.
    pub(super) fn first(&mut self, off: &OffTrack) {
        if let Some(off) = off.any() {
            self.notes.insert(0, off.to_string());
        }
    }

    fn count(&mut self, runs: &[ReplayedRun], mode: Mode) {
        self.runs += runs.len();
        self.unused += runs.iter().filter(|run| !run.is_used).count();
        self.warnings += runs.iter().map(|run| run.warnings.len()).sum::<usize>();
        self.learned |= runs.iter().any(|run| learned(run, mode));
    }
}

impl Outputs {
    fn begin(opened: &Opened, folder: &Path) -> Result<Self, WriteError> {
        let format = opened.request.tables.format;
        let json_path = folder.join("replay.json");
        let json = File::create(&json_path).and_then(|file| json::Stream::begin(BufWriter::new(file), &opened.head()));
        Ok(Self {
            features: Table::begin(folder, "features", features::columns(&opened.config.features), format)?,
            parameters: Table::begin(folder, "parameters", parameters::columns(), format)?,
            switches: Table::begin(folder, "switching_points", features::switch_columns(), format)?,
            json: json.map_err(|source| files::failed(&json_path, source))?,
            json_path,
        })
    }

    fn add(&mut self, runs: &[ReplayedRun]) -> Result<(), WriteError> {
        self.features.add(runs)?;
        self.parameters.add(runs)?;
        self.switches.add(runs.iter().flat_map(features::switches))?;
        self.json.runs(runs).map_err(|source| files::failed(&self.json_path, source))
    }

    fn end(self, summary: &Summary, gradient_sd_permille: f64) -> Result<(), WriteError> {
        self.features.end()?;
        self.parameters.end()?;
        self.switches.end()?;
        let Summary { failed, notes, gradient_doubt, .. } = summary;
        let gradient_doubt = gradient_doubt.as_ref();
        let ended = self.json.end(&json::End { failed, notes, gradient_doubt, gradient_sd_permille });
        ended.map_err(|source| files::failed(&self.json_path, source))
    }
}
