//! The bxCAN controller of an STM32L4: the sequences of RM0351 chapter 46, free of registers so that the host tests
//! them.
//!
//! In: registers ([`CanRegisters`]), a bit timing, the identifier that is for the board. Out: frames in a queue, frames
//! of a queue on the bus, what went wrong counted.
//!
//! Start:
//!
//! 1. Out of sleep, into initialisation. The wait is bounded: a controller without a clock, and the emulator, never
//!    answer.
//! 2. Bit timing; bus-off ends by itself after 128 times 11 recessive bits (ABOM); mailboxes leave in the order of
//!    their requests (TXFP); a full FIFO keeps what it has (RFLM).
//! 3. One filter: data frames with the one identifier, into FIFO 0. A busy bus costs nothing.
//! 4. Interrupts for frames that came, an overrun, a mailbox that became free, bus-off.
//! 5. Onto the bus, without waiting: it takes 11 recessive bits, which a dead bus never gives.
//!
//! A frame that nobody acknowledges is sent again until somebody does; meanwhile the queue in front of it fills up, and
//! the link behind it waits.

use super::Mailbox;
use super::timing::BitTiming;
use crate::onboard::clock::bounded;
use crate::onboard::serial::LineErrors;
use embedded_can::StandardId;
use embedded_hal_nb::serial::ErrorKind;
use heapless::spsc::{Consumer, Producer};
use rundown_wire::errors;

/// A register, by its offset in the controller's block, bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct CanRegister(u16);

impl CanRegister {
    /// MCR: master control.
    pub const CONTROL: Self = Self(0x000);
    /// MSR: master status.
    pub const STATUS: Self = Self(0x004);
    /// TSR: transmit status.
    pub const TRANSMIT: Self = Self(0x008);
    /// RF0R: receive FIFO 0.
    pub const RECEIVE: Self = Self(0x00C);
    /// IER: interrupt enable.
    pub const INTERRUPTS: Self = Self(0x014);
    /// BTR: bit timing.
    pub const TIMING: Self = Self(0x01C);
    /// First of the four registers of the first of three transmit mailboxes: TIR, TDTR, TDLR, TDHR.
    pub const TRANSMIT_MAILBOX: Self = Self(0x180);
    /// First of the four registers of FIFO 0's mailbox: RIR, RDTR, RDLR, RDHR.
    pub const RECEIVE_MAILBOX: Self = Self(0x1B0);
    /// FMR: filter master.
    pub const FILTER: Self = Self(0x200);
    /// FM1R: a bit a bank, list instead of mask.
    pub const FILTER_LIST: Self = Self(0x204);
    /// FS1R: a bit a bank, one of 32 bits instead of two of 16.
    pub const FILTER_WIDE: Self = Self(0x20C);
    /// FFA1R: a bit a bank, FIFO 1 instead of 0.
    pub const FILTER_FIFO: Self = Self(0x214);
    /// FA1R: a bit a bank, active.
    pub const FILTER_ACTIVE: Self = Self(0x21C);
    /// F0R1 and, behind it, F0R2: identifier and mask of bank 0.
    pub const FILTER_BANK: Self = Self(0x240);

    /// The register so many words behind this one.
    pub const fn plus(self, words: u16) -> Self {
        Self(self.0 + 4 * words)
    }

    /// Offset from the controller's first register, bytes.
    pub const fn offset(self) -> u16 {
        self.0
    }
}

/// Bits of the master control register.
pub mod control {
    /// Ask for initialisation, INRQ.
    pub const INITIALISE: u32 = 1 << 0;
    /// Ask for sleep. Set after a reset.
    pub const SLEEP: u32 = 1 << 1;
    /// Mailboxes in the order of their requests, TXFP.
    pub const IN_ORDER: u32 = 1 << 2;
    /// A full FIFO drops the newest, RFLM.
    pub const KEEP_OLDEST: u32 = 1 << 3;
    /// Send a frame once only, NART.
    pub const ONCE: u32 = 1 << 4;
    /// Time triggered communication, TTCM.
    pub const TIME_TRIGGERED: u32 = 1 << 7;
    /// Back from bus-off without being asked, ABOM.
    pub const RECOVER: u32 = 1 << 6;
}

