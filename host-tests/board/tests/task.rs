//! Does the board do what it is asked, and only that? The tick task over a flash and a link of the test's own.

use board_tests::board::{Board, PROVISIONING, answer, described, estimate, running, task};
use board_tests::described::measurements;
use board_tests::flash::Flash;
use board_tests::prelude::*;
use board_tests::said;
use rundown::estimator::config::SecurityConfig;
use rundown::model::effects::*;
use rundown::onboard::auth::{Provisioning, Signer};
use rundown::onboard::event::Event;
use rundown::onboard::uplink::{self, CurvePart, OPEN, Setting, Uplink};
use rundown::tick::regime::Regime;
use rundown_truth::sensors::SpeedReading;
use rundown_wire::{Body, Downlink, MAX_MESSAGE, Memory, Refusal};

fn board() -> Board {
    Board::start(Flash::erased(8))
}

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
    // One that follows displaces it.
    assert!(board.measure(&log[0]).is_empty());
    assert!(board.measure(&log[2]).is_empty());
    assert_eq!(answer(&board.measure(&log[0])).unwrap().result, Err(Refusal::TimeNotIncreasing));
    assert_eq!(estimate(&board.tick()).unwrap().time_s, log[2].time_s);
}

#[test]
fn what_changes_the_board_must_be_secured() {
    let (description, _) = described();
    let mut board = board();
    let requests = description.requests(PROVISIONING.train.0);
    for request in requests {
        let message = board.desk.open(request).unwrap();
        let refused = answer(&board.say(&message)).unwrap();
        assert_eq!(refused.result, Err(Refusal::NotSecured));
    }
    assert_eq!(board.status().train_id, None);
}

#[test]
fn open_measurements_are_refused_where_the_setting_asks_for_secured_ones() {
    let (description, log) = described();
    let security = SecurityConfig { secured_measurements: true };
    let config = Config { security, ..description.config };
    let (mut board, _, log) = running((Description { config, ..description }, log));
    let open = board.desk.open(Request::Measurement(log[0])).unwrap();
    assert_eq!(answer(&board.say(&open)).unwrap().result, Err(Refusal::NotSecured));
    assert_eq!(board.status().refusals[Refusal::NotSecured as usize], 1);
    let secured = board.desk.secured(Request::Measurement(log[0])).unwrap();
    assert_eq!(estimate(&board.say(&secured)).unwrap().time_s, log[0].time_s);
    // The desk knows what the board was described to ask for.
    let own = board.desk.measurement(&log[1]).unwrap();
    assert_eq!(estimate(&board.say(&own)).unwrap().time_s, log[1].time_s);
    // By default they are taken.
    let (mut board, _, log) = running(described());
    let open = board.desk.open(Request::Measurement(log[0])).unwrap();
    assert!(estimate(&board.say(&open)).is_some());
}

#[test]
fn a_wrong_key_changes_nothing() {
    let (mut board, ..) = running(described());
    let before = board.status();
    let other = Provisioning {
        key: rundown::onboard::auth::Key::new(*b"an attacker's key"[..16].first_chunk().unwrap()),
        ..PROVISIONING
    };
    assert!(Signer::new(&other, &before.announcement.unwrap()).is_err());
    // With every byte of a valid message changed once.
    let valid = board.desk.secured(Request::Command(Command::End)).unwrap();
    for at in 0..valid.len() {
        let mut forged = valid.clone();
        forged[at] ^= 0x20;
        let refused = answer(&board.say(&forged)).unwrap();
        assert!(refused.result.is_err(), "byte {at}");
    }
    let after = board.status();
    assert!(after.running);
    assert_eq!(after.setup, before.setup);
    let refused: u32 = after.refusals.iter().sum();
    assert_eq!(refused as usize, valid.len());
    // The valid one still is.
    assert_eq!(answer(&board.say(&valid)).unwrap().result, Ok(()));
    // And not a second time, whether it comes at once or later.
    assert!(board.say(&valid).is_empty());
    assert_eq!(board.status().duplicate, 1);
    assert_eq!(answer(&board.say(&valid)).unwrap().result, Err(Refusal::Stale));
}

