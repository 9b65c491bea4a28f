//! Tables that have one signal in each row: time, signal, value. The rows of one time become one row, with a column for
//! each signal.

use super::parts;
use super::row::{Each, Event, Header, Layout, RowField};
use crate::import::meaning::{Meaning, plain};
use crate::import::units;
use std::collections::{HashMap, VecDeque};

/// What the columns of such a table are called, the more usual names first.
const SIGNAL: &str = "signal|signal name|signalname|signal id|tag|tag name|tagname|tag id|variable|variable name|parameter|\
                      parameter name|kanal|kanalname|messgrosse|messgroesse|measurement|metric|sensor|sensor name|point|\
                      messstelle|bezeichnung|grosse|groesse|mesure|grandeur|parametre|senal|magnitud|segnale|grandezza|\
                      channel|channel name|voie|canal|canale|name|nom|nombre|nome|key|item|field";
const VALUE: &str = "value|val|wert|messwert|istwert|valeur|valor|valore|reading|signal value|tag value|physical value|\
                     phys value|eng value|engineering value|value num|numeric value|value float|float value|waarde|\
                     hodnota|wartosc|varde";
const UNIT: &str = "unit|units|uom|unit of measure|engineering unit|engineering units|eng unit|eu|dimension|einheit|unite|\
                    unidad|unita|eenheid|jednotka";
const QUALITY: &str = "quality|signal quality|tag quality|status|state|validity|valid|qualitat|qualitaet|gultig|qualite|\
                       etat|calidad|estado|qualita|stato|kwaliteit";
/// What such a column says of a value that is none.
const BAD: &str = "bad|invalid|uncertain|questionable|fault|faulty|error|failed|failure|stale|timeout|schlecht|ungultig|\
                   gestort|fehler|mauvais|invalide|defaut|malo|invalido|cattivo|non valido|slecht|ongeldig";
/// The least number of a good value where numbers say it, as OPC writes them: bad ones have 0, and doubtful ones 64.
const GOOD: f64 = 192.0;

/// So many times may be open at once: a recorder that writes one signal after the other does so for a day or less.
const OPEN: usize = 100_000;
/// More are no names of signals.
const MOST_SIGNALS: usize = 100_000;
/// Of more than these only those are read of which the name, or the unit, is known.
const MOST_READ: usize = 200;
/// Several trains or sources share their names where more values than this share stand beside another one of the same
/// signal and time.
const MOST_BESIDE: f64 = 0.05;

pub const BESIDE: &str = "values beside another one of the same signal and time, left out";
pub const CALLED_BAD: &str = "values that a column calls bad, left out";

/// How the rows of such a table become rows of all signals.
#[derive(Clone, Debug)]
pub struct Signals {
    columns: SignalColumns,
    /// Columns that rows of one time share.
    shared: Vec<usize>,
    /// Of each signal that is read its index among them.
    index: HashMap<String, usize>,
    read: Vec<ReadSignal>,
    /// Of all, those that are not read too.
    pub count: usize,
    /// One signal begins where another one has ended: nothing is complete before the end.
    are_blocks: bool,
    /// Values of one time are those of several trains or sources: of which signal, how many, and of how many.
    pub beside: Option<(String, usize, usize)>,
    /// Names of columns that are not used.
    pub unused: Vec<String>,
}

/// A signal that is read.
#[derive(Clone, Debug)]
struct ReadSignal {
    /// That of the header.
    unit: Option<String>,
    /// Its name says what it is.
    is_known: bool,
    /// It is the name of a unit or a run, which holds until the next one is written: the first of them.
    held: Option<RowField>,
}

/// The columns of a table with one signal in each row.
#[derive(Clone, Debug)]
pub struct SignalColumns {
    signal: usize,
    value: usize,
    unit: Option<usize>,
    quality: Option<usize>,
    /// The quality is a number, which good values have from [`GOOD`] on.
    has_codes: bool,
}

