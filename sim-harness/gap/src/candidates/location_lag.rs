//! A location that is late.

use crate::candidates::kit::*;
use rundown::model::effects::LocationLag;

pub struct This;

impl Candidate for This {
    fn facts(&self) -> Facts {
        Facts {
            kind: Some(EffectKind::LocationLag),
            what: "The location is late: a slow receiver or a slow bus.",
            law: "location shown at t = true location at t - lag",
            parameters: "lag_s",
            shows: "the location lags behind in proportion to the speed, so it jumps ahead when the train brakes",
            confounded: "train_length_error, where only gradients show it",
            separates: "strong accelerations and brakings; the time stamp of the receiver itself",
            nature: Nature { shows_in: ShowsIn::Readings, ..Nature::default() },
            size: Some(("lag_s", 0.0)),
            ..Facts::default()
        }
    }

    fn beside(&self, naming: &Naming<'_>) -> Option<(Named, Odds)> {
        let config = naming.context.config;
        let (lag_s, sd) = naming.kinematics.lag_that_matters(&config.kinematics)?;
        let sd = sd.hypot(config.kinematics.lag_sd_s);
        let effect = LocationLag { lag_s }.into();
        let interval = around("lag_s", lag_s, sd);
        Some((Named::plain(effect, vec![interval], 0.5 * (lag_s / sd).powi(2), config.certainty.most_gain), Vec::new()))
    }

    fn sentence(&self, named: &Named, _: &Context<'_>) -> String {
        format!(
            "The location comes {}, by {}",
            if named.value("lag_s") > 0.0 { "late" } else { "early" },
            scaled(named, "lag_s", named.value("lag_s").signum(), "s")
        )
    }

    fn hidden(&self, _: &str, hide: &mut Hide<'_>) -> Option<Value> {
        Some(json!({ "lag_s": hide.of([5.0, 3.0, 2.0]) }))
    }
}
