//! Numbers as people write them: decimal point or comma, groups of thousands, a unit behind.

/// A number of a text, and what stands behind it. `decimal` is the file's.
pub fn parse(text: &str, decimal: char) -> Option<(f64, &str)> {
    let text = text.trim();
    let end = text.find(|c: char| !(c.is_ascii_digit() || ".,'+-eE\u{a0}\u{202f} ".contains(c))).unwrap_or(text.len());
    let (number, rest) = text.split_at(end);
    // The e of a unit is none of an exponent.
    let trimmed = number.trim_end_matches([' ', 'e', 'E', '\u{a0}', '\u{202f}']);
    let rest = if trimmed.len() < number.trim_end().len() { &text[trimmed.len()..] } else { rest };
    let value = plain(trimmed, decimal)?;
    value.is_finite().then_some((value, rest.trim()))
}

fn plain(number: &str, decimal: char) -> Option<f64> {
    if let Ok(value) = number.parse::<f64>()
        && !(decimal == ',' && is_grouped(number, '.'))
    {
        return Some(value);
    }
    let other = if decimal == ',' { '.' } else { ',' };
    let (whole, fraction) = number.split_once(decimal).map_or((number, None), |(whole, rest)| (whole, Some(rest)));
    let groups = [other, '\'', ' ', '\u{a0}', '\u{202f}'];
    let separator = groups.into_iter().find(|group| whole.contains(*group));
    let whole = match separator {
        Some(separator) if is_grouped(whole, separator) => whole.replace(separator, ""),
        Some(_) => return None,
        None => whole.to_owned(),
    };
    fraction.map_or_else(|| whole.clone(), |fraction| format!("{whole}.{fraction}")).parse().ok()
}

/// Digits in groups of three: `1.234.567`.
fn is_grouped(number: &str, separator: char) -> bool {
    let mut groups = number.trim_start_matches(['-', '+']).split(separator);
    let digits = |group: &str| !group.is_empty() && group.bytes().all(|byte| byte.is_ascii_digit());
    let first = groups.next().is_some_and(|first| digits(first) && first.len() <= 3 && first != "0");
    let mut rest = groups.peekable();
    first && rest.peek().is_some() && rest.all(|group| digits(group) && group.len() == 3)
}

/// The decimal sign of some fields; a point unless more of them hold a comma.
pub fn decimal_of<'a>(fields: impl Iterator<Item = &'a str>) -> char {
    let with = |text: &str, sign: char| {
        let text = text.trim().trim_start_matches(['-', '+']);
        // A unit may stand behind the number.
        let end = text.find(|c: char| !(c.is_ascii_digit() || c == ',' || c == '.')).unwrap_or(text.len());
        let is_number = text[end..].chars().all(|c| !c.is_ascii_digit());
        let parts: Vec<&str> = text[..end].split(sign).collect();
        let digits = |part: &&str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
        is_number && parts.len() == 2 && parts.iter().all(digits)
    };
    let (mut commas, mut points) = (0, 0);
    for field in fields {
        commas += usize::from(with(field, ','));
        points += usize::from(with(field, '.'));
    }
    if commas > points { ',' } else { '.' }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_decimal_sign_is_that_of_most_numbers() {
        assert_eq!(decimal_of(["1,5", "2,25 km", "51.3", "10:00:00,5"].into_iter()), ',');
        assert_eq!(decimal_of(["1.5", "1,234.5", "31.01.2025"].into_iter()), '.');
    }

    #[test]
    fn numbers_are_read_as_they_are_written() {
        for (text, decimal, value) in [
            ("12.5", '.', 12.5),
            ("12,5", ',', 12.5),
            ("1.234,5", ',', 1234.5),
            ("1.234", ',', 1234.0),
            ("51.0521", ',', 51.0521),
            ("0.125", ',', 0.125),
            ("1,234.5", '.', 1234.5),
            ("1'234.5", '.', 1234.5),
            ("-1 234,5", ',', -1234.5),
            ("1e3", '.', 1000.0),
        ] {
            assert_eq!(parse(text, decimal), Some((value, "")), "{text}");
        }
        assert_eq!(parse("80 km/h", '.'), Some((80.0, "km/h")));
        for text in ["", "-", "12,5,1", "abc", "1.2.3", "NaN", "inf", "1e999"] {
            assert_eq!(parse(text, '.'), None, "{text}");
        }
    }
}
