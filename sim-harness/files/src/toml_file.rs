//! TOML files whose every error names file, line and column, also those found only after reading.
//!
//! In: a path or a text. Out: [`TomlFile`], the values with the text they came from. A check that later refuses a value
//! names it by its path (`davis.r0`, `gradient[3].from_m`), and [`TomlFile::refuse`] finds where that stands.

use crate::refusal::{Place, ReadError};
use serde::de::DeserializeOwned;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Values read from a TOML file, with the text they came from.
#[derive(Clone, Debug)]
pub struct TomlFile<T> {
    /// What was read.
    pub values: T,
    path: PathBuf,
    text: String,
}

/// One step of the path to a value: a name, or the index in an array of tables.
#[derive(Clone, Copy, Debug)]
#[expect(missing_docs, reason = "named by what it leads through")]
pub enum Step<'a> {
    Name(&'a str),
    Index(usize),
}

impl<T: DeserializeOwned> TomlFile<T> {
    /// Reads a file.
    ///
    /// # Errors
    /// [`ReadError`] when it cannot be read, is no TOML, or holds a field that is unknown, missing or of another type.
    pub fn read(path: &Path) -> Result<Self, ReadError> {
        Self::parse(path, &text_of(path)?)
    }

    /// Reads a text; `path` is for the messages.
    ///
    /// # Errors
    /// As [`TomlFile::read`].
    pub fn parse(path: &Path, text: &str) -> Result<Self, ReadError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        match toml::from_str(text) {
            Ok(values) => Ok(Self { values, path: path.to_owned(), text: text.to_owned() }),
            Err(error) => {
                let place = match error.span() {
                    Some(span) => Place::of_byte(path, text, span.start),
                    None => Place::of_file(path),
                };
                // The parser's own display draws the line over several lines; a message here is one line.
                let message = error.message().replace('\n', ", ");
                Err(place.refuse("", message).into())
            }
        }
    }
}

impl<T> TomlFile<T> {
    /// A refusal of the value at `steps`, found after reading. Where the value does not stand in the text (a default),
    /// the place is that of the table around it, or the file.
    pub fn refuse(&self, steps: &[Step<'_>], message: impl Into<String>) -> ReadError {
        let place = match self.byte_of(steps) {
            Some(byte) => Place::of_byte(&self.path, &self.text, byte),
            None => Place::of_file(&self.path),
        };
        let mut field = String::new();
        for step in steps {
            match step {
                Step::Name(name) if field.is_empty() => field += name,
                Step::Name(name) => field += &format!(".{name}"),
                Step::Index(index) => field += &format!("[{index}]"),
            }
        }
        place.refuse(field, message).into()
    }

    /// As [`TomlFile::refuse`], the path written as in `davis.r0`.
    pub fn refuse_dotted(&self, dotted: &str, message: impl Into<String>) -> ReadError {
        let steps: Vec<Step<'_>> = dotted.split('.').map(Step::Name).collect();
        self.refuse(&steps, message)
    }

    /// As [`TomlFile::refuse`], for an error that reads `field: expected X, found Y`, its field below `steps` and
    /// written as in `davis.r0`.
    pub fn refuse_error(&self, steps: &[Step<'_>], error: &dyn Display) -> ReadError {
        let text = error.to_string();
        let (field, message) = text.split_once(": ").unwrap_or(("", &text));
        let names = field.split('.').filter(|name| !name.is_empty()).map(Step::Name);
        let steps: Vec<Step<'_>> = steps.iter().copied().chain(names).collect();
        self.refuse(&steps, message)
    }

    /// Whether the text has a value, its path written as in `davis.r0`.
    pub fn has(&self, dotted: &str) -> bool {
        let Ok(table) = DeTable::parse(&self.text) else {
            return false;
        };
        let mut names = dotted.split('.');
        let mut value = names.next().and_then(|name| table.get_ref().get(name));
        for name in names {
            value = value.and_then(|value| child(value, &Step::Name(name)));
        }
        value.is_some()
    }

    fn byte_of(&self, steps: &[Step<'_>]) -> Option<usize> {
        let table = DeTable::parse(&self.text).ok()?;
        let (first, rest) = steps.split_first()?;
        let Step::Name(name) = first else { return None };
        let mut value = table.get_ref().get(*name)?;
        for step in rest {
            match child(value, step) {
                Some(inner) => value = inner,
                None => break,
            }
        }
        Some(value.span().start)
    }
}

/// The text of a file.
pub(crate) fn text_of(path: &Path) -> Result<String, ReadError> {
    let text = std::fs::read_to_string(path).map_err(|source| ReadError::io(path, source))?;
    log::info!("read {}", path.display());
    Ok(text)
}

fn child<'a, 'i>(value: &'a Spanned<DeValue<'i>>, step: &Step<'_>) -> Option<&'a Spanned<DeValue<'i>>> {
    match (value.get_ref(), step) {
        (DeValue::Table(table), Step::Name(name)) => table.get(*name),
        (DeValue::Array(array), Step::Index(index)) => array.get(*index),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Values {
        #[allow(dead_code)]
        mass_kg: f64,
        #[serde(default)]
        entry: Vec<Entry>,
    }

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Entry {
        #[allow(dead_code)]
        at_m: f64,
    }

    fn parse(text: &str) -> Result<TomlFile<Values>, ReadError> {
        TomlFile::parse("x.toml".as_ref(), text)
    }

    fn message(text: &str) -> String {
        parse(text).unwrap_err().to_string()
    }

    #[test]
    fn unknown_missing_and_wrong_fields_are_named_with_their_place() {
        assert_eq!(
            message("mass_kg = 1.0\nmas = 2\n"),
            "x.toml:2:1: unknown field `mas`, expected `mass_kg` or `entry`"
        );
        assert_eq!(message("# nothing\n"), "x.toml:1:1: missing field `mass_kg`");
        assert_eq!(message("mass_kg = \"heavy\"\n"), "x.toml:1:11: invalid type: string \"heavy\", expected f64");
        assert!(message("mass_kg = = 1").starts_with("x.toml:1:11: "));
    }

    #[test]
    fn whole_numbers_and_a_byte_order_mark_are_accepted() {
        assert!(parse("\u{feff}mass_kg = 1\n").is_ok());
    }

    #[test]
    fn a_value_refused_later_is_found_again() {
        let file = parse("mass_kg = 1\n\n[[entry]]\nat_m = 5\n[[entry]]\nat_m =  4\n").unwrap();
        assert_eq!(file.values.entry.len(), 2);
        let steps = [Step::Name("entry"), Step::Index(1), Step::Name("at_m")];
        assert_eq!(file.refuse(&steps, "not sorted").to_string(), "x.toml:6:9: entry[1].at_m: not sorted");
        assert_eq!(file.refuse_dotted("mass_kg", "light").to_string(), "x.toml:1:11: mass_kg: light");
        assert_eq!(file.refuse_dotted("davis.r0", "small").to_string(), "x.toml: davis.r0: small");
        assert!(file.has("mass_kg") && !file.has("davis.r0") && !file.has("mass_kg.r0"));
    }

    #[test]
    fn a_file_that_is_not_there_is_named() {
        let error = TomlFile::<Values>::read("no/such.toml".as_ref()).unwrap_err();
        assert!(error.to_string().starts_with("no/such.toml: cannot be read: "), "{error}");
    }
}
