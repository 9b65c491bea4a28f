//! Tables that have one signal in each row: time, signal, value. The rows of one time become one row, with a column for
//! each signal.

use super::parts;
use super::row::{Each, Event, Header, Layout, RowField};
use crate::import::meaning::{Meaning, plain};
use crate::import::units;
use std::collections::{HashMap, VecDeque};

/// What the columns of such a table are called.
const SIGNAL: &str = "signal|signal name|signalname|signal id|tag|tag name|tagname|tag id|variable|variable name|parameter|\
                      parameter name|channel|channel name|kanal|kanalname|sensor|sensor name|measurement|metric|point|name|\
                      key|item|field|messgrosse|messgroesse|grosse|groesse|messstelle|bezeichnung|mesure|grandeur|parametre|\
                      variable nom|voie|nom|senal|nombre|canal|magnitud|segnale|canale|grandezza|nome";
const VALUE: &str =
    "value|val|wert|messwert|valeur|valor|valore|reading|signal value|tag value|waarde|hodnota|wartosc|varde";
const UNIT: &str =
    "unit|units|uom|unit of measure|engineering unit|dimension|einheit|unite|unidad|unita|eenheid|jednotka";

/// So many times may be open at once: a recorder that writes one signal after the other does so for a day or less.
const OPEN: usize = 100_000;
/// More are no names of signals.
const MOST_SIGNALS: usize = 2_000;

/// How the rows of such a table become rows of all signals.
#[derive(Clone, Debug)]
pub struct Signals {
    signal: usize,
    value: usize,
    unit: Option<usize>,
    /// Columns that rows of one time share.
    shared: Vec<usize>,
    /// Of each signal its index among the signals.
    index: HashMap<String, usize>,
    /// Of each signal its unit, where a column has it, and whether its name is known.
    units: Vec<(Option<String>, bool)>,
    /// One signal begins where another one has ended: nothing is complete before the end.
    are_blocks: bool,
}

/// How many names of a row are those of signal and value, where both are there.
pub fn known_in(row: &[String]) -> usize {
    let is_there = |names: &str| row.iter().any(|text| names.split('|').any(|name| name == plain(text)));
    if is_there(SIGNAL) && is_there(VALUE) { 2 } else { 0 }
}

/// The columns of a table with one signal in each row.
pub struct SignalColumns {
    signal: usize,
    value: usize,
    unit: Option<usize>,
    shared: Vec<usize>,
}

impl SignalColumns {
    /// By what the layout says, else by their names. None where a column has a speed or a place of its own. `named` are
    /// columns of the mapping.
    pub fn find(headers: &[Header], layout: &Layout, named: &[String]) -> Option<Self> {
        let of = |stated: Option<&String>, names: &str| {
            let is_named = |header: &Header| match stated {
                Some(stated) => stated.trim() == header.written,
                None => names.split('|').any(|name| name == plain(&header.written)),
            };
            headers.iter().position(is_named)
        };
        let (signal, value) = (of(layout.signal.as_ref(), SIGNAL)?, of(layout.value.as_ref(), VALUE)?);
        let names: Vec<String> = headers.iter().map(|header| header.name.clone()).collect();
        let meanings = Meaning::of_names(&names);
        let is_wide = |meaning: Meaning| matches!(meaning, Meaning::Location | Meaning::Speed | Meaning::Latitude);
        if layout.signal.is_none() && meanings.iter().any(|(meaning, _)| is_wide(*meaning)) {
            return None;
        }
        let splits = |meaning: Meaning| matches!(meaning, Meaning::Time | Meaning::Date | Meaning::Run | Meaning::Unit);
        let is_shared = |index: &usize| {
            let header = &headers[*index];
            meanings.iter().any(|(meaning, at)| at == index && splits(*meaning))
                || named.iter().any(|name| name.trim() == header.written)
                || parts::is_part(header)
        };
        let others = (0..headers.len()).filter(|index| ![signal, value].contains(index));
        let shared = others.filter(is_shared).collect();
        Some(Self { signal, value, unit: of(None, UNIT), shared })
    }

    /// Of signal and value.
    pub fn names(&self, headers: &[Header]) -> [String; 2] {
        [self.signal, self.value].map(|index| headers[index].written.clone())
    }

