//! Who calls whom in an image: callers of `core::panicking`, and what smells of a heap.

use emulator::Image;
use rustc_demangle::demangle;

/// The log's own check that it is not entered twice; only the firmware's log lines come there, the library has none.
const OF_THE_LOG: [&str; 2] = ["_defmt_acquire", "_defmt_release"];

/// Functions that contain a call of something in `core::panicking`.
pub fn to_panics(image: &Image) -> Vec<String> {
    let is_panic = |name: &str| {
        name.starts_with("core::panicking::")
            || name.starts_with("core::option::")
            || name.starts_with("core::result::")
            || name.starts_with("core::slice::index::")
    };
    let targets: Vec<u64> = image
        .symbols()
        .filter(|(name, ..)| is_panic(&plain(name)))
        .map(|(_, address, _)| address & !1)
        .collect();
    let mut callers: Vec<String> = calls(&image.code.1, image.code.0)
        .filter(|(_, to)| targets.contains(to))
        .filter_map(|(from, _)| function_at(image, from))
        .filter(|name| !is_panic(name) && !OF_THE_LOG.contains(&name.as_str()))
        .collect();
    callers.sort();
    callers.dedup();
    callers
}

/// Symbols of an allocator.
pub fn allocators(image: &Image) -> Vec<String> {
    image
        .symbols()
        .map(|(name, ..)| plain(name))
        .filter(|name| {
            name.contains("__rust_alloc")
                || name.contains("__rg_alloc")
                || name.starts_with("alloc::")
        })
        .collect()
}

/// The name without its hash.
fn plain(name: &str) -> String {
    format!("{:#}", demangle(name))
}

fn function_at(image: &Image, address: u64) -> Option<String> {
    image
        .symbols()
        .find(|(_, start, size)| (start & !1..(start & !1) + size).contains(&address))
        .map(|(name, ..)| plain(name))
}

/// Calls and far jumps of Thumb code: where, and whither. A constant between the code may look like one, but hardly like one to a given address.
fn calls(code: &[u8], at: u64) -> impl Iterator<Item = (u64, u64)> {
    let halfwords: Vec<u16> = code
        .chunks_exact(2)
        .map(|pair| u16::from(pair[0]) | u16::from(pair[1]) << 8)
        .collect();
    (0..halfwords.len().saturating_sub(1)).filter_map(move |index| {
        let from = at + 2 * index as u64;
        let offset = offset(halfwords[index], halfwords[index + 1])?;
        Some((from, from.wrapping_add_signed(4 + i64::from(offset))))
    })
}

/// Offset of `BL` (encoding T1) or `B.W` (T4), from the instruction's end.
fn offset(first: u16, second: u16) -> Option<i32> {
    let is_call = first & 0xF800 == 0xF000 && matches!(second & 0xD000, 0xD000 | 0x9000);
    if !is_call {
        return None;
    }
    let (first, second) = (u32::from(first), u32::from(second));
    let sign = first >> 10 & 1;
    let bit = |j: u32| !(j ^ sign) & 1;
    let (i1, i2) = (bit(second >> 13 & 1), bit(second >> 11 & 1));
    let bits = sign << 24 | i1 << 23 | i2 << 22 | (first & 0x3FF) << 12 | (second & 0x7FF) << 1;
    // 25 bits with sign.
    Some((bits << 7).cast_signed() >> 7)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn calls_are_decoded_as_the_assembler_encodes_them() {
        // `bl .` and `bl .+4`, as in the architecture manual's examples of T1: -4 and 0 from the end.
        assert_eq!(offset(0xF7FF, 0xFFFE), Some(-4));
        assert_eq!(offset(0xF000, 0xF800), Some(0));
        assert_eq!(offset(0xF000, 0xF802), Some(4));
        // `b.w .`
        assert_eq!(offset(0xF7FF, 0xBFFE), Some(-4));
        // `movs r0, #0; bx lr` is none.
        assert_eq!(offset(0x2000, 0x4770), None);
    }

    #[test]
    fn a_call_is_found_with_its_target() {
        let code = [0x00, 0xBF, 0x00, 0xF0, 0x02, 0xF8, 0x70, 0x47];
        let found: Vec<_> = calls(&code, 0x0800_0000).collect();
        assert_eq!(found, [(0x0800_0002, 0x0800_000A)]);
    }
}
