//! One payload out, frame by frame.
//!
//! In: the payload, the flow control frames of the receiver, the time. Out: the data of the next frame, when one is
//! due.

use super::Config;
use super::pdu::{FlowControl, FlowStatus, FrameData, encode_begin, encode_consecutive};
use heapless::Vec;

errors! {
    /// Why a payload was not sent or not to its end.
    #[derive(Eq)]
    #[non_exhaustive]
    pub enum SendError {
        Busy => "the payload before is still being sent",
        Length { found: usize, capacity: usize } => "expected 1 to {capacity} bytes, found {found}",
        Timeout { waited_us: u64 } => "no flow control within {waited_us} us",
        Overflow => "the receiver has no room",
        TooManyWaits => "the receiver asked to wait too often",
        FlowStatus { found: u8 } => "expected flow status 0 to 2, found {found}",
    }
}

/// Where the separation time begins. It counts from the end of a frame, which is after the `now_us` of the call that
/// sent it; so it is taken from the next call, and is never too short.
#[derive(Clone, Copy, Debug)]
enum Pace {
    Free,
    SentIn { call_us: u64 },
    SentBefore { call_us: u64 },
}

#[derive(Clone, Copy, Debug, Default)]
enum State {
    #[default]
    Idle,
    Begin,
    AwaitFlowControl {
        since_us: u64,
        waits: u8,
    },
    Consecutive {
        pace: Pace,
        gap_us: u64,
        // Frames until the next flow control; none for all.
        block: Option<u8>,
    },
}

/// Sends payloads of up to `N` bytes, one at a time.
///
/// ```
/// use rundown_wire::link::isotp::{Config, Sender};
///
/// let mut sender: Sender<512> = Sender::new(Config::CLASSIC);
/// sender.start(&[1, 2, 3]).unwrap();
/// assert_eq!(sender.next_frame(0).unwrap().unwrap(), [0x03, 1, 2, 3]);
/// assert_eq!(sender.next_frame(0), Ok(None));
/// ```
#[derive(Debug)]
pub struct Sender<const N: usize> {
    config: Config,
    state: State,
    payload: Vec<u8, N>,
    sent: usize,
    sequence: u8,
}

impl<const N: usize> Sender<N> {
    /// A sender with nothing to send.
    pub const fn new(config: Config) -> Self {
        Self { config, state: State::Idle, payload: Vec::new(), sent: 0, sequence: 0 }
    }

    /// Whether the next payload may come.
    pub const fn is_idle(&self) -> bool {
        matches!(self.state, State::Idle)
    }

    /// Takes a payload.
    ///
    /// # Errors
    /// [`SendError::Busy`], [`SendError::Length`].
    pub fn start(&mut self, payload: &[u8]) -> Result<(), SendError> {
        if !self.is_idle() {
            return Err(SendError::Busy);
        }
        let error = SendError::Length { found: payload.len(), capacity: N };
        if payload.is_empty() {
            return Err(error);
        }
        self.payload.clear();
        self.payload.extend_from_slice(payload).map_err(|_| error)?;
        self.state = State::Begin;
        Ok(())
    }

    /// The next frame, if one is due. It counts as sent now, or when [`confirm`](Self::confirm) says so.
    ///
    /// # Errors
    /// [`SendError::Timeout`]. The payload is given up.
    pub fn next_frame(&mut self, now_us: u64) -> Result<Option<FrameData>, SendError> {
        match self.state {
            State::Idle => Ok(None),
            State::Begin => {
                let (frame, taken) = encode_begin(&self.payload, self.config.format);
                self.sent = taken;
                self.sequence = 1;
                self.state = if taken == self.payload.len() {
                    State::Idle
                } else {
                    State::AwaitFlowControl { since_us: now_us, waits: 0 }
                };
                Ok(Some(frame))
            }
            State::AwaitFlowControl { since_us, .. } => {
                let waited_us = now_us.saturating_sub(since_us);
                if waited_us < self.config.timeout_us {
                    return Ok(None);
                }
                self.state = State::Idle;
                Err(SendError::Timeout { waited_us })
            }
            State::Consecutive { pace, gap_us, block } => {
                match pace {
                    Pace::SentIn { call_us } if gap_us > 0 => {
                        if now_us > call_us {
                            self.state =
                                State::Consecutive { pace: Pace::SentBefore { call_us: now_us }, gap_us, block };
                        }
                        return Ok(None);
                    }
                    Pace::SentBefore { call_us } if now_us.saturating_sub(call_us) < gap_us => {
                        return Ok(None);
                    }
                    _ => {}
                }
                let left = self.payload.get(self.sent..).unwrap_or_default();
                let (frame, taken) = encode_consecutive(self.sequence, left, self.config.format);
                self.sent += taken;
                self.sequence = (self.sequence + 1) % 16;
                let block = block.map(|block| block.saturating_sub(1));
                self.state = if self.sent >= self.payload.len() {
                    State::Idle
                } else if block == Some(0) {
                    State::AwaitFlowControl { since_us: now_us, waits: 0 }
                } else {
                    State::Consecutive { pace: Pace::SentIn { call_us: now_us }, gap_us, block }
                };
                Ok(Some(frame))
            }
        }
    }

    /// The controller took the last frame only now: separation time and N_Bs begin here.
    pub fn confirm(&mut self, now_us: u64) {
        match &mut self.state {
            State::AwaitFlowControl { since_us, .. } => *since_us = now_us,
            State::Consecutive { pace: Pace::SentIn { call_us }, .. } => *call_us = now_us,
            _ => {}
        }
    }

