//! What is drawn behind the values and no frame of the board has: the train as its manufacturer describes it, stops,
//! limits, gradients.
//!
//! In: train and track files, each or none; what was sent to the board. Out: [`Setup`], which the page gets whenever it
//! changes.

use rundown_files::{track_file::TrackFile, train_file::TrainFile};
use serde::Serialize;

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Setup {
    /// The train; its `davis` is the manufacturer's curve.
    pub train: Option<TrainFile>,
    pub track: Option<TrackFile>,
}

impl Setup {
    /// The manufacturer's r(v), N/kg, at a speed in m/s.
    pub fn manufacturer(&self, speed_mps: f64) -> Option<f64> {
        Some(self.train.as_ref()?.davis.resistance_n_per_kg(speed_mps))
    }

    /// What is missing here from there.
    pub fn or(self, other: &Self) -> Self {
        Self { train: self.train.or_else(|| other.train.clone()), track: self.track.or_else(|| other.track.clone()) }
    }
}
