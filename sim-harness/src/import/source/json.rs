//! JSON lines: an object a line; objects in objects are named `a.b`.

use super::csv;
use super::row::{self, Each, Event, Field, Header};
use rundown_files::refusal::ReadError;
use serde_json::{Map, Value};
use std::path::Path;

/// Lines that decide the names of the columns.
const SNIFFED: u64 = 500;

fn flat(prefix: &str, object: &Map<String, Value>, into: &mut Named) {
    for (key, value) in object {
        let name = if prefix.is_empty() { key.clone() } else { format!("{prefix}.{key}") };
        let field = match value {
            Value::Object(inner) => {
                flat(&name, inner, into);
                continue;
            }
            Value::Number(number) => number.as_f64().map_or(Field::Empty, Field::Number),
            Value::String(text) if !text.trim().is_empty() => Field::Text(text.clone()),
            _ => Field::Empty,
        };
        into.push((name, field));
    }
}

/// The fields of an object with their names.
type Named = Vec<(String, Field)>;

/// Lines as objects; what is none is bad.
fn objects(path: &Path, each: &mut dyn FnMut(u64, Result<Named, String>) -> bool) -> Result<(), ReadError> {
    csv::lines(path, &mut |number, line| {
        let line = line.trim().trim_start_matches('[').trim_end_matches([',', ']']).trim();
        if line.is_empty() {
            return true;
        }
        let parsed = serde_json::from_str::<Map<String, Value>>(line)
            .map_err(|error| format!("expected an object, found: {error}"));
        each(
            number,
            parsed.map(|object| {
                let mut fields = Vec::new();
                flat("", &object, &mut fields);
                fields
            }),
        )
    })
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
        return Err(row::refused(path, format!("expected an object a line, found none in the first {SNIFFED} lines")));
    }
    Ok(names
        .iter()
        .map(|name| {
            // `gps.lat` is a latitude.
            let mut header = Header::new(name.rsplit('.').next().unwrap_or(name));
            header.written.clone_from(name);
            header
        })
        .collect())
}

pub fn rows(path: &Path, headers: &[Header], each: &mut Each) -> Result<(), ReadError> {
    let mut row = Vec::new();
    objects(path, &mut |number, object| match object {
        Ok(mut fields) => {
            row.clear();
            row.extend(headers.iter().map(|header| {
                let field = fields.iter_mut().find(|(name, _)| *name == header.written);
                field.map_or(Field::Empty, |(_, field)| std::mem::replace(field, Field::Empty))
            }));
            each(Event::Row(number, &row))
        }
        Err(error) => each(Event::Bad(number, error)),
    })
}
