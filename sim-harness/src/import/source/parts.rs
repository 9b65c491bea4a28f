//! Times and dates whose parts stand in columns of their own: hour, minute, second; year, month, day. They are put
//! together into one more column.

use super::row::{Header, RowField};
use crate::import::meaning::{Meaning, plain};

/// What each part is called, in the order in which they are written.
const TIME: [&str; 3] = [
    "hour|hours|hh|h|std|stunde|stunden|heure|heures|hora|horas|ora|ore",
    "minute|minutes|min|mm|minuten|minuto|minutos|minuti",
    "second|seconds|sec|ss|s|sek|sekunde|sekunden|seconde|secondes|segundo|segundos|secondo|secondi",
];
const DATE: [&str; 3] = ["year|yyyy|jahr|annee|ano|anno", "month|monat|mois|mes|mese", "day|dd|tag|jour|dia|giorno"];
/// Beside hour, minute and second.
const THOUSANDTHS: &str =
    "millisecond|milliseconds|millis|msec|ms|millisekunde|millisekunden|milliseconde|milisegundo|millisecondo";

/// Columns that are one, by their indices.
#[derive(Clone, Debug, PartialEq)]
pub struct Parts {
    of: Meaning,
    /// Hour, minute and second, year, month and day, or a time of whole seconds.
    indices: Vec<usize>,
    thousandths: Option<usize>,
}

/// Makes of parts a column each at the end of `headers`; none where a column has the whole.
pub fn join(headers: &mut Vec<Header>) -> Vec<Parts> {
    let found =
        [(Meaning::Time, TIME), (Meaning::Date, DATE)].into_iter().filter_map(|(of, names)| find(headers, of, names));
    let parts: Vec<Parts> = found.collect();
    for part in &parts {
        let written: Vec<String> = part.columns().map(|index| headers[index].written.clone()).collect();
        // A part is nothing else: `s` is no location, and `day` no date.
        part.columns().for_each(|index| headers[index].name.clear());
        headers.push(Header { written: written.join(":"), name: part.of.key().to_owned(), unit: None });
    }
    parts
}

/// A name of a part.
pub fn is_part(header: &Header) -> bool {
    let mut names = TIME.iter().chain(&DATE).chain([&THOUSANDTHS]).flat_map(|names| names.split('|'));
    names.any(|name| name == plain(&header.written))
}

fn find(headers: &[Header], of: Meaning, names: [&str; 3]) -> Option<Parts> {
    let position = |names: &str| {
        let is_named = |header: &Header| {
            names.split('|').any(|name| name == plain(&header.written) || name == plain(&header.name))
        };
        headers.iter().position(is_named)
    };
    let [first, second, third] = names.map(position);
    let thousandths = position(THOUSANDTHS).filter(|_| of == Meaning::Time);
    let [Some(first), Some(second), Some(third)] = [first, second, third] else {
        return whole_beside(headers, of, thousandths?);
    };
    let indices = vec![first, second, third];
    let others =
        headers.iter().enumerate().filter(|(index, _)| !indices.contains(index) && Some(*index) != thousandths);
    let others: Vec<String> = others.map(|(_, header)| header.name.clone()).collect();
    let is_there = Meaning::of_names(&others).iter().any(|(meaning, _)| *meaning == of);
    (!is_there).then_some(Parts { of, indices, thousandths })
}

/// A whole time whose thousandths stand in a column of their own.
fn whole_beside(headers: &[Header], of: Meaning, thousandths: usize) -> Option<Parts> {
    let names: Vec<String> = headers.iter().map(|header| header.name.clone()).collect();
    let (_, time) = Meaning::of_names(&names).into_iter().find(|(meaning, _)| *meaning == of)?;
    let is_number = headers[time].unit.is_some();
    (time != thousandths && !is_number).then(|| Parts { of, indices: vec![time], thousandths: Some(thousandths) })
}

impl Parts {
    fn columns(&self) -> impl Iterator<Item = usize> {
        self.indices.iter().copied().chain(self.thousandths)
    }

    /// The field of the column that they make: `9:34:56.250`, `2025-1-31`; empty where a part is missing.
    pub fn field(&self, row: &[RowField]) -> RowField {
        let part = |index: usize| match row.get(index)? {
            RowField::Number(number) => Some(number.to_string()),
            RowField::Text(text) => Some(text.trim().to_owned()),
            RowField::Empty => None,
        };
        if let [time] = self.indices[..] {
            let field = row.get(time).cloned().unwrap_or(RowField::Empty);
            return self
                .thousandths
                .and_then(part)
                .map_or(field.clone(), |thousandths| with_thousandths(field, &thousandths));
        }
        let [Some(first), Some(second), Some(third)] = [0, 1, 2].map(|at| part(*self.indices.get(at)?)) else {
            return RowField::Empty;
        };
        let sign = if self.of == Meaning::Date { '-' } else { ':' };
        let behind = self.thousandths.and_then(part).map_or(String::new(), |thousandths| format!(":{thousandths}"));
        RowField::Text(format!("{first}{sign}{second}{sign}{third}{behind}"))
    }
}

/// `10:00:00` and `250` are `10:00:00.250`; a time that has its fraction, no seconds or an offset stays as it is.
fn with_thousandths(field: RowField, thousandths: &str) -> RowField {
    let RowField::Text(time) = &field else { return field };
    let Some(number) = thousandths.parse::<u32>().ok().filter(|number| *number < 1000) else { return field };
    let end = time.rfind(|c: char| c.is_ascii_digit()).map_or(0, |last| last + 1);
    let colons = time.matches(':').count();
    let is_whole = colons == 2 && !time.contains(['.', ',', '+']);
    if is_whole { RowField::Text(format!("{}.{number:03}{}", &time[..end], &time[end..])) } else { field }
}
