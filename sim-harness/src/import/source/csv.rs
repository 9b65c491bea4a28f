//! Tables as text: the encoding, the delimiter and the header are found in the first lines, the rows are streamed.

use super::heading;
use super::row::{self, Each, Event, Header, Layout, RowField};
use super::unpacked;
use crate::import::letters;
use encoding_rs_io::DecodeReaderBytesBuilder;
use rundown_files::refusal::ReadError;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

/// Bytes that decide the encoding, and characters that decide the rest.
const SNIFFED: usize = 1 << 18;
/// The header stands in one of so many lines.
const MOST_PREAMBLE: usize = 400;
const DELIMITERS: [char; 4] = [';', '\t', '|', ','];
/// A line longer than this is no line of a table; the reader must not hold a file without line ends.
const LONGEST_LINE: u64 = 1 << 20;

/// Encoding by the first bytes: a mark, zeros in every other byte, valid UTF-8, else Windows-1252, which holds Latin-1.
fn encoding_of(path: &Path) -> Result<&'static str, ReadError> {
    let mut head = Vec::new();
    unpacked::bytes(path)?.take(SNIFFED as u64).read_to_end(&mut head).map_err(|error| row::io(path, error))?;
    Ok(match head.as_slice() {
        [0xff, 0xfe, ..] => "utf-16le",
        [0xfe, 0xff, ..] => "utf-16be",
        head => {
            let zeros = |from: usize| head.iter().skip(from).step_by(2).filter(|byte| **byte == 0).count();
            let many = head.len() / 4;
            if zeros(1) > many {
                "utf-16le"
            } else if zeros(0) > many {
                "utf-16be"
            } else {
                match std::str::from_utf8(head) {
                    // Cut inside of a character.
                    Err(error) if error.error_len().is_some() => letters::ASSUMED,
                    _ => "utf-8",
                }
            }
        }
    })
}

/// Line ends of all computers become LF: the reader of tables counts the LF behind a CR with the row that follows.
struct Lines<R> {
    inner: R,
    has_cr_only: bool,
}

impl<R: Read> Read for Lines<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        loop {
            let length = self.inner.read(buffer)?;
            let mut kept = 0;
            for at in 0..length {
                match buffer[at] {
                    b'\r' if self.has_cr_only => buffer[kept] = b'\n',
                    b'\r' => continue,
                    byte => buffer[kept] = byte,
                }
                kept += 1;
            }
            // Nothing is the end of the file.
            if kept > 0 || length == 0 {
                return Ok(kept);
            }
        }
    }
}

fn reader(path: &Path, encoding: &str) -> Result<impl BufRead + use<>, ReadError> {
    let mut head = Vec::new();
    decoded(path, encoding)?.take(SNIFFED as u64).read_to_end(&mut head).map_err(|error| row::io(path, error))?;
    let has_cr_only = head.contains(&b'\r') && !head.contains(&b'\n');
    Ok(BufReader::new(Lines { inner: decoded(path, encoding)?, has_cr_only }))
}

fn decoded(path: &Path, encoding: &str) -> Result<impl Read + use<>, ReadError> {
    let label = encoding_rs::Encoding::for_label(encoding.as_bytes()).ok_or_else(|| {
        row::refused(
            path,
            format!("encoding: expected a name such as utf-8, utf-16le or windows-1252, found {encoding:?}"),
        )
    })?;
    Ok(DecodeReaderBytesBuilder::new().encoding(Some(label)).strip_bom(true).build(unpacked::bytes(path)?))
}

/// Quotes are around fields where each line of the head has pairs of them; a single one is an inch.
fn has_quoted_fields(path: &Path, encoding: &str) -> Result<bool, ReadError> {
    let mut head = Vec::new();
    reader(path, encoding)?.take(SNIFFED as u64).read_to_end(&mut head).map_err(|error| row::io(path, error))?;
    let mut lines: Vec<&[u8]> = head.split(|byte| *byte == b'\n').collect();
    // The last one may be cut.
    let last = lines.pop().filter(|_| head.len() < SNIFFED);
    let quotes = |line: &[u8]| line.iter().filter(|byte| **byte == b'"').count();
    Ok(lines.into_iter().chain(last).all(|line| quotes(line) % 2 == 0))
}

