//! The effects of a model.

use super::frame::point_of;
use super::{Effect, EffectError, FrameError, Limits, Moment, Unknown};
use crate::Real;
use crate::extremes::Extremes;
use crate::listed::listed;
use crate::model::line::Line;
use crate::model::resistance::Davis;
use crate::model::train::Train;
use heapless::Vec;
use rundown_wire::{self as wire, EffectKind};

/// Most effects of a model.
pub const MAX_EFFECTS: usize = 8;

/// The effects of a model, checked; at most [`MAX_EFFECTS`], of them at most one [`Unknown`](super::Unknown) (the board
/// keeps one table). Empty by default.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Effects {
    list: Vec<Effect, MAX_EFFECTS>,
}

impl Effects {
    /// None.
    pub const NONE: Self = Self { list: Vec::new() };

    /// A list of checked effects.
    ///
    /// # Errors
    /// As [`Effects::push`], for the first effect that is refused.
    pub fn try_new(effects: impl IntoIterator<Item = Effect>) -> Result<Self, EffectError> {
        let mut list = Self::NONE;
        for effect in effects {
            list.push(effect)?;
        }
        Ok(list)
    }

    /// Checks an effect and appends it.
    ///
    /// # Errors
    /// [`EffectError`]; the list is as before.
    ///
    /// ```
    /// use rundown::model::effects::{DavisError, Effect, Effects};
    ///
    /// let mut effects = Effects::NONE;
    /// effects.push(Effect::DavisError(DavisError { dr0: 1e-3, dr1: 0.0, dr2: 0.0 }))?;
    /// assert_eq!(effects.iter().map(Effect::name).collect::<Vec<_>>(), ["davis_error"]);
    /// # Ok::<(), rundown::model::effects::EffectError>(())
    /// ```
    pub fn push(&mut self, effect: Effect) -> Result<(), EffectError> {
        effect.check()?;
        if effect.table().is_some() && self.table().is_some() {
            return Err(EffectError::Twice { effect: effect.kind() });
        }
        self.list.push(effect).map_err(|_| EffectError::TooMany { most: MAX_EFFECTS })
    }

    /// Takes an effect from a frame: appends it, or one point of the table of an unknown effect. The last one once more
    /// changes nothing: who got no answer asks again.
    ///
    /// # Errors
    /// [`FrameError`]; the list is as before.
    pub fn take(&mut self, frame: &wire::Effect) -> Result<(), FrameError> {
        if frame.kind == EffectKind::Unknown.number() {
            return self.take_point(frame);
        }
        if self.list.last().is_some_and(|last| last.to_frame() == *frame) {
            return Ok(());
        }
        let effect = Effect::from_frame(frame)?;
        self.push(effect).map_err(FrameError::Refused)
    }

    fn take_point(&mut self, frame: &wire::Effect) -> Result<(), FrameError> {
        let (coordinate, index, point) = point_of(frame)?;
        let table = self
            .list
            .iter_mut()
            .find_map(|effect| if let Effect::Unknown(unknown) = effect { Some(unknown) } else { None });
        match table {
            None if index > 0 => Err(FrameError::OutOfOrder),
            None => {
                let table = listed([point]);
                let unknown = Effect::Unknown(Unknown { coordinate, table });
                self.push(unknown).map_err(FrameError::Refused)
            }
            Some(unknown) if index == 0 => {
                let table = listed([point]);
                let replaced = Unknown { coordinate, table };
                replaced.check().map_err(FrameError::Refused)?;
                *unknown = replaced;
                Ok(())
            }
            Some(unknown) => {
                if unknown.coordinate != coordinate || unknown.table.len() != index {
                    return Err(FrameError::OutOfOrder);
                }
                // There is room: a point's number is below the capacity.
                let _fits = unknown.table.push(point).is_ok();
                unknown.check().map_err(|error| {
                    unknown.table.pop();
                    FrameError::Refused(error)
                })
            }
        }
    }

