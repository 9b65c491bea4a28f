//! The 32 kHz crystal (LSE), which trims the internal oscillator (RM0351 6.2.3): alone it is good to some per cent, too little for a serial line
//! and for CAN. It runs up to two seconds after power came; a board without it keeps the oscillator as it is.

use super::device::{PWR, RCC};

/// Starts it; it stands behind the backup domain's write protection.
pub fn start(rcc: &RCC, power: &PWR) {
    rcc.apb1enr1().modify(|_, w| w.pwren().set_bit());
    // The reference manual wants a moment between the enable and the first access; a read makes it.
    let _ = rcc.apb1enr1().read();
    power.cr1().modify(|_, w| w.dbp().set_bit());
    rcc.bdcr().modify(|_, w| w.lseon().set_bit());
}

/// Lets it trim the oscillator once it runs. To be called now and then, from one task.
pub fn trim() {
    // SAFETY: after the start nothing else touches the clocks.
    let rcc = unsafe { &*RCC::ptr() };
    if rcc.bdcr().read().lserdy().bit() && rcc.cr().read().msipllen().bit_is_clear() {
        rcc.cr().modify(|_, w| w.msipllen().set_bit());
    }
}
