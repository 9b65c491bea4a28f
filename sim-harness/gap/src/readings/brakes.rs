//! Do the brake readings of the effort column agree with its power readings?
//!
//! In: runs with an effort column. Out: shown over true effort of the brake, beside that of powering; and the runs
//! without the readings of the brake.
//!
//! ```text
//! ratio = sum u / sum f        f = dv/dt + r(v) + g(s): what the motion needs, over the intervals that brake hard, over the same of those that power hard
//! ```
//!
//! Many columns have the electric brake only, what goes back into the line, or a brake that is calculated from
//! pressures. Such readings are no gain of the column: what is wrong with the brake would go into masses and limits.
//! Hard braking outweighs what is not known of resistance and gradients. Readings that are too low at any speed are not
//! those of the brake; too high at speed alone are those of a brake that fades.

use crate::config::{GapConfig, NuisanceConfig};
use crate::data::believed::{Context, believed_load};
use crate::data::cut;
use crate::data::interval::{Interval, SAME_TIME_S};
use crate::data::rows::Row;
use crate::data::runs::{EffortReading, Run};
use crate::efforts::Looked;
use core::ops::Range;
use rundown_check::figure::Figure;
use rundown_files::statistics::{median, upper_quantile};

/// Shown over true effort of the brake, beside that of powering.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Brakes {
    /// At all speeds, less 1.
    pub off: Figure,
    /// In the slower and in the faster half of the intervals, less 1.
    halves: [Figure; 2],
}

impl Brakes {
    /// The readings are not those of the brake.
    pub fn are_apart(&self, config: &NuisanceConfig) -> bool {
        let most = config.sure * config.brake_gain_sd;
        let is_sure = |off: &Figure| off.away_from(0.0) > config.sure;
        let [slow, _] = &self.halves;
        let too_low = |off: &Figure| is_sure(off) && off.value < -most;
        self.halves.iter().any(too_low) || (is_sure(slow) && slow.value > most)
    }
}

/// What the motion needs, N/kg.
pub fn needed(row: &Row) -> f64 {
    row.effort_n_per_kg - row.residual_n_per_kg
}

/// Rows in which the motion needs more than half of the power that it needs where trains are driven hardest.
pub fn powered_hard(rows: &[Row]) -> Vec<&Row> {
    let driven = rows.iter().map(needed).filter(|needed| *needed > 0.0);
    let hard = upper_quantile(driven, 0.95).map_or(f64::INFINITY, |most| 0.5 * most);
    rows.iter().filter(|row| needed(row) >= hard).collect()
}

/// Shown over needed effort, run by run, as runs differ in it. None from too few rows.
fn ratio(rows: &[&Row], least_rows: usize) -> Option<Figure> {
    let of_run = |rows: &[&Row]| {
        let sum = |of: fn(&Row) -> f64| rows.iter().map(|row| of(row)).sum::<f64>();
        [sum(|row| row.effort_n_per_kg), sum(needed)]
    };
    let runs: Vec<[f64; 2]> = rows.chunk_by(|a, b| a.interval.run == b.interval.run).map(of_run).collect();
    let [shown, needed] = [0, 1].map(|which| runs.iter().map(|sums| sums[which]).sum::<f64>());
    let value = shown / needed;
    let scatter = runs.iter().map(|[shown, needed]| (shown - value * needed).powi(2)).sum::<f64>();
    let count = runs.len() as f64;
    (rows.len() >= least_rows && runs.len() > 1)
        .then(|| Figure { value, sd: (scatter * count / (count - 1.0)).sqrt() / needed.abs() })
}

/// Asks. None where trains hardly power or brake. `rows`: of the effort column, put in its time.
fn of_rows(rows: &[Row], config: &GapConfig) -> Option<Brakes> {
    let least = config.search.least_rows;
    let power = ratio(&powered_hard(rows), least)?;
    // A gentle brake is not distinguished from a slope.
    let brakes = |row: &&Row| needed(row) < -config.interval.brake_test_n_per_kg;
    let braking: Vec<&Row> = rows.iter().filter(brakes).collect();
    let middle = median(braking.iter().map(|row| row.interval.mean_speed_mps()))?;
    let beside = |rows: &[&Row]| {
        let brake = ratio(rows, least)?;
        let value = brake.value / power.value;
        Some(Figure { value: value - 1.0, sd: value.abs() * (brake.sd / brake.value).hypot(power.sd / power.value) })
    };
    let half = |fast: bool| -> Vec<&Row> {
        braking.iter().copied().filter(|row| (row.interval.mean_speed_mps() >= middle) == fast).collect()
    };
    Some(Brakes { off: beside(&braking)?, halves: [beside(&half(false))?, beside(&half(true))?] })
}

/// Asks the runs, their efforts put in their time.
pub fn brakes(context: &Context<'_>, runs: &[Run], effort: EffortReading) -> Option<Brakes> {
    let cut = cut::all(context, runs, effort);
    let looked = Looked { context, runs, cut: &cut, effort, measured: true, model: (&[], &[]) };
    of_rows(&looked.rows(None, 0.0), context.config)
}

/// An interval in which the motion shows a brake, whatever the column says.
pub fn is_braked(context: &Context<'_>, run: &Run, interval: &Interval) -> bool {
    let load = believed_load(context.believed.line(run.direction), interval);
    interval.acceleration_mps2() + load < -context.config.interval.brake_test_n_per_kg
}

