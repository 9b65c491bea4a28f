//! Effects that add to the resistance: their laws.

use super::Effect;
use crate::line::{Curve, Line};
use crate::motion::Motion;
use crate::train::{GRAVITY_MPS2, TrainTruth};
use std::f64::consts::PI;

/// A moment of a run, as the laws of the effects see it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Location along the way travelled, and speed.
    pub motion: Motion,
    /// Since the departure of the run, s; 0 before.
    pub since_departure_s: f64,
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

/// Resistance that an effect adds, N/kg of true rotating mass, positive against travel. 0 for effects that act elsewhere.
pub fn extra_n_per_kg(effect: &Effect, setting: &Setting, at: &Moment) -> f64 {
    let v = at.motion.speed_mps;
    match *effect {
        Effect::TunnelDrag { from_m, to_m, k } => {
            let front_m = at.motion.location_m;
            let tail_m = front_m - setting.train.length_m;
            let inside_m = (front_m.min(to_m) - tail_m.max(from_m)).max(0.0);
            let share = inside_m / setting.train.length_m;
            setting.described_over_true_mass * k * v * v * share
        }
        Effect::CurveResistance { coefficient_roeckl } => {
            let mean = roeckl_under(setting.line, at.motion.location_m, setting.train.length_m);
            coefficient_roeckl * mean * GRAVITY_MPS2 / setting.train.gamma
        }
        Effect::DraggingBrake { drag_n_per_kg, .. } if at.braked => setting.described_over_true_mass * drag_n_per_kg,
        Effect::TemperatureResistance { dr0_per_deg_c, ref_c } => dr0_per_deg_c * (at.temperature_c - ref_c),
        Effect::SeasonalDrift { dr0_over_period } => dr0_over_period * at.season,
        Effect::WarmUp { amplitude, tau_s } => amplitude * (-at.since_departure_s / tau_s).exp(),
        Effect::CubicDrag { k } => k * v * v * v,
        Effect::SpeedBump { at_kmh, half_width_kmh, drag_n_per_kg } => {
            drag_n_per_kg * raised_cosine((3.6 * v - at_kmh) / half_width_kmh)
        }
        Effect::LocationBump { from_m, to_m, drag_n_per_kg } => {
            let (middle_m, half_m) = ((from_m + to_m) / 2.0, (to_m - from_m) / 2.0);
            // The middle of the train stands for all of it, so that both directions feel the same.
            let train_m = at.motion.location_m - setting.train.length_m / 2.0;
            drag_n_per_kg * raised_cosine((train_m - middle_m) / half_m)
        }
        Effect::PeriodicDrag { amplitude, period_s } => amplitude * (2.0 * PI * at.since_departure_s / period_s).sin(),
        Effect::Frost { below_c, drag_n_per_kg } => {
            drag_n_per_kg * ((below_c - at.temperature_c) / 2.0).clamp(0.0, 1.0)
        }
        Effect::DayStep { from_share, drag_n_per_kg } if at.season >= from_share => drag_n_per_kg,
        _ => 0.0,
    }
}

/// Whether [`extra_n_per_kg`] of an effect can be other than 0.
pub fn is_resistance(effect: &Effect) -> bool {
    matches!(
        effect,
        Effect::TunnelDrag { .. }
            | Effect::CurveResistance { .. }
            | Effect::DraggingBrake { .. }
            | Effect::TemperatureResistance { .. }
            | Effect::SeasonalDrift { .. }
            | Effect::WarmUp { .. }
            | Effect::CubicDrag { .. }
            | Effect::SpeedBump { .. }
            | Effect::LocationBump { .. }
            | Effect::PeriodicDrag { .. }
            | Effect::Frost { .. }
            | Effect::DayStep { .. }
    )
}

/// 1 in the middle, 0 at ±1 and beyond, smooth.
fn raised_cosine(x: f64) -> f64 {
    if x.abs() < 1.0 { (1.0 + (PI * x).cos()) / 2.0 } else { 0.0 }
}

/// Roeckl's curve resistance as a share of the weight: 0.65/(R - 55 m) from 300 m on, 0.5/(R - 30 m) below.
///
/// ```
/// use crate::effects::resistance::roeckl;
///
/// assert!((roeckl(705.0) - 0.001).abs() < 1e-15);
/// ```
pub fn roeckl(radius_m: f64) -> f64 {
    if radius_m < 300.0 { 0.5 / (radius_m.max(50.0) - 30.0) } else { 0.65 / (radius_m - 55.0) }
}

