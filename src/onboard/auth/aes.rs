//! AES-128 (FIPS 197): one block, encrypted; nothing else is asked of it by a CMAC.
//!
//! In: a key and a block of 16 bytes. Out: the block encrypted, in place.
//!
//! Bit i of every byte stands in plane i, a bit for each byte, so a step is a few operations on eight words: no table and no branch asks a secret, and the time
//! is the same for all keys. The bits of a plane:
//!
//! ```text
//! 0 ..= 15    the block, or the round's key: row r of column c is bit 4 c + r
//! 16 ..= 19   in the S-box: the last column of the key, on its way to the next round's
//! ```
//!
//! The S-box's inverse is taken in GF(2⁴)\[y\] / (y² + y + x³) with GF(2⁴) = GF(2)\[x\] / (x⁴ + x + 1), after Satoh et al., "A compact Rijndael hardware
//! architecture", 2001.

type Planes = [u32; 8];

const BLOCK: u32 = 0xFFFF;
/// x⁸ as a number below it, of AES's own field.
const REDUCED: u32 = 0x1B;

pub(super) fn encrypt(key: &[u8; 16], block: &mut [u8; 16]) {
    let mut key = planes(key);
    let mut state = planes(block);
    add(&mut state, &key);
    let mut constant = 1;
    for round in 1..=10 {
        for (plane, key) in state.iter_mut().zip(&key) {
            *plane |= (next_row(*key) & 0xF000) << 4;
        }
        substitute(&mut state);
        next_key(&mut key, &state, constant);
        constant = constant << 1 ^ if constant == 0x80 { 0x100 | REDUCED } else { 0 };
        state.iter_mut().for_each(shift_rows);
        if round < 10 {
            mix_columns(&mut state);
        }
        add(&mut state, &key);
    }
    *block = [0; 16];
    for (at, byte) in block.iter_mut().enumerate() {
        for plane in state.iter().rev() {
            *byte = *byte << 1 | (plane >> at & 1) as u8;
        }
    }
}

fn planes(bytes: &[u8; 16]) -> Planes {
    let mut planes = [0; 8];
    for (at, byte) in bytes.iter().enumerate() {
        for (bit, plane) in planes.iter_mut().enumerate() {
            *plane |= u32::from(byte >> bit & 1) << at;
        }
    }
    planes
}

fn add(state: &mut Planes, key: &Planes) {
    for (plane, key) in state.iter_mut().zip(key) {
        *plane ^= key;
    }
}

/// Into each row what stands in the next one of the same column.
fn next_row(plane: u32) -> u32 {
    plane >> 1 & 0x7777 | plane << 3 & 0x8888
}

/// Each row to the left, by its number.
fn shift_rows(plane: &mut u32) {
    let twice = (*plane & BLOCK) * 0x1_0001;
    *plane = (0..4).fold(0, |rows, row| rows | twice >> (4 * row) & 0x1111 << row);
}

fn mix_columns(state: &mut Planes) {
    // a(r) becomes 2 (a(r) + a(r+1)) + a(r+1) + a(r+2) + a(r+3).
    let sum = |plane: u32| plane ^ next_row(plane);
    let last = sum(state[7]);
    let mut doubled = 0;
    for (bit, plane) in state.iter_mut().enumerate() {
        let both = sum(*plane);
        doubled ^= if REDUCED >> bit & 1 == 1 { last } else { 0 };
        *plane = doubled ^ next_row(*plane) ^ next_row(next_row(both));
        doubled = both;
    }
}

/// The key of the next round; `state` has gone through the S-box with its last column.
fn next_key(key: &mut Planes, state: &Planes, constant: u32) {
    for (bit, (key, plane)) in key.iter_mut().zip(state).enumerate() {
        *key ^= plane >> 16 & 0xF ^ constant >> bit & 1;
        // To each column those before it.
        *key ^= *key << 4;
        *key = (*key ^ *key << 8) & BLOCK;
    }
}

/// The S-box of every byte.
fn substitute(planes: &mut Planes) {
    // h y + l
    let [x0, x1, x2, x3, x4, x5, x6, x7] = *planes;
    let (a, b) = (x5 ^ x7, x4 ^ x6);
    let c = x2 ^ x3 ^ a;
    let l = [x0 ^ a, x2, b ^ c, x3 ^ x4];
    let h = [x5 ^ b, x1 ^ x7 ^ b, c, a];
    // Its inverse is (h y + h + l) / (h² x³ + l (h + l)).
    let both = sum(h, l);
    let [s0, s1, s2, s3] = square(h);
    let norm = sum([s1, s1 ^ s2, s2 ^ s3, s0 ^ s3], product(l, both));
    // 1 / d is d¹⁴.
    let squared = square(norm);
    let fourth = square(squared);
    let inverse = product(product(squared, fourth), square(fourth));
    let [z0, z1, z2, z3] = product(both, inverse);
    let [z4, z5, z6, z7] = product(h, inverse);
    // Back, and what AES does with it.
    let (a, b, e) = (z0 ^ z5, z1 ^ z2, z6 ^ z7);
    let c = z3 ^ a;
    let d = z4 ^ c;
    *planes = [!(z0 ^ z2 ^ z6), !(b ^ d), z6 ^ c, z2 ^ a, z1 ^ d, !(b ^ z3 ^ z5 ^ e), !(z4 ^ e), b];
}

/// Numbers of GF(2⁴).
type Nibbles = [u32; 4];

fn sum(a: Nibbles, b: Nibbles) -> Nibbles {
    core::array::from_fn(|bit| a[bit] ^ b[bit])
}

fn square([a0, a1, a2, a3]: Nibbles) -> Nibbles {
    [a0 ^ a2, a2, a1 ^ a3, a3]
}

fn product(a: Nibbles, b: Nibbles) -> Nibbles {
    b.into_iter().rev().fold([0; 4], |[p0, p1, p2, p3], b| sum([p3, p0 ^ p3, p1, p2], a.map(|a| a & b)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encrypted(key: u128, block: u128) -> u128 {
        let mut block = block.to_be_bytes();
        encrypt(&key.to_be_bytes(), &mut block);
        u128::from_be_bytes(block)
    }

    /// FIPS 197, appendices B and C.1.
    #[test]
    fn fips_197_vectors() {
        let worked = encrypted(0x2b7e_1516_28ae_d2a6_abf7_1588_09cf_4f3c, 0x3243_f6a8_885a_308d_3131_98a2_e037_0734);
        assert_eq!(worked, 0x3925_841d_02dc_09fb_dc11_8597_196a_0b32);
        let example = encrypted(0x0001_0203_0405_0607_0809_0a0b_0c0d_0e0f, 0x0011_2233_4455_6677_8899_aabb_ccdd_eeff);
        assert_eq!(example, 0x69c4_e0d8_6a7b_0430_d8cd_b780_70b4_c55a);
    }
}
