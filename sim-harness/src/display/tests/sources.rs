//! Recordings, files that grow, a board that goes and comes.

use super::{MESSAGES, file, hub, on_the_line, shown};
use crate::display::hub::{Connection, Hub};
use crate::{display::demo, display::setup::Setup, display::source::FrameSource, session};
use rundown::uplink::{self, Command, Request, SECURED, Uplink};
use rundown::{estimator::config::Config, model::direction::Direction, onboard::auth::TRAILER};
use std::time::{Duration, Instant};
use std::{io::Write, net::TcpListener, sync::Arc};

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
    let description = session::description(&train.train().unwrap(), &track, Config::default());
    let begin = Request::Command(Command::Begin { direction: Direction::Up, track_id: description.track_id() });
    // A display has no key and takes any MAC.
    let line = |request: Request| {
        let uplink = Uplink { sequence: 1, request };
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
        let sent = view.setup.track.as_ref().unwrap();
        assert_eq!(view.described, 1);
        let read = view.setup.train.as_ref().unwrap();
        assert_eq!((read.davis, read.mass_kg), (train.davis, train.mass_kg));
        assert_eq!(read.rotating_mass_factor, train.rotating_mass_factor);
        assert_eq!(sent.length_m, track.length_m);
        assert_eq!(sent.gradient, track.gradient);
        assert_eq!(sent.stops_m(), track.stops_m());
        assert_eq!(sent.speed_limit.len(), track.speed_limit.len());
        for (sent, described) in sent.speed_limit.iter().zip(&track.speed_limit) {
            assert_eq!(sent.from_m, described.from_m);
            assert!((sent.kmh - described.kmh).abs() < 1e-9);
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
    shown(b"").view(|view| assert!(matches!(view.link.connection, Connection::Lost(_)), "a recording has bytes"));
}

#[test]
fn a_file_that_grows_is_followed() {
    let line = on_the_line(&MESSAGES);
    let (half, rest) = line.split_at(line.len() / 2);
    let (_folder, path) = file(half);
    let hub = hub();
    let source = FrameSource::File { path: path.clone(), follow: true };
    let (feed, open) = (Arc::clone(&hub), source.open().unwrap());
    std::thread::spawn(move || open.run(&feed, None));
    wait(&hub, |frames| frames > MESSAGES.len() / 3);
    let mut file = std::fs::OpenOptions::new().append(true).open(path).unwrap();
    file.write_all(rest).unwrap();
    wait(&hub, |frames| frames == MESSAGES.len());
    hub.view(|view| assert_eq!((view.link.tally.lost, view.link.tally.damaged), (0, 0)));
}

#[test]
fn a_file_that_comes_later_and_is_written_again_is_followed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames");
    let hub = hub();
    let source = FrameSource::File { path: path.clone(), follow: true };
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

#[test]
fn a_board_that_goes_and_comes_is_found_again() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("tcp:{}", listener.local_addr().unwrap());
    let hub = hub();
    let source = FrameSource::Board { address: address.parse().unwrap(), listen_only: false };
    let (feed, open) = (Arc::clone(&hub), source.open().unwrap());
    std::thread::spawn(move || open.run(&feed, None));
    let mut sent = 0;
    for round in 0..3_u32 {
        let (mut line, _) = listener.accept().unwrap();
        let more = &MESSAGES[sent..sent + 50];
        sent += more.len();
        // The end of a message whose begin was not heard.
        line.write_all(&[0x17, 0x42, 0x00]).unwrap();
        line.write_all(&on_the_line(more)).unwrap();
        wait(&hub, |frames| frames == sent);
        drop(line);
        let begin = Instant::now();
        while hub.view(|view| !matches!(view.link.connection, Connection::Lost(_)) && view.link.reconnects == round) {
            assert!(begin.elapsed() < Duration::from_secs(10));
            std::thread::sleep(Duration::from_millis(1));
        }
    }
    hub.view(|view| {
        assert!(view.link.reconnects >= 2);
        assert_eq!((view.link.tally.lost, view.link.tally.damaged), (0, 3));
    });
}

fn wait(hub: &Hub, mut enough: impl FnMut(usize) -> bool) {
    let begin = Instant::now();
    while !hub.view(|view| enough(view.link.tally.frames as usize)) {
        let tally = hub.view(|view| view.link);
        assert!(begin.elapsed() < Duration::from_secs(20), "{tally:?}");
        std::thread::sleep(Duration::from_millis(5));
    }
}
