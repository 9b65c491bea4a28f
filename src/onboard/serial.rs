//! The interrupt of a serial port: bytes from the line into a ring, frames of the outbox onto the line, errors counted
//! by cause.
//!
//! In: a port as the `embedded-hal-nb` traits describe it. Out: bytes in a ring, for the link task. Bounded: one call
//! takes at most [`MOST_PER_CALL`] bytes from the line, so a line that babbles cannot hold the processor in the
//! interrupt. When the ring is full the newest byte is dropped and counted; the frame it belonged to fails its check.

use crate::onboard::outbox::Outbox;
use core::sync::atomic::{AtomicU32, Ordering};
use embedded_hal_nb::nb;
use embedded_hal_nb::serial::{Error, ErrorKind, Read, Write};
use heapless::spsc::Producer;
pub use rundown_wire::LineCounts;

/// Bytes that one interrupt takes at most; the next interrupt takes the rest.
pub const MOST_PER_CALL: usize = 16;

/// What a port must offer beyond reading and writing a byte.
///
/// `read` must clear the error flag that it reports, or the interrupt never ends.
pub trait LinePort: Read<u8> + Write<u8> {
    /// Asks for an interrupt when a byte can be written, or does not ask any more.
    fn interrupt_when_writable(&mut self, on: bool);

    /// Bytes that had come and that it gave up with the error that it said last; where it cannot know, at least so
    /// many. Asked once for each error.
    fn given_up(&mut self) -> u32 {
        0
    }
}

/// What went wrong on the line, counted since boot. Shared between the interrupt and the tasks, so each is an atomic.
#[derive(Debug, Default)]
pub struct LineErrors {
    overrun: AtomicU32,
    framing: AtomicU32,
    noise: AtomicU32,
    other: AtomicU32,
    ring_full: AtomicU32,
}

impl LineErrors {
    /// All zero.
    pub const fn new() -> Self {
        Self {
            overrun: AtomicU32::new(0),
            framing: AtomicU32::new(0),
            noise: AtomicU32::new(0),
            other: AtomicU32::new(0),
            ring_full: AtomicU32::new(0),
        }
    }

    /// As they stand now.
    pub fn counts(&self) -> LineCounts {
        LineCounts {
            overrun: self.overrun.load(Ordering::Relaxed),
            framing: self.framing.load(Ordering::Relaxed),
            noise: self.noise.load(Ordering::Relaxed),
            other: self.other.load(Ordering::Relaxed),
            ring_full: self.ring_full.load(Ordering::Relaxed),
        }
    }

    /// An error. To be counted by interrupts of one priority only.
    pub fn count(&self, kind: ErrorKind) {
        let counter = match kind {
            ErrorKind::Overrun => &self.overrun,
            ErrorKind::FrameFormat => &self.framing,
            ErrorKind::Noise => &self.noise,
            _ => &self.other,
        };
        add(counter, 1);
    }

    /// A byte or frame for which the queue had no room.
    pub fn count_full(&self) {
        self.count_dropped(1);
    }

    /// Bytes that had come and are lost.
    fn count_dropped(&self, bytes: u32) {
        add(&self.ring_full, bytes);
    }
}

/// Only interrupts of one priority write, so load and store need not be one step.
fn add(counter: &AtomicU32, more: u32) {
    let next = counter.load(Ordering::Relaxed).saturating_add(more);
    counter.store(next, Ordering::Relaxed);
}

/// What a call of [`serve`] found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Served {
    /// Bytes have come, for the link task to be woken.
    pub came: bool,
    /// There may be more: a port that collects bytes asks for no interrupt for these.
    pub more: bool,
}

/// What the port's interrupt does.
pub fn serve<const N: usize>(
    port: &mut impl LinePort,
    ring: &mut Producer<'_, u8>,
    outbox: &mut Outbox<N>,
    errors: &LineErrors,
) -> Served {
    let mut served = Served { came: false, more: true };
    for _ in 0..MOST_PER_CALL {
        match port.read() {
            Ok(byte) => {
                served.came = true;
                if ring.enqueue(byte).is_err() {
                    errors.count_full();
                }
            }
            Err(nb::Error::WouldBlock) => {
                served.more = false;
                break;
            }
            Err(nb::Error::Other(error)) => {
                errors.count(error.kind());
                errors.count_dropped(port.given_up());
            }
        }
    }
    send(port, outbox);
    served
}

