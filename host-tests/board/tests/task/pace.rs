//! By the clock or in lockstep: which measurement makes a tick.

use board_tests::board::{answer, described, estimate, running};
use board_tests::prelude::*;
use board_tests::said;
use rundown_wire::{Body, Refusal};

#[test]
fn by_the_clock_the_newest_measurement_counts() {
    let (mut board, _, log) = running(described());
    board.ask(Request::Command(Command::Pace(Pace::Clock))).unwrap();
    assert!(board.measure(&log[0]).is_empty());
    assert!(board.measure(&log[1]).is_empty());
    let frames = board.tick();
    assert_eq!(estimate(&frames).unwrap().time_s, log[1].time_s);
    // No measurement: the board still says how it is.
    let frames = board.tick();
    assert!(matches!(frames[0].body, Body::Status(status) if status.silent_ticks == 1));
    // Older than the last one: judged at the tick.
    assert!(board.measure(&log[0]).is_empty());
    let frames = board.tick();
    assert_eq!(answer(&frames).unwrap().result, Err(Refusal::TimeNotIncreasing));
    assert_eq!(estimate(&frames), None);
    // Nor is that a reason to fall silent.
    assert_eq!(said!(frames, Status).map(|status| status.silent_ticks), Some(2));
    // One that follows displaces it.
    assert!(board.measure(&log[0]).is_empty());
    assert!(board.measure(&log[2]).is_empty());
    assert_eq!(answer(&board.measure(&log[0])).unwrap().result, Err(Refusal::TimeNotIncreasing));
    assert_eq!(estimate(&board.tick()).unwrap().time_s, log[2].time_s);
}

#[test]
fn by_the_clock_a_far_time_gives_way_to_one_that_follows() {
    let (mut board, _, log) = running(described());
    board.ask(Request::Command(Command::Pace(Pace::Clock))).unwrap();
    board.measure(&log[0]);
    board.tick();
    let far = Measurement { time_s: log[1].time_s + 1e6, ..log[1] };
    assert!(board.measure(&far).is_empty(), "it waits where no other does");
    assert!(board.measure(&log[1]).is_empty());
    assert_eq!(answer(&board.measure(&far)).unwrap().result, Err(Refusal::OutOfRange));
    assert_eq!(estimate(&board.tick()).unwrap().time_s, log[1].time_s);
}

#[test]
fn by_the_clock_the_first_of_two_with_the_same_time_waits() {
    let (mut board, _, log) = running(described());
    board.ask(Request::Command(Command::Pace(Pace::Clock))).unwrap();
    assert!(board.measure(&log[0]).is_empty());
    assert_eq!(answer(&board.measure(&log[0])).unwrap().result, Err(Refusal::TimeNotIncreasing));
}

#[test]
fn in_lockstep_the_clock_says_nothing() {
    let (mut board, ..) = running(described());
    assert!(board.tick().is_empty());
}

#[test]
fn lockstep_drops_what_waits_for_the_clock_and_the_clock_once_more_does_not() {
    let (mut board, _, log) = running(described());
    let clock = Request::Command(Command::Pace(Pace::Clock));
    board.ask(clock.clone()).unwrap();
    board.measure(&log[0]);
    board.ask(clock).unwrap();
    assert_eq!(estimate(&board.tick()).unwrap().time_s, log[0].time_s);
    board.measure(&log[1]);
    board.ask(Request::Command(Command::Pace(Pace::Lockstep))).unwrap();
    assert!(board.tick().is_empty());
    assert_eq!(estimate(&board.measure(&log[1])).unwrap().time_s, log[1].time_s);
}
