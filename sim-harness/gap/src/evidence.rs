//! Is there a gap at all, and along what?
//!
//! Probes are functions of location, speed, time since departure, temperature, day, regime and direction that name no cause. Not of the effort: its own error
//! stands in the residual, so rows that are chosen by their effort have one. Under the null each run's score of a probe is as likely positive as negative, so
//! flipping the signs of whole runs gives the distribution of the largest of them, whatever the correlation within a run and between probes. (Sign-flip test;
//! runs are the unit.) What all drivers do alike between two readings of the effort is no gap: it is drawn with the signs, as large as the scatter of driven rows
//! says, and these rows count as much less. Nor is what sensors leave in all runs alike: the observed scores are less by what 1e-4 N/kg would make.

use crate::columns::{coordinate_name, hats, in_the_middle, knots};
use crate::config::EvidenceConfig;
use crate::data::{believed::Context, rows::Row};
use crate::fit::Base;
use crate::noise::calibrate::Calibrated;
use crate::search::fits::sensors;
use nalgebra::DVector;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rundown::model::{direction::Direction, effects::Coordinate};

/// Along what residuals may vary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// A coordinate of the runs.
    Over(Coordinate),
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
    vec![
        along(Coordinate::Location, config.location_knots),
        along(Coordinate::Speed, config.knots),
        along(Coordinate::Time, config.knots),
        along(Coordinate::Temperature, config.run_knots),
        along(Coordinate::Day, config.run_knots),
        (Along::Regime, [1, 0, -1].map(|which| those(f64::from(which), &|row| regime(row, config) == which)).to_vec()),
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
    /// The score by one standard deviation of each habit.
    habits: Vec<f64>,
}

impl Probe {
    /// In standard deviations of chance.
    fn size(&self, sum: f64) -> f64 {
        sum / self.scores.iter().chain(&self.habits).map(|s| s * s).sum::<f64>().sqrt()
    }

    /// As chance would have it: the runs with these signs, the habits with these sizes.
    fn by_chance(&self, signs: &[f64], habits: &[f64]) -> f64 {
        let sum = |of: &[f64], by: &[f64]| of.iter().zip(by).map(|(of, by)| of * by).sum::<f64>();
        self.size((sum(&self.scores, signs) + sum(&self.habits, habits)).abs())
    }

    fn observed(&self) -> f64 {
        self.size((self.scores.iter().sum::<f64>().abs() - self.small).max(0.0))
    }
}

/// Power 1, coast 0, brake -1.
fn regime(row: &Row, config: &EvidenceConfig) -> i8 {
    let effort = row.effort_n_per_kg;
    i8::from(effort > config.coast_n_per_kg) - i8::from(effort < -config.coast_n_per_kg)
}

/// Rows that power, or that brake: between two readings of the effort their drivers do what nobody sees.
struct Driven {
    /// As [`regime`] has it.
    regime: i8,
    /// Mean square of their residuals, and of those of coasting, (N/kg)².
    scatter: [f64; 2],
    /// What all drivers do alike, anywhere and at a place: standard deviation, N/kg.
    habit_n_per_kg: f64,
}

impl Driven {
    /// Powering and braking.
    fn both(rows: &[Row], config: &EvidenceConfig) -> [Self; 2] {
        // `None`: too few rows to tell.
        let scatter = |which: i8| {
            let those = rows.iter().filter(|row| regime(row, config) == which);
            let squares = those.map(|row| row.residual_n_per_kg.powi(2));
            let count = squares.clone().count();
            (count >= config.least_rows).then(|| squares.sum::<f64>() / count as f64)
        };
        // Where hardly anybody coasts, powering is the calmest that there is.
        let calm = scatter(0).or_else(|| scatter(1)).unwrap_or(f64::INFINITY);
        [(1, config.powering_habit), (-1, config.braking_habit)].map(|(regime, share)| {
            let scatter = [scatter(regime).unwrap_or(calm), calm];
            let habit_n_per_kg = share * (scatter[0] - calm).max(0.0).sqrt();
            Self { regime, scatter, habit_n_per_kg }
        })
    }

    /// So many times wider than coasting.
    fn wider(&self) -> f64 {
        let [driven, calm] = self.scatter;
        if calm > 0.0 && driven > calm { (driven / calm).sqrt() } else { 1.0 }
    }

