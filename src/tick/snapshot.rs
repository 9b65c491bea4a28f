//! Reading a snapshot field by field, so that the stack holds one field at a time.

use serde::Deserialize;

/// A snapshot that is read.
pub(crate) type Source<'a> = postcard::Deserializer<'a, postcard::de_flavors::Slice<'a>>;

/// Takes one field. A function of its own, so that the stack holds one field at a time and not all of them.
#[inline(never)]
pub(crate) fn take<'de, T: Deserialize<'de>>(field: &mut T, source: &mut Source<'de>) -> postcard::Result<()> {
    *field = T::deserialize(source)?;
    Ok(())
}

/// Takes the items of a list one by one, each into its place; false when there is no more room.
pub(crate) fn take_each<'de, T: Deserialize<'de>>(
    source: &mut Source<'de>,
    mut keep: impl FnMut(T) -> bool,
) -> postcard::Result<()> {
    for _ in 0..u32::deserialize(&mut *source)? {
        if !keep(T::deserialize(&mut *source)?) {
            return Err(postcard::Error::SerdeDeCustom);
        }
    }
    Ok(())
}
