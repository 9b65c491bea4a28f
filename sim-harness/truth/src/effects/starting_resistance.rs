//! Bearings that stood turn hard at first; harder after long or cold standing. Before its run a train stood long.
//!
//! ```text
//! extra = amplitude exp(-v / decay) (1 - exp(-stood / standing)) (1 + cold max(10 °C - T, 0))
//! ```

use super::*;

parameters!(StartingResistance {
    amplitude: f64,
    decay_kmh: f64,
    standing_min: f64,
    #[serde(rename = "cold_per_degC", default)]
    cold_per_deg_c: f64
});

impl Law for StartingResistance {
    fn extra_n_per_kg(&self, _setting: &Setting, at: &Moment) -> f64 {
        let kmh = 3.6 * at.motion.speed_mps;
        let stood_min = at.stood_s.map_or(f64::INFINITY, |stood_s| stood_s / 60.0);
        let dry = -(-stood_min / self.standing_min).exp_m1();
        let colder_c = (10.0 - at.temperature_c).max(0.0);
        self.amplitude * dry * (1.0 + self.cold_per_deg_c * colder_c) / (kmh / self.decay_kmh).exp()
    }
}
