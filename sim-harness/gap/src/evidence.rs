//! Is there a gap at all, and along what?
//!
//! Witnesses are functions of location, speed, time since departure, temperature, day, effort, regime and direction that name no cause. Under the null each run's score of a witness is as likely positive
//! as negative, so flipping the signs of whole runs gives the distribution of the largest of them, whatever the correlation within a run and
//! between witnesses. (Sign-flip test; runs are the unit.) What sensors leave in all runs alike is no gap: the observed scores are less by what 1e-4 N/kg would make.

use super::calibrate::{Calibrated, knots};
use super::fit::Base;
use super::rows::Row;
use super::select::sensors;
use super::terms::{Context, Coordinate, Term, coordinate};
use nalgebra::DVector;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rundown::model::direction::Direction;

/// How strongly the residuals depend on one coordinate.
#[derive(Clone, Debug, PartialEq)]
pub struct Evidence {
    /// Along what.
    pub coordinate: &'static str,
    /// Largest score over runs, in standard deviations.
    pub score: f64,
    /// Where it is largest.
    pub at: f64,
    /// Probability of such a score, or a larger one, somewhere along this coordinate, without a gap.
    pub p_value: f64,
}

const FLIPS: usize = 999;
/// A dependence up to this is none: what rounding and the reading of the sensors leave, N/kg.
pub const NOTHING_N_PER_KG: f64 = 1e-4;
/// An effort that changes by more within an interval is no evidence, N/kg.
const STEADY_N_PER_KG: f64 = 0.01;

/// A column for each value at which a witness stands.
type Witnesses = Vec<(f64, Vec<f64>)>;

/// Along what there may be a gap, with the witnesses for each: hats along coordinates and the effort, regimes (1 power, 0 coast, -1 brake), directions (1 up, -1 down).
fn axes(context: &Context<'_>, rows: &[Row]) -> Vec<(&'static str, Witnesses)> {
    /// An effort up to this is none, N/kg.
    const COAST_N_PER_KG: f64 = 0.005;
    let along = |axis: Coordinate, count: usize| {
        let at = rows.iter().filter_map(|row| coordinate(axis, row, row.interval.middle()));
        let knots = knots(at, count);
        let columns = Term::Smooth(axis, knots.clone()).columns(context, rows);
        knots.into_iter().zip(columns).collect()
    };
    let those = |value: f64, acts: &dyn Fn(&Row) -> bool| {
        let column = rows.iter().map(|row| f64::from(acts(row))).collect();
        (value, column)
    };
    let efforts = knots(rows.iter().map(|row| row.effort_n_per_kg), 6);
    let effort = efforts.windows(2).map(|pair| {
        let within = |row: &Row| (pair[0]..=pair[1]).contains(&row.effort_n_per_kg);
        those(0.5 * (pair[0] + pair[1]), &within)
    });
    vec![
        ("location", along(Coordinate::Location, 24)),
        ("speed", along(Coordinate::Speed, 7)),
        ("time", along(Coordinate::Time, 7)),
        ("temperature", along(Coordinate::Temperature, 5)),
        ("day", along(Coordinate::Day, 5)),
        ("effort", effort.collect()),
        (
            "regime",
            vec![
                those(1.0, &|row| row.effort_n_per_kg > COAST_N_PER_KG),
                those(0.0, &|row| row.effort_n_per_kg.abs() <= COAST_N_PER_KG),
                those(-1.0, &|row| row.effort_n_per_kg < -COAST_N_PER_KG),
            ],
        ),
        (
            "direction",
            [Direction::Up, Direction::Down]
                .map(|direction| those(direction.sign(), &|row| row.direction == direction))
                .to_vec(),
        ),
    ]
}

/// Evidence along each of them, strongest first, and the probability of the strongest of all without a gap.
pub fn evidence(context: &Context<'_>, rows: &[Row], calibrated: &Calibrated) -> (Vec<Evidence>, f64) {
    if rows.is_empty() {
        return (Vec::new(), 1.0);
    }
    let whitening = calibrated.whitening(context, rows);
    let y: Vec<f64> = rows.iter().map(|row| row.residual_n_per_kg).collect();
    let sensors = sensors(context, rows, &whitening);
    let Some(base) = Base::new(&whitening.whiten(&y), &sensors, whitening.runs()) else {
        return (Vec::new(), 1.0);
    };
    let y = &base.residual;
    // For each witness: along what, where, score of each run, and the score that what does not count would make.
    let mut witnesses: Vec<(usize, f64, Vec<f64>)> = Vec::new();
    let mut small = Vec::new();
    let axes = axes(context, rows);
    for (which, (_, columns)) in axes.iter().enumerate() {
        for (knot, column) in columns {
            let mut column = column.clone();
            // Where the effort changes within an interval its mean is a guess, and the guess is wrong in the same way in all runs.
            for (value, row) in column.iter_mut().zip(rows) {
                if row.interval.effort_change_n_per_kg > STEADY_N_PER_KG {
                    *value = 0.0;
                }
            }
            let column: DVector<f64> = base.beside(&whitening.whiten(&column));
            let scores: Vec<f64> =
                whitening.runs().iter().map(|r| column.rows(r.start, r.len()).dot(&y.rows(r.start, r.len()))).collect();
            if scores.iter().filter(|s| **s != 0.0).count() >= 3 {
                small.push(NOTHING_N_PER_KG * column.norm_squared());
                witnesses.push((which, *knot, scores));
            }
        }
    }
    let size = |sum: f64, scores: &[f64]| sum / scores.iter().map(|s| s * s).sum::<f64>().sqrt();
    let observed: Vec<f64> = witnesses
        .iter()
        .zip(&small)
        .map(|((_, _, s), small)| size((s.iter().sum::<f64>().abs() - small).max(0.0), s))
        .collect();
    let most = |of: &[f64], which: usize| {
        witnesses.iter().zip(of).filter(|((w, _, _), _)| *w == which).map(|(_, v)| *v).fold(0.0, f64::max)
    };
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let runs = whitening.runs().len();
    let (mut exceeded, mut any) = (vec![0_usize; axes.len()], 0);
    let largest = observed.iter().copied().fold(0.0, f64::max);
    for _ in 0..FLIPS {
        let signs: Vec<f64> = (0..runs).map(|_| if rng.next_u32() & 1 == 0 { 1.0 } else { -1.0 }).collect();
        let flipped: Vec<f64> = witnesses
            .iter()
            .map(|(_, _, s)| {
                let sum: f64 = s.iter().zip(&signs).map(|(s, sign)| s * sign).sum();
                size(sum.abs(), s)
            })
            .collect();
        any += usize::from(flipped.iter().copied().fold(0.0, f64::max) >= largest);
        for (which, count) in exceeded.iter_mut().enumerate() {
            *count += usize::from(most(&flipped, which) >= most(&observed, which));
        }
    }
    let p = |count: usize| (count + 1) as f64 / (FLIPS + 1) as f64;
    let mut all: Vec<Evidence> = axes
        .iter()
        .enumerate()
        .filter_map(|(which, (name, _))| {
            let best = (0..witnesses.len())
                .filter(|i| witnesses[*i].0 == which)
                .max_by(|a, b| observed[*a].total_cmp(&observed[*b]))?;
            Some(Evidence {
                coordinate: name,
                score: observed[best],
                at: witnesses[best].1,
                p_value: p(exceeded[which]),
            })
        })
        .collect();
    all.sort_by(|a, b| b.score.total_cmp(&a.score));
    (all, p(any))
}
