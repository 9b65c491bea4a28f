//! `report.html` of a check: recorder by recorder what was found, with pictures; the table of runs; and a page for each
//! run.
//!
//! In: a [`Check`] and its [`Logs`]. Out: a folder that opens from the disk.

use super::parts::{called, findings, interval};
use super::pictures::{ComparedWindow, MOST_DOTS, compared, digits_and_runs, speed_against_location};
use super::{Logs, of_all, run_page};
use crate::logs::Failed;
use crate::output::files;
use maud::{Markup, html};
use rayon::prelude::*;
use rundown_check::finding::Done;
use rundown_check::{Check, Correction, RecorderCheck, RunCheck};
use rundown_files::WriteError;
use rundown_files::sample::Sample;
use rundown_pages::assets::SCRIPT;
use rundown_pages::numbers::{NOTHING, counted, number};
use rundown_pages::run_pages;
use rundown_pages::shell::{self, Section, choice_column, column, figure, prose, sortable, table, text_column};
use std::path::Path;

/// Folder of the pages of the runs.
const RUN_PAGES: &str = "report";

/// Writes `report.html` and a page for each run into a folder, which is made when it does not exist. `notes`: what else
/// the screen says.
///
/// # Errors
/// [`WriteError`] names the file.
pub fn write(folder: &Path, found: &Check, logs: &Logs, failed: &[Failed], notes: &[String]) -> Result<(), WriteError> {
    let pages = folder.join(RUN_PAGES);
    files::folder(&pages)?;
    files::text(&folder.join("report.html"), &first(found, logs, failed, notes))?;
    files::text(&pages.join(run_pages::SCRIPT_FILE), SCRIPT)?;
    let write = |at| files::text(&pages.join(run_pages::name(at)), &run_page::page(found, logs, at));
    (0..found.runs.len()).into_par_iter().try_for_each(write)
}

fn first(found: &Check, logs: &Logs, failed: &[Failed], notes: &[String]) -> String {
    let of_recorder = |(at, recorder): (usize, &RecorderCheck)| {
        let heading = if recorder.unit.is_empty() { "The recorder".to_owned() } else { recorder.unit.clone() };
        Section::new(format!("recorder-{}", at + 1), heading, recorder_section(recorder, found, logs))
    };
    let mut sections: Vec<Section> = found.recorders.iter().enumerate().map(of_recorder).collect();
    if !found.runs.is_empty() {
        sections.push(Section::new("runs", "Runs", runs(found)));
    }
    if !failed.is_empty() {
        sections.push(Section::new("unread", "Logs that cannot be read", unread(failed)));
    }
    let notes: Vec<String> = of_all(found).chain(notes.iter().cloned()).collect();
    if !notes.is_empty() {
        sections.push(Section::new(
            "notes",
            "What else is to be known",
            html! { ul { @for note in &notes { li { (prose(note)) } } } },
        ));
    }
    sections.push(Section::new("reading-aids", "How to read this", reading_aids()));
    shell::document("What the recorders did to their logs", &lead(found, failed), &sections)
}

fn lead(found: &Check, failed: &[Failed]) -> Markup {
    let clean = found.clean();
    let refused = found.refused().count();
    html! {
        @if refused == found.runs.len() {
            p.lead { strong { "Nothing could be judged: no log can be used." } }
        }
        p.lead {
            (counted(found.runs.len(), "run", "runs")) " of " (counted(found.recorders.len(), "recorder", "recorders"))
            ": in " (clean) " nothing of their own was found, " (refused) " cannot be used."
            @if !failed.is_empty() {
                " Of " (found.runs.len() + failed.len()) " logs " a href="#unread" { (failed.len()) " cannot be read" } "."
            }
        }
    }
}

fn recorder_section(recorder: &RecorderCheck, found: &Check, logs: &Logs) -> Markup {
    let of_unit: Vec<usize> = (0..found.runs.len()).filter(|i| found.runs[*i].unit == recorder.unit).collect();
    let usable = || of_unit.iter().filter(|i| found.runs[**i].is_usable());
    let windows: Vec<ComparedWindow> =
        usable().flat_map(|i| compared(&found.runs[*i], recorder, &logs.right[*i])).collect();
    if usable().next().is_none() {
        let runs = counted(of_unit.len(), "run", "runs");
        return html! {
            p { "Nothing could be judged: of " (runs) " none can be used." }
            @if !recorder.findings.is_empty() { (findings(&recorder.findings, &recorder.evidence)) }
            p { "What is wrong with each stands " a href="#runs" { "in the table of runs" } "." }
        };
    }
    let runs: Vec<&RunCheck> = of_unit.iter().map(|i| &found.runs[*i]).collect();
    let recorded: Vec<&[Sample]> = of_unit.iter().map(|i| logs.recorded[*i].as_slice()).collect();
    let drawn = if windows.len() > MOST_DOTS { ", of which some are drawn" } else { "" };
    let against = format!(
        "Mean speed by the location less mean speed as read, in {} stretches{drawn}; the skew is taken out. A wheel that is not as believed is a slope, \
         a recorder that truncates lies above zero by half a step.",
        windows.len()
    );
    html! {
        p { "Speed and location were compared in " (recorder.compared) " of " (counted(recorder.runs, "run", "runs")) ". " (done(recorder)) }
        (figures(recorder))
        (findings(&recorder.findings, &recorder.evidence))
        (figure(&speed_against_location(recorder, &windows), &against))
        (figure(
            &digits_and_runs(&runs, &recorded),
            "The fractions that the speeds have say in which step they are shown. Scale and skew of each run alone, with 95 % intervals; dashed where both agree."
        ))
    }
}

