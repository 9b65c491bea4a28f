//! Less effort and power everywhere.

use crate::candidates::kit::*;

pub struct This;

impl Candidate for This {
    fn facts(&self) -> Facts {
        Facts {
            kind: Some(EffectKind::TractionScale),
            what: "The traction gives less (or more) everywhere: a motor is cut out.",
            law: "maximum effort and maximum power x factor",
            parameters: "factor",
            shows: "no powering phase goes beyond this share of the described limit, at any speed and place",
            confused: "drivers who never demand everything; mass_error without an effort column",
            separates: "the position of the controller; the number of motors at work",
            nature: Nature { shows_in: ShowsIn::FullPower, needs_effort: true, ..Nature::default() },
            size: Some(("factor", 1.0)),
            ..Facts::default()
        }
    }

    fn limit(&self, found: &FoundLimit, naming: &Naming<'_>) -> Option<(Named, Odds)> {
        let named = found.named(found.effect.clone(), &naming.context.config.certainty);
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
