//! The steps, in their order.
//!
//! ```text
//! wheels -> readings of all runs put right -> analysis: where, and which effect -> units -> what is left, is it chance?
//!        -> the same with the training runs alone -> hold-out runs before and after: the gap shrinks -> verdict
//! ```
//!
//! Names and sizes come from all runs. How much of the gap they remove comes from an analysis that saw only the
//! training runs, evaluated on the others.

use crate::analysis::{analyse, selected};
use crate::candidate::Term;
use crate::config::{GapConfig, HoldoutConfig};
use crate::data::believed::{Conditions, Context};
use crate::data::rows::Row;
use crate::data::runs::{EffortReading, Run};
use crate::evidence::{Evidence, evidence};
use crate::explained::repaired;
use crate::findings::Findings;
use crate::holdout::evaluation::{Evaluation, evaluate};
use crate::holdout::forward::{Compared, Touched, effects, gap, touched};
use crate::holdout::journey::Journey;
use crate::holdout::multiples::{self, is_simulated, most_denied};
use crate::holdout::share::{Multiple, Share};
use crate::levels::More;
use crate::named::Named;
use crate::naming::{
    confounded::{confounded, of_one_alone},
    names::{may_be_none, named},
    on_line::on_line,
};
use crate::noise::{alike::Alike, own_wind::own_wind, whiteness::Whiteness};
use crate::readings::kinematics::{own_scales, scaled_recorders};
use crate::readings::nuisances::{self, Nuisance, Readings, beside, nuisances, righted};
use crate::readings::offset::of_the_others;
use crate::readings::wheels::{Wheel, put_right, wheels};
use crate::traction::halves::halves;
use crate::trial::Trial;
use crate::trials::{of_scale, trials};
use crate::verdict::{Grounds, Verdict};
use rundown::model::effects::{Effect, EffectError, EffectKind, Effects};
use rundown_check::figure::Figure;

/// What an investigation has found, on all runs and on the hold-out runs.
#[derive(Clone, Debug)]
pub struct Investigation {
    /// Analysis of all runs.
    pub findings: Findings,
    /// What was found, by name, largest first.
    pub named: Vec<Named>,
    /// What fits as well as a named effect, but may be chance, does not repeat in halves of the runs, or is denied by
    /// the hold-out runs: no effect of the repaired model.
    pub candidates: Vec<Named>,
    /// How well the noise fits; none from too few rows.
    pub whiteness: Option<Whiteness>,
    /// What is wrong with the readings of all runs alike, told or not.
    pub nuisances: Vec<Nuisance>,
    /// What the same analysis of the training runs alone found.
    pub trained: Vec<Named>,
    /// Along what the residuals of the believed model vary.
    pub evidence: Vec<Evidence>,
    /// Probability of such evidence without a gap.
    pub p_value: f64,
    /// The same of what is left with the effects in the model, on the very runs that the effects were found in.
    pub p_value_after: f64,
    /// Both on the hold-out runs, with the effects that the training runs show; none with too few runs or rows.
    pub p_value_held_out: Option<[f64; 2]>,
    /// Running time and energy of the hold-out runs.
    pub journeys: Vec<Journey>,
    /// Simulated against measured speed on the hold-out runs.
    pub compared: Vec<Compared>,
    /// The same in numbers, m/s.
    pub gap: Share,
    /// The same where the effects act; none where they touch hardly anything.
    pub touched: Option<Touched>,
    /// Indices of the hold-out runs.
    pub held_out: Vec<usize>,
    /// What is said of the gap as a whole.
    pub verdict: Verdict,
}

/// The most runs that can be held out.
pub fn most_held_out(runs: usize, config: &HoldoutConfig) -> usize {
    runs.saturating_sub(config.least_training)
}

/// Indices of `count` runs, evenly spread; at most [`most_held_out`].
pub fn held_out(runs: usize, count: Option<usize>, config: &HoldoutConfig) -> Vec<usize> {
    let count = count.unwrap_or(runs / config.one_in).min(most_held_out(runs, config));
    (0..count).map(|i| (2 * i + 1) * runs / (2 * count)).collect()
}

