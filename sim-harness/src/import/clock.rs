//! Times of recorders as seconds since 1970, or since midnight, or on the recorder's own clock.

use super::number;
use jiff::civil::{Date, DateTime, Time};
use jiff::tz::TimeZone;
use serde::{Deserialize, Serialize};

/// How a column of times is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// A number that goes forward, from anywhere.
    Number,
    /// Seconds (or ms, us, ns) since 1970-01-01 UTC.
    Unix,
    /// Date and time, with or without a zone.
    DateTime,
    /// Time of the day; a date may stand in a column of its own.
    TimeOfDay,
}

/// Order of day, month and year.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Order {
    Ymd,
    Dmy,
    Mdy,
}

/// A time as it is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Written {
    /// A place in history, s since 1970-01-01 UTC.
    Instant(f64),
    /// A local date and time.
    Civil(DateTime),
    /// Seconds since midnight.
    OfDay(f64),
}

/// Reads a date and time, or a time of the day.
pub fn parse(text: &str, order: Order) -> Option<Written> {
    let text = text.trim();
    if let Ok(instant) = text.parse::<jiff::Timestamp>() {
        return Some(Written::Instant(instant.as_nanosecond() as f64 / 1e9));
    }
    match split(text) {
        (Some(date), Some(time)) => {
            let of_day = of_day(time)?;
            let nanoseconds = (of_day.fract() * 1e9).round() as i64;
            let midnight = parse_date(date, order)?.to_datetime(Time::midnight());
            let moved = midnight.checked_add(jiff::SignedDuration::new(of_day as i64, nanoseconds as i32)).ok()?;
            Some(Written::Civil(moved))
        }
        (Some(date), None) => Some(Written::Civil(parse_date(date, order)?.to_datetime(Time::midnight()))),
        (None, Some(time)) => of_day(time).map(Written::OfDay),
        (None, None) => None,
    }
}

/// Date and time of a text, as far as there are any.
fn split(text: &str) -> (Option<&str>, Option<&str>) {
    let Some(colon) = text.find(':') else {
        return (Some(text).filter(|text| !text.is_empty()), None);
    };
    match text[..colon].rfind([' ', 'T', 't', '_', ';', ',']) {
        Some(at) => (Some(text[..at].trim_end_matches([',', ' '])), Some(text[at + 1..].trim())),
        None => (None, Some(text)),
    }
}

/// Three numbers of a date as they stand.
fn numbers(date: &str) -> Option<[i32; 3]> {
    let mut parts = date.split(['.', '/', '-', ' ']).filter(|part| !part.is_empty());
    let mut next = || parts.next()?.parse::<i32>().ok().filter(|number| (0..=9999).contains(number));
    let found = [next()?, next()?, next()?];
    parts.next().is_none().then_some(found)
}

pub fn parse_date(date: &str, order: Order) -> Option<Date> {
    let [a, b, c] = match numbers(date) {
        Some(found) => found,
        // 20250131
        None if date.len() == 8 && date.bytes().all(|byte| byte.is_ascii_digit()) => {
            [date[..4].parse().ok()?, date[4..6].parse().ok()?, date[6..].parse().ok()?]
        }
        None => return None,
    };
    let (year, month, day) = match order {
        Order::Ymd => (a, b, c),
        Order::Dmy => (c, b, a),
        Order::Mdy => (c, a, b),
    };
    let year = if year < 100 { year + if year < 70 { 2000 } else { 1900 } } else { year };
    Date::new(year.try_into().ok()?, month.try_into().ok()?, day.try_into().ok()?).ok()
}

/// `hh:mm`, `hh:mm:ss`, `hh:mm:ss,123`, `hh:mm:ss:123`, with `am` or `pm`: seconds since midnight.
fn of_day(time: &str) -> Option<f64> {
    let small = time.trim().to_ascii_lowercase();
    let (time, half) = match small.strip_suffix("am").or_else(|| small.strip_suffix("a.m.")) {
        Some(time) => (time, Some(0.0)),
        None => match small.strip_suffix("pm").or_else(|| small.strip_suffix("p.m.")) {
            Some(time) => (time, Some(12.0)),
            None => (small.as_str(), None),
        },
    };
    let parts: Vec<&str> = time.trim().split(':').collect();
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
    dots: usize,
    first_above_12: usize,
    second_above_12: usize,
}

impl Orders {
    pub fn see(&mut self, text: &str) {
        let date = split(text.trim()).0.unwrap_or_default();
        let Some([a, b, _]) = numbers(date) else {
            self.year_first += usize::from(parse_date(date, Order::Ymd).is_some());
            return;
        };
        self.seen += 1;
        self.year_first += usize::from(a > 31);
        self.dots += usize::from(date.contains('.'));
        self.first_above_12 += usize::from(a > 12);
        self.second_above_12 += usize::from(b > 12);
    }

    /// The order, where there is no doubt. Dots between the numbers are of countries that write the day first.
    pub fn decided(&self) -> Option<Order> {
        if self.seen == 0 || self.year_first > 0 {
            return Some(Order::Ymd);
        }
        match (self.first_above_12 > 0, self.second_above_12 > 0) {
            (true, false) => Some(Order::Dmy),
            (false, true) => Some(Order::Mdy),
            (false, false) if self.dots > 0 => Some(Order::Dmy),
            _ => None,
        }
    }
}

/// A local time in a zone, s since 1970-01-01 UTC. An hour that the clocks are set back over is its first; `from_before` keeps it going forward.
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

    fn seconds(text: &str, order: Order) -> Option<f64> {
        match parse(text, order)? {
            Written::Instant(seconds) | Written::OfDay(seconds) => Some(seconds),
            Written::Civil(civil) => in_zone(civil, &TimeZone::UTC, None),
        }
    }

    #[test]
    fn times_are_read_in_their_orders() {
        let expected = Some(1_738_319_696.5);
        for (text, order) in [
            ("2025-01-31T10:34:56.5Z", Order::Ymd),
            ("2025-01-31T11:34:56.5+01:00", Order::Ymd),
            ("2025-01-31 10:34:56,5", Order::Ymd),
            ("31.01.2025 10:34:56.5", Order::Dmy),
            ("01/31/2025 10:34:56.5 AM", Order::Mdy),
            ("20250131 10:34:56:500", Order::Ymd),
        ] {
            assert_eq!(seconds(text, order), expected, "{text}");
        }
        assert_eq!(seconds("12:00:01 am", Order::Ymd), Some(1.0));
        for text in ["", ":", "31.13.2025 10:00", "10:61", "abc", "2025-02-30 10:00:00", "9999999999:00"] {
            assert_eq!(seconds(text, Order::Dmy), None, "{text}");
        }
    }

    #[test]
    fn an_order_is_decided_only_without_doubt() {
        let of = |texts: &[&str]| {
            let mut orders = Orders::default();
            texts.iter().for_each(|text| orders.see(text));
            orders.decided()
        };
        assert_eq!(of(&["03/04/2025 10:00", "03/04/2025 10:01"]), None);
        assert_eq!(of(&["03/14/2025 10:00"]), Some(Order::Mdy));
        assert_eq!(of(&["14/03/2025 10:00"]), Some(Order::Dmy));
        assert_eq!(of(&["03.04.2025 10:00"]), Some(Order::Dmy));
        assert_eq!(of(&["2025-03-04 10:00"]), Some(Order::Ymd));
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
