//! `gap.json`: the answer for programs.

use crate::answer::{notes::notes, rivals::MEANING, whole::Answer};
use crate::holdout::journey::{Spread, Summary};
use crate::holdout::share::Share;
use crate::levels::{NotCompared, Standout};
use crate::named::Named;
use crate::noise::whiteness::Whiteness;
use crate::readings::nuisances::Nuisance;
use serde_json::{Value, json};

/// Energy cannot be measured without an effort column.
pub const NO_ENERGY: &str = "cannot be measured: the logs have no effort column, or no hold-out run that powers";

const NOTHING_COMPARED: &str = "nothing was compared";
const NOT_TOUCHED: &str = "absent: the effects move hardly a speed";
const NOT_HELD_OUT: &str =
    "no run was held out, the other runs do not show it, it acts in some runs, in readings, or on hardly a speed";
const NOT_TRIED: &str = "it shows in differences between runs, in a lag or in a single run";
const IN_HALVES: &str = "as for `halves`, and for limits and wheels, which are tried in halves alone";
const NO_ROWS: &str = "no interval has a residual";

/// What stands in `gap.json`: path, unit, meaning, when it is null; `absent: ..` says when the key is not there.
pub const FIELDS: &[[&str; 4]] = &[
    ["dataset", "", "where the runs come from", ""],
    ["runs", "", "runs that were used", ""],
    ["runs_left_out", "", "logs that could not be used", ""],
    ["diagnosis.*", "", "as `rundown check --json` prints it", "the logs were taken as recorded"],
    ["verdict", "", "`no_gap`, `candidate`, `unknown`, `partly_explained` or `explained`", ""],
    ["nuisances[].name", "", "what is wrong with the readings of all runs alike", ""],
    ["nuisances[].unit", "", "unit of its value", ""],
    ["nuisances[].value", "as `unit`", "how much", ""],
    ["nuisances[].sd", "as `unit`", "its standard deviation", ""],
    ["nuisances[].interval_95[]", "as `unit`", "ends of its 95 % interval", ""],
    ["nuisances[].told", "", "whether it is beyond doubt", ""],
    ["nuisances[].ambiguous_with[]", "", "effects that it is confounded with", ""],
    [
        "gradient_errors_permille",
        "permille",
        "standard deviation of what the described gradients are off by at most places: effects are looked for beside it",
        "most places show none",
    ],
    ["effects[].name", "", "the effect", ""],
    ["effects[].from_m", "m", "begin of its section", "it acts everywhere"],
    ["effects[].to_m", "m", "end of its section", "it acts everywhere"],
    ["effects[].parameters.*", "as `rundown gap --explain NAME` says", "its parameters", ""],
    ["effects[].intervals_95.*", "as the parameter", "ends of their 95 % intervals", ""],
    ["effects[].confidence", "1", "how sure its name is: its share among rivals, chance and halves that differ", ""],
    ["effects[].ambiguous_with[]", "", "effects that it is not distinguishable from", ""],
    [
        "effects[].or_else",
        "",
        "what it may be that is no effect of a train",
        "nothing is known that would look the same",
    ],
    ["effects[].would_separate[]", "", "data that would separate them", "there is no rival"],
    ["effects[].runs[]", "", "runs in which it acts; empty: in all", ""],
    ["effects[].coordinate", "", "what it depends on, where no kind explains it", "a kind explains it"],
    ["effects[].gain", "", "penalised likelihood that it gains", ""],
    ["effects[].rivals[].name", "", "another effect that was tried", ""],
    ["effects[].rivals[].worse", "", "by how much it fits worse, see `rivals`", ""],
    ["effects[].table.*", "", "values over the coordinate", "absent: a kind explains it"],
    [
        "effects[].per_run[].*",
        "",
        "`run`, `value` and `sd` of an effect that differs from run to run",
        "absent: it does not",
    ],
    ["effects[].trial.p_value", "1", "how often chance alone makes as much of it", IN_HALVES],
    [
        "effects[].trial.p_value_as_described",
        "1",
        "the same if the described gradients are right; `p_value` is beside errors that they may have",
        "it has not stood its trial anyhow, errors are sure or hardly possible, it is a gradient, or as for `p_value`",
    ],
    ["effects[].trial.halves[].by", "", "how the runs are halved: `turn`, `date`, `direction`, `unit`", NOT_TRIED],
    ["effects[].trial.halves[].halves[]", "", "what the halves are", NOT_TRIED],
    ["effects[].trial.halves[].multiples[].multiple", "1", "how large it is in each half, over all runs", NOT_TRIED],
    ["effects[].trial.halves[].multiples[].sd", "1", "its standard deviation", NOT_TRIED],
    [
        "effects[].held_out.multiple",
        "1",
        "how many times as much as it foresees the hold-out runs have, beside the other effects",
        NOT_HELD_OUT,
    ],
    ["effects[].held_out.interval_95[]", "1", "ends of the 95 % interval of that", NOT_HELD_OUT],
    [
        "candidates[].*",
        "",
        "as an effect: what fits, but does not repeat, or acts in too few runs; not in the model",
        "there is none",
    ],
    ["not_compared[].by", "", "what could not be compared with each other: `unit`, `driver`, `day`", ""],
    ["not_compared[].why", "", "why", ""],
    ["standouts[].by", "", "by what runs are grouped: `unit`, `driver`, `day`", ""],
    ["standouts[].of", "", "the unit, driver or date whose runs differ from the others", ""],
    ["standouts[].more", "", "of what: `resistance` in coasting, or `effort` for the same motion", ""],
    ["standouts[].runs", "", "its runs", ""],
    ["standouts[].share", "1", "what it has beyond the others, of the believed resistance or of the effort", ""],
    ["standouts[].share_sd", "1", "the standard deviation of that", ""],
    [
        "standouts[].described",
        "1",
        "its resistance in coasting beyond the described one, of that, beside the effects of places",
        "",
    ],
    ["standouts[].other.of", "", "the other one, where there are only two", "without `other`: there are more than two"],
    ["standouts[].other.described", "1", "its resistance in coasting beyond the described one, of that", ""],
    ["standouts[].p_value", "1", "how often chance makes such a difference somewhere", ""],
    [
        "whiteness.coasting",
        "1",
        "standard deviation of the standardised residuals in coasting: 1 where the noise fits",
        "too few rows",
    ],
    ["whiteness.powering", "1", "the same while powering", "too few rows"],
    ["whiteness.braking", "1", "the same while braking", "too few rows"],
    ["whiteness.neighbours", "1", "correlation of neighbouring residuals: 0 where the noise fits", "too few rows"],
    [
        "whiteness.beyond_3",
        "1",
        "share of the residuals beyond three standard deviations: 0.0027 where they are normal",
        "too few rows",
    ],
    ["gap.what", "", "what is compared", ""],
    ["gap.unit", "", "unit of `before`, `after` and `noise_floor`", ""],
    [
        "gap.before",
        "m/s",
        "root mean square with the believed model, each speed weighed by how well a perfect model foresees it",
        NOTHING_COMPARED,
    ],
    ["gap.after", "m/s", "the same with the effects", NOTHING_COMPARED],
    ["gap.noise_floor", "m/s", "what noise alone leaves", NOTHING_COMPARED],
    ["gap.removed_share", "1", "share of the gap above the floor that is gone", "there was nothing to remove"],
    ["gap.removed_share_95[]", "1", "its 95 % interval", "too few runs, or nothing to remove"],
    ["gap.touched.speeds", "", "speeds that the effects move", NOT_TOUCHED],
    ["gap.touched.before", "m/s", "as `gap.before`, of these alone", NOT_TOUCHED],
    ["gap.touched.after", "m/s", "as `gap.after`, of these alone", NOT_TOUCHED],
    ["gap.touched.noise_floor", "m/s", "as `gap.noise_floor`, of these alone", NOT_TOUCHED],
    ["gap.touched.removed_share", "1", "as `gap.removed_share`, of these alone", "there was nothing to remove"],
    ["gap.touched.removed_share_95[]", "1", "its 95 % interval", "too few runs"],
    ["gap.touched.multiple", "1", "how many times as much as the effects foresee is there", "too few runs"],
    ["gap.touched.multiple_95[]", "1", "its 95 % interval", "too few runs"],
    ["gap.worse_than_before", "", "whether the effects make it worse", ""],
    ["gap.held_out_runs", "", "hold-out runs", ""],
    ["gap.p_value_before", "1", "of the residuals without a gap", NO_ROWS],
    ["gap.p_value_after", "1", "of the residuals with the effects", NO_ROWS],
    ["gap.p_value_held_out.before", "1", "the same on the hold-out runs alone", NOTHING_COMPARED],
    ["gap.p_value_held_out.after", "1", "the same on the hold-out runs alone", NOTHING_COMPARED],
    [
        "running_time.*",
        "",
        "error of the simulated running time; `what` and `unit` say of what, `why_not` why there is none",
        "it is not known",
    ],
    [
        "energy.*",
        "",
        "error of the simulated energy; `what` and `unit` say of what, `why_not` why there is none",
        "it is not known",
    ],
    ["p_value", "1", "as `gap.p_value_before`", NO_ROWS],
    ["evidence[].coordinate", "", "a coordinate over which the residuals may differ", ""],
    ["evidence[].score", "", "how much they do", ""],
    ["evidence[].at", "as the coordinate", "where most", "nowhere"],
    ["evidence[].p_value", "1", "of that score without a gap", ""],
    ["rivals", "", "what `worse` of a rival means", ""],
    ["caveats[]", "", "what the answer rests on", ""],
    [
        "headwind.*",
        "",
        "residuals with and without a measured headwind; `what` and `unit` say more",
        "absent: no log has a headwind",
    ],
    ["innovations.what", "", "what is compared", "absent: no hold-out run was replayed"],
    ["innovations.unit", "", "unit of the next two", "absent: no hold-out run was replayed"],
    ["innovations.before", "m/s", "with the believed model", "absent: no hold-out run was replayed"],
    ["innovations.after", "m/s", "with the effects", "absent: no hold-out run was replayed"],
];

