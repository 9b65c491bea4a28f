//! What a board needs besides the estimator, free of registers, so that the host tests it: serial line, watchdog, resets, clock, stack.
//!
//! ```text
//! registers (binary, src/board) --- traits ---> onboard (here) ---> tick and link task (binary, src/main.rs)
//! ```
//!
//! Nothing here blocks, and nothing here decides about estimates.

pub mod clock;
pub mod crash_loop;
pub mod kept;
pub mod outbox;
pub mod serial;
pub mod stack;
pub mod watchdog;
