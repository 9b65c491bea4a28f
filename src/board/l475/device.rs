//! Registers of the STM32L475 from its access crate; interrupts, as far as they are used, from RM0351 table 58: the
//! crate lacks those of the CAN controller.

use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;
pub use stm32l4::stm32l4x5::*;

/// The name under which RTIC looks for them.
pub use self::Interrupt as interrupt;

/// Priority bits of its interrupt controller.
pub const NVIC_PRIO_BITS: u8 = 4;

/// Switches interrupts on with the serial line's priority, 3 of RTIC: what they count together none interrupts in
/// another.
///
/// # Safety
/// Their handlers share nothing with tasks of other priorities but atomics, queues and what RTIC locks for that
/// priority.
pub unsafe fn unmask_as_line<const N: usize>(nvic: &mut NVIC, interrupts: [Interrupt; N]) {
    const PRIORITY: u8 = ((1 << NVIC_PRIO_BITS) - 3) << (8 - NVIC_PRIO_BITS);
    for interrupt in interrupts {
        // SAFETY: as above.
        unsafe {
            nvic.set_priority(interrupt, PRIORITY);
            NVIC::unmask(interrupt);
        }
    }
}

/// Names of the manual.
#[derive(Clone, Copy)]
#[expect(non_camel_case_types, reason = "as the peripheral access crates do")]
#[expect(clippy::upper_case_acronyms, reason = "as the peripheral access crates do")]
pub enum Interrupt {
    /// What waited on the serial line has gone.
    DMA1_CH4 = 14,
    /// Half of what may come over the serial line is there, or all.
    DMA1_CH5 = 15,
    /// A transmit mailbox became free.
    #[cfg(feature = "can")]
    CAN1_TX = 19,
    /// A frame came, or was lost.
    #[cfg(feature = "can")]
    CAN1_RX0 = 20,
    /// Bus-off.
    #[cfg(feature = "can")]
    CAN1_SCE = 22,
    /// The serial line.
    USART1 = 37,
    /// Not used by its device; wakes the tick task.
    COMP = 64,
    /// Not used by its device; wakes the link task.
    TSC = 77,
}

// SAFETY: the numbers are those of the vector table below.
unsafe impl InterruptNumber for Interrupt {
    fn number(self) -> u16 {
        self as u16
    }
}

unsafe extern "C" {
    #[cfg(feature = "can")]
    fn CAN1_TX();
    #[cfg(feature = "can")]
    fn CAN1_RX0();
    #[cfg(feature = "can")]
    fn CAN1_SCE();
    fn USART1();
    fn COMP();
    fn TSC();
    fn DefaultHandler();
}

/// As many as the chip has.
const VECTORS: usize = 82;

#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [unsafe extern "C" fn(); VECTORS] = {
    let mut vectors = [DefaultHandler as unsafe extern "C" fn(); VECTORS];
    #[cfg(feature = "can")]
    {
        vectors[Interrupt::CAN1_TX as usize] = CAN1_TX;
        vectors[Interrupt::CAN1_RX0 as usize] = CAN1_RX0;
        vectors[Interrupt::CAN1_SCE as usize] = CAN1_SCE;
    }
    vectors[Interrupt::USART1 as usize] = USART1;
    // One task serves the line, whoever calls it: the port looks at all flags.
    vectors[Interrupt::DMA1_CH4 as usize] = USART1;
    vectors[Interrupt::DMA1_CH5 as usize] = USART1;
    vectors[Interrupt::COMP as usize] = COMP;
    vectors[Interrupt::TSC as usize] = TSC;
    vectors
};
