//! RAM that plays the flash in the emulator, which has no flash controller: on the mps2-an386 a file holds it over the
//! loss of power, on the B-L475E-IOT01A it is lost.

use rundown::onboard::flash::{MemoryFlash, RECORDS};

unsafe extern "C" {
    /// The pages for records; the linker's symbol.
    static mut _records: [u8; RECORDS];
}

pub type Flash = MemoryFlash<&'static mut [u8; RECORDS]>;

/// To be called once.
pub fn start() -> Flash {
    let records = &raw mut _records;
    // SAFETY: so many bytes are reserved behind the symbol, and nothing else refers to them.
    MemoryFlash::new(unsafe { &mut *records })
}
