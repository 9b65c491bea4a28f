//! Groups of runs that stop at the same places, and the shift that brings one group onto another.

use crate::perturbed::near_m;
use crate::rows::profile::Profile;
use rundown_files::statistics::{extremes, mean, mean_of, median_of, sorted, squares_about};

/// Trains stop no farther from one place, m: platforms are long, and a train is as long as they are.
const MOST_NEAR_M: f64 = 150.0;
/// Runs that agree on such a share of the stops belong together.
const SAME_SHARE: f64 = 0.6;
/// Shifts that are looked at, m. A longer train stops further ahead: a smaller shift may be its length.
const SHIFTS_M: [f64; 2] = [200.0, 10_000.0];
/// Of the stops of both so many must agree when moved, and fewer than half as many when not.
const MOVED_SHARE: f64 = 0.66;
const LEAST_MOVED: usize = 2;
/// Both ends of a line are its ends from either side: so many stops must agree when counted from the other end, and
/// such a share.
const LEAST_TURNED: usize = 4;
const TURNED_SHARE: f64 = 0.8;
/// Stops are nowhere known better, m; and those of trains that come from the other side differ by as much.
const LEAST_SD_M: f64 = 10.0;

/// Runs that stop at the same places.
#[derive(Clone, Debug)]
pub struct Group {
    /// Their numbers.
    pub runs: Vec<usize>,
    /// Where they stop, m: for each place all of them.
    places_m: Vec<Vec<f64>>,
    /// From the first to the last location, m.
    ends_m: [f64; 2],
    /// How far apart two trains may stop at one place, m.
    near_m: f64,
}

/// A shift, or a turn, and what says so.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Match {
    /// What is added to the location, along the direction of travel, m; turned: the sum of both locations.
    pub by_m: f64,
    /// Its standard deviation, m.
    pub sd_m: f64,
    /// Stops that agree.
    pub count: usize,
    /// Stops of the group.
    pub of: usize,
    /// The location counts from the other end.
    pub is_turned: bool,
}

/// Runs by where they stop. A run that stops less than twice is in no group.
pub fn groups(profiles: &[Profile]) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    let near_m = near_m(profiles).min(MOST_NEAR_M);
    for (run, profile) in profiles.iter().enumerate() {
        let calls_m = profile.calls_m();
        if calls_m.len() < LEAST_MOVED {
            continue;
        }
        let one = Group {
            runs: vec![run],
            places_m: calls_m.iter().map(|at_m| vec![*at_m]).collect(),
            ends_m: profile.ends_m,
            near_m,
        };
        match groups.iter_mut().find(|group| group.share_with(&one) >= SAME_SHARE) {
            Some(group) => group.take(run, &calls_m, profile.ends_m),
            None => groups.push(one),
        }
    }
    groups
}

impl Group {
    /// Stops as a track describes them.
    pub fn described(stops_m: &[f64], near_m: f64) -> Self {
        let ends_m = extremes(stops_m).into();
        Self { runs: Vec::new(), places_m: stops_m.iter().map(|at_m| vec![*at_m]).collect(), ends_m, near_m }
    }

    /// How far apart two trains may stop at one place, m.
    pub fn near_m(&self) -> f64 {
        self.near_m
    }

    fn take(&mut self, run: usize, calls_m: &[f64], [from_m, to_m]: [f64; 2]) {
        self.runs.push(run);
        self.ends_m = [self.ends_m[0].min(from_m), self.ends_m[1].max(to_m)];
        for at_m in calls_m {
            match self.places_m.iter_mut().find(|place| (median_of(place.iter()) - at_m).abs() <= self.near_m) {
                Some(place) => place.push(*at_m),
                None => self.places_m.push(vec![*at_m]),
            }
        }
    }

    /// Where at least half of them stop, m, from the first to the last.
    fn stations_m(&self) -> Vec<f64> {
        let usual = |place: &&Vec<f64>| 2 * place.len() >= self.runs.len();
        sorted(self.places_m.iter().filter(usual).map(median_of))
    }

    /// Share of the stops of one that the other makes, too, where both pass: of that one of the two that stops less.
    fn share_with(&self, other: &Self) -> f64 {
        if !other.overlaps(self) {
            return 0.0;
        }
        let share = |own: &Self, others: &Self| {
            let passed =
                |at_m: &&f64| (others.ends_m[0] - self.near_m..=others.ends_m[1] + self.near_m).contains(*at_m);
            let stations_m = own.stations_m();
            let all = stations_m.iter().filter(passed).count();
            let places_m: Vec<f64> = others.places_m.iter().map(median_of).collect();
            let same = stations_m.iter().filter(passed).filter(|at_m| is_near(&places_m, **at_m, self.near_m)).count();
            same as f64 / all.max(1) as f64
        };
        share(self, other).max(share(other, self))
    }

    /// Share of its stops at these places.
    pub fn share_at(&self, places_m: &[f64]) -> f64 {
        let stations_m = self.stations_m();
        let there = stations_m.iter().filter(|at_m| is_near(places_m, **at_m, self.near_m)).count();
        there as f64 / stations_m.len().max(1) as f64
    }

