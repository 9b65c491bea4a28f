//! Interrupts of AN386, as far as they are used.

use cortex_m::interrupt::InterruptNumber;

/// The name under which RTIC looks for them.
pub use self::Interrupt as interrupt;

/// Priority bits of its interrupt controller.
pub const NVIC_PRIO_BITS: u8 = 3;

/// Names as on the reference board.
#[derive(Clone, Copy)]
#[expect(non_camel_case_types, clippy::upper_case_acronyms, reason = "as the peripheral access crates do")]
pub enum Interrupt {
    /// UART 0, a byte came.
    USART1 = 0,
    /// UART 0, a byte went.
    USART1_TX = 1,
    /// Not connected to anything here; wakes the tick task.
    COMP = 30,
    /// Not connected to anything here; wakes the link task.
    TSC = 31,
}

// SAFETY: the numbers are those of the vector table below.
unsafe impl InterruptNumber for Interrupt {
    fn number(self) -> u16 {
        self as u16
    }
}

unsafe extern "C" {
    fn USART1();
    fn COMP();
    fn TSC();
    fn DefaultHandler();
}

/// Both directions of the line go to one task.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [unsafe extern "C" fn(); 32] = {
    let mut vectors = [DefaultHandler as unsafe extern "C" fn(); 32];
    vectors[Interrupt::USART1 as usize] = USART1;
    vectors[Interrupt::USART1_TX as usize] = USART1;
    vectors[Interrupt::COMP as usize] = COMP;
    vectors[Interrupt::TSC as usize] = TSC;
    vectors
};
