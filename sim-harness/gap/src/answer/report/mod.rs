//! `report.html` of `rundown gap`: for a railway engineer who reads from top to bottom.
//!
//! | module | part of the page |
//! |---|---|
//! | `words` | the verdict in sentences |
//! | `maps` | residuals over location, speed, ..., with what the effects explain |
//! | `law` | each effect's law through the mean residuals |
//! | `rivals` | who else was tried, and how much worse it fits |
//! | `limits` | effort over the believed limit, where a limit was found |
//! | `held_out` | simulated speed before and after, on hold-out runs |
//! | `journeys` | running time and energy before and after, on the same runs |
//! | `tables` | evidence, effects, gap |
//! | `runs` | the table of runs, and a page for each |
//! | `caveats` | what the numbers rest on, and how a name can be wrong |
//! | `whiteness` | whether the noise fits |
//!
//! In: an [`Answer`]. Out: one HTML file that needs nothing else, and those of the runs.

mod binned;
mod caveats;
mod held_out;
mod journeys;
mod law;
mod limits;
mod maps;
mod rivals;
mod runs;
mod tables;
mod whiteness;
mod words;

use crate::answer::{notes::no_rows, whole::Answer};
use crate::explained::explained;
use maud::html;
use rundown_pages::numbers::counted;
use rundown_pages::shell::{Section, document, figure, prose};

/// Names of the pictures that [`picture`] knows.
pub const PICTURES: [&str; 4] = ["residual", "coordinates", "law", "before_after"];

/// One picture of the page as SVG: residuals over location, over the other coordinates, the law of the first effect,
/// the error of the simulated speed before and after. None where there is nothing to be drawn.
pub fn picture(answer: &Answer, name: &str) -> Option<String> {
    let found = &answer.found;
    let explained = || explained(&answer.context().believed, &found.named, &answer.input.runs, &found.findings.rows);
    let mut pictures = match name {
        "residual" | "coordinates" if found.findings.rows.is_empty() => Vec::new(),
        "residual" | "coordinates" => maps::maps(answer, &explained()),
        "law" => law::laws(answer, &explained()),
        "before_after" => held_out::held_out(answer),
        _ => Vec::new(),
    };
    let at = usize::from(name == "coordinates");
    (at < pictures.len()).then(|| pictures.swap_remove(at).0.to_svg())
}

/// The pages of the runs, in their order.
pub fn run_pages(answer: &Answer) -> Vec<String> {
    let found = &answer.found;
    let explained = explained(&answer.context().believed, &found.named, &answer.input.runs, &found.findings.rows);
    let rows = runs::by_run(answer, &explained);
    (0..answer.input.runs.len()).map(|index| runs::page(answer, &rows, index)).collect()
}

/// The whole page; `has_run_pages`: its table of runs leads to [`run_pages`].
pub fn page(answer: &Answer, has_run_pages: bool) -> String {
    let found = &answer.found;
    let context = answer.context();
    let explained = explained(&context.believed, &found.named, &answer.input.runs, &found.findings.rows);
    let lead = html! {
        p { (counted(answer.input.runs.len(), "run", "runs")) " of " (answer.input.dataset) ". Verdict: " strong { code { (found.verdict.name()) } } "." }
        @for sentence in words::verdict(answer) { p.lead { (prose(&sentence)) } }
    };
    let disagreement = html! {
            p { "The residual is the resistance that the believed model lacks: effort less acceleration less believed resistance and gradient, mean over about 10 s. Where the model is right it is zero but for noise." }
            @if found.findings.rows.is_empty() {
                p { (prose(no_rows(&found.findings))) }
            } @else {
                @for (drawing, caption) in maps::maps(answer, &explained) { (figure(&drawing, &caption)) }
                (tables::evidence(found))
            }
    };
    let missing = html! {
            (tables::effects(found))
            @for (drawing, caption) in law::laws(answer, &explained) { (figure(&drawing, &caption)) }
            @if let Some((drawing, caption)) = limits::limits(answer) { (figure(&drawing, &caption)) }
            (rivals::rivals(answer))
    };
    let compared = html! {
            (tables::gap(answer))
            @for (drawing, caption) in held_out::held_out(answer) { (figure(&drawing, &caption)) }
            (held_out::by_run(answer))
            (journeys::journeys(answer))
    };
    let rests_on = html! {
            (caveats::caveats(answer))
            @if let Some((drawing, caption)) = whiteness::whiteness(answer) { (figure(&drawing, &caption)) }
    };
    let sections = [
        Section::new("disagreement", "Where simulation and measurement disagree", disagreement),
        Section::new("missing", "What is missing in the model", missing),
        Section::new("before-and-after", "Before and after, on hold-out runs", compared),
        Section::new("runs", "Runs", runs::table(answer, &runs::by_run(answer, &explained), has_run_pages)),
        Section::new("caveats", "What this rests on", rests_on),
    ];
    document("Where the model and the train disagree", &lead, &sections)
}
