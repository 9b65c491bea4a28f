//! Run logs: one CSV file, one run.
//!
//! In: the text of a log. Out: a [`RunLog`], its samples in the order of the rows. The columns are those of
//! [`crate::sample::COLUMNS`].
//!
//! | in the file | what becomes of it |
//! |---|---|
//! | empty field | `None`: a missing sample, never a zero |
//! | column of another name | named in [`RunLog::other_columns`], used by nothing |
//! | line that begins with `#`, blank line, byte order mark, `\r\n` | accepted |
//! | not a number, wrong count of fields, no time, a time beyond 1e11 s | a bad row: the log is refused and every bad row is named, or it is left out with [`BadRows::LeaveOut`] |
//! | time not after the largest one before | warned of, handed on: the estimator drops and counts it |
//! | NaN, infinite, outside the range of its column | warned of, handed on: the estimator judges it and has a cause for it |
//!
//! Nothing is left out without a message that names file, line and column.

mod header;

use crate::refusal::{IMPORT_TIP, Place, ReadError, Refusal};
use crate::sample::{LOCATION, Sample};
use csv::{ReaderBuilder, StringRecord, Terminator, Trim};
use header::Header;
use std::path::{Path, PathBuf};

/// What is done with a row that cannot be read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BadRows {
    /// The log is refused, and its bad rows are named.
    #[default]
    Refuse,
    /// The rows are left out, named in [`RunLog::bad_rows`].
    LeaveOut,
}

/// A run log as it was read.
#[derive(Clone, Debug, PartialEq)]
pub struct RunLog {
    /// Where it was read from.
    pub path: PathBuf,
    /// Its rows, but for bad ones.
    pub samples: Vec<Sample>,
    /// The log has a column `location_m`; without it latitude and longitude take its place.
    pub has_location_column: bool,
    /// Names of the columns that the format does not know.
    pub other_columns: Vec<String>,
    /// Rows that were left out.
    pub bad_rows: Vec<Refusal>,
    /// Rows that were read and look wrong.
    pub warnings: Vec<Refusal>,
}

/// A path that stands for standard input; a file of this name is `./-`.
pub const STDIN: &str = "-";

impl RunLog {
    /// Reads a log; [`STDIN`] is that of standard input.
    ///
    /// # Errors
    /// [`ReadError`] names the file, and line and column where there are any.
    pub fn read(path: &Path, bad_rows: BadRows) -> Result<Self, ReadError> {
        let bytes = if path == Path::new(STDIN) {
            let mut bytes = Vec::new();
            std::io::Read::read_to_end(&mut std::io::stdin().lock(), &mut bytes).map(|_| bytes)
        } else {
            std::fs::read(path)
        };
        let bytes = bytes.map_err(|source| ReadError::io(path, source))?;
        log::info!("read {}", path.display());
        Self::parse(path, &bytes, bad_rows)
    }

