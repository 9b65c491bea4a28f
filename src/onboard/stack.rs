//! How deep the stack has been, from paint that was laid at the start.

/// What the start-up code fills the stack with.
pub const PAINT: u32 = 0xCCCC_CCCC;

/// A run of paint that is longer than any frame of a function, words: below it nothing was used. Frames are listed by
/// `cargo xtask stack`.
pub const HOLE: usize = 1024;

/// Words below a mark that were ever used. `below` goes from the mark down, as the stack grows; it is read until paint
/// as long as [`HOLE`] has come.
///
/// A value equal to the paint at the very edge is not seen; so the result may be a few words too small, never too
/// large.
///
/// ```
/// use rundown::onboard::stack::{PAINT, words_used};
///
/// assert_eq!(words_used([2, PAINT, 1, PAINT, PAINT]), 3);
/// ```
pub fn words_used(below: impl IntoIterator<Item = u32>) -> usize {
    let (mut used, mut hole) = (0, 0);
    for word in below {
        hole += 1;
        if word != PAINT {
            used += hole;
            hole = 0;
        } else if hole == HOLE {
            break;
        }
    }
    used
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn untouched_and_full_are_the_ends() {
        assert_eq!(words_used([PAINT; 8]), 0);
        assert_eq!(words_used([0; 8]), 8);
        assert_eq!(words_used([]), 0);
    }

    #[test]
    fn paint_left_inside_a_frame_is_used_and_the_search_ends_below_it() {
        let mut stack = [PAINT; 3 * HOLE];
        stack[HOLE - 1] = 7;
        assert_eq!(words_used(stack), HOLE);
        stack[2 * HOLE] = 7;
        assert_eq!(words_used(stack), HOLE);
    }
}
