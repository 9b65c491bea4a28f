//! Files of any kind as one thing: a header, then rows of fields. Text is streamed; sheets are held as a whole.

mod csv;
mod gpx;
mod heading;
mod joined_rows;
mod json;
mod nmea;
mod parquet;
mod parts;
mod quality;
pub mod row;
mod seen_signals;
mod sheet;
mod signals;
mod tags;
mod thousandths;
mod unpacked;

use super::mapping::{SAY_IT, line};
use super::meaning::Meaning;
use super::number;
use parts::Parts;
use quality::Qualities;
use row::{Each, Event, Header, Layout, RowField, SourceFormat};
use rundown_files::refusal::ReadError;
use rundown_files::run_set::{PACKED, ending};
use sheet::Sheets;
use signals::{SignalColumns, Signals};
use std::io::Read;
use std::path::{Path, PathBuf};
pub use tags::is_of_another;
use thousandths::Thousandths;
pub use unpacked::{are_equal, name as unpacked_name};

/// Rows that decide the decimal sign.
const DECIDING: usize = 400;
/// Rows that show how a column calls values good: receivers have no fix at first.
const JUDGING: usize = 20_000;

/// A file whose layout is known.
#[derive(Clone, Debug)]
pub struct SourceFile {
    pub path: PathBuf,
    pub layout: Layout,
    /// Those of the file, or its signals, and behind them what parts make.
    pub headers: Vec<Header>,
    /// Those of the file.
    written: Vec<Header>,
    thousandths: Option<Thousandths>,
    signals: Option<Signals>,
    /// Of a table with all readings in one row.
    qualities: Qualities,
    /// Columns that call each value of the first rows bad.
    all_bad: Vec<usize>,
    parts: Vec<Parts>,
    /// Of a workbook.
    pub sheets: Sheets,
}

/// The kind of a file: by its name, else by its first bytes.
fn format_of(path: &Path) -> Result<SourceFormat, ReadError> {
    let inner = unpacked_name(path);
    let extension = ending(&inner);
    let by_name = match extension.as_str() {
        "xlsx" | "xls" | "xlsm" | "xlsb" | "ods" => Some(SourceFormat::Sheet),
        "gpx" => Some(SourceFormat::Gpx),
        "nmea" | "nma" | "ubx" => Some(SourceFormat::Nmea),
        "jsonl" | "ndjson" | "json" => Some(SourceFormat::JsonLines),
        "parquet" | "pq" => Some(SourceFormat::Parquet),
        _ => None,
    };
    if let Some(format) = by_name {
        let is_text = !matches!(format, SourceFormat::Sheet | SourceFormat::Parquet);
        return if is_text || inner == path {
            Ok(format)
        } else {
            Err(row::refused(path, "expected text in a compressed file, found a workbook or Parquet: unpack it first"))
        };
    }
    if PACKED.contains(&extension.as_str()) {
        return Err(row::refused(
            path,
            format!("expected text, or text packed by gzip, found .{extension}: unpack it first"),
        ));
    }
    let mut head = Vec::new();
    unpacked::bytes(path)?.take(512).read_to_end(&mut head).map_err(|error| row::io(path, error))?;
    let text = String::from_utf8_lossy(&head).into_owned();
    let text = text.trim_start_matches('\u{feff}').trim_start();
    Ok(match text {
        text if text.starts_with("PAR1") => SourceFormat::Parquet,
        text if text.starts_with("PK\u{3}\u{4}") || head.starts_with(&[0xd0, 0xcf, 0x11, 0xe0]) => SourceFormat::Sheet,
        text if text.contains("<gpx") => SourceFormat::Gpx,
        text if text.starts_with('{') => SourceFormat::JsonLines,
        text if ["$GP", "$GN", "$GL", "$GA"].iter().any(|talker| text.starts_with(talker)) => SourceFormat::Nmea,
        _ => SourceFormat::Csv,
    })
}

/// A column of numbers that are read.
fn named_or_known(header: &Header, named: &[String]) -> bool {
    let is_number = |meaning| !matches!(meaning, Meaning::Date | Meaning::Unit | Meaning::Run);
    let has_unit = || Meaning::ALL.iter().any(|meaning| header.unit_of(*meaning).is_some());
    Meaning::of_name(&header.name).is_some_and(is_number) || has_unit() || header.is_among(named)
}

/// Looks at so many of the rows that `rows` gives.
fn first_rows<E>(
    count: usize,
    mut look: impl FnMut(&[RowField]),
    rows: impl FnOnce(&mut Each) -> Result<(), E>,
) -> Result<(), E> {
    let mut left = count;
    rows(&mut |event| {
        if let Event::Row(_, row) = event {
            look(row);
            left -= 1;
        }
        left > 0
    })
}

