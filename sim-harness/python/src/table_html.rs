//! A table as notebooks show it: HTML with the first and the last rows.

use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, Int64Type};
use arrow_array::{Array, RecordBatch};
use arrow_schema::DataType;
use maud::{Markup, html};

/// Rows at each end that are shown; of a table with no more than both all are.
const ENDS: usize = 5;

/// The table, its size below. `head`: name, unit and meaning of each column.
pub fn page(head: &[[String; 3]], parts: &[RecordBatch]) -> String {
    let rows: usize = parts.iter().map(RecordBatch::num_rows).sum();
    let is_whole = rows <= 2 * ENDS;
    let first = 0..if is_whole { rows } else { ENDS };
    let last = if is_whole { rows..rows } else { rows - ENDS..rows };
    let page = html! {
        div style="overflow-x: auto" {
            table {
                thead { tr { @for [name, unit, meaning] in head {
                    th title=(meaning) { (name) @if !unit.is_empty() { br; small { (unit) } } }
                } } }
                tbody {
                    @for at in first { (row(parts, at)) }
                    @if !is_whole { tr { @for _ in head { td { "\u{2026}" } } } }
                    @for at in last { (row(parts, at)) }
                }
            }
        }
        p { (rows) " rows \u{d7} " (head.len()) " columns" }
    };
    page.into_string()
}

fn row(parts: &[RecordBatch], mut at: usize) -> Markup {
    let part = parts.iter().find(|part| {
        let is_here = at < part.num_rows();
        at -= if is_here { 0 } else { part.num_rows() };
        is_here
    });
    html! { tr { @for column in part.iter().flat_map(|part| part.columns()) { td { (cell(column, at)) } } } }
}

/// A number in six digits; nothing where the cell is empty.
fn cell(column: &dyn Array, at: usize) -> String {
    if column.is_null(at) {
        return String::new();
    }
    match column.data_type() {
        DataType::Utf8 => column.as_string::<i32>().value(at).to_owned(),
        DataType::Int64 => column.as_primitive::<Int64Type>().value(at).to_string(),
        _ => short(column.as_primitive::<Float64Type>().value(at)),
    }
}

fn short(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-3..1e6).contains(&size) {
        return format!("{value:.5e}");
    }
    let before = if size < 1.0 { 0 } else { size.log10() as usize };
    let text = format!("{value:.*}", 5 - before.min(5));
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}
