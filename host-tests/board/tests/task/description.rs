//! Train, track and settings: taken whole or not at all, and only between runs.

use crate::board;
use board_tests::board::{Board, PROVISIONING, answer, described, estimate, running};
use board_tests::prelude::*;
use rundown::onboard::event::Event;
use rundown::uplink::Setting;
use rundown_wire::Refusal;

#[test]
fn settings_are_refused_whole() {
    let (mut board, description, log) = running(described());
    let setup = board.status().setup;
    assert_eq!(board.ask(Request::Setting(Setting::Mode(Mode::Paper))), Err(Refusal::Running));
    board.ask(Request::Command(Command::End)).unwrap();
    let mut sensor = description.config.sensor;
    sensor.location_sd_m = f64::NAN;
    assert_eq!(board.ask(Request::Setting(Setting::Sensor(sensor))), Err(Refusal::OutOfRange));
    let mut train = description.train;
    train.mass_kg = 0.0;
    let wrong = Description { train, ..description.clone() };
    let mut refusals = vec![];
    for request in wrong.requests(PROVISIONING.train.0) {
        refusals.extend(board.ask(request).err());
    }
    assert_eq!(refusals, [Refusal::OutOfRange]);
    assert_eq!(
        board.ask(description.requests(1).into_iter().find(|request| matches!(request, Request::Train(_))).unwrap()),
        Err(Refusal::OtherTrain)
    );
    assert_eq!(board.status().setup, setup);
    assert_eq!(answer(&board.measure(&log[0])).unwrap().result, Err(Refusal::NotRunning));
}

#[test]
fn a_track_comes_whole_or_not_at_all() {
    let (mut description, _) = described();
    description.gradients = (0..100)
        .map(|i| rundown::model::track::Gradient { from_m: 100.0 * f64::from(i), permille: f64::from(i % 7) })
        .collect();
    let mut board = board();
    board.status();
    let mut requests = description.requests(PROVISIONING.train.0);
    let last = requests.pop().unwrap();
    let middle = requests.pop().unwrap();
    for request in requests {
        board.ask(request).unwrap();
    }
    assert_eq!(board.ask(last.clone()), Err(Refusal::OutOfOrder));
    assert_eq!(board.status().track_id, None);
    board.ask(middle).unwrap();
    board.ask(last).unwrap();
    assert_eq!(board.status().track_id, Some(description.track_id()));
}

#[test]
fn a_run_needs_a_train_and_a_track() {
    let (description, log) = described();
    let track_id = description.track_id();
    for is_left_out in
        [(|request: &Request| matches!(request, Request::Train(_))) as fn(&Request) -> bool, |request: &Request| {
            matches!(request, Request::Track(_))
        }]
    {
        let mut board = board();
        board.status();
        for request in description.requests(PROVISIONING.train.0).into_iter().filter(|request| !is_left_out(request)) {
            board.ask(request).unwrap();
        }
        let begin = Request::Command(Command::Begin { direction: Direction::Up, track_id });
        assert_eq!(board.ask(begin), Err(Refusal::NotDescribed));
        assert_eq!(answer(&board.measure(&log[0])).unwrap().result, Err(Refusal::NotDescribed));
    }
}

#[test]
fn the_papers_vehicle_begins_with_deviations_of_its_own() {
    let (description, log) = described();
    let mut board = board();
    board.describe(&description);
    board.ask(Request::Setting(Setting::Mode(Mode::Paper))).unwrap();
    let track_id = description.track_id();
    board.ask(Request::Command(Command::Pace(Pace::Lockstep))).unwrap();
    board.ask(Request::Command(Command::Begin { direction: Direction::Up, track_id })).unwrap();
    let config = Config { mode: Mode::Paper, ..description.config };
    let estimator = Description { config, ..description }.estimator().unwrap();
    let mut run = estimator.begin_run(&estimator.new_vehicle(), Direction::Up);
    for measurement in &log[..30] {
        let expected = estimator.step(&mut run, measurement).unwrap();
        assert_eq!(estimate(&board.measure(measurement)).unwrap().digest, digest::of_estimate(&expected));
    }
}

#[test]
fn a_train_that_is_described_once_more_is_not_looked_for_again() {
    let (mut board, description, _) = running(described());
    board.end();
    board.prepare(&description, Direction::Up);
    let looked = board.log.iter().filter(|event| matches!(event, Event::Vehicle { .. })).count();
    assert_eq!(looked, 1, "{:?}", board.log);
}

#[test]
fn only_a_change_to_or_from_the_papers_mode_looks_for_the_vehicle_again() {
    let mut board = board();
    let (description, _) = described();
    let looked = |board: &Board| board.log.iter().filter(|event| matches!(event, Event::Vehicle { .. })).count();
    board.status();
    board.ask(Request::Setting(Setting::Mode(Mode::Paper))).unwrap();
    assert_eq!(looked(&board), 0, "no train is described yet");
    board.describe(&description);
    board.ask(Request::Setting(Setting::Mode(Mode::Gated))).unwrap();
    let before = looked(&board);
    let modes = [(Mode::Measured, 0), (Mode::Paper, 1), (Mode::Paper, 1), (Mode::Gated, 2), (Mode::Measured, 2)];
    for (mode, more) in modes {
        board.ask(Request::Setting(Setting::Mode(mode))).unwrap();
        assert_eq!(looked(&board), before + more, "{mode:?}");
    }
}

#[test]
fn another_description_of_the_train_comes_into_force() {
    let (mut board, mut description, log) = running(described());
    board.end();
    let before = board.status().setup;
    description.train.mass_kg *= 1.1;
    board.prepare(&description, Direction::Up);
    assert_ne!(board.status().setup, before);
    let estimator = description.estimator().unwrap();
    let mut run = estimator.begin_run(&estimator.new_vehicle(), Direction::Up);
    for measurement in &log[..30] {
        let expected = estimator.step(&mut run, measurement).unwrap();
        assert_eq!(estimate(&board.measure(measurement)).unwrap().digest, digest::of_estimate(&expected));
    }
}
