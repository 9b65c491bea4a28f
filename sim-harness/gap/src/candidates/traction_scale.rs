//! Less effort and power everywhere.

use crate::candidates::kit::*;

/// What the workflow knows of it.
pub static CANDIDATE: &dyn Candidate = &This;

struct This;

impl Candidate for This {
    fn kind(&self) -> Option<EffectKind> {
        Some(EffectKind::TractionScale)
    }

    fn page(&self) -> Option<Page> {
        Some(Page {
            what: "The traction gives less (or more) everywhere: a motor is cut out.",
            law: "maximum effort and maximum power x factor",
            parameters: "factor",
            shows: "no pull goes beyond this share of the described limit, at any speed and place",
            confused: "drivers who never ask for everything; mass_error without an effort column",
            separates: "the position of the controller; the number of motors at work",
        })
    }

    fn nature(&self) -> Nature {
        Nature { shows_in: ShowsIn::FullPower, needs_effort: true, ..Nature::default() }
    }

    fn limit(&self, found: &FoundLimit, naming: &Naming<'_>) -> Option<(Named, Odds)> {
        let named = found.named(found.effect.clone(), &naming.context.config.certainty);
        let rivals = (!naming.measured).then_some((EffectKind::MassError, 1.0));
        Some((named, rivals.into_iter().collect()))
    }

    fn sentence(&self, named: &Named, _: &Context<'_>) -> String {
        let Effect::TractionScale(e) = &named.effect else {
            return String::new();
        };
        format!(
            "Largest effort and power are everywhere {} of what is described",
            told(named, "factor", e.factor, 100.0, "%")
        )
    }

    fn hidden(&self, _: &str, hide: &mut Hide<'_>) -> Option<Value> {
        Some(json!({ "factor": hide.of([0.75, 0.85, 0.92]) }))
    }

    fn main_parameter(&self, _: f64) -> Option<(&'static str, f64)> {
        Some(("factor", 1.0))
    }
}
