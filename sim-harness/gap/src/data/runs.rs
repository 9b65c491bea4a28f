//! Recorded runs as the gap workflow sees them, and how their readings are corrected.

use rundown::model::direction::Direction;
use rundown_files::sample::Sample;

#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Name in every output.
    pub name: String,
    pub direction: Direction,
    /// Day of the departure, since 1970-01-01 UTC, if the index knows it.
    pub day: Option<f64>,
    /// Samples, times increasing.
    pub samples: Vec<Sample>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EffortReading {
    /// At the moment of its sample.
    Momentary,
    /// Mean since the sample before.
    MeanSinceLast,
}

/// Corrections of the readings, found from location against speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Readings {
    /// Measured over true speed.
    pub speed_scale: f64,
    /// To be added to a speed reading, m/s: half a quantum if the recorder truncates.
    pub speed_offset_mps: f64,
    /// The step of the speed readings, m/s; 0 if there is none.
    pub speed_quantum_mps: f64,
    /// The location reading is this old, s.
    pub location_lag_s: f64,
    pub effort: EffortReading,
}

impl Readings {
    /// The true speed from a reading, m/s. The recorder cuts digits off what the wheel shows, which is the scale times the truth; a train that stands has nothing to cut off:
    ///
    /// ```text
    /// read = scale v - offset        v = (read + offset)/scale
    /// ```
    pub fn true_speed_mps(&self, read_mps: f64) -> f64 {
        if read_mps > 0.0 { (read_mps + self.speed_offset_mps) / self.speed_scale } else { 0.0 }
    }
}

impl Default for Readings {
    fn default() -> Self {
        Self {
            speed_scale: 1.0,
            speed_offset_mps: 0.0,
            speed_quantum_mps: 0.0,
            location_lag_s: 0.0,
            effort: EffortReading::Momentary,
        }
    }
}

/// Median time between samples, s; that of a slow log where there is no second sample.
pub fn usual_step_s(run: &Run) -> f64 {
    let mut steps: Vec<f64> = run.samples.windows(2).map(|pair| pair[1].time_s - pair[0].time_s).collect();
    if steps.is_empty() {
        return 10.0;
    }
    steps.sort_by(f64::total_cmp);
    steps[steps.len() / 2]
}
