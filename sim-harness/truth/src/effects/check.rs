//! Whether an effect can be simulated at all.

use super::{Affected, Effect};
use thiserror::Error;

/// Why an effect was refused.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum EffectError {
    /// A parameter is out of range.
    #[error("{effect}: expected {field} {expected}, found {found}")]
    OutOfRange {
        /// Name of the effect.
        effect: &'static str,
        /// Name of the parameter.
        field: &'static str,
        /// What it should be.
        expected: &'static str,
        /// What it is.
        found: f64,
    },
    /// The effect needs something that the line does not have.
    #[error("{effect}: expected a line with curves, found none")]
    NoCurves {
        /// Name of the effect.
        effect: &'static str,
    },
}

impl Effect {
    /// Checks the parameters; `curves` says whether the line has any.
    ///
    /// # Errors
    /// [`EffectError`] names effect, parameter and what was expected.
    pub fn check(&self, curves: bool) -> Result<(), EffectError> {
        use Effect::*;
        let effect = self.name();
        let refuse = |field, expected, found| EffectError::OutOfRange { effect, field, expected, found };
        let finite = |field, value: f64| {
            (value.is_finite() && value.abs() < 1e7).then_some(()).ok_or(refuse(field, "finite", value))
        };
        let positive =
            |field, value: f64| (value.is_finite() && value > 0.0).then_some(()).ok_or(refuse(field, "above 0", value));
        let beyond = |from_m: f64, to_m: f64| {
            finite("from_m", from_m)?;
            finite("to_m", to_m)?;
            (to_m > from_m).then_some(()).ok_or(refuse("to_m", "beyond from_m", to_m))
        };
        let runs = |runs: &Affected| match runs {
            Affected::Share(share) if !(0.0..=1.0).contains(share) => {
                Err(refuse("runs", "to be a share of 0 to 1", *share))
            }
            Affected::Numbers(numbers) if numbers.contains(&0) => Err(refuse("runs", "to be counted from 1", 0.0)),
            _ => Ok(()),
        };
        match self {
            TunnelDrag { from_m, to_m, k } => beyond(*from_m, *to_m).and(finite("k", *k)),
            CurveResistance { coefficient_roeckl } => {
                finite("coefficient_roeckl", *coefficient_roeckl)?;
                curves.then_some(()).ok_or(EffectError::NoCurves { effect })
            }
            GradientError { from_m, to_m, delta_permille } => {
                beyond(*from_m, *to_m)?;
                (delta_permille.abs() <= 100.0).then_some(()).ok_or(refuse(
                    "delta_permille",
                    "within -100 to 100",
                    *delta_permille,
                ))
            }
            SteadyWind { wind_mps } => {
                (wind_mps.abs() <= 40.0).then_some(()).ok_or(refuse("wind_mps", "within -40 to 40", *wind_mps))
            }
            RunWind { sd_mps } => {
                (0.0..=20.0).contains(sd_mps).then_some(()).ok_or(refuse("sd_mps", "within 0 to 20", *sd_mps))
            }
            MassError { relative } => {
                (-0.5..=1.0).contains(relative).then_some(()).ok_or(refuse("relative", "within -0.5 to 1", *relative))
            }
            DraggingBrake { drag_n_per_kg, runs: some } => finite("drag_n_per_kg", *drag_n_per_kg).and(runs(some)),
            PowerLimitSection { from_m, to_m, factor, runs: some } => {
                beyond(*from_m, *to_m).and(positive("factor", *factor)).and(runs(some))
            }
            TractionScale { factor } => positive("factor", *factor),
            LowAdhesion { factor, below_kmh, runs: some } => {
                positive("factor", *factor).and(positive("below_kmh", *below_kmh)).and(runs(some))
            }
            SpeedScale { measured_over_true } => (0.5..=2.0).contains(measured_over_true).then_some(()).ok_or(refuse(
                "measured_over_true",
                "within 0.5 to 2",
                *measured_over_true,
            )),
            LocationLag { lag_s } => {
                (0.0..=60.0).contains(lag_s).then_some(()).ok_or(refuse("lag_s", "within 0 to 60", *lag_s))
            }
            TemperatureResistance { dr0_per_deg_c, ref_c } => {
                finite("dr0_per_degC", *dr0_per_deg_c).and(finite("ref_c", *ref_c))
            }
            SeasonalDrift { dr0_over_period } => finite("dr0_over_period", *dr0_over_period),
            BrakeFade { fade_at_140, from_kmh } => {
                let fits = (0.0..=0.8).contains(fade_at_140);
                fits.then_some(()).ok_or(refuse("fade_at_140", "within 0 to 0.8", *fade_at_140))?;
                (0.0..140.0).contains(from_kmh).then_some(()).ok_or(refuse(
                    "from_kmh",
                    "from 0 to below 140",
                    *from_kmh,
                ))
            }
            TrainLengthError { true_length_m } => positive("true_length_m", *true_length_m),
            WarmUp { amplitude, tau_s } => finite("amplitude", *amplitude).and(positive("tau_s", *tau_s)),
            DavisError { dr0, dr1, dr2 } => finite("dr0", *dr0).and(finite("dr1", *dr1)).and(finite("dr2", *dr2)),
            CubicDrag { k } => finite("k", *k),
            SpeedBump { at_kmh, half_width_kmh, drag_n_per_kg } => finite("at_kmh", *at_kmh)
                .and(positive("half_width_kmh", *half_width_kmh))
                .and(finite("drag_n_per_kg", *drag_n_per_kg)),
            LocationBump { from_m, to_m, drag_n_per_kg } => {
                beyond(*from_m, *to_m).and(finite("drag_n_per_kg", *drag_n_per_kg))
            }
            PeriodicDrag { amplitude, period_s } => {
                finite("amplitude", *amplitude).and(positive("period_s", *period_s))
            }
            Frost { below_c, drag_n_per_kg } => {
                finite("below_c", *below_c).and(finite("drag_n_per_kg", *drag_n_per_kg))
            }
            DayStep { from_share, drag_n_per_kg } => {
                (0.0..=1.0).contains(from_share).then_some(()).ok_or(refuse(
                    "from_share",
                    "within 0 to 1",
                    *from_share,
                ))?;
                finite("drag_n_per_kg", *drag_n_per_kg)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refusals_name_effect_parameter_and_value() {
        let error = |effect: Effect, curves| effect.check(curves).unwrap_err().to_string();
        let tunnel = Effect::TunnelDrag { from_m: 500.0, to_m: 400.0, k: 1e-5 };
        assert_eq!(error(tunnel, true), "tunnel_drag: expected to_m beyond from_m, found 400");
        let curves = Effect::CurveResistance { coefficient_roeckl: 1.0 };
        assert_eq!(curves.check(true), Ok(()));
        assert_eq!(error(curves, false), "curve_resistance: expected a line with curves, found none");
        let nan = Effect::CubicDrag { k: f64::NAN };
        assert_eq!(error(nan, true), "cubic_drag: expected k finite, found NaN");
        let share = Effect::DraggingBrake { drag_n_per_kg: 0.01, runs: Affected::Share(1.5) };
        assert_eq!(error(share, true), "dragging_brake: expected runs to be a share of 0 to 1, found 1.5");
    }
}
