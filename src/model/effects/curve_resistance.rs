//! Curves: the wheels of a rigid bogie slide sideways and touch the rail with their flanges.
//!
//! ```text
//! extra = coefficient x g / γ x mean of Roeckl's formula under the train
//!
//! Roeckl: 0.650 / (R - 55 m) from R = 300 m on, 0.500 / (R - 30 m) below       N per N of weight
//! ```
//!
//! The formula jumps by 43 % at 300 m, which says how rough it is: hence the coefficient. Constants as in the textbooks
//! of railway engineering, where they stand in N/kN: 650 and 500 (Germany, Austria, Switzerland, Czechia, Hungary,
//! Romania). Cant, speed and lubrication are left out.

use super::{CurveResistance, Law, Situation};
use crate::Real;

impl CurveResistance {
    /// Extra resistance in N/kg. `gravity_n_per_kg` is g / γ; `mean_roeckl` the mean of
    /// [`roeckl`](crate::model::curves::roeckl) under the train,
    /// [`Track::mean_roeckl`](crate::model::track::Track::mean_roeckl).
    ///
    /// ```
    /// use rundown::model::curves::roeckl;
    /// use rundown::model::effects::CurveResistance;
    ///
    /// let curves = CurveResistance { coefficient_roeckl: 0.8 };
    /// // The whole train in a curve of 705 m: 0.8 permille.
    /// assert!((curves.resistance_n_per_kg(10.0, roeckl(705.0)) - 0.8 * 10.0 * 0.001).abs() < 1e-15);
    /// ```
    pub fn resistance_n_per_kg(&self, gravity_n_per_kg: Real, mean_roeckl: Real) -> Real {
        self.coefficient_roeckl * gravity_n_per_kg * mean_roeckl
    }
}

impl Law for CurveResistance {
    fn extra_n_per_kg(&self, at: &Situation<'_>) -> Real {
        let length_m = at.line.train.length_m();
        let mean = at.line.track.mean_roeckl(at.moment.location_m, length_m, at.line.direction);
        self.resistance_n_per_kg(at.gravity_n_per_kg(), mean)
    }
}
