//! Rows of a day as runs: cut at gaps, long standing, turns and jumps, each with its reason.

use super::account::{Account, ROWS_TOO_SHORT};
use super::cubic;
use super::geo;
use super::mapping::RunCuts;
use super::rows::Record;
use super::speeds;
use rundown_check::finding::{Done, Finding, Kind};
use rundown_check::{clock, places, row_step, stuck_speeds};
use rundown_files::sample::{MOST_LOCATION_M, Sample};
use rundown_files::statistics::median;
use std::ops::Range;

/// Rows that are held at most before a stretch is cut without another reason.
const MOST_ROWS: usize = 500_000;
/// What no row has continued for so many is over.
const LEFT_ROWS: u64 = 20_000;
/// A train that is slower stands, m/s.
pub const STANDS_MPS: f64 = 0.3;
const WALKS_MPS: f64 = 1.5;
/// A shorter standing is none at a station, s.
pub const STOP_S: f64 = 10.0;
/// What is kept of a long standing on both sides of a cut, s.
const KEPT_S: f64 = 30.0;
/// A train that stood in a gap is no further on, m.
const STOOD_M: f64 = 300.0;
/// A reading that is written again sooner than this is one reading, s ...
const REPEATS_S: f64 = 0.999;
/// ... where so many pairs of rows are that close, and half of them are alike.
const LEAST_REPEATED: usize = 50;
/// A speed is the slope in the middle of so long before and after, s; where there are not as many rows on both sides,
/// the mean of this.
const SLOPE_S: f64 = 5.0;
const MEAN_S: f64 = 4.0;
/// Rows that are further apart show no slope, s.
const SLOPE_STEP_S: f64 = 10.5;
/// Fixes that are further from such a slope leapt, m.
const LEFT_M: f64 = 15.0;
/// Fixes nearer than this to the last one counted say nothing of a distance, m.
const ANCHOR_M: f64 = 15.0;

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
}

/// By how much the odometer of a file had wrapped when a stretch ended, and where that was.
#[derive(Clone, Copy, Debug, Default)]
pub struct Odometer {
    shift_m: f64,
    end_m: f64,
}

