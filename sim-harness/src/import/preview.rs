//! What an import would do, before it does: columns with meaning and unit, the first rows, a picture.

use super::account::Account;
use super::analysis::Group;
use super::clock::ClockKind;
use super::meaning::Meaning;
use super::rows::Converter;
use super::source::row::{Event, RowField};
use rundown_files::sample::Sample;
use rundown_files::statistics::extremes;
use rundown_pages::chart::{Figure, Layer, Panel, standalone};
use rundown_pages::colours;
use serde::Serialize;

const ROWS_SHOWN: usize = 5;
const ROWS_DRAWN: usize = 20_000;

/// The columns and first rows of a group, as text.
pub fn words(group: &Group) -> String {
    let Some(source) = group.sources.first() else { return String::new() };
    let layout = &source.layout;
    let more = group.sources.len() - 1;
    let mut text = format!(
        "{}{}\n",
        source.path.display(),
        if more > 0 { format!(" and {more} more of this layout") } else { String::new() }
    );
    let said = |name: &str, value: Option<String>| value.map(|value| format!("{name} {value}"));
    let layout = [
        layout.format.as_ref().map(as_mapped),
        said("encoding", layout.encoding.clone()),
        said("delimiter", layout.delimiter.map(|c| format!("{c:?}"))),
        said("decimal", layout.decimal.map(|c| format!("{c:?}"))),
        said("header in line", layout.header_line.map(|line| line.to_string())),
        source.sheets.words(),
    ];
    text += &format!("  {}\n", layout.into_iter().flatten().collect::<Vec<_>>().join(", "));
    for (index, header) in source.headers.iter().enumerate() {
        let found = group.columns.of.iter().find(|(_, column)| column.index == index);
        let meaning = found.map_or_else(
            || "not used".to_owned(),
            |(meaning, column)| {
                let kind = if *meaning == Meaning::Time {
                    format!(" ({})", as_mapped(&group.columns.kind))
                } else {
                    String::new()
                };
                let unit = column.unit.map_or("", |unit| unit.name);
                // Clock times have no unit that could be unknown.
                let is_clock =
                    *meaning == Meaning::Time && !matches!(group.columns.kind, ClockKind::Number | ClockKind::Unix);
                let how = if is_clock { String::new() } else { column.how.words() };
                format!("{}{kind} {unit}  {how}", meaning.key())
            },
        );
        text += &format!("  {:<32} {}\n", header.written, meaning.trim_end());
    }
    text += "  first rows:\n";
    let mut left = ROWS_SHOWN;
    let read = source.rows(&mut |event| {
        if let Event::Row(line, fields) = event {
            text += &format!("  {line:>6}  {}\n", fields.iter().map(shown).collect::<Vec<_>>().join(" | "));
            left -= 1;
        }
        left > 0
    });
    if let Err(error) = read {
        text += &format!("  {error}\n");
    }
    text
}

/// A word as a mapping takes it: what the preview shows is what a person will write.
fn as_mapped(word: &impl Serialize) -> String {
    serde_json::to_value(word).ok().and_then(|word| word.as_str().map(str::to_owned)).unwrap_or_default()
}

fn shown(field: &RowField) -> String {
    match field {
        RowField::Empty => String::new(),
        RowField::Text(text) => text.clone(),
        RowField::Number(number) => number.to_string(),
    }
}

/// Speed over location, or over time where there is no location, as a file of its own.
pub fn picture(groups: &[Group]) -> String {
    let mut samples: Vec<Vec<Sample>> = Vec::new();
    for group in groups {
        for source in &group.sources {
            let mut rows = Vec::new();
            let (mut converter, mut unread) = (Converter::new(&source.path, &group.columns), Account::default());
            // A file that tears off is drawn as far as it goes; the words say why.
            let _ = source.rows(&mut |event| {
                if let Event::Row(line, fields) = event {
                    rows.extend(converter.record(line, fields, &mut unread).map(|record| record.sample));
                }
                rows.len() < ROWS_DRAWN
            });
            samples.push(rows);
        }
    }
    let by_place = samples.iter().flatten().any(|row| row.location_m.is_some());
    let line = |rows: &Vec<Sample>| {
        let begin_s = rows.first().map_or(0.0, |row| row.time_s);
        let x = |row: &Sample| {
            if by_place { row.location_m.map(|m| m / 1000.0) } else { Some((row.time_s - begin_s) / 60.0) }
        };
        rows.iter().map(|row| Some((x(row)?, 3.6 * row.speed_mps?))).collect::<Vec<_>>()
    };
    let lines: Vec<Vec<Option<(f64, f64)>>> = samples.iter().map(line).collect();
    let ends = extremes(lines.iter().flatten().flatten().map(|(x, _)| x));
    let x = if ends.0 < ends.1 { ends.0..ends.1 } else { 0.0..1.0 };
    let label = if by_place { "location / km" } else { "time / min" };
    let panel = Panel::new("speed / km/h", 560, [Layer::threads("", colours::MEASURED, 0.6, lines)], "no speeds");
    standalone(&Figure::new("Preview of an import", "Speeds as they would be imported", label, x, [panel]).to_svg())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::source::row::SourceFormat;

    #[test]
    fn kinds_and_formats_are_written_as_a_mapping_takes_them() {
        assert_eq!(as_mapped(&ClockKind::TimeOfDay), "time_of_day");
        assert_eq!(as_mapped(&ClockKind::Number), "number");
        assert_eq!(as_mapped(&SourceFormat::JsonLines), "json_lines");
    }
}
