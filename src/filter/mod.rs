//! The Unscented Kalman Filter and what it stands on. Knows no train.

pub mod elimination;
pub mod gaussian;
pub mod general;
pub mod ukf;
