//! The columns of files with one header: which holds what, in which unit, and how that is known.

use super::clock::{ClockKind, DateOrder};
use super::mapping::{ColumnMapping, SAY_IT, SourceMapping, line};
use super::meaning::Meaning;
use super::source::is_of_another;
use super::source::row::Header;
use super::units::{self, Unit};
use jiff::tz::TimeZone;
use std::collections::BTreeMap;

/// How something is known.
#[derive(Clone, Debug, PartialEq)]
pub enum How {
    Mapping,
    Header,
    /// No name says it, and no other column has such a unit.
    UnitAlone,
    /// With the figure.
    Evidence(String),
    Assumed,
    NotNeeded,
    Unknown,
}

impl How {
    pub fn words(&self) -> String {
        match self {
            Self::Mapping => "by the mapping".to_owned(),
            Self::Header => "by the header".to_owned(),
            Self::UnitAlone => "by its unit, which no other column has".to_owned(),
            Self::Evidence(figure) => format!("by evidence: {figure}"),
            Self::Assumed => "assumed".to_owned(),
            Self::NotNeeded => String::new(),
            Self::Unknown => "not known".to_owned(),
        }
    }
}

#[derive(Clone, Debug)]
pub struct Column {
    pub index: usize,
    pub header: String,
    /// What leads to it in a mapping: `#4` where the header stands before, too.
    name: String,
    pub unit: Option<Unit>,
    pub how: How,
    /// What stands in the header as its unit.
    written: Option<String>,
}

impl Column {
    fn new(index: usize, headers: &[Header], unit: Option<Unit>, how: How) -> Self {
        let header = headers[index].written.clone();
        let is_led_to = !header.is_empty() && index_of(headers, &header) == Some(index);
        let name = if is_led_to { header.clone() } else { format!("#{}", index + 1) };
        Self { index, header, name, unit, how, written: headers[index].unit.clone() }
    }

    /// What its header has as a unit and is none that is known: `MN`, `rpm`, not `actual` or `GPS`.
    pub fn unknown_unit(&self) -> Option<&str> {
        self.written.as_deref().filter(|written| self.unit.is_none() && units::is_foreign(written))
    }
}

/// What trains weigh; a number of tonnes is less, but for the heaviest.
const OF_TRAINS_KG: std::ops::RangeInclusive<f64> = 2e3..=1e8;

/// What the fields of a row mean.
#[derive(Clone, Debug)]
pub struct Columns {
    pub of: BTreeMap<Meaning, Column>,
    pub kind: ClockKind,
    pub order: DateOrder,
    pub zone: TimeZone,
    pub zone_name: Option<String>,
    /// The times have their zones.
    pub has_zone: bool,
    /// Speeds below zero are those of a train that goes back.
    pub is_signed: bool,
    pub decimal: char,
    pub rotating_mass_kg: Option<f64>,
    pub unit_name: Option<String>,
}

/// The columns by mapping and names; units by mapping and header as far as they say so.
///
/// # Errors
/// What the mapping asks for and the file does not have.
pub fn find(headers: &[Header], mapping: &SourceMapping, decimal: char) -> Result<Columns, String> {
    let mut of = BTreeMap::new();
    let mut taken: Vec<usize> = Vec::new();
    for (meaning, mapped) in &mapping.columns {
        if mapped.name.is_empty() {
            continue;
        }
        let index = index_of(headers, &mapped.name).ok_or_else(|| {
            let names: Vec<&str> = headers.iter().map(|header| header.written.as_str()).collect();
            format!("columns.{}: expected one of {}, found {:?}", meaning.key(), names.join(", "), mapped.name)
        })?;
        // A date and a time may stand in one column.
        let is_shared = taken.contains(&index) && *meaning != Meaning::Date;
        if is_shared {
            return Err(format!(
                "columns.{}: expected a column of its own, found {:?} again",
                meaning.key(),
                headers[index].written
            ));
        }
        taken.push(index);
        let (unit, how) = unit_of(*meaning, &headers[index], Some(mapped))?;
        of.insert(*meaning, Column::new(index, headers, unit, how));
    }
    let names: Vec<String> = headers
        .iter()
        .enumerate()
        .map(|(i, header)| if taken.contains(&i) || is_misnamed(header) { String::new() } else { header.name.clone() })
        .collect();
    for (meaning, index) in Meaning::of_names(&names) {
        if !mapping.columns.contains_key(&meaning) {
            let (unit, how) = unit_of(meaning, &headers[index], None)?;
            of.insert(meaning, Column::new(index, headers, unit, how));
        }
    }
    for meaning in [Meaning::Speed, Meaning::Location] {
        if !mapping.columns.contains_key(&meaning)
            && let Some(column) = by_unit_alone(meaning, headers, &of)
        {
            of.insert(meaning, column);
        }
    }
    // A date alone is a time.
    if !of.contains_key(&Meaning::Time)
        && let Some(date) = of.remove(&Meaning::Date)
    {
        of.insert(Meaning::Time, date);
    }
    let zone_name = mapping.zone.clone();
    let zone = zone_name.as_deref().map_or(Ok(TimeZone::UTC), |name| {
        TimeZone::get(name).map_err(|_| format!("zone: expected a name such as Europe/Berlin, found {name:?}"))
    })?;
    let (rotating_mass_kg, unit_name) = (mass_of(mapping)?, mapping.unit.clone());
    Ok(Columns {
        of,
        kind: ClockKind::Number,
        order: DateOrder::Ymd,
        zone,
        zone_name,
        has_zone: false,
        is_signed: mapping.columns.get(&Meaning::Speed).and_then(|speed| speed.signed).unwrap_or(false),
        decimal,
        rotating_mass_kg,
        unit_name,
    })
}

