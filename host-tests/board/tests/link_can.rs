//! Does a CAN bus give the message that was sent, or nothing?

use board_tests::faults::{FaultyPort, Rates};
use board_tests::pipe;
use board_tests::port::Narrow;
use embedded_can::{Frame, nb::Can};
use proptest::prelude::*;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rundown::link::can::{CanFrame, Format, fd_length_for, standard};
use rundown::link::can_link::{CanLink, FROM_BOARD, TO_BOARD};
use rundown::link::isotp::pdu::{FrameData, Pdu, SeparationTime, parse};
use rundown::link::isotp::{Config, Receiver, Sender};
use rundown::link::slcan::{self, BitRate, Line, Slcan};
use rundown::link::{Link, LinkError, MAX_CHECKED, MAX_MESSAGE, Message};
use std::cell::Cell;

fn random(seed: u64, length: usize) -> Vec<u8> {
    let mut bytes = vec![0; length];
    ChaCha8Rng::seed_from_u64(seed).fill_bytes(&mut bytes);
    bytes
}

/// Sends a payload; `wire` says what becomes of each consecutive, first or single frame. Gives what was received, and
/// whether the sender was done.
fn transfer<const N: usize>(
    sender: &mut Sender<N>,
    receiver: &mut Receiver<N>,
    payload: &[u8],
    mut wire: impl FnMut(usize, FrameData) -> Vec<FrameData>,
) -> Vec<Vec<u8>> {
    let mut received = Vec::new();
    let (mut now_us, mut index) = (0, 0);
    sender.start(payload).unwrap();
    while !sender.is_idle() {
        match sender.next_frame(now_us) {
            Ok(Some(frame)) => {
                for frame in wire(index, frame) {
                    let pdu = parse(&frame).unwrap();
                    let outcome = receiver.on_frame(pdu, frame.len(), now_us);
                    if outcome.complete {
                        received.push(receiver.payload().to_vec());
                    }
                    if let Some(answer) = outcome.answer {
                        // The answer ends the payload only if it says so, which the caller sees by what is received.
                        let _ended = sender.on_flow_control(answer, now_us);
                    }
                }
                index += 1;
            }
            Ok(None) => now_us += 100_000,
            // The answer was lost with its cause.
            Err(_) => break,
        }
    }
    received
}

fn configs() -> Vec<Config> {
    let formats = [Format::Classic, Format::Fd { bit_rate_switch: false }];
    let config = |format| {
        [0, 1, 2, 8].map(|block_size| Config { format, block_size, separation: SeparationTime(0), ..Config::CLASSIC })
    };
    formats.into_iter().flat_map(config).collect()
}

#[test]
fn payloads_of_every_length_come_back() {
    for config in configs() {
        let mut sender: Sender<MAX_CHECKED> = Sender::new(config);
        let mut receiver: Receiver<MAX_CHECKED> = Receiver::new(config);
        for length in 1..=MAX_CHECKED {
            let payload = random(length as u64, length);
            let mut frames = 0;
            let received = transfer(&mut sender, &mut receiver, &payload, |_, frame| {
                frames += 1;
                match config.format {
                    Format::Classic => assert!(frame.len() <= 8),
                    Format::Fd { .. } => assert_eq!(fd_length_for(frame.len()), Some(frame.len())),
                }
                vec![frame]
            });
            assert_eq!(received, [payload], "{length} bytes, {config:?}");
            let (single, first, consecutive) = match config.format {
                Format::Classic => (7, 6, 7),
                Format::Fd { .. } => (62, 62, 63),
            };
            let expected = match length {
                length if length <= single => 1,
                _ => 1 + (length - first).div_ceil(consecutive),
            };
            assert_eq!(frames, expected, "{length} bytes, {config:?}");
        }
    }
}

#[test]
fn payloads_beyond_4095_bytes_have_a_32_bit_length() {
    for config in configs() {
        let mut sender: Sender<5000> = Sender::new(config);
        let mut receiver: Receiver<5000> = Receiver::new(config);
        for length in [4094, 4095, 4096, 5000] {
            let payload = random(3, length);
            let received = transfer(&mut sender, &mut receiver, &payload, |index, frame| {
                if index == 0 {
                    assert_eq!(frame[..2] == [0x10, 0], length > 4095);
                }
                vec![frame]
            });
            assert_eq!(received, [payload], "{length} bytes, {config:?}");
        }
    }
}

