//! Effects on the wire and in the store: a number, a section, and at most four values in the order of the table of `WIRE.md`.
//!
//! The table of an [`Unknown`] does not fit into four values. It comes point by point, each in a frame of its own with values (coordinate, number of the point, where, N/kg); point 0 begins
//! a new table. What the board says of it is a summary: (coordinate, number of points, smallest, largest N/kg).

use super::*;
use crate::listed::listed;
use rundown_wire as wire;

/// Why an effect frame was refused; the effects are as before.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum FrameError {
    /// No effect has this number.
    UnknownKind,
    /// Not the number of values that its kind has, or a section where there is none, or none where there is one.
    Shape,
    /// A point of a table that does not follow the one before it.
    OutOfOrder,
    /// The effect itself is refused.
    Refused(EffectError),
}

impl Effect {
    /// Its frame, as the board publishes it. Of an unknown effect a summary.
    pub fn to_frame(&self) -> wire::Effect {
        let values: &[Real] = match self {
            Self::TunnelDrag(e) => &[e.k],
            Self::CurveResistance(e) => &[e.coefficient_roeckl],
            Self::GradientError(e) => &[e.delta_permille],
            Self::SteadyWind(e) => &[e.wind_mps],
            Self::RunWind(e) => &[e.sd_mps],
            Self::MassError(e) => &[e.relative],
            Self::DraggingBrake(e) => &[e.drag_n_per_kg],
            Self::PowerLimitSection(e) => &[e.factor],
            Self::TractionScale(e) => &[e.factor],
            Self::LowAdhesion(e) => &[e.factor, e.below_kmh],
            Self::SpeedScale(e) => &[e.measured_over_true],
            Self::LocationLag(e) => &[e.lag_s],
            Self::TemperatureResistance(e) => &[e.dr0_per_deg_c, e.ref_c],
            Self::SeasonalDrift(e) => &[e.dr0_over_period, e.period_days, e.reference_day],
            Self::BrakeFade(e) => &[e.fade_at_140, e.from_kmh],
            Self::TrainLengthError(e) => &[e.true_length_m],
            Self::WarmUp(e) => &[e.amplitude, e.tau_s],
            Self::DavisError(e) => &[e.dr0, e.dr1, e.dr2],
            Self::Unknown(e) => &summary(e),
        };
        wire::Effect {
            kind: self.kind(),
            section_m: self.section_m().map(|(from_m, to_m)| [from_m, to_m]),
            values: listed(values.iter().copied()),
        }
    }

    /// The frames that tell a board of it: one, or one for each point of an unknown effect.
    pub fn parts(&self) -> impl Iterator<Item = wire::Effect> {
        let points = match self {
            Self::Unknown(unknown) => unknown.table.len(),
            _ => 1,
        };
        (0..points).map(|index| match self {
            Self::Unknown(unknown) => {
                wire::Effect { kind: self.kind(), section_m: None, values: listed(point(unknown, index)) }
            }
            _ => self.to_frame(),
        })
    }

