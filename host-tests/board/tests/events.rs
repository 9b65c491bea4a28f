//! Does the board's log say what happened? The same events that the firmware writes to the debugger.

use board_tests::board::{Board, described, running};
use board_tests::flash::{CutMode, Flash};
use board_tests::prelude::*;
use board_tests::said;
use rundown::onboard::event::{Event, WAITING};
use rundown::onboard::kept::Kept;
use rundown_wire::{Failure, Memory, Refusal, ResetCause, Stalled};

#[test]
fn a_run_is_logged_from_its_begin_to_its_record_and_the_next_start_finds_it() {
    let (mut board, description, log) = running(described());
    for measurement in &log {
        board.measure(measurement);
    }
    let summary = said!(board.end(), RunSummary).expect("a summary");
    let [vehicle, begins, learned, kept] = board.log[..] else { panic!("{:?}", board.log) };
    assert_eq!((vehicle, begins, kept), (Event::Vehicle(Memory::Empty), Event::RunBegins, Event::Kept(1)));
    let Event::Learned { learned_s, r_n_per_kg, sd_n_per_kg } = learned else { panic!("{learned:?}") };
    assert_eq!(learned_s, summary.learned_s);
    let [r0, r1, r2] = summary.vehicle_davis.map(|value| f64::from(value.value));
    let v = 100.0 / 3.6;
    let expected = r0 + v * (r1 + v * r2);
    assert!((f64::from(r_n_per_kg) - expected).abs() < 1e-6 * expected, "{r_n_per_kg} for {expected}");
    assert!(sd_n_per_kg > 0.0 && sd_n_per_kg < 0.1 * r_n_per_kg);
    assert!(!learned.is_trouble());

    let mut board = board.restart();
    board.prepare(&description, Direction::Up);
    assert_eq!(board.log, [Event::Vehicle(Memory::Restored), Event::RunBegins]);
}

#[test]
fn refusals_and_a_flash_that_takes_nothing_are_trouble() {
    let (mut board, ..) = running(described());
    board.log.clear();
    board.say(&[0xFF, 0, 1, 2]);
    assert_eq!(board.log, [Event::Refused(Refusal::Version)]);
    assert!(board.log[0].is_trouble());

    // The power of the flash goes after the epoch of the start is written.
    let start = Board::start(Flash::erased(8)).task.release().expect("a store").operations;
    let mut flash = Flash::erased(8);
    flash.cut_before(start, CutMode::NotDone, 0);
    let mut board = Board::start(flash);
    board.prepare(&described().0, Direction::Up);
    board.end();
    assert_eq!(board.log.last(), Some(&Event::NotKept), "{:?}", board.log);
    let status = board.status();
    assert_eq!((status.records, status.memory), ([0, 1], Memory::ReadOnly));
    assert!(Event::NotKept.is_trouble());
}

#[test]
fn what_nobody_reads_is_dropped_and_the_board_goes_on() {
    let mut board = Board::start(Flash::erased(8));
    for message in 0..2 * WAITING as u8 {
        board.task.receive(&[0xFF, 0, message], &mut board.wire);
    }
    let told: Vec<Event> = std::iter::from_fn(|| board.task.next_event()).collect();
    assert_eq!(told, [Event::Refused(Refusal::Version); WAITING]);
}

#[test]
fn a_crystal_that_does_not_come_is_trouble() {
    assert!(Event::CrystalMissed.is_trouble());
    assert!(Event::CrystalMissed.to_string().contains("crystal does not run"));
}

#[test]
fn a_start_says_why_and_what_was_before() {
    let stalled = Failure::Stalled(Stalled { tick: true, link: false });
    let before = Kept { failure: stalled, ..Kept::default() };
    let (_, boot) = Kept::boot(Some(before), ResetCause::Watchdog);
    let event = Event::boot(&boot, 80_000_000);
    assert!(event.is_trouble());
    let said = event.to_string();
    assert!(said.starts_with("boot: watchdog, 1 crashes since power-on, clock 80000000 Hz"), "{said}");
    assert!(said.contains("tick: true"), "{said}");
    let (_, boot) = Kept::boot(None, ResetCause::PowerOn);
    assert!(!Event::boot(&boot, 4_000_000).is_trouble());
}
