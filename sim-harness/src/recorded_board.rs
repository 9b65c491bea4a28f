//! What a board learned, from a recording of what it said.
//!
//! In: what `rundown display --record` or `rundown link --record` wrote, or the bytes of a serial line. Out: the end of
//! each run; and the train as described to the board, where the recording has what was sent to it.

use crate::display::sent::SentSetup;
use crate::link::record::{self, Way};
use rundown_files::refusal::{Place, ReadError};
use rundown_files::train_file::TrainFile;
use rundown_pages::numbers::counted;
use rundown_wire::{Body, Features, Learned, Reader, Received, RunSummary};
use std::path::Path;

/// First bytes of a recording in text.
const TEXT: &[u8] = b"time_us,";

/// What a recording holds.
#[derive(Debug, Default)]
pub struct BoardRecording {
    pub ends: Vec<RunEnd>,
    pub train: Option<TrainFile>,
    /// Frames that never arrived, or cannot be understood.
    pub missing: u64,
    /// Numbers of runs between those that end in it, first and last of each gap: whole runs that were not recorded, or
    /// of which the end was lost. Each run numbers its frames from 0 on, so `missing` does not know of theirs.
    pub missing_runs: Vec<[u32; 2]>,
    /// What is there of a last line or frame that was cut off, and was left out.
    pub cut: Option<String>,
    published: Option<Learned>,
    features: Option<Features>,
}

/// What the board said when a run ended.
#[derive(Debug)]
pub struct RunEnd {
    pub summary: RunSummary,
    /// How far it trusted its resistance.
    pub published: Learned,
    pub features: Option<Features>,
}

/// Reads a recording.
///
/// # Errors
/// [`ReadError`] where it cannot be read, or no run ends in it.
pub fn read(path: &Path) -> Result<BoardRecording, ReadError> {
    let bytes = std::fs::read(path).map_err(|source| ReadError::Io { path: path.to_owned(), source })?;
    log::info!("read {}", path.display());
    let refused = |message: String| ReadError::from(Place::of_file(path).refuse("", message));
    let (mut recorded, mut reader, mut sent) = (BoardRecording::default(), Reader::new(), SentSetup::default());
    if bytes.starts_with(TEXT) {
        let (rows, cut) = record::read_whole_lines(&bytes).map_err(|error| refused(error.to_string()))?;
        recorded.cut = cut.map(|cut| format!("{} of line {}", counted(cut.bytes, "byte", "bytes"), cut.line));
        for row in rows {
            match row.way {
                Way::Received => recorded.hear(reader.message(&row.message)),
                Way::Sent => {
                    recorded.train = sent.hear(&row.message).and_then(|setup| setup.train.clone()).or(recorded.train)
                }
            }
        }
    } else {
        bytes.iter().for_each(|byte| recorded.hear(reader.byte(*byte)));
        // A zero ends each frame.
        let rest = bytes.iter().rev().take_while(|byte| **byte != 0).count();
        recorded.cut = (rest > 0).then(|| format!("{} of a frame", counted(rest, "byte", "bytes")));
    }
    let tally = reader.tally();
    recorded.missing = u64::from(tally.lost) + u64::from(tally.damaged) + u64::from(tally.unknown);
    if recorded.ends.is_empty() {
        let found = format!("found none in {}", counted(tally.frames as usize, "frame", "frames"));
        return Err(refused(format!(
            "expected a recording of a board in which a run ends (frame run_summary), {found}"
        )));
    }
    Ok(recorded)
}

impl BoardRecording {
    fn hear(&mut self, received: Option<Received>) {
        match received.map(|received| received.frame.body) {
            Some(Body::Parameters(parameters)) => self.published = Some(parameters.learned),
            Some(Body::Features(features)) => self.features = Some(features),
            Some(Body::RunSummary(summary)) => {
                // Said once more, it is the same run.
                self.ends.pop_if(|end| end.summary.run == summary.run);
                if let Some(before) = self.ends.last().map(|end| end.summary.run)
                    && before.saturating_add(1) < summary.run
                {
                    self.missing_runs.push([before + 1, summary.run - 1]);
                }
                let published = self.published.unwrap_or(Learned::NotYet);
                self.ends.push(RunEnd { summary, published, features: self.features.take() });
            }
            _ => (),
        }
    }
}
