//! Features of the driving style and of the train's limits, section 3.3.
//!
//! In: one [`Observation`] a tick, with its confirmed regime. Out: [`Features`], at any time. [`FeatureExtractor`] does
//! it.
//!
//! ```text
//! interval -> steady -> statistic     largest effort, power, brake rates
//!          -> energy
//!          -> phases -> onset -> approach     switching points, final coast and brake
//!                    -> cruise                held speeds
//! ```
//!
//! Assumes that effort, acceleration and regime of a tick speak of the interval that ends with it. Power is effort
//! times speed; the paper's "divided by" is a slip. Without readings there is less to count, and the counts say so.

mod approach;
mod config;
mod cruise;
mod energy;
mod extractor;
mod hindsight;
mod interval;
mod onset;
mod phases;
mod statistic;
mod steady;

pub use config::FeatureConfig;
pub use extractor::FeatureExtractor;

use crate::Real;
use crate::model::resistance::Davis;
use crate::plain::plain;
use crate::tick::regime::Regime;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Switching points kept in one run; later ones are counted only.
pub const MAX_SWITCHING_POINTS: usize = 48;

/// One tick as the features see it: its regime is the confirmed one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Observation {
    /// Time of the tick, s; on the clock of the run's beginning, also where the sender's is set meanwhile.
    pub time_s: Real,
    /// Time since the tick before, s.
    pub dt_s: Real,
    /// Location of the front along the track, m.
    pub location_m: Real,
    /// Speed as read, m/s; the filtered one where none was used.
    pub speed_mps: Real,
    /// Applied effort, mean since the tick before, N/kg; none when a reading was missing.
    pub effort_n_per_kg: Option<Real>,
    /// Acceleration, mean since the tick before, m/s²; none when a reading was missing.
    pub acceleration_mps2: Option<Real>,
    /// Resistance of the gradient, N/kg, uphill positive.
    pub gradient_n_per_kg: Real,
    /// Running resistance as estimated at this tick.
    pub davis: Davis,
    /// The regime of this tick.
    pub regime: Regime,
}

plain! {
    struct Observation {
        time_s,
        dt_s,
        location_m,
        speed_mps,
        effort_n_per_kg,
        acceleration_mps2,
        gradient_n_per_kg,
        davis,
        regime,
    }
}

impl Observation {
    /// Zeros.
    pub(crate) const ZEROED: Self = Self {
        time_s: 0.0,
        dt_s: 0.0,
        location_m: 0.0,
        speed_mps: 0.0,
        effort_n_per_kg: None,
        acceleration_mps2: None,
        gradient_n_per_kg: 0.0,
        davis: Davis { r0: 0.0, r1: 0.0, r2: 0.0 },
        regime: Regime::Standstill,
    };
}

/// Number of values, their mean and standard deviation (0 for fewer than two).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Statistic {
    /// Number of values.
    pub count: u32,
    /// Mean; 0 when there is none: look at `count`.
    pub mean: Real,
    /// Standard deviation of the values.
    pub sd: Real,
}

impl Statistic {
    /// No value.
    pub const NONE: Self = Self { count: 0, mean: 0.0, sd: 0.0 };
}

/// Effort as a straight line over speed, fitted between the configured speeds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EffortLine {
    /// Effort over the values of the fit, N/kg: count, mean, standard deviation about the line.
    pub effort: Statistic,
    /// Effort of the line at the lower end of the speed window, N/kg.
    pub at_lower_n_per_kg: Real,
    /// Slope of the line, N/kg per m/s.
    pub slope: Real,
}

impl EffortLine {
    /// The slope, when there are points enough for one.
    pub fn known_slope(&self) -> Option<Real> {
        (self.effort.count > 1).then_some(self.slope)
    }

    /// The standard deviation about the line, when points are left over for one: a line goes through any two.
    pub fn known_sd(&self) -> Option<Real> {
        (self.effort.count > 2).then_some(self.effort.sd)
    }
}

/// A stretch of one regime.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Phase {
    /// Time of its start, s, between two ticks where the speeds allow it.
    pub start_time_s: Real,
    /// Location of its start, m.
    pub start_location_m: Real,
    /// Speed at its start, m/s.
    pub start_speed_mps: Real,
    /// Duration, s.
    pub duration_s: Real,
    /// Length, m.
    pub length_m: Real,
}

