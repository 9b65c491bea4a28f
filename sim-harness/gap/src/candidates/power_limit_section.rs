//! Less power in a feeding section.

use crate::candidates::kit::*;
use crate::naming::confounded::may_drag;
use rundown::model::effects::PowerLimitSection;

pub struct This;

impl Candidate for This {
    fn facts(&self) -> Facts {
        Facts {
            kind: Some(EffectKind::PowerLimitSection),
            what: "The supply gives less power in a feeding section.",
            law: "maximum power x factor while the front of the train is inside",
            parameters: "from_m, to_m; factor",
            shows: "at full power the train reaches a part of the described power in one section and all of it elsewhere",
            confounded: "traction_scale, where all powering is done in the section; drivers who demand less there",
            separates: "powering at full power inside and outside; the line voltage",
            nature: Nature { shows_in: ShowsIn::FullPower, needs_effort: true, ..Nature::default() },
            size: Some(("factor", 1.0)),
            ..Facts::default()
        }
    }

    fn limit(&self, found: &FoundLimit, naming: &Naming<'_>) -> Option<(Named, Odds)> {
        let Effect::PowerLimitSection(PowerLimitSection { from_m, to_m, factor }) = found.effect else {
            return None;
        };
        let Context { surroundings, config, .. } = naming.context;
        let certainty = &config.certainty;
        let edges = found.edges_m.unwrap_or([(from_m, from_m), (to_m, to_m)]);
        let [near_from_m, near_to_m] = described([from_m, to_m], edges, &surroundings.feeding, certainty.described_m);
        let effect = PowerLimitSection { from_m: near_from_m, to_m: near_to_m, factor };
        let mut named = found.named(effect.into(), certainty);
        for (name, (low, high)) in ["from_m", "to_m"].into_iter().zip(edges) {
            let on_line = |at: f64| at.clamp(0.0, surroundings.length_m);
            named.intervals.push((name, on_line(low), on_line(high)));
        }
        let or_drag = factor > certainty.little_less && may_drag(&effect, naming);
        Some((named, or_drag.then_some((EffectKind::TunnelDrag, 1.0)).into_iter().collect()))
    }

    fn sentence(&self, named: &Named, _: &Context<'_>) -> String {
        format!(
            "Traction power is capped from {}, at {} of what is described",
            section(named),
            scaled(named, "factor", 100.0, "%")
        )
    }

    fn hidden(&self, _: &str, hide: &mut Hide<'_>) -> Option<Value> {
        let from_m = hide.rng.random_range(1_500.0..3_000.0);
        let to_m = hide.rng.random_range(6_000.0..12_000.0);
        Some(json!({ "from_m": from_m, "to_m": to_m, "factor": hide.of([0.5, 0.65, 0.8]), "runs": 1.0 }))
    }
}