    /// Reads a log that is already in memory; `path` is for the messages.
    ///
    /// # Errors
    /// As [`RunLog::read`].
    ///
    /// ```
    /// use rundown_files::run_log::{BadRows, RunLog};
    ///
    /// let text = "time_s,location_m,speed_kmh\n0,0.0,36\n10,14.2,\n";
    /// let log = RunLog::parse("run.csv".as_ref(), text.as_bytes(), BadRows::Refuse)?;
    /// assert_eq!(log.samples[0].speed_mps, Some(10.0));
    /// assert_eq!((log.samples[1].location_m, log.samples[1].speed_mps), (Some(14.2), None));
    ///
    /// let broken = "time_s,location_m,speed_kmh\n0,0.0,fast\n";
    /// let error = RunLog::parse("run.csv".as_ref(), broken.as_bytes(), BadRows::Refuse).unwrap_err();
    /// assert!(error.to_string().starts_with("run.csv:2:3: speed_kmh: expected a number, found \"fast\""));
    /// # Ok::<(), rundown_files::refusal::ReadError>(())
    /// ```
    pub fn parse(path: &Path, bytes: &[u8], bad_rows: BadRows) -> Result<Self, ReadError> {
        is_text(path, bytes)?;
        let mut rows = rows(utf8(path, bytes)?);
        let empty =
            |found| ReadError::of_file(path, format!("expected a header line and rows below it, found {found}"));
        let Some((line, first)) = rows.next() else {
            return Err(empty("nothing"));
        };
        let header = Header::read(path, &first, line)?;
        let mut log = Self {
            path: path.to_owned(),
            samples: Vec::new(),
            has_location_column: header.has(LOCATION),
            other_columns: header.other_columns(),
            bad_rows: Vec::new(),
            warnings: Vec::new(),
        };
        let mut latest_s = f64::NEG_INFINITY;
        for (line, record) in rows {
            match header.sample(&record, line, latest_s) {
                Ok((sample, doubts)) => {
                    latest_s = latest_s.max(sample.time_s);
                    log.warnings.extend(doubts);
                    log.samples.push(sample);
                }
                Err(refusal) => log.bad_rows.push(refusal),
            }
        }
        if log.samples.is_empty()
            && let Some(refusal) = of_every_row(&log.bad_rows)
        {
            return Err(refusal.into());
        }
        if bad_rows == BadRows::Refuse && !log.bad_rows.is_empty() {
            return Err(ReadError::BadRows { path: path.to_owned(), rows: log.bad_rows });
        }
        if log.samples.is_empty() {
            return Err(empty("no row below the header that can be read"));
        }
        Ok(log)
    }
}

/// One refusal for several rows that are all refused for the same column, as for one with dates: a line for each would
/// say the same.
fn of_every_row(rows: &[Refusal]) -> Option<Refusal> {
    let (first, others) = rows.split_first()?;
    let is_like = |row: &Refusal| !row.field.is_empty() && row.field == first.field;
    let count = rows.len();
    (count > 1 && others.iter().all(is_like)).then(|| {
        let message = format!("{}, and the like in all {count} rows; {IMPORT_TIP}", first.message);
        Refusal { message, ..first.clone() }
    })
}

/// The text without its byte order mark.
fn utf8<'a>(path: &Path, bytes: &'a [u8]) -> Result<&'a str, Refusal> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    std::str::from_utf8(bytes).map_err(|error| {
        let (good, rest) = bytes.split_at(error.valid_up_to());
        let good = String::from_utf8_lossy(good);
        let row = good.rsplit('\n').next().unwrap_or_default();
        let line = good.matches('\n').count() + 1;
        let place = Place { file: path.to_owned(), line: Some(line), column: Some(row.matches(',').count() + 1) };
        let byte = rest.first().copied().unwrap_or_default();
        let expected = format!("expected a text in UTF-8, found byte 0x{byte:02x}");
        place.refuse("", format!("{expected}; save the log as UTF-8, or let `rundown import` read it"))
    })
}

/// What a file that is no text begins with, what it is, and what helps.
const NO_TEXTS: [(&[u8], &str, &str); 7] = [
    (b"PK\x03\x04", "a workbook or an archive", "`rundown import` reads workbooks"),
    (b"\xd0\xcf\x11\xe0", "a workbook", READS_IT),
    (b"PAR1", "a Parquet file", READS_IT),
    (b"\x1f\x8b", "a compressed file", UNPACK),
    (b"\x28\xb5\x2f\xfd", "a compressed file", UNPACK),
    (b"\xff\xfe", "a text in UTF-16", READS_IT),
    (b"\xfe\xff", "a text in UTF-16", READS_IT),
];
const READS_IT: &str = "`rundown import` reads it";
const UNPACK: &str = "unpack it first";

/// Files of another kind are named: no encoding would help.
fn is_text(path: &Path, bytes: &[u8]) -> Result<(), Refusal> {
    let other = NO_TEXTS.iter().find(|(begin, ..)| bytes.starts_with(begin));
    other.map_or(Ok(()), |(_, kind, remedy)| {
        Err(Place::of_file(path).refuse("", format!("expected a text in UTF-8, found {kind}; {remedy}")))
    })
}

/// The rows with their line numbers, comments and blank lines left out.
///
/// A row is a line: a quote that is never closed spoils its own row, not the rest of the file.
fn rows(text: &str) -> impl Iterator<Item = (u64, StringRecord)> + '_ {
    let lines = (1..).zip(text.lines());
    let rows = lines.filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with('#'));
    rows.map(|(number, line)| (number, fields(line)))
}

