//! What was learned: it survives the power, until somebody asks to forget it.

use board_tests::board::{Board, described, running};
use board_tests::prelude::*;
use board_tests::said;
use rundown::model::effects::{Effect, WarmUp};
use rundown::model::resistance::Davis;
use rundown::model::train::TrainDescription;
use rundown::uplink::Setting;
use rundown_wire::{Learned, Memory, Refusal, RunSummary};

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

#[test]
fn what_others_taught_stays_while_the_papers_mode_runs() {
    let (mut board, description, log) = running(described());
    log.iter().for_each(|measurement| drop(board.measure(measurement)));
    let taught = said!(board.end(), RunSummary).unwrap().vehicle_davis;
    let begin = Request::Command(Command::Begin { direction: Direction::Up, track_id: description.track_id() });
    board.ask(Request::Setting(Setting::Mode(Mode::Paper))).unwrap();
    board.ask(begin.clone()).unwrap();
    log.iter().for_each(|measurement| drop(board.measure(measurement)));
    assert_ne!(said!(board.end(), RunSummary).unwrap().vehicle_davis, taught, "it has a vehicle of its own");
    assert_eq!(board.status().records, [1, 0], "which is not kept");
    board.ask(Request::Setting(Setting::Mode(Mode::Gated))).unwrap();
    board.ask(begin).unwrap();
    log[..2].iter().for_each(|measurement| drop(board.measure(measurement)));
    assert_eq!(said!(board.end(), RunSummary).unwrap().vehicle_davis, taught);
}

#[test]
fn a_vehicle_that_is_not_believed_takes_no_effects_away() {
    let (description, log) = described();
    let warm = Effect::WarmUp(WarmUp { amplitude: 1e-3, tau_s: 300.0 });
    let mut board = Board::running(&description);
    board.end();
    board.ask(Request::Effect(warm.to_frame())).unwrap();
    let begin = Request::Command(Command::Begin { direction: Direction::Up, track_id: description.track_id() });
    board.ask(begin).unwrap();
    log.iter().for_each(|measurement| drop(board.measure(measurement)));
    board.end();
    let mut board = board.restart();
    let TrainDescription { davis, .. } = description.train;
    let other = TrainDescription { davis: Davis { r0: 20.0 * davis.r0, ..davis }, ..description.train };
    board.prepare(&Description { train: other, ..description }, Direction::Up);
    assert_eq!(board.status().memory, Memory::Implausible);
    let effects = log.iter().find_map(|measurement| said!(board.measure(measurement), Effects));
    assert_eq!(effects.unwrap().effects.len(), 1);
}

#[test]
fn nothing_is_forgotten_before_the_train_is_described() {
    let (mut board, description, log) = running(described());
    log.iter().for_each(|measurement| drop(board.measure(measurement)));
    board.end();
    let mut board = board.restart();
    board.status();
    assert_eq!(board.ask(Request::Command(Command::Forget)), Err(Refusal::NotDescribed));
    board.prepare(&description, Direction::Up);
    assert_eq!(board.status().memory, Memory::Restored);
}

/// What a board that was asked nothing else says of its vehicle after a run of such rows.
fn taught_by(rows: impl Fn(usize, Measurement) -> Measurement) -> RunSummary {
    let (mut board, _, log) = running(described());
    for (number, measurement) in log.iter().enumerate() {
        board.measure(&rows(number, *measurement));
    }
    said!(board.end(), RunSummary).expect("a summary")
}

#[test]
fn a_run_that_is_mostly_invalid_does_not_change_the_vehicle() {
    let ticks = described().1.len();
    let without_location_before = |first: usize| {
        taught_by(move |number, row| Measurement { location_m: row.location_m.filter(|_| number >= first), ..row })
    };
    let untouched = taught_by(|_, row| Measurement { location_m: None, speed_mps: None, ..row });
    assert_eq!(untouched.learned_s, 0.0);
    // The first minute without a location is held, not invalid.
    let mostly = without_location_before(ticks / 2 + 8);
    assert_eq!((mostly.learned_s, mostly.vehicle_davis), (0.0, untouched.vehicle_davis));
    assert_ne!(mostly.run_davis, untouched.run_davis, "it had learned something");
    let less = without_location_before(ticks / 2 + 4);
    assert!(less.learned_s > 0.0);
    assert_ne!(less.vehicle_davis, untouched.vehicle_davis);
}
