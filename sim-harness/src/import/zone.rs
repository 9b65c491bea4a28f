//! Zones that stand in headers and behind times, and numbers that count from another year than 1970.

use super::clock::{self, DateOrder};
use super::columns::Columns;
use super::meaning::Meaning;

/// Names of zones in headers. Only of UTC is it known in summer, too, what they mean.
const NAMES: [&str; 12] = ["UTC", "GMT", "CET", "CEST", "MEZ", "MESZ", "EET", "EEST", "OEZ", "WET", "WEST", "BST"];
/// So many first times have the same zone behind them where all of a file have.
const LOOKED: usize = 20;
/// No log of a train is of a later year, s since 1970: 2070.
const LATEST_S: f64 = 3.155_76e9;

/// The zone that a header names: of `UTC-Zeit` the part before it.
fn in_name(header: &str) -> Option<&str> {
    let is_part = |c: char| c.is_ascii_alphanumeric() || matches!(c, '+' | '-' | ':');
    header.split(|c| !is_part(c)).find_map(|word| {
        let at = word.find(['+', '-']).unwrap_or(word.len());
        let (name, east) = word.split_at(at);
        let is_name = NAMES.contains(&name) || matches!(name, "utc" | "gmt");
        let is_east = east.len() > 1 && east[1..].chars().all(|c| c.is_ascii_digit() || c == ':');
        is_name.then_some(if is_east { word } else { name })
    })
}

/// Which zone is believed of times that have none of their own.
pub fn believed(columns: &Columns) -> Option<String> {
    let named = [Meaning::Time, Meaning::Date].into_iter().find_map(|meaning| {
        let header = columns.header(meaning);
        in_name(header).map(|zone| (header, zone))
    });
    let is_utc = |zone: &str| ["UTC", "GMT"].iter().any(|name| zone.eq_ignore_ascii_case(name));
    match (&columns.zone_name, named) {
        (None, None) => {
            Some("times without a zone are taken for UTC; give zone in [[source]] where they are local".to_owned())
        }
        (None, Some((header, zone))) if is_utc(zone) => {
            Some(format!("times are taken for UTC, as column {header:?} says"))
        }
        (None, Some((header, zone))) => Some(format!(
            "times are taken for UTC, and not for {zone} of column {header:?}; give zone in [[source]], such as \"Europe/Berlin\""
        )),
        (Some(given), Some((header, zone))) if is_utc(zone) => {
            Some(format!("zone {given:?} of the mapping is believed, not {zone} of column {header:?}"))
        }
        (Some(_), _) => None,
    }
}

/// What is asked where a name of a zone stands behind times that can be read without it.
pub fn behind(texts: &[&String], order: DateOrder) -> Option<String> {
    let name_of = |text: &str| {
        let (time, name) = text.trim().rsplit_once(' ')?;
        let is_name = (2..=5).contains(&name.len()) && name.bytes().all(|byte| byte.is_ascii_uppercase());
        let is_read = clock::parse(text, order).is_some() || clock::parse(time, order).is_none();
        (is_name && !is_read).then(|| name.to_owned())
    };
    let first = texts.first()?;
    let name = name_of(first)?;
    texts.iter().take(LOOKED).all(|text| name_of(text).as_ref() == Some(&name)).then(|| {
        format!(
            "time: expected a zone as +01:00 or Z, or none, found {first:?}; write it so in the file, or leave out {name} and give zone in [[source]], such as \"Europe/Berlin\""
        )
    })
}

/// What is to be said of a number that is read as a time since 1970 and may count from another year.
pub fn other_epoch(header: &str, first_s: f64) -> Option<String> {
    let is_of_receiver = ["gps", "gnss"].iter().any(|name| header.to_ascii_lowercase().contains(name));
    let what = if is_of_receiver {
        "where it is GPS time, which counts from 1980-01-06 and knows no leap seconds, add 315964782 s"
    } else if first_s > LATEST_S {
        "where it counts from 1904, as LabVIEW does, subtract 2082844800 s"
    } else {
        return None;
    };
    let since = jiff::Timestamp::from_second(first_s as i64).ok()?;
    Some(format!("column {header:?} is taken for a time since 1970, {since} in the first row; {what}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_header_names_its_zone() {
        for (header, zone) in [
            ("Time (UTC)", Some("UTC")),
            ("time_utc", Some("utc")),
            ("Zeit [MEZ]", Some("MEZ")),
            ("time (UTC+1)", Some("UTC+1")),
            ("UTC-Zeit", Some("UTC")),
            ("GMT-Time", Some("GMT")),
            ("Time", None),
            ("Datum/Uhrzeit", None),
        ] {
            assert_eq!(in_name(header), zone, "{header}");
        }
    }
}
