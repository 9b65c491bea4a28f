//! Are these the bytes? `WIRE.md` is read here and held to the code; broken bytes never panic; frames of the first version stay readable.
//!
//! `BLESS=1 cargo test -p host-tests --test wire -- --test-threads=1` writes the examples and the sizes into the document. It never writes `data/golden/wire_v1.txt`: released bytes do not change.

#[path = "wire/conversation.rs"]
mod conversation;
#[path = "wire/examples.rs"]
mod examples;

use examples::{Frame, all, largest};
use host_tests::board::{Board, PROVISIONING, answer};
use host_tests::fields::{Fields, varint};
use host_tests::flash::Flash;
use rundown::estimator::config::Mode;
use rundown::model::direction::Direction;
use rundown::model::motion::Evaluate;
use rundown::onboard::uplink::{OPEN, Pace, Request, SECURED, VERSION as UPLINK_VERSION};
use rundown::tick::paper::Difference;
use rundown::tick::sensor::Rounding;
use rundown_wire::link::{checksum::CHECKSUM_BYTES, serial};
use rundown_wire::{
    Cause, CoastArrival, CoastOutcome, DecodeError, Downlink, FILE_TAIL, Failure, Learned, MAX_MESSAGE, Memory,
    Refusal, Regime, ResetCause, Stalled, VERSION, Validity, Value, decode,
};
use serde::{Serialize, de::DeserializeOwned};
use std::collections::BTreeMap;
use std::path::PathBuf;

const GOLDEN: &str = include_str!("../../data/golden/wire_v1.txt");
const TRAILER: usize = 16;

fn path() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../WIRE.md"))
}

fn document() -> String {
    std::fs::read_to_string(path()).expect("WIRE.md")
}

fn hex(bytes: &[u8]) -> String {
    let digits: Vec<String> = bytes.iter().map(|byte| format!("{byte:02X}")).collect();
    digits.join(" ")
}

fn unhex(words: &str) -> Vec<u8> {
    words.split_whitespace().map(|word| u8::from_str_radix(word, 16).expect("two digits")).collect()
}

/// An uplink message without version, protection and trailer.
fn payload(protection: u8, message: &[u8]) -> &[u8] {
    let end = message.len() - if protection == SECURED { TRAILER } else { 0 };
    &message[2..end]
}

/// An example as it stands in the document: bytes, two blanks, what they say; eight bytes a line.
fn shown(frame: &Frame) -> String {
    let message = frame.message();
    let mut rows: Vec<(String, Vec<u8>)> = vec![("version".into(), vec![message[0]])];
    if let Frame::Up(protection, _) = frame {
        let word = if *protection == OPEN { "open" } else { "secured" };
        rows.push((format!("protection {word}"), vec![*protection]));
    }
    for field in frame.fields().fields {
        rows.push((format!("{} {}", field.path, field.value), field.bytes));
    }
    if let Frame::Up(SECURED, _) = frame {
        let trailer = &message[message.len() - TRAILER..];
        for (name, part) in [("epoch", &trailer[..4]), ("counter", &trailer[4..8]), ("MAC", &trailer[8..])] {
            rows.push((name.into(), part.to_vec()));
        }
    }
    let mut text = String::new();
    for (says, bytes) in rows {
        for (i, line) in bytes.chunks(8).enumerate() {
            let says = if i == 0 { says.as_str() } else { "" };
            text += format!("{:<23}  {says}", hex(line)).trim_end();
            text += "\n";
        }
    }
    text
}

/// The bytes of an example in the document.
fn bytes_of(text: &str) -> Vec<u8> {
    text.lines().flat_map(|line| unhex(line.split("  ").next().unwrap_or(""))).collect()
}

/// Begin and end of what stands between a marker's fence and the closing one.
fn block(document: &str, name: &str) -> std::ops::Range<usize> {
    let marker = format!("<!-- example: {name} -->\n```text\n");
    let at = document.find(&marker).unwrap_or_else(|| panic!("WIRE.md has no example of {name}"));
    let begin = at + marker.len();
    begin..begin + document[begin..].find("```").expect("a closing fence")
}

#[test]
fn the_examples_in_the_document_are_what_the_code_writes_and_reads() {
    let mut document = document();
    for (name, frame) in all() {
        let range = block(&document, &name);
        if std::env::var_os("BLESS").is_some() {
            document.replace_range(range, &shown(&frame));
            continue;
        }
        let text = &document[range];
        let bytes = bytes_of(text);
        assert_eq!(hex(&frame.message()), hex(&bytes), "{name}: written");
        assert_eq!(frame.read(&bytes), Some(frame.clone()), "{name}: read");
        assert_eq!(text, shown(&frame), "{name}: said");
    }
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(path(), document).unwrap();
        return;
    }
    let markers = document.matches("<!-- example: ").count();
    assert_eq!(markers, all().len(), "an example of no frame");
}

