//! Every message of a link with time and direction, as CSV; and back.
//!
//! In: any link and a writer. Out: the same link, and a line a message (`docs/formats.md`).

use rundown::link::{Counters, Link, LinkError, MAX_MESSAGE, Message};
use rundown_files::column::Column;
use rundown_files::table::Cell;
use std::io::{self, Read, Write};

/// Which way a message went, seen from the recorder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Away.
    Sent,
    /// Here.
    Received,
}

impl Way {
    const fn word(self) -> &'static str {
        match self {
            Self::Sent => "sent",
            Self::Received => "received",
        }
    }
}

/// One message of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordedMessage {
    /// Time of the link's clock, µs.
    pub time_us: u64,
    /// Which way it went.
    pub way: Way,
    /// Its bytes.
    pub message: Message,
}

/// Why a recording cannot be read.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "said by the messages")]
pub enum RecordError {
    #[error(transparent)]
    Csv(#[from] csv::Error),
    #[error("header: expected the columns time_us,direction,message, found {found}")]
    Header { found: String },
    #[error("{line}: {column}: expected {expected}, found `{found}`")]
    Field { line: u64, column: &'static str, expected: &'static str, found: String },
}

/// A line of a recording.
pub type RecordRow = (u64, Way, Vec<u8>);

/// The columns of a recording.
pub fn columns() -> Vec<Column<RecordRow>> {
    let bytes = "1 to 512 bytes in hexadecimal digits; what they mean is in `WIRE.md`";
    vec![
        Column::number("time_us", "\u{b5}s", "time on the clock of the link", |row: &RecordRow| Cell::Count(row.0)),
        Column::text("direction", "seen from the recorder: `sent` or `received`", |row: &RecordRow| row.1.word()),
        Column::text("message", bytes, |row: &RecordRow| hex::encode(&row.2)),
    ]
}

/// The lines of a recording.
///
/// A writer that fails does not stop what is recorded: its first error is kept for [`finish`](Self::finish), and
/// nothing more is written.
pub struct Log<W: Write> {
    csv: csv::Writer<W>,
    columns: Vec<Column<RecordRow>>,
    failed: Option<csv::Error>,
}

impl<W: Write> Log<W> {
    /// Writes the header.
    pub fn new(writer: W) -> io::Result<Self> {
        let mut csv = csv::Writer::from_writer(writer);
        let columns = columns();
        csv.write_record(columns.iter().map(|column| &column.about.name))?;
        csv.flush()?;
        Ok(Self { csv, columns, failed: None })
    }

    /// Writes a message.
    pub fn write(&mut self, time_us: u64, way: Way, message: &[u8]) {
        if self.failed.is_some() {
            return;
        }
        let row = (time_us, way, message.to_vec());
        let row = self.columns.iter().map(|column| column.cell(&row).to_field());
        // A line a message, so that what was said last is there after a crash.
        let written = self.csv.write_record(row);
        self.failed = written.and_then(|()| self.csv.flush().map_err(csv::Error::from)).err();
    }

    /// The end of the recording.
    ///
    /// # Errors
    /// The first error of the writer; the recording lacks everything from then on.
    pub fn finish(mut self) -> io::Result<()> {
        self.csv.flush()?;
        self.failed.map_or(Ok(()), |error| Err(error.into()))
    }
}

/// A link that is recorded in a [`Log`]. A message that the link refused is not.
pub struct RecordingLink<L, W: Write> {
    link: L,
    log: Log<W>,
}

impl<L: Link, W: Write> RecordingLink<L, W> {
    /// Records `link` to `writer`, a header first.
    pub fn new(link: L, writer: W) -> io::Result<Self> {
        let log = Log::new(writer)?;
        Ok(Self { link, log })
    }

    /// The end of the recording: the link again.
    pub fn finish(self) -> io::Result<L> {
        self.log.finish()?;
        Ok(self.link)
    }
}

impl<L: Link, W: Write> Link for RecordingLink<L, W> {
    type PortError = L::PortError;

    fn send(&mut self, message: &[u8], now_us: u64) -> Result<(), LinkError<L::PortError>> {
        self.link.send(message, now_us)?;
        self.log.write(now_us, Way::Sent, message);
        Ok(())
    }

    fn receive(&mut self, now_us: u64) -> Result<Option<Message>, LinkError<L::PortError>> {
        let message = self.link.receive(now_us)?;
        if let Some(message) = &message {
            self.log.write(now_us, Way::Received, message);
        }
        Ok(message)
    }

    fn is_sending(&self) -> bool {
        self.link.is_sending()
    }

    fn counters(&self) -> Counters {
        self.link.counters()
    }
}

/// The messages of a recording, in their order.
///
/// # Errors
/// [`RecordError`] at the first line that cannot be read.
pub fn read(reader: impl Read) -> Result<Vec<RecordedMessage>, RecordError> {
    let mut csv = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(reader);
    let header = csv.headers()?;
    if !header.iter().eq(columns().iter().map(|column| column.about.name.as_str())) {
        return Err(RecordError::Header { found: header.iter().collect::<Vec<_>>().join(",") });
    }
    csv.records().map(|row| recorded(&row?)).collect()
}

/// The rest of a recording that was cut off while its last line was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CutLine {
    /// Its line.
    pub line: usize,
    /// How much of it is there.
    pub bytes: usize,
}

