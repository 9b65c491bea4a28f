//! The kind of a clock by its readings, and what is said of it.

use super::super::clock::{self, ClockKind, DateOrder, WrittenTime};
use super::super::columns::Columns;
use super::super::meaning::Meaning;
use super::super::zone;
use rundown_files::statistics::median;

/// The kind of a clock, by its fields as numbers and as texts. With a unit of time they are numbers.
pub(super) fn kind_of(times: &[f64], texts: &[&String], has_unit: bool, beside_dates: bool) -> ClockKind {
    if 2 * times.len() > texts.len() || texts.is_empty() {
        let is_dated = |text: &&String| matches!(clock::parse(text, DateOrder::Ymd), Some(WrittenTime::Civil(_)));
        return match median(times) {
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

/// What a person should know of how numbers are read as times; the first of them says it.
pub(super) fn read_as(columns: &Columns, first: f64) -> Option<String> {
    let header = columns.header(Meaning::Time);
    match columns.kind {
        ClockKind::Hhmmss => {
            Some(format!("column {header:?} is taken for times of the day without colons: {first:06} is hhmmss"))
        }
        ClockKind::Excel => {
            let Some(WrittenTime::Civil(civil)) = clock::of_number(columns.kind, first) else { return None };
            Some(format!("column {header:?} is taken for dates of a sheet, days since 1899-12-30: {first} is {civil}"))
        }
        ClockKind::Unix => zone::other_epoch(header, columns.unit(Meaning::Time)?.to_si(first)),
        ClockKind::Number | ClockKind::DateTime | ClockKind::TimeOfDay => None,
    }
}