/// How many names of a row are those of signal and value, where both are there: all that a mapping may name are
/// signals then.
pub fn known_in(row: &[String], named: &[String]) -> usize {
    let is_there = |names: &str| row.iter().any(|text| names.split('|').any(|name| name == plain(text)));
    if is_there(SIGNAL) && is_there(VALUE) { 2 + 4 * named.len() } else { 0 }
}

/// That a table may have one signal in each row, where a column is called so.
pub fn hint(headers: &[Header]) -> Option<&'static str> {
    let is_named = |header: &Header| [SIGNAL, VALUE].iter().any(|names| is_one_of(names, &header.written));
    headers.iter().any(is_named).then_some(
        "; where each row has one signal, layout.signal and layout.value in [[source]] name the columns of its name and value",
    )
}

fn is_one_of(names: &str, text: &str) -> bool {
    let text = plain(text);
    names.split('|').any(|name| name == text)
}

/// A tag such as `VEH1.TRC.SpeedAct` as a person would write it, where only its last part is known.
fn header_of(signal: &str) -> Header {
    let whole = Header::new(signal);
    let last = whole.written.rsplit(['.', '/', '\\', ':', '|']).next().unwrap_or_default();
    let mut apart = String::new();
    for (at, letter) in last.char_indices() {
        if letter.is_uppercase() && last[..at].ends_with(char::is_lowercase) {
            apart.push(' ');
        }
        apart.push(letter);
    }
    let is_known = |header: &Header| meaning_of(&header.name).is_some();
    // `Lok17_Weg`, but no `target_speed`.
    let of_number = last.split_once('_').filter(|(before, _)| before.ends_with(|c: char| c.is_ascii_digit()));
    let spelled = [last, &apart, of_number.map_or("", |(_, name)| name)].map(Header::new);
    let known = [whole.clone()].into_iter().chain(spelled).find(is_known);
    known.map_or(whole.clone(), |known| Header { written: whole.written, ..known })
}

fn meaning_of(name: &str) -> Option<Meaning> {
    Meaning::of_names(&[name.to_owned()]).first().map(|(meaning, _)| *meaning)
}

/// Speed or place, by the name or by the unit.
fn is_of_motion(header: &Header) -> bool {
    [Meaning::Speed, Meaning::Location].iter().any(|meaning| header.unit_of(*meaning).is_some())
}

/// A signal of the file, where it begins.
struct SeenSignal {
    name: String,
    unit: Option<String>,
    value: RowField,
    /// The first and last of its rows, and how many there are.
    ends: [usize; 2],
    rows: usize,
    /// What its last row shares with others, if the column of units has units of measure, and if it has vehicles; and
    /// how many values stood beside another one.
    keys: [String; 2],
    beside: [usize; 2],
    last: RowField,
}

impl SignalColumns {
    /// By what the layout says, else by their names. None where a column has a speed or a place of its own.
    pub fn find(headers: &[Header], layout: &Layout) -> Option<Self> {
        let of = |stated: Option<&String>, names: &str| match stated {
            Some(stated) => headers.iter().position(|header| stated.trim() == header.written),
            None => {
                let at = |name: &str| headers.iter().position(|header| plain(&header.written) == name);
                names.split('|').find_map(at)
            }
        };
        let (signal, value) = (of(layout.signal.as_ref(), SIGNAL)?, of(layout.value.as_ref(), VALUE)?);
        let is_wide = |header: &Header| {
            matches!(meaning_of(&header.name), Some(Meaning::Location | Meaning::Speed | Meaning::Latitude))
                || header.unit_of(Meaning::Speed).is_some()
        };
        let others = headers.iter().enumerate().filter(|(index, _)| ![signal, value].contains(index));
        if layout.signal.is_none() && others.map(|(_, header)| header).any(is_wide) {
            return None;
        }
        let [unit, quality] = [UNIT, QUALITY].map(|names| of(None, names));
        let free = |index: &usize| ![signal, value].contains(index);
        Some(Self { signal, value, unit: unit.filter(free), quality: quality.filter(free), has_codes: false })
    }

