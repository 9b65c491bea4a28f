//! Speeds that are signed by the direction of travel.

use super::SeenRows;
use super::ratios::{MOVES, Passing, longest, ratios, usual};
use super::stretches::{ALIKE, FEW_STEPS, LEAST_ALIKE, STEPS, Stretches, pieces};
use super::written::WrittenRow;
use crate::import::columns::Columns;
use crate::import::mapping::{SAY_IT, SourceMapping, line};
use crate::import::meaning::Meaning;

/// Of the readings of a moving train a larger share below zero is no matter of single wrong ones.
const MOST_WRONG: f64 = 0.2;

impl SeenRows {
    /// Speeds below zero that make the way of the locations are those of a train that goes back, and lose their sign;
    /// single wrong readings make none. Out: that they do, with the figures; or that too many for wrong readings are
    /// undecided.
    pub fn signed(&mut self, columns: &mut Columns, mapping: &SourceMapping) -> Option<String> {
        let said = mapping.columns.get(&Meaning::Speed).and_then(|column| column.signed);
        if said.is_some() || !columns.has(Meaning::Speed) {
            return None;
        }
        let pace = usual(&self.side(columns, |_| true))?;
        let moving = self.rows.iter().filter_map(|row| row.numbers[2]).filter(|speed| speed.abs() > MOVES * pace.0);
        let (below, above): (Vec<f64>, Vec<f64>) = moving.partition(|speed| *speed < 0.0);
        let header = columns.header(Meaning::Speed).to_owned();
        let Some(alike) = self.go_back(columns, pace) else {
            let is_large = below.len() as f64 > MOST_WRONG * (below.len() + above.len()) as f64;
            return is_large.then(|| {
                let remedy = line([(Meaning::Speed, &*header, "signed = true".to_owned())]);
                format!(
                    "column {header:?} is below zero in {} rows of a moving train, and the way by location does not show that the train goes back in them: they are missing; if it does, {SAY_IT}: {remedy}",
                    below.len()
                )
            });
        };
        columns.is_signed = true;
        self.rows.iter_mut().for_each(WrittenRow::leave_out_sign);
        Some(format!(
            "the sign of column {header:?} is taken for the direction of travel: its distance below zero ({} rows) is that by location in {:.0} % of the stretches",
            below.len(),
            100.0 * alike
        ))
    }

    /// Rows of a moving train on one side of zero, without their sign; a row on the other side ends a piece.
    fn side(&self, columns: &Columns, is_of: fn(f64) -> bool) -> Vec<Vec<Passing>> {
        let pieces = pieces(&self.rows, columns);
        let of_side = pieces.iter().flat_map(|piece| piece.split(|row| !is_of(row.speed)));
        of_side.map(|rows| rows.iter().map(|row| Passing { speed: row.speed.abs(), ..*row }).collect()).collect()
    }

    /// The share of the stretches below zero whose distance is as long as it is above zero; none where too few say so.
    fn go_back(&self, columns: &Columns, pace: (f64, f64)) -> Option<f64> {
        let [back, on] = [self.side(columns, |speed| speed < 0.0), self.side(columns, |speed| speed > 0.0)];
        [STEPS, FEW_STEPS].into_iter().find_map(|steps| {
            let of = |rows: &[Vec<Passing>]| {
                let longest = longest(rows, pace.1);
                Stretches::new(ratios(rows, columns, [pace.0, longest], (steps, true)), pace.0, pace.1)
            };
            let back = of(&back)?;
            let is_as_far = of(&on).is_none_or(|on| (back.ratio / on.ratio - 1.0).abs() < ALIKE);
            (is_as_far && back.alike >= LEAST_ALIKE).then_some(back.alike)
        })
    }
}

impl WrittenRow {
    pub(super) fn leave_out_sign(&mut self) {
        self.numbers[2] = self.numbers[2].map(f64::abs);
    }
}
