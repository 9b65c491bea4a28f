//! Each term, limit and reading as the effect that the board runs, with what it is not distinguishable from.

use crate::candidate::{Fitted, Naming, Odds, Term};
use crate::candidates::tunnel_drag::renamed;
use crate::candidates::{self, mass_error, separates};
use crate::named::{Named, around, beside, not_chance};
use crate::traction::limit::FoundLimit;
use rundown::model::effects::{Effect, EffectKind, MassError};

/// All that was found, by name, the largest gain first.
pub fn named(terms: &[Fitted], limit: Option<&FoundLimit>, naming: &Naming<'_>) -> Vec<Named> {
    let mut all: Vec<Named> = Vec::new();
    let of_kind = |kind: EffectKind| candidates::of(kind).beside(naming).map(|found| with_rivals(found, naming));
    let (readings, between_runs): (Vec<Named>, Vec<Named>) = EffectKind::ALL
        .iter()
        .filter_map(|kind| of_kind(*kind))
        .partition(|named| !matches!(named.effect, Effect::RunWind(_)));
    all.extend(readings);
    if let Some(mass) = mass_by_drag_and_power(terms, limit, naming) {
        all.push(mass);
        all.extend(between_runs);
    } else {
        all.extend(terms.iter().enumerate().filter_map(|(index, fitted)| of_term(index, fitted, naming)));
        all.extend(between_runs);
        all.extend(limit.and_then(|found| of_limit(found, naming)));
    }
    all.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    all
}

/// The 95 % interval of its size holds that of none. `length_m`: of the train as described.
pub fn may_be_none(one: &Named, length_m: f64) -> bool {
    let size = candidates::of_effect(&one.effect).main_parameter(length_m);
    let holds = |(parameter, none)| one.intervals.iter().any(|of| of.0 == parameter && (of.1..=of.2).contains(&none));
    size.is_some_and(holds)
}

fn with_rivals((mut named, rivals): (Named, Odds), naming: &Naming<'_>) -> Named {
    let kind = named.effect.kind();
    for (rival, odds) in rivals {
        named.rival(rival, odds, separates(kind, rival, naming.have()));
    }
    named
}

/// Without an effort column a heavier train shows twice: less acceleration for its power, and less air drag for its
/// mass.
fn mass_by_drag_and_power(terms: &[Fitted], limit: Option<&FoundLimit>, naming: &Naming<'_>) -> Option<Named> {
    let ([only], Some(found)) = (terms, limit) else {
        return None;
    };
    let Effect::TractionScale(scale) = &found.effect else {
        return None;
    };
    let certainty = &naming.context.config.certainty;
    let (by_drag, sd) = mass_error::by_drag(only, naming.context.believed.train().davis().r2)?;
    let by_power = 1.0 / scale.factor - 1.0;
    let same = by_drag * by_power > 0.0
        && (by_drag - by_power).abs() < certainty.same_mass * by_drag.abs() + certainty.same_mass_at_least;
    (!naming.measured && same).then(|| {
        let effect = Effect::MassError(MassError { relative: by_drag });
        let interval = around("relative", by_drag, sd);
        let mut mass = Named::plain(effect, vec![interval], only.gain + found.gain, certainty.most_gain);
        // Two causes instead of one, of the same size by chance: dearer by a coefficient.
        mass.confidence = beside(mass.confidence, (-naming.context.penalty().coefficient).exp());
        mass.ambiguous_with = vec![EffectKind::DavisError, EffectKind::TractionScale];
        mass.would_separate = vec![candidates::EFFORT];
        mass.term = only.term.is(EffectKind::MassError).then_some(0);
        mass
    })
}

