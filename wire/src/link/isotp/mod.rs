//! ISO-TP: payloads longer than a CAN frame (ISO 15765-2, normal addressing).
//!
//! In: a payload of 1 to `N` bytes. Out: the data of CAN frames; and back.
//!
//! ```text
//! sender     SF ------------------>            the payload fits into one frame
//!
//! sender     FF --->        CF CF .. CF --->        CF CF .. --->
//! receiver       <--- FC                <--- FC                     FC: go on (block size, separation time), wait, or overflow
//! ```
//!
//! | part | module |
//! |---|---|
//! | the bytes of SF, FF, CF, FC | [`pdu`] |
//! | one payload out | [`sender`] |
//! | one payload in | [`receiver`] |
//!
//! Neither machine has a port or a clock: frames and `now_us` go in, frames come out. Frames are taken in the order of
//! their arrival; one that is missing, doubled or out of place ends the payload, which is then dropped as a whole. The
//! standard's names: N_Bs is the time that the sender waits for an FC, N_Cr the time that the receiver waits for a CF,
//! N_WFTmax the number of FCs that ask to wait.

pub mod pdu;
pub mod receiver;
pub mod sender;

pub use receiver::{Outcome, ReceiveError, Receiver};
pub use sender::{SendError, Sender};

use super::can::Format;
use pdu::SeparationTime;

/// How payloads are cut and how long the other side may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Config {
    /// Format of all frames that are sent, flow control, too. Both formats are received.
    pub format: Format,
    /// Consecutive frames that this side takes before it must send the next flow control; 0 for all.
    pub block_size: u8,
    /// Time that this side needs between consecutive frames.
    pub separation: SeparationTime,
    /// N_Bs and N_Cr: longest silence of the other side, µs.
    pub timeout_us: u64,
    /// N_WFTmax: how often in a row the other side may ask to wait.
    pub max_waits: u8,
}

impl Config {
    /// Classic frames. Eight of them in SLCAN are 192 bytes, which a receive ring of 512 bytes takes while the tick
    /// runs; the second is that of the standard.
    pub const CLASSIC: Self = Self {
        format: Format::Classic,
        block_size: 8,
        separation: SeparationTime::ZERO,
        timeout_us: 1_000_000,
        max_waits: 10,
    };

    /// FD frames with the faster bit rate for the data. Three of them in SLCAN are 402 bytes.
    pub const FD: Self = Self { format: Format::Fd { bit_rate_switch: true }, block_size: 3, ..Self::CLASSIC };
}

impl Default for Config {
    fn default() -> Self {
        Self::CLASSIC
    }
}
