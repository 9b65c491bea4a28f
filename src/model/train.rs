//! The train as its description states it: mass, length, manufacturer's Davis coefficients and limits.

use crate::Real;
use crate::extremes::Extremes;
use crate::model::bounds::{OutOfRange, Range, between, field_name};
use crate::model::resistance::Davis;
use crate::plain::plain;
use serde::{Deserialize, Serialize};

/// Largest effort of the weakest train, N/kg: less than any train needs to start on the level (r0 is near 0.01), so it
/// was stated in kN.
const LEAST_EFFORT_N_PER_KG: Real = 5e-3;
/// Largest power of the weakest train, W/kg: that effort at 10 m/s; less was stated in kW.
const LEAST_POWER_W_PER_KG: Real = 0.05;

/// A checked description of the train. Made by [`Train::try_new`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Train {
    description: TrainDescription,
    gravity_n_per_kg: Real,
    gravity_n_per_kg_m: Real,
}

/// What a train file or train frame states; unchecked.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct TrainDescription {
    /// Mass as loaded, kg.
    pub mass_kg: Real,
    /// Rotating mass factor γ: the mass that must be accelerated is γ m.
    pub rotating_mass_factor: Real,
    /// Length, m: the gradient is averaged over it.
    pub length_m: Real,
    /// Manufacturer's Davis coefficients: the start of the estimate.
    pub davis: Davis,
    /// Largest tractive effort, N.
    pub max_tractive_effort_n: Real,
    /// Largest tractive power, W.
    pub max_power_w: Real,
    /// Largest deceleration by brake, m/s², positive.
    pub max_brake_mps2: Real,
}

plain! {
    struct TrainDescription {
        mass_kg,
        rotating_mass_factor,
        length_m,
        davis,
        max_tractive_effort_n,
        max_power_w,
        max_brake_mps2,
    }
}

/// Number by number: field by field it would take the board four times the flash.
impl PartialEq for TrainDescription {
    fn eq(&self, other: &Self) -> bool {
        self.numbers() == other.numbers()
    }
}

impl TrainDescription {
    fn numbers(&self) -> [Real; 9] {
        let Self { mass_kg, rotating_mass_factor, length_m, davis, .. } = *self;
        let Self { max_tractive_effort_n, max_power_w, max_brake_mps2, .. } = *self;
        let Davis { r0, r1, r2 } = davis;
        [mass_kg, rotating_mass_factor, length_m, r0, r1, r2, max_tractive_effort_n, max_power_w, max_brake_mps2]
    }

    /// The train of the case study, section 4.1: a double-deck intercity unit of six carriages. Stands in examples and
    /// tests.
    pub const CASE_STUDY: Self = Self {
        mass_kg: 364e3,
        rotating_mass_factor: 1.06,
        length_m: 162.0,
        davis: Davis { r0: 7.38e-3, r1: 1.6e-4, r2: 2.8e-5 },
        max_tractive_effort_n: 192.92e3,
        max_power_w: 2.036e6,
        max_brake_mps2: 0.66,
    };
}

impl Train {
    const RANGES: [Range; 7] = [
        Range::new(field_name("mass_kg"), 1e3, 1e8),
        Range::new(field_name("rotating_mass_factor"), 1.0, 2.0),
        Range::new(field_name("length_m"), 1.0, 5000.0),
        Range::new(field_name("davis.r0"), 1e-5, 1.0),
        Range::new(field_name("davis.r1"), 0.0, 0.1),
        Range::new(field_name("davis.r2"), 0.0, 0.01),
        Range::new(field_name("max_brake_mps2"), 0.01, 10.0),
    ];

