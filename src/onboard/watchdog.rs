//! When the watchdog may be fed: both tasks have advanced since the last feed.
//!
//! In: the beats of the tick task and of the link task, counted by each of them. Out: feed or not, and who stands
//! still. A timer alone must not feed, it runs on while a task hangs; one task alone must not feed, it hides the other
//! one.

pub use rundown_wire::Stalled;

/// A hardware watchdog that is running. It cannot be stopped, only fed.
pub trait Watchdog {
    /// Restarts its time.
    fn feed(&mut self);
}

/// Beats of the two tasks. A beat is counted at the end of a task's work, so a task that hangs half-way has not
/// advanced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Beats {
    /// Of the tick task.
    pub tick: u32,
    /// Of the link task.
    pub link: u32,
}

/// The rule. Asked by a timer that outranks both tasks.
///
/// ```
/// use rundown::onboard::watchdog::{Beats, FeedRule, Stalled};
///
/// let mut rule = FeedRule::default();
/// assert_eq!(rule.ask(Beats { tick: 1, link: 1 }), Ok(()));
/// assert_eq!(rule.ask(Beats { tick: 1, link: 9 }), Err(Stalled { tick: true, link: false }));
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct FeedRule {
    at_last_feed: Beats,
}

impl FeedRule {
    /// May the watchdog be fed now? If so, both have to advance again before the next time.
    ///
    /// # Errors
    /// Who stands still.
    pub fn ask(&mut self, now: Beats) -> Result<(), Stalled> {
        // Unequal, not greater: the counters wrap.
        let stalled = Stalled { tick: now.tick == self.at_last_feed.tick, link: now.link == self.at_last_feed.link };
        if stalled == Stalled::default() {
            self.at_last_feed = now;
            Ok(())
        } else {
            Err(stalled)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_feed_needs_both_to_advance_again() {
        let mut rule = FeedRule::default();
        assert_eq!(rule.ask(Beats { tick: 1, link: 3 }), Ok(()));
        let both = Stalled { tick: true, link: true };
        assert_eq!(rule.ask(Beats { tick: 1, link: 3 }), Err(both));
        assert_eq!(rule.ask(Beats { tick: 2, link: 4 }), Ok(()));
    }

    #[test]
    fn a_task_that_runs_wild_does_not_feed_for_the_other() {
        let mut rule = FeedRule::default();
        for beat in 1..1000 {
            let stalled = rule.ask(Beats { tick: beat, link: 0 });
            assert_eq!(stalled, Err(Stalled { tick: false, link: true }));
        }
    }

    #[test]
    fn advances_between_two_questions_add_up() {
        let mut rule = FeedRule::default();
        assert!(rule.ask(Beats { tick: 1, link: 0 }).is_err());
        assert_eq!(rule.ask(Beats { tick: 1, link: 1 }), Ok(()));
    }

    #[test]
    fn wrapped_counters_still_advance() {
        let mut rule = FeedRule::default();
        let last = Beats { tick: u32::MAX, link: u32::MAX };
        assert_eq!(rule.ask(last), Ok(()));
        assert_eq!(rule.ask(Beats { tick: 0, link: 0 }), Ok(()));
    }
}