impl Odometer {
    /// Leaves out what is beyond any line where most of the stretch is not: readings that mean nothing, not an
    /// odometer. Joins wraps; those before a gap too, where the train stood in the gap.
    fn join(&mut self, stretch: &mut Stretch, findings: &mut Vec<Finding>, account: &mut Account) {
        let left_out = far_readings(&mut stretch.rows);
        if left_out > 0 {
            account.count("locations beyond any line among others that are not, left out", left_out as u64);
        }
        let read_m = |stretch: &Stretch| stretch.rows.iter().rev().find_map(|row| row.location_m);
        let (first_m, last_m) = (stretch.rows.iter().find_map(|row| row.location_m), read_m(stretch));
        let stood = first_m.is_some_and(|first| (first + self.shift_m - self.end_m).abs() < STOOD_M);
        if self.shift_m != 0.0 && stood && !stretch.is_head {
            account.count("odometers that wrapped before a gap, joined over it", 1);
            stretch.rows.iter_mut().for_each(|row| row.location_m = row.location_m.map(|m| m + self.shift_m));
        }
        let stuck = stuck_speeds::found(&stretch.rows);
        places::join(&mut stretch.rows, &stuck, findings);
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

/// Makes stretches of rows as they come. Rows of several units or runs may take turns, as where a fleet writes one
/// file: each has a stretch of its own until it has not been continued for long.
#[derive(Debug)]
pub struct Cutter {
    settings: RunCuts,
    rows: u64,
    last_unit: String,
    /// The sheet whose rows are about to begin.
    sheet: Option<String>,
    /// In the order in which they began.
    held: Vec<Held>,
}

#[derive(Debug)]
struct Held {
    stretch: Stretch,
    /// Which rows of the file its first and last were.
    first: u64,
    last: u64,
}

impl Cutter {
    pub const fn new(settings: RunCuts) -> Self {
        Self { settings, rows: 0, last_unit: String::new(), sheet: None, held: Vec::new() }
    }

    /// The rows of a sheet begin.
    pub fn sheet(&mut self, name: &str) {
        self.sheet = Some(name.to_owned());
    }

    /// Takes a row; gives the stretches that end before it.
    pub fn push(&mut self, record: Record) -> Vec<Stretch> {
        let begun = self.sheet.take().filter(|_| self.is_earlier(&record));
        let ended = if begun.is_some() { std::mem::take(&mut self.held) } else { Vec::new() };
        let begun = begun.map(|sheet| format!("the sheet {sheet:?} begins, earlier than the one before ends"));
        ended.into_iter().map(|held| held.stretch).chain(self.next(record, begun)).collect()
    }

    /// A sheet goes on where the one before ended; one that begins earlier holds other runs, not a clock that was set
    /// back.
    fn is_earlier(&self, record: &Record) -> bool {
        let last = self.held.iter().filter_map(|held| held.stretch.rows.last());
        last.map(|row| row.time_s).fold(f64::NEG_INFINITY, f64::max) > record.sample.time_s
    }

    /// The same within a sheet, or of a file without any; `begun`: why a stretch begins here, where the sheet says it.
    fn next(&mut self, record: Record, begun: Option<String>) -> Vec<Stretch> {
        self.rows += 1;
        let is_of = |held: &Held| held.stretch.unit == record.unit && held.stretch.run == record.run;
        let found = self.held.iter().position(is_of);
        let cut = found.and_then(|at| Some((at, self.cut(&self.held[at].stretch, &record)?)));
        // What is over, and what was over before that began.
        let mut ended_before = self.rows.saturating_sub(LEFT_ROWS);
        let mut over = None;
        let at = match (found, cut) {
            (_, Some((at, reason))) => {
                let held = self.held.remove(at);
                ended_before = ended_before.max(held.first);
                over = Some(held.stretch);
                self.begin(&record, reason, false)
            }
            (Some(at), None) => at,
            (None, None) => {
                let reason = begun.unwrap_or_else(|| self.reason(&record));
                self.begin(&record, reason, true)
            }
        };
        let held = &mut self.held[at];
        held.last = self.rows;
        held.stretch.rows.push(record.sample);
        held.stretch.altitudes_m.push(record.altitude_m);
        if self.last_unit != record.unit {
            self.last_unit = record.unit;
        }
        let before = self.held.extract_if(.., |held| held.last < ended_before);
        before.map(|held| held.stretch).chain(over).collect()
    }

    /// Why a stretch does not go on with this row of its unit and run.
    fn cut(&self, stretch: &Stretch, record: &Record) -> Option<String> {
        let last = stretch.rows.last()?;
        let gap_s = record.sample.time_s - last.time_s;
        if gap_s > self.settings.gap_s && !went_on(last, &record.sample) {
            Some(format!("a gap of {gap_s:.0} s"))
        } else if stretch.rows.len() >= MOST_ROWS {
            Some(format!("{MOST_ROWS} rows without another place to cut"))
        } else {
            None
        }
    }

    /// Why the rows of a unit and run begin.
    fn reason(&self, record: &Record) -> String {
        if self.rows == 1 {
            "the file begins".to_owned()
        } else if self.last_unit == record.unit {
            format!("the run changes to {:?}", record.run)
        } else {
            format!("the unit changes to {:?}", record.unit)
        }
    }

    fn begin(&mut self, record: &Record, reason: String, is_head: bool) -> usize {
        let (unit, run, is_dated) = (record.unit.clone(), record.run.clone(), record.is_dated);
        let stretch = Stretch { unit, run, is_dated, reason, is_head, ..Stretch::default() };
        self.held.push(Held { stretch, first: self.rows, last: self.rows });
        self.held.len() - 1
    }

    pub fn end(self) -> impl Iterator<Item = Stretch> {
        self.held.into_iter().map(|held| held.stretch)
    }
}

impl Stretch {
    /// Brings a stretch in order and cuts it.
    pub fn pieces(mut self, settings: &RunCuts, odometer: &mut Odometer, account: &mut Account) -> Vec<Self> {
        if self.rows.len() < 2 {
            account.count("single rows between gaps, left out", self.rows.len() as u64);
            return Vec::new();
        }
        self.in_order(account);
        self.leave_out_repeats(account);
        self.locate(account);
        self.speeds(account);
        let mut findings = Vec::new();
        if !self.from_fixes {
            odometer.join(&mut self, &mut findings, account);
        }
        let mut cuts = self.jumps(&findings);
        put_down(&findings, account);
        cuts.extend(self.turns(settings.turn_m));
        cuts.extend(self.standings(settings.standing_s));
        cuts.sort_by_key(|cut| (cut.0.start, cut.0.end));
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
            if let Some(order) = clock::order(&self.rows, place_m) {
                account.count("steps back of the clock where rows were out of order, sorted", back as u64);
                self.altitudes_m = order.iter().map(|i| self.altitudes_m[*i]).collect();
                self.rows = order.iter().map(|i| self.rows[*i]).collect();
            }
        }
        let mut findings = Vec::new();
        clock::put_right(&mut self.rows, &mut findings);
        put_down(&findings, account);
        let (before, mut last_s, mut keep) = (self.rows.len(), f64::NEG_INFINITY, Vec::new());
        for row in &self.rows {
            keep.push(row.time_s > last_s);
            last_s = last_s.max(row.time_s);
        }
        self.keep(&keep);
        account.count("rows with a time that was there before, left out", (before - self.rows.len()) as u64);
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

    /// Distances along the fixes, where there is no location.
    fn locate(&mut self, account: &mut Account) {
        if self.rows.iter().any(|row| row.location_m.is_some()) {
            return;
        }
        self.from_fixes = true;
        let mut anchor: Option<(usize, geo::Fix)> = None;
        let mut passed_m = 0.0;
        for i in 0..self.rows.len() {
            let Some(fix) = fix(&self.rows[i]) else { continue };
            let Some((at, from)) = anchor else {
                anchor = Some((i, fix));
                self.rows[i].location_m = Some(0.0);
                continue;
            };
            let step_m = geo::distance_m(from, fix);
            let seconds = self.rows[i].time_s - self.rows[at].time_s;
            if step_m > 150.0 * seconds + 300.0 {
                account.count("fixes that jump, taken as missing", 1);
                (self.rows[i].latitude_deg, self.rows[i].longitude_deg) = (None, None);
                continue;
            }
            if step_m < ANCHOR_M {
                self.rows[i].location_m = Some(passed_m + step_m);
                continue;
            }
            passed_m += step_m;
            self.rows[i].location_m = Some(passed_m);
            anchor = Some((i, fix));
        }
    }

    /// Speeds by the locations, where the log has none.
    fn speeds(&mut self, account: &mut Account) {
        if self.rows.iter().any(|row| row.speed_mps.is_some()) {
            return;
        }
        let located: Vec<usize> = (0..self.rows.len()).filter(|i| self.rows[*i].location_m.is_some()).collect();
        let step_s = row_step::usual_step_s(&self.rows);
        // Over longer a train does more than a cubic, too.
        let is_short = step_s * cubic::LEAST as f64 <= 2.0 * SLOPE_S;
        let mps = |k: usize| match self.slope(&located, k, step_s) {
            Some((_, left_m)) if is_short && self.from_fixes && left_m > LEFT_M => None,
            Some((mps, _)) => Some(mps),
            None => Some(self.mean_mps(&located, k, step_s)),
        };
        let speeds: Vec<Option<f64>> = (0..located.len()).map(mps).collect();
        let found = speeds.iter().flatten().count();
        account.count("speeds computed from the locations", found as u64);
        account.count("rows beside a leap of the fixes, without a speed", (speeds.len() - found) as u64);
        for (i, mps) in located.into_iter().zip(speeds) {
            (self.rows[i].speed_mps, self.rows[i].speed_is_computed) = (mps, mps.is_some());
        }
    }

    /// The first and the last of the rows around one. As many rows on each side, not as long a time: where a clock
    /// jitters, the rows within a time are those whose time is too short.
    fn around(&self, located: &[usize], k: usize, step_s: f64, reach: usize) -> (usize, usize) {
        let time = |k: usize| self.rows[located[k]].time_s;
        let longest_s = 1.5 * step_s * reach as f64;
        let (mut a, mut b) = (k.saturating_sub(reach), (k + reach).min(located.len() - 1));
        while time(k) - time(a) > longest_s {
            a += 1;
        }
        while time(b) - time(k) > longest_s {
            b -= 1;
        }
        (a, b)
    }

    /// Speed, and what it leaves of the readings, m. Nothing beside a gap, and where rows are too far apart.
    fn slope(&self, located: &[usize], k: usize, step_s: f64) -> Option<(f64, f64)> {
        let reach = ((SLOPE_S / step_s).round() as usize).max(cubic::LEAST / 2);
        let (a, b) = self.around(located, k, step_s, reach);
        let middle = &self.rows[located[k]];
        let way = |row: &Sample| match (fix(middle), fix(row)) {
            (Some(from), Some(to)) if self.from_fixes => geo::offset_m(from, to),
            _ => (row.location_m.unwrap_or(0.0) - middle.location_m.unwrap_or(0.0), 0.0),
        };
        let along = |axis: fn((f64, f64)) -> f64| {
            let rows = located[a..=b].iter().map(|i| &self.rows[*i]);
            cubic::fit(&rows.map(|row| (row.time_s - middle.time_s, axis(way(row)))).collect::<Vec<_>>())
        };
        let (north, east) =
            along(|way| way.0).zip(along(|way| way.1)).filter(|_| k - a == b - k && step_s <= SLOPE_STEP_S)?;
        Some((north.per_s.hypot(east.per_s), (north.left + east.left).sqrt()))
    }

    fn mean_mps(&self, located: &[usize], k: usize, step_s: f64) -> f64 {
        let (a, b) = self.around(located, k, step_s, ((MEAN_S / step_s).round() as usize).max(1));
        // Rows further apart than that: the neighbours.
        let (a, b) = if a == b { (k.saturating_sub(1), (k + 1).min(located.len() - 1)) } else { (a, b) };
        let [from, to] = [a, b].map(|k| self.rows[located[k]]);
        let moved_m = match (fix(&from), fix(&to)) {
            (Some(from), Some(to)) if self.from_fixes => geo::distance_m(from, to),
            _ => (to.location_m.unwrap_or(0.0) - from.location_m.unwrap_or(0.0)).abs(),
        };
        let seconds = to.time_s - from.time_s;
        if seconds > 0.0 { moved_m / seconds } else { 0.0 }
    }

    /// Where the locations begin again elsewhere.
    fn jumps(&self, findings: &[Finding]) -> Vec<Cut> {
        let said = findings
            .iter()
            .filter(|finding| finding.done == Done::Said && matches!(finding.kind, Kind::Reset | Kind::Wrap));
        said.filter_map(|finding| {
            let at = self.rows.iter().position(|row| row.line == finding.line)?;
            Some((at..at, format!("the location jumps by {:.0} m", finding.figure.value)))
        })
        .collect()
    }

    /// Where the train turns: by the locations, or by the headings of its fixes before and after a standing.
    fn turns(&self, turn_m: f64) -> Vec<Cut> {
        let at = if self.from_fixes { self.turns_of_heading(turn_m) } else { self.turns_of_location(turn_m) };
        let standing = self.standing_ranges();
        let around = |at: usize| standing.iter().find(|range| range.start <= at + 3 && at <= range.end + 3);
        at.into_iter()
            .map(|at| {
                let middle = around(at).map_or(at, |range| usize::midpoint(range.start, range.end));
                (middle..middle, "the train turns".to_owned())
            })
            .collect()
    }

    fn turns_of_location(&self, turn_m: f64) -> Vec<usize> {
        let located: Vec<(usize, f64)> =
            self.rows.iter().enumerate().filter_map(|(i, row)| Some((i, row.location_m?))).collect();
        // The middle of three: one wild reading is no turn.
        let calm: Vec<(usize, f64)> = located
            .windows(3)
            .map(|three| {
                let mut metres = [three[0].1, three[1].1, three[2].1];
                metres.sort_by(f64::total_cmp);
                (three[1].0, metres[1])
            })
            .collect();
        let Some(first) = calm.first() else { return Vec::new() };
        let (mut low, mut high, mut sign, mut turns) = (*first, *first, 0.0, Vec::new());
        for here in &calm {
            if here.1 > high.1 {
                high = *here;
            }
            if here.1 < low.1 {
                low = *here;
            }
            if sign >= 0.0 && high.1 - here.1 > turn_m {
                if sign > 0.0 || high.1 - first.1 > turn_m {
                    turns.push(high.0);
                }
                (sign, low) = (-1.0, *here);
            } else if sign <= 0.0 && here.1 - low.1 > turn_m {
                if sign < 0.0 || first.1 - low.1 > turn_m {
                    turns.push(low.0);
                }
                (sign, high) = (1.0, *here);
            }
        }
        turns
    }

    fn turns_of_heading(&self, turn_m: f64) -> Vec<usize> {
        let reach_m = turn_m.clamp(60.0, 300.0);
        let near = |mut rows: Box<dyn Iterator<Item = &Sample> + '_>, from_m: f64| {
            rows.find(|row| row.location_m.is_some_and(|m| (m - from_m).abs() >= reach_m)).and_then(fix)
        };
        let turned = |range: &Range<usize>| {
            let middle = self.rows[range.clone()].iter().find_map(|row| Some((row.location_m?, fix(row)?)));
            let (from_m, here) = middle?;
            let before = near(Box::new(self.rows[..range.start].iter().rev()), from_m)?;
            let after = near(Box::new(self.rows[range.end..].iter()), from_m)?;
            let (a, b) = (geo::offset_m(before, here), geo::offset_m(here, after));
            let cosine = (a.0 * b.0 + a.1 * b.1) / (a.0.hypot(a.1) * b.0.hypot(b.1));
            // Trains do not take curves of 120 degrees in 600 m.
            (cosine < -0.5).then_some(usize::midpoint(range.start, range.end))
        };
        self.standing_ranges().iter().filter_map(turned).collect()
    }

    /// Rows in which the train stands; a pause of the recorder at one place counts.
    fn standing_ranges(&self) -> Vec<Range<usize>> {
        let mut ranges: Vec<Range<usize>> = Vec::new();
        let speeds = speeds::at_rows(&self.rows);
        let slow = |i: usize| speeds[i].is_some_and(|mps| mps < STANDS_MPS);
        for i in 0..self.rows.len() {
            let paused = i > 0 && {
                let (a, b) = (&self.rows[i - 1], &self.rows[i]);
                let seconds = b.time_s - a.time_s;
                let moved = a.location_m.zip(b.location_m).map(|(a, b)| (b - a).abs());
                seconds > 15.0 && moved.is_some_and(|metres| metres < 60.0 && metres < STANDS_MPS * seconds)
            };
            let from = if paused { i - 1 } else { i };
            if slow(i) || paused {
                match ranges.last_mut() {
                    Some(last) if last.end >= from => last.end = i + 1,
                    _ => ranges.push(from..i + 1),
                }
            }
        }
        ranges
    }

    fn standings(&self, standing_s: f64) -> Vec<Cut> {
        let long = |range: &Range<usize>| self.rows[range.end - 1].time_s - self.rows[range.start].time_s;
        let ranges = self.standing_ranges().into_iter().filter(|range| long(range) > standing_s);
        ranges.map(|range| (range.clone(), format!("the train stands for {:.0} s", long(&range)))).collect()
    }

    fn split(self, cuts: Vec<Cut>, account: &mut Account) -> Vec<Self> {
        let mut pieces = Vec::new();
        let (mut from, mut reason) = (0, self.reason.clone());
        let part = |range: Range<usize>, reason: String| Self {
            is_head: self.is_head && range.start == 0,
            rows: self.rows[range.clone()].to_vec(),
            altitudes_m: self.altitudes_m[range].to_vec(),
            unit: self.unit.clone(),
            run: self.run.clone(),
            is_dated: self.is_dated,
            from_fixes: self.from_fixes,
            reason,
        };
        for (range, why) in cuts {
            if range.end < from || range.start < from {
                continue;
            }
            let (mut end, mut begin) = (range.start, range.end);
            if range.start < range.end {
                let (first_s, last_s) = (self.rows[range.start].time_s, self.rows[range.end - 1].time_s);
                end += self.rows[range.clone()].iter().take_while(|row| row.time_s <= first_s + KEPT_S).count();
                begin -= self.rows[range.clone()].iter().rev().take_while(|row| row.time_s >= last_s - KEPT_S).count();
                account.count("rows of long standing, left out", begin.saturating_sub(end) as u64);
            }
            pieces.push(part(from..end, std::mem::replace(&mut reason, why)));
            from = begin.max(end);
        }
        pieces.push(part(from..self.rows.len(), reason));
        pieces
    }

    /// Too short a piece is said and left out.
    fn kept(self, settings: &RunCuts, account: &mut Account) -> Option<Self> {
        let (Some(first), Some(last)) = (self.rows.first(), self.rows.last()) else {
            return None;
        };
        let located = self.rows.iter().filter_map(|row| row.location_m);
        let (low, high) = located.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), m| (low.min(m), high.max(m)));
        let (length_m, seconds) = ((high - low).max(0.0), last.time_s - first.time_s);
        if length_m < settings.min_length_m || seconds < settings.min_duration_s {
            account.place("pieces too short for a run, left out", || {
                format!("lines {} to {}: expected {} m and {} s or more, found {length_m:.0} m in {seconds:.0} s; begins because {}", first.line, last.line, settings.min_length_m, settings.min_duration_s, self.reason)
            });
            account.count(ROWS_TOO_SHORT, self.rows.len() as u64);
            return None;
        }
        Some(self)
    }

    /// Middle places and lengths (s) of standing. A log that begins or ends at walking pace begins or ends at a stop.
    pub fn stops(&self) -> Vec<(f64, f64)> {
        let place = |range: &Range<usize>| {
            let places = self.rows[range.clone()].iter().filter_map(|row| row.location_m);
            let seconds = self.rows[range.end - 1].time_s - self.rows[range.start].time_s;
            median(places).map(|place| (place, seconds))
        };
        let speeds = speeds::at_rows(&self.rows);
        let end = |located: Option<(&Sample, &Option<f64>)>| {
            located.and_then(|(row, mps)| row.location_m.filter(|_| mps.is_some_and(|mps| mps < WALKS_MPS)))
        };
        let located = || self.rows.iter().zip(&speeds).filter(|(row, _)| row.location_m.is_some());
        let ends = [end(located().next()), end(located().next_back())].into_iter().flatten().map(|at_m| (at_m, STOP_S));
        self.standing_ranges().iter().filter_map(place).chain(ends).collect()
    }
}

/// Two rows of a moving train that is no further on than half a minute of travel: the clock jumped, the log has no gap.
fn went_on(a: &Sample, b: &Sample) -> bool {
    let moving = a.speed_mps.zip(b.speed_mps).map(|(a, b)| a.min(b)).filter(|mps| *mps > 5.0);
    let moved_m = a.location_m.zip(b.location_m).map(|(a, b)| (b - a).abs());
    moving.zip(moved_m).is_some_and(|(mps, metres)| metres > 0.0 && metres < 30.0 * mps)
}

/// Rows that end one run and begin the next, and the reason.
type Cut = (Range<usize>, String);

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
