//! Frames that wait for the line. When the line does not take them, the oldest goes, so that the newest estimate is the
//! one that is sent; what anybody can bring about, a refusal, makes none go.
//!
//! In: whole frames, each with the delimiter at its end and nowhere else (COBS). Out: bytes, in pieces that lie
//! together. A frame of which a part has gone is cut short by its delimiter: the receiver refuses that one and reads
//! the next.

use rundown_wire::errors;

/// End of a frame.
pub const DELIMITER: u8 = 0;

errors! {
    /// Why a frame was not taken.
    #[derive(Eq)]
    pub struct NoRoom { found: usize, room: usize } => "frame: expected at most {room} bytes, found {found}";
}

/// Bytes that come in one step, some 5 µs at 80 MHz: who locks the outbox against the line's interrupt need not do so
/// for longer.
const PIECE: usize = 64;

/// What a frame does where there is no room for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WhenFull {
    /// It takes the place of the oldest ones.
    DropOldest,
    /// It goes unsent.
    DropThis,
}

/// A frame that comes in pieces.
#[derive(Debug)]
pub struct Arriving<'a> {
    frame: &'a [u8],
    when_full: WhenFull,
    /// Bytes of it that are in the outbox.
    there: usize,
}

impl<'a> Arriving<'a> {
    /// Nothing of it is there.
    pub const fn new(frame: &'a [u8], when_full: WhenFull) -> Self {
        Self { frame, when_full, there: 0 }
    }
}

/// A queue of frames in `N` bytes.
///
/// ```
/// use rundown::onboard::outbox::{Outbox, WhenFull};
///
/// let mut outbox = Outbox::<8>::new();
/// outbox.push(&[1, 2, 3, 0], WhenFull::DropOldest)?;
/// outbox.push(&[4, 5, 6, 0], WhenFull::DropOldest)?;
/// outbox.push(&[7, 0], WhenFull::DropOldest)?; // the first goes
/// assert_eq!(outbox.dropped(), 1);
/// assert_eq!(outbox.pop(), Some(4));
/// # Ok::<(), rundown::onboard::outbox::NoRoom>(())
/// ```
#[derive(Debug)]
pub struct Outbox<const N: usize> {
    bytes: [u8; N],
    /// Place of the next byte.
    first: usize,
    waiting: usize,
    /// The front is the inside of a frame of which a part has gone.
    inside: bool,
    /// A frame was cut; its delimiter is still to be sent.
    owed: bool,
    /// The front is the inside of a frame that goes unsent.
    cutting: bool,
    dropped: u32,
}

impl<const N: usize> Default for Outbox<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> Outbox<N> {
    /// An empty one.
    pub const fn new() -> Self {
        Self { bytes: [0; N], first: 0, waiting: 0, inside: false, owed: false, cutting: false, dropped: 0 }
    }

    /// Takes a whole frame.
    ///
    /// # Errors
    /// As [`Outbox::take`].
    pub fn push(&mut self, frame: &[u8], when_full: WhenFull) -> Result<(), NoRoom> {
        let mut arriving = Arriving::new(frame, when_full);
        while !self.take(&mut arriving)? {}
        Ok(())
    }

    /// One step of [`push`](Self::push): a piece of an old frame goes, or one of this comes. True when the frame is
    /// whole; only then it counts as one that waits. Bytes may go meanwhile; a second frame must not come.
    ///
    /// # Errors
    /// [`NoRoom`], with its first step: not in an empty outbox, or not without dropping another. Nothing changes but
    /// the count.
    pub fn take(&mut self, arriving: &mut Arriving<'_>) -> Result<bool, NoRoom> {
        let Arriving { frame, when_full, there } = arriving;
        let room = match when_full {
            WhenFull::DropOldest => N,
            WhenFull::DropThis => N - self.waiting,
        };
        if frame.len() > room {
            self.dropped = self.dropped.saturating_add(1);
            return Err(NoRoom { found: frame.len(), room });
        }
        if self.cutting || N - self.waiting < frame.len() {
            self.drop_piece();
            return Ok(false);
        }
        let end = self.first + self.waiting + *there;
        let at = if end < N { end } else { end - N };
        // Up to the end of the room, the rest from its beginning. There is room: see above.
        let next = frame.len().min(*there + PIECE).min(*there + N - at);
        let piece = frame.get(*there..next).unwrap_or_default();
        if let Some(to) = self.bytes.get_mut(at..at + piece.len()) {
            to.copy_from_slice(piece);
        }
        *there = next;
        let whole = *there == frame.len();
        if whole {
            self.waiting += frame.len();
        }
        Ok(whole)
    }

