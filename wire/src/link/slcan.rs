//! CAN frames as text on a serial line, after Lawicel's CAN232, with the FD lines of CANable.
//!
//! In: frames. Out: lines that end with a carriage return; and back.
//!
//! ```text
//! tIIIL..      classic, 11 bits          dIIIL..      FD
//! TIIIIIIIIL.. classic, 29 bits          DIIIIIIIIL.. FD
//! rIIIL        remote, 11 bits           bIIIL..      FD with bit rate switch
//! RIIIIIIIIL   remote, 29 bits           BIIIIIIIIL.. FD with bit rate switch
//! ```
//!
//! I: identifier, L: data length code (one digit; FD up to F for 64 bytes), then two digits a byte, all hexadecimal.
//! Four more digits, a time stamp, are read over. Every other line of letters is a command; a single BEL says that a
//! command was refused. Lines have no checksum: a message's own CRC-32C is what protects it.

use super::can::{CanFrame, FD_BYTES, FD_LENGTHS, Format, fd_code};
use super::{WriteError, count, write_whole};
use core::fmt;
use embedded_can::{ExtendedId, Frame, Id, StandardId};
use embedded_io::{Read, ReadReady, Write};
use heapless::Vec;

/// Longest line: letter, eight digits of identifier, length, 64 bytes, time stamp, carriage return.
pub const MAX_LINE: usize = 1 + 8 + 1 + 2 * FD_BYTES + 4 + 1;

const RETURN: u8 = b'\r';
const BELL: u8 = 0x07;

/// Lines that one call of `receive` reads at most, in bytes.
const BYTES_PER_CALL: usize = 16 * MAX_LINE;

/// What a line says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Line {
    /// A frame.
    Frame(CanFrame),
    /// A command, by its letter.
    Command(u8),
    /// The device did what it was asked to.
    Done,
    /// The device refused.
    Refused,
}

errors! {
    /// A line that is none.
    #[derive(Eq)]
    #[non_exhaustive]
    pub enum SlcanError {
        /// More than [`MAX_LINE`] bytes.
        TooLong => "line of more than {MAX_LINE} bytes",
        /// A character that is not a hexadecimal digit where one is due, or too few of them.
        Digits => "expected more hexadecimal digits",
        Identifier { found: u32 } => "expected an identifier of 11 or 29 bits, found {found:x}",
        Length { found: u8 } => "expected a length that the frame has, found {found:x}",
        Trailing { found: usize } => "{found} characters too many",
        Letter { found: u8 } => "expected a letter, found {found:#04x}",
    }
}

/// The line of a frame, with its carriage return.
///
/// ```
/// use rundown_wire::link::can::{CanFrame, standard};
/// use rundown_wire::link::slcan::encode;
/// use embedded_can::Frame;
///
/// let frame = CanFrame::new(standard(0x6D0), &[0x03, 0x11, 0x22, 0xAB]).unwrap();
/// assert_eq!(encode(&frame), b"t6D04031122AB\r");
/// ```
pub fn encode(frame: &CanFrame) -> Vec<u8, MAX_LINE> {
    let (short, long) = match frame.format() {
        None => (b'r', b'R'),
        Some(Format::Classic) => (b't', b'T'),
        Some(Format::Fd { bit_rate_switch: false }) => (b'd', b'D'),
        Some(Format::Fd { bit_rate_switch: true }) => (b'b', b'B'),
    };
    let (letter, id, digits) = match frame.id() {
        Id::Standard(id) => (short, u32::from(id.as_raw()), 3),
        Id::Extended(id) => (long, id.as_raw(), 8),
    };
    let mut line: Vec<u8, MAX_LINE> = Vec::new();
    // The line has room for the longest frame. (Collecting it would bring in a panic that is never reached.)
    let mut push = |character| {
        let _fits = line.push(character);
    };
    push(letter);
    for place in (0..digits).rev() {
        push(digit(id >> (4 * place)));
    }
    // A frame has a length of its format, so it has a code.
    push(digit(u32::from(fd_code(frame.dlc()).unwrap_or_default())));
    for byte in frame.data() {
        push(digit(u32::from(byte >> 4)));
        push(digit(u32::from(byte & 0xF)));
    }
    push(RETURN);
    line
}

