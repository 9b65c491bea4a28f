//! Fixed fields in a run of bytes, little-endian; what does not fit is `None`, never a panic.

/// Takes the next N bytes off the front.
pub(crate) fn take<const N: usize>(bytes: &mut &[u8]) -> Option<[u8; N]> {
    let (first, rest) = bytes.split_first_chunk()?;
    *bytes = rest;
    Some(*first)
}

/// Writes a field to the front and moves on behind it.
pub(crate) fn put(space: &mut &mut [u8], field: &[u8]) -> Option<()> {
    let (first, rest) = core::mem::take(space).split_at_mut_checked(field.len())?;
    first.copy_from_slice(field);
    *space = rest;
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_put_is_taken_in_order() {
        let mut buffer = [0; 3];
        let mut space: &mut [u8] = &mut buffer;
        assert_eq!(put(&mut space, &[1, 2]), Some(()));
        assert_eq!(put(&mut space, &[3]), Some(()));
        assert_eq!(put(&mut space, &[4]), None);
        let mut bytes: &[u8] = &buffer;
        assert_eq!(take(&mut bytes), Some([1]));
        assert_eq!(take(&mut bytes), Some([2, 3]));
        assert_eq!(take::<1>(&mut bytes), None);
    }
}
