//! A centre line from the positions of many runs: the longest run as the first guess, then the median of all across it.

use super::geo::{self, Fix};
use super::staged::{Mark, Staged};
use rundown_files::map_matching::{CentreLine, Match, MatchState};
use rundown_files::statistics::{mean_of, median, sorted};
use rundown_files::track_file::CentreLinePoint;

/// Distance between points of the line, m.
const STEP_M: f64 = 50.0;
/// A fix further from the first guess says nothing of it, m.
const NEAR_M: f64 = 80.0;
/// Ends of other runs that are longer go on the line, m.
const LEAST_END_M: f64 = 300.0;
/// Least time from mark to mark, s, and a speed that trains are not slower than for the way between them, m/s: half of
/// the fastest that a match allows, as the way bends.
const LEAST_MARK_S: f64 = 1.0;
const SLOW_MPS: f64 = 60.0;
/// Times that the line may grow by the runs.
const MOST_GROWTH: usize = 50;

/// None where no run has positions.
pub fn centre_line(runs: &[&Staged]) -> Option<Vec<CentreLinePoint>> {
    let mut order: Vec<&&Staged> = runs.iter().filter(|run| run.fixes > 1).collect();
    order.sort_by(|a, b| b.length_m().total_cmp(&a.length_m()).then_with(|| a.name.cmp(&b.name)));
    let mut line = measured(&thinned(places(&fixes(order.first()?))));
    // The guess grows at its ends by what other runs went further, those that begin where others end one after the
    // other.
    for _ in 0..MOST_GROWTH {
        let before = line.len();
        for run in order.iter().skip(1) {
            line = measured(&lengthened(&line, &fixes(run)));
        }
        if line.len() == before {
            break;
        }
    }
    for _ in 0..2 {
        line = measured(&moved(&line, &order));
    }
    (line.len() > 1).then_some(line)
}

/// Stops of different runs that are nearer are one station, m.
const STATION_M: f64 = 80.0;

/// Where on the line runs stand; of several runs one that stands alone stands at a signal.
pub fn stations(runs: &[Staged], line: &[CentreLinePoint]) -> Vec<f64> {
    let stops_m = sorted(runs.iter().flat_map(|run| stops_on(run, line)));
    let groups = stops_m.chunk_by(|a, b| b - a < STATION_M);
    groups.filter(|group| group.len() >= 2.min(runs.len())).filter_map(median).collect()
}

fn stops_on(run: &Staged, line: &[CentreLinePoint]) -> Vec<f64> {
    let Some(matcher) = CentreLine::new(line) else { return Vec::new() };
    let mut state = MatchState::default();
    let mut located: Vec<(f64, f64)> = Vec::new();
    for fix in fixes(run) {
        located.extend(fix.on(&matcher, &mut state).map(|found| (fix.at_m, found.location_m)));
    }
    let nearest = |own_m: f64| located.iter().min_by(|a, b| (a.0 - own_m).abs().total_cmp(&(b.0 - own_m).abs()));
    run.stops.iter().filter_map(|(own_m, _)| nearest(*own_m)).map(|found| found.1).collect()
}

/// The same line, its locations counted from elsewhere, and backwards where `sign` is below zero.
pub fn counted(line: &[CentreLinePoint], sign: f64, offset_m: f64) -> Vec<CentreLinePoint> {
    let mut points: Vec<CentreLinePoint> = line.to_vec();
    points.iter_mut().for_each(|point| point.at_m = offset_m + sign * point.at_m);
    points.sort_by(|a, b| a.at_m.total_cmp(&b.at_m));
    points
}

/// A position of a run, its own location there, m, and a time by which a line finds it again behind the one before, s.
#[derive(Clone, Copy, Debug)]
pub struct TimedFix {
    pub time_s: f64,
    pub at_m: f64,
    pub fix: Fix,
    pub altitude_m: Option<f64>,
}

impl TimedFix {
    /// Where it lies on a line.
    pub fn on(&self, line: &CentreLine, state: &mut MatchState) -> Option<Match> {
        line.locate(state, self.time_s, Some(self.fix.0), Some(self.fix.1)).ok()
    }
}

/// The positions of a run. From mark to mark a second passes, also where marks have none, so that the line is found
/// again behind a tunnel; where they are far apart as long as a slow train takes.
pub fn fixes(run: &Staged) -> Vec<TimedFix> {
    let (mut time_s, mut last): (f64, Option<Fix>) = (0.0, None);
    let timed = |mark: &Mark| {
        let Some(fix) = mark.fix else {
            time_s += LEAST_MARK_S;
            return None;
        };
        let way_m = last.map_or(0.0, |last| geo::distance_m(last, fix));
        time_s += LEAST_MARK_S.max(way_m / SLOW_MPS);
        last = Some(fix);
        Some(TimedFix { time_s, at_m: mark.at_m, fix, altitude_m: mark.altitude_m })
    };
    run.marks().iter().filter_map(timed).collect()
}

