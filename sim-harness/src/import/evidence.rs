//! Clock and units by what the readings say: the units whose distance by speed agrees with the distance by location.

mod decided;
mod exchanged;
mod kind;
mod ratios;
mod run_column;
mod signed;
mod stretches;
mod written;

pub use written::{text, written};

use super::clock::{self, ClockKind, DateOrder, Orders, WrittenTime};
use super::columns::{Columns, How};
use super::mapping::{SAY_IT, SourceMapping, line};
use super::meaning::Meaning;
use super::number;
use super::source::SourceFile;
use super::source::row::{Event, RowField};
use super::units::{self, Unit};
use super::zone;
use decided::deny;
use exchanged::mostly;
use kind::{kind_of, read_as};
use rundown_files::refusal::ReadError;
use std::collections::BTreeMap;
use stretches::{LEAST_ALIKE, stretches};
use written::{WrittenRow, is_plain, unit_behind, value};

/// Rows of a file that are looked at.
const ROWS: usize = 20_000;
/// Rows as they are written.
#[derive(Debug, Default)]
pub struct SeenRows {
    rows: Vec<WrittenRow>,
    /// Where the rows of each file begin.
    begins: Vec<usize>,
    /// The first line that is no row.
    bad: Option<String>,
    /// Of [`FORCES`].
    forces: [Vec<f64>; 2],
    /// Units that stand behind the values.
    behind: BTreeMap<Meaning, Unit>,
}

impl SeenRows {
    /// Looks at the first rows of a file.
    ///
    /// # Errors
    /// As [`SourceFile::rows`].
    pub fn look(&mut self, source: &SourceFile, columns: &Columns) -> Result<(), ReadError> {
        let mut left = ROWS;
        let index = |meaning| columns.index(meaning);
        let numbers = EXPECTED.map(index);
        let date = index(Meaning::Date);
        let splits = [Meaning::Unit, Meaning::Run].map(index);
        let forces = FORCES.map(index);
        // A new file is a new stretch.
        self.begins.push(self.rows.len());
        self.rows.push(WrittenRow::default());
        source.rows(&mut |event| {
            if let Event::Bad(line, message) = &event {
                self.bad.get_or_insert_with(|| format!("line {line}: {message}"));
            }
            if let Event::Row(_, fields) = event {
                let at = |index: Option<usize>| index.and_then(|index| fields.get(index));
                let value = |index| value(at(index), columns.decimal);
                // Another unit than that of the column may stand behind a value.
                let behind: [Option<Unit>; 5] =
                    std::array::from_fn(|i| unit_behind(EXPECTED[i], at(numbers[i]), columns.decimal));
                let in_unit = |i: usize| {
                    let factor = behind[i].zip(columns.unit(EXPECTED[i])).map_or(1.0, |(a, b)| a.factor() / b.factor());
                    value(numbers[i]).map(|value| factor * value)
                };
                let (time, date) = (at(numbers[0]).and_then(text), at(date).and_then(text));
                let mut read = std::array::from_fn(in_unit);
                // `31 January` is no number.
                read[0] = read[0].filter(|_| at(numbers[0]).is_some_and(|field| is_plain(field, columns.decimal)));
                for position in 3..5 {
                    let Some(RowField::Text(text)) = at(numbers[position]) else { continue };
                    let angle = number::angle(text, columns.decimal).map(|(angle, _)| angle);
                    read[position] = angle.or(read[position]);
                }
                let mut row =
                    WrittenRow { numbers: read, time, date, of: splits.map(|index| at(index).and_then(text)) };
                if columns.is_signed {
                    row.leave_out_sign();
                }
                self.rows.push(row);
                for (meaning, unit) in EXPECTED.into_iter().zip(behind) {
                    if let Some(unit) = unit {
                        self.behind.entry(meaning).or_insert(unit);
                    }
                }
                self.forces.iter_mut().zip(forces).for_each(|(seen, force)| seen.extend(value(force)));
                left -= 1;
            }
            left > 0
        })
    }

    /// Whether there is anything to look at.
    ///
    /// # Errors
    /// There are no rows, or no times in them.
    pub fn are_there(&self) -> Result<(), String> {
        let bad = self.bad.as_ref().map_or(String::new(), |bad| format!("; {bad}"));
        let is_row =
            |row: &&WrittenRow| row.time.is_some() || row.date.is_some() || row.numbers.iter().any(Option::is_some);
        if !self.rows.iter().any(|row| is_row(&row)) {
            return Err(format!("expected rows with readings, found none{bad}"));
        }
        let has_time = self.rows.iter().any(|row| row.time.is_some());
        if has_time { Ok(()) } else { Err(format!("time: expected times, found none in any row{bad}")) }
    }

