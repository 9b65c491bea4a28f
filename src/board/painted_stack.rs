//! How deep the stack has been: the start-up code of `cortex-m-rt` paints it.

use core::sync::atomic::{AtomicUsize, Ordering};
use rundown::onboard::stack::words_used;

unsafe extern "C" {
    /// Lowest word of the stack; the linker's symbol, its address is the value.
    static _stack_end: u32;
    /// One past its highest word.
    static _stack_start: u32;
}

/// Words ever used, as far as was looked.
static USED: AtomicUsize = AtomicUsize::new(0);

/// Bytes ever used. Goes on where the last call ended: what was used stays used.
pub fn high_water() -> u32 {
    let (low, high) = (&raw const _stack_end, &raw const _stack_start);
    let words = (high as usize - low as usize) / size_of::<u32>();
    let known = USED.load(Ordering::Relaxed);
    let below = (0..words.saturating_sub(known)).rev().map(|index| {
        // SAFETY: between the two symbols is RAM, aligned; read volatile, because what lies in use changes below the
        // compiler's eyes.
        unsafe { low.add(index).read_volatile() }
    });
    let used = known + words_used(below);
    USED.store(used, Ordering::Relaxed);
    u32::try_from(used * size_of::<u32>()).unwrap_or(u32::MAX)
}

/// Whether an exception's frame lies within the stack. It does not after an overflow.
pub fn holds(frame: *const u32) -> bool {
    (&raw const _stack_end..&raw const _stack_start).contains(&frame)
}
