//! Logs as recordings, or why one cannot be used.

use rundown_check::finding::{Done, Finding, Kind};
use rundown_check::{Check, Known, check_beside};
use rundown_files::recording::{DirectionChoice, Recording};
use rundown_files::{map_matching::CentreLine, run_log::BadRows, run_set::RunFile};
use std::path::PathBuf;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failed {
    pub file: PathBuf,
    pub error: String,
}

pub fn read(
    file: &RunFile,
    bad_rows: BadRows,
    line: Option<&CentreLine>,
    direction: DirectionChoice,
) -> Result<Recording, Failed> {
    Recording::read(file, bad_rows, line, direction)
        .map_err(|error| Failed { file: file.path.clone(), error: error.to_string() })
}

/// Findings of single runs that are printed; `replay.json` has all.
const PRINTED: usize = 8;

/// Diagnoses recordings, puts right what is beyond doubt, and refuses those that cannot be used. Out: the others, and what was found.
pub fn diagnosed(mut recordings: Vec<Recording>, known: Known) -> (Vec<Recording>, Vec<Failed>, Check) {
    let found = check_beside(&mut recordings, known);
    let (mut used, mut failed) = (Vec::new(), Vec::new());
    for (recording, run) in recordings.into_iter().zip(&found.runs) {
        match run.findings.iter().find(|finding| finding.done == Done::Refused) {
            None => used.push(recording),
            Some(finding) => {
                let error = format!("{}: {finding}", recording.path.display());
                failed.push(Failed { file: recording.path, error });
            }
        }
    }
    (used, failed, found)
}

/// What a person must know of a diagnosis, a line each: whatever changed a reading, and what spoils results and was not changed.
pub fn notes(found: &Check) -> Vec<String> {
    let spoils = |finding: &&Finding| match finding.done {
        Done::PutRight | Done::LeftOut => true,
        Done::Refused => false,
        Done::Said => matches!(finding.kind, Kind::Reset | Kind::Skew | Kind::SpeedOffset),
    };
    let of_recorder = found.recorders.iter().flat_map(|recorder| {
        let name = if recorder.unit.is_empty() { "all runs" } else { &recorder.unit };
        recorder.findings.iter().filter(spoils).map(move |finding| format!("{name}: {finding}"))
    });
    let mut notes: Vec<String> = of_recorder.collect();
    let of_run = found
        .runs
        .iter()
        .flat_map(|run| run.findings.iter().filter(spoils).map(move |finding| format!("{}: {finding}", run.name)));
    let of_run: Vec<String> = of_run.collect();
    let more = of_run.len().saturating_sub(PRINTED);
    notes.extend(of_run.into_iter().take(PRINTED));
    if more > 0 {
        notes.push(format!("{more} more findings of single runs, all by `rundown check`"));
    }
    notes
}
