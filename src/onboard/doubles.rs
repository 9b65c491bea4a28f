//! Sums, products, quotients, comparisons and conversions of doubles in whole numbers: IEEE 754, to the nearest, the
//! even one of two.
//!
//! In and out: the bits of doubles. To the bit what a processor with doubles finds, but for which NaN an operation
//! without a result gives.
//!
//! A processor with single precision only spends most of the estimator's time on them, so a board has sums and products
//! in its own instructions for the usual numbers (`src/board/soft_doubles.rs`): this is what those are held against,
//! and what the board does with the others, and with quotients.

use core::cmp::Ordering;

/// Bits of the mantissa without the first one, which is not stored.
const STORED: u32 = 52;
const FIRST: u64 = 1 << STORED;
/// Bit of the sign.
pub const SIGN: u64 = 1 << 63;
/// Exponent of what is infinite or no number.
const BEYOND: u32 = 0x7FF;
const INFINITE: u64 = (BEYOND as u64) << STORED;
const NO_NUMBER: u64 = INFINITE | FIRST >> 1;
/// Exponent of 1.
const BIAS: i32 = 1023;
/// Bits below the last one while a number is made.
const BELOW: u32 = 10;

/// A mantissa with its exponent: what is too small for a first bit has that of the smallest number with one.
fn parts(bits: u64) -> (u32, u64) {
    let (exponent, stored) = ((bits >> STORED) as u32 & BEYOND, bits & (FIRST - 1));
    if exponent == 0 { (1, stored) } else { (exponent, stored | FIRST) }
}

/// Shifted down; what falls out leaves the last bit set.
fn shifted(bits: u64, by: u32) -> u64 {
    match by {
        0 => bits,
        1..64 => bits >> by | u64::from(bits << (64 - by) != 0),
        _ => u64::from(bits != 0),
    }
}

/// The number of this sign, exponent and mantissa, which has the bits below, and its first bit as the 62nd or, at the
/// least exponent, lower.
// Of the sign the upper half: so all stands in four registers, and nothing of the caller is left on the stack.
fn finished(sign: u32, exponent: i32, mantissa: u64) -> u64 {
    let sign = u64::from(sign) << 32;
    if exponent >= BEYOND as i32 {
        return sign | INFINITE;
    }
    let (exponent, mantissa) =
        if exponent < 1 { (1, shifted(mantissa, (1 - exponent) as u32)) } else { (exponent, mantissa) };
    let half = 1 << (BELOW - 1);
    let mantissa = (mantissa + (half - 1) + (mantissa >> BELOW & 1)) >> BELOW;
    // The first bit, where there is one, adds one to the exponent; so does a mantissa that is rounded up to the next
    // one's.
    sign | ((((exponent - 1) as u64) << STORED) + mantissa)
}

/// a + b.
///
/// ```
/// use rundown::onboard::doubles::add;
///
/// assert_eq!(add(0.1_f64.to_bits(), 0.2_f64.to_bits()), (0.1 + 0.2_f64).to_bits());
/// ```
#[inline(never)]
pub fn add(a: u64, b: u64) -> u64 {
    let (a, b) = if a << 1 < b << 1 { (b, a) } else { (a, b) };
    let (size_a, sign) = (a & !SIGN, a & SIGN);
    let apart = a ^ b >= SIGN;
    if size_a >= INFINITE {
        let none = size_a > INFINITE || (b & !SIGN == INFINITE && apart);
        return if none { a | NO_NUMBER } else { a };
    }
    let ((mut exponent, large), (exponent_b, small)) = (parts(a), parts(b));
    let (large, small) = (large << BELOW, shifted(small << BELOW, exponent - exponent_b));
    let mut sum = if apart { large - small } else { large + small };
    if sum == 0 && apart {
        return 0;
    }
    if sum >> 63 != 0 {
        sum = shifted(sum, 1);
        exponent += 1;
    } else {
        let up = (sum.leading_zeros() - 1).min(exponent - 1);
        sum <<= up;
        exponent -= up;
    }
    finished((sign >> 32) as u32, exponent as i32, sum)
}

