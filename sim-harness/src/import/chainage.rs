//! Many runs on one chainage: as they are, by the places where trains stop, by their speeds over the location, or on a
//! centre line.

use super::line;
use super::mapping::Method;
use super::odometer;
use super::staged::Staged;
use rundown_check::location::line_scale::{self, through};
use rundown_files::map_matching::{CentreLine, MatchState};
use rundown_files::sample::MOST_LOCATION_M;
use rundown_files::statistics::{correlation, median, sorted};
use rundown_files::track_file::CentreLinePoint;

/// Where the locations of a run go.
#[derive(Clone, Debug, PartialEq)]
pub enum Placing {
    /// location = offset + factor * own location. Below 0 the run is inverted; other than 1 in size its wheel is not
    /// the one that it counts with.
    Shift {
        factor: f64,
        offset_m: f64,
        how: String,
    },
    OnLine {
        share: f64,
    },
    /// It cannot be placed.
    Out(String),
}

#[derive(Clone, Debug)]
pub struct Placed {
    pub method: Method,
    /// Why this method.
    pub why: String,
    /// Run by run.
    pub places: Vec<Placing>,
    pub line: Vec<CentreLinePoint>,
    /// What a person is to be warned of.
    pub doubt: Option<String>,
}

/// What a track says of the line before any run.
#[derive(Clone, Debug, Default)]
pub struct Given {
    pub line: Vec<CentreLinePoint>,
    /// Where trains stop, m.
    pub stops_m: Vec<f64>,
}

/// So many stops tell a place and a direction.
pub const LEAST_STOPS: usize = 3;
/// Stops agree within, m: platforms are long, and trains stop anywhere along them.
const STOP_M: f64 = 80.0;
/// Offsets that differ by less are the same answer, m.
const SAME_M: f64 = 600.0;
/// Locations that begin below it are a run's own, m.
const OWN_M: f64 = 100.0;
/// Width of a bin of the speed over the location, m.
const BIN_M: f64 = 50.0;
const LEAST_BINS: usize = 40;
const LEAST_CORRELATION: f64 = 0.6;
const LEAST_LEAD: f64 = 0.1;
/// Of two directions between the same ends; the other places are out already.
const LEAST_LEAD_BETWEEN_ENDS: f64 = 0.05;
/// So many runs that all go one way let another go that way, if its speeds agree a little better so.
const ALL_ONE_WAY: usize = 10;
/// Share of the fixes that must lie on the line.
const LEAST_ON_LINE: f64 = 0.8;
const AS_IT_IS: Placing = Placing::Shift { factor: 1.0, offset_m: 0.0, how: String::new() };

/// Places runs, on a line of which something is known already.
pub fn place(runs: &[Staged], wanted: Option<Method>, given: Given) -> Placed {
    match wanted {
        Some(method) => by(method, "asked for".to_owned(), runs, given),
        None => found(runs, given),
    }
}

/// By the method that the runs call for.
fn found(runs: &[Staged], given: Given) -> Placed {
    let (method, why) = decided(runs, &given);
    let counts = if method == Method::AsIs { odometer::counts_on(runs) } else { None };
    let Some(counts) = counts else { return by(method, why, runs, given) };
    // Stops that agree by chance place one run, not most of them; speeds agree by chance more often.
    let places = shifted(runs, &[KnownLine::by_stops], &given.stops_m);
    let left_out = places.iter().filter(|place| matches!(place, Placing::Out(_))).count();
    if 5 * left_out <= runs.len() && runs.len() > 1 {
        return by(Method::Stops, format!("{counts}; most runs stop at the same places"), runs, given);
    }
    by(Method::AsIs, format!("{counts}, and the runs do not stop at the same places"), runs, given)
}

fn by(method: Method, why: String, runs: &[Staged], given: Given) -> Placed {
    let places = match method {
        Method::Line => return on_line(runs, given, why),
        Method::AsIs => as_they_are(runs),
        Method::Stops => {
            let ways = [KnownLine::by_scaled_stops, KnownLine::by_stops, KnownLine::by_ends, KnownLine::by_speeds];
            shifted(runs, &ways, &given.stops_m)
        }
        Method::Align => shifted(runs, &[KnownLine::by_speeds], &[]),
    };
    Placed { method, why, places, line: Vec::new(), doubt: None }
}

