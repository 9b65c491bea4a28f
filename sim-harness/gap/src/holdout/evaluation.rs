//! The model that the training runs gave, on hold-out runs: speeds, running times, energy, and whether a gap is left.

use crate::analysis::apply;
use crate::config::HoldoutConfig;
use crate::data::{believed::Context, rows::Row, runs::Run};
use crate::evidence::evidence;
use crate::explained::repaired;
use crate::findings::Findings;
use crate::holdout::forward::{Compared, Repaired, effects, touched};
use crate::holdout::multiples::is_simulated;
use crate::holdout::share::Multiple;
use crate::holdout::{journey::Journey, powered::powered, travelled::travelled};
use crate::named::Named;
use crate::noise::calibrate::Calibrated;
use rundown::model::effects::{EffectError, Effects};
use std::collections::BTreeMap;

/// What the hold-out runs say.
#[derive(Default)]
pub struct Evaluation {
    pub compared: Vec<Compared>,
    pub journeys: Vec<Journey>,
    /// How many times as much as each effect that was tried foresees these runs have, beside the others; none: it acts
    /// in some runs, in readings, or on hardly a speed.
    pub multiples: Vec<Option<Multiple>>,
    /// Probability of the residuals without a gap, before and after; none with too few runs.
    pub p_values: Option<[f64; 2]>,
}

/// Tries the effects that `found` has by name, of the `training` runs, on other runs. `context`: that of the findings.
pub fn evaluate(
    context: &Context<'_>,
    found: &Findings,
    trained: &[Named],
    [training, tested]: [&[Run]; 2],
) -> Result<Evaluation, EffectError> {
    // Which of the hold-out runs an effect of some runs acts in, their units say, where it acts in all runs of some;
    // else only the run itself can say: the choice that fits it better, one bit a run.
    let (always, sometimes): (Vec<Named>, Vec<Named>) =
        trained.iter().cloned().partition(|named| named.runs.is_empty());
    let without = effects(&always)?;
    let with = effects(always.iter().chain(&sometimes))?;
    let (mut rows, powering) = apply(context, found, tested);
    if found.rows.is_empty() {
        // The noise of forces is not known, nor what a perfect model would leave.
        rows.clear();
    }
    let repaired = Repaired { context, calibrated: &found.calibrated, measured: found.measured };
    let compare = |effects: &Effects| {
        let mut compared = repaired.resisted(effects, &rows)?;
        if found.limit(&context.config.search).is_some() {
            let train = context.believed.train();
            compared.extend(
                powering.iter().flat_map(|powering| powered(train, effects, powering, 10.0, &context.config.holdout)),
            );
        }
        Ok(compared)
    };
    let plain = compare(&without)?;
    let mut acts = vec![false; tested.len()];
    let mut compared = plain;
    if !sometimes.is_empty() {
        let acting = compare(&with)?;
        acts = of_units(&sometimes, training, tested)
            .unwrap_or_else(|| acting_in([&compared, &acting], tested.len(), &context.config.holdout));
        let chosen = compared.into_iter().zip(acting);
        compared = chosen.map(|(plain, acting)| if acts[plain.run] { acting } else { plain }).collect();
    }
    let multiple = |one: &Named| -> Result<Option<Multiple>, EffectError> {
        if !one.runs.is_empty() || !is_simulated(&one.effect) {
            return Ok(None);
        }
        let others = effects(always.iter().filter(|other| other.effect != one.effect))?;
        let pairs = compare(&others)?.into_iter().zip(&compared).filter(|(_, with)| !acts[with.run]);
        let beside: Vec<Compared> =
            pairs.map(|(less, with)| Compared { before_mps: less.after_mps, ..*with }).collect();
        Ok(touched(&beside, &context.config.holdout).and_then(|touched| touched.multiple))
    };
    let multiples = trained.iter().map(multiple).collect::<Result<Vec<_>, EffectError>>()?;
    if trained.iter().any(|one| !is_simulated(&one.effect)) {
        let of_run = |(i, run)| travelled(i, run, &context.config.holdout);
        compared.extend(tested.iter().enumerate().flat_map(of_run));
    }
    let of_runs = rows.chunk_by(|a, b| a.interval.run == b.interval.run);
    let journeys = of_runs.filter_map(|rows| {
        let acts = acts[rows[0].interval.run];
        repaired.journey(if acts { &with } else { &without }, rows).transpose()
    });
    let journeys = journeys.collect::<Result<Vec<Journey>, EffectError>>()?;
    // By the names of the hold-out runs.
    let renamed = sometimes.into_iter().filter_map(|mut one| {
        let acting = tested.iter().zip(&acts).filter(|(_, acts)| **acts);
        one.runs = acting.map(|(run, _)| run.name.clone()).collect();
        // No name at all would stand for all runs.
        (!one.runs.is_empty()).then_some(one)
    });
    let renamed: Vec<Named> = always.iter().cloned().chain(renamed).collect();
    Ok(Evaluation { journeys, multiples, p_values: p_values(context, found, &renamed, tested, &rows), compared })
}

