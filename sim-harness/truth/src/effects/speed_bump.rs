//! More resistance around a speed (bogies that hunt), a raised cosine of this half-width.

use super::*;

parameters!(SpeedBump { at_kmh: f64, half_width_kmh: f64, drag_n_per_kg: f64 });

impl Law for SpeedBump {
    fn check(&self, expect: &Expect) -> Result<(), EffectError> {
        expect.above_zero("half_width_kmh", self.half_width_kmh)
    }

    fn extra_n_per_kg(&self, _setting: &Setting, at: &Moment) -> f64 {
        self.drag_n_per_kg * raised_cosine((3.6 * at.motion.speed_mps - self.at_kmh) / self.half_width_kmh)
    }

    fn unknown_coordinate(&self) -> Option<&'static str> {
        Some("speed")
    }
}