fn digit(value: u32) -> u8 {
    match u8::try_from(value & 0xF) {
        Ok(value @ 0..=9) => b'0' + value,
        Ok(value) => b'A' + (value - 10),
        Err(_) => b'0',
    }
}

fn value(digit: u8) -> Result<u32, SlcanError> {
    char::from(digit).to_digit(16).ok_or(SlcanError::Digits)
}

fn number(digits: &[u8]) -> Result<u32, SlcanError> {
    digits.iter().try_fold(0, |sum, digit| Ok(sum << 4 | value(*digit)?))
}

/// What a line without its carriage return says.
///
/// # Errors
/// [`SlcanError`] when it says nothing.
pub fn parse(line: &[u8]) -> Result<Line, SlcanError> {
    let Some((&letter, rest)) = line.split_first() else {
        return Ok(Line::Done);
    };
    let fd = |bit_rate_switch| Some(Format::Fd { bit_rate_switch });
    let format = match letter {
        b't' | b'T' => Some(Format::Classic),
        b'd' | b'D' => fd(false),
        b'b' | b'B' => fd(true),
        b'r' | b'R' => None,
        // The answer to a frame when the device confirms each.
        b'z' | b'Z' if rest.is_empty() => return Ok(Line::Done),
        _ if letter.is_ascii_alphabetic() => return Ok(Line::Command(letter)),
        found => return Err(SlcanError::Letter { found }),
    };
    let digits = if letter.is_ascii_uppercase() { 8 } else { 3 };
    let (id, rest) = rest.split_at_checked(digits).ok_or(SlcanError::Digits)?;
    let found = number(id)?;
    let id = if letter.is_ascii_uppercase() {
        ExtendedId::new(found).map(Id::Extended)
    } else {
        u16::try_from(found).ok().and_then(StandardId::new).map(Id::Standard)
    }
    .ok_or(SlcanError::Identifier { found })?;
    let (&code, rest) = rest.split_first().ok_or(SlcanError::Digits)?;
    let code = u8::try_from(value(code)?).unwrap_or(u8::MAX);
    let wrong_length = SlcanError::Length { found: code };
    let bytes = FD_LENGTHS.get(usize::from(code)).map(|bytes| usize::from(*bytes)).ok_or(wrong_length)?;
    let expected = if format.is_some() { bytes } else { 0 };
    let (digits, stamp) = rest.split_at_checked(2 * expected).ok_or(SlcanError::Digits)?;
    match stamp.len() {
        0 => {}
        4 => {
            number(stamp)?;
        }
        found => return Err(SlcanError::Trailing { found }),
    }
    let mut data: Vec<u8, FD_BYTES> = Vec::new();
    for pair in digits.chunks_exact(2) {
        let byte = u8::try_from(number(pair)?).map_err(|_| SlcanError::Digits)?;
        data.push(byte).map_err(|_| wrong_length)?;
    }
    let frame = match format {
        Some(format) => CanFrame::try_new(id, format, &data).ok(),
        None => CanFrame::new_remote(id, bytes),
    };
    frame.map(Line::Frame).ok_or(wrong_length)
}

/// Takes bytes one by one and gives lines.
#[derive(Debug, Default)]
pub struct LineDecoder {
    line: Vec<u8, MAX_LINE>,
    overflow: bool,
}

impl LineDecoder {
    /// A decoder at the begin of a line.
    pub const fn new() -> Self {
        Self { line: Vec::new(), overflow: false }
    }

    /// Takes the next byte. A carriage return or BEL ends a line; line feeds are read over.
    ///
    /// # Errors
    /// [`SlcanError`] at the end of a line that is none. The decoder goes on with the next.
    pub fn push(&mut self, byte: u8) -> Result<Option<Line>, SlcanError> {
        match byte {
            BELL => {
                self.clear();
                Ok(Some(Line::Refused))
            }
            RETURN if self.overflow => {
                self.clear();
                Err(SlcanError::TooLong)
            }
            RETURN => {
                let line = parse(&self.line);
                self.clear();
                line.map(Some)
            }
            b'\n' => Ok(None),
            _ => {
                self.overflow |= self.line.push(byte).is_err();
                Ok(None)
            }
        }
    }

    fn clear(&mut self) {
        self.line.clear();
        self.overflow = false;
    }
}

