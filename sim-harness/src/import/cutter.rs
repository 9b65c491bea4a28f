//! Rows as they come, as stretches without a gap.

use super::geo;
use super::mapping::RunCuts;
use super::rows::Record;
use super::speeds::FASTEST_MPS;
use super::stretch::{Stretch, fix};
use rundown_files::sample::Sample;

/// Rows that are held at most before a stretch is cut without another reason.
const MOST_ROWS: usize = 500_000;
/// What no row has continued for so many is over.
const LEFT_ROWS: u64 = 20_000;
/// One of so many rows has a place, and a train is no further from it than it may have gone, and this, m.
const BESIDE: usize = 20;
const ELSEWHERE_M: f64 = 1000.0;
/// A clock that goes back by more, beside a train that does not move, is that of a recorder which was switched on again
/// and has not received the time, s.
const MOST_BACK_S: f64 = 1.2 * 86_400.0;

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
        let of_this = || (0..self.held.len()).filter(|at| is_of(&self.held[*at]));
        let cut_at = |at: usize| self.cut(&self.held[at].stretch, &record);
        let mut found = of_this().max_by_key(|at| self.held[*at].last);
        let mut cut = found.and_then(|at| Some((at, cut_at(at)?)));
        // Behind what was sent late goes on what was there before it.
        let goes_on = |at: &usize| self.held[*at].stretch.is_before(&record.sample) && cut_at(*at).is_none();
        if cut.is_some()
            && let Some(before) = of_this().find(goes_on)
        {
            (found, cut) = (Some(before), None);
        }
        // What is over, and what was over before that began.
        let mut ended_before = self.rows.saturating_sub(LEFT_ROWS);
        let mut over = None;
        let at = match (found, cut) {
            // What comes late is no end of what it interrupts.
            (_, Some((at, reason))) if !self.held[at].stretch.is_before(&record.sample) => {
                self.begin(&record, reason, false)
            }
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
        } else if -gap_s > self.settings.gap_s && is_elsewhere(stretch, &record.sample) {
            Some(format!("the time goes back by {:.0} s, to another place", -gap_s))
        } else if -gap_s > MOST_BACK_S && !went_on(last, &record.sample) {
            Some(format!("the time goes back by {:.0} s", -gap_s))
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

/// A row is not where the train may be that was here before: rows that a recorder could not send in time stand behind
/// later ones, where a clock that is set back leaves the train in its place.
fn is_elsewhere(stretch: &Stretch, row: &Sample) -> bool {
    let rows = &stretch.rows;
    let Some(last) = rows.last() else { return false };
    let step_s = rows.iter().rev().nth(1).map_or(0.0, |before| last.time_s - before.time_s);
    let beyond_m = |before: &Sample| {
        let located = before.location_m.zip(row.location_m).map(|(a, b)| (b - a).abs());
        let away_m = located.or_else(|| Some(geo::distance_m(fix(before)?, fix(row)?)))?;
        let since_s = last.time_s - before.time_s + step_s;
        Some(away_m - 2.0 * before.speed_mps.unwrap_or(FASTEST_MPS) * since_s)
    };
    let beside = rows.iter().rev().take(BESIDE).find_map(beyond_m);
    beside.is_some_and(|metres| metres > ELSEWHERE_M)
}

/// Two rows of a moving train that is no further on than half a minute of travel: the clock jumped, the log has no gap.
fn went_on(a: &Sample, b: &Sample) -> bool {
    let moving = a.speed_mps.zip(b.speed_mps).map(|(a, b)| a.min(b)).filter(|mps| *mps > 5.0);
    let moved_m = a.location_m.zip(b.location_m).map(|(a, b)| (b - a).abs());
    moving.zip(moved_m).is_some_and(|(mps, metres)| metres > 0.0 && metres < 30.0 * mps)
}