/// a b.
///
/// ```
/// use rundown::onboard::doubles::multiply;
///
/// assert_eq!(multiply(0.1_f64.to_bits(), 0.2_f64.to_bits()), (0.1 * 0.2_f64).to_bits());
/// ```
#[inline(never)]
pub fn multiply(a: u64, b: u64) -> u64 {
    let (size_a, size_b, sign) = (a & !SIGN, b & !SIGN, (a ^ b) & SIGN);
    let (large, small) = if size_a < size_b { (size_b, size_a) } else { (size_a, size_b) };
    if large >= INFINITE {
        let none = large > INFINITE || small == 0;
        return if none { large | NO_NUMBER } else { sign | INFINITE };
    }
    if small == 0 {
        return sign;
    }
    let ((exponent_a, a), (exponent_b, b)) = (with_first(large), with_first(small));
    // 106 bits or 105, of which the upper ones count, and of the others whether there are any.
    let product = u128::from(a << 11) * u128::from(b << 11);
    let upper = (product >> 64) as u64 | u64::from(product as u64 != 0);
    let more = upper >> 63;
    finished((sign >> 32) as u32, exponent_a + exponent_b - BIAS + more as i32, shifted(upper, more as u32))
}

/// a / b.
///
/// ```
/// use rundown::onboard::doubles::divide;
///
/// assert_eq!(divide(0.1_f64.to_bits(), 0.3_f64.to_bits()), (0.1 / 0.3_f64).to_bits());
/// ```
#[inline(never)]
pub fn divide(a: u64, b: u64) -> u64 {
    let (size_a, size_b, sign) = (a & !SIGN, b & !SIGN, (a ^ b) & SIGN);
    let largest = size_a.max(size_b);
    if largest > INFINITE || (size_a == size_b && (size_a == 0 || size_a == INFINITE)) {
        return largest | NO_NUMBER;
    }
    if size_a == 0 || size_b == INFINITE {
        return sign;
    }
    if size_a == INFINITE || size_b == 0 {
        return sign | INFINITE;
    }
    let ((exponent_a, mut rest), (exponent_b, divisor)) = (with_first(size_a), with_first(size_b));
    let less = rest < divisor;
    // By long division, 11 bits at a time, from a quotient between a half and 1: 55 bits. A divisor of 21 bits gives a
    // digit that is one too many at most.
    if !less {
        rest -= divisor;
    }
    let mut quotient = u64::from(!less);
    for _ in 0..5 {
        rest <<= 11;
        // A divisor has its first bit.
        let digit = ((rest >> 32) as u32).checked_div((divisor >> 32) as u32);
        let mut digit = u64::from(digit.unwrap_or(0));
        rest = rest.wrapping_sub(digit.wrapping_mul(divisor));
        if rest >= SIGN {
            rest = rest.wrapping_add(divisor);
            digit -= 1;
        }
        quotient = quotient << 11 | digit;
    }
    // 56 bits where the first digit was 1, else 55.
    let below = u64::from(rest != 0);
    let mantissa = if less { quotient << 8 } else { quotient << 7 } | below;
    finished((sign >> 32) as u32, exponent_a - exponent_b + BIAS - i32::from(less), mantissa)
}

/// The mantissa with its first bit, and its exponent, which may be below the least one; not of 0.
fn with_first(size: u64) -> (i32, u64) {
    let (exponent, mantissa) = parts(size);
    let up = mantissa.leading_zeros() - (63 - STORED);
    (exponent as i32 - up as i32, mantissa << up)
}

/// A whole number, of this sign: the first bit of `sign`.
///
/// ```
/// use rundown::onboard::doubles::from_count;
///
/// assert_eq!(from_count(1 << 31, 3), (-3.0_f64).to_bits());
/// ```
#[inline(never)]
pub fn from_count(sign: u32, count: u64) -> u64 {
    if count == 0 {
        return 0;
    }
    let up = count.leading_zeros();
    finished(sign & 1 << 31, BIAS + 63 - up as i32, shifted(count << up, 1))
}

