//! The flash controller of an STM32L4 as its reference manual and errata have it, over [`Flash`]: sticky flags, keys, a
//! busy flag, a data cache that goes stale, and a supply that can be cut at any access.

use crate::flash::{CutMode, Flash, PAGE, WORD};
use embedded_storage::nor_flash::{NorFlash, ReadNorFlash};
use rundown::onboard::stm32l4_flash::{FlashController, FlashRegister, KEYS, access, control, status};

/// Where the pages begin within bank 2.
const FIRST_PAGE: u32 = 248;
/// Flag: programming a word that is not erased.
const PROGERR: u32 = 1 << 3;
/// Flag: a step at the wrong time.
pub const PGSERR: u32 = 1 << 7;
/// Flag: the option bytes did not fit when they were read.
pub const OPTVERR: u32 = 1 << 15;

/// What was begun and is not over.
#[derive(Clone, Copy, Debug)]
enum Begun {
    Erase(u32),
    Program(u32, [u8; WORD]),
}

/// The controller. A clone is another chip in the same state.
#[derive(Clone, Debug)]
pub struct FlashSilicon {
    /// The cells.
    pub flash: Flash,
    /// The access control register.
    pub access: u32,
    flags: u32,
    control: u32,
    keys: usize,
    begun: Option<Begun>,
    polls: u32,
    cache: Vec<Option<u8>>,
    double_bit_errors: u32,
    cut: Option<(u64, CutMode, u64)>,
    powered: bool,
    /// Polls that an operation takes.
    pub busy_polls: u32,
    /// The operation, counted from now, that ends with this flag instead of its work.
    pub fails: Option<(u32, u32)>,
    /// Flags that are set again by each operation, and never go.
    pub stuck_flags: u32,
    /// Two bits of the double word with this byte are uncertain, though it reads right.
    pub uncertain: Option<u32>,
    /// Accesses to registers and double words so far. Reading changes nothing: a cut there is one at the next access.
    pub accesses: u64,
    /// What the reference manual forbids, in the order that it was done.
    pub violations: Vec<&'static str>,
}

impl FlashSilicon {
    /// After a reset: locked, caches on, with these flags set.
    pub fn after_reset(flash: Flash, flags: u32) -> Self {
        Self {
            flash,
            access: access::DATA_CACHE,
            flags,
            control: control::LOCK,
            keys: 0,
            begun: None,
            polls: 0,
            cache: vec![None; Self::CAPACITY],
            double_bit_errors: 0,
            cut: None,
            powered: true,
            busy_polls: 3,
            fails: None,
            stuck_flags: 0,
            uncertain: None,
            accesses: 0,
            violations: Vec::new(),
        }
    }

    /// Cuts the supply at this access, counted from now: it and all later ones do nothing.
    pub fn cut_at(&mut self, access: u64, mode: CutMode, seed: u64) {
        self.cut = Some((self.accesses + access, mode, seed));
    }

    /// Switches it off if it is on, then on: the same cells, everything else as after a reset, with these flags set.
    pub fn reset(mut self, flags: u32) -> Self {
        if self.powered {
            self.cut_now(CutMode::NotDone, 0);
        }
        self.flash.power_up();
        Self { violations: self.violations, ..Self::after_reset(self.flash, flags) }
    }

    /// Counts an access; false: there is no supply.
    fn powered(&mut self) -> bool {
        if let Some((at, mode, seed)) = self.cut
            && self.accesses == at
        {
            self.cut_now(mode, seed);
        }
        self.accesses += 1;
        self.powered
    }

    fn cut_now(&mut self, mode: CutMode, seed: u64) {
        self.powered = false;
        if let Some(begun) = self.begun.take() {
            self.flash.cut_before(0, mode, seed);
            let _ = self.carry_out(begun);
        }
    }

    fn carry_out(&mut self, begun: Begun) -> Result<(), crate::flash::FlashError> {
        match begun {
            Begun::Erase(page) => self.flash.erase(page * PAGE as u32, (page + 1) * PAGE as u32),
            Begun::Program(offset, bytes) => self.flash.write(offset, &bytes),
        }
    }