impl SourceFile {
    /// Finds what the file does not say. `named` are columns that the mapping names.
    ///
    /// # Errors
    /// [`ReadError`] when the file cannot be read, or no header is found.
    pub fn open(path: &Path, wanted: &Layout, named: &[String]) -> Result<Self, ReadError> {
        log::info!("read {}", path.display());
        let format = wanted.format.map_or_else(|| format_of(path), Ok)?;
        let plain = Layout { format: Some(format), ..wanted.clone() };
        // They stand in the header as the others do.
        let columns = named.iter().chain(&wanted.signal).chain(&wanted.value).cloned();
        let named = &columns.collect::<Vec<_>>();
        let mut sheets = Sheets::default();
        let (layout, written) = match format {
            SourceFormat::Csv => csv::open(path, &plain, named)?,
            SourceFormat::Sheet => {
                let (layout, headers, found) = sheet::open(path, &plain, named)?;
                sheets = found;
                (layout, headers)
            }
            SourceFormat::Gpx => (plain, gpx::headers()),
            SourceFormat::Nmea => (plain, nmea::headers()),
            SourceFormat::JsonLines => (plain, json::headers(path)?),
            SourceFormat::Parquet => (plain, parquet::headers(path)?),
        };
        let (path, headers, parts, qualities) = (path.to_owned(), Vec::new(), Vec::new(), Qualities::default());
        let all_bad = Vec::new();
        let mut source = Self {
            path,
            layout,
            headers,
            written,
            thousandths: None,
            signals: None,
            qualities,
            all_bad,
            parts,
            sheets,
        };
        let is_of_standard = matches!(format, SourceFormat::Gpx | SourceFormat::Nmea);
        if !is_of_standard {
            source.find_thousandths()?;
        }
        source.headers.clone_from(&source.written);
        if !is_of_standard {
            source.find_signals(named)?;
            source.find_qualities(named)?;
        }
        source.parts = parts::join(&mut source.headers);
        if source.layout.decimal.is_none() && !is_of_standard {
            source.layout.decimal = Some(source.decimal(named)?);
        }
        Ok(source)
    }

