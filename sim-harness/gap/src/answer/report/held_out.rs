//! Simulated against measured speed on hold-out runs.

use super::binned::{Value, binned, width};
use super::maps::{joined, sections};
use crate::answer::whole::Answer;
use crate::holdout::forward::Compared;
use maud::{Markup, html};
use plotters::style::RGBColor;
use rundown_check::figure::HALF_95;
use rundown_files::statistics::{mean_of, rms};
use rundown_pages::chart::{Drawing, Figure, Grid, Layer, Panel, Stroke, range_of};
use rundown_pages::shell::{choice_column, column, sortable, text_column};
use rundown_pages::{colours, numbers::number};
use std::collections::{BTreeMap, BTreeSet};

const BEFORE: RGBColor = colours::HELD;
const AFTER: RGBColor = colours::TRUTH;
const NOTHING_COMPARED: &str = "nothing was compared";

/// Pictures and captions; none where nothing was compared.
pub(super) fn held_out(answer: &Answer) -> Vec<(Drawing, String)> {
    if answer.found.compared.is_empty() {
        return Vec::new();
    }
    let mut all = vec![errors(answer)];
    all.extend(one_run(answer));
    all
}

/// Root mean square errors over location and speed.
fn errors(answer: &Answer) -> (Drawing, String) {
    let km = |c: &Compared| c.location_m / 1000.0;
    let kmh = |c: &Compared| 3.6 * c.measured_mps;
    let compared = &answer.found.compared;
    let figure = |label: &str, at: &dyn Fn(&Compared) -> f64, backs: Vec<Layer>| {
        let x = range_of(compared.iter().map(at));
        let width = width(&x, 30);
        let line = |legend: &str, colour, stroke, square: &dyn Fn(&Compared) -> f64| {
            let values = compared.iter().map(|c| Value { run: c.run, at: at(c), value: square(c), weight: 1.0 });
            let bins = binned(&values.collect::<Vec<_>>(), width);
            Layer::line(legend, colour, stroke, bins.iter().map(|bin| Some((bin.at, bin.mean.sqrt()))).collect())
        };
        let lines = [
            line("noise floor", colours::LIMIT, Stroke::Dotted, &|c| c.floor),
            line("before", BEFORE, Stroke::Solid, &|c| c.before_mps.powi(2)),
            line("after", AFTER, Stroke::Solid, &|c| c.after_mps.powi(2)),
        ];
        let layers: Vec<Layer> = backs.into_iter().chain(lines).collect();
        let top = layers.iter().flat_map(Layer::heights).fold(0.0, f64::max);
        let panel = Panel::new("error of speed, m/s", 340, layers, NOTHING_COMPARED).within(0.0..1.08 * top);
        Figure::in_grid(label, x, panel)
    };
    let grid = Grid::new(
        "Error of the simulated speed before and after",
        "Root mean square over location and over speed, hold-out runs",
        2,
        vec![figure("location, km", &km, vec![sections(answer)]), figure("speed, km/h", &kmh, Vec::new())],
    );
    (
        grid.into(),
        "Root mean square of simulated less measured speed on the hold-out runs: with the believed model, with the effects, and what noise alone would leave.".to_owned(),
    )
}

/// A row for each hold-out run: the reader may look for those that gain and those that lose.
pub(super) fn by_run(answer: &Answer) -> Markup {
    let mut runs: BTreeMap<usize, Vec<&Compared>> = BTreeMap::new();
    for c in &answer.found.compared {
        runs.entry(c.run).or_default().push(c);
    }
    let head = [
        text_column("hold-out run"),
        column("speeds compared", ""),
        column("before", "m/s, rms"),
        column("after", "m/s, rms"),
        column("noise floor", "m/s, rms"),
        choice_column("with the effects"),
    ];
    let rows = html! { @for (run, compared) in &runs {
        @let (before, after) = (rms(compared.iter().map(|c| c.before_mps)), rms(compared.iter().map(|c| c.after_mps)));
        tr {
            th scope="row" { (name(answer, *run)) }
            td { (compared.len()) }
            td { (number(before, 3)) }
            td { (number(after, 3)) }
            td { (number(mean_of(compared.iter().map(|c| c.floor)).sqrt(), 3)) }
            td.word { (if after < before { "nearer" } else if after > before { "further off" } else { "the same" }) }
        }
    } };
    html! { @if !runs.is_empty() {
        h3 { "Run by run" }
        (sortable(head, rows))
        p.small { "Here each speed counts alike; in the figures above each is weighed by how well a perfect model would foresee it." }
    } }
}