/// Investigates. `None`: no run has enough to analyse.
///
/// # Errors
/// [`EffectError`]: more effects than a board takes.
pub fn investigate(
    given: &Context<'_>,
    runs: &[Run],
    hold_out: Option<usize>,
    mut progress: impl FnMut(&str),
) -> Result<Option<Investigation>, EffectError> {
    let Some(Unjudged { findings, mut named, mut candidates, nuisances, runs, effort }) =
        explained(given, runs, &mut progress)
    else {
        return Ok(None);
    };
    let (runs, config) = (runs.as_slice(), given.config);
    let context = &Context { conditions: findings.conditions, ..*given };
    progress("is it chance: sign-flip test over runs");
    let (along, p_value) = evidence(context, &findings.rows, &findings.calibrated);
    let whiteness = Whiteness::of(context, &findings.rows, &findings.calibrated, &findings.terms);
    let tested = held_out(runs.len(), hold_out, &config.holdout);
    let (mut evaluation, mut trained) = (Evaluation::default(), Vec::new());
    if !tested.is_empty() {
        progress("the same on the training runs, evaluated on the others");
        let multiples;
        (evaluation, trained, multiples) = out_of_sample(given, runs, effort, &tested)?;
        named.iter_mut().for_each(|one| one.held_out = multiples::of(one, &multiples));
        if !evaluation.compared.is_empty() {
            let unshared = named.iter_mut().filter(|one| !is_among(one, &trained));
            unshared.for_each(|one| one.unshared(config));
            // Errors that all runs have alike, halves and signs of runs cannot tell from an effect.
            if Alike::of(context, &findings.rows).is_some() {
                let is_doubtful = |one: &mut Named| one.is_unshared || one.is_denied(&config.holdout);
                candidates.extend(named.extract_if(.., is_doubtful));
            }
        }
    }
    let with = effects(&named)?;
    for one in &mut named {
        if let Effect::RunWind(wind) = &one.effect {
            one.per_run = winds(context, &findings, &with, wind.sd_mps, runs);
        }
    }
    let repaired_rows = repaired(&context.believed, &named, runs, &findings.rows);
    let (_, p_value_after) = evidence(context, &repaired_rows, &findings.calibrated);
    let mut share = gap(&evaluation.compared, &config.holdout);
    let mut acting = touched(&evaluation.compared, &config.holdout);
    if let Some(acting) = acting.as_mut().filter(|_| p_value_after > config.certainty.chance) {
        share = share.beside_noise_alone(acting.multiple);
        acting.share = acting.share.beside_noise_alone(acting.multiple);
    }
    doubt_denied(&mut named, acting.as_ref(), config);
    let compared = (!evaluation.compared.is_empty()).then_some((&share, acting.as_ref()));
    let gradients_are_off = findings.gradient_errors_permille().is_some();
    let grounds =
        Grounds { named: &named, candidates: &candidates, p_value, p_value_after, gradients_are_off, gap: compared };
    let verdict = grounds.verdict(config);
    Ok(Some(Investigation {
        verdict,
        gap: share,
        touched: acting,
        findings,
        named,
        candidates,
        whiteness,
        nuisances,
        trained,
        evidence: along,
        p_value,
        p_value_after,
        p_value_held_out: evaluation.p_values,
        journeys: evaluation.journeys,
        compared: evaluation.compared,
        held_out: tested,
    }))
}

/// What all runs show, before it is judged.
struct Unjudged {
    findings: Findings,
    named: Vec<Named>,
    candidates: Vec<Named>,
    nuisances: Vec<Nuisance>,
    /// With readings put right, and how their efforts are read.
    runs: Vec<Run>,
    effort: EffortReading,
}

/// Puts the readings of the runs right, and names what explains them. `None`: no run has enough to analyse.
fn explained(given: &Context<'_>, runs: &[Run], progress: &mut impl FnMut(&str)) -> Option<Unjudged> {
    let config = given.config;
    progress("wheels: each run against the others");
    let (sure_wheels, doubted_wheels): (Vec<Wheel>, Vec<Wheel>) =
        wheels(runs, given.surroundings, config).into_iter().partition(|wheel| wheel.stands(runs, config));
    let by_true_wheels: Vec<Run>;
    let runs = if sure_wheels.is_empty() {
        runs
    } else {
        by_true_wheels = put_right(runs, &sure_wheels);
        &by_true_wheels
    };
    progress("readings of all runs: the age of the effort, the zero of the locations");
    let (read_right, readings) = righted(&Context { conditions: Conditions::of(runs), ..*given }, runs);
    progress("where and what: all runs");
    let (settled, runs, readings) = beside_lengths(given, read_right, readings)?;
    let Settled { findings, mut named, mut candidates } = settled;
    let (sure_units, doubted_units): (Vec<Named>, Vec<Named>) =
        scaled_units(&runs, config).into_iter().partition(|one| stands(&one.trial, config));
    for (all, wheels, units) in
        [(&mut named, sure_wheels, sure_units), (&mut candidates, doubted_wheels, doubted_units)]
    {
        all.extend(wheels.iter().map(|wheel| wheel.named(&runs, config)).chain(units));
    }
    named.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let mut nuisances = nuisances(&readings, findings.gain, config);
    let of_a_unit = findings.differing.standouts.iter().any(|one| one.more == More::Effort);
    beside(&mut nuisances, &named, findings.gain_may_be_mass || of_a_unit);
    nuisances.iter().filter(|one| one.told).for_each(|one| progress(&one.sentence()));
    let effort = readings.effort.reading;
    Some(Unjudged { findings, named, candidates, nuisances, runs, effort })
}

