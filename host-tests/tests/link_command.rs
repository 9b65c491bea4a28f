//! Does `rundown link` tell a board what a replay knows? A board on the host behind a TCP port, and the same log
//! through `replay`.

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
    /// The frame that closes the exchange of this number is lost, once: an answer, or an estimate.
    LosesClosing(usize),
    /// Summaries never come.
    WithoutSummaries,
}

/// What a request or a measurement waits for.
fn closes(body: &Body) -> bool {
    matches!(body, Body::Answer(_) | Body::Estimate(_))
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
        let (mut sent, mut closed) = (0, 0);
        while let Ok(message) = link.receive(0) {
            match message {
                Some(message) => task.receive(&message, &mut wire),
                None => thread::sleep(Duration::from_micros(100)),
            }
            for message in wire.messages.drain(..) {
                sent += 1;
                let body = Downlink::decode(&message).unwrap().body;
                closed += usize::from(closes(&body));
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
                    Line::LosesClosing(number) => usize::from(!(closes(&body) && closed == number)),
                    Line::WithoutSummaries => usize::from(!matches!(body, Body::RunSummary(_))),
                };
                if (0..times).any(|_| link.send(&message, 0).is_err()) {
                    return;
                }
            }
        }
    });
    address
}

/// The reference run on a day that gets colder; for some rows nobody knows how cold, and once the thermometer is
/// broken.
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
    play_log(line, &reference, "run01.csv")
}

/// The same with a log, a train and a track of this folder.
fn play_log(line: Line, reference: &Path, log: &str) -> (ExitCode, Vec<Downlink>) {
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
    arguments.push(reference.join(log).into());
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

/// The train and the first rows of the reference run, with what comes in parts: gradients, curves, targets, a table.
/// Where it lies.
fn in_parts() -> tempfile::TempDir {
    let reference = |name: &str| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/reference").join(name);
        std::fs::read_to_string(path).unwrap()
    };
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: String| std::fs::write(folder.path().join(name), text).unwrap();
    let effects = r#"
        [[effect]]
        name = "davis_error"
        dr0 = 1e-4
        dr1 = 0.0
        dr2 = 0.0
        [[effect]]
        name = "unknown"
        coordinate = "speed"
        table = [[0.0, 0.0], [10.0, 1e-4], [20.0, 2e-4]]
    "#;
    write("train.toml", reference("train.toml") + effects);
    let tables = (0..30).map(|k| {
        let (from_m, to_m) = (1000 * k, 1000 * k + 200);
        let (permille, kmh) = (k % 3 - 1, 130 + k % 2 * 10);
        format!(
            "[[gradient]]\nfrom_m = {from_m}.0\npermille = {permille}.0\n\
             [[curve]]\nfrom_m = {from_m}.0\nto_m = {to_m}.0\nradius_m = 900.0\n\
             [[speed_limit]]\nfrom_m = {from_m}.0\nkmh = {kmh}.0\n"
        )
    });
    write("track.toml", "name = \"in parts\"\nlength_m = 32103.0\n".to_owned() + &tables.collect::<String>());
    write("few.csv", reference("run01.csv").lines().take(6).map(|line| line.to_owned() + "\n").collect());
    folder
}

#[test]
fn whichever_answer_is_lost_the_board_knows_the_same_and_the_run_has_its_summary() {
    let folder = in_parts();
    let play = |line| play_log(line, folder.path(), "few.csv");
    let digests = |frames: &[Downlink]| -> Vec<u32> {
        let estimates = frames.iter().filter_map(|frame| match &frame.body {
            Body::Estimate(estimate) => Some(estimate.digest),
            _ => None,
        });
        estimates.collect()
    };
    let (code, right) = play(Line::Good);
    assert_eq!(code, ExitCode::SUCCESS);
    let expected = digests(&right);
    let exchanges = right.iter().filter(|frame| closes(&frame.body)).count();
    assert!(exchanges > 25, "{exchanges}");
    thread::scope(|scope| {
        let played: Vec<_> =
            (1..=exchanges).map(|lost| scope.spawn(move || (lost, play(Line::LosesClosing(lost))))).collect();
        for played in played {
            let (lost, (code, frames)) = played.join().unwrap();
            assert_eq!(code, ExitCode::SUCCESS, "without the answer of exchange {lost}");
            let found = digests(&frames);
            let is_right = found == expected
                || expected.len() == found.len() + 1 && found.iter().all(|one| expected.contains(one));
            assert!(is_right, "without the answer of exchange {lost}: {found:x?} for {expected:x?}");
        }
    });
}