/// Mean of Roeckl's formula along the train.
fn roeckl_under(line: &Line, front_m: f64, length_m: f64) -> f64 {
    let tail_m = front_m - length_m;
    let part = |curve: &Curve| {
        let inside_m = front_m.min(curve.to_m) - tail_m.max(curve.from_m);
        inside_m.max(0.0) * roeckl(curve.radius_m)
    };
    line.curves().iter().take_while(|curve| curve.from_m < front_m).map(part).sum::<f64>() / length_m
}

#[cfg(test)]
mod tests {
    use super::*;

    fn extra(effect: &Effect, line: &Line, at: Moment) -> f64 {
        let train = TrainTruth::default();
        let setting = Setting { train: &train, line, described_over_true_mass: 1.0 };
        extra_n_per_kg(effect, &setting, &at)
    }

    fn at(location_m: f64, speed_mps: f64) -> Moment {
        Moment {
            motion: Motion { location_m, speed_mps },
            since_departure_s: 0.0,
            braked: false,
            temperature_c: 10.0,
            season: 0.0,
        }
    }

    #[test]
    fn a_tunnel_counts_by_the_part_of_the_train_inside() {
        let line = Line::level(10_000.0, 140.0);
        let tunnel = Effect::TunnelDrag { from_m: 1_000.0, to_m: 2_000.0, k: 1e-5 };
        // Train of 162 m: outside, half inside at either portal, whole, and in the end outside again.
        for (front_m, share) in [(999.0, 0.0), (1_081.0, 0.5), (1_500.0, 1.0), (2_081.0, 0.5), (2_163.0, 0.0)] {
            let expected = 1e-5 * 900.0 * share;
            assert!((extra(&tunnel, &line, at(front_m, 30.0)) - expected).abs() < 1e-15);
        }
    }

    #[test]
    fn a_tunnel_shorter_than_the_train() {
        let line = Line::level(10_000.0, 140.0);
        let tunnel = Effect::TunnelDrag { from_m: 1_000.0, to_m: 1_081.0, k: 1e-5 };
        let found = extra(&tunnel, &line, at(1_120.0, 30.0));
        assert!((found - 0.5 * 9e-3).abs() < 1e-15);
    }

    #[test]
    fn a_curve_of_705_m_costs_a_thousandth_of_the_weight() {
        let mut line = Line::level(10_000.0, 140.0);
        line.set_curves(vec![Curve { from_m: 500.0, to_m: 900.0, radius_m: 705.0 }]);
        let curves = Effect::CurveResistance { coefficient_roeckl: 2.0 };
        let whole = 2.0 * 0.001 * 9.80665 / 1.06;
        assert!((extra(&curves, &line, at(800.0, 20.0)) - whole).abs() < 1e-15);
        assert!((extra(&curves, &line, at(581.0, 20.0)) - whole / 2.0).abs() < 1e-15);
        assert_eq!(extra(&curves, &line, at(1_100.0, 20.0)), 0.0);
    }

    #[test]
    fn a_dragging_brake_waits_for_the_first_application() {
        let line = Line::level(10_000.0, 140.0);
        let drag = Effect::DraggingBrake { drag_n_per_kg: 0.01, runs: crate::effects::Affected::Share(1.0) };
        let before = at(100.0, 20.0);
        assert_eq!(extra(&drag, &line, before), 0.0);
        let after = Moment { braked: true, ..before };
        assert_eq!(extra(&drag, &line, after), 0.01);
    }

    #[test]
    fn times_temperatures_and_dates() {
        let line = Line::level(10_000.0, 140.0);
        let moment = Moment { since_departure_s: 300.0, temperature_c: -5.0, season: 0.25, ..at(100.0, 20.0) };
        let cases = [
            (Effect::WarmUp { amplitude: 4e-3, tau_s: 300.0 }, 1.471_518e-3),
            (Effect::TemperatureResistance { dr0_per_deg_c: -1e-4, ref_c: 15.0 }, 2e-3),
            (Effect::SeasonalDrift { dr0_over_period: 4e-3 }, 1e-3),
            (Effect::PeriodicDrag { amplitude: 3e-3, period_s: 1_200.0 }, 3e-3),
            (Effect::Frost { below_c: -4.0, drag_n_per_kg: 2e-3 }, 1e-3),
            (Effect::DayStep { from_share: 0.5, drag_n_per_kg: 2e-3 }, 0.0),
            (Effect::CubicDrag { k: 1e-7 }, 8e-4),
            (Effect::SpeedBump { at_kmh: 67.0, half_width_kmh: 10.0, drag_n_per_kg: 2e-3 }, 1e-3),
            (Effect::LocationBump { from_m: 0.0, to_m: 38.0, drag_n_per_kg: 2e-3 }, 2e-3),
        ];
        for (effect, expected) in cases {
            let found = extra(&effect, &line, moment);
            assert!((found - expected).abs() < 1e-9, "{effect:?}: {found}");
        }
    }
}
