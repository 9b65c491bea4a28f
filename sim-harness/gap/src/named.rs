//! What was found, by name: each term as the effect that the board runs, with limits, runs and rivals.

use super::analysis::{Findings, NO_DRAG_GAIN, Surroundings};
use super::caps::{FoundLimit, Limit};
use super::fit::TWO_SIDED;
use super::fitted::{Fitted, NEAR};
use super::of_term::{described, of_term};
use super::rows::Row;
use super::runs::Run;
use super::separates::{Have, separates};
use super::terms::Term;
use rundown::model::effects as core_effects;
use rundown::model::effects::Effect;
use serde_json::{Map, Value, json};

/// A named effect with what is known of it.
#[derive(Clone, Debug)]
pub struct Named {
    /// As the board runs it.
    pub effect: Effect,
    /// 95 % intervals by parameter.
    pub intervals: Vec<(&'static str, f64, f64)>,
    /// Probability that the name is right, among the rivals and chance.
    pub confidence: f64,
    /// Others that these data cannot separate from it.
    pub ambiguous_with: Vec<&'static str>,
    /// What would separate them.
    pub would_separate: Vec<&'static str>,
    /// Runs in which it acts, if not in all.
    pub runs: Vec<String>,
    /// What an unknown effect depends on.
    pub coordinate: Option<&'static str>,
    /// Each run's own value, where it differs from run to run, with its standard deviation.
    pub per_run: Vec<(String, f64, f64)>,
    /// Gain of log-likelihood.
    pub gain: f64,
}

/// What rounding, and efforts that rise within a reading, do to the factor of a limit, as a share of it.
const LIMIT: f64 = 0.006;
/// What a speed changes between two readings of an accelerating train, km/h.
const BELOW_KMH: f64 = 3.0;
/// What the path between two readings does to a scale, and to a lag, s.
const SCALE: f64 = 3e-4;
const LAG_S: f64 = 0.02;
/// Above this factor what a section lacks in power may as well be a resistance in it, where the effort is calculated.
const LITTLE_LESS: f64 = 0.85;

impl Named {
    /// An effect that acts in all runs and has no rivals.
    pub(super) fn plain(effect: Effect, gain: f64) -> Self {
        Self {
            effect,
            intervals: Vec::new(),
            confidence: 1.0 - f64::exp(-f64::min(gain, 30.0) / 2.0),
            ambiguous_with: Vec::new(),
            would_separate: Vec::new(),
            runs: Vec::new(),
            coordinate: None,
            per_run: Vec::new(),
            gain,
        }
    }

    /// Adds what may as well be it, with its odds.
    fn rival(&mut self, name: &'static str, odds: f64, have: Have) {
        self.confidence = 1.0 / (1.0 / self.confidence + odds);
        self.would_separate.push(separates(self.effect.name(), name, have));
        self.ambiguous_with.push(name);
    }

    /// Adds the 95 % interval of a parameter.
    pub(super) fn around(&mut self, name: &'static str, value: f64, sd: f64) {
        self.intervals.push(around(name, value, sd));
    }

    /// As in `gap.json`.
    pub fn json(&self) -> Value {
        let mut parameters = match serde_json::to_value(&self.effect) {
            Ok(Value::Object(map)) => map,
            _ => Map::new(),
        };
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
            "ambiguous_with": self.ambiguous_with,
            "would_separate": self.would_separate,
            "runs": self.runs,
            "coordinate": self.coordinate,
            "gain": self.gain,
        });
        if let (Some(table), Some(map)) = (table, value.as_object_mut()) {
            map.insert("table".to_owned(), table);
        }
        if let (false, Some(map)) = (self.per_run.is_empty(), value.as_object_mut()) {
            let each = self.per_run.iter();
            let each = each.map(|(run, value, sd)| json!({ "run": run, "value": value, "sd": sd }));
            map.insert("per_run".to_owned(), each.collect());
        }
        value
    }
}

