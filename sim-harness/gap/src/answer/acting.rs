//! In which runs an effect acts: how many, whose they are, and when they were.

use crate::data::runs::Run;
use crate::named::Named;
use rundown_files::effect_file::date_of;
use rundown_files::statistics::extremes;

/// What a run is known by.
type Label = fn(&Run) -> &str;

/// `, in 13 of 28 runs, all those of unit 202`; empty where it acts in all runs.
pub(super) fn acting(named: &Named, runs: &[Run]) -> String {
    if named.runs.is_empty() {
        return String::new();
    }
    let (acts, others): (Vec<&Run>, Vec<&Run>) = runs.iter().partition(|run| named.runs.contains(&run.name));
    let mut text = format!(", in {} of {} runs", named.runs.len(), runs.len());
    let unit: Label = |run| &run.recorded.unit;
    let driver: Label = |run| &run.recorded.driver;
    for (name, label) in [("unit", unit), ("driver", driver)] {
        let of = acts.first().map_or("", |run| label(run));
        let is_whose = !of.is_empty() && acts.iter().all(|run| label(run) == of);
        // Where all runs are of one, nothing is said by it.
        if is_whose && others.iter().any(|run| label(run) != of) {
            let those = if others.iter().any(|run| label(run) == of) { "all" } else { "all those" };
            text.push_str(&format!(", {those} of {name} {of}"));
        }
    }
    let days = |runs: &[&Run]| runs.iter().map(|run| run.day).collect::<Option<Vec<f64>>>();
    if let Some((acts, others)) = days(&acts).zip(days(&others)) {
        let (first, last) = extremes(acts);
        let outside = others.iter().any(|day| *day < first || *day > last);
        if let (true, Some(first), Some(last)) = (outside, date_of(first), date_of(last)) {
            text.push_str(&format!(", {first} to {last}"));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::runs::tests::of_unit;
    use rundown::model::effects::{DraggingBrake, Effect};

    fn said(units: [&str; 4], acts: &[usize]) -> String {
        let runs: Vec<Run> = units.iter().enumerate().map(|(index, unit)| of_unit(index, unit)).collect();
        let effect = Effect::DraggingBrake(DraggingBrake { drag_n_per_kg: 4e-3 });
        let mut named = Named::plain(effect, Vec::new(), 30.0, 1e-3);
        named.runs = acts.iter().map(|index| format!("r{index}")).collect();
        acting(&named, &runs)
    }

    #[test]
    fn whose_runs_they_are_and_when_they_were() {
        assert_eq!(said(["", "", "", ""], &[]), "");
        assert_eq!(said(["201", "202", "201", "202"], &[0, 1, 2, 3]), ", in 4 of 4 runs");
        assert_eq!(said(["201", "202", "201", "202"], &[0, 3]), ", in 2 of 4 runs");
        let of_a_unit = ", in 2 of 4 runs, all those of unit 202, 2024-10-05 to 2024-10-07";
        assert_eq!(said(["201", "202", "201", "202"], &[1, 3]), of_a_unit);
        let of_part = ", in 2 of 4 runs, all of unit 202, 2024-10-05 to 2024-10-06";
        assert_eq!(said(["201", "202", "202", "202"], &[1, 2]), of_part);
        assert_eq!(said(["", "", "", ""], &[0, 1]), ", in 2 of 4 runs, 2024-10-04 to 2024-10-05");
    }
}
