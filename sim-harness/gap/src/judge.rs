//! The model that the training runs gave, on the runs that took no part: speeds, running times, energy, and whether a gap is left.

use super::analysis::{Findings, Surroundings, apply};
use super::calibrate::Calibrated;
use super::evidence::evidence;
use super::forward::{Compared, effects, resisted};
use super::journey::{Journey, journey};
use super::named::Named;
use super::pulled::pulled;
use super::rows::{Believed, Row};
use super::runs::Run;
use super::travelled::travelled;
use super::workflow::repaired;
use rundown::model::effects::{Effect, Effects};

/// With fewer runs the signs can be flipped in too few ways to tell chance.
const LEAST_FLIPPED: usize = 8;

/// What the held-out runs say.
#[derive(Default)]
pub(super) struct Judged {
    /// Speeds.
    pub compared: Vec<Compared>,
    /// Running times and energy.
    pub journeys: Vec<Journey>,
    /// Probability of the residuals without a gap, before and after; none with too few runs.
    pub p_values: Option<[f64; 2]>,
}

/// Judges the effects that `found` has by name on other runs.
pub(super) fn judge(
    believed: Believed<'_>,
    surroundings: &Surroundings,
    found: &Findings,
    trained: &[Named],
    tested: &[Run],
) -> Judged {
    // Which of the held-out runs an effect of some runs acts in, only the run itself can say: the choice that fits it better, one bit a run.
    let (always, sometimes): (Vec<Named>, Vec<Named>) =
        trained.iter().cloned().partition(|named| named.runs.is_empty());
    let without = effects(&always);
    let with = effects(&always.iter().chain(&sometimes).cloned().collect::<Vec<_>>());
    let (mut rows, pulls) = apply(believed, surroundings, found, tested);
    if found.rows.is_empty() {
        // The noise of forces is not known: what a perfect model would leave could not be told.
        rows.clear();
    }
    let compare = |effects: &Effects| {
        let mut compared = resisted(&believed, found, effects, &rows);
        if found.limit().is_some() {
            for (run, pulls) in tested.iter().zip(&pulls) {
                compared.extend(pulled(&believed, run.direction, effects, pulls, 10.0));
            }
        }
        compared
    };
    let kinematic = |named: &Named| matches!(named.effect, Effect::SpeedScale(_) | Effect::LocationLag(_));
    let way: Vec<Compared> = if trained.iter().any(kinematic) {
        let of_run = |(i, run)| travelled(i, run, &found.readings);
        tested.iter().enumerate().flat_map(of_run).collect()
    } else {
        Vec::new()
    };
    let plain = compare(&without);
    let mut acts = vec![false; tested.len()];
    let mut compared = if sometimes.is_empty() {
        plain
    } else {
        let acting = compare(&with);
        acts = acting_in(&plain, &acting, tested.len());
        let chosen = plain.into_iter().zip(acting);
        chosen.map(|(plain, acting)| if acts[plain.run] { acting } else { plain }).collect()
    };
    compared.extend(way);
    let of_runs = rows.chunk_by(|a, b| a.interval.run == b.interval.run);
    let journeys = of_runs.filter_map(|rows| {
        let acts = acts[rows.first()?.interval.run];
        journey(&believed, found, if acts { &with } else { &without }, rows)
    });
    // By the names of the held-out runs.
    let renamed: Vec<Named> = always
        .iter()
        .cloned()
        .chain(sometimes.into_iter().filter_map(|mut one| {
            let acting = tested.iter().zip(&acts).filter(|(_, acts)| **acts);
            one.runs = acting.map(|(run, _)| run.name.clone()).collect();
            // No name at all would stand for all runs.
            (!one.runs.is_empty()).then_some(one)
        }))
        .collect();
    Judged {
        journeys: journeys.collect(),
        p_values: p_values(believed, surroundings, found, &renamed, tested, &rows),
        compared,
    }
}

/// In which runs the effects of some runs act.
fn acting_in(plain: &[Compared], acting: &[Compared], runs: usize) -> Vec<bool> {
    let of_run = |compared: &[Compared], run: usize, of: fn(&Compared) -> f64| {
        let of_run = compared.iter().filter(|c| c.run == run);
        of_run.map(of).sum::<f64>()
    };
    let error = |compared: &[Compared], run| of_run(compared, run, |c| c.after_mps * c.after_mps);
    // A driver may by chance ask for what a limit leaves: where that foresees the pulls as well as a share of his own, the limit acts.
    let chance = |run| of_run(plain, run, |c| if c.time_s == 0.0 { c.floor } else { 0.0 });
    (0..runs).map(|run| error(acting, run) < error(plain, run) + chance(run)).collect()
}

/// Is there a gap in the held-out runs, and is there one left?
fn p_values(
    believed: Believed<'_>,
    surroundings: &Surroundings,
    found: &Findings,
    named: &[Named],
    tested: &[Run],
    rows: &[Row],
) -> Option<[f64; 2]> {
    let with_rows = rows.chunk_by(|a, b| a.interval.run == b.interval.run);
    if with_rows.count() < LEAST_FLIPPED {
        return None;
    }
    let context = found.context(believed, surroundings);
    let calibrated = Calibrated { spread: vec![1.0; rows.len()], ..found.calibrated.clone() };
    let p_value = |rows: &[Row]| evidence(&context, rows, &calibrated).1;
    let left = repaired(&believed, named, tested, rows);
    Some([p_value(rows), p_value(&left)])
}
