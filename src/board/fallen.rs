//! The firmware fell: write down why, then reset. The next boot says so in its status.

use super::kept_ram;
use core::panic::PanicInfo;
// The transport of the log: a ring in RAM that a probe reads.
use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};
use defmt_rtt as _;
use rundown_wire::Failure;

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    let failure = match info.location() {
        Some(place) => Failure::panic(place.file(), place.line()),
        None => Failure::panic("", 0),
    };
    kept_ram::write_down(failure);
    SCB::sys_reset()
}

// SAFETY: touches the kept RAM only, in the way of `kept_ram`, and does not return. A stack overflow does not come here (there is no stack left): the
// processor locks up, and the watchdog ends that.
#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    kept_ram::write_down(Failure::Fault { at: frame.pc() });
    SCB::sys_reset()
}

// SAFETY: as above. An interrupt that nobody bound; its number takes the place of the address.
#[exception]
unsafe fn DefaultHandler(number: i16) {
    kept_ram::write_down(Failure::Fault {
        at: number.unsigned_abs().into(),
    });
    SCB::sys_reset()
}
