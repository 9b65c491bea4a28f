//! Effects and parameters as they are read: names, places, units, digits, intervals.

use crate::named::Named;
use rundown::model::effects::EffectKind;
use rundown_check::figure::HALF_95;
use rundown_pages::numbers::number;

pub fn plain(name: &str) -> String {
    name.replace('_', " ")
}

/// `curve_resistance, gradient_error (4 times)`, `nothing`.
pub fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let mut names: Vec<&str> = names.collect();
    names.sort_unstable();
    let each = names.chunk_by(|a, b| a == b).map(|same| match same.len() {
        1 => same[0].to_owned(),
        count => format!("{} ({count} times)", same[0]),
    });
    let each: Vec<String> = each.collect();
    if each.is_empty() { "nothing".to_owned() } else { each.join(", ") }
}

/// `km 18.2 to 21.0`.
pub fn place(from_m: f64, to_m: f64) -> String {
    let km = |m: f64| number(m / 1000.0, 1);
    format!("km {} to {}", km(from_m), km(to_m))
}

pub fn side(more: bool) -> &'static str {
    if more { "more" } else { "less" }
}

/// Unit of a parameter, as the catalogue of effects has it; of a section m.
pub fn unit(kind: EffectKind, parameter: &str) -> &'static str {
    if matches!(parameter, "from_m" | "to_m") {
        return "m";
    }
    kind.parameters().iter().find(|one| one.name == parameter).map_or("", |one| one.unit)
}

/// With three digits, as a power of ten where the number is small.
pub fn short(value: f64) -> String {
    digits(value, value.abs() * 0.01, value)
}

/// With the digits that an uncertainty is worth, and the power of ten of a size, so that numbers beside each other have
/// the same.
fn digits(value: f64, uncertainty: f64, size: f64) -> String {
    let size = size.abs().max(uncertainty);
    if !size.is_finite() || size == 0.0 {
        return number(value, 0);
    }
    let last = uncertainty.max(1e-4 * size).log10().floor() as i32;
    if size < 1e-3 {
        let power = size.log10().floor() as i32;
        let mantissa = number(value / 10_f64.powi(power), (power - last).clamp(0, 4) as usize);
        return format!("{mantissa}\u{b7}10{}", superscript(power));
    }
    number(value, (-last).clamp(0, 6) as usize)
}

fn superscript(power: i32) -> String {
    let sign = if power < 0 { "\u{207b}" } else { "" };
    let figures = power.abs().to_string();
    let raised = figures.bytes().map(|b| match b {
        b'1' => '\u{b9}',
        b'2' => '\u{b2}',
        b'3' => '\u{b3}',
        other => char::from_u32(0x2070 + u32::from(other - b'0')).unwrap_or('?'),
    });
    format!("{sign}{}", raised.collect::<String>())
}

pub fn interval(named: &Named, parameter: &str) -> Option<(f64, f64)> {
    let mut all = named.intervals.iter();
    let found = all.find(|(name, ..)| *name == parameter)?;
    Some((found.1, found.2))
}

/// Value, and both ends of its interval, with the same digits.
pub fn with_ends(value: f64, interval: Option<(f64, f64)>) -> (String, Option<[String; 2]>) {
    match interval {
        Some((low, high)) if high > low => {
            let sd = 0.5 * (high - low) / HALF_95;
            // An end beside zero is not written as zero.
            let nearest = low.abs().min(high.abs());
            let text = |v| digits(v, nearest.clamp(0.1 * sd, sd), value);
            (text(value), Some([text(low), text(high)]))
        }
        _ => (short(value), None),
    }
}

/// Confidence in a name; more than two digits of it mean nothing.
pub fn confidence(named: &Named) -> String {
    if named.confidence > 0.99 {
        return "above 0.99".to_owned();
    }
    number(named.confidence, 2)
}

/// The section in which an effect acts.
pub fn section(named: &Named) -> String {
    named.effect.section_m().map_or_else(String::new, |(from_m, to_m)| place(from_m, to_m))
}

/// A parameter in its own unit: see [`scaled`].
pub fn with_unit(named: &Named, parameter: &str) -> String {
    scaled(named, parameter, 1.0, unit(named.effect.kind(), parameter))
}

/// `4.9 m/s (95 % interval 4.6 to 5.2)`; factor: from the parameter's unit and sign to those that are written.
pub fn scaled(named: &Named, parameter: &str, factor: f64, unit: &str) -> String {
    let ends = interval(named, parameter).map(|(low, high)| {
        let (one, other) = (factor * low, factor * high);
        (one.min(other), one.max(other))
    });
    let (value, ends) = with_ends(factor * named.value(parameter), ends);
    match ends {
        Some([low, high]) => format!("{value} {unit} (95\u{a0}% interval {low} to {high})").replace("  ", " "),
        None => format!("{value} {unit}").trim_end().to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_stands_once_with_its_count() {
        assert_eq!(listed([].into_iter()), "nothing");
        let names = ["gradient_error", "mass_error", "gradient_error"];
        assert_eq!(listed(names.into_iter()), "gradient_error (2 times), mass_error");
    }

    #[test]
    fn digits_follow_the_uncertainty() {
        assert_eq!(digits(4.9312, 0.13, 4.9312), "4.9");
        let small = |v| digits(v, 2e-7, 1.0834e-5);
        assert_eq!(small(1.0834e-5), "1.08\u{b7}10\u{207b}\u{2075}");
        assert_eq!(small(9.834e-6), "0.98\u{b7}10\u{207b}\u{2075}");
        assert_eq!(digits(-18_234.4, 40.0, 1e4), "\u{2212}18234");
        assert_eq!(short(0.0), "0");
        assert_eq!(short(0.6537), "0.654");
        let (value, ends) = with_ends(2.04, Some((1.84, 2.24)));
        assert_eq!(value, "2.0");
        assert_eq!(ends.unwrap(), ["1.8", "2.2"]);
        let (value, ends) = with_ends(0.0025, Some((0.0003, 0.0047)));
        assert_eq!((value.as_str(), ends.unwrap()), ("0.0025", ["0.0003", "0.0047"].map(String::from)));
    }
}
