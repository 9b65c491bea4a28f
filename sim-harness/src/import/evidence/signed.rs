//! Speeds that are signed by the direction of travel.

use super::{ALIKE, FEW_STEPS, LEAST_ALIKE, Passing, STEPS, SeenRows, Stretches, WrittenRow, ratios, usual};
use crate::import::columns::Columns;
use crate::import::mapping::SourceMapping;
use crate::import::meaning::Meaning;

impl SeenRows {
    /// Speeds below zero that make the way of the locations are those of a train that goes back, and lose their sign; single wrong readings make none.
    /// Out: that they do, with the figures.
    pub fn signed(&mut self, columns: &mut Columns, mapping: &SourceMapping) -> Option<String> {
        let said = mapping.columns.get(&Meaning::Speed).and_then(|column| column.signed);
        if said.is_some() || !columns.has(Meaning::Speed) {
            return None;
        }
        let alike = self.go_back(columns)?;
        let below = self.rows.iter().filter_map(|row| row.numbers[2]).filter(|speed| *speed < 0.0).count();
        columns.is_signed = true;
        self.rows.iter_mut().for_each(WrittenRow::leave_out_sign);
        Some(format!(
            "the sign of column {:?} is taken for the direction of travel: its distance below zero ({below} rows) is that by location in {:.0} % of the stretches",
            columns.header(Meaning::Speed),
            100.0 * alike
        ))
    }

    /// The share of the stretches below zero whose distance is as long as it is above zero; none where too few say so.
    fn go_back(&self, columns: &Columns) -> Option<f64> {
        let side = |is_of: fn(f64) -> bool| -> Vec<Option<Passing>> {
            let passing = self.rows.iter().map(|row| row.passing(columns).filter(|row| is_of(row.speed)));
            passing.map(|row| row.map(|row| Passing { speed: row.speed.abs(), ..row })).collect()
        };
        let pace = usual(&side(|_| true))?;
        let [back, on] = [side(|speed| speed < 0.0), side(|speed| speed > 0.0)];
        [STEPS, FEW_STEPS].into_iter().find_map(|steps| {
            let of = |rows: &[Option<Passing>]| Stretches::new(ratios(rows, columns, pace, steps), pace.0, pace.1);
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
