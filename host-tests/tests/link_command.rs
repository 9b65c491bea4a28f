//! Does `rundown link` tell a board what a replay knows? A board on the host behind a TCP port, and the same log through `replay`.

use host_tests::board::{PROVISIONING, Wire, task};
use host_tests::flash::Flash;
use host_tests::prelude::*;
use host_tests::reference::recording;
use rundown::link::Link;
use rundown::link::serial::SerialLink;
use rundown::model::effects::{Effect, Effects, TemperatureResistance};
use rundown_files::replay::{Tick, replay};
use rundown_wire::{Body, Downlink};
use sim_harness::commands;
use sim_harness::link::port::HostPort;
use sim_harness::link::record::{Way, read};
use std::ffi::OsString;
use std::fmt::Write;
use std::net::TcpListener;
use std::process::ExitCode;
use std::thread;
use std::time::Duration;

/// What the line does to the frames of a board.
#[derive(Clone, Copy)]
enum Line {
    Good,
    /// Each frame comes late.
    Late(Duration),
    /// Every so manieth frame is lost.
    Loses(usize),
    /// Each frame comes twice.
    Doubles,
    /// Summaries never come.
    WithoutSummaries,
}

/// A board that is there until the other side goes; its address.
fn board(line: Line) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("tcp:{}", listener.local_addr().unwrap());
    thread::spawn(move || {
        let port = HostPort::tcp(listener.accept().unwrap().0).unwrap();
        let mut link = SerialLink::new(port);
        let mut task = task(Ok(PROVISIONING), Flash::erased(8), false);
        let mut wire = Wire::default();
        let mut sent = 0;
        while let Ok(message) = link.receive(0) {
            match message {
                Some(message) => task.receive(&message, &mut wire),
                None => thread::sleep(Duration::from_micros(100)),
            }
            for message in wire.messages.drain(..) {
                sent += 1;
                let times = match line {
                    Line::Good => 1,
                    // Only now and then, or the test would take an hour.
                    Line::Late(by) if sent % 40 == 0 => {
                        thread::sleep(by);
                        1
                    }
                    Line::Late(_) => 1,
                    Line::Loses(each) => usize::from(sent % each != 0),
                    Line::Doubles => 2,
                    Line::WithoutSummaries => {
                        let body = Downlink::decode(&message).unwrap().body;
                        usize::from(!matches!(body, Body::RunSummary(_)))
                    }
                };
                if (0..times).any(|_| link.send(&message, 0).is_err()) {
                    return;
                }
            }
        }
    });
    address
}

/// The reference run on a day that gets colder; for some rows nobody knows how cold, and once the thermometer is broken.
fn with_temperatures(log: &str) -> String {
    let mut cold = String::new();
    for (row, line) in log.lines().enumerate() {
        match row {
            0 => writeln!(cold, "{line},ambient_temperature_c"),
            _ if row % 5 == 0 => writeln!(cold, "{line},"),
            42 => writeln!(cold, "{line},999"),
            _ => writeln!(cold, "{line},{}", 10.0 - row as f64 / 8.0),
        }
        .unwrap();
    }
    cold
}

fn digests_of_a_replay(train: &Path, track: &Path, run: &Path, effects: Effects) -> Vec<u32> {
    let (_, train) = TrainFile::read(train).unwrap();
    let (_, track) = TrackFile::read(track).unwrap();
    let recording = recording(run);
    let estimator = Estimator::try_new(Config::default(), train, track).unwrap();
    let estimator = estimator.with_effects(effects);
    let mut vehicle = estimator.new_vehicle();
    let replayed = replay(&estimator, &mut vehicle, &recording, Tick::default());
    replayed.estimates.iter().map(digest::of_estimate).collect()
}

