//! A board on the host, its flash and its lines, whole and broken, for tests.
//!
//! Nothing of the harness: what the board's own code must do is built and asked in seconds, for each mutant.
#![warn(missing_docs)]

pub mod board;
pub mod described;
pub mod faults;
pub mod flash;
pub mod pipe;
pub mod port;
pub mod prelude;
pub mod serial_board;
