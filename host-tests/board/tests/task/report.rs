//! What a tick says: the estimate as the estimator makes it, and the frames of a minute and of two.

use crate::board;
use board_tests::board::{described, estimate, running};
use board_tests::described::measurements;
use board_tests::prelude::*;
use board_tests::said;
use rundown_truth::sensors::SpeedReading;
use rundown_wire::{Body, Downlink, SWITCHING_POINTS};

#[test]
fn every_tick_says_what_the_estimator_says() {
    let (mut board, description, log) = running(described());
    let estimator = description.estimator().unwrap();
    let mut vehicle = estimator.new_vehicle();
    let mut run = estimator.begin_run(&vehicle, Direction::Up);
    for measurement in &log {
        let frames = board.measure(measurement);
        let found = estimate(&frames).expect("an estimate for each measurement");
        let expected = estimator.step(&mut run, measurement).unwrap();
        assert_eq!(found.digest, digest::of_estimate(&expected));
        assert_eq!(found.location_m.value, expected.belief.mean[0] as f32);
        assert_eq!(found.regime, expected.regime);
        // The estimate closes the tick.
        assert!(matches!(frames.last().map(|frame| &frame.body), Some(Body::Estimate(_))));
    }
    let found = said!(board.end(), RunSummary).expect("a summary");
    let expected = estimator.end_run(&mut run, &mut vehicle);
    assert_eq!(found.learned_s, expected.learned_s as f32);
    assert_eq!(found.run_davis[2].value, expected.run_davis.mean[2] as f32);
    assert!(expected.learned_s > 60.0, "the run has something to learn");
}

#[test]
fn sequence_numbers_count_every_frame() {
    let (mut board, _, log) = running(described());
    let mut next = None;
    for measurement in &log {
        for frame in board.measure(measurement) {
            if let Some(next) = next {
                assert_eq!(frame.sequence, next);
            }
            next = Some(frame.sequence.wrapping_add(1));
        }
    }
}

/// The numbers of the ticks in which a kind of frame was said.
fn ticks_with(frames: &[Downlink], is_kind: impl Fn(&Body) -> bool) -> Vec<u32> {
    frames.iter().filter(|frame| is_kind(&frame.body)).map(|frame| frame.tick).collect()
}

#[test]
fn a_minute_and_two_have_frames_of_their_own() {
    let (mut board, _, log) = running(described());
    let frames: Vec<Downlink> = log[..48].iter().flat_map(|measurement| board.measure(measurement)).collect();
    let each: Vec<u32> = (1..=48).collect();
    assert_eq!(ticks_with(&frames, |body| matches!(body, Body::Parameters(_))), each);
    assert_eq!(ticks_with(&frames, |body| matches!(body, Body::Effort(_))), each);
    assert_eq!(ticks_with(&frames, |body| matches!(body, Body::Estimate(_))), each);
    let minutes = [6, 12, 18, 24, 30, 36, 42, 48];
    assert_eq!(ticks_with(&frames, |body| matches!(body, Body::Features(_))), minutes);
    assert_eq!(ticks_with(&frames, |body| matches!(body, Body::Status(_))), minutes);
    // A snapshot begins half a minute behind every second one.
    let begins = |body: &Body| matches!(body, Body::SnapshotPart(part) if part.first == 0);
    assert_eq!(ticks_with(&frames, begins), [3, 15, 27, 39]);
}

#[test]
fn a_coast_ahead_is_said_again_after_each_minute_and_never_in_the_longest_ticks() {
    let (mut board, _, log) = running(board_tests::board::case_study());
    let frames: Vec<Downlink> = log.iter().flat_map(|measurement| board.measure(measurement)).collect();
    let said = ticks_with(&frames, |body| matches!(body, Body::CoastAhead(_)));
    assert!(said.iter().all(|tick| tick % 6 != 0 && tick % 12 != 3), "{said:?}");
    let (first, last) = (said[0], *said.last().unwrap());
    let after_minutes: Vec<u32> = (first..=last).filter(|tick| tick % 6 == 1).collect();
    assert!(after_minutes.len() > 15 && after_minutes.iter().all(|tick| said.contains(tick)), "{said:?}");
    assert!(said.len() > after_minutes.len(), "and what is new at once");
}

#[test]
fn a_recorder_that_cuts_speeds_off_is_named_once_it_is_found() {
    let sensors = Sensors { speed: SpeedReading::Truncated, ..Sensors::default() };
    let scenario = Scenario { sensors, ..Scenario::default() };
    let (description, _) = described();
    let mut board = board();
    let is_recorder = |body: &Body| matches!(body, Body::Recorder(_));
    let mut named = Vec::new();
    for seed in 0..8 {
        board.prepare(&description, Direction::Up);
        let log = measurements(&simulate(&scenario, seed));
        let frames: Vec<Downlink> = log.iter().flat_map(|measurement| board.measure(measurement)).collect();
        let ticks = ticks_with(&frames, is_recorder);
        assert!(ticks.iter().all(|tick| tick % 6 == 0), "{ticks:?}");
        let summary = said!(board.end(), Recorder);
        assert!(ticks.is_empty() || summary.is_some());
        named.push(summary.map(|recorder| recorder.speed_offset_mps.value * 3.6));
    }
    assert_eq!(named[0], None, "one run does not say");
    let offset_kmh = named[7].expect("found");
    assert!((offset_kmh - 0.5).abs() < 0.15, "half a step of 1 km/h: {offset_kmh}");
}

#[test]
fn a_summary_has_all_switching_points_and_a_minute_the_last_ones() {
    let (mut board, description, log) = running(described());
    // Three times the run's points, without the leap of the location back to the begin.
    let again_s = log.last().unwrap().time_s - log[0].time_s + 10.0;
    let drive = |round: usize| {
        let later = move |one: &Measurement| Measurement {
            time_s: one.time_s + again_s * round as f64,
            location_m: None,
            ..*one
        };
        log.iter().map(later)
    };
    let log: Vec<Measurement> = (0..3).flat_map(drive).collect();
    let estimator = description.estimator().unwrap();
    let mut vehicle = estimator.new_vehicle();
    let mut run = estimator.begin_run(&vehicle, Direction::Up);
    let mut minutes = 0;
    for measurement in &log {
        estimator.step(&mut run, measurement).unwrap();
        if let Some(said) = said!(board.measure(measurement), SwitchingPoints) {
            assert_eq!(usize::from(said.first) + said.points.len(), usize::from(said.total));
            assert_eq!(said.points.len(), SWITCHING_POINTS.min(said.total.into()));
            minutes += 1;
        }
    }
    assert_eq!(minutes, log.len() / 6);
    let summary = estimator.end_run(&mut run, &mut vehicle);
    let expected: Vec<f64> = summary.features.switching_points.iter().map(|point| point.time_s).collect();
    let mut found = Vec::new();
    for frame in board.end() {
        if let Some(said) = said!([frame], SwitchingPoints) {
            assert_eq!(usize::from(said.first), found.len());
            found.extend(said.points.iter().map(|point| point.time_s));
        }
    }
    assert_eq!(found, expected);
    assert!(expected.len() > SWITCHING_POINTS, "more than one frame: {}", expected.len());
}
