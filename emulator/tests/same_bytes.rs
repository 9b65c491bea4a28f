//! Is it the same code? The firmware's answers are the host's, byte for byte; and what lies in the flash at the start is seen.

mod common;

use common::{frame, settings};
use emulator::{Board, Emulator, FlashFile, Settings};
use std::io::Write;
use std::path::Path;
use std::process::Command;

/// A run in the frames of the line.
fn measurements() -> Vec<Vec<u8>> {
    let (mut speed_mps, mut location_m) = (0.0_f64, 0.0);
    (0..90)
        .map(|tick| {
            speed_mps += match tick {
                0..=20 => 1.9,
                21..=40 => 0.0,
                41..=75 => -0.5,
                _ => -5.0,
            };
            speed_mps = speed_mps.max(0.0);
            location_m += 10.0 * speed_mps;
            let values = [
                10.0 * f64::from(tick),
                location_m,
                (3.6 * speed_mps).round() / 3.6,
            ];
            let bytes: Vec<u8> = values
                .iter()
                .flat_map(|value| value.to_le_bytes())
                .collect();
            let mut coded = cobs::encode_vec(&bytes);
            coded.push(0);
            coded
        })
        .collect()
}

/// The firmware's program on the host: the same application over stdin and stdout.
fn host() -> Option<Vec<u8>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let build = Command::new(env!("CARGO"))
        .args(["build", "--quiet", "-p", "rundown", "--bin", "firmware"])
        .current_dir(&root)
        .status()
        .ok()?;
    assert!(build.success());
    let target = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .parent()?
        .join("debug/firmware");
    let input = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(input.path(), measurements().concat()).unwrap();
    let output = Command::new(target)
        .stdin(input.reopen().unwrap())
        .output()
        .unwrap();
    Some(output.stdout)
}

fn firmware(settings: &Settings) -> Vec<u8> {
    let mut emulator = Emulator::start(settings).unwrap();
    let mut answers = frame(&mut emulator);
    for measurement in measurements() {
        emulator.line().write_all(&measurement).unwrap();
        answers.extend(frame(&mut emulator));
    }
    answers
}

#[test]
fn both_boards_answer_as_the_host_does() {
    let host = host().unwrap();
    assert!(host.len() > 90 * 80, "{} bytes", host.len());
    for board in Board::ALL {
        let Some(settings) = settings(board) else {
            return;
        };
        let firmware = firmware(&settings);
        let first = host
            .iter()
            .zip(&firmware)
            .position(|(one, other)| one != other);
        assert!(
            host == firmware,
            "{board:?}: first difference at byte {first:?}"
        );
    }
}

#[test]
fn a_key_is_laid_into_the_reference_boards_flash() {
    let Some(mut settings) = settings(Board::L475) else {
        return;
    };
    let key: Vec<u8> = (1..=64).collect();
    settings.preloads.push((0x080F_F800, key.clone()));
    let mut emulator = Emulator::start(&settings).unwrap();
    frame(&mut emulator);
    assert_eq!(emulator.memory(0x080F_F800, 64).unwrap(), key);
    emulator.reset().unwrap();
    frame(&mut emulator);
    assert_eq!(emulator.memory(0x080F_F800, 64).unwrap(), key);
}

#[test]
fn the_test_boards_flash_outlives_the_emulator() {
    let Some(mut settings) = settings(Board::Mps2) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let flash = FlashFile::erased(&folder.path().join("flash")).unwrap();
    flash.put_records(8, &[1, 2, 3]).unwrap();
    flash.put_key(&[9; 64]).unwrap();
    settings.flash = Some(flash.clone());
    for _ in 0..2 {
        let mut emulator = Emulator::start(&settings).unwrap();
        frame(&mut emulator);
        assert_eq!(emulator.memory(0x2100_0008, 3).unwrap(), [1, 2, 3]);
        assert_eq!(emulator.memory(0x2100_F800, 64).unwrap(), [9; 64]);
    }
    assert_eq!(
        flash.records().unwrap()[..12],
        [255, 255, 255, 255, 255, 255, 255, 255, 1, 2, 3, 255]
    );
}

#[test]
fn an_emulator_that_ends_at_once_says_why() {
    let Some(mut settings) = settings(Board::L475) else {
        return;
    };
    settings.image = "no-such-image".into();
    let Err(error) = Emulator::start(&settings) else {
        panic!("started without an image")
    };
    assert!(error.to_string().contains("no-such-image"), "{error}");
}
