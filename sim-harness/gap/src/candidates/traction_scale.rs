//! Less effort and power everywhere.

use crate::candidates::{POSITION, kit::*};

pub struct This;

impl Candidate for This {
    fn facts(&self) -> Facts {
        Facts {
            kind: Some(EffectKind::TractionScale),
            what: "The traction gives less (or more) everywhere: a motor is cut out.",
            law: "maximum effort and maximum power x factor",
            parameters: "factor",
            shows: "no powering phase goes beyond this share of the described limit, at any speed and place",
            confounded: "drivers who never demand everything; mass_error without an effort column",
            separates: "the position of the controller; the number of motors at work",
            nature: Nature { shows_in: ShowsIn::FullPower, needs_effort: true, ..Nature::default() },
            size: Some(("factor", 1.0)),
            ..Facts::default()
        }
    }

    fn limit(&self, found: &FoundLimit, naming: &Naming<'_>) -> Option<(Named, Odds)> {
        let certainty = &naming.context.config.certainty;
        let mut named = found.named(found.effect.clone(), certainty);
        // Nobody asks for more than there is; for less everybody may.
        if found.factor < 1.0 {
            named.or_else("drivers who never ask for all of it", certainty.confounded, POSITION);
        }
        let rivals = (!naming.measured).then_some((EffectKind::MassError, 1.0));
        Some((named, rivals.into_iter().collect()))
    }

    fn sentence(&self, named: &Named, _: &Context<'_>) -> String {
        format!("Largest effort and power are everywhere {} of what is described", scaled(named, "factor", 100.0, "%"))
    }

    fn hidden(&self, _: &str, hide: &mut Hide<'_>) -> Option<Value> {
        Some(json!({ "factor": hide.of([0.75, 0.85, 0.92]) }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::believed::tests::on_a_level_line;
    use crate::readings::kinematics::Kinematics;
    use rundown::model::effects::TractionScale;

    /// A scale that the data show beyond all doubt, as it is named with an effort column.
    fn named(factor: f64) -> Named {
        on_a_level_line(20, |context| {
            let kinematics = Kinematics::default();
            let naming = Naming::plain(context, &kinematics);
            let found = FoundLimit {
                effect: TractionScale { factor }.into(),
                factor,
                factor_sd: 0.005,
                runs: Vec::new(),
                gain: 500.0,
                value: 490.0,
                edges_m: None,
                below_kmh: None,
                demanded: 0.0,
            };
            This.limit(&found, &naming).unwrap().0
        })
    }

    #[test]
    fn a_weak_traction_may_be_drivers_who_ask_for_less_and_a_strong_one_may_not() {
        let weak = named(0.9);
        assert!((weak.confidence - 1.0 / 1.6).abs() < 1e-3, "{}", weak.confidence);
        assert_eq!(weak.rivals().collect::<Vec<_>>(), ["drivers who never ask for all of it"]);
        assert_eq!(weak.would_separate, ["the position of the controller"]);
        let strong = named(1.2);
        assert!(strong.confidence > 0.9 && strong.rivals().next().is_none());
    }
}
