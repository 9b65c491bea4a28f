//! Frames out of what a link brings, with a tally of what is missing.
//!
//! In: the bytes of a serial line, from any place on; or whole messages of another link. Out: [`Received`] frames, each
//! with its [`Order`].
//!
//! ```text
//! bytes -> COBS, CRC-32C -> message -> version, postcard -> sequence number -> frame
//!          damaged                     unknown              lost, late, repeated, restarts
//! ```
//!
//! A reader may begin anywhere and meet anything: it is in step again at the next zero byte, and nothing panics. The
//! board's numbers restart with each run and after its restart, which is no loss; they are distinguished from frames
//! out of order by the last [`WINDOW`] numbers and their ticks.

use crate::downlink::Downlink;
use crate::link::serial::Decoder;

/// A frame that comes later than so many others is not expected any more.
pub const WINDOW: u16 = 32;

/// Where a frame stands among the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// The first one, or the next one.
    Next,
    /// So many before it are missing.
    After {
        /// How many.
        lost: u16,
    },
    /// It was missing, and newer ones have come before it.
    Late,
    /// It has come before.
    Repeated,
    /// The board counts from 0 again: a run begins, or the board has restarted.
    Restart,
}

/// A frame and where it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Received {
    /// What the board said.
    pub frame: Downlink,
    /// Where it stands.
    pub order: Order,
}

/// What a reader has counted. Counts stay at their largest value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Tally {
    /// Frames read.
    pub frames: u32,
    /// Numbers that never came.
    pub lost: u32,
    /// Pieces of the line that are no message: noise, a cut message, a wrong checksum.
    pub damaged: u32,
    /// Whole messages that are no frame of this version: from a newer board, or not from a board.
    pub unknown: u32,
    /// Frames that came after newer ones.
    pub out_of_order: u32,
    /// Frames that came twice.
    pub repeated: u32,
    /// How often the board restarted its count.
    pub restarts: u32,
}

/// Reads frames.
///
/// ```
/// use rundown_wire::{Answer, Body, Downlink, Order, Reader, link::serial};
///
/// let frame = |sequence| Downlink { sequence, tick: 3, body: Body::Answer(Answer { to: 4, result: Ok(()) }) };
/// let mut line = vec![0x55, 0x17, 0x00]; // noise
/// for sequence in [7, 9] {
///     let mut buffer = [0; 32];
///     line.extend_from_slice(&serial::encode(frame(sequence).encode(&mut buffer)?).unwrap());
/// }
/// let mut reader = Reader::new();
/// let orders: Vec<Order> = line.iter().filter_map(|byte| reader.byte(*byte)).map(|r| r.order).collect();
/// assert_eq!(orders, [Order::Next, Order::After { lost: 1 }]);
/// assert_eq!((reader.tally().frames, reader.tally().lost, reader.tally().damaged), (2, 1, 1));
/// # Ok::<(), rundown_wire::EncodeError>(())
/// ```
#[derive(Debug, Default)]
pub struct Reader {
    decoder: Decoder,
    sequence: Sequence,
    tally: Tally,
}

impl Reader {
    /// A reader that has met nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// The next byte of a serial line; the frame that it ends, if it ends one.
    pub fn byte(&mut self, byte: u8) -> Option<Received> {
        match self.decoder.push(byte) {
            Ok(None) => None,
            Ok(Some(message)) => read(message, &mut self.sequence, &mut self.tally),
            Err(_) => {
                count(&mut self.tally.damaged);
                None
            }
        }
    }

    /// A message of a link that has checked it, such as [`CanLink`](crate::link::can_link::CanLink).
    pub fn message(&mut self, message: &[u8]) -> Option<Received> {
        read(message, &mut self.sequence, &mut self.tally)
    }

    /// What was counted.
    pub const fn tally(&self) -> &Tally {
        &self.tally
    }
}

fn read(message: &[u8], sequence: &mut Sequence, tally: &mut Tally) -> Option<Received> {
    let Ok(frame) = Downlink::decode(message) else {
        count(&mut tally.unknown);
        return None;
    };
    let (order, was_missed) = sequence.place(&frame);
    count(&mut tally.frames);
    match order {
        Order::Next => {}
        Order::After { lost } => tally.lost = tally.lost.saturating_add(lost.into()),
        Order::Late => {
            count(&mut tally.out_of_order);
            tally.lost = tally.lost.saturating_sub(was_missed.into());
        }
        Order::Repeated => count(&mut tally.repeated),
        Order::Restart => {
            count(&mut tally.restarts);
            tally.lost = tally.lost.saturating_add(frame.sequence.into());
        }
    }
    Some(Received { frame, order })
}

fn count(counter: &mut u32) {
    *counter = counter.saturating_add(1);
}

/// Number and tick of a frame.
type Place = (u16, u32);

/// The numbers that came last.
#[derive(Debug, Default)]
struct Sequence {
    newest: Option<Place>,
    // Numbers since the first one that came, or since the board restarted its count.
    span: u16,
    recent: [Option<Place>; WINDOW as usize],
}

