//! JSON: an object a line, or objects over several lines, as in an array; objects in objects are named `a.b`.
//!
//! The first line that is not empty decides which: where it holds an object, every line does, so that one that is torn
//! off costs no other.

use super::csv;
use super::row::{self, Each, Event, Header, RowField};
use super::tags;
use rundown_files::refusal::ReadError;
use serde_json::{Map, Value};
use std::path::Path;

/// Lines that decide the names of the columns.
const SNIFFED: u64 = 500;

fn flat(prefix: &str, object: &Map<String, Value>, into: &mut NamedFields) {
    for (key, value) in object {
        let name = if prefix.is_empty() { key.clone() } else { format!("{prefix}.{key}") };
        let field = match value {
            Value::Object(inner) => {
                flat(&name, inner, into);
                continue;
            }
            Value::Number(number) => number.as_f64().map_or(RowField::Empty, RowField::Number),
            Value::String(text) if !text.trim().is_empty() => RowField::Text(text.clone()),
            _ => RowField::Empty,
        };
        into.push((name, field));
    }
}

/// The fields of an object with their names.
type NamedFields = Vec<(String, RowField)>;

/// What is to be done with an object, or with what is none, and the line that it begins in; false: no more of them.
type Take<'a> = dyn FnMut(u64, Result<NamedFields, String>) -> bool + 'a;

fn object(text: &str) -> Result<NamedFields, String> {
    let object = serde_json::from_str::<Map<String, Value>>(text);
    let object = object.map_err(|error| format!("expected an object, found: {error}"))?;
    let mut fields = Vec::new();
    flat("", &object, &mut fields);
    Ok(fields)
}

/// Objects of a file; what is none is bad.
fn objects(path: &Path, each: &mut Take) -> Result<(), ReadError> {
    let (mut layout, mut first, mut goes_on) = (None, 0, true);
    csv::lines(path, &mut |number, line| {
        let alone = line.trim().trim_start_matches('[').trim_end_matches([',', ']']).trim();
        if layout.is_none() && !line.trim().is_empty() {
            let is_spread = line.trim_start().starts_with(['[', '{']) && object(alone).is_err();
            (layout, first) = (Some(is_spread.then(Spread::default)), number);
        }
        if let Some(Some(begun)) = &layout
            && begun.depth > 0
            && number == first + 1
            && object(alone).is_ok()
        {
            goes_on = each(first, Err(NO_END.to_owned()));
            layout = Some(None);
        }
        goes_on = goes_on
            && match &mut layout {
                Some(Some(spread)) => spread.take(number, line, each),
                _ => alone.is_empty() || each(number, object(alone)),
            };
        goes_on
    })?;
    if let Some(Some(spread)) = layout
        && goes_on
        && spread.depth > 0
    {
        each(spread.line, Err(NO_END.to_owned()));
    }
    Ok(())
}

const NO_END: &str = "expected an object, found one without an end";
/// A longer object is no row of a log.
const LONGEST_OBJECT: usize = 1 << 20;

/// Objects over several lines: as much of the next one as is there.
#[derive(Default)]
struct Spread {
    text: String,
    /// The line that it begins in.
    line: u64,
    /// Braces and brackets that are open.
    depth: usize,
    is_text: bool,
    is_escaped: bool,
}

impl Spread {
    /// Hands over the objects that end in this line.
    fn take(&mut self, number: u64, line: &str, each: &mut Take) -> bool {
        for c in line.chars() {
            if self.depth == 0 {
                match c {
                    '{' => self.line = number,
                    // Of the array.
                    '[' | ']' | ',' | ' ' | '\t' => continue,
                    _ => return each(number, Err(format!("expected an object, found {:?}", line.trim()))),
                }
            }
            self.text.push(c);
            self.count(c);
            let is_too_long = self.text.len() > LONGEST_OBJECT;
            if self.depth == 0 || is_too_long {
                let Self { text, line, .. } = std::mem::take(self);
                let too_long = Err("expected an object of at most 1 MB, found a longer one".to_owned());
                if !each(line, if is_too_long { too_long } else { object(&text) }) {
                    return false;
                }
            }
        }
        true
    }

    fn count(&mut self, c: char) {
        match c {
            _ if self.is_escaped => self.is_escaped = false,
            '\\' if self.is_text => self.is_escaped = true,
            '"' => self.is_text = !self.is_text,
            '{' | '[' if !self.is_text => self.depth += 1,
            '}' | ']' if !self.is_text => self.depth = self.depth.saturating_sub(1),
            _ => (),
        }
    }
}

pub fn headers(path: &Path) -> Result<Vec<Header>, ReadError> {
    let mut names: Vec<String> = Vec::new();
    objects(path, &mut |number, object| {
        for (name, _) in object.unwrap_or_default() {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        number < SNIFFED
    })?;
    if names.is_empty() {
        return Err(row::refused(path, format!("expected objects, found none in the first {SNIFFED} lines")));
    }
    // `gps.lat` is a latitude.
    let mut headers: Vec<Header> = names.iter().map(|name| Header::new(name)).collect();
    tags::name(&mut headers);
    Ok(headers)
}

pub fn rows(path: &Path, headers: &[Header], each: &mut Each) -> Result<(), ReadError> {
    let mut row = Vec::new();
    objects(path, &mut |number, object| match object {
        Ok(mut fields) => {
            row.clear();
            row.extend(headers.iter().map(|header| {
                let field = fields.iter_mut().find(|(name, _)| *name == header.written);
                field.map_or(RowField::Empty, |(_, field)| std::mem::replace(field, RowField::Empty))
            }));
            each(Event::Row(number, &row))
        }
        Err(error) => each(Event::Bad(number, error)),
    })
}
