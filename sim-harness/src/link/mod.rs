//! The host's end of a link to a board, real or emulated, and what is put between.
//!
//! In: an address such as `/dev/ttyACM0@115200`. Out: a [`HostLink`] that carries messages.
//!
//! ```text
//! address -> port (serial, TCP, stdin/stdout) -> SerialLink, or Slcan -> CanLink
//!         -> socket (Linux)                   -> CanLink
//! ```
//!
//! | question | module |
//! |---|---|
//! | which port, which link? | [`address`] |
//! | a port that does not wait | [`port`] |
//! | a CAN controller of Linux | [`socket`] |
//! | what was said, and when? | [`record`]: wraps any link |
#![cfg_attr(not(target_os = "linux"), doc = "\n[`socket`]: https://docs.kernel.org/networking/can.html")]

pub mod address;
pub mod port;
pub mod record;
#[cfg(target_os = "linux")]
pub mod socket;

use rundown::link::slcan::PortError;
use rundown::link::{Counters, Link, LinkError, Message};
use std::{io, time::Instant};

/// A link of any kind.
pub struct HostLink(Box<dyn Link<PortError = io::Error>>);

impl HostLink {
    /// Any link whose port fails as ports of the host do.
    pub fn new(link: impl Link<PortError = io::Error> + 'static) -> Self {
        Self(Box::new(link))
    }
}

impl Link for HostLink {
    type PortError = io::Error;

    fn send(&mut self, message: &[u8], now_us: u64) -> Result<(), LinkError<io::Error>> {
        self.0.send(message, now_us)
    }

    fn receive(&mut self, now_us: u64) -> Result<Option<Message>, LinkError<io::Error>> {
        self.0.receive(now_us)
    }

    fn is_sending(&self) -> bool {
        self.0.is_sending()
    }

    fn counters(&self) -> Counters {
        self.0.counters()
    }
}

/// The host's clock for a link: microseconds since it was made.
#[derive(Clone, Copy, Debug)]
pub struct Clock(Instant);

impl Clock {
    /// A clock that begins now.
    #[expect(clippy::new_without_default, reason = "a default says nothing of time")]
    pub fn new() -> Self {
        Self(Instant::now())
    }

    /// µs since its begin.
    pub fn now_us(&self) -> u64 {
        // 2^64 µs are half a million years.
        u64::try_from(self.0.elapsed().as_micros()).unwrap_or(u64::MAX)
    }
}

/// A link over SLCAN fails with the error of its port.
pub(crate) struct Unwrapped<L>(pub(crate) L);

impl<L: Link<PortError = PortError<io::Error>>> Link for Unwrapped<L> {
    type PortError = io::Error;

    fn send(&mut self, message: &[u8], now_us: u64) -> Result<(), LinkError<io::Error>> {
        self.0.send(message, now_us).map_err(unwrap_port)
    }

    fn receive(&mut self, now_us: u64) -> Result<Option<Message>, LinkError<io::Error>> {
        self.0.receive(now_us).map_err(unwrap_port)
    }

    fn is_sending(&self) -> bool {
        self.0.is_sending()
    }

    fn counters(&self) -> Counters {
        self.0.counters()
    }
}

fn unwrap_port(error: LinkError<PortError<io::Error>>) -> LinkError<io::Error> {
    match error {
        LinkError::Port(PortError::Port(error)) => LinkError::Port(error),
        LinkError::Port(PortError::Full) | LinkError::Full => LinkError::Full,
        LinkError::Length { found } => LinkError::Length { found },
        LinkError::Busy => LinkError::Busy,
        // A cause that is newer than this function.
        other => LinkError::Port(io::Error::other(other.to_string())),
    }
}
