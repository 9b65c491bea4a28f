//! Is a log another one again? A run that is given twice would teach twice, and stand on both sides of a hold-out.
//!
//! Two logs are the same where all their readings are, to the last digit; a clock that was set and the lines of the
//! file do not count. Where few readings differ from one another, as while a train stands, the times must agree, too.
//!
//! A log that was cut, or recorded from another time on, has some of the rows of another one. So pieces of rows that no
//! two runs have alike are remembered by their digests, of each log a sample: of all logs those whose digests have the
//! same trailing zeros, so that two samples hold the same pieces.

use rundown_files::recording::Recording;
use rundown_files::sample::Sample;
use std::collections::HashMap;
use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};

/// So many changes of the location are no chance, whatever the clock says.
const LEAST_MOVED: usize = 20;

/// Rows of a piece, and how many different steps of the location make it one of a kind: a held speed leaves an odometer
/// two.
const PIECE: usize = 16;
const LEAST_STEPS: usize = 6;
/// Pieces of a log that are remembered, at most.
const SAMPLE: usize = 96;
/// So many that are another log's are no chance, where so many of them have no row in common: trains that start alike
/// from one place are alike for half a minute, in whole km/h and metres to the last digit, and all pieces of it are.
const LEAST_ALIKE: usize = 6;
const LEAST_APART: usize = 3;

/// The logs that have been seen, by digests of their readings: rows need not be kept.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    whole: HashMap<u64, String>,
    /// The log, by the digest of a piece.
    pieces: HashMap<u64, usize>,
    /// Names of the logs that have pieces, and how many trailing zeros their digests have.
    logs: Vec<(String, u32)>,
}

/// Rows that a log has in common with an earlier one.
#[derive(Clone, Debug, PartialEq)]
pub struct Shared {
    /// Share of its pieces.
    pub share: f64,
    /// The earlier log.
    pub with: String,
}

impl Seen {
    /// The earlier log with the same readings, by its file; none where this one is new. Call it before anything is put
    /// right.
    pub fn earlier(&mut self, recording: &Recording) -> Option<&str> {
        if recording.rows.is_empty() {
            return None;
        }
        let digest = digest(&recording.rows);
        if self.whole.contains_key(&digest) {
            return self.whole.get(&digest).map(String::as_str);
        }
        self.whole.insert(digest, called(recording));
        None
    }

    /// What a log that is none of the earlier ones has in common with the one that it is most like. Call it before
    /// anything is put right.
    pub fn shared(&mut self, recording: &Recording) -> Option<Shared> {
        let (pieces, zeros) = pieces(&recording.rows);
        // Where the pieces begin that are an earlier log's.
        let mut alike: HashMap<usize, Vec<usize>> = HashMap::new();
        for (piece, at) in &pieces {
            if let Some(log) = self.pieces.get(piece) {
                alike.entry(*log).or_default().push(*at);
            }
        }
        let most = alike.into_iter().max_by_key(|(log, begins)| (begins.len(), std::cmp::Reverse(*log)));
        let is_no_chance = |begins: &Vec<usize>| begins.len() >= LEAST_ALIKE && apart(begins) >= LEAST_APART;
        let shared = most.filter(|(_, begins)| is_no_chance(begins)).and_then(|(log, begins)| {
            let (name, its_zeros) = self.logs.get(log)?;
            let both = pieces.iter().filter(|(piece, _)| piece.trailing_zeros() >= *its_zeros).count();
            Some(Shared { share: begins.len() as f64 / both.max(1) as f64, with: name.clone() })
        });
        if !pieces.is_empty() {
            pieces.into_iter().for_each(|(piece, _)| _ = self.pieces.entry(piece).or_insert(self.logs.len()));
            self.logs.push((called(recording), zeros));
        }
        shared
    }
}

/// Most pieces that have no row in common, of those that begin at these rows.
fn apart(begins: &[usize]) -> usize {
    let mut begins = begins.to_vec();
    begins.sort_unstable();
    let (mut count, mut over) = (0, 0);
    for begin in begins {
        if begin >= over {
            (count, over) = (count + 1, begin + PIECE);
        }
    }
    count
}

/// Enough different steps to be no other log's by chance.
fn is_varied(steps: &[Option<i64>]) -> bool {
    let (mut different, mut count) = ([0; LEAST_STEPS], 0);
    for step in steps.iter().flatten() {
        if !different[..count].contains(step) {
            different[count] = *step;
            count += 1;
        }
        if count == LEAST_STEPS {
            return true;
        }
    }
    false
}

/// Digests of a sample of the pieces of a log with the rows at which they begin, and how many trailing zeros they have.
fn pieces(rows: &[Sample]) -> (Vec<(u64, usize)>, u32) {
    let digests: Vec<u64> = rows.iter().map(|row| digest_of(std::slice::from_ref(row), |_| None)).collect();
    let steps: Vec<Option<i64>> =
        rows.windows(2).map(|pair| Some((1e3 * (pair[1].location_m? - pair[0].location_m?)).round() as i64)).collect();
    let mut pieces: Vec<(u64, usize)> = (0..(rows.len() + 1).saturating_sub(PIECE))
        .filter(|at| is_varied(&steps[*at..at + PIECE - 1]))
        .map(|at| {
            let mut hasher = DefaultHasher::new();
            digests[at..at + PIECE].hash(&mut hasher);
            (hasher.finish(), at)
        })
        .collect();
    pieces.sort_unstable();
    pieces.dedup_by_key(|(piece, _)| *piece);
    let mut zeros = 0;
    while pieces.len() > SAMPLE {
        zeros += 1;
        pieces.retain(|(piece, _)| piece.trailing_zeros() >= zeros);
    }
    (pieces, zeros)
}

/// The file of a run, or its name where one file has several.
fn called(recording: &Recording) -> String {
    let file = recording.path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let has_own_file = recording.path.file_stem().is_some_and(|stem| *stem == *recording.name);
    if has_own_file { file } else { recording.name.clone() }
}

fn digest(rows: &[Sample]) -> u64 {
    let moved = rows.windows(2).filter(|pair| pair[0].location_m != pair[1].location_m).count();
    digest_of(rows, |row| (moved < LEAST_MOVED).then_some(row.time_s))
}

fn digest_of(rows: &[Sample], clock: impl Fn(&Sample) -> Option<f64>) -> u64 {
    let mut hasher = DefaultHasher::new();
    rows.len().hash(&mut hasher);
    for row in rows {
        let Sample { location_m, speed_mps, effort_n_per_kg, latitude_deg, longitude_deg, .. } = *row;
        for value in [clock(row), location_m, speed_mps, effort_n_per_kg, latitude_deg, longitude_deg] {
            value.map(f64::to_bits).hash(&mut hasher);
        }
    }
    hasher.finish()
}
