//! The bytes of the four kinds of ISO-TP frames.
//!
//! ```text
//! single       0L data            L = 1..7, frame of at most 8 bytes
//!              00 LL data         LL = 8..62, FD frame of more than 8 bytes
//! first        1L LL data         L LL = 12 bits
//!              10 00 LLLLLLLL ..  32 bits, big endian, only above 4095
//! consecutive  2N data            N counts 1..15, 0, 1, ..
//! flow control 3S BB TT           S: 0 continue, 1 wait, 2 overflow; BB block size; TT separation time
//! ```
//!
//! A frame with a length that the standard does not allow is refused, not guessed at. What follows the payload in a
//! single or the last consecutive frame is padding and ignored.

use crate::link::can::{CLASSIC_BYTES, FD_BYTES, Format, fd_length_for};
use heapless::Vec;

/// The data of one CAN frame.
pub type FrameData = Vec<u8, FD_BYTES>;

/// What FD frames are filled up with: alternating bits need no stuffing.
pub const PADDING: u8 = 0xCC;

/// Largest payload of a first frame with 12 bits for the length.
const SHORT_LENGTH: usize = 0xFFF;

/// What the receiver says to the sender.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlowStatus {
    /// Go on.
    Continue,
    /// Not yet; another flow control follows.
    Wait,
    /// No room for this payload.
    Overflow,
    /// A value that the standard does not have.
    Reserved(u8),
}

/// Time between consecutive frames (STmin) as it stands in a flow control.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SeparationTime(pub u8);

impl SeparationTime {
    /// No time needed.
    pub const ZERO: Self = Self(0);

    /// In microseconds. What the standard reserves counts as its longest time.
    ///
    /// ```
    /// use rundown_wire::link::isotp::pdu::SeparationTime;
    ///
    /// assert_eq!(SeparationTime(20).to_us(), 20_000);
    /// assert_eq!(SeparationTime(0xF3).to_us(), 300);
    /// assert_eq!(SeparationTime(0x80).to_us(), 127_000);
    /// ```
    pub const fn to_us(self) -> u64 {
        match self.0 {
            milliseconds @ 0..=0x7F => milliseconds as u64 * 1000,
            hundreds @ 0xF1..=0xF9 => (hundreds - 0xF0) as u64 * 100,
            _ => 127_000,
        }
    }
}

/// A flow control frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FlowControl {
    /// What to do.
    pub status: FlowStatus,
    /// Consecutive frames until the next flow control; 0 for all.
    pub block_size: u8,
    /// Time between them.
    pub separation: SeparationTime,
}

impl FlowControl {
    /// Its bytes, to be sent in this format.
    pub fn encode(self, format: Format) -> FrameData {
        let status = match self.status {
            FlowStatus::Continue => 0,
            FlowStatus::Wait => 1,
            FlowStatus::Overflow => 2,
            FlowStatus::Reserved(other) => other & 0xF,
        };
        frame(&[0x30 | status, self.block_size, self.separation.0], &[], format)
    }
}

/// What a frame is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pdu<'a> {
    /// The whole payload.
    Single(&'a [u8]),
    /// The begin of a payload.
    First {
        /// Bytes of the whole payload.
        length: usize,
        /// Those of this frame.
        data: &'a [u8],
    },
    /// The next piece, with padding if it is the last.
    Consecutive {
        /// Counts up modulo 16.
        sequence: u8,
        /// Bytes of this frame.
        data: &'a [u8],
    },
    /// What the receiver says.
    FlowControl(FlowControl),
}

errors! {
    /// A frame that ISO-TP does not have.
    #[derive(Eq)]
    #[non_exhaustive]
    pub enum PduError {
        Short { found: usize } => "frame of {found} bytes is too short",
        Kind { found: u8 } => "expected kind 0 to 3, found {found}",
        Length { found: usize, frame: usize } => "frame of {frame} bytes cannot say a length of {found}",
    }
}

