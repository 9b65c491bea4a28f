//! Any messages to the task, validly signed ones among them, with ticks in between: no panic, and nothing is said that
//! is no number.
#![no_main]

use host_tests::board::{PROVISIONING, Wire};
use host_tests::flash::Flash;
use libfuzzer_sys::fuzz_target;
use rundown::estimator::run_state::RunState;
use rundown::onboard::task::{Room, Task};
use rundown::uplink::{self, OPEN};
use rundown_fuzz::{Conversation, Step};
use rundown_wire::MAX_MESSAGE;

fuzz_target!(|data: &[u8]| {
    round_trip(data);
    let (mut run, mut room) = (Box::new(RunState::idle()), Box::new(Room::EMPTY));
    let mut task = Task::new(Ok(PROVISIONING), Flash::erased(4), false, &mut run, &mut room);
    let mut wire = Wire::default();
    let mut conversation = Conversation::new(data);
    while let Some(step) = conversation.next_step() {
        match step {
            Step::Tick => task.tick(&mut wire),
            Step::Deaf(deaf) => wire.room = deaf.then_some(0),
            Step::Message(message) | Step::Noise(message) => task.receive(&message, &mut wire),
        }
        for message in wire.messages.drain(..) {
            conversation.hear(&message);
        }
    }
    let flash = task.release().expect("a store");
    assert_eq!(flash.violations, 0, "a word was programmed twice");
});

/// What can be read is written and read again as the same bytes.
fn round_trip(payload: &[u8]) {
    let Some(first) = uplink::decode(payload) else {
        return;
    };
    let (mut one, mut two) = ([0; MAX_MESSAGE], [0; MAX_MESSAGE]);
    let Ok(bytes) = uplink::encode(&first, OPEN, &mut one) else {
        return;
    };
    let second = uplink::decode(&bytes[2..]).expect("own bytes are read");
    assert_eq!(uplink::encode(&second, OPEN, &mut two), Ok(bytes));
}
