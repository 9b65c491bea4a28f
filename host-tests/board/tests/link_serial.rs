//! Does a serial line give the message that was sent, or nothing?

use board_tests::faults::{FaultyPort, Rates};
use board_tests::pipe;
use board_tests::port::Narrow;
use proptest::prelude::*;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rundown::link::checksum::{ChecksumError, crc32c};
use rundown::link::serial::{Decoder, MAX_SERIAL, SerialError, SerialLink, encode};
use rundown::link::{Counters, Link, LinkError, MAX_MESSAGE};
use std::cell::Cell;

/// All messages and errors that these bytes give.
fn decode(bytes: &[u8]) -> (Vec<Vec<u8>>, Vec<SerialError>) {
    let mut decoder: Decoder = Decoder::new();
    let (mut messages, mut errors) = (Vec::new(), Vec::new());
    for byte in bytes {
        match decoder.push(*byte) {
            Ok(Some(message)) => messages.push(message.to_vec()),
            Ok(None) => {}
            Err(error) => errors.push(error),
        }
    }
    (messages, errors)
}

/// Random bytes, every third of them a zero when asked for: COBS treats zeros on their own.
fn random(seed: u64, length: usize, zeros: bool) -> Vec<u8> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let byte = |rng: &mut ChaCha8Rng| match zeros && rng.random_range(0..3) == 0 {
        true => 0,
        false => rng.random(),
    };
    (0..length).map(|_| byte(&mut rng)).collect()
}

/// Zeros, no zeros, random; short, of the size of a measurement, of an estimate, and over the 254 bytes where COBS
/// begins a new block.
fn representative() -> Vec<Vec<u8>> {
    vec![
        vec![0],
        vec![0; 22],
        vec![1; 22],
        vec![0xFF; 40],
        random(1, 22, true),
        random(2, 40, false),
        random(3, 64, true),
        (0..64).collect(),
        random(4, 270, false).iter().map(|byte| byte | 1).collect(),
    ]
}

/// One message of each frame of both directions.
fn of_each_frame() -> Vec<Vec<u8>> {
    let released = include_str!("../../../data/golden/wire_v1.txt").lines();
    released
        .filter_map(|line| line.split_once(": "))
        .filter(|(name, _)| !name.starts_with('#'))
        .map(|(_, bytes)| {
            let bytes = bytes.split_whitespace();
            bytes.map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect()
        })
        .collect()
}

/// Nothing but the message may come out of the damaged bytes.
///
/// The message's own bytes may still come out: a flip can turn COBS bytes into others of the same meaning.
fn only_the_message(message: &[u8], damaged: &[u8], what: impl Fn() -> String) {
    let mut decoder: Decoder = Decoder::new();
    for byte in damaged {
        if let Ok(Some(received)) = decoder.push(*byte) {
            assert_eq!(received, message, "{}", what());
        }
    }
}

fn flip(bytes: &mut [u8], bit: usize) {
    bytes[bit / 8] ^= 1 << (bit % 8);
}

#[test]
fn no_single_or_double_flip_is_taken_for_a_message() {
    let frames = of_each_frame();
    assert!(frames.len() > 30, "{} frames", frames.len());
    for message in representative().into_iter().chain(frames) {
        let mut bytes = encode(&message).unwrap().to_vec();
        // What follows on the line decides how a lost delimiter ends.
        let length = bytes.len();
        bytes.extend([0]);
        for first in 0..8 * length {
            flip(&mut bytes, first);
            only_the_message(&message, &bytes, || format!("bit {first} of {message:02x?}"));
            for second in first + 1..8 * length {
                flip(&mut bytes, second);
                only_the_message(&message, &bytes, || format!("bits {first} and {second} of {message:02x?}"));
                flip(&mut bytes, second);
            }
            flip(&mut bytes, first);
        }
    }
}

#[test]
fn a_flip_costs_one_message_or_two_when_it_joins_them() {
    let (one, two, three) = (random(5, 30, true), random(6, 30, true), random(7, 30, true));
    let line: Vec<u8> = [&one, &two, &three].into_iter().flat_map(|message| encode(message).unwrap()).collect();
    let first = encode(&one).unwrap().len();
    for bit in 0..8 * (first - 1) {
        let mut line = line.clone();
        flip(&mut line, bit);
        let (messages, errors) = decode(&line);
        assert_eq!(messages, [two.clone(), three.clone()], "bit {bit}");
        assert!(!errors.is_empty(), "bit {bit} is not counted");
    }
    for bit in 8 * (first - 1)..8 * first {
        let mut line = line.clone();
        flip(&mut line, bit);
        assert_eq!(decode(&line).0, std::slice::from_ref(&three), "delimiter, bit {bit}");
    }
}