    /// Kind of the clock and order of its dates, where the mapping does not say. Out: what a person should know of it.
    ///
    /// # Errors
    /// A question that only a person can answer.
    pub fn clock(&self, columns: &mut Columns, mapping: &SourceMapping) -> Result<Option<String>, String> {
        let mapped = |meaning| mapping.columns.get(&meaning);
        let times: Vec<f64> = self.rows.iter().filter_map(|row| row.numbers[0]).collect();
        let texts: Vec<&String> = self.rows.iter().filter_map(|row| row.time.as_ref()).collect();
        let kind = mapped(Meaning::Time).and_then(|column| column.kind);
        let (has_unit, beside_dates) = (columns.unit(Meaning::Time).is_some(), columns.has(Meaning::Date));
        columns.kind = kind.unwrap_or_else(|| kind_of(&times, &texts, has_unit, beside_dates));
        let has_date = columns.has(Meaning::Date) && columns.kind.is_of_day();
        let dates = || self.rows.iter().filter_map(|row| row.date.as_ref()).collect();
        let dated: Vec<&String> = match columns.kind.is_of_day() {
            true if has_date => dates(),
            true => Vec::new(),
            false => texts.clone(),
        };
        if !columns.kind.is_of_day() {
            columns.of.remove(&Meaning::Date);
        }
        let order = [Meaning::Date, Meaning::Time].into_iter().find_map(|meaning| mapped(meaning)?.order);
        let mut orders = Orders::default();
        dated.iter().for_each(|text| orders.see(text));
        columns.order = match order.or_else(|| orders.decided()) {
            Some(order) => order,
            None if columns.kind.has_unit() || columns.kind == ClockKind::Excel => DateOrder::Ymd,
            None => {
                let example = dated.first().copied().cloned().unwrap_or_default();
                let meaning = if columns.has(Meaning::Date) { Meaning::Date } else { Meaning::Time };
                let [numbers, order, others] = orders.doubt();
                let asked = (meaning, columns.header(meaning), format!("order = {order:?}"));
                return Err(format!(
                    "{}: expected dates in one order, found {example:?}, which may be {numbers} first; {SAY_IT} (or {others}): {}",
                    meaning.key(),
                    line([asked])
                ));
            }
        };
        if let Some(question) = zone::behind(&texts, columns.order).filter(|_| columns.kind == ClockKind::DateTime) {
            return Err(question);
        }
        let has_zone = |text: &&String| matches!(clock::parse(text, columns.order), Some(WrittenTime::Instant(_)));
        columns.has_zone = texts.first().is_some_and(has_zone);
        if columns.kind == ClockKind::Unix
            && let Some(time) = columns.of.get_mut(&Meaning::Time)
            && time.how != How::Mapping
        {
            let largest = times.iter().copied().fold(0.0, f64::max);
            let name = match largest {
                ..1e11 => "s",
                ..1e14 => "ms",
                ..1e17 => "us",
                _ => "ns",
            };
            time.unit = units::by_name(Meaning::Time, name);
            time.how = How::Evidence(format!("Unix time up to {largest:e}"));
        }
        // A repeated import says it again.
        let example = times.first().filter(|_| kind.is_none() || columns.kind == ClockKind::Unix);
        Ok(example.and_then(|first| read_as(columns, *first)))
    }