    /// The bytes that go next, as far as they lie together; none where nothing waits, or while an old frame goes.
    pub fn next(&self) -> &[u8] {
        match (self.owed, self.cutting) {
            (true, _) => &[DELIMITER],
            (false, true) => &[],
            (false, false) => self.front(),
        }
    }

    /// What waits, as far as it lies together.
    fn front(&self) -> &[u8] {
        let end = (self.first + self.waiting).min(N);
        self.bytes.get(self.first..end).unwrap_or_default()
    }

    /// So many of [`next`](Self::next) have gone.
    pub fn gone(&mut self, count: usize) {
        let next = self.next();
        let count = count.min(next.len());
        let Some(last) = count.checked_sub(1).and_then(|last| next.get(last)) else {
            return;
        };
        let inside = *last != DELIMITER;
        if self.owed {
            self.owed = false;
            return;
        }
        self.inside = inside;
        self.advance(count);
    }

    fn advance(&mut self, count: usize) {
        self.waiting -= count;
        self.first += count;
        if self.first == N {
            self.first = 0;
        }
    }

    /// Next byte for the line.
    pub fn pop(&mut self) -> Option<u8> {
        let byte = *self.next().first()?;
        self.gone(1);
        Some(byte)
    }

    /// Nothing is to go now.
    pub fn is_empty(&self) -> bool {
        self.next().is_empty()
    }

    /// Frames that went unsent, or were cut.
    pub fn dropped(&self) -> u32 {
        self.dropped
    }

