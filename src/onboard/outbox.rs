//! Frames that wait for the line. When the line does not take them, the oldest goes, so that the newest estimate is the one that is sent.
//!
//! In: whole frames, each with the delimiter at its end and nowhere else (COBS). Out: bytes, one by one.
//! A frame of which a part has gone is cut short by its delimiter: the receiver refuses that one and reads the next.

use heapless::Deque;
use rundown_wire::errors;

/// End of a frame.
pub const DELIMITER: u8 = 0;

errors! {
    /// Why a frame was not taken.
    #[derive(Eq)]
    pub struct TooLong { found: usize, capacity: usize } => "frame: expected at most {capacity} bytes, found {found}";
}

/// A queue of frames in `N` bytes.
///
/// ```
/// use rundown::onboard::outbox::Outbox;
///
/// let mut outbox = Outbox::<8>::new();
/// outbox.push(&[1, 2, 3, 0])?;
/// outbox.push(&[4, 5, 6, 0])?;
/// outbox.push(&[7, 0])?; // the first goes
/// assert_eq!(outbox.dropped(), 1);
/// assert_eq!(outbox.pop(), Some(4));
/// # Ok::<(), rundown::onboard::outbox::TooLong>(())
/// ```
#[derive(Debug, Default)]
pub struct Outbox<const N: usize> {
    bytes: Deque<u8, N>,
    /// The front is the inside of a frame of which a part has gone.
    inside: bool,
    /// A frame was cut; its delimiter is still to be sent.
    owed: bool,
    dropped: u32,
}

impl<const N: usize> Outbox<N> {
    /// An empty one.
    pub const fn new() -> Self {
        Self { bytes: Deque::new(), inside: false, owed: false, dropped: 0 }
    }

    /// Takes a whole frame, at the cost of the oldest ones if there is no room.
    ///
    /// # Errors
    /// [`TooLong`]: it would not fit into an empty outbox. Nothing changes.
    pub fn push(&mut self, frame: &[u8]) -> Result<(), TooLong> {
        if frame.len() > N {
            return Err(TooLong { found: frame.len(), capacity: N });
        }
        while N - self.bytes.len() < frame.len() {
            self.drop_oldest();
        }
        for byte in frame {
            // There is room: see above.
            let _ = self.bytes.push_back(*byte);
        }
        Ok(())
    }

    /// Next byte for the line.
    pub fn pop(&mut self) -> Option<u8> {
        if self.owed {
            self.owed = false;
            return Some(DELIMITER);
        }
        let byte = self.bytes.pop_front()?;
        self.inside = byte != DELIMITER;
        Some(byte)
    }

    /// The byte that [`Self::pop`] would give.
    pub fn front(&self) -> Option<u8> {
        if self.owed { Some(DELIMITER) } else { self.bytes.front().copied() }
    }

    /// Nothing waits.
    pub fn is_empty(&self) -> bool {
        self.bytes.is_empty() && !self.owed
    }

    /// Frames that went unsent, or were cut.
    pub fn dropped(&self) -> u32 {
        self.dropped
    }

    fn drop_oldest(&mut self) {
        self.owed |= self.inside;
        self.inside = false;
        while self.bytes.pop_front().is_some_and(|byte| byte != DELIMITER) {}
        self.dropped = self.dropped.saturating_add(1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    extern crate std;
    use std::vec::Vec;

    fn drain<const N: usize>(outbox: &mut Outbox<N>) -> Vec<u8> {
        core::iter::from_fn(|| outbox.pop()).collect()
    }

    #[test]
    fn frames_come_out_as_they_went_in() {
        let mut outbox = Outbox::<16>::new();
        outbox.push(&[1, 2, 0]).unwrap();
        outbox.push(&[3, 0]).unwrap();
        assert_eq!(drain(&mut outbox), [1, 2, 0, 3, 0]);
        assert!(outbox.is_empty());
        assert_eq!(outbox.dropped(), 0);
    }

    #[test]
    fn a_frame_half_sent_ends_in_a_delimiter_of_its_own() {
        let mut outbox = Outbox::<6>::new();
        outbox.push(&[1, 2, 3, 0]).unwrap();
        assert_eq!(outbox.pop(), Some(1));
        outbox.push(&[4, 5, 6, 0]).unwrap();
        assert_eq!(drain(&mut outbox), [0, 4, 5, 6, 0]);
        assert_eq!(outbox.dropped(), 1);
    }

    #[test]
    fn a_reader_that_was_away_finds_the_newest_whole() {
        let mut outbox = Outbox::<10>::new();
        outbox.push(&[9, 9, 9, 0]).unwrap();
        outbox.pop();
        for value in 1..=100 {
            outbox.push(&[value, value, 0]).unwrap();
        }
        assert_eq!(drain(&mut outbox), [0, 98, 98, 0, 99, 99, 0, 100, 100, 0]);
        assert_eq!(outbox.dropped(), 98);
    }

    #[test]
    fn a_frame_that_never_fits_changes_nothing() {
        let mut outbox = Outbox::<4>::new();
        outbox.push(&[1, 0]).unwrap();
        assert_eq!(outbox.push(&[1, 2, 3, 4, 0]), Err(TooLong { found: 5, capacity: 4 }));
        assert_eq!(drain(&mut outbox), [1, 0]);
    }

    #[test]
    fn a_frame_of_the_whole_size_fits() {
        let mut outbox = Outbox::<4>::new();
        outbox.push(&[1, 2, 0]).unwrap();
        outbox.push(&[1, 2, 3, 0]).unwrap();
        assert_eq!(drain(&mut outbox), [1, 2, 3, 0]);
    }
}
