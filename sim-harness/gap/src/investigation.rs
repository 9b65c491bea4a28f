//! The five steps, in their order: is there a gap, where, which effect, add it, show the gap shrink.
//!
//! Names and sizes come from all runs. How much of the gap they remove comes from an analysis that saw only the training runs, evaluated on the others.

use crate::analysis::analyse;
use crate::config::HoldoutConfig;
use crate::data::believed::{Conditions, Context};
use crate::data::rows::Row;
use crate::data::runs::{EffortReading, Run};
use crate::evidence::{Evidence, evidence};
use crate::explained::repaired;
use crate::findings::Findings;
use crate::holdout::evaluation::{Evaluation, evaluate};
use crate::holdout::forward::{Compared, Touched, effects, gap, touched};
use crate::holdout::{journey::Journey, share::Share};
use crate::levels::{Standout, standouts};
use crate::named::Named;
use crate::naming::{names::named, on_line::on_line};
use crate::noise::{own_wind::own_wind, whiteness::Whiteness};
use crate::readings::kinematics::scaled_recorders;
use crate::readings::nuisances::{Nuisance, nuisances, righted};
use crate::readings::wheels::{put_right, wheels};
use crate::trials::trials;
use rundown::model::effects::{Effect, EffectError, Effects};

/// What came of it.
#[derive(Clone, Debug)]
pub struct Investigation {
    /// Analysis of all runs.
    pub findings: Findings,
    /// What was found, by name, largest first.
    pub named: Vec<Named>,
    /// What fits as well as a named effect, but may be chance, or does not repeat in halves of the runs: no effect of the repaired model.
    pub candidates: Vec<Named>,
    /// Units, drivers and days that differ from the others beside all that.
    pub standouts: Vec<Standout>,
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
    /// What it comes to.
    pub verdict: Verdict,
}

/// What an investigation comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// What the model does not explain is what sensors leave.
    NoGap,
    /// There is a gap, and no name for it.
    Unknown,
    /// Named effects remove a part of the gap.
    PartlyExplained,
    /// Named effects remove the gap.
    Explained,
}

impl Verdict {
    /// One word.
    pub fn name(self) -> &'static str {
        match self {
            Self::NoGap => "no_gap",
            Self::Unknown => "unknown",
            Self::PartlyExplained => "partly_explained",
            Self::Explained => "explained",
        }
    }
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
    let config = given.config;
    progress("wheels: each run against the others");
    let wheels = wheels(runs, given.surroundings, config);
    let own_wheels: Vec<Run>;
    let runs = if wheels.is_empty() {
        runs
    } else {
        own_wheels = put_right(runs, &wheels);
        &own_wheels
    };
    progress("readings of all runs: the age of the effort, the zero of the locations");
    let (righted, readings) = righted(&Context { conditions: Conditions::of(runs), ..*given }, runs);
    let (runs, effort) = (righted.as_slice(), readings.effort.reading);
    progress("where and what: all runs");
    let Some(findings) = analyse(given, runs, effort) else {
        return Ok(None);
    };
    let nuisances = nuisances(&readings, findings.gain, config);
    nuisances.iter().filter(|one| one.told).for_each(|one| progress(&one.sentence()));
    let context = &Context { conditions: findings.conditions, ..*given };
    let (mut named, candidates) = all_named(&findings, context, runs);
    named.extend(wheels.iter().map(|wheel| wheel.named(runs, config.certainty.most_gain)));
    named.extend(scaled_recorders(runs).into_iter().map(|(scale, of)| Named {
        runs: of.into_iter().map(|i| runs[i].name.clone()).collect(),
        ..Named::wheel(&scale, config)
    }));
    named.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let with = effects(&named)?;
    for one in &mut named {
        if let Effect::RunWind(wind) = &one.effect {
            one.per_run = winds(context, &findings, &with, wind.sd_mps, runs);
        }
    }
    progress("is it chance: signs of whole runs flipped");
    let (evidence, p_value) = evidence(context, &findings.rows, &findings.calibrated);
    let rows = repaired(&context.believed, &named, runs, &findings.rows);
    let (_, p_value_after) = crate::evidence::evidence(context, &rows, &findings.calibrated);
    progress("which unit, driver or day differs");
    let standouts = standouts(context, &findings.rows, &findings.calibrated, &findings.terms, runs);
    let whiteness = Whiteness::of(context, &findings.rows, &findings.calibrated, &findings.terms);
    let held_out = held_out(runs.len(), hold_out, &config.holdout);
    let (mut evaluation, mut trained) = (Evaluation::default(), Vec::new());
    if !held_out.is_empty() {
        progress("the same on the training runs, evaluated on the others");
        (evaluation, trained) = out_of_sample(given, runs, effort, &held_out)?;
    }
    let gap = gap(&evaluation.compared, &config.holdout);
    let touched = touched(&evaluation.compared, &config.holdout);
    Ok(Some(Investigation {
        verdict: verdict(
            context,
            &named,
            [p_value, p_value_after],
            (!evaluation.compared.is_empty()).then_some((&gap, touched.as_ref())),
        ),
        gap,
        touched,
        findings,
        named,
        candidates,
        standouts,
        whiteness,
        nuisances,
        trained,
        evidence,
        p_value,
        p_value_after,
        p_value_held_out: evaluation.p_values,
        journeys: evaluation.journeys,
        compared: evaluation.compared,
        held_out,
    }))
}

