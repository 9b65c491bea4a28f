//! Do independent implementations of SLCAN and ISO-TP understand the board's side of the CAN link, and it them?
//!
//! python-can and can-isotp (`host-tests/peers/`) talk over TCP to a device that is played here. They are looked for in
//! the Python environment `target/peers`, then in the `python3` of the path:
//! `python3 -m venv target/peers && target/peers/bin/pip install -r host-tests/peers/requirements.txt`.

use embedded_can::{Frame, nb::Can};
use rundown::link::can::CanFrame;
use rundown::link::can_link::CanLink;
use rundown::link::isotp::Config;
use rundown::link::isotp::pdu::{Pdu, SeparationTime, parse};
use rundown::link::slcan::Slcan;
use rundown::link::{Counters, Link};
use sim_harness::link::Clock;
use sim_harness::link::port::HostPort;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

const SIZES: [usize; 12] = [1, 2, 3, 4, 7, 8, 20, 58, 59, 100, 500, 512];

/// The controller, with a count of the flow control frames that pass it and the shortest time between consecutive
/// frames of one message.
struct Watched<C> {
    controller: C,
    clock: Clock,
    answers_sent: usize,
    answers_received: usize,
    last_us: Option<u64>,
    shortest_gap_us: u64,
}

impl<C: Can<Frame = CanFrame>> Can for Watched<C> {
    type Frame = CanFrame;
    type Error = C::Error;

    fn transmit(&mut self, frame: &CanFrame) -> nb::Result<Option<CanFrame>, C::Error> {
        let displaced = self.controller.transmit(frame)?;
        match parse(frame.data()) {
            Ok(Pdu::FlowControl(_)) => self.answers_sent += 1,
            Ok(Pdu::Consecutive { .. }) => {
                let now_us = self.clock.now_us();
                if let Some(last_us) = self.last_us.replace(now_us) {
                    self.shortest_gap_us = self.shortest_gap_us.min(now_us - last_us);
                }
            }
            _ => self.last_us = None,
        }
        Ok(displaced)
    }

    fn receive(&mut self) -> nb::Result<CanFrame, C::Error> {
        let frame = self.controller.receive()?;
        if let Ok(Pdu::FlowControl(_)) = parse(frame.data()) {
            self.answers_received += 1;
            // The next frame begins a block: the separation time holds within one.
            self.last_us = None;
        }
        Ok(frame)
    }
}

/// A Python that has the peers, or why there is none.
fn python() -> Result<PathBuf, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let own = std::env::var_os("CARGO_TARGET_DIR").map_or(root.join("target"), PathBuf::from);
    let candidates = [own.join("peers/bin/python"), PathBuf::from("python3")];
    let mut causes = Vec::new();
    for python in candidates {
        let tried = Command::new(&python).args(["-c", "import can, isotp, serial"]).output();
        match tried {
            Ok(output) if output.status.success() => return Ok(python),
            Ok(output) => causes.push(format!(
                "{}: {}",
                python.display(),
                String::from_utf8_lossy(&output.stderr).lines().last().unwrap_or("no message")
            )),
            Err(error) => causes.push(format!("{}: {error}", python.display())),
        }
    }
    Err(causes.join("; "))
}