/// Bits of the master status register.
pub mod status {
    /// In initialisation, INAK.
    pub const INITIALISING: u32 = 1 << 0;
    /// Asleep, SLAK.
    pub const ASLEEP: u32 = 1 << 1;
    /// An error that may interrupt has occurred, ERRI; cleared by writing 1.
    pub const ERROR: u32 = 1 << 2;
}

/// Bits of the transmit status register.
pub mod transmit {
    /// RQCP of all mailboxes: a request is over; cleared by writing 1.
    pub const OVER: u32 = 1 << 0 | 1 << 8 | 1 << 16;
    /// TME of the first mailbox: it is free.
    pub const FREE: u32 = 1 << 26;
    /// Ask a mailbox to be sent, TXRQ of its first register.
    pub const REQUEST: u32 = 1 << 0;
}

/// Bits of the receive FIFO's register.
pub mod receive {
    /// Frames that wait, FMP.
    pub const PENDING: u32 = 0b11;
    /// A frame was lost, FOVR; cleared by writing 1.
    pub const OVERRUN: u32 = 1 << 4;
    /// Release the frame that was read, RFOM; reads 1 until it is done.
    pub const RELEASE: u32 = 1 << 5;
}

/// Interrupts that are used: TMEIE, FMPIE0, FOVIE0, BOFIE, ERRIE.
pub const INTERRUPTS: u32 = 1 << 0 | 1 << 1 | 1 << 3 | 1 << 10 | 1 << 15;

/// Filters are set up, FINIT of FMR.
pub const FILTER_SETUP: u32 = 1 << 0;
/// Bank 0, where each bank has a bit.
const BANK_0: u32 = 1 << 0;
/// All bits of a standard identifier and the two that say that it is one, of a data frame.
const WHOLE_IDENTIFIER: u32 = 0x7FF << super::STANDARD_SHIFT | super::EXTENDED | super::REMOTE;

/// Transmit mailboxes.
const MAILBOXES: u16 = 3;
/// Frames that one interrupt takes at most: twice what the FIFO holds. The next interrupt takes the rest.
pub const MOST_PER_CALL: usize = 6;
/// Polls of a release, which takes a few cycles.
const MOST_RELEASE_POLLS: usize = 100;

/// The registers of a controller.
pub trait CanRegisters {
    /// Reads one.
    fn register(&mut self, register: CanRegister) -> u32;
    /// Writes one as a whole.
    fn set_register(&mut self, register: CanRegister, bits: u32);
}

impl<R: CanRegisters> CanRegisters for &mut R {
    fn register(&mut self, register: CanRegister) -> u32 {
        (**self).register(register)
    }

    fn set_register(&mut self, register: CanRegister, bits: u32) {
        (**self).set_register(register, bits);
    }
}

errors! {
    /// The controller did not go into initialisation in time. The emulator has none.
    #[derive(Eq)]
    pub struct NoController => "CAN: the controller does not answer";
}

/// A controller on the bus.
#[derive(Clone, Debug)]
pub struct Bxcan<R> {
    registers: R,
}

impl<R: CanRegisters> Bxcan<R> {
    /// Brings it up, for data frames with the identifier `accept`.
    ///
    /// # Errors
    /// [`NoController`]. It is left as it was found, but for the request.
    pub fn start(mut registers: R, timing: BitTiming, accept: StandardId) -> Result<Self, NoController> {
        let found = registers.register(CanRegister::CONTROL);
        let awake = found & !(control::SLEEP | control::ONCE | control::TIME_TRIGGERED) | control::INITIALISE;
        registers.set_register(CanRegister::CONTROL, awake);
        let ready = |registers: &mut R| {
            registers.register(CanRegister::STATUS) & (status::INITIALISING | status::ASLEEP) == status::INITIALISING
        };
        bounded(|| ready(&mut registers)).ok_or(NoController)?;
        let set_up = awake | control::RECOVER | control::IN_ORDER | control::KEEP_OLDEST;
        registers.set_register(CanRegister::CONTROL, set_up);
        registers.set_register(CanRegister::TIMING, timing.bits());
        filter(&mut registers, accept);
        registers.set_register(CanRegister::INTERRUPTS, INTERRUPTS);
        registers.set_register(CanRegister::CONTROL, set_up & !control::INITIALISE);
        Ok(Self { registers })
    }