    /// Takes a flow control frame. One that was not waited for is ignored, as the standard asks.
    ///
    /// # Errors
    /// [`SendError::Overflow`], [`SendError::TooManyWaits`], [`SendError::FlowStatus`]. The payload is given up.
    pub fn on_flow_control(&mut self, answer: FlowControl, now_us: u64) -> Result<(), SendError> {
        let State::AwaitFlowControl { waits, .. } = self.state else {
            return Ok(());
        };
        let error = match answer.status {
            FlowStatus::Continue => {
                self.state = State::Consecutive {
                    pace: Pace::Free,
                    gap_us: answer.separation.to_us(),
                    block: (answer.block_size > 0).then_some(answer.block_size),
                };
                return Ok(());
            }
            FlowStatus::Wait if waits < self.config.max_waits => {
                self.state = State::AwaitFlowControl { since_us: now_us, waits: waits + 1 };
                return Ok(());
            }
            FlowStatus::Wait => SendError::TooManyWaits,
            FlowStatus::Overflow => SendError::Overflow,
            FlowStatus::Reserved(found) => SendError::FlowStatus { found },
        };
        self.state = State::Idle;
        Err(error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::isotp::pdu::SeparationTime;

    const PAYLOAD: [u8; 40] = [7; 40];

    fn answer(status: FlowStatus, block_size: u8, separation: u8) -> FlowControl {
        FlowControl { status, block_size, separation: SeparationTime(separation) }
    }

    fn waiting() -> Sender<40> {
        let mut sender = Sender::new(Config::CLASSIC);
        sender.start(&PAYLOAD).unwrap();
        let first = sender.next_frame(0).unwrap().unwrap();
        assert_eq!(first, [0x10, 40, 7, 7, 7, 7, 7, 7]);
        assert_eq!(sender.next_frame(999_999), Ok(None));
        sender
    }

    #[test]
    fn blocks_end_with_a_wait_for_flow_control_and_frames_keep_their_distance() {
        let mut sender = waiting();
        sender.on_flow_control(answer(FlowStatus::Continue, 2, 5), 0).unwrap();
        assert_eq!(sender.next_frame(0).unwrap().unwrap()[0], 0x21);
        // The frame went out after the call at 0 began and before the one at 1.
        assert_eq!(sender.next_frame(1), Ok(None));
        assert_eq!(sender.next_frame(5_000), Ok(None));
        assert_eq!(sender.next_frame(5_001).unwrap().unwrap()[0], 0x22);
        assert_eq!(sender.next_frame(20_000), Ok(None), "the block is over");
        // The next flow control may change both.
        sender.on_flow_control(answer(FlowStatus::Continue, 0, 0), 20_000).unwrap();
        for sequence in 0x23..=0x25 {
            assert_eq!(sender.next_frame(20_000).unwrap().unwrap()[0], sequence);
        }
        assert!(sender.is_idle());
    }

    #[test]
    fn distance_and_silence_count_from_when_the_controller_took_the_frame() {
        let mut sender = waiting();
        sender.confirm(500_000);
        assert_eq!(sender.next_frame(1_400_000), Ok(None));
        sender.on_flow_control(answer(FlowStatus::Continue, 0, 5), 1_400_000).unwrap();
        assert!(sender.next_frame(1_400_000).unwrap().is_some());
        sender.confirm(1_410_000);
        assert_eq!(sender.next_frame(1_410_000), Ok(None));
        assert_eq!(sender.next_frame(1_410_100), Ok(None));
        assert_eq!(sender.next_frame(1_415_099), Ok(None));
        assert!(sender.next_frame(1_415_100).unwrap().is_some());
    }

    #[test]
    fn silence_ends_the_payload() {
        let mut sender = waiting();
        assert_eq!(sender.next_frame(1_000_000), Err(SendError::Timeout { waited_us: 1_000_000 }));
        assert!(sender.is_idle());
    }

    #[test]
    fn a_wait_gives_another_second_until_there_were_too_many() {
        let mut sender = waiting();
        for wait in 1..=10 {
            let now_us = wait * 900_000;
            assert_eq!(sender.next_frame(now_us), Ok(None));
            sender.on_flow_control(answer(FlowStatus::Wait, 0, 0), now_us).unwrap();
        }
        assert_eq!(sender.on_flow_control(answer(FlowStatus::Wait, 0, 0), 9_000_001), Err(SendError::TooManyWaits));
        assert!(sender.is_idle());
    }

    #[test]
    fn overflow_and_unknown_answers_end_the_payload() {
        for (status, error) in
            [(FlowStatus::Overflow, SendError::Overflow), (FlowStatus::Reserved(5), SendError::FlowStatus { found: 5 })]
        {
            let mut sender = waiting();
            assert_eq!(sender.on_flow_control(answer(status, 0, 0), 1), Err(error));
            assert!(sender.is_idle());
        }
    }

    #[test]
    fn a_payload_is_refused_while_one_is_on_its_way_and_when_it_has_no_room() {
        assert_eq!(waiting().start(&[1]), Err(SendError::Busy));
        let mut sender: Sender<4> = Sender::new(Config::CLASSIC);
        for found in [0, 5] {
            let error = SendError::Length { found, capacity: 4 };
            assert_eq!(sender.start(&PAYLOAD[..found]), Err(error));
        }
        assert_eq!(sender.on_flow_control(answer(FlowStatus::Overflow, 0, 0), 0), Ok(()), "nothing was waited for");
    }
}
