//! Latitude and longitude under each other's name.

use super::SeenRows;
use super::decided::NEAR;
use super::ratios::usual;
use super::stretches::{OF_TRAINS_MPS, pieces};
use super::written::WrittenRow;
use crate::import::columns::Columns;
use crate::import::geo;
use crate::import::mapping::{SAY_IT, SourceMapping, line};
use crate::import::meaning::Meaning;
use crate::import::units::{self, Unit};
use rundown_files::statistics::median;

/// Ways by positions are compared in chords of so many metres, of which so many decide.
const CHORD_M: f64 = 150.0;
const LEAST_CHORDS: usize = 20;
/// Positions that are named rightly are nearer than this to the way, and those that are not are so many times as far as
/// the others.
const WAY_NEAR: f64 = 0.025;
const FARTHER: f64 = 3.0;

/// The first of them that is such, where most are: a single wrong fix says nothing of the others.
pub fn mostly<T: Copy>(all: impl Iterator<Item = T>, is_such: impl Fn(&T) -> bool) -> Option<T> {
    let (mut first, mut such, mut count) = (None, 0_usize, 0_usize);
    for one in all {
        count += 1;
        if is_such(&one) {
            such += 1;
            first = first.or(Some(one));
        }
    }
    first.filter(|_| 2 * such > count)
}

impl SeenRows {
    /// Latitude and longitude under each other's name: most are no latitudes, or the way by positions agrees with that
    /// by location or speed once they are exchanged, and not as they are named. Out: that they were exchanged, with the
    /// figures.
    ///
    /// # Errors
    /// The mapping names them so.
    pub fn exchanged(&mut self, columns: &mut Columns, mapping: &SourceMapping) -> Result<Option<String>, String> {
        let of = |meaning: Meaning| columns.of.get(&meaning).filter(|column| column.unit.is_some_and(Unit::is_degrees));
        let Some((latitude, longitude)) = of(Meaning::Latitude).zip(of(Meaning::Longitude)) else { return Ok(None) };
        // Rows without a fix are at no place.
        let fixes = || self.rows.iter().filter_map(|row| row.numbers[3].zip(row.numbers[4]));
        let fixes = || fixes().filter(|fix| *fix != (0.0, 0.0));
        let beyond = mostly(fixes(), |(latitude, _)| latitude.abs() > 90.0);
        let are_degrees = fixes().all(|(first, second)| first.abs() <= 180.0 && second.abs() <= 90.0);
        let why = match beyond.filter(|_| are_degrees) {
            Some((first, _)) => format!("{first} is no latitude"),
            None => match self.exchanged_ways(columns) {
                Some(why) => why,
                None => return Ok(None),
            },
        };
        let [first, second] = [&latitude.header, &longitude.header].map(Clone::clone);
        if [Meaning::Latitude, Meaning::Longitude].iter().any(|meaning| mapping.columns.contains_key(meaning)) {
            let said = [(Meaning::Latitude, second.as_str()), (Meaning::Longitude, first.as_str())];
            let said = said.map(|(meaning, header)| (meaning, header, String::new()));
            return Err(format!("latitude and longitude are exchanged: {why}; {SAY_IT}: {}", line(said)));
        }
        let [latitude, longitude] = [longitude.clone(), latitude.clone()];
        columns.of.insert(Meaning::Latitude, latitude);
        columns.of.insert(Meaning::Longitude, longitude);
        self.rows.iter_mut().for_each(|row| row.numbers.swap(3, 4));
        Ok(Some(format!("column {second:?} is taken for the latitude and {first:?} for the longitude: {why}")))
    }

    /// How the ways say that they are exchanged. Where nothing names the unit of the speed, beside which alone they go:
    /// no unit of trains agrees with the positions as they are named, and one only once they are exchanged.
    fn exchanged_ways(&self, columns: &Columns) -> Option<String> {
        let by = if columns.has(Meaning::Location) { Meaning::Location } else { Meaning::Speed };
        let figures = |[named, other]: [f64; 2], unit: &str| {
            format!(
                "the way by positions is {named:.4} of that by {}{unit} as the columns are named, and {other:.4} once they are exchanged",
                by.key()
            )
        };
        if let Some(unit) = columns.unit(by) {
            return self.ways(columns, unit).filter(|ways| is_other_way(*ways)).map(|ways| figures(ways, ""));
        }
        // Of a location without a unit its speed decides that first.
        let (fastest, _) = usual(&pieces(&self.rows, columns)).filter(|_| by == Meaning::Speed)?;
        let of_trains = units::candidates(by).iter().filter(|unit| OF_TRAINS_MPS.contains(&unit.to_si(fastest)));
        let tried: Vec<(&Unit, [f64; 2])> =
            of_trains.filter_map(|unit| Some((unit, self.ways(columns, *unit)?))).collect();
        let is_named_rightly = tried.iter().any(|(_, [named, _])| (named - 1.0).abs() < NEAR);
        let mut agree = tried.iter().filter(|(_, ways)| is_other_way(*ways));
        let (unit, ways) = agree.next().filter(|_| !is_named_rightly)?;
        agree.next().is_none().then(|| figures(*ways, &format!(" in {}, and no other unit agrees,", unit.name)))
    }

    /// The way by positions over that by location, or by speed, in this unit, as the columns are named and once they
    /// are exchanged: medians over chords. None where too few rows show it.
    fn ways(&self, columns: &Columns, unit: Unit) -> Option<[f64; 2]> {
        let located = columns.has(Meaning::Location);
        let passing = |row: &WrittenRow| {
            let [_, location, speed, latitude, longitude] = row.numbers;
            let fix = latitude.zip(longitude).filter(|fix| *fix != (0.0, 0.0))?;
            let time = row.time(columns)?;
            let time_s = if columns.kind.has_unit() { columns.unit(Meaning::Time)?.to_si(time) } else { time };
            Some((time_s, fix, unit.to_si(if located { location? } else { speed? })))
        };
        let mut ratios: [Vec<f64>; 2] = [Vec::new(), Vec::new()];
        let mut begin: Option<((f64, f64), f64)> = None;
        let mut before: Option<(f64, f64)> = None;
        for row in &self.rows {
            let Some((time_s, fix, other)) = passing(row) else { continue };
            let goes_on = before.filter(|(last_s, _)| time_s > *last_s && time_s - last_s < 60.0);
            let (from, way_m) = match goes_on.zip(begin) {
                Some(((last_s, last), (from, way_m))) => {
                    (from, way_m + if located { other - last } else { 0.5 * (other + last) * (time_s - last_s) })
                }
                None => (fix, 0.0),
            };
            begin = Some((from, way_m));
            before = Some((time_s, other));
            if way_m.abs() >= CHORD_M {
                let turned = |(latitude, longitude): (f64, f64)| (longitude, latitude);
                let chords_m = [geo::distance_m(from, fix), geo::distance_m(turned(from), turned(fix))];
                ratios.iter_mut().zip(chords_m).for_each(|(ratios, chord_m)| ratios.push(chord_m / way_m.abs()));
                begin = Some((fix, 0.0));
            }
        }
        let [named, other] = ratios.map(|ratios| median(&ratios).filter(|_| ratios.len() >= LEAST_CHORDS));
        Some([named?, other?])
    }
}

/// Exchanged positions go the way, and those as they are named do not.
fn is_other_way([named, exchanged]: [f64; 2]) -> bool {
    let [off, left] = [named, exchanged].map(|ratio| (ratio - 1.0).abs());
    left < WAY_NEAR && off > WAY_NEAR && off > FARTHER * left
}
