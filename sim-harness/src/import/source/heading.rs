//! Which row of a table is its header, and whether the one below it has units.

use super::signals;
use crate::import::meaning::Meaning;
use crate::import::units;

/// How many names of a row are known; those of the mapping, `named`, weigh more.
pub fn known_in(row: &[String], named: &[String]) -> usize {
    let names: Vec<String> = row.iter().map(|text| units::split(text).0).collect();
    let by_mapping = row.iter().filter(|text| named.iter().any(|name| name.trim() == text.trim())).count();
    Meaning::of_names(&names).len() + signals::known_in(row, named) + 4 * by_mapping
}

/// The row that looks like a header: its index, and how many of its names are known. `named` are those of the mapping.
pub fn header_among(rows: &[Vec<String>], named: &[String]) -> Option<(usize, usize)> {
    let best = rows
        .iter()
        .enumerate()
        .map(|(index, row)| (known_in(row, named), index))
        .max_by_key(|(known, index)| (*known, usize::MAX - index));
    if let Some((known, index)) = best
        && known >= 2
    {
        return Some((index, known));
    }
    // Words above numbers.
    let digit = |text: &String| text.trim().starts_with(|c: char| c.is_ascii_digit() || c == '-');
    let numbers = |row: &Vec<String>| row.len() > 1 && 2 * row.iter().filter(|text| digit(text)).count() >= row.len();
    let words = |row: &Vec<String>| row.len() > 1 && !row.iter().any(digit);
    rows.windows(2)
        .position(|pair| words(&pair[0]) && numbers(&pair[1]) && pair[0].len() == pair[1].len())
        .map(|index| (index, 0))
}

/// A row below the header that holds units and no values: `[s];[km];[km/h]`.
pub fn units_below(row: &[String]) -> Option<Vec<Option<String>>> {
    let unit = |text: &String| {
        let text = text.trim().trim_matches(['[', ']', '(', ')', '-']).trim().to_owned();
        (!text.is_empty()).then_some(text)
    };
    let found: Vec<Option<String>> = row.iter().map(unit).collect();
    let known = |text: &String| Meaning::ALL.into_iter().any(|meaning| units::by_name(meaning, text).is_some());
    let count = found.iter().flatten().filter(|text| known(text)).count();
    let digits = row.iter().any(|text| text.trim().starts_with(|c: char| c.is_ascii_digit()));
    (count >= 2 && !digits).then_some(found)
}