#[test]
fn no_burst_of_up_to_32_bits_is_taken_for_a_message() {
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    for message in representative() {
        let clean = encode(&message).unwrap().to_vec();
        let all = 8 * clean.len();
        for length in 2..=32 {
            for first in 0..=all - length {
                // All patterns of short bursts, some of the long ones; a burst begins and ends with a flip.
                let inner = length - 2;
                let patterns: Vec<u32> =
                    if inner <= 4 { (0..1 << inner).collect() } else { (0..4).map(|_| rng.next_u32()).collect() };
                for pattern in patterns {
                    let mut bytes = clean.clone();
                    flip(&mut bytes, first);
                    flip(&mut bytes, first + length - 1);
                    for bit in 0..inner {
                        if pattern >> bit & 1 == 1 {
                            flip(&mut bytes, first + 1 + bit);
                        }
                    }
                    only_the_message(&message, &bytes, || {
                        format!("burst of {length} at {first}, pattern {pattern:x}, {message:02x?}")
                    });
                }
            }
        }
    }
}

#[test]
fn messages_of_every_length_come_back() {
    for length in 1..=MAX_MESSAGE {
        for (seed, zeros) in [(1, false), (2, true)] {
            let message = random(seed, length, zeros);
            let bytes = encode(&message).unwrap();
            assert!(bytes.len() <= MAX_SERIAL);
            let (end, body) = bytes.split_last().unwrap();
            assert!(*end == 0 && !body.contains(&0), "{length} bytes, seed {seed}");
            assert_eq!(decode(&bytes), (vec![message], vec![]), "{length} bytes, seed {seed}");
        }
        // The worst and the best case of COBS.
        for byte in [0, 1] {
            let message = vec![byte; length];
            assert_eq!(decode(&encode(&message).unwrap()), (vec![message], vec![]));
        }
    }
}

#[test]
fn every_cause_has_its_own_count() {
    let good = encode(b"good").unwrap();
    let mut wrong_checksum = good.to_vec();
    wrong_checksum[1] ^= 4;
    let long = [vec![9; 300], vec![0]].concat();
    let too_long: Vec<u8> = [vec![0xFF; 3000], vec![0]].concat();
    for (bytes, error, count) in [
        (&wrong_checksum[..], "checksum", (|all| all.checksum) as fn(&Counters) -> u32),
        // Announces a ninth byte more than there is.
        (&[0x09, 1, 2, 3, 0], "coding", |all| all.coding),
        (&too_long, "too long", |all| all.too_long),
        // Four bytes are the checksum of nothing.
        (&[0x01, 0x01, 0x01, 0x01, 0x01, 0], "too short", |all| all.too_short),
        (&long, "checksum or coding", |all| all.checksum + all.coding),
    ] {
        let (_, errors) = decode(&[bytes, &good].concat());
        assert_eq!(errors.len(), 1, "{error}");
        let (mut here, mut there) = pipe::bytes();
        there.put(bytes.iter().chain(&good).copied());
        let mut link = SerialLink::new(&mut here);
        // One call takes a bounded number of bytes.
        let received = (0..10).find_map(|_| link.receive(0).unwrap());
        assert_eq!(received.unwrap(), *b"good", "after {error}");
        let counters = link.counters();
        assert_eq!(count(&counters), 1, "{error}: {counters:?}");
        let all = counters.checksum + counters.coding + counters.too_long + counters.too_short;
        assert_eq!((counters.received, all), (1, 1), "{error}: {counters:?}");
    }
}

#[test]
fn the_buffer_of_the_decoder_bounds_the_message() {
    let mut decoder: Decoder<14> = Decoder::new();
    for (length, fits) in [(9, true), (10, true), (11, false), (500, false), (10, true)] {
        let mut last = Ok(false);
        for byte in encode(&vec![7; length]).unwrap() {
            last = decoder.push(byte).map(|message| message.is_some());
        }
        let expected = match fits {
            true => Ok(true),
            false => Err(SerialError::TooLong { capacity: 14 }),
        };
        assert_eq!(last, expected, "{length} bytes");
    }
}

#[test]
fn nothing_between_two_delimiters_is_no_error() {
    let line = [&[0; 5], &encode(b"a").unwrap()[..], &[0; 3], &encode(b"b").unwrap()[..]].concat();
    assert_eq!(decode(&line), (vec![b"a".to_vec(), b"b".to_vec()], vec![]));
    assert_eq!(crc32c(&[]), 0, "why an empty message does not exist");
    assert!(encode(&[]).is_err());
    assert_eq!(decode(&[1, 1, 1, 1, 1, 0]).1, [SerialError::Checksum(ChecksumError::TooShort { found: 4 })]);
}

