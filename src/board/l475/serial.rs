//! USART1, 8N1: its pins.

use super::device::{GPIOB, RCC};

/// Gives USART1 its clock and its pins: the debugger's virtual COM port.
pub fn pins(rcc: &RCC, pins: &GPIOB) {
    rcc.ahb2enr().modify(|_, w| w.gpioben().set_bit());
    rcc.apb2enr().modify(|_, w| w.usart1en().set_bit());
    // The reference manual wants a moment between the enable and the first access; a read makes it.
    let _ = rcc.apb2enr().read();
    // SAFETY: alternate function 7 and mode 2 (alternate) exist for both pins.
    pins.afrl().modify(|_, w| unsafe { w.afrl6().bits(7).afrl7().bits(7) });
    // SAFETY: as above.
    pins.moder().modify(|_, w| unsafe { w.moder6().bits(2).moder7().bits(2) });
}