fn fields(line: &str) -> StringRecord {
    if !line.contains('"') {
        // The same without the cost of a reader for each line, which is most of the time of reading a day's log.
        return line.split(',').map(str::trim).collect();
    }
    let mut reader = ReaderBuilder::new()
        .has_headers(false)
        .trim(Trim::All)
        .terminator(Terminator::Any(b'\n'))
        .from_reader(line.as_bytes());
    // A line of UTF-8 that is not blank is one record; were it none, it would be a row without fields, and named as
    // such.
    let record = reader.records().next().and_then(Result::ok);
    record.unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::refusal::MAX_LISTED;

    fn parse(text: &str) -> Result<RunLog, ReadError> {
        RunLog::parse("run.csv".as_ref(), text.as_bytes(), BadRows::Refuse)
    }

    fn message(text: &str) -> String {
        parse(text).unwrap_err().to_string()
    }

    #[test]
    fn columns_may_stand_in_any_order_and_optional_ones_are_read() {
        let log = parse("speed_kmh,effort_n_per_kg,time_s,location_m,headwind_mps\n36,-0.25,5,100.5,2\n").unwrap();
        let sample = log.samples[0];
        assert_eq!((sample.time_s, sample.location_m, sample.speed_mps), (5.0, Some(100.5), Some(10.0)));
        assert_eq!((sample.effort_n_per_kg, sample.headwind_mps, sample.latitude_deg), (Some(-0.25), Some(2.0), None));
        assert!(log.warnings.is_empty());
    }

    #[test]
    fn byte_order_mark_crlf_blanks_comments_and_a_missing_last_newline_are_accepted() {
        let plain = parse("time_s,location_m,speed_kmh\n0,1,2\n1,,4\n").unwrap();
        let odd = parse("\u{feff}# recorder 7\r\ntime_s, location_m ,speed_kmh\r\n\r\n# a, b, c, d\r\n0, 1 ,2\r\n1,,4")
            .unwrap();
        let values =
            |log: &RunLog| -> Vec<_> { log.samples.iter().map(|s| (s.time_s, s.location_m, s.speed_mps)).collect() };
        assert_eq!(values(&plain), values(&odd));
        let lines: Vec<u64> = odd.samples.iter().map(|sample| sample.line).collect();
        assert_eq!(lines, [5, 6]);
        assert_eq!(parse("\u{feff}time_s,location_m,speed_kmh\n0,1,2").unwrap().samples.len(), 1);
    }

    #[test]
    fn empty_field_is_missing_and_not_zero() {
        let log = parse("time_s,location_m,speed_kmh\n0,,\n").unwrap();
        assert_eq!((log.samples[0].location_m, log.samples[0].speed_mps), (None, None));
    }

    #[test]
    fn columns_of_other_names_are_named() {
        let log = parse("time_s,note,location_m,speed_kmh\n0,\"a, b\",1,2\n1,,3,4\n").unwrap();
        assert_eq!(log.other_columns, ["note"]);
        assert_eq!(log.samples[0].location_m, Some(1.0));
    }

    #[test]
    fn bad_number_names_file_line_column_and_what_was_found() {
        let text = "# c\n\n# d\ntime_s,location_m,speed_kmh\n0,0,0\n# e\n1,12;5,3\n";
        let found = message(text);
        let first = "run.csv:7:2: location_m: expected a number, found \"12;5\" (an empty field is a missing sample)";
        assert_eq!(found.lines().next(), Some(first));
        assert!(
            found.ends_with(
                "1 unreadable row, the run was not used: correct the log, or leave such rows out with --skip-bad-rows"
            ),
            "{found}"
        );
    }

    #[test]
    fn wrong_count_of_fields_and_empty_time_are_bad_rows() {
        let found = message("time_s,location_m,speed_kmh\n0,0,0\n1,2\n3,4,5,6\n,7,8\nNaN,1,2\n");
        let expected = [
            "run.csv:3: expected 3 fields as in the header, found 2",
            "run.csv:4: expected 3 fields as in the header, found 4",
            "run.csv:5:1: time_s: expected a time, found an empty field",
            "run.csv:6:1: time_s: expected a finite number, found NaN",
        ];
        assert_eq!(found.lines().take(4).collect::<Vec<_>>(), expected);
    }

    #[test]
    fn an_open_quote_spoils_its_own_row_only() {
        let text = "time_s,location_m,speed_kmh,note\n0,0,0,\"open\n1,\"1,1,b\n2,2,2,\"a, b\"\n3,3\r,3,c\n";
        let log = RunLog::parse("run.csv".as_ref(), text.as_bytes(), BadRows::LeaveOut).unwrap();
        let lines: Vec<u64> = log.samples.iter().map(|sample| sample.line).collect();
        assert_eq!(lines, [2, 4, 5]);
        assert_eq!(log.bad_rows.len(), 1);
        assert_eq!(log.bad_rows[0].place.line, Some(3));
    }

    #[test]
    fn a_quote_changes_nothing_but_what_it_encloses() {
        assert_eq!(fields(" 1 ,2,,x\r,"), fields("\"1\", 2,,x\r,"));
        assert_eq!(fields("1,\"a,b\"").get(1), Some("a,b"));
    }

    #[test]
    fn bad_rows_are_left_out_only_on_request_and_stay_named() {
        let text = "time_s,location_m,speed_kmh,note\n0,0,0,a\n1,x,1,b\n2,2,2,c\n";
        let log = RunLog::parse("run.csv".as_ref(), text.as_bytes(), BadRows::LeaveOut).unwrap();
        assert_eq!(log.samples.len(), 2);
        assert_eq!(log.bad_rows.len(), 1);
        assert_eq!(log.bad_rows[0].place.line, Some(3));
    }

    #[test]
    fn long_lists_of_bad_rows_are_cut_and_counted() {
        let mut text = "time_s,location_m,speed_kmh\n".to_owned();
        for _ in 0..50 {
            text += "0,0\n";
        }
        let found = message(&text);
        assert_eq!(found.lines().count(), MAX_LISTED + 1);
        assert!(found.contains("30 more like these; 50 unreadable rows"), "{found}");
    }

    #[test]
    fn rows_that_all_fail_in_the_same_column_are_one_line_with_their_number_and_what_helps() {
        let of = |field: fn(u32) -> String| -> String {
            (0..14).map(|row| format!("{},{row},36\n", field(row))).collect::<String>()
        };
        let header = "time_s,location_m,speed_kmh\n";
        let dates = of(|row| format!("2024-01-01T08:00:{row:02}Z"));
        for bad_rows in [BadRows::Refuse, BadRows::LeaveOut] {
            let text = format!("{header}{dates}");
            let error = RunLog::parse("run.csv".as_ref(), text.as_bytes(), bad_rows).unwrap_err().to_string();
            assert!(
                error.starts_with("run.csv:2:1: time_s: expected a number, found \"2024-01-01T08:00:00Z\""),
                "{error}"
            );
            assert!(error.ends_with(&format!("in all 14 rows; {IMPORT_TIP}")), "{error}");
            assert_eq!(error.lines().count(), 1, "{error}");
        }
        // One row that is read, or one that fails otherwise, and each is named.
        let lines = |rest: &str| message(&format!("{header}{dates}{rest}")).lines().count();
        assert_eq!(lines("60,1,36\n"), 15);
        assert_eq!(lines("60,x,36\n"), 16);
    }

    #[test]
    fn doubtful_values_are_warned_of_and_handed_on() {
        let log = parse("time_s,location_m,speed_kmh\n0,0,0\n5,1,-3\n5,NaN,2\n4,2,inf\n6,3,4\n").unwrap();
        assert_eq!(log.samples.len(), 5);
        assert_eq!(log.samples[1].speed_mps, Some(-3.0 / 3.6));
        assert!(log.samples[2].location_m.unwrap().is_nan());
        let warnings: Vec<String> = log.warnings.iter().map(Refusal::to_string).collect();
        let expected = [
            "run.csv:3:3: speed_kmh: expected 0 to 1000 km/h, found -3.0",
            "run.csv:4:1: time_s: expected a time after 5, found 5",
            "run.csv:4:2: location_m: expected a finite number, found NaN",
            "run.csv:5:1: time_s: expected a time after 5, found 4",
            "run.csv:5:3: speed_kmh: expected a finite number, found inf",
        ];
        assert_eq!(warnings, expected);
    }

    #[test]
    fn values_no_train_has_are_named() {
        let log = parse("time_s,location_m,speed_kmh,effort_n_per_kg\n0,1e300,9000,-50\n").unwrap();
        let warnings: Vec<String> = log.warnings.iter().map(Refusal::to_string).collect();
        let expected = [
            "run.csv:2:2: location_m: expected -10000000 to 10000000 m, found 1e300",
            "run.csv:2:3: speed_kmh: expected 0 to 1000 km/h, found 9000.0",
            "run.csv:2:4: effort_n_per_kg: expected -10 to 10 N/kg, found -50.0",
        ];
        assert_eq!(warnings, expected);
        let found = message("time_s,location_m,speed_kmh\n1732205593000,0,0\n");
        let expected = "run.csv:2:1: time_s: expected -100000000000 to 100000000000 s, found 1732205593000.0\n";
        assert!(found.starts_with(expected), "{found}");
    }

    #[test]
    fn header_names_what_is_missing() {
        let found = message("# x\ntime_s,location_m,speed_mps\n0,0,0\n");
        let expected = "run.csv:2: expected a header with speed_kmh, found \"time_s,location_m,speed_mps\"; ";
        assert_eq!(found, format!("{expected}{IMPORT_TIP}"));
        let found = message("time_s;location_m;speed_kmh\n0;0;0\n");
        assert!(found.contains("; the separator must be a comma, not a semicolon; `rundown import` "), "{found}");
        let found = message("time_s,speed_kmh,latitude_deg\n");
        assert!(found.contains("; latitude_deg and longitude_deg together may stand for it; "), "{found}");
        let found = message("time_s,time_s,location_m,speed_kmh\n");
        assert_eq!(found, "run.csv:1:2: time_s: expected each column once, found it also as column 1");
    }

    #[test]
    fn coordinates_may_stand_for_the_location() {
        let log = parse("time_s,speed_kmh,latitude_deg,longitude_deg\n0,0,51.4,5.5\n").unwrap();
        assert!(!log.has_location_column);
        assert_eq!(log.samples[0].latitude_deg, Some(51.4));
    }

    #[test]
    fn empty_and_binary_files_are_refused() {
        for text in ["", "\n\n", "# only a comment\n"] {
            assert_eq!(message(text), "run.csv: expected a header line and rows below it, found nothing");
        }
        assert!(message("time_s,location_m,speed_kmh\n").ends_with("found no row below the header that can be read"));
        let error = RunLog::parse("run.csv".as_ref(), b"time_s\n0,\xff", BadRows::Refuse).unwrap_err();
        assert_eq!(
            error.to_string(),
            "run.csv:2:2: expected a text in UTF-8, found byte 0xff; save the log as UTF-8, or let \
             `rundown import` read it"
        );
        for (bytes, kind, remedy) in [
            (&b"PK\x03\x04\xff"[..], "a workbook or an archive", "`rundown import` reads workbooks"),
            (b"\xd0\xcf\x11\xe0", "a workbook", "`rundown import` reads it"),
            (b"PAR1\xff", "a Parquet file", "`rundown import` reads it"),
            (b"\x1f\x8b\x08", "a compressed file", "unpack it first"),
            (b"\xff\xfet\0", "a text in UTF-16", "`rundown import` reads it"),
        ] {
            let error = RunLog::parse("run.csv".as_ref(), bytes, BadRows::Refuse).unwrap_err();
            assert_eq!(error.to_string(), format!("run.csv: expected a text in UTF-8, found {kind}; {remedy}"));
        }
        let error = RunLog::read("no/such/run.csv".as_ref(), BadRows::Refuse).unwrap_err();
        assert!(error.to_string().starts_with("no/such/run.csv: cannot be read: "), "{error}");
    }
}
