//! The five steps, in their order: is there a gap, where, which effect, add it, show the gap shrink.
//!
//! Names and sizes come from all runs. How much of the gap they remove comes from an analysis that saw only the training runs, judged on the others.

use super::analysis::{Findings, Surroundings, analyse, apply};
use super::evidence::{Evidence, evidence};
use super::forward::{Compared, Gap, effects, pulled, resisted};
use super::named::{Named, named};
use super::own_wind::own_wind;
use super::rows::Believed;
use super::runs::Run;
use super::terms::Context;
use super::travelled::travelled;
use super::wheels::{put_right, wheels};
use rundown::effects::{Effect, Effects};
use serde_json::{Value, json};

/// What came of it.
#[derive(Clone, Debug)]
pub struct Investigation {
    /// Analysis of all runs.
    pub findings: Findings,
    /// What was found, by name, largest first.
    pub named: Vec<Named>,
    /// What the same analysis of the training runs alone found.
    pub trained: Vec<Named>,
    /// Along what the residuals of the believed model vary.
    pub evidence: Vec<Evidence>,
    /// Probability of such evidence without a gap.
    pub p_value: f64,
    /// Simulated against measured speed on the held-out runs.
    pub compared: Vec<Compared>,
    /// The same in numbers.
    pub gap: Gap,
    /// Indices of the held-out runs.
    pub held_out: Vec<usize>,
}

/// Share of the runs that are held out unless the caller says how many.
const HELD_OUT: usize = 5;
/// A gap of which less was removed is explained only in part.
const EXPLAINED: f64 = 0.7;

/// Indices of `count` runs, evenly spread.
pub fn held_out(runs: usize, count: Option<usize>) -> Vec<usize> {
    let count = count.unwrap_or(runs / HELD_OUT).min(runs.saturating_sub(2));
    (0..count)
        .map(|i| (2 * i + 1) * runs / (2 * count))
        .collect()
}

/// Investigates. `None`: no run has enough to analyse.
pub fn investigate(
    believed: Believed<'_>,
    surroundings: &Surroundings,
    runs: &[Run],
    hold_out: Option<usize>,
    mut story: impl FnMut(&str),
) -> Option<Investigation> {
    story("wheels: each run against the others");
    let wheels = wheels(runs, surroundings);
    let runs = put_right(runs, &wheels);
    let runs = runs.as_slice();
    story("where and what: all runs");
    let findings = analyse(believed, surroundings, runs, &mut story)?;
    let mut named = named(&findings, surroundings, runs);
    named.extend(wheels.iter().map(|wheel| wheel.named(runs)));
    named.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let with = effects(&named);
    for one in &mut named {
        if let Effect::RunWind(wind) = &one.effect {
            one.per_run = winds(&believed, &findings, &with, wind.sd_mps, runs);
        }
    }
    let context = Context {
        believed,
        curves: &surroundings.curves,
        temperature_c: findings.temperature_c,
        first_day: findings.first_day,
        period_days: findings.period_days,
    };
    story("is it chance: signs of whole runs flipped");
    let (evidence, p_value) = evidence(&context, &findings.rows, &findings.calibrated);
    let held_out = held_out(runs.len(), hold_out);
    let (tested, training): (Vec<_>, Vec<_>) = runs
        .iter()
        .cloned()
        .enumerate()
        .partition(|(i, _)| held_out.contains(i));
    let (tested, training): (Vec<Run>, Vec<Run>) = (
        tested.into_iter().map(|(_, run)| run).collect(),
        training.into_iter().map(|(_, run)| run).collect(),
    );
    story("the same on the training runs, judged on the others");
    let (trained, compared) = match analyse(believed, surroundings, &training, |_| ()) {
        Some(found) => {
            let trained = super::named::named(&found, surroundings, &training);
            let compared = compare(believed, surroundings, &found, &trained, &tested);
            (trained, compared)
        }
        None => (Vec::new(), Vec::new()),
    };
    Some(Investigation {
        gap: Gap::of(&compared),
        findings,
        named,
        trained,
        evidence,
        p_value,
        compared,
        held_out,
    })
}

