//! Dragging brake: a brake that does not release fully after it was applied.
//!
//! ```text
//! extra = drag from the first brake application of the run on, before it 0
//! ```
//!
//! In which runs it dragged is the analyst's knowledge (`runs` beside the effect in a model file); on board it is a
//! state of the vehicle, in force until it is taken out.

use super::{DraggingBrake, Law, Situation};
use crate::Real;

impl DraggingBrake {
    /// Extra resistance in N/kg, by whether a brake was applied since the departure.
    ///
    /// ```
    /// use rundown::model::effects::DraggingBrake;
    ///
    /// let stuck = DraggingBrake { drag_n_per_kg: 0.01 };
    /// assert_eq!((stuck.resistance_n_per_kg(false), stuck.resistance_n_per_kg(true)), (0.0, 0.01));
    /// ```
    pub fn resistance_n_per_kg(&self, braked: bool) -> Real {
        if braked { self.drag_n_per_kg } else { 0.0 }
    }
}

impl Law for DraggingBrake {
    fn extra_n_per_kg(&self, at: &Situation<'_>) -> Real {
        self.resistance_n_per_kg(at.moment.braked)
    }
}