    /// Of signal and value.
    pub fn names(&self, headers: &[Header]) -> [String; 2] {
        [self.signal, self.value].map(|index| headers[index].written.clone())
    }

    /// Columns that rows of one time share: time, date, unit, run and those that the mapping names.
    fn shared(&self, headers: &[Header], named: &[String]) -> Vec<usize> {
        let own = [Some(self.signal), Some(self.value), self.unit, self.quality];
        let is_own = |index: usize| own.contains(&Some(index));
        let names = headers.iter().enumerate().map(|(i, header)| if is_own(i) { "" } else { &header.name }.to_owned());
        let meanings = Meaning::of_names(&names.collect::<Vec<_>>());
        let splits = |meaning: Meaning| matches!(meaning, Meaning::Time | Meaning::Date | Meaning::Run | Meaning::Unit);
        let is_shared = |index: &usize| {
            let is_named = || named.iter().any(|name| name.trim() == headers[*index].written);
            !is_own(*index)
                && (meanings.iter().any(|(meaning, at)| at == index && splits(*meaning))
                    || is_named()
                    || parts::is_part(&headers[*index]))
        };
        (0..headers.len()).filter(is_shared).collect()
    }

    /// How the table is read, and its columns then. `rows` gives those of the file; `named` are columns of the mapping,
    /// `is_stated`: a person said that each row has a signal. None where it has none after all.
    pub fn read<E>(
        mut self,
        headers: &[Header],
        named: &[String],
        is_stated: bool,
        rows: impl FnOnce(&mut Each) -> Result<(), E>,
    ) -> Result<Option<(Signals, Vec<Header>)>, E> {
        let with_vehicles = Self { unit: None, ..self.clone() };
        let shared = [&self, &with_vehicles].map(|columns| columns.shared(headers, named));
        if shared[1].is_empty() {
            return Ok(None);
        }
        let mut signals: Vec<SeenSignal> = Vec::new();
        let mut index: HashMap<String, usize> = HashMap::new();
        let (mut number, mut is_measured) = (0_usize, false);
        rows(&mut |event| {
            if let Event::Row(_, row) = event
                && let Some(name) = text(row.get(self.signal))
            {
                let unit = self.unit.and_then(|unit| text(row.get(unit)));
                // A unit may be a vehicle, too.
                self.has_codes |=
                    self.quality.and_then(|quality| code(row.get(quality)?)).is_some_and(|code| code >= GOOD);
                is_measured |= unit.as_deref().is_some_and(|unit| units::by_name(Meaning::Speed, unit).is_some());
                let at = *index.entry(name.clone()).or_insert_with(|| {
                    signals.push(SeenSignal::new(name, number));
                    signals.len() - 1
                });
                signals[at].see(number, row.get(self.value), unit, &shared.each_ref().map(|shared| key(shared, row)));
                number += 1;
            }
            signals.len() <= MOST_SIGNALS
        })?;
        if !is_measured {
            self.unit = None;
        }
        if signals.len() < 2 || signals.len() > MOST_SIGNALS {
            return Ok(None);
        }
        let with_unit = |signal: &SeenSignal| {
            let mut header = header_of(&signal.name);
            header.unit = header.unit.take().or_else(|| signal.unit.clone().filter(|_| is_measured));
            header
        };
        let count = signals.len();
        let is_known = |header: &Header| {
            let is_named = named.iter().any(|name| name.trim() == header.written);
            meaning_of(&header.name).is_some() || is_of_motion(header) || is_named
        };
        let all: Vec<(SeenSignal, Header)> = signals
            .into_iter()
            .map(|signal| (with_unit(&signal), signal))
            .map(|(header, signal)| (signal, header))
            .collect();
        let known = all.iter().filter(|(_, header)| is_known(header)).count();
        if known == 0 && !is_stated {
            return Ok(None);
        }
        let read = all.into_iter().filter(|(_, header)| count <= MOST_READ || is_known(header));
        let (seen, columns): (Vec<SeenSignal>, Vec<Header>) = read.unzip();
        let shared = shared[usize::from(!is_measured)].clone();
        let beside = seen.iter().zip(&columns).filter(|(_, header)| is_known(header)).find_map(|(signal, _)| {
            let beside = signal.beside[usize::from(!is_measured)];
            (beside as f64 > MOST_BESIDE * signal.rows as f64).then(|| (signal.name.clone(), beside, signal.rows))
        });
        let many = seen.iter().filter(|signal| signal.rows > 1);
        let first_end = many.clone().map(|signal| signal.ends[1]).min();
        let are_blocks = many.map(|signal| signal.ends[0]).max() > first_end;
        let index = seen.iter().enumerate().map(|(index, signal)| (signal.name.clone(), index)).collect();
        let own = [Some(self.signal), Some(self.value), self.unit, self.quality];
        let unused = headers.iter().enumerate().filter(|(index, header)| {
            !shared.contains(index) && !own.contains(&Some(*index)) && !header.written.is_empty()
        });
        let unused = unused.map(|(_, header)| header.written.clone()).collect();
        let of_signal = |(signal, header): (SeenSignal, &Header)| ReadSignal {
            unit: signal.unit.filter(|_| is_measured),
            is_known: is_known(header),
            held: matches!(meaning_of(&header.name), Some(Meaning::Unit | Meaning::Run)).then_some(signal.value),
        };
        let read = seen.into_iter().zip(&columns).map(of_signal).collect();
        let headers = shared.iter().map(|shared| headers[*shared].clone()).chain(columns).collect();
        Ok(Some((Signals { columns: self, shared, index, read, count, are_blocks, beside, unused }, headers)))
    }
}

