//! Do the host's links reach a board by their address, and do recorder and injector stand between without harm?

use board_tests::faults::{FaultyLink, Rates};
use board_tests::pipe;
use rundown::link::can_link::CanLink;
use rundown::link::isotp::Config;
use rundown::link::serial::SerialLink;
use rundown::link::slcan::Slcan;
use rundown::link::{Link, LinkError, MAX_MESSAGE, Message};
use sim_harness::link::Clock;
use sim_harness::link::address::Address;
use sim_harness::link::port::HostPort;
use sim_harness::link::record::{RecordingLink, Way, read};
use std::net::TcpListener;
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Sends every message back, until the other side is gone.
fn echo(mut link: impl Link) {
    let clock = Clock::new();
    while let Ok(message) = link.receive(clock.now_us()) {
        match message {
            Some(message) => assert!(link.send(&message, clock.now_us()).is_ok()),
            None => thread::sleep(Duration::from_micros(200)),
        }
    }
}

/// A board behind a TCP server, as the emulator is one; gives its port.
fn board(kind: &'static str) -> (u16, JoinHandle<()>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    let board = thread::spawn(move || {
        let uart = HostPort::tcp(listener.accept().unwrap().0).unwrap();
        match kind {
            "" => echo(SerialLink::new(uart)),
            "slcan:" => echo(CanLink::board(Slcan::device(uart), Config::CLASSIC)),
            _ => echo(CanLink::board(Slcan::device(uart), Config::FD)),
        }
    });
    (port, board)
}

fn wait_for(link: &mut impl Link, clock: Clock) -> Option<Message> {
    let end_us = clock.now_us() + 20_000_000;
    while clock.now_us() < end_us {
        match link.receive(clock.now_us()) {
            Ok(None) => thread::sleep(Duration::from_micros(200)),
            Ok(message) => return message,
            Err(_) => return None,
        }
    }
    None
}

#[test]
fn a_board_behind_tcp_is_reached_over_serial_and_both_kinds_of_can_and_recorded() {
    for kind in ["", "slcan:", "slcanfd:"] {
        let (port, board) = board(kind);
        let address: Address = format!("{kind}tcp:127.0.0.1:{port}").parse().unwrap();
        let clock = Clock::new();
        let mut file = Vec::new();
        let mut link = RecordingLink::new(address.open().unwrap(), &mut file).unwrap();
        let messages: Vec<Vec<u8>> =
            [1, 7, 100, MAX_MESSAGE].map(|length| (0..length).map(|i| (i * i) as u8).collect()).into();
        for message in &messages {
            link.send(message, clock.now_us()).unwrap();
            let back = wait_for(&mut link, clock);
            assert_eq!(back.as_deref(), Some(&message[..]), "{address}");
        }
        drop(link.finish().unwrap());
        let recording = read(&file[..]).unwrap();
        let ways: Vec<Way> = recording.iter().map(|recorded| recorded.way).collect();
        assert_eq!(ways, [Way::Sent, Way::Received].repeat(messages.len()));
        assert!(recording.is_sorted_by_key(|recorded| recorded.time_us));
        for (pair, message) in recording.chunks(2).zip(&messages) {
            assert!(pair.iter().all(|recorded| recorded.message == message[..]));
        }
        board.join().unwrap();
    }
}

#[test]
fn a_closed_connection_is_an_error_and_no_endless_silence() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address: Address = format!("tcp:{}", listener.local_addr().unwrap()).parse().unwrap();
    let mut link = address.open().unwrap();
    drop(listener.accept().unwrap());
    let clock = Clock::new();
    let error = loop {
        match link.receive(clock.now_us()) {
            Ok(None) if clock.now_us() < 20_000_000 => thread::sleep(Duration::from_millis(1)),
            other => break other,
        }
    };
    assert!(matches!(error, Err(LinkError::Port(_))), "{error:?}");
    assert!(matches!(link.receive(clock.now_us()), Err(LinkError::Port(_))));
}

#[test]
fn the_injector_spoils_messages_above_the_checksum_in_both_directions() {
    let transfer = |rates: Rates| {
        let (here, there) = pipe::bytes();
        let mut host = FaultyLink::new(SerialLink::new(here), 5, rates);
        let mut board = SerialLink::new(there);
        let (mut at_board, mut at_host) = (Vec::new(), Vec::new());
        for turn in 0..400_u64 {
            let now_us = turn * 10_000;
            if turn < 200 {
                host.send(&[turn as u8; 30], now_us).unwrap();
                board.send(&[turn as u8; 30], now_us).unwrap();
            }
            at_host.extend(host.receive(now_us).unwrap());
            at_board.extend(board.receive(now_us).unwrap());
        }
        assert_eq!(board.counters().checksum, 0, "below the injector all is well");
        let (out, back) = host.tallies();
        assert_eq!((out.units, back.units), (200, 200));
        (at_board, at_host)
    };
    let clean: Vec<Message> = (0..200).map(|turn| Message::from_slice(&[turn; 30]).unwrap()).collect();
    assert_eq!(transfer(Rates::default()), (clean.clone(), clean.clone()));
    let (at_board, at_host) = transfer(Rates::all(0.05));
    for received in [at_board, at_host] {
        let unspoilt = received.iter().filter(|message| clean.contains(message)).count();
        assert!((120..200).contains(&unspoilt), "{unspoilt} of {}", received.len());
        assert!(unspoilt < received.len(), "some are spoilt");
    }
}
