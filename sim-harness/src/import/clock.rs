//! Times of recorders as seconds since 1970, or since midnight, or on the recorder's own clock.

use super::meaning::plain;
use super::number;
use jiff::civil::{Date, DateTime, Time};
use jiff::tz::TimeZone;
use serde::{Deserialize, Serialize};

/// How a column of times is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ClockKind {
    /// A number that goes forward, from anywhere.
    Number,
    /// Seconds (or ms, us, ns) since 1970-01-01 UTC.
    Unix,
    /// Date and time, with or without a zone.
    DateTime,
    /// Time of the day; a date may stand in a column of its own.
    TimeOfDay,
    /// The same as digits without colons: 93456 is 09:34:56.
    Hhmmss,
    /// Days since 1899-12-30, local: a date of a sheet without its format.
    Excel,
}

impl ClockKind {
    /// A date may stand in a column of its own.
    pub const fn is_of_day(self) -> bool {
        matches!(self, Self::TimeOfDay | Self::Hhmmss)
    }

    /// Numbers in a unit of time.
    pub const fn has_unit(self) -> bool {
        matches!(self, Self::Number | Self::Unix)
    }
}

/// Order of day, month and year.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DateOrder {
    Ymd,
    Dmy,
    Mdy,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WrittenTime {
    /// A place in history, s since 1970-01-01 UTC.
    Instant(f64),
    /// A local date and time.
    Civil(DateTime),
    /// Seconds since midnight.
    OfDay(f64),
}

/// Reads a date and time, or a time of the day.
pub fn parse(text: &str, order: DateOrder) -> Option<WrittenTime> {
    let text = text.trim();
    if let Ok(instant) = text.parse::<jiff::Timestamp>() {
        return Some(WrittenTime::Instant(instant.as_nanosecond() as f64 / 1e9));
    }
    if let Some((date, of_day)) = compact(text) {
        return later(parse_date(date, DateOrder::Ymd)?, of_day).map(WrittenTime::Civil);
    }
    match split(text) {
        (Some(date), Some(time)) => {
            let (time, east_s) = zoned(time);
            let civil = later(parse_date(date, order)?, of_day(time)?)?;
            let east_s = east_s.map(|east_s| in_zone(civil, &TimeZone::UTC, None).map(|utc_s| utc_s - east_s));
            east_s.map_or(Some(WrittenTime::Civil(civil)), |instant_s| instant_s.map(WrittenTime::Instant))
        }
        (Some(date), None) => Some(WrittenTime::Civil(parse_date(date, order)?.to_datetime(Time::midnight()))),
        (None, Some(time)) => of_day(time).map(WrittenTime::OfDay),
        (None, None) => None,
    }
}

/// Reads a text of a column of this kind: of one of times of the day `10.11.12` is no date.
pub fn of_text(kind: ClockKind, text: &str, order: DateOrder) -> Option<WrittenTime> {
    let of_day_s = (kind == ClockKind::TimeOfDay).then(|| of_dotted_day(text)).flatten();
    of_day_s.map(WrittenTime::OfDay).or_else(|| parse(text, order))
}

/// Texts that are times of the day with dots, and dates in no order; beside dates of their own they need not be none.
pub fn are_dotted(texts: &[&String], beside_dates: bool) -> bool {
    let are_dates = |order| texts.iter().all(|text| parse_date(text, order).is_some());
    texts.iter().all(|text| of_dotted_day(text).is_some())
        && (beside_dates || ![DateOrder::Ymd, DateOrder::Dmy, DateOrder::Mdy].into_iter().any(are_dates))
}

fn of_dotted_day(text: &str) -> Option<f64> {
    dotted(text.trim()).and_then(|_| of_day(text))
}

/// The parts of `23.50.00` and `23.50.00,5`.
fn dotted(time: &str) -> Option<Vec<&str>> {
    let parts: Vec<&str> = time.splitn(3, '.').collect();
    let [hours, minutes, seconds] = parts.as_slice() else { return None };
    let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
    let is_time = (1..=2).contains(&hours.len()) && digits(hours) == hours.len();
    let is_time = is_time && minutes.len() == 2 && digits(minutes) == 2 && digits(seconds) == 2;
    is_time.then_some(parts)
}

