//! `gap.json`: the answer for programs.

use super::innovations::Innovations;
use super::journey::{Error, Spread, Summary};
use super::named::Named;
use super::notes::{notes, worse};
use super::rivals::{MEANING, Rival};
use super::workflow::Investigation;
use serde_json::{Value, json};

/// All that is told of a data set.
#[derive(Clone, Copy, Debug)]
pub struct Answer<'a> {
    /// What is doubtful about the described track, in sentences.
    pub about_track: &'a [String],
    /// Where the runs come from.
    pub dataset: &'a str,
    /// How many there were.
    pub runs: usize,
    /// How many logs could not be used.
    pub left_out: usize,
    /// What came of them.
    pub found: &'a Investigation,
    /// Rivals of each effect.
    pub rivals: &'a [Vec<Rival>],
    /// Of the on-board estimator on the held-out runs, if it had any.
    pub innovations: Option<Innovations>,
    /// How many effects the described train and track had already.
    pub described_effects: usize,
    /// Rotating mass of the believed train, kg: energy for each kg of it becomes energy.
    pub rotating_mass_kg: f64,
}

/// Energy cannot be told without an effort column.
pub const NO_ENERGY: &str = "cannot be measured: the logs have no effort column, or no held-out run that pulls";
const J_PER_KWH: f64 = 3.6e6;

impl Answer<'_> {
    /// The object.
    pub fn json(&self) -> Value {
        let found = self.found;
        let gap = &found.gap;
        // Without rows there is nothing to flip, and without speeds nothing to compare.
        let judged = !found.findings.rows.is_empty();
        let compared = |value: f64| (!found.compared.is_empty()).then_some(value);
        let mut json = json!({
            "dataset": self.dataset,
            "runs": self.runs,
            "runs_left_out": self.left_out,
            "verdict": found.verdict(),
            "effects": self.effects(),
            "gap": {
                "what": "simulated against measured speed, held-out runs",
                "unit": "m/s",
                "before": compared(gap.before_mps),
                "after": compared(gap.after_mps),
                "noise_floor": compared(gap.floor_mps),
                "removed_share": gap.removed(),
                "removed_share_95": gap.removed_95,
                "worse_than_before": worse(gap),
                "held_out_runs": found.held_out.len(),
                "p_value_before": judged.then_some(found.p_value),
                "p_value_after": judged.then_some(found.p_value_after),
                "p_value_held_out": found.p_value_held_out.map(|[before, after]| json!({ "before": before, "after": after })),
            },
            "running_time": self.running_time(),
            "energy": self.energy(),
            "p_value": judged.then_some(found.p_value),
            "evidence": found.evidence.iter().map(|e| json!({
                "coordinate": e.coordinate,
                "score": e.score,
                "at": e.at,
                "p_value": e.p_value,
            })).collect::<Vec<_>>(),
            "rivals": MEANING,
            "caveats": self.notes(),
        });
        if let Some(found) = &self.innovations {
            json["innovations"] = json!({
                "what": "root mean square of the speed innovation of the estimator, held-out runs",
                "unit": "m/s",
                "before": found.before_mps,
                "after": found.after_mps,
            });
        }
        json
    }

    /// What a reader must know beside the verdict, the weightiest first.
    pub fn notes(&self) -> Vec<String> {
        let mut all = notes(self.found, self.runs);
        all.extend_from_slice(self.about_track);
        if self.left_out > 0 {
            all.push(format!(
                "{} of {} logs could not be used; why stands on the screen.",
                self.left_out,
                self.left_out + self.runs
            ));
        }
        if self.described_effects > 0 {
            all.push(format!(
                "The described train and track had effects already ({}). They took no part: the analysis began without them, and what was found stands in their place.",
                self.described_effects
            ));
        }
        all
    }

    fn effects(&self) -> Vec<Value> {
        let one = |(i, one): (usize, &Named)| {
            let mut json = one.json();
            let rivals = self.rivals.get(i).map_or(&[][..], Vec::as_slice);
            let each = rivals.iter();
            json["rivals"] = each.map(|r| json!({ "name": r.name, "worse": r.worse })).collect();
            json
        };
        self.found.named.iter().enumerate().map(one).collect()
    }

    /// Errors of the running time, s. `None`: no window could be covered.
    pub fn times(&self) -> Option<Summary> {
        let of = |j: &super::journey::Journey| j.time_s;
        Summary::of(&self.found.journeys.iter().map(of).collect::<Vec<_>>())
    }

    /// Errors of the energy at the wheel, kWh. `None`: see [`NO_ENERGY`].
    pub fn energies(&self) -> Option<Summary> {
        let kwh = self.rotating_mass_kg / J_PER_KWH;
        let of = |j: &super::journey::Journey| {
            let error = j.energy_j_per_kg?;
            Some(Error {
                measured: kwh * error.measured,
                before: kwh * error.before,
                after: kwh * error.after,
                floor: kwh * kwh * error.floor,
            })
        };
        let errors: Vec<Error> = self.found.journeys.iter().filter_map(of).collect();
        Summary::of(&errors)
    }

    fn running_time(&self) -> Value {
        let Some(summary) = self.times() else {
            return json!({ "why_not": "no window of a held-out run could be simulated" });
        };
        let mut json = of_summary(&summary, "s");
        let journeys = &self.found.journeys;
        json["what"] = json!(
            "time to cover the way of each window of up to 120 s from its measured first speed, driven by the recorded effort; simulated less measured, summed over each held-out run"
        );
        json["windows"] = json!(journeys.iter().map(|j| j.windows).sum::<usize>());
        json["windows_not_covered"] = json!(journeys.iter().map(|j| j.stalled).sum::<usize>());
        json
    }

    fn energy(&self) -> Value {
        let Some(summary) = self.energies() else {
            return json!({ "why_not": NO_ENERGY });
        };
        let mut json = of_summary(&summary, "kWh");
        json["what"] = json!(
            "energy at the wheel that the model needs on the measured speeds while the train pulls, less what the effort column says, for each held-out run"
        );
        json
    }
}

fn of_summary(summary: &Summary, unit: &str) -> Value {
    let spread = |spread: &Spread| {
        json!({
            "mean": spread.mean,
            "quantiles_10_50_90": spread.quantiles,
            "percent": 100.0 * spread.relative,
        })
    };
    let share = &summary.share;
    json!({
        "unit": unit,
        "runs": share.runs,
        "measured": summary.measured,
        "error_before": spread(&summary.before),
        "error_after": spread(&summary.after),
        "before": share.before,
        "after": share.after,
        "noise_floor": share.floor,
        "removed_share": share.removed,
        "removed_share_95": share.removed_95,
    })
}
