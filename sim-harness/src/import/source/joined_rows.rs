//! Rows of one signal each as rows of all: those of one time become one.

use super::quality::CALLED_BAD;
use super::row::{Each, Event, RowField};
use super::signals::{ReadSignal, Signals, key};
use std::collections::{HashMap, VecDeque};

/// So many times may be open at once: a recorder that writes one signal after the other does so for a day or less.
const OPEN: usize = 100_000;

const BESIDE: &str = "values beside another one of the same signal and time, left out";

/// Rows of which not all signals are there yet, in the order in which they begin.
struct OpenRows<'a> {
    signals: &'a Signals,
    rows: VecDeque<(u64, Vec<RowField>)>,
    /// Of what rows share, their numbers: an hour of the clock may come twice. The first that is open has the number
    /// `gone`.
    at: HashMap<String, Vec<usize>>,
    gone: usize,
    /// The row in which each signal was last.
    last: Vec<usize>,
    /// Names that hold, by vehicle.
    held: HashMap<(usize, String), RowField>,
}

/// Gives `each` the rows of all signals that the rows of the file, `rows`, make.
///
/// # Errors
/// Those of `rows`.
pub fn join<E>(signals: &Signals, each: &mut Each, rows: impl FnOnce(&mut Each) -> Result<(), E>) -> Result<(), E> {
    let mut open = OpenRows::new(signals);
    let mut goes_on = true;
    rows(&mut |event| {
        goes_on = match event {
            Event::Row(line, row) => open.take(line, row, each),
            // One signal may have a sheet of its own.
            Event::Sheet(_) if signals.are_blocks => true,
            Event::Sheet(name) => open.close(0, each) && each(Event::Sheet(name)),
            // How many fields a row should have is no matter of the columns that come out.
            Event::Ragged(..) => true,
            lost @ (Event::Bad(..) | Event::LeftOut(..)) => each(lost),
        };
        goes_on
    })?;
    if goes_on {
        open.close(0, each);
    }
    Ok(())
}

impl<'a> OpenRows<'a> {
    fn new(signals: &'a Signals) -> Self {
        let last = vec![usize::MAX; signals.read.len()];
        Self { signals, rows: VecDeque::new(), at: HashMap::new(), gone: 0, last, held: HashMap::new() }
    }

    /// Takes a row of the file; false: no more of them.
    fn take(&mut self, line: u64, row: &[RowField], each: &mut Each) -> bool {
        let signals = self.signals;
        let Some(name) = row.get(signals.columns.signal).and_then(RowField::text) else {
            return each(Event::Bad(line, "expected the name of a signal, found none".to_owned()));
        };
        let value = row.get(signals.columns.value);
        let (Some(index), Some(value)) = (signals.index.get(&name).copied(), value) else { return true };
        let ReadSignal { unit: expected, is_known, .. } = &signals.read[index];
        let called_bad = || signals.columns.quality.as_ref()?.called_bad(row);
        if *is_known && let Some(quality) = called_bad() {
            return each(Event::LeftOut(line, CALLED_BAD, format!("expected a good value of {name}, found {quality}")));
        }
        // Another unit than that of the header stands behind the value.
        let value = match signals.columns.unit.and_then(|unit| row.get(unit)?.text()) {
            Some(unit) if Some(&unit) != expected.as_ref() && *value != RowField::Empty => {
                value.text().map_or(RowField::Empty, |value| RowField::Text(format!("{value} {unit}")))
            }
            _ => value.clone(),
        };
        let field = &mut self.row(line, row, index)[signals.shared.len() + index];
        if *field == RowField::Empty {
            *field = value;
        } else if *field != value && value != RowField::Empty && *is_known {
            let [first, second] = [&*field, &value].map(|field| field.text().unwrap_or_default());
            let message = format!("expected one value of {name} at a time, found {first} and {second}");
            return each(Event::LeftOut(line, BESIDE, message));
        }
        signals.are_blocks || self.close(OPEN, each)
    }

