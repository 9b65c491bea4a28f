//! Does the firmware get up again, and does it say why it fell? On the test board, whose watchdog bites.

mod common;

use common::{frame, wait_for};
use emulator::{Board, Emulator, FlashFile, Image, Provoke, Settings};
use rundown::onboard::crash_loop::{MOST_RESETS, Operation};
use rundown::onboard::kept::Kept;
use rundown::onboard::watchdog::Stalled;
use rundown_wire::Failure;

/// Starts the firmware, provokes it once it is ready, and waits until it has fallen so many times.
fn after(what: Provoke, falls: u32) -> Kept {
    let folder = tempfile::tempdir().unwrap();
    let flash = FlashFile::erased(&folder.path().join("flash")).unwrap();
    let settings = Settings { flash: Some(flash.clone()), ..Settings::new(Board::Mps2).unwrap() };
    let image = Image::read(&settings.image).unwrap();
    let mut emulator = Emulator::start(&settings).unwrap();
    frame(&mut emulator);
    flash.provoke(what, falls > 1).unwrap();
    let kept = wait_for(&mut emulator, &image, |kept| kept.crash_loop.resets() == falls);
    // It is up again, or says at least that it lives.
    frame(&mut emulator);
    kept
}

#[test]
#[ignore = "needs the firmware and its emulator: cargo xtask test"]
fn a_tick_task_that_hangs_is_bitten_and_named() {
    let kept = after(Provoke::TickHangs, 1);
    // The link task has the same priority, so it hangs too.
    let Failure::Stalled(who) = kept.last else { panic!("{kept:?}") };
    assert!(who.tick, "{kept:?}");
    assert_eq!(kept.crash_loop.operation(), Operation::Normal);
}

#[test]
#[ignore = "needs the firmware and its emulator: cargo xtask test"]
fn a_link_task_that_hangs_is_bitten_and_named() {
    let kept = after(Provoke::LinkHangs, 1);
    let stalled = Stalled { tick: true, link: true };
    let link_only = Stalled { tick: false, ..stalled };
    assert!([stalled, link_only].map(Failure::Stalled).contains(&kept.last), "{kept:?}");
}

#[test]
#[ignore = "needs the firmware and its emulator: cargo xtask test"]
fn a_panic_is_reported_with_its_line() {
    let kept = after(Provoke::Panic, 1);
    assert_eq!(kept.last.file(), "board/mps2.rs");
}

#[test]
#[ignore = "needs the firmware and its emulator: cargo xtask test"]
fn a_stack_overflow_is_distinguished_from_other_faults() {
    let kept = after(Provoke::StackOverflow, 1);
    assert_eq!(kept.last, Failure::StackOverflow);
}

#[test]
#[ignore = "needs the firmware and its emulator: cargo xtask test"]
fn a_fault_is_reported_with_its_address() {
    let kept = after(Provoke::Fault, 1);
    let Failure::Fault { at } = kept.last else { panic!("{kept:?}") };
    let image = Image::read(&Board::Mps2.image_path()).unwrap();
    let code = image.code.0..image.code.0 + image.code.1.len() as u64;
    assert!(code.contains(&u64::from(at)), "{at:#x} is not within {code:x?}");
}

#[test]
#[ignore = "needs the firmware and its emulator: cargo xtask test"]
fn three_falls_leave_heartbeats_only() {
    let kept = after(Provoke::Panic, MOST_RESETS as u32);
    assert_eq!(kept.crash_loop.operation(), Operation::HeartbeatOnly);
}
