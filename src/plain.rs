//! Values as plain bytes: snapshots, records, requests and digests.
//!
//! ```text
//! f64, f32          8, 4 bytes, little-endian          bool, u8      a byte
//! u16, u32, u64     7 bits a byte, the lowest first, the highest bit says that more follow
//! Option            0, or 1 and the value              an enum       number of the value, as a u32, then what it holds
//! list              its length, as a u32, then each    else          one after the other, in the order of the declaration
//! ```
//!
//! These are postcard's bytes. One function of a type serves all ways, and an error is noted and not handed up: on the
//! board this takes a third of the code of serde's derived functions. A value that is written is not changed.

use heapless::{Deque, Vec};
use nalgebra::{ArrayStorage, SMatrix};
use rundown_wire::link::checksum::Crc32c;
use rundown_wire::{Effect, Regime, SnapshotPart};

/// What can go both ways.
pub(crate) trait Plain {
    /// What a value that is read begins as.
    const START: Self;

    /// Goes through all that the value holds.
    fn pass(&mut self, bytes: &mut Bytes<'_>);

    /// [`Self::START`] by a function of its own: it writes zeros where a constant would take their room in the flash.
    #[inline(never)]
    fn start() -> Self
    where
        Self: Sized,
    {
        Self::START
    }
}

/// Which way bytes go.
enum Transfer<'a> {
    Out { buffer: &'a mut [u8], length: usize },
    In { rest: &'a [u8] },
    Digest(Crc32c),
}

/// Bytes on their way.
pub(crate) struct Bytes<'a> {
    way: Transfer<'a>,
    sound: bool,
}

/// Writes a value; none: the buffer is too short.
pub(crate) fn write<'a>(value: &mut impl Plain, buffer: &'a mut [u8]) -> Option<&'a [u8]> {
    let mut bytes = Bytes { way: Transfer::Out { buffer, length: 0 }, sound: true };
    value.pass(&mut bytes);
    match bytes {
        Bytes { way: Transfer::Out { buffer, length }, sound: true } => buffer.get(..length),
        _ => None,
    }
}

/// Reads a value in place, and what stands behind it; none: these are not its bytes.
pub(crate) fn read<'a>(value: &mut impl Plain, bytes: &'a [u8]) -> Option<&'a [u8]> {
    let mut bytes = Bytes { way: Transfer::In { rest: bytes }, sound: true };
    value.pass(&mut bytes);
    match bytes {
        Bytes { way: Transfer::In { rest }, sound: true } => Some(rest),
        _ => None,
    }
}

/// Reads a value in place; false: these are not its bytes, or there are more.
pub(crate) fn read_all(value: &mut impl Plain, bytes: &[u8]) -> bool {
    read(value, bytes).is_some_and(<[u8]>::is_empty)
}

