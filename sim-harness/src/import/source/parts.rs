//! Times and dates whose parts stand in columns of their own: hour, minute, second; year, month, day. They are put
//! together into one more column.

use super::row::{Header, RowField};
use super::thousandths;
use crate::import::meaning::{Meaning, plain};

/// What each part is called, in the order in which they are written.
const TIME: [&str; 3] = [
    "hour|hours|hh|h|std|stunde|stunden|heure|heures|hora|horas|ora|ore",
    "minute|minutes|min|mm|minuten|minuto|minutos|minuti",
    "second|seconds|sec|ss|s|sek|sekunde|sekunden|seconde|secondes|segundo|segundos|secondo|secondi",
];
const DATE: [&str; 3] = ["year|yyyy|jahr|annee|ano|anno", "month|monat|mois|mes|mese", "day|dd|tag|jour|dia|giorno"];

/// Columns that are one, by their indices.
#[derive(Clone, Debug, PartialEq)]
pub struct Parts {
    of: Meaning,
    indices: [usize; 3],
    thousandths: Option<usize>,
}

/// Makes of parts a column each at the end of `headers`; none where a column has the whole.
pub fn join(headers: &mut Vec<Header>) -> Vec<Parts> {
    let parts = found(headers);
    for part in &parts {
        let written: Vec<String> = part.columns().map(|index| headers[index].written.clone()).collect();
        // A part is nothing else: `s` is no location, and `day` no date.
        part.columns().for_each(|index| headers[index].name.clear());
        headers.push(Header { written: written.join(":"), name: part.of.key().to_owned(), unit: None });
    }
    parts
}

/// Columns that are parts of one.
pub fn columns(headers: &[Header]) -> Vec<usize> {
    found(headers).iter().flat_map(|part| part.columns().collect::<Vec<_>>()).collect()
}

fn found(headers: &[Header]) -> Vec<Parts> {
    let all = [(Meaning::Time, TIME), (Meaning::Date, DATE)].into_iter();
    all.filter_map(|(of, names)| find(headers, of, names)).collect()
}

fn find(headers: &[Header], of: Meaning, names: [&str; 3]) -> Option<Parts> {
    let position = |names: &str| {
        let is_named = |header: &Header| {
            // A key in an object has the names of the objects before it.
            let last = header.written.rsplit('.').next().unwrap_or_default();
            let spelled = [header.written.as_str(), &header.name, last].map(plain);
            names.split('|').any(|name| spelled.iter().any(|spelled| name == spelled))
        };
        headers.iter().position(is_named)
    };
    let [first, second, third] = names.map(position);
    let indices = [first?, second?, third?];
    let thousandths = position(thousandths::NAMES).filter(|_| of == Meaning::Time);
    let others =
        headers.iter().enumerate().filter(|(index, _)| !indices.contains(index) && Some(*index) != thousandths);
    let others: Vec<String> = others.map(|(_, header)| header.name.clone()).collect();
    let is_there = Meaning::of_names(&others).iter().any(|(meaning, _)| *meaning == of);
    (!is_there).then_some(Parts { of, indices, thousandths })
}

impl Parts {
    fn columns(&self) -> impl Iterator<Item = usize> {
        self.indices.into_iter().chain(self.thousandths)
    }

    /// The field of the column that they make: `9:34:56.250`, `2025-1-31`; empty where a part is missing.
    pub fn field(&self, row: &[RowField]) -> RowField {
        let part = |index: usize| row.get(index)?.text();
        let [Some(first), Some(second), Some(third)] = self.indices.map(part) else { return RowField::Empty };
        let sign = if self.of == Meaning::Date { '-' } else { ':' };
        let behind = self.thousandths.and_then(part).map_or(String::new(), |thousandths| format!(":{thousandths}"));
        RowField::Text(format!("{first}{sign}{second}{sign}{third}{behind}"))
    }
}
