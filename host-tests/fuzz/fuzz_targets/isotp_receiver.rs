//! Any CAN frames at any time to both sides of ISO-TP: no panic, the payload stays within its buffer, and a payload
//! sent afterwards by the rules arrives as it was.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rundown_fuzz::Script;
use rundown_wire::link::MAX_CHECKED;
use rundown_wire::link::isotp::pdu::{Pdu, parse};
use rundown_wire::link::isotp::{Config, Receiver, Sender};

fuzz_target!(|data: &[u8]| {
    let mut script = Script(data);
    let config = if script.byte().is_multiple_of(2) { Config::CLASSIC } else { Config::FD };
    let mut receiver: Receiver<MAX_CHECKED> = Receiver::new(config);
    let mut sender: Sender<MAX_CHECKED> = Sender::new(config);
    let mut now_us = 0_u64;
    while !script.0.is_empty() {
        let length = usize::from(script.byte()) % 65;
        let bytes: [u8; 64] = script.array();
        // A quarter of the frames come after a silence of up to two seconds; now and then the clock is set back.
        now_us = match script.byte() {
            255 => 0,
            n if n.is_multiple_of(4) => now_us + u64::from(n) * 8000,
            n => now_us + u64::from(n),
        };
        let _silence = receiver.check_time(now_us);
        let _busy = sender.start(&bytes[..length]);
        if let Ok(Some(_)) = sender.next_frame(now_us) {
            sender.confirm(now_us);
        }
        if let Ok(pdu) = parse(&bytes[..length]) {
            if let Pdu::FlowControl(flow) = pdu {
                let _refused = sender.on_flow_control(flow, now_us);
            }
            let outcome = receiver.on_frame(pdu, length, now_us);
            assert!(receiver.payload().len() <= MAX_CHECKED);
            assert!(!(outcome.complete && receiver.payload().is_empty()));
        }
    }

    let payload: Vec<u8> = data.iter().copied().chain([1]).take(MAX_CHECKED).collect();
    let mut sender: Sender<MAX_CHECKED> = Sender::new(config);
    sender.start(&payload).expect("an idle sender takes a payload of this length");
    for _ in 0..200 {
        now_us += 1000;
        let Some(frame) = sender.next_frame(now_us).expect("answered in time") else {
            continue;
        };
        sender.confirm(now_us);
        let pdu = parse(&frame).expect("own frames can be read");
        let outcome = receiver.on_frame(pdu, frame.len(), now_us);
        if let Some(answer) = outcome.answer {
            sender.on_flow_control(answer, now_us).expect("a frank answer");
        }
        if outcome.complete {
            assert_eq!(receiver.payload(), payload);
            return;
        }
    }
    panic!("the payload did not arrive");
});
