//! One payload in, frame by frame.
//!
//! In: the data of frames, the time. Out: the payload when it is whole, and the flow control frames that the sender
//! waits for.
//!
//! The buffer is free whenever a first frame comes, since the caller has had the payload before: this side never asks
//! to wait.

use super::Config;
use super::pdu::{FlowControl, FlowStatus, Pdu, SeparationTime};
use heapless::Vec;

errors! {
    /// Why a payload was dropped.
    #[derive(Eq)]
    #[non_exhaustive]
    pub enum ReceiveError {
        Sequence { expected: u8, found: u8 } => "expected frame number {expected}, found {found}",
        /// A consecutive frame without a first one; the rest of a payload that was dropped before.
        NotStarted => "consecutive frame without a first frame",
        Interrupted { received: usize } => "another payload began after {received} bytes",
        /// A consecutive frame that is not the last has another length than the first frame.
        FrameLength { expected: usize, found: usize } => "expected a frame of {expected} bytes, found {found}",
        Overflow { found: usize, capacity: usize } => "expected at most {capacity} bytes, found {found}",
        Timeout { waited_us: u64 } => "no frame within {waited_us} us",
    }
}

/// What a frame did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Outcome {
    /// The payload is whole: see [`Receiver::payload`].
    pub complete: bool,
    /// Is to be sent back.
    pub answer: Option<FlowControl>,
    /// A payload was dropped: this one, or the one before it.
    pub dropped: Option<ReceiveError>,
}

#[derive(Clone, Copy, Debug)]
struct Progress {
    length: usize,
    frame: usize,
    sequence: u8,
    // Frames until the next flow control; none for all.
    block: Option<u8>,
    heard_us: u64,
}

/// Receives payloads of up to `N` bytes, one at a time.
///
/// ```
/// use rundown_wire::link::isotp::{Config, Receiver, pdu::parse};
///
/// let mut receiver: Receiver<512> = Receiver::new(Config::CLASSIC);
/// let frame = [0x03, 1, 2, 3];
/// let outcome = receiver.on_frame(parse(&frame).unwrap(), frame.len(), 0);
/// assert!(outcome.complete);
/// assert_eq!(receiver.payload(), [1, 2, 3]);
/// ```
#[derive(Debug)]
pub struct Receiver<const N: usize> {
    config: Config,
    progress: Option<Progress>,
    payload: Vec<u8, N>,
}

impl<const N: usize> Receiver<N> {
    /// A receiver at rest.
    pub const fn new(config: Config) -> Self {
        Self { config, progress: None, payload: Vec::new() }
    }

    /// The payload, after an outcome that says it is complete.
    pub fn payload(&self) -> &[u8] {
        &self.payload
    }

    /// Takes a frame of `frame` bytes. Flow control frames are for the sender and do nothing here.
    pub fn on_frame(&mut self, pdu: Pdu<'_>, frame: usize, now_us: u64) -> Outcome {
        match pdu {
            Pdu::Single(data) => {
                let dropped = self.interrupt();
                self.payload.clear();
                match self.payload.extend_from_slice(data) {
                    Ok(()) => Outcome { complete: true, dropped, answer: None },
                    Err(_) => Outcome {
                        dropped: Some(ReceiveError::Overflow { found: data.len(), capacity: N }),
                        ..Outcome::default()
                    },
                }
            }
            Pdu::First { length, data } => self.begin(length, data, frame, now_us),
            Pdu::Consecutive { sequence, data } => match self.progress.take() {
                None => Outcome { dropped: Some(ReceiveError::NotStarted), ..Outcome::default() },
                Some(progress) => self.go_on(progress, sequence, data, now_us),
            },
            Pdu::FlowControl(_) => Outcome::default(),
        }
    }

    /// To be called now and then: gives up a payload whose sender fell silent.
    ///
    /// # Errors
    /// [`ReceiveError::Timeout`].
    pub fn check_time(&mut self, now_us: u64) -> Result<(), ReceiveError> {
        let Some(progress) = self.progress else {
            return Ok(());
        };
        let waited_us = now_us.saturating_sub(progress.heard_us);
        if waited_us < self.config.timeout_us {
            return Ok(());
        }
        self.progress = None;
        Err(ReceiveError::Timeout { waited_us })
    }

    fn interrupt(&mut self) -> Option<ReceiveError> {
        self.progress.take().map(|_| ReceiveError::Interrupted { received: self.payload.len() })
    }

    fn answer(&self, status: FlowStatus) -> Option<FlowControl> {
        Some(FlowControl { status, block_size: self.config.block_size, separation: self.config.separation })
    }

    fn block(&self) -> Option<u8> {
        (self.config.block_size > 0).then_some(self.config.block_size)
    }

    fn begin(&mut self, length: usize, data: &[u8], frame: usize, now_us: u64) -> Outcome {
        let dropped = self.interrupt();
        self.payload.clear();
        if length > N || self.payload.extend_from_slice(data).is_err() {
            return Outcome {
                complete: false,
                answer: Some(FlowControl {
                    status: FlowStatus::Overflow,
                    block_size: 0,
                    separation: SeparationTime::ZERO,
                }),
                dropped: Some(ReceiveError::Overflow { found: length, capacity: N }),
            };
        }
        self.progress = Some(Progress { length, frame, sequence: 1, block: self.block(), heard_us: now_us });
        Outcome { complete: false, answer: self.answer(FlowStatus::Continue), dropped }
    }

