//! Does the board answer in the order that the document states?

use host_tests::board::{described, running};
use host_tests::prelude::*;
use rundown_wire::{Body, Downlink};

fn names(frames: &[Downlink]) -> Vec<&'static str> {
    frames.iter().map(|frame| frame.body.as_str()).collect()
}

const TICK: [&str; 3] = ["parameters", "effort", "estimate"];
const MINUTE: [&str; 5] = ["features", "switching_points", "status", "health", "versions"];

#[test]
fn the_frames_of_a_tick_come_in_this_order() {
    let (mut board, _, log) = running(described());
    let mut all_parts = 0;
    for (tick, measurement) in (1..=14).zip(&log) {
        let frames = board.measure(measurement);
        assert!(frames.iter().all(|frame| frame.tick == tick));
        if tick == 1 {
            // The answer to `begin` was number 0.
            assert_eq!(frames[0].sequence, 1);
        }
        let mut expected = TICK.to_vec();
        if tick % 6 == 0 {
            expected.splice(2..2, MINUTE);
        }
        let mut found = names(&frames);
        let parts = found.iter().filter(|name| **name == "snapshot_part").count();
        all_parts += parts;
        // From the third tick on until it is out, which is before the next one.
        let begun = tick >= 3 && parts > 0;
        assert!(parts <= 2 && (begun || parts == 0), "tick {tick}: {parts}");
        assert_eq!(all_parts == 0, tick < 3, "tick {tick}");
        assert!(tick < 13 || parts == 0, "tick {tick}: {parts}");
        let last = found.len() - 1;
        found.drain(last - parts..last);
        assert_eq!(found, expected, "tick {tick}");
    }
}

#[test]
fn the_end_of_a_run_comes_in_this_order() {
    let (mut board, _, log) = running(described());
    for measurement in &log {
        board.measure(measurement);
    }
    let end = board.desk.secured(Request::Command(Command::End)).unwrap();
    let mut found = names(&board.say(&end));
    found.dedup();
    assert_eq!(found, ["features", "switching_points", "run_summary", "status", "health", "versions", "answer"]);
    // The same bytes once more: no answer at all.
    assert_eq!(board.say(&end), []);
}

#[test]
fn a_long_stop_ends_the_run_with_the_estimate_and_the_next_one_begins_at_zero() {
    let (mut board, _, log) = running(described());
    for measurement in &log {
        board.measure(measurement);
    }
    let mut standing = *log.last().unwrap();
    standing.speed_mps = Some(0.0);
    let last = (0..60).find_map(|_| {
        standing.time_s += 10.0;
        let frames = board.measure(&standing);
        let ends = names(&frames).contains(&"run_summary");
        ends.then_some(frames)
    });
    let last = last.expect("a run that ends");
    let [.., before, estimate] = &last[..] else {
        panic!("two frames at least: {last:?}");
    };
    assert_eq!(before.body.as_str(), "versions");
    assert!(matches!(estimate.body, Body::Estimate(_)));
    assert_eq!((estimate.sequence, estimate.tick), (before.sequence + 1, before.tick));
    standing.time_s += 10.0;
    let next = board.measure(&standing);
    assert_eq!((next[0].sequence, next[0].tick), (0, 1));
}
