//! Excel and OpenDocument sheets, as the same rows of text.

use super::heading;
use super::row::{self, Each, Event, Header, Layout, RowField};
use calamine::{Data, Range, Reader, SheetType, open_workbook_auto};
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
        Data::Empty => RowField::Empty,
        Data::Error(error) => RowField::Text(error.to_string()),
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

/// The sheets of a workbook.
#[derive(Clone, Debug, Default)]
pub struct Sheets {
    /// Those that are read, one after the other: they have one header.
    read: Vec<Sheet>,
    /// Those that are not.
    others: Vec<String>,
    /// A person said which one is to be read.
    is_chosen: bool,
}

#[derive(Clone, Debug)]
struct Sheet {
    name: String,
    /// Index of its header among the rows.
    header: usize,
}

impl Sheets {
    /// What a preview says of them; nothing of a file without sheets.
    pub fn words(&self) -> Option<String> {
        let read: Vec<&str> = self.read.iter().map(|sheet| sheet.name.as_str()).collect();
        let others = self.others.join(", ");
        let not_read = if others.is_empty() { String::new() } else { format!(" (not read: {others})") };
        let one_or_more = if read.len() == 1 { "sheet" } else { "sheets" };
        (!read.is_empty()).then(|| format!("{one_or_more} {}{not_read}", read.join(", ")))
    }

    /// Why each of the others is not read, where nobody asked for that.
    pub fn lost(&self) -> impl Iterator<Item = String> {
        let first = self.read.first().map_or("", |sheet| &sheet.name);
        let others = self.others.iter().filter(|_| !self.is_chosen);
        others.map(move |other| format!("expected the columns of the sheet {first:?}, found others in {other:?}"))
    }
}

/// A sheet that may be read.
struct Headed {
    sheet: Sheet,
    /// Names of its header that are known.
    known: usize,
    headers: Vec<Header>,
}

/// The header of a sheet, where it has one, and whether it looks like a table at all.
fn headed(path: &Path, name: &str, wanted: &Layout, named: &[String]) -> Result<(Option<Headed>, bool), ReadError> {
    let range = range(path, name)?;
    let head: Vec<Vec<String>> = range.rows().take(MOST_PREAMBLE).map(|row| row.iter().map(text).collect()).collect();
    let stated = wanted.header_line.map(|line| (line as usize).saturating_sub(1));
    let stated = stated.filter(|index| head.get(*index).is_some_and(|row| may_be_header(row, named)));
    let found = match stated {
        Some(index) => Some((index, heading::known_in(&head[index], named))),
        None => heading::header_among(&head, named).filter(|_| wanted.header_line.is_none() || !named.is_empty()),
    };
    let headed = found.map(|(header, known)| {
        let mut headers: Vec<Header> = head[header].iter().map(|text| Header::new(text)).collect();
        if let Some(units) = head.get(header + 1).and_then(|row| heading::units_below(row)) {
            headers.iter_mut().zip(units).for_each(|(header, unit)| header.unit = header.unit.take().or(unit));
        }
        while headers.pop_if(|last| last.written.is_empty()).is_some() {}
        Headed { sheet: Sheet { name: name.to_owned(), header }, known, headers }
    });
    Ok((headed, range.height() > 1 && range.width() > 1))
}

/// Another sheet may have a longer preamble than the one whose line was stated.
fn may_be_header(row: &[String], named: &[String]) -> bool {
    let is_named = |text: &String| named.iter().any(|name| name.trim() == text.trim() || name.starts_with('#'));
    named.is_empty() || row.iter().any(is_named)
}

/// The sheet whose header is known best, and with it those of the same header.
pub fn open(path: &Path, wanted: &Layout, named: &[String]) -> Result<(Layout, Vec<Header>, Sheets), ReadError> {
    let book = open_workbook_auto(path).map_err(|error| row::refused(path, error.to_string()))?;
    // Charts may be sheets, too.
    let tables = book.sheets_metadata().iter().filter(|sheet| sheet.typ == SheetType::WorkSheet);
    let names: Vec<&str> = tables.map(|sheet| sheet.name.as_str()).collect();
    let mut sheets = Sheets { is_chosen: wanted.sheet.is_some(), ..Sheets::default() };
    let mut with_header = Vec::new();
    for name in &names {
        if wanted.sheet.as_ref().is_some_and(|sheet| sheet != name) {
            sheets.others.push((*name).to_owned());
            continue;
        }
        match headed(path, name, wanted, named)? {
            (Some(headed), _) => with_header.push(headed),
            (None, true) => sheets.others.push((*name).to_owned()),
            (None, false) => (),
        }
    }
    // Of several that are known alike the first.
    let best = with_header.iter().rev().max_by_key(|headed| headed.known);
    let Some((header, headers)) = best.map(|best| (best.sheet.header, best.headers.clone())) else {
        let expected = format!("expected a sheet with names of columns, found none among {}", names.join(", "));
        return Err(row::refused(path, expected));
    };
    for Headed { sheet, headers: own, .. } in with_header {
        if own == headers { sheets.read.push(sheet) } else { sheets.others.push(sheet.name) }
    }
    let layout = Layout { header_line: Some(header as u64 + 1), ..wanted.clone() };
    Ok((layout, headers, sheets))
}

pub fn rows(path: &Path, sheets: &Sheets, each: &mut Each) -> Result<(), ReadError> {
    for sheet in &sheets.read {
        let goes_on = sheets.read.len() == 1 || each(Event::Sheet(&sheet.name));
        if !goes_on || !rows_of(path, sheet, each)? {
            break;
        }
    }
    Ok(())
}

/// The rows of one sheet; false: no more of them.
fn rows_of(path: &Path, sheet: &Sheet, each: &mut Each) -> Result<bool, ReadError> {
    let range = range(path, &sheet.name)?;
    // Rows above the first one with content are not in the range.
    let above = range.start().map_or(0, |(row, _)| u64::from(row));
    let first = sheet.header + 1;
    for (index, cells) in range.rows().enumerate().skip(first) {
        let texts: Vec<String> = cells.iter().map(text).collect();
        if index == first && heading::units_below(&texts).is_some() {
            continue;
        }
        let fields: Vec<RowField> = cells.iter().map(field).collect();
        if !each(Event::Row(above + index as u64 + 1, &fields)) {
            return Ok(false);
        }
    }
    Ok(true)
}
