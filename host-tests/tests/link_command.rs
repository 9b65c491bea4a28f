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

/// A board that is there until the other side goes; its address.
fn board() -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("tcp:{}", listener.local_addr().unwrap());
    thread::spawn(move || {
        let port = HostPort::tcp(listener.accept().unwrap().0).unwrap();
        let mut link = SerialLink::new(port);
        let mut task = task(Ok(PROVISIONING), Flash::erased(8), false);
        let mut wire = Wire::default();
        while let Ok(message) = link.receive(0) {
            match message {
                Some(message) => task.receive(&message, &mut wire),
                None => thread::sleep(Duration::from_micros(100)),
            }
            for message in wire.messages.drain(..) {
                if link.send(&message, 0).is_err() {
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

    let mut arguments: Vec<OsString> = ["rundown", "link", "--to", &board()].map(OsString::from).into();
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