fn as_they_are(runs: &[Staged]) -> Vec<Placing> {
    let mut places = vec![AS_IT_IS; runs.len()];
    unturned(runs, &mut places);
    within_range(runs, &mut places);
    if runs.len() > 1 {
        for (run, place) in runs.iter().zip(&mut places) {
            if run.from_fixes {
                *place = Placing::Out("it has positions and no location: --chainage line".to_owned());
            }
        }
    }
    places
}

/// Moves runs by whole turns of an odometer that began again at zero in some of them: where it was joined on the way
/// back, the same places are a turn lower. Only onto a run that passes most of the same places then.
fn unturned(runs: &[Staged], places: &mut [Placing]) {
    // The highest: no location is below zero there.
    let wrapped = runs.iter().filter_map(|run| Some((run, run.turn_m?)));
    let Some((onto, turn_m)) = wrapped.max_by(|a, b| a.0.ends_m.0.total_cmp(&b.0.ends_m.0)) else { return };
    for (run, place) in runs.iter().zip(places) {
        let [middle_m, onto_m] = [run, onto].map(|run| 0.5 * (run.ends_m.0 + run.ends_m.1));
        let turns = ((onto_m - middle_m) / turn_m).round();
        let offset_m = turns * turn_m;
        let (low_m, high_m) = (run.ends_m.0 + offset_m, run.ends_m.1 + offset_m);
        let both_m = high_m.min(onto.ends_m.1) - low_m.max(onto.ends_m.0);
        if turns != 0.0 && run.unit == onto.unit && both_m > 0.5 * (high_m - low_m) {
            let how = format!(
                "an odometer that begins again at zero after {turn_m:.0} m: by {turns:+} turns, onto {}",
                onto.name
            );
            *place = Placing::Shift { factor: 1.0, offset_m, how };
        }
    }
}

/// Brings runs that stay as they are into the range of a chainage: by one shift, or each to begin at 0.
fn within_range(runs: &[Staged], places: &mut [Placing]) {
    if !runs.iter().any(|run| odometer::is_far(run.ends_m)) {
        return;
    }
    let least_m = runs.iter().map(|run| run.ends_m.0).fold(f64::INFINITY, f64::min);
    let most_m = runs.iter().map(|run| run.ends_m.1).fold(f64::NEG_INFINITY, f64::max);
    for (run, place) in runs.iter().zip(places) {
        let is_near = !odometer::is_far(run.ends_m);
        if is_near && most_m - least_m >= MOST_LOCATION_M {
            continue;
        }
        let (from_m, how) = if most_m - least_m < MOST_LOCATION_M {
            (least_m, "an odometer beyond any line: all runs by the same distance, so that the first begins at 0")
        } else {
            (run.ends_m.0, "odometers beyond any line and far apart: each run begins at 0")
        };
        *place = Placing::Shift { factor: 1.0, offset_m: -from_m, how: how.to_owned() };
    }
}

fn decided(runs: &[Staged], given: &Given) -> (Method, String) {
    let with_fixes = runs.iter().filter(|run| run.fixes > 1).count();
    let many_fixes = 10 * with_fixes >= 9 * runs.len();
    if !given.line.is_empty() && many_fixes {
        return (Method::Line, "a track with a centre line is given".to_owned());
    }
    if runs.iter().any(|run| run.from_fixes) {
        return (Method::Line, "there are positions and no locations".to_owned());
    }
    if given.stops_m.len() >= LEAST_STOPS {
        return by_stops_of(runs, &given.stops_m);
    }
    // A piece behind a cut goes on where the one before ended; the first of a file or a run says where its locations
    // begin.
    let heads: Vec<&Staged> = runs.iter().filter(|run| run.is_head).collect();
    let own = heads.iter().filter(|run| run.first_m.abs() < OWN_M).count();
    if heads.len() < 2 || 10 * own < 9 * heads.len() {
        return (Method::AsIs, "the locations begin at different places, or in one log only".to_owned());
    }
    let why = format!("the locations of {own} of {} logs begin at 0", heads.len());
    if many_fixes {
        return (Method::Line, format!("{why}, and there are positions"));
    }
    let stops: Vec<Vec<f64>> = runs.iter().map(own_stops).collect();
    let agree = |own: &Vec<f64>| {
        let others = || stops.iter().filter(|other| !std::ptr::eq(*other, own)).flatten();
        2 * own.iter().filter(|stop| **stop > OWN_M && others().any(|other| (other - *stop).abs() < STOP_M)).count()
            >= own.len().max(2) - 1
    };
    if stops.iter().all(|stops| stops.len() > 2) && stops.iter().filter(|own| agree(own)).count() * 10 >= 8 * runs.len()
    {
        return (Method::AsIs, format!("{why}, and the trains stop at the same places as they are"));
    }
    let alike = one_length(&heads).map_or(0, |(_, alike)| alike);
    let ends = if alike > 0 { format!(", and {alike} end at the same place") } else { String::new() };
    (Method::Stops, format!("{why}{ends}"))
}