/// Most of the runs give the name as well; a wheel of single runs is found before.
fn is_among(one: &Named, trained: &[Named]) -> bool {
    let kind = one.effect.kind();
    kind == EffectKind::SpeedScale || trained.iter().any(|trained| trained.effect.kind() == kind)
}

/// Lowers the confidence of what acts in the simulation of the hold-out runs, where these have too little of it; a
/// wheel is put right before.
fn doubt_denied(named: &mut [Named], touched: Option<&Touched>, config: &GapConfig) {
    let all = touched.is_some_and(|touched| touched.denying(&config.holdout).is_some());
    let denied = |one: &&mut Named| all && is_simulated(&one.effect) || one.is_denied(&config.holdout);
    named.iter_mut().filter(denied).for_each(|one| one.doubt(config.certainty.denied));
}

/// What the other runs have of each effect that the training runs show.
type Multiples = Vec<(Effect, Option<Multiple>)>;

/// What the training runs alone give, and how that does on the others: where runs are driven alike, without what these
/// deny, one after another, for beside a wrong name a right one may have too little.
fn out_of_sample(
    given: &Context<'_>,
    runs: &[Run],
    effort: EffortReading,
    held_out: &[usize],
) -> Result<(Evaluation, Vec<Named>, Multiples), EffectError> {
    let of = |tested: bool| -> Vec<Run> {
        let wanted = runs.iter().enumerate().filter(|(i, _)| held_out.contains(i) == tested);
        wanted.map(|(_, run)| run.clone()).collect()
    };
    let training = of(false);
    let Some(Settled { findings, mut named, .. }) = settled(given, &training, effort) else {
        return Ok((Evaluation::default(), Vec::new(), Vec::new()));
    };
    let context = &Context { conditions: findings.conditions, ..*given };
    let (tested, mut multiples) = (of(true), Vec::new());
    let alike = Alike::of(context, &findings.rows).is_some();
    loop {
        let evaluation = evaluate(context, &findings, &named, [&training, &tested])?;
        let denied = most_denied(&evaluation.multiples, &given.config.holdout).filter(|_| alike);
        let Some(denied) = denied else {
            let left = named.iter().zip(&evaluation.multiples).map(|(one, multiple)| (one.effect.clone(), *multiple));
            multiples.extend(left);
            return Ok((evaluation, named, multiples));
        };
        multiples.push((named.remove(denied).effect, evaluation.multiples[denied]));
    }
}

/// An analysis without what is no more than chance.
struct Settled {
    findings: Findings,
    named: Vec<Named>,
    candidates: Vec<Named>,
}

/// Analyses. A term that is no more than chance may have taken what the gain of an effort column does in truth: then it
/// is analysed again without the term. `None`: see [`analyse`].
fn settled(given: &Context<'_>, runs: &[Run], effort: EffortReading) -> Option<Settled> {
    let mut selected = selected(given, runs, effort)?;
    loop {
        let findings = analyse(given, runs, effort, &selected)?;
        let context = &Context { conditions: findings.conditions, ..*given };
        let (named, candidates, by_chance) = all_named(&findings, context, runs);
        if !findings.measured || by_chance.is_empty() {
            return Some(Settled { findings, named, candidates });
        }
        selected.leave_out(&by_chance);
    }
}

/// Analyses runs that were put right, and once more where the offset of the locations turns out to be another beside
/// runs of another length. With the runs and readings of which it is. `None`: see [`analyse`].
fn beside_lengths(given: &Context<'_>, runs: Vec<Run>, readings: Readings) -> Option<(Settled, Vec<Run>, Readings)> {
    let effort = readings.effort.reading;
    let found = settled(given, &runs, effort)?;
    let Findings { rows, terms, measured, conditions, .. } = &found.findings;
    let context = &Context { conditions: *conditions, ..*given };
    let left = of_the_others(context, rows, terms, *measured);
    let moved = left.and_then(|left| nuisances::further(context, &runs, &readings, left));
    let again = moved.and_then(|(runs, readings)| Some((settled(given, &runs, effort)?, runs, readings)));
    again.or(Some((found, runs, readings)))
}