/// A CAN controller at the other end of a serial line, or the side that plays one.
///
/// [`Slcan::device`] answers commands as an adapter does: bit rate and channel commands (`S s Y O L C`) with a carriage
/// return, since there is no bus behind it to set up, all others with BEL. Frames are not confirmed. [`Slcan::open`] is
/// the host's side: it opens the channel of an adapter.
#[derive(Debug)]
pub struct Slcan<P> {
    port: P,
    decoder: LineDecoder,
    answers: bool,
    // A line was cut by a port that was full: the next begins with its end.
    cut: bool,
    damaged: u32,
    refused: u32,
}

impl<P> Slcan<P> {
    /// The side that plays a controller.
    pub const fn device(port: P) -> Self {
        Self::new(port, true)
    }

    const fn new(port: P, answers: bool) -> Self {
        Self { port, decoder: LineDecoder::new(), answers, cut: false, damaged: 0, refused: 0 }
    }

    /// Lines that were none. The messages they were part of are counted by the link.
    pub const fn damaged(&self) -> u32 {
        self.damaged
    }

    /// Commands that the other side refused.
    pub const fn refused(&self) -> u32 {
        self.refused
    }

    /// The port below.
    pub const fn port_mut(&mut self) -> &mut P {
        &mut self.port
    }
}

impl<P: Write> Slcan<P> {
    /// The host's side. Closes the channel, sets the bit rate (`S0` 10 kbit/s to `S8` 1 Mbit/s) if one is given and
    /// opens it.
    ///
    /// # Errors
    /// Those of the port.
    pub fn open(port: P, bit_rate: Option<BitRate>) -> Result<Self, PortError<P::Error>> {
        let mut adapter = Self::new(port, false);
        // The first return ends what noise began.
        adapter.write(b"\rC\r")?;
        if let Some(bit_rate) = bit_rate {
            adapter.write(&[b'S', bit_rate.digit(), RETURN])?;
        }
        adapter.write(b"O\r")?;
        Ok(adapter)
    }
}

/// Bit rate of the bus behind an adapter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum BitRate {
    /// 10 kbit/s.
    Kbit10,
    /// 20 kbit/s.
    Kbit20,
    /// 50 kbit/s.
    Kbit50,
    /// 100 kbit/s.
    Kbit100,
    /// 125 kbit/s.
    Kbit125,
    /// 250 kbit/s.
    Kbit250,
    /// 500 kbit/s.
    Kbit500,
    /// 800 kbit/s. (python-can takes this code for 750.)
    Kbit800,
    /// 1 Mbit/s.
    Kbit1000,
}

impl BitRate {
    const fn digit(self) -> u8 {
        b'0' + self as u8
    }
}

/// How a port fails, as an error of a controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PortError<E> {
    /// The port failed.
    Port(E),
    /// The port took a part of a line or nothing, and no more.
    Full,
}

impl<E> From<WriteError<E>> for PortError<E> {
    fn from(error: WriteError<E>) -> Self {
        match error {
            WriteError::Port(error) => Self::Port(error),
            WriteError::Full => Self::Full,
        }
    }
}

impl<E: fmt::Display> fmt::Display for PortError<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Port(error) => error.fmt(f),
            Self::Full => f.write_str("the port takes no more bytes"),
        }
    }
}

impl<E: core::error::Error> core::error::Error for PortError<E> {}

impl<E: fmt::Debug> embedded_can::Error for PortError<E> {
    fn kind(&self) -> embedded_can::ErrorKind {
        embedded_can::ErrorKind::Other
    }
}

impl<P: Write> Slcan<P> {
    fn write(&mut self, line: &[u8]) -> Result<(), PortError<P::Error>> {
        if self.cut {
            write_whole(&mut self.port, &[RETURN])?;
        }
        self.cut = true;
        write_whole(&mut self.port, line)?;
        self.cut = false;
        self.port.flush().map_err(PortError::Port)
    }
}

impl<P: Read + ReadReady + Write> embedded_can::nb::Can for Slcan<P> {
    type Frame = CanFrame;
    type Error = PortError<P::Error>;

    fn transmit(&mut self, frame: &CanFrame) -> nb::Result<Option<CanFrame>, Self::Error> {
        match self.write(&encode(frame)) {
            Ok(()) => Ok(None),
            // Sent again as a whole; the other side drops what it has of the cut line.
            Err(PortError::Full) => Err(nb::Error::WouldBlock),
            Err(error) => Err(nb::Error::Other(error)),
        }
    }

