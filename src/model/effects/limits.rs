//! What the train can do at most.

use crate::Real;
use crate::extremes::Extremes;
use crate::model::train::Train;

/// Largest effort, power and brake per rotating mass γ m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Largest tractive effort, N/kg.
    pub effort_n_per_kg: Real,
    /// Largest tractive power, W/kg.
    pub power_w_per_kg: Real,
    /// Largest brake effort, N/kg, positive.
    pub brake_n_per_kg: Real,
}

impl Limits {
    /// As the train is described.
    pub fn of(train: &Train) -> Self {
        let rotating_mass_kg = train.rotating_mass_kg();
        Self {
            effort_n_per_kg: train.description().max_tractive_effort_n / rotating_mass_kg,
            power_w_per_kg: train.description().max_power_w / rotating_mass_kg,
            brake_n_per_kg: train.max_brake_n_per_kg(),
        }
    }

    /// Largest tractive effort at a speed, N/kg: constant effort below, constant power above the transition speed.
    ///
    /// ```
    /// use rundown::model::effects::Limits;
    ///
    /// let limits = Limits { effort_n_per_kg: 0.5, power_w_per_kg: 5.0, brake_n_per_kg: 0.66 };
    /// assert_eq!(limits.traction_n_per_kg(0.0), 0.5);
    /// assert_eq!(limits.traction_n_per_kg(20.0), 0.25);
    /// ```
    pub fn traction_n_per_kg(&self, speed_mps: Real) -> Real {
        let by_power = self.power_w_per_kg / speed_mps.at_least(Real::MIN_POSITIVE);
        self.effort_n_per_kg.at_most(by_power)
    }
}
