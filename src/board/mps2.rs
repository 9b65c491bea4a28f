//! Arm MPS2 with AN386 (Cortex-M4F, 25 MHz), test-only: in the emulator its watchdog bites, and its PSRAM, kept in a
//! file, plays the flash over a loss of power.
//!
//! The interrupts bear the reference board's names, so that both boards run the same
//! `src/bin/firmware/tasks.rs`.

pub mod device;
mod serial;

use super::ram_flash::{self, Flash};
use super::stopwatch;
use core::hint;
use cortex_m::peripheral::NVIC;
use cortex_m_rt::exception;
use device::Interrupt;
use rundown::onboard::board::{Board, FailurePoint, Started};
use rundown::onboard::clock::Clock;
use rundown::onboard::watchdog::Watchdog;
use rundown_wire::ResetCause;
use serial::SerialPort;

const CLOCK_HZ: u32 = 25_000_000;

/// As the reference board, without a clock tree. There is no reset register either: a reset that kept the RAM counts as
/// the watchdog's.
pub struct Mps2;

impl Board for Mps2 {
    type Core = cortex_m::Peripherals;
    type Port = SerialPort;
    type Watchdog = DogTimer;
    type Flash = Flash;

    fn start(mut core: cortex_m::Peripherals) -> Option<Started<Self>> {
        stopwatch::start(&mut core.SYST, CLOCK_HZ);
        // The line has an interrupt for each direction; RTIC sets up the one that it knows.
        // SAFETY: the priority of `line`, before any interrupt is enabled.
        unsafe {
            core.NVIC.set_priority(Interrupt::USART1_TX, rtic::export::cortex_logical2hw(3, device::NVIC_PRIO_BITS));
            NVIC::unmask(Interrupt::USART1_TX);
        }
        Some(Started {
            port: SerialPort::start(),
            watchdog: DogTimer::start(),
            flash: ram_flash::start(),
            clock: Clock::Fast,
            cause: ResetCause::Watchdog,
        })
    }

    /// Fails as the test wants it: 1 the tick task hangs, 2 the link task hangs, 3 panic, 4 endless recursion, 5
    /// undefined instruction. Once, unless 0x100 is added.
    fn provoke(point: FailurePoint) {
        let word = &raw mut _provoke;
        // SAFETY: a word of the PSRAM that nothing else uses; volatile, because the test changes it.
        let wish = unsafe { word.read_volatile() };
        let here = match point {
            FailurePoint::Link => wish & 0xFF == 2,
            FailurePoint::Tick => matches!(wish & 0xFF, 1 | 3 | 4 | 5),
        };
        if !here {
            return;
        }
        if wish & 0x100 == 0 {
            // SAFETY: as above.
            unsafe { word.write_volatile(0) };
        }
        match wish & 0xFF {
            3 => panic!("on demand"),
            4 => {
                dig(0);
            }
            5 => cortex_m::asm::udf(),
            _ => loop {
                hint::spin_loop();
            },
        }
    }
}

/// The CMSDK watchdog: half of the time until its interrupt (NMI), the other half until the reset.
pub struct DogTimer;

const DOG: usize = 0x4000_8000;
const LOAD: *mut u32 = DOG as *mut u32;
const CONTROL: *mut u32 = (DOG + 0x8) as *mut u32;
const CLEAR: *mut u32 = (DOG + 0xC) as *mut u32;
const LOCK: *mut u32 = (DOG + 0xC00) as *mut u32;

impl DogTimer {
    fn start() -> Self {
        // SAFETY: registers of the watchdog, which nothing else touches. Key of the technical reference manual;
        // interrupt and reset enabled.
        unsafe {
            LOCK.write_volatile(0x1ACC_E551);
            LOAD.write_volatile(CLOCK_HZ);
            CONTROL.write_volatile(0b11);
        }
        Self
    }
}

impl Watchdog for DogTimer {
    fn feed(&mut self) {
        // SAFETY: register of the watchdog; any value reloads its counter.
        unsafe { CLEAR.write_volatile(1) };
    }
}

/// Half of the watchdog's time is over, and the timer has recorded why: waits for the reset.
// SAFETY: touches nothing.
#[exception]
unsafe fn NonMaskableInt() {
    loop {
        hint::spin_loop();
    }
}

unsafe extern "C" {
    /// What to do wrong, written by the test into the file behind the PSRAM; the linker's symbol.
    static mut _provoke: u32;
}

/// Uses up the stack.
#[expect(unconditional_recursion, reason = "that is what it is for")]
#[inline(never)]
fn dig(depth: u32) -> u32 {
    let space = hint::black_box([depth; 64]);
    dig(depth + 1) + space.iter().sum::<u32>()
}
