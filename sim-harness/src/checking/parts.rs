//! What the first page of a check and those of its runs have in common.

use maud::{Markup, html};
use rundown_check::figure::Figure;
use rundown_check::finding::{Done, Finding, Kind};
use rundown_pages::numbers::{NOTHING, number};
use rundown_pages::shell::{column, prose, table, text_column};
use std::collections::BTreeMap;

/// How a recorder is called: without an index there is one, without a name.
pub(super) fn called(unit: &str) -> &str {
    if unit.is_empty() { "the recorder" } else { unit }
}

/// `0.99 to 1.01`.
pub(super) fn interval(value: Option<Figure>, decimals: usize) -> String {
    match value.map(|value| value.interval()) {
        Some([low, high]) => format!("{} to {}", number(low, decimals), number(high, decimals)),
        None => NOTHING.to_owned(),
    }
}

/// What was found, a row each; nothing says so.
pub(super) fn findings(findings: &[Finding], evidence: &BTreeMap<Kind, String>) -> Markup {
    if findings.is_empty() {
        return html! { p { "Nothing was found." } };
    }
    let head = [
        text_column("found"),
        text_column("done"),
        column("how much", "95 % interval"),
        column("times", ""),
        column("from line", ""),
        text_column("what says so"),
        text_column("what helps"),
    ];
    let rows = html! { @for finding in findings { tr {
        th scope="row" { (finding.kind.words()) }
        td.word { strong class=(class(finding.done)) { (finding.done.words()) } }
        td { (finding.how_much().replace('-', "\u{2212}")) }
        td { (finding.count) }
        td { @if finding.line > 0 { (finding.line) } @else { "all" } }
        td.text { (prose(evidence.get(&finding.kind).map_or(NOTHING, String::as_str))) }
        td.text { (prose(finding.kind.remedy().unwrap_or(NOTHING))) }
    } } };
    table(head, rows)
}

const fn class(done: Done) -> &'static str {
    match done {
        Done::PutRight => "good",
        Done::LeftOut | Done::Refused => "bad",
        Done::Said => "dim",
    }
}
