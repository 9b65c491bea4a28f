//! Tunnel: more air drag for the part of the train inside.
//!
//! ```text
//! extra = k v² x share inside         k in N/(kg (m/s)²) of the described train
//! ```

use super::*;

parameters!(TunnelDrag { from_m: f64, to_m: f64, k: f64 });

impl Law for TunnelDrag {
    fn extra_n_per_kg(&self, setting: &Setting, at: &Moment) -> f64 {
        let v = at.motion.speed_mps;
        let front_m = at.motion.location_m;
        let tail_m = front_m - setting.train.length_m;
        let inside_m = (front_m.min(self.to_m) - tail_m.max(self.from_m)).max(0.0);
        let share = inside_m / setting.train.length_m;
        setting.described_over_true_mass * self.k * v * v * share
    }

    fn section_mut(&mut self) -> Option<[&mut f64; 2]> {
        Some([&mut self.from_m, &mut self.to_m])
    }
}