/// A single number as a double: the same number.
///
/// ```
/// use rundown::onboard::doubles::from_single;
///
/// assert_eq!(from_single(0.1_f32.to_bits()), f64::from(0.1_f32).to_bits());
/// ```
pub fn from_single(a: u32) -> u64 {
    let (sign, size) = (u64::from(a & 1 << 31) << 32, a & !(1 << 31));
    if size == 0 {
        return sign;
    }
    let (exponent, mantissa) = if size >> 23 == 0 {
        // Too small for a first bit as a single number.
        let up = size.leading_zeros() - 8;
        (1_u32.wrapping_sub(up), size << up & 0x7F_FFFF)
    } else if size >> 23 == 0xFF {
        (BEYOND - 896, size & 0x7F_FFFF)
    } else {
        (size >> 23, size & 0x7F_FFFF)
    };
    sign | u64::from(exponent.wrapping_add(896)) << STORED | u64::from(mantissa) << 29
}

/// As a single number: the nearest one, the even one of two.
///
/// ```
/// use rundown::onboard::doubles::to_single;
///
/// assert_eq!(to_single(0.1_f64.to_bits()), 0.1_f32.to_bits());
/// ```
pub fn to_single(a: u64) -> u32 {
    let (sign, size) = ((a >> 32) as u32 & 1 << 31, a & !SIGN);
    if size > INFINITE {
        return sign | 0x7FC0_0000 | (size >> 29) as u32 & 0x3F_FFFF;
    }
    let exponent = (size >> STORED) as i32 - 896;
    if exponent >= 0xFF {
        return sign | 0x7F80_0000;
    }
    // What has no first bit as a double is far below the least single number.
    let mantissa = size & (FIRST - 1) | FIRST;
    let (exponent, mantissa) =
        if exponent < 1 { (1, shifted(mantissa, (1 - exponent) as u32)) } else { (exponent, mantissa) };
    let mantissa = (mantissa + ((1 << 28) - 1) + (mantissa >> 29 & 1)) >> 29;
    sign | ((((exponent - 1) as u32) << 23) + mantissa as u32)
}

/// Which of two is less; none where one is no number.
///
/// ```
/// use core::cmp::Ordering;
/// use rundown::onboard::doubles::compare;
///
/// assert_eq!(compare(0.1_f64.to_bits(), 0.3_f64.to_bits()), Some(Ordering::Less));
/// ```
pub fn compare(a: u64, b: u64) -> Option<Ordering> {
    let number = |bits: u64| {
        let size = (bits & !SIGN) as i64;
        (size <= INFINITE as i64).then_some(if bits & SIGN == 0 { size } else { -size })
    };
    Some(number(a)?.cmp(&number(b)?))
}

