//! The page of one log of a check.

use super::Logs;
use super::parts::{SCRIPT_FILE, called, file_name, findings, interval};
use super::run_pictures::{clock, readings};
use maud::{Markup, html};
use rundown_check::{Check, RunCheck};
use rundown_pages::numbers::number;
use rundown_pages::shell::{Script, Section, document_with, figure};

/// The page of the run at this place; a page without content where there is none.
pub(super) fn page(found: &Check, logs: &Logs, at: usize) -> String {
    let (Some(run), Some(recorded), Some(right)) = (found.runs.get(at), logs.recorded.get(at), logs.right.get(at))
    else {
        return String::new();
    };
    let link = |at: Option<usize>, word: &str| {
        let run = at.and_then(|at| Some((at, found.runs.get(at)?)));
        html! { @if let Some((at, run)) = run { " \u{b7} " a href=(file_name(at)) { (word) ": " (run.name) } } }
    };
    let lead = html! {
        p { a href="../index.html#runs" { "All runs" } (link(at.checked_sub(1), "before")) (link(Some(at + 1), "next")) }
        (lead(run))
        @if !right.warnings.is_empty() {
            details { summary { "Warnings of the log" } ul { @for warning in &right.warnings { li { (warning) } } } }
        }
    };
    let readings = figure(
        &readings(run, recorded, right),
        "Readings as recorded and as put right. Where location and speed agree the lower lines stay level: a jump is a location that began again, a slope a wheel, \
         steps at each start and stop a speed that is older than its location.",
    );
    let clock = figure(
        &clock(run, recorded),
        "Time between rows as recorded. A row above the others is a gap or a lost second, one below zero a clock that was set back.",
    );
    let sections = [
        Section::new("findings", "Found in this run", findings(run.findings.iter())),
        Section::new("readings", "Speed and location", readings),
        Section::new("clock", "The clock", clock),
    ];
    document_with(Script::Beside(SCRIPT_FILE), &run.name, &lead, &sections)
}

fn lead(run: &RunCheck) -> Markup {
    html! {
        p.lead {
            (run.rows) " rows of " (called(&run.unit)) ", usually each " (number(run.step_s, 1)) " s. "
            @if let Some(refusal) = run.refusal() { "The run is not used: " (refusal.kind.words()) ". " }
            @if let Some(perturbed) = run.perturbed() { "Perturbed: " (perturbed) ". " }
        }
        @if run.scale.is_some() || run.skew_s.is_some() {
            p {
                "By this run alone: measured over true speed " (interval(run.scale, 4)) ", speed older than location by " (interval(run.skew_s, 2))
                " s (95 % intervals); noise of the location " (number(run.location_noise_m, 1)) " m."
            }
        }
    }
}
