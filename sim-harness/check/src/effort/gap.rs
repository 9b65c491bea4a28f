//! An effort column that has nothing between 0 and a least effort: what is small is written as 0, and no zero is surely
//! that of a coast.
//!
//! In: rows of all runs of a unit, put right. Out: the least effort, where it is no step of the column.
//!
//! A lever has steps, and a driver who turns the power on and off passes small efforts within a row. So efforts just
//! above the least one are asked for, of many sizes.

use crate::rows::stairs::spacing;
use rundown_files::sample::Sample;
use rundown_files::statistics::sorted;

/// A least effort of so many steps of the column is none of them.
const LEAST_STEPS: f64 = 2.5;
/// So many efforts up to twice the least one, and of so many sizes: as many would be below it.
const LEAST_ROWS: usize = 60;
const LEAST_SIZES: usize = 15;

/// The least effort, N/kg, and how many rows have up to twice as much.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Gap {
    pub(crate) least_n_per_kg: f64,
    pub(crate) rows: usize,
}

/// None: efforts reach down to 0, or too few do nearly.
pub(crate) fn of<'a>(rows: impl Iterator<Item = &'a Sample>) -> Option<Gap> {
    let efforts = rows.filter_map(|row| row.effort_n_per_kg);
    let sizes = sorted(efforts.map(f64::abs).filter(|size| *size > 0.0));
    let least_n_per_kg = *sizes.first()?;
    let mut small = sizes[..sizes.partition_point(|size| *size < 2.0 * least_n_per_kg)].to_vec();
    let rows = small.len();
    small.dedup();
    let is_no_step = least_n_per_kg > LEAST_STEPS * spacing(&small);
    let is_gap = rows >= LEAST_ROWS && small.len() >= LEAST_SIZES && is_no_step;
    is_gap.then_some(Gap { least_n_per_kg, rows })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Efforts of all sizes up to 0.3 N/kg in steps, of which those below `least` are written as 0.
    fn found(step: f64, least: f64) -> Option<Gap> {
        let size = |i: usize| (0.3 * (i as f64 / 2000.0) / step).round() * step;
        let written = |n_per_kg: f64| if n_per_kg < least { 0.0 } else { n_per_kg };
        let row = |i| Sample { effort_n_per_kg: Some(written(size(i))), ..Sample::default() };
        let rows: Vec<Sample> = (0..2000).map(row).collect();
        of(rows.iter())
    }

    #[test]
    fn efforts_that_are_never_small_have_a_gap_and_those_of_a_lever_have_none() {
        let gap = found(1e-4, 0.022).unwrap();
        assert!((gap.least_n_per_kg - 0.022).abs() < 1e-9 && gap.rows > 100, "{gap:?}");
        for (step, least) in [(1e-4, 0.0), (1e-4, 2e-4), (0.02, 0.022), (0.03, 0.0)] {
            assert_eq!(found(step, least), None, "{step} {least}");
        }
    }
}
