//! Units that nothing names, and whether those that are named may be right.

use super::stretches::{LEAST_ALIKE, OF_TRAINS_MPS, Stretches, Tried, ratio_of, stretches};
use super::{SeenRows, WrittenRow};
use crate::import::columns::{Columns, How};
use crate::import::mapping::{SAY_IT, line};
use crate::import::meaning::Meaning;
use crate::import::units::{self, Unit};

/// A wheel may be off by so much; the units that are closest lie 10 % apart.
pub(super) const NEAR: f64 = 0.06;
/// Named units are believed where the distances agree so.
const MAY_BE: std::ops::Range<f64> = 0.8..1.25;

/// What evidence decides.
const DECIDED: [Meaning; 3] = [Meaning::Time, Meaning::Location, Meaning::Speed];

impl SeenRows {
    /// Units of time, location and speed that nothing names.
    ///
    /// # Errors
    /// Names the candidates, and the line that decides.
    pub fn units(&self, columns: &mut Columns) -> Result<Vec<String>, String> {
        self.forces(columns);
        for (meaning, unit) in &self.behind {
            if let Some(column) = columns.of.get_mut(meaning).filter(|column| column.unit.is_none()) {
                column.unit = Some(*unit);
                column.how = How::Evidence(format!("{} stands behind the values", unit.name));
            }
        }
        let is_number = columns.kind.has_unit();
        let unnamed = |meaning: &Meaning| columns.of.get(meaning).is_some_and(|column| column.unit.is_none());
        let unknown: Vec<Meaning> =
            DECIDED.into_iter().filter(unnamed).filter(|meaning| *meaning != Meaning::Time || is_number).collect();
        let stretches = match stretches(&self.rows, columns) {
            Ok(stretches) => stretches,
            Err(_) if unknown.is_empty() => return Ok(Vec::new()),
            Err(why) => return Err(not_decided(columns, &unknown, &[], &why)),
        };
        let tried = stretches.tried(columns, &unknown);
        let agree: Vec<Tried> = tried.iter().filter(|(ratio, _)| (ratio - 1.0).abs() < NEAR).copied().collect();
        match agree.as_slice() {
            [] if unknown.is_empty() => {
                let ratio = tried.first().map_or(1.0, |(ratio, _)| *ratio);
                let is_denied = !is_said(columns) && is_denied(columns, ratio, &stretches);
                if is_denied {
                    Err(format!("units: {}", contradiction(columns, ratio, &stretches)))
                } else {
                    Ok(vec![figure(ratio)])
                }
            }
            // Speeds that are none, a limit or a target, have a median that some units explain.
            [_] if !unknown.is_empty() && stretches.alike < LEAST_ALIKE => {
                let why = format!(
                    "speed and location agree in {:.0} % of the stretches only, expected at least {:.0} %: is it the speed of the train? With these units their median agrees",
                    100.0 * stretches.alike,
                    100.0 * LEAST_ALIKE
                );
                Err(not_decided(columns, &unknown, &agree, &why))
            }
            [(ratio, found)] => Ok(take(columns, &unknown, (*ratio, found))),
            [] => Err(not_decided(columns, &unknown, &[], "no units make the distance by speed that by location")),
            several => Err(not_decided(columns, &unknown, several, "these agree alike")),
        }
    }

    /// What is to be warned of: the distances do not agree in the units that a person or a header said.
    pub fn doubt(&self, columns: &Columns) -> Option<String> {
        let stretches = stretches(&self.rows, columns).ok()?;
        let (ratio, _) = stretches.tried(columns, &[]).first().copied()?;
        if is_said(columns) {
            let is_denied = is_denied(columns, ratio, &stretches);
            return is_denied
                .then(|| format!("units of the mapping are believed: {}", contradiction(columns, ratio, &stretches)));
        }
        is_off(columns, ratio).then(|| {
            format!("speed or location: expected 1 within {NEAR}, found: {}; look at both columns", figure(ratio))
        })
    }
}

/// Units by evidence. Out: the figure, and what stands in headers in their places.
fn take(columns: &mut Columns, unknown: &[Meaning], (ratio, found): (f64, &[Unit])) -> Vec<String> {
    let mut notes = vec![figure(ratio)];
    for (meaning, unit) in DECIDED.into_iter().zip(found).filter(|(meaning, _)| unknown.contains(meaning)) {
        if let Some(column) = columns.of.get_mut(&meaning) {
            notes.extend(column.unknown_unit().map(|written| {
                format!("column {:?}: {written:?} is no unit that is known, {} is taken", column.header, unit.name)
            }));
            column.unit = Some(*unit);
            column.how = How::Evidence(format!("distance by location over distance by speed is {ratio:.4}"));
        }
    }
    notes
}