/// Name of what a gauge of the effort does: no effect of a train.
pub const GAUGE: &str = "effort_gauge";

/// Name of what has none.
const UNKNOWN: &str = "unknown";

/// Name of a term.
pub fn name(term: &Term) -> &'static str {
    match term {
        Term::Davis(_) => "davis_error",
        Term::Tunnel(_) => "tunnel_drag",
        Term::Gradient(_) => "gradient_error",
        Term::Curve => "curve_resistance",
        Term::Wind(_) => "steady_wind",
        Term::Mass => "mass_error",
        Term::Temperature => "temperature_resistance",
        Term::Season => "seasonal_drift",
        Term::WarmUp(_) => "warm_up",
        Term::Length(_) => "train_length_error",
        Term::BrakeFade(_) => "brake_fade",
        Term::DraggingBrake(_) => "dragging_brake",
        Term::Bump(_) | Term::Cube | Term::Step(..) | Term::Smooth(..) => UNKNOWN,
        Term::Gauge => GAUGE,
        Term::Delay => "delay",
        Term::Late => "late",
    }
}

/// It has no name in the catalogue.
pub fn is_unnamed(term: &Term) -> bool {
    name(term) == UNKNOWN
}

/// All that was found, by name. `runs` as analysed.
pub fn named(findings: &Findings, surroundings: &Surroundings, runs: &[Run]) -> Vec<Named> {
    let mut all: Vec<Named> = Vec::new();
    let plain = |effect: Effect, intervals, gain| Named { intervals, ..Named::plain(effect, gain) };
    let kinematics = &findings.kinematics;
    if kinematics.scale_matters() {
        let (value, sd) = kinematics.scale;
        let scale = 1.0 + value;
        let effect = Effect::SpeedScale(core_effects::SpeedScale { measured_over_true: scale });
        let around = vec![around("measured_over_true", scale, sd.hypot(SCALE))];
        all.push(plain(effect, around, 0.5 * (value / sd).powi(2)));
    }
    if kinematics.lag_matters() {
        let (lag_s, sd) = kinematics.lag_s;
        let sd = sd.hypot(LAG_S);
        let effect = Effect::LocationLag(core_effects::LocationLag { lag_s });
        all.push(plain(effect, vec![around("lag_s", lag_s, sd)], 0.5 * (lag_s / sd).powi(2)));
    }
    let mut terms: Vec<&Fitted> = findings.terms.iter().collect();
    let mut limit = findings.limit();
    // Without an effort column a heavier train shows twice: less acceleration for its power, and less air drag for its mass.
    if let (false, [only], Some(found)) = (findings.measured, terms.as_slice(), limit)
        && let Limit::Scale { factor } = &found.limit
        && let Some((by_drag, sd)) = mass_by_drag(only, findings.believed_r2)
    {
        let by_power = 1.0 / factor - 1.0;
        if by_drag * by_power > 0.0 && (by_drag - by_power).abs() < 0.5 * by_drag.abs() + 0.02 {
            let effect = Effect::MassError(core_effects::MassError { relative: by_drag });
            let mut mass = plain(effect, vec![around("relative", by_drag, sd)], only.gain + found.gain);
            mass.ambiguous_with = vec!["davis_error", "traction_scale"];
            mass.would_separate = vec!["an effort column"];
            all.push(mass);
            terms.clear();
            limit = None;
        }
    }
    for fitted in terms {
        all.extend(of_term(fitted, findings, surroundings, runs));
    }
    if let Some((sd_mps, sd)) = findings.run_wind() {
        let effect = Effect::RunWind(core_effects::RunWind { sd_mps });
        let around = vec![around("sd_mps", sd_mps, sd)];
        let mut wind = plain(effect, around, findings.wind_gain);
        // Without an effort column nobody knows when a brake was applied.
        if !findings.measured || findings.wind_gain < NO_DRAG_GAIN {
            wind.rival("dragging_brake", 1.0, findings.have());
        }
        all.push(wind);
    }
    if let Some(found) = limit {
        let factor = |value: f64| {
            let sd = found.factor_sd.hypot(LIMIT * value);
            around("factor", value, sd)
        };
        let mut of_limit = match &found.limit {
            Limit::Scale { factor: value } => plain(
                Effect::TractionScale(core_effects::TractionScale { factor: *value }),
                vec![factor(*value)],
                found.gain,
            ),
            Limit::Section { from_m, to_m, factor: value } => {
                let edges = found.edges_m.unwrap_or([(*from_m, *from_m), (*to_m, *to_m)]);
                let [from_m, to_m] = described([*from_m, *to_m], edges, &surroundings.feeding);
                let mut named = plain(
                    Effect::PowerLimitSection(core_effects::PowerLimitSection { from_m, to_m, factor: *value }),
                    vec![factor(*value)],
                    found.gain,
                );
                for (name, (low, high)) in ["from_m", "to_m"].into_iter().zip(edges) {
                    let on_line = |at: f64| at.clamp(0.0, surroundings.length_m);
                    named.intervals.push((name, on_line(low), on_line(high)));
                }
                named
            }
            Limit::Adhesion { factor: value, below_kmh, runs: slippery } => {
                let mut named = plain(
                    Effect::LowAdhesion(core_effects::LowAdhesion { factor: *value, below_kmh: *below_kmh }),
                    vec![factor(*value)],
                    found.gain,
                );
                let limits = found.below_kmh;
                let limits = limits.map(|(low, high)| ("below_kmh", low - BELOW_KMH, high + BELOW_KMH));
                named.intervals.extend(limits);
                named.runs = slippery.iter().map(|i| runs[*i].name.clone()).collect();
                named
            }
        };
        match found.limit {
            Limit::Scale { .. } if !findings.measured => {
                of_limit.rival("mass_error", 1.0, findings.have());
            }
            Limit::Section { from_m, to_m, factor }
                if !findings.measured && factor > LITTLE_LESS && !coasted(from_m..to_m, findings) =>
            {
                of_limit.rival("tunnel_drag", 1.0, findings.have());
            }
            _ => {}
        }
        let near = |other: &&FoundLimit| found.value - other.value < NEAR;
        for other in findings.limits.iter().skip(1).filter(near) {
            let odds = f64::exp(other.value - found.value);
            of_limit.rival(other.limit.name(), odds, findings.have());
        }
        of_limit.ambiguous_with.truncate(2);
        of_limit.would_separate.truncate(2);
        of_limit.would_separate.dedup();
        all.push(of_limit);
    }
    all.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    all
}

/// Enough intervals coasted in a section for its resistance to be known there.
fn coasted(section: core::ops::Range<f64>, findings: &Findings) -> bool {
    const ENOUGH: usize = 10;
    let inside = |row: &&Row| section.contains(&row.interval.middle().location_m);
    findings.rows.iter().filter(inside).count() >= ENOUGH
}

/// What a train's mass would have to be, relative to the believed one and with its standard deviation, for a change of r2 alone to be less, or more, air drag for its mass.
fn mass_by_drag(fitted: &Fitted, r2: f64) -> Option<(f64, f64)> {
    let (beta, sd) = (*fitted.beta.first()?, *fitted.sd.first()?);
    match fitted.term {
        Term::Davis([false, false, true]) => {
            let true_r2 = r2 + beta;
            Some((-beta / true_r2, sd * r2 / (true_r2 * true_r2)))
        }
        Term::Mass => Some((beta / (1.0 - beta), sd / (1.0 - beta).powi(2))),
        _ => None,
    }
}

/// The 95 % interval of a parameter.
pub(super) fn around(name: &'static str, value: f64, sd: f64) -> (&'static str, f64, f64) {
    (name, value - TWO_SIDED * sd, value + TWO_SIDED * sd)
}