/// Reads a number: digits of a time of the day, or days of a sheet.
pub fn of_number(kind: ClockKind, value: f64) -> Option<WrittenTime> {
    if kind == ClockKind::Hhmmss {
        return of_digits(value).map(WrittenTime::OfDay);
    }
    // A double holds such a day to a microsecond.
    let milliseconds = (value * 8.64e7).round();
    let first = Date::new(1899, 12, 30).ok()?.to_datetime(Time::midnight());
    let since = jiff::SignedDuration::from_millis(milliseconds as i64);
    first.checked_add(since).ok().filter(|_| milliseconds.is_finite()).map(WrittenTime::Civil)
}

/// Seconds of the day of `hhmmss`, leading zeros lost or not.
pub fn of_digits(value: f64) -> Option<f64> {
    let whole = value.floor();
    let (hours, minutes, seconds) = ((whole / 1e4).floor(), (whole / 100.0).floor() % 100.0, value % 100.0);
    let fits = value >= 0.0 && hours < 24.0 && minutes < 60.0 && seconds < 60.0;
    fits.then_some(3600.0 * hours + 60.0 * minutes + seconds)
}

/// So many seconds behind the midnight of a day.
pub fn later(day: Date, of_day_s: f64) -> Option<DateTime> {
    let nanoseconds = (of_day_s.fract() * 1e9).round() as i32;
    day.to_datetime(Time::midnight()).checked_add(jiff::SignedDuration::new(of_day_s as i64, nanoseconds)).ok()
}

/// `20250131103456` and `20250131 103456.5`: the date, and seconds of the day.
fn compact(text: &str) -> Option<(&str, f64)> {
    let (date, time) = text.split_at_checked(8)?;
    let time = time.strip_prefix([' ', 'T', '_', '-']).unwrap_or(time);
    let is_whole = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    let (whole, fraction) = time.split_once(['.', ',']).unwrap_or((time, ""));
    let fits = is_whole(date) && whole.len() == 6 && is_whole(whole) && is_whole(fraction);
    let of_day = format!("{whole}.{fraction}0").parse().ok().filter(|_| fits)?;
    Some((date, of_digits(of_day)?))
}

/// A time of the day without its zone, and how far that is east of UTC, s.
fn zoned(time: &str) -> (&str, Option<f64>) {
    for name in ["UTC", "GMT", "Z"] {
        if let Some(rest) = time.strip_suffix(name) {
            return (rest.trim_end(), Some(0.0));
        }
    }
    let Some(at) = time.rfind(['+', '-']) else { return (time, None) };
    let digits: String = time[at + 1..].chars().filter(|c| *c != ':').collect();
    // What is cut below is counted in bytes.
    if !digits.is_ascii() {
        return (time, None);
    }
    let minutes = |text: &str| text.parse::<u32>().ok().map(f64::from);
    let before = time[..at].trim_end();
    // `UTC+1`
    let rest = before.strip_suffix("UTC").or_else(|| before.strip_suffix("GMT"));
    let east_s = match digits.len() {
        1 if rest.is_some() => minutes(&digits).map(|hours| 3600.0 * hours),
        2 => minutes(&digits).map(|hours| 3600.0 * hours),
        4 => minutes(&digits[..2]).zip(minutes(&digits[2..])).map(|(hours, minutes)| 3600.0 * hours + 60.0 * minutes),
        3 if rest.is_some() => {
            minutes(&digits[..1]).zip(minutes(&digits[1..])).map(|(hours, minutes)| 3600.0 * hours + 60.0 * minutes)
        }
        _ => None,
    };
    let sign = if time[at..].starts_with('-') { -1.0 } else { 1.0 };
    match east_s.filter(|east_s| *east_s <= 16.0 * 3600.0) {
        Some(east_s) => (rest.map_or(before, str::trim_end), Some(sign * east_s)),
        None => (time, None),
    }
}

