//! Registers and pages of the flash; the sequence is in `rundown::onboard::stm32l4_flash`.

use super::device::FLASH;
use super::{L475, RECORDS_ARE_READ};
use core::sync::atomic::{Ordering, compiler_fence};
use rundown::onboard::board::Board;
use rundown::onboard::stm32l4_flash::{FlashController, FlashRegister, PAGE, Stm32l4Flash};

/// Pages for records; `memory.x` has the same.
const PAGES: u32 = 8;
/// Where bank 2 begins.
const BANK_2: u32 = 0x0808_0000;

unsafe extern "C" {
    /// First byte of the records; the linker's symbol, its address is the value.
    static _records: u8;
}

pub type Flash = Stm32l4Flash<Controller>;

/// The flash controller and the pages for records.
pub struct Controller(pub FLASH);

impl Controller {
    fn base() -> *mut u8 {
        (&raw const _records).cast_mut()
    }
}

impl FlashController for Controller {
    const CAPACITY: usize = (PAGE * PAGES) as usize;

    fn register(&mut self, register: FlashRegister) -> u32 {
        match register {
            FlashRegister::Access => self.0.acr().read().bits(),
            // It reads zero.
            FlashRegister::Key => 0,
            FlashRegister::Status => self.0.sr().read().bits(),
            FlashRegister::Control => self.0.cr().read().bits(),
        }
    }

    fn set_register(&mut self, register: FlashRegister, bits: u32) {
        // SAFETY: caches, keys, flags, and pages for records only: the sequence takes its page numbers from
        // `first_page` and `CAPACITY`.
        unsafe {
            match register {
                FlashRegister::Access => drop(self.0.acr().write(|w| w.bits(bits))),
                FlashRegister::Key => drop(self.0.keyr().write(|w| w.bits(bits))),
                FlashRegister::Status => drop(self.0.sr().write(|w| w.bits(bits))),
                FlashRegister::Control => drop(self.0.cr().write(|w| w.bits(bits))),
            }
        }
    }

    fn program(&mut self, offset: u32, [low, high]: [u32; 2]) {
        // SAFETY: within the records and aligned, which the sequence has checked.
        unsafe {
            let to = Self::base().add(offset as usize).cast::<u32>();
            to.write_volatile(low);
            // Two steps in this order, both done before the status is read.
            cortex_m::asm::isb();
            to.add(1).write_volatile(high);
        }
        cortex_m::asm::dsb();
    }

    fn byte(&mut self, offset: u32) -> u8 {
        RECORDS_ARE_READ.store(true, Ordering::Relaxed);
        compiler_fence(Ordering::SeqCst);
        // SAFETY: within the records, which the sequence has checked; volatile, because the controller changes it.
        let byte = unsafe { Self::base().add(offset as usize).read_volatile() };
        // An error is reported before the flag falls.
        cortex_m::asm::dsb();
        RECORDS_ARE_READ.store(false, Ordering::Relaxed);
        byte
    }

    fn first_page(&self) -> u32 {
        (Self::base() as u32 - BANK_2) / PAGE
    }

    fn double_bit_errors(&self) -> u32 {
        L475::flash_errors()
    }
}
