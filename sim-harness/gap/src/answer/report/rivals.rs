//! Who else was tried in the place of each effect.

use crate::answer::{rivals::Rival, whole::Answer};
use crate::named::Named;
use crate::wording::plain;
use maud::{Markup, html};
use rundown_pages::numbers::number;
use rundown_pages::shell::{column, table, text_column};

/// A table of all rivals; nothing where no effect has any.
pub(super) fn rivals(answer: &Answer) -> Markup {
    let each = answer.found.named.iter().zip(&answer.rivals);
    let each: Vec<(&Named, &Vec<Rival>)> = each.filter(|(_, r)| !r.is_empty()).collect();
    if each.is_empty() {
        return html! {};
    }
    let (near, far) = (answer.config.certainty.rival_within, answer.config.certainty.ruled_out);
    let verdict = |worse: f64| match worse {
        w if w < near => "not distinguishable",
        w if w < far => "less likely",
        _ => "ruled out",
    };
    let digits = |worse: f64| number(worse, if worse.abs() < 100.0 { 1 } else { 0 });
    let head = [
        text_column("effect found"),
        text_column("in its place"),
        column("worse by", "log-likelihood"),
        text_column("so it is"),
    ];
    let rows = html! {
        @for (one, rivals) in &each {
            @for (i, rival) in rivals.iter().enumerate() { tr {
                @if i == 0 { th scope="row" rowspan=(rivals.len()) style="vertical-align: top" { (plain(one.effect.name())) } }
                td.text { (plain(rival.name)) }
                td { (digits(rival.worse)) }
                td.text { (verdict(rival.worse)) }
            } }
        }
    };
    html! {
        h3 { "Rivals" }
        (table(head, rows))
        p.small {
            "Every other candidate was fitted in the place of the effect, beside the other effects; one that would be too small to matter there is not listed. The number is the log-likelihood that is lost, the penalty of each one's freedom included: "
            "with 3 the effect found is 20 times more likely than its rival, with 7 a thousand times. " em { "Unknown" } " stands for a section or a law without a name."
        }
    }
}
