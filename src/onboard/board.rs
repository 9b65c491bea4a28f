//! What the tasks need of a board: the contract between the metal and the firmware.
//!
//! - [`Board::start`] is called once, with interrupts off. It waits for nothing without a bound, starts the watchdog
//!   before it returns, and may come back with a [`Clock::Slow`]: a dead oscillator costs speed, not the estimates.
//!   `None`: the registers were taken already, and the firmware resets.
//! - The serial port has one interrupt, of priority 3, for bytes that came and for room to send; [`LinePort`] says what
//!   it must clear.
//! - The watchdog cannot be stopped, bites after 2 s, and its bite is [`ResetCause::Watchdog`] at the next start.
//! - The flash has [`RECORDS`](super::flash::RECORDS) bytes in pages that nothing else uses, and survives power that
//!   goes away at any moment.
//! - Two interrupts that no device uses run the tasks `tick` and `link`, and the system timer runs at 10 Hz.
//!
//! Beside the trait, in `src/board/`: RAM that a reset leaves as it is, the paint of the stack, panics and faults, all
//! by the linker's symbols of the board's `board.x`.

use super::clock::Clock;
use super::serial::LinePort;
use super::watchdog::Watchdog;
use embedded_storage::nor_flash::NorFlash;
use rundown_wire::ResetCause;

/// A board.
pub trait Board: Sized {
    /// The processor's own peripherals.
    type Core;
    /// The line to the outside.
    type Port: LinePort;
    /// Resets the board when it is not fed.
    type Watchdog: Watchdog;
    /// The pages for records.
    type Flash: NorFlash;

    /// Starts clock, system timer, serial line and watchdog.
    fn start(core: Self::Core) -> Option<Started<Self>>;

    /// Keeps the clock right, where something has to be done for it after the start. Called some ten times a second.
    /// False: what it is to be trimmed by does not run.
    fn trim_clock() -> bool {
        true
    }

    /// Errors that the flash has reported since boot.
    fn flash_errors() -> u32 {
        0
    }

    /// Fails where a test wants it. Only a test build does.
    fn provoke(_: FailurePoint) {}
}

/// A board that was started.
pub struct Started<B: Board> {
    /// Its serial line.
    pub port: B::Port,
    /// Running.
    pub watchdog: B::Watchdog,
    /// Its pages for records.
    pub flash: B::Flash,
    /// The clock in force.
    pub clock: Clock,
    /// Why it started.
    pub cause: ResetCause,
}

/// Where a test build can be made to fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FailurePoint {
    /// The task of the clock.
    Tick,
    /// The task of the line.
    Link,
}
