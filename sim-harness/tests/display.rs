//! Does `rundown display` find every frame that came, and survive everything else?

use proptest::prelude::*;
use ratatui::Terminal;
use ratatui::backend::TestBackend;
use rundown::auth::TRAILER;
use rundown::config::Config;
use rundown::link::serial;
use rundown::track::Direction;
use rundown::uplink::{self, Command as ToBoard, Request, SECURED, Uplink};
use rundown_wire::{Body, Downlink, Reader, Value};
use sim_harness::desk::Description;
use sim_harness::display::hub::{Connection, Hub};
use sim_harness::display::setup::Setup;
use sim_harness::display::source::Source;
use sim_harness::display::state::State;
use sim_harness::display::{demo, terminal};
use sim_harness::track_file::TrackFile;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpListener;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use std::sync::{Arc, LazyLock};
use std::time::{Duration, Instant};

/// Messages of two simulated runs.
static MESSAGES: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
    let mut messages = Vec::new();
    demo::play_runs(2, |message| messages.push(message.to_vec())).unwrap();
    messages
});

fn on_the_line(messages: &[Vec<u8>]) -> Vec<u8> {
    messages
        .iter()
        .flat_map(|message| serial::encode(message).unwrap())
        .collect()
}

fn hub() -> Arc<Hub> {
    Arc::new(Hub::new(
        "test".to_owned(),
        1.0,
        Setup::default(),
        Box::new(|_, _| {}),
    ))
}

fn file(bytes: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames");
    std::fs::write(&path, bytes).unwrap();
    (folder, path)
}

/// A recording through the display, at once.
fn shown(bytes: &[u8]) -> Arc<Hub> {
    let (_folder, path) = file(bytes);
    let hub = hub();
    let source = Source::File {
        path,
        follow: false,
    };
    source.open().unwrap().run(&hub, None);
    hub
}

fn estimates(messages: &[Vec<u8>]) -> Vec<f64> {
    let time_s = |message: &Vec<u8>| match Downlink::decode(message).unwrap().body {
        Body::Estimate(estimate) => Some(estimate.time_s),
        _ => None,
    };
    messages.iter().filter_map(time_s).collect()
}

#[test]
fn two_runs_are_shown_one_as_past() {
    let hub = shown(&on_the_line(&MESSAGES));
    hub.view(|view| {
        let State {
            now,
            points,
            previous,
            past,
            ..
        } = view.state;
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
    let is_end =
        |message: &Vec<u8>| matches!(Downlink::decode(message).unwrap().body, Body::RunSummary(_));
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
            let point = view
                .state
                .points
                .iter()
                .find(|point| point.time_s == pair[0].0);
            if let (Some(point), Some(regime)) = (point, pair[1].1) {
                assert_eq!(point.regime, regime, "at {} s", pair[0].0);
                changed += 1;
            }
        }
    });
    assert!(changed > 50, "{changed}");
}

#[test]
fn a_recording_in_text_shows_the_same() {
    let mut text = "time_us,direction,message\n".to_owned();
    for (index, message) in MESSAGES.iter().enumerate() {
        text += &format!("{index},received,{}\n", hex::encode(message));
        text += &format!("{index},sent,00\n");
    }
    let (text, bytes) = (shown(text.as_bytes()), shown(&on_the_line(&MESSAGES)));
    text.view(|text| bytes.view(|bytes| assert_eq!(text.state, bytes.state)));
}

#[test]
fn a_recording_of_a_link_has_train_and_track() {
    let (train, track) = demo::described().unwrap();
    let description = Description::new(&train.train().unwrap(), &track, Config::default());
    let begin = Request::Command(ToBoard::Begin {
        direction: Direction::Up,
        track_id: description.track_id(),
    });
    // A display has no key and takes any MAC.
    let line = |request: Request| {
        let uplink = Uplink {
            sequence: 1,
            request,
        };
        let mut buffer = [0; 512];
        let message = uplink::encode(&uplink, SECURED, &mut buffer).unwrap();
        format!("1,sent,{}{}\n", hex::encode(message), "00".repeat(TRAILER))
    };
    // Twice, as before each run.
    let requests = [description.requests(1), description.requests(1)].concat();
    let lines: String = requests.into_iter().map(line).collect();
    let text = format!("time_us,direction,message\n{lines}");
    shown(text.as_bytes()).view(|view| {
        assert_eq!(*view.setup, Setup::default(), "no run has begun");
    });
    shown((text + &line(begin)).as_bytes()).view(|view| {
        let told = view.setup.track.as_ref().unwrap();
        assert_eq!(view.described, 1);
        let read = view.setup.train.as_ref().unwrap();
        assert_eq!((read.davis, read.mass_kg), (train.davis, train.mass_kg));
        assert_eq!(read.rotating_mass_factor, train.rotating_mass_factor);
        assert_eq!(told.length_m, track.length_m);
        assert_eq!(told.gradient, track.gradient);
        let places =
            |track: &TrackFile| -> Vec<f64> { track.stop.iter().map(|stop| stop.at_m).collect() };
        assert_eq!(places(told), places(&track));
        assert_eq!(told.speed_limit.len(), track.speed_limit.len());
        for (told, described) in told.speed_limit.iter().zip(&track.speed_limit) {
            assert_eq!(told.from_m, described.from_m);
            assert!((told.kmh - described.kmh).abs() < 1e-9);
        }
    });
}

