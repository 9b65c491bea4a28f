//! State that stays where it is: in a static of zeros, cleared and read from a snapshot field by field, so that the stack holds one field at a time.

use heapless::{Deque, Vec};
use serde::Deserialize;

/// A snapshot that is read.
pub(crate) type Source<'a> = postcard::Deserializer<'a, postcard::de_flavors::Slice<'a>>;

/// What is never moved as a whole.
pub(crate) trait InPlace {
    /// For a static: it takes no flash, and its start no stack. `None` of a type with a regime or a flag in it is not stored as zeros; `Some` of zeros is.
    const ZEROED: Self;

    /// To the state before a run.
    fn clear_fields(&mut self);

    /// Takes the fields of a snapshot in the order in which they are declared, which is the order in which they were written.
    fn take_fields(&mut self, source: &mut Source<'_>) -> postcard::Result<()>;
}

/// Takes one field. A function of its own, so that the stack holds one field at a time and not all of them.
#[inline(never)]
pub(crate) fn take<'de, T: Deserialize<'de>>(field: &mut T, source: &mut Source<'de>) -> postcard::Result<()> {
    *field = T::deserialize(source)?;
    Ok(())
}

/// Takes the items of a list one by one, each into its place; false when there is no more room.
fn take_each<T: for<'de> Deserialize<'de>>(
    source: &mut Source<'_>,
    mut keep: impl FnMut(T) -> bool,
) -> postcard::Result<()> {
    for _ in 0..u32::deserialize(&mut *source)? {
        if !keep(T::deserialize(&mut *source)?) {
            return Err(postcard::Error::SerdeDeCustom);
        }
    }
    Ok(())
}

macro_rules! list {
    ($List:ident, $push:ident) => {
        impl<T: for<'de> Deserialize<'de>, const N: usize> InPlace for $List<T, N> {
            const ZEROED: Self = Self::new();

            fn clear_fields(&mut self) {
                self.clear();
            }

            fn take_fields(&mut self, source: &mut Source<'_>) -> postcard::Result<()> {
                self.clear();
                take_each(source, |item| self.$push(item).is_ok())
            }
        }
    };
}

list!(Deque, push_back);
list!(Vec, push);

impl<T: InPlace> InPlace for Option<T> {
    const ZEROED: Self = Some(T::ZEROED);

    fn clear_fields(&mut self) {
        *self = None;
    }

    fn take_fields(&mut self, source: &mut Source<'_>) -> postcard::Result<()> {
        *self = None;
        let mut there = false;
        take(&mut there, source)?;
        if there { self.insert(T::ZEROED).take_fields(source) } else { Ok(()) }
    }
}

/// A struct with [`InPlace`]. Behind each field stands what it is before a run, and `zeroed` where a static has other zeros for it;
/// `in place` for what is [`InPlace`] itself.
macro_rules! in_place {
    ($(#[$attribute:meta])* $visibility:vis struct $Name:ident {
        $($(#[$of_field:meta])* $of:vis $field:ident: $Type:ty = $how:tt;)*
    }) => {
        $(#[$attribute])*
        $visibility struct $Name {
            $($(#[$of_field])* $of $field: $Type,)*
        }

        impl $crate::tick::snapshot::InPlace for $Name {
            const ZEROED: Self = Self { $($field: in_place!(@zeroed $how),)* };

            fn clear_fields(&mut self) {
                $(in_place!(@clear self.$field, $how);)*
            }

            #[inline(never)]
            fn take_fields(&mut self, source: &mut $crate::tick::snapshot::Source<'_>) -> postcard::Result<()> {
                $(in_place!(@take self.$field, source, $how)?;)*
                Ok(())
            }
        }
    };
    (@zeroed (in place)) => { $crate::tick::snapshot::InPlace::ZEROED };
    (@zeroed ($clear:expr, zeroed $zeroed:expr)) => { $zeroed };
    (@zeroed ($clear:expr)) => { $clear };
    (@clear $field:expr, (in place)) => { $crate::tick::snapshot::InPlace::clear_fields(&mut $field) };
    (@clear $field:expr, ($clear:expr $(, zeroed $zeroed:expr)?)) => { $field = $clear };
    (@take $field:expr, $source:ident, (in place)) => { $crate::tick::snapshot::InPlace::take_fields(&mut $field, $source) };
    (@take $field:expr, $source:ident, $how:tt) => { $crate::tick::snapshot::take(&mut $field, $source) };
}
pub(crate) use in_place;
