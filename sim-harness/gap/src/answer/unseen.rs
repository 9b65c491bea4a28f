//! Kilometres of the line of which no interval tells anything: an effect there is not found, however large.

use crate::data::rows::Row;
use crate::wording::place;

/// Side of the places that are looked at, m: a train covers half of it in one interval.
const CELL_M: f64 = 1000.0;
/// Sections that are named; the others are counted.
const NAMED: usize = 5;

/// Of a line of this length; `None` where every kilometre was seen.
pub(super) fn unseen(rows: &[Row], length_m: f64) -> Option<String> {
    let cells = (length_m / CELL_M).ceil().max(0.0) as usize;
    let mut seen = vec![false; cells];
    for point in rows.iter().flat_map(|row| &row.interval.path) {
        if let Some(cell) = seen.get_mut((point.location_m / CELL_M).max(0.0) as usize) {
            *cell = true;
        }
    }
    let kilometres = seen.iter().filter(|seen| !**seen).count();
    let sections: Vec<String> = sections(&seen).map(|(from, to)| place(from, to.min(length_m))).collect();
    let named = sections.iter().take(NAMED).map(String::as_str).collect::<Vec<_>>().join(", ");
    let more = match sections.len().saturating_sub(NAMED) {
        0 => String::new(),
        1 => ", and 1 more section".to_owned(),
        more => format!(", and {more} more sections"),
    };
    (kilometres > 0).then(|| {
        format!("{kilometres} of {cells} km of the line were not seen ({named}{more}): what acts there is not known.")
    })
}

/// From where to where cells adjoin that were not seen, m.
fn sections(seen: &[bool]) -> impl Iterator<Item = (f64, f64)> {
    let mut at = 0;
    seen.chunk_by(|a, b| a == b).filter_map(move |chunk| {
        let from = at;
        at += chunk.len();
        (!chunk[0]).then_some((from as f64 * CELL_M, at as f64 * CELL_M))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kilometres_without_an_interval_are_named_as_sections() {
        let gaps: Vec<_> = sections(&[true, false, false, true, false]).collect();
        assert_eq!(
            unseen(&[], 2500.0).unwrap(),
            "3 of 3 km of the line were not seen (km 0.0 to 2.5): what acts there is not known."
        );
        assert_eq!(gaps, [(1e3, 3e3), (4e3, 5e3)]);
    }
}