/// Each run's wind in the `up` direction, with its standard deviation.
fn winds(
    believed: &Believed<'_>,
    findings: &Findings,
    effects: &Effects,
    spread_mps: f64,
    runs: &[Run],
) -> Vec<(String, f64, f64)> {
    let noise = &findings.calibrated.noise;
    let of_run = |(i, run): (usize, &Run)| {
        let rows = findings.rows.iter().filter(|row| row.interval.run == i);
        let (headwind_mps, sd) = own_wind(rows, believed, effects, noise, spread_mps);
        (run.name.clone(), run.direction.sign() * headwind_mps, sd)
    };
    runs.iter().enumerate().map(of_run).collect()
}

fn compare(
    believed: Believed<'_>,
    surroundings: &Surroundings,
    found: &Findings,
    trained: &[Named],
    tested: &[Run],
) -> Vec<Compared> {
    // Which of the held-out runs an effect of some runs acts in, only the run itself can say: the choice that fits it better, one bit a run.
    let (always, sometimes): (Vec<Named>, Vec<Named>) = trained
        .iter()
        .cloned()
        .partition(|named| named.runs.is_empty());
    let without = effects(&always);
    let with = effects(&always.iter().chain(&sometimes).cloned().collect::<Vec<_>>());
    let (rows, pulls) = apply(believed, surroundings, found, tested);
    let judged = |effects: &Effects| {
        let mut compared = resisted(&believed, found, effects, &rows);
        if found.limit.is_some() {
            for (run, pulls) in tested.iter().zip(&pulls) {
                compared.extend(pulled(&believed, run.direction, effects, pulls, 10.0));
            }
        }
        compared
    };
    let kinematic =
        |named: &Named| matches!(named.effect, Effect::SpeedScale(_) | Effect::LocationLag(_));
    let way: Vec<Compared> = if trained.iter().any(kinematic) {
        let of_run = |(i, run)| travelled(i, run, &found.readings);
        tested.iter().enumerate().flat_map(of_run).collect()
    } else {
        Vec::new()
    };
    let mut plain = judged(&without);
    if sometimes.is_empty() {
        plain.extend(way);
        return plain;
    }
    let acting = judged(&with);
    let of_run = |compared: &[Compared], run: usize, of: fn(&Compared) -> f64| {
        let of_run = compared.iter().filter(|c| c.run == run);
        of_run.map(of).sum::<f64>()
    };
    let error = |compared: &[Compared], run| of_run(compared, run, |c| c.after_mps * c.after_mps);
    // A driver may by chance ask for what a limit leaves: where that foresees the pulls as well as a share of his own, the limit acts.
    let chance = |run| of_run(&plain, run, |c| if c.time_s == 0.0 { c.floor } else { 0.0 });
    let better: Vec<bool> = (0..tested.len())
        .map(|run| error(&acting, run) < error(&plain, run) + chance(run))
        .collect();
    let chosen = plain.into_iter().zip(acting);
    chosen
        .map(|(plain, acting)| if better[plain.run] { acting } else { plain })
        .chain(way)
        .collect()
}

impl Investigation {
    /// One word.
    pub fn verdict(&self) -> &'static str {
        // The wheel of one run is put right before the gap is measured.
        let of_one_run = |n: &Named| n.effect.name() == "speed_scale" && !n.runs.is_empty();
        if self.named.is_empty() {
            "no_gap"
        } else if self.named.iter().all(of_one_run) {
            "explained"
        } else if self.named.iter().all(|n| n.effect.name() == "unknown") {
            "unknown"
        } else if self.compared.is_empty()
            || self.gap.removed_share < EXPLAINED
            || self.named.iter().any(|n| n.effect.name() == "unknown")
        {
            "partly_explained"
        } else {
            "explained"
        }
    }

    /// `gap.json`.
    pub fn json(&self, dataset: &str) -> Value {
        let gap = &self.gap;
        json!({
            "dataset": dataset,
            "verdict": self.verdict(),
            "effects": self.named.iter().map(Named::json).collect::<Vec<_>>(),
            "gap": {
                "what": "simulated against measured speed, held-out runs",
                "unit": "m/s",
                "before": gap.before_mps,
                "after": gap.after_mps,
                "noise_floor": gap.floor_mps,
                "removed_share": gap.removed(),
                "held_out_runs": self.held_out.len(),
            },
            "p_value": self.p_value,
            "evidence": self.evidence.iter().map(|e| json!({
                "coordinate": e.coordinate,
                "score": e.score,
                "at": e.at,
                "p_value": e.p_value,
            })).collect::<Vec<_>>(),
        })
    }
}
