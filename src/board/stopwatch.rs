//! Time in counts of the system timer, which runs with the processor's clock here and in the emulator (a cycle counter does not).

use core::sync::atomic::{AtomicU32, Ordering};
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;

/// Counts of one period, and per microsecond; set by [`start`].
static PERIOD: AtomicU32 = AtomicU32::new(1);
static PER_US: AtomicU32 = AtomicU32::new(1);

/// Longest time so far, counts. The name is for `cargo xtask budget`, which reads it from the emulator's memory.
// SAFETY: no other symbol has this name.
#[unsafe(export_name = "LONGEST_COUNTS")]
static LONGEST: AtomicU32 = AtomicU32::new(0);

/// Interrupts a second. More would cost an emulated day an hour.
pub const TIMER_HZ: u32 = 10;

/// Starts the system timer at [`TIMER_HZ`] with its interrupt.
pub fn start(timer: &mut SYST, clock_hz: u32) {
    let period = clock_hz / TIMER_HZ;
    PERIOD.store(period, Ordering::Relaxed);
    PER_US.store(clock_hz / 1_000_000, Ordering::Relaxed);
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(period - 1);
    timer.clear_current();
    timer.enable_counter();
    timer.enable_interrupt();
}

/// A moment.
pub struct Stopwatch {
    count: u32,
}

impl Stopwatch {
    /// Now.
    pub fn start() -> Self {
        Self { count: SYST::get_current() }
    }

    /// Ends it; the longest is remembered. Right if fewer than a period of the timer have passed.
    pub fn stop(self) {
        let now = SYST::get_current();
        // The timer counts down.
        let counts =
            if self.count >= now { self.count - now } else { self.count + (PERIOD.load(Ordering::Relaxed) - now) };
        LONGEST.fetch_max(counts, Ordering::Relaxed);
    }
}

/// Longest time between a start and its stop, µs.
pub fn longest_us() -> u32 {
    LONGEST.load(Ordering::Relaxed) / PER_US.load(Ordering::Relaxed)
}
