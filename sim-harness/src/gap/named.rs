//! What was found, by name: each term as the effect that the board runs, with limits, runs and rivals.

use super::analysis::{Findings, Fitted, Surroundings};
use super::caps::Limit;
use super::fit::TWO_SIDED;
use super::runs::Run;
use super::separates::{Have, separates};
use super::terms::{Coordinate, Side, Term, both_directions};
use rundown::effects::{self as core_effects, Effect};
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
/// What the path between two readings does to a lag, s.
const LAG_S: f64 = 0.02;

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
        let intervals: Map<String, Value> = self
            .intervals
            .iter()
            .map(|(name, low, high)| ((*name).to_owned(), json!([low, high])))
            .collect();
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
        Term::Bump(_) | Term::Cube | Term::Step(..) | Term::Smooth(..) => "unknown",
        Term::Delay => "delay",
        Term::Late => "late",
    }
}

/// All that was found, by name. `runs` as analysed.
pub fn named(findings: &Findings, surroundings: &Surroundings, runs: &[Run]) -> Vec<Named> {
    let mut all: Vec<Named> = Vec::new();
    let plain = |effect: Effect, intervals, gain| Named {
        intervals,
        ..Named::plain(effect, gain)
    };
    let kinematics = &findings.kinematics;
    if kinematics.scale_matters() {
        let (value, sd) = kinematics.scale;
        let scale = 1.0 + value;
        let effect = Effect::SpeedScale(core_effects::SpeedScale {
            measured_over_true: scale,
        });
        let around = vec![around("measured_over_true", scale, sd)];
        all.push(plain(effect, around, 0.5 * (value / sd).powi(2)));
    }
    if kinematics.lag_matters() {
        let (lag_s, sd) = kinematics.lag_s;
        let sd = sd.hypot(LAG_S);
        let effect = Effect::LocationLag(core_effects::LocationLag { lag_s });
        all.push(plain(
            effect,
            vec![around("lag_s", lag_s, sd)],
            0.5 * (lag_s / sd).powi(2),
        ));
    }
    let mut terms: Vec<&Fitted> = findings.terms.iter().collect();
    let mut limit = findings.limit.as_ref();
    // Without an effort column a heavier train shows twice: less acceleration for its power, and less air drag for its mass.
    if let (false, [only], Some(found)) = (findings.measured, terms.as_slice(), limit)
        && let Limit::Scale { factor } = &found.limit
        && let Some((by_drag, sd)) = mass_by_drag(only, findings.believed_r2)
    {
        let by_power = 1.0 / factor - 1.0;
        if by_drag * by_power > 0.0 && (by_drag - by_power).abs() < 0.5 * by_drag.abs() + 0.02 {
            let effect = Effect::MassError(core_effects::MassError { relative: by_drag });
            let mut mass = plain(
                effect,
                vec![around("relative", by_drag, sd)],
                only.gain + found.gain,
            );
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
    if findings.run_wind() {
        let sd_mps = findings.calibrated.own.wind_mps;
        let relative = 1.0 / (2.0 * runs.len().max(2) as f64).sqrt();
        let effect = Effect::RunWind(core_effects::RunWind { sd_mps });
        let around = vec![around("sd_mps", sd_mps, 1.3 * relative * sd_mps)];
        all.push(plain(effect, around, findings.wind_gain));
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
            Limit::Section {
                from_m,
                to_m,
                factor: value,
            } => {
                let edges = found
                    .edges_m
                    .unwrap_or([(*from_m, *from_m), (*to_m, *to_m)]);
                let [from_m, to_m] = described([*from_m, *to_m], edges, &surroundings.feeding);
                let mut named = plain(
                    Effect::PowerLimitSection(core_effects::PowerLimitSection {
                        from_m,
                        to_m,
                        factor: *value,
                    }),
                    vec![factor(*value)],
                    found.gain,
                );
                for (name, (low, high)) in ["from_m", "to_m"].into_iter().zip(edges) {
                    let on_line = |at: f64| at.clamp(0.0, surroundings.length_m);
                    named.intervals.push((name, on_line(low), on_line(high)));
                }
                named
            }
            Limit::Adhesion {
                factor: value,
                below_kmh,
                runs: slippery,
            } => {
                let mut named = plain(
                    Effect::LowAdhesion(core_effects::LowAdhesion {
                        factor: *value,
                        below_kmh: *below_kmh,
                    }),
                    vec![factor(*value)],
                    found.gain,
                );
                let limits = found.below_kmh;
                let limits =
                    limits.map(|(low, high)| ("below_kmh", low - BELOW_KMH, high + BELOW_KMH));
                named.intervals.extend(limits);
                named.runs = slippery.iter().map(|i| runs[*i].name.clone()).collect();
                named
            }
        };
        if !findings.measured && matches!(found.limit, Limit::Scale { .. }) {
            of_limit.ambiguous_with = vec!["mass_error"];
            of_limit.would_separate = vec!["an effort column"];
        }
        all.push(of_limit);
    }
    all.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    all
}

/// What a train's mass would have to be, relative to the believed one and with its standard deviation, for a change of r2 alone to be less, or more, air drag for its mass.
fn mass_by_drag(fitted: &Fitted, r2: f64) -> Option<(f64, f64)> {
    let (beta, sd) = (*fitted.beta.first()?, *fitted.sd.first()?);
    match fitted.term {
        Term::Davis([false, false, true]) => Some((-beta / (r2 + beta), sd / r2)),
        Term::Mass => Some((beta / (1.0 - beta), sd)),
        _ => None,
    }
}

fn around(name: &'static str, value: f64, sd: f64) -> (&'static str, f64, f64) {
    (name, value - TWO_SIDED * sd, value + TWO_SIDED * sd)
}

/// A described section whose edges may be those of the one found takes its place.
fn described(section: [f64; 2], edges: [(f64, f64); 2], descriptions: &[(f64, f64)]) -> [f64; 2] {
    const NEAR_M: f64 = 600.0;
    let within = |at: f64, (low, high): (f64, f64)| (low - NEAR_M..high + NEAR_M).contains(&at);
    let fits = |&&(from, to): &&(f64, f64)| within(from, edges[0]) && within(to, edges[1]);
    let found = descriptions.iter().find(fits);
    found.map_or(section, |(from, to)| [*from, *to])
}

fn overlaps(section: [f64; 2], descriptions: &[(f64, f64)]) -> bool {
    descriptions.iter().any(|(from, to)| {
        let both = section[1].min(*to) - section[0].max(*from);
        let either = section[1].max(*to) - section[0].min(*from);
        both > 0.4 * either
    })
}

fn of_term(
    fitted: &Fitted,
    findings: &Findings,
    surroundings: &Surroundings,
    runs: &[Run],
) -> Option<Named> {
    let Fitted {
        term,
        beta,
        sd,
        gain,
        section,
        shape,
        rivals,
    } = fitted;
    let mut term = term.clone();
    let (mut beta, mut sd) = (beta.clone(), sd.clone());
    // A section that does as well as a tunnel and as a wrong gradient is a tunnel if one is described there, and a wrong gradient if not.
    let swap = match &term {
        Term::Tunnel(section) if !overlaps(*section, &surroundings.tunnels) => true,
        Term::Gradient(section) => overlaps(*section, &surroundings.tunnels),
        _ => false,
    };
    let mut rivals: Vec<(&'static str, f64)> = rivals
        .iter()
        .map(|(term, worse)| (name(term), *worse))
        .collect();
    if swap
        && let Some((other, _)) = fitted.rivals.iter().find(|(other, worse)| {
            *worse < 1.5 && matches!(other, Term::Tunnel(_) | Term::Gradient(_))
        })
    {
        // The force is the same; only what it is called differs.
        let speed2 = mean_square_speed(findings, &term);
        let gravity = findings.gravity_n_per_kg;
        let factor = match other {
            Term::Gradient(_) => speed2 / gravity,
            _ => gravity / speed2,
        };
        rivals.retain(|(n, _)| *n != name(other));
        rivals.insert(0, (name(&term), 0.0));
        term = other.clone();
        beta.iter_mut().for_each(|b| *b *= factor);
        sd.iter_mut().for_each(|s| *s *= factor);
    }
    let mut intervals = Vec::new();
    // Of a coefficient whose section may be another: as a share of it, for it may go by another name by now.
    let mut share = None;
    if let Some(limits) = section {
        let [from, to] = limits.edges_m;
        intervals.push(("from_m", from.0, from.1));
        intervals.push(("to_m", to.0, to.1));
        share = Some([limits.beta.0, limits.beta.1].map(|limit| limit / fitted.beta[0]));
    }
    let mut coordinate = None;
    let mut of_runs = Vec::new();
    let mut one = |name: &'static str, scale: f64| {
        let value = beta[0] * scale;
        intervals.push(match share {
            Some([a, b]) => (name, (value * a).min(value * b), (value * a).max(value * b)),
            None => around(name, value, sd[0] * scale),
        });
        value
    };
    let effect = match &term {
        Term::Davis(wrong) => {
            let mut d = [0.0; 3];
            let mut at = 0;
            for k in 0..3 {
                if wrong[k] {
                    d[k] = beta[at];
                    intervals.push(around(["dr0", "dr1", "dr2"][k], beta[at], sd[at]));
                    at += 1;
                }
            }
            Effect::DavisError(core_effects::DavisError {
                dr0: d[0],
                dr1: d[1],
                dr2: d[2],
            })
        }
        Term::Tunnel(section) => {
            let [from_m, to_m] =
                described(*section, section.map(|at| (at, at)), &surroundings.tunnels);
            Effect::TunnelDrag(core_effects::TunnelDrag {
                from_m,
                to_m,
                k: one("k", 1.0),
            })
        }
        Term::Gradient([from_m, to_m]) => Effect::GradientError(core_effects::GradientError {
            from_m: *from_m,
            to_m: *to_m,
            delta_permille: one("delta_permille", 1000.0),
        }),
        Term::Curve => Effect::CurveResistance(core_effects::CurveResistance {
            coefficient_roeckl: one("coefficient_roeckl", 1.0),
        }),
        Term::Wind(_) => Effect::SteadyWind(core_effects::SteadyWind {
            wind_mps: one("wind_mps", 1.0),
        }),
        Term::Mass => {
            // The coefficient is e/(1 + e).
            let relative = |b: f64| b / (1.0 - b);
            intervals.push((
                "relative",
                relative(beta[0] - TWO_SIDED * sd[0]),
                relative(beta[0] + TWO_SIDED * sd[0]),
            ));
            Effect::MassError(core_effects::MassError {
                relative: relative(beta[0]),
            })
        }
        Term::Temperature => {
            intervals.push(around("dr0_per_degC", beta[0], sd[0]));
            Effect::TemperatureResistance(core_effects::TemperatureResistance {
                dr0_per_deg_c: beta[0],
                ref_c: findings.temperature_c - beta[1] / beta[0],
            })
        }
        Term::Season => Effect::SeasonalDrift(core_effects::SeasonalDrift {
            dr0_over_period: one("dr0_over_period", 1.0),
            period_days: findings.period_days,
            reference_day: findings.first_day,
        }),
        Term::WarmUp(tau_s) => {
            if let Some(limits) = shape {
                intervals.push(("amplitude", limits.beta.0, limits.beta.1));
                intervals.push(("tau_s", limits.shape.0, limits.shape.1));
            }
            Effect::WarmUp(core_effects::WarmUp {
                amplitude: beta[0],
                tau_s: *tau_s,
            })
        }
        Term::Length(true_m) => {
            if let Some(limits) = shape {
                intervals.push(("true_length_m", limits.shape.0, limits.shape.1));
            }
            Effect::TrainLengthError(core_effects::TrainLengthError {
                true_length_m: *true_m,
            })
        }
        Term::BrakeFade(from_mps) => {
            if let Some(limits) = shape {
                intervals.push(("fade_at_140", limits.beta.0, limits.beta.1));
                let (low, high) = limits.shape;
                intervals.push(("from_kmh", 3.6 * low, 3.6 * high));
            }
            Effect::BrakeFade(core_effects::BrakeFade {
                fade_at_140: beta[0],
                from_kmh: 3.6 * from_mps,
            })
        }
        Term::DraggingBrake(dragging) => {
            of_runs = dragging.iter().map(|i| runs[*i].name.clone()).collect();
            Effect::DraggingBrake(core_effects::DraggingBrake {
                drag_n_per_kg: one("drag_n_per_kg", 1.0),
            })
        }
        Term::Bump([from_m, to_m]) => {
            coordinate = Some("location");
            let n_per_kg = one("n_per_kg", 1.0);
            table(
                Coordinate::Location,
                &[from_m - 1.0, *from_m, *to_m, to_m + 1.0],
                &[0.0, n_per_kg, n_per_kg, 0.0],
            )?
        }
        Term::Cube => {
            coordinate = Some("speed");
            let b = one("n_per_kg_at_1_mps", 1.0);
            let knots: Vec<f64> = (0..20).map(|i| 2.2 * f64::from(i)).collect();
            let values: Vec<f64> = knots.iter().map(|v| b * v.powi(3)).collect();
            table(Coordinate::Speed, &knots, &values)?
        }
        Term::Step(which, ends, side) => {
            coordinate = Some(coordinate_name(*which));
            let n_per_kg = one("n_per_kg", 1.0);
            let values = match side {
                Side::Below => [n_per_kg, 0.0],
                Side::Above => [0.0, n_per_kg],
            };
            table(*which, ends, &values)?
        }
        Term::Smooth(which, knots) => {
            coordinate = Some(coordinate_name(*which));
            table(*which, knots, &beta)?
        }
        Term::Delay | Term::Late => return None,
    };
    let odds: f64 = rivals
        .iter()
        .map(|(_, worse)| (-worse.max(0.0)).exp())
        .sum();
    let mut ambiguous_with: Vec<&'static str> = rivals
        .iter()
        .map(|(name, _)| *name)
        .filter(|other| *other != effect.name() && *other != "delay")
        .collect();
    ambiguous_with.dedup();
    ambiguous_with.truncate(2);
    let have = Have {
        effort: findings.measured,
        both_directions: both_directions(&findings.rows),
    };
    let advice = ambiguous_with
        .iter()
        .map(|other| separates(effect.name(), other, have));
    let mut would_separate: Vec<&'static str> = advice.collect();
    would_separate.dedup();
    Some(Named {
        confidence: (1.0 - (-gain.min(30.0) / 2.0).exp()) / (1.0 + odds),
        effect,
        intervals,
        ambiguous_with,
        would_separate,
        runs: of_runs,
        coordinate,
        per_run: Vec::new(),
        gain: *gain,
    })
}

/// Mean of v² over the rows in the section of a term.
fn mean_square_speed(findings: &Findings, term: &Term) -> f64 {
    let (Term::Tunnel(section) | Term::Gradient(section)) = term else {
        return 1.0;
    };
    let inside = || {
        findings
            .rows
            .iter()
            .filter(|row| (section[0]..section[1]).contains(&row.interval.middle().location_m))
            .map(|row| row.interval.mean_speed_mps().powi(2))
    };
    inside().sum::<f64>() / inside().count().max(1) as f64
}

fn coordinate_name(which: Coordinate) -> &'static str {
    match which {
        Coordinate::Location => "location",
        Coordinate::Speed => "speed",
        Coordinate::Time => "time",
        Coordinate::Temperature => "temperature",
        Coordinate::Day => "day",
    }
}

fn table(which: Coordinate, knots: &[f64], values: &[f64]) -> Option<Effect> {
    let coordinate = match which {
        Coordinate::Location => core_effects::Coordinate::Location,
        Coordinate::Speed => core_effects::Coordinate::Speed,
        Coordinate::Time => core_effects::Coordinate::Time,
        Coordinate::Temperature => core_effects::Coordinate::Temperature,
        Coordinate::Day => core_effects::Coordinate::Day,
    };
    let points = knots
        .iter()
        .zip(values)
        .map(|(k, v)| (*k as f32, *v as f32));
    Some(Effect::Unknown(core_effects::Unknown {
        coordinate,
        table: points.take(core_effects::MAX_POINTS).collect(),
    }))
}
