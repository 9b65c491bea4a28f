//! Ranges of what is described or set, and the refusal of a value outside.

use crate::Real;
use rundown_wire::errors;

/// No line is longer, m.
pub(crate) const FAR_M: Real = 1e7;

/// Name of a field, for messages.
#[cfg(not(target_os = "none"))]
pub type FieldName = &'static str;
/// Name of a field. A board writes no messages, and has no names: they would take 3 kB of its flash.
#[cfg(target_os = "none")]
pub use on_board::FieldName;

/// The name where there are names.
#[cfg(not(target_os = "none"))]
pub(crate) const fn field_name(name: &'static str) -> FieldName {
    name
}

#[cfg(target_os = "none")]
pub(crate) const fn field_name(_name: &'static str) -> FieldName {
    FieldName
}

#[cfg(target_os = "none")]
mod on_board {
    /// Nothing stands for a name.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct FieldName;

    impl core::fmt::Display for FieldName {
        fn fmt(&self, _: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
            Ok(())
        }
    }
}

errors! {
    /// A value lies outside its range. What was in force before stays in force.
    pub struct OutOfRange { field: FieldName, least: Real, most: Real, found: Real } =>
        "{field}: expected {least} to {most}, found {found}";
}

/// Name, least and most of a field. A board has a hundred of them, so its flash holds a bound as a decimal number of
/// few digits: 6 bytes for two of them in place of 16.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Range {
    field: FieldName,
    digits: [i16; 2],
    exponents: [i8; 2],
}

impl Range {
    /// For constants: bounds of more than four digits, which nobody writes, do not compile.
    pub(crate) const fn new(field: FieldName, least: Real, most: Real) -> Self {
        let (least, most) = (Decimal::of(least), Decimal::of(most));
        Self { field, digits: [least.digits, most.digits], exponents: [least.exponent, most.exponent] }
    }

    /// `found` lies within; NaN does not.
    #[inline(never)]
    pub(crate) fn check(&self, found: Real) -> Result<(), OutOfRange> {
        // Without an index, which the board would check.
        let Self { field, digits: [least, most], exponents: [by_least, by_most] } = *self;
        let least = Decimal { digits: least, exponent: by_least }.value();
        let most = Decimal { digits: most, exponent: by_most }.value();
        between(field, found, least, most)
    }
}

/// `digits`·10^`exponent`.
struct Decimal {
    digits: i16,
    exponent: i8,
}

impl Decimal {
    /// More powers of ten than this are not exact.
    const MOST_EXPONENT: i8 = 22;

    /// The number that is this one, to the last bit.
    const fn of(value: Real) -> Self {
        let mut exponent = -Self::MOST_EXPONENT;
        while exponent <= Self::MOST_EXPONENT {
            let digits = value / Self { digits: 1, exponent }.value();
            let nearest = (digits + if digits < 0.0 { -0.5 } else { 0.5 }) as i16;
            let decimal = Self { digits: nearest, exponent };
            if decimal.value() == value {
                return decimal;
            }
            exponent += 1;
        }
        panic!("a bound has at most four digits")
    }

    /// Digits and powers of ten up to 10^22 are exact, so this is rounded once, as a literal is.
    #[inline(never)]
    const fn value(&self) -> Real {
        let (mut power, mut left) = (1.0, self.exponent.unsigned_abs());
        while left > 0 {
            power *= 10.0;
            left -= 1;
        }
        let digits = self.digits as Real;
        if self.exponent < 0 { digits / power } else { digits * power }
    }
}

/// `found` lies within `least..=most`; NaN does not.
// Called from many places: inlined it takes more of the board's flash.
#[inline(never)]
pub(crate) fn between(field: FieldName, found: Real, least: Real, most: Real) -> Result<(), OutOfRange> {
    if (least..=most).contains(&found) { Ok(()) } else { Err(OutOfRange { field, least, most, found }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bound_is_the_literal_to_its_last_bit() {
        for bound in [0.0, 1.0, -1.0, 0.1, -0.7, 1.25, 139.0, 36e3, 1e-15, 1e12, -1e6, 0.05, 1e-6, 32.77e3, 1e22, 1e-22]
        {
            let range = Range::new("field", bound, 1e22);
            let (below, above) = (bound.next_down(), bound.next_up());
            assert_eq!(range.check(below), Err(OutOfRange { field: "field", least: bound, most: 1e22, found: below }));
            assert!(range.check(bound).is_ok(), "{bound}");
            let range = Range::new("field", -1e22, bound);
            assert_eq!(range.check(above), Err(OutOfRange { field: "field", least: -1e22, most: bound, found: above }));
            assert!(range.check(bound).is_ok(), "{bound}");
        }
        assert!(Range::new("field", -1.0, 1.0).check(Real::NAN).is_err());
    }
}