    /// From a frame; not of an unknown effect, whose points belong together.
    ///
    /// # Errors
    /// [`FrameError`].
    ///
    /// ```
    /// use rundown::model::effects::{Effect, WarmUp};
    ///
    /// let effect = Effect::WarmUp(WarmUp { amplitude: 3e-3, tau_s: 300.0 });
    /// assert_eq!(Effect::from_frame(&effect.to_frame()), Ok(effect));
    /// ```
    pub fn from_frame(frame: &wire::Effect) -> Result<Self, FrameError> {
        let one = || values(frame).map(|[value]| value);
        let effect = match frame.kind {
            1 => {
                let [from_m, to_m] = section(frame)?;
                Self::TunnelDrag(TunnelDrag { from_m, to_m, k: one()? })
            }
            2 => Self::CurveResistance(CurveResistance { coefficient_roeckl: one()? }),
            3 => {
                let [from_m, to_m] = section(frame)?;
                Self::GradientError(GradientError { from_m, to_m, delta_permille: one()? })
            }
            4 => Self::SteadyWind(SteadyWind { wind_mps: one()? }),
            5 => Self::RunWind(RunWind { sd_mps: one()? }),
            6 => Self::MassError(MassError { relative: one()? }),
            7 => Self::DraggingBrake(DraggingBrake { drag_n_per_kg: one()? }),
            8 => {
                let [from_m, to_m] = section(frame)?;
                Self::PowerLimitSection(PowerLimitSection { from_m, to_m, factor: one()? })
            }
            9 => Self::TractionScale(TractionScale { factor: one()? }),
            10 => {
                let [factor, below_kmh] = values(frame)?;
                Self::LowAdhesion(LowAdhesion { factor, below_kmh })
            }
            11 => Self::SpeedScale(SpeedScale { measured_over_true: one()? }),
            12 => Self::LocationLag(LocationLag { lag_s: one()? }),
            13 => {
                let [dr0_per_deg_c, ref_c] = values(frame)?;
                Self::TemperatureResistance(TemperatureResistance { dr0_per_deg_c, ref_c })
            }
            14 => {
                let [dr0_over_period, period_days, reference_day] = values(frame)?;
                Self::SeasonalDrift(SeasonalDrift { dr0_over_period, period_days, reference_day })
            }
            15 => {
                let [fade_at_140, from_kmh] = values(frame)?;
                Self::BrakeFade(BrakeFade { fade_at_140, from_kmh })
            }
            16 => Self::TrainLengthError(TrainLengthError { true_length_m: one()? }),
            17 => {
                let [amplitude, tau_s] = values(frame)?;
                Self::WarmUp(WarmUp { amplitude, tau_s })
            }
            18 => {
                let [dr0, dr1, dr2] = values(frame)?;
                Self::DavisError(DavisError { dr0, dr1, dr2 })
            }
            _ => return Err(FrameError::UnknownKind),
        };
        if effect.section_m().is_some() != frame.section_m.is_some() {
            return Err(FrameError::Shape);
        }
        effect.check().map_err(FrameError::Refused)?;
        Ok(effect)
    }
}

/// Number of [`Unknown`].
pub(crate) const UNKNOWN: u8 = 19;

/// A point of a table: coordinate, where, N/kg, and its number.
pub(super) fn point_of(frame: &wire::Effect) -> Result<(Coordinate, usize, (f32, f32)), FrameError> {
    let [coordinate, index, at, n_per_kg] = values(frame)?;
    let number = |value: Real| (0..MAX_POINTS).find(|index| *index as Real == value);
    let coordinate = number(coordinate).and_then(|number| Coordinate::ALL.get(number).copied());
    match (coordinate, number(index), frame.section_m) {
        (Some(coordinate), Some(index), None) => Ok((coordinate, index, (at as f32, n_per_kg as f32))),
        _ => Err(FrameError::Shape),
    }
}

fn point(unknown: &Unknown, index: usize) -> [Real; 4] {
    let (at, n_per_kg) = unknown.table.get(index).copied().unwrap_or_default();
    [Real::from(unknown.coordinate as u8), index as Real, Real::from(at), Real::from(n_per_kg)]
}

fn summary(unknown: &Unknown) -> [Real; 4] {
    let values = || unknown.table.iter().map(|(_, n_per_kg)| *n_per_kg);
    [
        Real::from(unknown.coordinate as u8),
        unknown.table.len() as Real,
        Real::from(values().fold(f32::INFINITY, f32::min)),
        Real::from(values().fold(f32::NEG_INFINITY, f32::max)),
    ]
}

fn values<const N: usize>(frame: &wire::Effect) -> Result<[Real; N], FrameError> {
    frame.values.as_slice().try_into().map_err(|_| FrameError::Shape)
}

fn section(frame: &wire::Effect) -> Result<[Real; 2], FrameError> {
    frame.section_m.ok_or(FrameError::Shape)
}