/// What the data of a frame means.
///
/// # Errors
/// [`PduError`] when it means nothing.
///
/// ```
/// use rundown_wire::link::isotp::pdu::{Pdu, parse};
///
/// assert_eq!(parse(&[0x03, 1, 2, 3, 0xCC]), Ok(Pdu::Single(&[1, 2, 3])));
/// assert_eq!(parse(&[0x21, 8, 9]), Ok(Pdu::Consecutive { sequence: 1, data: &[8, 9] }));
/// ```
pub fn parse(frame: &[u8]) -> Result<Pdu<'_>, PduError> {
    let short = PduError::Short { found: frame.len() };
    let (first, rest) = frame.split_first().ok_or(short)?;
    let (kind, low) = (first >> 4, first & 0xF);
    match kind {
        0 => single(low, rest, frame.len()),
        1 => begin(low, rest, frame.len()),
        2 if !rest.is_empty() => Ok(Pdu::Consecutive { sequence: low, data: rest }),
        3 => match rest {
            [block_size, separation, ..] => Ok(Pdu::FlowControl(FlowControl {
                status: match low {
                    0 => FlowStatus::Continue,
                    1 => FlowStatus::Wait,
                    2 => FlowStatus::Overflow,
                    other => FlowStatus::Reserved(other),
                },
                block_size: *block_size,
                separation: SeparationTime(*separation),
            })),
            _ => Err(short),
        },
        2 => Err(short),
        found => Err(PduError::Kind { found }),
    }
}

fn single(low: u8, rest: &[u8], frame: usize) -> Result<Pdu<'_>, PduError> {
    let (length, data, shortest) = if frame <= CLASSIC_BYTES {
        (usize::from(low), rest, 1)
    } else {
        // The escape: the length stands in the second byte, and is one that would not have fitted into eight bytes.
        let (length, data) = rest.split_first().ok_or(PduError::Short { found: frame })?;
        if low != 0 {
            return Err(PduError::Length { found: usize::from(low), frame });
        }
        (usize::from(*length), data, CLASSIC_BYTES)
    };
    match data.get(..length) {
        Some(payload) if length >= shortest => Ok(Pdu::Single(payload)),
        _ => Err(PduError::Length { found: length, frame }),
    }
}

fn begin(low: u8, rest: &[u8], frame: usize) -> Result<Pdu<'_>, PduError> {
    // A first frame is always full: there is more to come.
    if frame < CLASSIC_BYTES {
        return Err(PduError::Short { found: frame });
    }
    let (length, data, shortest) = match rest {
        [0, a, b, c, d, data @ ..] if low == 0 => {
            let length = u32::from_be_bytes([*a, *b, *c, *d]);
            let length = usize::try_from(length).unwrap_or(usize::MAX);
            (length, data, SHORT_LENGTH + 1)
        }
        [byte, data @ ..] => {
            let length = usize::from(low) << 8 | usize::from(*byte);
            (length, data, single_capacity(frame) + 1)
        }
        [] => return Err(PduError::Short { found: frame }),
    };
    if length < shortest {
        return Err(PduError::Length { found: length, frame });
    }
    Ok(Pdu::First { length, data })
}

/// Largest payload of a single frame when frames have up to `frame` bytes.
pub const fn single_capacity(frame: usize) -> usize {
    if frame <= CLASSIC_BYTES { CLASSIC_BYTES - 1 } else { frame - 2 }
}

/// The frame that begins a payload, and how many of its bytes it holds.
pub fn encode_begin(payload: &[u8], format: Format) -> (FrameData, usize) {
    let length = payload.len();
    let capacity = format.capacity();
    // Each cast follows the comparison that makes it fit; an impossible length says itself too large for every
    // receiver.
    if length < CLASSIC_BYTES {
        (frame(&[length as u8], payload, format), length)
    } else if length <= single_capacity(capacity) {
        (frame(&[0, length as u8], payload, format), length)
    } else if length <= SHORT_LENGTH {
        let [high, low] = (length as u16).to_be_bytes();
        let data = payload.get(..capacity - 2).unwrap_or(payload);
        (frame(&[0x10 | high, low], data, format), data.len())
    } else {
        let [a, b, c, d] = u32::try_from(length).unwrap_or(u32::MAX).to_be_bytes();
        let data = payload.get(..capacity - 6).unwrap_or(payload);
        (frame(&[0x10, 0, a, b, c, d], data, format), data.len())
    }
}

/// The frame that goes on with a payload, and how many of the bytes left it holds.
pub fn encode_consecutive(sequence: u8, left: &[u8], format: Format) -> (FrameData, usize) {
    let data = left.get(..format.capacity() - 1).unwrap_or(left);
    (frame(&[0x20 | sequence & 0xF], data, format), data.len())
}

/// Header and data, padded to a length that the format has. Callers give no more than fits.
fn frame(header: &[u8], data: &[u8], format: Format) -> FrameData {
    let mut frame = FrameData::new();
    // Headers and data are cut to the capacity by the callers.
    let _fits = frame.extend_from_slice(header).and_then(|()| frame.extend_from_slice(data));
    if let Format::Fd { .. } = format
        && let Some(length) = fd_length_for(frame.len())
    {
        // A length from the table of FD is at most the capacity.
        let _fits = frame.resize(length, PADDING);
    }
    frame
}

