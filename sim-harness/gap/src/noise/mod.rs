//! The noise of the residuals: of rows, and between runs.

pub mod alike;
pub mod calibrate;
pub mod dragging;
pub mod dragging_units;
pub mod gradient_errors;
pub mod gradients;
pub mod habit_sizes;
pub mod habits;
pub mod own_wind;
pub mod whiteness;
pub mod whitening;