/// CRC-32C of what passes.
pub(crate) fn digest(pass: impl FnOnce(&mut Bytes<'_>)) -> u32 {
    let mut bytes = Bytes { way: Transfer::Digest(Crc32c::START), sound: true };
    pass(&mut bytes);
    match bytes.way {
        Transfer::Digest(digest) => digest.value(),
        Transfer::Out { .. } | Transfer::In { .. } => 0,
    }
}

impl Bytes<'_> {
    /// A value is read, and there are no bytes left.
    pub(crate) fn are_at_end(&self) -> bool {
        matches!(self.way, Transfer::In { rest: [] })
    }

    /// True where a value is read, and what it was does not count.
    pub(crate) fn are_read(&self) -> bool {
        matches!(self.way, Transfer::In { .. })
    }

    /// What was read is no value.
    pub(crate) fn refuse(&mut self) {
        self.sound = false;
    }

    /// One piece of fixed length; what cannot be read stays.
    #[inline(never)]
    pub(crate) fn piece(&mut self, piece: &mut [u8]) {
        match &mut self.way {
            Transfer::Out { buffer, length } => match buffer.get_mut(*length..*length + piece.len()) {
                Some(free) => {
                    free.copy_from_slice(piece);
                    *length += piece.len();
                }
                None => self.sound = false,
            },
            Transfer::In { rest } => match rest.split_at_checked(piece.len()) {
                Some((now, behind)) => {
                    piece.copy_from_slice(now);
                    *rest = behind;
                }
                None => self.sound = false,
            },
            Transfer::Digest(digest) => digest.update(piece),
        }
    }

    /// One byte.
    #[inline(never)]
    fn byte(&mut self, byte: u8) -> u8 {
        match &mut self.way {
            Transfer::Out { buffer, length } => match buffer.get_mut(*length) {
                Some(free) => {
                    *free = byte;
                    *length += 1;
                }
                None => self.sound = false,
            },
            Transfer::In { rest } => match rest.split_first() {
                Some((first, behind)) => {
                    *rest = behind;
                    return *first;
                }
                None => self.sound = false,
            },
            Transfer::Digest(digest) => digest.update(&[byte]),
        }
        byte
    }

    /// Numbers, eight bytes each. Most of a snapshot is written here, so the way is asked for once.
    #[inline(never)]
    pub(crate) fn numbers(&mut self, numbers: &mut [f64]) {
        let size = 8 * numbers.len();
        match &mut self.way {
            Transfer::Out { buffer, length } => match buffer.get_mut(*length..*length + size) {
                Some(free) => {
                    for (piece, number) in free.as_chunks_mut().0.iter_mut().zip(numbers) {
                        *piece = number.to_le_bytes();
                    }
                    *length += size;
                }
                None => self.sound = false,
            },
            Transfer::In { rest } => match rest.split_at_checked(size) {
                Some((now, behind)) => {
                    for (piece, number) in now.as_chunks().0.iter().zip(numbers) {
                        *number = f64::from_le_bytes(*piece);
                    }
                    *rest = behind;
                }
                None => self.sound = false,
            },
            Transfer::Digest(digest) => numbers.iter().for_each(|number| digest.update(&number.to_le_bytes())),
        }
    }

    /// A count of at most so many bits.
    #[inline(never)]
    pub(crate) fn count(&mut self, count: u64, bits: u32) -> u64 {
        let (mut left, mut found) = (count, 0);
        for shift in (0..bits).step_by(7) {
            let byte = self.byte(if left < 0x80 { left as u8 } else { left as u8 | 0x80 });
            left >>= 7;
            let value = u64::from(byte & 0x7F);
            // The last byte has room for fewer bits.
            if bits - shift < 7 && value >> (bits - shift) != 0 {
                break;
            }
            found |= value << shift;
            if byte < 0x80 {
                return found;
            }
        }
        self.refuse();
        count
    }

    /// Many counts of 32 bits, most of them small.
    #[inline(never)]
    pub(crate) fn counts(&mut self, counts: &mut [u32]) {
        for count in counts {
            match &mut self.way {
                Transfer::Out { buffer, length } if *count < 0x80 && *length < buffer.len() => {
                    if let Some(free) = buffer.get_mut(*length) {
                        *free = *count as u8;
                        *length += 1;
                    }
                }
                _ => *count = self.count((*count).into(), u32::BITS) as u32,
            }
        }
    }

    /// Which one of so many.
    #[inline(never)]
    pub(crate) fn choice(&mut self, now: usize, of: usize) -> usize {
        let found = self.count(now as u64, u32::BITS) as usize;
        if found < of {
            return found;
        }
        self.refuse();
        now
    }

    /// Whether there is a value, or a flag is set.
    fn flag(&mut self, flag: bool) -> bool {
        let byte = self.byte(flag.into());
        if byte > 1 {
            self.refuse();
        }
        byte == 1
    }
}

impl Plain for f64 {
    const START: Self = 0.0;

    // Called for most of all fields: inlined it takes more of the board's flash.
    #[inline(never)]
    fn pass(&mut self, bytes: &mut Bytes<'_>) {
        bytes.numbers(core::slice::from_mut(self));
    }
}

impl Plain for f32 {
    const START: Self = 0.0;

    fn pass(&mut self, bytes: &mut Bytes<'_>) {
        let mut piece = self.to_le_bytes();
        bytes.piece(&mut piece);
        *self = Self::from_le_bytes(piece);
    }
}

impl Plain for bool {
    const START: Self = false;

    fn pass(&mut self, bytes: &mut Bytes<'_>) {
        *self = bytes.flag(*self);
    }
}

impl Plain for u8 {
    const START: Self = 0;

    fn pass(&mut self, bytes: &mut Bytes<'_>) {
        *self = bytes.byte(*self);
    }
}

