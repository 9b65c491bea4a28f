//! Values that a recorder writes where it has no location: zeros, 65535, 9999999.
//!
//! ```text
//! location 412 500  412 527  0  0  0  412 635        far from both sides, which agree with each other
//! ```
//!
//! In: rows in order, before anything joins what an odometer tore apart. Out: the rows whose location means nothing. A
//! single wild reading whose value is there once only is none of them.

use crate::figure::Figure;
use crate::finding::{Done, Finding, Kind};
use crate::rows::times::MOST_MEAN_S;
use crate::rows::ways::{LONGEST_S, between};
use crate::rows::wild::MOST_WILD;
use rundown_files::sample::Sample;
use rundown_files::statistics::sorted;

/// Such a value is further than this, and than the train went meanwhile, from the last location, m.
const FAR_M: f64 = 1500.0;
/// The location goes on with the train but for so many metres, and this share of the way.
const GOES_ON_M: f64 = 100.0;
const GOES_ON: f64 = 0.1;
/// A log may end on them: a location would have moved with the train by so much, m.
const ENDED_M: f64 = 500.0;
/// A recorder has few of them: many are those of another train whose rows take turns with these.
const MOST_VALUES: usize = 3;
/// A recorder that is switched off may write so many zeros last.
const MOST_LAST_ZEROS: usize = 3;
/// A train whose speed is not read runs no faster, m/s.
const MOST_MPS: f64 = 100.0;

/// The rows whose location stands for none.
pub fn found(rows: &[Sample]) -> Vec<usize> {
    let located: Vec<(usize, f64)> =
        rows.iter().enumerate().filter_map(|(i, row)| Some((i, row.location_m?))).collect();
    let values = sorted(located.iter().map(|(_, at_m)| at_m));
    let (mut found, mut at) = (Vec::new(), 1);
    while at < located.len() {
        let long = long(rows, &located[at - 1..], &values);
        found.extend(located[at..at + long].iter().map(|(i, _)| *i));
        at += long + 1;
    }
    let mut stand_for_none = sorted(found.iter().filter_map(|i| rows[*i].location_m));
    stand_for_none.dedup();
    if stand_for_none.len() <= MOST_VALUES { found } else { Vec::new() }
}

/// How many locations behind the first of these stand for none.
fn long(rows: &[Sample], located: &[(usize, f64)], values: &[f64]) -> usize {
    let (from, from_m) = located[0];
    let (mut way, mut row) = (Gone::default(), from);
    for (count, (to, to_m)) in located[1..].iter().enumerate() {
        way.add(&rows[row..=*to]);
        row = *to;
        let gone_m = (to_m - from_m).abs();
        if way.agrees(gone_m) && located[1..=count].iter().all(|(_, at_m)| at_m != to_m) {
            return count;
        }
        let is_wild = gone_m > FAR_M + way.most_m();
        let is_last_zero = *to_m == 0.0 && count + 2 == located.len();
        if !is_wild || !(is_last_zero || is_repeated(values, *to_m)) || rows[*to].time_s - rows[from].time_s > LONGEST_S
        {
            return 0;
        }
    }
    // Nothing follows: one that began again goes on with the train, and several values are no sign of a lost signal.
    let mut behind = Gone::default();
    behind.add(&rows[located[1].0..=row]);
    let is_one = located[1..].iter().all(|(_, at_m)| *at_m == located[1].1);
    let count = located.len() - 1;
    let are_last_zeros = located[1].1 == 0.0 && count <= MOST_LAST_ZEROS;
    if is_one && (are_last_zeros || behind.by_speed_m > ENDED_M) { count } else { 0 }
}

/// How far a train went over some rows, m: by its speeds, and at most where none was read.
#[derive(Default)]
struct Gone {
    by_speed_m: f64,
    unread_m: f64,
}

impl Gone {
    fn add(&mut self, rows: &[Sample]) {
        for pair in rows.windows(2) {
            let long_s = (pair[1].time_s - pair[0].time_s).max(0.0);
            // Between rows far apart speeds say little.
            let is_read = long_s <= MOST_MEAN_S && pair.iter().any(|row| row.speed_mps.is_some());
            self.by_speed_m += between(&pair[0], &pair[1]);
            self.unread_m += if is_read { 0.0 } else { MOST_MPS * long_s };
        }
    }

    fn most_m(&self) -> f64 {
        self.by_speed_m + self.unread_m
    }

    fn agrees(&self, gone_m: f64) -> bool {
        let allowed_m = GOES_ON_M + GOES_ON * self.by_speed_m;
        (self.by_speed_m - allowed_m..=self.most_m() + allowed_m).contains(&gone_m)
    }
}

/// The value is there more than once.
fn is_repeated(sorted: &[f64], value: f64) -> bool {
    let first = sorted.partition_point(|other| *other < value);
    sorted.get(first + 1) == Some(&value)
}

