//! AES-128 (FIPS 197): one block, encrypted; nothing else is asked of it by a CMAC.
//!
//! Not the crate `aes`, which tests compare it with: that one encrypts two blocks at once, and takes 2000 B more of the
//! image.
//!
//! In: a key and a block of 16 bytes. Out: the block encrypted, in place.
//!
//! Bit i of every byte stands in plane i, a bit for each byte, so a step is a few operations on words: no table and no
//! branch asks a secret, and the time is the same for all keys. Row r of column c is bit 4 c + r of a plane; word i
//! holds plane i below and plane i + 4 above.
//!
//! The S-box's inverse is taken in GF(2⁴)\[y\] / (y² + y + x³) with GF(2⁴) = GF(2)\[x\] / (x⁴ + x + 1), after Satoh et
//! al., "A compact Rijndael hardware architecture", 2001.

type Planes = [u32; 4];

/// x⁸ as a number below it, of AES's own field.
const REDUCED: u32 = 0x1B;

/// The keys of all rounds.
pub(super) struct RoundKeys([Planes; 11]);

impl RoundKeys {
    pub fn new(key: &[u8; 16]) -> Self {
        let mut key = planes(key);
        let mut keys = [key; 11];
        let mut constant = 1;
        for next in keys.iter_mut().skip(1) {
            let mut column = key.map(|plane| next_row(plane) >> 12 & 0x000F_000F);
            substitute(&mut column);
            for (bit, (plane, column)) in key.iter_mut().zip(column).enumerate() {
                *plane ^= column & 0x000F_000F ^ bits_of(constant, bit);
                // To each column those before it.
                *plane ^= *plane << 4 & 0xFFF0_FFF0;
                *plane ^= *plane << 8 & 0xFF00_FF00;
            }
            *next = key;
            // Of it the lowest eight bits count.
            constant = constant << 1 ^ if constant == 0x80 { REDUCED } else { 0 };
        }
        Self(keys)
    }

    pub fn encrypt(&self, block: &mut [u8; 16]) {
        let [first, others @ .., last] = &self.0;
        let mut state = planes(block);
        add(&mut state, first);
        for key in others {
            substitute(&mut state);
            state.iter_mut().for_each(shift_rows);
            mix_columns(&mut state);
            add(&mut state, key);
        }
        substitute(&mut state);
        state.iter_mut().for_each(shift_rows);
        add(&mut state, last);
        *block = bytes(&state);
    }
}

fn planes(bytes: &[u8; 16]) -> Planes {
    let mut planes = [0; 4];
    for (column, bytes) in bytes.as_chunks().0.iter().enumerate() {
        let word = u32::from_le_bytes(*bytes);
        for bit in 0..8 {
            // The product has the lowest bits of the four bytes side by side at its upper end.
            let rows = (word >> bit & 0x0101_0101).wrapping_mul(0x1020_4080) >> 28;
            planes[bit % 4] |= rows << (4 * column + 4 * (bit & 4));
        }
    }
    planes
}

fn bytes(planes: &Planes) -> [u8; 16] {
    let mut block = [0; 16];
    for (column, bytes) in block.as_chunks_mut().0.iter_mut().enumerate() {
        let mut word = 0;
        for bit in 0..8 {
            let rows = planes[bit % 4] >> (4 * column + 4 * (bit & 4)) & 0xF;
            word |= ((rows * 0x0020_4081) & 0x0101_0101) << bit;
        }
        *bytes = u32::to_le_bytes(word);
    }
    block
}

/// Bits i and i + 4 of a byte, each as the lowest one of its half.
fn bits_of(byte: u32, i: usize) -> u32 {
    (byte | byte << 12) >> i & 0x0001_0001
}

fn add(state: &mut Planes, key: &Planes) {
    for (plane, key) in state.iter_mut().zip(key) {
        *plane ^= key;
    }
}

/// Into each row what stands in the next one of the same column.
fn next_row(plane: u32) -> u32 {
    plane >> 1 & 0x7777_7777 | plane << 3 & 0x8888_8888
}

/// Each row to the left, by its number.
fn shift_rows(plane: &mut u32) {
    *plane = *plane & 0x1111_1111
        | *plane >> 4 & 0x0222_0222
        | *plane << 12 & 0x2000_2000
        | *plane >> 8 & 0x0044_0044
        | *plane << 8 & 0x4400_4400
        | *plane >> 12 & 0x0008_0008
        | *plane << 4 & 0x8880_8880;
}

