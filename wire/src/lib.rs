//! Rundown's frames: what the board says each tick, as another computer reads it. `no_std`, fixed memory.
//!
//! ```text
//! board: estimate -> Downlink -> message (version, postcard) -> link (serial: CRC, COBS; CAN style: ISO-TP) -> display
//! ```
//!
//! A display gives what its link brings to a [`Reader`], which finds the frames and counts what is lost;
//! `examples/display.rs` is one in thirty lines. [`Downlink::decode`] reads a single message. `WIRE.md` states every
//! byte.
//!
//! ```
//! use rundown_wire::{Body, Downlink};
//!
//! // version 1, sequence 7, tick 300, variant 9 (answer), to sequence 4, accepted
//! let message = [1, 7, 0xAC, 0x02, 9, 4, 0];
//! let frame = Downlink::decode(&message)?;
//! assert_eq!((frame.sequence, frame.tick), (7, 300));
//! assert!(matches!(frame.body, Body::Answer(answer) if answer.result.is_ok()));
//! # Ok::<(), rundown_wire::DecodeError>(())
//! ```
#![no_std]
#![forbid(unsafe_code)]
#![warn(missing_docs)]

#[macro_use]
mod errors;
#[macro_use]
mod catalogue;
mod coast;
mod downlink;
mod effects;
mod envelope;
mod health;
pub mod link;
mod reader;
mod words;

pub use coast::{CoastAhead, CoastArrival, CoastOutcome, CoastTarget};
pub use downlink::*;
pub use effects::{EffectKind, EffectParameter};
pub use envelope::{DecodeError, EncodeError, MAX_MESSAGE, VERSION, decode, encode};
pub use health::{FILE_TAIL, Failure, Health, LineCounts, ResetCause, Stalled};
pub use reader::{Order, Reader, Received, Tally, WINDOW};
pub use words::{Cause, Regime, Validity, Value};
