//! What holds for all effects.

extern crate std;
use super::*;
use crate::model::direction::Direction;
use crate::model::track::{Curve, Gradient, Track};
use crate::model::train::{Train, TrainDescription};
use std::collections::HashSet;
use std::vec::Vec;

/// One of each.
fn one_of_each() -> Vec<Effect> {
    std::vec![
        Effect::TunnelDrag(TunnelDrag { from_m: 1e3, to_m: 2e3, k: 1e-5 }),
        Effect::CurveResistance(CurveResistance { coefficient_roeckl: 1.0 }),
        Effect::GradientError(GradientError { from_m: 1e3, to_m: 2e3, delta_permille: 1.0 }),
        Effect::SteadyWind(SteadyWind { wind_mps: 2.0 }),
        Effect::RunWind(RunWind { sd_mps: 2.0 }),
        Effect::MassError(MassError { relative: 0.1 }),
        Effect::DraggingBrake(DraggingBrake { drag_n_per_kg: 0.01 }),
        Effect::PowerLimitSection(PowerLimitSection { from_m: 1e3, to_m: 2e3, factor: 0.6 }),
        Effect::TractionScale(TractionScale { factor: 0.9 }),
        Effect::LowAdhesion(LowAdhesion { factor: 0.5, below_kmh: 40.0 }),
        Effect::SpeedScale(SpeedScale { measured_over_true: 1.01 }),
        Effect::LocationLag(LocationLag { lag_s: 2.0 }),
        Effect::TemperatureResistance(TemperatureResistance { dr0_per_deg_c: -1e-4, ref_c: 15.0 }),
        Effect::SeasonalDrift(SeasonalDrift { dr0_over_period: 1e-3, period_days: 100.0, reference_day: 0.0 }),
        Effect::BrakeFade(BrakeFade { fade_at_140: 0.3, from_kmh: 80.0 }),
        Effect::TrainLengthError(TrainLengthError { true_length_m: 200.0 }),
        Effect::WarmUp(WarmUp { amplitude: 3e-3, tau_s: 300.0 }),
        Effect::DavisError(DavisError { dr0: 1e-3, dr1: 1e-5, dr2: 1e-6 }),
        Effect::Unknown(Unknown {
            coordinate: Coordinate::Speed,
            table: [(0.0, 1e-3), (30.0, 2e-3)].into_iter().collect(),
        }),
    ]
}

fn train() -> Train {
    Train::try_new(TrainDescription { length_m: 160.0, ..TrainDescription::CASE_STUDY }).unwrap()
}

#[test]
fn kinds_are_one_to_nineteen_and_names_differ() {
    let all = one_of_each();
    let kinds: Vec<u8> = all.iter().map(Effect::kind).collect();
    assert_eq!(kinds, (1..=19).collect::<Vec<u8>>());
    let names: HashSet<_> = all.iter().map(Effect::name).collect();
    assert_eq!(names.len(), 19);
    assert!(all.iter().all(|effect| effect.check().is_ok()));
}

#[test]
fn each_acts_in_one_way_only() {
    let train = train();
    let gradients = [(0.0, 0.0), (1450.0, 8.0)].map(|(from_m, permille)| Gradient { from_m, permille });
    let curves = [Curve { from_m: 1.2e3, to_m: 1.6e3, radius_m: 500.0 }];
    let track = Track::try_new(5e3, gradients).unwrap().with_curves(curves).unwrap();
    let line = Line { train: &train, track: &track, direction: Direction::Up };
    let moment = Moment {
        location_m: 1500.0,
        speed_mps: 25.0,
        effort_n_per_kg: 0.1,
        since_departure_s: 60.0,
        braked: true,
        temperature_c: Some(0.0),
        day: Some(50.0),
    };
    let believed = Limits::of(&train);
    for effect in one_of_each() {
        let resists = effect.resistance_n_per_kg(&line, &train.davis(), &moment) != 0.0;
        let limits = [5.0, 35.0].iter().any(|speed_mps| effect.limit(&believed, 1500.0, *speed_mps) != believed);
        let corrects = effect.correct(1.0, 1500.0, 25.0) != (1500.0, 25.0);
        let spreads = matches!(effect, Effect::RunWind(_));
        let ways = [resists, limits, corrects, spreads];
        assert_eq!(ways.iter().filter(|acts| **acts).count(), 1, "{}: {ways:?}", effect.name());
    }
}

