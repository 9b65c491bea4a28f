//! Time in counts of the system timer, which runs with the processor's clock here and in the emulator (a cycle counter
//! does not).

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

/// Time since the start, µs, from the periods of the timer that have passed. For tasks below the timer's priority:
/// there the count and the periods fit.
#[cfg(feature = "can")]
pub fn now_us(periods: &AtomicU32) -> u64 {
    let period = PERIOD.load(Ordering::Relaxed);
    let mut now = (periods.load(Ordering::Relaxed), SYST::get_current());
    // A period that ends between the two readings is over at the second.
    if periods.load(Ordering::Relaxed) != now.0 {
        now = (periods.load(Ordering::Relaxed), SYST::get_current());
    }
    let counts = period.saturating_sub(now.1) / PER_US.load(Ordering::Relaxed);
    u64::from(now.0) * u64::from(1_000_000 / TIMER_HZ) + u64::from(counts)
}

/// Nothing asks.
#[cfg(not(feature = "can"))]
pub fn now_us(_: &AtomicU32) -> u64 {
    0
}

/// Counts that were spent apart, see [`apart`]; wraps.
static APART: AtomicU32 = AtomicU32::new(0);

/// A moment.
pub struct Stopwatch {
    count: u32,
    apart: u32,
}

impl Stopwatch {
    /// Now.
    pub fn start() -> Self {
        Self { count: SYST::get_current(), apart: APART.load(Ordering::Relaxed) }
    }

    /// Ends it; the longest is remembered. Right if fewer than a period of the timer have passed.
    pub fn stop(self) {
        let apart = APART.load(Ordering::Relaxed).wrapping_sub(self.apart);
        LONGEST.fetch_max(since(self.count).saturating_sub(apart), Ordering::Relaxed);
    }
}

/// Does what no stopwatch counts: handing bytes to the line, which takes some µs here and in the emulator as long as
/// there are bytes, for its line takes all at once. From one priority only.
pub fn apart<T>(what: impl FnOnce() -> T) -> T {
    let count = SYST::get_current();
    let done = what();
    let apart = APART.load(Ordering::Relaxed).wrapping_add(since(count));
    APART.store(apart, Ordering::Relaxed);
    done
}

/// Counts since the timer stood so.
fn since(count: u32) -> u32 {
    let now = SYST::get_current();
    // The timer counts down.
    if count >= now { count - now } else { count + (PERIOD.load(Ordering::Relaxed) - now) }
}

/// Longest time between a start and its stop, µs.
pub fn longest_us() -> u32 {
    LONGEST.load(Ordering::Relaxed) / PER_US.load(Ordering::Relaxed)
}