    /// Checks a description.
    ///
    /// # Errors
    /// [`OutOfRange`] names the first field that no train has (NaN included).
    ///
    /// ```
    /// use rundown::model::resistance::Davis;
    /// use rundown::model::train::{Train, TrainDescription};
    ///
    /// let description = TrainDescription {
    ///     mass_kg: 364e3, rotating_mass_factor: 1.06, length_m: 162.0,
    ///     davis: Davis { r0: 7.38e-3, r1: 1.6e-4, r2: 2.8e-5 },
    ///     max_tractive_effort_n: 192.92e3, max_power_w: 2.036e6, max_brake_mps2: 0.66,
    /// };
    /// let train = Train::try_new(description)?;
    /// assert!((train.max_effort_n_per_kg(20.0) - 0.2639).abs() < 1e-4);
    /// # Ok::<(), rundown::model::bounds::OutOfRange>(())
    /// ```
    pub fn try_new(description: TrainDescription) -> Result<Self, OutOfRange> {
        let d = &description;
        // Not a number there leaves a bound that refuses everything; the mass itself is refused first.
        let rotating_mass_kg = d.rotating_mass_factor * d.mass_kg;
        for (range, found) in Self::RANGES.iter().zip([
            d.mass_kg,
            d.rotating_mass_factor,
            d.length_m,
            d.davis.r0,
            d.davis.r1,
            d.davis.r2,
            d.max_brake_mps2,
        ]) {
            range.check(found)?;
        }
        for (field, found, least, most) in [
            (
                field_name("max_tractive_effort_n"),
                d.max_tractive_effort_n,
                LEAST_EFFORT_N_PER_KG * rotating_mass_kg,
                1e8,
            ),
            (field_name("max_power_w"), d.max_power_w, LEAST_POWER_W_PER_KG * rotating_mass_kg, 1e9),
        ] {
            between(field, found, least, most)?;
        }
        Ok(Self::new(description))
    }

    const fn new(description: TrainDescription) -> Self {
        // The only place where the division by γ is made.
        let gravity_n_per_kg = crate::model::units::GRAVITY_MPS2 / description.rotating_mass_factor;
        Self { description, gravity_n_per_kg, gravity_n_per_kg_m: gravity_n_per_kg / description.length_m }
    }

    /// The description that was checked.
    pub fn description(&self) -> &TrainDescription {
        &self.description
    }

    /// Manufacturer's Davis coefficients.
    pub fn davis(&self) -> Davis {
        self.description.davis
    }

    /// Length, m.
    pub fn length_m(&self) -> Real {
        self.description.length_m
    }

    /// Rotating mass γ m in kg: efforts per mass times this are forces in N.
    pub fn rotating_mass_kg(&self) -> Real {
        self.description.rotating_mass_factor * self.description.mass_kg
    }

    /// Weight over rotating mass, 9.80665 / γ in N/kg: turns a gradient (m/m) into a resistance per γ m.
    pub fn gravity_n_per_kg(&self) -> Real {
        self.gravity_n_per_kg
    }

    /// The same over the length of the train, in N/(kg m): turns the height of its front above its tail into a
    /// resistance per γ m.
    pub fn gravity_n_per_kg_m(&self) -> Real {
        self.gravity_n_per_kg_m
    }

    /// Stands in until a train is described; no run begins with it.
    pub(crate) const fn undescribed() -> Self {
        Self::new(TrainDescription {
            mass_kg: 1.0,
            rotating_mass_factor: 1.0,
            length_m: 1.0,
            davis: Davis { r0: 1.0, r1: 1.0, r2: 1.0 },
            max_tractive_effort_n: 1.0,
            max_power_w: 1.0,
            max_brake_mps2: 1.0,
        })
    }

    /// Largest brake effort per rotating mass, N/kg, positive.
    pub fn max_brake_n_per_kg(&self) -> Real {
        self.description.max_brake_mps2
    }

    /// Largest applicable effort in N/kg at a speed: constant effort below, constant power above the transition speed
    /// (section 4.4).
    pub fn max_effort_n_per_kg(&self, speed_mps: Real) -> Real {
        let by_power = self.description.max_power_w / speed_mps.at_least(Real::MIN_POSITIVE);
        self.description.max_tractive_effort_n.at_most(by_power) / self.rotating_mass_kg()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn description() -> TrainDescription {
        TrainDescription::CASE_STUDY
    }

    fn refused(spoil: impl Fn(&mut TrainDescription)) -> &'static str {
        let mut description = description();
        spoil(&mut description);
        match Train::try_new(description) {
            Err(error) => error.field,
            Ok(_) => "nothing",
        }
    }

    #[test]
    fn kilonewtons_and_kilowatts_are_not_taken_for_newtons_and_watts() {
        assert_eq!(refused(|_| ()), "nothing");
        assert_eq!(refused(|d| d.max_tractive_effort_n /= 1e3), "max_tractive_effort_n");
        assert_eq!(refused(|d| d.max_power_w /= 1e3), "max_power_w");
        // A heavy freight train behind a weak engine: 4000 t, 300 kN, 1.5 MW.
        let freight = |d: &mut TrainDescription| {
            (d.mass_kg, d.max_tractive_effort_n, d.max_power_w) = (4e6, 300e3, 1.5e6);
        };
        assert_eq!(refused(freight), "nothing");
    }
}
