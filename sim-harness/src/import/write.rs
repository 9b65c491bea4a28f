//! The runs of an import, and where they may be written.

use super::chainage::{Placed, Placing};
use super::cut::STOP_S;
use super::line::{self, TimedFix};
use super::skeleton::Passed;
use super::staged::{Mark, Staged};
use super::stretch::fix;
use crate::output::files::failed;
use rundown_check::rows::ways::step_ahead_m;
use rundown_files::WriteError;
use rundown_files::folder::{self, MANIFEST};
use rundown_files::map_matching::{CentreLine, MatchState};
use rundown_files::sample::COLUMNS;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// What stands in every folder that an import wrote.
pub const ACCOUNT: &str = "import.json";

/// Whether an import may write there.
///
/// # Errors
/// The folder holds something that no import wrote.
pub fn may_write(to: &Path) -> Result<(), WriteError> {
    let is_empty = !to.exists() || fs::read_dir(to).is_ok_and(|mut inside| inside.next().is_none());
    if is_empty {
        return Ok(());
    }
    let lacks = match folder::files_of("import", to)? {
        _ if !to.join(ACCOUNT).is_file() => ACCOUNT.to_owned(),
        None => format!("a {MANIFEST} of `rundown import`"),
        Some(_) => return Ok(()),
    };
    let message = format!("expected no folder, an empty one or one of `rundown import`, found one without {lacks}");
    Err(failed(to, io::Error::new(io::ErrorKind::AlreadyExists, message)))
}

/// A run as it was written.
#[derive(Debug)]
pub struct WrittenRun {
    pub is_up: bool,
    pub ends_m: (f64, f64),
    /// Rows whose positions gave no location.
    pub lost: u64,
    pub passed: Passed,
}

/// Writes a run whose place is known.
///
/// # Errors
/// It cannot be written.
pub fn run(run: &Staged, place: &Placing, placed: &Placed, folder: &Path) -> Result<WrittenRun, WriteError> {
    let path = folder.join(format!("{}.csv", run.name));
    let has = run.has;
    let matcher = CentreLine::new(&placed.line);
    let mut state = MatchState::default();
    let (mut ends, mut last_m, mut lost) = ((f64::INFINITY, f64::NEG_INFINITY), None, 0);
    let mut ahead_m = 0.0;
    let written = File::create(&path).and_then(|file| {
        let mut file = BufWriter::new(file);
        let names: Vec<&str> = COLUMNS.iter().zip(has).filter(|(_, has)| *has).map(|(column, _)| column.name).collect();
        writeln!(file, "{}", names.join(","))?;
        run.read(&mut |mut sample| {
            match place {
                Placing::Shift { factor, offset_m, .. } => {
                    sample.location_m = sample.location_m.map(|m| offset_m + factor * m)
                }
                _ => {
                    let found = matcher.as_ref().and_then(|line| {
                        line.locate(&mut state, sample.time_s, sample.latitude_deg, sample.longitude_deg).ok()
                    });
                    lost += u64::from(found.is_none() && fix(&sample).is_some());
                    sample.location_m = found.map(|found| found.location_m);
                }
            }
            if let Some(at_m) = sample.location_m {
                ends = (ends.0.min(at_m), ends.1.max(at_m));
                // The last location alone may be a zero that a recorder writes as it ends.
                ahead_m += step_ahead_m(last_m.replace(at_m).unwrap_or(at_m), at_m);
            }
            sample.time_s -= run.begin_s;
            let values = COLUMNS.iter().zip(has).filter(|(_, has)| *has);
            let values: Vec<String> = values
                .map(|(column, _)| (column.get)(&sample).map_or_else(String::new, |value| short(column.name, value)))
                .collect();
            writeln!(file, "{}", values.join(","))
        })?;
        file.flush()
    });
    written.map_err(|error| failed(&path, error))?;
    let (low, high) = if ends.0 <= ends.1 { ends } else { (0.0, 0.0) };
    Ok(WrittenRun {
        is_up: ahead_m >= 0.0,
        ends_m: (low, high),
        lost,
        passed: passed(run, place, matcher.as_ref(), (low, high)),
    })
}

/// As few digits as the reading deserves.
fn short(name: &str, value: f64) -> String {
    let digits = match name {
        "location_m" => 1e3,
        "latitude_deg" | "longitude_deg" => 1e8,
        _ => 1e6,
    };
    let rounded = (value * digits).round() / digits;
    (if rounded == 0.0 { 0.0 } else { rounded }).to_string()
}

fn passed(run: &Staged, place: &Placing, line: Option<&CentreLine>, ends_m: (f64, f64)) -> Passed {
    let mut state = MatchState::default();
    let located: Vec<(f64, f64, Option<f64>)> = match (place, line) {
        (Placing::Shift { factor, offset_m, .. }, _) => {
            let of = |mark: &Mark| (mark.at_m, offset_m + factor * mark.at_m, mark.altitude_m);
            run.marks().iter().map(of).collect()
        }
        (_, Some(line)) => {
            let of = |fix: &TimedFix| Some((fix.at_m, fix.on(line, &mut state)?.location_m, fix.altitude_m));
            line::fixes(run).iter().filter_map(of).collect()
        }
        (_, None) => Vec::new(),
    };
    let nearest = |own_m: f64| {
        located.iter().min_by(|a, b| (a.0 - own_m).abs().total_cmp(&(b.0 - own_m).abs())).map(|found| found.1)
    };
    let stops_m = run.stops.iter().filter(|(_, seconds)| *seconds >= STOP_S).filter_map(|(at_m, _)| match place {
        Placing::Shift { factor, offset_m, .. } => Some(offset_m + factor * at_m),
        _ => nearest(*at_m),
    });
    Passed {
        ends_m,
        stops_m: stops_m.collect(),
        altitudes: located.iter().filter_map(|(_, at_m, altitude)| Some((*at_m, (*altitude)?))).collect(),
    }
}