/// The rotating mass of a mapping, kg.
fn mass_of(mapping: &SourceMapping) -> Result<Option<f64>, String> {
    match mapping.rotating_mass_kg {
        Some(mass) if !OF_TRAINS_KG.contains(&mass) => {
            let [least, most] = [OF_TRAINS_KG.start(), OF_TRAINS_KG.end()];
            Err(format!("rotating_mass_kg: expected kg, {least} to {most}, found {mass}"))
        }
        mass => Ok(mass),
    }
}

/// `Tempo [km/h]` is no time.
fn is_misnamed(header: &Header) -> bool {
    let named = Meaning::of_names(std::slice::from_ref(&header.name));
    let is_of_name = |meaning: Meaning| {
        let unit = header.unit.as_deref().and_then(|unit| units::by_name(meaning, unit));
        // `effort_kn` is no speed in knots.
        meaning.is_speed() || meaning.is_force() && unit.is_some()
    };
    // `Zug [kN]` and `Trip [km]` are measured.
    let is_run = named.iter().any(|(meaning, _)| *meaning == Meaning::Run);
    let is_measured = is_run && header.unit.as_deref().is_some_and(units::is_known);
    !named.iter().any(|(meaning, _)| is_of_name(*meaning)) && header.unit_of(Meaning::Speed).is_some() || is_measured
}

/// What no name says: the only column without a meaning that has such a unit. A place needs it only where there is
/// none, and a named speed to try it against.
fn by_unit_alone(meaning: Meaning, headers: &[Header], of: &BTreeMap<Meaning, Column>) -> Option<Column> {
    let located = of.contains_key(&Meaning::Latitude) && of.contains_key(&Meaning::Longitude);
    let named_speed = of.get(&Meaning::Speed).is_some_and(|speed| speed.how != How::UnitAlone);
    if of.contains_key(&meaning) || meaning == Meaning::Location && (located || !named_speed) {
        return None;
    }
    let mut candidates = unused(headers, of).filter_map(|(index, header)| {
        let unit = header.unit_of(meaning).filter(|_| !is_of_another(&header.written))?;
        Some(Column::new(index, headers, Some(unit), How::UnitAlone))
    });
    let only = candidates.next()?;
    candidates.next().is_none().then_some(only)
}

fn quoted<'a>(headers: impl Iterator<Item = &'a Header>) -> String {
    headers.map(|header| format!("{:?}", header.written)).collect::<Vec<_>>().join(", ")
}

/// Columns without a meaning.
fn unused<'a>(headers: &'a [Header], of: &'a BTreeMap<Meaning, Column>) -> impl Iterator<Item = (usize, &'a Header)> {
    headers.iter().enumerate().filter(|(index, _)| !of.values().any(|column| column.index == *index))
}

fn index_of(headers: &[Header], name: &str) -> Option<usize> {
    let number = name.strip_prefix('#').and_then(|number| number.parse::<usize>().ok());
    if let Some(number) = number {
        return number.checked_sub(1).filter(|index| *index < headers.len());
    }
    let same = |header: &Header| header.written.trim() == name.trim();
    let alike =
        |header: &Header| header.written.trim().to_lowercase() == name.trim().to_lowercase() || header.name == name;
    headers.iter().position(same).or_else(|| headers.iter().position(alike))
}

fn unit_of(meaning: Meaning, header: &Header, mapped: Option<&ColumnMapping>) -> Result<(Option<Unit>, How), String> {
    if units::of(meaning).is_empty() {
        return Ok((None, How::NotNeeded));
    }
    if let Some(name) = mapped.and_then(|mapped| mapped.unit.as_deref()) {
        let unit = units::by_name(meaning, name).ok_or_else(|| {
            let names: Vec<&str> = units::of(meaning).iter().map(|unit| unit.name).collect();
            format!("columns.{}.unit: expected one of {}, found {name:?}", meaning.key(), names.join(", "))
        })?;
        return Ok((Some(unit), How::Mapping));
    }
    let unit = header.unit.as_deref().and_then(|name| units::by_name(meaning, name));
    Ok(match (meaning, unit) {
        (_, Some(unit)) => (Some(unit), How::Header),
        (Meaning::Latitude | Meaning::Longitude, None) => (units::by_name(meaning, "degrees"), How::Header),
        (Meaning::Altitude, None) => (units::by_name(meaning, "m"), How::Assumed),
        (Meaning::Temperature, None) => (units::by_name(meaning, "°C"), How::Assumed),
        _ => (None, How::Unknown),
    })
}

