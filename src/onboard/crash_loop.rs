//! When to stop trying: after [`MOST_RESETS`] resets within [`WINDOW_S`] the firmware sends heartbeats only, until the
//! power is taken away.
//!
//! In: the seconds that pass, and each reset that the firmware did not ask for. Out: [`Operation`]. Kept in RAM over
//! resets (see [`crate::onboard::kept`]); a power cut empties it. Time does not pass while the processor is held in
//! reset.

/// So many resets within the window end normal operation.
pub const MOST_RESETS: usize = 3;
/// Length of the window, s.
pub const WINDOW_S: u32 = 600;

/// What the firmware does after this boot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Operation {
    /// Everything.
    #[default]
    Normal,
    /// It says that it lives, and why nothing else; it estimates nothing.
    HeartbeatOnly,
}

/// The resets since power-on.
///
/// ```
/// use rundown::onboard::crash_loop::{CrashLoop, Operation};
///
/// let mut resets = CrashLoop::default();
/// assert_eq!(resets.reset(), Operation::Normal);
/// assert_eq!(resets.reset(), Operation::Normal);
/// assert_eq!(resets.reset(), Operation::HeartbeatOnly);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CrashLoop {
    /// Seconds since power-on.
    pub(crate) clock_s: u32,
    /// When the last resets were, oldest first; only the first `resets` count while these are fewer than the array
    /// holds.
    pub(crate) at_s: [u32; MOST_RESETS],
    /// All resets since power-on.
    pub(crate) resets: u32,
    /// Once given up, only a power cut helps.
    pub(crate) gave_up: bool,
}

impl CrashLoop {
    /// A second has passed.
    pub fn second(&mut self) {
        self.clock_s = self.clock_s.saturating_add(1);
    }

    /// The firmware begins again after a crash.
    pub fn reset(&mut self) -> Operation {
        self.resets = self.resets.saturating_add(1);
        self.at_s.rotate_left(1);
        if let Some(newest) = self.at_s.last_mut() {
            *newest = self.clock_s;
        }
        let enough = self.resets as usize >= MOST_RESETS;
        let oldest = self.at_s.first().copied().unwrap_or(0);
        self.gave_up |= enough && self.clock_s.saturating_sub(oldest) <= WINDOW_S;
        self.operation()
    }

    /// What is in force.
    pub fn operation(&self) -> Operation {
        if self.gave_up { Operation::HeartbeatOnly } else { Operation::Normal }
    }

    /// Resets since power-on.
    pub fn resets(&self) -> u32 {
        self.resets
    }

    /// Seconds since power-on, without the time spent in reset.
    pub fn clock_s(&self) -> u32 {
        self.clock_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pass(resets: &mut CrashLoop, seconds: u32) {
        for _ in 0..seconds {
            resets.second();
        }
    }

    #[test]
    fn three_resets_in_the_window_end_normal_operation() {
        let mut resets = CrashLoop::default();
        pass(&mut resets, 5000);
        assert_eq!(resets.reset(), Operation::Normal);
        pass(&mut resets, 300);
        assert_eq!(resets.reset(), Operation::Normal);
        pass(&mut resets, 300);
        assert_eq!(resets.reset(), Operation::HeartbeatOnly);
        assert_eq!(resets.resets(), 3);
    }

    #[test]
    fn a_reset_now_and_then_goes_on_for_ever() {
        let mut resets = CrashLoop::default();
        for _ in 0..50 {
            assert_eq!(resets.reset(), Operation::Normal);
            pass(&mut resets, WINDOW_S / 2 + 1);
        }
        assert_eq!(resets.resets(), 50);
    }

    #[test]
    fn giving_up_lasts() {
        let mut resets = CrashLoop::default();
        for _ in 0..MOST_RESETS {
            resets.reset();
        }
        pass(&mut resets, 10 * WINDOW_S);
        assert_eq!(resets.operation(), Operation::HeartbeatOnly);
        assert_eq!(resets.reset(), Operation::HeartbeatOnly);
    }

    #[test]
    fn the_first_seconds_do_not_count_as_resets() {
        let mut resets = CrashLoop::default();
        assert_eq!(resets.reset(), Operation::Normal);
        assert_eq!(resets.reset(), Operation::Normal);
    }
}
