//! Whether a column that is named like one of runs holds runs.

use super::SeenRows;
use crate::import::columns::Columns;
use crate::import::mapping::{SAY_IT, SourceMapping, line};
use crate::import::meaning::Meaning;
use std::collections::BTreeSet;

/// Rows that a run has at least, in the mean: a course over ground is another one in every few.
const LEAST_ROWS: usize = 10;
/// With fewer names of runs nothing is said of their rows.
const FEWEST_RUNS: usize = 20;
/// Times that a switch of two values goes to and fro.
const SWITCHED: usize = 3;

impl SeenRows {
    /// A `course` over ground, a `track` in degrees, a `run` that says whether the train moves split no rows. Out: that
    /// it is so, with the line that splits by it all the same.
    pub fn no_run(&mut self, columns: &mut Columns, mapping: &SourceMapping) -> Option<String> {
        if mapping.columns.contains_key(&Meaning::Run) || !columns.has(Meaning::Run) {
            return None;
        }
        let why = self.why_no_run()?;
        let header = columns.of.remove(&Meaning::Run)?.header;
        self.rows.iter_mut().for_each(|row| row.of[1] = None);
        let remedy = line([(Meaning::Run, &*header, String::new())]);
        Some(format!("column {header:?} is not taken for the run: {why}; if it is, {SAY_IT}: {remedy}"))
    }

    fn why_no_run(&self) -> Option<String> {
        let names: Vec<&str> = self.rows.iter().filter_map(|row| row.of[1].as_deref()).map(str::trim).collect();
        let is_fraction =
            |name: &&&str| name.replace(',', ".").parse::<f64>().is_ok_and(|number| number.fract() != 0.0);
        if let Some(fraction) = names.iter().find(is_fraction) {
            return Some(format!("{fraction} is no whole number"));
        }
        let different: BTreeSet<&str> = names.iter().copied().collect();
        let changes = names.windows(2).filter(|pair| pair[0] != pair[1]).count();
        let is_switch = ["0", "false"].iter().any(|off| different.contains(off)) && different.len() == 2;
        if is_switch && changes >= SWITCHED {
            return Some(format!("it goes to and fro between two values {changes} times"));
        }
        let is_of_rows = different.len() >= FEWEST_RUNS && names.len() < LEAST_ROWS * different.len();
        is_of_rows.then(|| format!("{} rows have {} different values", names.len(), different.len()))
    }
}
