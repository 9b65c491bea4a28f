//! Recorded runs for the comparison: as their recorder wrote them and, where a diagnosis puts something right, as they
//! are then.
//!
//! In: runs as recorded, the description of their train. Out: the runs by recorder, the remarks that they say nothing
//! of, and notes. The first [`CHUNK`] runs are compared: each goes through some hundred filters.

use super::comparison::ByRecorder;
use super::reading::Recorder;
use super::remarks::{COUNT, FAST_MPS, REMARKS};
use crate::logs;
use crate::replaying::CHUNK;
use crate::study::Refused;
use crate::study::dynamics::SLOW_MPS;
use crate::study::source::RunSource;
use rundown::model::train::Train;
use rundown_check::finding::Kind;
use rundown_check::{Check, Known, RecorderCheck, rows::same::Seen};
use rundown_files::recording::Recording;
use rundown_pages::numbers::counted;
use rundown_truth::sensors::SpeedReading;

/// The paper's r0, N/kg: for another train its band says nothing.
const PAPERS_R0: f64 = 7.38e-3;
/// A skew is rounded to this, s.
const SKEW_STEP_S: f64 = 0.1;

pub struct RecordedReadings {
    pub by_recorder: ByRecorder,
    pub left_out: [bool; COUNT],
    pub notes: Vec<String>,
    pub runs: usize,
}

/// How runs are taken.
#[derive(Clone, Copy, Debug)]
pub struct Taken<'a> {
    pub known: &'a Known,
    pub as_recorded: bool,
    pub keep_perturbed: bool,
}

/// `source`: runs that are not diagnosed yet.
pub fn recorded(source: &mut RunSource, taken: Taken<'_>, train: &Train) -> Result<RecordedReadings, Refused> {
    let mut notes = Vec::new();
    let mut read: Vec<Recording> = Vec::new();
    for case in source.next_chunk()?.unwrap_or_default() {
        match case {
            Ok(case) => read.push(case.recording),
            Err(failed) => notes.push(failed.error),
        }
    }
    if source.total() > CHUNK {
        notes.push(format!("the first {CHUNK} of {} runs are compared", source.total()));
    }
    let (each, found) = logs::diagnosed_each(read.clone(), taken.known, &mut Seen::default());
    notes.extend(found.notes());
    let (mut as_read, mut right, mut aside) = (Vec::new(), Vec::new(), 0);
    for (read, diagnosed) in read.into_iter().zip(each) {
        match diagnosed {
            Err(failed) => notes.push(failed.error),
            Ok(diagnosed) if diagnosed.perturbed.is_some() && !taken.keep_perturbed => aside += 1,
            Ok(diagnosed) => {
                as_read.push(read);
                right.push(diagnosed);
            }
        }
    }
    if aside > 0 {
        let runs = counted(aside, "perturbed run is", "perturbed runs are");
        notes.push(format!("{runs} set aside; --keep-perturbed keeps them"));
    }
    let left_out = left_out(train, &as_read);
    let names: Vec<&str> = REMARKS.iter().zip(left_out).filter(|(_, out)| *out).map(|((name, _), _)| *name).collect();
    if !names.is_empty() {
        notes.push(format!("not judged, for these runs say nothing of it: {}", names.join(", ")));
    }
    let runs = as_read.len();
    Ok(RecordedReadings { by_recorder: by_recorder(&found, as_read, right, taken.as_recorded), left_out, notes, runs })
}

fn by_recorder(found: &Check, as_read: Vec<Recording>, right: Vec<Recording>, as_recorded: bool) -> ByRecorder {
    let recorder = recorder(found);
    let put_right = Recorder {
        skew_s: 0.0,
        speed: if recorder.speed == SpeedReading::Truncated { SpeedReading::Rounded } else { recorder.speed },
    };
    let is_changed = as_read.iter().zip(&right).any(|(read, right)| read.rows != right.rows);
    match (is_changed && !as_recorded, recorder == put_right) {
        (false, _) => vec![(recorder, as_read)],
        // What was put right is no matter of a recorder's skew or rounding: as recorded they are of no use.
        (true, true) => vec![(put_right, right)],
        (true, false) => vec![(recorder, as_read), (put_right, right)],
    }
}

/// What the diagnosis says of the recorder of the most runs.
fn recorder(found: &Check) -> Recorder {
    let largest = found.recorders.iter().max_by_key(|recorder| recorder.compared);
    let skew_s = largest.and_then(|recorder| recorder.skew_s.as_ref()).map_or(0.0, |skew| skew.value);
    let speed = match largest {
        Some(recorder) if recorder.correction.offset_mps > 0.0 && truncates(recorder) => SpeedReading::Truncated,
        Some(recorder) if recorder.speed_step_kmh.is_some() => SpeedReading::Rounded,
        _ => SpeedReading::Exact,
    };
    Recorder { skew_s: (skew_s / SKEW_STEP_S).round() * SKEW_STEP_S + 0.0, speed }
}

/// An offset that is put right may be another one.
fn truncates(recorder: &RecorderCheck) -> bool {
    recorder.findings.iter().any(|finding| finding.kind == Kind::TruncatedSpeed)
}

/// Remarks of which the runs say nothing: the band of r0 is the paper's train's, and lower speeds are those below 80
/// and 100 km/h.
fn left_out(train: &Train, runs: &[Recording]) -> [bool; COUNT] {
    let speeds = runs.iter().flat_map(|run| &run.rows).filter_map(|row| row.speed_mps);
    let top_mps = speeds.fold(0.0, f64::max);
    let is_other_train = train.davis().r0 != PAPERS_R0;
    REMARKS.map(|(name, _)| match name {
        "lower end" | "upper end" => is_other_train,
        "rises" => top_mps <= SLOW_MPS,
        "inverse" => top_mps <= FAST_MPS,
        _ => false,
    })
}
