//! Tables that have one signal in each row: time, signal, value. What their columns are, and the signals in them.

use super::parts;
use super::quality::{self, Quality, is_one_of};
use super::row::{Each, Event, Header, Layout, RowField};
use super::seen_signals::{SeenSignal, SeenSignals};
use super::tags::{self, is_of_another};
use crate::import::meaning::{Meaning, plain};
use std::collections::HashMap;

/// What the columns of such a table are called, the more usual names first.
const SIGNAL: &str = "signal|signal name|signalname|signal id|tag|tag name|tagname|tag id|field|variable|variable name|\
                      parameter|parameter name|kanal|kanalname|messgrosse|messgroesse|sensor|sensor name|point|\
                      messstelle|bezeichnung|grosse|groesse|mesure|grandeur|parametre|senal|magnitud|segnale|grandezza|\
                      channel|channel name|voie|canal|canale|measurement|metric|name|nom|nombre|nome|key|item";
const VALUE: &str = "value|val|wert|messwert|istwert|valeur|valor|valore|reading|signal value|tag value|physical value|\
                     phys value|eng value|engineering value|value num|numeric value|value float|float value|waarde|\
                     hodnota|wartosc|varde";
const UNIT: &str = "unit|units|uom|unit of measure|engineering unit|engineering units|eng unit|eu|dimension|einheit|unite|\
                    unidad|unita|eenheid|jednotka";

/// More are no names of signals.
const MOST_SIGNALS: usize = 100_000;
/// Of more than these only those are read of which the name, or the unit, is known.
const MOST_READ: usize = 200;
/// How the rows of such a table become rows of all signals.
#[derive(Clone, Debug)]
pub struct Signals {
    pub columns: SignalColumns,
    /// Columns that rows of one time share.
    pub shared: Vec<usize>,
    /// Of these the one that has the unit, as an index among them.
    pub vehicle: Option<usize>,
    /// Of each signal that is read its index among them.
    pub index: HashMap<String, usize>,
    pub read: Vec<ReadSignal>,
    /// Of all, those that are not read too.
    pub count: usize,
    /// One signal begins where another one has ended: nothing is complete before the end.
    pub are_blocks: bool,
    /// Values of one time are those of several trains or sources: of which signal, how many, and of how many.
    pub mixed: Option<(String, usize, usize)>,
    /// Names of columns that are not used.
    pub unused: Vec<String>,
    /// A column that calls each value bad.
    pub all_bad: Option<usize>,
}

/// A signal that is read.
#[derive(Clone, Debug)]
pub struct ReadSignal {
    /// That of the header.
    pub unit: Option<String>,
    /// Its name says what it is.
    pub is_known: bool,
    /// It is the name of a unit or a run, which holds until the next one is written.
    pub is_held: bool,
    /// The first value.
    pub first: RowField,
}

/// The columns of a table with one signal in each row.
#[derive(Clone, Debug)]
pub struct SignalColumns {
    pub signal: usize,
    pub value: usize,
    pub unit: Option<usize>,
    pub quality: Option<Quality>,
}

/// How many names of a row are those of signal and value, where both stand beside a time: all that a mapping may name
/// are signals then.
pub fn known_in(row: &[String], named: &[String]) -> usize {
    let is_there = |names: &str| row.iter().any(|text| is_one_of(names, text));
    let has_time = || {
        let headers: Vec<Header> = row.iter().map(|text| Header::new(text)).collect();
        let is_time = |header: &Header| is_of_time(header) || header.is_among(named);
        headers.iter().any(is_time) || !parts::columns(&headers).is_empty()
    };
    if is_there(SIGNAL) && is_there(VALUE) && has_time() { 2 + 4 * named.len() } else { 0 }
}

fn is_of_time(header: &Header) -> bool {
    matches!(Meaning::of_name(&header.name), Some(Meaning::Time | Meaning::Date))
}

/// That a table may have one signal in each row, where a column is called so.
pub fn hint(headers: &[Header]) -> Option<&'static str> {
    let is_named = |header: &Header| [SIGNAL, VALUE].iter().any(|names| is_one_of(names, &header.written));
    headers.iter().any(is_named).then_some(
        "; where each row has one signal, layout.signal and layout.value in [[source]] name the columns of its name and value",
    )
}

/// Speed or place, by the unit.
fn is_of_motion(header: &Header) -> bool {
    let is_of = |meaning: &Meaning| header.unit_of(*meaning).is_some();
    [Meaning::Speed, Meaning::Location].iter().any(is_of) && !is_of_another(&header.written)
}