#[test]
fn truncated_messages_cost_at_most_the_one_they_run_into() {
    let (one, two, three) = (random(1, 60, true), random(2, 60, true), random(3, 60, true));
    let first = encode(&one).unwrap();
    let rest = [encode(&two).unwrap(), encode(&three).unwrap()].concat();
    for length in 0..first.len() {
        // Cut anywhere, also just before the delimiter: what is left is glued to the second.
        let (messages, errors) = decode(&[&first[..length], &rest].concat());
        let expected = if length == 0 { vec![two.clone(), three.clone()] } else { vec![three.clone()] };
        assert_eq!(messages, expected, "first {length} bytes");
        assert_eq!(errors.len(), usize::from(length > 0), "first {length} bytes");
        // The end is missing, the delimiter is not.
        if length > 0 && length < first.len() - 1 {
            let (messages, errors) = decode(&[&first[..length], &[0], &rest].concat());
            assert_eq!((messages.len(), errors.len()), (2, 1), "first {length} bytes");
        }
    }
}

#[test]
fn over_a_bad_wire_come_only_messages_that_were_sent() {
    for seed in 0..20 {
        let now_us = Cell::new(0_u64);
        let (here, there) = pipe::bytes();
        let bad = FaultyPort::new(here, seed, Rates::all(0.05), || now_us.get());
        let (mut sender, mut receiver) = (SerialLink::new(bad), SerialLink::new(there));
        let sent: Vec<Vec<u8>> = (0..500).map(|i| random(seed * 1000 + i, 1 + i as usize % 90, true)).collect();
        let mut received = Vec::new();
        for message in &sent {
            now_us.set(now_us.get() + 10_000);
            sender.send(message, now_us.get()).unwrap();
            received.extend(receiver.receive(now_us.get()).unwrap().map(|message| message.to_vec()));
        }
        for _ in 0..1000 {
            now_us.set(now_us.get() + 10_000);
            assert!(sender.receive(now_us.get()).unwrap().is_none());
            received.extend(receiver.receive(now_us.get()).unwrap().map(|message| message.to_vec()));
        }
        for message in &received {
            assert!(sent.contains(message), "seed {seed}: {message:02x?} was never sent");
        }
        // Six faults of 5 % hit the bytes of a message or its neighbour's.
        assert!(received.len() > 250, "seed {seed}: {} of 500", received.len());
        assert!(received.len() < 600, "seed {seed}: {} of 500", received.len());
        let counters = receiver.counters();
        assert!(counters.checksum + counters.coding > 20, "seed {seed}: {counters:?}");
    }
}

#[test]
fn a_full_port_costs_the_cut_message_only() {
    for room in 0..25 {
        let (end, mut there) = pipe::bytes();
        let mut link = SerialLink::new(Narrow { end, room });
        // 20 bytes are 26 on the line.
        assert!(matches!(link.send(&[1; 20], 0), Err(LinkError::Full)));
        link.port_mut().room = 100;
        link.send(&[2; 20], 0).unwrap();
        let (messages, _) = decode(&there.take());
        assert_eq!(messages, [vec![2; 20]], "room for {room}");
        assert_eq!(link.counters().sent, 1);
    }
}

#[test]
fn a_babbling_line_does_not_hold_up_the_caller() {
    let (mut here, mut there) = pipe::bytes();
    let babble = vec![0x55; 100 * MAX_SERIAL];
    there.put(babble.iter().copied());
    assert!(SerialLink::new(&mut here).receive(0).unwrap().is_none());
    assert!(babble.len() - here.take().len() <= 2 * MAX_SERIAL);
}

#[test]
fn one_call_gets_past_a_damaged_message_to_the_one_behind_it() {
    let (here, mut there) = pipe::bytes();
    let good = encode(&[0xFF; MAX_MESSAGE]).unwrap();
    let mut damaged = good.clone();
    damaged[9] ^= 1;
    there.put([damaged.to_vec(), good.to_vec()].concat());
    let mut link = SerialLink::new(here);
    assert_eq!(link.receive(0).unwrap().as_deref(), Some(&[0xFF; MAX_MESSAGE][..]));
    assert!(!link.is_sending(), "a port takes a message at once or not at all");
}

proptest! {
    #[test]
    fn garbage_zero_valid_gives_valid(
        garbage in proptest::collection::vec(any::<u8>(), 0..1500),
        message in proptest::collection::vec(any::<u8>(), 1..=MAX_MESSAGE),
    ) {
        let line = [&garbage, &[0][..], &encode(&message).unwrap()].concat();
        prop_assert_eq!(decode(&line).0.pop(), Some(message));
    }

    #[test]
    fn garbage_costs_at_most_the_message_behind_it(
        garbage in proptest::collection::vec(any::<u8>(), 0..1500),
        one in proptest::collection::vec(any::<u8>(), 1..100),
        two in proptest::collection::vec(any::<u8>(), 1..100),
    ) {
        let line = [&garbage, &encode(&one).unwrap()[..], &encode(&two).unwrap()].concat();
        prop_assert_eq!(decode(&line).0.pop(), Some(two));
    }

    #[test]
    fn random_bytes_are_no_messages(bytes in proptest::collection::vec(any::<u8>(), 0..4000)) {
        // A chance of 2^-32 for each zero among them.
        prop_assert!(decode(&bytes).0.is_empty());
    }
}
