//! Rows whose speeds and locations are compared, in parts without a gap.

use crate::agreement::compared::{Differences, Row};
use crate::rows::times::{located_step_s, longest_step_s};
use crate::rows::ways;
use rundown_files::sample::Sample;

/// A location that is off by more is another chainage, m ...
const MOST_JUMP_M: f64 = 300.0;
/// ... beside this share of the way since the one before it, by which no wheel is off.
const MOST_SHARE: f64 = 0.1;

/// Rows with time, location and speed, the location growing, cut where the time or the location does not go on as
/// usual.
///
/// `step_s`: usual time between rows, s.
pub fn parts(rows: &[Sample], step_s: f64) -> Vec<Vec<Row>> {
    cut(rows.iter().filter(|row| row.location_m.is_some()), ways::heading(rows), longest_step_s(step_s), 0.0)
}

/// The same for comparing ways: where only some rows have a location, those between them with their speeds, and without
/// a location (not a number), for the way of dense speeds is known however far the locations are apart.
///
/// `located_s`: usual time between rows with a location, s.
pub fn compared(rows: &[Sample], step_s: f64, located_s: f64) -> Vec<Vec<Row>> {
    let longest_s = longest_step_s(step_s);
    if located_s <= longest_s {
        return parts(rows, step_s);
    }
    cut(rows.iter(), ways::heading(rows), longest_s, MOST_SHARE)
}

/// What is compared of a run.
pub(crate) fn differences(rows: &[Sample], step_s: f64) -> Differences {
    Differences::of(&compared(rows, step_s, located_step_s(rows)))
}

/// Rows with a speed, cut after more than `longest_s`, and where the location is off by more than a jump and this share
/// of the way since the one before it.
fn cut<'a>(rows: impl Iterator<Item = &'a Sample>, sign: f64, longest_s: f64, most_share: f64) -> Vec<Vec<Row>> {
    let mut parts: Vec<Vec<Row>> = vec![Vec::new()];
    // The location before, and the way by speed since.
    let (mut before_m, mut way_m): (Option<f64>, f64) = (None, 0.0);
    for row in rows {
        let Some(speed_mps) = row.speed_mps else { continue };
        let location_m = row.location_m.map(|m| sign * m);
        let mut goes_on = true;
        if let Some(last) = parts.last().and_then(|part| part.last()) {
            let dt = row.time_s - last.time_s;
            if dt <= 0.0 {
                continue;
            }
            way_m += 0.5 * dt * (speed_mps + last.speed_mps);
            let jump_m = location_m.zip(before_m).map_or(0.0, |(here_m, before_m)| here_m - before_m - way_m);
            goes_on = dt <= longest_s && jump_m.abs() <= MOST_JUMP_M + most_share * way_m;
        }
        if !goes_on {
            parts.push(Vec::new());
            (before_m, way_m) = (None, 0.0);
        }
        if location_m.is_some() {
            (before_m, way_m) = (location_m, 0.0);
        }
        if let Some(part) = parts.last_mut() {
            part.push(Row { time_s: row.time_s, location_m: location_m.unwrap_or(f64::NAN), speed_mps });
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_between_seldom_locations_are_those_of_the_speeds() {
        // A location every 30 s, of a train that starts; one row is missing.
        let row = |t: u32| Sample {
            time_s: f64::from(t),
            speed_mps: Some(0.2 * f64::from(t)),
            location_m: t.is_multiple_of(30).then(|| 0.1 * f64::from(t * t)),
            ..Sample::default()
        };
        let rows: Vec<Sample> = (0..180).filter(|t| *t != 50).map(row).collect();
        let found = compared(&rows, 1.0, 30.0);
        assert_eq!((found.len(), found[0].len()), (1, rows.len()));
        let differences = crate::agreement::compared::Differences::of(&found);
        assert!(differences.dt.iter().all(|dt| *dt == 30.0), "{:?}", differences.dt);
        assert!(differences.y.iter().all(|metres| metres.abs() < 0.1), "{:?}", differences.y);
        assert!(differences.y.len() >= 4);
        // Rows that all have one are compared as they are.
        let whole: Vec<Sample> = rows.iter().filter(|row| row.location_m.is_some()).copied().collect();
        assert_eq!(compared(&whole, 30.0, 30.0), parts(&whole, 30.0));
    }
}
