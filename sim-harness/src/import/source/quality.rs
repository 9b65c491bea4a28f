//! Columns that call values good or bad: of a table with one signal in each row, or beside the columns of a wide one.

use super::row::{Each, Event, Header, RowField};
use crate::import::meaning::{Meaning, plain};

/// Columns that say nothing but that.
pub const OF_VALUES_ONLY: &str =
    "quality|signal quality|tag quality|qualitat|qualitaet|qualite|calidad|qualita|kwaliteit|validity|valid|gultig";
/// Those that may be of a train, too.
pub const STATES: &str = "status|state|etat|estado|stato";
/// What stands before or behind the name of the column that is judged.
const BESIDE_NAME: &str = "quality|q|qualitat|qualitaet|qualite|calidad|qualita|kwaliteit|validity|valid|gultig|gueltig|status|state|ok|flag|\
     valide|valido|geldig|is valid|quality flag|valid flag";
/// Names of columns in which 1 is good and 0 is bad.
const OF_FLAGS: &str = "valid|validity|gultig|gueltig|ok|valide|valido|geldig";
/// What such a column says of a value that is one, and of one that is none: a state of the train has both hardly ever.
const GOOD_WORDS: &str = "good|ok|valid|true|gut|gultig|bon|bonne|valide|bueno|buono|valido|goed|geldig";
const BAD_WORDS: &str = "bad|invalid|false|nok|not ok|uncertain|questionable|fault|faulty|error|failed|failure|stale|\
                         timeout|schlecht|ungultig|gestort|fehler|mauvais|invalide|defaut|malo|invalido|cattivo|\
                         non valido|slecht|ongeldig";
/// The least number of a good value where numbers say it, as OPC writes them: bad ones have 0, and doubtful ones 64.
const GOOD_CODE: f64 = 192.0;

pub const CALLED_BAD: &str = "values that a column calls bad, left out";

/// A column that calls values good or bad, and how it says so, as far as rows have shown it.
#[derive(Clone, Debug)]
pub struct Quality {
    pub column: usize,
    may_be_flag: bool,
    /// Rows that call their value good and bad, by numbers from [`GOOD_CODE`] on, and by 1 and 0; those
    /// that call it good by a word, which means but one thing.
    codes: [usize; 2],
    flags: [usize; 2],
    good_words: usize,
    /// Rows that call their value bad by a word, or by a 0 under a name of flags; and those that say something else.
    bad: [usize; 2],
}

/// Most of these numbers are good: where they are not, they mean something else, or the other way round.
fn are_marks([good, bad]: [usize; 2]) -> bool {
    good > bad
}

pub fn is_one_of(names: &str, text: &str) -> bool {
    let text = plain(text);
    names.split('|').any(|name| name == text)
}

impl Quality {
    pub fn new(column: usize, header: &Header) -> Self {
        let name = plain(&header.written);
        let may_be_flag = name.split(' ').any(|word| OF_FLAGS.split('|').any(|flag| flag == word));
        Self { column, may_be_flag, codes: [0; 2], flags: [0; 2], good_words: 0, bad: [0; 2] }
    }

    /// Rows have shown what is good.
    pub fn is_known(&self) -> bool {
        are_marks(self.codes) || are_marks(self.flags) || self.has_words()
    }

    /// Each row calls its value bad: whether that means what it says nothing shows.
    pub const fn calls_all_bad(&self) -> bool {
        self.bad[0] > 0 && self.bad[1] == 0
    }

    const fn has_words(&self) -> bool {
        self.good_words > 0
    }

    pub fn see(&mut self, row: &[RowField]) {
        let Some(field) = row.get(self.column) else { return };
        let count = |of: &mut [usize; 2], is_good: bool, is_bad: bool| {
            of[0] += usize::from(is_good);
            of[1] += usize::from(is_bad);
        };
        match (field.number(), field.text()) {
            (Some(code), _) => {
                count(&mut self.codes, code >= GOOD_CODE, code < GOOD_CODE);
                count(&mut self.flags, self.may_be_flag && code == 1.0, code != 1.0);
                let is_bad = self.may_be_flag && code == 0.0;
                count(&mut self.bad, is_bad, !is_bad);
            }
            (None, Some(text)) => {
                self.good_words += usize::from(is_one_of(GOOD_WORDS, &text));
                let is_bad = is_one_of(BAD_WORDS, &text);
                count(&mut self.bad, is_bad, !is_bad);
            }
            (None, None) => {}
        }
    }

    /// What it says against a value of this row.
    pub fn called_bad(&self, row: &[RowField]) -> Option<String> {
        let field = row.get(self.column)?;
        let text = field.text()?;
        let is_bad = match field.number() {
            Some(code) if are_marks(self.codes) => code < GOOD_CODE,
            Some(code) => are_marks(self.flags) && code == 0.0,
            None => self.has_words() && is_one_of(BAD_WORDS, &text),
        };
        is_bad.then_some(text)
    }
}

