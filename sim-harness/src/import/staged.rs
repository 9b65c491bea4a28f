//! A run between cutting and placing: its rows wait in a file, what places it is held.

use super::geo::Fix;
use super::speeds;
use super::stretch::{Stretch, fix};
use rundown_files::sample::{COLUMNS, Sample};
use rundown_files::statistics::extremes;
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
    pub driver: String,
    pub reason: String,
    /// Time of the first row; since 1970 UTC if dated.
    pub begin_s: f64,
    /// When it begins, since 1970 UTC, if that is known.
    pub departure_s: Option<f64>,
    pub duration_s: f64,
    pub from_fixes: bool,
    /// It begins with its file, or with a run of a column.
    pub is_head: bool,
    /// The turn of its odometer, m, where it began again at zero on the way.
    pub turn_m: Option<f64>,
    pub rows: usize,
    pub lines: (u64, u64),
    /// Own locations of standing, and how long, s.
    pub stops: Vec<(f64, f64)>,
    /// First, least and greatest own location of the marks, and how many of them have a position.
    pub first_m: f64,
    pub ends_m: (f64, f64),
    pub fixes: usize,
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
        let marks = marks(piece);
        std::fs::write(path.with_extension("marks"), marks.iter().flat_map(Mark::bytes).collect::<Vec<u8>>())?;
        let (low, high) = extremes(marks.iter().map(|mark| mark.at_m));
        let (begin_s, end_s) =
            piece.rows.first().zip(piece.rows.last()).map_or((0.0, 0.0), |(first, last)| (first.time_s, last.time_s));
        let lines = piece.rows.first().zip(piece.rows.last()).map_or((0, 0), |(first, last)| (first.line, last.line));
        Ok(Self {
            name,
            source: source.display().to_string(),
            unit: piece.unit.clone(),
            driver: String::new(),
            reason: piece.reason.clone(),
            begin_s,
            departure_s: piece.is_dated.then_some(begin_s),
            duration_s: end_s - begin_s,
            from_fixes: piece.from_fixes,
            is_head: piece.is_head,
            turn_m: piece.turn_m,
            rows: piece.rows.len(),
            lines,
            stops: piece.stops(),
            first_m: marks.first().map_or(0.0, |mark| mark.at_m),
            ends_m: if low <= high { (low, high) } else { (0.0, 0.0) },
            fixes: marks.iter().filter(|mark| mark.fix.is_some()).count(),
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
        Ok(())
    }

    /// Removes the files that wait.
    ///
    /// # Errors
    /// A file cannot be removed.
    pub fn forget(&self) -> io::Result<()> {
        std::fs::remove_file(&self.path)?;
        std::fs::remove_file(self.path.with_extension("marks"))
    }

    pub fn length_m(&self) -> f64 {
        self.ends_m.1 - self.ends_m.0
    }

    /// The places that the run passed. Thousands of runs are placed in constant memory, so they wait in a file too;
    /// where that is gone the rows beside it are gone as well, and their reading says so.
    pub fn marks(&self) -> Vec<Mark> {
        let bytes = std::fs::read(self.path.with_extension("marks")).unwrap_or_default();
        bytes.chunks_exact(8 * MARK_NUMBERS).map(Mark::of_bytes).collect()
    }
}

/// Numbers of a mark in its file; what is missing is not a number.
const MARK_NUMBERS: usize = 5;

impl Mark {
    fn bytes(&self) -> [u8; 8 * MARK_NUMBERS] {
        let fix = self.fix.unwrap_or((f64::NAN, f64::NAN));
        let numbers = [self.at_m, self.speed_mps, fix.0, fix.1, self.altitude_m.unwrap_or(f64::NAN)];
        let mut bytes = [0; 8 * MARK_NUMBERS];
        for (eight, number) in bytes.chunks_exact_mut(8).zip(numbers) {
            eight.copy_from_slice(&number.to_le_bytes());
        }
        bytes
    }

    fn of_bytes(bytes: &[u8]) -> Self {
        let number = |index: usize| {
            let eight = bytes.get(8 * index..8 * index + 8).and_then(|eight| eight.try_into().ok());
            eight.map_or(f64::NAN, f64::from_le_bytes)
        };
        let fix = Some((number(2), number(3))).filter(|fix| fix.0.is_finite());
        let altitude_m = Some(number(4)).filter(|altitude| altitude.is_finite());
        Self { at_m: number(0), speed_mps: number(1), fix, altitude_m }
    }
}

fn marks(piece: &Stretch) -> Vec<Mark> {
    let mut marks: Vec<Mark> = Vec::new();
    for ((row, speed_mps), altitude_m) in piece.rows.iter().zip(speeds::at_rows(&piece.rows)).zip(&piece.altitudes_m) {
        let (Some(at_m), Some(speed_mps)) = (row.location_m, speed_mps) else { continue };
        let last = marks.last();
        if last.is_none_or(|last| (at_m - last.at_m).abs() >= MARKS_M) {
            marks.push(Mark { at_m, speed_mps, fix: fix(row), altitude_m: *altitude_m });
        }
    }
    marks
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without a mark a run had no place, and began at 0 as all the others did.
    #[test]
    fn locations_that_have_rows_of_their_own_are_marked_with_the_speed_between_the_readings() {
        let row = |second: u32| {
            let (time_s, mps) = (f64::from(second), 10.0 + 0.1 * f64::from(second));
            let own = |of: u32, value: f64| (second % 3 == of).then_some(value);
            Sample { time_s, location_m: own(1, 500.0 + 15.0 * time_s), speed_mps: own(0, mps), ..Sample::default() }
        };
        let rows: Vec<Sample> = (0..60).map(row).collect();
        let found = marks(&Stretch { altitudes_m: vec![None; rows.len()], rows, ..Stretch::default() });
        assert_eq!(found.len(), 20, "each location");
        assert_eq!(found[0].at_m, 515.0);
        assert!((found[3].speed_mps - 11.0).abs() < 1e-9, "{}", found[3].speed_mps);
    }
}
