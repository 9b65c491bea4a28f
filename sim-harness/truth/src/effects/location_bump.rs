//! Bad track: a raised cosine between two locations, the same in both directions and at every speed.

use super::{EffectError, Expect, Law, Moment, Setting, raised_cosine};
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LocationBump {
    pub from_m: f64,
    pub to_m: f64,
    pub drag_n_per_kg: f64,
}

impl Law for LocationBump {
    fn check(&self, expect: &Expect) -> Result<(), EffectError> {
        expect.section(self.from_m, self.to_m)?;
        expect.finite("drag_n_per_kg", self.drag_n_per_kg)
    }

    fn extra_n_per_kg(&self, setting: &Setting, at: &Moment) -> f64 {
        let (middle_m, half_m) = ((self.from_m + self.to_m) / 2.0, (self.to_m - self.from_m) / 2.0);
        // The middle of the train stands for all of it, so that both directions feel the same.
        let train_m = at.motion.location_m - setting.train.length_m / 2.0;
        self.drag_n_per_kg * raised_cosine((train_m - middle_m) / half_m)
    }

    fn section_mut(&mut self) -> Option<[&mut f64; 2]> {
        Some([&mut self.from_m, &mut self.to_m])
    }

    fn unknown_coordinate(&self) -> Option<&'static str> {
        Some("location")
    }
}
