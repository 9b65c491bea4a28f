//! Times of whole seconds whose thousandths stand in a column of their own.
//!
//! Such a column may also hold how long something took. It is a part of the time where steps from row to row are more
//! even with it than without.

use super::row::{Header, RowField};
use crate::import::meaning::{Meaning, plain};
use rundown_files::statistics::{mean_of, squares_about};

/// What the column is called.
pub const NAMES: &str =
    "millisecond|milliseconds|millis|msec|ms|millisekunde|millisekunden|milliseconde|milisegundo|millisecondo";

/// The two columns, by their indices.
#[derive(Clone, Copy, Debug)]
pub struct Thousandths {
    time: usize,
    pub column: usize,
}

impl Thousandths {
    pub fn find(headers: &[Header]) -> Option<Self> {
        let is_named = |header: &Header| NAMES.split('|').any(|name| name == plain(&header.written));
        let column = headers.iter().position(is_named)?;
        let names: Vec<String> = headers.iter().map(|header| header.name.clone()).collect();
        let (_, time) = Meaning::of_names(&names).into_iter().find(|(meaning, _)| *meaning == Meaning::Time)?;
        (time != column && headers[time].unit.is_none()).then_some(Self { time, column })
    }

    /// Second of the day, and thousandths, of a row.
    pub fn seconds(&self, row: &[RowField]) -> Option<[f64; 2]> {
        let RowField::Text(time) = row.get(self.time)? else { return None };
        let clock = time.split([' ', 'T']).find(|part| part.contains(':'))?;
        let mut parts = clock.split(|c: char| !c.is_ascii_digit()).map(str::parse::<f64>);
        let [hour, minute, second] = [parts.next()?.ok()?, parts.next()?.ok()?, parts.next()?.ok()?];
        Some([3600.0 * hour + 60.0 * minute + second, f64::from(number(row.get(self.column)?)?)])
    }

    /// These rows have more even steps with the thousandths.
    pub fn are_part(seen: &[[f64; 2]]) -> bool {
        let unevenness = |share: f64| {
            let at = |row: &[f64; 2]| row[0] + share * 1e-3 * row[1];
            let steps: Vec<f64> = seen.windows(2).map(|pair| at(&pair[1]) - at(&pair[0])).collect();
            squares_about(mean_of(&steps), &steps)
        };
        seen.len() > 1 && unevenness(1.0) <= unevenness(0.0)
    }

    /// Puts them into the time: `10:00:00` and `250` are `10:00:00.250`. One that has its fraction, or no seconds,
    /// stays as it is.
    pub fn put_in(&self, row: &mut [RowField]) {
        let Some(thousandths) = row.get(self.column).and_then(number) else { return };
        let Some(RowField::Text(time)) = row.get_mut(self.time) else { return };
        let Some((colon, _)) = time.match_indices(':').nth(1) else { return };
        let seconds = &time[colon + 1..];
        let digits = seconds.find(|c: char| !c.is_ascii_digit()).unwrap_or(seconds.len());
        let has_fraction = seconds[digits..].starts_with(['.', ',', ':'])
            && seconds[digits + 1..].starts_with(|c: char| c.is_ascii_digit());
        if digits > 0 && !has_fraction {
            time.insert_str(colon + 1 + digits, &format!(".{thousandths:03}"));
        }
    }
}

fn number(field: &RowField) -> Option<u32> {
    let number = match field {
        RowField::Number(number) => *number,
        RowField::Text(text) => text.trim().parse().ok()?,
        RowField::Empty => return None,
    };
    (number.fract() == 0.0 && (0.0..1000.0).contains(&number)).then_some(number as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(time: &str, thousandths: f64) -> Vec<RowField> {
        vec![RowField::Text(time.to_owned()), RowField::Number(thousandths)]
    }

    #[test]
    fn thousandths_stand_behind_the_seconds() {
        let columns = Thousandths::find(&["Zeit", "ms"].map(Header::new)).unwrap();
        for (time, whole) in [
            ("31.01.2025 10:00:07", "31.01.2025 10:00:07.040"),
            ("2025-01-31T10:00:07Z", "2025-01-31T10:00:07.040Z"),
            ("1:00:07 PM", "1:00:07.040 PM"),
            ("10:00:07.5", "10:00:07.5"),
            ("2025-01-31T10:00:07+01:00", "2025-01-31T10:00:07.040+01:00"),
            ("1:00:07 p.m.", "1:00:07.040 p.m."),
            ("10:00", "10:00"),
        ] {
            let mut row = row(time, 40.0);
            columns.put_in(&mut row);
            assert_eq!(row[0], RowField::Text(whole.to_owned()));
        }
    }

    #[test]
    fn how_long_something_took_is_no_part_of_the_time() {
        let columns = Thousandths::find(&["Zeit", "ms"].map(Header::new)).unwrap();
        let are_part = |of: &dyn Fn(usize) -> (usize, f64)| {
            let seen = (0..100).map(of).filter_map(|(second, ms)| {
                columns.seconds(&row(&format!("10:{:02}:{:02}", second / 60, second % 60), ms))
            });
            Thousandths::are_part(&seen.collect::<Vec<_>>())
        };
        assert!(are_part(&|i| (i / 5, 200.0 * (i % 5) as f64)));
        assert!(are_part(&|i| (i + i / 50, (20 * i % 1000) as f64)));
        assert!(!are_part(&|i| (i, (37 * i % 90) as f64)));
        assert!(!are_part(&|i| (i / 5, (370 * i % 990) as f64)));
    }
}
