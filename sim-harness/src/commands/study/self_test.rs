//! `rundown study --truth-slope`: does the estimate follow the truth?

use super::Arguments;
use crate::commands::{Failure, screen};
use crate::study::case::calm;
use crate::study::figures::{Picture, slope};
use crate::study::slope::{self as self_test, SlopePlan};
use crate::study::write;
use rundown::estimator::config::Config;
use rundown_files::WriteError;
use rundown_files::folder::{self, Provenance};
use serde_json::json;
use std::path::Path;
use std::process::ExitCode;

pub(super) fn run(arguments: &Arguments, config: Config, out: &Path) -> Result<ExitCode, Failure> {
    let provenance = Provenance::begin(arguments.config.as_slice());
    let plan = SlopePlan {
        simulation: calm()?,
        vehicles: usize::from(arguments.vehicles),
        runs: usize::from(arguments.vehicle_runs),
        seed: arguments.seed(),
    };
    let bar = screen::progress(plan.vehicles * plan.runs);
    let test = self_test::self_test(&plan, config, || bar.inc(1))?;
    bar.finish_and_clear();
    let pictures: Vec<Picture> = plan.stages().into_iter().map(|runs| slope::slope(&test, runs)).collect();
    let json = json!({ "vehicles": plan.vehicles, "runs": plan.runs, "seed": plan.seed, "answers": test.answers });
    let json = format!("{json:#}\n");
    folder::write("study", out, &provenance, |folder| -> Result<(), WriteError> {
        write::pictures(folder, &pictures)?;
        write::records(&folder.join("slope.csv"), &self_test::records(&test.answers))?;
        write::text(&folder.join("slope.md"), &self_test::markdown(&test.answers))?;
        write::text(&folder.join("slope.json"), &json)
    })?;
    screen::results(arguments.json, &json, &self_test::table(&test.answers), out);
    Ok(ExitCode::SUCCESS)
}
