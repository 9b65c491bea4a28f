//! A CAN frame, classic or FD.
//!
//! In: an identifier and up to 8 (classic) or 64 bytes (FD). Out: [`CanFrame`], which is an [`embedded_can::Frame`].
//!
//! `embedded-can` has identifiers, the frame trait and the controller traits, but nothing of FD. So [`CanFrame`] holds
//! up to 64 bytes and says its [`Format`]; for classic frames it keeps the trait to the letter. For FD, `Frame::new`
//! makes an FD frame when there are more than 8 bytes and refuses lengths that FD does not have, and `dlc` is the
//! number of bytes, as for classic frames, not the code on the wire. A controller that knows classic frames only is
//! driven through [`CanFrame::to_frame`].

use core::fmt;
use embedded_can::{ExtendedId, Frame, Id, StandardId};
use heapless::Vec;

/// Most bytes in a classic frame.
pub const CLASSIC_BYTES: usize = 8;

/// Most bytes in an FD frame.
pub const FD_BYTES: usize = 64;

/// Bytes of an FD frame for each data length code.
pub const FD_LENGTHS: [u8; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64];

/// How a data frame is sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Format {
    /// Up to 8 bytes.
    #[default]
    Classic,
    /// Up to 64 bytes.
    Fd {
        /// Whether the data goes at the faster bit rate.
        bit_rate_switch: bool,
    },
}

impl Format {
    /// Most bytes in a frame.
    pub const fn capacity(self) -> usize {
        match self {
            Self::Classic => CLASSIC_BYTES,
            Self::Fd { .. } => FD_BYTES,
        }
    }
}

/// A frame of this length does not exist in its format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameLengthError {
    /// Format of the frame.
    pub format: Format,
    /// Bytes of data.
    pub found: usize,
}

impl fmt::Display for FrameLengthError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.format {
            Format::Classic => write!(f, "expected at most 8 bytes, found {}", self.found),
            Format::Fd { .. } => write!(f, "expected 0 to 8, 12, 16, 20, 24, 32, 48 or 64 bytes, found {}", self.found),
        }
    }
}

impl core::error::Error for FrameLengthError {}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Content {
    Data(Format, Vec<u8, FD_BYTES>),
    Remote { dlc: u8 },
}

/// One frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CanFrame {
    id: Id,
    content: Content,
}

impl CanFrame {
    /// A data frame.
    ///
    /// # Errors
    /// [`FrameLengthError`] when the format has no frame of this length. FD data is padded by the caller, who knows
    /// with what.
    ///
    /// ```
    /// use rundown_wire::link::can::{CanFrame, Format};
    /// use embedded_can::StandardId;
    ///
    /// let id = StandardId::new(0x6D0).unwrap();
    /// assert!(CanFrame::try_new(id, Format::Classic, &[0; 8]).is_ok());
    /// assert!(CanFrame::try_new(id, Format::Classic, &[0; 9]).is_err());
    /// assert!(CanFrame::try_new(id, Format::Fd { bit_rate_switch: true }, &[0; 9]).is_err());
    /// assert!(CanFrame::try_new(id, Format::Fd { bit_rate_switch: true }, &[0; 12]).is_ok());
    /// ```
    pub fn try_new(id: impl Into<Id>, format: Format, data: &[u8]) -> Result<Self, FrameLengthError> {
        let error = FrameLengthError { format, found: data.len() };
        let exists = match format {
            Format::Classic => data.len() <= CLASSIC_BYTES,
            Format::Fd { .. } => fd_code(data.len()).is_some(),
        };
        if !exists {
            return Err(error);
        }
        let data = Vec::from_slice(data).map_err(|_| error)?;
        Ok(Self { id: id.into(), content: Content::Data(format, data) })
    }

    /// The format of a data frame; nothing for a remote frame.
    pub const fn format(&self) -> Option<Format> {
        match &self.content {
            Content::Data(format, _) => Some(*format),
            Content::Remote { .. } => None,
        }
    }

    /// The same frame in another type, for instance that of a controller's driver; nothing when that type has no such
    /// frame.
    pub fn to_frame<F: Frame>(&self) -> Option<F> {
        match &self.content {
            Content::Data(_, data) => F::new(self.id, data),
            Content::Remote { dlc } => F::new_remote(self.id, usize::from(*dlc)),
        }
    }

