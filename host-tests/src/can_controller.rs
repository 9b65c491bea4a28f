//! The bxCAN controller of an STM32L4 as its reference manual has it, with a bus that the test plays.

use rundown::link::can::CanFrame;
use rundown::onboard::can::Mailbox;
use rundown::onboard::can::bxcan::{CanRegister, CanRegisters, FILTER_SETUP, control, receive, status, transmit};
use std::collections::{BTreeMap, VecDeque};

/// Frames that FIFO 0 holds.
pub const FIFO: usize = 3;
const INTERRUPT_FREE: u32 = 1 << 0;
const INTERRUPT_CAME: u32 = 1 << 1;
const INTERRUPT_OVERRUN: u32 = 1 << 3;
const INTERRUPT_BUS_OFF: u32 = 1 << 10;
const INTERRUPT_ERROR: u32 = 1 << 15;

/// The controller.
#[derive(Clone, Debug)]
pub struct CanSilicon {
    registers: BTreeMap<CanRegister, u32>,
    /// Requests under way: mailbox and its number in the order of requests.
    requests: Vec<usize>,
    over: u32,
    fifo: VecDeque<Mailbox>,
    overrun: bool,
    error: bool,
    bus_off: bool,
    acknowledged: bool,
    polls: u32,
    releasing: u32,
    /// Without a clock: every register reads zero.
    pub dead: bool,
    /// Polls until a mode is acknowledged.
    pub mode_polls: u32,
    /// Polls until a frame of the FIFO is released.
    pub release_polls: u32,
    /// Accesses so far.
    pub accesses: u64,
    /// What the reference manual forbids, in the order that it was done.
    pub violations: Vec<&'static str>,
}

impl Default for CanSilicon {
    /// After a reset: asleep.
    fn default() -> Self {
        Self {
            registers: BTreeMap::from([
                (CanRegister::CONTROL, 1 << 16 | control::SLEEP),
                (CanRegister::FILTER, 0x2A1C_0E01),
            ]),
            requests: Vec::new(),
            over: 0,
            fifo: VecDeque::new(),
            overrun: false,
            error: false,
            bus_off: false,
            acknowledged: false,
            polls: 0,
            releasing: 0,
            dead: false,
            mode_polls: 3,
            release_polls: 2,
            accesses: 0,
            violations: Vec::new(),
        }
    }
}

impl CanSilicon {
    /// What stands in a register.
    pub fn bits(&self, register: CanRegister) -> u32 {
        self.registers.get(&register).copied().unwrap_or(0)
    }

    /// Takes part in the traffic of the bus.
    pub fn is_on_bus(&self) -> bool {
        self.bits(CanRegister::CONTROL) & (control::INITIALISE | control::SLEEP) == 0 && !self.bus_off
    }

    /// An interrupt is asked for.
    pub fn interrupts(&self) -> bool {
        let asked = |bit, so| self.bits(CanRegister::INTERRUPTS) & bit != 0 && so;
        asked(INTERRUPT_FREE, self.over != 0)
            || asked(INTERRUPT_CAME, !self.fifo.is_empty())
            || asked(INTERRUPT_OVERRUN, self.overrun)
            || asked(INTERRUPT_ERROR, self.error)
    }

    /// A frame on the bus.
    pub fn bus_brings(&mut self, frame: &CanFrame) {
        let mailbox = Mailbox::of(frame).expect("a classic frame");
        if !self.is_on_bus() || !self.accepts(mailbox.identifier) {
            return;
        }
        if self.fifo.len() < FIFO {
            self.fifo.push_back(mailbox);
            return;
        }
        self.overrun = true;
        if self.bits(CanRegister::CONTROL) & control::KEEP_OLDEST == 0 {
            self.fifo.pop_back();
            self.fifo.push_back(mailbox);
        }
    }

    /// The bus takes and acknowledges a frame.
    pub fn bus_takes(&mut self) -> Option<CanFrame> {
        if !self.is_on_bus() || self.requests.is_empty() {
            return None;
        }
        // By identifier, of equal ones the lowest mailbox, unless the order of the requests counts.
        let in_order = self.bits(CanRegister::CONTROL) & control::IN_ORDER != 0;
        let key = |number: usize| (self.transmit_mailbox(number).identifier, number);
        let place = if in_order { Some(0) } else { (0..self.requests.len()).min_by_key(|at| key(self.requests[*at])) };
        let number = self.requests.remove(place?);
        self.over |= 1 << (8 * number);
        self.transmit_mailbox(number).frame()
    }

    /// So many errors on the bus that it leaves it.
    pub fn bus_goes_off(&mut self) {
        self.bus_off = true;
        let enabled = INTERRUPT_BUS_OFF;
        self.error |= self.bits(CanRegister::INTERRUPTS) & enabled == enabled;
    }

    /// 128 times 11 recessive bits.
    pub fn bus_is_quiet(&mut self) {
        if self.bits(CanRegister::CONTROL) & control::RECOVER != 0 {
            self.bus_off = false;
        }
    }