/// One run of a unit is no matter of the unit: it may be of a day.
const LEAST_OF_UNIT: usize = 2;

/// In which runs the effects act that act in all training runs of some units, two or more each, and in none of the
/// others; none where they are not all of these, or the training runs do not know a unit.
fn of_units(sometimes: &[Named], training: &[Run], tested: &[Run]) -> Option<Vec<bool>> {
    let runs = &sometimes.first()?.runs;
    if sometimes.iter().any(|named| named.runs != *runs) {
        return None;
    }
    // Of each unit how many runs there are, and in how many of them they act.
    let mut of_units: BTreeMap<&str, [usize; 2]> = BTreeMap::new();
    for run in training {
        let [all, acting] = of_units.entry(&run.recorded.unit).or_default();
        *all += 1;
        *acting += usize::from(runs.contains(&run.name));
    }
    let is_decided = |[all, acting]: &[usize; 2]| *acting == 0 || (acting == all && *all >= LEAST_OF_UNIT);
    if of_units.contains_key("") || !of_units.values().all(is_decided) {
        return None;
    }
    tested.iter().map(|run| of_units.get(run.recorded.unit.as_str()).map(|[_, acting]| *acting > 0)).collect()
}

/// In which runs the effects of some runs act.
fn acting_in([plain, acting]: [&[Compared]; 2], runs: usize, config: &HoldoutConfig) -> Vec<bool> {
    let of_run = |compared: &[Compared], run: usize, of: fn(&Compared) -> f64| {
        let of_run = compared.iter().filter(|c| c.run == run);
        of_run.map(|c| c.weight(config) * of(c)).sum::<f64>()
    };
    let error = |compared: &[Compared], run| of_run(compared, run, |c| c.after_mps * c.after_mps);
    // A driver may by chance demand what a limit leaves: where that foresees the powering phases as well as a share of
    // his own, the limit acts.
    let chance = |run| of_run(plain, run, |c| if c.time_s == 0.0 { c.floor } else { 0.0 });
    (0..runs).map(|run| error(acting, run) < error(plain, run) + chance(run)).collect()
}

/// Is there a gap in the hold-out runs, and is there one left? None with runs whose signs can be flipped in too few
/// combinations.
fn p_values(
    context: &Context<'_>,
    found: &Findings,
    named: &[Named],
    tested: &[Run],
    rows: &[Row],
) -> Option<[f64; 2]> {
    let with_rows = rows.chunk_by(|a, b| a.interval.run == b.interval.run);
    if with_rows.count() < context.config.holdout.least_flipped {
        return None;
    }
    let calibrated = Calibrated { spread: vec![1.0; rows.len()], ..found.calibrated.clone() };
    let p_value = |rows: &[Row]| evidence(context, rows, &calibrated).1;
    let after = repaired(&context.believed, named, tested, rows);
    Some([p_value(rows), p_value(&after)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::runs::tests::of_unit;
    use rundown::model::effects::{DraggingBrake, Effect};

    fn runs(units: &[&str], from: usize) -> Vec<Run> {
        (from..).zip(units).map(|(index, unit)| of_unit(index, unit)).collect()
    }

    fn acts(training: [&str; 4], dragging: &[usize], tested: &[&str]) -> Option<Vec<bool>> {
        let mut named =
            Named::plain(Effect::DraggingBrake(DraggingBrake { drag_n_per_kg: 4e-3 }), Vec::new(), 30.0, 1e-3);
        named.runs = dragging.iter().map(|index| format!("r{index}")).collect();
        of_units(&[named], &runs(&training, 0), &runs(tested, 4))
    }

    #[test]
    fn what_acts_in_all_runs_of_a_unit_acts_in_its_others() {
        let of_c = Some(vec![false, true, false]);
        assert_eq!(acts(["A", "C", "B", "C"], &[1, 3], &["B", "C", "A"]), of_c);
        assert_eq!(acts(["A", "C", "B", "C"], &[1], &["B", "C", "A"]), None, "in one of its two");
        assert_eq!(acts(["A", "C", "B", "C"], &[1, 3], &["D"]), None, "another unit");
        assert_eq!(acts(["", "C", "", "C"], &[1, 3], &["C"]), None);
        assert_eq!(acts(["A", "C", "B", "D"], &[1], &["C"]), None, "a single run");
    }
}
