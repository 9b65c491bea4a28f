//! Sentences of satellite receivers: RMC for time, position and speed, GGA for the height; checksums are checked.

use super::csv;
use super::row::{Each, Event, Header, RowField};
use nmea::ParseResult;
use rundown_files::refusal::ReadError;
use std::path::Path;

pub fn headers() -> Vec<Header> {
    ["time", "latitude [degrees]", "longitude [degrees]", "altitude [m]", "speed [knots]"].map(Header::new).to_vec()
}

/// The sentences of one second.
#[derive(Default)]
struct Epoch {
    line: u64,
    of_day: String,
    date: String,
    fields: [Option<f64>; 4],
}

impl Epoch {
    fn emit(&self, each: &mut Each) -> bool {
        if self.of_day.is_empty() {
            return true;
        }
        let time = if self.date.is_empty() { self.of_day.clone() } else { format!("{}T{}Z", self.date, self.of_day) };
        let mut row = vec![RowField::Text(time)];
        row.extend(self.fields.map(|value| value.map_or(RowField::Empty, RowField::Number)));
        each(Event::Row(self.line, &row))
    }
}

pub fn rows(path: &Path, each: &mut Each) -> Result<(), ReadError> {
    let mut epoch = Epoch::default();
    let mut goes_on = true;
    csv::lines(path, &mut |number, line| {
        // Some loggers write their own clock before the sentence.
        let Some(sentence) = line.find('$').map(|at| line[at..].trim()) else {
            return true;
        };
        let parsed = nmea::parse_str(sentence);
        let (time, valid) = match &parsed {
            Ok(ParseResult::RMC(rmc)) => {
                (rmc.fix_time, rmc.status_of_fix != nmea::sentences::rmc::RmcStatusOfFix::Invalid)
            }
            Ok(ParseResult::GGA(gga)) => (gga.fix_time, true),
            Ok(_) | Err(nmea::Error::Unsupported(_) | nmea::Error::Unknown(_) | nmea::Error::DisabledSentence) => {
                return true;
            }
            Err(error) => {
                let found: String = sentence.chars().take(40).collect();
                goes_on = each(Event::Bad(
                    number,
                    format!("expected a sentence with its checksum, found {found:?}: {error}"),
                ));
                return goes_on;
            }
        };
        let Some(time) = time else {
            return true;
        };
        let of_day = time.to_string();
        if of_day != epoch.of_day {
            goes_on = epoch.emit(each);
            epoch = Epoch { line: number, of_day, date: epoch.date.clone(), ..Epoch::default() };
        }
        match parsed {
            Ok(ParseResult::RMC(rmc)) => {
                if let Some(date) = rmc.fix_date {
                    epoch.date = date.to_string();
                }
                if valid {
                    let speed = rmc.speed_over_ground.map(|knots| (f64::from(knots) * 1e4).round() / 1e4);
                    epoch.fields = [rmc.lat, rmc.lon, epoch.fields[2], speed];
                }
            }
            Ok(ParseResult::GGA(gga)) => {
                epoch.fields[0] = epoch.fields[0].or(gga.latitude);
                epoch.fields[1] = epoch.fields[1].or(gga.longitude);
                epoch.fields[2] = gga.altitude.map(|metres| (f64::from(metres) * 1e3).round() / 1e3);
            }
            _ => {}
        }
        goes_on
    })?;
    if goes_on {
        epoch.emit(each);
    }
    Ok(())
}
