//! What a board needs besides the estimator, free of registers, so that the host tests it: serial line, CAN, watchdog,
//! resets, clock, stack.
//!
//! ```text
//! registers (src/board) --- traits ---> onboard (here) ---> tick and link task (src/bin/firmware)
//! ```
//!
//! Nothing here blocks, and nothing here decides about estimates.

pub mod application;
pub mod auth;
pub mod board;
mod bytes;
pub mod can;
pub mod clock;
pub mod crash_loop;
pub mod doubles;
pub mod event;
pub mod flash;
pub mod frames;
pub mod kept;
pub mod outbox;
pub mod serial;
pub mod stack;
pub mod stm32l4_flash;
pub mod stm32l4_serial;
pub mod store;
pub mod task;
pub mod train_id;
pub mod versions;
pub mod watchdog;
