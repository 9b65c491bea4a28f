//! What is left when the power goes? The firmware on the test board of the emulator, whose flash is a file: killing the
//! emulator is the loss of power.

use emulator::{Board, Emulator, FlashFile, Settings};
use host_tests::board::{PROVISIONING, described};
use host_tests::prelude::*;
use host_tests::said;
use host_tests::target::on_target;
use rundown_wire::{Body, Downlink, Memory};
use sim_harness::session::Heard;
use std::thread::sleep;
use std::time::Duration;

fn frames(heard: Vec<Heard>) -> Vec<Downlink> {
    heard.into_iter().map(|heard| heard.frame).collect()
}

/// The test board with a key in its flash; the folder holds the flash.
fn provisioned() -> (Settings, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let flash = FlashFile::erased(&folder.path().join("flash")).unwrap();
    flash.put_key(&PROVISIONING.to_bytes()).unwrap();
    (Settings { flash: Some(flash), ..Settings::new(Board::Mps2).unwrap() }, folder)
}

#[test]
#[ignore = "needs the firmware and its emulator: cargo xtask test"]
fn what_was_learned_outlives_the_power_wherever_it_is_cut() {
    let (settings, _folder) = provisioned();
    let (description, log) = described();

    let mut emulator = Emulator::start(&settings).unwrap();
    let mut session = on_target(&mut emulator).unwrap();
    session.prepare(&description, Direction::Up, Pace::Lockstep).unwrap();
    for measurement in &log {
        session.measure(measurement).unwrap();
    }
    let learned = said!(frames(session.end_run().unwrap()), RunSummary).unwrap();
    assert!(learned.learned_s > 60.0);
    drop(emulator);

    // The board writes two records at each start: cut it before, within and after.
    let mut before = None;
    for cut_us in [0, 300, 1000, 3000, 10_000, 20_000, 30_000, 50_000, 80_000, 200_000] {
        let emulator = Emulator::start(&settings).unwrap();
        sleep(Duration::from_micros(cut_us));
        drop(emulator);

        let mut emulator = Emulator::start(&settings).unwrap();
        let mut session = on_target(&mut emulator).unwrap();
        session.prepare(&description, Direction::Up, Pace::Lockstep).unwrap();
        let now = said!(frames(session.greet().unwrap()), Status).unwrap();
        assert!(
            matches!(now.memory, Memory::Restored | Memory::RestoredOlder),
            "cut after {cut_us} us: {:?}",
            now.memory
        );
        session.measure(&log[0]).unwrap();
        let after = said!(frames(session.end_run().unwrap()), RunSummary).unwrap();
        assert_eq!(after.vehicle_davis, learned.vehicle_davis, "{cut_us} us");
        // What was signed for an earlier start is of no use now.
        let epoch = now.announcement.map(|announcement| announcement[..4].to_vec());
        assert!(epoch > before, "{before:?} {epoch:?}");
        before = epoch;
    }
}

/// The run goes on in a board that has lost everything but its flash, from the snapshot that the desk kept.
#[test]
#[ignore = "needs the firmware and its emulator: cargo xtask test"]
fn a_run_goes_on_after_a_brown_out() {
    let (settings, _folder) = provisioned();
    let (description, log) = described();
    let estimator = description.estimator().unwrap();
    let mut run = estimator.begin_run(&estimator.new_vehicle(), Direction::Up);
    let (before, after) = log.split_at(100);

    let mut emulator = Emulator::start(&settings).unwrap();
    let mut session = on_target(&mut emulator).unwrap();
    session.prepare(&description, Direction::Up, Pace::Lockstep).unwrap();
    for measurement in before {
        session.measure(measurement).unwrap();
        estimator.step(&mut run, measurement).unwrap();
    }
    // What is on its way is of an earlier tick; the one after it is of now.
    let parts = loop {
        let what = "a snapshot";
        session.ask(Request::Command(Command::Snapshot), what).unwrap();
        if let Some(parts) = session.desk().snapshot().filter(|parts| parts[0].tick == 100) {
            break parts.to_vec();
        }
    };
    drop(emulator);

    let mut emulator = Emulator::start(&settings).unwrap();
    let mut session = on_target(&mut emulator).unwrap();
    session.greet().unwrap();
    for request in description.requests(PROVISIONING.train.0) {
        session.ask(request, "the description").unwrap();
    }
    let pace = Request::Command(Command::Pace(Pace::Lockstep));
    session.ask(pace, "the pace").unwrap();
    for part in parts {
        session.ask(Request::Snapshot(part), "a part of the snapshot").unwrap();
    }
    for measurement in after {
        let frames = session.measure(measurement).unwrap();
        let expected = estimator.step(&mut run, measurement).unwrap();
        let Some(Body::Estimate(found)) = frames.last().map(|heard| &heard.frame.body) else {
            panic!("no estimate at {} s", measurement.time_s);
        };
        assert_eq!(found.digest, digest::of_estimate(&expected), "at {} s", measurement.time_s);
    }
}
