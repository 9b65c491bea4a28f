//! The header of a run log: which column is where, and what that makes of a row.

use super::{Complaint, MOST_LOCATION_M, MOST_SPEED_KMH, OtherColumn, Sample};
use csv::StringRecord;

const TIME: usize = 0;
pub(super) const LOCATION: usize = 1;
const SPEED: usize = 2;
const LATITUDE: usize = 3;
const LONGITUDE: usize = 4;
const EFFORT: usize = 5;
const AMBIENT: usize = 6;
const HEADWIND: usize = 7;
/// The columns that mean something, in the order of the constants above.
const COLUMNS: [&str; 8] = [
    "time_s",
    "location_m",
    "speed_kmh",
    "latitude_deg",
    "longitude_deg",
    "effort_n_per_kg",
    "ambient_temperature_c",
    "headwind_mps",
];

/// Which column is where.
pub(super) struct Header {
    names: Vec<String>,
    positions: [Option<usize>; COLUMNS.len()],
    /// Positions of the columns that the format does not know.
    pub(super) others: Vec<usize>,
}

/// No clock in seconds is beyond this, three thousand years. One in milliseconds since 1970 is.
const LATEST_S: f64 = 1e11;

impl Header {
    pub(super) fn read(record: &StringRecord, line: u64) -> Result<Self, Complaint> {
        let names: Vec<String> = record.iter().map(str::to_owned).collect();
        let mut header = Self { positions: [None; COLUMNS.len()], others: Vec::new(), names };
        for (index, name) in header.names.iter().enumerate() {
            let Some(known) = COLUMNS.iter().position(|column| column == name) else {
                header.others.push(index);
                continue;
            };
            if let Some(before) = header.positions[known].replace(index) {
                return Err(Complaint {
                    line,
                    column: Some((index + 1, name.clone())),
                    message: format!("expected each column once, found it also as column {}", before + 1),
                });
            }
        }
        header.mandatory(line)?;
        Ok(header)
    }

    fn mandatory(&self, line: u64) -> Result<(), Complaint> {
        let coordinates = self.position(LATITUDE).is_some() && self.position(LONGITUDE).is_some();
        let missing: Vec<&str> = [TIME, LOCATION, SPEED]
            .into_iter()
            .filter(|column| self.position(*column).is_none())
            .filter(|column| !(*column == LOCATION && coordinates))
            .map(|column| COLUMNS[column])
            .collect();
        if missing.is_empty() {
            return Ok(());
        }
        let found = shortened(&self.names.join(","));
        let hint = match self.names.as_slice() {
            [only] if only.contains(';') => "; the separator must be a comma, not a semicolon",
            [only] if only.contains('\t') => "; the separator must be a comma, not a tab",
            _ if missing == ["location_m"] => "; latitude_deg and longitude_deg together may stand for it",
            _ => "",
        };
        Err(Complaint {
            line,
            column: None,
            message: format!("expected a header with {}, found {found:?}{hint}", missing.join(" and ")),
        })
    }

    pub(super) fn position(&self, column: usize) -> Option<usize> {
        self.positions[column]
    }

    pub(super) fn other_columns(&self) -> Vec<OtherColumn> {
        let named = |position: &usize| OtherColumn { name: self.names[*position].clone(), fields: Vec::new() };
        self.others.iter().map(named).collect()
    }

    fn complaint(&self, line: u64, column: usize, message: String) -> Complaint {
        let number = self.position(column).map_or(0, |position| position + 1);
        Complaint { line, column: Some((number, COLUMNS[column].to_owned())), message }
    }

    pub(super) fn sample(&self, record: &StringRecord, line: u64) -> Result<Sample, Complaint> {
        if record.len() != self.names.len() {
            return Err(Complaint {
                line,
                column: None,
                message: format!("expected {} fields as in the header, found {}", self.names.len(), record.len()),
            });
        }
        let number = |column: usize| -> Result<Option<f64>, Complaint> {
            let field = self.position(column).map_or("", |position| &record[position]);
            if field.is_empty() {
                return Ok(None);
            }
            field.parse().map(Some).map_err(|_| {
                let found = shortened(field);
                let message = format!("expected a number, found {found:?} (an empty field is a missing sample)");
                self.complaint(line, column, message)
            })
        };
        let time_s = match number(TIME)? {
            Some(time_s) if time_s.abs() <= LATEST_S => time_s,
            Some(time_s) => {
                let message = format!("expected a time in s, at most {LATEST_S:e}, found {time_s:e}");
                return Err(self.complaint(line, TIME, message));
            }
            None => {
                return Err(self.complaint(line, TIME, "expected a time, found an empty field".to_owned()));
            }
        };
        Ok(Sample {
            line,
            time_s,
            location_m: number(LOCATION)?,
            speed_kmh: number(SPEED)?,
            latitude_deg: number(LATITUDE)?,
            longitude_deg: number(LONGITUDE)?,
            effort_n_per_kg: number(EFFORT)?,
            ambient_temperature_c: number(AMBIENT)?,
            headwind_mps: number(HEADWIND)?,
        })
    }

    /// What can be read and looks wrong. `latest_s` is the largest time so far.
    pub(super) fn doubts(&self, sample: &Sample, latest_s: f64) -> Vec<Complaint> {
        let mut doubts = Vec::new();
        let mut doubt = |column, message| doubts.push(self.complaint(sample.line, column, message));
        if sample.time_s <= latest_s {
            doubt(TIME, format!("expected a time after {latest_s}, found {}", sample.time_s));
        }
        for (column, value, most) in [
            (LOCATION, sample.location_m, MOST_LOCATION_M),
            (SPEED, sample.speed_kmh, MOST_SPEED_KMH),
            (LATITUDE, sample.latitude_deg, 90.0),
            (LONGITUDE, sample.longitude_deg, 180.0),
            (EFFORT, sample.effort_n_per_kg, 10.0),
        ] {
            match value {
                Some(value) if !value.is_finite() => doubt(column, format!("expected a finite number, found {value}")),
                Some(value) if column == SPEED && value < 0.0 => {
                    doubt(column, format!("expected a speed of 0 or more, found {value}"));
                }
                // Not `{value}`: 1e300 would be three hundred digits.
                Some(value) if value.abs() > most => {
                    doubt(column, format!("expected at most {most}, found {value:e}"));
                }
                _ => {}
            }
        }
        doubts
    }
}

/// The beginning of a text that may be a whole file.
fn shortened(text: &str) -> String {
    const LONGEST: usize = 60;
    let mut short: String = text.chars().take(LONGEST).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    short
}
