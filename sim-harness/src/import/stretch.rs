//! Rows without a gap between them, on the way from a file to pieces of runs: brought in order, joined over wraps of
//! the odometer, placed, cut.

use super::account::Account;
use super::geo;
use super::mapping::RunCuts;
use rundown_check::clock::jumps;
use rundown_check::finding::{Done, Finding, Kind};
use rundown_check::location::{odometer, placeholders};
use rundown_check::speed;
use rundown_files::sample::{COLUMNS, MOST_LOCATION_M, Sample};

/// A train that stood in a gap is no further on, m.
const STOOD_M: f64 = 300.0;
/// Of rows with a time that was there before so many elsewhere are those of another train.
const LEAST_ELSEWHERE: u64 = 20;
const OF_ANOTHER_TRAIN: &str =
    "rows with a time that was there before, elsewhere: another train? (columns.unit in the mapping tells them apart)";
/// A reading that is written again sooner than this is one reading, s ...
const REPEATS_S: f64 = 0.999;
/// ... where so many pairs of rows are that close, and half of them are alike.
const LEAST_REPEATED: usize = 50;

/// Rows without a gap between them, of one unit and run.
#[derive(Clone, Debug, Default)]
pub struct Stretch {
    pub rows: Vec<Sample>,
    pub altitudes_m: Vec<Option<f64>>,
    pub unit: String,
    pub run: String,
    pub is_dated: bool,
    /// Why it begins.
    pub reason: String,
    /// Locations are distances along the fixes.
    pub from_fixes: bool,
    /// It begins with its file, or with a run of a column.
    pub is_head: bool,
    /// The turn of the odometer, m, where it began again at zero on the way.
    pub turn_m: Option<f64>,
}

/// By how much the odometer of a file had wrapped when a stretch ended, and where that was.
#[derive(Clone, Copy, Debug, Default)]
pub struct Odometer {
    shift_m: f64,
    end_m: f64,
}

impl Odometer {
    /// Leaves out what is beyond any line where most of the stretch is not, and what stands for no location: readings
    /// that mean nothing, not an odometer. Joins wraps; those before a gap too, where the train stood in the gap.
    fn join(&mut self, stretch: &mut Stretch, findings: &mut Vec<Finding>, account: &mut Account) {
        let left_out = far_readings(&mut stretch.rows);
        if left_out > 0 {
            account.count("locations beyond any line among others that are not, left out", left_out as u64);
        }
        let stand_for_none = placeholders::found(&stretch.rows);
        account.count(
            "locations far from those around them, which agree with each other, taken as missing",
            stand_for_none.len() as u64,
        );
        stand_for_none.into_iter().for_each(|i| stretch.rows[i].location_m = None);
        let read_m = |stretch: &Stretch| stretch.rows.iter().rev().find_map(|row| row.location_m);
        let (first_m, last_m) = (stretch.rows.iter().find_map(|row| row.location_m), read_m(stretch));
        let stood = first_m.is_some_and(|first| (first + self.shift_m - self.end_m).abs() < STOOD_M);
        if self.shift_m != 0.0 && stood && !stretch.is_head {
            account.count("odometers that wrapped before a gap, joined over it", 1);
            stretch.rows.iter_mut().for_each(|row| row.location_m = row.location_m.map(|m| m + self.shift_m));
        }
        let stuck = speed::stuck::found(&stretch.rows);
        odometer::join(&mut stretch.rows, &stuck, findings);
        let wrapped = findings.iter().find(|one| one.kind == Kind::Wrap && one.done == Done::PutRight);
        stretch.turn_m = wrapped.map(|one| odometer::turn_m(one.figure.value));
        if let Some((last_m, end_m)) = last_m.zip(read_m(stretch)) {
            *self = Self { shift_m: end_m - last_m, end_m };
        }
    }
}

/// Takes locations beyond any line away where less than half of all are far out. Out: how many.
fn far_readings(rows: &mut [Sample]) -> usize {
    let located = rows.iter().filter_map(|row| row.location_m).count();
    let far_out = rows.iter().filter_map(|row| row.location_m).filter(|m| m.abs() > 0.5 * MOST_LOCATION_M).count();
    if 2 * far_out >= located {
        return 0;
    }
    let beyond = rows.iter_mut().filter_map(|row| row.location_m.take_if(|m| m.abs() > MOST_LOCATION_M));
    beyond.count()
}

impl Stretch {
    /// A row is later than its last one.
    pub fn is_before(&self, row: &Sample) -> bool {
        self.rows.last().is_some_and(|last| row.time_s > last.time_s)
    }

    /// Brings a stretch in order and cuts it.
    pub fn pieces(mut self, settings: &RunCuts, odometer: &mut Odometer, account: &mut Account) -> Vec<Self> {
        if self.rows.len() < 2 {
            account.count("single rows between gaps, left out", self.rows.len() as u64);
            return Vec::new();
        }
        self.in_order(account);
        self.leave_out_repeats(account);
        self.locate(account);
        let mut findings = Vec::new();
        if !self.from_fixes {
            odometer.join(&mut self, &mut findings, account);
        }
        self.speeds(account);
        put_down(&findings, account);
        let cuts = self.cuts(settings, &findings);
        self.split(cuts, account).into_iter().filter_map(|piece| piece.kept(settings, account)).collect()
    }