    /// The row for this one of a signal: of those that share its time the first without the signal, else the one in
    /// which it was last, else a new one.
    fn row(&mut self, line: u64, row: &[RowField], index: usize) -> &mut Vec<RowField> {
        let Signals { shared, read, .. } = self.signals;
        let numbers = self.at.entry(key(shared, row)).or_default();
        let (gone, rows) = (self.gone, &self.rows);
        let is_free = |number: &&usize| rows[**number - gone].1[shared.len() + index] == RowField::Empty;
        let found = numbers.iter().find(is_free).copied();
        let last = numbers.last().copied().filter(|number| *number == self.last[index]);
        let number = found.or(last).unwrap_or_else(|| {
            let mut fields: Vec<RowField> =
                shared.iter().map(|shared| row.get(*shared).cloned().unwrap_or(RowField::Empty)).collect();
            fields.resize(shared.len() + read.len(), RowField::Empty);
            self.rows.push_back((line, fields));
            let number = gone + self.rows.len() - 1;
            numbers.push(number);
            number
        });
        self.last[index] = number;
        &mut self.rows[number - gone].1
    }

    /// Gives the oldest rows to `each`, until so many are left.
    fn close(&mut self, left: usize, each: &mut Each) -> bool {
        // Not one by one: looking for those that are gone takes as long for one as for many.
        if self.rows.len() <= 2 * left {
            return true;
        }
        let leaving = self.rows.len() - left;
        self.gone += leaving;
        let gone = self.gone;
        self.at.retain(|_, numbers| {
            numbers.retain(|number| *number >= gone);
            !numbers.is_empty()
        });
        for _ in 0..leaving {
            let Some((line, mut row)) = self.rows.pop_front() else { break };
            self.hold(&mut row);
            if !each(Event::Row(line, &row)) {
                return false;
            }
        }
        true
    }

    /// Fills in the names that hold in this row. Before the first of them that one holds, unless vehicles take turns.
    fn hold(&mut self, row: &mut [RowField]) {
        let Signals { shared, vehicle, read, .. } = self.signals;
        let vehicle = vehicle.and_then(|at| row.get(at)?.text());
        let held = read.iter().enumerate().filter(|(_, signal)| signal.is_held);
        for (index, signal) in held {
            let key = (index, vehicle.clone().unwrap_or_default());
            let field = &mut row[shared.len() + index];
            if *field != RowField::Empty {
                self.held.insert(key, field.clone());
            } else if let Some(held) = self.held.get(&key) {
                *field = held.clone();
            } else if vehicle.is_none() {
                *field = signal.first.clone();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::source::row::{Header, Layout};
    use crate::import::source::signals::SignalColumns;

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
        let columns = SignalColumns::find(&headers, &Layout::default()).unwrap();
        let (signals, headers) = columns.read(&headers, &[], false, give).unwrap().unwrap();
        assert!(headers.len() >= 3);
        let (mut out, mut is_early) = (Vec::new(), false);
        let mut each = |event: Event| {
            if let Event::Row(_, row) = event {
                out.push(row.to_vec());
                is_early |= went_in.get() + 1 < rows.len() as u64;
            }
            true
        };
        join(&signals, &mut each, give).unwrap();
        (out, is_early)
    }

    #[test]
    fn long_tables_are_streamed_unless_one_signal_ends_before_another_begins() {
        let times = 2 * OPEN + 10;
        let both = (0..times).flat_map(|time| [("speed", time), ("location", time)]);
        let both: Vec<_> = both.collect();
        let (rows, is_early) = joined(&both);
        assert!(is_early && rows.len() == times);
        // Others that are there at one end only do not matter.
        let others = |name| [(name, 1), (name, 2)];
        let (_, is_early) = joined(&[&others("version")[..], &both, &others("fault")].concat());
        assert!(is_early);
        let blocks = ["speed", "location"].iter().flat_map(|name| (0..times).map(move |time| (*name, time)));
        let (in_blocks, is_early) = joined(&blocks.collect::<Vec<_>>());
        assert!(!is_early && in_blocks == rows);
        assert!(rows.iter().enumerate().all(|(time, row)| *row == vec![RowField::Number(time as f64); 3]));
    }
}
