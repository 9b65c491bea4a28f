//! State that stays where it is: in a static of zeros, cleared and read from its bytes field by field, so that the
//! stack holds one field at a time.

use crate::plain::Plain;
use heapless::{Deque, Vec};

/// What is never moved as a whole.
pub(crate) trait InPlace: Plain {
    /// For a static: it takes no flash, and its start no stack. `None` of a type with a regime or a flag in it is not
    /// stored as zeros; `Some` of zeros is.
    const ZEROED: Self;

    /// To the state before a run.
    fn clear_fields(&mut self);
}

macro_rules! list {
    ($List:ident) => {
        impl<T: Plain, const N: usize> InPlace for $List<T, N> {
            const ZEROED: Self = Self::new();

            fn clear_fields(&mut self) {
                self.clear();
            }
        }
    };
}

list!(Deque);
list!(Vec);

impl<T: InPlace> InPlace for Option<T> {
    const ZEROED: Self = Some(T::ZEROED);

    fn clear_fields(&mut self) {
        *self = None;
    }
}

/// A struct with [`InPlace`]. Behind each field stands what it is before a run, and `zeroed` where a static has other
/// zeros for it; `in place` for what is [`InPlace`] itself.
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
        }

        $crate::plain::plain! {
            struct $Name { $($field),* }
        }
    };
    (@zeroed (in place)) => { $crate::tick::snapshot::InPlace::ZEROED };
    (@zeroed ($clear:expr, zeroed $zeroed:expr)) => { $zeroed };
    (@zeroed ($clear:expr)) => { $clear };
    (@clear $field:expr, (in place)) => { $crate::tick::snapshot::InPlace::clear_fields(&mut $field) };
    (@clear $field:expr, ($clear:expr $(, zeroed $zeroed:expr)?)) => { $field = $clear };
}
pub(crate) use in_place;
