//! Rows as they are written, and what their fields say.

use super::super::clock::{self, ClockKind, WrittenTime};
use super::super::columns::Columns;
use super::super::meaning::Meaning;
use super::super::number;
use super::super::source::row::RowField;
use super::super::units::{self, Unit};
use super::ratios::Passing;

#[derive(Clone, Debug, Default)]
pub(super) struct WrittenRow {
    /// Time as a number, location, speed, latitude, longitude.
    pub(super) numbers: [Option<f64>; 5],
    pub(super) time: Option<String>,
    pub(super) date: Option<String>,
    /// What splits the rows: unit and run.
    pub(super) of: [Option<String>; 2],
}

impl WrittenRow {
    pub(super) fn passing(&self, columns: &Columns) -> Option<Passing> {
        let [_, location, speed, latitude, longitude] = self.numbers;
        let degrees = |meaning, value: Option<f64>| Some(columns.unit(meaning)?.to_si(value?));
        let place = if columns.has(Meaning::Location) {
            (location?, 0.0)
        } else if latitude.zip(longitude) == Some((0.0, 0.0)) {
            // The receiver had no fix.
            return None;
        } else {
            (degrees(Meaning::Latitude, latitude)?, degrees(Meaning::Longitude, longitude)?)
        };
        Some(Passing { time: self.time(columns)?, place, speed: speed? })
    }

    pub(super) fn time(&self, columns: &Columns) -> Option<f64> {
        if columns.kind.has_unit() {
            return self.numbers[0];
        }
        let written = match columns.kind {
            ClockKind::Hhmmss | ClockKind::Excel => clock::of_number(columns.kind, self.numbers[0]?),
            kind => clock::of_text(kind, self.time.as_deref()?, columns.order),
        };
        match written? {
            WrittenTime::Instant(seconds) => Some(seconds),
            WrittenTime::Civil(civil) => clock::in_zone(civil, &columns.zone, None),
            WrittenTime::OfDay(seconds) => {
                let date = self.date.as_deref();
                let date = date.and_then(|date| clock::parse_date(clock::day_of(date), columns.order));
                let midnight = date.and_then(|day| clock::in_zone(day.at(0, 0, 0, 0), &columns.zone, None));
                Some(seconds + midnight.unwrap_or(0.0))
            }
        }
    }
}

/// A field as it is written.
pub fn text(field: &RowField) -> Option<String> {
    match field {
        RowField::Empty => None,
        RowField::Text(text) => Some(text.clone()),
        RowField::Number(number) => Some(number.to_string()),
    }
}

/// A time that has no unit.
pub fn written(kind: ClockKind, field: &RowField, columns: &Columns) -> Option<WrittenTime> {
    match kind {
        ClockKind::Hhmmss | ClockKind::Excel => clock::of_number(kind, value(Some(field), columns.decimal)?),
        _ => clock::of_text(kind, &text(field)?, columns.order),
    }
}

/// A number, with nothing but a unit of time behind it.
pub(super) fn is_plain(field: &RowField, decimal: char) -> bool {
    let RowField::Text(text) = field else { return true };
    let parsed = number::parse(text, decimal);
    parsed.is_some_and(|(_, rest)| rest.is_empty() || units::by_name(Meaning::Time, rest).is_some())
}

/// `km/h` of `80 km/h`.
pub(super) fn unit_behind(meaning: Meaning, field: Option<&RowField>, decimal: char) -> Option<Unit> {
    let RowField::Text(text) = field? else { return None };
    let (_, rest) = number::parse(text, decimal)?;
    if rest.is_empty() { None } else { units::by_name(meaning, rest) }
}

pub(super) fn value(field: Option<&RowField>, decimal: char) -> Option<f64> {
    match field? {
        RowField::Empty => None,
        RowField::Number(number) => Some(*number),
        RowField::Text(text) => number::parse(text, decimal)
            .filter(|(_, rest)| !rest.starts_with([':', '/', 'T']))
            .map(|(number, _)| number),
    }
}
