//! One sample of a run, and [`COLUMNS`], the table by which CSV and Parquet are read and written. What a file has in
//! other units is SI from here on.

use crate::column::{About, Kind};
use rundown::{model::effects::Surroundings, model::units::KmPerHour, tick::measurement::Measurement};

/// One row of a log. What is missing is `None`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Line of the log, counted from 1.
    pub line: u64,
    /// Time on any monotonic clock, s.
    pub time_s: f64,
    /// Location of the front along the track, m.
    pub location_m: Option<f64>,
    /// Measured speed, m/s.
    pub speed_mps: Option<f64>,
    /// WGS 84, degrees.
    pub latitude_deg: Option<f64>,
    /// WGS 84, degrees.
    pub longitude_deg: Option<f64>,
    /// Measured applied effort F/(γ m), N/kg, traction positive, brake negative.
    pub effort_n_per_kg: Option<f64>,
    /// Ambient temperature, °C.
    pub temperature_c: Option<f64>,
    /// Wind component against the direction of travel, m/s.
    pub headwind_mps: Option<f64>,
    /// The speed is no reading, but was computed from the locations.
    pub speed_is_computed: bool,
}

/// A column of numbers.
#[derive(Clone, Copy, Debug)]
pub struct NumberColumn {
    /// Its name in a file.
    pub name: &'static str,
    /// The file's unit.
    pub unit: &'static str,
    /// What it says.
    pub meaning: &'static str,
    /// No log goes without it, but for [`LOCATION`] where there are coordinates.
    pub needed: bool,
    /// What a value may be in the file's unit. One beyond is warned of and handed on; a time beyond makes a bad row.
    pub range: (f64, f64),
    /// Takes the file's value into a sample.
    pub set: fn(&mut Sample, f64),
    /// Removes the value from a sample; the time stays.
    pub clear: fn(&mut Sample),
    /// The sample's value in the file's unit.
    pub get: fn(&Sample) -> Option<f64>,
}

const NOT_READ: &str = "there is no reading";

/// Name of the column without which a row is none.
pub const TIME: &str = "time_s";
/// Name of the column that coordinates may stand for.
pub const LOCATION: &str = "location_m";
/// Name of the column that says of a speed that it is none of the recorder.
const COMPUTED: &str = "speed_is_computed";
const COORDINATES: [&str; 2] = ["latitude_deg", "longitude_deg"];

/// No train is further along its line, m; a location beyond it is warned of.
pub const MOST_LOCATION_M: f64 = 1e7;
/// No train is faster, km/h; a speed above it is warned of.
pub const MOST_SPEED_KMH: f64 = 1e3;
/// No clock in seconds is beyond this, three thousand years. One in milliseconds since 1970 is.
const LATEST_S: f64 = 1e11;

/// A column that stands as it is in the field of this name.
macro_rules! column {
    ($name:expr, $unit:literal, $meaning:literal, $needed:literal, $range:expr, $field:ident) => {
        NumberColumn {
            name: $name,
            unit: $unit,
            meaning: $meaning,
            needed: $needed,
            range: $range,
            set: |sample, value| sample.$field = Some(value),
            clear: |sample| sample.$field = None,
            get: |sample| sample.$field,
        }
    };
}

