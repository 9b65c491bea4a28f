//! Do the columns of a log hold the units that their names say?
//!
//! Distance by location over distance by speed is 1 where all is well, within the few percent of a worn wheel. A speed
//! in m/s makes it 3.6, a time in milliseconds or a location in kilometres a thousandth. An effort that is a force has
//! values that no train has. Medians, so that no single wild reading decides.

use crate::sample::Sample;
use crate::statistics::median_of;
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
/// Fewer pieces or efforts decide nothing.
const FEW: usize = 20;
/// Nor do fewer pieces in which the speed changes.
const FEW_CHANGING: usize = 5;
/// Where a unit changes within a log, so large a share of the pieces has the usual ratio of its part, within this
/// factor.
const MOST: f64 = 0.85;
const ALIKE: f64 = 1.2;
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
    far_ratio(&pieces(rows)).map(|ratio| Doubt::Distance { ratio })
}

/// Distance by location over distance by speed, where it is too far from 1 to be a matter of a wheel, and the line from
/// which on: 0 for the whole run, otherwise where the part that is off begins or ends.
pub fn far(rows: &[Sample]) -> Option<(f64, u64)> {
    let pieces = pieces(rows);
    far_ratio(&pieces).map(|ratio| (ratio, 0)).or_else(|| far_part(pieces))
}

/// The median over the pieces of a run. A speed that stands still is no unit: the pieces in which it changes must say
/// the same, if there are any.
fn far_ratio(pieces: &[Piece]) -> Option<f64> {
    let changing: Vec<f64> = pieces.iter().filter(|piece| piece.changes).map(|piece| piece.ratio).collect();
    let ratio = middle(pieces.iter().map(|piece| piece.ratio)).filter(|ratio| is_far(*ratio))?;
    let is_agreed = changing.len() >= FEW_CHANGING && (ratio / FAR..ratio * FAR).contains(&median_of(&changing));
    is_agreed.then_some(ratio)
}

/// The same of a log whose unit changes within.
fn far_part(mut pieces: Vec<Piece>) -> Option<(f64, u64)> {
    pieces.retain(|piece| piece.changes);
    let far = pieces.iter().filter(|piece| is_far(piece.ratio)).count();
    if far < FEW / 2 || pieces.len() - far < FEW / 2 {
        return None;
    }
    let part = |split: usize| {
        let halves = [&pieces[..split], &pieces[split..]];
        let [one, two] = halves.map(|part| median_of(part.iter().map(|piece| piece.ratio)));
        let (far, near) = if is_far(one) { (one, two) } else { (two, one) };
        let agrees = |piece: &Piece, usual: f64| (usual / ALIKE..usual * ALIKE).contains(&piece.ratio);
        let agree = halves.iter().zip([one, two]).map(|(part, usual)| part.iter().filter(|p| agrees(p, usual)).count());
        let share = agree.sum::<usize>() as f64 / pieces.len() as f64;
        (is_far(far) && !is_far(near) && share > MOST).then_some((share, far, pieces[split].line))
    };
    let split = (FEW / 2..=pieces.len() - FEW / 2).filter_map(part).max_by(|a, b| a.0.total_cmp(&b.0));
    split.map(|(_, ratio, line)| (ratio, line))
}

fn is_far(ratio: f64) -> bool {
    !(1.0 / FAR..FAR).contains(&ratio)
}

/// A part of a run over which a train moves.
struct Piece {
    /// Distance by location over that by speed.
    ratio: f64,
    /// The speed is not the same in all its rows.
    changes: bool,
    /// Where it begins.
    line: u64,
}

fn pieces(rows: &[Sample]) -> Vec<Piece> {
    let read: Vec<&Sample> = rows.iter().filter(|row| row.location_m.is_some() && row.speed_mps.is_some()).collect();
    let step = |pair: &[&Sample]| {
        let (from, to) = (pair[0].speed_mps?, pair[1].speed_mps?);
        let by_speed_m = 0.5 * (from + to) * (pair[1].time_s - pair[0].time_s);
        let by_location_m = pair[1].location_m? - pair[0].location_m?;
        let is_moving = from.min(to) > SLOW_MPS && by_speed_m > 0.0;
        is_moving.then_some(Stride { by_location_m, by_speed_m, changes: from != to, line: pair[0].line })
    };
    let steps: Vec<Option<Stride>> = read.windows(2).map(step).collect();
    let all_m: f64 = steps.iter().flatten().map(|step| step.by_speed_m).sum();
    joined(&steps, PIECE_M.min(all_m / (2 * FEW) as f64))
}

/// From row to row.
#[derive(Clone, Copy)]
struct Stride {
    by_location_m: f64,
    by_speed_m: f64,
    changes: bool,
    line: u64,
}

/// Steps of a moving train as pieces of this length; a location that stands still is no matter of units.
fn joined(steps: &[Option<Stride>], piece_m: f64) -> Vec<Piece> {
    let mut pieces = Vec::new();
    let mut sum: Option<Stride> = None;
    for step in steps {
        let Some(step) = step else {
            sum = None;
            continue;
        };
        let piece = sum.map_or(*step, |sum| Stride {
            by_location_m: sum.by_location_m + step.by_location_m,
            by_speed_m: sum.by_speed_m + step.by_speed_m,
            changes: sum.changes || step.changes,
            line: sum.line,
        });
        let Stride { by_location_m, by_speed_m, changes, line } = piece;
        sum = Some(piece);
        if by_speed_m >= piece_m && by_location_m != 0.0 {
            pieces.push(Piece { ratio: by_location_m.abs() / by_speed_m, changes, line });
            sum = None;
        } else if by_speed_m > STUCK_M {
            sum = None;
        }
    }
    pieces
}

fn middle(values: impl Iterator<Item = f64>) -> Option<f64> {
    let values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    (values.len() >= FEW).then(|| median_of(&values))
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
