//! What the integration tests share: the task on a board of the host and of the emulator, a flash that fails, a CAN
//! controller, the textbook filter, the steps of a true run, and the measure of accuracy.

#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod accuracy;
pub mod can_controller;
pub mod coasting;
pub mod fields;
pub mod flash_controller;
pub mod moving;
pub mod plays;
pub mod prelude;
pub mod project;
pub mod reference;
pub mod target;
pub mod textbook;

pub use board_tests::{board, flash, said};
