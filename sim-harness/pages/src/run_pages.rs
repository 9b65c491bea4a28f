//! A page for each run in a folder beside the page of all, which is read only when the reader goes there: a thousand
//! runs open at once.

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

/// Letters at the end of a long name that are always seen: names of one recorder often differ there only.
const TAIL: usize = 10;
/// Shorter names stand whole.
const LONG: usize = 24;

/// A run's name in the table of all, as a link where it has a page.
pub fn linked(run: &str, index: usize, has_page: bool) -> Markup {
    html! { @if has_page { a href=(file(index)) { (one_line(run)) } } @else { (one_line(run)) } }
}

/// A name in one line: of a long one the middle gives way where there is no room, and all of it is under the cursor.
pub fn one_line(name: &str) -> Markup {
    let letters = name.chars().count();
    if letters <= LONG {
        return html! { (name) };
    }
    let tail = name.char_indices().nth(letters - TAIL).map_or(0, |(at, _)| at);
    let (head, tail) = name.split_at(tail);
    html! { span.name title=(name) { span { (head) } span { (tail) } } }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_name_has_a_head_that_gives_way_and_a_tail_that_stays() {
        assert_eq!(linked("run001", 0, true).into_string(), "<a href=\"report/run0001.html\">run001</a>");
        let long = "EMU_4711_Gro\u{df}-Kleinstadt_2025-01-31T10_34_56\u{fc}\u{df}_up";
        let text = linked(long, 0, false).into_string();
        assert!(text.contains(&format!("title=\"{long}\"")), "{text}");
        assert!(text.ends_with("<span>34_56\u{fc}\u{df}_up</span></span>"), "{text}");
    }
}
