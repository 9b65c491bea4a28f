//! RCC and the flash's wait states, as steps of `rundown::onboard::clock`.

use super::device::{FLASH, RCC};
use rundown::onboard::clock::{ClockTree, bounded};

/// Wait states for 80 MHz in voltage range 1, the range after reset.
const WAIT_STATES: u8 = 4;
/// Values of `SW` and `SWS`: internal oscillator, PLL.
const MSI: u8 = 0;
const PLL: u8 = 3;

pub struct Tree<'a> {
    pub rcc: &'a RCC,
    pub flash: &'a FLASH,
}

impl Tree<'_> {
    /// The flash's control register is locked after reset, on every chip. The emulator has no flash controller, its
    /// registers read zero, and its memory has no wait states to set.
    fn flash_has_a_controller(&self) -> bool {
        self.flash.cr().read().bits() != 0
    }
}

impl ClockTree for Tree<'_> {
    fn start_pll(&mut self) {
        self.rcc.cr().modify(|_, w| w.pllon().clear_bit());
        // MSI 4 MHz / 1 * 40 / 2 = 80 MHz.
        self.rcc.pllcfgr().write(|w| {
            // SAFETY: source MSI, M = 1, N = 40, R = 2: all within the reference manual's ranges (VCO 160 MHz of 64 to
            // 344).
            unsafe { w.pllsrc().bits(1).pllm().bits(0).plln().bits(40).pllr().bits(0) };
            w.pllren().set_bit()
        });
        self.rcc.cr().modify(|_, w| w.pllon().set_bit());
    }

    fn pll_ready(&self) -> bool {
        self.rcc.cr().read().pllrdy().bit()
    }

    fn set_wait_states(&mut self) {
        // SAFETY: four of the five that exist.
        self.flash.acr().modify(|_, w| unsafe { w.latency().bits(WAIT_STATES) });
    }

    fn wait_states_ready(&self) -> bool {
        !self.flash_has_a_controller() || self.flash.acr().read().latency().bits() == WAIT_STATES
    }

    fn select_pll(&mut self) {
        // SAFETY: one of the four sources.
        self.rcc.cfgr().modify(|_, w| unsafe { w.sw().bits(PLL) });
    }

    fn pll_selected(&self) -> bool {
        self.rcc.cfgr().read().sws().bits() == PLL
    }

    fn back_to_slow(&mut self) {
        // SAFETY: one of the four sources.
        self.rcc.cfgr().modify(|_, w| unsafe { w.sw().bits(MSI) });
        // How long the flash may take is judged by its wait states, which the slow clock needs none of.
        if bounded(|| self.rcc.cfgr().read().sws().bits() == MSI).is_some() {
            // SAFETY: no wait state is one of the five that exist.
            self.flash.acr().modify(|_, w| unsafe { w.latency().bits(0) });
        }
        self.rcc.cr().modify(|_, w| w.pllon().clear_bit());
    }
}
