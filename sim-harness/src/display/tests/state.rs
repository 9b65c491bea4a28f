//! What is known from frames in any order, with losses and noise.

use super::{MESSAGES, estimates, on_the_line, shown};
use crate::display::hub::{Connection, Hub};
use crate::{display::setup::Setup, display::state::State, display::text};
use proptest::prelude::*;
use rundown::link::serial;
use rundown_wire::{Answer, Body, Downlink, Order, Reader, Received, Recorder, Value};
use std::time::Duration;

#[test]
fn two_runs_are_shown_one_as_past() {
    let hub = shown(&on_the_line(&MESSAGES));
    hub.view(|view| {
        let State { now, points, previous, past, .. } = view.state;
        assert_eq!(past.len(), 2);
        assert_eq!(past[1].summary.run, 2);
        assert!(past[0].features.unwrap().final_coast.is_some());
        assert_eq!(points.last().unwrap().time_s, now.estimate.unwrap().time_s);
        assert!(previous.len() > 50 && points.len() > 50);
        assert_eq!(now.effects[0].name, "power_limit_section");
        assert_eq!(now.effects[0].section_m, Some([0.0, 4000.0]));
        assert_eq!(view.link.connection, Connection::Ended);
        assert_eq!(view.link.tally.frames as usize, MESSAGES.len());
        assert_eq!((view.link.tally.lost, view.link.tally.damaged), (0, 0));
    });
}

#[test]
fn the_regime_of_a_point_is_the_confirmed_one() {
    let hub = shown(&on_the_line(&MESSAGES));
    let is_end = |message: &Vec<u8>| matches!(Downlink::decode(message).unwrap().body, Body::RunSummary(_));
    let second_run = MESSAGES.iter().position(is_end).unwrap();
    let mut confirmed = Vec::new();
    for message in &MESSAGES[second_run..] {
        if let Body::Estimate(estimate) = Downlink::decode(message).unwrap().body {
            confirmed.push((estimate.time_s, estimate.confirmed));
        }
    }
    let mut changed = 0;
    hub.view(|view| {
        for pair in confirmed.windows(2) {
            let point = view.state.points.iter().find(|point| point.time_s == pair[0].0);
            if let (Some(point), Some(regime)) = (point, pair[1].1) {
                assert_eq!(point.regime, regime, "at {} s", pair[0].0);
                changed += 1;
            }
        }
    });
    assert!(changed > 50, "{changed}");
}

#[test]
fn frames_that_never_come_leave_a_gap_in_the_curve() {
    let mut messages = MESSAGES[..200].to_vec();
    messages.drain(100..140);
    let hub = shown(&on_the_line(&messages));
    hub.view(|view| {
        assert_eq!(view.link.tally.lost, 40);
        let gaps = view.state.points.iter().filter(|point| point.gap).count();
        assert_eq!(gaps, 1);
        assert_eq!(view.state.points.len(), estimates(&messages).len());
    });
}

#[test]
fn old_values_are_called_old() {
    // Faster than real time, so that the test does not wait for 25 s.
    let hub = Hub::new("test".to_owned(), 100.0, Setup::default(), Box::new(|_, _| {}));
    assert!(hub.view(|view| view.link.silent), "nothing has come yet");
    hub.message(&MESSAGES[30]);
    assert!(!hub.view(|view| view.link.silent));
    std::thread::sleep(Duration::from_millis(2100));
    assert!(hub.view(|view| view.link.silent));
}

#[test]
fn the_board_s_firmware_is_shown_from_its_first_status_on() {
    let hub = shown(&on_the_line(&MESSAGES));
    let version = format!("firmware {} (", env!("CARGO_PKG_VERSION"));
    let said = hub.view(|view| view.state.now.versions).expect("a board that says its version");
    assert!(said.to_string().starts_with(&version), "{said}");
}

#[test]
fn that_speeds_are_cut_off_is_shown_until_the_run_is_over() {
    let recorder = Recorder { speed_offset_mps: Value { value: 0.14, sd: 0.01 }, put_right: false };
    let mut state = State::default();
    let mut take = |tick, body| {
        state.take(&Received { frame: Downlink { sequence: 7, tick, body }, order: Order::Next });
        state.now.recorder
    };
    assert_eq!(take(300, Body::Recorder(recorder)), Some(recorder));
    let answer = || Body::Answer(Answer { to: 4, result: Ok(()) });
    assert_eq!((take(301, answer()), take(1, answer())), (Some(recorder), None));
}

