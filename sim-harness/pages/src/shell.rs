//! The shell of a page and the words around its pictures: one HTML file that asks for no address.
//!
//! A page has its script within, but for pages of a folder that share one file. Without scripts it shows the same,
//! standing still.

use crate::assets::{SCRIPT, STYLE};
use crate::chart::Drawing;
use crate::{colours, numbers::percent};
use maud::{DOCTYPE, Markup, PreEscaped, html};
use rundown::{Real, tick::regime::Regime};

/// A part of a page with its place in the contents.
#[derive(Clone, Debug)]
pub struct Section {
    /// What links name.
    pub id: String,
    /// Its heading.
    pub heading: String,
    /// What stands below.
    pub body: Markup,
}

impl Section {
    /// A part of a page.
    pub fn new(id: impl Into<String>, heading: impl Into<String>, body: Markup) -> Self {
        Self { id: id.into(), heading: heading.into(), body }
    }
}

/// Where a page has its script.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Script {
    /// Within: the file needs nothing else.
    Within,
    /// In a file of this name beside it, which holds [`SCRIPT`].
    Beside(&'static str),
}

/// A whole page in one file: its title, what stands before the contents' first section, its sections.
pub fn document(title: &str, lead: &Markup, sections: &[Section]) -> String {
    document_with(Script::Within, title, lead, sections)
}

/// The same with its script elsewhere.
pub fn document_with(script: Script, title: &str, lead: &Markup, sections: &[Section]) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="generator" content="rundown";
                title { (title) }
                style { (PreEscaped(STYLE)) }
                @match script {
                    Script::Within => script { (PreEscaped(SCRIPT)) },
                    Script::Beside(name) => script src=(name) {},
                }
            }
            body {
                header { h1 { (title) } }
                @if sections.len() > 1 {
                    nav.contents aria-label="Contents" { ol {
                        @for Section { id, heading, .. } in sections { li { a href=(format!("#{id}")) { (heading) } } }
                    } }
                }
                main {
                    (lead)
                    @for Section { id, heading, body } in sections {
                        section id=(id) { h2 { (heading) } (body) }
                    }
                }
            }
        }
    };
    page.into_string()
}

/// A picture with its words below, as SVG and with the data of its live form.
pub fn figure(drawing: &Drawing, caption: &str) -> Markup {
    html! {
        figure.picture {
            div.wide.static { (PreEscaped(drawing.to_svg())) }
            script type="application/json" { (PreEscaped(drawing.live())) }
            figcaption { (caption) }
        }
    }
}

/// A table that scrolls where the screen is too narrow: the cells of its head, its rows.
pub fn table(head: impl IntoIterator<Item = Markup>, rows: Markup) -> Markup {
    html! { div.wide { table { thead { tr { @for cell in head { (cell) } } } tbody { (rows) } } } }
}

/// A [`table`] whose rows the reader may sort and filter.
pub fn sortable(head: impl IntoIterator<Item = Markup>, rows: Markup) -> Markup {
    html! { div.wide { table.sortable { thead { tr { @for cell in head { (cell) } } } tbody { (rows) } } } }
}

/// Head of a column of numbers, with its unit unless that is empty.
pub fn column(name: &str, unit: &str) -> Markup {
    html! { th scope="col" { (name) @if !unit.is_empty() { br; span.unit { (unit) } } } }
}

/// Head of a column of words.
pub fn text_column(name: &str) -> Markup {
    html! { th.text scope="col" { (name) } }
}

/// Head of a column of a few words, one of which the reader may choose in a [`sortable`] table.
pub fn choice_column(name: &str) -> Markup {
    html! { th.text scope="col" data-choices=(name) { (name) } }
}

/// A square of the regime's colour, with its name.
pub fn swatch(regime: Regime) -> Markup {
    let colour = colours::css(colours::of_regime(regime));
    html! { span.swatch style=(format!("background:{colour}")) {} }
}

/// A message as it stands on the screen: what is in backticks there is code here.
pub fn prose(text: &str) -> Markup {
    // A single one opens nothing.
    if text.matches('`').count() % 2 == 1 {
        return html! { (text) };
    }
    html! { @for (at, part) in text.split('`').enumerate() { @if at % 2 == 1 { code { (part) } } @else { (part) } } }
}

/// Per cent with a sign.
pub fn signed_percent(share: Real) -> String {
    let sign = if share > 0.0 { "+" } else { "" };
    format!("{sign}{}", percent(share))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_in_backticks_is_code_and_a_lonely_one_stays() {
        let said = |text: &str| prose(text).into_string();
        assert_eq!(said("use `a <b>` or `c`"), "use <code>a &lt;b&gt;</code> or <code>c</code>");
        assert_eq!(said("no `code"), "no `code");
    }
}
