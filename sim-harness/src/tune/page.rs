//! `report.html` of a tuning.

use super::parameters::{PARAMETERS, Place, values};
use super::runs::{self, ScoredRun, TITLE};
use super::{score::FilterScore, search::Minimum};
use crate::{study::figures::Picture, study::page::initial, study::slope::SlopeAnswer, study::trials::Sensitivity};
use maud::{Markup, html};
use rundown_pages::numbers::number;
use rundown_pages::shell::{Section, column, document, figure, table, text_column};

/// What came of a tuning; of two, Table 1 is the first and the optimum the second.
#[derive(Clone, Debug)]
pub struct Tuning {
    pub source: String,
    pub table1: Place,
    pub found: Minimum,
    pub scores: [FilterScore; 2],
    pub pictures: [Picture; 2],
    pub runs: Vec<ScoredRun>,
    pub has_run_pages: bool,
    /// The remark of section 4.2, with Table 1.
    pub sensitivity: Vec<Sensitivity>,
    /// Of the paper's mode.
    pub slopes: [SlopeAnswer; 2],
}

pub fn page(page: &Tuning) -> String {
    let lead = html! {
        p.lead {
            "The paper's filter, tuned on " (page.source) " by its two criteria: the summed logarithm of the conditional likelihood of location and speed, and coefficients that are not negative. "
            (page.found.evaluations) " configurations were tried by the simplex of Nelder and Mead."
        }
        @if let Some(caveat) = page.found.caveat() { p.note { strong { "No optimum yet. " } (caveat) "." } }
        (scores(page))
        (parameters(page))
        @let [table1, optimum] = &page.slopes;
            p.note {
                strong { "A likely filter is no true one. " }
                "Slope of estimated on true deviation of the resistance at 60 / 100 / 140 km/h after one run: Table 1 "
                (table1.slope.map(|v| number(v, 2)).join(" / ")) ", optimum "
                (optimum.slope.map(|v| number(v, 2)).join(" / "))
                ". The effort of the paper's loop is calculated from the resistance that it is to find; no choice of these parameters changes that. Error of r(v): "
                (number(table1.rmse_percent, 1)) "\u{a0}% and " (number(optimum.rmse_percent, 1)) "\u{a0}%."
            }
    };
    let surface = html! { @for picture in &page.pictures { (figure(&picture.drawing, &picture.caption)) } };
    let sensitivity = html! {
            p { "Section 4.2: two orders of magnitude more in one initial covariance give negative coefficients. Table 1 with larger initial deviations, on the same runs:" }
            (initial(&page.sensitivity))
    };
    let sections = [
        Section::new("surface", "The surface around the optimum", surface),
        Section::new("runs", "Runs", runs::table(&page.runs, page.has_run_pages)),
        Section::new("sensitivity", "Sensitivity to the initial covariances", sensitivity),
    ];
    document(TITLE, &lead, &sections)
}

fn scores(page: &Tuning) -> Markup {
    let [table1, optimum] = &page.scores;
    let rows = [("Table 1", table1), ("optimum", optimum)];
    let head = [
        text_column(""),
        column("log-likelihood", "all samples"),
        column("a sample", ""),
        column("samples with a negative coefficient", ""),
        column("repaired", "samples"),
    ];
    let rows = html! { @for (name, score) in rows { tr {
        th scope="row" { (name) }
        td { (number(score.log_likelihood, 0)) }
        td { (number(score.per_sample(), 3)) }
        td { (score.negative_samples) " of " (score.samples) }
        td { (score.repaired) }
    } } };
    table(head, rows)
}

fn parameters(page: &Tuning) -> Markup {
    let (table1, optimum) = (values(&page.table1), values(&page.found.place));
    let head = [text_column("parameter"), column("Table 1", ""), column("optimum", ""), text_column("unit")];
    let rows = html! { @for (index, parameter) in PARAMETERS.iter().enumerate() { tr {
        th scope="row" { (parameter.name) }
        td { (short(table1[index])) }
        td { (short(optimum[index])) }
        td.text { (parameter.unit) }
    } } };
    html! {
        (table(head, rows))
        p.small { "An acceleration noise at its lower bound means none. The configuration lies beside this page: "
            code { "rundown replay --config config.toml" } "." }
    }
}

/// Three digits, as a power of ten where the number is far from one.
pub fn short(value: f64) -> String {
    match value.abs() {
        size if value != 0.0 && !(1e-3..1e4).contains(&size) => format!("{value:.2e}"),
        _ => format!("{}", (value * 1e4).round() / 1e4),
    }
}