/// What the training runs alone give, and how that does on the others.
fn out_of_sample(
    given: &Context<'_>,
    runs: &[Run],
    effort: EffortReading,
    held_out: &[usize],
) -> Result<(Evaluation, Vec<Named>), EffectError> {
    let of = |tested: bool| -> Vec<Run> {
        let wanted = runs.iter().enumerate().filter(|(i, _)| held_out.contains(i) == tested);
        wanted.map(|(_, run)| run.clone()).collect()
    };
    let training = of(false);
    let Some(found) = analyse(given, &training, effort) else {
        return Ok((Evaluation::default(), Vec::new()));
    };
    let context = &Context { conditions: found.conditions, ..*given };
    let (trained, _) = all_named(&found, context, &training);
    Ok((evaluate(context, &found, &trained, &of(true))?, trained))
}

/// What was found, by name, and what is but a candidate; nothing of it lies beyond the ends of the line.
fn all_named(findings: &Findings, context: &Context<'_>, runs: &[Run]) -> (Vec<Named>, Vec<Named>) {
    let names: Vec<String> = runs.iter().map(|run| run.name.clone()).collect();
    let limit = findings.limit(&context.config.search);
    let mut all = named(&findings.terms, limit, &findings.naming(context, &names));
    // What no board takes is no effect of a train; the residuals still say that something is left.
    all.retain(|one| one.effect.check().is_ok());
    for one in &mut all {
        on_line(one, context.surroundings.length_m);
    }
    let trials = trials(context, &findings.rows, &findings.calibrated, &findings.terms, runs);
    for one in &mut all {
        one.tried(one.term.and_then(|term| trials.get(term)).cloned().flatten());
    }
    let stood = |one: &Named| one.trial.as_ref().is_none_or(|trial| trial.is_stood(context.config));
    all.into_iter().partition(stood)
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

/// `gap`: none where nothing could be compared.
fn verdict(
    context: &Context<'_>,
    named: &[Named],
    [p_value, p_value_after]: [f64; 2],
    gap: Option<(&Share, Option<&Touched>)>,
) -> Verdict {
    let config = &context.config.holdout;
    // The wheel of one run is put right before the gap is measured.
    let of_one_run = |n: &Named| matches!(n.effect, Effect::SpeedScale(_)) && !n.runs.is_empty();
    let unknown = |n: &Named| matches!(n.effect, Effect::Unknown(_));
    if named.is_empty() {
        return if p_value < context.config.evidence.sure { Verdict::Unknown } else { Verdict::NoGap };
    }
    if named.iter().all(of_one_run) {
        return Verdict::Explained;
    }
    if named.iter().all(unknown) {
        return Verdict::Unknown;
    }
    let removed = |(gap, touched): (&Share, Option<&Touched>)| {
        let share = touched.map_or(gap, |touched| &touched.share);
        let most = share.removed.is_some_and(|share| share >= config.explained);
        // The noise floor may be too low; where nothing is left in the residuals and the hold-out runs have what was foreseen, that is all.
        let foreseen =
            |multiple: f64, low: f64| low > 0.0 && multiple < config.foreseen && multiple * config.foreseen > 1.0;
        let nothing_left = p_value_after >= context.config.evidence.significant;
        let all = touched.and_then(|touched| touched.multiple).is_some_and(|(one, (low, _))| foreseen(one, low));
        (most || nothing_left && all) && !gap.is_worse(config)
    };
    if gap.is_some_and(removed) && !named.iter().any(unknown) { Verdict::Explained } else { Verdict::PartlyExplained }
}
