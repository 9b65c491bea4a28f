//! Named physical effects that a believed model of train and track may lack, each with its law. The gap workflow finds them, the board runs them.
//!
//! In: where the train is, how fast, since when ([`Moment`]). Out, by what the effect acts on:
//!
//! | acts on | function | effects |
//! |---|---|---|
//! | motion | [`Effect::resistance_n_per_kg`]: extra resistance against travel, N/kg of rotating mass γ m | [`TunnelDrag`], [`CurveResistance`], [`GradientError`], [`SteadyWind`], [`MassError`], [`DraggingBrake`], [`TemperatureResistance`], [`SeasonalDrift`], [`TrainLengthError`], [`WarmUp`], [`DavisError`], [`Unknown`] |
//! | limits of the train | [`Effect::limit`] | [`PowerLimitSection`], [`TractionScale`], [`LowAdhesion`], [`BrakeFade`] |
//! | readings | [`Effect::correct`] | [`SpeedScale`], [`LocationLag`] |
//! | differences between runs | [`Effects::wind_sd_mps`] | [`RunWind`] |
//!
//! ```text
//! a = u - r(v) - g(s) - Σ extra             Eq. (1) with the effects
//! ```
//!
//! Each function gives 0, or what it got, for effects that act elsewhere, so a sum over any list of effects is right. Extra resistances add up; limits and corrections are applied in
//! the order of the list. What an effect needs and nobody knows (temperature, date) leaves it at 0.
//!
//! Every effect has a wire number, [`Effect::kind`]; with the feature `alloc` it is read and written by name, as `[[effect]] name = "tunnel_drag"` in a train or track file.

mod acting;
mod brake_fade;
mod curve_resistance;
mod davis_error;
mod dragging_brake;
mod error;
mod frame;
mod gradient_error;
mod limits;
mod list;
mod location_lag;
mod low_adhesion;
mod mass_error;
mod moment;
mod power_limit_section;
mod run_wind;
mod seasonal_drift;
mod section;
mod speed_scale;
mod steady_wind;
mod temperature_resistance;
mod traction_scale;
mod train_length_error;
mod tunnel_drag;
mod unknown;
mod warm_up;

pub use acting::{Acting, Journey, Surroundings};
pub use brake_fade::BrakeFade;
pub use curve_resistance::CurveResistance;
pub use davis_error::DavisError;
pub use dragging_brake::DraggingBrake;
pub use error::EffectError;
pub use frame::FrameError;
pub(crate) use frame::UNKNOWN;
pub use gradient_error::GradientError;
pub use limits::Limits;
pub use list::{Effects, MAX_EFFECTS};
pub use location_lag::LocationLag;
pub use low_adhesion::LowAdhesion;
pub use mass_error::MassError;
pub use moment::Moment;
pub use power_limit_section::PowerLimitSection;
pub use run_wind::RunWind;
pub use seasonal_drift::SeasonalDrift;
pub use section::share_inside;
pub use speed_scale::SpeedScale;
pub use steady_wind::SteadyWind;
pub use temperature_resistance::TemperatureResistance;
pub use traction_scale::TractionScale;
pub use train_length_error::TrainLengthError;
pub use tunnel_drag::TunnelDrag;
pub use unknown::{Coordinate, MAX_POINTS, Unknown};
pub use warm_up::WarmUp;

use crate::Real;
use crate::model::line::Line;
use crate::model::resistance::Davis;
#[cfg(feature = "alloc")]
use serde::{Deserialize, Serialize};

/// A named effect with its parameters.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "alloc", derive(Serialize, Deserialize), serde(tag = "name", rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Effect {
    /// 1: more air resistance in a tunnel.
    TunnelDrag(TunnelDrag),
    /// 2: resistance of curves.
    CurveResistance(CurveResistance),
    /// 3: the described gradient is wrong on a section.
    GradientError(GradientError),
    /// 4: a wind that blows in every run.
    SteadyWind(SteadyWind),
    /// 5: a wind that differs from run to run.
    RunWind(RunWind),
    /// 6: the described mass is wrong.
    MassError(MassError),
    /// 7: a brake that does not release.
    DraggingBrake(DraggingBrake),
    /// 8: less power in a feeding section.
    PowerLimitSection(PowerLimitSection),
    /// 9: another maximum of effort and power everywhere.
    TractionScale(TractionScale),
    /// 10: wheels slip at low speed.
    LowAdhesion(LowAdhesion),
    /// 11: the odometer reads too much or too little.
    SpeedScale(SpeedScale),
    /// 12: the location comes late.
    LocationLag(LocationLag),
    /// 13: r0 depends on the ambient temperature.
    TemperatureResistance(TemperatureResistance),
    /// 14: r0 drifts over the dates of the runs.
    SeasonalDrift(SeasonalDrift),
    /// 15: the brake weakens with speed.
    BrakeFade(BrakeFade),
    /// 16: the described length is wrong.
    TrainLengthError(TrainLengthError),
    /// 17: r0 is larger in the first minutes.
    WarmUp(WarmUp),
    /// 18: the described Davis coefficients are wrong.
    DavisError(DavisError),
    /// 19: none of these: a table over one coordinate.
    Unknown(Unknown),
}

