//! Is there a gap at all, and along what?
//!
//! Probes are functions of location, speed, time since departure, temperature, day, effort, regime and direction that name no cause. Under the null each run's score of a probe is as likely positive
//! as negative, so flipping the signs of whole runs gives the distribution of the largest of them, whatever the correlation within a run and
//! between probes. (Sign-flip test; runs are the unit.) What sensors leave in all runs alike is no gap: the observed scores are less by what 1e-4 N/kg would make.

use crate::columns::{coordinate_name, hats, in_the_middle, knots};
use crate::config::EvidenceConfig;
use crate::data::{believed::Context, rows::Row};
use crate::fit::Base;
use crate::noise::calibrate::Calibrated;
use crate::search::fits::sensors;
use nalgebra::DVector;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rundown::model::{direction::Direction, effects::Coordinate};

/// Along what residuals may vary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// A coordinate of the runs.
    Over(Coordinate),
    Effort,
    /// Power 1, coast 0, brake -1.
    Regime,
    /// Up 1, down -1.
    Direction,
}

impl Along {
    /// As in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Over(coordinate) => coordinate_name(coordinate),
            Self::Effort => "effort",
            Self::Regime => "regime",
            Self::Direction => "direction",
        }
    }
}

/// How strongly the residuals depend on one coordinate.
#[derive(Clone, Debug, PartialEq)]
pub struct Evidence {
    pub along: Along,
    /// Largest score over runs, in standard deviations.
    pub score: f64,
    pub at: f64,
    /// Probability of such a score, or a larger one, somewhere along this coordinate, without a gap.
    pub p_value: f64,
}

/// A column for each value at which a probe stands.
type Columns = Vec<(f64, Vec<f64>)>;

/// Along what there may be a gap, with the probes for each: hats along coordinates and the effort, regimes, directions.
fn axes(rows: &[Row], config: &EvidenceConfig) -> Vec<(Along, Columns)> {
    let along = |axis: Coordinate, count: usize| {
        let knots = knots(rows.iter().filter_map(|row| in_the_middle(axis, row)), count);
        let columns = hats(axis, &knots, rows);
        (Along::Over(axis), knots.into_iter().zip(columns).collect())
    };
    let those = |value: f64, acts: &dyn Fn(&Row) -> bool| {
        let column = rows.iter().map(|row| f64::from(acts(row))).collect();
        (value, column)
    };
    let efforts = knots(rows.iter().map(|row| row.effort_n_per_kg), config.effort_knots);
    let effort = efforts.windows(2).map(|pair| {
        let within = |row: &Row| (pair[0]..=pair[1]).contains(&row.effort_n_per_kg);
        those(0.5 * (pair[0] + pair[1]), &within)
    });
    let coast_n_per_kg = config.coast_n_per_kg;
    vec![
        along(Coordinate::Location, config.location_knots),
        along(Coordinate::Speed, config.knots),
        along(Coordinate::Time, config.knots),
        along(Coordinate::Temperature, config.run_knots),
        along(Coordinate::Day, config.run_knots),
        (Along::Effort, effort.collect()),
        (
            Along::Regime,
            vec![
                those(1.0, &|row| row.effort_n_per_kg > coast_n_per_kg),
                those(0.0, &|row| row.effort_n_per_kg.abs() <= coast_n_per_kg),
                those(-1.0, &|row| row.effort_n_per_kg < -coast_n_per_kg),
            ],
        ),
        (
            Along::Direction,
            [Direction::Up, Direction::Down]
                .map(|direction| those(direction.sign(), &|row| row.direction == direction))
                .to_vec(),
        ),
    ]
}

/// A probe regressor: along what, where, the score of each run, and the score that what does not count would make.
struct Probe {
    axis: usize,
    at: f64,
    scores: Vec<f64>,
    small: f64,
}

impl Probe {
    /// In standard deviations.
    fn size(&self, sum: f64) -> f64 {
        sum / self.scores.iter().map(|s| s * s).sum::<f64>().sqrt()
    }

    fn observed(&self) -> f64 {
        self.size((self.scores.iter().sum::<f64>().abs() - self.small).max(0.0))
    }
}

