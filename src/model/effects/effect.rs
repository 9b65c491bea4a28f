//! What an effect changes in the believed model: the law of its kind, applied.

use super::error::within;
use super::law::{Law, Situation};
use super::parameters::Parameters;
use super::{Effect, EffectError, Limits, Moment, Unknown, section};
use crate::Real;
use crate::model::line::Line;
use crate::model::resistance::Davis;

impl Effect {
    /// Its name in files and reports.
    pub const fn name(&self) -> &'static str {
        self.kind().name()
    }

    /// The section of the track where it acts, m; `None`: everywhere.
    pub fn section_m(&self) -> Option<(Real, Real)> {
        for_kind!(self, effect => effect.section_m())
    }

    /// Checks the parameters; a list of effects takes none that was refused.
    ///
    /// # Errors
    /// [`EffectError`] names the first parameter that is out of range (NaN included).
    ///
    /// ```
    /// use rundown::model::effects::{Effect, SteadyWind};
    ///
    /// assert!(Effect::SteadyWind(SteadyWind { wind_mps: 3.0 }).check().is_ok());
    /// let gale = Effect::SteadyWind(SteadyWind { wind_mps: 300.0 });
    /// assert_eq!(gale.check().unwrap_err().to_string(), "steady_wind.wind_mps: expected -40 to 40, found 300");
    /// ```
    pub fn check(&self) -> Result<(), EffectError> {
        if let Self::Unknown(unknown) = self {
            return unknown.check();
        }
        let (kind, frame) = (self.kind(), self.to_frame());
        if let Some([from_m, to_m]) = frame.section_m {
            section::check(kind, from_m, to_m)?;
        }
        let ranges = for_kind!(self, effect => effect.ranges());
        for (range, found) in ranges.iter().zip(&frame.values) {
            within(kind, range, *found)?;
        }
        Ok(())
    }

    /// The table, if it is an unknown effect.
    pub(crate) const fn table(&self) -> Option<&Unknown> {
        if let Self::Unknown(unknown) = self { Some(unknown) } else { None }
    }

    /// Extra resistance against travel that the effect adds to the believed model, N/kg of rotating mass; 0 for effects
    /// that act elsewhere.
    ///
    /// `line` is the believed one, `davis` the coefficients that the model has at this moment (learned or described).
    ///
    /// ```
    /// use rundown::model::effects::{Effect, Moment, SteadyWind};
    /// use rundown::model::line::Line;
    /// use rundown::model::{direction::Direction, track::*};
    /// use rundown::model::train::*;
    ///
    /// let train = Train::try_new(TrainDescription::CASE_STUDY)?;
    /// let track = Track::try_new(1000.0, [])?;
    /// let up = Line { train: &train, track: &track, direction: Direction::Up };
    /// let wind = Effect::SteadyWind(SteadyWind { wind_mps: 2.0 });
    /// let at_30 = Moment { location_m: 500.0, speed_mps: 30.0, ..Moment::default() };
    /// let extra = wind.resistance_n_per_kg(&up, &train.davis(), &at_30);
    /// assert!((extra - 2.8e-5 * (32.0 * 32.0 - 30.0 * 30.0)).abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn resistance_n_per_kg(&self, line: &Line<'_>, davis: &Davis, moment: &Moment) -> Real {
        let at = Situation { line, davis, moment };
        for_kind!(self, law => law.extra_n_per_kg(&at))
    }

    /// The part of an applied effort that [`Effect::resistance_n_per_kg`] takes away again: the law is linear in the
    /// effort, this is its slope. 0 but for [`MassError`](super::MassError).
    pub fn effort_share(&self) -> Real {
        for_kind!(self, law => law.slope_over_effort())
    }

    /// The train's limits with this effect, at a location of its front and a speed; unchanged by effects that act
    /// elsewhere.
    ///
    /// ```
    /// use rundown::model::effects::{Effect, Limits, PowerLimitSection};
    ///
    /// let believed = Limits { effort_n_per_kg: 0.5, power_w_per_kg: 5.0, brake_n_per_kg: 0.66 };
    /// let weak = Effect::PowerLimitSection(PowerLimitSection { from_m: 4e3, to_m: 9e3, factor: 0.6 });
    /// assert!((weak.limit(&believed, 5e3, 30.0).traction_n_per_kg(30.0) - 0.1).abs() < 1e-15);
    /// assert_eq!(weak.limit(&believed, 1e3, 30.0), believed);
    /// ```
    pub fn limit(&self, limits: &Limits, location_m: Real, speed_mps: Real) -> Limits {
        for_kind!(self, law => law.limits_left(limits, location_m, speed_mps))
    }

    /// Location and speed as they are, from the readings; unchanged by effects that act elsewhere.
    ///
    /// `direction_sign` is +1 for up. A late location is carried on by `speed_mps`, the corrected speed.
    pub fn correct(&self, direction_sign: Real, location_m: Real, speed_mps: Real) -> (Real, Real) {
        for_kind!(self, law => law.corrected(direction_sign, location_m, speed_mps))
    }

    /// Standard deviation of the wind from run to run, m/s, if the effect states it.
    pub(super) fn wind_sd_mps(&self) -> Option<Real> {
        for_kind!(self, law => law.wind_between_runs_mps())
    }
}
