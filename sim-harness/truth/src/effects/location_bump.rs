//! Bad track: a raised cosine between two locations, the same in both directions and at every speed.

use super::*;

parameters!(LocationBump { from_m: f64, to_m: f64, drag_n_per_kg: f64 });

impl Law for LocationBump {
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