/// Points at least a step from each other.
fn thinned(fixes: impl IntoIterator<Item = Fix>) -> Vec<Fix> {
    let mut kept: Vec<Fix> = Vec::new();
    for fix in fixes {
        if kept.last().is_none_or(|last| geo::distance_m(*last, fix) >= STEP_M) {
            kept.push(fix);
        }
    }
    kept
}

fn measured(points: &[Fix]) -> Vec<CentreLinePoint> {
    let mut at_m = 0.0;
    let mut last: Option<Fix> = None;
    let mut line = Vec::new();
    for point in points {
        let step_m = last.map_or(0.0, |last| geo::distance_m(last, *point));
        if last.is_none() || step_m > 1.0 {
            at_m += step_m;
            line.push(CentreLinePoint { at_m, latitude_deg: point.0, longitude_deg: point.1 });
            last = Some(*point);
        }
    }
    line
}

const fn fix_of(point: &CentreLinePoint) -> Fix {
    (point.latitude_deg, point.longitude_deg)
}

fn places(fixes: &[TimedFix]) -> impl DoubleEndedIterator<Item = Fix> {
    fixes.iter().map(|timed| timed.fix)
}

fn lengthened(line: &[CentreLinePoint], fixes: &[TimedFix]) -> Vec<Fix> {
    let points: Vec<Fix> = line.iter().map(fix_of).collect();
    let Some((matcher, last)) = CentreLine::new(line).zip(line.last()) else { return points };
    let mut state = MatchState::default();
    // A run that begins at the station where another ended begins some metres beyond the line.
    let inside = |m: f64| (-NEAR_M..=last.at_m + NEAR_M).contains(&m);
    let near = |found: Match| (found.distance_m < NEAR_M && inside(found.location_m)).then_some(found.location_m);
    let matched: Vec<Option<f64>> = fixes.iter().map(|fix| fix.on(&matcher, &mut state).and_then(near)).collect();
    let (Some(first), Some(end)) =
        (matched.iter().position(Option::is_some), matched.iter().rposition(Option::is_some))
    else {
        return points;
    };
    let length_m = |part: &[Fix]| part.windows(2).map(|pair| geo::distance_m(pair[0], pair[1])).sum::<f64>();
    let (mut before, mut after): (Vec<Fix>, Vec<Fix>) = (Vec::new(), Vec::new());
    let head: Vec<Fix> = places(&fixes[..first]).rev().collect();
    let tail: Vec<Fix> = places(&fixes[end + 1..]).collect();
    for (part, at) in [(head, matched[first]), (tail, matched[end])] {
        let at = at.unwrap_or(0.5 * last.at_m);
        if length_m(&part) < LEAST_END_M {
        } else if at < 3.0 * STEP_M && before.is_empty() {
            before = part;
        } else if at > last.at_m - 3.0 * STEP_M && after.is_empty() {
            after = part;
        }
    }
    before.reverse();
    thinned([before, points, after].concat())
}

/// Each point moved across the line to the middle of the runs that pass it.
fn moved(line: &[CentreLinePoint], runs: &[&&Staged]) -> Vec<Fix> {
    let mut across: Vec<Vec<f64>> = vec![Vec::new(); line.len()];
    let Some(matcher) = CentreLine::new(line) else { return Vec::new() };
    for run in runs {
        let mut own: Vec<Vec<f64>> = vec![Vec::new(); line.len()];
        let mut state = MatchState::default();
        for fix in fixes(run) {
            let Some(found) = fix.on(&matcher, &mut state) else { continue };
            if found.distance_m < NEAR_M {
                let index = line.partition_point(|point| point.at_m <= found.location_m).clamp(1, line.len() - 1);
                let (north, east) = along(line, index);
                let from = geo::offset_m(fix_of(&line[index - 1]), fix.fix);
                own[index].push(from.1 * north - from.0 * east);
            }
        }
        for (all, own) in across.iter_mut().zip(own) {
            all.extend(median(own));
        }
    }
    // Smooth: the mean of three neighbours, so that one fix makes no kink.
    let medians: Vec<f64> = across.into_iter().map(|all| median(all).unwrap_or(0.0)).collect();
    let smooth = |i: usize| {
        let near = &medians[i.saturating_sub(1)..(i + 2).min(medians.len())];
        mean_of(near)
    };
    let place = |i: usize| {
        let (north, east) = along(line, i.max(1));
        let shift_m = smooth(i);
        geo::moved(fix_of(&line[i]), (-east * shift_m, north * shift_m))
    };
    (0..line.len()).map(place).collect()
}

/// Direction of the piece that ends at a point.
fn along(line: &[CentreLinePoint], index: usize) -> (f64, f64) {
    let (north, east) = geo::offset_m(fix_of(&line[index - 1]), fix_of(&line[index]));
    let length = north.hypot(east).max(1e-9);
    (north / length, east / length)
}