#[test]
fn damage_in_a_recording_is_counted_and_passed_over() {
    let mut text = "time_us,direction,message\n1,received,zz\n,,,,\n".to_owned();
    text += &format!("2,received,{}\n", hex::encode(&MESSAGES[0]));
    shown(text.as_bytes()).view(|view| {
        assert_eq!(view.link.tally.frames, 1);
        assert_eq!(view.link.tally.damaged, 2);
    });
    shown(b"time_us,").view(|view| assert_eq!(view.link.tally.frames, 0));
    shown(b"").view(|view| assert_eq!(view.link.connection, Connection::Ended));
}

#[test]
fn a_file_that_grows_is_followed() {
    let line = on_the_line(&MESSAGES);
    let (half, rest) = line.split_at(line.len() / 2);
    let (_folder, path) = file(half);
    let hub = hub();
    let source = Source::File {
        path: path.clone(),
        follow: true,
    };
    let (feed, open) = (Arc::clone(&hub), source.open().unwrap());
    std::thread::spawn(move || open.run(&feed, None));
    wait(&hub, |frames| frames > MESSAGES.len() / 3);
    let mut file = std::fs::OpenOptions::new().append(true).open(path).unwrap();
    file.write_all(rest).unwrap();
    wait(&hub, |frames| frames == MESSAGES.len());
    hub.view(|view| assert_eq!((view.link.tally.lost, view.link.tally.damaged), (0, 0)));
}

#[test]
fn a_file_that_comes_later_and_is_written_anew_is_followed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames");
    let hub = hub();
    let source = Source::File {
        path: path.clone(),
        follow: true,
    };
    let (feed, open) = (Arc::clone(&hub), source.open().unwrap());
    std::thread::spawn(move || open.run(&feed, None));
    let begin = Instant::now();
    while !hub.view(|view| matches!(view.link.connection, Connection::Lost(_))) {
        assert!(begin.elapsed() < Duration::from_secs(10), "it is not there");
    }
    std::fs::write(&path, on_the_line(&MESSAGES[..60])).unwrap();
    wait(&hub, |frames| frames == 60);
    std::fs::write(&path, on_the_line(&MESSAGES[60..90])).unwrap();
    wait(&hub, |frames| frames == 90);
    hub.view(|view| assert_eq!((view.link.tally.lost, view.link.tally.damaged), (0, 0)));
}

