//! What of section 3.3 depends on the network and the train: speed windows, brake steps, lengths of time.
//!
//! The defaults are those of the case study. Its discards of section 4.4 are in the windows: efforts below 10 and between 30 and 50 km/h lie in none,
//! nor do those near the line's top speed of 140 km/h.

use crate::Real;
use crate::model::units::KmPerHour;
use crate::tick::bounds::{ConfigError, between};
use serde::{Deserialize, Serialize};

/// Settings of the features. Windows include their edges.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FeatureConfig {
    /// Speeds of the fit of the largest effort, km/h (section 3.3).
    pub effort_window_kmh: [Real; 2],
    /// Speeds of the mean power, km/h (section 3.3).
    pub power_window_kmh: [Real; 2],
    /// Speeds of the largest power, km/h (Fig. 9).
    pub max_power_window_kmh: [Real; 2],
    /// Edges of the ATB-EG steps, falling, km/h (section 3.3).
    pub brake_steps_kmh: [Real; 4],
    /// Interruptions of a phase of at most this many ticks (or as many times `window_s`) are bridged; 0 bridges none.
    pub bridge_samples: u32,
    /// An interruption whose effort moves the speed by more than this is real at any length, and so is a turn of power inside one tick of a coast, km/h.
    /// Rounding to 1 km/h alone can make 1.
    pub bridge_speed_kmh: Real,
    /// Below this the train comes to a stop within the interval, km/h.
    pub stop_speed_kmh: Real,
    /// Time over which a rate is taken, s: the sampling of the case study. Ticks that come faster are taken together.
    pub window_s: Real,
    /// Width of one cruising level, km/h: cruising slower than the fastest by more than this belongs to another level.
    pub cruise_band_kmh: Real,
    /// Coasting and re-accelerating that change the speed by no more than this hold the speed, km/h.
    pub cruise_cycle_kmh: Real,
    /// Share of the top speed since the last stop below which the train has left line speed and approaches the platform.
    pub approach_share: Real,
}

impl Default for FeatureConfig {
    fn default() -> Self {
        Self {
            effort_window_kmh: [10.0, 30.0],
            power_window_kmh: [50.0, 130.0],
            max_power_window_kmh: [50.0, 90.0],
            brake_steps_kmh: [130.0, 80.0, 60.0, 40.0],
            bridge_samples: 2,
            bridge_speed_kmh: 1.6,
            stop_speed_kmh: 1.0,
            window_s: 10.0,
            cruise_band_kmh: 10.0,
            cruise_cycle_kmh: 8.0,
            approach_share: 0.5,
        }
    }
}

impl FeatureConfig {
    /// Called once, where the estimator is made.
    ///
    /// # Errors
    /// [`ConfigError`] names the field that cannot be used.
    ///
    /// ```
    /// use rundown::{features::FeatureConfig, tick::bounds::ConfigError};
    ///
    /// assert_eq!(FeatureConfig::default().check(), Ok(()));
    /// let swapped = FeatureConfig { effort_window_kmh: [30.0, 10.0], ..Default::default() };
    /// let error = ConfigError::Window { field: "effort_window_kmh", found: [30.0, 10.0] };
    /// assert_eq!(swapped.check(), Err(error));
    /// ```
    pub fn check(&self) -> Result<(), ConfigError> {
        for (field, found) in [
            ("effort_window_kmh", self.effort_window_kmh),
            ("power_window_kmh", self.power_window_kmh),
            ("max_power_window_kmh", self.max_power_window_kmh),
        ] {
            let [lower, upper] = found;
            if !(0.0 <= lower && lower < upper && upper.is_finite()) {
                return Err(ConfigError::Window { field, found });
            }
        }
        let [a, b, c, d] = self.brake_steps_kmh;
        if !(a.is_finite() && a > b && b > c && c > d && d > 0.0) {
            return Err(ConfigError::StepsNotFalling { field: "brake_steps_kmh", found: self.brake_steps_kmh });
        }
        for (field, found, most) in [
            ("bridge_samples", Real::from(self.bridge_samples), 10.0),
            ("bridge_speed_kmh", self.bridge_speed_kmh, 50.0),
            ("stop_speed_kmh", self.stop_speed_kmh, 20.0),
            ("cruise_cycle_kmh", self.cruise_cycle_kmh, 50.0),
            ("approach_share", self.approach_share, 1.0),
        ] {
            between(field, found, 0.0, most)?;
        }
        between("window_s", self.window_s, 1.0, 60.0)?;
        between("cruise_band_kmh", self.cruise_band_kmh, 1.0, 100.0)
    }

    /// Both ends of an interval lie in the window; its edges belong to it.
    pub(super) fn contains(window_kmh: [Real; 2], lower_mps: Real, upper_mps: Real) -> bool {
        let [lower, upper] = window_kmh.map(|kmh| KmPerHour(kmh).to_mps());
        lower_mps >= lower && upper_mps <= upper
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refusal_names_the_field() {
        let steps = FeatureConfig { brake_steps_kmh: [130.0, 80.0, 80.0, 40.0], ..Default::default() };
        assert!(matches!(steps.check(), Err(ConfigError::StepsNotFalling { field: "brake_steps_kmh", .. })));
        let window = FeatureConfig { window_s: Real::NAN, ..Default::default() };
        assert!(matches!(window.check(), Err(ConfigError::OutOfRange { field: "window_s", .. })));
        let nan = FeatureConfig { power_window_kmh: [50.0, Real::NAN], ..Default::default() };
        assert!(matches!(nan.check(), Err(ConfigError::Window { field: "power_window_kmh", .. })));
    }

    #[test]
    fn windows_include_their_edges() {
        let window = [50.0, 130.0];
        assert!(FeatureConfig::contains(window, 50.0 / 3.6, 130.0 / 3.6));
        assert!(!FeatureConfig::contains(window, 49.9 / 3.6, 60.0 / 3.6));
        assert!(!FeatureConfig::contains(window, 120.0 / 3.6, 130.1 / 3.6));
    }
}
