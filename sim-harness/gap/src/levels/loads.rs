//! Which unit needs more effort than the others for the same motion? Either it is heavier, or its effort column reads
//! too high: both multiply the effort of this unit alone.
//!
//! In: all rows of an effort column beside the model that was found. Each run says by which share of its effort it
//! needs more; units are compared as in the level above.

use super::{Level, More, One, Standout, all_columns, compared, runs_of, without_directions};
use crate::candidate::Fitted;
use crate::chance::Ground;
use crate::columns::mass;
use crate::data::{believed::Context, rows::Row, runs::Run};
use crate::noise::calibrate::{Calibrated, effort};
use crate::trials::column;

const LEVELS: [Level; 1] = [Level::Unit];

/// Units that need more effort than the others, or less; none without an effort column. `noise`: beside columns in
/// which runs differ.
pub(super) fn standouts(
    context: &Context<'_>,
    rows: &[Row],
    noise: impl Fn(Vec<Vec<f64>>) -> Calibrated,
    model: &[Fitted],
    runs: &[Run],
) -> Vec<Standout> {
    let config = context.config;
    let mass = mass(context, rows);
    let beside = all_columns(&LEVELS, &mass, rows, runs, config.evidence.least_runs);
    if beside.is_empty() || effort(rows).iter().all(|effort| *effort == 0.0) {
        return Vec::new();
    }
    let ground = Ground::of_each_run(context, rows, &noise(beside));
    let columns: Vec<Vec<f64>> = model.iter().map(|fitted| column(context, rows, fitted)).collect();
    let Some(base) = ground.beside(&columns) else {
        return Vec::new();
    };
    let one = |(of_run, run)| One { of_run, described: of_run, run };
    let mut all: Vec<One<'_>> = ground.of_runs(&base, &mass).into_iter().zip(runs_of(rows, runs)).map(one).collect();
    all.retain(|one| one.of_run.information > 0.0);
    without_directions(&mut all);
    let (mut found, _) = compared(&LEVELS, &all, More::Effort, config);
    found.retain(|one| one.share.value.abs() > config.between_runs.least_effort);
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::believed::tests::on_a_level_line;
    use crate::data::runs::Recorded;
    use crate::noise::whitening::Noise;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;
    use rundown::model::direction::Direction;

    const RUNS: usize = 40;

    /// Of forty runs of four units, of which unit 3 is heavier by a share, beside an effort column that reads 3 % too
    /// much in all; loads differ by 0.8 %.
    fn found(heavier: f64, seed: u64) -> Vec<Standout> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let run = |run: usize| Run {
            name: run.to_string(),
            direction: [Direction::Up, Direction::Down][run / 4 % 2],
            day: Some((run / 8) as f64 + 0.3),
            samples: Vec::new(),
            recorded: Recorded { unit: format!("u{}", run % 4), ..Recorded::default() },
        };
        let runs: Vec<Run> = (0..RUNS).map(run).collect();
        on_a_level_line(RUNS, |context| {
            let r2 = context.believed.train().davis().r2;
            let mut rows = Vec::new();
            for (index, run) in runs.iter().enumerate() {
                let load = 0.008 * rng.sample::<f64, _>(StandardNormal) + if index % 4 == 3 { heavier } else { 0.0 };
                for i in 0..60 {
                    let speed_mps: f64 = rng.random_range(10.0..35.0);
                    let mut row = Row::coasting(run.direction, 900.0 * f64::from(i), speed_mps);
                    row.interval.run = index;
                    let effort = [0.0, 0.05, 0.25, -0.1][i as usize % 4];
                    row.effort_n_per_kg = 1.03 * effort;
                    row.interval.effort_n_per_kg = Some(row.effort_n_per_kg);
                    row.residual_n_per_kg = 0.03 * effort
                        + load / (1.0 + load) * (effort - r2 * speed_mps * speed_mps)
                        + 0.01 * rng.sample::<f64, _>(StandardNormal);
                    rows.push(row);
                }
            }
            let noise = Noise { acceleration_mps2: 0.01, ..Noise::default() };
            let calibrated = Calibrated::even(noise, rows.len());
            standouts(context, &rows, |_| calibrated.clone(), &[], &runs)
        })
    }

    #[test]
    fn a_unit_that_is_heavier_is_reported_with_its_share() {
        for seed in 0..5 {
            let found = found(0.08, seed);
            let [one] = &found[..] else {
                panic!("expected one, found {found:?}");
            };
            assert_eq!((one.of.as_str(), one.more, one.runs), ("u3", More::Effort, 10));
            assert!((one.share.value - 0.08).abs() < 0.02, "{one:?}");
            assert!(one.sentence().contains("it is heavier by about as much"), "{}", one.sentence());
        }
    }

    #[test]
    fn where_no_unit_differs_none_is_reported() {
        let sets = (10..40).filter(|seed| !found(0.0, *seed).is_empty()).count();
        assert!(sets <= 2, "{sets} of 30");
    }
}