/// What was found, by name, what is but a candidate, and the terms that are no more than chance; nothing of it lies
/// beyond the ends of the line.
fn all_named(findings: &Findings, context: &Context<'_>, runs: &[Run]) -> (Vec<Named>, Vec<Named>, Vec<Term>) {
    let names: Vec<String> = runs.iter().map(|run| run.name.clone()).collect();
    let limit = findings.limit(&context.config.search);
    let naming = findings.naming(context, &names);
    let mut all = named(&findings.terms, limit, &naming);
    let gain = findings.gain.filter(|gain| nuisances::is_reported(*gain, context.config)).map(|gain| gain.value);
    confounded(&mut all, gain, &naming);
    of_one_alone(&mut all, &findings.differing.standouts, &context.config.certainty);
    // What no board takes is no effect of a train; the residuals still say that something is left.
    all.retain(|one| one.effect.check().is_ok());
    for one in &mut all {
        on_line(one, context.surroundings.length_m);
    }
    let trials = trials(context, &findings.rows, &findings.calibrated, &findings.terms, runs);
    for one in &mut all {
        let of_term = one.term.and_then(|term| trials.get(term)).cloned().flatten();
        one.tried(of_term.or_else(|| of_readings_and_limits(one, findings, context.config, runs)), context.config);
    }
    let may_be_none = |one: &Named| may_be_none(one, context.believed.train().length_m());
    let (named, others): (Vec<Named>, Vec<Named>) =
        all.into_iter().partition(|one| stands(&one.trial, context.config) && !may_be_none(one) && !one.may_be_habit());
    let is_beyond = |one: &Named| match &one.trial {
        _ if one.may_be_habit() => true,
        Some(trial) => trial.is_beyond_chance(context.config),
        None => may_be_none(one),
    };
    let (candidates, chance): (Vec<Named>, Vec<Named>) = others.into_iter().partition(is_beyond);
    let terms = chance.iter().filter_map(|one| Some(findings.terms.get(one.term?)?.term.clone()));
    (named, candidates, terms.collect())
}

fn stands(trial: &Option<Trial>, config: &GapConfig) -> bool {
    trial.as_ref().is_none_or(|trial| trial.is_stood(config))
}

/// The trial in halves of what leaves no mean residual: limits of the traction, and the wheel of all runs.
fn of_readings_and_limits(one: &Named, findings: &Findings, config: &GapConfig, runs: &[Run]) -> Option<Trial> {
    let limit = findings.limit(&config.search).filter(|limit| limit.effect.kind() == one.effect.kind());
    if let Some(limit) = limit {
        return Trial::by_halves(halves(limit, &findings.powering, runs, &config.traction));
    }
    let Effect::SpeedScale(scale) = &one.effect else { return None };
    of_scale(scale.measured_over_true, &own_scales(runs), runs)
}

/// The wheels that the diagnosis of the logs has put right, where there are several units.
fn scaled_units(runs: &[Run], config: &GapConfig) -> Vec<Named> {
    let of_unit = |(scale, of): (Figure, Vec<usize>)| {
        let mut each = own_scales(runs);
        each.retain(|(run, _)| of.contains(run));
        let names = of.into_iter().map(|i| runs[i].name.clone()).collect();
        let mut named = Named { runs: names, ..Named::wheel(&scale, config) };
        named.tried(of_scale(scale.value, &each, runs), config);
        named
    };
    scaled_recorders(runs).into_iter().map(of_unit).collect()
}

/// Each run's wind in the `up` direction, with its standard deviation.
fn winds(
    context: &Context<'_>,
    findings: &Findings,
    effects: &Effects,
    spread_mps: f64,
    runs: &[Run],
) -> Vec<(String, f64, f64)> {
    let noise = &findings.calibrated.noise;
    let of_run = |(i, run): (usize, &Run)| {
        let rows = findings.rows.iter().filter(|row: &&Row| row.interval.run == i);
        let (headwind_mps, sd) = own_wind(rows, &context.believed, effects, noise, spread_mps);
        (run.name.clone(), run.direction.sign() * headwind_mps, sd)
    };
    runs.iter().enumerate().map(of_run).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rundown::model::effects::MassError;

    #[test]
    fn names_of_which_the_hold_out_runs_have_too_little_are_doubted_but_not_a_wheel() {
        let config = GapConfig::default();
        let confidences = |multiple| {
            let mass = Named::plain(MassError { relative: 0.1 }.into(), Vec::new(), 30.0, 30.0);
            let wheel = Named::wheel(&Figure { value: 1.02, sd: 0.001 }, &config);
            let mut named = [mass, wheel];
            let share = gap(&[], &config.holdout);
            doubt_denied(&mut named, Some(&Touched { count: 40, share, multiple }), &config);
            named.map(|one| one.confidence)
        };
        let [mass, wheel] = confidences(None);
        assert!(mass > 0.9 && wheel > 0.9);
        // Not known well enough to be less, or no less.
        for multiple in [(0.4, (-0.1, 0.9)), (0.95, (0.85, 1.05))] {
            assert_eq!(confidences(Some(multiple)), [mass, wheel]);
        }
        let [denied, same] = confidences(Some((0.4, (-0.1, 0.7))));
        assert!(denied < 0.5 && same == wheel, "{denied}");
    }
}
