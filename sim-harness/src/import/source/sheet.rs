//! Excel and OpenDocument sheets, as the same rows of text.

use super::row::{self, Each, Event, Header, Layout, RowField};
use calamine::{Data, Range, Reader, open_workbook_auto};
use rundown_files::refusal::ReadError;
use std::path::Path;

const MOST_PREAMBLE: usize = 400;

fn text(cell: &Data) -> String {
    match field(cell) {
        RowField::Empty => String::new(),
        RowField::Text(text) => text,
        RowField::Number(number) => number.to_string(),
    }
}

/// Dates become text, as a person would see them; times of the day too.
fn field(cell: &Data) -> RowField {
    match cell {
        Data::Empty | Data::Error(_) => RowField::Empty,
        Data::Int(number) => RowField::Number(*number as f64),
        Data::Float(number) => RowField::Number(*number),
        Data::Bool(is) => RowField::Number(f64::from(u8::from(*is))),
        Data::String(text) | Data::DateTimeIso(text) | Data::DurationIso(text) if text.trim().is_empty() => {
            RowField::Empty
        }
        Data::String(text) | Data::DateTimeIso(text) | Data::DurationIso(text) => RowField::Text(text.clone()),
        Data::DateTime(time) => {
            let (year, month, day, hour, minute, second, milli) = time.to_ymd_hms_milli();
            let of_day = format!("{hour:02}:{minute:02}:{second:02}.{milli:03}");
            let is_day = (0.0..1.0).contains(&time.as_f64()) || time.is_duration();
            RowField::Text(if is_day { of_day } else { format!("{year:04}-{month:02}-{day:02}T{of_day}") })
        }
    }
}

fn range(path: &Path, sheet: &str) -> Result<Range<Data>, ReadError> {
    let mut book = open_workbook_auto(path).map_err(|error| row::refused(path, error.to_string()))?;
    book.worksheet_range(sheet).map_err(|error| row::refused(path, error.to_string()))
}

pub fn open(path: &Path, wanted: &Layout, named: &[String]) -> Result<(Layout, Vec<Header>), ReadError> {
    let book = open_workbook_auto(path).map_err(|error| row::refused(path, error.to_string()))?;
    let names = book.sheet_names();
    let tried: Vec<&String> =
        names.iter().filter(|name| wanted.sheet.as_ref().is_none_or(|sheet| sheet == *name)).collect();
    let mut best: Option<(usize, usize, &String, Vec<Vec<String>>)> = None;
    for name in tried {
        let head: Vec<Vec<String>> =
            range(path, name)?.rows().take(MOST_PREAMBLE).map(|row| row.iter().map(text).collect()).collect();
        let found = match wanted.header_line {
            Some(line) => Some(((line as usize).saturating_sub(1), 0)).filter(|(index, _)| *index < head.len()),
            None => row::header_among(&head, named),
        };
        if let Some((index, known)) = found
            && best.as_ref().is_none_or(|best| known > best.1)
        {
            best = Some((index, known, name, head));
        }
    }
    let Some((index, _, sheet, head)) = best else {
        return Err(row::refused(
            path,
            format!("expected a sheet with names of columns, found none among {}", names.join(", ")),
        ));
    };
    let mut headers: Vec<Header> = head[index].iter().map(|text| Header::new(text)).collect();
    if let Some(units) = head.get(index + 1).and_then(|row| row::units_below(row)) {
        headers.iter_mut().zip(units).for_each(|(header, unit)| header.unit = header.unit.take().or(unit));
    }
    let layout = Layout {
        sheet: Some(sheet.clone()),
        header_line: Some(index as u64 + 1),
        decimal: wanted.decimal.or(Some('.')),
        ..wanted.clone()
    };
    Ok((layout, headers))
}

pub fn rows(path: &Path, layout: &Layout, each: &mut Each) -> Result<(), ReadError> {
    let range = range(path, layout.sheet.as_deref().unwrap_or_default())?;
    // Rows above the first one with content are not in the range.
    let above = range.start().map_or(0, |(row, _)| u64::from(row));
    let header = layout.header_line.unwrap_or(1) as usize;
    for (index, cells) in range.rows().enumerate().skip(header) {
        let texts: Vec<String> = cells.iter().map(text).collect();
        if index == header && row::units_below(&texts).is_some() {
            continue;
        }
        let fields: Vec<RowField> = cells.iter().map(field).collect();
        if !each(Event::Row(above + index as u64 + 1, &fields)) {
            break;
        }
    }
    Ok(())
}