fn mix_columns(state: &mut Planes) {
    // a(r) becomes 2 (a(r) + a(r+1)) + a(r+1) + a(r+2) + a(r+3).
    let sum = |plane: u32| plane ^ next_row(plane);
    let last = sum(state[3]);
    let (mut below, last) = (last << 16, last >> 16);
    for (bit, plane) in state.iter_mut().enumerate() {
        let both = sum(*plane);
        *plane = below ^ (last * bits_of(REDUCED, bit)) ^ next_row(*plane) ^ next_row(next_row(both));
        below = both;
    }
}

/// The S-box of every byte.
#[inline(never)]
fn substitute(planes: &mut Planes) {
    // h y + l; what is above the lower half of a word is of no use.
    let [x0, x1, x2, x3] = *planes;
    let [x4, x5, x6, x7] = planes.map(|plane| plane >> 16);
    let (a, b) = (x5 ^ x7, x4 ^ x6);
    let c = x2 ^ x3 ^ a;
    let [l0, l1, l2, l3] = [x0 ^ a, x2, b ^ c, x3 ^ x4];
    let [h0, h1, h2, h3] = [x5 ^ b, x1 ^ x7 ^ b, c, a];
    // Its inverse is (h y + h + l) / (h² x³ + l (h + l)).
    let [s0, s1, s2, s3] = [h0 ^ l0, h1 ^ l1, h2 ^ l2, h3 ^ l3];
    let [p0, p1, p2, p3] = product([l0, l1, l2, l3], [s0, s1, s2, s3]);
    let norm = [p0 ^ h2, p1 ^ h1 ^ h2 ^ h3, p2 ^ h1, p3 ^ h0 ^ h2 ^ h3];
    let numerators = [pair(s0, h0), pair(s1, h1), pair(s2, h2), pair(s3, h3)];
    let [z0, z1, z2, z3] = product(numerators, inverse(norm).map(|bits| pair(bits, bits)));
    let [z4, z5, z6, z7] = [z0 >> 16, z1 >> 16, z2 >> 16, z3 >> 16];
    // Back, and what AES does with it.
    let (a, b, e) = (z0 ^ z5, z1 ^ z2, z6 ^ z7);
    let c = z3 ^ a;
    let d = z4 ^ c;
    *planes =
        [pair(!(z0 ^ z2 ^ z6), z1 ^ d), pair(!(b ^ d), !(b ^ z3 ^ z5 ^ e)), pair(z6 ^ c, !(z4 ^ e)), pair(z2 ^ a, b)];
}

fn pair(lower: u32, upper: u32) -> u32 {
    lower & 0xFFFF | upper << 16
}

/// Numbers of GF(2⁴).
type Nibbles = [u32; 4];

#[inline(never)]
fn product([a0, a1, a2, a3]: Nibbles, [b0, b1, b2, b3]: Nibbles) -> Nibbles {
    // x⁴ = x + 1, x⁵ = x² + x, x⁶ = x³ + x²
    let x4 = a1 & b3 ^ a2 & b2 ^ a3 & b1;
    let x5 = a2 & b3 ^ a3 & b2;
    let x6 = a3 & b3;
    [
        a0 & b0 ^ x4,
        a0 & b1 ^ a1 & b0 ^ x4 ^ x5,
        a0 & b2 ^ a1 & b1 ^ a2 & b0 ^ x5 ^ x6,
        a0 & b3 ^ a1 & b2 ^ a2 & b1 ^ a3 & b0 ^ x6,
    ]
}

/// 1 / d, and 0 of 0: its table of 16 as sums of products.
fn inverse([d0, d1, d2, d3]: Nibbles) -> Nibbles {
    let (d01, d02, d12, d03, d13) = (d0 & d1, d0 & d2, d1 & d2, d0 & d3, d1 & d3);
    let sum = d1 ^ d2 ^ d3;
    [
        sum ^ d0 ^ d02 ^ d12 ^ d12 & (d0 ^ d3),
        d01 ^ d02 ^ d12 ^ d3 ^ d13 ^ d01 & d3,
        d01 ^ d02 ^ d2 ^ d3 ^ d03 ^ d02 & d3,
        sum ^ d03 ^ d13 ^ d2 & d3 ^ d12 & d3,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encrypted(key: u128, block: u128) -> u128 {
        let mut block = block.to_be_bytes();
        RoundKeys::new(&key.to_be_bytes()).encrypt(&mut block);
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