/// A reading, by its name or its unit: no time, and no name of a train.
fn is_measured(header: &Header) -> bool {
    match Meaning::of_name(&header.name) {
        Some(Meaning::Time | Meaning::Date | Meaning::Unit | Meaning::Run) => false,
        Some(_) => true,
        None => [Meaning::Speed, Meaning::Location, Meaning::Effort].iter().any(|of| header.unit_of(*of).is_some()),
    }
}

fn is_of_fix(header: &Header) -> bool {
    matches!(Meaning::of_name(&header.name), Some(Meaning::Latitude | Meaning::Longitude | Meaning::Altitude))
}

/// A column has the name of another one, and says how good that is.
fn is_of(quality: &Header, value: &Header) -> bool {
    // The state of traction and brakes is that of the equipment.
    let is_force = Meaning::of_name(&value.name).is_some_and(Meaning::is_force);
    let (name, values) = (plain(&quality.written), [plain(&value.name), plain(&value.written)]);
    BESIDE_NAME.split('|').filter(|word| !(is_force && ["status", "state"].contains(word))).any(|word| {
        let behind = name.strip_suffix(word).and_then(|before| before.strip_suffix(' '));
        let before = name.strip_prefix(word).and_then(|behind| behind.strip_prefix(' '));
        behind.into_iter().chain(before).any(|name| values.iter().any(|value| value == name))
    })
}

/// The columns of a wide table that call others bad, and which these are.
#[derive(Clone, Debug, Default)]
pub struct Qualities(Vec<(Quality, Vec<usize>)>);

impl Qualities {
    /// By their names: `speed;speed_valid`, or `speed;quality;location;quality`, or one `quality` of all. `named` are
    /// columns of the mapping.
    pub fn find(headers: &[Header], named: &[String]) -> Self {
        let is_bare = |index: &usize| is_one_of(OF_VALUES_ONLY, &headers[*index].written);
        let bare = (0..headers.len()).filter(is_bare).count();
        let measured = || (0..headers.len()).filter(|at| is_measured(&headers[*at]));
        // That of a receiver says nothing of a wheel.
        let has_fixes = measured().any(|at| is_of_fix(&headers[at]));
        let first = (0..headers.len()).find(is_bare).and_then(|index| index.checked_sub(1));
        let are_behind = first.is_some_and(|before| is_measured(&headers[before]));
        let judged = |index: usize| match (0..headers.len()).find(|at| is_of(&headers[index], &headers[*at])) {
            Some(at) if is_measured(&headers[at]) => vec![at],
            Some(at) if headers[at].is_among(named) && Meaning::of_name(&headers[at].name).is_none() => vec![at],
            Some(_) => Vec::new(),
            None if !is_bare(&index) => Vec::new(),
            None if bare == 1 && has_fixes => measured().filter(|at| is_of_fix(&headers[*at])).collect(),
            None if bare == 1 => measured().collect(),
            None => measured().filter(|at| if are_behind { at + 1 == index } else { index + 1 == *at }).collect(),
        };
        let judging = (0..headers.len()).map(|index| (index, judged(index))).filter(|(_, judged)| !judged.is_empty());
        Self(judging.map(|(index, judged)| (Quality::new(index, &headers[index]), judged)).collect())
    }

    pub const fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub fn see(&mut self, row: &[RowField]) {
        self.0.iter_mut().for_each(|(quality, _)| quality.see(row));
    }

    /// Keeps those that are known. With columns of which each row calls its value bad.
    pub fn forget_unknown(&mut self) -> Vec<usize> {
        let all_bad = self.0.iter().filter(|(quality, _)| quality.calls_all_bad()).map(|(quality, _)| quality.column);
        let all_bad = all_bad.collect();
        self.0.retain(|(quality, _)| quality.is_known());
        all_bad
    }

    pub fn columns(&self) -> impl Iterator<Item = usize> {
        self.0.iter().map(|(quality, _)| quality.column)
    }

    /// Gives a row to `each` without its bad values, and these before it; `whole` is kept from row to row.
    pub fn judge(
        &self,
        (line, row): (u64, &[RowField]),
        headers: &[Header],
        whole: &mut Vec<RowField>,
        each: &mut Each,
    ) -> bool {
        whole.clear();
        for (quality, judged) in &self.0 {
            let Some(found) = quality.called_bad(row) else { continue };
            if whole.is_empty() {
                whole.extend_from_slice(row);
            }
            for index in judged {
                let Some(field) = whole.get_mut(*index).filter(|field| **field != RowField::Empty) else { continue };
                *field = RowField::Empty;
                let message = format!("expected a good value of {}, found {found}", headers[*index].written);
                if !each(Event::LeftOut(line, CALLED_BAD, message)) {
                    return false;
                }
            }
        }
        each(Event::Row(line, if whole.is_empty() { row } else { whole }))
    }
}