    /// How the table is read, and its columns then. `rows` gives those of the file. None where no column is one of
    /// signals after all.
    pub fn read<E>(
        mut self,
        headers: &[Header],
        rows: impl FnOnce(&mut Each) -> Result<(), E>,
    ) -> Result<Option<(Signals, Vec<Header>)>, E> {
        let mut signals: Vec<SeenSignal> = Vec::new();
        let mut index: HashMap<String, usize> = HashMap::new();
        let (mut number, mut is_measured) = (0_usize, false);
        rows(&mut |event| {
            if let Event::Row(_, row) = event
                && let Some(name) = text(row.get(self.signal))
            {
                let unit = self.unit.and_then(|unit| text(row.get(unit)));
                // A unit may be a vehicle, too.
                is_measured |= unit.as_deref().is_some_and(|unit| units::by_name(Meaning::Speed, unit).is_some());
                let at = *index.entry(name.clone()).or_insert_with(|| {
                    signals.push(SeenSignal { name, unit: None, first: number, last: number });
                    signals.len() - 1
                });
                let signal = &mut signals[at];
                signal.last = number;
                signal.unit = signal.unit.take().or(unit);
                number += 1;
            }
            signals.len() <= MOST_SIGNALS
        })?;
        self.unit = self.unit.filter(|_| is_measured);
        self.shared.retain(|shared| Some(*shared) != self.unit);
        if signals.len() < 2 || signals.len() > MOST_SIGNALS {
            return Ok(None);
        }
        let many = signals.iter().filter(|signal| signal.first < signal.last);
        let first_end = many.clone().map(|signal| signal.last).min();
        let are_blocks = many.map(|signal| signal.first).max() > first_end;
        let column = |signal: &SeenSignal| {
            let mut header = Header::new(&signal.name);
            header.unit = header.unit.take().or_else(|| signal.unit.clone().filter(|_| self.unit.is_some()));
            header
        };
        let columns: Vec<Header> = signals.iter().map(column).collect();
        let units = columns.iter().zip(&signals).map(|(header, signal)| {
            let is_known = !Meaning::of_names(std::slice::from_ref(&header.name)).is_empty();
            (signal.unit.clone().filter(|_| self.unit.is_some()), is_known)
        });
        let units = units.collect();
        let Self { signal, value, unit, shared } = self;
        let headers = shared.iter().map(|shared| headers[*shared].clone()).chain(columns).collect();
        Ok(Some((Signals { signal, value, unit, shared, index, units, are_blocks }, headers)))
    }
}

/// A signal of the file: its unit where it begins, and the first and last of its rows.
struct SeenSignal {
    name: String,
    unit: Option<String>,
    first: usize,
    last: usize,
}

fn text(field: Option<&RowField>) -> Option<String> {
    match field? {
        RowField::Empty => None,
        RowField::Text(text) => Some(text.trim().to_owned()).filter(|text| !text.is_empty()),
        RowField::Number(number) => Some(number.to_string()),
    }
}

/// Rows of which not all signals are there yet, in the order in which they begin.
#[derive(Default)]
struct OpenRows {
    rows: VecDeque<(u64, Vec<RowField>)>,
    /// Of what rows share, the number of the row; the first one that is open has the number `gone`.
    at: HashMap<String, usize>,
    gone: usize,
}

impl Signals {
    /// How many there are.
    pub fn count(&self) -> usize {
        self.units.len()
    }

    /// Gives `each` the rows of all signals that the rows of the file, `rows`, make.
    ///
    /// # Errors
    /// Those of `rows`.
    pub fn rows<E>(&self, each: &mut Each, rows: impl FnOnce(&mut Each) -> Result<(), E>) -> Result<(), E> {
        let mut open = OpenRows::default();
        let mut goes_on = true;
        rows(&mut |event| {
            goes_on = match event {
                Event::Row(line, row) => self.take(line, row, &mut open, each),
                Event::Sheet(name) => open.close(0, each) && each(Event::Sheet(name)),
                // How many fields a row should have is no matter of the columns that come out.
                Event::Ragged(..) => true,
                bad @ Event::Bad(..) => each(bad),
            };
            goes_on
        })?;
        if goes_on {
            open.close(0, each);
        }
        Ok(())
    }

