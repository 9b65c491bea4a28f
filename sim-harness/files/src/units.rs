//! Do the columns of a log hold the units that their names say?
//!
//! Distance by location over distance by speed is 1 where all is well, within the few percent of a worn wheel. A speed in m/s makes it 3.6, a time in milliseconds or a location in kilometres a
//! thousandth. An effort that is a force has values that no train has. Medians, so that no single wild reading decides.

use crate::sample::Sample;
use thiserror::Error;

/// A column that seems to hold another unit.
#[derive(Clone, Debug, Error, PartialEq)]
#[expect(missing_docs, reason = "said by the messages")]
pub enum Doubt {
    #[error("expected 1 as ratio of the distance by location_m to that by speed_kmh and time_s, found {ratio:.3}: {}", likely(*ratio))]
    Distance { ratio: f64 },
    #[error(
        "expected most of effort_n_per_kg below {MOST_EFFORT} N/kg, found half of it at {median:.0} or more: a force has to be divided by the rotating mass (1 kN = 1000 N)"
    )]
    Effort { median: f64 },
}

/// No train powers or brakes harder for half of its time, N/kg.
const MOST_EFFORT: f64 = 3.0;
/// Distances further apart than by this factor are no matter of a wheel.
const FAR: f64 = 1.25;
/// Fewer pairs or efforts decide nothing.
const FEW: usize = 20;
/// A slower reading is mostly rounding, m/s.
const SLOW_MPS: f64 = 2.0;
/// Over less, steps and noise of the location weigh, m.
const PIECE_M: f64 = 200.0;
/// A location that is the same over more stands still, m.
const STUCK_M: f64 = 3000.0;

fn likely(ratio: f64) -> &'static str {
    match ratio {
        0.0005..0.002 => "a time in milliseconds, or a location in kilometres?",
        1.5..1.72 => "a speed in miles per hour?",
        3.2..4.0 => "a speed in m/s?",
        _ => "look at the units, and whether the log belongs to this track",
    }
}

/// What is doubtful about the units of a run.
pub fn doubt(rows: &[Sample]) -> Option<Doubt> {
    let efforts = rows.iter().filter_map(|r| r.effort_n_per_kg);
    let efforts = efforts.map(f64::abs).filter(|effort| *effort > 0.0);
    if let Some(median) = middle(efforts).filter(|median| *median > MOST_EFFORT) {
        return Some(Doubt::Effort { median });
    }
    far_ratio(rows).map(|ratio| Doubt::Distance { ratio })
}

/// Distance by location over distance by speed, where it is too far from 1 to be a matter of a wheel; their median over
/// pieces of the run.
pub fn far_ratio(rows: &[Sample]) -> Option<f64> {
    let read = rows.iter().filter_map(|row| Some((row.time_s, row.location_m?, row.speed_mps?)));
    let read: Vec<(f64, f64, f64)> = read.collect();
    let pairs = read.windows(2).map(|pair| {
        let (from, to) = (pair[0], pair[1]);
        let by_speed_m = 0.5 * (from.2 + to.2) * (to.0 - from.0);
        let is_moving = from.2.min(to.2) > SLOW_MPS && by_speed_m > 0.0;
        is_moving.then_some([to.1 - from.1, by_speed_m])
    });
    let pairs: Vec<Option<[f64; 2]>> = pairs.collect();
    let all_m: f64 = pairs.iter().flatten().map(|[_, by_speed_m]| by_speed_m).sum();
    let ratios = ratios(&pairs, PIECE_M.min(all_m / (2 * FEW) as f64));
    middle(ratios.into_iter()).filter(|ratio| !(1.0 / FAR..FAR).contains(ratio))
}

/// Distance by location over that by speed, piece by piece; a location that stands still is no matter of units.
fn ratios(pairs: &[Option<[f64; 2]>], piece_m: f64) -> Vec<f64> {
    let mut ratios = Vec::new();
    let mut piece = [0.0; 2];
    for pair in pairs {
        let Some([by_location_m, by_speed_m]) = pair else {
            piece = [0.0; 2];
            continue;
        };
        piece = [piece[0] + by_location_m, piece[1] + by_speed_m];
        if piece[1] >= piece_m && piece[0] != 0.0 {
            ratios.push(piece[0].abs() / piece[1]);
            piece = [0.0; 2];
        } else if piece[1] > STUCK_M {
            piece = [0.0; 2];
        }
    }
    ratios
}

fn middle(values: impl Iterator<Item = f64>) -> Option<f64> {
    let values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    (values.len() >= FEW).then(|| median(&values))
}

/// Middle value, the upper one of two; of a list that is not empty.
pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A run at 20 to 30 m/s, its readings in other units by these factors.
    fn rows(time: f64, location: f64, speed: f64, effort: f64) -> Vec<Sample> {
        let row = |i: u32| {
            let t = 10.0 * f64::from(i);
            Sample {
                line: 2 + u64::from(i),
                time_s: time * t,
                location_m: Some(location * (25.0 * t + 250.0 * (t / 50.0).sin())),
                speed_mps: Some(speed * (25.0 + 5.0 * (t / 50.0).cos())),
                effort_n_per_kg: Some(effort * 0.3 * (t / 50.0).sin()),
                ..Sample::default()
            }
        };
        (0..60).map(row).collect()
    }

    fn words(rows: &[Sample]) -> String {
        doubt(rows).map_or_else(String::new, |doubt| doubt.to_string())
    }

    #[test]
    fn right_units_and_a_worn_wheel_are_not_doubted() {
        assert_eq!(doubt(&rows(1.0, 1.0, 1.0, 1.0)), None);
        assert_eq!(doubt(&rows(1.0, 1.0, 1.05, 1.0)), None);
        assert_eq!(doubt(&rows(1.0, 1.0, 1.0, 1.0)[..15]), None);
    }

    #[test]
    fn another_unit_is_named() {
        let of = |rows: Vec<Sample>, unit: &str| assert!(words(&rows).contains(unit), "{}", words(&rows));
        of(rows(1.0, 1.0, 1.0 / 3.6, 1.0), "found 3.600");
        of(rows(1.0, 1.0, 1.0 / 3.6, 1.0), "m/s");
        of(rows(1.0, 1.0, 0.6214, 1.0), "miles");
        of(rows(1e3, 1.0, 1.0, 1.0), "milliseconds");
        of(rows(1.0, 1e-3, 1.0, 1.0), "kilometres");
        of(rows(60.0, 1.0, 1.0, 1.0), "look at the units");
        of(rows(1.0, 1.0, 1.0, 200e3), "rotating mass");
        of(rows(1.0, 1.0, 1.0, 200.0), "rotating mass");
    }
}
