//! Effects of train and track: they act as on the desk, are refused one by one, and survive the power.

use board_tests::board::{Board, described, estimate, running};
use board_tests::flash::Flash;
use board_tests::prelude::*;
use board_tests::said;
use rundown::model::effects::*;
use rundown::uplink::CurvePart;
use rundown_wire::Refusal;

fn effects() -> Effects {
    Effects::try_new([
        Effect::TunnelDrag(TunnelDrag { from_m: 8e3, to_m: 14e3, k: 1e-5 }),
        Effect::CurveResistance(CurveResistance { coefficient_roeckl: 1.0 }),
        Effect::Unknown(Unknown {
            coordinate: Coordinate::Temperature,
            table: [(-10.0, 4e-3), (20.0, 0.0)].into_iter().collect(),
        }),
    ])
    .unwrap()
}

fn with_effects() -> (Description, Vec<Measurement>) {
    let (description, log) = described();
    let curve = |from_m| Curve { from_m, to_m: from_m + 300.0, radius_m: 600.0 };
    let description = Description {
        curves: (0..20).map(|i| curve(1000.0 * f64::from(i))).collect(),
        effects: effects(),
        ..description
    };
    (description, log)
}

#[test]
fn effects_act_on_the_board_as_on_the_desk_and_survive_the_power() {
    let (description, log) = with_effects();
    let cold = Surroundings { temperature_c: Some(-4.0), day: None };
    let mut board = Board::running(&description);
    board.ask(Request::Surroundings(cold)).unwrap();
    let with = board.status().setup;
    let estimator = description.estimator().unwrap();
    let vehicle = estimator.new_vehicle();
    let bare = Description { effects: Effects::NONE, ..description.clone() };
    let bare_estimator = bare.estimator().unwrap();
    let (mut run, mut bare_run) =
        (estimator.begin_run(&vehicle, Direction::Up), bare_estimator.begin_run(&vehicle, Direction::Up));
    estimator.set_surroundings(&mut run, cold);
    let (mut same, mut seen) = (true, None);
    for measurement in &log {
        let frames = board.measure(measurement);
        let expected = estimator.step(&mut run, measurement).unwrap();
        assert_eq!(estimate(&frames).unwrap().digest, digest::of_estimate(&expected));
        let without = bare_estimator.step(&mut bare_run, measurement).unwrap();
        same &= digest::of_estimate(&without) == digest::of_estimate(&expected);
        seen = seen.or(said!(frames, Effects));
    }
    assert!(!same, "the effects do something in this run");
    assert_eq!(seen, Some(effects().to_frame()));

    // The power goes in the middle of the next run. Nobody tells the effects again.
    let mut board = board.restart();
    board.prepare(&bare, Direction::Up);
    assert_eq!(board.status().setup, with);
    board.ask(Request::Command(Command::End)).unwrap();
    // Taken out, they stay out.
    let clear = board.desk.secured(Request::Command(Command::ClearEffects)).unwrap();
    assert_eq!(said!(board.say(&clear), Effects), Some(rundown_wire::Effects::default()));
    assert_ne!(board.status().setup, with);
    let begin = Command::Begin { direction: Direction::Up, track_id: bare.track_id() };
    board.ask(Request::Command(begin)).unwrap();
    let mut board = board.restart();
    board.prepare(&bare, Direction::Up);
    assert_ne!(board.status().setup, with);
}

#[test]
fn the_last_effect_once_more_changes_nothing() {
    let mut board = Board::start(Flash::erased(8));
    board.status();
    let [one, other] = [1.0, 2.0].map(|wind_mps| Effect::SteadyWind(SteadyWind { wind_mps }).to_frame());
    let mut setups = Vec::new();
    for effect in [&one, &one, &other, &one] {
        board.ask(Request::Effect(effect.clone())).unwrap();
        setups.push(board.status().setup);
    }
    assert_eq!(setups[0], setups[1]);
    assert!(setups[1] != setups[2] && setups[2] != setups[3], "{setups:x?}");
}