    /// The frame of a controller's driver; nothing when its length is none.
    pub fn from_frame(frame: &impl Frame) -> Option<Self> {
        if frame.is_remote_frame() {
            Self::new_remote(frame.id(), frame.dlc())
        } else {
            Self::new(frame.id(), frame.data())
        }
    }
}

impl Frame for CanFrame {
    fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
        let format = if data.len() <= CLASSIC_BYTES { Format::Classic } else { Format::Fd { bit_rate_switch: false } };
        Self::try_new(id, format, data).ok()
    }

    fn new_remote(id: impl Into<Id>, dlc: usize) -> Option<Self> {
        let dlc = u8::try_from(dlc).ok().filter(|dlc| usize::from(*dlc) <= CLASSIC_BYTES)?;
        Some(Self { id: id.into(), content: Content::Remote { dlc } })
    }

    fn is_extended(&self) -> bool {
        matches!(self.id, Id::Extended(_))
    }

    fn is_remote_frame(&self) -> bool {
        matches!(self.content, Content::Remote { .. })
    }

    fn id(&self) -> Id {
        self.id
    }

    fn dlc(&self) -> usize {
        match &self.content {
            Content::Data(_, data) => data.len(),
            Content::Remote { dlc } => usize::from(*dlc),
        }
    }

    fn data(&self) -> &[u8] {
        match &self.content {
            Content::Data(_, data) => data,
            Content::Remote { .. } => &[],
        }
    }
}

/// Data length code of an FD frame of this many bytes, if there is one.
pub fn fd_code(bytes: usize) -> Option<u8> {
    let place = FD_LENGTHS.iter().position(|length| usize::from(*length) == bytes)?;
    u8::try_from(place).ok()
}

/// Smallest FD frame that takes this many bytes.
///
/// ```
/// use rundown_wire::link::can::fd_length_for;
///
/// assert_eq!(fd_length_for(8), Some(8));
/// assert_eq!(fd_length_for(9), Some(12));
/// assert_eq!(fd_length_for(65), None);
/// ```
pub fn fd_length_for(bytes: usize) -> Option<usize> {
    FD_LENGTHS.iter().map(|length| usize::from(*length)).find(|length| *length >= bytes)
}

/// Identifier with 11 bits, checked while compiling.
///
/// # Panics
/// Above 0x7FF.
pub const fn standard(id: u16) -> Id {
    match StandardId::new(id) {
        Some(id) => Id::Standard(id),
        None => panic!("a standard identifier has 11 bits"),
    }
}

/// Identifier with 29 bits, checked while compiling.
///
/// # Panics
/// Above 0x1FFF_FFFF.
pub const fn extended(id: u32) -> Id {
    match ExtendedId::new(id) {
        Some(id) => Id::Extended(id),
        None => panic!("an extended identifier has 29 bits"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_than_eight_bytes_are_fd_and_only_the_lengths_it_has() {
        let id = standard(0x6D0);
        for length in 0..=70 {
            let frame = CanFrame::new(id, &[1; 70][..length]);
            let expected = match length {
                0..=8 => Some(Format::Classic),
                12 | 16 | 20 | 24 | 32 | 48 | 64 => Some(Format::Fd { bit_rate_switch: false }),
                _ => None,
            };
            assert_eq!(frame.and_then(|frame| frame.format()), expected, "{length} bytes");
        }
    }

    #[test]
    fn an_identifier_is_extended_where_it_has_29_bits() {
        assert!(!CanFrame::new(standard(0x7FF), &[]).unwrap().is_extended());
        assert!(CanFrame::new(extended(0x7FF), &[]).unwrap().is_extended());
    }

    #[test]
    fn a_frame_survives_another_frame_type() {
        for frame in [
            CanFrame::new(standard(0x123), &[1, 2, 3]).unwrap(),
            CanFrame::new_remote(extended(0x1234_5678), 5).unwrap(),
        ] {
            let other: CanFrame = frame.to_frame().unwrap();
            assert_eq!(CanFrame::from_frame(&other), Some(frame));
        }
        assert_eq!(CanFrame::new_remote(standard(1), 9), None);
    }
}
