//! What holds for all effects.

extern crate std;
use super::*;
use crate::Real;
use crate::model::bounds::OutOfRange;
use crate::model::direction::Direction;
use crate::model::line::Line;
use crate::model::resistance::Davis;
use crate::model::track::{Curve, Gradient, Track};
use crate::model::train::{Train, TrainDescription};
use rundown_wire as wire;
use std::vec::Vec;

/// One of each kind, its values at four tenths of their ranges.
fn one_of_each() -> Vec<Effect> {
    let one = |kind: EffectKind| {
        let values = kind.parameters().iter().map(|range| range.least + 0.4 * (range.most - range.least)).collect();
        let section_m = kind.has_section().then_some([1e3, 2e3]);
        Effect::from_frame(&wire::Effect { kind: kind.number(), section_m, values }).unwrap_or_else(|_| table())
    };
    EffectKind::ALL.map(one).to_vec()
}

fn table() -> Effect {
    Unknown { coordinate: Coordinate::Speed, table: [(0.0, 1e-3), (30.0, 2e-3)].into_iter().collect() }.into()
}

fn train() -> Train {
    Train::try_new(TrainDescription { length_m: 160.0, ..TrainDescription::CASE_STUDY }).unwrap()
}

#[test]
fn there_is_one_of_each_kind_and_its_frame_leads_back() {
    let all = one_of_each();
    assert_eq!(all.iter().map(Effect::kind).collect::<Vec<_>>(), EffectKind::ALL);
    for effect in all {
        effect.check().unwrap();
        let frame = effect.to_frame();
        assert_eq!(frame.values.len(), effect.kind().parameters().len(), "{}", effect.kind());
        assert_eq!(frame.section_m.is_some(), effect.kind().has_section(), "{}", effect.kind());
        match effect.table() {
            Some(_) => assert_eq!(Effect::from_frame(&frame), Err(FrameError::UnknownKind)),
            None => assert_eq!(Effect::from_frame(&frame), Ok(effect)),
        }
    }
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
        stood_s: None,
        braked: true,
        temperature_c: Some(0.0),
        day: Some(50.0),
    };
    let believed = Limits::of(&train);
    for effect in one_of_each() {
        let resists = effect.resistance_n_per_kg(&line, &train.davis(), &moment) != 0.0;
        let limits = [5.0, 35.0].iter().any(|speed_mps| effect.limit(&believed, 1500.0, *speed_mps) != believed);
        let corrects = effect.correct(1.0, 1500.0, 25.0) != (1500.0, 25.0);
        let spreads = effect.wind_sd_mps().is_some();
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
    // The train covers the same metres both ways: 40 of its 160 m are inside.
    let both = |effect: &Effect| (extra(effect, Direction::Up, 1040.0), extra(effect, Direction::Down, 880.0));
    let (tunnel_up, tunnel_down) = both(&TunnelDrag { from_m: 1e3, to_m: 2e3, k: 1e-5 }.into());
    assert_eq!(tunnel_up, 0.25 * 1e-5 * 625.0);
    assert_eq!(tunnel_up, tunnel_down);
    let (gradient_up, gradient_down) = both(&GradientError { from_m: 1e3, to_m: 2e3, delta_permille: 1.0 }.into());
    assert!((gradient_up - 0.25e-3 * train.gravity_n_per_kg()).abs() < 1e-15);
    assert_eq!(gradient_up, -gradient_down);
    let (wind_up, wind_down) = both(&SteadyWind { wind_mps: 2.0 }.into());
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
    let twice = Effects::try_new([table(), table()]);
    assert_eq!(twice, Err(EffectError::Twice { effect: EffectKind::Unknown }));
}

#[test]
fn wrong_parameters_are_named() {
    let message = |effect: Effect| effect.check().unwrap_err();
    assert_eq!(
        message(Effect::TunnelDrag(TunnelDrag { from_m: 5.0, to_m: 5.0, k: 1e-5 })),
        EffectError::Section { effect: EffectKind::TunnelDrag, from_m: 5.0, to_m: 5.0 }
    );
    assert!(matches!(
        message(Effect::WarmUp(WarmUp { amplitude: Real::NAN, tau_s: 60.0 })),
        EffectError::OutOfRange(EffectKind::WarmUp, OutOfRange { field: "amplitude", .. })
    ));
    let table = |points: &[(f32, f32)]| {
        message(Effect::Unknown(Unknown { coordinate: Coordinate::Time, table: points.iter().copied().collect() }))
    };
    assert_eq!(table(&[]), EffectError::NoPoints);
    assert_eq!(table(&[(0.0, 0.0), (0.0, 1e-3)]), EffectError::Point { index: 1 });
    assert_eq!(table(&[(f32::NAN, 0.0)]), EffectError::Point { index: 0 });
    assert_eq!(table(&[(0.0, 2.0)]), EffectError::Point { index: 0 });
}
