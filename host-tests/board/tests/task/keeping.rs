//! What was learned: it survives the power, until somebody asks to forget it.

use board_tests::board::{Board, described, running};
use board_tests::prelude::*;
use board_tests::said;
use rundown_wire::{Learned, Memory, Refusal};

#[test]
fn what_was_learned_survives_the_power() {
    let (mut board, description, log) = running(described());
    for measurement in &log {
        board.measure(measurement);
    }
    let learned = said!(board.end(), RunSummary).unwrap();
    let status = board.status();
    assert_eq!((status.records, status.memory), ([1, 0], Memory::Empty), "as it was found");

    let mut board = board.restart();
    board.prepare(&description, Direction::Up);
    assert_eq!(board.status().memory, Memory::Restored);
    for measurement in log.iter().take(2) {
        board.measure(measurement);
    }
    let after = said!(board.end(), RunSummary).unwrap();
    assert_eq!(after.vehicle_davis, learned.vehicle_davis);
    assert_ne!(after.vehicle_davis[2].value, description.train.davis.r2 as f32);
    assert_eq!(after.run, 1, "two samples at standstill say nothing");
}

#[test]
fn forgetting_is_for_between_runs_and_is_kept() {
    let (mut board, description, log) = running(described());
    assert_eq!(board.ask(Request::Command(Command::Forget)), Err(Refusal::Running));
    for measurement in &log {
        board.measure(measurement);
    }
    let learned = said!(board.end(), RunSummary).expect("a summary").vehicle_davis;
    let [kept, failed] = board.status().records;
    assert_eq!(board.ask(Request::Command(Command::Forget)), Ok(()));
    assert_eq!(board.status().records, [kept + 1, failed]);
    let mut board = board.restart();
    board.prepare(&description, Direction::Up);
    let forgotten = said!(board.end(), RunSummary).expect("a summary").vehicle_davis;
    assert_ne!(forgotten, learned);
    let described = [description.train.davis.r0, description.train.davis.r1, description.train.davis.r2];
    assert_eq!(forgotten.map(|coefficient| coefficient.value), described.map(|value| value as f32));
}

#[test]
fn a_train_counts_as_learned_once_its_runs_say_so_and_until_it_is_forgotten() {
    let (mut board, description, log) = running(described());
    let learned_first = |board: &mut Board| said!(board.measure(&log[0]), Parameters).unwrap().learned;
    assert_eq!(learned_first(&mut board), Learned::NotYet);
    let mut last = Learned::NotYet;
    for measurement in &log[1..] {
        last = said!(board.measure(measurement), Parameters).unwrap().learned;
    }
    assert_eq!(last, Learned::Learned);
    board.end();
    let mut board = board.restart();
    board.prepare(&description, Direction::Up);
    assert_eq!(learned_first(&mut board), Learned::Learned);
    board.end();
    board.ask(Request::Command(Command::Forget)).unwrap();
    board.prepare(&description, Direction::Up);
    assert_eq!(learned_first(&mut board), Learned::NotYet);
}
