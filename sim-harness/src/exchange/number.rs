//! Numbers as other tools' files have them.

/// Seven significant digits, without an exponent: several schemas' decimals have none.
pub(super) fn decimal(value: f64) -> String {
    significant(value, 7)
}

/// The same with so many significant digits.
pub(super) fn significant(value: f64, digits: i32) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let digits = digits - 1 - value.abs().log10().floor() as i32;
    let text = format!("{value:.*}", digits.max(0) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_have_no_exponent() {
        assert_eq!(decimal(1e-5), "0.00001");
        assert_eq!(decimal(12_345_678.9), "12345679");
        assert_eq!(decimal(10.0), "10");
        assert_eq!(decimal(1.06), "1.06");
    }
}
