//! Runs from a folder, as the gap workflow takes them.

use crate::data::{believed::Surroundings, runs::Recorded, runs::Run};
use rayon::prelude::*;
use rundown::model::{train::Train, units::KmPerHour};
use rundown_check::figure::Figure;
use rundown_check::finding::{Done, Kind};
use rundown_check::rows::same::Seen;
use rundown_check::rows::steps;
use rundown_check::{Check, Correction, Known, RecorderCheck, RunCheck, check_beside, limits};
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

/// A lag of a recorder within so many standard deviations is none: it would only move trains on their gradients by
/// chance.
const LAG_SURE: f64 = 3.0;

/// Runs as the workflow takes them, beside what an estimator replays, and what was said while they were read.
#[derive(Debug, Default)]
pub struct Loaded {
    pub runs: Vec<Run>,
    /// Put right but for the scale of the speed: an estimator has that as an effect.
    pub recordings: Vec<Recording>,
    /// What the recorders did; none where the runs were taken as recorded.
    pub check: Option<Check>,
    pub notes: Vec<String>,
    /// Why the first of the runs that cannot be used was left out.
    pub first_left_out: Option<String>,
}

/// Reads all runs of a set, those that can be used. With `as_recorded` nothing is diagnosed nor put right.
pub fn runs(set: &RunSet, train: &Train, track: &TrackFile, direction: DirectionChoice, as_recorded: bool) -> Loaded {
    let line = CentreLine::new(&track.centre_line);
    let read = set.files.par_iter().map(|file| recording(file, line.as_ref(), direction)).collect();
    usable(read, train, track, as_recorded)
}

/// The same of runs that came as tables.
pub fn of_tables(
    recordings: impl IntoIterator<Item = Recording>,
    train: &Train,
    track: &TrackFile,
    as_recorded: bool,
) -> Loaded {
    let named = |mut recording: Recording| {
        recording.path = format!("{}: run {}", recording.path.display(), recording.name).into();
        believable(recording)
    };
    usable(recordings.into_iter().map(named).collect(), train, track, as_recorded)
}

fn usable(read: Vec<Result<Recording, LoadError>>, train: &Train, track: &TrackFile, as_recorded: bool) -> Loaded {
    let mut loaded = Loaded::default();
    for result in read {
        match result {
            Ok(recording) => {
                loaded.notes.extend(recording.warnings.iter().cloned());
                loaded.recordings.push(recording);
            }
            Err(error) => loaded.leave_out(&error.to_string()),
        }
    }
    if as_recorded {
        loaded.leave_out_copies();
        loaded.runs = loaded.recordings.iter().map(|recording| run(recording, as_read(recording))).collect();
    } else {
        let stops_m = track.stops_m();
        let limits = limits::Described::of(Some(*train), Some(track));
        loaded.diagnose(&Known { scale: true, stops_m, limits, ..Known::default() });
    }
    loaded
}

impl Loaded {
    /// Diagnoses recordings.
    #[cfg(test)]
    pub fn of(recordings: Vec<Recording>) -> Self {
        let mut loaded = Self { recordings, ..Self::default() };
        loaded.diagnose(&Known { scale: true, ..Known::default() });
        loaded
    }

    fn leave_out(&mut self, why: &str) {
        let note = format!("{why}; the run was left out");
        self.first_left_out.get_or_insert_with(|| note.clone());
        self.notes.push(note);
    }

    /// Counted twice a run would stand on both sides of the hold-out, put right or not.
    fn leave_out_copies(&mut self) {
        let mut seen = Seen::default();
        for recording in std::mem::take(&mut self.recordings) {
            match seen.earlier(&recording) {
                Some(earlier) => {
                    self.leave_out(&format!("{}: it holds the same rows as {earlier}", recording.path.display()));
                }
                None => self.recordings.push(recording),
            }
        }
    }

    fn diagnose(&mut self, known: &Known) {
        let mut check = check_beside(&mut self.recordings, known);
        // In the runs the scale is put right, too.
        let wheels = check.recorders.iter_mut().filter(|recorder| recorder.is_wheel);
        for finding in wheels.flat_map(|recorder| &mut recorder.findings) {
            if finding.kind == Kind::SpeedScale {
                finding.done = Done::PutRight;
            }
        }
        self.notes.extend(check.notes());
        self.notes.extend(check.perturbed_note().map(|note| format!("{note}; they were used as the others")));
        let recordings = std::mem::take(&mut self.recordings);
        for (recording, of_run) in recordings.into_iter().zip(&check.runs) {
            if let Some(finding) = of_run.refusal() {
                self.leave_out(&format!("{}: {}", recording.path.display(), of_run.said(finding)));
                continue;
            }
            self.runs.push(run(&recording, recorded(&check, of_run)));
            self.recordings.push(recording);
        }
        self.check = Some(check);
    }
}

