//! A page for each run in a folder beside the page of all, which is read only when the reader goes there: a thousand runs open at once.

use crate::shell::{Script, Section, document_with};
use maud::{Markup, html};

/// Folder of the pages, beside `report.html`.
pub const FOLDER: &str = "report";
/// Name of the script in that folder, which holds [`crate::assets::SCRIPT`]: the pages share it.
pub const SCRIPT_FILE: &str = "pages.js";

/// Name of a run's page, counted from 0: names of runs may hold what links cannot.
pub fn name(index: usize) -> String {
    format!("run{:04}.html", index + 1)
}

/// The same from the folder of `report.html`.
pub fn file(index: usize) -> String {
    format!("{FOLDER}/{}", name(index))
}

/// Where a run stands among the others.
#[derive(Clone, Copy, Debug)]
pub struct Neighbours<'a> {
    /// Its number, from 0.
    pub index: usize,
    /// Link to the table of all runs, and its words.
    pub all: (&'a str, &'a str),
    /// Name of the run before it.
    pub before: Option<&'a str>,
    /// Name of the run after it.
    pub next: Option<&'a str>,
}

/// The page of a run of this name: what stands before its first section, its sections.
pub fn page(run: &str, neighbours: &Neighbours, lead: &Markup, sections: &[Section]) -> String {
    let Neighbours { index, all: (link, words), before, next } = *neighbours;
    let to = |word: &str, index: Option<usize>, run: Option<&str>| {
        html! { @if let Some((index, run)) = index.zip(run) { " \u{b7} " a href=(name(index)) { (word) ": " (run) } } }
    };
    let lead = html! {
        p { a href=(link) { (words) } (to("before", index.checked_sub(1), before)) (to("next", Some(index + 1), next)) }
        (lead)
    };
    document_with(Script::Beside(SCRIPT_FILE), run, &lead, sections)
}

/// A run's name in the table of all, as a link where it has a page.
pub fn linked(run: &str, index: usize, has_page: bool) -> Markup {
    html! { @if has_page { a href=(file(index)) { (run) } } @else { (run) } }
}
