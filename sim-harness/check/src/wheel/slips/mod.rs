//! Wheels that slip while the train powers, or slide while it brakes: for some seconds the speed is that of the wheel,
//! and not of the train.
//!
//! In: runs of a recorder. Out: the speeds of slips and slides left out, and what is to be said of them.
//!
//! One bump of a tram may say little: all of a run, or of the recorder, are a mixture of slips and of what the train
//! did, and where slips among them are beyond doubt, those that are more likely slips are left out. An odometer of the
//! same axle slips as well, and shows nothing.

mod bumps;
mod unknown;

use crate::agreement::compared::Row;
use crate::agreement::late_rows::with_moved;
use crate::agreement::parts::parts;
use crate::figure::{Figure, HALF_95};
use crate::finding::{Done, Finding, Kind};
use crate::rows::times::usual_step_s;
use bumps::Bump;
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;
use rundown_files::statistics::{median, spread};
use unknown::Noise;

/// Rows that are farther apart do not show a slip, and nearer ones are passed over, s.
const MOST_STEP_S: f64 = 2.0;
const LEAST_STEP_S: f64 = 0.8;
/// The part of a slip's bump that the locations do not know: the rest is what the power fades by.
const UNKNOWN: f64 = 0.85;
/// That part comes out too large by such a share of how surely it is known of one slip, where three in four are chosen.
const CHOSEN: f64 = 0.4;
/// Nats by which slips must explain the locations better than none.
const SURE: f64 = 12.0;
/// Shares of the bumps that are slips, as they are tried.
const SHARES: [f64; 7] = [0.02, 0.05, 0.1, 0.25, 0.5, 0.75, 0.98];

/// A bump, and which part of it the locations do not know.
#[derive(Clone, Copy)]
struct Slip {
    from_s: f64,
    to_s: f64,
    long_s: f64,
    share: f64,
    unknown: Figure,
}

impl Slip {
    /// By which it is more likely a slip.
    fn nats(&self) -> f64 {
        UNKNOWN * (self.unknown.value - 0.5 * UNKNOWN) / self.unknown.sd.powi(2)
    }
}

/// What the wheels of a recorder do.
#[derive(Clone, Debug)]
pub(crate) struct Slips {
    kind: Kind,
    /// Reading over the speed of the train, less 1, %.
    percent: Figure,
    count: usize,
    runs: usize,
    long_s: f64,
    first: String,
}

impl Slips {
    pub(crate) fn finding(&self) -> Finding {
        let Self { kind, percent: figure, count, .. } = *self;
        Finding { kind, figure, unit: "%", count, line: 0, done: Done::LeftOut }
    }

    /// `of_runs`: all of the recorder.
    pub(crate) fn evidence(&self, of_runs: usize) -> String {
        let Self { runs, long_s, first, .. } = self;
        format!("in {runs} of {of_runs} runs, for {long_s:.0} s in the median, first in {first}")
    }
}

/// Leaves out the speeds of slips and slides in these runs of a recorder. `compared`: those whose speeds were compared
/// with the locations, and by how much they were moved for it, s.
pub(crate) fn leave_out(recordings: &mut [Recording], compared: &[(usize, f64)]) -> Vec<Slips> {
    let parts_of = |(i, moved_s): &(usize, f64)| {
        let rows = &recordings[*i].rows;
        let step_s = usual_step_s(rows);
        let parts = if step_s > MOST_STEP_S { Vec::new() } else { parts(rows, step_s) };
        with_moved(parts, step_s, *moved_s).iter().map(|part| thinned(part)).collect()
    };
    let of_runs: Vec<Vec<Vec<Row>>> = compared.iter().map(parts_of).collect();
    let mut found = Vec::new();
    for (kind, sign) in [(Kind::Slips, 1.0), (Kind::Slides, -1.0)] {
        let slips = sought(&of_runs, sign);
        let Some(first) = slips.iter().position(|slips| !slips.is_empty()) else { continue };
        let percent = percent(&slips.concat());
        // None that may be no slips at all.
        if percent.away_from(0.0) < HALF_95 {
            continue;
        }
        let leave =
            |((i, moved_s), slips): (&(usize, f64), &Vec<Slip>)| without(&mut recordings[*i].rows, slips, *moved_s);
        let lines: Vec<u64> = compared.iter().zip(&slips).map(leave).collect();
        let all = || slips.iter().flatten();
        found.push(Slips {
            kind,
            percent,
            count: all().count(),
            runs: slips.iter().filter(|slips| !slips.is_empty()).count(),
            long_s: median(all().map(|slip| slip.long_s)).unwrap_or_default(),
            first: format!("{} line {}", recordings[compared[first].0].name, lines[first]),
        });
    }
    found
}

