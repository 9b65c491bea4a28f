//! How deep the stack has been: the start-up code of `cortex-m-rt` paints it.

use rundown::onboard::stack::high_water_bytes;

unsafe extern "C" {
    /// Lowest word of the stack; the linker's symbol, its address is the value.
    static _stack_end: u32;
    /// One past its highest word.
    static _stack_start: u32;
}

/// Bytes ever used.
pub fn high_water() -> u32 {
    let (low, high) = (&raw const _stack_end, &raw const _stack_start);
    let words = (high as usize - low as usize) / size_of::<u32>();
    let stack = (0..words).map(|index| {
        // SAFETY: between the two symbols is RAM, aligned; read volatile, because what lies in use changes below the compiler's eyes.
        unsafe { low.add(index).read_volatile() }
    });
    u32::try_from(high_water_bytes(stack)).unwrap_or(u32::MAX)
}

/// Whether an exception's frame lies within the stack. It does not after an overflow.
pub fn holds(frame: *const u32) -> bool {
    (&raw const _stack_end..&raw const _stack_start).contains(&frame)
}