impl Effect {
    /// Its name in files and reports.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::TunnelDrag(_) => TunnelDrag::NAME,
            Self::CurveResistance(_) => CurveResistance::NAME,
            Self::GradientError(_) => GradientError::NAME,
            Self::SteadyWind(_) => SteadyWind::NAME,
            Self::RunWind(_) => RunWind::NAME,
            Self::MassError(_) => MassError::NAME,
            Self::DraggingBrake(_) => DraggingBrake::NAME,
            Self::PowerLimitSection(_) => PowerLimitSection::NAME,
            Self::TractionScale(_) => TractionScale::NAME,
            Self::LowAdhesion(_) => LowAdhesion::NAME,
            Self::SpeedScale(_) => SpeedScale::NAME,
            Self::LocationLag(_) => LocationLag::NAME,
            Self::TemperatureResistance(_) => TemperatureResistance::NAME,
            Self::SeasonalDrift(_) => SeasonalDrift::NAME,
            Self::BrakeFade(_) => BrakeFade::NAME,
            Self::TrainLengthError(_) => TrainLengthError::NAME,
            Self::WarmUp(_) => WarmUp::NAME,
            Self::DavisError(_) => DavisError::NAME,
            Self::Unknown(_) => Unknown::NAME,
        }
    }

    /// Its number on the wire and in the store, 1 to 19, in the order of the variants. A number once given stays.
    pub const fn kind(&self) -> u8 {
        match self {
            Self::TunnelDrag(_) => 1,
            Self::CurveResistance(_) => 2,
            Self::GradientError(_) => 3,
            Self::SteadyWind(_) => 4,
            Self::RunWind(_) => 5,
            Self::MassError(_) => 6,
            Self::DraggingBrake(_) => 7,
            Self::PowerLimitSection(_) => 8,
            Self::TractionScale(_) => 9,
            Self::LowAdhesion(_) => 10,
            Self::SpeedScale(_) => 11,
            Self::LocationLag(_) => 12,
            Self::TemperatureResistance(_) => 13,
            Self::SeasonalDrift(_) => 14,
            Self::BrakeFade(_) => 15,
            Self::TrainLengthError(_) => 16,
            Self::WarmUp(_) => 17,
            Self::DavisError(_) => 18,
            Self::Unknown(_) => 19,
        }
    }

    /// The section of the track where it acts, m; `None`: everywhere.
    pub const fn section_m(&self) -> Option<(Real, Real)> {
        match self {
            Self::TunnelDrag(effect) => Some((effect.from_m, effect.to_m)),
            Self::GradientError(effect) => Some((effect.from_m, effect.to_m)),
            Self::PowerLimitSection(effect) => Some((effect.from_m, effect.to_m)),
            _ => None,
        }
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
    /// assert_eq!(gale.check().unwrap_err().to_string(), "effect steady_wind: wind_mps must be -40 to 40, found 300");
    /// ```
    pub fn check(&self) -> Result<(), EffectError> {
        match self {
            Self::TunnelDrag(effect) => effect.check(),
            Self::CurveResistance(effect) => effect.check(),
            Self::GradientError(effect) => effect.check(),
            Self::SteadyWind(effect) => effect.check(),
            Self::RunWind(effect) => effect.check(),
            Self::MassError(effect) => effect.check(),
            Self::DraggingBrake(effect) => effect.check(),
            Self::PowerLimitSection(effect) => effect.check(),
            Self::TractionScale(effect) => effect.check(),
            Self::LowAdhesion(effect) => effect.check(),
            Self::SpeedScale(effect) => effect.check(),
            Self::LocationLag(effect) => effect.check(),
            Self::TemperatureResistance(effect) => effect.check(),
            Self::SeasonalDrift(effect) => effect.check(),
            Self::BrakeFade(effect) => effect.check(),
            Self::TrainLengthError(effect) => effect.check(),
            Self::WarmUp(effect) => effect.check(),
            Self::DavisError(effect) => effect.check(),
            Self::Unknown(effect) => effect.check(),
        }
    }

    /// Extra resistance against travel that the effect adds to the believed model, N/kg of rotating mass; 0 for effects that act elsewhere.
    ///
    /// `line` is the believed one, `davis` the coefficients that the model has at this moment (learned or described).
    ///
    /// ```
    /// use rundown::model::effects::{Effect, Moment, SteadyWind};
    /// use rundown::model::line::Line;
    /// use rundown::model::resistance::Davis;
    /// use rundown::model::{direction::Direction, track::*};
    /// use rundown::model::train::*;
    ///
    /// # let description = TrainDescription::CASE_STUDY;
    /// let train = Train::try_new(description)?;
    /// let track = Track::try_new(1000.0, [])?;
    /// let up = Line { train: &train, track: &track, direction: Direction::Up };
    /// let wind = Effect::SteadyWind(SteadyWind { wind_mps: 2.0 });
    /// let at_30 = Moment { location_m: 500.0, speed_mps: 30.0, ..Moment::default() };
    /// let extra = wind.resistance_n_per_kg(&up, &train.davis(), &at_30);
    /// assert!((extra - 2.8e-5 * (32.0 * 32.0 - 30.0 * 30.0)).abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn resistance_n_per_kg(&self, line: &Line<'_>, davis: &Davis, moment: &Moment) -> Real {
        let speed_mps = moment.speed_mps;
        let gravity_n_per_kg = line.train.gravity_n_per_kg();
        let sign = line.direction.sign();
        let share = |from_m, to_m| {
            let length_m = line.train.length_m();
            share_inside(from_m, to_m, moment.location_m, length_m, line.direction)
        };
        match self {
            Self::TunnelDrag(effect) => effect.resistance_n_per_kg(speed_mps, share(effect.from_m, effect.to_m)),
            Self::CurveResistance(effect) => {
                let length_m = line.train.length_m();
                let mean = line.track.mean_roeckl(moment.location_m, length_m, line.direction);
                effect.resistance_n_per_kg(gravity_n_per_kg, mean)
            }
            Self::GradientError(effect) => {
                effect.resistance_n_per_kg(gravity_n_per_kg, share(effect.from_m, effect.to_m), sign)
            }
            Self::SteadyWind(effect) => effect.resistance_n_per_kg(davis.r2, speed_mps, sign),
            Self::MassError(effect) => effect.resistance_n_per_kg(davis.r2, speed_mps, moment.effort_n_per_kg),
            Self::DraggingBrake(effect) => effect.resistance_n_per_kg(moment.braked),
            Self::TemperatureResistance(effect) => effect.resistance_n_per_kg(moment.temperature_c),
            Self::SeasonalDrift(effect) => effect.resistance_n_per_kg(moment.day),
            Self::TrainLengthError(effect) => {
                let mean = |length_m| line.track.mean_gradient(moment.location_m, length_m, line.direction);
                let believed = mean(line.train.length_m());
                effect.resistance_n_per_kg(gravity_n_per_kg, mean(effect.true_length_m), believed)
            }
            Self::WarmUp(effect) => effect.resistance_n_per_kg(moment.since_departure_s),
            Self::DavisError(effect) => effect.resistance_n_per_kg(speed_mps),
            Self::Unknown(effect) => effect.resistance_n_per_kg(moment),
            Self::RunWind(_)
            | Self::PowerLimitSection(_)
            | Self::TractionScale(_)
            | Self::LowAdhesion(_)
            | Self::SpeedScale(_)
            | Self::LocationLag(_)
            | Self::BrakeFade(_) => 0.0,
        }
    }

    /// The part of an applied effort that [`Effect::resistance_n_per_kg`] takes away again: the law is linear in the effort, this is its slope.
    /// 0 but for [`MassError`].
    pub fn effort_share(&self) -> Real {
        match self {
            Self::MassError(effect) => effect.effort_share(),
            _ => 0.0,
        }
    }

    /// The train's limits with this effect, at a location of its front and a speed; unchanged by effects that act elsewhere.
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
        match self {
            Self::PowerLimitSection(effect) => effect.limit(limits, location_m),
            Self::TractionScale(effect) => effect.limit(limits),
            Self::LowAdhesion(effect) => effect.limit(limits, speed_mps),
            Self::BrakeFade(effect) => effect.limit(limits, speed_mps),
            _ => *limits,
        }
    }

    /// Location and speed as they are, from the readings; unchanged by effects that act elsewhere.
    ///
    /// `direction_sign` is +1 for up. A late location is carried on by `speed_mps`, the corrected speed.
    pub fn correct(&self, direction_sign: Real, location_m: Real, speed_mps: Real) -> (Real, Real) {
        match self {
            Self::SpeedScale(effect) => (location_m, effect.true_speed_mps(speed_mps)),
            Self::LocationLag(effect) => {
                let true_m = effect.true_location_m(direction_sign, location_m, speed_mps);
                (true_m, speed_mps)
            }
            _ => (location_m, speed_mps),
        }
    }
}

#[cfg(test)]
mod tests;
