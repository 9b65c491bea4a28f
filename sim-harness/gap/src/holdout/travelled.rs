//! Does the distance by speed agree with the locations? The gap that a wrong scale or a late location makes.
//!
//! In windows of 120 s, σ the sign of the direction, v the speeds as they were read (before) and put right (after):
//!
//! ```text
//! error = (∫ v dt - lag Δv - σ Δs) / window        m/s; scale, offset and lag put right only after
//! ```

use crate::config::HoldoutConfig;
use crate::data::runs::{Run, usual_step_s};
use crate::holdout::forward::Compared;
use rundown_check::Correction;

/// A sample that has both.
#[derive(Clone, Copy)]
struct Read {
    time_s: f64,
    location_m: f64,
    speed_mps: f64,
}

/// The windows of a run, `index` its number. Floor: what the scatter of pieces of about 10 s leaves of the difference
/// of two locations.
pub fn travelled(index: usize, run: &Run, config: &HoldoutConfig) -> Vec<Compared> {
    let sign = run.direction.sign();
    let longest_s = 3.0 * usual_step_s(run).max(5.0);
    let read: Vec<Read> = run
        .samples
        .iter()
        .filter_map(|s| Some(Read { time_s: s.time_s, location_m: s.location_m?, speed_mps: s.speed_mps? }))
        .collect();
    let recorded = &run.recorded;
    // Errors of the distance between two samples, before and after, m.
    let errors = |from: usize, to: usize| {
        let distance = |correction: Correction, lag_s: f64| {
            let speed = |read: &Read| correction.read_mps(read.speed_mps);
            let by_speed: f64 = read[from..=to]
                .windows(2)
                .map(|p| 0.5 * (p[1].time_s - p[0].time_s) * (speed(&p[0]) + speed(&p[1])))
                .sum();
            by_speed - lag_s * (speed(&read[to]) - speed(&read[from]))
        };
        let by_location = sign * (read[to].location_m - read[from].location_m);
        (
            distance(recorded.correction, 0.0) - by_location,
            distance(Correction::NONE, recorded.location_lag_s) - by_location,
        )
    };
    let cut = |length_s: f64| {
        let mut pieces = Vec::new();
        let mut from = 0;
        for to in 1..read.len() {
            if read[to].time_s - read[to - 1].time_s > longest_s {
                from = to;
            } else if read[to].time_s - read[from].time_s >= length_s {
                pieces.push((from, to));
                from = to;
            }
        }
        pieces
    };
    let pieces = cut(config.piece_s);
    let scatter = pieces.iter().map(|&(from, to)| errors(from, to).1.powi(2));
    let variance_m2 = scatter.sum::<f64>() / pieces.len().max(1) as f64;
    cut(config.window_s)
        .into_iter()
        .map(|(from, to)| {
            let lasts_s = read[to].time_s - read[from].time_s;
            let (before_m, after_m) = errors(from, to);
            Compared {
                run: index,
                time_s: read[to].time_s,
                since_s: 0.0,
                location_m: read[to].location_m,
                measured_mps: sign * (read[to].location_m - read[from].location_m) / lasts_s,
                before_mps: before_m / lasts_s,
                after_mps: after_m / lasts_s,
                floor: variance_m2 / (lasts_s * lasts_s),
                variance: variance_m2 / (lasts_s * lasts_s),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::runs::Recorded;
    use rundown::model::direction::Direction;
    use rundown_files::sample::Sample;

    /// 20 m/s down the line by location, read by this recorder and put right.
    fn run(correction: Correction) -> Run {
        let sample = |k: u32| Sample {
            time_s: 10.0 * f64::from(k),
            location_m: Some(10_000.0 - 200.0 * f64::from(k)),
            speed_mps: Some(20.0),
            ..Sample::default()
        };
        let samples = (0..25).map(sample).collect();
        let recorded = Recorded { correction, ..Recorded::default() };
        Run { name: "run".to_owned(), direction: Direction::Down, day: None, samples, recorded }
    }

    #[test]
    fn a_wheel_that_reads_high_is_a_gap_until_it_is_known() {
        let wheel = Correction { scale: 1.02, ..Correction::NONE };
        let found = travelled(0, &run(wheel), &HoldoutConfig::default());
        assert_eq!(found.len(), 2);
        for window in found {
            assert!((window.before_mps - 0.4).abs() < 1e-9);
            assert!(window.after_mps.abs() < 1e-9);
            assert!((window.measured_mps - 20.0).abs() < 1e-9);
        }
    }
}