impl Answer {
    /// The object.
    pub fn json(&self) -> Value {
        let (found, input) = (&self.found, &self.input);
        let mut json = json!({
            "dataset": input.dataset,
            "runs": input.runs.len(),
            "runs_left_out": input.left_out,
            "diagnosis": input.check,
            "verdict": found.verdict.name(),
            "nuisances": found.nuisances.iter().map(Nuisance::json).collect::<Vec<_>>(),
            "gradient_errors_permille": found.findings.gradient_errors_permille(),
            "effects": self.effects(),
            "candidates": found.candidates.iter().map(|one| one.json()).collect::<Vec<_>>(),
            "not_compared": found.findings.differing.not_compared.iter().map(NotCompared::json).collect::<Vec<_>>(),
            "standouts": found.findings.differing.standouts.iter().map(Standout::json).collect::<Vec<_>>(),
            "whiteness": found.whiteness.as_ref().map(Whiteness::json),
            "gap": self.gap(),
            "running_time": self.running_time(),
            "energy": self.energy(),
            "p_value": self.of_rows(found.p_value),
            "evidence": found.evidence.iter().map(|e| json!({
                "coordinate": e.along.name(),
                "score": e.score,
                "at": e.at,
                "p_value": e.p_value,
            })).collect::<Vec<_>>(),
            "rivals": MEANING,
            "caveats": notes(self),
        });
        if let Some(wind) = &found.findings.headwind {
            json["headwind"] = json!({
                "what": "root mean square of the residuals of intervals with a measured headwind, in still air and at the air speed; share of that wind that the residuals fit",
                "unit": "N/kg",
                "intervals": wind.rows,
                "before": wind.before_n_per_kg,
                "after": wind.after_n_per_kg,
                "scale": wind.scale.0,
                "scale_95": wind.scale.1,
                "agrees": wind.agrees(),
            });
        }
        if let Some(found) = &self.innovations {
            json["innovations"] = json!({
                "what": "root mean square of the speed innovation of the estimator, hold-out runs",
                "unit": "m/s",
                "before": found.before_mps,
                "after": found.after_mps,
            });
        }
        json
    }

