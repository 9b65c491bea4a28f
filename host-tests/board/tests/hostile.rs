//! What do a wrong clock and a flood of messages that nobody vouches for cost? A few ticks, and no estimate.

use board_tests::board::{Board, answer, described, estimate, running};
use board_tests::prelude::*;
use board_tests::said;
use board_tests::serial_board::{LINE_BYTES_PER_S, SerialBoard};
use rundown::tick::estimate::Cause;
use rundown::uplink::{self, OPEN, SECURED, Uplink};
use rundown_wire::{Answer, Body, Estimate as Estimated, Refusal};

/// What a clock does to the times of a run: number since it went wrong, and true time, to its time. With it why such a
/// time is refused.
type Clock = fn(usize, f64) -> f64;
const CLOCKS: [(&str, Refusal, Clock); 7] = [
    ("one far time", Refusal::OutOfRange, |k, time_s| if k == 0 { 1e300 } else { time_s }),
    ("an hour back", Refusal::TimeNotIncreasing, |_, time_s| time_s - 3600.0),
    ("ten seconds back", Refusal::TimeNotIncreasing, |_, time_s| time_s - 10.0),
    ("a GPS week ahead", Refusal::OutOfRange, |_, time_s| time_s + 604_800.0),
    ("an epoch back", Refusal::TimeNotIncreasing, |_, time_s| time_s - 619_315_200.0),
    ("repeated once", Refusal::TimeNotIncreasing, |k, time_s| if k == 0 { time_s - 10.0 } else { time_s }),
    // No acceleration comes out of a change of speed in no time.
    (
        "repeated but for a rounding",
        Refusal::TimeNotIncreasing,
        |k, time_s| if k == 0 { time_s - 10.0 + 1e-9 } else { time_s },
    ),
];

/// The log, with this clock from its middle on.
fn spoilt(log: &[Measurement], clock: Clock) -> Vec<Measurement> {
    let half = log.len() / 2;
    let spoil = |(k, measurement): (usize, &Measurement)| Measurement {
        time_s: if k < half { measurement.time_s } else { clock(k - half, measurement.time_s) },
        ..*measurement
    };
    log.iter().enumerate().map(spoil).collect()
}

#[test]
fn a_wrong_clock_costs_a_few_ticks_in_lockstep() {
    let (mut right, _, log) = running(described());
    let expected: Vec<f32> =
        log.iter().filter_map(|one| estimate(&right.measure(one))).map(|said| said.speed_mps.value).collect();
    for (name, refusal, clock) in CLOCKS {
        let (mut board, ..) = running(described());
        let mut heard = Vec::new();
        for (k, measurement) in spoilt(&log, clock).iter().enumerate() {
            let frames = board.measure(measurement);
            match estimate(&frames) {
                Some(said) => {
                    assert_eq!(said.time_s, measurement.time_s, "{name}");
                    heard.push((k, said.speed_mps.value));
                }
                None => assert_eq!(answer(&frames).unwrap().result, Err(refusal), "{name}"),
            }
        }
        let lost = log.len() - heard.len();
        assert!((1..=2).contains(&lost), "{name}: {lost}");
        let status = board.status();
        assert_eq!(status.refusals[refusal as usize] as usize, lost, "{name}");
        // From a few ticks later on the speed is what it would have been.
        for (k, speed_mps) in heard.into_iter().filter(|(k, _)| *k > log.len() / 2 + 8) {
            assert!((speed_mps - expected[k]).abs() < 1.0, "{name} at {k}: {speed_mps} for {}", expected[k]);
        }
        assert!(said!(board.end(), RunSummary).is_some());
    }
}

#[test]
fn a_wrong_clock_costs_a_few_ticks_by_the_clock() {
    for (name, _, clock) in CLOCKS {
        let (mut board, _, log) = running(described());
        board.ask(Request::Command(Command::Pace(Pace::Clock))).unwrap();
        let mut estimates = 0;
        for measurement in spoilt(&log, clock) {
            board.measure(&measurement);
            estimates += usize::from(estimate(&board.tick()).is_some());
        }
        assert!(log.len() - estimates <= 2, "{name}: {estimates} of {}", log.len());
    }
}

