//! The MAC: AES-128-CMAC over what must not be exchanged, and the trailer that carries it.

use super::aes::RoundKeys;
use super::provisioning::{Key, Provisioning};
use crate::onboard::bytes::take;

/// Bytes of the truncated MAC: a forger's chance is 2⁻⁶⁴ a message.
pub const MAC: usize = 8;
/// Bytes behind the message: epoch, counter, MAC.
pub const TRAILER: usize = 4 + 4 + MAC;

/// What makes a message unlike every other one of its key: lower ones are refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Freshness {
    /// Boot of the board.
    pub epoch: u32,
    /// Number within the boot; the first message has 1.
    pub counter: u32,
}

/// Who signs: a message of one direction is none of the other.
#[derive(Clone, Copy)]
#[repr(u8)]
pub(super) enum Recipient {
    Board = 1,
    Desk = 2,
}

/// The trailer's freshness and MAC.
pub(super) struct Trailer {
    pub freshness: Freshness,
    pub mac: [u8; MAC],
}

impl Trailer {
    pub fn sign(
        provisioning: &Provisioning,
        direction: Recipient,
        data_id: u16,
        freshness: Freshness,
        message: &[u8],
    ) -> Self {
        let parts: [&[u8]; 6] = [
            &[direction as u8],
            &data_id.to_le_bytes(),
            &provisioning.train.0.to_le_bytes(),
            &freshness.epoch.to_le_bytes(),
            &freshness.counter.to_le_bytes(),
            message,
        ];
        let [mac @ .., _, _, _, _, _, _, _, _] = cmac(&provisioning.key, &parts);
        Self { freshness, mac }
    }

    /// Compared in constant time: all bytes, whatever the first ones say.
    pub fn is_of(&self, provisioning: &Provisioning, direction: Recipient, data_id: u16, message: &[u8]) -> bool {
        let expected = Self::sign(provisioning, direction, data_id, self.freshness, message);
        let differing = self.mac.iter().zip(expected.mac).fold(0, |bits, (found, expected)| bits | (found ^ expected));
        core::hint::black_box(differing) == 0
    }

    pub fn to_bytes(&self) -> [u8; TRAILER] {
        let [a, b, c, d] = self.freshness.epoch.to_le_bytes();
        let [e, f, g, h] = self.freshness.counter.to_le_bytes();
        let [i, j, k, l, m, n, o, p] = self.mac;
        [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p]
    }

    pub fn from_bytes(mut bytes: &[u8]) -> Option<Self> {
        let epoch = u32::from_le_bytes(take(&mut bytes)?);
        let counter = u32::from_le_bytes(take(&mut bytes)?);
        let mac = take(&mut bytes)?;
        bytes.is_empty().then_some(Self { freshness: Freshness { epoch, counter }, mac })
    }
}

/// Of the parts one after the other.
fn cmac(key: &Key, parts: &[&[u8]]) -> [u8; 16] {
    let keys = RoundKeys::new(&key.bytes());
    let (mut block, mut filled) = ([0; 16], 0);
    for byte in parts.iter().copied().flatten() {
        // Not before there is more: the last block is another one.
        if filled == block.len() {
            keys.encrypt(&mut block);
            filled = 0;
        }
        if let Some(place) = block.get_mut(filled) {
            *place ^= byte;
        }
        filled += 1;
    }
    let mut subkey = [0; 16];
    keys.encrypt(&mut subkey);
    let mut subkey = doubled(u128::from_be_bytes(subkey));
    if let Some(place) = block.get_mut(filled) {
        *place ^= 0x80;
        subkey = doubled(subkey);
    }
    block = (u128::from_be_bytes(block) ^ subkey).to_be_bytes();
    keys.encrypt(&mut block);
    block
}

/// In GF(2¹²⁸), without a branch.
fn doubled(number: u128) -> u128 {
    number << 1 ^ (number >> 127).wrapping_neg() & 0x87
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bytes<const N: usize>(hex: &str) -> [u8; N] {
        assert_eq!(hex.len(), 2 * N);
        core::array::from_fn(|i| u8::from_str_radix(&hex[2 * i..2 * i + 2], 16).unwrap())
    }

    /// RFC 4493, section 4, examples 1 to 4; the message in one part and in two.
    #[test]
    fn rfc_4493_vectors() {
        let key = Key::new(bytes("2b7e151628aed2a6abf7158809cf4f3c"));
        let message: [u8; 64] = bytes(concat!(
            "6bc1bee22e409f96e93d7e117393172aae2d8a571e03ac9c9eb76fac45af8e51",
            "30c81c46a35ce411e5fbc1191a0a52eff69f2445df4f9b17ad2b417be66c3710"
        ));
        for (length, mac) in [
            (0, "bb1d6929e95937287fa37d129b756746"),
            (16, "070a16b46b4d4144f79bdd9dd04a287c"),
            (40, "dfa66747de9ae63030ca32611497c827"),
            (64, "51f0bebf7e3b9d92fc49741779363cfe"),
        ] {
            let (head, tail) = message[..length].split_at(length / 3);
            for parts in [[head, tail], [&message[..length], &[]]] {
                assert_eq!(cmac(&key, &parts), bytes(mac), "{length} bytes");
            }
        }
    }
}
