//! RAM that survives a reset: neither zeroed nor set at start-up.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;
use rundown::onboard::kept::{Kept, WORDS};
use rundown_wire::Failure;

struct Ram(UnsafeCell<MaybeUninit<[u32; WORDS]>>);

// SAFETY: one core, and every access below is a volatile copy of plain words within a critical section.
unsafe impl Sync for Ram {}

// SAFETY: no other symbol has this name, which the tests look up. The section is neither zeroed nor set; the type
// allows any content.
#[unsafe(export_name = "KEPT")]
#[unsafe(link_section = ".uninit.kept")]
static RAM: Ram = Ram(UnsafeCell::new(MaybeUninit::uninit()));

/// What was kept, if it is whole.
pub fn load() -> Option<Kept> {
    let words = cortex_m::interrupt::free(|_| {
        let mut words = [0; WORDS];
        for (index, word) in words.iter_mut().enumerate() {
            // SAFETY: within the array, aligned; RAM holds some bits after power-on too, and every bit pattern is a
            // u32.
            *word = unsafe { RAM.0.get().cast::<u32>().add(index).read_volatile() };
        }
        words
    });
    Kept::from_words(&words)
}

/// Keeps it.
pub fn store(kept: &Kept) {
    // Before the lock: the checksum takes some 7000 instructions, a byte's time on the line.
    let words = kept.to_words();
    cortex_m::interrupt::free(|_| {
        for (index, word) in words.into_iter().enumerate() {
            // SAFETY: within the array, aligned, and nothing else accesses it meanwhile.
            unsafe { RAM.0.get().cast::<u32>().add(index).write_volatile(word) };
        }
    });
}

/// Changes why the firmware fell, keeps the rest.
pub fn write_down(failure: Failure) {
    let mut kept = load().unwrap_or_default();
    kept.failure = failure;
    store(&kept);
}