    /// Times go forward: rows that were written out of order are sorted, a clock that was set is put right. Which, the
    /// locations say: the shorter path is the true one.
    fn in_order(&mut self, account: &mut Account) {
        let back = self.rows.windows(2).filter(|pair| pair[1].time_s < pair[0].time_s).count();
        if back > 0 {
            let located = self.rows.iter().filter(|row| row.location_m.is_some()).count() > 1;
            let place_m = |a: &Sample, b: &Sample| {
                if located { Some(b.location_m? - a.location_m?) } else { Some(geo::distance_m(fix(a)?, fix(b)?)) }
            };
            if let Some(order) = jumps::order(&self.rows, place_m) {
                account.count("steps back of the clock where rows were out of order, sorted", back as u64);
                self.altitudes_m = order.iter().map(|i| self.altitudes_m[*i]).collect();
                self.rows = order.iter().map(|i| self.rows[*i]).collect();
            }
        }
        let mut findings = Vec::new();
        jumps::put_right(&mut self.rows, &mut findings);
        put_down(&findings, account);
        self.join_halves(account);
        let (mut last, mut keep, mut elsewhere): (Option<&Sample>, Vec<bool>, u64) = (None, Vec::new(), 0);
        let mut located = 0;
        for row in &self.rows {
            let is_later = last.is_none_or(|last| row.time_s > last.time_s);
            let apart_m = last.and_then(|last| Some((row.location_m? - last.location_m?).abs()));
            elsewhere += u64::from(!is_later && apart_m.is_some_and(|metres| metres > STOOD_M));
            located += u64::from(!is_later && apart_m.is_some());
            keep.push(is_later);
            last = if is_later { Some(row) } else { last };
        }
        let left_out = keep.iter().filter(|keep| !**keep).count() as u64;
        self.keep(&keep);
        account.count("rows with a time that was there before, left out", left_out);
        if 2 * elsewhere > located && elsewhere > LEAST_ELSEWHERE {
            account.count(OF_ANOTHER_TRAIN, elsewhere);
        }
    }

    /// Rows of the same time of which one has what the other lacks are one row. One that says something else is of
    /// another train, or comes too often: it stays what it is.
    fn join_halves(&mut self, account: &mut Account) {
        let (mut keep, mut first) = (vec![true; self.rows.len()], 0);
        for (i, keep) in keep.iter_mut().enumerate().skip(1) {
            let [before, row] = [self.rows[first], self.rows[i]];
            if before.time_s != row.time_s || before.speed_is_computed != row.speed_is_computed {
                first = i;
                continue;
            }
            let read: Vec<_> = COLUMNS[1..].iter().filter_map(|one| Some((one, (one.get)(&row)?))).collect();
            let adds_altitude = self.altitudes_m[i].is_some() && self.altitudes_m[first].is_none();
            let is_new =
                read.iter().all(|(one, _)| (one.get)(&before).is_none()) && (adds_altitude || !read.is_empty());
            if is_new {
                read.iter().for_each(|(one, value)| (one.set)(&mut self.rows[first], *value));
                self.altitudes_m[first] = self.altitudes_m[first].or(self.altitudes_m[i]);
                *keep = false;
            }
        }
        let joined = keep.iter().filter(|keep| !**keep).count() as u64;
        self.keep(&keep);
        account.count("rows of the same time with other readings, joined", joined);
    }

    /// A logger that is faster than its receiver writes each reading several times, with later times: the first of them
    /// is the reading.
    fn leave_out_repeats(&mut self, account: &mut Account) {
        let read = |row: &Sample| (row.location_m, fix(row), row.speed_mps);
        let is_soon = |a: &Sample, b: &Sample| b.time_s - a.time_s < REPEATS_S;
        let moves = |row: &Sample| row.speed_mps.is_none_or(|mps| mps > 1.0);
        let pairs = self.rows.windows(2).filter(|pair| is_soon(&pair[0], &pair[1]) && moves(&pair[0]));
        let (all, same) =
            pairs.fold((0, 0), |(all, same), pair| (all + 1, same + usize::from(read(&pair[0]) == read(&pair[1]))));
        if all < LEAST_REPEATED || 2 * same < all {
            return;
        }
        let mut kept: Option<Sample> = None;
        let is_new = |row: &Sample| {
            let is_new = kept.is_none_or(|first| !is_soon(&first, row) || read(&first) != read(row));
            if is_new {
                kept = Some(*row);
            }
            is_new
        };
        let keep: Vec<bool> = self.rows.iter().map(is_new).collect();
        let left_out = keep.iter().filter(|keep| !**keep).count();
        self.keep(&keep);
        account.count("rows that repeat the reading before within a second, left out", left_out as u64);
    }

    fn keep(&mut self, keep: &[bool]) {
        let mut kept = keep.iter();
        self.rows.retain(|_| kept.next().copied().unwrap_or(true));
        let mut kept = keep.iter();
        self.altitudes_m.retain(|_| kept.next().copied().unwrap_or(true));
    }
}

pub fn fix(row: &Sample) -> Option<geo::Fix> {
    row.latitude_deg.zip(row.longitude_deg)
}

fn put_down(findings: &[Finding], account: &mut Account) {
    for finding in findings {
        let what = match finding.kind {
            Kind::Midnight => super::rows::MIDNIGHT,
            Kind::ClockSetBack => "clocks set back, put right",
            Kind::ClockSetForward => "clocks set forward, put right",
            Kind::Wrap if finding.done == Done::PutRight => "odometers that wrapped, joined",
            Kind::Reset if finding.done == Done::PutRight => "odometers that began again, joined",
            _ => "locations that begin again elsewhere, cut",
        };
        account.place(what, || finding.to_string());
    }
}