#[test]
fn the_rules_in_the_document_give_the_bytes() {
    for (name, frame) in all().into_iter().chain(largest()) {
        let message = frame.message();
        let payload = match frame {
            Frame::Down(_) => &message[1..],
            Frame::Up(protection, _) => payload(protection, &message),
        };
        assert_eq!(hex(payload), hex(&frame.fields().bytes()), "{name}");
    }
}

/// The rows of the table under a heading, cut into cells.
fn table(document: &str, heading: &str) -> Option<Vec<Vec<String>>> {
    let mut lines = document.lines().skip_while(|line| *line != format!("#### {heading}"));
    lines.next()?;
    let rows =
        lines.take_while(|line| !line.starts_with('#')).filter(|line| line.starts_with("| ")).skip(1).map(|line| {
            let cells = line.trim_matches('|').split('|');
            cells.map(|cell| cell.trim().replace('`', "")).collect()
        });
    Some(rows.collect())
}

#[test]
fn the_field_tables_are_those_of_the_code() {
    let document = document();
    let mut shapes = BTreeMap::new();
    for (_, frame) in all() {
        shapes.extend(frame.fields().shapes);
    }
    // Reached through no example, which has another failure.
    shapes.extend(Fields::of(&Stalled::default()).shapes);
    for (name, fields) in &shapes {
        let heading = name.strip_suffix("Table").unwrap_or(name);
        let rows = table(&document, heading).unwrap_or_else(|| panic!("no table of {heading}"));
        let found: Vec<(&str, &str)> =
            rows.iter().map(|row| (row[0].as_str(), row[1].split(" up to ").next().unwrap())).collect();
        let kind = |kind: &str| kind.replace("SpreadTable", "Spread");
        let fields: Vec<(&str, String)> = fields.iter().map(|(f, k)| (*f, kind(k))).collect();
        let expected: Vec<(&str, &str)> = fields.iter().map(|(f, k)| (*f, k.as_str())).collect();
        assert_eq!(found, expected, "{heading}");
    }
}

/// Numbers and words of an enum stand in the document, and no other number is read.
fn enum_table<T: Serialize + DeserializeOwned>(values: &[T]) {
    let document = document();
    let mut expected = Vec::new();
    let mut name = "";
    for value in values {
        let fields = Fields::of(value);
        let (of, number, word) = fields.variants[0].clone();
        name = of;
        expected.push((number.to_string(), word));
    }
    let rows = table(&document, name).unwrap_or_else(|| panic!("no table of {name}"));
    let found: Vec<(String, String)> = rows.iter().map(|row| (row[0].clone(), row[1].clone())).collect();
    assert_eq!(found, expected, "{name}");
    for number in values.len()..=usize::from(u8::MAX) {
        let mut message = vec![VERSION];
        message.extend(varint(number as u64));
        message.extend([0; 300]);
        assert!(
            matches!(decode::<T>(&message), Err(DecodeError::Malformed)),
            "{name} has a variant {number} that the document does not list"
        );
    }
}

#[test]
fn the_numbers_of_the_enums_are_those_of_the_code() {
    enum_table(&Regime::ALL);
    enum_table(&Cause::ALL);
    enum_table(&Refusal::ALL);
    enum_table(&[Validity::Valid, Validity::Held(Cause::NoSpeed), Validity::Invalid(Cause::NoSpeed)]);
    enum_table(&[
        CoastOutcome::Unknown,
        CoastOutcome::NoTarget,
        CoastOutcome::Arrives(CoastArrival { speed_mps: Value::default(), time_s: 0.0, time_sd_s: 0.0 }),
        CoastOutcome::MayStop,
        CoastOutcome::Stops(Value::default()),
    ]);
    enum_table(&[Learned::NotYet, Learned::Learned, Learned::OutOfBounds]);
    enum_table(&[
        Memory::Empty,
        Memory::Restored,
        Memory::RestoredOlder,
        Memory::Foreign,
        Memory::Implausible,
        Memory::ReadOnly,
    ]);
    enum_table(&[ResetCause::PowerOn, ResetCause::Pin, ResetCause::Software, ResetCause::Watchdog, ResetCause::Other]);
    enum_table(&[
        Failure::None,
        Failure::Panic { line: 1, file: [0; FILE_TAIL] },
        Failure::Fault { at: 1 },
        Failure::StackOverflow,
        Failure::Stalled(Stalled::default()),
    ]);
    enum_table(&[Mode::Paper, Mode::Gated, Mode::Measured]);
    enum_table(&[Rounding::Rounded, Rounding::Truncated]);
    enum_table(&[Difference::Backward, Difference::Forward]);
    enum_table(&[Evaluate::Beginning, Evaluate::Midway]);
    enum_table(&[Direction::Up, Direction::Down]);
    enum_table(&[Pace::Clock, Pace::Lockstep]);
    enum_table(&examples::COMMANDS);
    enum_table(&rundown::onboard::uplink::Setting::all(&rundown::estimator::config::Config::default()));

    let mut requests: Vec<Request> = Vec::new();
    let mut bodies = Vec::new();
    for (_, frame) in all() {
        match frame {
            Frame::Down(frame) => bodies.push(frame.body),
            Frame::Up(_, frame) => {
                let number = |request: &Request| Fields::of(request).variants[0].1;
                if requests.last().map(number) != Some(number(&frame.request)) {
                    requests.push(frame.request);
                }
            }
        }
    }
    enum_table(&bodies);
    enum_table(&requests);
}