/// The runs without what the column has while trains brake: the readings of the brake, and zeros beside blocks that are
/// not in it.
pub fn set_aside(context: &Context<'_>, runs: &[Run], effort: EffortReading) -> Vec<Run> {
    let least = context.config.nuisance.brake_n_per_kg;
    let cut = cut::all(context, runs, effort);
    let of_run = |(run, intervals): (&Run, Vec<Interval>)| {
        let mut run = run.clone();
        let braked: Vec<Range<f64>> = intervals
            .iter()
            .filter(|interval| is_braked(context, &run, interval))
            .map(|interval| interval.begin_s - SAME_TIME_S..interval.begin_s + interval.dt_s + SAME_TIME_S)
            .collect();
        for sample in &mut run.samples {
            let within = || braked.iter().any(|span| span.contains(&sample.time_s));
            if sample.effort_n_per_kg.is_some_and(|effort| effort < -least) || within() {
                sample.effort_n_per_kg = None;
            }
        }
        run.recorded.brakes_aside = true;
        run
    };
    runs.iter().zip(cut).map(of_run).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::believed::tests::on_a_level_line;
    use crate::data::runs::Recorded;
    use crate::efforts::measured;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rundown::model::direction::Direction;
    use rundown_files::sample::Sample;

    const RUNS: usize = 12;

    /// Runs of a train that powers up to 35 m/s, coasts, and brakes with 0.1 to 0.35 N/kg to 8 m/s, read every 5 s.
    /// `shown`: what the column has of an effort at a speed; `arrives`: the share of the demanded brake that arrives at
    /// a speed.
    fn runs(context: &Context<'_>, shown: fn(f64, f64) -> f64, arrives: fn(f64) -> f64) -> Vec<Run> {
        let line = context.believed.line(Direction::Up);
        let mut rng = ChaCha8Rng::seed_from_u64(9);
        let one = |index: usize| {
            let (mut speed, mut location_m, mut effort, mut until): (f64, f64, f64, i32) = (20.0, 1_000.0, 0.25, 0);
            let mut samples = Vec::new();
            for second in 0..1_500 {
                if effort > 0.0 && speed > 35.0 {
                    (effort, until) = (0.0, second + rng.random_range(30..90));
                } else if effort < 0.0 && speed < 8.0 {
                    effort = 0.25;
                } else if effort == 0.0 && second >= until {
                    effort = -rng.random_range(0.1..0.35);
                }
                if second % 5 == 0 {
                    samples.push(Sample {
                        time_s: f64::from(second),
                        location_m: Some(location_m),
                        speed_mps: Some((36.0 * speed).round() / 36.0),
                        effort_n_per_kg: Some(shown(effort, speed)),
                        ..Sample::default()
                    });
                }
                let applied = if effort < 0.0 { effort * arrives(speed) } else { effort };
                speed += applied - line.train.davis().resistance_n_per_kg(speed);
                location_m += speed;
            }
            Run { name: index.to_string(), direction: Direction::Up, day: None, samples, recorded: Recorded::default() }
        };
        (0..RUNS).map(one).collect()
    }

    fn found(shown: fn(f64, f64) -> f64, arrives: fn(f64) -> f64) -> (Brakes, bool) {
        on_a_level_line(RUNS, |context| {
            let brakes = brakes(context, &runs(context, shown, arrives), EffortReading::Momentary).unwrap();
            (brakes, brakes.are_apart(&context.config.nuisance))
        })
    }

    #[test]
    fn a_gain_of_the_brake_readings_alone_is_found_and_one_of_the_column_is_none() {
        let (brakes, apart) = found(|effort, _| if effort < 0.0 { 0.6 * effort } else { effort }, |_| 1.0);
        assert!(apart && (brakes.off.value + 0.4).abs() < 0.03, "{brakes:?}");
        let (brakes, apart) = found(|effort, _| 1.3 * effort, |_| 1.0);
        assert!(!apart && brakes.off.value.abs() < 0.03, "{brakes:?}");
    }

    #[test]
    fn motors_that_hold_less_the_faster_they_are_are_not_the_brake_and_one_that_fades_is() {
        let (brakes, apart) = found(|effort, speed| effort.max(-4.0 / speed), |_| 1.0);
        assert!(apart && brakes.halves[1].value < -0.15, "{brakes:?}");
        // From 60 km/h on, a half less at 140 km/h: the readings are too high where it is fast.
        let (brakes, apart) = found(|effort, _| effort, |speed| 1.0 - 0.5 * ((3.6 * speed - 60.0) / 80.0).max(0.0));
        assert!(!apart && brakes.halves[1].value > 0.15, "{brakes:?}");
    }

    #[test]
    fn what_is_set_aside_is_all_of_the_brake_and_hardly_anything_of_the_power() {
        on_a_level_line(RUNS, |context| {
            // Blocks alone: the column has none of the brake.
            let of_motors = runs(context, |effort, _| effort.max(0.0), |_| 1.0);
            let aside = set_aside(context, &of_motors, EffortReading::Momentary);
            assert!(measured(&aside, &context.config.effort));
            let cut = cut::all(context, &aside, EffortReading::Momentary);
            let effort = EffortReading::Momentary;
            let looked = Looked { context, runs: &aside, cut: &cut, effort, measured: true, model: (&[], &[]) };
            let rows = looked.rows(None, 0.0);
            assert!(rows.len() > 500, "{}", rows.len());
            // Where a log ends as the brake begins, nothing shows it.
            for row in rows.iter().filter(|row| row.interval.begin_s < 1_470.0) {
                assert!(row.residual_n_per_kg.abs() < 0.03, "{row:?}");
            }
            let powered = |runs: &[Run]| {
                let samples = runs.iter().flat_map(|run| &run.samples);
                samples.filter(|sample| sample.effort_n_per_kg.is_some_and(|effort| effort > 0.0)).count()
            };
            // One reading beside each brake at most.
            let [left, all] = [powered(&aside), powered(&of_motors)];
            assert!(left <= all && left as f64 > 0.98 * all as f64, "{left} of {all}");
        });
    }
}
