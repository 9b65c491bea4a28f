//! How the board is, as the tick task hands it to the status frame.

use crate::onboard::clock::Clock;
use crate::onboard::kept::Boot;
use crate::onboard::serial::LineCounts;

/// A reading of everything that the board counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Health {
    /// Since boot, ms.
    pub uptime_ms: u32,
    /// Why it began, and what follows.
    pub boot: Boot,
    /// The clock in force.
    pub clock: Clock,
    /// The serial line.
    pub line: LineCounts,
    /// Frames that the line did not take.
    pub frames_dropped: u32,
    /// Deepest use of the stack, bytes.
    pub stack_bytes: u32,
    /// Longest time that one call of the application took, µs. Only below 100 ms; longer ones read too short.
    pub longest_us: u32,
    /// Double-bit errors that the flash reported.
    pub flash_errors: u32,
}