impl SeenSignal {
    fn new(name: String, number: usize) -> Self {
        let (unit, value, last) = (None, RowField::Empty, RowField::Empty);
        Self { name, unit, value, ends: [number; 2], rows: 0, keys: Default::default(), beside: [0; 2], last }
    }

    fn see(&mut self, number: usize, value: Option<&RowField>, unit: Option<String>, keys: &[String; 2]) {
        self.ends[1] = number;
        self.rows += 1;
        self.unit = self.unit.take().or(unit);
        let Some(value) = value.filter(|value| **value != RowField::Empty) else { return };
        for ((before, key), beside) in self.keys.iter().zip(keys).zip(&mut self.beside) {
            *beside += usize::from(before == key && self.last != *value);
        }
        if self.value == RowField::Empty {
            self.value = value.clone();
        }
        (self.keys, self.last) = (keys.clone(), value.clone());
    }
}

fn text(field: Option<&RowField>) -> Option<String> {
    match field? {
        RowField::Empty => None,
        RowField::Text(text) => Some(text.trim().to_owned()).filter(|text| !text.is_empty()),
        RowField::Number(number) => Some(number.to_string()),
    }
}

/// The number of a quality.
fn code(field: &RowField) -> Option<f64> {
    match field {
        RowField::Number(code) => Some(*code),
        RowField::Text(text) => text.trim().parse().ok(),
        RowField::Empty => None,
    }
}

/// What a row shares with others of its time.
fn key(shared: &[usize], row: &[RowField]) -> String {
    let field = |index: &usize| text(row.get(*index)).unwrap_or_default();
    shared.iter().map(field).collect::<Vec<_>>().join("\u{1f}")
}

/// Rows of which not all signals are there yet, in the order in which they begin.
#[derive(Default)]
struct OpenRows {
    rows: VecDeque<(u64, Vec<RowField>)>,
    /// Of what rows share, their numbers: an hour of the clock may come twice. The first that is open has the number
    /// `gone`.
    at: HashMap<String, Vec<usize>>,
    gone: usize,
    /// The row in which each signal was last.
    last: Vec<usize>,
    /// Names that hold.
    held: Vec<Option<RowField>>,
}