/// Bytes on the serial line at worst: no byte of the message is zero, so COBS needs all its extra bytes.
fn on_the_line(message: usize) -> usize {
    let checked = message + CHECKSUM_BYTES;
    checked + 1 + checked / 254 + 1
}

#[test]
fn the_largest_sizes_are_those_of_the_document() {
    let mut document = document();
    let heading = "| frame | message | serial line |\n|---|---|---|\n";
    let mut rows = String::new();
    let mut most = 0;
    for (name, frame) in largest() {
        let length = frame.message().len();
        assert!(length <= MAX_MESSAGE, "{name}: {length} bytes");
        // Every other value of these frames is shorter, or as long.
        assert_eq!(frame.fields().could_grow, [""; 0], "{name}");
        let line = on_the_line(length);
        let tried = (1..=u8::MAX).map(|byte| serial::encode(&vec![byte; length]).unwrap().len()).max();
        assert_eq!(tried, Some(line), "{name}");
        assert!(serial::encode(&frame.message()).unwrap().len() <= line);
        rows += &format!("| {name} | {length} | {line} |\n");
        most = most.max(length);
    }
    rows += &format!("| any | {MAX_MESSAGE} | {} |\n", serial::MAX_SERIAL);
    if std::env::var_os("BLESS").is_some() {
        let begin = document.find(heading).expect("the table") + heading.len();
        let end = begin + document[begin - 1..].find("\n\n").expect("an end");
        document.replace_range(begin..end, &rows);
        std::fs::write(path(), document).unwrap();
        return;
    }
    assert!(document.contains(&format!("{heading}{rows}\n")), "{rows}");
}

/// Old frames stay readable, and are written as they were.
#[test]
fn frames_of_version_1_are_read_and_written_as_ever() {
    let golden: BTreeMap<&str, Vec<u8>> = GOLDEN
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| line.split_once(": ").expect("name: bytes"))
        .map(|(name, words)| (name, unhex(words)))
        .collect();
    for (name, frame) in all() {
        let Some(bytes) = golden.get(name.as_str()) else {
            panic!("append to data/golden/wire_v1.txt:\n{name}: {}", hex(&frame.message()));
        };
        assert_eq!(frame.read(bytes), Some(frame.clone()), "{name}");
        assert_eq!(hex(&frame.message()), hex(bytes), "{name}");
    }
    assert_eq!(golden.len(), all().len(), "a released frame is no longer there");
}

#[test]
fn a_message_that_ends_early_is_none() {
    for (name, frame) in all().into_iter().chain(largest()) {
        let message = frame.message();
        for length in 0..message.len() {
            assert_eq!(frame.read(&message[..length]), None, "{name}: {length}");
        }
        match frame {
            Frame::Down(_) => {
                assert_eq!(Downlink::decode(&[]), Err(DecodeError::Empty));
                for length in 1..message.len() {
                    let found = Downlink::decode(&message[..length]);
                    assert_eq!(found, Err(DecodeError::Malformed), "{name}: {length}");
                }
            }
            // What stands behind a MAC that is right may end early, too.
            Frame::Up(protection, _) => {
                let payload = payload(protection, &message);
                for length in 0..payload.len() {
                    let found = rundown::onboard::uplink::decode(&payload[..length]);
                    assert_eq!(found, None, "{name}: {length}");
                }
            }
        }
    }
}