#[cfg(test)]
mod tests {
    use super::*;

    const FD: Format = Format::Fd { bit_rate_switch: false };

    #[test]
    fn single_frames_use_the_escape_above_seven_bytes() {
        let payload: [u8; 63] = core::array::from_fn(|i| i as u8 + 1);
        for length in 1..=7 {
            let (frame, taken) = encode_begin(&payload[..length], Format::Classic);
            assert_eq!((frame[0], frame.len(), taken), (length as u8, length + 1, length));
            assert_eq!(parse(&frame), Ok(Pdu::Single(&payload[..length])));
        }
        for length in 8..=62 {
            let (frame, taken) = encode_begin(&payload[..length], FD);
            assert_eq!((frame[0], frame[1], taken), (0, length as u8, length));
            assert_eq!(parse(&frame), Ok(Pdu::Single(&payload[..length])));
        }
        let (frame, taken) = encode_begin(&payload, FD);
        assert_eq!((frame[0], frame[1], taken), (0x10, 63, 62));
    }

    #[test]
    fn first_frames_of_more_than_4095_bytes_have_32_bits_for_the_length() {
        let payload = [9; 4096];
        let (frame, taken) = encode_begin(&payload[..4095], Format::Classic);
        assert_eq!((&frame[..2], taken), (&[0x1F, 0xFF][..], 6));
        let (frame, taken) = encode_begin(&payload, Format::Classic);
        assert_eq!(frame, [0x10, 0, 0, 0, 0x10, 0, 9, 9]);
        assert_eq!(taken, 2);
        assert_eq!(parse(&frame), Ok(Pdu::First { length: 4096, data: &[9, 9] }));
    }

    #[test]
    fn a_flow_control_has_its_status_in_four_bits_and_is_read_as_it_was_sent() {
        use FlowStatus::{Continue, Overflow, Reserved, Wait};
        for (status, first) in
            [(Continue, 0x30), (Wait, 0x31), (Overflow, 0x32), (Reserved(3), 0x33), (Reserved(15), 0x3F)]
        {
            let flow_control = FlowControl { status, block_size: 8, separation: SeparationTime(20) };
            let frame = flow_control.encode(Format::Classic);
            assert_eq!(frame, [first, 8, 20]);
            assert_eq!(parse(&frame), Ok(Pdu::FlowControl(flow_control)));
        }
        let beyond = FlowControl { status: Reserved(0x43), block_size: 0, separation: SeparationTime::ZERO };
        assert_eq!(beyond.encode(Format::Classic), [0x33, 0, 0]);
    }

    #[test]
    fn separation_times_are_milliseconds_hundreds_of_microseconds_or_the_longest() {
        for (code, us) in [
            (0, 0),
            (1, 1000),
            (0x7F, 127_000),
            (0x80, 127_000),
            (0xF0, 127_000),
            (0xF1, 100),
            (0xF9, 900),
            (0xFA, 127_000),
        ] {
            assert_eq!(SeparationTime(code).to_us(), us, "{code:#x}");
        }
    }

    #[test]
    fn lengths_that_the_standard_forbids_are_refused() {
        let fd_nine = |first, second| {
            let mut frame = [0; 12];
            (frame[0], frame[1]) = (first, second);
            parse(&frame).is_err()
        };
        // Single: none, more than there is, more than seven without the escape, the escape for what fits without.
        assert!(parse(&[0]).is_err() && parse(&[0, 8, 1, 2, 3, 4, 5, 6]).is_err());
        assert!(parse(&[0x03, 1, 2]).is_err() && parse(&[0x08, 1, 2, 3, 4, 5, 6, 7]).is_err());
        assert!(fd_nine(0x05, 0) && fd_nine(0, 7) && fd_nine(0, 11) && !fd_nine(0, 10));
        // First: not full, a length that fits a single frame, 32 bits for what fits 12.
        assert!(parse(&[0x10, 9, 1, 2, 3, 4, 5]).is_err());
        assert!(parse(&[0x10, 7, 1, 2, 3, 4, 5, 6]).is_err());
        assert!(parse(&[0x10, 8, 1, 2, 3, 4, 5, 6]).is_ok());
        assert!(parse(&[0x10, 0, 0, 0, 0x0F, 0xFF, 1, 2]).is_err());
        // Consecutive without data, flow control cut short, no such kind.
        assert!(parse(&[]).is_err() && parse(&[0x21]).is_err() && parse(&[0x30, 0]).is_err());
        assert!((4..16).all(|kind| parse(&[kind << 4; 8]) == Err(PduError::Kind { found: kind })));
    }
}
