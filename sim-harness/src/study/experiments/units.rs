//! Section 5: "to detect the existing parameter variability within the different units".
//!
//! Units of one type whose true resistance is spread evenly about the description, with wind and load from run to run.
//! Each run is estimated for itself, so that runs of a unit are no more alike than others unless the unit makes them
//! so, and r at 100 km/h is tested between units. Beside it the spread of what is carried from run to run, against the
//! true one.

use super::answer::{Answer, Arm, ArmRow, VariantAxis};
use super::groups::{PERMUTATIONS, p_value};
use super::look::{Driven, Look};
use super::plan::Plan;
use super::sweep::Estimated;
use super::variant::Variant;
use crate::report::resistance::Resistance;
use crate::study::Refused;
use crate::study::moments::Moments;
use crate::study::readings::comparison::seed_of;
use rayon::prelude::*;
use rundown::estimator::config::Mode;
use rundown::filter::gaussian::Gaussian;
use rundown_files::replay::ReplayedRun;
use rundown_files::statistics::correlation;

const UNITS: usize = 6;
/// Half of the true spread between units, shares.
const SPREADS: [f64; 4] = [0.0, 0.02, 0.05, 0.10];
/// r is compared at this speed, m/s.
const AT_MPS: f64 = 100.0 / 3.6;

/// What is measured: name, and label with unit.
pub const MEASURED: [(&str, &str); 4] = [
    ("spread_percent", "standard deviation of r(100 km/h) between units, %"),
    ("error_percent", "error of r(100 km/h) of a unit, rms, %"),
    ("correlation", "correlation of estimated and true r(100 km/h)"),
    ("p_value", "p-value: units are alike"),
];

pub fn answer(plan: &Plan<'_>) -> Result<Answer, Refused> {
    let fields = "[wind]\nsd_mps = 1.0\n[load]\nsd = 0.02";
    let variant = |spread: f64| Variant::parse(format!("\u{b1}{} %", 100.0 * spread), 100.0 * spread, fields);
    let variants = SPREADS.into_iter().map(variant).collect::<Result<Vec<_>, _>>()?;
    let all = variants.len() * plan.sets;
    let one = |index: usize| {
        let (variant, set) = (&variants[index / plan.sets], index % plan.sets);
        let found = of_set(plan, variant, SPREADS[index / plan.sets], set);
        (plan.done)(all);
        found
    };
    let rows = (0..all).into_par_iter().map(one).collect::<Result<Vec<_>, Refused>>()?.concat();
    let note = format!(
        "{UNITS} units in each set, each with {} runs; p-values by {PERMUTATIONS} permutations.",
        of_unit(plan)
    );
    Ok(Answer::new(plan, VariantAxis::Values("true half-spread between units, %"), MEASURED.to_vec(), rows)
        .noting(note))
}

fn of_set(plan: &Plan<'_>, variant: &Variant, spread: f64, set: usize) -> Result<Vec<ArmRow>, Refused> {
    let drive = |unit: usize| {
        let scale = 1.0 + spread * (2.0 * unit as f64 / (UNITS - 1) as f64 - 1.0);
        let variant = variant.clone().driven_by(|scenario| scenario.davis_scale = [scale; 3]);
        Driven::new(&variant, of_unit(plan), seed_of(plan.seed, UNITS * set + unit), 0)
    };
    let driven = (0..UNITS).map(drive).collect::<Result<Vec<_>, _>>()?;
    let truth: Vec<f64> = (0..UNITS)
        .map(|unit| {
            let scale = 1.0 + spread * (2.0 * unit as f64 / (UNITS - 1) as f64 - 1.0);
            scale * variant.train.davis().resistance_n_per_kg(AT_MPS)
        })
        .collect();
    let row = |arm: Arm, values| ArmRow { variant: variant.name.clone(), x: variant.x, arm, set, values };
    let mut rows = Vec::new();
    for Estimated { arm, config } in [Estimated::PAPER, Estimated::GATED] {
        let config = config(variant.config);
        let looks = driven.iter().map(|unit| unit.look(variant, config)).collect::<Result<Vec<_>, _>>()?;
        let estimated: Option<Vec<f64>> = looks.iter().map(|look| carried(look, config.mode)).collect();
        let estimated = estimated.ok_or("a unit has no run")?;
        let (mut values, mut labels) = (Vec::new(), Vec::new());
        for (label, unit) in driven.iter().enumerate() {
            let of_its_runs: Vec<f64> = unit.look_apart(variant, config)?.runs.iter().filter_map(of_run).collect();
            labels.resize(labels.len() + of_its_runs.len(), label);
            values.extend(of_its_runs);
        }
        let p = p_value(&values, &labels, plan.seed);
        let pairs: Vec<(f64, f64)> = truth.iter().copied().zip(estimated.iter().copied()).collect();
        let squares = pairs.iter().map(|(was, found)| (found / was - 1.0).powi(2)).sum::<f64>();
        let error = 100.0 * (squares / pairs.len().max(1) as f64).sqrt();
        rows.push(row(arm, vec![spread_percent(&estimated), Some(error), correlation(&pairs), p]));
    }
    rows.push(row(Arm::TRUTH, vec![spread_percent(&truth), None, None, None]));
    Ok(rows)
}

/// Runs of each unit: half of those of a set, for there are several units.
fn of_unit(plan: &Plan<'_>) -> usize {
    plan.runs.div_ceil(2)
}

fn at(davis: &Gaussian<3>) -> Option<f64> {
    Resistance::at(davis, AT_MPS).map(|r| r.mean_n_per_kg)
}

fn of_run(run: &ReplayedRun) -> Option<f64> {
    at(&run.summary.run_davis)
}

/// r at 100 km/h as it is known of the unit after its last run; the paper's mode carries nothing from run to run.
fn carried(look: &Look<'_>, mode: Mode) -> Option<f64> {
    let last = look.runs.last()?;
    at(if mode == Mode::Paper { &last.summary.run_davis } else { &last.vehicle_after })
}

fn spread_percent(values: &[f64]) -> Option<f64> {
    values.iter().copied().collect::<Moments>().variation().map(|share| 100.0 * share)
}
