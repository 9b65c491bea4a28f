//! Is a log another one again? A run that is given twice would teach twice, and stand on both sides of a hold-out.
//!
//! Two logs are the same where all their readings are, to the last digit; a clock that was set and the lines of the file do not count. Where few readings
//! differ from one another, as while a train stands, the times must agree, too.

use rundown_files::recording::Recording;
use rundown_files::sample::Sample;
use std::collections::HashMap;
use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};

/// So many changes of the location are no chance, whatever the clock says.
const LEAST_MOVED: usize = 20;

/// The logs that have been seen, by a digest of their readings: rows need not be kept.
#[derive(Clone, Debug, Default)]
pub struct Seen(HashMap<u64, String>);

impl Seen {
    /// The earlier log with the same readings, by its file; none where this one is new. Call it before anything is put right.
    pub fn earlier(&mut self, recording: &Recording) -> Option<&str> {
        if recording.rows.is_empty() {
            return None;
        }
        let digest = digest(&recording.rows);
        if self.0.contains_key(&digest) {
            return self.0.get(&digest).map(String::as_str);
        }
        self.0.insert(digest, called(recording));
        None
    }
}

/// The file of a run, or its name where one file has several.
fn called(recording: &Recording) -> String {
    let file = recording.path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let has_own_file = recording.path.file_stem().is_some_and(|stem| *stem == *recording.name);
    if has_own_file { file } else { recording.name.clone() }
}

fn digest(rows: &[Sample]) -> u64 {
    let mut hasher = DefaultHasher::new();
    let moved = rows.windows(2).filter(|pair| pair[0].location_m != pair[1].location_m).count();
    rows.len().hash(&mut hasher);
    for row in rows {
        let with_clock = (moved < LEAST_MOVED).then_some(row.time_s);
        let Sample { location_m, speed_mps, effort_n_per_kg, latitude_deg, longitude_deg, .. } = *row;
        for value in [with_clock, location_m, speed_mps, effort_n_per_kg, latitude_deg, longitude_deg] {
            value.map(f64::to_bits).hash(&mut hasher);
        }
    }
    hasher.finish()
}