/// Where one regime gave way to another.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SwitchingPoint {
    /// Time, s.
    pub time_s: Real,
    /// Location, m.
    pub location_m: Real,
    /// Speed, m/s.
    pub speed_mps: Real,
    /// Regime before.
    pub from: Regime,
    /// Regime after.
    pub to: Regime,
}

plain! {
    struct SwitchingPoint { time_s, location_m, speed_mps, from, to }
}

/// Energy per rotating mass, J/kg; resistance terms as taken from the train over the run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Energy {
    /// Work of the traction (efforts above 0, outside coasting and standstill).
    pub traction_j_per_kg: Real,
    /// Work taken out by the brake, positive.
    pub brake_j_per_kg: Real,
    /// Taken by r0.
    pub r0_j_per_kg: Real,
    /// Taken by r1 v.
    pub r1_j_per_kg: Real,
    /// Taken by r2 v².
    pub r2_j_per_kg: Real,
    /// Taken by the gradient, negative where the train came down.
    pub gradient_j_per_kg: Real,
}

plain! {
    struct Energy {
        traction_j_per_kg,
        brake_j_per_kg,
        r0_j_per_kg,
        r1_j_per_kg,
        r2_j_per_kg,
        gradient_j_per_kg,
    }
}

impl Energy {
    /// None.
    pub const ZEROED: Self = Self {
        traction_j_per_kg: 0.0,
        brake_j_per_kg: 0.0,
        r0_j_per_kg: 0.0,
        r1_j_per_kg: 0.0,
        r2_j_per_kg: 0.0,
        gradient_j_per_kg: 0.0,
    };
}

/// What one run said. Everything is there from the first tick on; what was not seen has count 0 or is none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Features {
    /// Largest tractive effort at low speed.
    pub max_effort: Option<EffortLine>,
    /// Tractive power per rotating mass while accelerating, effort times speed, W/kg; one value for each stretch of
    /// `window_s`, weighted with its time. Within 0.8 % of the true mean in 90 % of 400 runs
    /// (`host-tests/tests/features.rs`).
    pub power_w_per_kg: Statistic,
    /// Its largest value in the narrower window (red crosses of Fig. 9), W/kg. The largest of some values with the
    /// noise of readings in whole km/h: 6 % above the true power on average.
    pub max_power_w_per_kg: Option<Real>,
    /// Brake rates, positive, m/s², by ATB-EG step: above 130, 130-80, 80-60, 60-40, below 40 km/h.
    pub brake_rate_mps2: [Statistic; 5],
    /// Cruise speed, m/s: statistic of the speeds held at the fastest level (see `cruise.rs`), count in s.
    pub cruise_speed_mps: Statistic,
    /// Median of the same speeds, m/s (the paper's cruise speed); within 0.5 km/h in 90 % of 400 runs read in whole
    /// km/h every 10 s.
    pub cruise_speed_median_mps: Option<Real>,
    /// Coasting from which the final brake begins.
    pub final_coast: Option<Phase>,
    /// Brake by which the train leaves line speed for the last standstill; a low speed zone before the platform is
    /// inside it.
    pub final_brake: Option<Phase>,
    /// Where the regime changed, in order; short interruptions are bridged.
    pub switching_points: Vec<SwitchingPoint, MAX_SWITCHING_POINTS>,
    /// Switching points beyond the capacity.
    pub switching_points_lost: u32,
    /// Time in each regime, s, indexed by `Regime as usize`; each tick's time counts for its regime, only the interval
    /// of a stop is divided.
    pub regime_time_s: [Real; 5],
    /// Energy per rotating mass.
    pub energy: Energy,
}

impl Features {
    /// Nothing was seen.
    pub const NONE: Self = Self {
        max_effort: None,
        power_w_per_kg: Statistic::NONE,
        max_power_w_per_kg: None,
        brake_rate_mps2: [Statistic::NONE; 5],
        cruise_speed_mps: Statistic::NONE,
        cruise_speed_median_mps: None,
        final_coast: None,
        final_brake: None,
        switching_points: Vec::new(),
        switching_points_lost: 0,
        regime_time_s: [0.0; 5],
        energy: Energy::ZEROED,
    };
}
