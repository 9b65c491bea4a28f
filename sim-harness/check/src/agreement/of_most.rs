//! The scale of the speed of most runs of a recorder.
//!
//! In: what each run says of scale and offset. Out: the scale of most of them beside one offset, and how far a single
//! run is from it.

use crate::agreement::{Agreement, Pooled, pooled};
use crate::figure::Figure;
use rundown_files::statistics::{median, spread};
use std::slice;

/// So many runs say what is usual.
const LEAST_USUAL: usize = 6;

/// The scale of most runs of a recorder beside its offset; one run with another wheel does not move it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct OfMost {
    offset_mps: f64,
    /// With what the runs differ by.
    scale: Figure,
}

impl OfMost {
    /// None of too few runs.
    pub(crate) fn of(agreements: &[Option<Agreement>], offset_mps: f64) -> Option<Self> {
        let alone = |agreement: &Agreement| Some(pooled(slice::from_ref(agreement))?.scale_at(offset_mps).value);
        let scales: Vec<f64> = agreements.iter().flatten().filter_map(alone).collect();
        let value = median(&scales).filter(|_| scales.len() >= LEAST_USUAL)?;
        let sd = spread(scales.iter().map(|scale| scale - value));
        Some(Self { offset_mps, scale: Figure { value, sd } })
    }

    /// A run's scale over theirs, all with one offset: on short hops its own hides what a wheel does.
    pub(crate) fn ratio(&self, alone: &Pooled) -> Figure {
        let own = alone.scale_at(self.offset_mps);
        Figure { value: own.value / self.scale.value, sd: own.sd.hypot(self.scale.sd) }
    }
}