    fn take(&self, line: u64, row: &[RowField], open: &mut OpenRows, each: &mut Each) -> bool {
        let Some(name) = text(row.get(self.signal)) else {
            return each(Event::Bad(line, "expected the name of a signal, found none".to_owned()));
        };
        let (Some(index), Some(value)) = (self.index.get(&name), row.get(self.value)) else { return true };
        let (of_signal, is_known) = &self.units[*index];
        let unit = self.unit.and_then(|unit| text(row.get(unit)));
        if *is_known && unit.is_some() && unit != *of_signal {
            let [expected, found] = [of_signal, &unit].map(|unit| unit.as_deref().unwrap_or_default());
            return each(Event::Bad(line, format!("expected {name} in {expected:?} as before, found {found:?}")));
        }
        let shared: Vec<RowField> =
            self.shared.iter().map(|shared| row.get(*shared).cloned().unwrap_or(RowField::Empty)).collect();
        let columns = shared.len() + self.units.len();
        let field = &mut open.row(line, shared, columns)[self.shared.len() + index];
        if *field == RowField::Empty {
            *field = value.clone();
        } else if field != value && *is_known {
            let [first, second] = [&*field, value].map(|field| text(Some(field)).unwrap_or_default());
            return each(Event::Bad(
                line,
                format!("expected one value of {name} at a time, found {first} and {second}"),
            ));
        }
        self.are_blocks || open.close(OPEN, each)
    }
}

impl OpenRows {
    /// The row that shares this with others, begun here if there is none.
    fn row(&mut self, line: u64, shared: Vec<RowField>, columns: usize) -> &mut Vec<RowField> {
        let key = shared.iter().map(|field| text(Some(field)).unwrap_or_default()).collect::<Vec<_>>().join("\u{1f}");
        let next = self.gone + self.rows.len();
        let at = *self.at.entry(key).or_insert(next);
        if at == next {
            let mut row = shared;
            row.resize(columns, RowField::Empty);
            self.rows.push_back((line, row));
        }
        &mut self.rows[at - self.gone].1
    }

    /// Gives the oldest rows to `each`, until so many are left.
    fn close(&mut self, left: usize, each: &mut Each) -> bool {
        // Not one by one: looking for those that are gone takes as long for one as for many.
        if self.rows.len() <= 2 * left {
            return true;
        }
        let leaving = self.rows.len() - left;
        self.gone += leaving;
        self.at.retain(|_, at| *at >= self.gone);
        self.rows.drain(..leaving).all(|(line, row)| each(Event::Row(line, &row)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rows that come out of these, and whether some came before the last one went in.
    fn joined(rows: &[(&str, usize)]) -> (Vec<Vec<RowField>>, bool) {
        let headers = ["t", "signal", "value"].map(Header::new);
        let field = |name: &str, time: usize| {
            [RowField::Number(time as f64), RowField::Text(name.to_owned()), RowField::Number(time as f64)]
        };
        let went_in = std::cell::Cell::new(0);
        let give = |each: &mut Each| -> Result<(), ()> {
            for (line, (name, time)) in (2..).zip(rows) {
                went_in.set(line - 2);
                if !each(Event::Row(line, &field(name, *time))) {
                    break;
                }
            }
            Ok(())
        };
        let columns = SignalColumns::find(&headers, &Layout::default(), &[]).unwrap();
        let (signals, headers) = columns.read(&headers, give).unwrap().unwrap();
        assert_eq!(headers.len(), 3);
        let (mut out, mut is_early) = (Vec::new(), false);
        let mut each = |event: Event| {
            if let Event::Row(_, row) = event {
                out.push(row.to_vec());
                is_early |= went_in.get() + 1 < rows.len() as u64;
            }
            true
        };
        signals.rows(&mut each, give).unwrap();
        (out, is_early)
    }

    #[test]
    fn long_tables_are_streamed_unless_one_signal_ends_before_another_begins() {
        let times = 2 * OPEN + 10;
        let both = (0..times).flat_map(|time| [("speed", time), ("location", time)]);
        let (rows, is_early) = joined(&both.collect::<Vec<_>>());
        assert!(is_early && rows.len() == times);
        let blocks = ["speed", "location"].iter().flat_map(|name| (0..times).map(move |time| (*name, time)));
        let (in_blocks, is_early) = joined(&blocks.collect::<Vec<_>>());
        assert!(!is_early && in_blocks == rows);
        assert!(rows.iter().enumerate().all(|(time, row)| *row == vec![RowField::Number(time as f64); 3]));
    }
}