/// Lines as text; a byte that is no character is replaced.
pub fn lines(path: &Path, each: &mut dyn FnMut(u64, &str) -> bool) -> Result<(), ReadError> {
    let mut reader = reader(path, encoding_of(path)?)?;
    let mut line = Vec::new();
    for number in 1.. {
        line.clear();
        let length =
            reader.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut line).map_err(|error| row::io(path, error))?;
        if length == 0 || !each(number, String::from_utf8_lossy(&line).trim_end_matches(['\n', '\r'])) {
            break;
        }
    }
    Ok(())
}

fn table(delimiter: char) -> ::csv::ReaderBuilder {
    let mut builder = ::csv::ReaderBuilder::new();
    builder.delimiter(delimiter as u8).has_headers(false).flexible(true).trim(::csv::Trim::All);
    builder
}

fn fields(line: &str, delimiter: char) -> Vec<String> {
    let mut reader = table(delimiter).from_reader(line.as_bytes());
    let record = reader.records().next().and_then(Result::ok);
    record.map(|record| record.iter().map(str::to_owned).collect()).unwrap_or_default()
}

/// Finds the layout and the header.
pub fn open(path: &Path, wanted: &Layout, named: &[String]) -> Result<(Layout, Vec<Header>), ReadError> {
    let mut layout = wanted.clone();
    let encoding = wanted.encoding.clone().map_or_else(|| encoding_of(path).map(str::to_owned), Ok)?;
    let mut reader = reader(path, &encoding)?;
    let mut head = Vec::new();
    reader.by_ref().take(SNIFFED as u64).read_to_end(&mut head).map_err(|error| row::io(path, error))?;
    let head = String::from_utf8_lossy(&head).into_owned();
    let lines: Vec<&str> = head.lines().take(MOST_PREAMBLE).collect();
    layout.encoding = Some(encoding);
    let tried: Vec<char> = wanted.delimiter.map_or_else(|| DELIMITERS.to_vec(), |one| vec![one]);
    if let Some(delimiter) = tried.iter().find(|delimiter| !delimiter.is_ascii()) {
        return Err(row::refused(path, format!("delimiter: expected an ASCII character, found {delimiter:?}")));
    }
    let (delimiter, rows, index) = header_of(path, &lines, &tried, wanted.header_line, named)?;
    layout.delimiter = Some(delimiter);
    let Some(header) = rows.get(index) else {
        return Err(row::refused(
            path,
            format!("header_line: expected a line of the first {}, found {}", rows.len(), index + 1),
        ));
    };
    let mut headers: Vec<Header> = if wanted.header_line == Some(0) {
        (1..=header.len()).map(|number| Header::new(&format!("#{number}"))).collect()
    } else {
        header.iter().map(|text| Header::new(text)).collect()
    };
    layout.header_line = Some(if wanted.header_line == Some(0) { 0 } else { index as u64 + 1 });
    if let Some(units) = rows.get(index + 1).and_then(|row| heading::units_below(row)) {
        headers.iter_mut().zip(units).for_each(|(header, unit)| header.unit = header.unit.take().or(unit));
    }
    Ok((layout, headers))
}

