//! Clock and units by what the readings say: the units whose distance by speed agrees with the distance by location.

mod exchanged;
mod ratios;
mod signed;

use self::ratios::{Passing, longest, ratios, usual};
use super::clock::{self, ClockKind, DateOrder, Orders, WrittenTime};
use super::columns::{Columns, How};
use super::mapping::{SAY_IT, SourceMapping, line};
use super::meaning::Meaning;
use super::number;
use super::source::SourceFile;
use super::source::row::{Event, RowField};
use super::units::{self, Unit};
use rundown_files::refusal::ReadError;
use rundown_files::statistics::median;
use rundown_pages::numbers::counted;
use std::collections::BTreeMap;

/// Rows of a file that are looked at.
const ROWS: usize = 20_000;
/// Steps that make a stretch over which distances are compared, and stretches that decide.
const STEPS: usize = 20;
/// The same where rows are far apart and stops near.
const FEW_STEPS: usize = 5;
const LEAST_STRETCHES: usize = 4;
/// Speed and location are of one train where so many stretches have the usual ratio within that.
const LEAST_ALIKE: f64 = 0.8;
const ALIKE: f64 = 0.2;
/// A wheel may be off by so much; the units that are closest lie 10 % apart.
const NEAR: f64 = 0.06;
/// Named units are believed where the distances agree so.
const MAY_BE: std::ops::Range<f64> = 0.8..1.25;
/// What trains do, m/s, and how often recorders write, s.
const FASTEST_MPS: std::ops::Range<f64> = 2.0..140.0;
const STEP_S: std::ops::Range<f64> = 0.009..600.0;

