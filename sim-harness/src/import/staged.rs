//! A run between cutting and placing: its rows wait in a file, what places it is held.

use super::cut::{Stretch, fix};
use super::geo::Fix;
use rundown_files::sample::{COLUMNS, Sample};
use std::fs::File;
use std::io::{self, BufRead, BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Distance between marks, m.
const MARKS_M: f64 = 25.0;

/// A place that a run passed.
#[derive(Clone, Copy, Debug)]
pub struct Mark {
    pub at_m: f64,
    pub speed_mps: f64,
    pub fix: Option<Fix>,
    pub altitude_m: Option<f64>,
}

/// What is known of a run while its rows wait.
#[derive(Clone, Debug)]
pub struct Staged {
    pub name: String,
    pub source: String,
    pub unit: String,
    pub reason: String,
    /// Time of the first row; since 1970 UTC if dated.
    pub begin_s: f64,
    pub duration_s: f64,
    pub is_dated: bool,
    pub from_fixes: bool,
    /// It begins with its file, or with a run of a column.
    pub is_head: bool,
    pub rows: usize,
    pub lines: (u64, u64),
    /// Own locations of standing, and how long, s.
    pub stops: Vec<(f64, f64)>,
    pub marks: Vec<Mark>,
    /// Columns that are written: those that have values, and those that every log has.
    pub has: [bool; COLUMNS.len()],
    path: PathBuf,
}

impl Staged {
    /// Writes the rows of a run and keeps what places it.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn new(piece: &Stretch, name: String, source: &Path, folder: &Path) -> io::Result<Self> {
        let path = folder.join(format!("{name}.rows"));
        let mut file = BufWriter::new(File::create(&path)?);
        let mut has = COLUMNS.map(|column| column.needed);
        for row in &piece.rows {
            has.iter_mut().zip(&COLUMNS).for_each(|(has, column)| *has |= (column.get)(row).is_some());
            writeln!(file, "{}", row.line)?;
            let values = COLUMNS.map(|column| (column.get)(row).map_or_else(String::new, |value| value.to_string()));
            writeln!(file, "{}", values.join(","))?;
        }
        file.flush()?;
        let (begin_s, end_s) =
            piece.rows.first().zip(piece.rows.last()).map_or((0.0, 0.0), |(first, last)| (first.time_s, last.time_s));
        let lines = piece.rows.first().zip(piece.rows.last()).map_or((0, 0), |(first, last)| (first.line, last.line));
        Ok(Self {
            name,
            source: source.display().to_string(),
            unit: piece.unit.clone(),
            reason: piece.reason.clone(),
            begin_s,
            duration_s: end_s - begin_s,
            is_dated: piece.is_dated,
            from_fixes: piece.from_fixes,
            is_head: piece.is_head,
            rows: piece.rows.len(),
            lines,
            stops: piece.stops(),
            marks: marks(piece),
            has,
            path,
        })
    }

    /// The rows again, one after the other.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn read(&self, each: &mut dyn FnMut(Sample) -> io::Result<()>) -> io::Result<()> {
        let mut lines = BufReader::new(File::open(&self.path)?).lines();
        while let (Some(line), Some(values)) = (lines.next().transpose()?, lines.next().transpose()?) {
            let mut sample = Sample { line: line.parse().unwrap_or(0), ..Sample::default() };
            for (column, value) in COLUMNS.iter().zip(values.split(',')) {
                if let Ok(value) = value.parse() {
                    (column.set)(&mut sample, value);
                }
            }
            each(sample)?;
        }
        std::fs::remove_file(&self.path)
    }

    /// Rows of a run that is left out.
    ///
    /// # Errors
    /// The file cannot be removed.
    pub fn forget(&self) -> io::Result<()> {
        std::fs::remove_file(&self.path)
    }

    pub fn length_m(&self) -> f64 {
        let ends = self
            .marks
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), mark| (low.min(mark.at_m), high.max(mark.at_m)));
        (ends.1 - ends.0).max(0.0)
    }
}

fn marks(piece: &Stretch) -> Vec<Mark> {
    let mut marks: Vec<Mark> = Vec::new();
    for (row, altitude_m) in piece.rows.iter().zip(&piece.altitudes_m) {
        let (Some(at_m), Some(speed_mps)) = (row.location_m, row.speed_mps) else { continue };
        let last = marks.last();
        if last.is_none_or(|last| (at_m - last.at_m).abs() >= MARKS_M) {
            marks.push(Mark { at_m, speed_mps, fix: fix(row), altitude_m: *altitude_m });
        }
    }
    marks
}
