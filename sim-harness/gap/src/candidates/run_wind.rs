//! A wind that differs from run to run.

use crate::candidates::kit::*;
use rundown::model::effects::RunWind;

pub struct This;

impl Candidate for This {
    fn facts(&self) -> Facts {
        Facts {
            kind: Some(EffectKind::RunWind),
            what: "Wind that differs from run to run.",
            law: "r2 (v + w)² with another w in every run",
            parameters: "sd_mps of w between the runs; each run's own w is in `per_run`",
            shows: "each run has its own difference, which grows with the speed, and the mean over the runs is none",
            confounded: "loads that differ (a difference under effort, not with the speed)",
            separates: "the wind of each day; an effort column, which shows the load",
            nature: Nature { shows_in: ShowsIn::Runs, ..Nature::default() },
            size: Some(("sd_mps", 0.0)),
            ..Facts::default()
        }
    }

    fn beside(&self, naming: &Naming<'_>) -> Option<(Named, Odds)> {
        let (sd_mps, sd) = naming.run_wind?;
        let config = naming.context.config;
        if sd_mps > config.certainty.most_wind_mps {
            return None;
        }
        let effect = RunWind { sd_mps }.into();
        let interval = around("sd_mps", sd_mps, sd);
        // Without an effort column nobody knows when a brake was applied.
        let or_drag = !naming.measured || naming.wind_gain < config.between_runs.wind_or_drag_gain;
        let rivals = or_drag.then_some((EffectKind::DraggingBrake, 1.0));
        let named = Named::plain(effect, vec![interval], naming.wind_gain, config.certainty.most_gain);
        Some((named, rivals.into_iter().collect()))
    }

    fn separated_from(&self, other: EffectKind) -> Option<&'static str> {
        (other == EffectKind::DraggingBrake).then_some("longer coasting, from high speed to low")
    }

    fn sentence(&self, named: &Named, _: &Context<'_>) -> String {
        format!("A wind that differs from run to run, with a standard deviation of {}", with_unit(named, "sd_mps"))
    }

    fn hidden(&self, _: &str, hide: &mut Hide<'_>) -> Option<Value> {
        Some(json!({ "sd_mps": hide.of([4.0, 2.5, 1.2]) }))
    }
}
