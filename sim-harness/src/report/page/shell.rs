//! The shell of a page and the words around its pictures: no script, no style sheet, no font, no address.

use super::super::colours;
use super::super::numbers::percent;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use rundown::Real;
use rundown::regime::Regime;

const STYLE: &str = include_str!("../style.css");

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

pub(super) fn swatch(regime: Regime) -> Markup {
    let colour = colours::css(colours::of_regime(regime));
    html! { span.swatch style=(format!("background:{colour}")) {} }
}

pub(super) fn signed_percent(share: Real) -> String {
    let sign = if share > 0.0 { "+" } else { "" };
    format!("{sign}{}", percent(share))
}
