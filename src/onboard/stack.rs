//! How deep the stack has been, from paint that was laid at the start.

/// What the start-up code fills the stack with.
pub const PAINT: u32 = 0xCCCC_CCCC;

/// Bytes of the stack that were ever used. `stack` goes from its lowest address up; it grows downwards.
///
/// A value equal to the paint at the very edge is not seen; so the result may be a few words too small, never too large.
///
/// ```
/// use rundown::onboard::stack::{PAINT, high_water_bytes};
///
/// assert_eq!(high_water_bytes([PAINT, PAINT, 1, PAINT, 2].into_iter()), 12);
/// ```
pub fn high_water_bytes(stack: impl ExactSizeIterator<Item = u32>) -> usize {
    let words = stack.len();
    4 * (words - stack.take_while(|word| *word == PAINT).count())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn untouched_and_full_are_the_ends() {
        assert_eq!(high_water_bytes([PAINT; 8].into_iter()), 0);
        assert_eq!(high_water_bytes([0; 8].into_iter()), 32);
        assert_eq!(high_water_bytes([].into_iter()), 0);
    }
}