    /// The registers.
    pub fn registers(&mut self) -> &mut R {
        &mut self.registers
    }

    /// What the controller's interrupts do, whichever it was. Returns whether the link task has something to do: frames
    /// came, or there is room for others.
    pub fn serve(
        &mut self,
        incoming: &mut Producer<'_, Mailbox>,
        outgoing: &mut Consumer<'_, Mailbox>,
        errors: &LineErrors,
    ) -> bool {
        if self.registers.register(CanRegister::STATUS) & status::ERROR != 0 {
            self.registers.set_register(CanRegister::STATUS, status::ERROR);
            // Bus-off: of the errors the only one that interrupts.
            errors.count(ErrorKind::Other);
        }
        let came = self.take(incoming, errors);
        let went = self.send(outgoing);
        came || went
    }

    fn take(&mut self, incoming: &mut Producer<'_, Mailbox>, errors: &LineErrors) -> bool {
        let mut came = false;
        for _ in 0..MOST_PER_CALL {
            let fifo = self.registers.register(CanRegister::RECEIVE);
            if fifo & receive::OVERRUN != 0 {
                self.registers.set_register(CanRegister::RECEIVE, receive::OVERRUN);
                errors.count(ErrorKind::Overrun);
            }
            if fifo & receive::PENDING == 0 {
                break;
            }
            let mut word = |place| self.registers.register(CanRegister::RECEIVE_MAILBOX.plus(place));
            let mailbox = Mailbox { identifier: word(0), length: word(1), data: [word(2), word(3)] };
            self.registers.set_register(CanRegister::RECEIVE, receive::RELEASE);
            came = true;
            if incoming.enqueue(mailbox).is_err() {
                errors.count_full();
            }
            // Until then the same frame would be read again.
            let released =
                (0..MOST_RELEASE_POLLS).any(|_| self.registers.register(CanRegister::RECEIVE) & receive::RELEASE == 0);
            if !released {
                break;
            }
        }
        came
    }

    /// Fills the mailboxes that are free.
    fn send(&mut self, outgoing: &mut Consumer<'_, Mailbox>) -> bool {
        let transmit = self.registers.register(CanRegister::TRANSMIT);
        // Only those that were seen: one that ends now interrupts again.
        self.registers.set_register(CanRegister::TRANSMIT, transmit & transmit::OVER);
        let mut went = false;
        for number in 0..MAILBOXES {
            if transmit & (transmit::FREE << number) == 0 {
                continue;
            }
            let Some(mailbox) = outgoing.dequeue() else {
                break;
            };
            let first = CanRegister::TRANSMIT_MAILBOX.plus(4 * number);
            let [low, high] = mailbox.data;
            self.registers.set_register(first.plus(1), mailbox.length);
            self.registers.set_register(first.plus(2), low);
            self.registers.set_register(first.plus(3), high);
            self.registers.set_register(first, mailbox.identifier | transmit::REQUEST);
            went = true;
        }
        went
    }
}

fn filter(registers: &mut impl CanRegisters, accept: StandardId) {
    let master = registers.register(CanRegister::FILTER);
    registers.set_register(CanRegister::FILTER, master | FILTER_SETUP);
    registers.set_register(CanRegister::FILTER_ACTIVE, 0);
    for (register, bits) in [
        (CanRegister::FILTER_LIST, 0),
        (CanRegister::FILTER_WIDE, BANK_0),
        (CanRegister::FILTER_FIFO, 0),
        (CanRegister::FILTER_BANK, u32::from(accept.as_raw()) << super::STANDARD_SHIFT),
        (CanRegister::FILTER_BANK.plus(1), WHOLE_IDENTIFIER),
        (CanRegister::FILTER_ACTIVE, BANK_0),
    ] {
        registers.set_register(register, bits);
    }
    registers.set_register(CanRegister::FILTER, master & !FILTER_SETUP);
}
