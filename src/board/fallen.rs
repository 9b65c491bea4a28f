//! The firmware fell: write down why, then reset. The next boot says so in its status.

use super::{kept_ram, painted_stack};
use core::arch::naked_asm;
use core::panic::PanicInfo;
// The transport of the log: a ring in RAM that a probe reads.
use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};
use defmt_rtt as _;
use rundown_wire::Failure;

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    let failure = match info.location() {
        Some(place) => Failure::panic(without_detour(place.file()), place.line()),
        None => Failure::panic("", 0),
    };
    kept_ram::write_down(failure);
    SCB::sys_reset()
}

/// `src/bin/firmware/../../board/l475.rs` is `board/l475.rs`: 24 bytes are kept, too few for the way there.
fn without_detour(path: &str) -> &str {
    let detour = path.as_bytes().windows(3).rposition(|part| part == b"../");
    detour.and_then(|at| path.get(at + 3..)).unwrap_or(path)
}

/// Takes the stack from its top again, because there may be none left, then goes on in [`fault`].
// SAFETY: the vector table's entry for the fault. The frame is where the stack pointer points at entry; nothing
// returns, so what lay on the stack is not needed.
#[unsafe(naked)]
#[unsafe(export_name = "HardFault")]
#[unsafe(link_section = ".HardFault.rundown")]
unsafe extern "C" fn hard_fault() -> ! {
    naked_asm!(
        "mrs r0, MSP",
        "ldr r1, =_stack_start",
        "mov sp, r1",
        "b {fault}",
        fault = sym fault
    )
}

extern "C" fn fault(frame: *const ExceptionFrame) -> ! {
    let failure = if painted_stack::holds(frame.cast()) {
        // SAFETY: the processor has put its frame there, within the stack; the words that were just pushed lie at its
        // other end.
        Failure::Fault { at: unsafe { (*frame).pc() } }
    } else {
        Failure::StackOverflow
    };
    kept_ram::write_down(failure);
    SCB::sys_reset()
}

// SAFETY: touches the kept RAM only, in the way of `kept_ram`, and does not return. An interrupt that nobody bound; its
// number takes the place of the address.
#[exception]
unsafe fn DefaultHandler(number: i16) {
    kept_ram::write_down(Failure::Fault { at: number.unsigned_abs().into() });
    SCB::sys_reset()
}