    /// A piece of the oldest frame goes unsent. The line gets nothing of it meanwhile.
    fn drop_piece(&mut self) {
        self.owed |= core::mem::take(&mut self.inside);
        let front = self.front();
        let piece = front.get(..PIECE).unwrap_or(front);
        let end = piece.iter().position(|byte| *byte == DELIMITER);
        let whole = end.is_some() || piece.is_empty();
        let count = end.map_or(piece.len(), |end| end + 1);
        self.advance(count);
        self.cutting = !whole;
        if !self.cutting {
            self.dropped = self.dropped.saturating_add(1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    extern crate std;
    use std::collections::VecDeque;
    use std::vec;
    use std::vec::Vec;

    fn drain<const N: usize>(outbox: &mut Outbox<N>) -> Vec<u8> {
        core::iter::from_fn(|| outbox.pop()).collect()
    }

    #[test]
    fn frames_come_out_as_they_went_in() {
        let mut outbox = Outbox::<16>::new();
        outbox.push(&[1, 2, 0], WhenFull::DropOldest).unwrap();
        outbox.push(&[3, 0], WhenFull::DropOldest).unwrap();
        assert_eq!(drain(&mut outbox), [1, 2, 0, 3, 0]);
        assert!(outbox.is_empty());
        assert_eq!(outbox.dropped(), 0);
    }

    #[test]
    fn a_frame_half_sent_ends_in_a_delimiter_of_its_own() {
        let mut outbox = Outbox::<6>::new();
        outbox.push(&[1, 2, 3, 0], WhenFull::DropOldest).unwrap();
        assert_eq!(outbox.pop(), Some(1));
        outbox.push(&[4, 5, 6, 0], WhenFull::DropOldest).unwrap();
        assert_eq!(drain(&mut outbox), [0, 4, 5, 6, 0]);
        assert_eq!(outbox.dropped(), 1);
    }

    #[test]
    fn a_reader_that_was_away_finds_the_newest_whole() {
        let mut outbox = Outbox::<10>::new();
        outbox.push(&[9, 9, 9, 0], WhenFull::DropOldest).unwrap();
        outbox.pop();
        for value in 1..=100 {
            outbox.push(&[value, value, 0], WhenFull::DropOldest).unwrap();
        }
        assert_eq!(drain(&mut outbox), [0, 98, 98, 0, 99, 99, 0, 100, 100, 0]);
        assert_eq!(outbox.dropped(), 98);
    }

    #[test]
    fn a_frame_that_never_fits_changes_nothing() {
        let mut outbox = Outbox::<4>::new();
        outbox.push(&[1, 0], WhenFull::DropOldest).unwrap();
        assert_eq!(outbox.push(&[1, 2, 3, 4, 0], WhenFull::DropOldest), Err(NoRoom { found: 5, room: 4 }));
        assert_eq!(drain(&mut outbox), [1, 0]);
        assert_eq!(outbox.dropped(), 1);
    }

    #[test]
    fn a_frame_that_may_not_displace_waits_only_where_there_is_room() {
        let mut outbox = Outbox::<6>::new();
        let refuse = |outbox: &mut Outbox<6>| outbox.push(&[9, 9, 0], WhenFull::DropThis);
        refuse(&mut outbox).unwrap();
        outbox.push(&[1, 0], WhenFull::DropOldest).unwrap();
        assert_eq!(refuse(&mut outbox), Err(NoRoom { found: 3, room: 1 }));
        assert_eq!(outbox.dropped(), 1);
        assert_eq!(drain(&mut outbox), [9, 9, 0, 1, 0]);
        // Nor does it keep its own place against another.
        refuse(&mut outbox).unwrap();
        outbox.push(&[1, 2, 3, 0], WhenFull::DropOldest).unwrap();
        assert_eq!(drain(&mut outbox), [1, 2, 3, 0]);
    }

    /// The same by a queue of bytes, one at a time.
    #[derive(Default)]
    struct Model {
        bytes: VecDeque<u8>,
        inside: bool,
        owed: bool,
        dropped: u32,
    }

    impl Model {
        fn push(&mut self, frame: &[u8], room: usize) {
            while room - self.bytes.len() < frame.len() {
                self.owed |= self.inside;
                self.inside = false;
                while self.bytes.pop_front().is_some_and(|byte| byte != DELIMITER) {}
                self.dropped += 1;
            }
            self.bytes.extend(frame);
        }

        fn pop(&mut self) -> Option<u8> {
            if std::mem::take(&mut self.owed) {
                return Some(DELIMITER);
            }
            let byte = self.bytes.pop_front()?;
            self.inside = byte != DELIMITER;
            Some(byte)
        }
    }

    #[test]
    fn pieces_of_any_length_are_the_bytes_one_by_one() {
        let (mut outbox, mut model) = (Outbox::<23>::new(), Model::default());
        let mut random = 1_u32;
        let mut below = |limit: u32| {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (random >> 16) % limit
        };
        for step in 0..20_000_u32 {
            if below(3) == 0 {
                let mut frame: Vec<u8> = (0..below(12)).map(|_| 1 + below(255) as u8).collect();
                frame.push(DELIMITER);
                outbox.push(&frame, WhenFull::DropOldest).unwrap();
                model.push(&frame, 23);
            } else {
                let piece = below(6) as usize;
                let next = outbox.next();
                let gone: Vec<u8> = next.iter().take(piece).copied().collect();
                outbox.gone(piece);
                let expected: Vec<u8> = (0..gone.len()).filter_map(|_| model.pop()).collect();
                assert_eq!(gone, expected, "step {step}");
            }
            assert_eq!(outbox.is_empty(), model.bytes.is_empty() && !model.owed, "step {step}");
            assert_eq!(outbox.is_empty(), outbox.next().is_empty(), "step {step}");
            assert_eq!(outbox.dropped(), model.dropped, "step {step}");
        }
        assert!(outbox.dropped() > 1000);
    }

    #[test]
    fn a_frame_in_pieces_waits_until_it_is_whole_whatever_goes_meanwhile() {
        let mut outbox = Outbox::<300>::new();
        let old: Vec<u8> = core::iter::repeat_n(7, 149).chain([0]).collect();
        let new: Vec<u8> = core::iter::repeat_n(8, 199).chain([0]).collect();
        outbox.push(&old, WhenFull::DropOldest).unwrap();
        for _ in 0..100 {
            outbox.pop();
        }
        let mut arriving = Arriving::new(&new, WhenFull::DropOldest);
        let mut gone = Vec::new();
        while !outbox.take(&mut arriving).unwrap() {
            gone.extend(outbox.pop());
        }
        // 50 are left of the old frame: they and the new one fit.
        assert_eq!(outbox.dropped(), 0);
        gone.extend(drain(&mut outbox));
        assert_eq!(gone, [&old[100..], &new].concat());
    }

    #[test]
    fn an_old_frame_goes_in_pieces_and_the_line_gets_none_of_its_rest() {
        let frame = |byte: u8| -> Vec<u8> { core::iter::repeat_n(byte, 199).chain([0]).collect() };
        let mut outbox = Outbox::<300>::new();
        outbox.push(&frame(7), WhenFull::DropOldest).unwrap();
        outbox.pop();
        let new = frame(8);
        let mut arriving = Arriving::new(&new, WhenFull::DropOldest);
        let (mut gone, mut steps) = (Vec::new(), 0);
        while !outbox.take(&mut arriving).unwrap() {
            gone.extend(drain(&mut outbox));
            steps += 1;
        }
        // Four pieces of the old one, and four of the new one, of which the last is not counted.
        assert_eq!((gone, steps, outbox.dropped()), (vec![0], 7, 1));
        assert_eq!(drain(&mut outbox), new);
    }

    #[test]
    fn a_frame_of_the_whole_size_fits() {
        let mut outbox = Outbox::<4>::new();
        outbox.push(&[1, 2, 0], WhenFull::DropOldest).unwrap();
        outbox.push(&[1, 2, 3, 0], WhenFull::DropOldest).unwrap();
        assert_eq!(drain(&mut outbox), [1, 2, 3, 0]);
    }
}
