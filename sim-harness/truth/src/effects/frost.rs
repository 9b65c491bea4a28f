//! More resistance below a temperature (stiff grease), full 2 °C below it.

use super::*;

parameters!(Frost { below_c: f64, drag_n_per_kg: f64 });

impl Law for Frost {
    fn extra_n_per_kg(&self, _setting: &Setting, at: &Moment) -> f64 {
        self.drag_n_per_kg * ((self.below_c - at.temperature_c) / 2.0).clamp(0.0, 1.0)
    }

    fn unknown_coordinate(&self) -> Option<&'static str> {
        Some("temperature")
    }
}
