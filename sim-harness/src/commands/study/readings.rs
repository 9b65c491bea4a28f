//! `rundown study --readings`: which reading of the text, with which recorder, gives the paper's figures, on simulated
//! or recorded runs.

use super::Arguments;
use crate::commands::recorded::OpenedCase;
use crate::commands::{Failure, screen};
use crate::study::readings::comparison::Compared;
use crate::study::readings::recorded::Taken;
use crate::study::readings::{self, comparison, outcome, reading::Combination};
use crate::study::{description, write};
use rundown::estimator::config::Config;
use rundown_files::WriteError;
use rundown_files::column;
use rundown_files::folder::{self, Provenance};
use rundown_pages::numbers::counted;
use serde_json::json;
use std::path::Path;
use std::process::ExitCode;

/// Sets of runs on which readings are compared.
const SETS: u16 = 5;

/// `rundown study --readings`.
pub(super) fn compare(arguments: &Arguments, out: &Path) -> Result<ExitCode, Failure> {
    if let Some(opened) = arguments.recorded.open_undiagnosed(&Config::default())? {
        return readings_of(arguments, opened, out);
    }
    let provenance = Provenance::begin(arguments.scenario.as_slice());
    let simulation = arguments.simulation()?;
    let plan = comparison::ComparisonPlan {
        runs: simulation.runs,
        seed: arguments.seed(),
        seeds: usize::from(arguments.seeds.unwrap_or(SETS)),
        simulation,
    };
    let bar = screen::progress(plan.seeds * Combination::all().len());
    let all = comparison::compare(&plan, || bar.inc(1))?;
    bar.finish_and_clear();
    let words = Words {
        on: format!("{} sets of {} simulated runs", plan.seeds, plan.runs),
        of: format!("mean of {} seeds", plan.seeds),
        notes: Vec::new(),
        extent: json!({ "runs": plan.runs, "seeds": plan.seeds, "seed": plan.seed }),
    };
    write_readings(&all, words, &provenance, arguments.json, out)
}

/// The readings on recorded runs.
fn readings_of(arguments: &Arguments, opened: OpenedCase, out: &Path) -> Result<ExitCode, Failure> {
    let OpenedCase { train, track, mut source, known, inputs, .. } = opened;
    let recorded = &arguments.recorded;
    let taken = Taken { known: &known, as_recorded: recorded.as_recorded, keep_perturbed: recorded.keep_perturbed };
    let found = readings::recorded::recorded(&mut source, taken, &train)?;
    found.notes.iter().for_each(|text| screen::note(text));
    recorded.strict.check(found.notes.len())?;
    if found.runs == 0 {
        return Err(Failure::no_runs("no run could be used; the notes say why"));
    }
    let believed = description::Believed { train, track };
    let bar = screen::progress(Combination::of(found.by_recorder.iter().map(|(recorder, _)| *recorder)).len());
    let all = comparison::compare_recorded(&believed, &found.by_recorder, found.left_out, || bar.inc(1))?;
    bar.finish_and_clear();
    let runs = counted(found.runs, "recorded run", "recorded runs");
    let extent = json!({ "runs": found.runs, "seeds": null, "seed": null });
    let words = Words { on: runs.clone(), of: runs, notes: found.notes, extent };
    write_readings(&all, words, &Provenance::begin(&inputs), arguments.json, out)
}

/// What is said beside the readings.
struct Words {
    /// What they are compared on.
    on: String,
    /// What the values of the picture are of.
    of: String,
    notes: Vec<String>,
    /// The first fields of the JSON.
    extent: serde_json::Value,
}

fn write_readings(
    all: &[Compared],
    words: Words,
    provenance: &Provenance,
    as_json: bool,
    out: &Path,
) -> Result<ExitCode, Failure> {
    let pictures = readings::picture::pictures(all, &words.of);
    let rows: Vec<_> = column::records(&pictures[0].numbers).iter().map(rundown_files::table::to_json).collect();
    let mut json = words.extent;
    json["notes"] = json!(words.notes);
    json["combinations"] = json!(rows);
    let json = format!("{json:#}\n");
    let page = outcome::page(&words.on, &words.notes, all, &pictures);
    folder::write("study", out, provenance, |folder| -> Result<(), WriteError> {
        write::pictures(folder, &pictures)?;
        write::text(&folder.join("readings.json"), &json)?;
        write::text(&folder.join("readings.md"), &outcome::markdown(all))?;
        write::text(&folder.join("report.html"), &page)
    })?;
    screen::results(as_json, &json, &outcome::screen(all), out);
    Ok(ExitCode::SUCCESS)
}