#[test]
fn directions_turn_gradient_and_wind_and_nothing_else() {
    let train = train();
    let track = Track::try_new(5e3, []).unwrap();
    let extra = |effect: &Effect, direction, location_m| {
        let line = Line { train: &train, track: &track, direction };
        let moment = Moment { location_m, speed_mps: 25.0, ..Moment::default() };
        effect.resistance_n_per_kg(&line, &train.davis(), &moment)
    };
    let all = one_of_each();
    // The train covers the same metres both ways: 40 of its 160 m are inside.
    let both = |index: usize| (extra(&all[index], Direction::Up, 1040.0), extra(&all[index], Direction::Down, 880.0));
    let (tunnel_up, tunnel_down) = both(0);
    assert_eq!(tunnel_up, 0.25 * 1e-5 * 625.0);
    assert_eq!(tunnel_up, tunnel_down);
    let (gradient_up, gradient_down) = both(2);
    assert!((gradient_up - 0.25e-3 * train.gravity_n_per_kg()).abs() < 1e-15);
    assert_eq!(gradient_up, -gradient_down);
    let (wind_up, wind_down) = both(3);
    assert!(wind_up > 0.0 && wind_down < 0.0);
}

#[test]
fn a_heavier_train_moves_as_its_equation_says() {
    let (e, u, v) = (0.2, 0.25, 30.0);
    let Davis { r0, r1, r2 } = train().davis();
    let heavy = MassError { relative: e };
    let believed = u - r0 - r1 * v - r2 * v * v - heavy.resistance_n_per_kg(r2, v, u);
    let true_acceleration = (u - r2 * v * v) / (1.0 + e) - r0 - r1 * v;
    assert!((believed - true_acceleration).abs() < 1e-15);
    // And back: the effort from acceleration and resistances.
    let effects = Effects::try_new([Effect::MassError(heavy)]).unwrap();
    let at_no_effort = heavy.resistance_n_per_kg(r2, v, 0.0);
    let resultant = true_acceleration + r0 + r1 * v + r2 * v * v + at_no_effort;
    assert!((effects.effort_n_per_kg(resultant) - u).abs() < 1e-15);
}

#[test]
fn a_list_takes_eight_good_effects_and_one_table() {
    let mut effects = Effects::NONE;
    for effect in one_of_each().into_iter().take(MAX_EFFECTS) {
        effects.push(effect).unwrap();
    }
    let one_more = Effect::WarmUp(WarmUp { amplitude: 1e-3, tau_s: 60.0 });
    assert_eq!(effects.push(one_more), Err(EffectError::TooMany { most: 8 }));
    let table = one_of_each().pop().unwrap();
    let twice = Effects::try_new([table.clone(), table]);
    assert_eq!(twice, Err(EffectError::Twice { effect: "unknown" }));
}

#[test]
fn wrong_parameters_are_named() {
    let message = |effect: Effect| effect.check().unwrap_err();
    assert_eq!(
        message(Effect::TunnelDrag(TunnelDrag { from_m: 5.0, to_m: 5.0, k: 1e-5 })),
        EffectError::Section { effect: "tunnel_drag", from_m: 5.0, to_m: 5.0 }
    );
    assert!(matches!(
        message(Effect::WarmUp(WarmUp { amplitude: Real::NAN, tau_s: 60.0 })),
        EffectError::OutOfRange { parameter: "amplitude", .. }
    ));
    let table = |points: &[(f32, f32)]| {
        message(Effect::Unknown(Unknown { coordinate: Coordinate::Time, table: points.iter().copied().collect() }))
    };
    assert_eq!(table(&[]), EffectError::NoPoints);
    assert_eq!(table(&[(0.0, 0.0), (0.0, 1e-3)]), EffectError::Point { index: 1 });
    assert_eq!(table(&[(f32::NAN, 0.0)]), EffectError::Point { index: 0 });
    assert_eq!(table(&[(0.0, 2.0)]), EffectError::Point { index: 0 });
}