/// The messages of a recording that may have been cut off: what is whole, and what is not.
///
/// # Errors
/// [`RecordError`] at the first line that cannot be read, but for a last one without its end.
pub fn read_whole_lines(bytes: &[u8]) -> Result<(Vec<RecordedMessage>, Option<CutLine>), RecordError> {
    let end = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
    let (whole, rest) = bytes.split_at(end);
    // Written by hand, a last line may be whole without its end.
    if end == 0 || rest.is_empty() || recorded_line(rest).is_ok() {
        return Ok((read(bytes)?, None));
    }
    let line = 1 + whole.iter().filter(|byte| **byte == b'\n').count();
    Ok((read(whole)?, Some(CutLine { line, bytes: rest.len() })))
}

/// The message of one line of a recording, which may still be growing; none in an empty line or a comment.
pub fn recorded_line(line: &[u8]) -> Result<Option<RecordedMessage>, RecordError> {
    let mut csv = csv::ReaderBuilder::new().has_headers(false).comment(Some(b'#')).from_reader(line);
    let row = csv.records().next().transpose()?;
    row.map(|row| recorded(&row)).transpose()
}

fn recorded(row: &csv::StringRecord) -> Result<RecordedMessage, RecordError> {
    let line = row.position().map_or(0, csv::Position::line);
    let field = |place: usize| row.get(place).unwrap_or_default();
    let error =
        |place: usize, column, expected| RecordError::Field { line, column, expected, found: field(place).to_owned() };
    let way = [Way::Sent, Way::Received]
        .into_iter()
        .find(|way| way.word() == field(1))
        .ok_or_else(|| error(1, "direction", "sent or received"))?;
    let message = hex::decode(field(2))
        .ok()
        .filter(|bytes| (1..=MAX_MESSAGE).contains(&bytes.len()))
        .and_then(|bytes| Message::from_slice(&bytes).ok())
        .ok_or_else(|| error(2, "message", "1 to 512 bytes in hexadecimal digits"))?;
    Ok(RecordedMessage { time_us: field(0).parse().map_err(|_| error(0, "time_us", "microseconds"))?, way, message })
}

#[cfg(test)]
mod tests {
    use super::*;
    use board_tests::pipe;
    use rundown::link::serial::SerialLink;

    #[test]
    fn a_recording_is_these_lines_and_reads_back() {
        let (here, there) = pipe::bytes();
        let mut file = Vec::new();
        let mut recorder = RecordingLink::new(SerialLink::new(here), &mut file).unwrap();
        let mut board = SerialLink::new(there);
        recorder.send(&[0, 0xAB], 10).unwrap();
        assert!(recorder.send(&[], 11).is_err(), "refused, not recorded");
        board.send(b"ok", 12).unwrap();
        assert_eq!(recorder.receive(20).unwrap().unwrap(), *b"ok");
        assert!(recorder.receive(21).unwrap().is_none());
        recorder.finish().unwrap();
        let text = String::from_utf8(file).unwrap();
        assert_eq!(text, "time_us,direction,message\n10,sent,00ab\n20,received,6f6b\n");
        let messages = read(text.as_bytes()).unwrap();
        assert_eq!(messages.len(), 2);
        assert_eq!(
            messages[1],
            RecordedMessage { time_us: 20, way: Way::Received, message: Message::from_slice(b"ok").unwrap() }
        );
    }

    #[test]
    fn a_line_that_cannot_be_read_is_named() {
        for (line, cause) in [
            ("x,sent,00", "2: time_us: expected microseconds, found `x`"),
            ("1,lost,00", "2: direction: expected sent or received, found `lost`"),
            ("1,sent,0g", "2: message: expected 1 to 512 bytes in hexadecimal digits, found `0g`"),
            ("1,sent,", "2: message: expected 1 to 512 bytes in hexadecimal digits, found ``"),
        ] {
            let text = format!("time_us,direction,message\n{line}\n");
            assert_eq!(read(text.as_bytes()).unwrap_err().to_string(), cause);
        }
        assert!(read(&b"time,way\n"[..]).is_err());
    }

    #[test]
    fn a_last_line_that_was_cut_off_is_left_out_and_said() {
        let text = b"time_us,direction,message\n10,sent,00ab\n20,received,6f6b\n";
        let cut = |bytes: usize| read_whole_lines(&text[..bytes]).map(|(messages, cut)| (messages.len(), cut)).unwrap();
        assert_eq!(cut(text.len()), (2, None));
        // Whole but for its end.
        assert_eq!(cut(text.len() - 1), (2, None));
        assert_eq!(cut(text.len() - 2), (1, Some(CutLine { line: 3, bytes: 15 })));
        assert_eq!(cut(40), (1, Some(CutLine { line: 3, bytes: 1 })));
        assert!(read_whole_lines(b"time_us,direction,message\n10,se\n20,sent,00\n").is_err(), "not the last line");
    }

    #[test]
    fn a_full_disk_does_not_stop_the_link_and_is_reported() {
        struct Full(usize);
        impl Write for Full {
            fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
                self.0 = self.0.checked_sub(bytes.len()).ok_or(io::ErrorKind::StorageFull)?;
                Ok(bytes.len())
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        let (here, _there) = pipe::bytes();
        let mut recorder = RecordingLink::new(SerialLink::new(here), Full(30)).unwrap();
        for time in 0..5 {
            recorder.send(b"message", time).unwrap();
        }
        assert!(recorder.finish().is_err());
    }
}