    /// The payload is under way again only if the frame is the one that was due.
    fn go_on(&mut self, mut progress: Progress, sequence: u8, data: &[u8], now_us: u64) -> Outcome {
        let refused = |error| Outcome { dropped: Some(error), ..Outcome::default() };
        if sequence != progress.sequence {
            return refused(ReceiveError::Sequence { expected: progress.sequence, found: sequence });
        }
        let left = progress.length.saturating_sub(self.payload.len());
        let found = data.len() + 1;
        // Only the last frame may be shorter than the first one; none may be longer.
        if found > progress.frame || (data.len() < left && found != progress.frame) {
            return refused(ReceiveError::FrameLength { expected: progress.frame, found });
        }
        let data = data.get(..left).unwrap_or(data);
        if self.payload.extend_from_slice(data).is_err() {
            // Cannot be reached: the length was compared with the room when the payload began.
            return refused(ReceiveError::Overflow { found: progress.length, capacity: N });
        }
        if self.payload.len() >= progress.length {
            return Outcome { complete: true, ..Outcome::default() };
        }
        progress.sequence = (progress.sequence + 1) % 16;
        progress.heard_us = now_us;
        progress.block = progress.block.map(|block| block.saturating_sub(1));
        let answer = if progress.block == Some(0) {
            progress.block = self.block();
            self.answer(FlowStatus::Continue)
        } else {
            None
        };
        self.progress = Some(progress);
        Outcome { complete: false, answer, dropped: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::isotp::pdu::parse;

    fn push<const N: usize>(receiver: &mut Receiver<N>, frame: &[u8]) -> Outcome {
        receiver.on_frame(parse(frame).unwrap(), frame.len(), 0)
    }

    fn begun() -> Receiver<32> {
        let mut receiver = Receiver::new(Config { block_size: 1, ..Config::CLASSIC });
        let outcome = push(&mut receiver, &[0x10, 20, 1, 2, 3, 4, 5, 6]);
        assert_eq!(outcome.answer.unwrap().status, FlowStatus::Continue);
        receiver
    }

    const SECOND: [u8; 8] = [0x21, 7, 8, 9, 10, 11, 12, 13];
    const THIRD: [u8; 8] = [0x22, 14, 15, 16, 17, 18, 19, 20];

    #[test]
    fn every_block_is_answered_and_the_last_is_not() {
        let mut receiver = begun();
        assert!(push(&mut receiver, &SECOND).answer.is_some());
        let outcome = push(&mut receiver, &THIRD);
        assert!(outcome.complete && outcome.answer.is_none());
        assert!(receiver.payload().iter().copied().eq(1..=20));
    }

    #[test]
    fn missing_doubled_and_misplaced_frames_drop_the_payload() {
        let mut receiver = begun();
        assert_eq!(push(&mut receiver, &THIRD).dropped, Some(ReceiveError::Sequence { expected: 1, found: 2 }));
        // What is left of it begins nothing.
        assert_eq!(push(&mut receiver, &SECOND).dropped, Some(ReceiveError::NotStarted));
        let mut receiver = begun();
        push(&mut receiver, &SECOND);
        assert!(push(&mut receiver, &SECOND).dropped.is_some());
        assert!(push(&mut receiver, &THIRD).dropped.is_some());
    }

    #[test]
    fn a_short_frame_within_the_payload_drops_it() {
        let mut receiver = begun();
        assert_eq!(
            push(&mut receiver, &SECOND[..7]).dropped,
            Some(ReceiveError::FrameLength { expected: 8, found: 7 })
        );
    }

    #[test]
    fn a_new_payload_ends_the_old_one_and_is_received() {
        let mut receiver = begun();
        let outcome = push(&mut receiver, &[0x02, 5, 6]);
        assert!(outcome.complete);
        assert_eq!(outcome.dropped, Some(ReceiveError::Interrupted { received: 6 }));
        assert_eq!(receiver.payload(), [5, 6]);
    }

    #[test]
    fn too_long_is_answered_with_overflow() {
        let mut receiver: Receiver<32> = Receiver::new(Config::CLASSIC);
        for (frame, found) in
            [([0x10, 33, 1, 2, 3, 4, 5, 6], 33), ([0x10, 0, 0xFF, 0xFF, 0xFF, 0xFF, 1, 2], 0xFFFF_FFFF)]
        {
            let outcome = push(&mut receiver, &frame);
            assert_eq!(outcome.answer.unwrap().status, FlowStatus::Overflow);
            let error = ReceiveError::Overflow { found, capacity: 32 };
            assert_eq!(outcome.dropped, Some(error));
        }
    }

    #[test]
    fn silence_drops_the_payload() {
        let mut receiver = begun();
        assert_eq!(receiver.check_time(999_999), Ok(()));
        assert_eq!(receiver.check_time(1_000_000), Err(ReceiveError::Timeout { waited_us: 1_000_000 }));
        assert_eq!(receiver.check_time(2_000_000), Ok(()));
    }
}
