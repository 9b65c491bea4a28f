//! What a board needs besides the estimator, free of registers, so that the host tests it: serial line, watchdog, resets, clock, stack.
//!
//! ```text
//! registers (binary, src/board) --- traits ---> onboard (here) ---> tick and link task (binary, src/main.rs)
//! ```
//!
//! Nothing here blocks, and nothing here decides about estimates.

#[cfg(feature = "onboard")]
pub mod application;
#[cfg(feature = "onboard")]
pub mod auth;
#[cfg(feature = "onboard")]
mod bytes;
#[cfg(feature = "onboard")]
pub mod clock;
#[cfg(feature = "onboard")]
pub mod crash_loop;
#[cfg(feature = "onboard")]
pub mod frames;
#[cfg(feature = "onboard")]
pub mod kept;
#[cfg(feature = "onboard")]
pub mod outbox;
#[cfg(feature = "onboard")]
pub mod published;
#[cfg(feature = "onboard")]
pub mod serial;
#[cfg(feature = "onboard")]
pub mod stack;
#[cfg(feature = "onboard")]
pub mod stm32l4_flash;
#[cfg(feature = "onboard")]
pub mod store;
#[cfg(feature = "onboard")]
pub mod task;
#[cfg(feature = "onboard")]
pub mod train_id;
pub mod uplink;
#[cfg(feature = "onboard")]
pub mod watchdog;