    fn transmit_mailbox(&self, number: usize) -> Mailbox {
        let word = |place| self.bits(word_of(CanRegister::TRANSMIT_MAILBOX, 4 * number + place));
        Mailbox { identifier: word(0) & !transmit::REQUEST, length: word(1), data: [word(2), word(3)] }
    }

    /// Bank 0, one of 32 bits with a mask; others are not modelled.
    fn accepts(&self, identifier: u32) -> bool {
        let set = |register| self.bits(register) & 1 != 0;
        let [id, mask] = [0, 1].map(|place| self.bits(word_of(CanRegister::FILTER_BANK, place)));
        let modelled =
            set(CanRegister::FILTER_WIDE) && !set(CanRegister::FILTER_LIST) && !set(CanRegister::FILTER_FIFO);
        modelled
            && set(CanRegister::FILTER_ACTIVE)
            && self.bits(CanRegister::FILTER) & FILTER_SETUP == 0
            && (identifier ^ id) & mask == 0
    }

    fn status(&mut self) -> u32 {
        let asked = self.bits(CanRegister::CONTROL);
        if self.polls < self.mode_polls {
            self.polls += 1;
        } else {
            self.acknowledged = asked & control::INITIALISE != 0;
        }
        let asleep = asked & control::SLEEP != 0;
        let flags = [(self.acknowledged, status::INITIALISING), (asleep, status::ASLEEP), (self.error, status::ERROR)];
        flags.into_iter().filter(|(is, _)| *is).map(|(_, bit)| bit).sum()
    }

    fn fifo_register(&mut self) -> u32 {
        if self.releasing > 0 {
            self.releasing -= 1;
            if self.releasing == 0 {
                self.fifo.pop_front();
            }
        }
        let releasing = if self.releasing > 0 { receive::RELEASE } else { 0 };
        let overrun = if self.overrun { receive::OVERRUN } else { 0 };
        self.fifo.len() as u32 | overrun | releasing
    }

    fn transmit_register(&self) -> u32 {
        let free = (0..3).filter(|number| !self.requests.contains(number)).map(|number| transmit::FREE << number);
        self.over | free.sum::<u32>()
    }

    fn check(&mut self, register: CanRegister, bits: u32) {
        let filtering = self.bits(CanRegister::FILTER) & FILTER_SETUP == 0;
        let forbidden = match register {
            CanRegister::TIMING if !self.acknowledged => "the bit timing was written outside initialisation",
            CanRegister::FILTER_LIST | CanRegister::FILTER_WIDE | CanRegister::FILTER_FIFO if filtering => {
                "a filter was changed while filters were in force"
            }
            CanRegister::CONTROL if bits & control::INITIALISE == 0 && self.bits(CanRegister::TIMING) == 0 => {
                "it went onto the bus without a bit timing"
            }
            _ => return,
        };
        self.violations.push(forbidden);
    }
}

impl CanRegisters for CanSilicon {
    fn register(&mut self, register: CanRegister) -> u32 {
        self.accesses += 1;
        match register {
            _ if self.dead => 0,
            CanRegister::STATUS => self.status(),
            CanRegister::RECEIVE => self.fifo_register(),
            CanRegister::TRANSMIT => self.transmit_register(),
            other => match received_word(other) {
                Some(place) => {
                    let Some(mailbox) = self.fifo.front() else {
                        self.violations.push("an empty FIFO was read");
                        return 0;
                    };
                    [mailbox.identifier, mailbox.length, mailbox.data[0], mailbox.data[1]][place]
                }
                None => self.bits(other),
            },
        }
    }

    fn set_register(&mut self, register: CanRegister, bits: u32) {
        self.accesses += 1;
        if self.dead {
            return;
        }
        self.check(register, bits);
        match register {
            CanRegister::STATUS => self.error &= bits & status::ERROR == 0,
            CanRegister::TRANSMIT => self.over &= !bits,
            CanRegister::RECEIVE => {
                self.overrun &= bits & receive::OVERRUN == 0;
                if bits & receive::RELEASE != 0 {
                    self.releasing = self.release_polls + 1;
                }
            }
            CanRegister::CONTROL => {
                self.polls = 0;
                self.registers.insert(register, bits);
            }
            other => {
                self.registers.insert(other, bits);
                let request = (0..3).find(|number| other == word_of(CanRegister::TRANSMIT_MAILBOX, 4 * number));
                if let Some(number) = request.filter(|_| bits & transmit::REQUEST != 0) {
                    if self.requests.contains(&number) {
                        self.violations.push("a mailbox under way was written");
                    }
                    self.requests.push(number);
                }
            }
        }
    }
}

fn word_of(first: CanRegister, words: usize) -> CanRegister {
    first.plus(words as u16)
}

/// Which word of FIFO 0's mailbox a register is.
fn received_word(register: CanRegister) -> Option<usize> {
    (0..4).find(|place| register == word_of(CanRegister::RECEIVE_MAILBOX, *place))
}
