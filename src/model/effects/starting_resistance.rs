//! Starting resistance: bearings that stood have lost their film of grease or oil, and rolling builds it up again.
//!
//! ```text
//! extra = amplitude exp(-v / decay) x stood x cold
//!
//! stood = 1 - exp(-standing / standing_min)                    1 at the first start of a run
//! cold  = 1 + cold_per_degC max(10 °C - T, 0)                  1 without a temperature
//! ```
//!
//! How large: judgement, 0.025 to 0.25 N per kg of mass, by kind and load of the bearings, their temperature and how
//! long the train stood. An eighth of it with roller bearings in place of plain ones, and very small above 10 mph
//! (Johnson, *The Steam Locomotive*, 1942). The exponential and its dependence on time are the simplest forms with
//! these ends. Unlike `warm_up`, which lasts for minutes and comes once in a run, it is over with the first metres and
//! comes at each start.
//!
//! How long a train stood before its run nobody has measured: it is taken for long.

use super::{Law, Situation, StartingResistance};
use crate::Real;
use crate::extremes::Extremes;

/// Above this nobody has found a train harder to start, °C.
const MILD_C: Real = 10.0;

impl StartingResistance {
    /// Extra resistance in N/kg at a speed, after standing for this long; `None`: before the run.
    ///
    /// ```
    /// use rundown::model::effects::StartingResistance;
    ///
    /// let grease = StartingResistance { amplitude: 0.04, decay_kmh: 3.6, standing_min: 10.0, cold_per_deg_c: 0.02 };
    /// let r = |speed_mps, stood_s, temperature_c| grease.resistance_n_per_kg(speed_mps, stood_s, temperature_c);
    /// assert_eq!(r(0.0, None, None), 0.04);
    /// // At 1 m/s 37 % are left; a stop of 30 s brings back 5 %; at -15 °C it is half as much again.
    /// assert!((r(1.0, None, Some(20.0)) - 0.014_715).abs() < 1e-6);
    /// assert!((r(0.0, Some(30.0), None) - 0.001_951).abs() < 1e-6);
    /// assert!((r(0.0, None, Some(-15.0)) - 0.06).abs() < 1e-15);
    /// ```
    pub fn resistance_n_per_kg(&self, speed_mps: Real, stood_s: Option<Real>, temperature_c: Option<Real>) -> Real {
        let stood = stood_s.map_or(1.0, |stood_s| 1.0 - libm::exp(-stood_s / (60.0 * self.standing_min)));
        let cold = temperature_c.map_or(1.0, |at_c| 1.0 + self.cold_per_deg_c * (MILD_C - at_c).at_least(0.0));
        self.amplitude * libm::exp(-3.6 * speed_mps / self.decay_kmh) * stood * cold
    }
}

impl Law for StartingResistance {
    fn extra_n_per_kg(&self, at: &Situation<'_>) -> Real {
        self.resistance_n_per_kg(at.moment.speed_mps, at.moment.stood_s, at.moment.temperature_c)
    }
}
