//! A running path of railtoolkit's schema, YAML, as a track file.

use super::yaml;
use rundown::model::track::Gradient;
use rundown_files::refusal::{Place, ReadError, Refusal};
use rundown_files::track_file::{SpeedLimit, TrackFile};
use serde::Deserialize;
use serde_saphyr::{Location, Spanned};
use std::ops::RangeInclusive;
use std::path::Path;

/// What `schema` of a file says.
pub(super) const SCHEMA: &str = "https://railtoolkit.org/schema/running-path.json";

/// No train on rails was faster; what is above is in another unit.
const MOST_KMH: f64 = 700.0;
/// As in a track file.
const PERMILLE: RangeInclusive<f64> = -200.0..=200.0;

#[derive(Deserialize)]
struct PathFile {
    paths: Vec<RunningPath>,
}

#[derive(Deserialize)]
struct RunningPath {
    id: String,
    characteristic_sections: Spanned<Vec<Spanned<Section>>>,
    #[serde(default)]
    points_of_interest: Vec<serde_json::Value>,
}

/// A section up to the next one; in older files a list instead of names, of which newer ones need not have both values.
#[derive(Clone, Copy, Deserialize)]
#[serde(untagged)]
enum Section {
    Named { position: f64, speed: Option<f64>, resistance: Option<f64> },
    Listed(f64, f64, f64),
}

/// The values of a section.
#[derive(Clone, Copy)]
struct Values {
    position_m: f64,
    kmh: Option<f64>,
    permille: Option<f64>,
}

impl From<Section> for Values {
    fn from(section: Section) -> Self {
        match section {
            Section::Named { position, speed, resistance } => {
                Self { position_m: position, kmh: speed, permille: resistance }
            }
            Section::Listed(position_m, kmh, permille) => Self { position_m, kmh: Some(kmh), permille: Some(permille) },
        }
    }
}

fn refuse(path: &Path, at: Location, field: &str, message: String) -> ReadError {
    let place = Place { file: path.to_owned(), line: Some(at.line() as usize), column: Some(at.column() as usize) };
    place.refuse(format!("paths[0].characteristic_sections{field}"), message).into()
}

/// The sections, in the order of the file: a section holds from its position up to the next one's, so that positions
/// must rise.
fn sections(path: &Path, found: &Spanned<Vec<Spanned<Section>>>) -> Result<Vec<Values>, ReadError> {
    let mut sections: Vec<Values> = Vec::new();
    for (index, section) in found.value.iter().enumerate() {
        let values = Values::from(section.value);
        let refuse = |field: &str, expected: String, found: f64| {
            let message = format!("expected {expected}, found {found}");
            Err(refuse(path, section.referenced, &format!("[{index}].{field}"), message))
        };
        let position_m = values.position_m;
        let before_m = sections.last().map(|before| before.position_m);
        if let Some(before_m) = before_m.filter(|before_m| position_m <= *before_m) {
            let expected = format!("beyond {before_m}, as a track's locations rise from section to section");
            return refuse("position", expected, position_m);
        }
        if let Some(kmh) = values.kmh.filter(|kmh| !(*kmh > 0.0 && *kmh <= MOST_KMH)) {
            return refuse("speed", format!("above 0 to {MOST_KMH} km/h"), kmh);
        }
        if let Some(permille) = values.permille.filter(|permille| !PERMILLE.contains(permille)) {
            let expected = format!("{} to {} permille", PERMILLE.start(), PERMILLE.end());
            return refuse("resistance", expected, permille);
        }
        sections.push(values);
    }
    if sections.len() < 2 {
        let message =
            format!("expected at least two sections, the last of which marks the end, found {}", sections.len());
        return Err(refuse(path, found.referenced, "", message));
    }
    Ok(sections)
}

