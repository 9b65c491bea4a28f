//! Which clock the processor runs at: 80 MHz from the PLL, or the 4 MHz it woke up with.
//!
//! In: an oscillator, a PLL and a flash that may be dead. Out: a clock that runs, and why it is not the fast one. Every
//! wait is bounded, so a dead crystal costs speed, not the train's estimates: the longest call, of 320 to 590 k
//! instructions, takes 80 to 150 ms at 4 MHz. A flood of forged messages is too much for it there (docs/faults.md).

use rundown_wire::LineCounts;

/// Frequency after reset, Hz.
pub const SLOW_HZ: u32 = 4_000_000;
/// Frequency with the PLL, Hz.
pub const FAST_HZ: u32 = 80_000_000;
/// Longest wait for one thing, polls. At 4 MHz and some 10 cycles a poll this is 50 ms; a PLL locks within 40 µs.
pub const MOST_POLLS: u32 = 20_000;

/// The steps that a clock tree can be asked for. Each `..._ready` is polled.
pub trait ClockTree {
    /// Starts the PLL on the internal oscillator.
    fn start_pll(&mut self);
    /// The PLL is locked.
    fn pll_ready(&self) -> bool;
    /// Sets the flash to the wait states that [`FAST_HZ`] needs.
    fn set_wait_states(&mut self);
    /// The flash has taken them.
    fn wait_states_ready(&self) -> bool;
    /// Runs the processor from the PLL.
    fn select_pll(&mut self);
    /// The processor runs from the PLL.
    fn pll_selected(&self) -> bool;
    /// Back to the internal oscillator, which has been running all the time; stops the PLL.
    fn back_to_slow(&mut self);
}

/// What did not come in time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Late {
    /// The PLL did not lock.
    Pll,
    /// The flash did not take its wait states; the fast clock would read wrong instructions.
    WaitStates,
    /// The switch to the PLL did not happen.
    Switch,
}

/// The clock in force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// [`FAST_HZ`].
    Fast,
    /// [`SLOW_HZ`], because something was late.
    Slow(Late),
}

impl Clock {
    /// Frequency of the processor and its buses, Hz.
    pub const fn hz(self) -> u32 {
        match self {
            Self::Fast => FAST_HZ,
            Self::Slow(_) => SLOW_HZ,
        }
    }
}

/// Brings the clock up, or leaves the slow one in force.
pub fn start(tree: &mut impl ClockTree) -> Clock {
    match try_fast(tree) {
        Ok(()) => Clock::Fast,
        Err(late) => {
            tree.back_to_slow();
            Clock::Slow(late)
        }
    }
}

fn try_fast(tree: &mut impl ClockTree) -> Result<(), Late> {
    tree.start_pll();
    bounded(|| tree.pll_ready()).ok_or(Late::Pll)?;
    tree.set_wait_states();
    bounded(|| tree.wait_states_ready()).ok_or(Late::WaitStates)?;
    tree.select_pll();
    bounded(|| tree.pll_selected()).ok_or(Late::Switch)
}

/// A crystal whose switch stands behind a write protection: what is written too early is lost without a word.
pub trait Crystal {
    /// Takes the protection away.
    fn unprotect(&mut self);
    /// It is away.
    fn is_unprotected(&self) -> bool;
    /// Switches it on.
    fn switch_on(&mut self);
    /// The switch has taken it; that it runs comes later.
    fn is_on(&self) -> bool;
}

/// Switches a crystal on; none where the switch does not take it.
pub fn start_crystal(crystal: &mut impl Crystal) -> Option<()> {
    crystal.unprotect();
    // One that never says so is tried all the same: the switch is asked.
    let _unprotected = bounded(|| crystal.is_unprotected());
    bounded(|| {
        crystal.switch_on();
        crystal.is_on()
    })
}

/// A crystal that does not run so long after the start is missed, s. Its start takes 2 s, typically (data sheet of the
/// STM32L475, low-speed external oscillator).
pub const CRYSTAL_START_S: u32 = 5;

/// Whether the crystal has come. Nothing waits for it: one that comes later trims the oscillator all the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CrystalWatch {
    missed: bool,
}

impl CrystalWatch {
    /// To be asked now and then. True once, where it does not run and its time is over.
    pub fn is_missed(&mut self, runs: bool, uptime_s: u32) -> bool {
        let news = !runs && uptime_s >= CRYSTAL_START_S && !self.missed;
        self.missed |= news;
        news
    }

    /// What went wrong on the line, with a crystal that was missed: without it bytes may be lost.
    pub fn counted(self, line: LineCounts) -> LineCounts {
        LineCounts { other: line.other.saturating_add(self.missed.into()), ..line }
    }
}

