//! The firmware's application from the bytes of the serial line on: no panic, and all it says is a frame with numbers
//! in it.
#![no_main]

use host_tests::board::PROVISIONING;
use host_tests::flash::Flash;
use libfuzzer_sys::fuzz_target;
use rundown::estimator::run_state::RunState;
use rundown::onboard::application::Application;
use rundown::onboard::task::Room;
use rundown_fuzz::{Conversation, Step};
use rundown_wire::Health;
use rundown_wire::link::serial::{Decoder, encode};

fuzz_target!(|data: &[u8]| {
    let (mut run, mut room) = (Box::new(RunState::idle()), Box::new(Room::EMPTY));
    let mut application = Application::new(Ok(PROVISIONING), Flash::erased(4), false, &mut run, &mut room);
    let mut conversation = Conversation::new(data);
    let (mut said, mut deaf) = (Vec::new(), false);
    let mut decoder: Decoder = Decoder::new();
    while let Some(step) = conversation.next_step() {
        let mut send = |frame: &[u8], _| {
            if !deaf {
                said.extend_from_slice(frame);
            }
            !deaf
        };
        let line = match step {
            Step::Tick => {
                application.tick(Health::default, &mut send);
                while application.is_busy() {
                    application.go_on(Health::default, &mut send);
                }
                Vec::new()
            }
            Step::Deaf(now) => {
                deaf = now;
                Vec::new()
            }
            Step::Message(message) => encode(&message).map(|frame| frame.to_vec()).unwrap_or(message),
            Step::Noise(noise) => noise,
        };
        let mut send = |frame: &[u8], _| {
            if !deaf {
                said.extend_from_slice(frame);
            }
            !deaf
        };
        for byte in line {
            application.receive_byte(byte, Health::default, &mut send);
            while application.is_busy() {
                application.go_on(Health::default, &mut send);
            }
        }
        for byte in said.drain(..) {
            if let Some(message) = decoder.push(byte).expect("the board's line is clean") {
                conversation.hear(message);
            }
        }
    }
});
