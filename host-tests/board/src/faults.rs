//! A bad wire: what goes over it is damaged, lost, doubled, late or out of order, by a seed.
//!
//! In: units, that is messages or what was written to a port in one go; the chance of each fault. Out: units.
//!
//! [`FaultyPort`] damages the bytes below a link, as a wire does: what the link then gives must still be right.
//! [`FaultyLink`] damages the messages themselves, as a forger or a broken sender does: what takes the messages must
//! cope. A CAN frame in SLCAN is one write, so a faulty port under it loses, doubles and reorders single frames.
//!
//! The same seed and the same calls give the same faults.

use embedded_io::{Read, ReadReady, Write};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rundown::link::{Counters, Link, LinkError, MAX_MESSAGE, Message};
use std::collections::VecDeque;

/// Each fault once: its chance and its count.
macro_rules! faults {
    ($($(#[$what:meta])* $fault:ident)*) => {
        /// Chance of each fault for a unit, 0 to 1, and how long the slow ones take.
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct Rates {
            $($(#[$what])* pub $fault: f64,)*
            /// Length of a delay, µs.
            pub delay_us: u64,
            /// Length of a stall, µs.
            pub stall_us: u64,
        }

        impl Rates {
            /// Every fault with this chance, delays of 50 ms and stalls of 0.5 s.
            pub const fn all(chance: f64) -> Self {
                Self { $($fault: chance,)* delay_us: 50_000, stall_us: 500_000 }
            }
        }

        /// How often each fault happened.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        #[expect(missing_docs, reason = "named as in Rates")]
        pub struct Tally {
            pub units: u32,
            $(pub $fault: u32,)*
        }
    };
}

faults! {
    /// One to three bits anywhere are flipped.
    bit_flips
    /// Up to 32 neighbouring bits become random.
    burst
    /// The end is missing.
    truncation
    /// All of it is missing.
    drop
    /// It comes twice.
    duplicate
    /// The next one overtakes it; when none comes, it is late by `delay_us`.
    reorder
    /// 1 to 64 random bytes come before it.
    garbage
    /// It is late by `delay_us`, and all that follow wait for it.
    delay
    /// Nothing passes for `stall_us`.
    stall
}

#[derive(Clone, Debug)]
struct Transit {
    due_us: u64,
    bytes: Vec<u8>,
}

/// One direction of the wire.
#[derive(Clone, Debug)]
pub struct BadWire {
    rates: Rates,
    rng: ChaCha8Rng,
    queue: VecDeque<Transit>,
    overtaken: Option<Transit>,
    stalled_until_us: u64,
    tally: Tally,
}

impl BadWire {
    /// A wire with nothing on it.
    pub fn new(seed: u64, rates: Rates) -> Self {
        Self {
            rates,
            rng: ChaCha8Rng::seed_from_u64(seed),
            queue: VecDeque::new(),
            overtaken: None,
            stalled_until_us: 0,
            tally: Tally::default(),
        }
    }

    /// What happened so far.
    pub const fn tally(&self) -> Tally {
        self.tally
    }

    /// Puts a unit on the wire.
    pub fn put(&mut self, mut bytes: Vec<u8>, now_us: u64) {
        self.tally.units += 1;
        let rates = self.rates;
        if self.happens(rates.stall, |tally| &mut tally.stall) {
            self.stalled_until_us = now_us.saturating_add(rates.stall_us);
        }
        if self.happens(rates.drop, |tally| &mut tally.drop) {
            return;
        }
        if self.happens(rates.bit_flips, |tally| &mut tally.bit_flips) {
            for _ in 0..self.rng.random_range(1..=3) {
                flip(&mut bytes, &mut self.rng, 1);
            }
        }
        if self.happens(rates.burst, |tally| &mut tally.burst) {
            let bits = self.rng.random_range(2..=32);
            flip(&mut bytes, &mut self.rng, bits);
        }
        if self.happens(rates.truncation, |tally| &mut tally.truncation) {
            bytes.truncate(self.rng.random_range(0..=bytes.len().saturating_sub(1)));
        }
        if self.happens(rates.garbage, |tally| &mut tally.garbage) {
            let mut garbage = vec![0; self.rng.random_range(1..=64)];
            self.rng.fill_bytes(&mut garbage);
            self.queue.push_back(Transit { due_us: now_us, bytes: garbage });
        }
        let late_us = now_us.saturating_add(rates.delay_us);
        let delayed = self.happens(rates.delay, |tally| &mut tally.delay);
        let unit = Transit { due_us: if delayed { late_us } else { now_us }, bytes };
        if self.happens(rates.duplicate, |tally| &mut tally.duplicate) {
            self.queue.push_back(unit.clone());
        }
        if self.overtaken.is_none() && self.happens(rates.reorder, |tally| &mut tally.reorder) {
            self.overtaken = Some(Transit { due_us: late_us, ..unit });
            return;
        }
        self.queue.push_back(unit);
        self.queue.extend(self.overtaken.take().map(|unit| Transit { due_us: now_us, ..unit }));
    }

    /// The next unit that has come out by now. Units leave in the order in which they are queued.
    pub fn take(&mut self, now_us: u64) -> Option<Vec<u8>> {
        if now_us < self.stalled_until_us {
            return None;
        }
        if self.overtaken.as_ref().is_some_and(|unit| unit.due_us <= now_us) {
            self.queue.extend(self.overtaken.take());
        }
        if self.queue.front()?.due_us > now_us {
            return None;
        }
        self.queue.pop_front().map(|unit| unit.bytes)
    }

    /// Whether nothing is on its way.
    pub fn is_empty(&self) -> bool {
        self.queue.is_empty() && self.overtaken.is_none()
    }

    fn happens(&mut self, chance: f64, counter: impl Fn(&mut Tally) -> &mut u32) -> bool {
        let happens = self.rng.random::<f64>() < chance;
        if happens {
            *counter(&mut self.tally) += 1;
        }
        happens
    }
}

/// Flips one bit, or makes a burst: its first and last bit change, those between by chance.
fn flip(bytes: &mut [u8], rng: &mut impl Rng, bits: usize) {
    let all = 8 * bytes.len();
    let Some(first) = all.checked_sub(bits).map(|last| rng.random_range(0..=last)) else {
        return;
    };
    for bit in first..first + bits {
        let edge = bit == first || bit + 1 == first + bits;
        if (edge || rng.random())
            && let Some(byte) = bytes.get_mut(bit / 8)
        {
            *byte ^= 1 << (bit % 8);
        }
    }
}

/// A link whose messages are damaged in both directions.
///
/// A message that came out empty or too long is no message and is lost, as is one that a full port cut.
pub struct FaultyLink<L> {
    link: L,
    out: BadWire,
    back: BadWire,
    // Taken off the wire while the link below was busy.
    waiting: Option<Vec<u8>>,
}

impl<L: Link> FaultyLink<L> {
    /// A bad wire before `link`.
    pub fn new(link: L, seed: u64, rates: Rates) -> Self {
        let [out, back] = wires(seed, rates);
        Self { link, out, back, waiting: None }
    }

    /// What happened to sent and to received messages.
    pub const fn tallies(&self) -> (Tally, Tally) {
        (self.out.tally(), self.back.tally())
    }

    fn pass_on(&mut self, now_us: u64) -> Result<(), LinkError<L::PortError>> {
        while let Some(message) = self.waiting.take().or_else(|| self.out.take(now_us)) {
            match self.link.send(&message, now_us) {
                Ok(()) | Err(LinkError::Length { .. } | LinkError::Full) => {}
                Err(LinkError::Busy) => {
                    self.waiting = Some(message);
                    break;
                }
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }
}

impl<L: Link> Link for FaultyLink<L> {
    type PortError = L::PortError;

    fn send(&mut self, message: &[u8], now_us: u64) -> Result<(), LinkError<L::PortError>> {
        let found = message.len();
        if !(1..=MAX_MESSAGE).contains(&found) {
            return Err(LinkError::Length { found });
        }
        self.out.put(message.to_vec(), now_us);
        self.pass_on(now_us)
    }

    fn receive(&mut self, now_us: u64) -> Result<Option<Message>, LinkError<L::PortError>> {
        self.pass_on(now_us)?;
        while let Some(message) = self.link.receive(now_us)? {
            self.back.put(message.to_vec(), now_us);
        }
        while let Some(bytes) = self.back.take(now_us) {
            match Message::from_slice(&bytes) {
                Ok(message) if !message.is_empty() => return Ok(Some(message)),
                _ => {}
            }
        }
        Ok(None)
    }

    fn is_sending(&self) -> bool {
        self.waiting.is_some() || !self.out.is_empty() || self.link.is_sending()
    }

    fn counters(&self) -> Counters {
        self.link.counters()
    }
}

/// A port whose bytes are damaged in both directions.
///
/// What is written in one go is a unit, and so is what has come in since the last look. Late bytes move on when the
/// port is used.
pub struct FaultyPort<P, C> {
    port: P,
    out: BadWire,
    back: BadWire,
    ready: VecDeque<u8>,
    clock_us: C,
}

impl<P: Read + ReadReady + Write, C: FnMut() -> u64> FaultyPort<P, C> {
    /// A bad wire before `port`; `clock_us` says the time, which a port does not know.
    pub fn new(port: P, seed: u64, rates: Rates, clock_us: C) -> Self {
        let [out, back] = wires(seed, rates);
        Self { port, out, back, ready: VecDeque::new(), clock_us }
    }

    /// What happened to what was written and what was read.
    pub const fn tallies(&self) -> (Tally, Tally) {
        (self.out.tally(), self.back.tally())
    }

    fn move_on(&mut self) -> Result<(), P::Error> {
        let now_us = (self.clock_us)();
        while let Some(bytes) = self.out.take(now_us) {
            self.port.write_all(&bytes)?;
        }
        let mut unit = Vec::new();
        // Bounded, or a babbling port would never let go.
        while unit.len() < 4096 && self.port.read_ready()? {
            let mut byte = [0];
            match self.port.read(&mut byte)? {
                0 => break,
                _ => unit.extend(byte),
            }
        }
        if !unit.is_empty() {
            self.back.put(unit, now_us);
        }
        while let Some(bytes) = self.back.take(now_us) {
            self.ready.extend(bytes);
        }
        Ok(())
    }
}

impl<P: Read, C> embedded_io::ErrorType for FaultyPort<P, C> {
    type Error = P::Error;
}

impl<P: Read + ReadReady + Write, C: FnMut() -> u64> ReadReady for FaultyPort<P, C> {
    fn read_ready(&mut self) -> Result<bool, P::Error> {
        self.move_on()?;
        Ok(!self.ready.is_empty())
    }
}

impl<P: Read + ReadReady + Write, C: FnMut() -> u64> Read for FaultyPort<P, C> {
    /// Gives nothing, rather than wait, when nothing is there.
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, P::Error> {
        let length = buffer.len().min(self.ready.len());
        for (to, from) in buffer.iter_mut().zip(self.ready.drain(..length)) {
            *to = from;
        }
        Ok(length)
    }
}

impl<P: Read + ReadReady + Write, C: FnMut() -> u64> Write for FaultyPort<P, C> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, P::Error> {
        let now_us = (self.clock_us)();
        self.out.put(bytes.to_vec(), now_us);
        self.move_on()?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), P::Error> {
        self.move_on()?;
        self.port.flush()
    }
}

/// Both directions, with seeds of their own.
fn wires(seed: u64, rates: Rates) -> [BadWire; 2] {
    [seed, !seed].map(|seed| BadWire::new(seed, rates))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn through(rates: Rates, seed: u64, units: u8) -> (Vec<Vec<u8>>, Tally) {
        let mut wire = BadWire::new(seed, rates);
        let mut out = Vec::new();
        for unit in 0..units {
            wire.put(vec![unit; 20], u64::from(unit));
            out.extend(std::iter::from_fn(|| wire.take(u64::from(unit))));
        }
        out.extend(std::iter::from_fn(|| wire.take(10_000_000)));
        assert!(wire.is_empty());
        (out, wire.tally())
    }

    #[test]
    fn without_faults_all_comes_out_as_it_went_in() {
        let (out, tally) = through(Rates::default(), 1, 100);
        assert!(out.iter().zip(0..).all(|(unit, i)| *unit == vec![i; 20]));
        assert_eq!((out.len(), tally.units), (100, 100));
    }

    #[test]
    fn every_fault_does_what_its_name_says() {
        let one = |change: fn(&mut Rates)| {
            let mut rates = Rates { delay_us: 5, stall_us: 50, ..Rates::default() };
            change(&mut rates);
            through(rates, 7, 10).0
        };
        let clean = one(|_| ());
        assert_eq!(one(|rates| rates.drop = 1.0), Vec::<Vec<u8>>::new());
        assert_eq!(one(|rates| rates.duplicate = 1.0).len(), 20);
        assert_eq!(one(|rates| rates.garbage = 1.0).len(), 20);
        assert!(one(|rates| rates.truncation = 1.0).iter().all(|unit| unit.len() < 20));
        for change in [|rates: &mut Rates| rates.bit_flips = 1.0, |rates: &mut Rates| rates.burst = 1.0] {
            let damaged = one(change);
            assert_eq!(damaged.len(), 10);
            assert!(damaged.iter().map(Vec::len).all(|length| length == 20));
            assert_ne!(damaged, clean);
        }
        assert_eq!(one(|rates| rates.delay = 1.0), clean, "late, in order");
        assert_eq!(one(|rates| rates.stall = 1.0), clean, "late, in order");
        let reordered: Vec<u8> = one(|rates| rates.reorder = 1.0).iter().map(|unit| unit[0]).collect();
        assert_eq!(reordered, [1, 0, 3, 2, 5, 4, 7, 6, 9, 8]);
    }

    #[test]
    fn late_units_are_not_out_before_their_time() {
        for rates in [
            Rates { delay: 1.0, delay_us: 50, ..Rates::default() },
            Rates { reorder: 1.0, delay_us: 50, ..Rates::default() },
            Rates { stall: 1.0, stall_us: 50, ..Rates::default() },
        ] {
            let mut wire = BadWire::new(3, rates);
            wire.put(vec![1], 100);
            assert_eq!(wire.take(149), None, "{rates:?}");
            assert_eq!(wire.take(150), Some(vec![1]), "{rates:?}");
        }
    }

    #[test]
    fn the_seed_decides() {
        let rates = Rates::all(0.3);
        assert_eq!(through(rates, 1, 200), through(rates, 1, 200));
        assert_ne!(through(rates, 1, 200).0, through(rates, 2, 200).0);
    }
}
