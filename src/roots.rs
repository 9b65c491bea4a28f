//! Square roots of doubles, and of sums of two squares.
//!
//! In: numbers. Out: the nearest double, which is the same one wherever it is computed; of the sum the double that
//! libm's `hypot` gives.
//!
//! A processor without doubles finds half of a root bit by bit, and the other half by divisions: 700 B less than
//! libm's, which is the faster one on a host.

use crate::Real;

/// Bits of the mantissa without the first one, which is not stored.
const STORED: u32 = 52;
/// Exponent of 1.
const BIAS: i32 = 1023;

/// √x; of a negative number none.
pub(crate) fn square_root(x: Real) -> Real {
    if cfg!(target_os = "none") { by_bits(x) } else { libm::sqrt(x) }
}

/// √(a² + b²), of numbers whose squares are neither too large nor too small for a double.
pub(crate) fn hypotenuse(a: Real, b: Real) -> Real {
    // No `max`: what is no number would be left out by it.
    let [(large, large_below), (small, small_below)] = if a > b { [a, b] } else { [b, a] }.map(square);
    square_root(small_below + large_below + small + large)
}

/// x² without a rounding: its double, and what that lacks (Dekker, "A floating-point technique for extending the
/// available precision", 1971).
fn square(x: Real) -> (Real, Real) {
    let shifted = x * 134_217_729.0;
    let upper = x - shifted + shifted;
    let lower = x - upper;
    let square = x * x;
    (square, upper * upper - square + 2.0 * upper * lower + lower * lower)
}

#[inline(never)]
fn by_bits(x: Real) -> Real {
    let bits = x.to_bits();
    // As whole numbers, what is negative and what is no number are above what is infinite.
    if bits << 1 == 0 || bits == Real::INFINITY.to_bits() {
        return x;
    }
    if bits > Real::INFINITY.to_bits() {
        return Real::NAN;
    }
    let (exponent, stored) = ((bits >> STORED) as i32, bits & ((1 << STORED) - 1));
    let mantissa = if exponent == 0 { stored << 1 } else { stored | 1 << STORED };
    let up = mantissa.leading_zeros() as i32 - 11;
    let exponent = exponent - up - BIAS;
    // The exponent is halved, and what is left of it belongs to the mantissa: 54 bits, from the top.
    let mut bits = mantissa << (up + 10);
    if exponent & 1 != 0 {
        bits <<= 1;
    }
    let (mut root, mut rest) = (0_u32, 0_u32);
    for _ in 0..27 {
        rest = rest << 2 | (bits >> 62) as u32;
        bits <<= 2;
        let step = root << 2 | 1;
        root <<= 1;
        if rest >= step {
            rest -= step;
            root |= 1;
        }
    }
    // The other half of the root is what is left over twice the first half, or one less (Zimmermann, "Karatsuba square
    // root", 1999).
    let mut lower = 0_u32;
    for _ in 0..13 {
        rest <<= 2;
        // The first half is not 0.
        let digit = rest.checked_div(root).unwrap_or(0);
        rest -= digit * root;
        lower = (lower << 2) + digit;
    }
    if u64::from(rest) << 28 < u64::from(lower) * u64::from(lower) {
        lower -= 1;
    }
    let root = (u64::from(root) << 27) + u64::from(lower);
    // One bit more than a double has; no root lies in the middle between two. The first bit adds one to the exponent.
    Real::from_bits(((((exponent >> 1) + BIAS - 1) as u64) << STORED) + root.div_ceil(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of all sizes, and the numbers beside squares.
    fn numbers() -> impl Iterator<Item = Real> {
        let edges = [0.0, -0.0, -1.0, Real::MIN_POSITIVE, Real::MAX, Real::INFINITY, Real::NEG_INFINITY, Real::NAN];
        let smallest = (0..STORED).map(|bit| Real::from_bits(1 << bit));
        let mut bits = 0x9E37_79B9_7F4A_7C15_u64;
        let any = (0..200_000).flat_map(move |_| {
            // Marsaglia's xorshift.
            bits ^= bits << 13;
            bits ^= bits >> 7;
            bits ^= bits << 17;
            let root = Real::from_bits((bits & ((1 << STORED) - 1)) | 0x3FF << STORED);
            let square = (root * root).to_bits();
            [bits & !(1 << 63), square, square - 1, square + 1].map(Real::from_bits)
        });
        edges.into_iter().chain(smallest).chain(any)
    }

    #[test]
    fn roots_by_bits_are_those_of_libm() {
        for x in numbers() {
            let (found, expected) = (by_bits(x), libm::sqrt(x));
            assert!(found.to_bits() == expected.to_bits() || (found.is_nan() && expected.is_nan()), "{x:e}: {found:e}");
        }
    }

    #[test]
    fn hypotenuses_are_those_of_libm() {
        assert!(hypotenuse(Real::NAN, 1.0).is_nan() && hypotenuse(1.0, Real::NAN).is_nan());
        let mut before = 1.0;
        for x in numbers().filter(|x| x.is_normal()) {
            // Of sizes that uncertainties have.
            let x = Real::from_bits(x.to_bits() & !(1 << 63 | 0x7F0 << STORED) | 0x3F0 << STORED);
            for y in [before, 0.0, 1e-12 * before] {
                let (found, expected) = (hypotenuse(x, y), libm::hypot(x, y));
                assert!(found.to_bits() == expected.to_bits(), "{x:e} {y:e}: {found:e}");
                assert!(hypotenuse(y, x).to_bits() == expected.to_bits(), "{y:e} {x:e}");
            }
            before = x;
        }
    }
}
