//! What the laws say at single moments.

use super::*;
use crate::line::{Curve, Line};
use crate::motion::Motion;
use crate::train::TrainTruth;

#[test]
fn the_name_is_the_one_in_files() {
    let effect = Effect::TemperatureResistance(TemperatureResistance { dr0_per_deg_c: -1e-4, ref_c: 10.0 });
    let text = toml::to_string(&effect).unwrap();
    assert_eq!(text, "name = \"temperature_resistance\"\ndr0_per_degC = -0.0001\nref_c = 10.0\n");
    assert_eq!(toml::from_str::<Effect>(&text).unwrap(), effect);
}

macro_rules! fields {
    ($($number:literal $Kind:ident $name:ident $place:ident $summary:literal $parameters:tt)*) => {
        [$((EffectKind::$Kind, $Kind::FIELDS)),*]
    };
}

/// Ranges are looked up by place. A kind may have fewer parameters than the estimator's.
#[test]
fn parameters_stand_in_the_order_of_the_catalogue() {
    for (kind, fields) in effects_catalogue!(named: fields) {
        let ends = if kind.has_section() { ["from_m", "to_m"].as_slice() } else { &[] };
        let numbers = fields.strip_prefix(ends).unwrap_or_else(|| panic!("{kind}: {fields:?}"));
        let numbers = numbers.strip_suffix(&["runs"]).unwrap_or(numbers);
        let known: Vec<&str> = kind.parameters().iter().map(|it| it.name).collect();
        let numbers: Vec<String> = numbers.iter().map(|name| name.replace("deg_c", "degC")).collect();
        assert!(!numbers.is_empty() && known[..numbers.len()] == numbers, "{kind}: {fields:?}, {known:?}");
    }
}

#[test]
fn a_section_seen_from_the_other_end() {
    let bump = Effect::LocationBump(LocationBump { from_m: 100.0, to_m: 300.0, drag_n_per_kg: 0.01 });
    let mirrored = Effect::LocationBump(LocationBump { from_m: 700.0, to_m: 900.0, drag_n_per_kg: 0.01 });
    assert_eq!(bump.clone().mirrored(1000.0), mirrored);
    assert_eq!(mirrored.mirrored(1000.0), bump);
}

#[test]
fn refusals_name_effect_parameter_and_value() {
    let error = |effect: Effect, curves| effect.check(curves, 32_000.0).unwrap_err().to_string();
    let tunnel = Effect::TunnelDrag(TunnelDrag { from_m: 500.0, to_m: 400.0, k: 1e-5 });
    assert_eq!(error(tunnel, true), "tunnel_drag.to_m: expected a place beyond from_m, found 400");
    let curves = Effect::CurveResistance(CurveResistance { coefficient_roeckl: 1.0 });
    assert_eq!(curves.check(true, 32_000.0), Ok(()));
    assert_eq!(error(curves, false), "curve_resistance: expected a line with curves, found none");
    let nan = Effect::CubicDrag(CubicDrag { k: f64::NAN });
    assert_eq!(error(nan, true), "cubic_drag.k: expected a finite number, found NaN");
    let share = Effect::DraggingBrake(DraggingBrake { drag_n_per_kg: 0.01, runs: Affected::Share(1.5) });
    assert_eq!(error(share, true), "dragging_brake.runs: expected 0 to 1, found 1.5");
}

fn at(location_m: f64, speed_mps: f64) -> Moment {
    Moment {
        motion: Motion { location_m, speed_mps },
        since_departure_s: 0.0,
        stood_s: None,
        braked: false,
        temperature_c: 10.0,
        season: 0.0,
    }
}

/// What an effect adds at single moments, N/kg, to so many digits.
fn adds(effect: impl Into<Effect>, tolerance: f64, cases: &[(Moment, f64)]) {
    let mut line = Line::level(10_000.0, 140.0);
    line.set_curves(vec![Curve { from_m: 500.0, to_m: 900.0, radius_m: 705.0 }]);
    let train = TrainTruth::default();
    let setting = Setting { train: &train, line: &line, described_over_true_mass: 1.0 };
    let effect = effect.into();
    for (moment, expected) in cases {
        let found = effect.law().extra_n_per_kg(&setting, moment);
        assert!((found - expected).abs() <= tolerance, "{effect:?} at {moment:?}: {found}, expected {expected}");
    }
}

#[test]
fn a_tunnel_counts_by_the_part_of_the_train_inside() {
    // Train of 162 m: outside, half inside at either portal, whole, and in the end outside again.
    let cases = [(999.0, 0.0), (1_081.0, 0.5), (1_500.0, 1.0), (2_081.0, 0.5), (2_163.0, 0.0)];
    let cases = cases.map(|(front_m, share)| (at(front_m, 30.0), 1e-5 * 900.0 * share));
    adds(TunnelDrag { from_m: 1_000.0, to_m: 2_000.0, k: 1e-5 }, 1e-15, &cases);
    // Shorter than the train.
    adds(TunnelDrag { from_m: 1_000.0, to_m: 1_081.0, k: 1e-5 }, 1e-15, &[(at(1_120.0, 30.0), 0.5 * 9e-3)]);
}

