//! Does the board survive what `docs/faults.md` lists? The rows that no other test holds, through the tick task and its
//! messages.

use board_tests::board::{Board, answer, case_study, estimate, running};
use board_tests::described::measurements;
use board_tests::described::with_targets;
use board_tests::flash::Flash;
use board_tests::prelude::*;
use board_tests::said;
use rundown::link::serial::{Decoder, encode};
use rundown::model::effects::*;
use rundown::uplink::{self, Setting, Uplink};
use rundown_wire::{Downlink, Refusal};

/// Digests of the estimates: equal digests, equal states.
fn digests(board: &mut Board, log: &[Measurement]) -> Vec<u32> {
    log.iter().filter_map(|measurement| Some(estimate(&board.measure(measurement))?.digest)).collect()
}

fn is_a_number(frame: &Downlink) -> bool {
    let text = format!("{:?}", frame.body);
    let mut words = text.split(|c: char| !c.is_alphanumeric() && c != '_');
    !words.any(|word| word == "NaN" || word == "inf")
}

/// Row 1, over the decoder and the task: what a flipped bit leaves of a message changes nothing, in the run nor in the
/// counters of what was asked.
#[test]
fn a_flipped_bit_on_the_line_leaves_the_state_as_it_was() {
    let (mut plain, _, log) = running(case_study());
    let (mut board, ..) = running(case_study());
    let (before, after) = log.split_at(60);
    assert_eq!(digests(&mut board, before), digests(&mut plain, before));
    let measurement = board.desk.open(Request::Measurement(after[0])).unwrap();
    let end = board.desk.secured(Request::Command(Command::End)).unwrap();
    let mut decoder: Decoder = Decoder::new();
    for message in [measurement, end] {
        let line = encode(&message).unwrap();
        for bit in 0..8 * line.len() {
            let mut damaged = line.to_vec();
            damaged[bit / 8] ^= 1 << (bit % 8);
            damaged.push(0);
            let mut dropped = 0;
            for byte in damaged {
                match decoder.push(byte) {
                    Ok(Some(read)) => panic!("bit {bit} of {message:02X?} gives {read:02X?}"),
                    Ok(None) => {}
                    Err(_) => dropped += 1,
                }
            }
            assert!(dropped > 0, "bit {bit} of {message:02X?} is not counted");
        }
    }
    assert_eq!(board.status().refusals, plain.status().refusals);
    let (found, expected) = (board.snapshot(), plain.snapshot());
    assert_eq!(found, expected);
    assert_eq!(digests(&mut board, after), digests(&mut plain, after));
}

/// Row 3.
#[test]
fn a_message_that_comes_twice_is_answered_once_and_changes_nothing() {
    let (mut plain, _, log) = running(case_study());
    let expected = digests(&mut plain, &log);
    let (mut board, ..) = running(case_study());
    let mut found = Vec::new();
    for measurement in &log {
        let message = board.desk.open(Request::Measurement(*measurement)).unwrap();
        found.extend(estimate(&board.say(&message)).map(|estimate| estimate.digest));
        assert!(board.say(&message).is_empty());
    }
    assert_eq!(found, expected);
    assert_eq!(board.status().duplicate as usize, log.len());
}

/// Row 4.
#[test]
fn a_log_out_of_order_gives_what_its_rising_part_gives() {
    let (_, _, mut log) = running(case_study());
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    for _ in 0..log.len() / 2 {
        let at = rng.random_range(1..log.len() - 1);
        log.swap(at, at + 1);
    }
    let mut rising: Vec<Measurement> = Vec::new();
    for measurement in &log {
        if rising.last().is_none_or(|last| measurement.time_s > last.time_s) {
            rising.push(*measurement);
        }
    }
    assert!(rising.len() + 10 < log.len());
    let expected = digests(&mut running(case_study()).0, &rising);
    let mut board = running(case_study()).0;
    assert_eq!(digests(&mut board, &log), expected);
    let refused = board.status().refusals[Refusal::TimeNotIncreasing as usize];
    assert_eq!(refused as usize, log.len() - rising.len());
}

/// Row 6.
#[test]
fn the_senders_counter_wraps_without_a_gap() {
    let (mut board, _, log) = running(case_study());
    let mut say = |sequence: u16, request: Request| {
        let mut buffer = [0; rundown_wire::MAX_MESSAGE];
        let uplink = Uplink { sequence, request };
        let message = uplink::encode(&uplink, uplink::OPEN, &mut buffer).unwrap();
        said!(board.say(message), Status).map(|status| status.missed)
    };
    let status = Request::Command(Command::Status);
    // Far from the counter before: taken for a sender that has restarted.
    for (sequence, measurement) in (u16::MAX - 3..=u16::MAX).chain(0..4).zip(&log) {
        say(sequence, Request::Measurement(*measurement));
    }
    assert_eq!(say(4, status.clone()), Some(0));
    // Two are lost over the wrap.
    say(u16::MAX - 1, Request::Measurement(log[8]));
    say(1, Request::Measurement(log[9]));
    assert_eq!(say(2, status), Some(2));
}