/// Date and time of a text, as far as there are any.
fn split(text: &str) -> (Option<&str>, Option<&str>) {
    let Some(colon) = text.find(':') else {
        let dotted = text.rsplit_once([' ', 'T', 't', '_', ';']).filter(|(_, time)| dotted(time).is_some());
        return match dotted {
            Some((date, time)) => (Some(date.trim_end_matches([',', ' '])), Some(time)),
            None => (Some(text).filter(|text| !text.is_empty()), None),
        };
    };
    // The t of `31-Oct-2025` is no separator.
    let is_hour = |at: &usize| text[at + 1..colon].trim_start().bytes().all(|byte| byte.is_ascii_digit());
    match text[..colon].rfind([' ', 'T', 't', '_', ';', ',']).filter(is_hour) {
        Some(at) => (Some(text[..at].trim_end_matches([',', ' '])), Some(text[at + 1..].trim())),
        None => (None, Some(text)),
    }
}

/// The date of a text that may have a time behind it.
pub fn day_of(text: &str) -> &str {
    split(text.trim()).0.unwrap_or_default()
}

/// Three numbers of a date as they stand.
fn numbers(date: &str) -> Option<[i32; 3]> {
    let mut parts = date.split(['.', '/', '-', ' ']).filter(|part| !part.is_empty());
    let mut next = || parts.next()?.parse::<i32>().ok().filter(|number| (0..=9999).contains(number));
    let found = [next()?, next()?, next()?];
    parts.next().is_none().then_some(found)
}

pub fn parse_date(date: &str, order: DateOrder) -> Option<Date> {
    let [a, b, c] = match numbers(date) {
        Some(found) => found,
        // 20250131
        None if date.len() == 8 && date.bytes().all(|byte| byte.is_ascii_digit()) => {
            return ymd(date[..4].parse().ok()?, date[4..6].parse().ok()?, date[6..].parse().ok()?);
        }
        None => return in_words(date),
    };
    match order {
        DateOrder::Ymd => ymd(a, b, c),
        DateOrder::Dmy => ymd(c, b, a),
        DateOrder::Mdy => ymd(c, a, b),
    }
}

/// The first letters of the months in English, German, French, Spanish and Italian, without accents.
const MONTHS: [&[&str]; 12] = [
    &["jan", "gen", "ene"],
    &["feb", "fev"],
    &["mar", "mrz", "maer"],
    &["apr", "avr", "abr"],
    &["may", "mai", "mag"],
    &["jun", "juin", "giu"],
    &["jul", "juil", "lug"],
    &["aug", "aou", "ago"],
    &["sep", "set"],
    &["oct", "okt", "ott"],
    &["nov"],
    &["dec", "dez", "dic"],
];

/// `31 January 2025`, `Jan 31st, 2025`, `31-JAN-25`, `Fri 31. Januar 2025`. With two words for months (`mar.` is a
/// Tuesday, too) it is none.
fn in_words(date: &str) -> Option<Date> {
    let (mut months, mut numbers, mut rest) = (Vec::new(), Vec::new(), &*plain(date));
    while let Some(first) = rest.chars().next() {
        let is_digit = first.is_ascii_digit();
        let end = rest.find(|c: char| c.is_ascii_digit() != is_digit).unwrap_or(rest.len());
        let (token, behind) = rest.split_at(end);
        rest = behind;
        if is_digit {
            numbers.push((token.len(), token.parse::<i32>().ok()?));
            continue;
        }
        let month = |word: &str| MONTHS.iter().position(|stems| stems.iter().any(|stem| word.starts_with(stem)));
        months.extend(token.split_whitespace().filter_map(month));
    }
    let ([month], [first, second]) = (&*months, &*numbers) else { return None };
    let (year, day) = if first.0 == 4 { (first, second) } else { (second, first) };
    let is_year = matches!(year.0, 2 | 4) && day.0 <= 2;
    ymd(year.1, *month as i32 + 1, day.1).filter(|_| is_year)
}

fn ymd(year: i32, month: i32, day: i32) -> Option<Date> {
    let year = if year < 100 { year + if year < 70 { 2000 } else { 1900 } } else { year };
    Date::new(year.try_into().ok()?, month.try_into().ok()?, day.try_into().ok()?).ok()
}

