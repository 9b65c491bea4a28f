//! Digest of a value: CRC-32C of its postcard bytes, without a buffer for them.
//!
//! Equal bits give equal digests on every machine, so a replay can name the first tick that differs.

use crate::filter::ukf::{Innovation, Reading};
use crate::plain::{self, Plain};
use crate::tick::estimate::Estimate;
use postcard::ser_flavors::Flavor;
use rundown_wire::link::checksum::{Crc32c, crc32c};
use rundown_wire::{Cause, Validity};
use serde::Serialize;

struct Running(Crc32c);

impl Flavor for Running {
    type Output = u32;

    fn try_push(&mut self, byte: u8) -> postcard::Result<()> {
        self.0.update(&[byte]);
        Ok(())
    }

    fn try_extend(&mut self, bytes: &[u8]) -> postcard::Result<()> {
        self.0.update(bytes);
        Ok(())
    }

    fn finalize(self) -> postcard::Result<u32> {
        Ok(self.0.value())
    }
}

/// Digest of bytes.
///
/// ```
/// assert_eq!(rundown::tick::digest::of_bytes(b"123456789"), 0xE306_9283); // the check value of CRC-32C
/// ```
pub fn of_bytes(bytes: &[u8]) -> u32 {
    crc32c(bytes)
}

/// Digest of any value; 0 for one that cannot be written, which none of this library is.
pub fn of<T: Serialize>(value: &T) -> u32 {
    postcard::serialize_with_flavor(value, Running(Crc32c::START)).unwrap_or(0)
}

/// Digest of all that an estimate says, in full precision.
pub fn of_estimate(estimate: &Estimate) -> u32 {
    // A value that is written is not changed.
    let Estimate { mut belief, mut regime, mut confirmed, mut learning, .. } = *estimate;
    plain::digest(|bytes| {
        bytes.numbers(&mut [estimate.time_s, estimate.dt_s]);
        belief.pass(bytes);
        [estimate.effort_n_per_kg, estimate.acceleration_mps2].pass(bytes);
        bytes.numbers(&mut [estimate.gradient_n_per_kg]);
        regime.pass(bytes);
        confirmed.pass(bytes);
        learning.pass(bytes);
        estimate.innovation.is_some().pass(bytes);
        if let Some(Innovation { mut value, mut covariance, readings, .. }) = estimate.innovation {
            value.pass(bytes);
            covariance.pass(bytes);
            readings.map(number).pass(bytes);
        }
        let (validity, cause) = match estimate.validity {
            Validity::Valid => (0, None),
            Validity::Held(cause) => (1, Some(cause)),
            Validity::Invalid(cause) => (2, Some(cause)),
        };
        bytes.choice(validity, 3);
        if let Some(cause) = cause {
            bytes.choice(cause as usize, Cause::ALL.len());
        }
    })
}

fn number(reading: Reading) -> u8 {
    match reading {
        Reading::Missing => 0,
        Reading::Used => 1,
        Reading::Gated => 2,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::gaussian::Gaussian;
    use nalgebra::{matrix, vector};
    use rundown_wire::Regime;

    #[test]
    fn the_digest_of_an_estimate_is_that_of_its_postcard_bytes() {
        let mut belief = Gaussian::independent([1.0, 2.0, 3.0, 4.0, 5.0], [0.1, 0.2, 0.3, 0.4, 0.5]);
        belief.covariance[(3, 1)] = 0.01;
        let innovation = Innovation {
            value: vector![1.5, -0.5],
            covariance: matrix![4.0, 0.5; 0.25, 1.0],
            readings: [Reading::Used, Reading::Gated],
            sequential: [(0.0, 1.0); 2],
        };
        let estimate = Estimate {
            time_s: 20.0,
            dt_s: 10.0,
            belief,
            effort_n_per_kg: Some(0.3),
            acceleration_mps2: None,
            gradient_n_per_kg: -0.02,
            regime: Regime::Coast,
            confirmed: Some(Regime::Brake),
            learning: true,
            innovation: Some(innovation),
            validity: Validity::Held(Cause::Numerics),
        };
        for (innovation, validity) in [
            (Some(innovation), Validity::Held(Cause::Numerics)),
            (None, Validity::Valid),
            (None, Validity::Invalid(Cause::NoLocation)),
        ] {
            let estimate = Estimate { innovation, validity, ..estimate };
            let expected = of(&(
                (estimate.time_s, estimate.dt_s, estimate.belief),
                (estimate.effort_n_per_kg, estimate.acceleration_mps2, estimate.gradient_n_per_kg),
                (estimate.regime, estimate.confirmed, estimate.learning),
                (innovation.map(|it| (it.value, it.covariance, it.readings.map(number))), validity),
            ));
            assert_eq!(of_estimate(&estimate), expected, "{estimate:?}");
        }
    }
}
