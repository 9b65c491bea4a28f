//! The five steps, in their order: is there a gap, where, which effect, add it, show the gap shrink.
//!
//! Names and sizes come from all runs. How much of the gap they remove comes from an analysis that saw only the training runs, judged on the others.

use super::analysis::{Findings, Surroundings, analyse};
use super::evidence::{Evidence, evidence};
use super::explained::explained;
use super::forward::{Compared, Gap, effects};
use super::journey::Journey;
use super::judge::{Judged, judge};
use super::named::{Named, named};
use super::notes::worse;
use super::on_line::on_line;
use super::own_wind::own_wind;
use super::rows::{Believed, Row};
use super::runs::Run;
use super::wheels::{put_right, wheels};
use rundown::model::effects::{Effect, Effects};

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
    /// The same of what is left with the effects in the model, on the very runs that the effects were found in.
    pub p_value_after: f64,
    /// Both on the held-out runs, with the effects that the training runs tell; none with too few runs or rows.
    pub p_value_held_out: Option<[f64; 2]>,
    /// Running time and energy of the held-out runs.
    pub journeys: Vec<Journey>,
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
/// Below this p-value there is a gap, named or not: that of fewer than one in a thousand flips of signs.
const SURE_GAP: f64 = 0.0015;

/// Fewer runs are no ground to find an effect in.
pub const LEAST_TRAINING: usize = 5;
/// The most runs that can be held out.
pub fn most_held_out(runs: usize) -> usize {
    runs.saturating_sub(LEAST_TRAINING)
}

/// Indices of `count` runs, evenly spread; at most [`most_held_out`].
pub fn held_out(runs: usize, count: Option<usize>) -> Vec<usize> {
    let count = count.unwrap_or(runs / HELD_OUT).min(most_held_out(runs));
    (0..count).map(|i| (2 * i + 1) * runs / (2 * count)).collect()
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
    let righted: Vec<Run>;
    let runs = if wheels.is_empty() {
        runs
    } else {
        righted = put_right(runs, &wheels);
        &righted
    };
    story("where and what: all runs");
    let findings = analyse(believed, surroundings, runs, &mut story)?;
    let mut named = all_named(&findings, surroundings, runs);
    named.extend(wheels.iter().map(|wheel| wheel.named(runs)));
    named.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let with = effects(&named);
    for one in &mut named {
        if let Effect::RunWind(wind) = &one.effect {
            one.per_run = winds(&believed, &findings, &with, wind.sd_mps, runs);
        }
    }
    let context = findings.context(believed, surroundings);
    story("is it chance: signs of whole runs flipped");
    let (evidence, p_value) = evidence(&context, &findings.rows, &findings.calibrated);
    let rows = repaired(&believed, &named, runs, &findings.rows);
    let (_, p_value_after) = super::evidence::evidence(&context, &rows, &findings.calibrated);
    let held_out = held_out(runs.len(), hold_out);
    let of = |tested: bool| -> Vec<Run> {
        let runs = runs.iter().enumerate();
        let wanted = runs.filter(|(i, _)| held_out.contains(i) == tested);
        wanted.map(|(_, run)| run.clone()).collect()
    };
    let (tested, training) = (of(true), of(false));
    let mut judged = Judged::default();
    let mut trained = Vec::new();
    if !tested.is_empty() {
        story("the same on the training runs, judged on the others");
        if let Some(found) = analyse(believed, surroundings, &training, |_| ()) {
            trained = all_named(&found, surroundings, &training);
            judged = judge(believed, surroundings, &found, &trained, &tested);
        }
    }
    Some(Investigation {
        gap: Gap::of(&judged.compared),
        findings,
        named,
        trained,
        evidence,
        p_value,
        p_value_after,
        p_value_held_out: judged.p_values,
        journeys: judged.journeys,
        compared: judged.compared,
        held_out,
    })
}

/// What was found, by name; nothing of it lies beyond the ends of the line.
fn all_named(findings: &Findings, surroundings: &Surroundings, runs: &[Run]) -> Vec<Named> {
    let mut all = named(findings, surroundings, runs);
    // What no board takes is no effect of a train; the residuals still say that something is left.
    all.retain(|one| one.effect.check().is_ok());
    for one in &mut all {
        on_line(one, surroundings.length_m);
    }
    all
}

/// The rows with what the effects leave of their residuals.
pub(super) fn repaired(believed: &Believed<'_>, named: &[Named], runs: &[Run], rows: &[Row]) -> Vec<Row> {
    let left =
        |(row, explained): (&Row, f64)| Row { residual_n_per_kg: row.residual_n_per_kg - explained, ..row.clone() };
    let explained = explained(believed, named, runs, rows);
    rows.iter().zip(explained).map(left).collect()
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

impl Investigation {
    /// One word.
    pub fn verdict(&self) -> &'static str {
        // The wheel of one run is put right before the gap is measured.
        let of_one_run = |n: &Named| n.effect.name() == "speed_scale" && !n.runs.is_empty();
        if self.named.is_empty() {
            if self.p_value < SURE_GAP { "unknown" } else { "no_gap" }
        } else if self.named.iter().all(of_one_run) {
            "explained"
        } else if self.named.iter().all(|n| n.effect.name() == "unknown") {
            "unknown"
        } else if self.compared.is_empty()
            || self.gap.removed().is_none_or(|share| share < EXPLAINED)
            || worse(&self.gap)
            || self.named.iter().any(|n| n.effect.name() == "unknown")
        {
            "partly_explained"
        } else {
            "explained"
        }
    }
}