    /// The table of the unknown effect.
    pub(crate) fn table(&self) -> Option<&Unknown> {
        self.iter().find_map(Effect::table)
    }

    /// The frame in which the board publishes them.
    pub fn to_frame(&self) -> wire::Effects {
        wire::Effects { effects: listed(self.iter().map(Effect::to_frame)) }
    }

    /// Takes all effects out.
    pub fn clear(&mut self) {
        self.list.clear();
    }

    /// There are none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// All of them, in order.
    pub fn iter(&self) -> impl Iterator<Item = &Effect> {
        self.list.iter()
    }

    /// Extra resistance of all effects together, N/kg; see [`Effect::resistance_n_per_kg`].
    pub fn resistance_n_per_kg(&self, line: &Line<'_>, davis: &Davis, moment: &Moment) -> Real {
        self.iter().map(|effect| effect.resistance_n_per_kg(line, davis, moment)).sum()
    }

    /// Applied effort, per believed γ m, that a resultant (acceleration and all resistances, those of the effects at no
    /// effort included) asks for. Another figure than the resultant only where the mass is wrong.
    pub fn effort_n_per_kg(&self, resultant_n_per_kg: Real) -> Real {
        let share: Real = self.iter().map(Effect::effort_share).sum();
        // Bounded by the range of a mass error; several of them may not turn the sign of an effort.
        resultant_n_per_kg / (1.0 - share).at_least(0.1)
    }

    /// The limits of a train with all effects.
    pub fn limits(&self, train: &Train, location_m: Real, speed_mps: Real) -> Limits {
        self.iter().fold(Limits::of(train), |limits, effect| effect.limit(&limits, location_m, speed_mps))
    }

    /// Largest tractive effort and largest brake effort of a train with all effects, N/kg, both positive.
    pub fn limits_n_per_kg(&self, train: &Train, location_m: Real, speed_mps: Real) -> (Real, Real) {
        if self.is_empty() {
            return (train.max_effort_n_per_kg(speed_mps), train.max_brake_n_per_kg());
        }
        let limits = self.limits(train, location_m, speed_mps);
        (limits.traction_n_per_kg(speed_mps), limits.brake_n_per_kg)
    }

    /// Location and speed as they are, from the readings; see [`Effect::correct`]. The speed is put right before a late
    /// location is carried on by it.
    ///
    /// ```
    /// use rundown::model::effects::{Effect, Effects, LocationLag, SpeedScale};
    ///
    /// let effects = Effects::try_new([
    ///     Effect::LocationLag(LocationLag { lag_s: 2.0 }),
    ///     Effect::SpeedScale(SpeedScale { measured_over_true: 1.25 }),
    /// ])?;
    /// assert_eq!(effects.correct(-1.0, 1000.0, 25.0), (960.0, 20.0));
    /// # Ok::<(), rundown::model::effects::EffectError>(())
    /// ```
    pub fn correct(&self, direction_sign: Real, location_m: Real, speed_mps: Real) -> (Real, Real) {
        let speed_mps = self.true_speed_mps(speed_mps);
        let location_m = self.true_location_m(direction_sign, location_m, speed_mps);
        (location_m, speed_mps)
    }

    /// The speed as it is, from its reading.
    pub fn true_speed_mps(&self, reading_mps: Real) -> Real {
        self.iter().fold(reading_mps, |speed_mps, effect| effect.correct(1.0, 0.0, speed_mps).1)
    }

    /// The location as it is, from its reading and the speed as it is.
    pub fn true_location_m(&self, direction_sign: Real, reading_m: Real, speed_mps: Real) -> Real {
        self.iter().fold(reading_m, |location_m, effect| effect.correct(direction_sign, location_m, speed_mps).0)
    }

    /// Standard deviation of the wind from run to run, where an effect states it, m/s: it takes the place of the
    /// memory's setting.
    pub fn wind_sd_mps(&self) -> Option<Real> {
        self.iter().find_map(Effect::wind_sd_mps)
    }
}