    /// That each row has one signal, where it is so.
    pub fn words_of_signals(&self) -> Option<String> {
        let signals = self.signals.as_ref()?;
        let column = self.layout.signal.as_deref().unwrap_or_default();
        let unused = signals.unused.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", ");
        let unused = if unused.is_empty() { unused } else { format!("; not used: {unused}") };
        let count = signals.count;
        let quality = signals.columns.quality.as_ref().map_or_else(String::new, |quality| {
            format!("; {:?} says which values are bad", self.written[quality.column].written)
        });
        Some(format!(
            "each row has one of {count} signals (column {column:?}); those of one time are one row{quality}{unused}"
        ))
    }

    /// That thousandths of a second are read, where they are.
    pub fn words_of_thousandths(&self) -> Option<String> {
        let column = &self.written[self.thousandths?.column].written;
        Some(format!("column {column:?} has the thousandths of a second of the times: steps are more even with them"))
    }

    /// Which columns say what is bad, where each row has all readings.
    pub fn words_of_qualities(&self) -> Option<String> {
        let names = self.qualities.columns().map(|column| format!("{:?}", self.written[column].written));
        let names = names.collect::<Vec<_>>().join(", ");
        (!names.is_empty()).then(|| format!("which values are bad is read from {names}"))
    }

    /// Which columns call all values bad, and are not believed.
    pub fn doubt_of_qualities(&self) -> Option<String> {
        let of_signals = self.signals.as_ref().and_then(|signals| signals.all_bad);
        let columns = self.all_bad.iter().copied().chain(of_signals);
        let names: Vec<String> = columns.map(|column| format!("{:?}", self.written[column].written)).collect();
        let path = self.path.display();
        (!names.is_empty()).then(|| {
            format!(
                "{path}: {} calls all values bad that were looked at: they are read as if it said nothing; leave the file out if it is right",
                names.join(", ")
            )
        })
    }

    /// Columns that call values of others bad, by what they say in the first rows.
    fn find_qualities(&mut self, named: &[String]) -> Result<(), ReadError> {
        if self.signals.is_some() {
            return Ok(());
        }
        let mut found = Qualities::find(&self.written, named);
        if !found.is_empty() {
            first_rows(JUDGING, |row| found.see(row), |each| self.timed(each))?;
            self.all_bad = found.forget_unknown();
        }
        self.qualities = found;
        Ok(())
    }

    /// Whether a column has thousandths of the times. It is nothing else then.
    fn find_thousandths(&mut self) -> Result<(), ReadError> {
        let Some(found) = Thousandths::find(&self.written) else { return Ok(()) };
        let mut seen = Vec::new();
        first_rows(DECIDING, |row| seen.extend(found.seconds(row)), |each| self.as_written(each))?;
        if Thousandths::are_part(&seen) {
            self.thousandths = Some(found);
            self.written[found.column].name.clear();
        }
        Ok(())
    }

    /// That each row may have one, where it is not read so.
    pub fn hint_of_signals(&self) -> Option<&'static str> {
        signals::hint(&self.headers).filter(|_| self.signals.is_none())
    }

    /// Whether each row has one signal.
    fn find_signals(&mut self, named: &[String]) -> Result<(), ReadError> {
        let Some(columns) = SignalColumns::find(&self.written, &self.layout) else {
            let stated = self.layout.signal.iter().chain(&self.layout.value);
            let is_missing = |name: &&String| !self.written.iter().any(|header| header.written == name.trim());
            let found = match stated.clone().find(is_missing) {
                Some(missing) => format!("{missing:?}"),
                None if stated.count() > 0 => "only one of signal and value".to_owned(),
                None => return Ok(()),
            };
            let names: Vec<&str> = self.written.iter().map(|header| header.written.as_str()).collect();
            let expected = names.join(", ");
            return Err(row::refused(&self.path, format!("layout: expected two of {expected}, found {found}")));
        };
        let ([signal, value], is_stated) = (columns.names(&self.written), self.layout.signal.is_some());
        let found = columns.read(&self.written, named, is_stated, |each| self.timed(each))?;
        if let Some((signals, headers)) = found {
            if let Some((name, beside, rows)) = &signals.mixed {
                let remedy = signals.unused.first().map_or_else(String::new, |unused| {
                    let columns = line([(Meaning::Unit, unused.as_str(), String::new())]);
                    format!("; is it {}? {SAY_IT}: {columns}", signals.unused.join(" or "))
                });
                let expected =
                    format!("expected one value of {name} at a time, found another in {beside} of {rows} rows");
                let why = "several trains, or sources, which need a column that tells them apart";
                return Err(row::refused(&self.path, format!("{expected}: {why}{remedy}")));
            }
            (self.layout.signal, self.layout.value) = (Some(signal), Some(value));
            (self.signals, self.headers) = (Some(signals), headers);
        }
        Ok(())
    }

    /// The decimal sign of the first texts: cells of a sheet, or values of JSON, may be texts as the fields of a CSV
    /// are.
    fn decimal(&self, named: &[String]) -> Result<char, ReadError> {
        let mut texts = Vec::new();
        // Versions and addresses have points, too.
        let are_read: Vec<bool> = self.headers.iter().map(|header| named_or_known(header, named)).collect();
        let any = !are_read.contains(&true);
        let mut take = |fields: &[RowField]| {
            let read = fields.iter().zip(&are_read).filter(|(_, is_read)| any || **is_read);
            texts.extend(read.filter_map(|(field, _)| match field {
                RowField::Text(text) => Some(text.clone()),
                RowField::Empty | RowField::Number(_) => None,
            }));
        };
        first_rows(DECIDING, &mut take, |each| self.joined(each))?;
        Ok(number::decimal_of(texts.iter().map(String::as_str)))
    }

    /// Every row, as long as `each` wants one.
    ///
    /// # Errors
    /// [`ReadError`] when the file cannot be read any further.
    pub fn rows(&self, each: &mut Each) -> Result<(), ReadError> {
        if self.parts.is_empty() {
            return self.joined(each);
        }
        let written = self.headers.len() - self.parts.len();
        self.joined(&mut changed(each, |whole| {
            // A row may be shorter, or longer, than the header.
            whole.resize(written, RowField::Empty);
            for part in &self.parts {
                whole.push(part.field(whole));
            }
        }))
    }

    /// Rows with all of their times.
    fn timed(&self, each: &mut Each) -> Result<(), ReadError> {
        let Some(thousandths) = self.thousandths else { return self.as_written(each) };
        self.as_written(&mut changed(each, |whole| thousandths.put_in(whole)))
    }

    /// Rows of all signals.
    fn joined(&self, each: &mut Each) -> Result<(), ReadError> {
        match &self.signals {
            Some(signals) => joined_rows::join(signals, each, |each| self.timed(each)),
            None => self.judged(each),
        }
    }

    /// Rows without the values that a column calls bad.
    fn judged(&self, each: &mut Each) -> Result<(), ReadError> {
        if self.qualities.is_empty() {
            return self.timed(each);
        }
        let mut whole: Vec<RowField> = Vec::new();
        self.timed(&mut |event| match event {
            Event::Row(line, row) => self.qualities.judge((line, row), &self.written, &mut whole, each),
            other => each(other),
        })
    }

    /// So many fields are named: nothing may stand behind them.
    fn named(&self) -> usize {
        self.written.iter().rposition(|header| !header.written.is_empty()).map_or(0, |last| last + 1)
    }

    fn as_written(&self, each: &mut Each) -> Result<(), ReadError> {
        let path = &self.path;
        match self.layout.format.unwrap_or(SourceFormat::Csv) {
            SourceFormat::Csv => csv::rows(path, &self.layout, self.named(), each),
            SourceFormat::Sheet => sheet::rows(path, &self.sheets, each),
            SourceFormat::Gpx => gpx::rows(path, each),
            SourceFormat::Nmea => nmea::rows(path, each),
            SourceFormat::JsonLines => json::rows(path, &self.written, each),
            SourceFormat::Parquet => parquet::rows(path, each),
        }
    }
}

/// Rows that `change` completes before `each` gets them.
fn changed(each: &mut Each, change: impl Fn(&mut Vec<RowField>)) -> impl FnMut(Event) -> bool {
    let mut whole: Vec<RowField> = Vec::new();
    move |event| match event {
        Event::Row(number, row) => {
            whole.clear();
            whole.extend_from_slice(row);
            change(&mut whole);
            each(Event::Row(number, &whole))
        }
        other => each(other),
    }
}