/// Lets the peer talk to the board's side of a link; gives what the link counted and the watch.
fn talk(kind: &str, config: Config, peer_block_size: u8, peer_separation_ms: u8) -> (Counters, [usize; 2], u64) {
    let python = python().unwrap_or_else(|cause| {
        panic!(
            "expected a Python with python-can and can-isotp, found none ({cause}). \
             Remedy: python3 -m venv target/peers && target/peers/bin/pip install -r host-tests/peers/requirements.txt"
        )
    });
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    let peer = Command::new(python)
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("peers/isotp_peer.py"))
        .args([&port.to_string(), kind])
        .args([peer_block_size, peer_separation_ms].map(|number| number.to_string()))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // The peer ends by itself; its output says how.
    let peer = thread::spawn(move || peer.wait_with_output().unwrap());
    listener.set_nonblocking(true).unwrap();
    let stream = loop {
        match listener.accept() {
            Ok((stream, _)) => break stream,
            Err(_) if peer.is_finished() => {
                panic!("peer did not connect: {:?}", peer.join().unwrap())
            }
            Err(_) => thread::sleep(Duration::from_millis(10)),
        }
    };
    stream.set_nonblocking(false).unwrap();
    let clock = Clock::new();
    let mut link = CanLink::board(
        Watched {
            controller: Slcan::device(HostPort::tcp(stream).unwrap()),
            clock,
            answers_sent: 0,
            answers_received: 0,
            last_us: None,
            shortest_gap_us: u64::MAX,
        },
        config,
    );
    // Until the peer closes the connection.
    while let Ok(message) = link.receive(clock.now_us()) {
        match message {
            Some(message) => {
                let inverted: Vec<u8> = message.iter().map(|byte| !byte).collect();
                if link.send(&inverted, clock.now_us()).is_err() {
                    break;
                }
            }
            None => thread::sleep(Duration::from_micros(200)),
        }
    }
    let output = peer.join().unwrap();
    assert!(
        output.status.success() && output.stdout.ends_with(b"ok\n"),
        "{}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
    let counters = link.counters();
    let watch = link.controller_mut();
    assert_eq!(watch.controller.damaged(), 0);
    (counters, [watch.answers_sent, watch.answers_received], watch.shortest_gap_us)
}

/// Flow control frames that the messages of the peer need: one for each first frame, one after each whole block but the
/// last frame.
fn answers(single: usize, first: usize, consecutive: usize, block_size: usize) -> usize {
    SIZES
        .iter()
        .map(|size| size + 4)
        .filter(|length| *length > single)
        .map(|length| match (length - first).div_ceil(consecutive) {
            _ if block_size == 0 => 1,
            frames => 1 + (frames - 1) / block_size,
        })
        .sum()
}

/// What the script did besides the echoes: a wrong checksum, 600 bytes, one more echo.
fn check_counts(counters: Counters) {
    let echoes = SIZES.len() as u32 + 1;
    let expected = Counters { sent: echoes, received: echoes, checksum: 1, too_long: 1, ..Counters::ZERO };
    assert_eq!(counters, expected);
}

#[test]
#[ignore = "needs python-can and can-isotp: cargo xtask test"]
fn classic_frames_with_small_blocks_and_separation_times() {
    let config = Config { block_size: 2, separation: SeparationTime(1), ..Config::CLASSIC };
    let (counters, [sent, received], gap_us) = talk("classic", config, 3, 2);
    check_counts(counters);
    // Of the two others, the wrong checksum has 22 bytes, and the refusal is a flow control, too.
    assert_eq!(sent, answers(7, 6, 7, 2) + 2 + 1, "blocks of two");
    assert_eq!(received, answers(7, 6, 7, 3), "blocks of three");
    assert!(gap_us >= 2_000, "{gap_us} us between frames, 2 ms were asked for");
}

#[test]
#[ignore = "needs python-can and can-isotp: cargo xtask test"]
fn classic_frames_without_blocks() {
    let config = Config { block_size: 0, ..Config::CLASSIC };
    let (counters, [sent, received], _) = talk("classic", config, 0, 0);
    check_counts(counters);
    assert_eq!(sent, answers(7, 6, 7, 0) + 1 + 1);
    assert_eq!(received, answers(7, 6, 7, 0));
}

#[test]
#[ignore = "needs python-can and can-isotp: cargo xtask test"]
fn fd_frames_with_small_blocks() {
    let config = Config { block_size: 2, ..Config::FD };
    let (counters, [sent, received], _) = talk("fd", config, 1, 0);
    check_counts(counters);
    // The wrong checksum is a single frame here.
    assert_eq!(sent, answers(62, 62, 63, 2) + 1);
    assert_eq!(received, answers(62, 62, 63, 1));
}
