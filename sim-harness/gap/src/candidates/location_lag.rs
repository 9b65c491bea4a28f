//! A location that is late.

use crate::candidates::kit::*;
use rundown::model::effects::LocationLag;

/// What the workflow knows of it.
pub static CANDIDATE: &dyn Candidate = &This;

struct This;

impl Candidate for This {
    fn kind(&self) -> Option<EffectKind> {
        Some(EffectKind::LocationLag)
    }

    fn page(&self) -> Option<Page> {
        Some(Page {
            what: "The location is late: a slow receiver or a slow bus.",
            law: "location shown at t = true location at t - lag",
            parameters: "lag_s",
            shows: "the location lags behind in proportion to the speed, so it jumps ahead when the train brakes",
            confused: "train_length_error, where only gradients tell",
            separates: "strong accelerations and brakings; the time stamp of the receiver itself",
        })
    }

    fn nature(&self) -> Nature {
        Nature { shows_in: ShowsIn::Readings, ..Nature::default() }
    }

    fn beside(&self, naming: &Naming<'_>) -> Option<(Named, Odds)> {
        let config = naming.context.config;
        let (lag_s, sd) = naming.kinematics.lag_that_matters(&config.kinematics)?;
        let sd = sd.hypot(config.kinematics.lag_sd_s);
        let effect = Effect::LocationLag(LocationLag { lag_s });
        let interval = around("lag_s", lag_s, sd);
        Some((Named::plain(effect, vec![interval], 0.5 * (lag_s / sd).powi(2), config.certainty.most_gain), Vec::new()))
    }

    fn sentence(&self, named: &Named, _: &Context<'_>) -> String {
        let Effect::LocationLag(e) = &named.effect else {
            return String::new();
        };
        format!(
            "The location comes {}, by {}",
            if e.lag_s > 0.0 { "late" } else { "early" },
            told(named, "lag_s", e.lag_s, e.lag_s.signum(), "s")
        )
    }

    fn on_screen(&self, named: &Named) -> String {
        let Effect::LocationLag(e) = &named.effect else {
            return String::new();
        };
        let side = if e.lag_s > 0.0 { "late" } else { "early" };
        format!("location_lag  the location comes {:.1} s {side}", e.lag_s.abs())
    }

    fn hidden(&self, _: &str, hide: &mut Hide<'_>) -> Option<Value> {
        Some(json!({ "lag_s": hide.of([5.0, 3.0, 2.0]) }))
    }

    fn main_parameter(&self, _: f64) -> Option<(&'static str, f64)> {
        Some(("lag_s", 0.0))
    }
}