    /// At least half of its way is that of the other one.
    pub fn overlaps(&self, other: &Self) -> bool {
        let [from_m, to_m] = self.ends_m;
        let shared_m = to_m.min(other.ends_m[1]) - from_m.max(other.ends_m[0]);
        shared_m >= 0.5 * (to_m - from_m).min(other.ends_m[1] - other.ends_m[0])
    }

    /// Scatter of one stop around its place, standard deviation, m.
    fn scatter_m(&self) -> f64 {
        let (mut squares, mut free) = (0.0, 0_usize);
        for place in self.places_m.iter().filter(|place| place.len() > 1) {
            squares += squares_about(mean_of(place), place);
            free += place.len() - 1;
        }
        (squares / free.max(1) as f64).sqrt()
    }
}

fn is_near(places_m: &[f64], at_m: f64, near_m: f64) -> bool {
    places_m.iter().any(|place_m| (place_m - at_m).abs() <= near_m)
}

/// The first and the last stop of one group are those of the other: moved, it would be as long, and yet from other
/// places.
fn has_ends_of(there_m: &[f64], here_m: &[f64], near_m: f64) -> bool {
    let is_same = |end: fn(&[f64]) -> Option<&f64>| {
        end(there_m).zip(end(here_m)).is_some_and(|(there, here)| (there - here).abs() <= near_m)
    };
    is_same(<[f64]>::first) && is_same(<[f64]>::last)
}

/// Shifts that bring the stops of a group onto those of the reference.
pub fn shift(reference: &Group, group: &Group) -> Vec<Match> {
    let (there_m, here_m) = (reference.stations_m(), group.stations_m());
    if has_ends_of(&there_m, &here_m, group.near_m) {
        return Vec::new();
    }
    let unmoved = here_m.iter().filter(|at_m| is_near(&there_m, **at_m, group.near_m)).count();
    let candidates = here_m.iter().flat_map(|here| there_m.iter().map(move |there| there - here));
    let tried = candidates.filter(|by_m| (SHIFTS_M[0]..=SHIFTS_M[1]).contains(&by_m.abs()));
    let matched = tried.filter_map(|by_m| {
        let matched = matched(&there_m, &here_m, group.near_m, |at_m| at_m + by_m, |there, here| there - here)?;
        let [from_m, to_m] = group.ends_m.map(|m| m + matched.mean_m);
        let passed =
            there_m.iter().filter(|at_m| (from_m - group.near_m..=to_m + group.near_m).contains(*at_m)).count();
        let both = here_m.len().max(passed) as f64;
        let is_all = matched.count >= LEAST_MOVED && matched.count as f64 >= MOVED_SHARE * both;
        let is_far = matched.mean_m.abs() >= SHIFTS_M[0];
        (is_all && is_far && 2 * unmoved <= matched.count).then(|| matched.of(reference, group, here_m.len(), false))
    });
    matched.collect()
}

/// The group counts from the other end of the line.
pub fn turned(reference: &Group, group: &Group) -> Option<Match> {
    let (there_m, here_m) = (reference.stations_m(), group.stations_m());
    let unmoved = here_m.iter().filter(|at_m| is_near(&there_m, **at_m, group.near_m)).count();
    let candidates = here_m.iter().flat_map(|here| there_m.iter().map(move |there| there + here));
    let tried = candidates.filter_map(|sum_m| {
        let matched = matched(&there_m, &here_m, group.near_m, |at_m| sum_m - at_m, |there, here| there + here)?;
        let both = here_m.len().max(there_m.len()) as f64;
        let is_all = matched.count >= LEAST_TURNED && matched.count as f64 >= TURNED_SHARE * both;
        (is_all && unmoved + 2 <= matched.count).then(|| matched.of(reference, group, here_m.len(), true))
    });
    tried.max_by_key(|matched| matched.count)
}

struct Matched {
    mean_m: f64,
    sd_m: f64,
    count: usize,
}

/// Stops that agree once they are placed: mean and standard deviation of what `between` says of each.
fn matched(
    there_m: &[f64],
    here_m: &[f64],
    near_m: f64,
    placed: impl Fn(f64) -> f64,
    between: impl Fn(f64, f64) -> f64,
) -> Option<Matched> {
    let nearest = |here: &f64| {
        let at_m = placed(*here);
        let near = there_m.iter().filter(|there| (*there - at_m).abs() <= near_m);
        near.min_by(|a, b| (*a - at_m).abs().total_cmp(&(*b - at_m).abs())).map(|there| between(*there, *here))
    };
    let each: Vec<f64> = here_m.iter().filter_map(nearest).collect();
    let n = each.len() as f64;
    let mean_m = mean(&each)?;
    Some(Matched { mean_m, sd_m: (squares_about(mean_m, &each) / (n - 1.0).max(1.0)).sqrt(), count: each.len() })
}

impl Matched {
    fn of(&self, reference: &Group, group: &Group, of: usize, is_turned: bool) -> Match {
        let share = |group: &Group| 1.0 / group.runs.len().max(1) as f64;
        let scatter_m = reference.scatter_m() * (share(reference) + share(group)).sqrt();
        let of_mean_m = self.sd_m.max(scatter_m).max(LEAST_SD_M) / (self.count as f64).sqrt();
        let sd_m = of_mean_m.hypot(if is_turned { LEAST_SD_M } else { 0.0 });
        Match { by_m: self.mean_m, sd_m, count: self.count, of, is_turned }
    }
}
