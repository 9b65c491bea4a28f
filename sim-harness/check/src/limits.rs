//! Trains that exceed what is described of them: faster than the line allows, more effort than the train has, harder
//! brakes.
//!
//! In: rows of all runs of a unit, put right, and the descriptions. Out: what is exceeded, in how many rows, by how
//! much.
//!
//! Either the description or the reading is wrong: a limit that nobody keeps, a train of another type, an effort in
//! another unit. A replay learns on, and its limits rest on what is described; so it is said, once a unit.

use crate::figure::Figure;
use crate::finding::Kind;
use rundown::model::train::Train;
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;
use rundown_files::track_file::TrackFile;

/// Drivers keep limits by their speedometers, and trains their efforts by their computers, within these shares ...
const BEYOND_SPEED: f64 = 0.03;
const BEYOND_EFFORT: f64 = 0.05;
/// ... and readings are off by so much, km/h and N/kg.
const SPEED_OFF_KMH: f64 = 2.0;
const EFFORT_OFF_N_PER_KG: f64 = 0.005;
/// Limits begin where the front passes, but for the length of the train and an error of the location, m.
const AROUND_M: f64 = 300.0;
/// Fewer rows are wild readings: so many, and such a share of those that can show it.
const SPEEDS: (usize, f64) = (5, 0.002);
/// Efforts are noisy, and those of a loaded train are above by its load.
const EFFORTS: (usize, f64) = (20, 0.05);

/// What is described of trains and line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Described {
    /// The train.
    pub train: Option<Train>,
    /// Speed limits: from a location on, m, this speed, km/h; sorted, none before the first.
    pub speeds: Vec<(f64, f64)>,
}

/// A limit that is exceeded.
#[derive(Clone, Debug, PartialEq)]
pub struct Excess {
    /// Which.
    pub kind: Kind,
    /// Share of the rows that can show it, per cent.
    pub percent: Figure,
    /// Rows.
    pub rows: usize,
    /// Limit and what is read.
    pub evidence: String,
}

/// A row beyond a limit: what is read, and the limit.
type Beyond = Option<(f64, f64)>;

/// What the runs of a unit exceed.
pub fn exceeded<'a>(recordings: impl Iterator<Item = &'a Recording> + Clone, described: &Described) -> Vec<Excess> {
    let rows = || recordings.clone().flat_map(|recording| &recording.rows);
    let pairs = || recordings.clone().flat_map(|recording| recording.rows.windows(2));
    let speed = rows().filter_map(|row| described.speed(row));
    let mut found = vec![excess(Kind::AboveSpeedLimit, speed, "km/h", SPEEDS)];
    if let Some(train) = &described.train {
        found.push(excess(Kind::AboveTraction, pairs().filter_map(|pair| traction(train, pair)), "N/kg", EFFORTS));
        found.push(excess(Kind::AboveBrake, rows().filter_map(|row| brake(train, row)), "N/kg", EFFORTS));
    }
    found.into_iter().flatten().collect()
}

/// `rows`: those that can show it.
fn excess(kind: Kind, rows: impl Iterator<Item = Beyond>, unit: &str, least: (usize, f64)) -> Option<Excess> {
    let (mut all, mut beyond) = (0_usize, Vec::new());
    for row in rows {
        all += 1;
        beyond.extend(row);
    }
    let share = beyond.len() as f64 / all.max(1) as f64;
    let (most, limit) = beyond.iter().copied().max_by(|a, b| (a.0 / a.1).total_cmp(&(b.0 / b.1)))?;
    let decimals = if unit == "km/h" { 0 } else { 3 };
    let percent = Figure { value: 100.0 * share, sd: 0.0 };
    let evidence = format!("up to {most:.decimals$} {unit} where {limit:.decimals$} is described");
    (beyond.len() >= least.0 && share > least.1).then_some(Excess { kind, percent, rows: beyond.len(), evidence })
}

impl Described {
    /// Of a track, and of a train where it is known.
    pub fn of(train: Option<Train>, track: Option<&TrackFile>) -> Self {
        let limits = track.iter().flat_map(|track| &track.speed_limit);
        let mut speeds: Vec<(f64, f64)> = limits.map(|limit| (limit.from_m, limit.kmh)).collect();
        speeds.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self { train, speeds }
    }

    fn speed(&self, row: &Sample) -> Option<Beyond> {
        let (at_m, mps) = (row.location_m?, row.speed_mps?);
        // Multipath makes any speed of positions, and no driver.
        let limit_kmh = self.limit_kmh(at_m).filter(|_| mps > 0.0 && !row.speed_is_computed)?;
        let kmh = 3.6 * mps;
        Some((kmh > (1.0 + BEYOND_SPEED) * limit_kmh + SPEED_OFF_KMH).then_some((kmh, limit_kmh)))
    }

    /// The highest limit around a location.
    fn limit_kmh(&self, at_m: f64) -> Option<f64> {
        let here = self.speeds.iter().rposition(|(from_m, _)| *from_m <= at_m - AROUND_M)?;
        let around = self.speeds[here..].iter().take_while(|(from_m, _)| *from_m <= at_m + AROUND_M);
        around.map(|(_, kmh)| *kmh).reduce(f64::max)
    }
}

/// The effort may be the mean since the row before, when the train was slower and had more.
fn traction(train: &Train, pair: &[Sample]) -> Option<Beyond> {
    let (effort, mps) = (pair[1].effort_n_per_kg?, pair[0].speed_mps?.min(pair[1].speed_mps?));
    let limit = train.max_effort_n_per_kg(mps);
    (effort > 0.0).then_some((effort > (1.0 + BEYOND_EFFORT) * limit + EFFORT_OFF_N_PER_KG).then_some((effort, limit)))
}

fn brake(train: &Train, row: &Sample) -> Option<Beyond> {
    let (effort, limit) = (-row.effort_n_per_kg?, train.max_brake_n_per_kg());
    (effort > 0.0).then_some((effort > (1.0 + BEYOND_EFFORT) * limit + EFFORT_OFF_N_PER_KG).then_some((effort, limit)))
}