#[test]
fn a_lost_doubled_or_overtaken_frame_never_gives_another_payload() {
    for config in configs() {
        for length in [5, 8, 20, 62, 63, 130, 300] {
            let payload = random(1, length);
            let count = {
                let (mut sender, mut receiver) = ends(config);
                let mut count = 0;
                transfer(&mut sender, &mut receiver, &payload, |_, frame| {
                    count += 1;
                    vec![frame]
                });
                count
            };
            for hit in 0..count {
                for fault in ["lost", "doubled", "overtaken"] {
                    let (mut sender, mut receiver) = ends(config);
                    let mut held = None;
                    let received = transfer(&mut sender, &mut receiver, &payload, |index, frame| match fault {
                        _ if index != hit => [Some(frame), held.take()].into_iter().flatten().collect(),
                        "lost" => vec![],
                        "doubled" => vec![frame.clone(), frame],
                        _ => {
                            held = Some(frame);
                            vec![]
                        }
                    });
                    let what = format!("{length} bytes, frame {hit} {fault}, {config:?}");
                    assert!(received.iter().all(|got| *got == payload), "{what}");
                    // Nothing is left that would spoil what follows.
                    let (mut sender, next) = (ends(config).0, random(2, length));
                    let received = transfer(&mut sender, &mut receiver, &next, |_, frame| vec![frame]);
                    assert_eq!(received, [next], "after {what}");
                }
            }
        }
    }
}

fn ends(config: Config) -> (Sender<MAX_CHECKED>, Receiver<MAX_CHECKED>) {
    (Sender::new(config), Receiver::new(config))
}

/// The sequence number comes round after 16 frames, so that ISO-TP alone joins the begin of one payload to the end of
/// another. The checksum does not.
#[test]
fn sixteen_lost_frames_are_found_by_the_checksum_only() {
    let config = Config { block_size: 0, ..Config::CLASSIC };
    let (here, mut wire) = pipe::bus();
    let mut link = CanLink::host(here, config);
    let mut board_to_host: Vec<CanFrame> = Vec::new();
    for (seed, length) in [(1, 156), (2, 156)] {
        let (end, mut other) = pipe::bus();
        let mut board = CanLink::board(end, config);
        board.send(&random(seed, length), 0).unwrap();
        other.put([CanFrame::new(TO_BOARD, &[0x30, 0, 0]).unwrap()]);
        board.receive(0).unwrap();
        board_to_host.extend(other.take());
    }
    // 1 first and 22 consecutive frames each: the first message loses its frames 5 to 20.
    assert_eq!(board_to_host.len(), 46);
    let first = board_to_host[..5].iter().chain(&board_to_host[21..23]);
    // And the second loses all until its frame 7, which has the number that is due.
    let second = &board_to_host[23 + 7..];
    wire.put(first.chain(second).cloned());
    assert_eq!(link.receive(0).unwrap(), None);
    assert_eq!(link.counters().checksum, 1, "{:?}", link.counters());
    assert_eq!(FROM_BOARD, board_to_host[0].id());
}

#[test]
fn messages_of_every_length_pass_the_bus_both_ways_at_once() {
    for config in [Config::CLASSIC, Config::FD] {
        let (here, there) = pipe::bus();
        let (mut host, mut board) = (CanLink::host(here, config), CanLink::board(there, config));
        for length in 1..=MAX_MESSAGE {
            let (up, down) = (random(1, length), random(2, length));
            host.send(&up, 0).unwrap();
            board.send(&down, 0).unwrap();
            let (mut at_host, mut at_board) = (Vec::<Message>::new(), Vec::<Message>::new());
            for _ in 0..100 {
                at_board.extend(board.receive(0).unwrap());
                at_host.extend(host.receive(0).unwrap());
            }
            assert_eq!(at_board, [&up[..]], "{length} bytes up");
            assert_eq!(at_host, [&down[..]], "{length} bytes down");
            assert!(!host.is_sending() && !board.is_sending());
        }
        assert_eq!(host.counters().received, MAX_MESSAGE as u32);
        assert_eq!(board.counters().sent, MAX_MESSAGE as u32);
    }
}