/// The length that four fifths of the runs have, and how many have it.
fn one_length(runs: &[&Staged]) -> Option<(f64, usize)> {
    let lengths_m: Vec<f64> = runs.iter().map(|run| run.length_m()).collect();
    let length_m = median(&lengths_m)?;
    let alike = lengths_m.iter().filter(|other| (**other - length_m).abs() < STOP_M).count();
    (runs.len() > 1 && 10 * alike >= 8 * runs.len()).then_some((length_m, alike))
}

/// By the stops of a track: as they are where most runs stop there already.
fn by_stops_of(runs: &[Staged], stops_m: &[f64]) -> (Method, String) {
    let is_there = |stop: &&f64| stops_m.iter().any(|known| (known - **stop).abs() < STOP_M);
    let agrees = |own: &Vec<f64>| 2 * own.iter().filter(is_there).count() > own.len();
    let agree = runs.iter().map(own_stops).filter(agrees).count();
    if 10 * agree >= 8 * runs.len() {
        return (Method::AsIs, format!("{agree} of {} runs stop where the track has its stops", runs.len()));
    }
    (Method::Stops, "the track has stops, and the runs do not stop there as they are".to_owned())
}

/// Own locations where a run stands, its ends among them.
fn own_stops(run: &Staged) -> Vec<f64> {
    let mut stops = sorted(run.stops.iter().map(|(at_m, _)| at_m));
    stops.dedup_by(|a, b| (*a - *b).abs() < STOP_M);
    stops
}

/// Projected on the line of the track, or on one that is made of them; that counts as the track does, where its stops
/// tell how.
fn on_line(runs: &[Staged], given: Given, mut why: String) -> Placed {
    let all: Vec<&Staged> = runs.iter().collect();
    let is_made = given.line.is_empty();
    let mut line = if is_made { line::centre_line(&all).unwrap_or_default() } else { given.line };
    let mut doubt = None;
    if is_made && !given.stops_m.is_empty() {
        let known = KnownLine { stops: given.stops_m, ..KnownLine::default() };
        match known.agree_at_one_place(&line::stations(runs, &line)) {
            Some((sign, offset_m, how)) => {
                why += &format!("; the line is counted as the track is: {how}");
                line = line::counted(&line, sign, offset_m);
            }
            None => doubt = Some(STOPS_NOT_USED.to_owned()),
        }
    }
    let places = places_on(runs, &line);
    Placed { method: Method::Line, why, places, line, doubt }
}

const STOPS_NOT_USED: &str = "the track has no centre line, and its stops are not used, for those of the runs agree with \
                              them at no one place: the chainage is that of the longest run; --chainage stops tries \
                              run by run";

fn places_on(runs: &[Staged], line: &[CentreLinePoint]) -> Vec<Placing> {
    let Some(matcher) = CentreLine::new(line) else {
        return vec![Placing::Out("there are no positions".to_owned()); runs.len()];
    };
    let place = |run: &Staged| {
        let fixes = line::fixes(run);
        let mut state = MatchState::default();
        let on = fixes.iter().filter(|fix| fix.on(&matcher, &mut state).is_some());
        let share = on.count() as f64 / fixes.len().max(1) as f64;
        if fixes.len() < 2 {
            Placing::Out("it has no positions".to_owned())
        } else if share < LEAST_ON_LINE {
            Placing::Out(format!(
                "{:.0} % of its positions lie on the centre line, {:.0} % are needed",
                100.0 * share,
                100.0 * LEAST_ON_LINE
            ))
        } else {
            Placing::OnLine { share }
        }
    };
    runs.iter().map(place).collect()
}

/// Factor and offset of a run on what is known of the line, and why.
type FindPlace = fn(&KnownLine, &Staged) -> Option<(f64, f64, String)>;