#[test]
fn the_temperature_of_a_log_reaches_the_board_as_it_reaches_a_replay() {
    let reference = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/reference");
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let log = std::fs::read_to_string(reference.join("run01.csv")).unwrap();
    std::fs::write(path("run.csv"), with_temperatures(&log)).unwrap();
    std::fs::write(path("key.bin"), PROVISIONING.to_bytes()).unwrap();
    let train = std::fs::read_to_string(reference.join("train.toml")).unwrap();
    let effect = "[[effect]]\nname = \"temperature_resistance\"\ndr0_per_degC = -1e-4\nref_c = 15.0\n";
    std::fs::write(path("train.toml"), format!("{train}\n{effect}")).unwrap();
    let track = reference.join("track.toml");

    let mut arguments: Vec<OsString> = ["rundown", "link", "--to", &board(Line::Good)].map(OsString::from).into();
    for (name, value) in [
        ("--key", path("key.bin")),
        ("--train", path("train.toml")),
        ("--track", track.clone()),
        ("--record", path("record.csv")),
    ] {
        arguments.extend([name.into(), value.into()]);
    }
    arguments.push(path("run.csv").into());
    assert_eq!(commands::run(arguments), ExitCode::SUCCESS);

    let recorded = read(std::fs::File::open(path("record.csv")).unwrap()).unwrap();
    let heard = recorded.iter().filter(|recorded| recorded.way == Way::Received);
    let found: Vec<u32> = heard
        .filter_map(|recorded| match Downlink::decode(&recorded.message).unwrap().body {
            Body::Estimate(estimate) => Some(estimate.digest),
            _ => None,
        })
        .collect();
    let effects =
        Effects::try_new([Effect::TemperatureResistance(TemperatureResistance { dr0_per_deg_c: -1e-4, ref_c: 15.0 })]);
    let run = path("run.csv");
    let train = path("train.toml");
    let expected = digests_of_a_replay(&train, &track, &run, effects.unwrap());
    assert_eq!(found, expected);
    // And it matters.
    let without = digests_of_a_replay(&train, &track, &run, Effects::NONE);
    assert_ne!(found, without);
}

/// Plays the reference run over such a line; the exit code and the frames received.
fn play(line: Line) -> (ExitCode, Vec<Downlink>) {
    let reference = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/reference");
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("key.bin"), PROVISIONING.to_bytes()).unwrap();
    let mut arguments: Vec<OsString> = ["rundown", "link", "--to", &board(line)].map(OsString::from).into();
    for (name, value) in [
        ("--key", path("key.bin")),
        ("--train", reference.join("train.toml")),
        ("--track", reference.join("track.toml")),
        ("--record", path("record.csv")),
    ] {
        arguments.extend([name.into(), value.into()]);
    }
    arguments.push(reference.join("run01.csv").into());
    let code = commands::run(arguments);
    let recorded = read(std::fs::File::open(path("record.csv")).unwrap()).unwrap();
    let heard = recorded.iter().filter(|recorded| recorded.way == Way::Received);
    (code, heard.map(|recorded| Downlink::decode(&recorded.message).unwrap()).collect())
}

fn estimates(frames: &[Downlink]) -> Vec<f64> {
    let times = frames.iter().filter_map(|frame| match &frame.body {
        Body::Estimate(estimate) => Some(estimate.time_s),
        _ => None,
    });
    times.collect()
}

#[test]
fn answers_that_are_late_or_doubled_are_taken_for_no_other_questions() {
    let (_, expected) = play(Line::Good);
    for line in [Line::Late(Duration::from_millis(300)), Line::Late(Duration::from_secs(2)), Line::Doubles] {
        let (code, frames) = play(line);
        assert_eq!(code, ExitCode::SUCCESS);
        let mut times = estimates(&frames);
        times.dedup();
        assert_eq!(times, estimates(&expected));
    }
}

#[test]
fn a_lost_answer_is_asked_for_again() {
    let (code, frames) = play(Line::Loses(41));
    assert_eq!(code, ExitCode::SUCCESS);
    assert!(frames.iter().any(|frame| matches!(frame.body, Body::RunSummary(_))));
}

#[test]
fn a_run_without_a_summary_is_an_error() {
    let (code, _) = play(Line::WithoutSummaries);
    assert_eq!(code, ExitCode::from(5));
}