#[test]
fn a_busy_link_refuses_and_a_silent_one_gives_up() {
    let (here, mut there) = pipe::bus();
    let mut host = CanLink::host(here, Config::CLASSIC);
    host.send(&[1; 50], 0).unwrap();
    assert!(matches!(host.send(&[2; 50], 1), Err(LinkError::Busy)));
    assert!(matches!(host.send(&[], 1), Err(LinkError::Length { found: 0 })));
    assert!(host.receive(1_000_000).unwrap().is_none());
    assert_eq!(host.counters().timeout, 1);
    assert!(!host.is_sending());
    // The other side begins and falls silent.
    there.put([CanFrame::new(FROM_BOARD, &[0x10, 50, 1, 2, 3, 4, 5, 6]).unwrap()]);
    assert!(host.receive(2_000_000).unwrap().is_none());
    assert!(host.receive(3_000_000).unwrap().is_none());
    assert_eq!(host.counters().timeout, 2);
    // No room at the other side.
    host.send(&[1; 50], 3_000_000).unwrap();
    there.put([CanFrame::new(FROM_BOARD, &[0x32, 0, 0]).unwrap()]);
    assert!(host.receive(3_000_000).unwrap().is_none());
    assert_eq!(host.counters().refused, 1);
}

#[test]
fn a_controller_that_is_full_loses_nothing() {
    /// Takes one frame in three calls.
    struct Slow(pipe::PipeEnd<CanFrame>, u32);
    impl Can for Slow {
        type Frame = CanFrame;
        type Error = pipe::BusError;
        fn transmit(&mut self, frame: &CanFrame) -> nb::Result<Option<CanFrame>, Self::Error> {
            self.1 += 1;
            if self.1.is_multiple_of(3) { self.0.transmit(frame) } else { Err(nb::Error::WouldBlock) }
        }
        fn receive(&mut self) -> nb::Result<CanFrame, Self::Error> {
            self.0.receive()
        }
    }
    let (here, there) = pipe::bus();
    let mut host = CanLink::host(Slow(here, 0), Config::CLASSIC);
    let mut board = CanLink::board(Slow(there, 1), Config::CLASSIC);
    let message = random(1, 300);
    host.send(&message, 0).unwrap();
    let received = (0..2000).find_map(|_| {
        host.receive(0).unwrap();
        board.receive(0).unwrap()
    });
    assert_eq!(received.as_deref(), Some(&message[..]));
}

/// A controller that takes frames only while it may.
struct Held {
    end: pipe::PipeEnd<CanFrame>,
    takes: bool,
}

impl Can for Held {
    type Frame = CanFrame;
    type Error = pipe::BusError;

    fn transmit(&mut self, frame: &CanFrame) -> nb::Result<Option<CanFrame>, Self::Error> {
        if self.takes { self.end.transmit(frame) } else { Err(nb::Error::WouldBlock) }
    }

    fn receive(&mut self) -> nb::Result<CanFrame, Self::Error> {
        self.end.receive()
    }
}

#[test]
fn a_message_is_on_its_way_until_the_controller_has_taken_all_of_it() {
    let (end, mut there) = pipe::bus();
    let mut host = CanLink::host(Held { end, takes: false }, Config::CLASSIC);
    assert!(!host.is_sending());
    host.send(&[1], 0).unwrap();
    assert!(host.is_sending());
    assert!(matches!(host.send(&[2], 0), Err(LinkError::Busy)));
    host.controller_mut().takes = true;
    assert!(host.receive(0).unwrap().is_none());
    assert!(!host.is_sending());
    assert_eq!(there.take().len(), 1);
}

#[test]
fn the_other_sides_silence_begins_when_the_controller_has_taken_the_frame() {
    let (end, mut there) = pipe::bus();
    let mut host = CanLink::host(Held { end, takes: false }, Config::CLASSIC);
    host.send(&[1; 50], 0).unwrap();
    host.controller_mut().takes = true;
    host.receive(900_000).unwrap();
    assert_eq!(there.take().len(), 1);
    host.receive(1_899_999).unwrap();
    assert_eq!((host.is_sending(), host.counters().timeout), (true, 0));
    host.receive(1_900_000).unwrap();
    assert_eq!((host.is_sending(), host.counters().timeout), (false, 1));
}

