//! Bit timing of a bxCAN controller, from its clock and the bit rate.
//!
//! ```text
//! bit = 1 + segment 1 + segment 2 quanta            sample point = (1 + segment 1) / bit
//! quantum = prescaler / clock
//! ```
//!
//! The rate is met exactly or refused: what two nodes differ by adds to what their oscillators differ by, and that is
//! all the tolerance there is.

use rundown_wire::errors;

/// Sample point that CiA 301 recommends, per mille of the bit.
const SAMPLE_PERMILLE: u32 = 875;
/// Sample points that CiA 301 allows at every rate, per mille.
const ALLOWED_PERMILLE: [u32; 2] = [850, 900];
/// Quanta of a bit: at least 8 as in ISO 11898-1, at most what the segments hold.
const QUANTA: [u32; 2] = [8, 25];
const MOST_SEGMENT_1: u32 = 16;
const MOST_SEGMENT_2: u32 = 8;
const MOST_JUMP: u32 = 4;
const MOST_PRESCALER: u32 = 1024;

errors! {
    /// Why there is no bit timing.
    #[derive(Eq)]
    pub enum TimingError {
        NoDivisor { clock_hz: u32, bit_s: u32 } => "CAN: {clock_hz} Hz cannot be divided into {bit_s} bit/s",
        /// The rate could be met, the sample point not.
        SamplePoint { clock_hz: u32, bit_s: u32 } =>
            "CAN: no sample point within 85 to 90 % at {bit_s} bit/s from {clock_hz} Hz",
    }
}

/// A bit, in quanta.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BitTiming {
    /// Periods of the clock in a quantum, 1 to 1024.
    pub prescaler: u32,
    /// Quanta from the first to the sample point, 1 to 16.
    pub segment_1: u32,
    /// Quanta from the sample point to the end, 1 to 8.
    pub segment_2: u32,
    /// Most quanta that a bit is stretched or shortened by to follow the others, 1 to 4.
    pub jump: u32,
}

impl BitTiming {
    /// The timing of `bit_s` bit/s from a clock of `clock_hz` Hz whose sample point is nearest to 87.5 %; of several
    /// the one with the finest quanta.
    ///
    /// ```
    /// use rundown::onboard::can::timing::BitTiming;
    ///
    /// let timing = BitTiming::new(80_000_000, 250_000)?;
    /// // 80 MHz / 20 = 4 MHz; 1 + 13 + 2 = 16 quanta
    /// assert_eq!((timing.prescaler, timing.segment_1, timing.segment_2), (20, 13, 2));
    /// assert_eq!(timing.sample_permille(), 875);
    /// # Ok::<(), rundown::onboard::can::timing::TimingError>(())
    /// ```
    ///
    /// # Errors
    /// [`TimingError`]: the clock is no multiple of the rate, or no sample point lies within 85 to 90 %.
    pub const fn new(clock_hz: u32, bit_s: u32) -> Result<Self, TimingError> {
        let mut best: Option<Self> = None;
        let mut divides = false;
        let mut quanta = QUANTA[1];
        while quanta >= QUANTA[0] {
            // At most 25 quanta of a 32-bit rate.
            let per_second = bit_s as u64 * quanta as u64;
            let clock = clock_hz as u64;
            if per_second > 0
                && clock > 0
                && clock.is_multiple_of(per_second)
                && clock / per_second <= MOST_PRESCALER as u64
            {
                divides = true;
                let prescaler = (clock / per_second) as u32;
                // The two whole numbers of quanta around the recommended point.
                let before = quanta * SAMPLE_PERMILLE / 1000;
                let mut sample = before;
                while sample <= before + 1 {
                    if let Some(timing) = Self::sampled_at(prescaler, quanta, sample)
                        && timing.is_nearer_than(best)
                    {
                        best = Some(timing);
                    }
                    sample += 1;
                }
            }
            quanta -= 1;
        }
        match best {
            Some(timing) => Ok(timing),
            None if divides => Err(TimingError::SamplePoint { clock_hz, bit_s }),
            None => Err(TimingError::NoDivisor { clock_hz, bit_s }),
        }
    }

    /// Where the controller reads the bit, per mille of it.
    pub const fn sample_permille(self) -> u32 {
        1000 * (1 + self.segment_1) / (1 + self.segment_1 + self.segment_2)
    }

