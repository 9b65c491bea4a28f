//! How far a train may go between two rows whatever it does between them: it may stop and start again, or run on and
//! brake.
//!
//! ```text
//! shortest: v² - 2 b x down to u, up again        longest: v² + 2 b x up to w, down again
//! ```
//!
//! In: both speeds, the time between, the fastest speed. Where rows are missing the mean of both speeds says little,
//! and less than it is no sign of a fault.

use std::ops::RangeInclusive;

/// No train brakes or gathers speed faster all the way, m/s².
const MOST_MPS2: f64 = 1.4;

/// The shortest and the longest way, m, in so many seconds from one speed to another, at most at the fastest one.
pub(crate) fn reach_m([from_mps, to_mps]: [f64; 2], seconds: f64, fastest_mps: f64) -> RangeInclusive<f64> {
    let change_mps = MOST_MPS2 * seconds;
    let squares = from_mps.powi(2) + to_mps.powi(2);
    let mean_m = 0.5 * (from_mps + to_mps) * seconds;
    // Such a change of the speed in so short a time is a fault of a reading, of which the mean says as much as
    // anything.
    if change_mps <= (from_mps - to_mps).abs() {
        return mean_m..=mean_m;
    }
    let slowest_mps = (0.5 * (from_mps + to_mps - change_mps)).max(0.0);
    let shortest_m = (squares - 2.0 * slowest_mps.powi(2)) / (2.0 * MOST_MPS2);
    let fastest_mps = (0.5 * (from_mps + to_mps + change_mps)).min(fastest_mps.max(from_mps).max(to_mps));
    let at_fastest_s = seconds - (2.0 * fastest_mps - from_mps - to_mps) / MOST_MPS2;
    let longest_m = (2.0 * fastest_mps.powi(2) - squares) / (2.0 * MOST_MPS2) + fastest_mps * at_fastest_s;
    let at_slowest_s = seconds - (from_mps + to_mps - 2.0 * slowest_mps) / MOST_MPS2;
    shortest_m + slowest_mps * at_slowest_s.max(0.0)..=longest_m
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_train_may_stop_between_two_rows_where_there_is_the_way_to_do_so() {
        // 14² / 2.8 = 70 m to a stand, as much to 14 m/s again.
        assert!(reach_m([14.0; 2], 60.0, 20.0).contains(&141.0));
        assert!(!reach_m([14.0; 2], 60.0, 20.0).contains(&139.0));
        // In 10 s down to 7 m/s and up again: 14 * 10 - 1.4 * 5².
        assert!((reach_m([14.0; 2], 10.0, 20.0).start() - 105.0).abs() < 1e-9);
    }

    #[test]
    fn a_train_runs_no_faster_between_two_rows_than_it_does() {
        assert!((reach_m([14.0; 2], 10.0, 40.0).end() - 175.0).abs() < 1e-9);
        // 18.2 m/s after 3 s, for 54 s.
        assert!((reach_m([14.0; 2], 60.0, 18.2).end() - (2.0 * 3.0 * 16.1 + 54.0 * 18.2)).abs() < 1e-9);
    }
}