/// What the runs that are placed say of the line.
#[derive(Default)]
struct KnownLine {
    stops: Vec<f64>,
    /// Sum and count of speeds, by bin.
    speeds: std::collections::BTreeMap<i64, (f64, u32)>,
    /// Both ends of the first run, m, where most are as long: they go from the one to the other, or back.
    ends_m: Option<(f64, f64)>,
    /// The stops are those of a track, and so the lengths between them are right.
    of_track: bool,
    /// How many runs go up, how many down.
    ways: (usize, usize),
    /// Each run was looked at once.
    all_seen: bool,
}

impl KnownLine {
    fn add(&mut self, run: &Staged, factor: f64, offset_m: f64) {
        *(if factor > 0.0 { &mut self.ways.0 } else { &mut self.ways.1 }) += 1;
        for stop in own_stops(run) {
            let at_m = offset_m + factor * stop;
            if self.stops.iter().all(|known| (known - at_m).abs() > STOP_M) {
                self.stops.push(at_m);
            }
        }
        for (bin, mps) in profile(run, factor) {
            let entry = self.speeds.entry(bin + (offset_m / BIN_M).round() as i64).or_default();
            *entry = (entry.0 + mps, entry.1 + 1);
        }
    }

    /// By the stops: how many agree, sign and offset, the best first.
    fn agreeing(&self, own: &[f64]) -> Vec<(usize, f64, f64)> {
        let mut best: Vec<(usize, f64, f64)> = Vec::new();
        for sign in [1.0, -1.0] {
            for known in &self.stops {
                for stop in own {
                    let offset_m = known - sign * stop;
                    let off = |stop: &f64| {
                        self.stops
                            .iter()
                            .map(|known| known - offset_m - sign * stop)
                            .min_by(|a, b| a.abs().total_cmp(&b.abs()))
                    };
                    let near: Vec<f64> = own.iter().filter_map(off).filter(|off| off.abs() < STOP_M).collect();
                    let refined = offset_m + median(&near).unwrap_or(0.0);
                    best.push((near.len(), sign, refined));
                }
            }
        }
        best.sort_by(|a, b| b.0.cmp(&a.0).then(b.1.total_cmp(&a.1)).then(a.2.total_cmp(&b.2)));
        best
    }

    fn by_stops(&self, run: &Staged) -> Option<(f64, f64, String)> {
        self.agree_at_one_place(&own_stops(run))
    }

    /// Sign and offset by which these stops are those of the line, where three or more, and at least half, agree so and
    /// fewer otherwise.
    fn agree_at_one_place(&self, own: &[f64]) -> Option<(f64, f64, String)> {
        let best = self.agreeing(own);
        let (count, sign, offset_m) = *best.first()?;
        let other =
            best.iter().find(|other| other.1 != sign || (other.2 - offset_m).abs() > SAME_M).map_or(0, |other| other.0);
        let clear = count >= 3 && count > other && 2 * count >= own.len();
        clear.then(|| (sign, offset_m, format!("{count} of {} stops agree, {other} at the next best place", own.len())))
    }

    /// By the stops of a track, where the wheel of the run is not the one that it counts with, so that more of its
    /// stops agree: by least squares over these.
    fn by_scaled_stops(&self, run: &Staged) -> Option<(f64, f64, String)> {
        if !self.of_track {
            return None;
        }
        let own = own_stops(run);
        let (first, last) = (*own.first()?, *own.last()?);
        let as_counted = self.agreeing(&own).first().map_or(0, |best| best.0);
        let pairs = self.stops.iter().flat_map(|from| self.stops.iter().map(move |to| (*from, *to)));
        let placed = |(from, to): (f64, f64)| {
            let factor = (to - from) / (last - first);
            ((factor.abs() - 1.0).abs() < line_scale::MOST_OFF)
                .then(|| self.refined(&own, factor, from - factor * first))?
        };
        let mut found: Vec<(usize, f64, f64)> = pairs.filter_map(placed).collect();
        found.sort_by(|a, b| b.0.cmp(&a.0).then(a.2.total_cmp(&b.2)));
        let (count, factor, offset_m) = *found.first()?;
        let is_other = |other: &&(usize, f64, f64)| other.1 * factor < 0.0 || (other.2 - offset_m).abs() > SAME_M;
        let other = found.iter().find(is_other).map_or(0, |other| other.0);
        let clear = count >= line_scale::LEAST_STOPS && count > other.max(as_counted) && 10 * count >= 8 * own.len();
        if !clear {
            return None;
        }
        let percent = 100.0 * (1.0 / factor.abs() - 1.0);
        let how = format!(
            "{count} of {} stops agree if its distances are {:.2} % too {}, {other} at the next best place",
            own.len(),
            percent.abs(),
            if percent > 0.0 { "long" } else { "short" },
        );
        Some((factor, offset_m, how))
    }

