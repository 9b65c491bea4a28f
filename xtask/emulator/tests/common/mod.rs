//! What the tests with the emulator share.

use emulator::{Emulator, Image};
use rundown::onboard::kept::{Kept, WORDS};
use std::io::Read;
use std::time::{Duration, Instant};

/// Reads until the end of a frame.
pub fn frame(emulator: &mut Emulator) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut byte = [1];
    while byte != [0] {
        emulator.line().read_exact(&mut byte).expect("a frame within 10 s");
        bytes.extend(byte);
    }
    bytes
}

/// What the firmware keeps over resets.
pub fn kept(emulator: &mut Emulator, image: &Image) -> Option<Kept> {
    let address = image.address("KEPT").unwrap();
    let bytes = emulator.memory(address, 4 * WORDS as u64).unwrap();
    let mut words = [0; WORDS];
    for (word, bytes) in words.iter_mut().zip(bytes.chunks_exact(4)) {
        *word = u32::from_le_bytes(bytes.try_into().unwrap());
    }
    Kept::from_words(&words)
}

/// Waits for what is kept to become so, at most 5 min: alone a watchdog of the emulator bites after half a minute, on a
/// busy machine after more than one.
pub fn wait_for(emulator: &mut Emulator, image: &Image, so: impl Fn(&Kept) -> bool) -> Kept {
    let begin = Instant::now();
    loop {
        let kept = kept(emulator, image);
        if let Some(kept) = kept.filter(&so) {
            return kept;
        }
        assert!(begin.elapsed() < Duration::from_secs(300), "kept: {kept:?}");
        std::thread::sleep(Duration::from_millis(20));
    }
}
