//! Distances by location over those by speed, of all stretches of some files, and the units that they allow.

use super::super::columns::Columns;
use super::super::meaning::Meaning;
use super::super::speeds::FASTEST_MPS;
use super::super::units::{self, Unit};
use super::ratios::{Passing, longest, ratios, usual};
use super::written::WrittenRow;
use super::{EXPECTED, ROWS};
use rundown_files::statistics::median;
use rundown_pages::numbers::counted;
use std::collections::BTreeMap;

/// Steps that make a stretch over which distances are compared, and stretches that decide.
pub(super) const STEPS: usize = 20;
/// The same where rows are far apart and stops near.
pub(super) const FEW_STEPS: usize = 5;
const LEAST_STRETCHES: usize = 4;
/// Speed and location are of one train where so many stretches have the usual ratio within that.
pub(super) const LEAST_ALIKE: f64 = 0.8;
pub(super) const ALIKE: f64 = 0.2;
/// What trains do, m/s, and how often recorders write, s.
pub(super) const OF_TRAINS_MPS: std::ops::Range<f64> = 2.0..FASTEST_MPS;
const STEP_S: std::ops::Range<f64> = 0.009..600.0;

/// More steps back of the clock than this share are those of a file with the newest row first.
const NEWEST_FIRST: f64 = 0.9;
/// Where a row has it.
const SPEED: usize = 2;

/// Distance by location over distance by speed with these units.
pub(super) type Tried = (f64, [Unit; 3]);

/// What the moving stretches of some files say.
pub(super) struct Stretches {
    pub(super) ratio: f64,
    /// Share of them that have it.
    pub(super) alike: f64,
    pub(super) fastest: f64,
    step: f64,
}

/// Distance by location over distance by speed in the units that were decided.
pub(super) fn ratio_of(rows: &[WrittenRow], columns: &Columns) -> Option<f64> {
    let stretches = stretches(rows, columns).ok()?;
    stretches.tried(columns, &[]).first().map(|(ratio, _)| *ratio)
}

/// Distances by location over those by speed, in the units of the file.
///
/// # Errors
/// Why they cannot be compared.
pub(super) fn stretches(all: &[WrittenRow], columns: &Columns) -> Result<Stretches, String> {
    let pieces = pieces(all, columns);
    let together = pieces.iter().flatten().count();
    let (mut long, mut short) = (None, None);
    if let Some((fastest, step)) = usual(&pieces).filter(|_| columns.has(Meaning::Speed)) {
        let longest = longest(&pieces, step);
        let counted = |steps, of_place| {
            Stretches::new(ratios(&pieces, columns, [fastest, longest], (steps, of_place)), fastest, step)
        };
        let of = |steps| counted(steps, true);
        long = of(STEPS);
        // A few steps of a location with few digits say nothing.
        let alike = |found: &Stretches| found.alike >= LEAST_ALIKE;
        short = long.is_none().then(|| of(FEW_STEPS)).flatten().filter(alike);
        // Between near stops a place in large steps hardly takes so many.
        short = short.or_else(|| long.is_none().then(|| counted(STEPS, false)).flatten().filter(alike));
    }
    long.or(short).ok_or_else(|| match without_numbers(all, columns) {
        Some(header) => format!("column {header:?} holds no number that can be read{}", within(all.len())),
        None if !columns.has(Meaning::Speed) => "no column has a speed".to_owned(),
        None if together < STEPS * LEAST_STRETCHES => {
            format!("time, speed and location stand together in {} only", counted(together, "row", "rows"))
        }
        None => format!(
            "in {together} rows with speed and location the train hardly ever keeps moving for {FEW_STEPS} locations on end"
        ),
    })
}

/// Rows of each file that have time, place and speed: where columns are sparse others stand between them.
pub(super) fn pieces(all: &[WrittenRow], columns: &Columns) -> Vec<Vec<Passing>> {
    let begins = |row: &WrittenRow| row.time.is_none() && row.numbers[0].is_none();
    all.split(begins).flat_map(|rows| of_trains(rows).into_iter().map(|rows| passings(&rows, columns))).collect()
}