    /// How many stops of a run agree, with factor and offset by least squares over these.
    fn refined(&self, own: &[f64], factor: f64, offset_m: f64) -> Option<(usize, f64, f64)> {
        let fit = through(own, &self.stops, 1.0 / factor, -offset_m / factor)?;
        Some((fit.stops, 1.0 / fit.scale, -fit.offset_m / fit.scale))
    }

    /// By both ends: only the direction is open, and the speeds over the location tell it.
    fn by_ends(&self, run: &Staged) -> Option<(f64, f64, String)> {
        let (low_m, high_m) = self.ends_m?;
        if (run.length_m() - (high_m - low_m)).abs() >= STOP_M {
            return None;
        }
        // Noise of the first reading is no offset.
        let as_it_is = (run.ends_m.0 - low_m).abs() < STOP_M && (run.ends_m.1 - high_m).abs() < STOP_M;
        let offset_m = |sign: f64| match sign > 0.0 {
            true if as_it_is => 0.0,
            true => low_m - run.ends_m.0,
            false => high_m + run.ends_m.0,
        };
        let correlation = |sign: f64| {
            let own = profile(run, sign);
            self.correlation(&own, (offset_m(sign) / BIN_M).round() as i64, LEAST_BINS.max(own.len() * 6 / 10))
        };
        let (forth, back) = (correlation(1.0)?, correlation(-1.0)?);
        let sign = if forth >= back { 1.0 } else { -1.0 };
        let others = if sign > 0.0 { self.ways } else { (self.ways.1, self.ways.0) };
        let all_go_so = self.all_seen && others.0 >= ALL_ONE_WAY && others.1 == 0;
        (all_go_so || (forth - back).abs() >= LEAST_LEAD_BETWEEN_ENDS).then(|| {
            let (r, other) = (forth.max(back), forth.min(back));
            let how = format!("it has both ends of the others; speeds over the location correlate by {r:.2}, {other:.2} in the other direction");
            (sign, offset_m(sign), how)
        })
    }

    /// By the speeds over the location.
    fn by_speeds(&self, run: &Staged) -> Option<(f64, f64, String)> {
        let (low, high) = (*self.speeds.keys().next()?, *self.speeds.keys().next_back()?);
        let mut found: Vec<(f64, f64, i64)> = Vec::new();
        for sign in [1.0, -1.0] {
            let own = profile(run, sign);
            let (Some(first), Some(last)) = (own.first(), own.last()) else { continue };
            let least = LEAST_BINS.max(own.len() * 6 / 10);
            // Coarse first, then around the best.
            let coarse = (low - last.0..=high - first.0).step_by(4);
            let score = |shift: i64| self.correlation(&own, shift, least).map(|r| (r, sign, shift));
            let rough: Vec<(f64, f64, i64)> = coarse.filter_map(score).collect();
            if let Some(top) = rough.iter().copied().max_by(|a, b| a.0.total_cmp(&b.0)) {
                found.extend((top.2 - 4..=top.2 + 4).filter_map(score));
            }
            found.extend(rough);
        }
        found.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.2.cmp(&b.2)));
        let (r, sign, shift) = *found.first()?;
        let same = (SAME_M / BIN_M) as i64;
        let other =
            found.iter().find(|other| other.1 != sign || (other.2 - shift).abs() > same).map_or(0.0, |other| other.0);
        let clear = r >= LEAST_CORRELATION && r - other >= LEAST_LEAD;
        clear.then(|| {
            (
                sign,
                shift as f64 * BIN_M,
                format!("speeds over the location correlate by {r:.2}, {other:.2} at the next best place"),
            )
        })
    }

    fn correlation(&self, own: &[(i64, f64)], shift: i64, least: usize) -> Option<f64> {
        let pairs: Vec<(f64, f64)> = own
            .iter()
            .filter_map(|(bin, mps)| {
                let (sum, count) = self.speeds.get(&(bin + shift))?;
                Some((*mps, sum / f64::from(*count)))
            })
            .collect();
        if pairs.len() < least { None } else { correlation(&pairs) }
    }
}

