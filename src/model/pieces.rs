//! Into how many equal pieces a time or a way is divided, and whole numbers.

use crate::Real;

/// The fewest pieces of `length` of which none is longer than `longest`: at least 1, at most `most`. 1 of what is no
/// number.
// By a whole number, which the board has code for; libm's `ceil` would be for this alone.
#[inline(never)]
pub(crate) fn pieces(length: Real, longest: Real, most: u32) -> u32 {
    let least = length / longest;
    let full = whole(least);
    let begun = u32::from(Real::from(full) < least);
    full.saturating_add(begun).clamp(1, most)
}

/// Without what is behind the point: 0 of what is below 0 or no number, at most [`u32::MAX`].
// Once on the board, where it takes 40 bytes.
#[cfg_attr(not(target_os = "none"), inline)]
#[cfg_attr(target_os = "none", inline(never))]
pub(crate) fn whole(number: Real) -> u32 {
    number as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_are_as_long_as_they_may_be() {
        for (length, longest, expected) in [
            (10.0, 2.5, 4),
            (10.1, 2.5, 5),
            (1.0, 2.5, 1),
            (0.0, 2.5, 1),
            (-5.0, 2.5, 1),
            (1e9, 2.5, 1000),
            (1e300, 2.5, 1000),
            (Real::NAN, 2.5, 1),
        ] {
            assert_eq!(pieces(length, longest, 1000), expected, "{length}");
        }
    }

    #[test]
    fn they_are_those_of_a_number_rounded_up() {
        for i in 1..20_000 {
            let length = 0.037 * Real::from(i);
            assert_eq!(Real::from(pieces(length, 2.5, 1000)), libm::ceil(length / 2.5).clamp(1.0, 1000.0), "{length}");
        }
    }
}
