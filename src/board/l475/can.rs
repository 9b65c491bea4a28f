//! Registers, pins and interrupts of CAN1; the sequence is in `rundown::onboard::can::bxcan`.
//!
//! At 87.5 % two nodes may differ by 1 % in all (0.48 % each): until the crystal trims the oscillator (`crystal`), and
//! on a board without one, frames may be lost.

use super::super::CAN_BIT_S;
use super::device::{CAN1, Interrupt, Peripherals, unmask_as_line};
use core::cell::RefCell;
use cortex_m::interrupt::{self, Mutex};
use cortex_m::peripheral::NVIC;
use embedded_hal_nb::serial::ErrorKind;
use heapless::spsc::{Consumer, Producer};
use rundown::link::can_link::TO_BOARD;
use rundown::onboard::can::Mailbox;
use rundown::onboard::can::bxcan::{Bxcan, CanRegister, CanRegisters};
use rundown::onboard::can::timing::BitTiming;
use rundown::onboard::clock::FAST_HZ;
use rundown::onboard::serial::LineErrors;

// A rate that the clock does not give does not build.
const _: () = assert!(BitTiming::new(FAST_HZ, CAN_BIT_S).is_ok());

/// The registers of CAN1.
pub struct Registers(CAN1);

impl CanRegisters for Registers {
    fn register(&mut self, register: CanRegister) -> u32 {
        let at = CAN1::ptr().cast::<u32>().wrapping_byte_add(register.offset().into());
        // SAFETY: a register of the block, aligned; `self` owns it.
        unsafe { at.read_volatile() }
    }

    fn set_register(&mut self, register: CanRegister, bits: u32) {
        let at = CAN1::ptr().cast::<u32>().cast_mut().wrapping_byte_add(register.offset().into());
        // SAFETY: as above.
        unsafe { at.write_volatile(bits) }
    }
}

/// What the interrupts have: the controller and their ends of the queues.
struct Bus {
    controller: Bxcan<Registers>,
    incoming: Producer<'static, Mailbox>,
    outgoing: Consumer<'static, Mailbox>,
    errors: &'static LineErrors,
}

/// Of the interrupts alone once it is there. They have one priority, so the lock, some 5 µs long, is never waited for.
static BUS: Mutex<RefCell<Option<Bus>>> = Mutex::new(RefCell::new(None));

/// Brings CAN1 up and its interrupts; false where the clock does not give the rate, and where no controller answers.
///
/// To be called once, after the board's start and before interrupts are on.
pub fn start(
    clock_hz: u32,
    incoming: Producer<'static, Mailbox>,
    outgoing: Consumer<'static, Mailbox>,
    errors: &'static LineErrors,
) -> bool {
    let Some(controller) = controller(clock_hz) else {
        // Said in the counts of the line.
        errors.count(ErrorKind::Other);
        return false;
    };
    let bus = Bus { controller, incoming, outgoing, errors };
    interrupt::free(|section| BUS.borrow(section).replace(Some(bus)));
    // SAFETY: interrupts are off, and the start is done with it.
    let mut core = unsafe { cortex_m::Peripherals::steal() };
    let interrupts = [Interrupt::CAN1_TX, Interrupt::CAN1_RX0, Interrupt::CAN1_SCE];
    // SAFETY: they share nothing with the tasks but atomics and the queues.
    unsafe { unmask_as_line(&mut core.NVIC, interrupts) };
    true
}

/// Frames were put into the queue for the bus.
pub fn wake() {
    NVIC::pend(Interrupt::CAN1_TX);
}

/// Whichever interrupt it was; wakes the link task.
fn serve() {
    let to_do = interrupt::free(|section| {
        let mut bus = BUS.borrow(section).try_borrow_mut().ok()?;
        let bus = bus.as_mut()?;
        Some(bus.controller.serve(&mut bus.incoming, &mut bus.outgoing, bus.errors))
    });
    if to_do == Some(true) {
        NVIC::pend(Interrupt::TSC);
    }
}

// SAFETY: no other symbols have these names; the vector table refers to them.
#[unsafe(no_mangle)]
extern "C" fn CAN1_TX() {
    serve();
}

// SAFETY: see above.
#[unsafe(no_mangle)]
extern "C" fn CAN1_RX0() {
    serve();
}

// SAFETY: see above.
#[unsafe(no_mangle)]
extern "C" fn CAN1_SCE() {
    serve();
}

fn controller(clock_hz: u32) -> Option<Bxcan<Registers>> {
    let embedded_can::Id::Standard(accept) = TO_BOARD else {
        return None;
    };
    let timing = BitTiming::new(clock_hz, CAN_BIT_S).ok()?;
    // SAFETY: the start is over, and with interrupts off nothing else touches clocks and pins; CAN1 is taken here only.
    let chip = unsafe { Peripherals::steal() };
    chip.RCC.apb1enr1().modify(|_, w| w.can1en().set_bit());
    // The reference manual wants a moment between the enable and the first access; a read makes it.
    let _ = chip.RCC.apb1enr1().read();
    chip.RCC.ahb2enr().modify(|_, w| w.gpioben().set_bit());
    let _ = chip.RCC.ahb2enr().read();
    // SAFETY: alternate function 9 and mode 2 (alternate) exist for both pins.
    chip.GPIOB.afrh().modify(|_, w| unsafe { w.afrh8().bits(9).afrh9().bits(9) });
    // SAFETY: as above.
    chip.GPIOB.moder().modify(|_, w| unsafe { w.moder8().bits(2).moder9().bits(2) });
    Bxcan::start(Registers(chip.CAN1), timing, accept).ok()
}