/// Speeds by bins of the location, once each.
fn profile(run: &Staged, factor: f64) -> Vec<(i64, f64)> {
    let mut bins: std::collections::BTreeMap<i64, f64> = std::collections::BTreeMap::new();
    for pair in run.marks().windows(2) {
        let bin = |mark: f64| (factor * mark / BIN_M).round() as i64;
        let (from, to) = (bin(pair[0].at_m), bin(pair[1].at_m));
        // A gap in the log is none in the profile as long as it is short.
        for between in from.min(to)..=from.max(to).min(from.min(to) + 4) {
            bins.insert(between, 0.5 * (pair[0].speed_mps + pair[1].speed_mps));
        }
    }
    bins.into_iter().collect()
}

/// A run of the length that most have stays as it is, of several the longest, of these the first; the others are placed
/// beside those that are placed already. Runs of a length of their own come last: two that a short stop did not part,
/// or the readings of another wheel. Where the stops of a track are known, all are placed by these.
fn shifted(runs: &[Staged], ways: &[FindPlace], stops_m: &[f64]) -> Vec<Placing> {
    let lengths_m: Vec<f64> = runs.iter().map(Staged::length_m).collect();
    let alike = |length_m: f64| lengths_m.iter().filter(|other| (**other - length_m).abs() < STOP_M).count();
    let mut order: Vec<(usize, usize)> = lengths_m.iter().map(|length_m| alike(*length_m)).enumerate().collect();
    let steps = |index: usize| (lengths_m[index] / STOP_M).round();
    order.sort_by(|a, b| b.1.cmp(&a.1).then(steps(b.0).total_cmp(&steps(a.0))).then(a.cmp(b)));
    let order: Vec<usize> = order.into_iter().map(|(index, _)| index).collect();
    let mut places: Vec<Option<Placing>> = vec![None; runs.len()];
    let mut known = KnownLine { stops: stops_m.to_vec(), of_track: !stops_m.is_empty(), ..KnownLine::default() };
    if let (Some(first), []) = (order.first(), stops_m) {
        known.add(&runs[*first], 1.0, 0.0);
        let all: Vec<&Staged> = runs.iter().collect();
        known.ends_m = one_length(&all).map(|_| runs[*first].ends_m);
        let how = "the run that the others are shifted to".to_owned();
        places[*first] = Some(Placing::Shift { factor: 1.0, offset_m: 0.0, how });
    }
    // Those that cannot be placed at first may be when more of the line is known.
    for _ in 0..3 {
        for index in &order {
            if places[*index].is_some() {
                continue;
            }
            let run = &runs[*index];
            if let Some((factor, offset_m, how)) = ways.iter().find_map(|way| way(&known, run)) {
                known.add(run, factor, offset_m);
                places[*index] = Some(Placing::Shift { factor, offset_m, how });
            }
        }
        known.all_seen = true;
    }
    let zero_m = zero_m(runs, &places, stops_m);
    let (others, else_by) = match known.of_track {
        true => ("the track", "without --track runs are placed beside each other"),
        false => ("the other runs", "--track K.toml places runs by the stops of a track"),
    };
    let out = || {
        Placing::Out(format!(
            "neither its stops nor its speeds over the location agree with those of {others} at one place only; \
             --chainage as-is keeps the locations as they are, {else_by}"
        ))
    };
    let placed = places.into_iter().map(|place| place.unwrap_or_else(out));
    placed
        .map(|place| match place {
            Placing::Shift { factor, offset_m, how } => Placing::Shift { factor, offset_m: offset_m - zero_m, how },
            other => other,
        })
        .collect()
}

/// What all locations count from.
fn zero_m(runs: &[Staged], places: &[Option<Placing>], stops_m: &[f64]) -> f64 {
    let least = runs.iter().zip(places).filter_map(|(run, place)| match place {
        Some(Placing::Shift { factor, offset_m, .. }) => {
            Some(offset_m + (factor * run.ends_m.0).min(factor * run.ends_m.1))
        }
        _ => None,
    });
    let least_m = least.min_by(f64::total_cmp).unwrap_or(0.0);
    // The chainage of a track stays.
    match stops_m {
        [] if runs.iter().any(|run| odometer::is_far(run.ends_m)) => least_m,
        // A reading of a few metres below the first platform is noise.
        [] if least_m > -STOP_M => 0.0,
        [] => least_m,
        _ => 0.0,
    }
}
