//! Self-test of learning: does the estimate follow the true resistance, how closely, and does it know how closely?
//!
//! In: simulated vehicles whose true r0, r1, r2 are 0.7 to 1.3 of the described ones. Out: for each mode and after 1,
//! 10 and all runs the slope of estimated on true deviation and the spread about it, the error of r(v), the error that
//! is possible ([`crate::bound`]), and the share of truths in the reported 95 % interval.
//!
//! A slope of 1 follows the truth, a slope of 0 does not see it. Efficiency is the variance that is possible over the
//! one that was reached.

use super::{Refused, case::Case, description::Believed};
use crate::bound::{Bound, Known, Worth};
use crate::output::markdown::table as table_of;
use crate::report::resistance::Resistance;
use crate::simulation::scenario_file::Simulation;
use nalgebra::{Matrix3, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use rundown::estimator::config::{Config, Mode};
use rundown::{estimator::Estimator, filter::gaussian::Gaussian, model::resistance::Davis, model::units::KmPerHour};
use rundown_check::figure::HALF_95;
use rundown_files::column::{Column, record};
use rundown_files::replay::{Tick, replay};
use rundown_files::statistics::Pairs;
use rundown_files::table::Record;
use rundown_truth::plan::plan as planned;
use rundown_truth::scenario::{DriveError, Scenario, simulate_planned};
use rundown_truth::sensors::Sample;
use serde::Serialize;

pub const SLOPE_KMH: [f64; 3] = [60.0, 100.0, 140.0];
pub const ERROR_KMH: [f64; 7] = [20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 140.0];
pub const SCALES: [f64; 2] = [0.7, 1.3];
/// Standard deviation by which each coefficient differs beyond the whole, share: that of the memory's prior.
pub const SHAPE_SD: f64 = 0.10;
pub const MODES: [Mode; 3] = [Mode::Paper, Mode::Gated, Mode::Measured];
/// Runs after which is looked, before the last.
const STAGES: [usize; 2] = [1, 10];

#[derive(Clone, Debug)]
pub struct SlopePlan {
    /// The vehicles' line, driver and sensors; without wind, load or effects, or the bound is none.
    pub simulation: Simulation,
    pub vehicles: usize,
    pub runs: usize,
    pub seed: u64,
}

impl SlopePlan {
    /// True over described r0, r1, r2 of a vehicle: as a whole evenly from the smallest to the largest, and each
    /// coefficient beyond that by as much as the memory believes vehicles to differ ([`SHAPE_SD`]). Without the latter
    /// the bound, which knows the prior, would be too high.
    pub fn scales(&self, vehicle: usize) -> [f64; 3] {
        let [least, most] = SCALES;
        let part = match self.vehicles {
            0 | 1 => 0.0,
            count => vehicle as f64 / (count - 1) as f64,
        };
        let whole = least + (most - least) * part;
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed ^ 0x5CA1E);
        rng.set_stream(vehicle as u64);
        std::array::from_fn(|_| {
            let unit: f64 = StandardNormal.sample(&mut rng);
            (whole + SHAPE_SD * unit).clamp(least, most)
        })
    }

    pub fn stages(&self) -> Vec<usize> {
        let before = STAGES.into_iter().filter(|stage| *stage < self.runs);
        before.chain([self.runs]).collect()
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct SlopeLook {
    pub mode: Mode,
    pub vehicle: usize,
    pub scales: [f64; 3],
    pub runs: usize,
    pub believed: Gaussian<3>,
    pub truth: Davis,
    /// Smallest possible covariance, with the prior of the memory.
    pub bound: Matrix3<f64>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SlopeAnswer {
    pub mode: &'static str,
    pub runs: usize,
    pub vehicles: usize,
    pub slope: [f64; 3],
    /// Standard deviation about the line at the same speeds, % of the described resistance.
    pub spread_percent: [f64; 3],
    /// Root mean square error of r(v) over [`ERROR_KMH`], %.
    pub rmse_percent: f64,
    /// Root mean square of the Cramér-Rao bound over the same, %.
    pub bound_percent: f64,
    pub efficiency: f64,
    pub coverage: f64,
}

#[derive(Clone, Debug)]
pub struct SelfTest {
    pub looks: Vec<SlopeLook>,
    /// One for each mode and stage.
    pub answers: Vec<SlopeAnswer>,
    pub stated: Davis,
}

/// Simulates and replays every vehicle, side by side. `done` is called once a run.
pub fn self_test(plan: &SlopePlan, config: Config, done: impl Fn() + Sync) -> Result<SelfTest, Refused> {
    let Believed { train, track } = super::description::of(&plan.simulation)?;
    let of_mode = |mode| Estimator::try_new(Config { mode, ..config }, train, track.clone());
    let estimators = MODES.into_iter().map(of_mode).collect::<Result<Vec<_>, _>>()?;
    let one = |vehicle: usize| of_vehicle(plan, &estimators, vehicle, &done);
    let looks = (0..plan.vehicles).into_par_iter().map(one).collect::<Result<Vec<_>, DriveError>>()?.concat();
    let stated = train.davis();
    Ok(SelfTest { answers: answers(plan, &looks, &stated), looks, stated })
}

fn of_vehicle(
    plan: &SlopePlan,
    estimators: &[Estimator],
    vehicle: usize,
    done: &(impl Fn() + Sync),
) -> Result<Vec<SlopeLook>, DriveError> {
    let scales = plan.scales(vehicle);
    let scenario = Scenario { davis_scale: scales, ..plan.simulation.scenario.clone() };
    let of_vehicle = scenario.train.davis.scaled(scenario.davis_scale);
    let truth = Davis { r0: of_vehicle.r0, r1: of_vehicle.r1, r2: of_vehicle.r2 };
    let worth = Worth::of(&scenario.sensors);
    let stages = plan.stages();
    let mut believed: Vec<_> = estimators.iter().map(Estimator::new_vehicle).collect();
    let mut bounds: Vec<Bound> = estimators.iter().map(|estimator| before(estimator, worth)).collect();
    let mut looks = Vec::new();
    let seed = plan.seed.wrapping_add(7_919 * vehicle as u64);
    for (index, planned) in planned(&scenario, plan.runs, seed).iter().enumerate() {
        let run = simulate_planned(&scenario, planned)?;
        let samples: Vec<Sample> = run.samples.clone();
        let of_run = run.facts.davis;
        let case = Case::simulated(format!("run{index}"), String::new(), run);
        let moved = case.truth.iter().flat_map(|truth| &truth.samples).copied();
        let moved: Vec<_> = moved.collect();
        for (slot, estimator) in estimators.iter().enumerate() {
            replay(estimator, &mut believed[slot], &case.recording, Tick::EverySample);
            bounds[slot].another_gain(estimator.config().learning.gain_sd);
            bounds[slot].run(&moved, &samples, [of_run.r0, of_run.r1, of_run.r2]);
        }
        if stages.contains(&(index + 1)) {
            for (slot, mode) in MODES.into_iter().enumerate() {
                looks.push(SlopeLook {
                    mode,
                    vehicle,
                    scales,
                    runs: index + 1,
                    believed: believed[slot].davis(),
                    truth,
                    bound: bounds[slot].davis(),
                });
            }
        }
        done();
    }
    Ok(looks)
}

/// What the gated mode's memory knows before the first run: the prior that all bounds share.
fn before(estimator: &Estimator, worth: Worth) -> Bound {
    let memory = &estimator.config().memory;
    let vehicle = rundown::tick::memory::Vehicle::new(memory, estimator.train().davis());
    Bound::new(Known::of(estimator.config().mode), worth, vehicle.davis().covariance, 0.0, 0.0)
}

impl SlopeLook {
    /// True and estimated deviation from the description at a speed, and the reported standard deviation, as shares of
    /// the description.
    pub fn deviations(&self, described: &Davis, speed_kmh: f64) -> Option<[f64; 3]> {
        let v = KmPerHour(speed_kmh).to_mps();
        let stated = described.resistance_n_per_kg(v);
        let r = Resistance::at(&self.believed, v)?;
        Some([self.truth.resistance_n_per_kg(v) / stated - 1.0, r.mean_n_per_kg / stated - 1.0, r.sd_n_per_kg / stated])
    }
}

fn answers(plan: &SlopePlan, looks: &[SlopeLook], described: &Davis) -> Vec<SlopeAnswer> {
    let mut answers = Vec::new();
    for mode in MODES {
        for runs in plan.stages() {
            let of = |look: &&SlopeLook| look.mode == mode && look.runs == runs;
            let looks: Vec<&SlopeLook> = looks.iter().filter(of).collect();
            answers.push(answer(mode, runs, &looks, described));
        }
    }
    answers
}

fn answer(mode: Mode, runs: usize, looks: &[&SlopeLook], described: &Davis) -> SlopeAnswer {
    let fits = SLOPE_KMH.map(|kmh| {
        let pairs = looks.iter().filter_map(|l| l.deviations(described, kmh));
        fit(&pairs.map(|[x, y, _]| (x, y)).collect::<Vec<_>>())
    });
    let (mut square, mut possible, mut inside, mut count) = (0.0, 0.0, 0.0, 0.0);
    for look in looks {
        for kmh in ERROR_KMH {
            let v = KmPerHour(kmh).to_mps();
            let true_r = look.truth.resistance_n_per_kg(v);
            let h = Vector3::new(1.0, v, v * v);
            possible += h.dot(&(look.bound * h)) / (true_r * true_r);
            count += 1.0;
            if let Some(r) = Resistance::at(&look.believed, v) {
                let error = r.mean_n_per_kg - true_r;
                square += (error / true_r).powi(2);
                if error.abs() <= HALF_95 * r.sd_n_per_kg {
                    inside += 1.0;
                }
            }
        }
    }
    SlopeAnswer {
        mode: crate::output::json::mode_word(mode),
        runs,
        vehicles: looks.len(),
        slope: fits.map(|fit| fit.slope),
        spread_percent: fits.map(|fit| 100.0 * fit.spread),
        rmse_percent: 100.0 * (square / count).sqrt(),
        bound_percent: 100.0 * (possible / count).sqrt(),
        efficiency: possible / square,
        coverage: inside / count,
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    pub offset: f64,
    pub slope: f64,
    /// Standard deviation of the points about it.
    pub spread: f64,
}

/// Least squares; the spread has n - 2 in the denominator. Not a number for fewer than three points.
pub fn fit(points: &[(f64, f64)]) -> Fit {
    if points.len() < 3 {
        return Fit { offset: f64::NAN, slope: f64::NAN, spread: f64::NAN };
    }
    let pairs = Pairs::of(points);
    let spread = (pairs.left(points) / (points.len() as f64 - 2.0)).sqrt();
    Fit { offset: pairs.offset(), slope: pairs.slope(), spread }
}

/// The columns of `slope.csv`.
pub fn columns() -> Vec<Column<SlopeAnswer>> {
    let mut columns = vec![
        Column::text("mode", "`paper`, `gated` or `measured`", |answer: &SlopeAnswer| answer.mode),
        Column::count("runs", "runs of each vehicle that were learned from", |answer: &SlopeAnswer| answer.runs),
        Column::count("vehicles", "simulated vehicles", |answer: &SlopeAnswer| answer.vehicles),
    ];
    for (index, kmh) in SLOPE_KMH.into_iter().enumerate() {
        let slope = format!("slope of the estimated on the true deviation of r({kmh} km/h) from the description");
        let spread = "standard deviation about that line, of the described resistance";
        columns.push(Column::number(&format!("slope_{kmh}"), "1", &slope, move |answer: &SlopeAnswer| {
            answer.slope[index]
        }));
        let percent = move |answer: &SlopeAnswer| answer.spread_percent[index];
        columns.push(Column::number(&format!("spread_{kmh}_percent"), "%", spread, percent));
    }
    let rmse = format!("root mean square error of r(v) at {} km/h", ERROR_KMH.map(|kmh| kmh.to_string()).join(", "));
    let bound = "root mean square of the Cramér-Rao bound over the same";
    let efficiency = "square of the bound over that of the error";
    columns.extend([
        Column::number("rmse_percent", "%", &rmse, |answer: &SlopeAnswer| answer.rmse_percent),
        Column::number("bound_percent", "%", bound, |answer: &SlopeAnswer| answer.bound_percent),
        Column::number("efficiency", "1", efficiency, |answer: &SlopeAnswer| answer.efficiency),
        Column::number("coverage", "1", "share of the truths in the 95 % interval", |answer: &SlopeAnswer| {
            answer.coverage
        }),
    ]);
    columns
}

pub fn records(answers: &[SlopeAnswer]) -> Vec<Record> {
    let columns = columns();
    answers.iter().map(|answer| record(&columns, answer)).collect()
}

pub fn table(answers: &[SlopeAnswer]) -> String {
    let mut text = format!(
        "{:9} {:>4}  {:>22}  {:>20}  {:>7} {:>7} {:>10}  {:>9}\n",
        "mode", "runs", "slope 60/100/140 km/h", "spread, %", "rmse, %", "bound,%", "efficiency", "in 95 %"
    );
    for answer in answers {
        let three = |values: [f64; 3], digits: usize| values.map(|value| format!("{value:.digits$}")).join(" / ");
        text += &format!(
            "{:9} {:>4}  {:>22}  {:>20}  {:>7.2} {:>7.2} {:>10.3}  {:>7.0} %\n",
            answer.mode,
            answer.runs,
            three(answer.slope, 2),
            three(answer.spread_percent, 2),
            answer.rmse_percent,
            answer.bound_percent,
            answer.efficiency,
            100.0 * answer.coverage
        );
    }
    text
}

/// `slope.md`: a row a mode, the slope after one run and the rest after each stage.
pub fn markdown(answers: &[SlopeAnswer]) -> String {
    let mut stages: Vec<usize> = answers.iter().map(|answer| answer.runs).collect();
    stages.sort_unstable();
    stages.dedup();
    let after = stages.iter().map(usize::to_string).collect::<Vec<_>>().join(" / ");
    let slope = format!("slope at {} km/h after one run", SLOPE_KMH.map(|kmh| kmh.to_string()).join(" / "));
    let error = format!("error after {after} runs");
    let head = ["mode".to_owned(), slope, error, "bound".to_owned(), "in the 95 % interval".to_owned()];
    let row = |mode: &Mode| {
        let word = crate::output::json::mode_word(*mode);
        let of_mode: Vec<&SlopeAnswer> = answers.iter().filter(|answer| answer.mode == word).collect();
        let all = |of: &dyn Fn(&SlopeAnswer) -> String| of_mode.iter().map(|a| of(a)).collect::<Vec<_>>().join(" / ");
        let first = of_mode.first().map(|a| a.slope.map(|slope| format!("{slope:.2}")).join(" / "));
        vec![
            format!("`{word}`"),
            first.unwrap_or_default(),
            format!("{} %", all(&|a| format!("{:.1}", a.rmse_percent))),
            format!("{} %", all(&|a| format!("{:.1}", a.bound_percent))),
            format!("{} %", all(&|a| format!("{:.0}", 100.0 * a.coverage))),
        ]
    };
    table_of(&head, &MODES.iter().map(row).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The heading says after how many runs, the first column which mode.
    #[test]
    fn the_table_of_the_document_has_the_rows_that_are_written() {
        let document = crate::output::markdown::page("study.md");
        let theirs = crate::output::markdown::found(&document, "| mode | slope at");
        let plan = |runs| SlopePlan { simulation: crate::study::case::calm().unwrap(), vehicles: 3, runs, seed: 1 };
        let mut test = self_test(&plan(2), Config::default(), || ()).unwrap();
        // As if after the stages of the command's default: what is compared are heading and labels, not values.
        test.answers.retain(|answer| answer.runs == 1);
        let one = test.answers.clone();
        for runs in &plan(67).stages()[1..] {
            test.answers.extend(one.iter().map(|answer| SlopeAnswer { runs: *runs, ..answer.clone() }));
        }
        let ours = crate::output::markdown::found(&markdown(&test.answers), "| mode |");
        assert_eq!(theirs.first(), ours.first());
        let labels = |rows: &[Vec<String>]| rows.iter().map(|row| row[0].clone()).collect::<Vec<_>>();
        assert_eq!(labels(&theirs), labels(&ours));
        let measured = crate::output::markdown::found(&crate::output::markdown::measured("slope.md"), "| mode |");
        assert_eq!(theirs, measured, "docs/study.md");
    }

    #[test]
    fn points_on_a_line_give_that_line() {
        let line = fit(&[(0.0, 1.0), (1.0, 3.0), (2.0, 5.0)]);
        assert!((line.slope - 2.0).abs() < 1e-12 && (line.offset - 1.0).abs() < 1e-12);
        assert!(line.spread < 1e-12);
    }
}
