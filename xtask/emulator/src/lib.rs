//! The firmware in QEMU: its serial line, its memory, the loss of power. Used by `xtask` and by the tests.
//!
//! ```no_run
//! use emulator::{Board, Emulator, Settings};
//! use std::io::Write;
//!
//! let mut emulator = Emulator::start(&Settings::new(Board::L475)?)?;
//! emulator.line().write_all(&[0])?;
//! let ram = emulator.memory(0x2000_0000, 16)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Time in the emulator counts instructions (16 ns each, 62.5 million a second), not the host's clock: runs repeat.
//! While the processor sleeps, time goes with the host's clock, or jumps to the next interrupt ([`Sleep`]).
#![forbid(unsafe_code)]
#![warn(missing_docs)]

mod board;
mod flash_file;
mod image;
mod machine;
mod qmp;

pub use board::{Board, NoImage};
pub use flash_file::{FlashFile, Provoke};
pub use image::{Image, ImageError};
pub use machine::{Emulator, EmulatorError, NS_PER_INSTRUCTION, Settings, Sleep, version};