/// Pairs of bits without order, the same each time: any, and such that cancel each other, end in halves, or give what
/// is too small for a first bit. For tests on the host and on a board.
pub fn pairs(count: u32) -> impl Iterator<Item = [u64; 2]> {
    let exponent = INFINITE;
    let with_few = |bits: u64| bits & !(FIRST - 1) | bits << 40 & (FIRST - 1);
    // A half, and something far below it.
    let at_both_ends = |bits: u64| bits & 0xFFFC_0000_0000_0003;
    let near_one = |bits: u64| bits & !(0x3 << 61) | 0x3F << 56;
    let mut before = 1.0_f64.to_bits();
    let mut bits = 0x9E37_79B9_7F4A_7C15_u64;
    (0..count).map(move |turn| {
        let a = core::mem::replace(&mut before, bits);
        // Marsaglia's xorshift.
        bits ^= bits << 13;
        bits ^= bits >> 7;
        bits ^= bits << 17;
        let b = bits;
        let near = b & !exponent | a & exponent;
        let steps = (b >> 20 & 0x3F) << STORED;
        match turn % 10 {
            0 => [a, b],
            1 => [a, near],
            2 => [a, near.wrapping_add(steps)],
            3 => [near.wrapping_sub(steps), a],
            4 => [near_one(with_few(a)), near_one(with_few(b))],
            5 => [near_one(a), near_one(b)],
            6 => [at_both_ends(near_one(a)), at_both_ends(near_one(b))],
            7 => [a, at_both_ends(near.wrapping_sub(steps))],
            8 => [a & !exponent, b & (SIGN | ((FIRST << 6) - 1))],
            _ => [a & !(0x600 << STORED), b & !(0x400 << STORED)],
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers at all edges, of both signs.
    fn edges() -> impl Iterator<Item = u64> + Clone {
        let sizes = [0, 1, 2, 3, FIRST / 2, FIRST - 2, FIRST - 1, FIRST, FIRST + 1, INFINITE - 1, INFINITE, NO_NUMBER];
        let near_one = [0, 1, 2, FIRST - 1, FIRST / 2, FIRST / 2 + 1].map(|more| 1.0_f64.to_bits() + more);
        let exponents = (0..BEYOND).step_by(13).map(|exponent| u64::from(exponent) << STORED | 0x8_0000_0000_0001);
        let all = sizes.into_iter().chain(near_one).chain(exponents);
        all.flat_map(|bits| [bits, bits | SIGN])
    }

    fn check(a: u64, b: u64) {
        let (x, y) = (f64::from_bits(a), f64::from_bits(b));
        let all = [(add(a, b), x + y, "+"), (multiply(a, b), x * y, "x"), (divide(a, b), x / y, "/")];
        for (found, expected, name) in all {
            let found = f64::from_bits(found);
            let same = found.to_bits() == expected.to_bits() || (found.is_nan() && expected.is_nan());
            assert!(same, "{a:#x} {name} {b:#x}: {x:e} {name} {y:e} = {expected:e}, found {found:e}");
        }
    }

    #[test]
    fn edges_are_as_the_processor_has_them() {
        for a in edges() {
            for b in edges() {
                check(a, b);
            }
        }
    }

    #[test]
    fn any_bits_are_as_the_processor_has_them() {
        pairs(2_000_000).for_each(|[a, b]| check(a, b));
    }

    #[test]
    fn comparisons_are_as_the_processor_has_them() {
        let others = pairs(500_000).map(|[a, b]| (a, b)).chain(pairs(1000).map(|[a, _]| (a, a)));
        for (a, b) in edges().flat_map(|a| edges().map(move |b| (a, b))).chain(others) {
            let (x, y) = (f64::from_bits(a), f64::from_bits(b));
            assert_eq!(compare(a, b), x.partial_cmp(&y), "{x:e} {y:e}");
        }
    }

    #[test]
    fn conversions_are_as_the_processor_has_them() {
        let near_singles = pairs(500_000).flat_map(|[a, b]| [a, b & !(0x700 << STORED) | 0x380 << STORED]);
        for bits in edges().chain(near_singles) {
            let (number, found) = (f64::from_bits(bits), f32::from_bits(to_single(bits)));
            assert!(found.to_bits() == (number as f32).to_bits() || (found.is_nan() && number.is_nan()), "{number:e}");
        }
        let singles =
            (0..=u32::MAX).step_by(4099).chain([1, 2, 0x7F_FFFF, 0x80_0000, 0x7F7F_FFFF, 0x7F80_0000, 1 << 31]);
        for bits in singles {
            let (number, found) = (f32::from_bits(bits), f64::from_bits(from_single(bits)));
            assert!(
                found.to_bits() == f64::from(number).to_bits() || (found.is_nan() && number.is_nan()),
                "{number:e}"
            );
        }
        for count in [0, 1, 3, u64::from(u32::MAX), FIRST * 2 + 1, FIRST * 2 + 3, u64::MAX, u64::MAX - 1024] {
            assert_eq!(from_count(0, count), (count as f64).to_bits());
            assert_eq!(from_count(!0, count) & !SIGN, (count as f64).to_bits());
        }
    }
}