/// The columns that mean something, those of CSV and of Parquet.
pub const COLUMNS: [NumberColumn; 9] = [
    NumberColumn {
        name: TIME,
        unit: "s",
        meaning: "time on any clock that only goes forward",
        needed: true,
        range: (-LATEST_S, LATEST_S),
        set: |sample, time_s| sample.time_s = time_s,
        clear: |_| {},
        get: |sample| Some(sample.time_s),
    },
    column!(
        LOCATION,
        "m",
        "location of the front along the track",
        true,
        (-MOST_LOCATION_M, MOST_LOCATION_M),
        location_m
    ),
    NumberColumn {
        name: "speed_kmh",
        unit: "km/h",
        meaning: "speed reading",
        needed: true,
        range: (0.0, MOST_SPEED_KMH),
        set: |sample, kmh| sample.speed_mps = Some(KmPerHour(kmh).to_mps()),
        clear: |sample| sample.speed_mps = None,
        // Readings are km/h with a few decimals; the detour through m/s must not leave crumbs.
        get: |sample| sample.speed_mps.map(|mps| (3.6e6 * mps).round() / 1e6),
    },
    column!(COORDINATES[0], "degrees", "latitude, WGS 84", false, (-90.0, 90.0), latitude_deg),
    column!(COORDINATES[1], "degrees", "longitude, WGS 84", false, (-180.0, 180.0), longitude_deg),
    column!(
        "effort_n_per_kg",
        "N/kg",
        "applied effort F/(γ m), traction positive, brake negative",
        false,
        (-10.0, 10.0),
        effort_n_per_kg
    ),
    column!("ambient_temperature_c", "°C", "ambient temperature", false, (-60.0, 80.0), temperature_c),
    column!(
        "headwind_mps",
        "m/s",
        "wind component against the direction of travel",
        false,
        (-60.0, 60.0),
        headwind_mps
    ),
    NumberColumn {
        name: COMPUTED,
        unit: "1",
        meaning: "1: the speed is no reading, but was computed from the locations",
        needed: false,
        range: (0.0, 1.0),
        set: |sample, value| sample.speed_is_computed = value != 0.0,
        clear: |sample| sample.speed_is_computed = false,
        get: |sample| sample.speed_is_computed.then_some(1.0),
    },
];

/// Names of needed columns that a file does not have.
pub(crate) fn missing(has: impl Fn(&str) -> bool) -> Vec<&'static str> {
    let coordinates = COORDINATES.iter().all(|name| has(name));
    let absent = COLUMNS.iter().filter(|column| column.needed && !has(column.name));
    absent.map(|column| column.name).filter(|name| !(*name == LOCATION && coordinates)).collect()
}

impl NumberColumn {
    /// What it is, without its values.
    pub fn about(&self) -> About {
        About {
            name: self.name.to_owned(),
            kind: Kind::Number,
            unit: self.unit,
            meaning: self.meaning.to_owned(),
            empty: match self.name {
                TIME => "",
                COMPUTED => "it is a reading",
                _ => NOT_READ,
            },
        }
    }

    /// What makes a value of the file doubtful.
    pub(crate) fn doubt(&self, value: f64) -> Option<String> {
        let (least, most) = self.range;
        if !value.is_finite() {
            return Some(format!("expected a finite number, found {value}"));
        }
        // Not `{value}`: 1e300 would be three hundred digits.
        (!(least..=most).contains(&value)).then(|| format!("expected {least} to {most} {}, found {value:?}", self.unit))
    }
}

impl Sample {
    /// What the estimator gets.
    pub fn measurement(&self) -> Measurement {
        let Self { time_s, location_m, speed_mps, effort_n_per_kg, .. } = *self;
        Measurement { time_s, location_m, speed_mps, effort_n_per_kg }
    }

    /// Takes the temperature into what is known of the surroundings. An empty field, or one that a board refuses: as it
    /// was.
    pub fn update(&self, surroundings: &mut Surroundings) {
        let now = Surroundings { temperature_c: self.temperature_c.or(surroundings.temperature_c), ..*surroundings };
        if now.are_plausible() {
            *surroundings = now;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_column_has_a_field_of_its_own_and_gives_back_what_it_took() {
        for (index, column) in COLUMNS.iter().enumerate() {
            let mut sample = Sample::default();
            (column.set)(&mut sample, 1.0);
            let found = COLUMNS.map(|column| (column.get)(&sample));
            let mut expected = [None; COLUMNS.len()];
            expected[0] = Some(0.0);
            expected[index] = Some(1.0);
            assert_eq!(found, expected, "{}", column.name);
            (column.clear)(&mut sample);
            expected[index] = if column.name == TIME { Some(1.0) } else { None };
            assert_eq!(COLUMNS.map(|column| (column.get)(&sample)), expected, "{}", column.name);
        }
    }

    #[test]
    fn the_document_of_formats_has_these_columns_and_units() {
        let text = include_str!("../../../docs/formats.md");
        for column in COLUMNS {
            let row = text.lines().find(|line| line.starts_with('|') && line.contains(&format!("`{}`", column.name)));
            let row = row.unwrap_or_else(|| panic!("docs/formats.md: expected a row for {}", column.name));
            assert!(row.split('|').nth(2).is_some_and(|unit| unit.trim() == column.unit), "{row}");
        }
    }
}