/// `hh:mm`, `hh:mm:ss`, `hh:mm:ss,123`, `hh:mm:ss:123`, `hh.mm.ss`, with `am` or `pm`: seconds since midnight.
fn of_day(time: &str) -> Option<f64> {
    let small = time.trim().to_ascii_lowercase();
    let (time, half) = match small.strip_suffix("am").or_else(|| small.strip_suffix("a.m.")) {
        Some(time) => (time, Some(0.0)),
        None => match small.strip_suffix("pm").or_else(|| small.strip_suffix("p.m.")) {
            Some(time) => (time, Some(12.0)),
            None => (small.as_str(), None),
        },
    };
    let time = time.trim();
    let parts = if time.contains(':') { time.split(':').collect() } else { dotted(time)? };
    if !(2..=4).contains(&parts.len()) {
        return None;
    }
    let whole = |text: &str| text.parse::<u32>().ok().map(f64::from);
    let mut hours = whole(parts[0])?;
    if let Some(half) = half {
        hours = hours % 12.0 + half;
    }
    let minutes = whole(parts[1])?;
    let seconds = parts.get(2).map_or(Some(0.0), |text| {
        number::parse(&text.replace(',', "."), '.').filter(|n| n.1.is_empty()).map(|n| n.0)
    })?;
    let thousandths = parts.get(3).map_or(Some(0.0), |text| whole(text))?;
    let fits = hours < 25.0 && minutes < 60.0 && (0.0..61.0).contains(&seconds) && thousandths < 1000.0;
    fits.then_some(3600.0 * hours + 60.0 * minutes + seconds + 0.001 * thousandths)
}

/// What the dates of a column allow for the order of their numbers.
#[derive(Clone, Copy, Debug, Default)]
pub struct Orders {
    seen: usize,
    year_first: usize,
    year_last: usize,
    dots: usize,
    first_above_12: usize,
    second_above_12: usize,
    slashes: usize,
    /// First and third number of the first date, and by how much those of others differ at most.
    first: Option<[i32; 2]>,
    differ: [i32; 2],
}

impl Orders {
    pub fn see(&mut self, text: &str) {
        let date = day_of(text);
        let Some([a, b, c]) = numbers(date) else {
            self.year_first += usize::from(parse_date(date, DateOrder::Ymd).is_some());
            return;
        };
        self.seen += 1;
        let is_day = |number: i32| (1..=31).contains(&number);
        self.year_first += usize::from(!is_day(a));
        self.year_last += usize::from(!is_day(c));
        self.dots += usize::from(date.contains('.'));
        self.slashes += usize::from(date.contains('/'));
        self.first_above_12 += usize::from(a > 12);
        self.second_above_12 += usize::from(b > 12);
        let first = self.first.get_or_insert([a, c]);
        self.differ[0] = self.differ[0].max((first[0] - a).abs());
        self.differ[1] = self.differ[1].max((first[1] - c).abs());
    }

    /// The order, where there is no doubt. Dots between the numbers are of countries that write the day first.
    pub fn decided(&self) -> Option<DateOrder> {
        if self.seen == 0 || self.year_first > 0 {
            return Some(DateOrder::Ymd);
        }
        match (self.differ[0], self.differ[1]) {
            // Days change, years do not, or by one.
            (0 | 1, 2..) | (0, 1) if self.may_be_year_first() => return Some(DateOrder::Ymd),
            (2.., 0 | 1) | (1, 0) => {}
            _ if self.may_be_year_first() && self.dots == 0 => return None,
            _ => {}
        }
        match (self.first_above_12 > 0, self.second_above_12 > 0) {
            (true, false) => Some(DateOrder::Dmy),
            (false, true) => Some(DateOrder::Mdy),
            (false, false) if self.dots > 0 => Some(DateOrder::Dmy),
            _ => None,
        }
    }

    /// Years of two digits at either end: `25-03-24`.
    const fn may_be_year_first(&self) -> bool {
        self.year_last == 0 && self.second_above_12 == 0
    }

