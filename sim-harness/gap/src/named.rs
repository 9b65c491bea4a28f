//! A named effect with what is known of it.

use crate::columns::coordinate_name;
use crate::config::{GapConfig, HoldoutConfig};
use crate::holdout::share::{Multiple, is_denied};
use crate::trial::Trial;
use rundown::model::effects::{Effect, EffectKind, SpeedScale};
use rundown_check::figure::Figure;
use rundown_check::figure::HALF_95;
use serde_json::{Map, Value, json};

/// Name of a parameter with the ends of its 95 % interval.
pub type Interval95 = (&'static str, f64, f64);

/// A named effect with what is known of it.
#[derive(Clone, Debug)]
pub struct Named {
    /// As the board runs it.
    pub effect: Effect,
    /// 95 % intervals by parameter.
    pub intervals: Vec<Interval95>,
    /// Probability that the name is right, among the rivals and chance, as far as the runs repeat it.
    pub confidence: f64,
    /// Others that these data cannot separate from it.
    pub ambiguous_with: Vec<EffectKind>,
    /// What it may be that is no effect of a train.
    pub or_else: Option<&'static str>,
    /// What would separate them.
    pub would_separate: Vec<&'static str>,
    /// Runs in which it acts, if not in all.
    pub runs: Vec<String>,
    /// Each run's own value, where it differs from run to run, with its standard deviation.
    pub per_run: Vec<(String, f64, f64)>,
    /// Gain of log-likelihood.
    pub gain: f64,
    /// Which term of the model it is, if it is one.
    pub term: Option<usize>,
    /// Whether it is more than chance and repeats; none: it was not tried, since it shows in something else than the
    /// mean of the residuals.
    pub trial: Option<Trial>,
    /// How many times as much as it foresees the hold-out runs have, beside the other effects; none: nothing of it was
    /// compared.
    pub held_out: Option<Multiple>,
    /// The runs that are not held out do not show it by themselves.
    pub is_unshared: bool,
}

/// Probability that a gain of log-likelihood is not chance; more than `most` of it counts no more.
pub fn not_chance(gain: f64, most: f64) -> f64 {
    1.0 - f64::exp(-f64::min(gain, most) / 2.0)
}

/// A confidence beside further odds against the name.
pub fn beside(confidence: f64, odds: f64) -> f64 {
    1.0 / (1.0 / confidence + odds)
}

/// The 95 % interval of a parameter.
pub fn around(parameter: &'static str, value: f64, sd: f64) -> Interval95 {
    (parameter, value - HALF_95 * sd, value + HALF_95 * sd)
}

impl Named {
    /// An effect that acts in all runs and has no rivals.
    pub fn plain(effect: Effect, intervals: Vec<Interval95>, gain: f64, most_gain: f64) -> Self {
        Self {
            effect,
            intervals,
            confidence: not_chance(gain, most_gain),
            ambiguous_with: Vec::new(),
            or_else: None,
            would_separate: Vec::new(),
            runs: Vec::new(),
            per_run: Vec::new(),
            gain,
            term: None,
            trial: None,
            held_out: None,
            is_unshared: false,
        }
    }

    /// A wheel that the diagnosis of the logs found and put right.
    pub fn wheel(scale: &Figure, config: &GapConfig) -> Self {
        let effect = Effect::SpeedScale(SpeedScale { measured_over_true: scale.value });
        let sd = scale.sd.hypot(config.kinematics.scale_sd);
        let interval = around("measured_over_true", scale.value, sd);
        Self::plain(effect, vec![interval], 0.5 * scale.away_from(1.0).powi(2), config.certainty.most_gain)
    }

    /// Adds what may as well be it, with its odds and what would separate the two.
    pub fn rival(&mut self, kind: EffectKind, odds: f64, separated_by: &'static str) {
        self.confidence = beside(self.confidence, odds);
        self.would_separate.push(separated_by);
        self.ambiguous_with.push(kind);
    }

    /// Lowers the confidence by the odds of anything else.
    pub fn doubt(&mut self, odds: f64) {
        self.confidence = beside(self.confidence, odds);
    }

    /// The hold-out runs have surely less of it than what a right name would leave.
    pub(crate) fn is_denied(&self, config: &HoldoutConfig) -> bool {
        self.held_out.is_some_and(|multiple| is_denied(&multiple, config))
    }

    /// The runs that are not held out do not show it by themselves: less sure, and but a candidate where runs are
    /// driven alike, for then all of them have the same errors.
    pub(crate) fn unshared(&mut self, config: &GapConfig) {
        self.is_unshared = true;
        self.doubt(config.certainty.unshared);
    }

    /// Less effort than there is on some days, where drivers may as well start with a part of it, as many do.
    pub fn may_be_habit(&self) -> bool {
        self.or_else.is_some() && self.effect.kind() == EffectKind::LowAdhesion
    }

    /// Adds what it may be that is no effect of a train, in the same way.
    pub fn or_else(&mut self, what: &'static str, odds: f64, separated_by: &'static str) {
        self.doubt(odds);
        self.would_separate.push(separated_by);
        self.or_else = Some(what);
    }

    /// All that it is not distinguishable from, in words of files.
    pub fn rivals(&self) -> impl Iterator<Item = &'static str> {
        self.ambiguous_with.iter().map(|kind| kind.name()).chain(self.or_else)
    }

    /// Adds how it fared: chance is one more rival, and halves that differ make all rivals likelier.
    pub(crate) fn tried(&mut self, trial: Option<Trial>, config: &GapConfig) {
        if let Some(trial) = &trial {
            let against = 1.0 / self.confidence - 1.0 + trial.odds_of_chance();
            self.confidence = 1.0 / (1.0 + against / trial.odds_of_repeating(config));
        }
        self.trial = trial;
    }

    /// What an unknown effect depends on.
    pub fn coordinate(&self) -> Option<&'static str> {
        if let Effect::Unknown(unknown) = &self.effect { Some(coordinate_name(unknown.coordinate)) } else { None }
    }

    /// All parameters by their names in files.
    fn parameters(&self) -> Map<String, Value> {
        match serde_json::to_value(&self.effect) {
            Ok(Value::Object(map)) => map,
            _ => Map::new(),
        }
    }

    /// A parameter by its name in files.
    pub fn value(&self, parameter: &str) -> f64 {
        self.parameters().get(parameter).and_then(Value::as_f64).unwrap_or(f64::NAN)
    }

    /// As in `gap.json`.
    pub fn json(&self) -> Value {
        let mut parameters = self.parameters();
        parameters.remove("name");
        let from_m = parameters.remove("from_m");
        let to_m = parameters.remove("to_m");
        let table = parameters.remove("table");
        parameters.remove("coordinate");
        let intervals: Map<String, Value> =
            self.intervals.iter().map(|(name, low, high)| ((*name).to_owned(), json!([low, high]))).collect();
        let mut value = json!({
            "name": self.effect.name(),
            "from_m": from_m,
            "to_m": to_m,
            "parameters": parameters,
            "intervals_95": intervals,
            "confidence": self.confidence,
            "ambiguous_with": self.ambiguous_with.iter().map(|kind| kind.name()).collect::<Vec<_>>(),
            "or_else": self.or_else,
            "would_separate": self.would_separate,
            "runs": self.runs,
            "coordinate": self.coordinate(),
            "gain": self.gain,
            "trial": self.trial.as_ref().map(Trial::json),
            "held_out": self.held_out.map(|(multiple, (low, high))| json!({ "multiple": multiple, "interval_95": [low, high] })),
        });
        if let Some(table) = table {
            value["table"] = table;
        }
        if !self.per_run.is_empty() {
            let each = self.per_run.iter();
            value["per_run"] = each.map(|(run, value, sd)| json!({ "run": run, "value": value, "sd": sd })).collect();
        }
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rundown::model::effects::{LowAdhesion, TunnelDrag};

    #[test]
    fn less_effort_that_drivers_may_demand_may_be_their_habit() {
        let slips = LowAdhesion { factor: 0.8, below_kmh: 35.0 };
        let mut named = Named::plain(slips.into(), Vec::new(), 40.0, 30.0);
        assert!(!named.may_be_habit());
        named.or_else("drivers", 0.5, "the controller");
        assert!(named.may_be_habit());
        let drag = TunnelDrag { from_m: 0.0, to_m: 1_000.0, k: 1e-5 };
        let mut other = Named::plain(drag.into(), Vec::new(), 40.0, 30.0);
        other.or_else("anything else", 0.5, "more runs");
        assert!(!other.may_be_habit());
    }
}
