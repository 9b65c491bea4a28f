//! Is it the same code? The firmware in the emulator and the task on the host, fed with the same logs, say the same bytes.

use host_tests::accuracy::description;
use host_tests::scenario::Scenario;
use host_tests::target::{compare, firmware};
use rundown::config::Config;
use rundown::track::Direction;

#[test]
fn simulated_runs_give_the_same_bytes() {
    let Some(settings) = firmware() else { return };
    let scenario = Scenario::default();
    let log = host_tests::accuracy::measurements(&host_tests::scenario::simulate(&scenario, 3));
    let description = description(Config::default(), &scenario);
    let same = compare(&settings, &description, Direction::Up, &log).unwrap();
    println!(
        "{} ticks, {} frames, {} bytes\n{:?}",
        same.ticks, same.frames, same.line_bytes, same.health
    );
    assert_eq!(same.ticks, log.len());
}
