//! Runs of one train that begin before the one before them ends: rows that stand in no order of time are cut at each of
//! their gaps, and make many runs of a few rows.

use super::stretch::Stretch;

pub const OVERLAPS: &str = "runs that begin before the one before them ends (rows in no order of time: sort the file by it; \
                            or a clock that was set back)";

/// When the runs of one unit and run of a file end so far.
#[derive(Debug, Default)]
pub struct Ends {
    last_s: Option<f64>,
}

impl Ends {
    /// The next run. Out: whether it begins too early. Clocks without a date may begin anywhere, as a file and a sheet.
    pub fn is_early(&mut self, piece: &Stretch) -> bool {
        let (Some(first), Some(last)) = (piece.rows.first(), piece.rows.last()) else { return false };
        let before_s = self.last_s.filter(|_| !piece.is_head);
        self.last_s = Some(before_s.map_or(last.time_s, |end_s| end_s.max(last.time_s)));
        piece.is_dated && before_s.is_some_and(|end_s| first.time_s < end_s)
    }
}
