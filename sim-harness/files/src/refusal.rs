//! What a file is refused for, and where. Every refusal reads `file:line:column: field: expected X, found Y`, as
//! compilers do; what is not known is left out. In a log the column is the number of the field, elsewhere that of the
//! character; both count from 1.

use std::fmt;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// A place in a text file.
#[derive(Clone, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "counted from 1, where they are known")]
pub struct Place {
    pub file: PathBuf,
    pub line: Option<usize>,
    pub column: Option<usize>,
}

/// What is wrong, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// Where.
    pub place: Place,
    /// Path of the value (`davis.r0`, `tunnel[1].to_m`) or name of the column; empty when the row or the file is meant.
    pub field: String,
    /// What was expected and what was found.
    pub message: String,
}

/// Why a file gave nothing.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "said by the messages")]
pub enum ReadError {
    #[error("{}: cannot be read: {source}", path.display())]
    Io { path: PathBuf, source: std::io::Error },
    #[error(transparent)]
    Refused(#[from] Refusal),
    /// Rows of a log cannot be read.
    #[error("{}", listed(path, rows))]
    BadRows { path: PathBuf, rows: Vec<Refusal> },
}

/// What helps with a log that has other columns than a run log, or the same ones in another form.
pub const IMPORT_TIP: &str = "`rundown import` reads other names, units and times";

/// Bad rows and warnings that are spelled out; the rest is counted.
pub const MAX_LISTED: usize = 20;

/// One line for each row, at most [`MAX_LISTED`], and a last one that says what can be done.
fn listed(path: &Path, rows: &[Refusal]) -> String {
    let mut text = String::new();
    for row in rows.iter().take(MAX_LISTED) {
        text += &format!("{row}\n");
    }
    let more = match rows.len().saturating_sub(MAX_LISTED) {
        0 => String::new(),
        more => format!("{more} more like these; "),
    };
    let count = rows.len();
    let word = if count == 1 { "row" } else { "rows" };
    let advice = "correct the log, or leave such rows out with --skip-bad-rows";
    text + &format!("{}: {more}{count} unreadable {word}, the run was not used: {advice}", path.display())
}

impl ReadError {
    pub(crate) fn io(path: &Path, source: std::io::Error) -> Self {
        Self::Io { path: path.to_owned(), source }
    }

    pub(crate) fn of_file(path: &Path, message: impl Into<String>) -> Self {
        Self::Refused(Place::of_file(path).refuse("", message))
    }
}

impl Place {
    /// The place of a byte of `text`; columns are counted in characters.
    pub fn of_byte(file: impl Into<PathBuf>, text: &str, byte: usize) -> Self {
        let before = text.get(..byte).unwrap_or(text);
        let line = before.matches('\n').count() + 1;
        let begin_of_line = before.rfind('\n').map_or(0, |at| at + 1);
        let column = before[begin_of_line..].chars().count() + 1;
        Self { file: file.into(), line: Some(line), column: Some(column) }
    }

    /// A line.
    pub fn of_line(file: impl Into<PathBuf>, line: u64) -> Self {
        Self { file: file.into(), line: Some(line as usize), column: None }
    }

    /// The file as a whole.
    pub fn of_file(file: impl Into<PathBuf>) -> Self {
        Self { file: file.into(), line: None, column: None }
    }

    /// A refusal of what stands here.
    pub fn refuse(self, field: impl Into<String>, message: impl Into<String>) -> Refusal {
        Refusal { place: self, field: field.into(), message: message.into() }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        [self.line, self.column].into_iter().flatten().try_for_each(|number| write!(f, ":{number}"))
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.place)?;
        if !self.field.is_empty() {
            write!(f, "{}: ", self.field)?;
        }
        f.write_str(&self.message)
    }
}

impl std::error::Error for Refusal {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_columns_begin_at_one() {
        let text = "ab\ncö x\n";
        let at = |byte| Place::of_byte("f", text, byte).to_string();
        assert_eq!(at(0), "f:1:1");
        assert_eq!(at(3), "f:2:1");
        assert_eq!(at(text.find('x').unwrap()), "f:2:4");
        assert_eq!(at(99), "f:3:1");
        assert_eq!(Place::of_file("f").to_string(), "f");
        assert_eq!(
            Place::of_line("f", 7).refuse("a.b", "expected X, found Y").to_string(),
            "f:7: a.b: expected X, found Y"
        );
    }
}
