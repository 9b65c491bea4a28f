//! What of section 3.3 depends on the network and the train: speed windows, brake steps, lengths of time.
//!
//! The defaults are those of the case study. Its discards of section 4.4 are in the windows: efforts below 10 and
//! between 30 and 50 km/h lie in none, nor do those near the line's top speed of 140 km/h.

use crate::Real;
use crate::model::bounds::field_name;
use crate::model::units::KmPerHour;
use crate::tick::bounds::{Check, ConfigError, settings};

settings! {
    /// Settings of the features. Windows include their edges.
    FeatureConfig in "features" {
        /// Speeds of the fit of the largest effort, km/h (section 3.3).
        effort_window_kmh: [Real; 2] = [10.0, 30.0];
        /// Speeds of the mean power, km/h (section 3.3).
        power_window_kmh: [Real; 2] = [50.0, 130.0];
        /// Speeds of the largest power, km/h (Fig. 9).
        max_power_window_kmh: [Real; 2] = [50.0, 90.0];
        /// Edges of the ATB-EG steps, falling, km/h (section 3.3).
        brake_steps_kmh: [Real; 4] = [130.0, 80.0, 60.0, 40.0];
        /// Interruptions of a phase of at most this many ticks (or as many times `window_s`) are bridged; 0 bridges
        /// none.
        bridge_samples: u32 = 2, 0.0 to 10.0;
        /// An interruption whose effort moves the speed by more than this is real at any length, and so is an on/off
        /// cycle inside one tick of a coast, km/h. Rounding to 1 km/h alone can make 1.
        bridge_speed_kmh: Real = 1.6, 0.0 to 50.0;
        /// Below this the train comes to a stop within the interval, km/h.
        stop_speed_kmh: Real = 1.0, 0.0 to 20.0;
        /// Time over which a rate is taken, s: the sampling of the case study. Ticks that come faster are taken
        /// together.
        window_s: Real = 10.0, 1.0 to 60.0;
        /// Width of one cruising level, km/h: cruising slower than the fastest by more than this belongs to another
        /// level.
        cruise_band_kmh: Real = 10.0, 1.0 to 100.0;
        /// Coasting and re-accelerating that change the speed by no more than this hold the speed, km/h.
        cruise_cycle_kmh: Real = 8.0, 0.0 to 50.0;
        /// Share of the top speed since the last stop below which the train has left line speed and approaches the
        /// platform.
        approach_share: Real = 0.5, 0.0 to 1.0;
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
    /// let error = ConfigError::Window { field: "features.effort_window_kmh", found: [30.0, 10.0] };
    /// assert_eq!(swapped.check(), Err(error));
    /// ```
    pub fn check(&self) -> Result<(), ConfigError> {
        for (field, found) in [
            (field_name("features.effort_window_kmh"), self.effort_window_kmh),
            (field_name("features.power_window_kmh"), self.power_window_kmh),
            (field_name("features.max_power_window_kmh"), self.max_power_window_kmh),
        ] {
            let [lower, upper] = found;
            if !(0.0 <= lower && lower < upper && upper.is_finite()) {
                return Err(ConfigError::Window { field, found });
            }
        }
        let [a, b, c, d] = self.brake_steps_kmh;
        if !(a.is_finite() && a > b && b > c && c > d && d > 0.0) {
            return Err(ConfigError::StepsNotFalling {
                field: field_name("features.brake_steps_kmh"),
                found: self.brake_steps_kmh,
            });
        }
        let mut check = Check::default();
        self.check_ranges(&mut check);
        Ok(check.result()?)
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
    use crate::tick::bounds::OutOfRange;

    #[test]
    fn a_refusal_names_the_field() {
        let steps = FeatureConfig { brake_steps_kmh: [130.0, 80.0, 80.0, 40.0], ..Default::default() };
        assert!(matches!(steps.check(), Err(ConfigError::StepsNotFalling { field: "features.brake_steps_kmh", .. })));
        let window = FeatureConfig { window_s: Real::NAN, ..Default::default() };
        assert!(matches!(window.check(), Err(ConfigError::OutOfRange(OutOfRange { field: "features.window_s", .. }))));
        let nan = FeatureConfig { power_window_kmh: [50.0, Real::NAN], ..Default::default() };
        assert!(matches!(nan.check(), Err(ConfigError::Window { field: "features.power_window_kmh", .. })));
    }

    #[test]
    fn windows_include_their_edges() {
        let window = [50.0, 130.0];
        assert!(FeatureConfig::contains(window, 50.0 / 3.6, 130.0 / 3.6));
        assert!(!FeatureConfig::contains(window, 49.9 / 3.6, 60.0 / 3.6));
        assert!(!FeatureConfig::contains(window, 120.0 / 3.6, 130.1 / 3.6));
    }
}
