//! Fields of a row as one sample in SI units, with all that cannot be read counted.

use super::account::{Account, NO_NUMBER};
use super::clock::{self, ClockKind, WrittenTime};
use super::columns::Columns;
use super::evidence;
use super::meaning::Meaning;
use super::number;
use super::source::row::RowField;
use super::units;
use rundown_files::sample::{COLUMNS, LOCATION, NumberColumn, Sample};
use std::path::Path;

/// No train turns its wheels further in its life, m.
const MOST_ODOMETER_M: f64 = 1e11;

/// A row that is understood.
#[derive(Clone, Debug, Default)]
pub struct Record {
    pub sample: Sample,
    pub altitude_m: Option<f64>,
    /// Values of the columns that split the rows.
    pub unit: String,
    pub run: String,
    /// `time_s` counts from 1970 UTC.
    pub is_dated: bool,
}

/// What is remembered from row to row of a file.
#[derive(Debug)]
pub struct Converter<'a> {
    /// The file, and its sheet where it has several.
    place: String,
    columns: &'a Columns,
    /// Columns of a log that are taken as they are, in SI.
    others: Vec<(Meaning, NumberColumn)>,
    last_s: Option<f64>,
    days_s: f64,
}

pub const NO_TIME: &str = "rows without a time, left out";
const SHORTER: &str = "rows with fewer fields than the header, the rest taken as missing";
const LONGER: &str = "rows with more fields than the header, the rest not read";
pub const UNREADABLE: &str = "fields that cannot be read, taken as missing";
const BEYOND: &str = "values beyond what trains do, taken as missing";
const NO_PLACE: &str = "positions that are no place on Earth, taken as missing";
pub const MIDNIGHT: &str = "midnights, joined";
const DATE_LAGS: &str = "rows whose date turned before or after midnight, put right";
/// What a sample has of these takes more than a number, or other units.
const READ_APART: [Meaning; 7] = [
    Meaning::Time,
    Meaning::Location,
    Meaning::Speed,
    Meaning::Latitude,
    Meaning::Longitude,
    Meaning::Effort,
    Meaning::SpeedIsComputed,
];
const DAY_S: f64 = 86_400.0;
/// A date that is copied from another clock turns within so much of midnight, s: receivers and networks tell it each
/// minute, or few.
const MOST_DATE_LAG_S: f64 = 600.0;
/// Rows so near to each other by the time of the day are of one recording, s.
const GOES_ON_S: f64 = 60.0;

impl<'a> Converter<'a> {
    pub fn new(path: &Path, columns: &'a Columns) -> Self {
        let meaning = |column: &NumberColumn| Meaning::of_name(&units::split(column.name).0);
        let others = COLUMNS.into_iter().filter_map(|column| Some((meaning(&column)?, column)));
        let others = others.filter(|(meaning, _)| !READ_APART.contains(meaning)).collect();
        Self { place: path.display().to_string(), columns, others, last_s: None, days_s: 0.0 }
    }

    /// The rows of a sheet begin.
    pub fn sheet(&mut self, path: &Path, name: &str) {
        self.place = format!("{}[{name}]", path.display());
    }

    /// The next row has so many fields in place of those of the header. One that nobody reads may be missing.
    pub fn ragged(&self, line: u64, (expected, found): (usize, usize), account: &mut Account) {
        let read = self.columns.of.values().map(|column| column.index + 1).filter(|needed| *needed <= expected);
        let what = match found {
            _ if found > expected => LONGER,
            _ if found < read.max().unwrap_or(0) => SHORTER,
            _ => return,
        };
        account.place(what, || format!("{}:{line}: expected {expected} fields, found {found}", self.place));
    }