/// The track, and what was lost or needs to be known.
pub(super) fn read(path: &Path, text: &str) -> Result<(TrackFile, Vec<String>), ReadError> {
    let file: PathFile = yaml::read(path, text, "a running path of railtoolkit")?;
    let of_file = |field: &str, message: String| ReadError::from(Place::of_file(path).refuse(field, message));
    let running = file.paths.first().ok_or_else(|| of_file("paths", "expected one, found none".to_owned()))?;
    let sections = sections(path, &running.characteristic_sections)?;
    let (Some(first), Some((last, sections))) = (sections.first(), sections.split_last()) else {
        return Err(of_file("paths[0].characteristic_sections", "expected sections, found none".to_owned()));
    };
    let first_m = first.position_m;
    let gradient = sections.iter().filter_map(|section| {
        section.permille.map(|permille| Gradient { from_m: section.position_m - first_m, permille })
    });
    let speed_limit = sections
        .iter()
        .filter_map(|section| section.kmh.map(|kmh| SpeedLimit { from_m: section.position_m - first_m, kmh }));
    let track = TrackFile {
        name: running.id.clone(),
        length_m: last.position_m - first_m,
        gradient: gradient.collect(),
        speed_limit: speed_limit.collect(),
        ..TrackFile::default()
    };
    check(&track).map_err(|message| of_file("paths[0]", message))?;
    let mut notes =
        vec!["the resistance of the path is taken as gradient; resistance in curves may be part of it".to_owned()];
    notes.extend(lacking(sections, "resistance", "the gradient", |section| section.permille.is_some()));
    notes.extend(lacking(sections, "speed", "the speed limit", |section| section.kmh.is_some()));
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

/// A track file may hold less than a path; lines of a track file that nobody has seen are not named.
fn check(track: &TrackFile) -> Result<(), String> {
    let text = toml::to_string(track).map_err(|error| error.to_string())?;
    TrackFile::parse(Path::new(""), &text).map(|_| ()).map_err(|error| match error {
        ReadError::Refused(Refusal { field, message, .. }) => format!("as a track, {field}: {message}"),
        other => other.to_string(),
    })
}

/// What becomes of sections without a value.
fn lacking(sections: &[Values], name: &str, what: &str, has: impl Fn(&Values) -> bool) -> Option<String> {
    let without: Vec<String> =
        sections.iter().filter(|section| !has(section)).map(|section| section.position_m.to_string()).collect();
    if without.is_empty() {
        return None;
    }
    let begin = if sections.first().is_some_and(has) { "" } else { "; before the first value the track has none" };
    Some(format!(
        "sections without {name}, at {} m: {what} of the section before is taken to hold on{begin}",
        without.join(", ")
    ))
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
        let lacking = "sections without resistance, at 600 m: the gradient of the section before is taken to hold on";
        assert_eq!(notes[1], lacking);
        assert_eq!(notes[2], "locations begin at 0: 100 m was subtracted");
        assert_eq!(notes[3], "not kept: 1 points of interest");
        let error = read("p.yaml".as_ref(), "paths:\n  - id: x\n").unwrap_err().to_string();
        assert!(error.starts_with("p.yaml:2:"), "{error}");
    }

    fn of_sections(sections: &[&str]) -> Result<(TrackFile, Vec<String>), String> {
        let lines: String = sections.iter().map(|section| format!("      - {section}\n")).collect();
        let text = format!("paths:\n  - id: hill\n    characteristic_sections:\n{lines}");
        read("p.yaml".as_ref(), &text).map_err(|error| error.to_string())
    }

    #[test]
    fn what_no_track_has_is_refused_where_it_stands() {
        let fine = "{position: 0, speed: 80, resistance: 5}";
        for (sections, expected) in [
            (
                &["{position: 2100, speed: 80, resistance: 5}", "{position: 600, speed: 60, resistance: -3}"][..],
                "p.yaml:5:9: paths[0].characteristic_sections[1].position: \
                 expected beyond 2100, as a track's locations rise from section to section, found 600",
            ),
            (
                &[fine, "[0, 60, 1]"],
                "p.yaml:5:9: paths[0].characteristic_sections[1].position: \
                 expected beyond 0, as a track's locations rise from section to section, found 0",
            ),
            (
                &[fine],
                "p.yaml:4:7: paths[0].characteristic_sections: \
                 expected at least two sections, the last of which marks the end, found 1",
            ),
            (
                &[fine, "{position: 10, speed: 8000, resistance: 0}", "[20, 60, 1]"],
                "p.yaml:5:9: paths[0].characteristic_sections[1].speed: expected above 0 to 700 km/h, found 8000",
            ),
            (
                &[fine, "[10, 60, 500]"],
                "p.yaml:5:9: paths[0].characteristic_sections[1].resistance: \
                 expected -200 to 200 permille, found 500",
            ),
        ] {
            assert_eq!(of_sections(sections).map(|_| ()).unwrap_err(), expected);
        }
        let many: Vec<String> = (0..5000).map(|index| format!("[{index}, 60, 1]")).collect();
        let many: Vec<&str> = many.iter().map(String::as_str).collect();
        let error = of_sections(&many).map(|_| ()).unwrap_err();
        assert!(error.starts_with("p.yaml: paths[0]: as a track, gradient["), "{error}");
        assert!(error.contains("expected at most") && error.ends_with("found 4999"), "{error}");
    }

    #[test]
    fn a_value_that_the_first_section_lacks_is_said_to_be_missing() {
        let sections = ["{position: 0, resistance: 5}", "{position: 900, speed: 60}", "[2000, 60, 1]"];
        let (track, notes) = of_sections(&sections).unwrap();
        assert_eq!(track.speed_limit, [SpeedLimit { from_m: 900.0, kmh: 60.0 }]);
        let speed = "sections without speed, at 0 m: the speed limit of the section before is taken to hold on; \
                     before the first value the track has none";
        assert!(notes.iter().any(|note| note == speed), "{notes:?}");
        let (_, notes) = of_sections(&["[0, 80, 5]", "[10, 60, 1]"]).unwrap();
        assert_eq!(notes.len(), 1, "{notes:?}");
    }
}
