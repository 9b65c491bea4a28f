//! Messages that come, are lost or find no room: what is counted, and what is answered.

use crate::board;
use board_tests::board::{Board, PROVISIONING, answer, described, estimate, running, task};
use board_tests::flash::Flash;
use board_tests::prelude::*;
use board_tests::said;
use board_tests::serial_board::SerialBoard;
use rundown::onboard::outbox::WhenFull;
use rundown::uplink::{self, OPEN, Uplink};
use rundown_wire::{Body, MAX_MESSAGE, Refusal};

#[test]
fn a_gap_of_a_thousand_messages_is_a_sender_that_restarts() {
    for (next, missed) in [(2, 0), (3, 1), (1001, 999), (1002, 0)] {
        let mut board = board();
        let mut asked = |sequence| {
            let status = Uplink { sequence, request: Request::Command(Command::Status) };
            let mut buffer = [0; MAX_MESSAGE];
            said!(board.say(uplink::encode(&status, OPEN, &mut buffer).unwrap()), Status).unwrap()
        };
        asked(1);
        assert_eq!(asked(next).missed, missed, "{next}");
    }
}

#[test]
fn a_reader_that_is_gone_does_not_stop_the_board() {
    let (mut board, description, log) = running(described());
    board.wire.room = Some(0);
    for measurement in log.iter().take(40) {
        assert!(board.measure(measurement).is_empty());
    }
    board.wire.room = None;
    let frames = board.measure(&log[40]);
    let estimator = description.estimator().unwrap();
    let mut run = estimator.begin_run(&estimator.new_vehicle(), Direction::Up);
    let expected = log[..=40].iter().map(|measurement| estimator.step(&mut run, measurement).unwrap()).last();
    assert_eq!(estimate(&frames).unwrap().digest, digest::of_estimate(&expected.unwrap()));
    assert!(board.status().not_sent > 80);
}

#[test]
fn status_and_health_count_the_same_frames_that_the_line_did_not_take() {
    let (description, log) = described();
    let mut board = SerialBoard::start();
    board.prepare(&description);
    board.deaf = true;
    for measurement in log.iter().take(20) {
        let message = board.desk.open(Request::Measurement(*measurement)).unwrap();
        board.say(&message);
        board.wait(10);
    }
    board.deaf = false;
    board.wait(1);
    board.heard.clear();
    let ask = board.desk.open(Request::Command(Command::Status)).unwrap();
    board.say(&ask);
    board.wait(1);
    let frames: Vec<_> = board.heard.drain(..).map(|(_, frame)| frame).collect();
    let (status, health) = (said!(frames, Status).unwrap(), said!(frames, Health).unwrap());
    assert_eq!(status.not_sent, health.not_sent);
    assert!(status.not_sent > 20, "{status:?}");
}

#[test]
fn a_crash_loop_leaves_a_heartbeat() {
    let (description, _) = described();
    let mut first = board();
    first.status();
    let task = task(Ok(PROVISIONING), Flash::erased(8), true);
    let mut board = Board { task, ..first };
    for ticks in 1..=2 {
        let frames = board.tick();
        assert!(matches!(frames[0].body, Body::Status(status) if status.silent_ticks == ticks));
    }
    for message in board.desk.prepare(&description, Direction::Up, Pace::Clock).unwrap() {
        let answer = answer(&board.say(&message)).unwrap();
        assert_eq!(answer.result, Err(Refusal::HeartbeatOnly));
    }
    assert!(!board.status().running);
    assert!(board.task.release().is_none(), "what is in the flash may be why it fell");
}

/// A board without a clock.
#[derive(Default)]
struct Clockless(Vec<Vec<u8>>);

impl rundown::onboard::task::Port for Clockless {
    fn send(&mut self, message: &[u8], _: WhenFull) {
        self.0.push(message.to_vec());
    }

    fn health(&self) -> rundown_wire::Health {
        rundown_wire::Health::default()
    }
}

#[test]
fn without_a_clock_every_refusal_is_answered() {
    let mut task = task(Ok(PROVISIONING), Flash::erased(8), false);
    let mut port = Clockless::default();
    let mut desk = Desk::new(PROVISIONING);
    for _ in 0..100 {
        let end = desk.open(Request::Command(Command::End)).unwrap();
        task.receive(&end, &mut port);
    }
    assert_eq!(port.0.len(), 100);
}