/// The delimiter, the lines by it, and the index of the header among them.
fn header_of(
    path: &Path,
    lines: &[&str],
    tried: &[char],
    stated: Option<u64>,
    named: &[String],
) -> Result<(char, Vec<Vec<String>>, usize), ReadError> {
    let split = |delimiter: char| -> Vec<Vec<String>> { lines.iter().map(|line| fields(line, delimiter)).collect() };
    // Another file of the same recorder may have a longer preamble.
    let named_there = |line: &u64| {
        let text = lines.get((*line as usize).saturating_sub(1)).copied().unwrap_or_default();
        let mut names = text.split(DELIMITERS).map(|name| name.trim().trim_matches('"'));
        *line == 0
            || named.is_empty()
            || names.any(|name| named.iter().any(|other| other == name || other.starts_with('#')))
    };
    Ok(match stated.filter(named_there) {
        Some(line) => {
            let index = (line as usize).saturating_sub(1);
            let most = tried
                .iter()
                .map(|delimiter| (split(*delimiter), *delimiter))
                .max_by_key(|(rows, _)| rows.get(index).map_or(0, Vec::len));
            let (rows, delimiter) = most.ok_or_else(|| row::refused(path, "expected a delimiter, found none"))?;
            (delimiter, rows, index)
        }
        None => {
            let headed = tried.iter().filter_map(|delimiter| {
                let rows = split(*delimiter);
                let (index, known) = heading::header_among(&rows, named)?;
                Some((known, rows[index].len(), (*delimiter, rows, index)))
            });
            let best = headed.max_by_key(|(known, fields, _)| (*known, *fields));
            best.map(|(_, _, found)| found).ok_or_else(|| no_header(path, lines))?
        }
    })
}

fn no_header(path: &Path, lines: &[&str]) -> ReadError {
    let first: String = lines.first().unwrap_or(&"").chars().take(60).collect();
    let remedy = if letters::are_strange(&first) { format!("; {}", letters::REMEDY) } else { String::new() };
    let message = format!(
        "expected a line with names of columns, found none that is known; the file begins with {first:?}; give header_line in import.toml, 0 where there is no header{remedy}"
    );
    row::refused(path, message)
}

/// Every row below the header, which has so many names.
pub fn rows(path: &Path, layout: &Layout, named: usize, each: &mut Each) -> Result<(), ReadError> {
    let encoding = layout.encoding.as_deref().unwrap_or("utf-8");
    let mut reader = reader(path, encoding)?;
    let header_line = layout.header_line.unwrap_or(1);
    let mut skipped = Vec::new();
    for _ in 0..header_line {
        skipped.clear();
        reader.read_until(b'\n', &mut skipped).map_err(|error| row::io(path, error))?;
    }
    let mut builder = table(layout.delimiter.unwrap_or(','));
    let quoting = has_quoted_fields(path, encoding)?;
    let mut table = builder.comment(Some(b'#')).quoting(quoting).from_reader(reader);
    let mut record = ::csv::ByteRecord::new();
    let mut row: Vec<RowField> = Vec::new();
    let mut first = true;
    loop {
        match table.read_byte_record(&mut record) {
            Ok(true) => {}
            Ok(false) => return Ok(()),
            Err(error) => return Err(row::refused(path, error.to_string())),
        }
        let line = header_line + record.position().map_or(0, ::csv::Position::line);
        let lost: usize = record.iter().map(|field| field.iter().filter(|byte| **byte == b'\n').count()).sum();
        for behind in 0..lost as u64 {
            let message = "expected a quote at the end of a field, found none: this line stands within the field";
            if !each(Event::Bad(line + behind + 1, message.to_owned())) {
                return Ok(());
            }
        }
        row.clear();
        row.extend(record.iter().map(|field| match String::from_utf8_lossy(field) {
            text if text.is_empty() => RowField::Empty,
            text => RowField::Text(text.into_owned()),
        }));
        if std::mem::take(&mut first) {
            let texts: Vec<String> = record.iter().map(|field| String::from_utf8_lossy(field).into_owned()).collect();
            if heading::units_below(&texts).is_some() {
                continue;
            }
        }
        let is_longer = row.iter().skip(named).any(|field| *field != RowField::Empty);
        if (row.len() < named || is_longer) && !each(Event::Ragged(line, (named, row.len()))) {
            return Ok(());
        }
        if !each(Event::Row(line, &row)) {
            return Ok(());
        }
    }
}
