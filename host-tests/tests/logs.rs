//! Are logs read? The run of `data/reference`, or those of the folder `RUNDOWN_LOGS` (docs/replay.md).
//!
//! What needs coordinates reads 105 stop-to-stop runs recorded by phone on one suburban line, 1 s samples. They are not
//! part of the project (their licence is the GPL).

use host_tests::prelude::*;
use host_tests::reference::{Logs, train_and_track};
use rundown_files::map_matching::{CentreLine, MatchState};
use rundown_files::replay::{Tick, replay_carried_by};
use rundown_files::run_set::RunFile;
use rundown_files::track_file::CentreLinePoint;
use serde::Deserialize;
use std::collections::HashMap;

/// Half of all matched locations lie within this of the recording's own projection, m: the origin of a run is given to
/// 1 m.
const MATCH_MEDIAN_M: f64 = 0.3;
/// All of them lie within this, m.
const MATCH_MAX_M: f64 = 1.0;
/// After a longer silence the recording's own location is not to be trusted, s: twice it is 300 and 600 m from where
/// the coordinates lie.
const LONG_GAP_S: f64 = 60.0;

/// A row of the recording's own index.
#[derive(Deserialize)]
struct IndexRow {
    file: String,
    direction: String,
    line_from_m: f64,
    samples: usize,
}

#[derive(Deserialize)]
struct LineRow {
    chainage_m: f64,
    latitude_deg: f64,
    longitude_deg: f64,
}

fn rows<T: for<'a> Deserialize<'a>>(path: &Path) -> Vec<T> {
    let mut reader = csv::Reader::from_path(path).unwrap();
    reader.deserialize().map(|row| row.unwrap()).collect()
}

fn index(folder: &Path) -> HashMap<String, IndexRow> {
    let rows = rows(&folder.join("index.csv")).into_iter();
    let name = |row: &IndexRow| Path::new(&row.file).file_stem().unwrap().to_string_lossy().into_owned();
    rows.map(|row: IndexRow| (name(&row), row)).collect()
}

fn centre_line(folder: &Path) -> CentreLine {
    let point = |row: LineRow| CentreLinePoint {
        at_m: row.chainage_m,
        latitude_deg: row.latitude_deg,
        longitude_deg: row.longitude_deg,
    };
    let points: Vec<CentreLinePoint> = rows(&folder.join("kolkata_line.csv")).into_iter().map(point).collect();
    CentreLine::new(&points).unwrap()
}

/// The recorded runs.
fn recorded() -> Logs {
    let logs = Logs::find();
    assert_eq!(logs.set.files.len(), 105);
    logs
}

#[test]
fn every_row_of_every_run_is_read() {
    let logs = Logs::find();
    let index = logs.folder.join("index.csv").is_file().then(|| index(&logs.folder));
    for file in logs.set.files {
        let log = RunLog::read(&file.path, BadRows::Refuse).unwrap();
        assert!(log.warnings.is_empty(), "{}: {:?}", file.name, log.warnings);
        assert!(log.other_columns.is_empty(), "{}: {:?}", file.name, log.other_columns);
        let lines = || std::fs::read_to_string(&file.path).unwrap().lines().count() - 1;
        let expected = index.as_ref().map_or_else(lines, |index| index[&file.name].samples);
        assert_eq!(log.samples.len(), expected, "{}", file.name);
    }
}