/// The name, the parameters and the limits of a term. `None`: a matter of sensors.
fn of_term(index: usize, fitted: &Fitted, naming: &Naming<'_>) -> Option<Named> {
    let certainty = &naming.context.config.certainty;
    let other = renamed(fitted, naming);
    let fitted = other.as_ref().unwrap_or(fitted);
    let (effect, intervals) = fitted.term.of.effect(fitted, naming)?;
    let kind = fitted.term.of.facts().kind?;
    let counts = |worse: f64| worse.max(0.0) / fitted.dispersion;
    let odds: f64 = fitted.rivals.iter().map(|(_, worse)| (-counts(*worse)).exp()).sum();
    let near: Vec<&Term> = fitted
        .rivals
        .iter()
        .filter(|(_, worse)| counts(*worse) < certainty.rival_within)
        .map(|(term, _)| term)
        .collect();
    let mut rivals: Vec<EffectKind> = near.iter().filter_map(|term| term.of.facts().kind).collect();
    rivals.retain(|other| *other != kind);
    rivals.dedup();
    rivals.truncate(2);
    let mut would_separate: Vec<&'static str> =
        rivals.iter().map(|other| separates(kind, *other, naming.have())).collect();
    would_separate.dedup();
    let mut named = Named::plain(effect, intervals, fitted.gain, certainty.most_gain);
    named.confidence = beside(not_chance(fitted.gain, certainty.most_gain), odds);
    named.ambiguous_with = rivals;
    named.would_separate = would_separate;
    named.term = Some(index);
    named.runs = fitted.term.shape.runs().iter().map(|i| naming.runs[*i].clone()).collect();
    if fitted.may_be_brakes {
        named.or_else("light brakes on descents", certainty.confounded, candidates::EFFORT);
    }
    if fitted.may_be_refused && !naming.measured {
        named.or_else(
            "a section where the slope, or what drivers do, is another",
            certainty.confounded,
            candidates::EFFORT,
        );
    }
    Some(named)
}

/// A limit with those that are as likely.
fn of_limit(found: &FoundLimit, naming: &Naming<'_>) -> Option<Named> {
    let candidate = candidates::of_effect(&found.effect);
    let (named, mut rivals) = candidate.limit(found, naming)?;
    let near = |other: &&FoundLimit| found.value - other.value < naming.context.config.certainty.rival_within;
    let others = naming.limits.iter().skip(1).filter(near);
    rivals.extend(others.map(|other| (other.effect.kind(), f64::exp(other.value - found.value))));
    let mut named = with_rivals((named, rivals), naming);
    named.ambiguous_with.truncate(2);
    named.would_separate.truncate(2);
    named.would_separate.dedup();
    Some(named)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::candidate::Shape;
    use crate::data::believed::tests::on_a_level_line;
    use crate::readings::kinematics::Kinematics;
    use rundown::model::effects::TunnelDrag;

    #[test]
    fn what_a_refused_section_explains_has_doubt() {
        on_a_level_line(20, |context| {
            let kinematics = Kinematics::default();
            let name = |may_be_refused: bool, measured: bool| {
                let naming = Naming { measured, ..Naming::plain(context, &kinematics) };
                let shape = Shape::Powers([true, false, false]);
                let term = Term { of: candidates::of(EffectKind::DavisError), shape };
                let fitted = Fitted { may_be_refused, gain: 40.0, ..Fitted::certain(term, vec![2e-3]) };
                of_term(0, &fitted, &naming).unwrap()
            };
            for sure in [name(false, false), name(true, true)] {
                assert!(sure.or_else.is_none() && sure.confidence > 0.9);
            }
            let doubted = name(true, false);
            assert!(doubted.or_else.is_some() && doubted.confidence < 0.7);
        });
    }

    #[test]
    fn an_interval_that_holds_zero_may_be_none_at_all() {
        let may_be_none = |low: f64| {
            let drag = TunnelDrag { from_m: 6_600.0, to_m: 6_900.0, k: 1.4e-4 };
            may_be_none(&Named::plain(drag.into(), vec![("from_m", -9.0, 9.0), ("k", low, 4.8e-4)], 40.0, 30.0), 25.0)
        };
        assert!(may_be_none(-6.7e-5) && !may_be_none(1e-5));
        // What has no interval is judged elsewhere.
        let scale = Named::plain(MassError { relative: 0.1 }.into(), Vec::new(), 40.0, 30.0);
        assert!(!super::may_be_none(&scale, 25.0));
    }
}