/// What a row shares with others of its time.
pub fn key(shared: &[usize], row: &[RowField]) -> String {
    let field = |index: &usize| row.get(*index).and_then(RowField::text).unwrap_or_default();
    shared.iter().map(field).collect::<Vec<_>>().join("\u{1f}")
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
            matches!(Meaning::of_name(&header.name), Some(Meaning::Location | Meaning::Speed | Meaning::Latitude))
                || header.unit_of(Meaning::Speed).is_some()
        };
        let others = headers.iter().enumerate().filter(|(index, _)| ![signal, value].contains(index));
        if layout.signal.is_none() && others.map(|(_, header)| header).any(is_wide) {
            return None;
        }
        let free = |index: &usize| ![signal, value].contains(index);
        let unit = of(None, UNIT).filter(free);
        let quality = of(None, quality::OF_VALUES_ONLY).or_else(|| of(None, quality::STATES)).filter(free);
        let quality = quality.map(|column| Quality::new(column, &headers[column]));
        Some(Self { signal, value, unit, quality })
    }

    /// Of signal and value.
    pub fn names(&self, headers: &[Header]) -> [String; 2] {
        [self.signal, self.value].map(|index| headers[index].written.clone())
    }

    fn own(&self) -> [Option<usize>; 4] {
        [Some(self.signal), Some(self.value), self.unit, self.quality.as_ref().map(|quality| quality.column)]
    }

    /// Columns that rows of one time share: time, date, unit, run and those that the mapping names; and which of them
    /// has the unit. None where no column has a time.
    fn shared(&self, headers: &[Header], named: &[String]) -> (Vec<usize>, Option<usize>) {
        let is_own = |index: usize| self.own().contains(&Some(index));
        let names = headers.iter().enumerate().map(|(i, header)| if is_own(i) { "" } else { &header.name }.to_owned());
        let meanings = Meaning::of_names(&names.collect::<Vec<_>>());
        let parts = parts::columns(headers);
        let splits = |meaning: Meaning| matches!(meaning, Meaning::Time | Meaning::Date | Meaning::Run | Meaning::Unit);
        let is_shared = |index: &usize| {
            let has_meaning = meanings.iter().any(|(meaning, at)| at == index && splits(*meaning));
            !is_own(*index) && (has_meaning || headers[*index].is_among(named) || parts.contains(index))
        };
        let shared: Vec<usize> = (0..headers.len()).filter(is_shared).collect();
        let is_time = |index: &usize| is_of_time(&headers[*index]) || parts.contains(index);
        if named.is_empty() && !shared.iter().any(is_time) {
            return (Vec::new(), None);
        }
        let vehicle = meanings.iter().find(|(meaning, _)| *meaning == Meaning::Unit);
        let vehicle = vehicle.and_then(|(_, index)| shared.iter().position(|shared| shared == index));
        (shared, vehicle)
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
        // A unit may be a vehicle, too.
        let with_vehicles = Self { unit: None, ..self.clone() };
        let shared = [&self, &with_vehicles].map(|columns| columns.shared(headers, named));
        if shared[1].0.is_empty() {
            return Ok(None);
        }
        let mut seen = SeenSignals::default();
        rows(&mut |event| {
            if let Event::Row(_, row) = event
                && let Some(name) = row.get(self.signal).and_then(RowField::text)
            {
                if let Some(quality) = &mut self.quality {
                    quality.see(row);
                }
                let unit = self.unit.and_then(|unit| row.get(unit)?.text());
                let keys = shared.each_ref().map(|(shared, _)| key(shared, row));
                seen.see(name, row.get(self.value), unit, keys);
            }
            seen.all.len() <= MOST_SIGNALS
        })?;
        let is_measured = seen.is_measured;
        self.unit = self.unit.filter(|_| is_measured);
        let all_bad = self.quality.as_ref().filter(|quality| quality.calls_all_bad()).map(|quality| quality.column);
        self.quality = self.quality.filter(Quality::is_known);
        let mut seen = seen.all;
        if seen.len() < 2 || seen.len() > MOST_SIGNALS {
            return Ok(None);
        }
        // Whatever comes first, two files of one recorder have one header.
        seen.sort_by(|a, b| a.name.cmp(&b.name));
        let mut columns: Vec<Header> = seen.iter().map(|signal| Header::new(&signal.name)).collect();
        tags::name(&mut columns);
        for (header, signal) in columns.iter_mut().zip(&seen) {
            header.unit = header.unit.take().or_else(|| signal.unit(&header.name).filter(|_| is_measured));
        }
        let is_known = |header: &Header| {
            Meaning::of_name(&header.name).is_some() || is_of_motion(header) || header.is_among(named)
        };
        if !is_stated && !columns.iter().any(is_known) {
            return Ok(None);
        }
        let count = seen.len();
        let read = seen.into_iter().zip(columns).filter(|(_, header)| count <= MOST_READ || is_known(header));
        let (seen, columns): (Vec<SeenSignal>, Vec<Header>) = read.unzip();
        let (shared, vehicle) = shared[usize::from(!is_measured)].clone();
        let moves = |header: &Header| {
            matches!(Meaning::of_name(&header.name), Some(Meaning::Speed | Meaning::Location | Meaning::Latitude))
        };
        let of_motion = seen.iter().zip(&columns).filter(|(_, header)| moves(header)).map(|(signal, _)| signal);
        let mixed = of_motion.clone().find_map(|signal| signal.far_beside(!is_measured));
        let many = of_motion.filter(|signal| signal.rows > 1);
        let first_end = many.clone().map(|signal| signal.ends[1]).min();
        let are_blocks = many.map(|signal| signal.ends[0]).max() > first_end;
        let index = seen.iter().enumerate().map(|(index, signal)| (signal.name.clone(), index)).collect();
        let used = self.own();
        let is_unused = |(index, header): &(usize, &Header)| {
            !shared.contains(index) && !used.contains(&Some(*index)) && !header.written.is_empty()
        };
        let unused = headers.iter().enumerate().filter(is_unused).map(|(_, header)| header.written.clone()).collect();
        let of_signal = |(signal, header): (SeenSignal, &Header)| ReadSignal {
            unit: header.unit.clone().filter(|_| is_measured),
            is_known: is_known(header),
            is_held: matches!(Meaning::of_name(&header.name), Some(Meaning::Unit | Meaning::Run)),
            first: signal.value,
        };
        let read = seen.into_iter().zip(&columns).map(of_signal).collect();
        let headers = shared.iter().map(|shared| headers[*shared].clone()).chain(columns).collect();
        let signals =
            Signals { columns: self, shared, vehicle, index, read, count, are_blocks, mixed, unused, all_bad };
        Ok(Some((signals, headers)))
    }
}