    /// The timing register, BTR.
    pub const fn bits(self) -> u32 {
        (self.jump - 1) << 24 | (self.segment_2 - 1) << 20 | (self.segment_1 - 1) << 16 | (self.prescaler - 1)
    }

    const fn sampled_at(prescaler: u32, quanta: u32, sample: u32) -> Option<Self> {
        let (segment_1, segment_2) = (sample - 1, quanta - sample);
        let exists = segment_1 <= MOST_SEGMENT_1 && 1 <= segment_2 && segment_2 <= MOST_SEGMENT_2;
        let jump = if segment_2 < MOST_JUMP { segment_2 } else { MOST_JUMP };
        let timing = Self { prescaler, segment_1, segment_2, jump };
        let allowed = exists
            && ALLOWED_PERMILLE[0] <= timing.sample_permille()
            && timing.sample_permille() <= ALLOWED_PERMILLE[1];
        if allowed { Some(timing) } else { None }
    }

    const fn is_nearer_than(self, best: Option<Self>) -> bool {
        match best {
            Some(best) => self.off() < best.off(),
            None => true,
        }
    }

    const fn off(self) -> u32 {
        self.sample_permille().abs_diff(SAMPLE_PERMILLE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rate(timing: BitTiming, clock_hz: u32) -> u32 {
        clock_hz / (timing.prescaler * (1 + timing.segment_1 + timing.segment_2))
    }

    #[test]
    fn each_rate_of_cia_301_is_met_exactly_at_80_mhz() {
        for (bit_s, permille, bits) in [
            (125_000, 875, 0x011C_0027),
            (250_000, 875, 0x011C_0013),
            (500_000, 875, 0x011C_0009),
            // 100 periods are 20 quanta of 5: 17 / 20.
            (800_000, 850, 0x022F_0004),
            (1_000_000, 875, 0x011C_0004),
        ] {
            let timing = BitTiming::new(80_000_000, bit_s).unwrap();
            assert_eq!(rate(timing, 80_000_000), bit_s);
            assert_eq!(timing.sample_permille(), permille, "{bit_s}");
            assert_eq!(timing.bits(), bits, "{bit_s}: {:#x}", timing.bits());
        }
    }

    #[test]
    fn the_slow_clock_still_has_the_slow_rates() {
        for bit_s in [125_000, 250_000, 500_000] {
            let timing = BitTiming::new(4_000_000, bit_s).unwrap();
            assert_eq!((rate(timing, 4_000_000), timing.sample_permille()), (bit_s, 875));
        }
        // 5 and 4 periods are fewer than the 8 quanta of a bit.
        for bit_s in [800_000, 1_000_000] {
            let error = TimingError::NoDivisor { clock_hz: 4_000_000, bit_s };
            assert_eq!(BitTiming::new(4_000_000, bit_s), Err(error));
        }
    }

    #[test]
    fn a_rate_that_is_not_met_exactly_is_refused() {
        for (clock_hz, bit_s) in
            [(80_000_000, 300_000), (80_000_000, 0), (0, 250_000), (80_000_000, 1_000), (u32::MAX, u32::MAX)]
        {
            assert_eq!(BitTiming::new(clock_hz, bit_s), Err(TimingError::NoDivisor { clock_hz, bit_s }));
        }
    }

    #[test]
    fn a_rate_without_a_sample_point_is_refused() {
        // 9 quanta and no other number: 7 / 9 or 8 / 9. 11: 9 / 11 = 81.8 % or 10 / 11 = 90.9 %.
        assert_eq!(BitTiming::new(9_000_000, 1_000_000).unwrap().sample_permille(), 888);
        let error = TimingError::SamplePoint { clock_hz: 11_000_000, bit_s: 1_000_000 };
        assert_eq!(BitTiming::new(11_000_000, 1_000_000), Err(error));
    }

    #[test]
    fn every_field_fits_its_bits() {
        for clock_hz in (1..=80).map(|mhz| mhz * 1_000_000) {
            for bit_s in [10_000, 20_000, 50_000, 125_000, 250_000, 500_000, 800_000, 1_000_000] {
                let Ok(timing) = BitTiming::new(clock_hz, bit_s) else { continue };
                assert!((1..=1024).contains(&timing.prescaler) && (1..=16).contains(&timing.segment_1));
                assert!((1..=8).contains(&timing.segment_2) && (1..=4).contains(&timing.jump));
                assert!(timing.jump <= timing.segment_2);
            }
        }
    }
}