/// Rows as they are written.
#[derive(Debug, Default)]
pub struct SeenRows {
    rows: Vec<WrittenRow>,
    /// Where the rows of each file begin.
    begins: Vec<usize>,
    /// The first line that is no row.
    bad: Option<String>,
    efforts: Vec<f64>,
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
        let (date, effort) = (index(Meaning::Date), index(Meaning::Effort));
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
                let (time, date) = (at(numbers[0]).and_then(text), at(date).and_then(text));
                let mut read = numbers.map(value);
                // `31 January` is no number.
                read[0] = read[0].filter(|_| at(numbers[0]).is_some_and(|field| is_plain(field, columns.decimal)));
                for position in 3..5 {
                    let Some(RowField::Text(text)) = at(numbers[position]) else { continue };
                    let angle = number::angle(text, columns.decimal).map(|(angle, _)| angle);
                    read[position] = angle.or(read[position]);
                }
                let mut row = WrittenRow { numbers: read, time, date };
                if columns.is_signed {
                    row.leave_out_sign();
                }
                self.rows.push(row);
                for (meaning, index) in EXPECTED.into_iter().zip(numbers) {
                    if let Some(unit) = unit_behind(meaning, at(index), columns.decimal) {
                        self.behind.entry(meaning).or_insert(unit);
                    }
                }
                self.efforts.extend(value(effort));
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
                let asked = (meaning, columns.header(meaning), "order = \"dmy\"".to_owned());
                return Err(format!(
                    "{}: expected dates in one order, found {example:?}, which may be day or month first; {SAY_IT} (or \"mdy\"): {}",
                    meaning.key(),
                    line([asked])
                ));
            }
        };
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
        let example = kind.is_none().then(|| times.first()).flatten();
        Ok(example.and_then(|number| match clock::of_number(columns.kind, *number)? {
            WrittenTime::OfDay(_) if columns.kind == ClockKind::Hhmmss => Some(format!(
                "column {:?} is taken for times of the day without colons: {number:06} is hhmmss",
                columns.header(Meaning::Time)
            )),
            WrittenTime::Civil(civil) if columns.kind == ClockKind::Excel => Some(format!(
                "column {:?} is taken for dates of a sheet, days since 1899-12-30: {number} is {civil}",
                columns.header(Meaning::Time)
            )),
            _ => None,
        }))
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
        let beyond = fixes.iter().find(|(latitude, longitude)| latitude.abs() > 90.0 || longitude.abs() > 180.0);
        let (latitude, _) = *beyond.filter(|_| all_fit)?;
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
                "column {header:?} has a unit of a {key}, but is none: speed and location agree in {percent:.0} % of the stretches, expected {:.0} %",
                100.0 * LEAST_ALIKE
            ),
            (false, None) => {
                format!("column {header:?} has a unit of a {key}, but too few rows of a moving train to try it")
            }
        }]
    }

    /// Units of time, location and speed that nothing names.
    ///
    /// # Errors
    /// Names the candidates, and the line that decides.
    pub fn units(&self, columns: &mut Columns) -> Result<Vec<String>, String> {
        self.effort(columns);
        for (meaning, unit) in &self.behind {
            if let Some(column) = columns.of.get_mut(meaning).filter(|column| column.unit.is_none()) {
                column.unit = Some(*unit);
                column.how = How::Evidence(format!("{} stands behind the values", unit.name));
            }
        }
        let is_number = columns.kind.has_unit();
        let unnamed = |meaning: &Meaning| columns.of.get(meaning).is_some_and(|column| column.unit.is_none());
        let unknown: Vec<Meaning> =
            DECIDED.into_iter().filter(unnamed).filter(|meaning| *meaning != Meaning::Time || is_number).collect();
        let stretches = match stretches(&self.rows, columns) {
            Ok(stretches) => stretches,
            Err(_) if unknown.is_empty() => return Ok(Vec::new()),
            Err(why) => return Err(not_decided(columns, &unknown, &[], &why)),
        };
        let tried = stretches.tried(columns, &unknown);
        let agree: Vec<Tried> = tried.iter().filter(|(ratio, _)| (ratio - 1.0).abs() < NEAR).copied().collect();
        match agree.as_slice() {
            [] if unknown.is_empty() => {
                let ratio = tried.first().map_or(1.0, |(ratio, _)| *ratio);
                let is_believed = is_said(columns) || MAY_BE.contains(&ratio);
                if is_believed {
                    Ok(vec![figure(ratio)])
                } else {
                    Err(format!("units: {}", contradiction(columns, ratio, &stretches)))
                }
            }
            [(ratio, found)] => {
                for (meaning, unit) in DECIDED.into_iter().zip(found).filter(|(meaning, _)| unknown.contains(meaning)) {
                    if let Some(column) = columns.of.get_mut(&meaning) {
                        column.unit = Some(*unit);
                        column.how =
                            How::Evidence(format!("distance by location over distance by speed is {ratio:.4}"));
                    }
                }
                Ok(vec![figure(*ratio)])
            }
            [] => Err(not_decided(columns, &unknown, &[], "no units make the distance by speed that by location")),
            several => Err(not_decided(columns, &unknown, several, "these agree alike")),
        }
    }

    /// What is to be warned of: the distances do not agree in the units that a person said.
    pub fn doubt(&self, columns: &Columns) -> Option<String> {
        let stretches = stretches(&self.rows, columns).ok().filter(|_| is_said(columns))?;
        let (ratio, _) = stretches.tried(columns, &[]).first().copied()?;
        let is_denied = !MAY_BE.contains(&ratio);
        is_denied.then(|| format!("units of the mapping are believed: {}", contradiction(columns, ratio, &stretches)))
    }

    /// Of each file, whether its own rows deny what was decided of all: times that are not read so, or distances that
    /// do not agree. Never what a person said.
    pub fn denied(&self, columns: &Columns) -> Vec<bool> {
        let ends = self.begins.iter().skip(1).copied().chain([self.rows.len()]);
        let of_file = |(begin, end): (&usize, usize)| {
            let rows = &self.rows[*begin..end];
            let written = rows.iter().filter(|row| row.time.is_some()).count();
            let read = rows.iter().filter(|row| row.time(columns).is_some()).count();
            2 * read < written
                || (!is_said(columns) && ratio_of(rows, columns).is_some_and(|ratio| !MAY_BE.contains(&ratio)))
        };
        self.begins.iter().zip(ends).map(of_file).collect()
    }

    /// An effort without unit is one per mass if it is as small as that.
    fn effort(&self, columns: &mut Columns) {
        let largest = self.efforts.iter().map(|effort| effort.abs()).fold(0.0, f64::max);
        let Some(column) = columns.of.get_mut(&Meaning::Effort) else {
            return;
        };
        if column.unit.is_none() && largest < 3.0 && largest > 0.0 {
            column.unit = units::by_name(Meaning::Effort, "N/kg");
            column.how = How::Evidence(format!("no value beyond {largest:.2}"));
        }
    }
}

