//! A v³ term, k in N/(kg (m/s)³).

use super::*;

parameters!(CubicDrag { k: f64 });

impl Law for CubicDrag {
    fn extra_n_per_kg(&self, _setting: &Setting, at: &Moment) -> f64 {
        let v = at.motion.speed_mps;
        self.k * v * v * v
    }

    fn unknown_coordinate(&self) -> Option<&'static str> {
        Some("speed")
    }
}
