//! The runs of a tuning: how likely each is with Table 1 and with the optimum, and a page of each as the tuned filter
//! saw it.

use super::parameters::Place;
use super::score::{Bench, FilterScore};
use crate::report::{Report, RunView, TruthView, begin_run_pages, write_run_pages};
use crate::study::Refused;
use maud::{Markup, html};
use rundown::estimator::{Estimator, config::Config};
use rundown_files::recording::Recording;
use rundown_files::replay::{Tick, replay_apart_by};
use rundown_pages::numbers::number;
use rundown_pages::run_pages;
use rundown_pages::shell::{column, sortable, text_column};
use std::path::Path;

/// Of the page of all runs, and of those of single ones.
pub const TITLE: &str = "Tuning of the paper's filter";
/// Runs that are in memory at a time with what is drawn of them.
const CHUNK: usize = 256;

/// A filter is not tuned on fewer rows of a train that moves.
pub const LEAST_MOVING_ROWS: usize = 10;
/// Slower is standing, m/s.
const MOVING_MPS: f64 = 1.0;

/// The run has enough rows of a moving train.
pub fn moves(run: &Recording) -> bool {
    let moving = run.rows.iter().filter(|row| row.speed_mps.is_some_and(|mps| mps > MOVING_MPS));
    moving.take(LEAST_MOVING_ROWS).count() == LEAST_MOVING_ROWS
}

/// A run with its score by Table 1 and by the optimum.
#[derive(Clone, Debug)]
pub struct ScoredRun {
    name: String,
    scores: [FilterScore; 2],
}

/// All runs; none where one of the two places is no filter.
pub fn scored(bench: &Bench, places: [&Place; 2]) -> Option<Vec<ScoredRun>> {
    let [table1, optimum] = places.map(|place| bench.scores(place));
    let scores = table1?.into_iter().zip(optimum?);
    let names = bench.runs.iter().map(|run| run.name.clone());
    Some(names.zip(scores).map(|(name, (table1, optimum))| ScoredRun { name, scores: [table1, optimum] }).collect())
}

/// The table of the page.
pub fn table(runs: &[ScoredRun], has_run_pages: bool) -> Markup {
    let head = [
        text_column("run"),
        column("samples", "with a likelihood"),
        column("log-likelihood, Table 1", "a sample"),
        column("log-likelihood, optimum", "a sample"),
        column("negative coefficient, optimum", "samples"),
    ];
    let rows = html! { @for (index, run) in runs.iter().enumerate() { @let [table1, optimum] = &run.scores; tr {
        th scope="row" { (run_pages::linked(&run.name, index, has_run_pages)) }
        td { (optimum.samples) }
        td { (number(table1.per_sample(), 3)) }
        td { (number(optimum.per_sample(), 3)) }
        td { (optimum.negative_samples) }
    } } };
    html! {
        @if has_run_pages { p { "The page of a run shows it as the tuned filter sees it." } }
        (sortable(head, rows))
    }
}

/// Writes a page for each run, with the truth of those that have one.
pub fn write_pages(folder: &Path, bench: &Bench, truths: &[Option<TruthView>], tuned: &Config) -> Result<(), Refused> {
    let estimator = Estimator::try_new(*tuned, bench.train, bench.track.clone())?;
    begin_run_pages(folder)?;
    let name = |at: usize| bench.runs.get(at).map(|run| run.name.clone());
    for (number, chunk) in bench.runs.chunks(CHUNK).enumerate() {
        let first = number * CHUNK;
        let replayed = replay_apart_by(&|_| &estimator, chunk, Tick::EverySample, || ());
        let report = Report {
            title: TITLE.to_owned(),
            train: &bench.train,
            runs: replayed.iter().zip(&truths[first..]).map(|(run, truth)| RunView::of(run, truth.as_ref())).collect(),
            first,
            before: first.checked_sub(1).and_then(name),
            after: name(first + chunk.len()),
            has_run_pages: true,
            mode: tuned.mode,
            features: tuned.features,
            vehicles: Vec::new(),
            notes: &[],
            failed: &[],
        };
        write_run_pages(folder, &report)?;
    }
    Ok(())
}