#[test]
fn wrong_effects_change_nothing() {
    let (mut board, description, log) = running(with_effects());
    let setup = board.status().setup;
    let good = Effect::WarmUp(WarmUp { amplitude: 3e-3, tau_s: 300.0 }).to_frame();
    let under_way = [Request::Effect(good.clone()), Request::Command(Command::ClearEffects)];
    for request in under_way {
        assert_eq!(board.ask(request), Err(Refusal::Running));
    }
    board.measure(&log[0]);
    board.ask(Request::Command(Command::End)).unwrap();
    let change = |change: fn(&mut rundown_wire::Effect)| {
        let mut wrong = good.clone();
        change(&mut wrong);
        wrong
    };
    let point =
        |values: [f64; 4]| rundown_wire::Effect { kind: 19, section_m: None, values: values.into_iter().collect() };
    for (wrong, refusal) in [
        (change(|e| e.kind = 0), Refusal::UnknownEffect),
        (change(|e| e.kind = u8::MAX), Refusal::UnknownEffect),
        (change(|e| e.values[0] = f64::NAN), Refusal::OutOfRange),
        (change(|e| e.values[1] = 0.0), Refusal::OutOfRange),
        (
            change(|e| {
                e.values.pop();
            }),
            Refusal::OutOfRange,
        ),
        (change(|e| e.section_m = Some([0.0, 1.0])), Refusal::OutOfRange),
        (point([3.0, 3.0, 30.0, 0.0]), Refusal::OutOfOrder),
        (point([1.0, 2.0, 30.0, 0.0]), Refusal::OutOfOrder),
        (point([3.0, 2.0, 20.0, 0.0]), Refusal::OutOfRange),
        (point([5.0, 2.0, 30.0, 0.0]), Refusal::OutOfRange),
        (point([3.0, 0.5, 30.0, 0.0]), Refusal::OutOfRange),
    ] {
        assert_eq!(board.ask(Request::Effect(wrong.clone())), Err(refusal), "{wrong:?}");
    }
    assert_eq!(board.status().setup, setup);
    for tau_s in [300.0, 301.0, 302.0, 303.0, 304.0] {
        let another = Effect::WarmUp(WarmUp { amplitude: 3e-3, tau_s }).to_frame();
        board.ask(Request::Effect(another)).unwrap();
    }
    assert_eq!(board.ask(Request::Effect(good)), Err(Refusal::OutOfRange), "a ninth one");

    let part = |track_id, first, radius_m| {
        Request::Curves(CurvePart {
            track_id,
            first,
            curves: [Curve { from_m: 25e3, to_m: 26e3, radius_m }].into_iter().collect(),
        })
    };
    let id = description.track_id();
    assert_eq!(board.ask(part(id + 1, 20, 500.0)), Err(Refusal::OtherTrack));
    assert_eq!(board.ask(part(id, 19, 500.0)), Err(Refusal::OutOfOrder));
    assert_eq!(board.ask(part(id, 20, 500.0)), Ok(()));
    assert_eq!(board.ask(part(id, 21, 0.0)), Err(Refusal::OutOfRange));
    assert_eq!(board.ask(part(id, 0, 500.0)), Ok(()));
}

#[test]
fn effects_are_kept_once_and_not_at_the_begin_of_each_run() {
    let (mut board, mut description, _) = running(described());
    board.end();
    let tunnel = Effect::TunnelDrag(TunnelDrag { from_m: 8e3, to_m: 14e3, k: 1e-5 });
    description.effects = Effects::try_new([tunnel]).unwrap();
    let [before, _] = board.status().records;
    board.prepare(&description, Direction::Up);
    assert_eq!(board.status().records[0], before + 1, "at the begin of the run");
    board.end();
    let [before, _] = board.status().records;
    let track_id = description.track_id();
    board.ask(Request::Command(Command::Begin { direction: Direction::Up, track_id })).unwrap();
    assert_eq!(board.status().records[0], before, "the same effects");
}

#[test]
fn effects_that_differ_in_one_value_are_another_setup() {
    let (mut board, ..) = running(described());
    board.end();
    let bare = board.status().setup;
    let mut with = |amplitude| {
        board.ask(Request::Command(Command::ClearEffects)).unwrap();
        assert_eq!(board.status().setup, bare);
        board.ask(Request::Effect(Effect::WarmUp(WarmUp { amplitude, tau_s: 300.0 }).to_frame())).unwrap();
        board.status().setup
    };
    let setups = [with(1e-3), with(2e-3), with(1e-3)];
    assert!(!setups.contains(&bare) && setups[0] != setups[1] && setups[0] == setups[2], "{setups:?}");
}
