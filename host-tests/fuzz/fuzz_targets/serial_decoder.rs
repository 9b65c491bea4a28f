//! Any bytes on the serial line: no panic, no message longer than allowed, what is decoded encodes back, and behind a
//! zero a valid message is always read.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rundown_wire::link::serial::{Decoder, encode};
use rundown_wire::link::{Counters, MAX_MESSAGE};

fuzz_target!(|data: &[u8]| {
    // Random bytes hardly ever carry a valid checksum: the first byte says how much of the rest is a message that is
    // damaged by what follows.
    let (&head, rest) = data.split_first().unwrap_or((&0, &[]));
    let (message, damage) = rest.split_at(rest.len().min(2 * usize::from(head)));
    let mut line = encode(message).map(|frame| frame.to_vec()).unwrap_or_default();
    for pair in damage.chunks_exact(3) {
        if let Some(byte) = line.get_mut(usize::from(u16::from_le_bytes([pair[0], pair[1]])) % MAX_MESSAGE) {
            *byte ^= pair[2];
        }
    }
    line.extend_from_slice(damage);

    let mut decoder: Decoder = Decoder::new();
    let mut small: Decoder<16> = Decoder::new();
    let mut counters = Counters::ZERO;
    for &byte in &line {
        match decoder.push(byte) {
            Ok(Some(message)) => {
                assert!((1..=MAX_MESSAGE).contains(&message.len()));
                let again = encode(message).expect("what was decoded has a valid length");
                let mut fresh: Decoder = Decoder::new();
                let decoded = again.iter().any(|&byte| fresh.push(byte) == Ok(Some(message)));
                assert!(decoded);
            }
            Ok(None) => {}
            Err(error) => error.count(&mut counters),
        }
        if let Ok(Some(message)) = small.push(byte) {
            assert!(message.len() <= 12);
        }
    }
    let _garbage_ends = decoder.push(0);
    let valid = encode(b"valid").expect("short");
    let received = valid.iter().filter(|&&byte| decoder.push(byte) == Ok(Some(b"valid")));
    assert_eq!(received.count(), 1);
});