/// Polls until it is so, at most [`MOST_POLLS`] times.
///
/// ```
/// use rundown::onboard::clock::bounded;
///
/// let mut polls = 0;
/// assert_eq!(bounded(|| { polls += 1; polls == 3 }), Some(()));
/// assert_eq!(bounded(|| false), None);
/// ```
pub fn bounded(mut ready: impl FnMut() -> bool) -> Option<()> {
    (0..MOST_POLLS).any(|_| ready()).then_some(())
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use core::cell::Cell;

    /// A clock tree that dies at a chosen step.
    struct Mock {
        dead: Option<Late>,
        running_from_pll: bool,
        wait_states: bool,
    }

    impl Mock {
        fn new(dead: Option<Late>) -> Self {
            Self { dead, running_from_pll: false, wait_states: false }
        }
    }

    impl ClockTree for Mock {
        fn start_pll(&mut self) {}
        fn pll_ready(&self) -> bool {
            self.dead != Some(Late::Pll)
        }
        fn set_wait_states(&mut self) {
            self.wait_states = self.dead != Some(Late::WaitStates);
        }
        fn wait_states_ready(&self) -> bool {
            self.wait_states
        }
        fn select_pll(&mut self) {
            assert!(self.wait_states && self.dead != Some(Late::Pll));
            self.running_from_pll = true;
        }
        fn pll_selected(&self) -> bool {
            self.dead != Some(Late::Switch)
        }
        fn back_to_slow(&mut self) {
            self.running_from_pll = false;
        }
    }

    #[test]
    fn a_healthy_tree_runs_fast() {
        let mut tree = Mock::new(None);
        assert_eq!(start(&mut tree), Clock::Fast);
        assert!(tree.running_from_pll);
    }

    #[test]
    fn whatever_dies_the_slow_clock_stays() {
        for late in [Late::Pll, Late::WaitStates, Late::Switch] {
            let mut tree = Mock::new(Some(late));
            let clock = start(&mut tree);
            assert_eq!(clock, Clock::Slow(late));
            assert_eq!(clock.hz(), SLOW_HZ);
            assert!(!tree.running_from_pll, "{late:?}");
        }
    }

    /// A crystal behind a protection that goes after some polls, with a switch that loses some writes.
    struct Protected {
        polls_left: Cell<u32>,
        lost_writes: u32,
        on: bool,
    }

    impl Crystal for Protected {
        fn unprotect(&mut self) {}
        fn is_unprotected(&self) -> bool {
            self.polls_left.set(self.polls_left.get().saturating_sub(1));
            self.polls_left.get() == 0
        }
        fn switch_on(&mut self) {
            if self.polls_left.get() > 0 {
                return;
            }
            self.on = self.lost_writes == 0;
            self.lost_writes = self.lost_writes.saturating_sub(1);
        }
        fn is_on(&self) -> bool {
            self.on
        }
    }

    #[test]
    fn a_crystal_is_switched_on_once_its_protection_is_away_and_until_it_is_on() {
        for (polls, lost_writes, expected) in
            [(1, 0, Some(())), (100, 3, Some(())), (MOST_POLLS, 0, Some(())), (u32::MAX, 0, None), (1, u32::MAX, None)]
        {
            let mut crystal = Protected { polls_left: Cell::new(polls), lost_writes, on: false };
            assert_eq!(start_crystal(&mut crystal), expected, "{polls} polls, {lost_writes} writes");
            assert_eq!(crystal.on, expected.is_some());
        }
    }

    #[test]
    fn a_crystal_that_does_not_come_is_missed_once_and_counted_on_the_line() {
        let line = LineCounts { framing: 7, other: 2, ..LineCounts::default() };
        let mut watch = CrystalWatch::default();
        let told: std::vec::Vec<u32> = (0..600).filter(|second| watch.is_missed(false, *second)).collect();
        assert_eq!(told, [CRYSTAL_START_S]);
        // Whether it comes later or not.
        assert!(!watch.is_missed(true, 600));
        assert_eq!(watch.counted(line), LineCounts { other: 3, ..line });

        let mut watch = CrystalWatch::default();
        assert!((0..600).all(|second| !watch.is_missed(second >= CRYSTAL_START_S, second)));
        assert_eq!(watch.counted(line), line);
    }

    #[test]
    fn a_wait_ends() {
        let mut polls = 0;
        assert_eq!(
            bounded(|| {
                polls += 1;
                false
            }),
            None
        );
        assert_eq!(polls, MOST_POLLS);
    }
}