/// What was done to the speeds.
fn done(recorder: &RecorderCheck) -> String {
    let Correction { offset_mps, scale } = recorder.correction;
    match recorder.correction == Correction::NONE {
        true => "Its speeds are left as they are.".to_owned(),
        false => format!(
            "Its speeds were put right: true speed = (speed as read + {} km/h) / {}, a standing train stays at 0.",
            number(3.6 * offset_mps, 3),
            number(scale, 4)
        ),
    }
}

fn figures(recorder: &RecorderCheck) -> Markup {
    let with_interval = [
        ("measured over true speed", recorder.scale, 4, ""),
        ("true less read speed", recorder.offset_kmh, 3, "km/h"),
        ("speed older than location, median over runs", recorder.skew_s, 2, "s"),
    ];
    let alone = [
        ("difference of that from run to run", recorder.skew_spread_s, 2, "s"),
        ("how surely lost seconds beside a wheel are seen", recorder.lost_second_sd_s, 2, "s"),
        ("step of the speeds", recorder.speed_step_kmh, 3, "km/h"),
        ("step of the locations", recorder.location_step_m, 3, "m"),
        ("step of the efforts", recorder.effort_step_n_per_kg, 4, "N/kg"),
    ];
    let rows = html! {
        @for (name, value, decimals, unit) in with_interval { tr {
            th scope="row" { (name) } td { (number(value.map(|v| v.value), decimals)) } td { (interval(value, decimals)) } td.word { (unit) }
        } }
        @for (name, value, decimals, unit) in alone { tr {
            th scope="row" { (name) } td { (number(value, decimals)) } td { (NOTHING) } td.word { (unit) }
        } }
    };
    table([text_column("quantity"), column("value", ""), column("95 % interval", ""), text_column("unit")], rows)
}

/// The worst that was done with a run, in a word to choose by.
fn verdict(run: &RunCheck) -> &'static str {
    let has = |done| run.findings.iter().any(|finding| finding.done == done);
    match () {
        () if has(Done::Refused) => "not used",
        () if has(Done::LeftOut) => "readings left out",
        () if has(Done::PutRight) => "put right",
        () if !run.perturbations.is_empty() => "perturbed",
        () if has(Done::Said) => "noted",
        () => "clean",
    }
}

/// What was found in a run, why it is not used, and what held it up.
fn said(run: &RunCheck) -> String {
    let found = run.findings.iter().map(|finding| match finding.done {
        Done::Refused => run.said(finding),
        Done::PutRight | Done::LeftOut | Done::Said => finding.kind.words().to_owned(),
    });
    found.chain(run.perturbed()).collect::<Vec<String>>().join("; ")
}

/// What matters comes first: on a narrow screen the last columns have to be scrolled to.
fn runs(found: &Check) -> Markup {
    let head = [
        text_column("run"),
        choice_column("verdict"),
        text_column("found"),
        choice_column("recorder"),
        column("rows", ""),
        column("step", "s"),
        column("speed over location", "95 % interval"),
        column("speed older", "s, 95 % interval"),
        column("location noise", "m"),
    ];
    let rows = html! { @for (at, run) in found.runs.iter().enumerate() { tr {
        th scope="row" { a href=(format!("{RUN_PAGES}/{}", run_pages::name(at))) { (run_pages::one_line(&run.name)) } }
        td.word { (verdict(run)) }
        td.text { (prose(&said(run))) }
        td.word { (called(&run.unit)) }
        td { (run.rows) }
        td { (number(run.step_s, 1)) }
        td { (interval(run.scale, 4)) }
        td { (interval(run.skew_s, 2)) }
        td { (number(run.location_noise_m, 1)) }
    } } };
    html! {
        (sortable(head, rows))
        p.small { "What is found in all runs of a recorder stands above. Each run has a page in the folder " code { (RUN_PAGES) } "." }
    }
}

fn unread(failed: &[Failed]) -> Markup {
    let rows = html! { @for failed in failed { tr {
        th scope="row" { (run_pages::one_line(&failed.file.display().to_string())) }
        td.text { @for line in failed.error.lines() { div { (prose(line)) } } }
    } } };
    table([text_column("log"), text_column("why")], rows)
}

fn reading_aids() -> Markup {
    html! { dl {
        dt { "Put right, left out, not changed, not used" }
        dd { "What a replay, a gap or a study does before anything else looks at the log: corrects the readings, leaves the readings concerned out, says it only, or refuses the run." }
        dt { "95 % interval" }
        dd { "The wider one of what the noise and what the scatter between runs says. Scale and offset are one fit: a slow run cannot tell them apart, and does not decide." }
        dt { "Speed older than location" }
        dd { "The recorder writes the speed of some time ago beside the location of now. What is beyond doubt is put right: each location is moved to the age of the speed." }
        dt { "Pictures" }
        dd { "Drag to zoom, double-click to see all again; values under the cursor stand above each plot; a click on a name there switches it off." }
    } }
}