    /// None for a row without a time.
    pub fn record(&mut self, line: u64, fields: &[RowField], account: &mut Account) -> Option<Record> {
        let time = self.time(line, fields, account).filter(|(time_s, _)| time_s.abs() < COLUMNS[0].range.1);
        let Some((time_s, is_dated)) = time else {
            account.place(NO_TIME, || format!("{}:{line}: expected a time, found none", self.place));
            return None;
        };
        let mut number = |meaning| self.number(meaning, line, fields, account);
        let mut sample = Sample { line, time_s, ..Sample::default() };
        sample.location_m = number(Meaning::Location);
        sample.speed_mps = number(Meaning::Speed);
        let altitude_m = number(Meaning::Altitude);
        sample.effort_n_per_kg = number(Meaning::Effort);
        if self.columns.unit(Meaning::Effort).is_some() {
            sample.effort_n_per_kg = with_brake(sample.effort_n_per_kg, number(Meaning::Braking));
        }
        for (meaning, column) in &self.others {
            if let Some(value) = number(*meaning) {
                (column.set)(&mut sample, value);
            }
        }
        let (latitude, longitude) = (number(Meaning::Latitude), number(Meaning::Longitude));
        if let Some((latitude, longitude)) = latitude.zip(longitude) {
            // Nobody runs trains where the receiver has no fix: 0, 0.
            let on_earth = latitude.abs() <= 90.0 && longitude.abs() <= 180.0 && (latitude, longitude) != (0.0, 0.0);
            if on_earth {
                (sample.latitude_deg, sample.longitude_deg) = (Some(latitude), Some(longitude));
            } else {
                account.count(NO_PLACE, 1);
            }
        }
        if self.columns.is_signed {
            sample.speed_mps = sample.speed_mps.map(f64::abs);
        }
        self.beyond(&mut sample, account);
        sample.speed_mps = sample.speed_mps.filter(|mps| {
            if *mps < 0.0 {
                account.place("speeds below zero, taken as missing", || {
                    format!("{}:{line}: speed: expected 0 or more, found {:.2} m/s", self.place, mps)
                });
            }
            *mps >= 0.0
        });
        let word =
            |meaning| self.columns.index(meaning).and_then(|index| fields.get(index)?.text()).unwrap_or_default();
        // A log of an earlier import.
        sample.speed_is_computed = word(Meaning::SpeedIsComputed).parse().is_ok_and(|yes: f64| yes != 0.0);
        let unit = self.columns.unit_name.clone().unwrap_or_else(|| word(Meaning::Unit));
        Some(Record { sample, altitude_m, unit, run: word(Meaning::Run), is_dated })
    }

    /// Values that no train and no clock has are missing.
    fn beyond(&self, sample: &mut Sample, account: &mut Account) {
        for column in &COLUMNS {
            let value = (column.get)(sample);
            // An odometer may count further than any line is long; it is brought to a chainage afterwards.
            let (low, high) = match column.name {
                LOCATION => (-MOST_ODOMETER_M, MOST_ODOMETER_M),
                _ => column.range,
            };
            let Some(value) = value.filter(|value| value.abs() > high.abs().max(low.abs())) else { continue };
            account.place(BEYOND, || {
                format!(
                    "{}:{}: {}: expected {low} to {high} {}, found {value:e}",
                    self.place, sample.line, column.name, column.unit
                )
            });
            (column.clear)(sample);
        }
    }

    fn number(&self, meaning: Meaning, line: u64, fields: &[RowField], account: &mut Account) -> Option<f64> {
        let column = self.columns.of.get(&meaning)?;
        let unit = column.unit?;
        let decimal = self.columns.decimal;
        let angle = |text: &str| number::angle(text, decimal).filter(|_| meaning.is_angle());
        let (value, unit) = match fields.get(column.index)? {
            RowField::Empty => return None,
            RowField::Number(value) => (*value, unit),
            RowField::Text(text) if is_missing(text) => {
                account.count(NO_NUMBER, u64::from(text.trim().eq_ignore_ascii_case("nan")));
                return None;
            }
            RowField::Text(text) if let Some((value, is_whole)) = angle(text) => {
                return Some(if is_whole { value } else { unit.to_si(value) });
            }
            RowField::Text(text) => {
                let parsed = number::parse(text, decimal);
                let with_unit = parsed.and_then(|(value, rest)| {
                    if rest.is_empty() { Some((value, unit)) } else { Some((value, units::by_name(meaning, rest)?)) }
                });
                let Some(with_unit) = with_unit else {
                    account.place(UNREADABLE, || {
                        format!(
                            "{}:{line}:{}: {}: expected a number, found {text:?}",
                            self.place,
                            column.index + 1,
                            column.header
                        )
                    });
                    return None;
                };
                with_unit
            }
        };
        let mass = if meaning.is_force() && unit.name != "N/kg" { self.columns.rotating_mass_kg? } else { 1.0 };
        Some(unit.to_si(value) / mass).filter(|value| value.is_finite())
    }