    /// Without rows there is nothing to flip.
    fn of_rows(&self, p_value: f64) -> Option<f64> {
        (!self.found.findings.rows.is_empty()).then_some(p_value)
    }

    fn gap(&self) -> Value {
        let found = &self.found;
        let touched = found.touched.as_ref().map(|touched| {
            let mut json = of_share(Some(&touched.share));
            json["speeds"] = json!(touched.count);
            json["multiple"] = json!(touched.multiple.map(|(value, _)| value));
            json["multiple_95"] = json!(touched.multiple.map(|(_, ends)| ends));
            json
        });
        let held_out = found.p_value_held_out.map(|[before, after]| json!({ "before": before, "after": after }));
        let mut json = of_share((!found.compared.is_empty()).then_some(&found.gap));
        json["what"] = json!("simulated against measured speed, hold-out runs");
        json["unit"] = json!("m/s");
        json["touched"] = json!(touched);
        json["worse_than_before"] = json!(found.gap.is_worse(self.holdout()));
        json["held_out_runs"] = json!(found.held_out.len());
        json["p_value_before"] = json!(self.of_rows(found.p_value));
        json["p_value_after"] = json!(self.of_rows(found.p_value_after));
        json["p_value_held_out"] = json!(held_out);
        json
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

    fn running_time(&self) -> Value {
        let Some(summary) = self.times() else {
            return json!({ "why_not": "no window of a hold-out run could be simulated" });
        };
        let mut json = of_summary(&summary, "s");
        let journeys = &self.found.journeys;
        json["what"] = json!(
            "time to cover the distance of each window of up to 120 s from its measured first speed, driven by the recorded effort; simulated less measured, summed over each hold-out run"
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
            "energy at the wheel that the model needs on the measured speeds while the train powers, less what the effort column says, for each hold-out run"
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
    let mut json = of_share(Some(&summary.share));
    json["unit"] = json!(unit);
    json["runs"] = json!(summary.share.runs);
    json["measured"] = json!(summary.measured);
    json["error_before"] = spread(&summary.before);
    json["error_after"] = spread(&summary.after);
    json
}

/// `None`: nothing was compared.
fn of_share(share: Option<&Share>) -> Value {
    json!({
        "before": share.map(|share| share.before),
        "after": share.map(|share| share.after),
        "noise_floor": share.map(|share| share.floor),
        "removed_share": share.and_then(|share| share.removed),
        "removed_share_95": share.and_then(|share| share.removed_95),
    })
}
