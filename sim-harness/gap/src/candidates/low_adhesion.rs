//! Wheels that slip at low speed on some days.

use crate::candidates::{POSITION, kit::*};
use crate::named::beside;

pub struct This;

impl Candidate for This {
    fn facts(&self) -> Facts {
        Facts {
            kind: Some(EffectKind::LowAdhesion),
            what: "Wheels slip at low speed, on some days.",
            law: "maximum effort x factor below a speed",
            parameters: "factor, below_kmh; the runs in which it acts",
            shows: "in some runs the effort stays far below its limit at low speed and is normal above",
            confounded: "traction_scale, where it acts in all runs; drivers who start gently",
            separates: "records of slip control and sanding; rain",
            nature: Nature { shows_in: ShowsIn::FullPower, ..Nature::default() },
            size: Some(("factor", 1.0)),
            ..Facts::default()
        }
    }

    fn limit(&self, found: &FoundLimit, naming: &Naming<'_>) -> Option<(Named, Odds)> {
        let certainty = &naming.context.config.certainty;
        let mut named = found.named(found.effect.clone(), certainty);
        let around_kmh = certainty.below_kmh;
        named.intervals.extend(found.below_kmh.map(|(low, high)| ("below_kmh", low - around_kmh, high + around_kmh)));
        named.runs = found.runs.iter().map(|i| naming.runs[*i].clone()).collect();
        // A share that drivers like anyway may be theirs here, too.
        if found.demanded > (-certainty.rival_within).exp() {
            named.or_else("drivers who start with a part of it", found.demanded, POSITION);
        } else {
            named.confidence = beside(named.confidence, found.demanded);
        }
        Some((named, Vec::new()))
    }

    fn sentence(&self, named: &Named, _: &Context<'_>) -> String {
        format!(
            "Low adhesion: below {} the effort reaches {} of the described one",
            with_unit(named, "below_kmh"),
            scaled(named, "factor", 100.0, "%")
        )
    }

    fn hidden(&self, _: &str, hide: &mut Hide<'_>) -> Option<Value> {
        let factor = hide.of([0.4, 0.5, 0.65]);
        Some(json!({ "factor": factor, "below_kmh": hide.rng.random_range(35.0..60.0), "runs": 0.25 }))
    }
}