fn wait(hub: &Hub, mut enough: impl FnMut(usize) -> bool) {
    let begin = Instant::now();
    while !hub.view(|view| enough(view.link.tally.frames as usize)) {
        let tally = hub.view(|view| view.link);
        assert!(begin.elapsed() < Duration::from_secs(20), "{tally:?}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_board_that_goes_and_comes_is_found_again() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("tcp:{}", listener.local_addr().unwrap());
    let hub = hub();
    let source = Source::Board {
        address: address.parse().unwrap(),
        listen_only: false,
    };
    let (feed, open) = (Arc::clone(&hub), source.open().unwrap());
    std::thread::spawn(move || open.run(&feed, None));
    let mut told = 0;
    for round in 0..3_u32 {
        let (mut line, _) = listener.accept().unwrap();
        let more = &MESSAGES[told..told + 50];
        told += more.len();
        // The end of a message that nobody heard begin.
        line.write_all(&[0x17, 0x42, 0x00]).unwrap();
        line.write_all(&on_the_line(more)).unwrap();
        wait(&hub, |frames| frames == told);
        drop(line);
        let begin = Instant::now();
        while hub.view(|view| {
            !matches!(view.link.connection, Connection::Lost(_)) && view.link.reconnects == round
        }) {
            assert!(begin.elapsed() < Duration::from_secs(10));
            std::thread::sleep(Duration::from_millis(1));
        }
    }
    hub.view(|view| {
        assert!(view.link.reconnects >= 2);
        assert_eq!((view.link.tally.lost, view.link.tally.damaged), (0, 3));
    });
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
    // Faster than real time, so that nobody waits for 25 s.
    let hub = Hub::new(
        "test".to_owned(),
        100.0,
        Setup::default(),
        Box::new(|_, _| {}),
    );
    assert!(hub.view(|view| view.link.silent), "nothing has come yet");
    hub.message(&MESSAGES[30]);
    assert!(!hub.view(|view| view.link.silent));
    std::thread::sleep(Duration::from_millis(2100));
    assert!(hub.view(|view| view.link.silent));
}

#[test]
fn effects_have_the_names_of_the_estimator() {
    use rundown::effects::{Effect, EffectError, FrameError};
    for kind in 1..=18 {
        let mut effect = rundown_wire::Effect {
            kind,
            section_m: None,
            values: Default::default(),
        };
        let meaning = effect.meaning().unwrap();
        // Not a number is refused under the effect's name, once the number of values and the section are right.
        effect.values = meaning.values.iter().map(|_| f64::NAN).collect();
        let mut names = Vec::new();
        for section_m in [None, Some([0.0, 1.0])] {
            effect.section_m = section_m;
            match Effect::from_frame(&effect) {
                Err(FrameError::Refused(EffectError::OutOfRange { effect, .. })) => {
                    names.push(effect);
                }
                Err(FrameError::Shape) => {}
                other => panic!("{}: {other:?}", meaning.name),
            }
        }
        assert_eq!(names, [meaning.name]);
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
        let spoiled = pieces.iter().filter(|piece| !piece.is_empty() && piece.last() != Some(&0)).count();
        prop_assert!(found >= sent - spoiled && found <= sent);
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
        prop_assert_eq!(tally.anew, 0);
        // First to last number: each came, or is lost.
        let span = order.len() + 12;
        let fresh = tally.frames - tally.repeated;
        prop_assert!((fresh + tally.lost) as usize <= span);
        for pair in state.points.windows(2) {
            prop_assert!(pair[0].time_s < pair[1].time_s, "time goes on");
        }
    }
}

#[test]
fn the_terminal_shows_the_values_of_the_frames() {
    for (width, height) in [(120, 40), (80, 24)] {
        let hub = shown(&on_the_line(&MESSAGES[..MESSAGES.len() - 10]));
        let text = hub.view(|view| {
            let mut screen = Terminal::new(TestBackend::new(width, height)).unwrap();
            screen.draw(|frame| terminal::draw(frame, &view)).unwrap();
            screen.backend().to_string()
        });
        let estimate = hub.view(|view| view.state.now.estimate).unwrap();
        let speed = format!(
            "{:.1} ±{:.1} km/h",
            estimate.speed_mps.value * 3.6,
            estimate.speed_mps.sd * 3.6
        );
        assert!(text.contains(&speed), "{speed} is not in\n{text}");
        assert!(text.contains(&estimate.regime.as_str().to_uppercase()));
        let parameters = hub.view(|view| view.state.now.parameters).unwrap();
        let Value { value, sd } = parameters.at(100.0 / 3.6);
        let effort = hub.view(|view| view.state.now.effort).unwrap();
        let whole = [
            format!("r(100) {value:.5} ±{sd:.5} N/kg"),
            format!(
                "r2    {:>10.3e} ±{:.1e}",
                parameters.r2.value, parameters.r2.sd
            ),
            format!("most traction  {:>8.4} N/kg", effort.max_traction_n_per_kg),
            "> 130   ".to_owned(),
            "run  coast s  brake s  learned s".to_owned(),
            "q: quit".to_owned(),
        ];
        for words in whole {
            assert!(text.contains(&words), "`{words}` is not in\n{text}");
        }
    }
    // And before anything has come.
    let empty = hub();
    let mut screen = Terminal::new(TestBackend::new(80, 24)).unwrap();
    empty
        .view(|view| screen.draw(|frame| terminal::draw(frame, &view)).map(drop))
        .unwrap();
    let text = screen.backend().to_string();
    assert!(
        text.contains("no run yet") && text.contains("OLD VALUES"),
        "{text}"
    );
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
    let lines: Vec<serde_json::Value> = text
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
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
    assert_eq!(
        note,
        format!(
            "note: {} frames, 1 lost, 0 damaged, 0 unknown\n",
            messages.len()
        )
    );
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
    BufReader::new(child.stderr.as_mut().unwrap())
        .read_line(&mut note)
        .unwrap();
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
fn wrong_arguments_are_named() {
    let code = |arguments: &[&str]| rundown(arguments, &[]).status.code();
    assert_eq!(code(&["--tcp", "nowhere", "--text"]), Some(2));
    assert_eq!(code(&[]), Some(2), "no source");
    assert_eq!(code(&["-", "--text", "--json"]), Some(2), "two views");
    assert_eq!(code(&["--file", "no-such-file", "--text"]), Some(3));
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
    BufReader::new(child.stdout.as_mut().unwrap())
        .read_line(&mut line)
        .unwrap();
    let host = line
        .split_whitespace()
        .nth(1)
        .unwrap()
        .trim_start_matches("http://")
        .trim_end_matches('/')
        .to_owned();
    let ask = |path: &str, name: &str| {
        let mut stream = std::net::TcpStream::connect(&host).unwrap();
        write!(
            stream,
            "GET {path} HTTP/1.1\r\nHost: {name}\r\nConnection: close\r\n\r\n"
        )
        .unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        answer
    };
    let answers = [
        ("/", "<!DOCTYPE html>"),
        ("/state", "\"points\":[]"),
        ("/setup", "{\"train\":null"),
        ("/uplot.js", "uPlot"),
    ];
    for (path, expected) in answers {
        let answer = ask(path, &host);
        assert!(
            answer.starts_with("HTTP/1.1 200") && answer.contains(expected),
            "{path}: {answer:.300}"
        );
    }
    assert!(ask("/state", "evil.example").starts_with("HTTP/1.1 403"));
    assert!(ask("/nothing", &host).starts_with("HTTP/1.1 404"));
    child.kill().unwrap();
    child.wait().unwrap();
}
