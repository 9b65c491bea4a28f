//! Are the bytes in docs/link.md those of the code?

use board_tests::pipe;
use embedded_can::Frame;
use rundown::link::can::{CanFrame, Format};
use rundown::link::can_link::{CanLink, FROM_BOARD, TO_BOARD};
use rundown::link::isotp::{Config, pdu};
use rundown::link::{Link, MAX_CHECKED, checksum, serial, slcan};

const DOCUMENT: &str = include_str!("../../../docs/link.md");

/// The words behind `name` at the begin of a line, for each such line.
fn lines(name: &str) -> Vec<&'static str> {
    DOCUMENT.lines().filter_map(|line| line.strip_prefix(name)?.strip_prefix("  ")).map(str::trim).collect()
}

fn bytes(words: &str) -> Vec<u8> {
    let byte = |word| u8::from_str_radix(word, 16).unwrap();
    words.split(' ').map(byte).collect()
}

#[test]
fn the_serial_example_is_what_is_sent() {
    let message = bytes(lines("message")[0]);
    assert_eq!(checksum::append(&message).unwrap(), bytes(lines("checked")[0])[..]);
    assert_eq!(serial::encode(&message).unwrap(), bytes(lines("line")[0])[..]);
}

#[test]
fn the_can_examples_are_what_is_sent() {
    let message = bytes(lines("message")[1]);
    let answer = bytes(lines("flow control")[0]);
    let (here, mut wire) = pipe::bus();
    let mut host = CanLink::host(here, Config::CLASSIC);
    host.send(&message, 0).unwrap();
    wire.put([CanFrame::new(FROM_BOARD, &answer).unwrap()]);
    host.receive(0).unwrap();
    let sent: Vec<CanFrame> = wire.take();
    let expected: Vec<Vec<u8>> = [lines("first"), lines("consecutive")].concat().into_iter().map(bytes).collect();
    assert_eq!(sent.iter().map(Frame::data).collect::<Vec<_>>(), expected);
    assert!(sent.iter().all(|frame| frame.id() == TO_BOARD));
    assert_eq!(slcan::encode(&sent[3]), format!("{}\r", lines("slcan")[0]).as_bytes());

    // The receiver's side of the same message answers as the document says.
    let (here, mut wire) = pipe::bus();
    let mut board = CanLink::board(here, Config::CLASSIC);
    wire.put(sent);
    assert_eq!(board.receive(0).unwrap().as_deref(), Some(&message[..]));
    assert_eq!(wire.take(), [CanFrame::new(FROM_BOARD, &answer).unwrap()]);

    let checked = checksum::append(&message).unwrap();
    let (single, taken) = pdu::encode_begin(&checked, Format::Fd { bit_rate_switch: true });
    assert_eq!((&single[..], taken), (&bytes(lines("single")[0])[..], checked.len()));
}

#[test]
fn the_numbers_in_the_tables_are_those_of_the_code() {
    assert!(DOCUMENT.contains(&format!("| longest on the line | {} |", serial::MAX_SERIAL)));
    assert!(DOCUMENT.contains(&format!("| buffer of the decoder | {MAX_CHECKED} |")));
    let (classic, fd) = (Config::CLASSIC, Config::FD);
    for line in [
        format!("| block size asked for | {} | {} |", classic.block_size, fd.block_size),
        format!("| STmin asked for | {} | {} |", classic.separation.0, fd.separation.0),
        format!("| N_Bs, N_Cr | {} s | {} s |", classic.timeout_us / 1_000_000, fd.timeout_us / 1_000_000),
        format!("| N_WFTmax | {} | {} |", classic.max_waits, fd.max_waits),
    ] {
        assert!(DOCUMENT.contains(&line), "{line}");
    }
    assert_eq!((TO_BOARD, FROM_BOARD), (rundown::link::can::standard(0x6D0), rundown::link::can::standard(0x6D1)));
}
