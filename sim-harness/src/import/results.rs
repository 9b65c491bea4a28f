//! Results of Rundown that were copied without their manifest: tables that have a time and a location, and are no logs.
//!
//! In: files. Out: those whose header does not begin as that of a table of results, and why the others were left out.

use crate::alike::few;
use crate::output::{coast_ahead, estimates, features, parameters};
use crate::simulation::folder::truth_columns;
use crate::study::figures::{profiles, run};
use rundown::features::FeatureConfig;
use rundown_files::column::{About, about};
use rundown_gap::answer::tables;
use rundown_pages::numbers::counted;
use std::path::{Path, PathBuf};

/// So many first columns of a table make it known; those that follow may depend on the configuration.
const KNOWN_BY: usize = 8;

struct ResultTable {
    /// Command and file.
    name: &'static str,
    columns: Vec<String>,
}

impl ResultTable {
    fn new(name: &'static str, columns: &[About]) -> Self {
        Self { name, columns: columns.iter().take(KNOWN_BY).map(|column| column.name.clone()).collect() }
    }

    fn begins(&self, header: &[String]) -> bool {
        header.starts_with(&self.columns)
    }
}

fn known() -> Vec<ResultTable> {
    let of = ResultTable::new;
    vec![
        of("replay: <run>.estimates", &about(estimates::columns())),
        of("replay: <run>.coast_ahead", &about(coast_ahead::columns())),
        of("replay: features", &about(features::columns(&FeatureConfig::default()))),
        of("replay: parameters", &about(parameters::columns())),
        of("replay: switching_points", &about(features::switch_columns())),
        of("gap: residuals", &about(tables::residuals())),
        of("gap: powering", &about(tables::powering())),
        of("gap: before_after", &about(tables::before_after())),
        of("simulate: truth", &about(truth_columns())),
        of("study: fig2_speed_profiles", &about(profiles::columns())),
        of("study: fig3_run", &about(run::motion_columns())),
        of("study: fig5_resistance", &about(run::term_columns())),
        of("study: fig6_regimes", &about(run::regime_columns())),
    ]
}

/// Takes them out. Out: a line for each of the first, and how many there are.
pub fn left_out(files: &mut Vec<PathBuf>) -> Vec<String> {
    let (known, mut said) = (known(), Vec::new());
    files.retain(|path| {
        let header = header(path);
        let result = known.iter().find(|table| table.begins(&header));
        said.extend(result.map(|table| {
            let name = table.name;
            format!("{}: expected a log, found the columns of a result of `rundown {name}`; left out", path.display())
        }));
        result.is_none()
    });
    let count = said.len();
    let all =
        (count > 0).then(|| format!("{} left out", counted(count, "result of Rundown is", "results of Rundown are")));
    few(&said).into_iter().chain(all).collect()
}

/// Names of the columns of a CSV; none of anything else.
fn header(path: &Path) -> Vec<String> {
    let is_csv = path.extension().is_some_and(|end| end.eq_ignore_ascii_case("csv"));
    let reader = csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_path(path);
    let read = |mut reader: csv::Reader<std::fs::File>| {
        reader.headers().map(|header| header.iter().map(str::to_owned).collect()).unwrap_or_default()
    };
    if is_csv { reader.map(read).unwrap_or_default() } else { Vec::new() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rundown_files::sample::COLUMNS;

    #[test]
    fn no_log_begins_as_a_result_does() {
        let log: Vec<String> = COLUMNS.iter().map(|column| column.about().name).collect();
        for table in known() {
            assert!(!table.begins(&log) && table.columns.len() >= 3, "{}: {:?}", table.name, table.columns);
        }
    }
}