/// That the distances do not agree in the named units, and the line with those in which they would.
fn contradiction(columns: &Columns, ratio: f64, stretches: &Stretches) -> String {
    let of = |meaning: Meaning| units::of(meaning).iter().map(move |unit| (meaning, *unit));
    let others: Vec<String> = of(Meaning::Location)
        .filter(|_| columns.has(Meaning::Location))
        .chain(of(Meaning::Speed))
        .filter(|(meaning, unit)| {
            let named = columns.unit(*meaning).map_or(1.0, Unit::factor);
            let change = unit.factor() / named;
            let ratio = if *meaning == Meaning::Speed { ratio / change } else { ratio * change };
            let mps = if *meaning == Meaning::Speed {
                unit.to_si(stretches.fastest)
            } else {
                columns.unit(Meaning::Speed).map_or(1.0, |unit| unit.to_si(stretches.fastest))
            };
            (ratio - 1.0).abs() < NEAR && FASTEST_MPS.contains(&mps)
        })
        .map(|(meaning, unit)| line([(meaning, columns.header(meaning), format!("unit = {:?}", unit.name))]))
        .collect();
    let remedy = if others.is_empty() {
        "look at the columns; a unit that --mapping gives is believed".to_owned()
    } else {
        format!("{SAY_IT}: {}", others.join(" or "))
    };
    format!("expected 1, found: {}; {remedy}", figure(ratio))
}

/// A person said what place or speed are in.
fn is_said(columns: &Columns) -> bool {
    let said = |meaning| columns.of.get(meaning).is_some_and(|column| column.how == How::Mapping);
    [Meaning::Location, Meaning::Speed].iter().any(said)
}

/// Distance by location over distance by speed in the units that were decided.
fn ratio_of(rows: &[WrittenRow], columns: &Columns) -> Option<f64> {
    let stretches = stretches(rows, columns).ok()?;
    stretches.tried(columns, &[]).first().map(|(ratio, _)| *ratio)
}

/// Distances by location over those by speed, in the units of the file.
///
/// # Errors
/// Why they cannot be compared.
fn stretches(all: &[WrittenRow], columns: &Columns) -> Result<Stretches, String> {
    let pieces = pieces(all, columns);
    let together = pieces.iter().flatten().count();
    let (mut long, mut short) = (None, None);
    if let Some((fastest, step)) = usual(&pieces).filter(|_| columns.has(Meaning::Speed)) {
        let longest = longest(&pieces, step);
        let counted = |steps, of_place| {
            Stretches::new(ratios(&pieces, columns, [fastest, longest], (steps, of_place)), fastest, step)
        };
        let of = |steps| counted(steps, true);
        long = of(STEPS);
        // A few steps of a location with few digits say nothing.
        let alike = |found: &Stretches| found.alike >= LEAST_ALIKE;
        short = long.is_none().then(|| of(FEW_STEPS)).flatten().filter(alike);
        // Between near stops a place in large steps hardly takes so many.
        short = short.or_else(|| long.is_none().then(|| counted(STEPS, false)).flatten().filter(alike));
    }
    long.or(short).ok_or_else(|| match without_numbers(all, columns) {
        Some(header) => format!("column {header:?} holds no number that can be read"),
        None if !columns.has(Meaning::Speed) => "no column has a speed".to_owned(),
        None if together < STEPS * LEAST_STRETCHES => {
            format!("time, speed and location stand together in {} only", counted(together, "row", "rows"))
        }
        None => format!(
            "in {together} rows with speed and location the train hardly ever keeps moving for {FEW_STEPS} locations on end"
        ),
    })
}

/// Rows of each file that have time, place and speed: where columns are sparse others stand between them.
fn pieces(all: &[WrittenRow], columns: &Columns) -> Vec<Vec<Passing>> {
    let begins = |row: &WrittenRow| row.time.is_none() && row.numbers[0].is_none();
    let of_file = |rows: &[WrittenRow]| rows.iter().filter_map(|row| row.passing(columns)).collect();
    all.split(begins).map(of_file).collect()
}

