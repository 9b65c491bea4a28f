//! Runs whose locations count from another place than those of the others.
//!
//! In: runs whose readings are put right, and the described stops. Out: for each run by how much its chainage is off,
//! and what says so.
//!
//! ```text
//! runs of a direction -> groups that stop at the same places (stops) -> the group that is on the chainage of the track
//!                     -> each other group: the shift that brings its stops onto those, and its speeds (speeds)
//! ```
//!
//! Stops alone may agree by chance on a line with regular ones, and speeds alone on a line without restrictions: both
//! must agree, the speeds in both halves of the run. Nothing is said of runs with fewer than two stops, nor where a
//! shift is more than half of the run, nor of one that begins and ends where the others do, nor where no three runs in
//! ten stop at the same places and none where the track has stops.

mod speeds;
mod stops;

use crate::figure::Figure;
use crate::rows::profile::{Medians, Profile};
use rundown::model::direction::Direction;
use rundown_files::recording::Recording;
use stops::{Group, Match, groups, shift, turned};

/// A reference must be so many times as large as the group that is said to be off ...
const OUTNUMBERS: usize = 2;
/// ... and have so many runs, unless the described stops decide.
const LEAST_REFERENCE: usize = 3;
/// Nor is it a reference with a smaller share of the runs: where each stops elsewhere, some stops of two lie together
/// by chance for one of many shifts.
const REFERENCE_SHARE: f64 = 0.34;
/// Share of the stops that lie where the track describes them, of those who are on its chainage and those who are not.
const AT_DESCRIBED: [f64; 2] = [0.8, 0.5];
/// With fewer described stops these decide nothing.
const LEAST_DESCRIBED: usize = 3;

/// By how much a run is off.
#[derive(Clone, Debug, PartialEq)]
pub struct Off {
    /// Its location less that of the others, m; where it counts from the other end, the sum of both.
    pub figure: Figure,
    /// It counts from the other end of the line.
    pub is_turned: bool,
    /// Which of the two is on the chainage of the track is known.
    pub is_decided: bool,
    /// What says so.
    pub evidence: String,
}

/// Compares runs with one another and with the described stops, as the track has them. `is_usable`: by run. Out: for
/// each run what is off.
pub fn find(recordings: &[Recording], is_usable: &[bool], stops_m: &[f64]) -> Vec<Option<Off>> {
    let mut found = vec![None; recordings.len()];
    for direction in [Direction::Up, Direction::Down] {
        let sign = direction.sign();
        let of_direction = (0..recordings.len()).filter(|i| is_usable[*i] && recordings[*i].direction == direction);
        let (indices, profiles): (Vec<usize>, Vec<Profile>) =
            of_direction.filter_map(|i| Some((i, Profile::of(&recordings[i].rows, sign)?))).unzip();
        let described_m: Vec<f64> = stops_m.iter().map(|at_m| sign * at_m).collect();
        for (group, off) in compare(&profiles, &described_m, sign) {
            group.runs.iter().for_each(|run| found[indices[*run]] = Some(off.clone()));
        }
    }
    found
}

/// The groups of one direction that are off.
fn compare(profiles: &[Profile], described_m: &[f64], sign: f64) -> Vec<(Group, Off)> {
    let mut groups = groups(profiles);
    let all = groups.iter().map(|group| group.runs.len()).sum::<usize>() as f64;
    let at_described = |group: &Group| group.share_at(described_m);
    let is_described = described_m.len() >= LEAST_DESCRIBED;
    let rank = |group: &Group| {
        let is_there = is_described && at_described(group) >= AT_DESCRIBED[0];
        (is_there, group.runs.len(), std::cmp::Reverse(group.runs[0]))
    };
    groups.sort_by_key(|group| std::cmp::Reverse(rank(group)));
    let mut groups = groups.into_iter();
    let Some(reference) = groups.next() else {
        return Vec::new();
    };
    let is_on_track = is_described && at_described(&reference) >= AT_DESCRIBED[0];
    if !is_on_track && (reference.runs.len() as f64) < REFERENCE_SHARE * all {
        return Vec::new();
    }
    let mut off = Vec::new();
    for group in groups {
        let Some(matched) = explained(profiles, &reference, &group) else { continue };
        let outnumbered =
            reference.runs.len() >= LEAST_REFERENCE && reference.runs.len() >= OUTNUMBERS * group.runs.len();
        let is_decided = if is_on_track { at_described(&group) <= AT_DESCRIBED[1] } else { outnumbered };
        let evidence = evidence(&matched, &reference, is_on_track, is_decided);
        let figure = figure(&matched, sign);
        off.push((group, Off { figure, is_turned: matched.is_turned, is_decided, evidence }));
    }
    if is_described && !is_on_track {
        off.extend(beside_described(reference, described_m, sign));
    }
    off
}

/// The group is on the chainage of the reference once it is moved or turned.
fn explained(profiles: &[Profile], reference: &Group, group: &Group) -> Option<Match> {
    if !group.overlaps(reference) {
        return None;
    }
    let [there, here] = [reference, group].map(|group| {
        let profiles = group.runs.iter().map(|run| &profiles[*run]);
        Medians::of(profiles.map(|profile| (profile.first_cell, profile.speeds_mps.as_slice())))
    });
    let moved = shift(reference, group).into_iter().filter(|moved| speeds::agree(&there, &here, moved.by_m));
    moved.max_by_key(|moved| moved.count).or_else(|| turned(reference, group))
}

/// Stops of all runs that lie together elsewhere than the described ones.
fn beside_described(group: Group, described_m: &[f64], sign: f64) -> Option<(Group, Off)> {
    let described = Group::described(described_m, group.near_m());
    let moved = shift(&described, &group).into_iter().max_by_key(|moved| moved.count)?;
    (moved.count >= LEAST_DESCRIBED && group.share_at(described_m) <= AT_DESCRIBED[1]).then(|| {
        let Match { count, of, .. } = moved;
        let evidence = format!("{count} of {of} stops lie at described ones once they are moved");
        (group, Off { figure: figure(&moved, sign), is_turned: false, is_decided: false, evidence })
    })
}

/// From the distance along the direction of travel to the locations of the track.
fn figure(matched: &Match, sign: f64) -> Figure {
    let along = if matched.is_turned { 1.0 } else { -1.0 };
    Figure { value: along * sign * matched.by_m, sd: matched.sd_m }
}

fn evidence(matched: &Match, reference: &Group, is_on_track: bool, is_decided: bool) -> String {
    let Match { count, of, is_turned, .. } = matched;
    let others = reference.runs.len();
    let how = if *is_turned { "counted from the other end" } else { "moved, and its speeds agree in both halves" };
    let who = match (is_on_track, is_decided) {
        (true, _) => ", and these stop where the track describes it",
        (false, true) => "",
        (false, false) => "; which of them are on the chainage of the track is not known",
    };
    format!("{count} of its {of} stops lie at those of {others} other runs once it is {how}{who}")
}
