//! Does `rundown display` print every frame, name what it refuses, and serve its page?

use rundown::link::serial;
use rundown_wire::{Body, Downlink, RunSummary};
use sim_harness::display::demo;
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Command, Output, Stdio};
use std::{net::TcpListener, sync::LazyLock};

/// Messages of two simulated runs.
static MESSAGES: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
    let mut messages = Vec::new();
    demo::play_runs(2, |message| messages.push(message.to_vec())).unwrap();
    messages
});

fn on_the_line(messages: &[Vec<u8>]) -> Vec<u8> {
    messages.iter().flat_map(|message| serial::encode(message).unwrap()).collect()
}

fn rundown(arguments: &[&str], stdin: &[u8]) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_rundown"))
        .arg("display")
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut pipe = child.stdin.take().unwrap();
    let bytes = stdin.to_vec();
    let writer = std::thread::spawn(move || pipe.write_all(&bytes));
    let output = child.wait_with_output().unwrap();
    // The command may refuse its arguments before it reads.
    let _ = writer.join().unwrap();
    output
}

#[test]
fn json_lines_have_every_frame_in_si_units() {
    let output = rundown(&["-", "--json"], &on_the_line(&MESSAGES));
    assert_eq!(output.status.code(), Some(0));
    let text = String::from_utf8(output.stdout).unwrap();
    let lines: Vec<serde_json::Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(lines.len(), MESSAGES.len());
    for (line, message) in lines.iter().zip(MESSAGES.iter()) {
        let frame = Downlink::decode(message).unwrap();
        assert_eq!(line["sequence"], frame.sequence);
        assert_eq!(line["tick"], frame.tick);
        let body = &line["body"][frame.body.as_str()];
        if let Body::Estimate(estimate) = frame.body {
            assert_eq!(body["time_s"], estimate.time_s);
            let speed = body["speed_mps"]["value"].as_f64().unwrap();
            assert_eq!(speed as f32, estimate.speed_mps.value);
            assert_eq!(body["regime"], estimate.regime.as_str());
        } else {
            assert!(!body.is_null(), "{line}");
        }
    }
}

#[test]
fn text_has_a_line_a_frame_and_says_what_was_lost() {
    let mut messages = MESSAGES.clone();
    messages.remove(100);
    let output = rundown(&["-", "--text"], &on_the_line(&messages));
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(text.lines().count(), messages.len());
    assert!(text.contains("(1 lost)"));
    assert!(text.contains("not learned yet"));
    let note = String::from_utf8(output.stderr).unwrap();
    assert_eq!(note, format!("note: {} frames, 1 lost, 0 damaged, 0 unknown\n", messages.len()));
}

#[test]
fn a_whole_run_that_is_missing_is_said_by_the_numbers_of_the_runs() {
    let summary = |run| {
        let message =
            MESSAGES.iter().find(|message| matches!(Downlink::decode(message).unwrap().body, Body::RunSummary(_)));
        let frame = Downlink::decode(message.unwrap()).unwrap();
        let Body::RunSummary(summary) = frame.body else { panic!("a summary") };
        let body = Body::RunSummary(RunSummary { run, ..summary });
        let mut buffer = [0; 512];
        Downlink { sequence: 0, tick: run, body }.encode(&mut buffer).unwrap().to_vec()
    };
    let note = |runs: &[u32]| {
        let messages: Vec<Vec<u8>> = runs.iter().map(|run| summary(*run)).collect();
        String::from_utf8(rundown(&["-", "--text"], &on_the_line(&messages)).stderr).unwrap()
    };
    assert_eq!(note(&[4, 5]), "");
    let said = "note: by their numbers 3 runs are missing between those recorded; their lost frames are not counted\n";
    assert_eq!(note(&[4, 8, 9]), said);
    assert_eq!(note(&[4, 1, 2]), "", "another vehicle");
}

#[test]
fn beside_lines_that_do_not_come_stands_why() {
    // Nothing listens on a port that was just free.
    let free = TcpListener::bind("127.0.0.1:0").unwrap();
    let server = free.local_addr().unwrap().to_string();
    drop(free);
    let mut child = Command::new(env!("CARGO_BIN_EXE_rundown"))
        .args(["display", "--tcp", &server, "--json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut note = String::new();
    BufReader::new(child.stderr.as_mut().unwrap()).read_line(&mut note).unwrap();
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(note.starts_with(&format!("note: tcp:{server}: ")), "{note}");
    assert!(note.ends_with("; it is tried again\n"), "{note}");
}

#[test]
fn what_is_recorded_can_be_shown_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.frames");
    let path = path.to_str().unwrap();
    let first = rundown(&["-", "--text", "--record", path], &on_the_line(&MESSAGES));
    let again = rundown(&["--file", path, "--text"], &[]);
    assert_eq!(first.stdout, again.stdout);
    assert!(!again.stdout.is_empty());
}

#[test]
fn a_recording_without_a_byte_is_none() {
    let output = rundown(&["-", "--text"], &[]);
    assert_eq!(output.status.code(), Some(3));
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(error.contains("expected a recording of frames, found none in 0 bytes"), "{error}");
}

#[test]
fn wrong_arguments_are_named() {
    let code = |arguments: &[&str]| rundown(arguments, &[]).status.code();
    assert_eq!(code(&["--tcp", "nowhere", "--text"]), Some(2));
    assert_eq!(code(&[]), Some(2), "no source");
    assert_eq!(code(&["-", "--text", "--json"]), Some(2), "two views");
    assert_eq!(code(&["--file", "no-such-file", "--text"]), Some(3));
    for view in ["--text", "--json"] {
        for prose in ["# Rundown\n", "# Rundown\n\0is no recording\0of frames"] {
            let refused = rundown(&["-", view], prose.as_bytes());
            assert_eq!(refused.status.code(), Some(3));
            let said = String::from_utf8(refused.stderr).unwrap();
            assert!(said.contains("expected a recording of frames, found none in "), "{said}");
        }
    }
    assert_eq!(code(&["-", "--text", "--speed", "0"]), Some(2));
}

#[test]
fn the_page_answers_its_own_name_only() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_rundown"))
        .args(["display", "-", "--http", "0"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut line).unwrap();
    let host = line.split_whitespace().nth(1).unwrap().trim_start_matches("http://").trim_end_matches('/').to_owned();
    let ask = |path: &str, name: &str| {
        let mut stream = std::net::TcpStream::connect(&host).unwrap();
        write!(stream, "GET {path} HTTP/1.1\r\nHost: {name}\r\nConnection: close\r\n\r\n").unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        answer
    };
    let answers =
        [("/", "<!DOCTYPE html>"), ("/state", "\"points\":[]"), ("/setup", "{\"train\":null"), ("/uplot.js", "uPlot")];
    for (path, expected) in answers {
        let answer = ask(path, &host);
        assert!(answer.starts_with("HTTP/1.1 200") && answer.contains(expected), "{path}: {answer:.300}");
    }
    assert!(ask("/state", "evil.example").starts_with("HTTP/1.1 403"));
    assert!(ask("/nothing", &host).starts_with("HTTP/1.1 404"));
    child.kill().unwrap();
    child.wait().unwrap();
}
