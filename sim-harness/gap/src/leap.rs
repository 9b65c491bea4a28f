//! Do the locations of all runs leap at one place, beyond what their speeds cover?
//!
//! In: the runs as they are read. Out: where, by how much, and in how many runs. A chainage that leaps, or a line that
//! was measured again up to one place, puts all that lies behind it elsewhere: gradients, lengths and wheels would be
//! named for it.
//!
//! ```text
//! leap = x1 - x0 -+ (v0 + v1)/2 (t1 - t0)        the largest between two readings of a run
//! ```

use crate::config::GapConfig;
use crate::data::runs::{Run, usual_step_s};
use rundown_files::sample::Sample;
use rundown_files::statistics::median;

/// A leap of the locations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leap {
    /// Where it begins, m.
    pub at_m: f64,
    /// How far further along the line the locations go than the trains, m.
    pub by_m: f64,
    /// Runs that have it.
    pub runs: usize,
}

/// Locations this long before and after a leap must show it, too, s: a receiver that loses a train in a tunnel finds it
/// again.
const LASTS_S: core::ops::Range<f64> = 90.0..150.0;

/// Time, location, and location less the distance by speed, along the direction of travel, of the readings that have
/// both.
fn shifts(run: &Run) -> Vec<(f64, f64, f64)> {
    let sign = run.direction.sign();
    let (mut distance_m, mut last): (f64, Option<(f64, f64)>) = (0.0, None);
    let of_sample = |sample: &Sample| {
        let (speed, at_m) = (sample.speed_mps?, sample.location_m?);
        if let Some((before_s, slower)) = last.replace((sample.time_s, speed)) {
            distance_m += 0.5 * (speed + slower) * (sample.time_s - before_s);
        }
        Some((sample.time_s, at_m, sign * at_m - distance_m))
    };
    run.samples.iter().filter_map(of_sample).collect()
}

/// The largest of a run that lasts: where, and by how much along the line.
fn largest(run: &Run, config: &GapConfig) -> Option<(f64, f64)> {
    let longest_s = config.interval.gap * usual_step_s(run);
    let shifts = shifts(run);
    let near = shifts.windows(2).filter(|pair| pair[1].0 - pair[0].0 <= longest_s);
    let size = |pair: &[(f64, f64, f64)]| (pair[1].2 - pair[0].2).abs();
    let pair = near.max_by(|a, b| size(a).total_cmp(&size(b)))?;
    let [(from_s, from_m, from), (to_s, to_m, to)] = [pair[0], pair[1]];
    let within = |lasts: &dyn Fn(f64) -> bool| median(shifts.iter().filter(|at| lasts(at.0)).map(|at| at.2));
    let lasting = within(&|t| LASTS_S.contains(&(t - to_s)))? - within(&|t| LASTS_S.contains(&(from_s - t)))?;
    let lasts = (lasting / (to - from) - 1.0).abs() < config.track.leap_apart;
    // Down the line it is met from the other side.
    lasts.then_some((from_m.min(to_m), to - from))
}

/// The leap that nearly all runs have at one place.
pub fn leap(runs: &[Run], config: &GapConfig) -> Option<Leap> {
    let track = &config.track;
    let each: Vec<(f64, f64)> = runs.iter().filter_map(|run| largest(run, config)).collect();
    let at_m = median(each.iter().map(|(at_m, _)| *at_m))?;
    let by_m = median(each.iter().map(|(_, by_m)| *by_m))?;
    let near_m = config.traction.beyond_m + by_m.abs();
    let same = |(at, by): &&(f64, f64)| (at - at_m).abs() < near_m && (by / by_m - 1.0).abs() < track.leap_apart;
    let count = each.iter().filter(same).count();
    let nearly_all = count as f64 >= track.leap_share * runs.len() as f64;
    (by_m.abs() > track.most_leap_m && nearly_all).then_some(Leap { at_m, by_m, runs: count })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::runs::Recorded;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, Normal};
    use rundown::model::direction::Direction;

    /// What is found of 20 runs over 30 km, read every 10 s with a noise of 8 m, of which some leap by so much at km
    /// 12.
    fn found(by_m: f64, leaps: fn(usize) -> bool) -> Option<Leap> {
        found_until(by_m, leaps, f64::INFINITY)
    }

    /// The same where the locations are right again from a place on.
    fn found_until(by_m: f64, leaps: fn(usize) -> bool, until_m: f64) -> Option<Leap> {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let noise_m = Normal::new(0.0, 8.0).unwrap();
        let mut run = |index: usize| {
            let direction = [Direction::Up, Direction::Down][index % 2];
            let sample = |i: u32| {
                let along_m = 300.0 * f64::from(i);
                let at_m = if direction == Direction::Up { along_m } else { 30_000.0 - along_m };
                let leap_m = if (12_000.0..until_m).contains(&at_m) && leaps(index) { by_m } else { 0.0 };
                Sample {
                    time_s: 10.0 * f64::from(i),
                    location_m: Some(at_m + leap_m + noise_m.sample(&mut rng)),
                    speed_mps: Some(30.0),
                    ..Sample::default()
                }
            };
            let samples = (0..=100).map(sample).collect();
            Run { name: index.to_string(), direction, day: None, samples, recorded: Recorded::default() }
        };
        let runs: Vec<Run> = (0..20).map(&mut run).collect();
        leap(&runs, &GapConfig::default())
    }

    #[test]
    fn locations_that_leap_in_all_runs_are_seen_with_place_and_size() {
        for by_m in [300.0, -250.0, 120.0] {
            let leap = found(by_m, |_| true).unwrap();
            assert!((leap.by_m - by_m).abs() < 10.0 && leap.runs == 20, "{leap:?}");
            assert!((leap.at_m - 12_000.0).abs() < 350.0 + by_m.abs(), "{leap:?}");
        }
    }

    #[test]
    fn noise_and_a_leap_of_a_few_runs_are_none() {
        assert_eq!(found(0.0, |_| true), None);
        assert_eq!(found(300.0, |run| run < 8), None);
        // Lost in a tunnel of 1 km, and found again behind it.
        assert_eq!(found_until(-300.0, |_| true, 13_000.0), None);
    }
}
