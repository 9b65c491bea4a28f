//! The 32 kHz crystal (LSE), which trims the internal oscillator (RM0351 6.2.3): alone it is good to some per cent, too
//! little for a serial line and for CAN. It runs up to two seconds after power came; a board without it keeps the
//! oscillator as it is.

use super::device::{PWR, RCC};
use rundown::onboard::clock::{Crystal, start_crystal};

/// Its switch, in the backup domain.
struct Lse<'a> {
    rcc: &'a RCC,
    power: &'a PWR,
}

impl Crystal for Lse<'_> {
    fn unprotect(&mut self) {
        self.rcc.apb1enr1().modify(|_, w| w.pwren().set_bit());
        // The reference manual wants a moment between the enable and the first access; a read makes it.
        let _ = self.rcc.apb1enr1().read();
        self.power.cr1().modify(|_, w| w.dbp().set_bit());
    }

    fn is_unprotected(&self) -> bool {
        self.power.cr1().read().dbp().bit()
    }

    fn switch_on(&mut self) {
        self.rcc.bdcr().modify(|_, w| w.lseon().set_bit());
    }

    fn is_on(&self) -> bool {
        self.rcc.bdcr().read().lseon().bit()
    }
}

/// Starts it.
pub fn start(rcc: &RCC, power: &PWR) {
    if start_crystal(&mut Lse { rcc, power }).is_none() {
        defmt::warn!("the crystal is not switched on: the oscillator is not trimmed");
    }
}

/// Lets it trim the oscillator once it runs, and says whether it does. To be called now and then, from one task.
pub fn trim() -> bool {
    // SAFETY: after the start nothing else touches the clocks.
    let rcc = unsafe { &*RCC::ptr() };
    let runs = rcc.bdcr().read().lserdy().bit();
    if runs && rcc.cr().read().msipllen().bit_is_clear() {
        rcc.cr().modify(|_, w| w.msipllen().set_bit());
    }
    runs
}