/// Every byte of every example replaced by every other one. What is still read is written again: its bytes are a message.
#[test]
fn no_changed_byte_panics() {
    let (mut tried, mut still_read) = (0, 0);
    let mut buffer = [0; MAX_MESSAGE];
    for (_, frame) in all() {
        let message = frame.message();
        // Without the MAC, which refuses them all: what an own key signs is read, too.
        let payload = match frame {
            Frame::Down(_) => message.as_slice(),
            Frame::Up(protection, _) => payload(protection, &message),
        };
        for at in 0..payload.len() {
            let mut changed = payload.to_vec();
            for byte in 0..=u8::MAX {
                changed[at] = byte;
                tried += 1;
                still_read += u32::from(match frame {
                    Frame::Down(_) => match Downlink::decode(&changed) {
                        Ok(read) => read.encode(&mut buffer).is_ok(),
                        Err(_) => false,
                    },
                    Frame::Up(..) => match rundown::onboard::uplink::decode(&changed) {
                        Some(read) => rundown::onboard::uplink::encode(&read, OPEN, &mut buffer).is_ok(),
                        None => false,
                    },
                });
            }
        }
    }
    println!("{tried} changed messages, {still_read} are messages too");
    assert!(0 < still_read && still_read < tried);
}

#[test]
fn no_changed_byte_passes_the_mac() {
    for (name, frame) in all() {
        let Frame::Up(SECURED, _) = frame else {
            continue;
        };
        let message = frame.message();
        // The protection byte says whether there is a MAC at all; the board then asks for one.
        for at in (0..message.len()).filter(|at| *at != 1) {
            for flip in [0x01, 0x80, 0xFF] {
                let mut changed = message.clone();
                changed[at] ^= flip;
                assert_eq!(frame.read(&changed), None, "{name}: byte {at} ^ {flip}");
            }
        }
    }
}

#[test]
fn what_a_receiver_does_not_know_has_a_name() {
    for (_, frame) in all() {
        let Frame::Down(frame) = frame else {
            continue;
        };
        let mut buffer = [0; MAX_MESSAGE];
        let message = frame.encode(&mut buffer).unwrap().to_vec();
        let mut longer = message.clone();
        longer.extend([0, 0]);
        let too_long = Err(DecodeError::TooLong { left: 2 });
        assert_eq!(Downlink::decode(&longer), too_long);
        let mut other = message.clone();
        other[0] = VERSION + 1;
        let version = Err(DecodeError::Version { found: VERSION + 1 });
        assert_eq!(Downlink::decode(&other), version);
        // Version, sequence 7, tick 300 in two bytes, then the number of the frame.
        let mut unknown = message;
        unknown[4] = 12;
        assert_eq!(Downlink::decode(&unknown), Err(DecodeError::Malformed));
    }
}

/// What the board answers to a message that says `payload`, signed with its key.
fn secured(payload: &[u8]) -> Refusal {
    let mut board = Board::start(Flash::erased(8));
    let announcement = board.status().announcement.unwrap();
    let mut signer = rundown::onboard::auth::Signer::new(&PROVISIONING, &announcement).unwrap();
    let mut message = vec![UPLINK_VERSION, SECURED];
    message.extend(payload);
    let mut buffer = [0; MAX_MESSAGE];
    let sealed = signer.seal(rundown::onboard::task::DATA_ID, &message, &mut buffer);
    let frames = board.say(sealed.unwrap());
    answer(&frames).unwrap().result.unwrap_err()
}

#[test]
fn the_board_names_what_it_does_not_know() {
    let open = |message: &[u8]| {
        let frames = Board::start(Flash::erased(8)).say(message);
        answer(&frames).unwrap().result.unwrap_err()
    };
    let status = [UPLINK_VERSION, OPEN, 21, 5, 3];
    assert_eq!(open(&[UPLINK_VERSION + 1, OPEN, 21, 5, 3]), Refusal::Version);
    assert_eq!(open(&[UPLINK_VERSION, 2, 21, 5, 3]), Refusal::Malformed);
    assert_eq!(open(&[UPLINK_VERSION, OPEN, 21, 10]), Refusal::Malformed);
    assert_eq!(open(&[&status[..], &[0]].concat()), Refusal::Malformed);
    assert_eq!(open(&status[..1]), Refusal::Malformed);
    assert_eq!(secured(&[21, 10]), Refusal::Malformed);
    assert_eq!(secured(&[21, 5, 3, 0]), Refusal::Malformed);

    // Every request but a measurement and the question for the status must be secured; of the effects only those that the model has are taken.
    for (name, frame) in all() {
        let Frame::Up(protection, uplink) = &frame else {
            continue;
        };
        if *protection == SECURED {
            let message = frame.message();
            let bare = payload(SECURED, &message);
            let unsigned = [&[UPLINK_VERSION, OPEN], bare].concat();
            assert_eq!(open(&unsigned), Refusal::NotSecured, "{name}");
            if let Request::Effect(_) = uplink.request {
                // The second byte behind the sequence number is the kind.
                let mut other = bare.to_vec();
                assert_eq!(other[2], 1);
                other[2] = u8::MAX;
                assert_eq!(secured(&other), Refusal::UnknownEffect);
            }
        }
    }
}
