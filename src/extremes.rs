//! The larger and the smaller of two numbers.
//!
//! In: two numbers. Out: one of them; where one is no number, the other one; of equal ones, two zeros among them, the
//! second one. Of zeros core's `max` and `min` leave the sign to the compiler.
//!
//! From Rust 1.96 on the compiler writes core's functions out wherever they are called. Of doubles that takes some 50 B
//! each time on a processor without them: here they are functions, which a board has once.

use crate::Real;

/// `max` and `min`, under names that say what comes out.
pub(crate) trait Extremes {
    /// The number, or the other one if that is larger.
    fn at_least(self, least: Self) -> Self;

    /// The number, or the other one if that is smaller.
    fn at_most(self, most: Self) -> Self;
}

impl Extremes for Real {
    #[cfg_attr(target_os = "none", inline(never))]
    fn at_least(self, least: Self) -> Self {
        if self > least || least.is_nan() { self } else { least }
    }

    #[cfg_attr(target_os = "none", inline(never))]
    fn at_most(self, most: Self) -> Self {
        if self < most || most.is_nan() { self } else { most }
    }
}

// A few instructions where the processor has single precision.
impl Extremes for f32 {
    fn at_least(self, least: Self) -> Self {
        if self > least || least.is_nan() { self } else { least }
    }

    fn at_most(self, most: Self) -> Self {
        if self < most || most.is_nan() { self } else { most }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_are_max_and_min() {
        let numbers = [Real::NEG_INFINITY, -1.0, -Real::MIN_POSITIVE, 0.0, Real::MIN_POSITIVE, 1.0, Real::INFINITY];
        for a in numbers {
            for b in numbers {
                let (a_single, b_single) = (a as f32, b as f32);
                assert_eq!((a.at_least(b), a.at_most(b)), (a.max(b), a.min(b)));
                assert_eq!(a_single.at_least(b_single), a_single.max(b_single));
                assert_eq!(a_single.at_most(b_single), a_single.min(b_single));
            }
        }
    }

    #[test]
    fn what_is_no_number_is_left_out() {
        for number in [Real::NEG_INFINITY, -1.0, 0.0, Real::INFINITY] {
            assert_eq!((number.at_least(Real::NAN), Real::NAN.at_least(number)), (number, number));
            assert_eq!((number.at_most(Real::NAN), Real::NAN.at_most(number)), (number, number));
        }
        assert!(Real::NAN.at_least(Real::NAN).is_nan() && Real::NAN.at_most(Real::NAN).is_nan());
    }

    #[test]
    fn of_two_zeros_it_is_the_second_one() {
        for (first, second) in [(0.0, -0.0), (-0.0, 0.0)] {
            let second_bits = Real::to_bits(second);
            assert_eq!(Real::to_bits(Real::at_least(first, second)), second_bits);
            assert_eq!(Real::to_bits(Real::at_most(first, second)), second_bits);
        }
    }
}
