//! `report.html` of `rundown gap`: for a railway engineer who reads from top to bottom.
//!
//! | module | part of the page |
//! |---|---|
//! | `words` | the verdict in sentences |
//! | `maps` | residuals over location, speed, ..., with what the effects explain |
//! | `law`, `axis` | each effect's law through the mean residuals |
//! | `rivals` | who else was tried, and how much worse it fits |
//! | `limits` | effort over the believed limit, where a limit was found |
//! | `held_out` | simulated speed before and after, on runs that took no part |
//! | `journeys` | running time and energy before and after, on the same runs |
//! | `tables` | evidence, effects, gap |
//! | `caveats` | what the numbers rest on, and how a name can be wrong |
//!
//! In: a [`Page`], which borrows what the workflow has. Out: one HTML file that needs nothing else.

mod axis;
mod binned;
mod caveats;
mod held_out;
mod journeys;
mod law;
mod limits;
mod maps;
mod rivals;
mod tables;
mod values;
mod words;

use super::answer::Answer;
use super::explained::explained;
use super::notes::NO_ROWS;
use super::rows::Believed;
use super::runs::Run;
use super::workflow::Investigation;
use maud::html;
use rundown_pages::shell::{document, figure};

/// What is told.
#[derive(Clone, Copy, Debug)]
pub struct Page<'a> {
    /// All that is told.
    pub answer: Answer<'a>,
    /// What came of them.
    pub found: &'a Investigation,
    /// The believed model.
    pub believed: Believed<'a>,
    /// The runs, as analysed.
    pub runs: &'a [Run],
}

/// The whole page.
pub fn page(page: &Page<'_>) -> String {
    let found = page.found;
    let explained = explained(&page.believed, &found.named, page.runs, &found.findings.rows);
    let body = html! {
        @for sentence in words::verdict(page) { p.lead { (sentence) } }
        p.small { (page.runs.len()) " runs of " (page.answer.dataset) ". Verdict in one word: " code { (found.verdict()) } "." }
        section {
            h2 { "Where simulation and measurement disagree" }
            p { "The residual is the resistance that the believed model lacks: effort less acceleration less believed resistance and gradient, mean over about 10 s. Where the model is right it is zero but for noise." }
            @if found.findings.rows.is_empty() {
                p { (NO_ROWS) }
            } @else {
                @for (svg, caption) in maps::maps(page, &explained) { (figure(svg, &caption)) }
                (tables::evidence(found))
            }
        }
        section {
            h2 { "What is missing in the model" }
            (tables::effects(found))
            @for (svg, caption) in law::laws(page, &explained) { (figure(svg, &caption)) }
            @if let Some((svg, caption)) = limits::limits(page) { (figure(svg, &caption)) }
            (rivals::rivals(page))
        }
        section {
            h2 { "Before and after, on held-out runs" }
            (tables::gap(page))
            @for (svg, caption) in held_out::held_out(page) { (figure(svg, &caption)) }
            (journeys::journeys(page))
        }
        section {
            h2 { "What this rests on" }
            (caveats::caveats(page))
        }
    };
    document("Where the model and the train disagree", &body)
}
