//! The table of all runs, and the page of each: its residuals over location, and its simulated speeds where it was held
//! out.

use super::held_out::simulated;
use super::maps::{joined, sections};
use crate::answer::whole::Answer;
use crate::data::rows::Row;
use maud::{Markup, html};
use rundown_files::statistics::mean;
use rundown_pages::chart::{Drawing, Figure, Layer, Panel, Stroke, range_of};
use rundown_pages::numbers::{counted, number};
use rundown_pages::run_pages::{self, Neighbours};
use rundown_pages::shell::{Section, choice_column, column, figure, sortable, text_column};
use rundown_pages::{colours, shell};

const NOTHING: &str = "no intervals";

/// A row of the analysis with what the effects explain of it.
type Explained<'a> = (&'a Row, f64);

/// The rows of each run, in the order of the runs.
pub(super) fn by_run<'a>(answer: &'a Answer, explained: &[f64]) -> Vec<Vec<Explained<'a>>> {
    let mut runs = vec![Vec::new(); answer.input.runs.len()];
    for (row, explained) in answer.found.findings.rows.iter().zip(explained) {
        if let Some(of_run) = runs.get_mut(row.interval.run) {
            of_run.push((row, *explained));
        }
    }
    runs
}

fn is_held_out(answer: &Answer, run: usize) -> bool {
    answer.found.held_out.contains(&run)
}

/// 10⁻³ N/kg.
const MILLI: f64 = 1e3;

/// A row for each run; its name leads to its page where there is one.
pub(super) fn table(answer: &Answer, rows: &[Vec<Explained<'_>>], has_pages: bool) -> Markup {
    let head = [
        text_column("run"),
        choice_column("direction"),
        choice_column("held out"),
        column("intervals", ""),
        column("mean residual", "10\u{207b}\u{b3} N/kg"),
        column("not explained", "10\u{207b}\u{b3} N/kg"),
    ];
    let body = html! { @for (index, (run, rows)) in answer.input.runs.iter().zip(rows).enumerate() { tr {
        th scope="row" { (run_pages::linked(&run.name, index, has_pages)) }
        td.word { (run.direction.as_str()) }
        td.word { @if is_held_out(answer, index) { "yes" } @else { "no" } }
        td { (rows.len()) }
        td { (number(mean(rows.iter().map(|(row, _)| MILLI * row.residual_n_per_kg)), 2)) }
        td { (number(mean(rows.iter().map(|(row, explained)| MILLI * (row.residual_n_per_kg - explained))), 2)) }
    } } };
    html! {
        p {
            "The residual is a mean over the intervals of the run, before and after what the effects explain of it. "
            "Wind and load of the day stay: no model of other runs knows them. Names and sizes of the effects come from all runs; how much of the gap they "
            "remove was measured on those held out, with what the others show."
            @if has_pages { " Each run has a page in the folder " code { (run_pages::FOLDER) } "." }
        }
        (sortable(head, body))
    }
}

/// The page of a run; a page without content where there is no such run.
pub(super) fn page(answer: &Answer, rows: &[Vec<Explained<'_>>], index: usize) -> String {
    let (Some(run), Some(rows)) = (answer.input.runs.get(index), rows.get(index)) else {
        return String::new();
    };
    let name = |at: usize| answer.input.runs.get(at).map(|run| run.name.as_str());
    let neighbours = Neighbours {
        index,
        all: ("../report.html#runs", "All runs"),
        before: index.checked_sub(1).and_then(name),
        next: name(index + 1),
    };
    let lead = html! {
        p.lead {
            (counted(rows.len(), "interval", "intervals")) " of this run counted; it went "
            (run.direction.as_str()) " the line. "
            @if is_held_out(answer, index) { "It was held out when the model was tested." }
        }
    };
    let mut parts = vec![Section::new("residual", "Residual over location", residual(answer, index, rows))];
    let held_out = answer.found.held_out.iter().position(|held_out| *held_out == index);
    if let Some(drawing) = held_out.and_then(|at| simulated(answer, at)) {
        let words =
            "Windows begin at the measured speed and are driven by the recorded effort, or by none while coasting.";
        parts.push(Section::new("simulated", "Measured and simulated speed", figure(&drawing, words)));
    }
    run_pages::page(&run.name, &neighbours, &lead, &parts)
}

fn residual(answer: &Answer, index: usize, rows: &[Explained<'_>]) -> Markup {
    let words = "Above: the measured speed, all of it. Below: the resistance that the believed model lacks, interval by interval, and what the effects \
        explain of it. Intervals that say nothing, as while the effort changes or is not known, are left out.";
    shell::figure(&residual_figure(answer, index, rows), words)
}

fn residual_figure(answer: &Answer, index: usize, rows: &[Explained<'_>]) -> Drawing {
    let run = &answer.input.runs[index];
    let km = |row: &Row| row.interval.middle().location_m / 1000.0;
    let speeds: Vec<Option<(f64, f64)>> =
        run.samples.iter().map(|s| Some((s.location_m? / 1000.0, 3.6 * s.speed_mps?))).collect();
    // What is not adjacent in time is not joined.
    let apart = |a: &Explained<'_>, b: &Explained<'_>| {
        b.0.interval.begin_s - (a.0.interval.begin_s + a.0.interval.dt_s) > 0.5 * a.0.interval.dt_s
    };
    let mut residuals = vec![sections(answer)];
    residuals.push(Layer::dots(
        "residual",
        colours::MEASURED,
        0.7,
        rows.iter().map(|(row, _)| (km(row), row.residual_n_per_kg)).collect(),
    ));
    if !answer.found.named.is_empty() {
        let law = joined(rows, apart, |(row, explained)| Some((km(row), *explained)));
        residuals.push(Layer::line("explained", colours::ESTIMATED, Stroke::Dashed, law));
    }
    let x = range_of(speeds.iter().flatten().map(|(km, _)| *km).chain(rows.iter().map(|(row, _)| km(row))));
    let measured = Layer::line("measured", colours::MEASURED, Stroke::Thin, speeds);
    Figure::new(
        format!("Residuals of {}", run.name),
        "Measured speed and residual over location",
        "location, km",
        x,
        [
            Panel::new("speed, km/h", 260, vec![sections(answer), measured], "no readings"),
            Panel::new("residual, N/kg", 340, residuals, NOTHING),
        ],
    )
    .into()
}
