//! A speed that is late by whole rows, compared with the locations that it belongs to.
//!
//! In: rows, and what they say as they are. Out: the same with the speeds moved by the rows that they are late, and by
//! how much; as they are where that fits no better.
//!
//! The ways between the rows are bent as the speeds of the wrong rows say, which no skew to first order makes up for:
//! with truncated speeds 10 s late in rows of 10 s twice as many runs were needed to see the truncation, and trams in
//! rows of 1 s whose speed was 3 s late got an offset of 0.9 km/h.

use crate::agreement::compared::{Compared, Differences, Row, SLOWEST_MPS};

/// A skew that is known no better, in standard deviations, moves nothing.
const SURE: f64 = 6.0;
/// Two rows follow each other where the time between them is off by less than this share of the usual one.
const REGULAR: f64 = 0.25;

/// By how much the speeds were moved, s, and what they say then. None: as they are they belong to other rows, and moved
/// they are bent all the way.
pub(crate) fn moved(parts: &[Vec<Row>], step_s: f64, compared: Compared) -> Option<(Compared, f64)> {
    let skew = compared.skew_s();
    let late = (skew.value / step_s).round();
    if late == 0.0 || skew.away_from(0.0) < SURE {
        return Some((compared, 0.0));
    }
    let pieces: Vec<Vec<[Row; 2]>> = parts.iter().flat_map(|part| beside(part, late as isize, step_s)).collect();
    let differences = Differences::of(&one_of(&pieces, 1));
    // Of a log whose rows are not regular hardly any are left.
    if 2 * differences.y.len() < compared.differences.y.len() {
        return Some((compared, 0.0));
    }
    let found = Compared::fitted(differences)?;
    let is_better = fits_better(&pieces)? && found.skew_s().value.abs() < skew.value.abs();
    Some(if is_better { (found, late * step_s) } else { (compared, 0.0) })
}

/// The same rows with the speeds moved by so much, s.
pub(crate) fn with_moved(parts: Vec<Vec<Row>>, step_s: f64, moved_s: f64) -> Vec<Vec<Row>> {
    if moved_s == 0.0 {
        return parts;
    }
    let late = (moved_s / step_s).round() as isize;
    one_of(&parts.iter().flat_map(|part| beside(part, late, step_s)).collect::<Vec<_>>(), 1)
}

/// Whether the later speeds fit the locations better: in the same rows, those that run by both. A filter of first order
/// is late, too, but no delay: as it is its skew explains it in full, and moved it made wheels of 0.98 of trams.
fn fits_better(pieces: &[Vec<[Row; 2]>]) -> Option<bool> {
    let runs = |rows: &[Row; 2]| rows.iter().all(|row| row.speed_mps >= SLOWEST_MPS);
    let stands = |rows: &[Row; 2]| rows.map(|row| Row { speed_mps: 0.0, ..row });
    let both = |piece: &Vec<[Row; 2]>| piece.iter().map(|rows| if runs(rows) { *rows } else { stands(rows) }).collect();
    let both: Vec<Vec<[Row; 2]>> = pieces.iter().map(both).collect();
    let likely = |which| Some(Compared::fitted(Differences::of(&one_of(&both, which)))?.fit.log_likelihood);
    Some(likely(1)? > likely(0)?)
}

/// With the speeds as they are (0) or the later ones (1).
fn one_of(pieces: &[Vec<[Row; 2]>], which: usize) -> Vec<Vec<Row>> {
    pieces.iter().map(|piece| piece.iter().map(|rows| rows[which]).collect()).collect()
}

/// Rows, and the same with the speed of so many rows later, cut where rows are missing.
fn beside(part: &[Row], late: isize, step_s: f64) -> Vec<Vec<[Row; 2]>> {
    let (mut found, mut piece): (Vec<Vec<[Row; 2]>>, Vec<[Row; 2]>) = (Vec::new(), Vec::new());
    for (i, row) in part.iter().enumerate() {
        let of_speed = i.checked_add_signed(late).and_then(|at| part.get(at));
        let off_s = |of: &Row| (of.time_s - row.time_s - late as f64 * step_s).abs();
        match of_speed.filter(|of| off_s(of) < REGULAR * step_s) {
            Some(of) => piece.push([*row, Row { speed_mps: of.speed_mps, ..*row }]),
            None => found.push(std::mem::take(&mut piece)),
        }
    }
    found.push(piece);
    found.retain(|piece| !piece.is_empty());
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_get_the_speed_of_the_rows_they_are_late_by_and_none_over_a_gap() {
        let row = |i: u32| {
            let time_s = 10.0 * f64::from(i) + if i < 5 { 0.0 } else { 30.0 };
            Row { time_s, location_m: f64::from(i), speed_mps: 100.0 + f64::from(i) }
        };
        let part: Vec<Row> = (0..9).map(row).collect();
        let read = |late| -> Vec<Vec<(f64, f64)>> {
            let pieces = one_of(&beside(&part, late, 10.0), 1);
            pieces
                .iter()
                .map(|piece| piece.iter().map(|row| (row.location_m, row.speed_mps - 100.0)).collect())
                .collect()
        };
        assert_eq!(
            read(1),
            [vec![(0.0, 1.0), (1.0, 2.0), (2.0, 3.0), (3.0, 4.0)], vec![(5.0, 6.0), (6.0, 7.0), (7.0, 8.0)]]
        );
        assert_eq!(read(-2)[0], [(2.0, 0.0), (3.0, 1.0), (4.0, 2.0)]);
    }
}