    fn time(&mut self, line: u64, fields: &[RowField], account: &mut Account) -> Option<(f64, bool)> {
        let column = self.columns.of.get(&Meaning::Time)?;
        let field = fields.get(column.index)?;
        let (time_s, is_dated) = match self.columns.kind {
            ClockKind::Number => (self.number(Meaning::Time, line, fields, account)?, false),
            ClockKind::Unix => (self.number(Meaning::Time, line, fields, account)?, true),
            kind @ (ClockKind::DateTime | ClockKind::TimeOfDay | ClockKind::Hhmmss | ClockKind::Excel) => {
                let Some(written) = evidence::written(kind, field, self.columns) else {
                    account.place(UNREADABLE, || {
                        format!(
                            "{}:{line}:{}: {}: expected a time, found {:?}",
                            self.place,
                            column.index + 1,
                            column.header,
                            evidence::text(field).unwrap_or_default()
                        )
                    });
                    return None;
                };
                match written {
                    WrittenTime::Instant(seconds) => (seconds, true),
                    WrittenTime::Civil(civil) => (clock::in_zone(civil, &self.columns.zone, self.last_s)?, true),
                    WrittenTime::OfDay(seconds) => self.of_day(line, seconds, fields, account)?,
                }
            }
        };
        self.last_s = Some(time_s);
        Some((time_s, is_dated))
    }

    /// The time where a date turned too late or too early: just behind midnight it is a day too small, just before it a
    /// day too large, and the time of the day goes on from row to row.
    fn of_turned_date(&self, of_day_s: f64, dated_s: f64, beside: impl Fn() -> Option<[f64; 2]>) -> Option<f64> {
        let last_s = self.last_s.filter(|last_s| (dated_s - last_s).abs() > 0.5 * DAY_S)?;
        let [tomorrow_s, yesterday_s] = beside()?;
        let turned_s = if of_day_s < MOST_DATE_LAG_S {
            tomorrow_s
        } else if of_day_s > DAY_S - MOST_DATE_LAG_S {
            yesterday_s
        } else {
            return None;
        };
        (0.0..GOES_ON_S).contains(&(turned_s - last_s)).then_some(turned_s)
    }

    /// A time of the day with the date of its row, or after the midnights so far.
    fn of_day(&mut self, line: u64, seconds: f64, fields: &[RowField], account: &mut Account) -> Option<(f64, bool)> {
        if let Some(index) = self.columns.index(Meaning::Date) {
            let text = evidence::text(fields.get(index)?)?;
            let day = clock::parse_date(clock::day_of(&text), self.columns.order)?;
            let on = |day| clock::in_zone(clock::later(day, seconds)?, &self.columns.zone, self.last_s);
            let time_s = on(day)?;
            let turned =
                self.of_turned_date(seconds, time_s, || Some([on(day.tomorrow().ok()?)?, on(day.yesterday().ok()?)?]));
            if let Some(turned_s) = turned {
                account.place(DATE_LAGS, || {
                    format!(
                        "{}:{line}: {}: expected another day, found {text:?}",
                        self.place,
                        self.columns.header(Meaning::Date)
                    )
                });
                return Some((turned_s, true));
            }
            return Some((time_s, true));
        }
        let mut time_s = seconds + self.days_s;
        if self.last_s.is_some_and(|last| time_s < last - 0.5 * DAY_S) {
            account.count(MIDNIGHT, 1);
            self.days_s += DAY_S;
            time_s += DAY_S;
        }
        Some((time_s, false))
    }
}

/// The effort of traction and brake where each has a column of its own, whatever the sign of the brake's. In an effort
/// below zero the larger of both may be all of it; none beside no brake stays unknown.
fn with_brake(traction: Option<f64>, braking: Option<f64>) -> Option<f64> {
    let Some(brake) = braking.map(f64::abs).filter(|brake| *brake > 0.0) else { return traction };
    let traction = traction.unwrap_or(0.0);
    Some(if traction < 0.0 { traction.min(-brake) } else { traction - brake })
}

/// What recorders write for nothing. `#N/A` of a table calculation is none of it: it stands where a formula found no
/// value; nor is what a division by zero leaves.
fn is_missing(text: &str) -> bool {
    matches!(text.trim().to_ascii_lowercase().as_str(), "" | "-" | "--" | "na" | "n/a" | "nan" | "null" | "none" | "?")
}
