//! A term as the effect that the board runs.

use super::analysis::{Findings, Surroundings};
use super::fit::TWO_SIDED;
use super::fitted::{Fitted, NEAR};
use super::named::{GAUGE, Named, around, name};
use super::rows::Row;
use super::runs::Run;
use super::separates::separates;
use super::terms::{Coordinate, Side, Term};
use rundown::model::effects as core_effects;
use rundown::model::effects::Effect;

/// A described section whose edges may be those of the one found takes its place.
pub(super) fn described(section: [f64; 2], edges: [(f64, f64); 2], descriptions: &[(f64, f64)]) -> [f64; 2] {
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

/// The name, the parameters and the limits of a term. `None`: a matter of sensors.
pub(super) fn of_term(
    fitted: &Fitted,
    findings: &Findings,
    surroundings: &Surroundings,
    runs: &[Run],
) -> Option<Named> {
    let Fitted { term, beta, sd, gain, section, shape, rivals } = fitted;
    let mut term = term.clone();
    let (mut beta, mut sd) = (beta.clone(), sd.clone());
    // A section that does as well as a tunnel and as a wrong gradient is a tunnel if one is described there, and a wrong gradient if not.
    let swap = match &term {
        Term::Tunnel(section) if !overlaps(*section, &surroundings.tunnels) => true,
        Term::Gradient(section) => overlaps(*section, &surroundings.tunnels),
        _ => false,
    };
    let mut rivals: Vec<(&'static str, f64)> = rivals.iter().map(|(term, worse)| (name(term), *worse)).collect();
    let other = fitted
        .rivals
        .iter()
        .find(|(other, worse)| *worse < 1.5 && matches!(other, Term::Tunnel(_) | Term::Gradient(_)));
    let factor = other.map_or(0.0, |(other, _)| same_force(&findings.rows, findings.gravity_n_per_kg, &term, other));
    // A tunnel helps nobody along.
    let possible = |other: &Term| matches!(other, Term::Gradient(_)) || beta[0] * factor > 0.0;
    if swap
        && let Some((other, _)) = other
        && possible(other)
    {
        // The force is the same; only what it is called differs.
        rivals.retain(|(n, _)| *n != name(other));
        rivals.insert(0, (name(&term), 0.0));
        term = other.clone();
        beta.iter_mut().for_each(|b| *b *= factor);
        sd.iter_mut().for_each(|s| *s *= factor.abs());
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
            Effect::DavisError(core_effects::DavisError { dr0: d[0], dr1: d[1], dr2: d[2] })
        }
        Term::Tunnel(section) => {
            let [from_m, to_m] = described(*section, section.map(|at| (at, at)), &surroundings.tunnels);
            Effect::TunnelDrag(core_effects::TunnelDrag { from_m, to_m, k: one("k", 1.0) })
        }
        Term::Gradient([from_m, to_m]) => Effect::GradientError(core_effects::GradientError {
            from_m: *from_m,
            to_m: *to_m,
            delta_permille: one("delta_permille", 1000.0),
        }),
        Term::Curve => Effect::CurveResistance(core_effects::CurveResistance {
            coefficient_roeckl: one("coefficient_roeckl", 1.0),
        }),
        Term::Wind(_) => Effect::SteadyWind(core_effects::SteadyWind { wind_mps: one("wind_mps", 1.0) }),
        Term::Mass => {
            // The coefficient is e/(1 + e).
            let relative = |b: f64| b / (1.0 - b);
            intervals.push(("relative", relative(beta[0] - TWO_SIDED * sd[0]), relative(beta[0] + TWO_SIDED * sd[0])));
            Effect::MassError(core_effects::MassError { relative: relative(beta[0]) })
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
            Effect::WarmUp(core_effects::WarmUp { amplitude: beta[0], tau_s: *tau_s })
        }
        Term::Length(true_m) => {
            if let Some(limits) = shape {
                intervals.push(("true_length_m", limits.shape.0, limits.shape.1));
            }
            Effect::TrainLengthError(core_effects::TrainLengthError { true_length_m: *true_m })
        }
        Term::BrakeFade(from_mps) => {
            if let Some(limits) = shape {
                intervals.push(("fade_at_140", limits.beta.0, limits.beta.1));
                let (low, high) = limits.shape;
                intervals.push(("from_kmh", 3.6 * low, 3.6 * high));
            }
            Effect::BrakeFade(core_effects::BrakeFade { fade_at_140: beta[0], from_kmh: 3.6 * from_mps })
        }
        Term::DraggingBrake(dragging) => {
            of_runs = dragging.iter().map(|i| runs[*i].name.clone()).collect();
            Effect::DraggingBrake(core_effects::DraggingBrake { drag_n_per_kg: one("drag_n_per_kg", 1.0) })
        }
        Term::Bump([from_m, to_m]) => {
            coordinate = Some("location");
            let n_per_kg = one("n_per_kg", 1.0);
            table(Coordinate::Location, &[from_m - 1.0, *from_m, *to_m, to_m + 1.0], &[0.0, n_per_kg, n_per_kg, 0.0])?
        }
        Term::Cube => {
            coordinate = Some("speed");
            let b = one("n_per_kg_at_1_mps", 1.0);
            let fastest = findings.rows.iter().map(|row| row.interval.speed_mps[0]);
            let step_mps = fastest.fold(1.0, f64::max) / 19.0;
            let knots: Vec<f64> = (0..20).map(|i| step_mps * f64::from(i)).collect();
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
        Term::Delay | Term::Late | Term::Gauge => return None,
    };
    let odds: f64 = rivals.iter().map(|(_, worse)| (-worse.max(0.0)).exp()).sum();
    let near = || rivals.iter().filter(|(_, worse)| *worse < NEAR);
    let mut ambiguous_with: Vec<&'static str> =
        near().map(|(name, _)| *name).filter(|other| *other != effect.name() && *other != GAUGE).collect();
    ambiguous_with.dedup();
    ambiguous_with.truncate(2);
    let have = findings.have();
    let advice = ambiguous_with.iter().map(|other| separates(effect.name(), other, have));
    let mut would_separate: Vec<&'static str> = advice.collect();
    if near().any(|(name, _)| *name == GAUGE) {
        would_separate.push("a calibrated gauge of the effort");
    }
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

/// Coefficient of another term of the same section over that of a term, for the same mean force. A gradient changes its sign with the direction.
fn same_force(rows: &[Row], gravity_n_per_kg: f64, term: &Term, other: &Term) -> f64 {
    let (Term::Tunnel(section) | Term::Gradient(section)) = term else {
        return 0.0;
    };
    let inside = |row: &&Row| (section[0]..section[1]).contains(&row.interval.middle().location_m);
    let (mut count, mut sign, mut speed2) = (0.0, 0.0, 0.0);
    for row in rows.iter().filter(inside) {
        count += 1.0;
        sign += row.direction.sign();
        speed2 += row.interval.mean_speed_mps().powi(2);
    }
    let tunnel_over_gradient = gravity_n_per_kg * count / f64::max(speed2, 1e-9);
    let usual_sign = if sign < 0.0 { -1.0 } else { 1.0 };
    usual_sign
        * match other {
            Term::Gradient(_) => 1.0 / tunnel_over_gradient,
            _ => tunnel_over_gradient,
        }
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
    let mut points: Vec<(f32, f32)> = knots.iter().zip(values).map(|(k, v)| (*k as f32, *v as f32)).collect();
    // Single precision may make two knots one, and a board takes neither that nor a value that is no number.
    points.dedup_by(|a, b| a.0 <= b.0);
    let finite = points.iter().all(|(k, v)| k.is_finite() && v.is_finite());
    finite.then(|| {
        Effect::Unknown(core_effects::Unknown {
            coordinate,
            table: points.into_iter().take(core_effects::MAX_POINTS).collect(),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rundown::model::direction::Direction;

    /// 0.02 N/kg more resistance at 50 m/s are a tunnel of 8e-6 in both directions, and a gradient whose sign is that of the direction.
    #[test]
    fn a_gradient_by_the_name_of_a_tunnel_is_the_same_force_in_each_direction() {
        let section = [1_000.0, 3_000.0];
        let (tunnel, gradient) = (Term::Tunnel(section), Term::Gradient(section));
        let gravity = 9.25;
        for direction in [Direction::Up, Direction::Down] {
            let rows = [
                Row::coasting(direction, 2_000.0, 50.0),
                // Outside, and so of no weight.
                Row::coasting(direction, 9_000.0, 10.0),
            ];
            let slope = direction.sign() * 0.02 / gravity;
            let k = slope * same_force(&rows, gravity, &gradient, &tunnel);
            assert!((k - 8e-6).abs() < 1e-12, "{direction:?}: {k}");
            let back = k * same_force(&rows, gravity, &tunnel, &gradient);
            assert!((back - slope).abs() < 1e-12, "{direction:?}: {back}");
        }
    }
}
