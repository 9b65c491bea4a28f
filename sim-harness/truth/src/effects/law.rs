//! What an effect can change of the truth.

use super::{Affected, EffectError, Expect, Parameter};
use crate::line::Line;
use crate::motion::Motion;
use crate::train::TrainTruth;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use std::f64::consts::PI;

/// A moment of a run, as the laws of the effects see it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Location along the distance travelled, and speed.
    pub motion: Motion,
    /// Since the departure of the run, s; 0 before.
    pub since_departure_s: f64,
    /// How long the train stood before its last start, or stands now, s; `None`: since before the run.
    pub stood_s: Option<f64>,
    /// A brake has been applied since the departure.
    pub braked: bool,
    /// Ambient temperature, °C.
    pub temperature_c: f64,
    /// Where in the period of all runs this run lies, 0 to 1.
    pub season: f64,
}

/// What a law needs to know beside the moment: train and line as they are in this run.
#[derive(Clone, Copy, Debug)]
pub struct Setting<'a> {
    /// The train.
    pub train: &'a TrainTruth,
    /// The line in the direction of travel.
    pub line: &'a Line,
    /// Described over true rotating mass: forces in newton that are stated per described kg.
    pub described_over_true_mass: f64,
}

/// What is left of the train's described limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capability {
    /// Largest effort over the described one: what the driver's share is a share of.
    pub scale: f64,
    /// The effort is not above this share of the largest.
    pub effort_cap: f64,
    /// The power is not above this share of the largest.
    pub power_cap: f64,
}

impl Capability {
    /// All of it.
    pub const WHOLE: Self = Self { scale: 1.0, effort_cap: f64::INFINITY, power_cap: f64::INFINITY };
}

/// What an effect may alter before a run: line (in the `up` direction), train, wind and readings.
#[derive(Debug)]
pub struct Altered {
    /// The line.
    pub line: Line,
    /// The train before the load of the day.
    pub train: TrainTruth,
    /// Wind against the direction of travel, m/s.
    pub headwind_mps: f64,
    /// Indicated over true speed.
    pub speed_scale: f64,
    /// How late the location is beyond the sensors' latency, s.
    pub location_lag_s: f64,
    /// +1 for a run up, -1 for one down.
    pub up_sign: f64,
    /// Draws of the run.
    pub draws: ChaCha8Rng,
}

impl Altered {
    /// A draw of this run.
    pub fn unit_normal(&mut self) -> f64 {
        Normal::new(0.0, 1.0).expect("constant").sample(&mut self.draws)
    }
}

/// Which runs share the fate of being affected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Together {
    /// Each run for itself.
    Nothing,
    /// All runs of a day.
    Day,
}

/// The parameters of a kind of effect.
pub trait Parameters {
    /// With their names, in the order of files.
    fn parameters(&self) -> Vec<(&'static str, Parameter<'_>)>;
}

/// The law of a kind of effect. What it does not state, it leaves as it is.
pub trait Law: Parameters {
    /// Checks what the ranges of the parameters do not say.
    ///
    /// # Errors
    /// [`EffectError`] names effect, parameter and what was expected.
    fn check(&self, _expect: &Expect) -> Result<(), EffectError> {
        Ok(())
    }

    /// The runs in which it acts, where these are not all.
    fn affected(&self) -> Option<(&Affected, Together)> {
        None
    }

    /// Alters what a run meets as a whole.
    fn alter(&self, _world: &mut Altered) {}

    /// Resistance that it adds, N/kg of true rotating mass, positive against travel.
    fn extra_n_per_kg(&self, _setting: &Setting, _at: &Moment) -> f64 {
        0.0
    }

    /// Caps traction.
    fn cap(&self, _left: &mut Capability, _at: Motion) {}

    /// What arrives of a demanded brake, 0 to 1.
    fn brake_share(&self, _speed_mps: f64) -> f64 {
        1.0
    }

    /// The ends of its section, m, if it is asked for them in a run. What alters the line is reversed with it.
    fn section_mut(&mut self) -> Option<[&mut f64; 2]> {
        None
    }

    /// For an effect that is in no catalogue: the coordinate it depends on.
    fn unknown_coordinate(&self) -> Option<&'static str> {
        None
    }
}

/// 1 in the middle, 0 at ±1 and beyond, smooth.
pub(super) fn raised_cosine(x: f64) -> f64 {
    if x.abs() < 1.0 { (1.0 + (PI * x).cos()) / 2.0 } else { 0.0 }
}
