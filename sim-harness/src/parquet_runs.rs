//! Runs of Parquet files, one after the other. A unit's files must follow each other in time; a run does not go on in
//! the next file.

use rundown_files::map_matching::CentreLine;
use rundown_files::parquet::{ParquetError, RunReader};
use rundown_files::recording::Recording;
use rundown_files::refusal::{Place, ReadError};
use std::collections::VecDeque;
use std::path::{Path, PathBuf};

/// The files that are not yet read to their end.
#[derive(Debug)]
pub struct ParquetRuns {
    readers: VecDeque<RunReader>,
    files: Vec<PathBuf>,
    runs: usize,
}

impl ParquetRuns {
    /// Parquet files and folders of them, also deeper, in the order of their paths; none where no argument leads to
    /// one.
    ///
    /// # Errors
    /// A file or folder cannot be read, or some arguments lead to Parquet files and others do not.
    pub fn open(arguments: &[PathBuf], line: Option<&CentreLine>) -> Result<Option<Self>, ParquetError> {
        let mut files = Vec::new();
        let mut without = None;
        for argument in arguments {
            let before = files.len();
            find(argument, &mut files)?;
            without = without.or((files.len() == before).then_some(argument));
        }
        if files.is_empty() {
            return Ok(None);
        }
        if let Some(argument) = without {
            let message = "expected Parquet files, as the others are, found none";
            return Err(Place::of_file(argument).refuse("", message).into());
        }
        let readers = files.iter().map(|path| RunReader::open(path, line));
        let readers = readers.collect::<Result<VecDeque<_>, _>>()?;
        let runs = readers.iter().map(RunReader::runs).sum();
        Ok(Some(Self { readers, files, runs }))
    }

    /// How many runs there are.
    pub fn runs(&self) -> usize {
        self.runs
    }

    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// The next runs, at most so many; none after the last.
    ///
    /// # Errors
    /// A file is broken.
    pub fn next_chunk(&mut self, most: usize) -> Result<Vec<Recording>, ParquetError> {
        let mut chunk = Vec::new();
        while chunk.len() < most
            && let Some(reader) = self.readers.front_mut()
        {
            match reader.next_run()? {
                Some(recording) => chunk.push(recording),
                None => drop(self.readers.pop_front()),
            }
        }
        Ok(chunk)
    }
}

/// Parquet files behind an argument, folders in the order of their paths.
fn find(path: &Path, files: &mut Vec<PathBuf>) -> Result<(), ParquetError> {
    if path.is_dir() {
        let failed = |source| ReadError::Io { path: path.to_owned(), source };
        let entries = std::fs::read_dir(path).map_err(failed)?;
        let entries = entries.map(|entry| entry.map(|entry| entry.path()));
        let mut paths = entries.collect::<Result<Vec<_>, _>>().map_err(failed)?;
        paths.sort();
        for path in paths {
            find(&path, files)?;
        }
    } else if path.extension().is_some_and(|end| end == "parquet") {
        files.push(path.to_owned());
    }
    Ok(())
}