    /// Positions without a unit that are no degrees may be degrees and minutes as one number, as receivers write them.
    /// Out: that they are.
    pub fn positions(&self, columns: &mut Columns) -> Option<String> {
        let of = |meaning: Meaning| columns.of.get(&meaning).filter(|column| column.unit.is_some_and(Unit::is_degrees));
        if of(Meaning::Latitude).is_none_or(|column| column.how == How::Mapping) || of(Meaning::Longitude).is_none() {
            return None;
        }
        let fixes = self.rows.iter().filter_map(|row| row.numbers[3].zip(row.numbers[4]));
        let fixes: Vec<(f64, f64)> = fixes.filter(|fix| *fix != (0.0, 0.0)).collect();
        let fits = |value: f64, most: f64| value.abs() < 100.0 * most && value.abs() % 100.0 < 60.0;
        let all_fit = fixes.iter().all(|(latitude, longitude)| fits(*latitude, 90.0) && fits(*longitude, 180.0));
        let is_beyond = |(latitude, longitude): &(f64, f64)| latitude.abs() > 90.0 || longitude.abs() > 180.0;
        let (latitude, _) = mostly(fixes.iter().copied(), is_beyond).filter(|_| all_fit)?;
        for meaning in [Meaning::Latitude, Meaning::Longitude] {
            if let Some(column) = columns.of.get_mut(&meaning) {
                column.unit = units::by_name(meaning, units::DEGREES_AND_MINUTES);
                column.how = How::Evidence(format!("{latitude} is no latitude in degrees"));
            }
        }
        let unit = columns.unit(Meaning::Latitude)?;
        Some(format!(
            "positions are taken for degrees and minutes as one number: {latitude} is {:.6}°",
            unit.to_si(latitude)
        ))
    }

    /// A column with nothing but its unit is a speed or a location where it follows the other of the two. A speed that
    /// too few rows can deny stays; a location does not: altitudes and accuracies are lengths, too.
    pub fn unit_alone(&self, columns: &mut Columns) -> Vec<String> {
        let alone = |meaning: &Meaning| columns.of.get(meaning).is_some_and(|column| column.how == How::UnitAlone);
        let Some(meaning) = [Meaning::Speed, Meaning::Location].into_iter().find(alone) else { return Vec::new() };
        let follows = stretches(&self.rows, columns).ok().map(|stretches| stretches.alike);
        let header = columns.header(meaning).to_owned();
        let (key, percent) = (meaning.key(), 100.0 * follows.unwrap_or(0.0));
        let stays = follows.map_or(meaning == Meaning::Speed, |alike| alike >= LEAST_ALIKE);
        if !stays {
            columns.of.remove(&meaning);
        }
        vec![match (stays, follows) {
            (true, Some(_)) => format!(
                "column {header:?} is taken for the {key}: no name says so, but its unit, which no other column has; speed and location agree in {percent:.0} % of the stretches"
            ),
            (true, None) => format!(
                "column {header:?} is taken for the {key} by its unit alone, which no other column has; too few rows of a moving train to try it"
            ),
            (false, Some(_)) => format!(
                "column {header:?} has the unit of a {key} without being one: speed and location agree in {percent:.0} % of the stretches, expected {:.0} %",
                100.0 * LEAST_ALIKE
            ),
            (false, None) => {
                format!("column {header:?} has the unit of a {key}, but too few rows of a moving train to try it")
            }
        }]
    }

    /// Of each file, whether its own rows deny what was decided of all: times that are not read so, or distances that
    /// do not agree. Never what a person said.
    pub fn denied(&self, columns: &Columns) -> Vec<bool> {
        let ends = self.begins.iter().skip(1).copied().chain([self.rows.len()]);
        let of_file = |(begin, end): (&usize, usize)| {
            let rows = &self.rows[*begin..end];
            let written = rows.iter().filter(|row| row.time.is_some()).count();
            let read = rows.iter().filter(|row| row.time(columns).is_some()).count();
            2 * read < written || deny(rows, columns)
        };
        self.begins.iter().zip(ends).map(of_file).collect()
    }

    /// A force without unit is one per mass if it is as small as that. One in a unit that is not known is not.
    fn forces(&self, columns: &mut Columns) {
        for (meaning, seen) in FORCES.into_iter().zip(&self.forces) {
            let largest = seen.iter().map(|force| force.abs()).fold(0.0, f64::max);
            let Some(column) = columns.of.get_mut(&meaning) else { continue };
            // A column of 0 and 1 says only whether.
            let is_measured = seen.iter().any(|force| force.fract() != 0.0);
            if column.unit.is_none() && column.unknown_unit().is_none() && largest < 3.0 && is_measured {
                column.unit = units::by_name(meaning, "N/kg");
                column.how = How::Evidence(format!("no value beyond {largest:.2}"));
            }
        }
    }
}

/// What a mass may divide.
const FORCES: [Meaning; 2] = [Meaning::Effort, Meaning::Braking];

/// What a row says of where the train is.
const EXPECTED: [Meaning; 5] =
    [Meaning::Time, Meaning::Location, Meaning::Speed, Meaning::Latitude, Meaning::Longitude];