#[test]
fn a_line_of_json_has_the_frame_and_its_order() {
    let body = Body::Answer(Answer { to: 4, result: Ok(()) });
    let received = Received { frame: Downlink { sequence: 7, tick: 300, body }, order: Order::Next };
    let expected =
        r#"{"order":"next","lost":0,"sequence":7,"tick":300,"body":{"answer":{"to":4,"result":{"Ok":null}}}}"#;
    assert_eq!(text::json(&received), expected);
}

#[test]
fn effects_have_the_names_of_the_estimator() {
    use rundown::model::effects::{Effect, EffectError, EffectKind, FrameError};
    for kind in EffectKind::ALL.into_iter().filter(|kind| *kind != EffectKind::Unknown) {
        let mut effect = rundown_wire::Effect { kind: kind.number(), section_m: None, values: Default::default() };
        // Not a number is refused under the effect's name, once the number of values and the section are right.
        effect.values = kind.parameters().iter().map(|_| f64::NAN).collect();
        let mut names = Vec::new();
        for section_m in [None, Some([0.0, 1.0])] {
            effect.section_m = section_m;
            match Effect::from_frame(&effect) {
                Err(FrameError::Refused(EffectError::OutOfRange(effect, _))) => {
                    names.push(effect);
                }
                Err(FrameError::Shape) => {}
                other => panic!("{kind}: {other:?}"),
            }
        }
        assert_eq!(names, [kind]);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Noise between whole messages: every frame is found or counted, nothing is made up.
    #[test]
    fn garbage_costs_at_most_the_message_that_it_runs_into(
        pieces in proptest::collection::vec(proptest::collection::vec(any::<u8>(), 0..60), 1..40)
    ) {
        let mut reader = Reader::new();
        let mut found = 0;
        for (piece, message) in pieces.iter().zip(MESSAGES.iter().skip(40)) {
            for byte in piece.iter().copied().chain(serial::encode(message).unwrap()) {
                found += usize::from(reader.byte(byte).is_some());
            }
        }
        let sent = pieces.len();
        let damaged = pieces.iter().filter(|piece| !piece.is_empty() && piece.last() != Some(&0)).count();
        prop_assert!(found >= sent - damaged && found <= sent);
        // A missing last frame is not missed yet.
        let tally = reader.tally();
        prop_assert!((tally.frames + tally.lost) as usize <= sent);
    }

    /// Any bytes at all through the whole display.
    #[test]
    fn nothing_that_comes_ends_the_display(bytes in proptest::collection::vec(any::<u8>(), 0..4000), text in any::<bool>()) {
        let mut all = if text { b"time_us,direction,message\n".to_vec() } else { Vec::new() };
        all.extend(&bytes);
        all.extend([0]);
        all.extend(on_the_line(&MESSAGES[..20]));
        let frames = shown(&all).view(|view| view.link.tally.frames);
        prop_assert!(text || frames >= 20);
    }

    /// Frames in any order, some of them never, some twice.
    #[test]
    fn the_tally_adds_up_in_any_order(order in proptest::collection::vec((0_usize..12, any::<bool>()), 30..120)) {
        let (mut state, mut reader) = (State::default(), Reader::new());
        for (index, (jitter, drop)) in order.iter().enumerate() {
            let message = &MESSAGES[150 + index + jitter];
            if *drop {
                continue;
            }
            if let Some(received) = reader.message(message) {
                state.take(&received);
            }
        }
        let tally = reader.tally();
        let came = order.iter().filter(|(_, drop)| !drop).count();
        prop_assert_eq!(tally.frames as usize, came);
        prop_assert_eq!(tally.restarts, 0);
        // First to last number: each came, or is lost.
        let span = order.len() + 12;
        let fresh = tally.frames - tally.repeated;
        prop_assert!((fresh + tally.lost) as usize <= span);
        for pair in state.points.windows(2) {
            prop_assert!(pair[0].time_s < pair[1].time_s, "time goes on");
        }
    }
}