impl Signals {
    /// Gives `each` the rows of all signals that the rows of the file, `rows`, make.
    ///
    /// # Errors
    /// Those of `rows`.
    pub fn rows<E>(&self, each: &mut Each, rows: impl FnOnce(&mut Each) -> Result<(), E>) -> Result<(), E> {
        let held = self.read.iter().map(|signal| signal.held.clone()).collect();
        let mut open = OpenRows { last: vec![usize::MAX; self.read.len()], held, ..OpenRows::default() };
        let mut goes_on = true;
        rows(&mut |event| {
            goes_on = match event {
                Event::Row(line, row) => self.take(line, row, &mut open, each),
                // One signal may have a sheet of its own.
                Event::Sheet(_) if self.are_blocks => true,
                Event::Sheet(name) => open.close(0, each) && each(Event::Sheet(name)),
                // How many fields a row should have is no matter of the columns that come out.
                Event::Ragged(..) => true,
                lost @ (Event::Bad(..) | Event::Lost(..)) => each(lost),
            };
            goes_on
        })?;
        if goes_on {
            open.close(0, each);
        }
        Ok(())
    }

    fn take(&self, line: u64, row: &[RowField], open: &mut OpenRows, each: &mut Each) -> bool {
        let SignalColumns { signal, value, unit, quality, has_codes } = self.columns;
        let Some(name) = text(row.get(signal)) else {
            return each(Event::Bad(line, "expected the name of a signal, found none".to_owned()));
        };
        let (Some(index), Some(value)) = (self.index.get(&name).copied(), row.get(value)) else { return true };
        let ReadSignal { unit: expected, is_known, .. } = &self.read[index];
        let word = |column: Option<usize>| column.and_then(|column| text(row.get(column)));
        if *is_known
            && let Some(quality) = quality.and_then(|quality| row.get(quality))
            && (has_codes && code(quality).is_some_and(|code| code < GOOD)
                || text(Some(quality)).is_some_and(|quality| is_one_of(BAD, &quality)))
        {
            return each(Event::Lost(
                line,
                CALLED_BAD,
                format!("expected a good value of {name}, found {}", text(Some(quality)).unwrap_or_default()),
            ));
        }
        // Another unit than that of the header stands behind the value.
        let value = match word(unit) {
            Some(unit) if Some(&unit) != expected.as_ref() => {
                text(Some(value)).map_or(RowField::Empty, |value| RowField::Text(format!("{value} {unit}")))
            }
            _ => value.clone(),
        };
        let field = &mut open.row(line, row, self, index)[self.shared.len() + index];
        if *field == RowField::Empty {
            *field = value;
        } else if *field != value && *is_known {
            let [first, second] = [&*field, &value].map(|field| text(Some(field)).unwrap_or_default());
            let message = format!("expected one value of {name} at a time, found {first} and {second}");
            return each(Event::Lost(line, BESIDE, message));
        }
        self.are_blocks || open.close(OPEN, each)
    }
}

impl OpenRows {
    /// The row for this one of a signal: of those that share its time the first without the signal, else the one in
    /// which it was last, else a new one.
    fn row(&mut self, line: u64, row: &[RowField], signals: &Signals, index: usize) -> &mut Vec<RowField> {
        let Signals { shared, read, .. } = signals;
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
        let Self { rows, held, .. } = self;
        rows.drain(..leaving).all(|(line, mut row)| {
            let shared = row.len() - held.len();
            for (field, held) in row[shared..].iter_mut().zip(&mut *held) {
                let Some(held) = held else { continue };
                if *field == RowField::Empty {
                    *field = held.clone();
                } else {
                    *held = field.clone();
                }
            }
            each(Event::Row(line, &row))
        })
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
        let columns = SignalColumns::find(&headers, &Layout::default()).unwrap();
        let (signals, headers) = columns.read(&headers, &[], false, give).unwrap().unwrap();
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
