//! Whether a column that is named like one of runs holds runs.

use super::SeenRows;
use crate::import::columns::Columns;
use crate::import::mapping::{SAY_IT, SourceMapping, line};
use crate::import::meaning::Meaning;
use std::collections::{BTreeMap, BTreeSet};

/// Rows for which a run stays the same at least, in the mean: a course over ground is another one in every few.
const LEAST_ROWS: usize = 10;
/// Whole numbers say nothing where there are fewer of them.
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
        let of_trains = self.names_of_runs();
        let names = || of_trains.iter().flatten().map(|(name, _)| *name);
        let changes = |names: &Vec<(&str, Option<&str>)>| names.windows(2).filter(|pair| goes_on(pair)).count();
        let most = of_trains.iter().map(changes).max().unwrap_or(0);
        if names().all(is_of_switch) && most >= SWITCHED {
            return Some(format!("it goes to and fro between on and off {most} times"));
        }
        let (rows, stays) = (names().count(), of_trains.iter().map(|names| changes(names) + 1).sum::<usize>());
        if rows >= LEAST_ROWS * stays {
            return None;
        }
        let is_fraction = |name: &&str| {
            let number = name.replace(',', ".").parse::<f64>();
            number.is_ok_and(|number| number.is_finite() && number.fract() != 0.0)
        };
        let different = names().collect::<BTreeSet<&str>>().len();
        let fraction = names().find(|name| is_fraction(name)).map(|name| format!("{name} is no whole number"));
        let are_many = || (different >= FEWEST_RUNS).then(|| format!("it has {different} values"));
        fraction.or_else(are_many).map(|why| format!("{why}, and stays the same for {} rows", rows / stays))
    }

    /// What the column has, with the time, row by row of each unit in each file.
    fn names_of_runs(&self) -> Vec<Vec<(&str, Option<&str>)>> {
        let ends = self.begins.iter().skip(1).copied().chain([self.rows.len()]);
        let mut of_trains = BTreeMap::new();
        for (file, (begin, end)) in self.begins.iter().zip(ends).enumerate() {
            for row in &self.rows[*begin..end] {
                let Some(name) = row.of[1].as_deref() else { continue };
                let names: &mut Vec<_> = of_trains.entry((file, &row.of[0])).or_default();
                names.push((name.trim(), row.time.as_deref()));
            }
        }
        of_trains.into_values().collect()
    }
}

/// Another name in a later row: rows of one time are those of trains that take turns.
fn goes_on(pair: &[(&str, Option<&str>)]) -> bool {
    pair[0].0 != pair[1].0 && pair[0].1 != pair[1].1
}

fn is_of_switch(name: &str) -> bool {
    ["0", "1", "0.0", "1.0", "false", "true", "off", "on"].iter().any(|one| name.eq_ignore_ascii_case(one))
}
