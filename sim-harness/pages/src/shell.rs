//! The shell of a page and the words around its pictures: no script, no style sheet, no font, no address.

use crate::{colours, numbers::percent};
use maud::{DOCTYPE, Markup, PreEscaped, html};
use rundown::{Real, tick::regime::Regime};

const STYLE: &str = include_str!("style.css");

/// A whole page.
pub fn document(title: &str, body: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="generator" content="rundown";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body { main {
                h1 { (title) }
                (body)
            } }
        }
    };
    page.into_string()
}

/// A picture with its words below; it scrolls where the screen is too narrow to read it.
pub fn figure(svg: String, caption: &str) -> Markup {
    html! {
        figure {
            div.wide { (PreEscaped(svg)) }
            figcaption { (caption) }
        }
    }
}

/// A table that scrolls where the screen is too narrow: the cells of its head, its rows.
pub fn table(head: impl IntoIterator<Item = Markup>, rows: Markup) -> Markup {
    html! { div.wide { table { thead { tr { @for cell in head { (cell) } } } tbody { (rows) } } } }
}

/// Head of a column of numbers, with its unit unless that is empty.
pub fn column(name: &str, unit: &str) -> Markup {
    html! { th scope="col" { (name) @if !unit.is_empty() { br; span.unit { (unit) } } } }
}

/// Head of a column of words.
pub fn text_column(name: &str) -> Markup {
    html! { th.text scope="col" { (name) } }
}

/// A square of the regime's colour, with its name.
pub fn swatch(regime: Regime) -> Markup {
    let colour = colours::css(colours::of_regime(regime));
    html! { span.swatch style=(format!("background:{colour}")) {} }
}

/// Per cent with a sign.
pub fn signed_percent(share: Real) -> String {
    let sign = if share > 0.0 { "+" } else { "" };
    format!("{sign}{}", percent(share))
}
