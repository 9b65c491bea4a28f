//! Numbers as people write them: decimal point or comma, groups of thousands, a unit behind.

/// A number of a text, and what stands behind it. `decimal` is the file's.
pub fn parse(text: &str, decimal: char) -> Option<(f64, &str)> {
    let text = text.trim();
    if let Some(kilometres) = chainage(text, decimal) {
        return Some((kilometres, "km"));
    }
    let end = text.find(|c: char| !(c.is_ascii_digit() || ".,'’+-eE\u{a0}\u{202f} ".contains(c))).unwrap_or(text.len());
    let (number, rest) = text.split_at(end);
    // The e of a unit is none of an exponent.
    let trimmed = number.trim_end_matches([' ', 'e', 'E', '\u{a0}', '\u{202f}']);
    let rest = if trimmed.len() < number.trim_end().len() { &text[trimmed.len()..] } else { rest };
    let value = plain(trimmed, decimal)?;
    value.is_finite().then_some((value, rest.trim()))
}

/// Kilometres of a chainage with its metres behind a plus, `12+400.5`, as on plans and posts.
fn chainage(text: &str, decimal: char) -> Option<f64> {
    let (kilometres, metres) = text.split_once('+')?;
    let kilometres: u32 = kilometres.parse().ok()?;
    let (whole, fraction) = metres.split_once(decimal).unwrap_or((metres, "0"));
    let are_digits = [whole, fraction].iter().all(|part| part.bytes().all(|byte| byte.is_ascii_digit()));
    let metres: f64 = format!("{whole}.{fraction}").parse().ok()?;
    (are_digits && whole.len() == 3).then(|| f64::from(kilometres) + 1e-3 * metres)
}

/// An angle with its degrees, minutes and seconds apart, or with the letter of its hemisphere: the value, and whether
/// it is whole, in degrees. None for a plain number. O is east or west, by the language.
pub fn angle(text: &str, decimal: char) -> Option<(f64, bool)> {
    let text = text.trim();
    let hemisphere = |c: &char| "NSEWnsew".contains(*c);
    let (letter, text) = match (text.chars().next().filter(hemisphere), text.chars().next_back().filter(hemisphere)) {
        (Some(letter), None) => (Some(letter), &text[1..]),
        (None, Some(letter)) => (Some(letter), &text[..text.len() - 1]),
        (None, None) => (None, text),
        (Some(_), Some(_)) => return None,
    };
    let text = text.trim().replace(decimal, ".");
    let (sign, text) = text.strip_prefix('-').map_or((1.0, &*text), |rest| (-1.0, rest));
    let sign = match letter {
        Some('S' | 's' | 'W' | 'w') if sign > 0.0 => -1.0,
        Some(_) if sign < 0.0 => return None,
        _ => sign,
    };
    let marks = ['°', 'º', '\'', '′', '’', '"', '″', '”', ' '];
    let parts: Vec<&str> = text.split(marks).filter(|part| !part.is_empty()).collect();
    let is_angle = letter.is_some() || parts.len() > 1 || text.contains(['°', 'º']);
    let mut value = 0.0;
    for (index, part) in parts.iter().enumerate() {
        let is_number = part.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.' && index + 1 == parts.len());
        let number: f64 = part.parse().ok().filter(|_| is_number)?;
        if index > 0 && number >= 60.0 {
            return None;
        }
        value += number / [1.0, 60.0, 3600.0].get(index)?;
    }
    (is_angle && !parts.is_empty()).then_some((sign * value, parts.len() > 1))
}

fn plain(number: &str, decimal: char) -> Option<f64> {
    if let Ok(value) = number.parse::<f64>()
        && !(decimal == ',' && is_grouped(number, '.'))
    {
        return Some(value);
    }
    let other = if decimal == ',' { '.' } else { ',' };
    let (whole, fraction) = number.split_once(decimal).map_or((number, None), |(whole, rest)| (whole, Some(rest)));
    let groups = [other, '\'', '’', ' ', '\u{a0}', '\u{202f}'];
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

/// One in so many numbers with a sign must be surely a decimal.
const LEAST_SURE: usize = 20;

/// The decimal sign of some fields; a point unless more of them hold a comma. What may be a group of thousands decides
/// only where nothing else does.
pub fn decimal_of<'a>(fields: impl Iterator<Item = &'a str>) -> char {
    // None: no number with this sign once. True: surely a decimal; false: may be a group of thousands.
    let with = |text: &str, sign: char| {
        let text = text.trim().trim_start_matches(['-', '+']);
        // A unit may stand behind the number.
        let end = text.find(|c: char| !(c.is_ascii_digit() || c == ',' || c == '.')).unwrap_or(text.len());
        let is_number = text[end..].chars().all(|c| !c.is_ascii_digit());
        let parts: Vec<&str> = text[..end].split(sign).collect();
        let digits = |part: &&str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
        (is_number && parts.len() == 2 && parts.iter().all(digits)).then(|| !is_grouped(&text[..end], sign))
    };
    let [mut sure, mut all] = [[0_usize; 2]; 2];
    for field in fields {
        for (i, sign) in [',', '.'].into_iter().enumerate() {
            if let Some(is_sure) = with(field, sign) {
                sure[i] += usize::from(is_sure);
                all[i] += 1;
            }
        }
    }
    // A stray field decides nothing.
    let are_many = LEAST_SURE * sure[0].max(sure[1]) >= all[0] + all[1];
    let [commas, points] = if sure[0] == sure[1] || !are_many { all } else { sure };
    if commas > points { ',' } else { '.' }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_read_as_they_are_written() {
        for (text, decimal, degrees) in [
            ("50° 06.12' N", '.', 50.102),
            ("S50°6'7,2\"", ',', -50.102),
            ("8 00 14.4 W", '.', -8.004),
            ("-8°0'14.4\"", '.', -8.004),
            ("50.102 N", '.', 50.102),
            ("50.102°", '.', 50.102),
        ] {
            let found = angle(text, decimal).map(|(value, _)| (1e9 * value).round());
            assert_eq!(found, Some(f64::round(1e9 * degrees)), "{text}");
        }
        assert_eq!(angle("5006.12N", '.'), Some((5006.12, false)));
        for text in ["50.102", "", "N", "50°61'", "-50.1 S", "50.5°06'", "N50E", "8°00'O", "50°06'07\"08", "NaN N"]
        {
            assert_eq!(angle(text, '.'), None, "{text}");
        }
    }

    #[test]
    fn the_decimal_sign_is_that_of_most_numbers() {
        assert_eq!(decimal_of(["1,5", "2,25 km", "51.3", "10:00:00,5"].into_iter()), ',');
        assert_eq!(decimal_of(["1.5", "1,234.5", "31.01.2025"].into_iter()), '.');
        // Metres in groups of thousands beside speeds with decimals, and kilometres with three.
        assert_eq!(decimal_of(["12.345", "80,5", "12.369", "81", "12.393", "81,5"].into_iter()), ',');
        assert_eq!(decimal_of(["12,345", "80.5", "12,369", "81", "12,393", "81.5"].into_iter()), '.');
        assert_eq!(decimal_of(["12,345", "80", "12,369", "81"].into_iter()), ',');
        assert_eq!(decimal_of(["12.345", "80", "0,5"].into_iter()), ',');
        let stray = std::iter::repeat_n("12.345", 50).chain(["0,5"]);
        assert_eq!(decimal_of(stray), '.');
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
            ("1’234.5", '.', 1234.5),
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
