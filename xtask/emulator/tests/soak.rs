//! Does it run on by itself? Hours of virtual time without input.

mod common;

use common::{frame, wait_for};
use emulator::{Board, Emulator, Image, Settings, Sleep};
use rundown_wire::Failure;

/// Two hours on all boards: the watchdog of the test board would have bitten 3600 times.
#[test]
#[ignore = "needs the firmware and its emulator: cargo xtask test"]
fn two_quiet_hours_pass_without_a_reset() {
    for board in Board::ALL {
        let settings = Settings { sleep: Sleep::Jumps, ..Settings::new(board).unwrap() };
        let image = Image::read(&settings.image).unwrap();
        let mut emulator = Emulator::start(&settings).unwrap();
        frame(&mut emulator);
        let kept =
            wait_for(&mut emulator, &image, |kept| kept.crash_loop.clock_s() >= 7200 || kept.crash_loop.resets() > 0);
        assert_eq!(kept.crash_loop.resets(), 0, "{board:?}: {kept:?}");
        assert_eq!(kept.failure, Failure::None, "{board:?}");
    }
}