    fn receive(&mut self) -> nb::Result<CanFrame, Self::Error> {
        for _ in 0..BYTES_PER_CALL {
            let mut byte = [0];
            if !self.port.read_ready().map_err(PortError::Port)?
                || self.port.read(&mut byte).map_err(PortError::Port)? == 0
            {
                return Err(nb::Error::WouldBlock);
            }
            let [byte] = byte;
            match self.decoder.push(byte) {
                Ok(Some(Line::Frame(frame))) => return Ok(frame),
                Ok(Some(Line::Command(letter))) if self.answers => {
                    let answer = match letter {
                        b'S' | b's' | b'Y' | b'O' | b'L' | b'C' => RETURN,
                        _ => BELL,
                    };
                    match self.write(&[answer]) {
                        // An answer for which there is no room is left out: adapters' hosts do not wait for one.
                        Ok(()) | Err(PortError::Full) => {}
                        Err(error) => return Err(nb::Error::Other(error)),
                    }
                }
                Ok(Some(Line::Refused)) => count(&mut self.refused),
                Ok(_) => {}
                Err(_) => count(&mut self.damaged),
            }
        }
        Err(nb::Error::WouldBlock)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::can::{extended, standard};

    #[test]
    fn every_kind_of_frame_has_its_line() {
        let fd = |bit_rate_switch| Format::Fd { bit_rate_switch };
        let (short, long) = (standard(0x6D0), extended(0x1234_ABCD));
        for (frame, line) in [
            (CanFrame::try_new(short, Format::Classic, &[1, 0xFE]), "t6D0201FE\r"),
            (CanFrame::try_new(long, Format::Classic, &[]), "T1234ABCD0\r"),
            (CanFrame::try_new(short, fd(false), &[7; 12]), "d6D09070707070707070707070707\r"),
            (CanFrame::try_new(long, fd(true), &[5]), "B1234ABCD105\r"),
        ] {
            let frame = frame.unwrap();
            assert_eq!(encode(&frame), line.as_bytes());
            let line = line.trim_end().as_bytes();
            assert_eq!(parse(line), Ok(Line::Frame(frame.clone())));
        }
        let remote = CanFrame::new_remote(short, 4).unwrap();
        assert_eq!(encode(&remote), b"r6D04\r");
        assert_eq!(parse(b"r6D04"), Ok(Line::Frame(remote)));
        let longest = CanFrame::try_new(long, fd(true), &[9; 64]).unwrap();
        assert_eq!(encode(&longest).len(), MAX_LINE - 4);
    }

    #[test]
    fn lines_that_are_none_say_why() {
        for (line, error) in [
            ("t6D", SlcanError::Digits),
            ("t6D02ab", SlcanError::Digits),
            ("t6D01xx", SlcanError::Digits),
            ("tFFF0", SlcanError::Identifier { found: 0xFFF }),
            ("T200000000", SlcanError::Identifier { found: 0x2000_0000 }),
            ("t6D09010203040506070809101112", SlcanError::Length { found: 9 }),
            ("t6D01abc", SlcanError::Trailing { found: 1 }),
            ("7", SlcanError::Letter { found: b'7' }),
        ] {
            assert_eq!(parse(line.as_bytes()), Err(error), "{line}");
        }
        assert!(matches!(parse(b"t6D01ab1234"), Ok(Line::Frame(_))), "time stamp");
        assert_eq!(parse(b"S6"), Ok(Line::Command(b'S')));
    }

    #[test]
    fn a_device_confirms_with_nothing_or_with_a_z() {
        for line in [&b""[..], b"z", b"Z"] {
            assert_eq!(parse(line), Ok(Line::Done));
        }
        assert_eq!(parse(b"z1"), Ok(Line::Command(b'z')), "with more it is a command");
    }

    #[test]
    fn an_endless_line_is_refused_and_the_next_is_read() {
        let mut decoder = LineDecoder::new();
        for _ in 0..1000 {
            assert_eq!(decoder.push(b't'), Ok(None));
        }
        assert_eq!(decoder.push(b'\r'), Err(SlcanError::TooLong));
        let mut last = None;
        for byte in b"t12300\r\nt1230\r" {
            last = decoder.push(*byte).ok().flatten();
        }
        assert!(matches!(last, Some(Line::Frame(_))));
    }
}