#[test]
fn a_curve_of_705_m_costs_a_thousandth_of_the_weight() {
    let whole = 2.0 * 0.001 * 9.80665 / 1.06;
    let cases = [(at(800.0, 20.0), whole), (at(581.0, 20.0), whole / 2.0), (at(1_100.0, 20.0), 0.0)];
    adds(CurveResistance { coefficient_roeckl: 2.0 }, 1e-15, &cases);
}

#[test]
fn a_dragging_brake_waits_for_the_first_application() {
    let before = at(100.0, 20.0);
    let drag = DraggingBrake { drag_n_per_kg: 0.01, runs: Affected::Share(1.0) };
    adds(drag, 0.0, &[(before, 0.0), (Moment { braked: true, ..before }, 0.01)]);
}

#[test]
fn a_train_starts_harder_after_long_and_cold_standing() {
    let cases = [
        (None, 10.0, 0.0, 0.04),
        (None, 10.0, 2.0, 0.04 * 0.367_879),
        (Some(600.0), 10.0, 0.0, 0.04 * 0.632_121),
        (None, -15.0, 0.0, 0.06),
        (Some(0.0), -15.0, 0.0, 0.0),
    ];
    let cases = cases.map(|(stood_s, temperature_c, speed_mps, expected)| {
        (Moment { stood_s, temperature_c, ..at(0.0, speed_mps) }, expected)
    });
    let grease = StartingResistance { amplitude: 0.04, decay_kmh: 7.2, standing_min: 10.0, cold_per_deg_c: 0.02 };
    adds(grease, 1e-7, &cases);
}

#[test]
fn times_temperatures_and_dates() {
    let moment = Moment { since_departure_s: 300.0, temperature_c: -5.0, season: 0.25, ..at(100.0, 20.0) };
    let cases: [(Effect, f64); 9] = [
        (WarmUp { amplitude: 4e-3, tau_s: 300.0 }.into(), 1.471_518e-3),
        (TemperatureResistance { dr0_per_deg_c: -1e-4, ref_c: 15.0 }.into(), 2e-3),
        (SeasonalDrift { dr0_over_period: 4e-3 }.into(), 1e-3),
        (PeriodicDrag { amplitude: 3e-3, period_s: 1_200.0 }.into(), 3e-3),
        (Frost { below_c: -4.0, drag_n_per_kg: 2e-3 }.into(), 1e-3),
        (DayStep { from_share: 0.5, drag_n_per_kg: 2e-3 }.into(), 0.0),
        (CubicDrag { k: 1e-7 }.into(), 8e-4),
        (SpeedBump { at_kmh: 67.0, half_width_kmh: 10.0, drag_n_per_kg: 2e-3 }.into(), 1e-3),
        (LocationBump { from_m: 0.0, to_m: 38.0, drag_n_per_kg: 2e-3 }.into(), 2e-3),
    ];
    for (effect, expected) in cases {
        adds(effect, 1e-9, &[(moment, expected)]);
    }
}

fn capability(effects: &[Effect], location_m: f64, kmh: f64) -> Capability {
    let mut left = Capability::WHOLE;
    for effect in effects {
        effect.law().cap(&mut left, Motion { location_m, speed_mps: kmh / 3.6 });
    }
    left
}

#[test]
fn caps_hold_where_they_are_said_to() {
    let effects = [
        Effect::TractionScale(TractionScale { factor: 1.1 }),
        Effect::PowerLimitSection(PowerLimitSection {
            from_m: 0.0,
            to_m: 3_000.0,
            factor: 0.8,
            runs: Affected::Share(1.0),
        }),
        Effect::LowAdhesion(LowAdhesion { factor: 0.5, below_kmh: 30.0, runs: Affected::Share(1.0) }),
    ];
    let slow = capability(&effects, 2_999.0, 29.0);
    assert_eq!(slow, Capability { scale: 1.1, effort_cap: 0.5, power_cap: 0.8 });
    let fast = capability(&effects, 3_001.0, 31.0);
    assert_eq!((fast.effort_cap, fast.power_cap), (f64::INFINITY, f64::INFINITY));
}

#[test]
fn brake_fade_grows_with_speed() {
    let fade = BrakeFade { fade_at_140: 0.3, from_kmh: 60.0 };
    for (kmh, share) in [(50.0, 1.0), (60.0, 1.0), (100.0, 0.85), (140.0, 0.7)] {
        assert!((fade.brake_share(kmh / 3.6) - share).abs() < 1e-12);
    }
}
