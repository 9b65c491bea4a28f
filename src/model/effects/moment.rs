//! What the laws of the effects depend on, at one moment of a run.

use crate::Real;

/// One moment of a run. The default: at the origin, standing, nothing known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moment {
    /// Location of the front, m.
    pub location_m: Real,
    /// Speed, m/s, not negative.
    pub speed_mps: Real,
    /// Applied effort as the log or the bus gives it, force over the *believed* γ m, N/kg, traction positive; 0 where
    /// it is not known.
    pub effort_n_per_kg: Real,
    /// Time since the run's departure, s.
    pub since_departure_s: Real,
    /// How long the train stood before its last start, or stands now, s; `None`: since before the run.
    pub stood_s: Option<Real>,
    /// A brake has been applied since the departure.
    pub braked: bool,
    /// Ambient temperature, °C.
    pub temperature_c: Option<Real>,
    /// Date, days on one calendar for all effects of a model; replay and board count from 1970-01-01 UTC.
    pub day: Option<Real>,
}
