//! What is put right in the speeds of a recorder.

use serde::Serialize;

/// What is put right in the speeds of a recorder.
///
/// ```text
/// read = scale v - offset        v = (read + offset)/scale
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Correction {
    /// True less read speed, m/s: half a step where the recorder truncates, less than none by as much where it rounds
    /// up, or what all its readings are off by.
    pub offset_mps: f64,
    /// Measured over true speed.
    pub scale: f64,
}

impl Correction {
    /// Nothing is put right.
    pub const NONE: Self = Self { offset_mps: 0.0, scale: 1.0 };

    /// What it puts right beyond another one.
    pub(crate) fn beside(&self, other: &Self) -> Self {
        Self { offset_mps: (self.offset_mps - other.offset_mps) / other.scale, scale: self.scale / other.scale }
    }

    /// The true speed from a reading, m/s. A standing train reads zero, or what its recorder is off by.
    pub fn true_mps(&self, read_mps: f64) -> f64 {
        if read_mps > 0.0 { ((read_mps + self.offset_mps) / self.scale).max(0.0) } else { read_mps }
    }

    /// The reading of a true speed, m/s.
    ///
    /// ```
    /// use rundown_check::Correction;
    ///
    /// let wheel = Correction { offset_mps: 0.5 / 3.6, scale: 1.013 };
    /// assert!((wheel.true_mps(wheel.read_mps(20.0)) - 20.0).abs() < 1e-9);
    /// ```
    pub fn read_mps(&self, true_mps: f64) -> f64 {
        if true_mps > 0.0 { (true_mps * self.scale - self.offset_mps).max(0.0) } else { true_mps }
    }
}

impl Default for Correction {
    fn default() -> Self {
        Self::NONE
    }
}