#[test]
#[ignore = "needs the recorded runs with coordinates: RUNDOWN_LOGS=FOLDER"]
fn coordinates_are_matched_where_the_recording_says() {
    let Logs { folder, set } = recorded();
    let (index, line) = (index(&folder), centre_line(&folder));
    let mut errors_m = Vec::new();
    for file in set.files {
        let log = RunLog::read(&file.path, BadRows::Refuse).unwrap();
        let row = &index[&file.name];
        let sign = if row.direction == "down" { 1.0 } else { -1.0 };
        let mut state = MatchState::default();
        let mut last_s = 0.0;
        for sample in &log.samples {
            let found = line.locate(&mut state, sample.time_s, sample.latitude_deg, sample.longitude_deg);
            let found = found.unwrap_or_else(|reason| panic!("{} line {}: {reason:?}", file.name, sample.line));
            let location_m = sample.location_m.unwrap();
            let gap_s = sample.time_s - std::mem::replace(&mut last_s, sample.time_s);
            // Before its departure stop the recording says 0.0.
            if location_m > 0.0 && gap_s < LONG_GAP_S {
                errors_m.push((found.location_m - (row.line_from_m + sign * location_m)).abs());
            }
        }
    }
    errors_m.sort_by(f64::total_cmp);
    let median_m = errors_m[errors_m.len() / 2];
    let max_m = errors_m[errors_m.len() - 1];
    println!("{} fixes: median {median_m:.3} m, largest {max_m:.3} m", errors_m.len());
    assert!(errors_m.len() > 25_000);
    assert!(median_m < MATCH_MEDIAN_M, "median {median_m} m");
    assert!(max_m < MATCH_MAX_M, "largest {max_m} m");
}

#[test]
#[ignore = "needs the recorded runs with coordinates: RUNDOWN_LOGS=FOLDER"]
fn runs_without_a_location_column_get_location_and_direction_from_coordinates() {
    let Logs { folder, set } = recorded();
    let (index, line) = (index(&folder), centre_line(&folder));
    for file in set.files {
        let mut log = RunLog::read(&file.path, BadRows::Refuse).unwrap();
        log.has_location_column = false;
        let recording = Recording::new(&file, &log, Some(&line), DirectionChoice::Auto).unwrap();
        assert!(recording.warnings.is_empty(), "{:?}", recording.warnings);
        // On this line "down" leads away from the terminus at 0 m: there locations grow.
        let expected = if index[&file.name].direction == "down" { Direction::Up } else { Direction::Down };
        assert_eq!(recording.direction, expected, "{}", file.name);
    }
}

#[test]
fn every_run_is_replayed_to_its_last_row() {
    let logs = Logs::find();
    let estimator = Estimator::try_new(Config::default(), logs.train().1, logs.track().1).unwrap();
    let read = |file: &RunFile| Recording::read(file, BadRows::Refuse, None, DirectionChoice::Auto).unwrap();
    let recordings: Vec<Recording> = logs.set.files.iter().map(read).collect();
    for tick in [Tick::EverySample, Tick::Period { seconds: 10.0 }] {
        for run in replay_carried_by(&|_| &estimator, &recordings, tick, || ()) {
            assert!(run.dropped.is_empty(), "{}: {:?}", run.name, run.dropped);
            if tick == Tick::EverySample {
                assert_eq!(run.estimates.len(), run.rows, "{}", run.name);
            }
            assert!(run.vehicle_after.is_finite(), "{}", run.name);
            for estimate in &run.estimates {
                assert!(estimate.belief.is_finite(), "{} at {} s", run.name, estimate.time_s);
            }
        }
    }
}

#[test]
fn a_log_of_one_row_and_a_log_without_readings_are_replayed() {
    let track = Track::try_new(1000.0, [Gradient { from_m: 0.0, permille: 1.0 }]).unwrap();
    let estimator = Estimator::try_new(Config::default(), train_and_track().0, track).unwrap();
    for rows in ["0,0,0\n", "0,,\n10,,\n20,,\n"] {
        let text = format!("time_s,location_m,speed_kmh\n{rows}");
        let log = RunLog::parse("run.csv".as_ref(), text.as_bytes(), BadRows::Refuse).unwrap();
        let file = RunSet::find(&["run.csv".into()]).unwrap().files.remove(0);
        let recording = Recording::new(&file, &log, None, DirectionChoice::Auto).unwrap();
        let run = replay_carried_by(&|_| &estimator, &[recording], Tick::EverySample, || ()).remove(0);
        assert_eq!(run.estimates.len(), log.samples.len());
    }
}