/// Reads one log.
fn recording(file: &RunFile, line: Option<&CentreLine>, direction: DirectionChoice) -> Result<Recording, LoadError> {
    let log = RunLog::read(&file.path, BadRows::LeaveOut)?;
    believable(Recording::new(file, &log, line, direction)?)
}

/// Not in other units.
fn believable(recording: Recording) -> Result<Recording, LoadError> {
    match units::doubt(&recording.rows) {
        Some(doubt) => Err(LoadError::Units { path: recording.path, doubt }),
        None => Ok(recording),
    }
}

/// The run of a recording whose clock, locations and truncation are put right: its scale is, here.
fn run(recording: &Recording, recorded: Recorded) -> Run {
    let most_mps = KmPerHour(MOST_SPEED_KMH).to_mps();
    let wheel = Correction { offset_mps: 0.0, ..recorded.correction };
    let mut samples: Vec<Sample> = Vec::with_capacity(recording.rows.len());
    for row in &recording.rows {
        // Times that do not increase were reported when the log was read.
        if samples.last().is_some_and(|last| last.time_s >= row.time_s) {
            continue;
        }
        samples.push(Sample {
            // What no train has was warned of when the log was read; no estimator checks it here.
            location_m: row.location_m.filter(|at| at.abs() < MOST_LOCATION_M),
            speed_mps: row.speed_mps.filter(|v| (0.0..most_mps).contains(v)).map(|v| wheel.true_mps(v)),
            ..*row
        });
    }
    let Recording { name, direction, day, driver, .. } = recording;
    let recorded = Recorded { driver: driver.clone(), ..recorded };
    Run { name: name.clone(), direction: *direction, day: *day, samples, recorded }
}

/// What a log says of its recorder without a diagnosis: how it rounds.
fn as_read(recording: &Recording) -> Recorded {
    let rows = || recording.rows.iter();
    Recorded {
        unit: recording.unit.clone(),
        speed_step_mps: steps::of_speed_kmh(rows()).unwrap_or(0.0) / 3.6,
        effort_step_n_per_kg: steps::of_effort_n_per_kg(rows()).unwrap_or(0.0),
        ..Recorded::default()
    }
}

/// What the diagnosis says of one run.
pub fn recorded(check: &Check, run: &RunCheck) -> Recorded {
    let Some(recorder) = check.recorder(&run.unit) else {
        return Recorded::default();
    };
    let scale = recorder.scale.filter(|_| recorder.is_wheel);
    Recorded {
        unit: run.unit.clone(),
        correction: Correction { scale: scale.map_or(1.0, |scale| scale.value), ..recorder.correction },
        scale,
        own_scale: run.scale,
        speed_step_mps: recorder.speed_step_kmh.unwrap_or(0.0) / 3.6,
        effort_step_n_per_kg: recorder.effort_step_n_per_kg.unwrap_or(0.0),
        // The diagnosis asks how old the speed is, the effect how old the location.
        usual_lag_s: recorder.skew_s.map(|skew| Figure { value: -skew.value, sd: skew.sd }),
        location_lag_s: -skew_s(recorder, run),
        ..Recorded::default()
    }
}

/// By how much the speed of a run is older than the location, s: its own figure, drawn to the usual one of its recorder
/// by what is known of both.
fn skew_s(recorder: &RecorderCheck, run: &RunCheck) -> f64 {
    let usual = recorder.skew_s.filter(|usual| usual.away_from(0.0) > LAG_SURE).map_or(0.0, |usual| usual.value);
    let (Some(own), Some(spread_s)) = (run.skew_s, recorder.skew_spread_s) else {
        return usual;
    };
    own.drawn(usual, spread_s)
}

/// No gradient is described.
pub fn is_level(track: &TrackFile) -> bool {
    track.gradient.iter().all(|g| g.permille == 0.0)
}

/// What is doubtful about the described gradients.
pub fn about_gradients(track: &TrackFile) -> Option<&'static str> {
    is_level(track).then_some("The track is described without gradients. If the line is not flat, its slopes are found as effects of places, of the length of the train or of the direction.")
}

/// What the track file says beside gradients.
pub fn surroundings(track: &TrackFile) -> Surroundings {
    Surroundings {
        is_level: is_level(track),
        length_m: track.length_m,
        curves: track.curve.iter().map(|c| (c.from_m, c.to_m, rundown::model::curves::roeckl(c.radius_m))).collect(),
        tunnels: track.tunnel.iter().map(|t| (t.from_m, t.to_m)).collect(),
        feeding: track.feeding_section.iter().map(|f| (f.from_m, f.to_m)).collect(),
        stops: track.stops_m(),
    }
}
