//! The metal: registers and linker symbols. The only place with `unsafe`; what can be decided without a register is in
//! `rundown::onboard`, and what a board must offer in `rundown::onboard::board`.
//!
//! | here | what |
//! |---|---|
//! | `l475` | ST B-L475E-IOT01A |
//! | `mps2` | Arm MPS2 AN386, test-only, in the emulator |
//! | `ram_flash` | RAM that plays the flash, in the emulator |
//! | `kept_ram` | RAM that survives a reset |
//! | `painted_stack` | how deep the stack has been |
//! | `fallen` | panics and faults: write down why, then reset |
//! | `memory` | copies and fills of memory, for the compiler |
//! | `soft_doubles` | sums and products of doubles, for the compiler |
//! | `provisioning` | the record that was written at the depot |
//! | `stopwatch` | time in counts of the system timer |

mod fallen;
pub mod kept_ram;
mod memory;
pub mod painted_stack;
pub mod provisioning;
#[cfg(any(feature = "mps2", feature = "emulator"))]
mod ram_flash;
mod soft_doubles;
pub mod stopwatch;

#[cfg(not(feature = "mps2"))]
mod l475;
#[cfg(all(feature = "can", not(feature = "mps2")))]
pub use l475::can;
#[cfg(not(feature = "mps2"))]
pub use l475::{L475 as Metal, device};

#[cfg(feature = "mps2")]
mod mps2;
#[cfg(feature = "mps2")]
pub use mps2::{Mps2 as Metal, device};

/// Speed of the serial line, bit/s.
#[cfg_attr(feature = "mps2", expect(dead_code, reason = "the emulated port takes any"))]
pub const BAUD: u32 = 115_200;
/// Bit rate on CAN, bit/s: one of CiA 301's, 125 k to 1 M, as the bus has it.
#[cfg(feature = "can")]
pub const CAN_BIT_S: u32 = 250_000;

#[cfg(all(feature = "can", feature = "mps2"))]
compile_error!("the mps2-an386 has no CAN controller");
