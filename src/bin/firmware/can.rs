//! The CAN line of the firmware: the link task's side, with the feature `can`. Without it a line that takes everything
//! and brings nothing.

#[cfg(not(feature = "can"))]
pub use absent::{Counts, Line};
#[cfg(feature = "can")]
pub use present::{Counts, Line};

#[cfg(feature = "can")]
mod present {
    use crate::board::{can, device::Interrupt};
    use cortex_m::singleton;
    use heapless::spsc::Queue;
    use rundown::link::{Counters, Message};
    use rundown::onboard::can::line::CanLine;
    use rundown::onboard::can::{Ends, Mailbox};
    use rundown::onboard::outbox::WhenFull;
    use rundown::onboard::serial::LineErrors;

    /// Frames from the bus that may wait, less one: four blocks of flow control.
    const INCOMING: usize = 33;
    /// Frames for the bus that may wait, less one.
    const OUTGOING: usize = 17;
    /// Bytes of messages that may wait: the most that a tick sends.
    const WAITING: usize = 4096;

    /// What the line has counted.
    #[derive(Clone, Copy)]
    pub struct Counts {
        link: Counters,
        dropped: u32,
    }

    impl Counts {
        pub const NONE: Self = Self { link: Counters::ZERO, dropped: 0 };

        pub fn link(&self) -> Counters {
            self.link
        }

        /// Messages that had to make way for newer ones.
        pub fn dropped(&self) -> u32 {
            self.dropped
        }
    }

    /// None where the controller did not start.
    pub struct Line(Option<&'static mut CanLine<Ends<'static>, WAITING>>);

    impl Line {
        /// To be called once. A controller that does not start is counted as an error of the line.
        pub fn start(clock_hz: u32, errors: &'static LineErrors) -> Self {
            Self::try_start(clock_hz, errors).unwrap_or(Self(None))
        }

        // In a frame of its own, so that the stack of the start is given back.
        #[inline(never)]
        fn try_start(clock_hz: u32, errors: &'static LineErrors) -> Option<Self> {
            let (came, incoming) = singleton!(: Queue<Mailbox, INCOMING> = Queue::new())?.split();
            let (outgoing, goes) = singleton!(: Queue<Mailbox, OUTGOING> = Queue::new())?.split();
            if !can::start(clock_hz, came, goes, errors) {
                return None;
            }
            let ends = Ends { incoming, outgoing };
            Some(Self(singleton!(: CanLine<Ends<'static>, WAITING> = CanLine::new(ends))))
        }

        /// Takes a message as the serial line has it.
        pub fn push(&mut self, frame: &[u8], when_full: WhenFull) {
            if let Some(line) = &mut self.0 {
                // Where there is no room the line has counted it.
                let _ = line.push(frame, when_full);
                rtic::pend(Interrupt::TSC);
            }
        }

        /// Sends what is due; the next message that came.
        pub fn exchange(&mut self, now_us: u64) -> Option<Message> {
            let line = self.0.as_mut()?;
            let message = line.exchange(now_us);
            can::wake();
            if message.is_some() || line.is_due() {
                rtic::pend(Interrupt::TSC);
            }
            message
        }

        /// So far.
        pub fn counts(&self) -> Counts {
            let line = self.0.as_ref();
            line.map_or(Counts::NONE, |line| Counts { link: line.counters(), dropped: line.dropped() })
        }
    }
}

#[cfg(not(feature = "can"))]
mod absent {
    use rundown::link::{Counters, Message};
    use rundown::onboard::outbox::WhenFull;
    use rundown::onboard::serial::LineErrors;

    #[derive(Clone, Copy)]
    pub struct Counts;

    impl Counts {
        pub const NONE: Self = Self;

        pub fn link(&self) -> Counters {
            Counters::ZERO
        }

        pub fn dropped(&self) -> u32 {
            0
        }
    }

    pub struct Line;

    impl Line {
        pub fn start(_: u32, _: &LineErrors) -> Self {
            Self
        }

        pub fn push(&mut self, _: &[u8], _: WhenFull) {}

        pub fn exchange(&mut self, _: u64) -> Option<Message> {
            None
        }

        pub fn counts(&self) -> Counts {
            Counts
        }
    }
}
