//! Air drag in a tunnel.

use crate::candidates::kit::*;
use rundown::model::effects::TunnelDrag;

pub struct This;

impl Candidate for This {
    fn facts(&self) -> Facts {
        Facts {
            kind: Some(EffectKind::TunnelDrag),
            what: "Air drag is larger in a tunnel, for the part of the train that is inside.",
            law: "resistance + k v² x (length inside / train length)",
            parameters: "from_m, to_m; k in N/(kg (m/s)²)",
            shows: "more resistance in one section in both directions, growing with the square of the speed; its edges are as soft as the train is long",
            confounded: "gradient_error, where all runs go in one direction at similar speeds",
            separates: "runs in the other direction, runs at another speed, a tunnel in the track file",
            nature: Nature { by_place: true, ..Nature::default() },
            size: Some(("k", 0.0)),
            ..Facts::default()
        }
    }

    fn families(&self, _: &Offer<'_>) -> Vec<Family> {
        vec![Family::Section(Term { of: &This, shape: Shape::Section([0.0; 2]) })]
    }

    fn columns(&self, shape: &Shape, context: &Context<'_>, rows: &[Row]) -> Vec<Vec<f64>> {
        let section = shape.section();
        vec![along(context, rows, |line, _, p| p.speed_mps * p.speed_mps * share(line, p.location_m, section))]
    }

    /// A tunnel helps nobody along.
    fn is_plausible(&self, size: &Size<'_>) -> bool {
        let search = &size.context.config.search;
        let most = search.most_tunnel * size.context.believed.train().davis().r2;
        (0.0..=most).contains(&size.beta[0]) && size.most() > search.least_in_section_n_per_kg
    }

    fn effect(&self, fitted: &Fitted, naming: &Naming<'_>) -> Option<(Effect, Vec<Interval95>)> {
        let section = fitted.term.section()?;
        let Context { surroundings, config, .. } = naming.context;
        let near_m = config.certainty.described_m;
        let [from_m, to_m] = described(section, section.map(|at| (at, at)), &surroundings.tunnels, near_m);
        let (k, interval) = fitted.first("k", 1.0);
        Some((TunnelDrag { from_m, to_m, k }.into(), [fitted.edges(), vec![interval]].concat()))
    }

    fn sentence(&self, named: &Named, context: &Context<'_>) -> String {
        format!(
            "Tunnel drag from {}: there the air resistance grows by k v\u{b2}, k = {}, which is {}\u{a0}% of the believed r2",
            section(named),
            with_unit(named, "k"),
            number(100.0 * named.value("k") / context.believed.train().davis().r2, 0)
        )
    }

    /// Where the whole train is inside: there the law is one of the speed alone.
    fn axis<'a>(&self, named: &'a Named, context: &Context<'a>) -> Option<Axis<'a>> {
        let (k, believed) = (named.value("k"), context.believed);
        Some(Axis::over("speed, km/h, with the whole train in the section", move |row| {
            let v2 = row.interval.mean(|p| p.speed_mps * p.speed_mps);
            let inside = extra(&believed, &named.effect, row) / (k * v2);
            Some(kmh(row)).filter(|_| inside > 0.98)
        }))
    }

    fn hidden(&self, _: &str, hide: &mut Hide<'_>) -> Option<Value> {
        let [from_m, to_m] = hide.section_m;
        Some(json!({ "from_m": from_m, "to_m": to_m, "k": hide.davis.r2 * hide.of([0.36, 0.18, 0.09]) }))
    }
}

/// A section that does as well as a tunnel and as a wrong gradient is a tunnel if one is described there, and a wrong
/// gradient if not: the force is the same; only what it is called differs. Gives the term by its other name, and the
/// first name as a rival.
pub fn renamed(fitted: &Fitted, naming: &Naming<'_>) -> Option<Fitted> {
    let certainty = &naming.context.config.certainty;
    let section = fitted.term.section()?;
    let in_tunnel = overlaps(section, &naming.context.surroundings.tunnels, certainty.overlap);
    let swap =
        fitted.term.is(EffectKind::TunnelDrag) && !in_tunnel || fitted.term.is(EffectKind::GradientError) && in_tunnel;
    let by_name = |term: &Term| term.is(EffectKind::TunnelDrag) || term.is(EffectKind::GradientError);
    let near = |(other, worse): &&(Term, f64)| *worse < certainty.same && by_name(other);
    let (other, _) = fitted.rivals.iter().find(near).filter(|_| swap)?;
    let gravity_n_per_kg = naming.context.believed.train().gravity_n_per_kg();
    let factor = same_force(naming.rows, gravity_n_per_kg, section, other);
    let possible = other.is(EffectKind::GradientError) || fitted.beta[0] * factor > 0.0;
    possible.then(|| {
        let mut renamed = fitted.clone();
        renamed.rivals.retain(|(term, _)| term.of.facts().kind != other.of.facts().kind);
        renamed.rivals.insert(0, (fitted.term.clone(), 0.0));
        renamed.term = other.clone();
        renamed.beta.iter_mut().for_each(|b| *b *= factor);
        renamed.sd.iter_mut().for_each(|s| *s *= factor.abs());
        renamed
    })
}

fn overlaps(section: [f64; 2], descriptions: &[(f64, f64)], least: f64) -> bool {
    descriptions.iter().any(|(from, to)| {
        let both = section[1].min(*to) - section[0].max(*from);
        let either = section[1].max(*to) - section[0].min(*from);
        both > least * either
    })
}

/// Coefficient of the other term over that of a term of this section, for the same mean force. A gradient changes its
/// sign with the direction.
fn same_force(rows: &[Row], gravity_n_per_kg: f64, section: [f64; 2], other: &Term) -> f64 {
    let inside = |row: &&Row| (section[0]..section[1]).contains(&row.interval.middle().location_m);
    let (mut count, mut sign, mut speed2) = (0.0, 0.0, 0.0);
    for row in rows.iter().filter(inside) {
        count += 1.0;
        sign += row.direction.sign();
        speed2 += row.interval.mean_speed_mps().powi(2);
    }
    let tunnel_over_gradient = gravity_n_per_kg * count / f64::max(speed2, 1e-9);
    let usual_sign = if sign < 0.0 { -1.0 } else { 1.0 };
    let factor = if other.is(EffectKind::GradientError) { 1.0 / tunnel_over_gradient } else { tunnel_over_gradient };
    usual_sign * factor
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::candidates;
    use rundown::model::direction::Direction;

    /// 0.02 N/kg more resistance at 50 m/s are a tunnel of 8e-6 in both directions, and a gradient whose sign is that
    /// of the direction.
    #[test]
    fn a_gradient_by_the_name_of_a_tunnel_is_the_same_force_in_each_direction() {
        let section = [1_000.0, 3_000.0];
        let [tunnel, gradient] = [candidates::of(EffectKind::TunnelDrag), candidates::of(EffectKind::GradientError)]
            .map(|of| Term { of, shape: Shape::Section(section) });
        let gravity = 9.25;
        for direction in [Direction::Up, Direction::Down] {
            let rows = [
                Row::coasting(direction, 2_000.0, 50.0),
                // Outside, and so of no weight.
                Row::coasting(direction, 9_000.0, 10.0),
            ];
            let slope = direction.sign() * 0.02 / gravity;
            let k = slope * same_force(&rows, gravity, section, &tunnel);
            assert!((k - 8e-6).abs() < 1e-12, "{direction:?}: {k}");
            let back = k * same_force(&rows, gravity, section, &gradient);
            assert!((back - slope).abs() < 1e-12, "{direction:?}: {back}");
        }
    }
}