/// The run whose error before is the middle one of all hold-out runs: a typical one.
fn typical(compared: &[&Compared]) -> Option<usize> {
    let runs: BTreeSet<usize> = compared.iter().map(|c| c.run).collect();
    let error = |run: usize| mean_of(compared.iter().filter(|c| c.run == run).map(|c| c.before_mps.powi(2)));
    let mut errors: Vec<(f64, usize)> = runs.iter().map(|run| (error(*run), *run)).collect();
    errors.sort_by(|a, b| a.0.total_cmp(&b.0));
    errors.get(errors.len() / 2).map(|(_, run)| *run)
}

fn one_run(answer: &Answer) -> Option<(Drawing, String)> {
    let windows: Vec<&Compared> = windows(answer).collect();
    let run = typical(&windows)?;
    let caption = format!(
        "Hold-out run {}, a typical one: half of the hold-out runs had a larger error before. Windows of up to {} s begin at the measured speed and are driven by the recorded effort, or by none while coasting.",
        name(answer, run),
        number(answer.holdout().window_s, 0)
    );
    Some((simulated(answer, run)?, caption))
}

/// What was simulated from a measured speed on.
fn windows(answer: &Answer) -> impl Iterator<Item = &Compared> {
    answer.found.compared.iter().filter(|c| c.since_s > 0.0)
}

/// Of a run by its number among the hold-out ones.
fn name(answer: &Answer, run: usize) -> &str {
    let index = answer.found.held_out.get(run);
    index.and_then(|index| answer.input.runs.get(*index)).map_or("", |run| run.name.as_str())
}

/// Measured and simulated speed of a run, by its number among the hold-out ones; none where nothing of it was
/// simulated.
pub(super) fn simulated(answer: &Answer, run: usize) -> Option<Drawing> {
    let of_run: Vec<&Compared> = windows(answer).filter(|c| c.run == run).collect();
    if of_run.is_empty() {
        return None;
    }
    // A window restarts at the measured speed: its line must not be joined to the one before.
    let restarts = |a: &&Compared, b: &&Compared| b.since_s <= a.since_s;
    let km = |c: &Compared| c.location_m / 1000.0;
    let line = |legend: &str, colour, of: &dyn Fn(&Compared) -> f64| {
        Layer::line(legend, colour, Stroke::Thin, joined(&of_run, restarts, |c| Some((km(c), of(c)))))
    };
    let band = joined(&of_run, restarts, |c| {
        let half = HALF_95 * c.floor.sqrt();
        Some((km(c), -half, half))
    });
    let kmh = |mps: f64| 3.6 * mps;
    let measured = of_run.iter().map(|c| (km(c), kmh(c.measured_mps))).collect();
    let speeds = [
        sections(answer),
        line("simulated before", BEFORE, &|c| kmh(c.measured_mps + c.before_mps)),
        line("simulated after", AFTER, &|c| kmh(c.measured_mps + c.after_mps)),
        Layer::dots("measured", colours::MEASURED, 0.7, measured),
    ];
    let errors = [
        Layer::band("95 % of noise", colours::LIMIT, 0.15, band),
        line("before", BEFORE, &|c| c.before_mps),
        line("after", AFTER, &|c| c.after_mps),
    ];
    let figure = Figure::new(
        format!("Hold-out run {}", name(answer, run)),
        "Measured and simulated speed over location, and their difference",
        "location, km",
        range_of(of_run.iter().map(|c| km(c))),
        [
            Panel::new("speed, km/h", 360, speeds, NOTHING_COMPARED),
            Panel::new("simulated \u{2212} measured, m/s", 300, errors, NOTHING_COMPARED),
        ],
    );
    Some(figure.into())
}