impl Sequence {
    /// Where a frame stands, and whether it was counted as lost before.
    fn place(&mut self, frame: &Downlink) -> (Order, bool) {
        let place @ (number, tick) = (frame.sequence, frame.tick);
        let Some((newest, newest_tick)) = self.newest else {
            return (self.begin(place, Order::Next), false);
        };
        let ahead = number.wrapping_sub(newest);
        let behind = newest.wrapping_sub(number);
        if ahead == 1 {
            return (self.go_on(place, ahead, Order::Next), false);
        }
        if behind < WINDOW {
            let slot = self.slot(number).and_then(|slot| *slot);
            let came = slot == Some(place);
            // The same number at another tick: the board restarted and counts once more.
            let taken = !came && slot.is_some_and(|(of, _)| of == number);
            // A board that restarted counts from 0, at an early tick. The newest frame, sent twice, is no restart.
            let begins = number == 0 || (tick < newest_tick && number < WINDOW);
            let was_missed = behind < self.span;
            let restarted =
                if was_missed { taken || (came && number == 0 && behind > 0) } else { begins || tick > newest_tick };
            return if restarted {
                (self.begin(place, Order::Restart), false)
            } else if came {
                (Order::Repeated, false)
            } else {
                self.remember(place);
                (Order::Late, was_missed)
            };
        }
        // Half of all numbers lie ahead; a tick that goes back says that they do not.
        if tick >= newest_tick && ahead <= u16::MAX / 2 {
            return (self.go_on(place, ahead, Order::After { lost: ahead - 1 }), false);
        }
        (self.begin(place, Order::Restart), false)
    }

    fn begin(&mut self, place: Place, order: Order) -> Order {
        self.recent = [None; WINDOW as usize];
        self.span = match order {
            // What is missing of the new count may still come.
            Order::Restart => place.0.saturating_add(1),
            _ => 1,
        };
        self.newest = Some(place);
        self.remember(place);
        order
    }

    fn go_on(&mut self, place: Place, ahead: u16, order: Order) -> Order {
        self.span = self.span.saturating_add(ahead);
        self.newest = Some(place);
        self.remember(place);
        order
    }

    fn slot(&mut self, number: u16) -> Option<&mut Option<Place>> {
        self.recent.get_mut(usize::from(number % WINDOW))
    }

    fn remember(&mut self, place: Place) {
        if let Some(slot) = self.slot(place.0) {
            *slot = Some(place);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::downlink::{Answer, Body};
    use crate::link::serial;
    use heapless::Vec;

    fn message(sequence: u16, tick: u32) -> crate::link::Message {
        let body = Body::Answer(Answer { to: 1, result: Ok(()) });
        let mut buffer = [0; 32];
        let frame = Downlink { sequence, tick, body };
        Vec::from_slice(frame.encode(&mut buffer).unwrap()).unwrap()
    }

    fn orders<const N: usize>(places: [Place; N]) -> ([Order; N], Tally) {
        let mut reader = Reader::new();
        let orders = places.map(|(sequence, tick)| reader.message(&message(sequence, tick)).unwrap().order);
        (orders, *reader.tally())
    }

    #[test]
    fn a_gap_is_a_loss_until_the_frame_comes_late() {
        let (found, tally) = orders([(5, 1), (6, 1), (9, 2), (7, 1), (8, 2), (10, 3)]);
        let lost = Order::After { lost: 2 };
        let late = Order::Late;
        assert_eq!(found, [Order::Next, Order::Next, lost, late, late, Order::Next]);
        assert_eq!((tally.lost, tally.out_of_order), (0, 2));
    }

    #[test]
    fn frames_that_came_before_the_first_one_are_late_and_were_not_lost() {
        let (found, tally) = orders([(102, 9), (101, 9), (105, 9), (100, 8)]);
        assert_eq!(found[1], Order::Late);
        assert_eq!(found[3], Order::Late);
        assert_eq!((tally.lost, tally.out_of_order, tally.restarts), (2, 2, 0));
    }

    #[test]
    fn numbers_wrap_without_a_loss() {
        let (_, tally) = orders([(65_534, 9), (65_535, 9), (0, 9), (2, 10)]);
        assert_eq!((tally.lost, tally.restarts), (1, 0));
    }

    #[test]
    fn a_run_that_begins_is_no_loss() {
        // The description of train and track, then `begin`; a long run, then the next one, whose first two frames are
        // lost.
        let (found, tally) = orders([(14, 0), (15, 0), (0, 0), (1, 1), (40_000, 9000), (2, 1), (3, 1)]);
        assert_eq!(found[2], Order::Restart);
        assert_eq!(found[4], Order::Restart, "more than half of all numbers ahead");
        assert_eq!(found[5], Order::Restart);
        assert_eq!(found[6], Order::Next);
        assert_eq!((tally.restarts, tally.lost), (3, 40_002));
    }

    #[test]
    fn repeated_frames_are_recognised() {
        let (found, tally) = orders([(5, 1), (5, 1), (6, 1), (5, 1), (7, 2)]);
        assert_eq!(found[1], Order::Repeated);
        assert_eq!(found[3], Order::Repeated);
        assert_eq!((tally.repeated, tally.lost, tally.restarts), (2, 0, 0));
    }

    #[test]
    fn a_line_that_is_joined_in_the_middle_costs_one_message() {
        let mut reader = Reader::new();
        let mut frames = 0;
        let line = (0..4).flat_map(|n| serial::encode(&message(n, 1)).unwrap());
        for byte in line.skip(5) {
            frames += u32::from(reader.byte(byte).is_some());
        }
        assert_eq!((frames, reader.tally().damaged), (3, 1));
    }

    #[test]
    fn a_message_of_a_newer_board_is_counted_and_not_taken() {
        let mut reader = Reader::new();
        assert_eq!(reader.message(&[2, 0, 0, 0]), None);
        assert_eq!(reader.message(&[1, 0, 0, 99]), None);
        assert_eq!(reader.tally().unknown, 2);
    }
}
