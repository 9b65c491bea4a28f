//! A tick and the end of a run in pieces: the same frames, and nothing lost between two of them.

use board_tests::board::{Board, described, running};
use board_tests::prelude::*;
use rundown_wire::{Body, Downlink, Memory};

/// Pieces that are still to be done, each with the messages that it sent.
fn pieces(board: &mut Board) -> Vec<Vec<Vec<u8>>> {
    std::iter::from_fn(|| {
        board.task.is_busy().then(|| {
            board.task.go_on(&mut board.wire);
            board.wire.messages.drain(..).collect()
        })
    })
    .collect()
}

#[test]
fn a_tick_in_pieces_says_what_it_says_in_one_call() {
    let (mut whole, _, log) = running(described());
    let (mut apart, ..) = running(described());
    let last = *log.last().unwrap();
    // The long stop ends the run, which takes more pieces.
    let stands = (1..=6).map(|minute| Measurement {
        time_s: last.time_s + 60.0 * f64::from(minute),
        speed_mps: Some(0.0),
        ..last
    });
    let mut most = 0;
    for measurement in log.iter().copied().chain(stands) {
        let message = whole.desk.open(Request::Measurement(measurement)).unwrap();
        whole.task.receive(&message, &mut whole.wire);
        apart.task.begin_message(&message, &mut apart.wire);
        let mut found: Vec<_> = apart.wire.messages.drain(..).collect();
        assert!(found.is_empty() && apart.task.is_busy(), "the estimate is a piece of its own");
        let pieces = pieces(&mut apart);
        most = most.max(pieces.len());
        found.extend(pieces.into_iter().flatten());
        assert_eq!(found, std::mem::take(&mut whole.wire.messages));
    }
    assert_eq!(most, 6, "estimate, first frames, the others, the end, record and summary, estimate frame");
}

#[test]
fn what_comes_between_two_pieces_waits_for_the_last_one() {
    let (mut board, _, log) = running(described());
    let message = |board: &mut Board, row: usize| board.desk.open(Request::Measurement(log[row])).unwrap();
    let (first, second) = (message(&mut board, 0), message(&mut board, 1));
    board.task.begin_message(&first, &mut board.wire);
    board.task.begin_message(&second, &mut board.wire);
    let estimates = |frames: Vec<Downlink>| {
        frames.into_iter().filter(|frame| matches!(frame.body, Body::Estimate(_))).map(|frame| frame.tick).collect()
    };
    let of_the_first: Vec<u32> = estimates(board.heard());
    assert_eq!(of_the_first, [1]);
    pieces(&mut board);
    assert!(!board.task.is_busy());
}

#[test]
fn power_that_goes_between_two_pieces_of_an_end_leaves_the_vehicle_before_it_or_after_it() {
    let mut runs = Vec::new();
    for done in 0..=3 {
        let (mut board, description, log) = running(described());
        log.iter().for_each(|measurement| drop(board.measure(measurement)));
        let message = board.desk.secured(Request::Command(Command::End)).unwrap();
        board.task.begin_message(&message, &mut board.wire);
        (0..done).for_each(|_| board.task.go_on(&mut board.wire));
        let mut board = board.restart();
        board.prepare(&description, Direction::Up);
        let memory = board.status().memory;
        assert!(matches!(memory, Memory::Empty | Memory::Restored), "{memory:?}");
        runs.push(memory == Memory::Restored);
    }
    // Nothing, what it taught, the record and the summary, the answer.
    assert_eq!(runs, [false, false, true, true]);
}