/// Starts sending what waits; the interrupt does the rest.
pub fn send<const N: usize>(port: &mut impl LinePort, outbox: &mut Outbox<N>) {
    loop {
        let bytes = outbox.next();
        let takes = |byte: &&u8| !matches!(port.write(**byte), Err(nb::Error::WouldBlock));
        let (taken, all) = (bytes.iter().take_while(takes).count(), bytes.len());
        outbox.gone(taken);
        if taken == 0 || taken < all {
            break;
        }
    }
    port.interrupt_when_writable(!outbox.is_empty());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::onboard::outbox::WhenFull;
    use embedded_hal_nb::serial::ErrorType;
    use heapless::spsc::Queue;
    extern crate std;
    use std::collections::VecDeque;
    use std::vec::Vec;

    /// Registers of a port: what the line brings, and one byte of room for what goes out.
    #[derive(Default)]
    struct Mock {
        line: VecDeque<Result<u8, ErrorKind>>,
        room: usize,
        sent: Vec<u8>,
        asks: bool,
    }

    impl ErrorType for Mock {
        type Error = ErrorKind;
    }

    impl Read<u8> for Mock {
        fn read(&mut self) -> nb::Result<u8, ErrorKind> {
            match self.line.pop_front() {
                Some(Ok(byte)) => Ok(byte),
                Some(Err(kind)) => Err(nb::Error::Other(kind)),
                None => Err(nb::Error::WouldBlock),
            }
        }
    }

    impl Write<u8> for Mock {
        fn write(&mut self, byte: u8) -> nb::Result<(), ErrorKind> {
            self.room = self.room.checked_sub(1).ok_or(nb::Error::WouldBlock)?;
            self.sent.push(byte);
            Ok(())
        }
        fn flush(&mut self) -> nb::Result<(), ErrorKind> {
            Ok(())
        }
    }

    impl LinePort for Mock {
        fn interrupt_when_writable(&mut self, on: bool) {
            self.asks = on;
        }
    }

    #[test]
    fn each_error_is_counted_by_its_cause_and_the_good_bytes_arrive() {
        let mut port = Mock {
            line: VecDeque::from([
                Ok(1),
                Err(ErrorKind::Overrun),
                Ok(2),
                Err(ErrorKind::FrameFormat),
                Err(ErrorKind::Noise),
                Err(ErrorKind::Parity),
                Ok(3),
            ]),
            ..Mock::default()
        };
        let (mut queue, mut outbox, errors) = (Queue::<u8, 8>::new(), Outbox::<8>::new(), LineErrors::new());
        let (mut ring, mut bytes) = queue.split();
        assert_eq!(serve(&mut port, &mut ring, &mut outbox, &errors), Served { came: true, more: false });
        let arrived: Vec<u8> = core::iter::from_fn(|| bytes.dequeue()).collect();
        assert_eq!(arrived, [1, 2, 3]);
        let expected = LineCounts { overrun: 1, framing: 1, noise: 1, other: 1, ring_full: 0 };
        assert_eq!(errors.counts(), expected);
    }

    #[test]
    fn a_line_of_nothing_but_errors_ends_the_interrupt_too() {
        let mut port = Mock { line: std::iter::repeat_n(Err(ErrorKind::Overrun), 1000).collect(), ..Mock::default() };
        let (mut queue, mut outbox, errors) = (Queue::<u8, 8>::new(), Outbox::<8>::new(), LineErrors::new());
        let (mut ring, _) = queue.split();
        assert_eq!(serve(&mut port, &mut ring, &mut outbox, &errors), Served { came: false, more: true });
        assert_eq!(errors.counts().overrun as usize, MOST_PER_CALL);
    }

    #[test]
    fn a_full_ring_drops_the_newest_and_counts() {
        let mut port = Mock { line: (0..10).map(Ok).collect(), ..Mock::default() };
        let (mut queue, mut outbox, errors) = (Queue::<u8, 5>::new(), Outbox::<8>::new(), LineErrors::new());
        let (mut ring, mut bytes) = queue.split();
        serve(&mut port, &mut ring, &mut outbox, &errors);
        let arrived: Vec<u8> = core::iter::from_fn(|| bytes.dequeue()).collect();
        assert_eq!(arrived, [0, 1, 2, 3]);
        assert_eq!(errors.counts().ring_full, 6);
    }

    #[test]
    fn the_outbox_is_sent_byte_by_byte_and_the_interrupt_is_switched_off_at_the_end() {
        let mut port = Mock::default();
        let (mut queue, mut outbox, errors) = (Queue::<u8, 8>::new(), Outbox::<8>::new(), LineErrors::new());
        let (mut ring, _) = queue.split();
        outbox.push(&[1, 2, 0], WhenFull::DropOldest).unwrap();
        for sent in 0..3 {
            send(&mut port, &mut outbox);
            assert!(port.asks, "after {sent} bytes");
            port.room = 1;
        }
        serve(&mut port, &mut ring, &mut outbox, &errors);
        assert_eq!(port.sent, [1, 2, 0]);
        assert!(!port.asks);
    }
}