#[test]
fn a_serial_port_that_is_full_within_a_line_loses_nothing() {
    let (here, there) = pipe::bytes();
    let mut host = CanLink::host(Slcan::device(Narrow { end: here, room: 0 }), Config::CLASSIC);
    let mut board = CanLink::board(Slcan::device(there), Config::CLASSIC);
    let message = random(1, 100);
    host.send(&message, 0).unwrap();
    let received = (0..1000).find_map(|turn| {
        // Lines of 22 bytes do not go into 30, so most are cut.
        host.controller_mut().port_mut().room = if turn % 2 == 0 { 30 } else { 7 };
        host.receive(0).unwrap();
        board.receive(0).unwrap()
    });
    assert_eq!(received.as_deref(), Some(&message[..]));
    assert!(board.controller_mut().damaged() > 5);
}

#[test]
fn frames_of_others_on_the_bus_are_left_alone() {
    let (here, mut there) = pipe::bus();
    let mut host = CanLink::host(here, Config::CLASSIC);
    there.put([
        CanFrame::new(standard(0x123), &[0x10, 50, 1, 2, 3, 4, 5, 6]).unwrap(),
        CanFrame::new(TO_BOARD, &[0x10, 50, 1, 2, 3, 4, 5, 6]).unwrap(),
        CanFrame::new_remote(FROM_BOARD, 8).unwrap(),
    ]);
    assert!(host.receive(0).unwrap().is_none());
    assert!(there.take().is_empty(), "nothing is answered");
    assert_eq!(host.counters(), Default::default());
}

#[test]
fn over_a_bad_slcan_line_come_only_messages_that_were_sent_and_afterwards_all() {
    let mut all = 0;
    for seed in 0..20 {
        let (now_us, chance) = (Cell::new(0_u64), 0.004);
        let (here, there) = pipe::bytes();
        let bad = FaultyPort::new(here, seed, Rates::all(chance), || now_us.get());
        let adapter = Slcan::open(bad, Some(BitRate::Kbit500)).unwrap();
        let mut host = CanLink::host(adapter, Config::CLASSIC);
        let mut board = CanLink::board(Slcan::device(there), Config::CLASSIC);
        let mut received = 0;
        for i in 0..200 {
            let message = random(seed * 1000 + i, 1 + i as usize % 60);
            host.send(&message, now_us.get()).unwrap();
            // Until it is out or given up; then until nothing of it is on its way.
            for _ in 0..400 {
                now_us.set(now_us.get() + 10_000);
                if let Some(got) = board.receive(now_us.get()).unwrap() {
                    assert_eq!(got, message[..], "seed {seed}, message {i}");
                    received += 1;
                }
                assert!(host.receive(now_us.get()).unwrap().is_none());
            }
            assert!(!host.is_sending(), "seed {seed}, message {i}");
        }
        let (out, _) = host.controller_mut().port_mut().tallies();
        assert!(out.bit_flips + out.drop + out.reorder > 0, "seed {seed}: {out:?}");
        all += received;
    }
    assert!(all > 20 * 150, "{all} of 4000 arrived");
}

