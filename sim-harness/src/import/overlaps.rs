//! Runs of one train that begin before the one before them ends: rows that stand in no order of time are cut at each of
//! their gaps, and make many runs of a few rows.

use super::cut::Stretch;
use std::collections::HashMap;

pub const OVERLAPS: &str = "runs that begin before the one before them ends (rows in no order of time: sort the file by it; \
                            or a clock that was set back)";

/// When the runs of a file end so far, by unit and run.
#[derive(Debug, Default)]
pub struct Overlaps {
    ends_s: HashMap<(String, String), f64>,
}

impl Overlaps {
    /// The next run. Out: whether it begins too early. Clocks without a date may begin anywhere, as a file and a sheet.
    pub fn is_early(&mut self, piece: &Stretch) -> bool {
        let (Some(first), Some(last)) = (piece.rows.first(), piece.rows.last()) else { return false };
        let end_s = self.ends_s.entry((piece.unit.clone(), piece.run.clone())).or_insert(f64::NEG_INFINITY);
        let is_early = piece.is_dated && !piece.is_head && first.time_s < *end_s;
        *end_s = if piece.is_head { last.time_s } else { end_s.max(last.time_s) };
        is_early
    }
}
