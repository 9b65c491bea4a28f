//! Where a stretch is cut into runs: where it turns, jumps or stands for long, each with its reason.

use super::account::{Account, ROWS_TOO_SHORT};
use super::mapping::RunCuts;
use super::speeds::{FASTEST_MPS, STANDS_MPS};
use super::stretch::{Stretch, fix};
use super::{geo, speeds};
use rundown_check::finding::{Done, Finding, Kind};
use rundown_check::rows::times::MOST_MEAN_S;
use rundown_files::sample::Sample;
use rundown_files::statistics::{median, median_of, span};
use std::ops::Range;

/// A train that is slower comes to a stop, m/s.
const WALKS_MPS: f64 = 1.5;
/// Distance by location over that by speed, of one unit, over so many metres: no wheel is off by as much, but noise of
/// locations adds to the way.
const ONE_UNIT: Range<f64> = 0.8..1.3;
const LEAST_WAY_M: f64 = 500.0;
/// A shorter standing is none at a station, s.
pub const STOP_S: f64 = 10.0;
/// What is kept of a long standing on both sides of a cut, s.
const KEPT_S: f64 = 30.0;

/// Rows that end one run and begin the next, and the reason.
type Cut = (Range<usize>, String);

impl Stretch {
    /// All places at which it is cut, in their order.
    pub(super) fn cuts(&self, settings: &RunCuts, findings: &[Finding]) -> Vec<Cut> {
        let mut cuts = self.jumps(findings);
        cuts.extend(self.turns(settings.turn_m));
        cuts.extend(self.standings(settings.standing_s));
        cuts.sort_by_key(|cut| (cut.0.start, cut.0.end));
        cuts
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
        let calm: Vec<(usize, f64)> =
            located.windows(3).map(|three| (three[1].0, median_of(three.iter().map(|(_, at_m)| at_m)))).collect();
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

    pub(super) fn split(self, cuts: Vec<Cut>, account: &mut Account) -> Vec<Self> {
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
            turn_m: self.turn_m,
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
    pub(super) fn kept(self, settings: &RunCuts, account: &mut Account) -> Option<Self> {
        let (Some(first), Some(last)) = (self.rows.first(), self.rows.last()) else {
            return None;
        };
        let length_m = span(self.rows.iter().filter_map(|row| row.location_m)).max(0.0);
        let seconds = last.time_s - first.time_s;
        if length_m < settings.min_length_m || seconds < settings.min_duration_s {
            account.place("pieces too short for a run, left out", || {
                format!("lines {} to {}: expected {} m and {} s or more, found {length_m:.0} m in {seconds:.0} s; begins because {}", first.line, last.line, settings.min_length_m, settings.min_duration_s, self.reason)
            });
            account.count(ROWS_TOO_SHORT, self.rows.len() as u64);
            return None;
        }
        if let Some(ratio) = self.location_over_speed().filter(|ratio| !ONE_UNIT.contains(ratio)) {
            account.place("runs in which location and speed disagree, as of another unit", || {
                format!("lines {} to {}: expected 1 as location over speed, found {ratio:.3}", first.line, last.line)
            });
        }
        if length_m > FASTEST_MPS * seconds {
            account.place(
                "runs that are faster than any train by their locations: which unit, which decimal sign?",
                || {
                    format!(
                        "lines {} to {}: found {:.0} km in {:.0} min",
                        first.line,
                        last.line,
                        1e-3 * length_m,
                        seconds / 60.0
                    )
                },
            );
        }
        Some(self)
    }

    /// Distance by the locations over that by the speeds, where both are read.
    fn location_over_speed(&self) -> Option<f64> {
        // Either may stand in rows of its own.
        let speeds = speeds::at_rows(&self.rows);
        let read = self.rows.iter().zip(&speeds).filter(|(row, _)| !row.speed_is_computed);
        let located: Vec<[f64; 3]> =
            read.filter_map(|(row, speed_mps)| Some([row.time_s, row.location_m?, (*speed_mps)?])).collect();
        let steps = located.windows(2).filter_map(|pair| {
            let [[a_s, a_m, a_mps], [b_s, b_m, b_mps]] = [pair[0], pair[1]];
            let seconds = b_s - a_s;
            (seconds <= MOST_MEAN_S).then_some([(b_m - a_m).abs(), 0.5 * (a_mps + b_mps) * seconds])
        });
        let [by_location, by_speed] = steps.fold([0.0, 0.0], |sum, step| [sum[0] + step[0], sum[1] + step[1]]);
        (by_location.min(by_speed) > LEAST_WAY_M).then(|| by_location / by_speed)
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
