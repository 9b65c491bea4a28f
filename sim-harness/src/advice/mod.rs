//! What a person should know before trusting the results: things that are no error of any log, and still spoil all of it.
//!
//! In: the estimator, the runs as replayed. Out: notes, one line each.

mod vehicle;

use rundown::estimator::Estimator;
use rundown::estimator::config::Mode;
use rundown::tick::estimate::Cause;
use rundown_files::replay::ReplayedRun;

const NAMED: usize = 3;
/// One reading in so many off the track is no glitch of a receiver.
const SHARE_OFF_TRACK: usize = 20;

pub fn advice(estimator: &Estimator, runs: &[ReplayedRun]) -> Vec<String> {
    let (config, track_length_m) = (estimator.config(), estimator.track().length_m());
    let mut notes = Vec::new();
    if runs.is_empty() {
        return notes;
    }
    let mut about = |runs: Vec<&ReplayedRun>, text: &str| {
        if !runs.is_empty() {
            notes.push(format!("{}: {text}", names(&runs)));
        }
    };
    let off_track = |run: &&ReplayedRun| {
        let off = run.summary.counters.of(Cause::LocationOutOfRange) as usize;
        off * SHARE_OFF_TRACK > run.estimates.len()
    };
    about(
        runs.iter().filter(off_track).collect(),
        &format!(
            "more than one location in {SHARE_OFF_TRACK} lies off the track, which is 0 to {track_length_m} m: are track and length_m those of this line?"
        ),
    );
    let without_speed = |run: &&ReplayedRun| {
        let mut rows = run.measurements.iter();
        rows.all(|measurement| measurement.speed_mps.is_none())
    };
    about(
        runs.iter().filter(without_speed).collect(),
        "no speed_kmh in any row, without which nothing is known of the train",
    );
    if config.mode == Mode::Measured {
        let without_effort = |run: &&ReplayedRun| {
            let mut rows = run.measurements.iter();
            rows.all(|measurement| measurement.effort_n_per_kg.is_none())
        };
        about(
            runs.iter().filter(without_effort).collect(),
            "no effort_n_per_kg, without which the measured mode learns nothing",
        );
    }
    if config.mode == Mode::Paper {
        notes.push(
            "in the paper mode the estimate does not follow the true resistance, and its deviation is no measure of accuracy"
                .to_owned(),
        );
    } else if runs.iter().all(|run| run.summary.learned_s == 0.0) {
        let learning = &config.learning;
        let what = match config.mode {
            Mode::Gated => format!("coasting above {} km/h", learning.min_speed_kmh),
            _ => "known effort".to_owned(),
        };
        notes.push(format!(
            "nothing was learned about the resistance: it takes {} s of {what} in one piece",
            learning.min_segment_s
        ));
    }
    if config.mode != Mode::Paper {
        notes.extend(vehicle::notes(estimator, runs));
    }
    notes
}

/// `run01, run02, run03 and 4 more runs`
fn names(runs: &[&ReplayedRun]) -> String {
    let first: Vec<&str> = runs.iter().take(NAMED).map(|run| run.name.as_str()).collect();
    let text = first.join(", ");
    match runs.len().saturating_sub(NAMED) {
        0 => text,
        1 => format!("{text} and 1 more run"),
        more => format!("{text} and {more} more runs"),
    }
}