    /// One standard deviation of each habit: of all of them, and along the line.
    fn habits(&self, rows: &[Row], config: &EvidenceConfig) -> Vec<Vec<f64>> {
        let acts = |row: &Row| regime(row, config) == self.regime;
        let place = |row: &Row| in_the_middle(Coordinate::Location, row);
        let edges = knots(rows.iter().filter(|row| acts(row)).filter_map(place), config.location_knots);
        let column = |here: &dyn Fn(&Row) -> bool| -> Vec<f64> {
            rows.iter().map(|row| if acts(row) && here(row) { self.habit_n_per_kg } else { 0.0 }).collect()
        };
        let within = |row: &Row, pair: &[f64]| place(row).is_some_and(|at| (pair[0]..=pair[1]).contains(&at));
        let along = edges.windows(2).map(|pair| column(&|row| within(row, pair)));
        std::iter::once(column(&|_| true)).chain(along).collect()
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
    let driven = Driven::both(rows, config);
    let mut calibrated = calibrated.clone();
    for (row, spread) in rows.iter().zip(&mut calibrated.spread) {
        if let Some(driven) = driven.iter().find(|driven| driven.regime == regime(row, config)) {
            *spread *= driven.wider();
        }
    }
    let whitening = calibrated.whitening(context, rows);
    let y: Vec<f64> = rows.iter().map(|row| row.residual_n_per_kg).collect();
    let sensors = sensors(context, rows, &whitening);
    let base = Base::new(&whitening.whiten(&y), &sensors, whitening.runs())?;
    let habits = driven.iter().flat_map(|driven| driven.habits(rows, config));
    let habits: Vec<DVector<f64>> = habits.map(|habit| whitening.whiten(&habit)).collect();
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
        let habits = habits.iter().map(|habit| habit.dot(&column)).collect();
        enough.then_some(Probe { axis, at, scores, small, habits })
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
        let habits: Vec<f64> = (0..probes.first().map_or(0, |probe| probe.habits.len()))
            .map(|_| StandardNormal.sample(&mut rng))
            .collect();
        let flipped: Vec<f64> = probes.iter().map(|probe| probe.by_chance(&signs, &habits)).collect();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::believed::tests::on_a_level_line;

    const RUNS: usize = 30;
    const ROWS: usize = 60;

    /// The p-value where nothing is hidden but what `residual` says of a row: its index in the run and whether it brakes, with noise of a standard deviation
    /// of 0.01 N/kg, five times as much where it brakes.
    fn p_value(seed: u64, residual: fn(usize, bool) -> f64) -> f64 {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut rows = Vec::new();
        for run in 0..RUNS {
            let direction = [Direction::Up, Direction::Down][run % 2];
            for i in 0..ROWS {
                let brakes = i % 12 == 0;
                let mut row = Row::coasting(direction, 1000.0 * i as f64, 25.0);
                row.interval.run = run;
                row.effort_n_per_kg = if brakes { -0.3 } else { 0.0 };
                let noise: f64 = StandardNormal.sample(&mut rng);
                row.residual_n_per_kg = noise * if brakes { 0.05 } else { 0.01 } + residual(i, brakes);
                rows.push(row);
            }
        }
        let noise = crate::noise::whitening::Noise { acceleration_mps2: 0.01, ..Default::default() };
        let calibrated = Calibrated { noise, spread: vec![1.0; rows.len()], ..Calibrated::default() };
        on_a_level_line(RUNS, |context| evidence(context, &rows, &calibrated).1)
    }

    #[test]
    fn where_nothing_is_hidden_a_low_p_value_is_as_rare_as_it_says() {
        let low = (0..60).filter(|seed| p_value(*seed, |_, _| 0.0) < 0.05).count();
        // Binomial, 60 of 0.05: more than 8 in one of 300 tries.
        assert!(low <= 8, "{low} of 60");
    }

    #[test]
    fn a_brake_that_works_between_two_readings_in_all_runs_alike_is_no_gap() {
        let low = (0..20).filter(|seed| p_value(*seed, |_, brakes| if brakes { 0.05 } else { 0.0 }) < 0.05).count();
        assert!(low <= 4, "{low} of 20");
    }

    #[test]
    fn more_resistance_at_a_place_is_one() {
        for seed in 0..5 {
            let p = p_value(seed, |i, _| if (20..26).contains(&i) { 0.01 } else { 0.0 });
            assert!(p <= 0.002, "{p}");
        }
    }
}
