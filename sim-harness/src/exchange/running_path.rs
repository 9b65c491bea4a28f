//! A running path of railtoolkit's schema, YAML, as a track file.

use super::yaml;
use rundown::model::track::Gradient;
use rundown_files::refusal::{Place, ReadError};
use rundown_files::track_file::{SpeedLimit, TrackFile};
use serde::Deserialize;
use std::path::Path;

/// What `schema` of a file says.
pub(super) const SCHEMA: &str = "https://railtoolkit.org/schema/running-path.json";

#[derive(Deserialize)]
struct File {
    paths: Vec<RunningPath>,
}

#[derive(Deserialize)]
struct RunningPath {
    id: String,
    characteristic_sections: Vec<Section>,
    #[serde(default)]
    points_of_interest: Vec<serde_json::Value>,
}

/// A section up to the next one; in older files a list instead of names.
#[derive(Deserialize)]
#[serde(untagged)]
enum Section {
    Named { position: f64, speed: Option<f64>, resistance: Option<f64> },
    Listed(f64, f64, f64),
}

/// Position in m, permitted speed in km/h, resistance in permille.
fn values(section: &Section) -> (f64, Option<f64>, Option<f64>) {
    match *section {
        Section::Named { position, speed, resistance } => (position, speed, resistance),
        Section::Listed(position, speed, resistance) => (position, Some(speed), Some(resistance)),
    }
}

/// The track, and what was lost or needs to be known.
pub(super) fn read(path: &Path, text: &str) -> Result<(TrackFile, Vec<String>), ReadError> {
    let file: File = yaml::read(path, text, "a running path of railtoolkit")?;
    let refuse = |field: &str, message: String| ReadError::from(Place::of_file(path).refuse(field, message));
    let running = file.paths.first().ok_or_else(|| refuse("paths", "expected one, found none".to_owned()))?;
    let mut sections: Vec<_> = running.characteristic_sections.iter().map(values).collect();
    sections.sort_by(|a, b| a.0.total_cmp(&b.0));
    let ([(first_m, ..), ..], Some((last_m, ..))) = (&sections[..], sections.last()) else {
        return Err(refuse("paths[0].characteristic_sections", "expected two or more, found none".to_owned()));
    };
    let (first_m, length_m) = (*first_m, last_m - first_m);
    // The last one marks the end.
    let sections = &sections[..sections.len() - 1];
    let gradient = sections.iter().filter_map(|(position, _, permille)| {
        permille.map(|permille| Gradient { from_m: position - first_m, permille })
    });
    let speed_limit =
        sections.iter().filter_map(|(position, kmh, _)| kmh.map(|kmh| SpeedLimit { from_m: position - first_m, kmh }));
    let track = TrackFile {
        name: running.id.clone(),
        length_m,
        gradient: gradient.collect(),
        speed_limit: speed_limit.collect(),
        ..TrackFile::default()
    };
    let mut notes =
        vec!["the resistance of the path is taken as gradient; resistance in curves may be part of it".to_owned()];
    if first_m != 0.0 {
        notes.push(format!("locations begin at 0: {first_m} m was subtracted"));
    }
    if !running.points_of_interest.is_empty() {
        notes.push(format!("not kept: {} points of interest", running.points_of_interest.len()));
    }
    if file.paths.len() > 1 {
        notes.push(format!("read is the first of {} paths", file.paths.len()));
    }
    Ok((track, notes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sections_become_gradients_and_limits() {
        let text = "schema: https://railtoolkit.org/schema/running-path.json\npaths:\n  - id: hill\n    \
            points_of_interest: [{position: 150, label: a, measure: front}]\n    characteristic_sections:\n      \
            - {position: 100, speed: 80, resistance: 5}\n      - {position: 600, speed: 60}\n      \
            - {position: 2100, speed: 60, resistance: -3}\n";
        let (track, notes) = read("p.yaml".as_ref(), text).unwrap();
        assert_eq!((track.length_m, track.gradient.len(), track.speed_limit.len()), (2000.0, 1, 2));
        assert_eq!(track.gradient[0], Gradient { from_m: 0.0, permille: 5.0 });
        assert_eq!(track.speed_limit[1], SpeedLimit { from_m: 500.0, kmh: 60.0 });
        assert_eq!(notes[1], "locations begin at 0: 100 m was subtracted");
        assert_eq!(notes[2], "not kept: 1 points of interest");
        let error = read("p.yaml".as_ref(), "paths:\n  - id: x\n").unwrap_err().to_string();
        assert!(error.starts_with("p.yaml:2:"), "{error}");
    }
}
