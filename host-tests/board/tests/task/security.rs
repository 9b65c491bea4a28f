//! Who may ask: what must be secured, what no key opens, and what is old.

use crate::board;
use board_tests::board::{Board, PROVISIONING, answer, described, estimate, running, task};
use board_tests::flash::Flash;
use board_tests::prelude::*;
use board_tests::said;
use rundown::estimator::config::SecurityConfig;
use rundown::onboard::auth::{Provisioning, Signer};
use rundown::uplink::{self, OPEN, Uplink};
use rundown_wire::{MAX_MESSAGE, Refusal};

#[test]
fn what_changes_the_board_must_be_secured() {
    let (description, _) = described();
    let mut board = board();
    let requests: Vec<Request> = description.requests(PROVISIONING.train.0);
    assert!(requests.len() > 2);
    for request in requests {
        let message = board.desk.open(request).unwrap();
        let refused = answer(&board.say(&message)).unwrap();
        assert_eq!(refused.result, Err(Refusal::NotSecured));
    }
    assert_eq!(board.status().train_id, None);
}

/// A running board whose setting asks for secured measurements.
fn asks_for_secured() -> (Board, Description, Vec<Measurement>) {
    let (description, log) = described();
    let security = SecurityConfig { secured_measurements: true };
    let config = Config { security, ..description.config };
    running((Description { config, ..description }, log))
}

#[test]
fn open_measurements_are_refused_where_the_setting_asks_for_secured_ones() {
    let (mut board, _, log) = asks_for_secured();
    let open = board.desk.open(Request::Measurement(log[0])).unwrap();
    assert_eq!(answer(&board.say(&open)).unwrap().result, Err(Refusal::NotSecured));
    assert_eq!(board.status().refusals[Refusal::NotSecured as usize], 1);
    let secured = board.desk.secured(Request::Measurement(log[0])).unwrap();
    assert_eq!(estimate(&board.say(&secured)).unwrap().time_s, log[0].time_s);
    // The desk knows what the board was described to ask for.
    let own = board.desk.measurement(&log[1]).unwrap();
    assert_eq!(estimate(&board.say(&own)).unwrap().time_s, log[1].time_s);
    // By default they are taken.
    let (mut board, _, log) = running(described());
    let open = board.desk.open(Request::Measurement(log[0])).unwrap();
    assert!(estimate(&board.say(&open)).is_some());
}

#[test]
fn open_messages_make_no_losses_where_measurements_are_secured() {
    let (mut board, _, log) = asks_for_secured();
    let asked = |board: &mut Board, sequence| {
        let status = Uplink { sequence, request: Request::Command(Command::Status) };
        let mut buffer = [0; MAX_MESSAGE];
        said!(board.say(uplink::encode(&status, OPEN, &mut buffer).unwrap()), Status).unwrap().missed
    };
    let missed = board.status().missed;
    for (k, measurement) in log[..20].iter().enumerate() {
        // A stranger: far from the sender's numbers, before them, and the very next one.
        let next = board.desk.sequence().wrapping_add(1);
        for sequence in [next + 500, next.wrapping_sub(3), next, next + 1, next + 700] {
            assert_eq!(asked(&mut board, sequence), missed, "{k}");
        }
        let own = board.desk.measurement(measurement).unwrap();
        assert!(estimate(&board.say(&own)).is_some());
        assert_eq!(board.status().missed, missed, "{k}");
    }
    // What the sender loses is counted.
    for measurement in &log[20..23] {
        board.desk.measurement(measurement).unwrap();
    }
    let own = board.desk.measurement(&log[23]).unwrap();
    assert!(estimate(&board.say(&own)).is_some());
    assert_eq!(board.status().missed, missed + 3);
}

#[test]
fn a_wrong_key_changes_nothing() {
    let (mut board, ..) = running(described());
    let before = board.status();
    let other = Provisioning { key: rundown::onboard::auth::Key::new([0x5A; 16]), ..PROVISIONING };
    assert!(Signer::new(&other, &before.announcement.unwrap()).is_err());
    // With every byte of a valid message changed once.
    let valid = board.desk.secured(Request::Command(Command::End)).unwrap();
    for at in 0..valid.len() {
        let mut forged = valid.clone();
        forged[at] ^= 0x20;
        let refused = answer(&board.say(&forged)).unwrap();
        assert!(refused.result.is_err(), "byte {at}");
    }
    let after = board.status();
    assert!(after.running);
    assert_eq!(after.setup, before.setup);
    let refused: u32 = after.refusals.iter().sum();
    assert_eq!(refused as usize, valid.len());
    // The valid one still is.
    assert_eq!(answer(&board.say(&valid)).unwrap().result, Ok(()));
    // And not a second time, whether it comes at once or later.
    assert!(board.say(&valid).is_empty());
    assert_eq!(board.status().duplicate, 1);
    assert_eq!(answer(&board.say(&valid)).unwrap().result, Err(Refusal::Stale));
}

#[test]
fn a_recorded_message_is_refused_after_a_restart() {
    let (description, _) = described();
    let mut board = board();
    board.status();
    let recorded = board.desk.prepare(&description, Direction::Up, Pace::Lockstep).unwrap();
    let mut board = board.restart();
    assert!(recorded.len() > 2);
    for message in recorded {
        assert_eq!(answer(&board.say(&message)).unwrap().result, Err(Refusal::Stale));
    }
    assert_eq!(board.status().train_id, None);
}

#[test]
fn a_board_without_a_key_refuses_and_says_so() {
    let task = task(Provisioning::from_bytes(&[0xFF; 64]), Flash::erased(8), false);
    let mut board = Board { task, ..board() };
    assert_eq!(board.status().announcement, None);
    let mut desk = Desk::new(PROVISIONING);
    assert!(desk.secured(Request::Command(Command::End)).is_err());
}

#[test]
fn a_secured_message_is_refused_for_its_true_reason() {
    let (mut with_key, ..) = running(described());
    let valid = with_key.desk.secured(Request::Command(Command::End)).unwrap();
    let mut forged = valid.clone();
    *forged.last_mut().unwrap() ^= 1;
    let refused = |board: &mut Board, message: &[u8]| answer(&board.say(message)).unwrap().result;
    assert_eq!(refused(&mut with_key, &forged), Err(Refusal::WrongMac));
    assert_eq!(refused(&mut with_key, &valid[..4]), Err(Refusal::Malformed), "shorter than what protects it");
    let without = task(Provisioning::from_bytes(&[0xFF; 64]), Flash::erased(8), false);
    let mut without_key = Board { task: without, ..board() };
    assert_eq!(refused(&mut without_key, &valid), Err(Refusal::Unprovisioned));
}
