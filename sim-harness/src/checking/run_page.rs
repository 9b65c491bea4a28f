//! The page of one log of a check.

use super::Logs;
use super::parts::{called, findings, interval};
use super::run_pictures::{clock, readings};
use maud::{Markup, html};
use rundown_check::{Check, RunCheck};
use rundown_pages::numbers::number;
use rundown_pages::run_pages::{self, Neighbours};
use rundown_pages::shell::{Section, figure, prose};

/// The page of the run at this place; a page without content where there is none.
pub(super) fn page(found: &Check, logs: &Logs, at: usize) -> String {
    let (Some(run), Some(recorded), Some(right)) = (found.runs.get(at), logs.recorded.get(at), logs.right.get(at))
    else {
        return String::new();
    };
    let name = |at: usize| found.runs.get(at).map(|run| run.name.as_str());
    let neighbours = Neighbours {
        index: at,
        all: ("../report.html#runs", "All runs"),
        before: at.checked_sub(1).and_then(name),
        next: name(at + 1),
    };
    let lead = html! {
        (lead(run))
        @if !right.warnings.is_empty() {
            details { summary { "Warnings of the log" } ul { @for warning in &right.warnings { li { (prose(warning)) } } } }
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
        Section::new("findings", "Found in this run", findings(&run.findings, &run.evidence)),
        Section::new("readings", "Speed and location", readings),
        Section::new("clock", "The clock", clock),
    ];
    run_pages::page(&run.name, &neighbours, &lead, &sections)
}

fn lead(run: &RunCheck) -> Markup {
    html! {
        p.lead {
            (run.rows) " rows of " (called(&run.unit)) ", usually each " (number(run.step_s, 1)) " s. "
            @if let Some(refusal) = run.refusal() { "The run is not used: " (run.said(refusal)) ". " }
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