/// What comes beside each row once its clock has been set: how far, and times by that of the row.
type Beside = (&'static str, f64, fn(f64) -> Vec<f64>);
const BESIDE: [Beside; 10] = [
    ("twice", -3600.0, |time_s| vec![time_s; 2]),
    ("three times", -3600.0, |time_s| vec![time_s; 3]),
    ("twice, a week ahead", 604_800.0, |time_s| vec![time_s; 2]),
    ("a second source that is late", -3600.0, |time_s| vec![time_s, time_s - 3.0]),
    ("a second source that is late, a week ahead", 604_800.0, |time_s| vec![time_s, time_s - 3.0]),
    ("one far back", -3600.0, |time_s| vec![time_s, -1e6]),
    ("one far ahead", -3600.0, |time_s| vec![time_s, 1e9]),
    ("one that is another each time", -3600.0, |time_s| vec![time_s, 1e3 * time_s]),
    ("one that is another each time, before it", -3600.0, |time_s| vec![-1e4 * time_s, time_s]),
    ("the same one within the next day, by the right clock", 0.0, |time_s| vec![time_s, 50_000.0]),
];

#[test]
fn rows_that_come_twice_late_or_wrong_keep_no_clock_from_being_believed() {
    for pace in [Pace::Lockstep, Pace::Clock] {
        for (name, set_s, beside) in BESIDE {
            let (mut board, _, log) = running(described());
            board.ask(Request::Command(Command::Pace(pace))).unwrap();
            let (mut lost, mut last) = (0, 0);
            for (k, measurement) in log.iter().enumerate() {
                let time_s = measurement.time_s + if k < log.len() / 2 { 0.0 } else { set_s };
                let times = if k < log.len() / 2 { vec![time_s] } else { beside(time_s) };
                let mut frames: Vec<_> =
                    times.iter().flat_map(|&time_s| board.measure(&Measurement { time_s, ..*measurement })).collect();
                if pace == Pace::Clock {
                    frames.extend(board.tick());
                }
                let is_right = estimate(&frames).is_some_and(|said| said.time_s == time_s);
                lost += usize::from(!is_right);
                last = if is_right { last } else { k };
            }
            assert!(lost <= 4 && last < log.len() / 2 + 8, "{name}, {pace:?}: {lost}, the last at {last}");
        }
    }
}

#[test]
fn a_first_time_that_is_wrong_each_time_costs_the_first_ticks() {
    for first in [true, false] {
        let (mut board, _, log) = running(described());
        board.ask(Request::Command(Command::Pace(Pace::Clock))).unwrap();
        let mut right = 0;
        for measurement in &log {
            let wrong = Measurement { time_s: 4e12, ..*measurement };
            let rows = if first { [wrong, *measurement] } else { [*measurement, wrong] };
            rows.iter().for_each(|row| drop(board.measure(row)));
            right += usize::from(estimate(&board.tick()).is_some_and(|said| said.time_s == measurement.time_s));
        }
        assert!(log.len() - right <= 3, "{first}: {right} of {}", log.len());
    }
}

/// A run by another clock from its beginning: its estimates, and the reasons of what was refused.
fn by_clock(clock: fn(f64) -> f64) -> (Vec<Estimated>, Vec<Refusal>, Board) {
    let (mut board, _, log) = running(described());
    let (mut estimates, mut refused) = (Vec::new(), Vec::new());
    for measurement in &log {
        let frames = board.measure(&Measurement { time_s: clock(measurement.time_s), ..*measurement });
        match estimate(&frames) {
            Some(said) => estimates.push(said),
            None => refused.extend(answer(&frames).unwrap().result.err()),
        }
    }
    (estimates, refused, board)
}

#[test]
fn a_clock_of_seconds_may_begin_far_from_zero() {
    let (right, ..) = by_clock(|time_s| time_s);
    for clock in [|time_s| 1.7e12 + time_s, |time_s| time_s - 3e12] {
        let (found, refused, _) = by_clock(clock);
        assert_eq!(refused, []);
        for (found, right) in found.iter().zip(&right) {
            assert!((found.dt_s - right.dt_s).abs() < 1e-3);
            assert!((found.speed_mps.value - right.speed_mps.value).abs() < 0.01, "{found:?} for {right:?}");
        }
    }
}

#[test]
fn a_clock_of_another_unit_is_seen_as_such() {
    // Rows every 10 s. In ms, from zero or from 1970, each is a long gap.
    for clock in [|time_s| 1e3 * time_s, |time_s| 1.7e12 + 1e3 * time_s] {
        let (found, refused, mut board) = by_clock(clock);
        assert_eq!(refused, []);
        assert!(found.iter().all(|found| found.dt_s == 0.0));
        assert_eq!(board.status().causes[Cause::LongGap as usize] as usize, found.len() - 1);
    }
    // In µs each is days ahead; FILETIME, 100 ns since 1601, shows no time at all.
    for (clock, taken) in
        [((|time_s| 1.08e10 + 1e6 * time_s) as fn(f64) -> f64, 1), (|time_s| 1.33e17 + 1e7 * time_s, 0)]
    {
        let (found, refused, mut board) = by_clock(clock);
        assert_eq!(found.len(), taken);
        assert!(refused.iter().all(|refused| *refused == Refusal::OutOfRange), "{refused:?}");
        assert_eq!(board.status().refusals[Refusal::OutOfRange as usize] as usize, refused.len());
    }
}

#[test]
fn a_first_time_that_no_clock_shows_is_refused_and_the_run_begins_with_the_next() {
    let (mut board, _, log) = running(described());
    for time_s in [-2.6e156, 1e300, f64::NAN] {
        let frames = board.measure(&Measurement { time_s, ..log[0] });
        assert_eq!(answer(&frames).unwrap().result, Err(Refusal::OutOfRange), "{time_s}");
    }
    let heard = log.iter().filter(|measurement| estimate(&board.measure(measurement)).is_some()).count();
    assert_eq!(heard, log.len());
}

#[test]
fn a_source_that_begins_again_at_zero_and_elsewhere_is_believed_in_the_end() {
    let (estimator, mut run, log) = {
        let (description, log) = described();
        let estimator = description.estimator().unwrap();
        let run = estimator.begin_run(&estimator.new_vehicle(), Direction::Up);
        (estimator, run, log)
    };
    for measurement in &log {
        estimator.step(&mut run, measurement).unwrap();
    }
    // The same rows again: they lie behind, as rows that come late do.
    let refused = log.iter().take_while(|measurement| estimator.step(&mut run, measurement).is_err()).count();
    assert_eq!(refused, 11);
    assert!(run.counters().of(Cause::LongGap) > 0);
}

#[test]
fn one_open_measurement_within_the_next_day_costs_two_ticks() {
    let (mut board, _, log) = running(described());
    let half = log.len() / 2;
    for measurement in &log[..half] {
        assert!(estimate(&board.measure(measurement)).is_some());
    }
    // So that the true rows lie behind the train.
    let far =
        Measurement { time_s: log[half].time_s + 80_000.0, location_m: log.last().unwrap().location_m, ..log[half] };
    assert!(estimate(&board.measure(&far)).is_some(), "believed, as after a pause");
    let lost = log[half..].iter().filter(|measurement| estimate(&board.measure(measurement)).is_none()).count();
    assert_eq!(lost, 2);
    assert_eq!(board.status().refusals[Refusal::TimeNotIncreasing as usize], 2);
}

/// A board whose clock stands in one second, a run under way by the clock.
fn in_one_second() -> (Board, Vec<Measurement>) {
    let (mut board, _, log) = running(described());
    board.ask(Request::Command(Command::Pace(Pace::Clock))).unwrap();
    board.wire.health.uptime_s = 77;
    (board, log)
}

#[test]
fn a_flood_of_open_messages_gets_one_status_and_a_few_answers_a_second_and_costs_no_estimate() {
    let (mut board, log) = in_one_second();
    let begin = Command::Begin { direction: Direction::Up, track_id: 0 };
    for (second, measurement) in log.iter().take(20).enumerate() {
        board.wire.health.uptime_s = 77 + second as u32;
        let (mut statuses, mut answers) = (0, 0);
        for k in 0..900 {
            let message = match k % 3 {
                0 => board.desk.open(Request::Command(Command::Status)).unwrap(),
                1 => board.desk.open(Request::Command(begin)).unwrap(),
                _ => vec![1, 0, k as u8, (k / 256) as u8, 255, 255],
            };
            let frames = board.say(&message);
            statuses += frames.iter().filter(|frame| matches!(frame.body, Body::Status(_))).count();
            answers += frames.iter().filter(|frame| matches!(frame.body, Body::Answer(_))).count();
        }
        assert_eq!((statuses, answers), (1, 9), "second {second}");
        board.measure(measurement);
        assert!(estimate(&board.tick()).is_some());
    }
    board.wire.health.uptime_s = 0;
    let status = board.status();
    assert!(status.refusals[Refusal::NotSecured as usize] >= 20 * 300, "{status:?}");
}

#[test]
fn the_status_of_a_second_is_used_up_by_an_open_status_alone() {
    let (mut board, log) = in_one_second();
    board.measure(&log[0]);
    let status = Request::Command(Command::Status);
    let secured = board.desk.secured(status.clone()).unwrap();
    assert!(said!(board.say(&secured), Status).is_some());
    board.status();
    let open = board.desk.open(status).unwrap();
    assert!(board.say(&open).is_empty());
}

/// A message that anybody can send, by its number: no two in a row are the same.
type Flood = fn(u16) -> Vec<u8>;

fn open(sequence: u16, request: Request) -> Vec<u8> {
    let uplink = Uplink { sequence, request };
    uplink::encode(&uplink, OPEN, &mut [0; 64]).unwrap().to_vec()
}

fn open_measurement(number: u16, time_s: f64) -> Vec<u8> {
    let measurement = Measurement { time_s, ..Measurement::default() };
    open(number, Request::Measurement(measurement))
}

/// With a trailer of zeros.
fn forged(number: u16) -> Vec<u8> {
    let uplink = Uplink { sequence: number, request: Request::Command(Command::End) };
    [uplink::encode(&uplink, SECURED, &mut [0; 64]).unwrap(), &[0; 16]].concat()
}

const FLOODS: [(&str, Flood); 9] = [
    ("secured, too short", |number| [&[1, 1], &number.to_le_bytes()[..]].concat()),
    ("secured, shorter and shorter", |number| vec![1, 1, 2][..2 + usize::from(number % 2)].to_vec()),
    ("secured, wrong MAC", forged),
    ("open status", |number| open(number, Request::Command(Command::Status))),
    ("open end", |number| open(number, Request::Command(Command::End))),
    ("another version", |number| [&[2, 0], &number.to_le_bytes()[..]].concat()),
    ("a measurement of old", |number| open_measurement(number, -1.0)),
    ("a measurement at no time", |number| open_measurement(number, f64::NAN)),
    ("a measurement far ahead", |number| open_measurement(number, 1e300)),
];

#[test]
fn a_flood_at_line_rate_loses_no_estimate_delays_none_and_who_has_the_key_is_answered() {
    const PERIOD: u64 = 10 * LINE_BYTES_PER_S;
    let (description, log) = described();
    for (name, flood) in FLOODS {
        let mut board = SerialBoard::start();
        board.prepare(&description);
        // Far from the desk's own numbers.
        let mut number = 20_000;
        let mut flood_until = |board: &mut SerialBoard, end: u64| {
            while board.passed() < end {
                number += 1;
                board.say(&flood(number));
            }
        };
        let first_tick = board.passed().next_multiple_of(PERIOD);
        let (mut asked, mut tick) = (Vec::new(), first_tick);
        board.heard.clear();
        for measurement in &log[..3] {
            let message = board.desk.open(Request::Measurement(*measurement)).unwrap();
            board.say(&message);
            flood_until(&mut board, tick - PERIOD / 20);
            let message = board.desk.secured(Request::Command(Command::Forget)).unwrap();
            asked.push(board.desk.sequence());
            board.say(&message);
            flood_until(&mut board, tick + 1);
            tick += PERIOD;
        }
        flood_until(&mut board, tick - PERIOD / 2);

        let seconds = (board.passed() - first_tick) / LINE_BYTES_PER_S + 11;
        let heard = |is: &dyn Fn(&Body) -> bool| -> Vec<u64> {
            board.heard.iter().filter(|(_, frame)| is(&frame.body)).map(|(at, _)| *at).collect()
        };
        let estimates = heard(&|body| matches!(body, Body::Estimate(_)));
        assert_eq!(estimates.len(), 3, "{name}");
        assert!(estimates.iter().all(|at| at % PERIOD < LINE_BYTES_PER_S / 4), "{name}: {estimates:?}");
        for asked in asked {
            let answers = heard(&|body| matches!(body, Body::Answer(answer) if answer.to == asked));
            assert_eq!(answers.len(), 1, "{name}");
        }
        let refusals = heard(
            &|body| matches!(body, Body::Answer(Answer { result: Err(refused), .. }) if *refused != Refusal::Running),
        );
        assert!(refusals.len() as u64 <= 8 * (seconds + 1), "{name}: {} in {seconds} s", refusals.len());
    }
}

#[test]
fn the_first_second_after_a_start_is_limited_as_any_other() {
    let mut board = SerialBoard::start();
    for number in 0..400 {
        board.say(&open(number, Request::Command(Command::Status)));
        board.say(&open_measurement(number, 1e300));
    }
    let of = |is: fn(&Body) -> bool| board.heard.iter().filter(|(_, frame)| is(&frame.body)).count();
    assert!(board.passed() > LINE_BYTES_PER_S && board.passed() < 2 * LINE_BYTES_PER_S);
    // One of the first tick, which has no measurement, and one in each second.
    assert_eq!(of(|body| matches!(body, Body::Status(_))), 3);
    assert_eq!(of(|body| matches!(body, Body::Answer(Answer { result: Err(_), .. }))), 16);
}