    /// Which numbers may stand first, and the orders to choose from.
    pub const fn doubt(&self) -> [&'static str; 3] {
        match (self.may_be_year_first(), self.first_above_12 > 0) {
            (false, _) => ["day or month", "dmy", "\"mdy\""],
            // Slashes are of countries that write the year last.
            (true, true) if self.slashes > 0 => ["day or year", "dmy", "\"ymd\""],
            (true, true) => ["year or day", "ymd", "\"dmy\""],
            (true, false) => ["day, month or year", "dmy", "\"mdy\", \"ymd\""],
        }
    }
}

/// A local time in a zone, s since 1970-01-01 UTC. An hour that the clocks are set back over is its first;
/// `from_before` keeps it going forward.
pub fn in_zone(civil: DateTime, zone: &TimeZone, from_before: Option<f64>) -> Option<f64> {
    let ambiguous = zone.to_ambiguous_timestamp(civil);
    let first = ambiguous.earlier().ok()?.as_nanosecond() as f64 / 1e9;
    if ambiguous.is_ambiguous()
        && let Some(before) = from_before
        && first < before - 1800.0
    {
        return ambiguous.later().ok().map(|later| later.as_nanosecond() as f64 / 1e9);
    }
    Some(first)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seconds(text: &str, order: DateOrder) -> Option<f64> {
        match parse(text, order)? {
            WrittenTime::Instant(seconds) | WrittenTime::OfDay(seconds) => Some(seconds),
            WrittenTime::Civil(civil) => in_zone(civil, &TimeZone::UTC, None),
        }
    }

    #[test]
    fn words_behind_a_time_are_no_zone_whatever_their_letters() {
        for text in ["08:15-Köl", "2025-01-31 08:15:00-Köl", "08:15 UTC-€", "08:15:00+aß1"] {
            assert_eq!(seconds(text, DateOrder::Dmy), None, "{text}");
        }
    }

    #[test]
    fn times_are_read_in_their_orders() {
        let expected = Some(1_738_319_696.5);
        for (text, order) in [
            ("2025-01-31T10:34:56.5Z", DateOrder::Ymd),
            ("2025-01-31T11:34:56.5+01:00", DateOrder::Ymd),
            ("2025-01-31 10:34:56,5", DateOrder::Ymd),
            ("31.01.2025 10:34:56.5", DateOrder::Dmy),
            ("01/31/2025 10:34:56.5 AM", DateOrder::Mdy),
            ("20250131 10:34:56:500", DateOrder::Ymd),
            ("31 January 2025 10:34:56.5", DateOrder::Ymd),
            ("Fri, 31 Jan 2025 11:34:56.5 +0100", DateOrder::Mdy),
            ("Freitag, 31. Januar 2025 10:34:56,5", DateOrder::Ymd),
            ("31-JAN-25 10:34:56.5", DateOrder::Ymd),
            ("Jan 31st, 2025 10:34:56.5 AM", DateOrder::Ymd),
            ("2025 janv. 31 10:34:56.5 UTC", DateOrder::Ymd),
            ("31.01.2025 08:04:56.5-02:30", DateOrder::Dmy),
            ("31.01.2025 11:34:56.5 UTC+1", DateOrder::Dmy),
            ("2025-01-31 08:04:56,5 UTC-02:30", DateOrder::Ymd),
            ("2025-01-31T12:34:56.5GMT+02", DateOrder::Ymd),
            ("20250131103456.5", DateOrder::Mdy),
            ("20250131T103456.5", DateOrder::Ymd),
            ("31.01.2025 10.34.56,5", DateOrder::Dmy),
            ("2025-01-31T10.34.56.5", DateOrder::Ymd),
        ] {
            assert_eq!(seconds(text, order), expected, "{text}");
        }
        assert_eq!(seconds("12:00:01 am", DateOrder::Ymd), Some(1.0));
        for text in [
            "",
            ":",
            "31.13.2025 10:00",
            "10:61",
            "abc",
            "2025-02-30 10:00:00",
            "9999999999:00",
            "mar. 4 mars 2025 10:00",
            "30 Feb 2025 10:00",
            "Jan 2025 10:00",
            "20250131 106056",
            "31 Jan 025 10:00",
        ] {
            assert_eq!(seconds(text, DateOrder::Dmy), None, "{text}");
        }
    }

    #[test]
    fn times_of_the_day_have_dots_where_no_date_does() {
        let of_day = |text| of_text(ClockKind::TimeOfDay, text, DateOrder::Dmy);
        assert_eq!(of_day("23.50.00"), Some(WrittenTime::OfDay(85_800.0)));
        assert_eq!(of_day(" 9.05.07,25 "), Some(WrittenTime::OfDay(32_707.25)));
        assert_eq!(of_day("10.11.12"), Some(WrittenTime::OfDay(36_672.0)));
        for wrong in ["24.60.00", "23.50", "23.50.61", "23.5o.00"] {
            assert_eq!(of_day(wrong), None, "{wrong}");
        }
        let are_dotted = |texts: &[&str], beside_dates| {
            let texts: Vec<String> = texts.iter().map(|text| (*text).to_owned()).collect();
            super::are_dotted(&texts.iter().collect::<Vec<_>>(), beside_dates)
        };
        assert!(are_dotted(&["10.31.00", "10.32.00"], false));
        assert!(!are_dotted(&["10.11.12", "11.11.12"], false));
        assert!(are_dotted(&["10.11.12", "11.11.12"], true));
        assert!(!are_dotted(&["10.31.00", "10.32.61"], true));
    }

    #[test]
    fn digits_of_the_day_and_days_of_a_sheet_are_times() {
        assert_eq!(of_number(ClockKind::Hhmmss, 93_456.5), Some(WrittenTime::OfDay(34_496.5)));
        assert_eq!(of_number(ClockKind::Hhmmss, 5.0), Some(WrittenTime::OfDay(5.0)));
        for wrong in [93_460.0, 96_000.0, 240_000.0, -1.0, f64::NAN] {
            assert_eq!(of_number(ClockKind::Hhmmss, wrong), None, "{wrong}");
        }
        let noon: DateTime = "2025-01-31T10:34:56.5".parse().unwrap();
        assert_eq!(of_number(ClockKind::Excel, 45_688.440_931_713), Some(WrittenTime::Civil(noon)));
        assert_eq!(of_number(ClockKind::Excel, f64::INFINITY), None);
    }

    #[test]
    fn an_order_is_decided_only_without_doubt() {
        let of = |texts: &[&str]| {
            let mut orders = Orders::default();
            texts.iter().for_each(|text| orders.see(text));
            orders.decided()
        };
        assert_eq!(of(&["03/04/2025 10:00", "03/04/2025 10:01"]), None);
        assert_eq!(of(&["03/14/2025 10:00"]), Some(DateOrder::Mdy));
        assert_eq!(of(&["14/03/2025 10:00"]), Some(DateOrder::Dmy));
        assert_eq!(of(&["03.04.2025 10:00"]), Some(DateOrder::Dmy));
        assert_eq!(of(&["2025-03-04 10:00"]), Some(DateOrder::Ymd));
        assert_eq!(of(&["25-03-24 10:00", "25-03-24 10:01"]), None);
        assert_eq!(of(&["25-03-04 10:00", "25-03-05 10:00"]), Some(DateOrder::Ymd));
        assert_eq!(of(&["24/03/25 10:00", "25/03/25 10:00"]), Some(DateOrder::Dmy));
        assert_eq!(of(&["31/12/24 23:00", "01/01/25 01:00"]), Some(DateOrder::Dmy));
        assert_eq!(of(&["24-12-31 23:00", "25-01-01 01:00"]), Some(DateOrder::Ymd));
        assert_eq!(of(&["24.03.25 10:00"]), Some(DateOrder::Dmy));
        assert_eq!(of(&["03/24/25 10:00"]), Some(DateOrder::Mdy));
        assert_eq!(of(&["24/03/99 10:00"]), Some(DateOrder::Dmy));
    }

    #[test]
    fn the_hour_that_comes_twice_goes_forward() {
        let zone = TimeZone::get("Europe/Berlin").unwrap();
        let civil: DateTime = "2025-10-26T02:30:00".parse().unwrap();
        let first = in_zone(civil, &zone, None).unwrap();
        assert_eq!(in_zone(civil, &zone, Some(first + 1799.0)), Some(first));
        assert_eq!(in_zone(civil, &zone, Some(first + 3000.0)), Some(first + 3600.0));
    }
}