    /// Begins an operation, unless a flag is set.
    fn begin(&mut self, begun: Begun) {
        if self.flags & status::ERRORS != 0 {
            self.flags |= PGSERR;
            return;
        }
        // The erratum: what the cache holds may be anything afterwards.
        if self.access & access::DATA_CACHE != 0 {
            self.cache.iter_mut().flatten().for_each(|byte| *byte ^= 0x55);
        }
        if let Some((left, flag)) = &mut self.fails {
            if *left == 0 {
                self.flags |= *flag;
                self.fails = None;
                return;
            }
            *left -= 1;
        }
        self.flags |= self.stuck_flags;
        self.polls = self.busy_polls;
        self.begun = Some(begun);
    }

    /// One poll further.
    fn poll(&mut self) {
        if self.polls > 0 {
            self.polls -= 1;
        } else if let Some(begun) = self.begun.take()
            && self.carry_out(begun).is_err()
        {
            self.flags |= PROGERR;
        }
    }

    fn set_control(&mut self, bits: u32) {
        if self.begun.is_some() {
            self.violations.push("the control register was written while busy");
        } else if self.control & control::LOCK != 0 {
            self.violations.push("the control register was written while locked");
        } else {
            self.control = bits & !control::START;
            if bits & control::START != 0 && bits & control::ERASE != 0 {
                let page = (bits >> control::PAGE_SHIFT & 0xFF).checked_sub(FIRST_PAGE);
                match page.filter(|_| bits & control::BANK_2 != 0) {
                    Some(page) => self.begin(Begun::Erase(page)),
                    None => self.violations.push("a page of the program was erased"),
                }
            }
        }
    }
}

impl FlashController for FlashSilicon {
    const CAPACITY: usize = 4 * PAGE;

    fn register(&mut self, register: FlashRegister) -> u32 {
        if !self.powered() {
            return 0;
        }
        match register {
            FlashRegister::Access => self.access,
            FlashRegister::Key => 0,
            FlashRegister::Control => self.control,
            FlashRegister::Status => {
                self.poll();
                self.flags | if self.begun.is_some() { status::BUSY } else { 0 }
            }
        }
    }

    fn set_register(&mut self, register: FlashRegister, bits: u32) {
        if !self.powered() {
            return;
        }
        match register {
            FlashRegister::Status => self.flags &= !bits,
            FlashRegister::Control => self.set_control(bits),
            FlashRegister::Key if self.control & control::LOCK == 0 || KEYS.get(self.keys) != Some(&bits) => {
                self.violations.push("a key that was not asked for: bus fault");
            }
            FlashRegister::Key => {
                self.keys = (self.keys + 1) % KEYS.len();
                if self.keys == 0 {
                    self.control &= !control::LOCK;
                }
            }
            FlashRegister::Access => {
                if bits & access::DATA_CACHE_RESET != 0 {
                    if self.access & access::DATA_CACHE == 0 {
                        self.cache.fill(None);
                    } else {
                        self.violations.push("the data cache was reset while on");
                    }
                }
                self.access = bits;
            }
        }
    }

    fn program(&mut self, offset: u32, [low, high]: [u32; 2]) {
        if !self.powered() {
            return;
        }
        if self.control & (control::PROGRAM | control::LOCK) != control::PROGRAM || self.begun.is_some() {
            self.flags |= PGSERR;
            return;
        }
        let bits = u64::from(high) << 32 | u64::from(low);
        self.begin(Begun::Program(offset, bits.to_le_bytes()));
    }

    fn byte(&mut self, offset: u32) -> u8 {
        if !self.powered {
            return 0;
        }
        // Reading the bank that is busy waits for it.
        while self.begun.is_some() {
            self.poll();
        }
        let cached = self.access & access::DATA_CACHE != 0;
        if let Some(byte) = self.cache[offset as usize].filter(|_| cached) {
            return byte;
        }
        let mut byte = [0xAA];
        let is_uncertain = self.uncertain.is_some_and(|at| at / WORD as u32 == offset / WORD as u32);
        if self.flash.read(offset, &mut byte).is_err() || is_uncertain {
            self.double_bit_errors += 1;
        } else if cached {
            self.cache[offset as usize] = Some(byte[0]);
        }
        byte[0]
    }

    fn first_page(&self) -> u32 {
        FIRST_PAGE
    }

    fn double_bit_errors(&self) -> u32 {
        self.double_bit_errors
    }
}