macro_rules! counts {
    ($($Count:ident),*) => {$(
        impl Plain for $Count {
            const START: Self = 0;

            fn pass(&mut self, bytes: &mut Bytes<'_>) {
                *self = bytes.count((*self).into(), Self::BITS) as Self;
            }
        }
    )*};
}

counts!(u16, u32, u64);

impl<T: Plain> Plain for Option<T> {
    const START: Self = None;

    fn pass(&mut self, bytes: &mut Bytes<'_>) {
        let there = bytes.flag(self.is_some());
        if bytes.are_read() {
            *self = None;
            if there {
                *self = Some(T::START);
            }
        }
        if let Some(value) = self {
            value.pass(bytes);
        }
    }
}

impl<T: Plain, const N: usize> Plain for [T; N] {
    const START: Self = [T::START; N];

    fn pass(&mut self, bytes: &mut Bytes<'_>) {
        self.iter_mut().for_each(|value| value.pass(bytes));
    }
}

impl<A: Plain, B: Plain> Plain for (A, B) {
    const START: Self = (A::START, B::START);

    fn pass(&mut self, bytes: &mut Bytes<'_>) {
        self.0.pass(bytes);
        self.1.pass(bytes);
    }
}

macro_rules! list {
    ($List:ident, $push:ident) => {
        impl<T: Plain, const N: usize> Plain for $List<T, N> {
            const START: Self = Self::new();

            fn pass(&mut self, bytes: &mut Bytes<'_>) {
                let length = bytes.choice(self.len(), N + 1);
                if bytes.are_read() {
                    self.clear();
                    for _ in 0..length {
                        // There is room for `N`.
                        let _kept = self.$push(T::start()).is_ok();
                    }
                }
                self.iter_mut().for_each(|value| value.pass(bytes));
            }
        }
    };
}

list!(Deque, push_back);
list!(Vec, push);

impl<const R: usize, const C: usize> Plain for SMatrix<f64, R, C> {
    const START: Self = Self::from_array_storage(ArrayStorage([[0.0; R]; C]));

    fn pass(&mut self, bytes: &mut Bytes<'_>) {
        bytes.numbers(self.as_mut_slice());
    }
}

/// Structs by all their fields, and enums without fields by all their values.
macro_rules! plain {
    ($(struct $Name:ty { $($field:ident),* $(,)? })*) => {$(
        impl $crate::plain::Plain for $Name {
            const START: Self = Self { $($field: $crate::plain::Plain::START),* };

            #[inline(never)]
            fn pass(&mut self, bytes: &mut $crate::plain::Bytes<'_>) {
                $($crate::plain::Plain::pass(&mut self.$field, bytes);)*
            }
        }
    )*};
    ($(enum $Name:ident { $First:ident $(, $Other:ident)* $(,)? })*) => {$(
        impl $crate::plain::Plain for $Name {
            const START: Self = Self::$First;

            fn pass(&mut self, bytes: &mut $crate::plain::Bytes<'_>) {
                let all = [Self::$First $(, Self::$Other)*];
                let chosen = bytes.choice(*self as usize, all.len());
                *self = all.get(chosen).copied().unwrap_or(*self);
            }
        }
    )*};
}