#[test]
fn a_recorded_message_is_refused_after_a_restart() {
    let (description, _) = described();
    let mut board = board();
    board.status();
    let recorded = board.desk.prepare(&description, Direction::Up, Pace::Lockstep).unwrap();
    let mut board = board.restart();
    for message in recorded {
        assert_eq!(answer(&board.say(&message)).unwrap().result, Err(Refusal::Stale));
    }
    assert_eq!(board.status().train_id, None);
}

#[test]
fn a_board_without_a_key_refuses_and_says_so() {
    let task = task(Provisioning::from_bytes(&[0xFF; 64]), Flash::erased(8), false);
    let mut board = Board { task, ..board() };
    assert_eq!(board.status().announcement, None);
    let mut desk = Desk::new(PROVISIONING);
    assert!(desk.secured(Request::Command(Command::End)).is_err());
}

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
fn what_was_learned_survives_the_power() {
    let (mut board, description, log) = running(described());
    for measurement in &log {
        board.measure(measurement);
    }
    let learned = said!(board.end(), RunSummary).unwrap();
    assert_eq!(board.status().records, [1, 0]);

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
fn a_brown_out_in_the_middle_of_a_run_loses_nothing() {
    let (description, log) = described();
    let [mut whole, mut broken] = [(); 2].map(|()| Board::running(&description));
    for (tick, measurement) in log.iter().enumerate() {
        if tick == 60 {
            let snapshot = broken.snapshot();
            broken = broken.restart();
            broken.status();
            for request in description.requests(PROVISIONING.train.0) {
                broken.ask(request).unwrap();
            }
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
        apart.task.accept(&message, &mut apart.wire);
        let mut found: Vec<_> = apart.wire.messages.drain(..).collect();
        assert!(!found.is_empty() && apart.task.is_busy(), "parameters and effort come first");
        let pieces = pieces(&mut apart);
        most = most.max(pieces.len());
        found.extend(pieces.into_iter().flatten());
        assert_eq!(found, std::mem::take(&mut whole.wire.messages));
    }
    assert_eq!(most, 4, "frames, the end, record and summary, estimate");
}

#[test]
fn what_comes_between_two_pieces_waits_for_the_last_one() {
    let (mut board, _, log) = running(described());
    let message = |board: &mut Board, row: usize| board.desk.open(Request::Measurement(log[row])).unwrap();
    let (first, second) = (message(&mut board, 0), message(&mut board, 1));
    board.task.accept(&first, &mut board.wire);
    board.task.accept(&second, &mut board.wire);
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
        board.task.accept(&message, &mut board.wire);
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

#[test]
fn a_long_stop_ends_the_run_and_keeps_what_it_taught() {
    let (mut board, _, log) = running(described());
    for measurement in &log {
        board.measure(measurement);
    }
    let last = *log.last().unwrap();
    let mut ended = 0;
    for minute in 1..=480_u32 {
        let frames = board.measure(&Measurement {
            time_s: last.time_s + 60.0 * f64::from(minute),
            speed_mps: Some(0.0),
            ..last
        });
        ended += usize::from(said!(frames, RunSummary).is_some());
        assert_eq!(estimate(&frames).unwrap().regime, Regime::Standstill);
    }
    // Eight hours: one end, one record.
    assert_eq!((ended, board.status().records), (1, [1, 0]));
}

#[test]
fn a_reader_that_is_gone_does_not_stop_the_board() {
    let (mut board, description, log) = running(described());
    board.wire.room = Some(0);
    for measurement in log.iter().take(40) {
        assert!(board.measure(measurement).is_empty());
    }
    board.wire.room = None;
    let frames = board.measure(&log[40]);
    let estimator = description.estimator().unwrap();
    let mut run = estimator.begin_run(&estimator.new_vehicle(), Direction::Up);
    let expected = log[..=40].iter().map(|measurement| estimator.step(&mut run, measurement).unwrap()).last();
    assert_eq!(estimate(&frames).unwrap().digest, digest::of_estimate(&expected.unwrap()));
    assert!(board.status().not_sent > 80);
}

#[test]
fn a_crash_loop_leaves_a_heartbeat() {
    let (description, _) = described();
    let mut first = board();
    first.status();
    let task = task(Ok(PROVISIONING), Flash::erased(8), true);
    let mut board = Board { task, ..first };
    let frames = board.tick();
    assert!(matches!(frames[0].body, Body::Status(_)));
    for message in board.desk.prepare(&description, Direction::Up, Pace::Clock).unwrap() {
        assert!(answer(&board.say(&message)).unwrap().result.is_err());
    }
    assert!(!board.status().running);
}

fn effects() -> Effects {
    Effects::try_new([
        Effect::TunnelDrag(TunnelDrag { from_m: 8e3, to_m: 14e3, k: 1e-5 }),
        Effect::CurveResistance(CurveResistance { coefficient_roeckl: 1.0 }),
        Effect::Unknown(Unknown {
            coordinate: Coordinate::Temperature,
            table: [(-10.0, 4e-3), (20.0, 0.0)].into_iter().collect(),
        }),
    ])
    .unwrap()
}

fn with_effects() -> (Description, Vec<Measurement>) {
    let (description, log) = described();
    let curve = |from_m| Curve { from_m, to_m: from_m + 300.0, radius_m: 600.0 };
    let description = Description {
        curves: (0..20).map(|i| curve(1000.0 * f64::from(i))).collect(),
        effects: effects(),
        ..description
    };
    (description, log)
}

#[test]
fn effects_act_on_the_board_as_on_the_desk_and_survive_the_power() {
    let (description, log) = with_effects();
    let cold = Surroundings { temperature_c: Some(-4.0), day: None };
    let mut board = Board::running(&description);
    board.ask(Request::Surroundings(cold)).unwrap();
    let with = board.status().setup;
    let estimator = description.estimator().unwrap();
    let vehicle = estimator.new_vehicle();
    let bare = Description { effects: Effects::NONE, ..description.clone() };
    let bare_estimator = bare.estimator().unwrap();
    let (mut run, mut bare_run) =
        (estimator.begin_run(&vehicle, Direction::Up), bare_estimator.begin_run(&vehicle, Direction::Up));
    estimator.set_surroundings(&mut run, cold);
    let (mut same, mut seen) = (true, None);
    for measurement in &log {
        let frames = board.measure(measurement);
        let expected = estimator.step(&mut run, measurement).unwrap();
        assert_eq!(estimate(&frames).unwrap().digest, digest::of_estimate(&expected));
        let without = bare_estimator.step(&mut bare_run, measurement).unwrap();
        same &= digest::of_estimate(&without) == digest::of_estimate(&expected);
        seen = seen.or(said!(frames, Effects));
    }
    assert!(!same, "the effects do something in this run");
    assert_eq!(seen, Some(effects().to_frame()));

    // The power goes in the middle of the next run. Nobody tells the effects again.
    let mut board = board.restart();
    board.prepare(&bare, Direction::Up);
    assert_eq!(board.status().setup, with);
    board.ask(Request::Command(Command::End)).unwrap();
    // Taken out, they stay out.
    let clear = board.desk.secured(Request::Command(Command::ClearEffects)).unwrap();
    assert_eq!(said!(board.say(&clear), Effects), Some(rundown_wire::Effects::default()));
    assert_ne!(board.status().setup, with);
    let begin = Command::Begin { direction: Direction::Up, track_id: bare.track_id() };
    board.ask(Request::Command(begin)).unwrap();
    let mut board = board.restart();
    board.prepare(&bare, Direction::Up);
    assert_ne!(board.status().setup, with);
}

#[test]
fn wrong_effects_change_nothing() {
    let (mut board, description, log) = running(with_effects());
    let setup = board.status().setup;
    let good = Effect::WarmUp(WarmUp { amplitude: 3e-3, tau_s: 300.0 }).to_frame();
    let under_way = [Request::Effect(good.clone()), Request::Command(Command::ClearEffects)];
    for request in under_way {
        assert_eq!(board.ask(request), Err(Refusal::Running));
    }
    board.measure(&log[0]);
    board.ask(Request::Command(Command::End)).unwrap();
    let change = |change: fn(&mut rundown_wire::Effect)| {
        let mut wrong = good.clone();
        change(&mut wrong);
        wrong
    };
    let point =
        |values: [f64; 4]| rundown_wire::Effect { kind: 19, section_m: None, values: values.into_iter().collect() };
    for (wrong, refusal) in [
        (change(|e| e.kind = 0), Refusal::UnknownEffect),
        (change(|e| e.kind = u8::MAX), Refusal::UnknownEffect),
        (change(|e| e.values[0] = f64::NAN), Refusal::OutOfRange),
        (change(|e| e.values[1] = 0.0), Refusal::OutOfRange),
        (
            change(|e| {
                e.values.pop();
            }),
            Refusal::OutOfRange,
        ),
        (change(|e| e.section_m = Some([0.0, 1.0])), Refusal::OutOfRange),
        (point([3.0, 3.0, 30.0, 0.0]), Refusal::OutOfOrder),
        (point([1.0, 2.0, 30.0, 0.0]), Refusal::OutOfOrder),
        (point([3.0, 2.0, 20.0, 0.0]), Refusal::OutOfRange),
        (point([5.0, 2.0, 30.0, 0.0]), Refusal::OutOfRange),
        (point([3.0, 0.5, 30.0, 0.0]), Refusal::OutOfRange),
    ] {
        assert_eq!(board.ask(Request::Effect(wrong.clone())), Err(refusal), "{wrong:?}");
    }
    assert_eq!(board.status().setup, setup);
    for _ in 0..5 {
        board.ask(Request::Effect(good.clone())).unwrap();
    }
    assert_eq!(board.ask(Request::Effect(good)), Err(Refusal::OutOfRange), "a ninth one");

    let part = |track_id, first, radius_m| {
        Request::Curves(CurvePart {
            track_id,
            first,
            curves: [Curve { from_m: 25e3, to_m: 26e3, radius_m }].into_iter().collect(),
        })
    };
    let id = description.track_id();
    assert_eq!(board.ask(part(id + 1, 20, 500.0)), Err(Refusal::OtherTrack));
    assert_eq!(board.ask(part(id, 19, 500.0)), Err(Refusal::OutOfOrder));
    assert_eq!(board.ask(part(id, 20, 500.0)), Ok(()));
    assert_eq!(board.ask(part(id, 21, 0.0)), Err(Refusal::OutOfRange));
    assert_eq!(board.ask(part(id, 0, 500.0)), Ok(()));
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
fn by_the_clock_a_far_time_gives_way_to_one_that_follows() {
    let (mut board, _, log) = running(described());
    board.ask(Request::Command(Command::Pace(Pace::Clock))).unwrap();
    board.measure(&log[0]);
    board.tick();
    let far = Measurement { time_s: log[1].time_s + 1e6, ..log[1] };
    assert!(board.measure(&far).is_empty(), "it waits where no other does");
    assert!(board.measure(&log[1]).is_empty());
    assert_eq!(answer(&board.measure(&far)).unwrap().result, Err(Refusal::TimeNotIncreasing));
    assert_eq!(estimate(&board.tick()).unwrap().time_s, log[1].time_s);
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
fn effects_are_kept_once_and_not_at_the_begin_of_each_run() {
    let (mut board, mut description, _) = running(described());
    board.end();
    let tunnel = Effect::TunnelDrag(TunnelDrag { from_m: 8e3, to_m: 14e3, k: 1e-5 });
    description.effects = Effects::try_new([tunnel]).unwrap();
    let [before, _] = board.status().records;
    board.prepare(&description, Direction::Up);
    assert_eq!(board.status().records[0], before + 1, "at the begin of the run");
    board.end();
    let [before, _] = board.status().records;
    let track_id = description.track_id();
    board.ask(Request::Command(Command::Begin { direction: Direction::Up, track_id })).unwrap();
    assert_eq!(board.status().records[0], before, "the same effects");
}

/// A board without a clock.
#[derive(Default)]
struct Clockless(Vec<Vec<u8>>);

impl rundown::onboard::task::Port for Clockless {
    fn send(&mut self, message: &[u8]) -> bool {
        self.0.push(message.to_vec());
        true
    }

    fn health(&self) -> rundown_wire::Health {
        rundown_wire::Health::default()
    }
}

#[test]
fn without_a_clock_every_refusal_is_answered() {
    let mut task = task(Ok(PROVISIONING), Flash::erased(8), false);
    let mut port = Clockless::default();
    let mut desk = Desk::new(PROVISIONING);
    for _ in 0..100 {
        let end = desk.open(Request::Command(Command::End)).unwrap();
        task.receive(&end, &mut port);
    }
    assert_eq!(port.0.len(), 100);
}

#[test]
fn parts_of_a_snapshot_come_in_order_and_belong_together() {
    let (mut board, _, log) = running(described());
    board.measure(&log[0]);
    let parts = board.snapshot();
    board.end();
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
fn the_papers_vehicle_begins_with_deviations_of_its_own() {
    let (description, log) = described();
    let mut board = board();
    board.status();
    for request in description.requests(PROVISIONING.train.0) {
        board.ask(request).unwrap();
    }
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
fn a_gap_of_a_thousand_messages_is_a_sender_that_restarts() {
    for (next, missed) in [(2, 0), (3, 1), (1001, 999), (1002, 0)] {
        let mut board = board();
        let mut asked = |sequence| {
            let status = Uplink { sequence, request: Request::Command(Command::Status) };
            let mut buffer = [0; MAX_MESSAGE];
            said!(board.say(uplink::encode(&status, OPEN, &mut buffer).unwrap()), Status).unwrap()
        };
        asked(1);
        assert_eq!(asked(next).missed, missed, "{next}");
    }
}

#[test]
fn in_lockstep_the_clock_says_nothing() {
    let (mut board, ..) = running(described());
    assert!(board.tick().is_empty());
}

#[test]
fn by_the_clock_the_first_of_two_with_the_same_time_waits() {
    let (mut board, _, log) = running(described());
    board.ask(Request::Command(Command::Pace(Pace::Clock))).unwrap();
    assert!(board.measure(&log[0]).is_empty());
    assert_eq!(answer(&board.measure(&log[0])).unwrap().result, Err(Refusal::TimeNotIncreasing));
}

#[test]
fn a_run_that_is_none_does_not_end() {
    let (mut board, ..) = running(described());
    board.end();
    assert_eq!(board.ask(Request::Command(Command::End)), Err(Refusal::NotRunning));
    assert_eq!(board.ask(Request::Command(Command::Snapshot)), Err(Refusal::NotRunning));
}

#[test]
fn a_train_that_is_described_once_more_is_not_looked_for_again() {
    let (mut board, description, _) = running(described());
    board.end();
    board.prepare(&description, Direction::Up);
    let looked = board.log.iter().filter(|event| matches!(event, Event::Vehicle { .. })).count();
    assert_eq!(looked, 1, "{:?}", board.log);
}