/// A column that says where the train is or how fast, without a number in any row.
fn without_numbers<'a>(rows: &[WrittenRow], columns: &'a Columns) -> Option<&'a str> {
    let is_empty = |position: usize| rows.iter().all(|row| row.numbers[position].is_none());
    let mut numbered = EXPECTED.iter().enumerate().skip(1);
    let found = numbered.find(|(position, meaning)| columns.has(**meaning) && is_empty(*position));
    found.map(|(_, meaning)| columns.header(*meaning))
}

#[derive(Debug, Default)]
struct WrittenRow {
    /// Time as a number, location, speed, latitude, longitude.
    numbers: [Option<f64>; 5],
    time: Option<String>,
    date: Option<String>,
}

impl WrittenRow {
    fn passing(&self, columns: &Columns) -> Option<Passing> {
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

    fn time(&self, columns: &Columns) -> Option<f64> {
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

/// What a row says of where the train is.
const EXPECTED: [Meaning; 5] =
    [Meaning::Time, Meaning::Location, Meaning::Speed, Meaning::Latitude, Meaning::Longitude];

/// What evidence decides.
const DECIDED: [Meaning; 3] = [Meaning::Time, Meaning::Location, Meaning::Speed];

/// Distance by location over distance by speed with these units.
type Tried = (f64, [Unit; 3]);

/// What the moving stretches of some files say.
struct Stretches {
    ratio: f64,
    /// Share of them that have it.
    alike: f64,
    fastest: f64,
    step: f64,
}

/// The kind of a clock, by its fields as numbers and as texts. With a unit of time they are numbers.
fn kind_of(times: &[f64], texts: &[&String], has_unit: bool, beside_dates: bool) -> ClockKind {
    if 2 * times.len() > texts.len() || texts.is_empty() {
        let is_dated = |text: &&String| matches!(clock::parse(text, DateOrder::Ymd), Some(WrittenTime::Civil(_)));
        return match median(times.iter().copied()) {
            _ if !has_unit
                && texts.len() > 1
                && texts.iter().take(1000).all(|text| text.len() >= 14 && is_dated(text)) =>
            {
                ClockKind::DateTime
            }
            _ if !has_unit && are_digits(times) => ClockKind::Hhmmss,
            Some(time) if !has_unit && SHEET_DAYS.contains(&time) && are_days(times) => ClockKind::Excel,
            Some(time) if time > 3e8 => ClockKind::Unix,
            _ => ClockKind::Number,
        };
    }
    let of_day = |text: &&&String| matches!(clock::parse(text, DateOrder::Ymd), Some(WrittenTime::OfDay(_)));
    let looked = texts.len().min(1000);
    let count = texts[..looked].iter().filter(of_day).count();
    let is_of_day = 2 * count > looked || clock::are_dotted(&texts[..looked], beside_dates);
    if is_of_day { ClockKind::TimeOfDay } else { ClockKind::DateTime }
}

/// Dates of a sheet from 1954 to 2119, and how far apart its rows may be, days.
const SHEET_DAYS: std::ops::Range<f64> = 20_000.0..80_000.0;
const SHEET_STEP: std::ops::Range<f64> = 1e-7..7e-3;

/// Numbers that go forward by seconds, if they are days: a clock in seconds would be read a hundred times a second and
/// more.
fn are_days(times: &[f64]) -> bool {
    let steps = times.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0);
    median(steps).is_some_and(|step| SHEET_STEP.contains(&step))
}

/// Numbers of which none ends on 60 to 99, and whose last two digits begin again while those before go on: `hhmmss`.
fn are_digits(times: &[f64]) -> bool {
    let minutes = times.windows(2).filter(|pair| pair[0] % 100.0 > pair[1] % 100.0 && pair[1] > pair[0]).count();
    minutes >= 2 && times.iter().all(|time| clock::of_digits(*time).is_some())
}

fn figure(ratio: f64) -> String {
    format!("distance by location over distance by speed is {ratio:.4} with these units")
}

impl Stretches {
    /// None where they are too few.
    fn new(mut ratios: Vec<f64>, fastest: f64, step: f64) -> Option<Self> {
        // A train that stands where its speed is large denies the speed.
        let tried = ratios.len();
        ratios.retain(|ratio| *ratio > 0.0 && ratio.is_finite());
        let ratio = median(ratios.iter().copied()).filter(|_| ratios.len() >= LEAST_STRETCHES)?;
        let alike = ratios.iter().filter(|one| (*one / ratio - 1.0).abs() < ALIKE).count() as f64 / tried as f64;
        Some(Self { ratio, alike, fastest, step })
    }

    /// All units that are known or possible, at speeds of trains and steps of recorders where something is unknown.
    fn tried(&self, columns: &Columns, unknown: &[Meaning]) -> Vec<Tried> {
        // A column that is not there is in SI: text gives seconds, positions give metres.
        let units = |meaning, si: &str| -> Vec<Unit> {
            if unknown.contains(&meaning) {
                return units::candidates(meaning).to_vec();
            }
            columns.unit(meaning).or_else(|| units::by_name(meaning, si)).into_iter().collect()
        };
        let is_text = !columns.kind.has_unit();
        let second = || units::by_name(Meaning::Time, "s").into_iter().collect();
        let times: Vec<Unit> = if is_text { second() } else { units(Meaning::Time, "s") };
        let mut tried = Vec::new();
        for time in times {
            for length in units(Meaning::Location, "m") {
                for speed in units(Meaning::Speed, "m/s") {
                    let factor = length.factor() / (speed.factor() * time.factor());
                    let of_trains = FASTEST_MPS.contains(&speed.to_si(self.fastest));
                    if unknown.is_empty() || (of_trains && STEP_S.contains(&time.to_si(self.step))) {
                        tried.push((factor * self.ratio, [time, length, speed]));
                    }
                }
            }
        }
        tried
    }
}

fn not_decided(columns: &Columns, unknown: &[Meaning], agree: &[Tried], why: &str) -> String {
    let keys: Vec<&str> = unknown.iter().map(|meaning| meaning.key()).collect();
    let place = |meaning: &Meaning| DECIDED.iter().position(|one| one == meaning).unwrap_or(0);
    let sets: Vec<String> = agree
        .iter()
        .map(|(ratio, set)| {
            let names: Vec<&str> = unknown.iter().map(|meaning| set[place(meaning)].name).collect();
            format!("{} ({ratio:.3})", names.join(" with "))
        })
        .collect();
    let lists: Vec<String> = unknown
        .iter()
        .map(|meaning| units::candidates(*meaning).iter().map(|unit| unit.name).collect::<Vec<_>>().join(", "))
        .collect();
    let candidates = if sets.is_empty() { lists.join("; ") } else { sets.join(" or ") };
    let said = unknown.iter().map(|meaning| {
        let unit = agree.first().map(|(_, set)| set[place(meaning)]).or(units::candidates(*meaning).first().copied());
        (*meaning, columns.header(*meaning), format!("unit = {:?}", unit.map_or("", |unit| unit.name)))
    });
    format!(
        "{}: expected a unit, found none in the header, and {why}: {candidates}; {SAY_IT} (or another unit): {}",
        keys.join(" and "),
        line(said)
    )
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
fn is_plain(field: &RowField, decimal: char) -> bool {
    let RowField::Text(text) = field else { return true };
    let parsed = number::parse(text, decimal);
    parsed.is_some_and(|(_, rest)| rest.is_empty() || units::by_name(Meaning::Time, rest).is_some())
}

/// `km/h` of `80 km/h`.
fn unit_behind(meaning: Meaning, field: Option<&RowField>, decimal: char) -> Option<Unit> {
    let RowField::Text(text) = field? else { return None };
    let (_, rest) = number::parse(text, decimal)?;
    if rest.is_empty() { None } else { units::by_name(meaning, rest) }
}

fn value(field: Option<&RowField>, decimal: char) -> Option<f64> {
    match field? {
        RowField::Empty => None,
        RowField::Number(number) => Some(*number),
        RowField::Text(text) => number::parse(text, decimal)
            .filter(|(_, rest)| !rest.starts_with([':', '/', 'T']))
            .map(|(number, _)| number),
    }
}
