//! ST B-L475E-IOT01A: STM32L475VG at 80 MHz, serial line on the debugger's USB port.
//!
//! | what | where |
//! |---|---|
//! | serial line | USART1, TX PB6, RX PB7, both AF7: the ST-LINK's virtual COM port; DMA1 channels 4 and 5, byte by byte where there is no DMA, as in the emulator |
//! | clock | MSI 4 MHz, trimmed by the 32 kHz crystal -> PLL 80 MHz; MSI alone if anything is late |
//! | CAN, feature `can` | CAN1, RX PB8, TX PB9, both AF9; a transceiver is not on the board |
//! | watchdog | IWDG on the LSI, 2 s, stands still while a debugger halts the core |

mod byte_serial;
#[cfg(feature = "can")]
pub mod can;
mod clock_tree;
mod crystal;
pub mod device;
mod dma_serial;
#[cfg(not(feature = "emulator"))]
mod flash;
mod serial;

#[cfg(feature = "emulator")]
use super::ram_flash::{self, Flash};
use super::{kept_ram, stopwatch};
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use cortex_m::peripheral::SCB;
use cortex_m_rt::exception;
use device::{IWDG, Peripherals};
#[cfg(not(feature = "emulator"))]
use flash::Flash;
use rundown::onboard::board::{Board, Started};
use rundown::onboard::clock::{self, bounded};
use rundown::onboard::flash::{PAGE, RECORDS};
use rundown::onboard::stm32l4_flash::{DoubleBitError, double_bit_error};
use rundown::onboard::watchdog::Watchdog;
use rundown_wire::{Failure, ResetCause};
use serial::SerialPort;

/// Time until the watchdog bites, in its counts of 2 ms (LSI 32 kHz / 64). The LSI is good to 10 %.
const BITE_COUNTS: u16 = 1000;

/// The board.
pub struct L475;

impl Board for L475 {
    type Core = cortex_m::Peripherals;
    type Port = SerialPort;
    type Watchdog = DogTimer;
    type Flash = Flash;

    fn start(mut core: cortex_m::Peripherals) -> Option<Started<Self>> {
        let chip = Peripherals::take()?;
        let cause = reset_cause(&chip.RCC);
        let clock = clock::start(&mut clock_tree::Tree { rcc: &chip.RCC, flash: &chip.FLASH });
        stopwatch::start(&mut core.SYST, clock.hz());
        crystal::start(&chip.RCC, &chip.PWR);
        let port = SerialPort::start(&chip.RCC, &chip.GPIOB, chip.USART1, chip.DMA1, &mut core.NVIC, clock.hz());
        // Stop the watchdog while the debugger has halted the core.
        chip.DBGMCU.apb1fzr1().modify(|_, w| w.dbg_iwdg_stop().set_bit());
        let watchdog = DogTimer::start(chip.IWDG);
        #[cfg(not(feature = "emulator"))]
        let flash = Flash::new(flash::Controller(chip.FLASH));
        #[cfg(feature = "emulator")]
        let flash = ram_flash::start();
        Some(Started { port, watchdog, flash, clock, cause })
    }

    fn trim_clock() -> bool {
        crystal::trim()
    }

    fn flash_errors() -> u32 {
        FLASH_ERRORS.load(Ordering::Relaxed)
    }
}

fn reset_cause(rcc: &device::RCC) -> ResetCause {
    let flags = rcc.csr().read();
    rcc.csr().modify(|_, w| w.rmvf().set_bit());
    // Several may be set: every internal reset drives the pin too.
    if flags.iwdgrstf().bit() || flags.wwdgrstf().bit() {
        ResetCause::Watchdog
    } else if flags.sftrstf().bit() {
        ResetCause::Software
    } else if flags.borrstf().bit() {
        ResetCause::PowerOn
    } else if flags.lpwrstf().bit() || flags.oblrstf().bit() || flags.firewallrstf().bit() {
        ResetCause::Other
    } else {
        ResetCause::Pin
    }
}

/// The independent watchdog.
pub struct DogTimer(IWDG);

impl DogTimer {
    fn start(iwdg: IWDG) -> Self {
        // Keys of the reference manual: start, then unlock; start first, because the registers need its clock.
        iwdg.kr().write(|w| unsafe { w.bits(0xCCCC) }); // SAFETY: a key, no memory.
        iwdg.kr().write(|w| unsafe { w.bits(0x5555) }); // SAFETY: a key, no memory.
        iwdg.pr().write(|w| unsafe { w.bits(4) }); // SAFETY: divider 64, one of the eight that exist.
        iwdg.rlr().write(|w| unsafe { w.bits(BITE_COUNTS) }); // SAFETY: below the field's 4095.
        // If this is late, the longest time (8 s at this divider) is in force: later, but it bites.
        let _ = bounded(|| iwdg.sr().read().bits() == 0);
        let mut watchdog = Self(iwdg);
        watchdog.feed();
        watchdog
    }
}

impl Watchdog for DogTimer {
    fn feed(&mut self) {
        self.0.kr().write(|w| unsafe { w.bits(0xAAAA) }); // SAFETY: a key, no memory.
    }
}

/// Only set while a byte of the records is read.
static RECORDS_ARE_READ: AtomicBool = AtomicBool::new(false);
/// Double-bit errors that the flash has reported.
static FLASH_ERRORS: AtomicU32 = AtomicU32::new(0);

unsafe extern "C" {
    /// First byte of the records, and of the key; the linker's symbols, their addresses are the values.
    static _records: u8;
    static _key: u8;
}

/// A word that was torn by a loss of power is reported as a double-bit error, by this interrupt, at every read of it.
/// In the records and the key it is cleared and counted, or the firmware would stay here for ever: the reader sees
/// wrong bytes, and a checksum refuses them. Anywhere else the program is damaged, and what it would do next nobody
/// knows.
// SAFETY: touches one register that nothing else uses, one atomic, and the kept RAM where it does not return.
#[exception]
unsafe fn NonMaskableInt() {
    // SAFETY: see above.
    let flash = unsafe { &*device::FLASH::ptr() };
    let pages = |first: *const u8, bytes: usize| first as u32..first as u32 + bytes as u32;
    let written = [pages(&raw const _records, RECORDS), pages(&raw const _key, PAGE)];
    match double_bit_error(flash.eccr().read().bits(), &written, RECORDS_ARE_READ.load(Ordering::Relaxed)) {
        DoubleBitError::Torn => {
            flash.eccr().modify(|_, w| w.eccd().set_bit());
            // Cleared before this ends, or it comes again at once.
            cortex_m::asm::dsb();
            let count = FLASH_ERRORS.load(Ordering::Relaxed).saturating_add(1);
            FLASH_ERRORS.store(count, Ordering::Relaxed);
        }
        DoubleBitError::Damage(at) => {
            kept_ram::write_down(Failure::Fault { at });
            SCB::sys_reset()
        }
    }
}