/// By how much the wheels turn faster, as far as the locations do not know it.
fn percent(slips: &[Slip]) -> Figure {
    let usual = median(slips.iter().map(|slip| 100.0 * slip.share)).unwrap_or_default();
    let differs = spread(slips.iter().map(|slip| 100.0 * slip.share - usual)) / (slips.len() as f64).sqrt();
    let weights: f64 = slips.iter().map(|slip| slip.unknown.sd.powi(-2)).sum();
    let all = slips.iter().map(|slip| slip.unknown.value * slip.unknown.sd.powi(-2)).sum::<f64>() / weights;
    // Those that are left out are the ones of which the locations know the least.
    let chosen = CHOSEN * median(slips.iter().map(|slip| slip.unknown.sd)).unwrap_or_default();
    let unknown = Figure { value: all.min(1.0), sd: weights.recip().sqrt().hypot(chosen) };
    Figure { value: usual * unknown.value, sd: (unknown.value * differs).hypot(usual * unknown.sd) }
}

/// Leaves out the speeds of slips, which are later by `moved_s` than the locations. Out: the line of the first one.
fn without(rows: &mut [Sample], slips: &[Slip], moved_s: f64) -> u64 {
    let is_slip =
        |row: &&mut Sample| slips.iter().any(|slip| (slip.from_s..=slip.to_s).contains(&(row.time_s - moved_s)));
    let mut line = None;
    for row in rows.iter_mut().filter(is_slip) {
        line.get_or_insert(row.line);
        row.speed_mps = None;
    }
    line.unwrap_or_default()
}

fn thinned(part: &[Row]) -> Vec<Row> {
    let mut last_s = f64::NEG_INFINITY;
    let is_next = |row: &&Row| {
        let is_next = row.time_s >= last_s + LEAST_STEP_S;
        last_s = if is_next { row.time_s } else { last_s };
        is_next
    };
    part.iter().filter(is_next).copied().collect()
}

/// The slips of each run, or its slides where `sign` is below zero.
fn sought(of_runs: &[Vec<Vec<Row>>], sign: f64) -> Vec<Vec<Slip>> {
    let bumps: Vec<Vec<Slip>> = of_runs.iter().map(|parts| judged(parts, sign)).collect();
    let of_all = share(&bumps.concat());
    let likely = |bumps: &Vec<Slip>| -> Vec<Slip> {
        let share = share(bumps).into_iter().chain(of_all).fold(0.0, f64::max);
        let is_likely = |slip: &&Slip| share > 0.0 && slip.nats() + share.ln() > (1.0 - share).ln();
        bumps.iter().filter(is_likely).copied().collect()
    };
    bumps.iter().map(likely).collect()
}

/// Which share of the bumps are slips; none where it is not beyond doubt that there are any.
fn share(bumps: &[Slip]) -> Option<f64> {
    let of = |share: f64| (share, bumps.iter().map(|bump| mixed(share, bump.nats())).sum::<f64>());
    let best = SHARES.map(of).into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
    best.filter(|(_, nats)| *nats > SURE).map(|(share, _)| share)
}

/// The bumps of a run.
fn judged(parts: &[Vec<Row>], sign: f64) -> Vec<Slip> {
    let bumps: Vec<Vec<Bump>> = parts.iter().map(|part| bumps::of_part(part, sign)).collect();
    if bumps.iter().all(Vec::is_empty) {
        return Vec::new();
    }
    let Some(noise) = Noise::of(parts) else { return Vec::new() };
    let of_part = |(part, bumps): (&Vec<Row>, &Vec<Bump>)| -> Vec<Slip> {
        let of = |bump: &Bump| {
            if unknown::is_leap(&part[bump.rows.start..=bump.rows.end]) {
                return None;
            }
            let unknown = unknown::share(part, &bump.rows, &noise)?;
            let [from_s, to_s] = [bump.rows.start, bump.rows.end].map(|at| part[at].time_s);
            let long_s = part[bump.rows.end - 1].time_s - from_s;
            Some(Slip { from_s, to_s, long_s, share: bump.share, unknown })
        };
        bumps.iter().filter_map(of).collect()
    };
    parts.iter().zip(&bumps).flat_map(of_part).collect()
}

/// Log-likelihood of one of many of which this share are slips, over that of none; `nats`: that of a slip.
fn mixed(share: f64, nats: f64) -> f64 {
    let most = nats.max(0.0);
    most + ((1.0 - share) * (-most).exp() + share * (nats - most).exp()).ln()
}

/// The speed of a train that did not slip between two rows.
struct Chord {
    from: Row,
    to: Row,
    mps2: f64,
}

impl Chord {
    fn through(from: Row, to: Row) -> Self {
        Self { from, to, mps2: (to.speed_mps - from.speed_mps) / (to.time_s - from.time_s) }
    }

    fn long_s(&self) -> f64 {
        self.to.time_s - self.from.time_s
    }

    fn at(&self, time_s: f64) -> f64 {
        self.from.speed_mps + self.mps2 * (time_s - self.from.time_s)
    }

    /// The speed of the train in a row.
    fn of(&self, row: &Row) -> f64 {
        let is_between = (self.from.time_s..=self.to.time_s).contains(&row.time_s);
        if is_between { self.at(row.time_s) } else { row.speed_mps }
    }
}