/// Whether these rows alone deny the units that were decided of all files. Never what a person said.
pub(super) fn deny(rows: &[WrittenRow], columns: &Columns) -> bool {
    !is_said(columns) && ratio_of(rows, columns).is_some_and(|ratio| !MAY_BE.contains(&ratio))
}

/// That the distances do not agree in the named units, and the line with those in which they would.
fn contradiction(columns: &Columns, ratio: f64, stretches: &Stretches) -> String {
    let others = others(columns, ratio, stretches);
    let remedy = if others.is_empty() {
        "look at the columns; a unit that --mapping gives is believed".to_owned()
    } else {
        format!("{SAY_IT} (or the unit of the header, which is believed there): {}", others.join(" or "))
    };
    format!("expected 1, found: {}; {remedy}", figure(ratio))
}

/// The distances differ by more than a wheel makes, and by more than positions that jitter, whose way is too long.
fn is_off(columns: &Columns, ratio: f64) -> bool {
    (ratio - 1.0).abs() > NEAR && (columns.has(Meaning::Location) || ratio < 1.0)
}

/// Whether the distances deny the units: they are far apart, or others are right that nobody named.
fn is_denied(columns: &Columns, ratio: f64, stretches: &Stretches) -> bool {
    let is_off = is_off(columns, ratio) && stretches.alike >= LEAST_ALIKE;
    !MAY_BE.contains(&ratio) || is_off && !others(columns, ratio, stretches).is_empty()
}

/// Lines of a mapping with units in which the distances would agree.
fn others(columns: &Columns, ratio: f64, stretches: &Stretches) -> Vec<String> {
    let of = |meaning: Meaning| units::of(meaning).iter().map(move |unit| (meaning, *unit));
    of(Meaning::Location)
        .filter(|_| columns.has(Meaning::Location))
        .chain(of(Meaning::Speed))
        .filter(|(meaning, unit)| {
            let named = columns.unit(*meaning).map_or(1.0, Unit::factor);
            let change = unit.factor() / named;
            let ratio = if *meaning == Meaning::Speed { ratio / change } else { ratio * change };
            let mps = if *meaning == Meaning::Speed {
                unit.to_si(stretches.fastest)
            } else {
                columns.unit(Meaning::Speed).map_or(1.0, |unit| unit.to_si(stretches.fastest))
            };
            (ratio - 1.0).abs() < NEAR && OF_TRAINS_MPS.contains(&mps)
        })
        .map(|(meaning, unit)| line([(meaning, columns.header(meaning), format!("unit = {:?}", unit.name))]))
        .collect()
}

/// A person said what place or speed are in.
fn is_said(columns: &Columns) -> bool {
    let said = |meaning| columns.of.get(meaning).is_some_and(|column| column.how == How::Mapping);
    [Meaning::Location, Meaning::Speed].iter().any(said)
}

fn figure(ratio: f64) -> String {
    format!("distance by location over distance by speed is {ratio:.4} with these units")
}

fn not_decided(columns: &Columns, unknown: &[Meaning], agree: &[Tried], why: &str) -> String {
    let keys: Vec<&str> = unknown.iter().map(|meaning| meaning.key()).collect();
    let foreign = unknown.iter().find_map(|meaning| columns.of.get(meaning)?.unknown_unit());
    let found = foreign.map_or_else(|| "none".to_owned(), |unit| format!("{unit:?}"));
    let place = |meaning: &Meaning| DECIDED.iter().position(|one| one == meaning).unwrap_or(0);
    let sets: Vec<String> = agree
        .iter()
        .map(|(ratio, set)| {
            let names: Vec<&str> = unknown.iter().map(|meaning| set[place(meaning)].name).collect();
            format!("{} ({ratio:.3})", names.join(" with "))
        })
        .collect();
    let lists: Vec<String> = unknown
        .iter()
        .map(|meaning| units::candidates(*meaning).iter().map(|unit| unit.name).collect::<Vec<_>>().join(", "))
        .collect();
    let candidates = if sets.is_empty() { lists.join("; ") } else { sets.join(" or ") };
    let said = unknown.iter().map(|meaning| {
        let unit = agree.first().map(|(_, set)| set[place(meaning)]).or(units::candidates(*meaning).first().copied());
        (*meaning, columns.header(*meaning), format!("unit = {:?}", unit.map_or("", |unit| unit.name)))
    });
    format!(
        "{}: expected a unit, found {found} in the header, and {why}: {candidates}; {SAY_IT} (or another unit): {}",
        keys.join(" and "),
        line(said)
    )
}
