//! Where in a file something stands, so that every message can name file, line and column.

use std::fmt;
use std::path::PathBuf;

/// A place in a text file. Prints as `file:line:column`, as compilers do; what is not known is left out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub file: PathBuf,
    /// Line and column, both counted from 1.
    pub at: Option<(usize, usize)>,
}

impl Place {
    /// The place of a byte of `text`; columns are counted in characters.
    pub fn of_byte(file: impl Into<PathBuf>, text: &str, byte: usize) -> Self {
        let before = text.get(..byte).unwrap_or(text);
        let line = before.matches('\n').count() + 1;
        let begin_of_line = before.rfind('\n').map_or(0, |at| at + 1);
        let column = before[begin_of_line..].chars().count() + 1;
        Self { file: file.into(), at: Some((line, column)) }
    }

    /// The file as a whole.
    pub fn of_file(file: impl Into<PathBuf>) -> Self {
        Self { file: file.into(), at: None }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        match self.at {
            Some((line, column)) => write!(f, ":{line}:{column}"),
            None => Ok(()),
        }
    }
}

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
    }
}
