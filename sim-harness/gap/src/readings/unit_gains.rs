//! Does the effort column of one unit read otherwise than those of the others?
//!
//! In: runs of several units with an effort column. Out: by how much a unit's readings of hard power are off beside those of the others; and the runs with them put right.
//!
//! ```text
//! off = ratio of the unit / middle ratio of all units - 1        ratio = sum u / sum f, see `brakes.rs`
//! ```
//!
//! The column of one unit would go into the gain of all, and what is left of it into the traction of all. A unit that is heavier than the others looks the same; what
//! all units have alike stays for the fits.

use crate::config::NuisanceConfig;
use crate::data::believed::Context;
use crate::data::cut;
use crate::data::rows::Row;
use crate::data::runs::{EffortReading, Run, run_without_gain};
use crate::efforts::Looked;
use crate::readings::brakes::{powered_hard, ratio};
use rundown_check::agreement::Figure;
use std::collections::BTreeMap;

/// The effort column of a unit beside those of the others.
#[derive(Clone, Debug, PartialEq)]
pub struct UnitGain {
    /// Name of the unit.
    pub of: String,
    /// Its gain over theirs less 1.
    pub off: Figure,
}

/// Each unit's ratio over the middle one; of two in the middle the one that is nearer to 1.
fn beside_middle(ratios: BTreeMap<&str, Figure>) -> Vec<UnitGain> {
    let mut values: Vec<Figure> = ratios.values().copied().collect();
    values.sort_by(|a, b| a.value.total_cmp(&b.value));
    let count = values.len();
    let both = [count.saturating_sub(1) / 2, count / 2].map(|i| values.get(i).copied());
    let off = |figure: &Figure| (figure.value - 1.0).abs();
    let Some(middle) = both.into_iter().flatten().min_by(|a, b| off(a).total_cmp(&off(b))) else {
        return Vec::new();
    };
    let one = |(of, ratio): (&str, Figure)| {
        let value = ratio.value / middle.value;
        let sd = value * (ratio.sd / ratio.value).hypot(middle.sd / middle.value);
        UnitGain { of: of.to_owned(), off: Figure { value: value - 1.0, sd } }
    };
    ratios.into_iter().map(one).collect()
}

/// Units whose column is surely off, and by more than matters.
pub fn unit_gains(context: &Context<'_>, runs: &[Run], effort: EffortReading) -> Vec<UnitGain> {
    let unit = |row: &Row| runs[row.interval.run].recorded.unit.as_str();
    if runs.iter().all(|run| run.recorded.unit == runs[0].recorded.unit) {
        return Vec::new();
    }
    let cut = cut::all(context, runs, effort);
    let rows = Looked { context, runs, cut: &cut, effort, measured: true, model: (&[], &[]) }.rows(None, 0.0);
    let mut of_units: BTreeMap<&str, Vec<&Row>> = BTreeMap::new();
    powered_hard(&rows).into_iter().for_each(|row| of_units.entry(unit(row)).or_default().push(row));
    let least = context.config.search.least_rows;
    let ratios = of_units.iter().filter_map(|(unit, rows)| Some((*unit, ratio(rows, least)?))).collect();
    let mut found = beside_middle(ratios);
    found.retain(|one| is_off(one, &context.config.nuisance));
    found
}

fn is_off(one: &UnitGain, config: &NuisanceConfig) -> bool {
    one.off.value.abs() > config.least_gain && one.off.away_from(0.0) > config.sure
}

/// The runs with the columns of these units as those of the others read.
pub fn put_right(runs: &[Run], found: &[UnitGain]) -> Vec<Run> {
    let gain = |run: &Run| found.iter().find(|one| one.of == run.recorded.unit).map_or(0.0, |one| one.off.value);
    runs.iter().map(|run| run_without_gain(run, gain(run))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::believed::tests::on_a_level_line;
    use crate::readings::brakes::tests;

    /// What is found of twelve runs of units a, b and so on in turn, whose columns have these gains, and what is left once that is put right.
    fn found(gains: &[f64]) -> [Vec<UnitGain>; 2] {
        on_a_level_line(12, |context| {
            let runs = tests::runs(context, |effort, _| effort, |_| 1.0);
            let of_unit = |(i, run): (usize, &Run)| {
                let unit = i % gains.len();
                let mut run = run_without_gain(run, 1.0 / gains[unit] - 1.0);
                run.recorded.unit = ["a", "b", "c", "d"][unit].to_owned();
                run
            };
            let runs: Vec<Run> = runs.iter().enumerate().map(of_unit).collect();
            let found = unit_gains(context, &runs, EffortReading::Momentary);
            let left = unit_gains(context, &put_right(&runs, &found), EffortReading::Momentary);
            [found, left]
        })
    }

    #[test]
    fn the_column_of_one_unit_is_put_right_and_those_of_the_others_are_left() {
        for gains in [&[1.0, 1.1, 1.0][..], &[1.0, 0.9], &[1.0, 1.06, 1.0, 1.0]] {
            let [found, left] = found(gains);
            let [one] = &found[..] else {
                panic!("expected one, found {found:?}");
            };
            assert!(one.of == "b" && (one.off.value - (gains[1] - 1.0)).abs() < 0.01, "{one:?}");
            assert_eq!(left, []);
        }
    }

    #[test]
    fn what_all_columns_have_alike_is_none_of_one_unit() {
        assert_eq!(found(&[1.1, 1.1, 1.1]), [[], []]);
        assert_eq!(found(&[1.1]), [[], []]);
    }
}
