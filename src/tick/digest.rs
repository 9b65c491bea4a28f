//! Digest of a value: CRC-32C of its postcard bytes, without a buffer for them.
//!
//! Equal bits give equal digests on every machine, so a replay can name the first tick that differs.

use crate::filter::ukf::Reading;
use crate::tick::estimate::Estimate;
use postcard::ser_flavors::Flavor;
use rundown_wire::link::checksum::{Crc32c, crc32c};
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
    let innovation = estimate.innovation.as_ref().map(|innovation| {
        let readings = innovation.readings.map(|reading| match reading {
            Reading::Missing => 0_u8,
            Reading::Used => 1,
            Reading::Gated => 2,
        });
        (innovation.value, innovation.covariance, readings)
    });
    of(&(
        (estimate.time_s, estimate.dt_s, estimate.belief),
        (estimate.effort_n_per_kg, estimate.acceleration_mps2, estimate.gradient_n_per_kg),
        (estimate.regime, estimate.confirmed, estimate.learning),
        (innovation, estimate.validity),
    ))
}
