//! Distances along the fixes, and speeds by the locations, of a stretch whose file has none.

use super::account::Account;
use super::stretch::{Stretch, fix};
use super::{cubic, geo, still};
use rundown_check::rows::{steps, times};
use rundown_files::sample::Sample;

/// A speed is the slope in the middle of so long before and after, s; where there are not as many rows on both sides,
/// the mean of this.
const SLOPE_S: f64 = 5.0;
const MEAN_S: f64 = 4.0;
/// Rows that are further apart show no slope, s.
const SLOPE_STEP_S: f64 = 10.5;
/// Fixes that are further from such a slope leapt, m.
const LEFT_M: f64 = 15.0;
/// Locations in larger steps show no speed, m.
const COARSEST_M: f64 = 30.0;
/// No train is faster, m/s: locations that leap show no speed.
const FASTEST_MPS: f64 = 110.0;
/// Fixes nearer than this to the last one counted say nothing of a distance, m.
const ANCHOR_M: f64 = 15.0;

/// A fix further than at this pace, m/s, and this distance, m, from the last one jumps.
const JUMPS_MPS: f64 = 150.0;
const JUMPS_M: f64 = 300.0;
/// So many first fixes at most may be old ones, and so many that follow say it.
const MOST_OLD: usize = 4;
const FOLLOWING: usize = 20;

const TOO_COARSE: &str = "runs whose locations are too coarse for speeds, and that have none";

impl Stretch {
    /// Distances along the fixes, where there is no location.
    pub(super) fn locate(&mut self, account: &mut Account) {
        if self.rows.iter().any(|row| row.location_m.is_some()) {
            return;
        }
        self.from_fixes = true;
        let frozen = still::frozen(&self.rows);
        account.count(
            "fixes that stand still and then leap, as of a receiver in a tunnel, taken as missing",
            frozen.len() as u64,
        );
        for i in frozen {
            (self.rows[i].latitude_deg, self.rows[i].longitude_deg) = (None, None);
        }
        let old = old_fixes(&self.rows);
        account.count("first fixes far from where the following ones begin, taken as missing", old.len() as u64);
        for i in old {
            (self.rows[i].latitude_deg, self.rows[i].longitude_deg) = (None, None);
        }
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
            if jumps(&self.rows[at], &self.rows[i]) {
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
    pub(super) fn speeds(&mut self, account: &mut Account) {
        if self.rows.iter().any(|row| row.speed_mps.is_some()) {
            return;
        }
        if let Some(step_m) = steps::of_location_m(self.rows.iter()).filter(|step_m| *step_m > COARSEST_M) {
            account.place(TOO_COARSE, || format!("locations have steps of {step_m:.0} m"));
            return;
        }
        let located: Vec<usize> = (0..self.rows.len()).filter(|i| self.rows[*i].location_m.is_some()).collect();
        let step_s = times::usual_step_s(&self.rows);
        // Over longer a train does more than a cubic, too.
        let is_short = step_s * cubic::LEAST as f64 <= 2.0 * SLOPE_S;
        let mps = |k: usize| match self.slope(&located, k, step_s) {
            Some((_, left_m)) if is_short && self.from_fixes && left_m > LEFT_M => None,
            Some((mps, _)) => Some(mps),
            None => Some(self.mean_mps(&located, k, step_s)),
        };
        let possible = |mps: &f64| *mps < FASTEST_MPS;
        let speeds: Vec<Option<f64>> = (0..located.len()).map(|k| mps(k).filter(possible)).collect();
        let found = speeds.iter().flatten().count();
        account.count("speeds computed from the locations", found as u64);
        account.count("rows beside a leap of the locations, without a speed", (speeds.len() - found) as u64);
        for (i, mps) in located.iter().zip(speeds) {
            (self.rows[*i].speed_mps, self.rows[*i].speed_is_computed) = (mps, mps.is_some());
        }
        if self.from_fixes && step_s <= SLOPE_STEP_S {
            let rows: Vec<Sample> = located.iter().map(|i| self.rows[*i]).collect();
            let stands = still::stands(&rows, step_s);
            account.count(
                "speeds of 0 where the fixes stay in one place for 20 s",
                stands.iter().filter(|one| **one).count() as u64,
            );
            for (i, _) in located.into_iter().zip(stands).filter(|(_, stands)| *stands) {
                (self.rows[i].speed_mps, self.rows[i].speed_is_computed) = (Some(0.0), true);
            }
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
}

/// No train came from one fix to the other.
fn jumps(from: &Sample, to: &Sample) -> bool {
    let apart_m = fix(from).zip(fix(to)).map(|(a, b)| geo::distance_m(a, b));
    apart_m.is_some_and(|metres| metres > JUMPS_MPS * (to.time_s - from.time_s) + JUMPS_M)
}

/// The first rows with the fix at which the receiver was switched off: more of those that follow go on from the one
/// behind them.
fn old_fixes(rows: &[Sample]) -> Vec<usize> {
    let fixes = rows.iter().enumerate().filter(|(_, row)| fix(row).is_some());
    let fixes: Vec<(usize, &Sample)> = fixes.take(MOST_OLD + 1 + FOLLOWING).collect();
    let is_old = |last: &usize| {
        let [(_, old), (_, new)] = [fixes[*last], fixes[*last + 1]];
        let going_on = |from: &Sample| fixes[*last + 2..].iter().filter(|(_, row)| !jumps(from, row)).count();
        // A single fix that jumps lies between others that go on.
        let are_old = fixes[..=*last].iter().all(|(_, row)| jumps(row, new));
        are_old && going_on(new) > going_on(old)
    };
    let old = (0..MOST_OLD.min(fixes.len().saturating_sub(1))).find(is_old).map_or(0, |last| last + 1);
    fixes[..old].iter().map(|(i, _)| *i).collect()
}