/// The probes that stand in enough runs.
fn probes(
    context: &Context<'_>,
    rows: &[Row],
    calibrated: &Calibrated,
    axes: &[(Along, Columns)],
) -> Option<Vec<Probe>> {
    let config = &context.config.evidence;
    let whitening = calibrated.whitening(context, rows);
    let y: Vec<f64> = rows.iter().map(|row| row.residual_n_per_kg).collect();
    let sensors = sensors(context, rows, &whitening);
    let base = Base::new(&whitening.whiten(&y), &sensors, whitening.runs())?;
    let probe = |axis: usize, at: f64, column: &[f64]| {
        // Where the effort changes within an interval its mean is a guess, and the guess is wrong in the same way in all runs.
        let steady = |row: &Row| row.interval.effort_change_n_per_kg <= config.steady_n_per_kg;
        let column = column.iter().zip(rows).map(|(value, row)| if steady(row) { *value } else { 0.0 });
        let column: DVector<f64> = base.beside(&whitening.whiten(&column.collect::<Vec<f64>>()));
        let score =
            |r: &core::ops::Range<usize>| column.rows(r.start, r.len()).dot(&base.residual.rows(r.start, r.len()));
        let scores: Vec<f64> = whitening.runs().iter().map(score).collect();
        let enough = scores.iter().filter(|s| **s != 0.0).count() >= config.least_runs;
        let small = context.config.certainty.nothing_n_per_kg * column.norm_squared();
        enough.then_some(Probe { axis, at, scores, small })
    };
    let all = axes.iter().enumerate().flat_map(|(axis, (_, columns))| columns.iter().map(move |column| (axis, column)));
    Some(all.filter_map(|(axis, (at, column))| probe(axis, *at, column)).collect())
}

/// Evidence along each of them, strongest first, and the probability of the strongest of all without a gap.
pub fn evidence(context: &Context<'_>, rows: &[Row], calibrated: &Calibrated) -> (Vec<Evidence>, f64) {
    let config = &context.config.evidence;
    if rows.is_empty() {
        return (Vec::new(), 1.0);
    }
    let axes = axes(rows, config);
    let Some(probes) = probes(context, rows, calibrated, &axes) else {
        return (Vec::new(), 1.0);
    };
    let observed: Vec<f64> = probes.iter().map(Probe::observed).collect();
    let most = |of: &[f64], axis: usize| {
        probes.iter().zip(of).filter(|(probe, _)| probe.axis == axis).map(|(_, v)| *v).fold(0.0, f64::max)
    };
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let runs = rows.chunk_by(|a, b| a.interval.run == b.interval.run).count();
    let (mut exceeded, mut any) = (vec![0_usize; axes.len()], 0);
    let largest = observed.iter().copied().fold(0.0, f64::max);
    for _ in 0..config.flips {
        let signs: Vec<f64> = (0..runs).map(|_| if rng.next_u32() & 1 == 0 { 1.0 } else { -1.0 }).collect();
        let flipped = |probe: &Probe| {
            let sum: f64 = probe.scores.iter().zip(&signs).map(|(s, sign)| s * sign).sum();
            probe.size(sum.abs())
        };
        let flipped: Vec<f64> = probes.iter().map(flipped).collect();
        any += usize::from(flipped.iter().copied().fold(0.0, f64::max) >= largest);
        for (axis, count) in exceeded.iter_mut().enumerate() {
            *count += usize::from(most(&flipped, axis) >= most(&observed, axis));
        }
    }
    let p = |count: usize| (count + 1) as f64 / (config.flips + 1) as f64;
    let of_axis = |(axis, (along, _)): (usize, &(Along, Columns))| {
        let of = (0..probes.len()).filter(|i| probes[*i].axis == axis);
        let best = of.max_by(|a, b| observed[*a].total_cmp(&observed[*b]))?;
        Some(Evidence { along: *along, score: observed[best], at: probes[best].at, p_value: p(exceeded[axis]) })
    };
    let mut all: Vec<Evidence> = axes.iter().enumerate().filter_map(of_axis).collect();
    all.sort_by(|a, b| b.score.total_cmp(&a.score));
    (all, p(any))
}