proptest! {
    #[test]
    fn random_frames_are_no_messages(
        frames in proptest::collection::vec(proptest::collection::vec(any::<u8>(), 0..=8), 0..200),
    ) {
        let (here, mut there) = pipe::bus();
        let mut link = CanLink::host(here, Config::CLASSIC);
        there.put(frames.iter().map(|data| CanFrame::new(FROM_BOARD, data).unwrap()));
        for call in 0..10 {
            prop_assert_eq!(link.receive(call).unwrap(), None);
        }
    }

    #[test]
    fn what_a_frame_says_is_within_the_frame(frame in proptest::collection::vec(any::<u8>(), 0..=64)) {
        match parse(&frame) {
            Ok(Pdu::Single(data)) => prop_assert!((1..=62).contains(&data.len())),
            Ok(Pdu::First { length, data }) => prop_assert!(length > data.len()),
            Ok(Pdu::Consecutive { data, .. }) => prop_assert!(data.len() + 1 == frame.len()),
            Ok(Pdu::FlowControl(_)) | Err(_) => {}
        }
    }

    #[test]
    fn slcan_lines_come_back(id in 0..=0x7FF_u16, code in 0..16_usize, fd: bool, switch: bool, seed: u64) {
        let format = match fd {
            true => Format::Fd { bit_rate_switch: switch },
            false => Format::Classic,
        };
        let length = usize::from(rundown::link::can::FD_LENGTHS[code]);
        let frame = CanFrame::try_new(standard(id), format, &random(seed, length));
        prop_assume!(frame.is_ok());
        let frame = frame.unwrap();
        let mut decoder = slcan::LineDecoder::new();
        let mut lines = Vec::new();
        for byte in slcan::encode(&frame) {
            lines.extend(decoder.push(byte).unwrap());
        }
        prop_assert_eq!(lines, vec![Line::Frame(frame)]);
    }

    #[test]
    fn random_text_never_breaks_the_slcan_decoder(bytes in proptest::collection::vec(any::<u8>(), 0..2000)) {
        let mut decoder = slcan::LineDecoder::new();
        for byte in bytes {
            if let Ok(Some(Line::Frame(frame))) = decoder.push(byte) {
                prop_assert!(frame.data().len() <= 64);
            }
        }
        decoder.push(b'\r').ok();
        for byte in b"t1230" {
            decoder.push(*byte).unwrap();
        }
        prop_assert!(matches!(decoder.push(b'\r'), Ok(Some(Line::Frame(_)))));
    }
}

#[test]
fn an_adapter_is_closed_set_and_opened_and_answers_what_it_knows() {
    let (here, mut wire) = pipe::bytes();
    let opened = Slcan::open(here, Some(BitRate::Kbit500)).unwrap();
    let commands = wire.take();
    let text = String::from_utf8_lossy(&commands);
    assert!(text.ends_with("C\rS6\rO\r"), "{text:?}");
    drop(opened);

    // The side that plays one: a return for each of these, BEL for what it does not know, nothing for a frame.
    let (here, mut wire) = pipe::bytes();
    let mut device = Slcan::device(here);
    wire.put(*b"C\rS6\rO\rV\rt1230\r");
    assert_eq!(device.receive().ok().map(|frame| frame.id()), Some(standard(0x123)));
    assert_eq!(wire.take(), b"\r\r\r\x07");
    // A host does not answer an adapter.
    let (here, mut wire) = pipe::bytes();
    let mut host = Slcan::open(here, None).unwrap();
    wire.take();
    wire.put(*b"V\rt1230\r");
    assert!(host.receive().is_ok());
    assert_eq!(wire.take(), b"");
    // It counts what the adapter refuses.
    wire.put(*b"\x07\x07\rt1230\r");
    assert!(host.receive().is_ok());
    assert_eq!((host.refused(), host.damaged()), (2, 0));
}

#[test]
fn a_babbling_line_does_not_hold_up_the_caller_and_a_full_ring_is_read_in_one_call() {
    let (mut here, mut there) = pipe::bytes();
    let babble = vec![b'x'; 100 * slcan::MAX_LINE];
    there.put(babble.iter().copied());
    assert!(Slcan::device(&mut here).receive().is_err());
    let read = babble.len() - here.take().len();
    assert!((512..=16 * slcan::MAX_LINE).contains(&read), "{read}");
}

#[test]
fn each_failure_says_what_it_is() {
    use rundown::link::slcan::PortError;

    let of_link = [LinkError::Port("unplugged"), LinkError::Full, LinkError::Busy, LinkError::Length { found: 0 }];
    assert_eq!(
        of_link.map(|error| error.to_string()),
        [
            "port: unplugged",
            "the port takes no more bytes",
            "the message before is still being sent",
            "expected 1 to 512 bytes, found 0"
        ]
    );
    let of_port = [PortError::Port("unplugged"), PortError::Full];
    assert_eq!(of_port.map(|error| error.to_string()), ["unplugged", "the port takes no more bytes"]);
    let of_length = |format| CanFrame::try_new(standard(1), format, &[0; 9]).unwrap_err().to_string();
    assert_eq!(of_length(Format::Classic), "expected at most 8 bytes, found 9");
    let fd = Format::Fd { bit_rate_switch: false };
    assert_eq!(of_length(fd), "expected 0 to 8, 12, 16, 20, 24, 32, 48 or 64 bytes, found 9");
}