/// Rows of one file by unit and run: several may take turns.
fn of_trains(rows: &[WrittenRow]) -> Vec<Vec<&WrittenRow>> {
    let mut trains: BTreeMap<&[Option<String>; 2], Vec<&WrittenRow>> = BTreeMap::new();
    rows.iter().for_each(|row| trains.entry(&row.of).or_default().push(row));
    trains.into_values().collect()
}

/// Rows of one train. The newest may be written first.
fn passings(rows: &[&WrittenRow], columns: &Columns) -> Vec<Passing> {
    let mut passings = joined(rows, columns);
    let back = passings.windows(2).filter(|pair| pair[1].time < pair[0].time).count();
    if back as f64 > NEWEST_FIRST * passings.len() as f64 {
        passings.reverse();
    }
    passings
}

/// Where the speed hardly ever stands beside the place, it is that of the row before.
fn joined(rows: &[&WrittenRow], columns: &Columns) -> Vec<Passing> {
    let together: Vec<Passing> = rows.iter().filter_map(|row| row.passing(columns)).collect();
    let with_speed = rows.iter().filter(|row| row.numbers[SPEED].is_some()).count();
    if 2 * together.len() >= with_speed {
        return together;
    }
    let mut last = None;
    let with_last = |row: &&WrittenRow| {
        last = row.numbers[SPEED].or(last);
        let mut row = (*row).clone();
        row.numbers[SPEED] = last;
        row.passing(columns)
    };
    rows.iter().filter_map(with_last).collect()
}

/// What was looked at, where that may not be all.
fn within(rows: usize) -> String {
    if rows < ROWS { String::new() } else { format!(" in the first {ROWS} rows") }
}

/// A column that says where the train is or how fast, without a number in any row.
fn without_numbers<'a>(rows: &[WrittenRow], columns: &'a Columns) -> Option<&'a str> {
    let is_empty = |position: usize| rows.iter().all(|row| row.numbers[position].is_none());
    let mut numbered = EXPECTED.iter().enumerate().skip(1);
    let found = numbered.find(|(position, meaning)| columns.has(**meaning) && is_empty(*position));
    found.map(|(_, meaning)| columns.header(*meaning))
}

impl Stretches {
    /// None where they are too few.
    pub(super) fn new(mut ratios: Vec<f64>, fastest: f64, step: f64) -> Option<Self> {
        // A train that stands where its speed is large denies the speed.
        let tried = ratios.len();
        ratios.retain(|ratio| *ratio > 0.0 && ratio.is_finite());
        let ratio = median(&ratios).filter(|_| ratios.len() >= LEAST_STRETCHES)?;
        let alike = ratios.iter().filter(|one| (*one / ratio - 1.0).abs() < ALIKE).count() as f64 / tried as f64;
        Some(Self { ratio, alike, fastest, step })
    }

    /// All units that are known or possible, at speeds of trains and steps of recorders where something is unknown.
    pub(super) fn tried(&self, columns: &Columns, unknown: &[Meaning]) -> Vec<Tried> {
        // A column that is not there is in SI: text gives seconds, positions give metres.
        let units = |meaning, si: &str| -> Vec<Unit> {
            if unknown.contains(&meaning) {
                return units::candidates(meaning).to_vec();
            }
            columns.unit(meaning).or_else(|| units::by_name(meaning, si)).into_iter().collect()
        };
        let is_text = !columns.kind.has_unit();
        let second = || units::by_name(Meaning::Time, "s").into_iter().collect();
        let mut times: Vec<Unit> = if is_text { second() } else { units(Meaning::Time, "s") };
        if unknown.contains(&Meaning::Time) && unknown.contains(&Meaning::Speed) {
            // Tenths of the speed explain as much as tenths of a second, and are more usual.
            times.retain(|unit| !unit.is_of_counter());
        }
        let mut tried = Vec::new();
        for time in times {
            for length in units(Meaning::Location, "m") {
                for speed in units(Meaning::Speed, "m/s") {
                    let factor = length.factor() / (speed.factor() * time.factor());
                    let of_trains = OF_TRAINS_MPS.contains(&speed.to_si(self.fastest));
                    if unknown.is_empty() || (of_trains && STEP_S.contains(&time.to_si(self.step))) {
                        tried.push((factor * self.ratio, [time, length, speed]));
                    }
                }
            }
        }
        tried
    }
}
