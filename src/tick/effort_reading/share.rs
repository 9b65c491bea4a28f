//! What is known of `s`, and of the `s` of ticks of another length.
//!
//! In: a belief of `s` at one tick. Out: that at another one.
//!
//! ```text
//! s = m - τ / Δ          m: kind of the column, 0 a mean, 1/2 a momentary value; τ: its age; Δ: the tick
//! ```
//!
//! Kind and age are the same whatever the tick, so where rows are not evenly spaced
//!
//! ```text
//! s(Δ') = s + (1 - Δ/Δ') (m - s)
//! ```
//!
//! Of kind and age no more is known than their sum: before a column has taught, m = 1/4 ± 1/4 and τ = 0 ± `late_sd_s`,
//! and given `s`
//!
//! ```text
//! m = 1/4 + K (s - 1/4) ± 1/4 sqrt(1 - K)          K = (1/4)² / ((1/4)² + (late_sd_s / Δ)²)
//! ```
//!
//! A mean whose rows were lost is taken right as well: over a tick that is longer than the mean it is as a momentary
//! value that is late by half of it.

use super::{EffortReadingConfig, square};
use crate::plain::plain;

/// Before the first interval a mean and a momentary value are as likely as each other.
const KIND: f32 = 0.25;
/// Standard deviation of the kind, which is that of `s` for a column that is in time.
const KIND_SD: f32 = 0.25;
/// Ticks that differ by less, as a share, are the same: clocks do.
const SAME_TICK: f32 = 0.1;

/// A belief of `s`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Share {
    pub mean: f32,
    /// Nothing is known where it is 0.
    pub variance: f32,
    /// Tick that it is of, s.
    pub tick_s: f32,
}

plain! {
    struct Share { mean, variance, tick_s }
}

impl Share {
    /// Nothing is known.
    pub const UNKNOWN: Self = Self { mean: 0.0, variance: 0.0, tick_s: 0.0 };

    /// Before a column has taught.
    pub fn unknown(config: &EffortReadingConfig, tick_s: f32) -> Self {
        Self { mean: KIND, variance: square(KIND_SD) + square(config.late_sd_s as f32 / tick_s), tick_s }
    }

    pub fn is_known(&self) -> bool {
        self.variance > 0.0
    }

    /// Of a tick as long.
    pub fn is_of(&self, tick_s: f32) -> bool {
        (self.tick_s - tick_s).abs() < SAME_TICK * tick_s
    }

    /// How much the kind goes with `s`: K.
    fn known_of_kind(&self, config: &EffortReadingConfig) -> f32 {
        square(KIND_SD) / (square(KIND_SD) + square(config.late_sd_s as f32 / self.tick_s))
    }

    /// Of another tick.
    pub fn at(self, config: &EffortReadingConfig, tick_s: f32) -> Self {
        if self.is_of(tick_s) {
            return self;
        }
        let (known, ratio) = (self.known_of_kind(config), self.tick_s / tick_s);
        let kind = KIND + known * (self.mean - KIND);
        let mean = self.mean + (1.0 - ratio) * (kind - self.mean);
        let variance =
            square(ratio + (1.0 - ratio) * known) * self.variance + square((1.0 - ratio) * KIND_SD) * (1.0 - known);
        Self { mean, variance, tick_s }
    }

    /// What a change over a tick of `tick_s` is multiplied by beside `s`, and beside what of the kind does not go with
    /// it, s.
    pub fn weights_s(&self, config: &EffortReadingConfig, tick_s: f32) -> [f32; 2] {
        if self.is_of(tick_s) {
            return [tick_s, 0.0];
        }
        let longer_s = tick_s - self.tick_s;
        [self.tick_s + self.known_of_kind(config) * longer_s, longer_s]
    }

    /// What of the kind does not go with `s`: mean and variance.
    pub fn kind_beyond(&self, config: &EffortReadingConfig) -> (f32, f32) {
        let unknown = 1.0 - self.known_of_kind(config);
        (KIND * unknown, square(KIND_SD) * unknown)
    }
}