/// Row 6: the board's own counters. Of a train that waits for its departure, so that the run does not end.
#[test]
fn the_boards_counters_wrap_without_a_gap() {
    let (mut board, description, log) = running(case_study());
    let (mut plain, ..) = running(case_study());
    // The tick of a run that began four years ago. A snapshot says at which tick it was taken.
    board.measure(&log[0]);
    plain.measure(&log[0]);
    let mut parts = board.snapshot();
    let mut board = board.restart();
    board.describe(&description);
    board.ask(Request::Command(Command::Pace(Pace::Lockstep))).unwrap();
    for part in &mut parts {
        part.tick = u32::MAX - 3;
        board.ask(Request::Snapshot(part.clone())).unwrap();
    }
    let mut ticks = Vec::new();
    for measurement in &log[1..40] {
        let found = board.measure(measurement);
        ticks.extend(found.last().map(|frame| frame.tick));
        assert_eq!(estimate(&found), estimate(&plain.measure(measurement)));
    }
    let expected = (1..40).map(|tick| (u32::MAX - 3_u32).wrapping_add(tick));
    assert_eq!(ticks, expected.collect::<Vec<_>>());

    // The sequence numbers of its frames.
    let (mut board, ..) = running(case_study());
    let (mut frames, mut last) = (0_u32, None);
    let mut measurement = Measurement { speed_mps: Some(0.0), ..log[0] };
    while frames < 66_000 {
        for frame in board.measure(&measurement) {
            assert!(
                last.is_none_or(|last: u16| frame.sequence == last.wrapping_add(1)),
                "{last:?}, then {}",
                frame.sequence
            );
            last = Some(frame.sequence);
            frames += 1;
        }
        measurement.time_s += 10.0;
    }
    assert_eq!(board.status().not_sent, 0);
}

/// Row 7.
#[test]
fn unknown_versions_kinds_and_lengths_are_refused_by_cause() {
    let (mut board, ..) = running(case_study());
    let setup = board.status().setup;
    let mut valid = board.desk.open(Request::Command(Command::Status)).unwrap();
    let long = [&valid[..], &[0; 600]].concat();
    let over_long_varint = [&[uplink::VERSION, uplink::OPEN][..], &[0xFF; 12]].concat();
    let unknown = [uplink::VERSION, uplink::OPEN, 1, 0x63];
    for message in [&[][..], &[1], &long, &over_long_varint, &unknown, &[1, 9, 0, 0]] {
        let refused = answer(&board.say(message)).unwrap();
        assert_eq!(refused.result, Err(Refusal::Malformed), "{message:?}");
    }
    valid[0] = uplink::VERSION + 1;
    let refused = answer(&board.say(&valid)).unwrap();
    assert_eq!(refused.result, Err(Refusal::Version));
    let status = board.status();
    assert_eq!((status.setup, status.running), (setup, true));
    assert_eq!(status.refusals[Refusal::Malformed as usize], 6);
}

/// Row 10.
#[test]
fn a_run_on_another_track_is_refused_and_the_one_under_way_goes_on() {
    let (mut board, description, log) = running(case_study());
    let (mut plain, ..) = running(case_study());
    let other = Command::Begin { direction: Direction::Down, track_id: description.track_id() ^ 1 };
    let (before, after) = log.split_at(30);
    assert_eq!(digests(&mut board, before), digests(&mut plain, before));
    let refused = board.ask(Request::Command(other));
    assert_eq!(refused, Err(Refusal::OtherTrack));
    assert_eq!(digests(&mut board, after), digests(&mut plain, after));
    assert_eq!(board.status().refusals[Refusal::OtherTrack as usize], 1);

    board.ask(Request::Command(Command::End)).unwrap();
    let refused = board.ask(Request::Command(other));
    assert_eq!(refused, Err(Refusal::OtherTrack));
    assert!(!board.status().running);
}

/// Row 14.
#[test]
fn odd_floats_in_every_field_never_reach_a_frame_and_leave_the_run_usable() {
    let odd = [
        f64::NAN,
        -f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        -0.0,
        f64::MIN_POSITIVE / 2.0,
        1e300,
        -1e300,
        f64::MAX,
        401.0 / 3.6,
    ];
    for mode in [Mode::Gated, Mode::Measured, Mode::Paper] {
        let (mut board, _, log) = running(case_study());
        board.ask(Request::Command(Command::End)).unwrap();
        board.ask(Request::Setting(Setting::Mode(mode))).unwrap();
        let track_id = board.status().track_id.unwrap();
        let direction = Direction::Up;
        let begin = Command::Begin { direction, track_id };
        board.ask(Request::Command(begin)).unwrap();
        for (k, sample) in log.iter().enumerate() {
            let mut spoilt = *sample;
            let value = odd[(k / 6) % odd.len()];
            match k % 6 {
                1 => spoilt.location_m = Some(value),
                3 => spoilt.speed_mps = Some(value),
                5 => spoilt.effort_n_per_kg = Some(value),
                _ => {}
            }
            let frames = board.measure(&spoilt);
            assert!(frames.iter().all(is_a_number), "{mode:?} {spoilt:?}");
            let said = estimate(&frames).expect("an estimate for each measurement");
            // A reading that is not believed leaves the other one in use.
            let off_m = sample.location_m.unwrap() - f64::from(said.location_m.value);
            assert!(off_m.abs() < 200.0, "{mode:?} {spoilt:?}: {off_m} m");
        }
        for wild in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1e300] {
            let time_s = wild;
            let refused = board.measure(&Measurement { time_s, ..log[0] });
            let refused = answer(&refused).unwrap().result;
            assert_eq!(refused, Err(Refusal::OutOfRange), "{time_s}");
        }
    }
}

