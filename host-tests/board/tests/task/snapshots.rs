//! Snapshots: a run goes on where the power went, and no other one does.

use board_tests::board::{Board, described, estimate, running};
use board_tests::prelude::*;
use board_tests::said;
use rundown::uplink::Setting;
use rundown_wire::Refusal;

#[test]
fn a_brown_out_in_the_middle_of_a_run_loses_nothing() {
    let (description, log) = described();
    let [mut whole, mut broken] = [(); 2].map(|()| Board::running(&description));
    for (tick, measurement) in log.iter().enumerate() {
        if tick == 60 {
            let snapshot = broken.snapshot();
            broken = broken.restart();
            broken.describe(&description);
            broken.ask(Request::Command(Command::Pace(Pace::Lockstep))).unwrap();
            for part in snapshot {
                broken.ask(Request::Snapshot(part)).unwrap();
            }
        }
        let expected = estimate(&whole.measure(measurement));
        assert_eq!(estimate(&broken.measure(measurement)), expected, "tick {tick}");
    }
    let (expected, found) = (whole.end(), broken.end());
    assert!(said!(found, RunSummary).is_some() && said!(found, Features).is_some());
    assert_eq!(said!(found, RunSummary), said!(expected, RunSummary));
    assert_eq!(said!(found, Features), said!(expected, Features));
}

#[test]
fn a_snapshot_of_another_setup_is_refused() {
    let (mut board, _, log) = running(described());
    board.measure(&log[0]);
    let parts = board.snapshot();
    board.ask(Request::Command(Command::End)).unwrap();
    let mut damaged = parts.clone();
    damaged[0].bytes[5] ^= 1;
    let (last, rest) = damaged.split_last().unwrap();
    for part in rest {
        board.ask(Request::Snapshot(part.clone())).unwrap();
    }
    assert_eq!(board.ask(Request::Snapshot(last.clone())), Err(Refusal::Snapshot));
    assert!(!board.status().running);
    board.ask(Request::Setting(Setting::Mode(Mode::Measured))).unwrap();
    assert_eq!(board.ask(Request::Snapshot(parts[0].clone())), Err(Refusal::Snapshot));
}

#[test]
fn parts_of_a_snapshot_come_in_order_and_belong_together() {
    let (mut board, description, log) = running(described());
    board.measure(&log[0]);
    let parts = board.snapshot();
    let mut board = board.restart();
    board.describe(&description);
    assert!(parts.len() > 2);
    assert_eq!(board.ask(Request::Snapshot(parts[1].clone())), Err(Refusal::OutOfOrder), "the second one first");
    assert_eq!(board.ask(Request::Snapshot(parts[0].clone())), Ok(()));
    assert_eq!(board.ask(Request::Snapshot(parts[2].clone())), Err(Refusal::OutOfOrder), "one is left out");
    for spoil in
        [(|part| part.total += 1) as fn(&mut rundown_wire::SnapshotPart), |part| part.tick += 1, |part| part.crc ^= 1]
    {
        let mut other = parts[1].clone();
        spoil(&mut other);
        assert_eq!(board.ask(Request::Snapshot(other)), Err(Refusal::OutOfOrder), "of another snapshot");
    }
    for part in &parts[1..] {
        assert_eq!(board.ask(Request::Snapshot(part.clone())), Ok(()));
    }
    assert!(board.status().running);
}

#[test]
fn a_snapshot_of_a_run_that_has_ended_does_not_teach_once_more() {
    let (mut board, description, log) = running(described());
    log[..60].iter().for_each(|measurement| drop(board.measure(measurement)));
    let parts = board.snapshot();
    board.end();
    let taken = |board: &mut Board| {
        let (last, rest) = parts.split_last().unwrap();
        rest.iter().for_each(|part| board.ask(Request::Snapshot(part.clone())).unwrap());
        board.ask(Request::Snapshot(last.clone()))
    };
    assert_eq!(taken(&mut board), Err(Refusal::Snapshot));
    // Nor where the power went at the end of the run, and the desk does not know that it has ended.
    let mut board = board.restart();
    board.describe(&description);
    assert_eq!(taken(&mut board), Err(Refusal::Snapshot));
}
