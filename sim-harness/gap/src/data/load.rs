//! Runs from a folder, as the gap workflow takes them.

use crate::data::{believed::Surroundings, runs::Run};
use rayon::prelude::*;
use rundown::model::units::KmPerHour;
use rundown_files::recording::{DirectionChoice, Recording};
use rundown_files::run_log::{BadRows, RunLog};
use rundown_files::run_set::{RunFile, RunSet};
use rundown_files::sample::{MOST_LOCATION_M, MOST_SPEED_KMH, Sample};
use rundown_files::{map_matching::CentreLine, refusal::ReadError, track_file::TrackFile, units};
use std::path::PathBuf;
use thiserror::Error;

/// Why a log gives no run.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LoadError {
    /// It cannot be read, or has no location.
    #[error(transparent)]
    Log(#[from] ReadError),
    /// Its numbers are in other units.
    #[error("{}: {doubt}", path.display())]
    Units {
        path: PathBuf,
        /// Which, and why it is thought so.
        doubt: units::Doubt,
    },
}

/// Reads one run: as the workflow takes it, and as an estimator replays it.
pub fn run(
    file: &RunFile,
    line: Option<&CentreLine>,
    direction: DirectionChoice,
) -> Result<(Run, Recording), LoadError> {
    let log = RunLog::read(&file.path, BadRows::LeaveOut)?;
    let recording = Recording::new(file, &log, line, direction)?;
    if let Some(doubt) = units::doubt(&recording.rows) {
        let path = file.path.clone();
        return Err(LoadError::Units { path, doubt });
    }
    let most_mps = KmPerHour(MOST_SPEED_KMH).to_mps();
    let mut samples: Vec<Sample> = Vec::with_capacity(recording.rows.len());
    for row in &recording.rows {
        // Times that do not increase were reported when the log was read.
        if samples.last().is_some_and(|last| last.time_s >= row.time_s) {
            continue;
        }
        samples.push(Sample {
            // The same reading in another line of another log is the same.
            line: 0,
            // What no train has was warned of when the log was read; no estimator checks it here.
            location_m: row.location_m.filter(|at| at.abs() < MOST_LOCATION_M),
            speed_mps: row.speed_mps.filter(|v| (0.0..most_mps).contains(v)),
            ..*row
        });
    }
    let run = Run { name: recording.name.clone(), direction: recording.direction, day: recording.day, samples };
    Ok((run, recording))
}

/// Reads all runs, with what an estimator replays of each; those that cannot be used are left out, with the reason.
pub fn runs(set: &RunSet, track: &TrackFile, direction: DirectionChoice) -> (Vec<(Run, Recording)>, Vec<String>) {
    let line = CentreLine::new(&track.centre_line);
    let read: Vec<_> = set.files.par_iter().map(|file| run(file, line.as_ref(), direction)).collect();
    let (mut runs, mut notes): (Vec<(Run, Recording)>, Vec<String>) = (Vec::new(), Vec::new());
    for result in read {
        match result {
            // Counted twice it would stand on both sides of the hold-out.
            Ok((run, _)) if runs.iter().any(|(other, _)| other.samples == run.samples) => {
                let name = &run.name;
                notes.push(format!("{name}: has the samples of another run, to the last digit; the run was left out"));
            }
            Ok((run, recording)) => {
                notes.extend(recording.warnings.iter().cloned());
                runs.push((run, recording));
            }
            Err(error) => notes.push(format!("{error}; the run was left out")),
        }
    }
    (runs, notes)
}

/// What is doubtful about the track that these runs are compared with. `beyond_m`: how far a location may lie beyond its ends.
pub fn about_track(track: &TrackFile, runs: &[Run], beyond_m: f64) -> Vec<String> {
    let mut notes = Vec::new();
    let located = || runs.iter().flat_map(|run| run.samples.iter().filter_map(|s| s.location_m));
    let line = -beyond_m..=track.length_m + beyond_m;
    let beyond = located().filter(|at| !line.contains(at)).count();
    if beyond > 0 {
        let (first_m, last_m) = located().fold((f64::INFINITY, 0.0_f64), |(low, high), at| (low.min(at), high.max(at)));
        notes.push(format!(
            "{beyond} of {} locations are not on the described track: they go from {first_m:.0} to {last_m:.0} m, the track from 0 to {:.0} m. Nothing is known of gradients there; look whether the logs belong to this track.",
            located().count(),
            track.length_m
        ));
    }
    if track.gradient.iter().all(|g| g.permille == 0.0) {
        notes.push("The track is described without gradients. If the line is not flat, its slopes are found as effects of places, of the length of the train or of the direction.".to_owned());
    }
    notes
}

/// What the track file says beside gradients.
pub fn surroundings(track: &TrackFile) -> Surroundings {
    Surroundings {
        length_m: track.length_m,
        curves: track.curve.iter().map(|c| (c.from_m, c.to_m, rundown::model::curves::roeckl(c.radius_m))).collect(),
        tunnels: track.tunnel.iter().map(|t| (t.from_m, t.to_m)).collect(),
        feeding: track.feeding_section.iter().map(|f| (f.from_m, f.to_m)).collect(),
        stops: track.stop.iter().map(|s| s.at_m).collect(),
    }
}