/// Row 14, of what the effects depend on.
#[test]
fn odd_temperatures_and_dates_are_refused_and_the_old_ones_stay() {
    let (mut board, description, log) = running(case_study());
    board.ask(Request::Command(Command::End)).unwrap();
    let with_effects = Description {
        effects: Effects::try_new([
            Effect::TemperatureResistance(TemperatureResistance { dr0_per_deg_c: -1e-4, ref_c: 15.0 }),
            Effect::SeasonalDrift(SeasonalDrift { dr0_over_period: 1e-3, period_days: 365.0, reference_day: 20_000.0 }),
        ])
        .unwrap(),
        ..description
    };
    let winter = Surroundings { temperature_c: Some(-5.0), day: Some(20_100.0) };
    let start = || {
        let mut board = Board::running(&with_effects);
        board.ask(Request::Surroundings(winter)).unwrap();
        board
    };
    let (mut plain, mut board) = (start(), start());
    for (tick, measurement) in log.iter().enumerate() {
        let odd = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300, 1e9][tick % 6];
        for wrong in [Surroundings { temperature_c: Some(odd), ..winter }, Surroundings { day: Some(odd), ..winter }] {
            let refused = board.ask(Request::Surroundings(wrong));
            assert_eq!(refused, Err(Refusal::OutOfRange), "{wrong:?}");
        }
        let frames = board.measure(measurement);
        assert!(frames.iter().all(is_a_number), "tick {tick}");
        assert_eq!(estimate(&frames), estimate(&plain.measure(measurement)));
    }
}

/// Row 28.
#[test]
fn a_hostile_train_or_track_leaves_the_old_one_in_force() {
    let (mut board, description, log) = running(case_study());
    board.ask(Request::Command(Command::End)).unwrap();
    let setup = board.status().setup;
    let mut hostile = Vec::new();
    for mass_kg in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let mut wrong = description.clone();
        wrong.train.mass_kg = mass_kg;
        hostile.push(wrong);
    }
    for gradients in [[100.0, 50.0], [f64::NAN, 10.0], [0.0, f64::INFINITY]] {
        let gradients = gradients.map(|from_m| Gradient { from_m, permille: 1.0 });
        hostile.push(Description {
            gradients: gradients.to_vec(),
            // Of a track that is not in force they would be refused, too.
            targets: Vec::new(),
            ..description.clone()
        });
    }
    for permille in [f64::NAN, f64::INFINITY, 1e9] {
        let gradients = vec![Gradient { from_m: 0.0, permille }];
        hostile.push(Description { gradients, targets: Vec::new(), ..description.clone() });
    }
    for wrong in hostile {
        let mut refusals = Vec::new();
        for request in wrong.requests(board_tests::board::PROVISIONING.train.0) {
            refusals.extend(board.ask(request).err());
        }
        assert_eq!(refusals, [Refusal::OutOfRange], "{wrong:?}");
        assert_eq!(board.status().setup, setup);
    }
    // And the board still runs with the old one.
    let direction = Direction::Up;
    let track_id = description.track_id();
    let begin = Command::Begin { direction, track_id };
    board.ask(Request::Command(begin)).unwrap();
    assert!(estimate(&board.measure(&log[0])).is_some());
}

/// Row 26.
#[test]
fn a_train_described_with_too_little_resistance_is_published_within_bounds() {
    let scenario = Scenario::default();
    let mut wrong = with_targets(Config::default(), &scenario);
    let davis = &mut wrong.train.davis;
    (davis.r0, davis.r1, davis.r2) = (davis.r0 / 2.4, davis.r1 / 2.4, davis.r2 / 2.4);
    let davis = *davis;
    let mut board = Board::start(Flash::erased(8));
    let mut out_of_bounds = 0;
    for seed in 0..3 {
        board.prepare(&wrong, Direction::Up);
        for measurement in measurements(&simulate(&scenario, seed)) {
            let said = said!(board.measure(&measurement), Parameters);
            if let Some(said) = said.filter(|said| said.learned == rundown_wire::Learned::OutOfBounds) {
                out_of_bounds += 1;
                for (said, nominal) in [(said.r0, davis.r0), (said.r1, davis.r1), (said.r2, davis.r2)] {
                    let share = f64::from(said.value) / nominal;
                    assert!((0.4999..=2.0001).contains(&share), "{share}");
                }
            }
        }
        board.ask(Request::Command(Command::End)).unwrap();
    }
    assert!(out_of_bounds > 0, "2.4 times the described resistance was never seen");
}
