//! Is there a gap at all, and along what?
//!
//! Probes are functions of location, speed, time since departure, temperature, day, regime and direction that name no
//! cause. Not of the effort: its own error stands in the residual, so rows that are chosen by their effort have one.
//! Under the null each run's score of a probe is as likely positive as negative, so the sign-flip test over runs gives
//! the distribution of the largest of them, whatever the correlation within a run and between probes. (Runs are the
//! unit.) What all drivers do alike between two readings of the effort is no gap: it is drawn with the signs, as large
//! as these runs have it, and driven rows count as much less as they scatter more. Nor is what sensors leave in all
//! runs alike: it is drawn with a standard deviation of 5e-5 N/kg.

use crate::chance::{Draw, Ground, Probe, probability};
use crate::columns::{coordinate_name, hats, in_the_middle, knots};
use crate::config::EvidenceConfig;
use crate::data::{believed::Context, rows::Row};
use crate::noise::calibrate::{Calibrated, Own};
use crate::noise::habits::regime;
use core::ops::Range;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rundown::model::{direction::Direction, effects::Coordinate};
use rundown_files::statistics::mean_of;

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

/// Along what there may be a gap, with the probes for each: hats along coordinates, regimes, directions.
fn axes(rows: &[Row], config: &EvidenceConfig) -> Vec<(Along, Columns)> {
    let along = |axis: Coordinate, count: usize| {
        let knots = knots(rows.iter().filter_map(|row| in_the_middle(axis, row)), count);
        let mut columns = hats(axis, &knots, rows);
        if matches!(axis, Coordinate::Temperature | Coordinate::Day) {
            columns.iter_mut().for_each(|column| centre(column));
        }
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

/// Takes out the mean: what differs from run to run shows in comparison, and what all runs have alike, habits of
/// drivers among it, does not.
fn centre(column: &mut [f64]) {
    let mean = mean_of(&*column);
    column.iter_mut().for_each(|value| *value -= mean);
}

/// Evidence along each of them, strongest first, and the probability of the strongest of all without a gap.
pub fn evidence(context: &Context<'_>, rows: &[Row], calibrated: &Calibrated) -> (Vec<Evidence>, f64) {
    if rows.is_empty() {
        return (Vec::new(), 1.0);
    }
    let config = &context.config.evidence;
    let sizes = Ground::habit_sizes(context, rows, calibrated);
    let ground = Ground::of_probes(context, rows, calibrated, sizes);
    // What runs of a direction have alike is a matter of runs: with a wind of its own in each of them, what is left of
    // one that all have is what drivers do.
    let of_runs = Calibrated { own: Own::default(), ..calibrated.clone() };
    let probes = probes(&ground, &Ground::of_probes(context, rows, &of_runs, sizes), config);
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let mut by_chance = |draw: Draw| -> Vec<f64> {
        let left = || StandardNormal.sample(&mut rng);
        let left: Vec<f64> = core::iter::repeat_with(left).take(probes.len()).collect();
        let size = |(placed, left): (&Placed, f64)| placed.probe.by_chance_beside_sensors(&draw, left);
        probes.iter().zip(left).map(size).collect()
    };
    let draws: Vec<Vec<f64>> = ground.draws(config.flips).map(&mut by_chance).collect();
    let observed: Vec<f64> = probes.iter().map(|placed| placed.probe.observed_beside_sensors()).collect();
    // How often the largest of some probes by chance is as large as the largest observed.
    let p = |of: Range<usize>| {
        let most = |sizes: &[f64]| sizes[of.clone()].iter().copied().fold(0.0, f64::max);
        probability(draws.iter().filter(|sizes| most(sizes) >= most(&observed)).count(), config.flips)
    };
    let mut from = 0;
    let mut all = Vec::new();
    for along in probes.chunk_by(|a, b| a.along == b.along) {
        let those = from..from + along.len();
        from = those.end;
        let best = those.clone().max_by(|a, b| observed[*a].total_cmp(&observed[*b]));
        all.extend(best.map(|best| Evidence {
            along: probes[best].along,
            score: observed[best],
            at: probes[best].at,
            p_value: p(those),
        }));
    }
    all.sort_by(|a, b| b.score.total_cmp(&a.score));
    (all, p(0..probes.len()))
}

/// A probe, along what, and where it stands.
pub struct Placed {
    along: Along,
    at: f64,
    /// What it makes of each run.
    pub probe: Probe,
}

/// The probes that stand in enough runs, those of a direction on ground of their own; none where the columns of the
/// sensors are not independent.
pub fn probes(ground: &Ground<'_>, of_runs: &Ground<'_>, config: &EvidenceConfig) -> Vec<Placed> {
    let Some((base, of_runs_base)) = ground.beside(&[]).zip(of_runs.beside(&[])) else {
        return Vec::new();
    };
    let axes = axes(ground.rows, config).into_iter();
    let all = axes.flat_map(|(along, columns)| columns.into_iter().map(move |(at, column)| (along, at, column)));
    let probe = |along, column: &[f64]| match along {
        Along::Direction => of_runs.probe(&of_runs_base, column),
        Along::Over(_) | Along::Regime => ground.probe(&base, column),
    };
    all.filter_map(|(along, at, column)| Some(Placed { along, at, probe: probe(along, &column)? })).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::believed::tests::on_a_level_line;
    use crate::noise::habits::Scatter;

    const RUNS: usize = 30;
    const ROWS: usize = 60;

    /// The p-value where nothing is hidden but what `residual` says of a row: its index in the run and whether it
    /// brakes, with noise of a standard deviation of 0.01 N/kg, five times as much where it brakes.
    fn p_value(seed: u64, residual: fn(usize, bool) -> f64) -> f64 {
        p_value_of(seed, |_, i| i % 12 == 0, [0.01, 0.05], residual)
    }

    /// The same where every third row brakes, another one in each run, with noise of 0.02 N/kg.
    fn p_value_of_thirds(seed: u64, residual: impl Fn(usize, bool) -> f64) -> f64 {
        p_value_of(seed, |run, i| (i + run) % 3 == 0, [0.01, 0.02], residual)
    }

    /// `brakes`: of a run and a row of it. Noise of a row that coasts, and of one that brakes, N/kg.
    fn p_value_of(
        seed: u64,
        brakes: fn(usize, usize) -> bool,
        [calm_sd, braking_sd]: [f64; 2],
        residual: impl Fn(usize, bool) -> f64,
    ) -> f64 {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut rows = Vec::new();
        for run in 0..RUNS {
            let direction = [Direction::Up, Direction::Down][run / 3 % 2];
            for i in 0..ROWS {
                let brakes = brakes(run, i);
                let speed_mps = 20.0 + ((7 * i + 5 * run) % 13) as f64;
                let mut row = Row::coasting(direction, 1000.0 * i as f64, speed_mps);
                row.interval.run = run;
                row.effort_n_per_kg = if brakes { -0.3 } else { 0.0 };
                row.interval.effort_n_per_kg = Some(row.effort_n_per_kg);
                let noise: f64 = StandardNormal.sample(&mut rng);
                row.residual_n_per_kg = noise * if brakes { braking_sd } else { calm_sd } + residual(i, brakes);
                rows.push(row);
            }
        }
        let noise = crate::noise::whitening::Noise { acceleration_mps2: calm_sd, ..Default::default() };
        on_a_level_line(RUNS, |context| {
            let left: Vec<f64> = rows.iter().map(|row| row.residual_n_per_kg).collect();
            let driven_n_per_kg = Scatter::of(&rows, &left, &context.config.evidence).beyond_n_per_kg();
            let calibrated =
                Calibrated { noise, spread: vec![1.0; rows.len()], driven_n_per_kg, ..Calibrated::default() };
            evidence(context, &rows, &calibrated).1
        })
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

    /// A force of braking in each part of the line, in all runs alike, in its standard deviations.
    fn habit(seed: u64) -> Vec<f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(1000 + seed);
        (0..ROWS / 3).map(|_| StandardNormal.sample(&mut rng)).collect()
    }

    #[test]
    fn what_drivers_do_alike_here_and_there_is_as_large_as_it_is() {
        let of_habit = |seed: u64| {
            let habit = habit(seed);
            p_value_of_thirds(seed, |i, brakes| if brakes { 0.017 * habit[i / 3] } else { 0.0 })
        };
        let low = (0..40).filter(|seed| of_habit(*seed) < 0.05).count();
        // Binomial, 40 of 0.05: more than 6 in one of 300 tries.
        assert!(low <= 6, "{low} of 40");
        let low = (0..40).filter(|seed| p_value_of_thirds(*seed, |_, _| 0.0) < 0.05).count();
        assert!(low <= 6, "{low} of 40 without any");
    }

    #[test]
    fn a_little_resistance_shows_where_drivers_do_nothing_alike() {
        let of_place = |seed| p_value_of_thirds(seed, |i, _| if (20..26).contains(&i) { 0.005 } else { 0.0 });
        let low = (0..20).filter(|seed| of_place(*seed) < 0.05).count();
        assert!(low >= 15, "{low} of 20");
    }

    /// The p-value where nobody brakes, in calm noise.
    fn p_value_of_calm(seed: u64, calm_sd: f64, residual: impl Fn(usize, bool) -> f64) -> f64 {
        p_value_of(seed, |_, _| false, [calm_sd; 2], residual)
    }

    #[test]
    fn what_sensors_leave_in_all_runs_alike_is_no_gap_and_makes_nothing_sure() {
        let nothing = crate::config::GapConfig::default().certainty.nothing_n_per_kg;
        let of_place = |i: usize| if (20..26).contains(&i) { nothing } else { 0.0 };
        let low = (0..20).filter(|seed| p_value_of_calm(*seed, 1e-4, |i, _| of_place(i)) < 0.05).count();
        assert!(low <= 4, "{low} of 20");
        // A probe of 75 rows has a standard deviation of 1.2e-4 N/kg.
        let below_half = (0..40).filter(|seed| p_value_of_calm(*seed, 1e-3, |_, _| 0.0) < 0.5).count();
        assert!((8..=28).contains(&below_half), "{below_half} of 40");
    }
}