/// Declares an enum of which each value holds one thing: what stands first is 0.
macro_rules! plain_choice {
    (
        $(#[$attribute:meta])* pub enum $Name:ident {
            $(#[$first:meta])* $First:ident($FirstType:ty)
            $(, $(#[$other:meta])* $Other:ident($Type:ty))* $(,)?
        }
    ) => {
        $(#[$attribute])*
        pub enum $Name {
            $(#[$first])*
            $First($FirstType),
            $($(#[$other])* $Other($Type),)*
        }

        impl $crate::plain::Plain for $Name {
            const START: Self = Self::$First(<$FirstType as $crate::plain::Plain>::START);

            fn pass(&mut self, bytes: &mut $crate::plain::Bytes<'_>) {
                /// The values by their numbers alone.
                enum Numbered { $First $(, $Other)* }
                let values = [Numbered::$First $(, Numbered::$Other)*].len();
                let now = match self {
                    Self::$First(_) => Numbered::$First,
                    $(Self::$Other(_) => Numbered::$Other,)*
                };
                let chosen = bytes.choice(now as usize, values);
                if bytes.are_read() {
                    *self = Self::START;
                    $(
                        if chosen == Numbered::$Other as usize {
                            *self = Self::$Other(<$Type as $crate::plain::Plain>::START);
                        }
                    )*
                }
                match self {
                    Self::$First(value) => $crate::plain::Plain::pass(value, bytes),
                    $(Self::$Other(value) => $crate::plain::Plain::pass(value, bytes),)*
                }
            }
        }
    };
}
pub(crate) use {plain, plain_choice};

plain! {
    struct Effect { kind, section_m, values }
}

impl Plain for SnapshotPart {
    const START: Self = Self { tick: 0, setup: 0, crc: 0, total: 0, first: 0, bytes: Vec::new() };

    fn pass(&mut self, bytes: &mut Bytes<'_>) {
        self.tick.pass(bytes);
        for digest in [&mut self.setup, &mut self.crc] {
            let mut piece = digest.to_le_bytes();
            bytes.piece(&mut piece);
            *digest = u32::from_le_bytes(piece);
        }
        self.total.pass(bytes);
        self.first.pass(bytes);
        self.bytes.pass(bytes);
    }
}

plain! {
    enum Regime { Standstill, Traction, Cruise, Coast, Brake }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Many = (([f64; 2], Option<f64>), ((u16, u32), (Option<(bool, u8)>, (Regime, Vec<(f32, f32), 3>))));

    fn many() -> Many {
        let list = [(1.5, -2.5), (0.0, f32::MAX)].into_iter().collect();
        (([1.25, -0.0], Some(f64::MIN)), ((u16::MAX, 300), (Some((true, 0xFF)), (Regime::Brake, list))))
    }

    #[test]
    fn the_bytes_are_those_of_postcard() {
        let (mut buffer, mut expected) = ([0; 80], [0; 80]);
        let expected = postcard::to_slice(&many(), &mut expected).unwrap();
        assert_eq!(write(&mut many(), &mut buffer).unwrap(), expected);
        let mut found = Many::START;
        assert!(read_all(&mut found, expected));
        assert_eq!(found, many());
    }

    #[test]
    fn too_few_bytes_and_too_many_are_refused() {
        let mut buffer = [0; 80];
        let length = write(&mut many(), &mut buffer).unwrap().len();
        for wrong in (0..80).filter(|wrong| *wrong != length) {
            let mut value = Many::START;
            assert!(!read_all(&mut value, &buffer[..wrong]), "{wrong} of {length} bytes");
        }
        for short in 0..length {
            assert!(write(&mut many(), &mut [0; 80][..short]).is_none(), "room for {short} of {length} bytes");
        }
    }

    #[test]
    fn counts_are_written_alike_by_one_and_by_many() {
        let mut counts = [0, 1, 0x7F, 0x80, 0x3FFF, 0x4000, u32::MAX];
        let (mut one, mut many) = ([0; 40], [0; 40]);
        let mut bytes = Bytes { way: Transfer::Out { buffer: &mut many, length: 0 }, sound: true };
        bytes.counts(&mut counts);
        assert!(bytes.sound);
        assert_eq!(write(&mut counts, &mut one).unwrap(), &many[..15]);
    }

    /// Every pair of bytes before some that end each count, read by this and by postcard.
    #[test]
    fn what_is_refused_is_what_postcard_refuses() {
        fn same<'a, T: Plain + PartialEq + core::fmt::Debug + serde::Deserialize<'a>>(bytes: &'a [u8]) {
            let mut value = T::START;
            let found = read(&mut value, bytes).map(|rest| (value, rest));
            assert_eq!(found, postcard::take_from_bytes(bytes).ok(), "{bytes:x?}");
        }
        for pair in 0..=u16::MAX {
            let [a, b] = pair.to_le_bytes();
            let short = [a, b, 3];
            same::<u16>(&short);
            same::<(Option<u8>, bool)>(&short);
            same::<Regime>(&short);
            same::<Vec<u8, 2>>(&short);
            same::<u16>(&[a, 0x80, b]);
            same::<u32>(&[a, 0x80, 0x80, 0xFF, b]);
            same::<u32>(&[0x80, 0x80, 0x80, a, b, 0]);
        }
    }
}