impl Columns {
    pub fn has(&self, meaning: Meaning) -> bool {
        self.of.contains_key(&meaning)
    }

    pub fn unit(&self, meaning: Meaning) -> Option<Unit> {
        self.of.get(&meaning).and_then(|column| column.unit)
    }

    /// Its header as it stands; empty where it has none.
    pub fn header(&self, meaning: Meaning) -> &str {
        self.of.get(&meaning).map_or("", |column| &column.header)
    }

    pub fn index(&self, meaning: Meaning) -> Option<usize> {
        self.of.get(&meaning).map(|column| column.index)
    }

    /// Headers of the columns that are not used, quoted.
    pub fn unused(&self, headers: &[Header]) -> String {
        quoted(unused(headers, &self.of).map(|(_, header)| header))
    }

    /// Headers of those without a name that is known, or that is not that of what they hold, quoted.
    pub fn nameless(&self, headers: &[Header]) -> String {
        quoted(
            unused(headers, &self.of)
                .map(|(_, header)| header)
                .filter(|header| !header.name.is_empty())
                .filter(|header| Meaning::of_name(&header.name).is_none_or(|meaning| !self.has(meaning))),
        )
    }

    /// What is said of names that stand several times, of which one is used.
    pub fn repeated(&self, headers: &[Header]) -> Vec<String> {
        let of_column = |(meaning, column): (&Meaning, &Column)| {
            let written = headers[column.index].written.as_str();
            let same: Vec<usize> =
                (1..).zip(headers).filter(|(_, one)| one.written == written).map(|(n, _)| n).collect();
            let used = column.index + 1;
            let other = same.iter().find(|number| **number != used).filter(|_| !written.is_empty())?;
            let all: Vec<String> = same.iter().map(|number| format!("#{number}")).collect();
            Some(format!(
                "column {written:?} stands {} times ({}): #{used} is used; for another one {SAY_IT}: {}",
                same.len(),
                all.join(", "),
                line([(*meaning, &*format!("#{other}"), String::new())])
            ))
        };
        self.of.iter().filter_map(of_column).collect()
    }

    /// What is said of columns that another one goes before.
    pub fn outranked(&self, headers: &[Header]) -> Vec<String> {
        let by_name = |meaning: Meaning| {
            let taken = self.of.get(&meaning)?;
            let of_name =
                |header: &&Header| Meaning::of_name(&header.name) == Some(meaning) && header.written != taken.header;
            let others = quoted(unused(headers, &self.of).map(|(_, header)| header).filter(of_name));
            let key = meaning.key();
            (!others.is_empty())
                .then(|| format!("not used, for another column has the {key} ({:?}): {others}", taken.header))
        };
        Meaning::ALL.into_iter().filter_map(by_name).collect()
    }

    /// The columns that are not used, and the line for `--mapping` that takes one for `meaning`; nothing where all are
    /// used.
    pub fn remedy(&self, meaning: Meaning, headers: &[Header]) -> String {
        let left: Vec<&Header> = unused(headers, &self.of).map(|(_, header)| header).collect();
        let mut may_be = left.iter().filter(|header| !is_of_another(&header.written));
        let likely = may_be.clone().find(|header| header.unit_of(meaning).is_some()).or(may_be.next()).or(left.first());
        let Some(likely) = likely else { return String::new() };
        format!(
            "; not used: {}. If one of them is the {}, {SAY_IT}: {}",
            self.unused(headers),
            meaning.key(),
            line([(meaning, likely.written.as_str(), String::new())])
        )
    }

    /// As `import.toml` has them.
    pub fn mapped(&self) -> BTreeMap<Meaning, ColumnMapping> {
        let dated = if self.has(Meaning::Date) { Meaning::Date } else { Meaning::Time };
        let mapped = |(meaning, column): (&Meaning, &Column)| {
            let is_dated = *meaning == dated && (self.kind == ClockKind::DateTime || self.kind.is_of_day());
            let is_time = *meaning == Meaning::Time;
            let unit = column.unit.filter(|_| !is_time || self.kind.has_unit());
            let column = ColumnMapping {
                name: column.name.clone(),
                unit: unit.map(|unit| unit.name.to_owned()),
                kind: is_time.then_some(self.kind),
                order: is_dated.then_some(self.order),
                signed: (*meaning == Meaning::Speed && self.is_signed).then_some(true),
            };
            (*meaning, column)
        };
        let mut columns: BTreeMap<Meaning, ColumnMapping> = self.of.iter().map(mapped).collect();
        for meaning in Meaning::ALL {
            columns.entry(meaning).or_default();
        }
        columns
    }
}