/// Takes them as missing, but for those that are too few to be more than spikes.
pub(crate) fn leave_out(rows: &mut [Sample], findings: &mut Vec<Finding>) {
    let found = found(rows);
    let ends = rows.iter().rposition(|row| row.location_m.is_some());
    let is_between = |a: usize, b: usize| rows[a + 1..b].iter().any(|row| row.location_m.is_some());
    let blocks = found.chunk_by(|a, b| !is_between(*a, *b));
    let left_out: Vec<usize> =
        blocks.filter(|rows| rows.len() > MOST_WILD || rows.last() == ends.as_ref()).flatten().copied().collect();
    let Some(first) = left_out.first() else { return };
    let (kind, figure) = (Kind::NoLocation, Figure { value: left_out.len() as f64, sd: 0.0 });
    let (count, line) = (1, rows[*first].line);
    findings.push(Finding { kind, figure, unit: "rows", count, line, done: Done::LeftOut });
    left_out.into_iter().for_each(|i| rows[i].location_m = None);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 20 m/s, a row each second.
    fn rows(location_m: impl Fn(usize, f64) -> f64) -> Vec<Sample> {
        let row = |i: usize| {
            let location_m = Some(location_m(i, 412_500.0 + 20.0 * i as f64));
            Sample { time_s: i as f64, location_m, speed_mps: Some(20.0), ..Sample::default() }
        };
        (0..300).map(row).collect()
    }

    #[test]
    fn a_value_between_locations_that_go_on_stands_for_none() {
        let lost = |i: usize, at_m: f64| if (200..205).contains(&i) { 0.0 } else { at_m };
        assert_eq!(found(&rows(lost)), [200, 201, 202, 203, 204]);
        // Without a speed, too.
        let unread: Vec<Sample> = rows(lost).iter().map(|row| Sample { speed_mps: None, ..*row }).collect();
        assert_eq!(found(&unread), [200, 201, 202, 203, 204]);
        let single = |i: usize, at_m: f64| if [200, 202].contains(&i) { 65_535.0 } else { at_m };
        assert_eq!(found(&rows(single)), [200, 202]);
        let mixed = |i: usize, at_m: f64| [at_m, 0.0, 65_535.0][if (100..108).contains(&i) { 1 + i % 2 } else { 0 }];
        assert_eq!(found(&rows(mixed)), (100..108).collect::<Vec<_>>());
        assert_eq!(found(&rows(|i, at_m| if i < 200 { at_m } else { 0.0 })), (200..300).collect::<Vec<_>>());
    }

    #[test]
    fn locations_in_some_rows_only_are_one_block_and_rows_far_apart_none() {
        let mut sparse = rows(|i, at_m| if (150..250).contains(&i) { 0.0 } else { at_m });
        sparse.iter_mut().enumerate().filter(|(i, _)| i % 5 != 0).for_each(|(_, row)| row.location_m = None);
        let mut findings = Vec::new();
        leave_out(&mut sparse, &mut findings);
        assert_eq!(findings.iter().map(|finding| finding.kind).collect::<Vec<_>>(), [Kind::NoLocation]);
        // Every four minutes, between two stations.
        let shuttles = |i: usize| {
            let location_m = Some([0.0, 4300.0, 8600.0, 4300.0][i % 4]);
            let speed_mps = Some(if i.is_multiple_of(2) { 0.0 } else { 3.0 });
            Sample { time_s: 240.0 * i as f64, location_m, speed_mps, ..Sample::default() }
        };
        assert_eq!(found(&(0..80).map(shuttles).collect::<Vec<_>>()), Vec::<usize>::new());
    }

    #[test]
    fn a_last_zero_stands_for_none_and_one_that_stays_for_an_odometer_that_begins_again() {
        assert_eq!(found(&rows(|i, at_m| if i == 299 { 0.0 } else { at_m })), [299]);
        let mut stands = rows(|i, at_m| if i < 200 { at_m } else { 0.0 });
        stands[199..].iter_mut().for_each(|row| row.speed_mps = Some(0.0));
        assert_eq!(found(&stands), Vec::<usize>::new());
        assert_eq!(found(&stands[..203]), [200, 201, 202]);
    }

    #[test]
    fn an_odometer_that_begins_again_and_a_single_wild_reading_stand_for_something() {
        let none: [usize; 0] = [];
        assert_eq!(found(&rows(|i, at_m| if i < 200 { at_m } else { 20.0 * (i - 200) as f64 })), none);
        assert_eq!(found(&rows(|i, at_m| if i == 200 { 0.0 } else { at_m })), none);
        // Another train, whose rows take turns with these.
        let other = |i: usize, at_m: f64| if i.is_multiple_of(2) { at_m } else { (10_000.0 - at_m / 100.0).floor() };
        assert_eq!(found(&rows(other)), none);
        // It turns over, in steps of 100 m.
        assert_eq!(found(&rows(|_, at_m| (at_m / 100.0).floor() * 100.0 % 10_000.0)), none);
    }
}
