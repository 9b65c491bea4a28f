//! Does every kind of the catalogue do something, the same in the truth and on the board? Each is hidden as the bench
//! of the gap workflow hides it, and a kind that is only a name is found here.

use host_tests::moving::moving_steps;
use host_tests::prelude::*;
use rundown::model::effects::{Effect, EffectKind, Effects, Limits, Moment};
use rundown::model::line::Line;
use rundown_gap::candidates;
use rundown_gap::{HiddenSize, Hide};
use rundown_truth as truth;
use rundown_truth::effects::{Altered, Capability, Effect as TrueEffect};
use rundown_truth::facts::Facts;
use rundown_truth::motion::Motion;
use rundown_truth::plan::{Headings, RunPlan, plan};
use rundown_truth::sensors::TruthSample;
use rundown_truth::weather::Climate;
use serde_json::Value;

/// An acceleration is computed to this; a step across the edge of a section or gradient sees both sides, N/kg.
const EXACT_N_PER_KG: f64 = 1e-5;
/// The least that a clear effect does, N/kg.
const ACTS_N_PER_KG: f64 = 5e-4;
/// Of the board where none is stated.
const PERIOD_DAYS: f64 = 365.0;

/// What the bench hides of a kind in each run, by each of its names, as in a scenario.
fn hidden(kind: EffectKind) -> Vec<(&'static str, Result<Value, String>)> {
    let Davis { r0, r1, r2 } = TrainDescription::CASE_STUDY.davis;
    let candidate = candidates::of(kind);
    let draw = |name| {
        let mut hide = Hide {
            size: HiddenSize::Clear,
            // While trains accelerate, so that less power shows.
            section_m: [1_000.0, 4_000.0],
            sign: 1.0,
            davis: Davis { r0, r1, r2 },
            length_m: TrainDescription::CASE_STUDY.length_m,
            rng: &mut ChaCha8Rng::seed_from_u64(1),
        };
        let mut value = candidate.hidden(name, &mut hide).ok_or_else(|| "expected a hidden effect".to_owned())?;
        value["name"] = name.into();
        if let Some(runs) = value.get_mut("runs") {
            *runs = 1.0.into();
        }
        Ok(value)
    };
    candidate.hidden_names().into_iter().map(|name| (name, draw(name))).collect()
}

fn true_effect(value: &Value) -> Result<TrueEffect, String> {
    serde_json::from_value(value.clone()).map_err(|error| format!("expected an effect of the truth: {error}"))
}

fn board_effect(mut value: Value) -> Result<Effect, String> {
    value.as_object_mut().expect("an object").remove("runs");
    serde_json::from_value(value).map_err(|error| format!("expected an effect of the board: {error}"))
}

/// Cold enough for what acts in frost.
fn scenario(effects: &[TrueEffect], headings: Headings) -> Scenario {
    let climate = Climate { mean_c: 0.0, ..Climate::default() };
    Scenario { effects: effects.to_vec(), headings, climate, brake_test_share: 1.0, ..Scenario::default() }
}

/// The middle one of three runs.
fn planned(scenario: &Scenario) -> RunPlan {
    plan(scenario, 3, 5).swap_remove(1)
}

/// What three runs over a year show, to the last digit.
fn shown(effects: &[TrueEffect]) -> String {
    let scenario = scenario(effects, Headings::Up);
    let runs = plan(&scenario, 3, 5).into_iter().map(|plan| simulate_planned(&scenario, &plan).unwrap());
    runs.map(|run| format!("{:?} {:?}", run.truth, run.samples)).collect()
}

/// Largest difference of truth and board in the motion of a run, but for the steps across edges, and the largest
/// resistance that the board adds, N/kg.
fn motion(effect: &TrueEffect, board: &Effect, headings: Headings) -> (f64, f64) {
    let scenario = scenario(std::slice::from_ref(effect), headings);
    let (trace, facts, _) = drive_planned(&scenario, &planned(&scenario)).unwrap();
    let (mut errors, largest) = account(&scenario, board, headings, &trace, &facts);
    errors.sort_by(f64::total_cmp);
    (errors[errors.len() - 1 - errors.len() / 200], largest)
}

/// For each step what the board's model with the effect lacks.
fn account(
    scenario: &Scenario,
    board: &Effect,
    headings: Headings,
    trace: &[TruthSample],
    facts: &Facts,
) -> (Vec<f64>, f64) {
    let train = Train::try_new(TrainDescription::CASE_STUDY).unwrap();
    let gradients = scenario.line.gradients_permille().iter().map(|&(from_m, permille)| Gradient { from_m, permille });
    let curve = |curve: &truth::line::Curve| Curve { from_m: curve.from_m, to_m: curve.to_m, radius_m: curve.radius_m };
    let track = Track::try_new(scenario.line.length_m(), gradients).unwrap();
    let track = track.with_curves(scenario.line.curves().iter().map(curve)).unwrap();
    let direction = if headings == Headings::Up { Direction::Up } else { Direction::Down };
    let line = Line { train: &train, track: &track, direction };
    let (mut errors, mut largest) = (Vec::new(), 0.0_f64);
    for step in moving_steps(trace) {
        let moment = Moment {
            location_m: step.mean(|at| at.location_m),
            speed_mps: step.mean(|at| at.speed_mps),
            effort_n_per_kg: step.to.effort_n_per_kg * facts.train.rotating_mass_kg() / train.rotating_mass_kg(),
            since_departure_s: step.since_departure_s,
            stood_s: None,
            braked: step.braked,
            temperature_c: Some(step.mean(|at| at.temperature_c)),
            day: Some(facts.plan.season * PERIOD_DAYS),
        };
        let extra = board.resistance_n_per_kg(&line, &train.davis(), &moment);
        let resistance = train.davis().resistance_n_per_kg(moment.speed_mps) + extra;
        let expected = moment.effort_n_per_kg - resistance - line.gradient_n_per_kg(moment.location_m);
        errors.push((expected - step.acceleration_mps2()).abs());
        largest = largest.max(extra.abs());
    }
    (errors, largest)
}

/// Largest difference of what truth and board leave of traction and brake, and the most that the board takes; shares.
fn limits(effect: &TrueEffect, board: &Effect) -> (f64, f64) {
    let whole = Limits { effort_n_per_kg: 1.0, power_w_per_kg: 1.0, brake_n_per_kg: 1.0 };
    let (mut difference, mut largest) = (0.0_f64, 0.0_f64);
    for (location_m, kmh) in
        (0..60).flat_map(|at| (0..28).map(move |kmh| (100.0 * f64::from(at), 5.0 * f64::from(kmh))))
    {
        let speed_mps = (kmh + 0.1) / 3.6;
        let mut left = Capability::WHOLE;
        effect.law().cap(&mut left, Motion { location_m, speed_mps });
        let brake = effect.law().brake_share(speed_mps);
        let of_truth = [left.scale.min(left.effort_cap), left.scale.min(left.power_cap), brake];
        let Limits { effort_n_per_kg, power_w_per_kg, brake_n_per_kg } = board.limit(&whole, location_m, speed_mps);
        for (of_truth, of_board) in of_truth.into_iter().zip([effort_n_per_kg, power_w_per_kg, brake_n_per_kg]) {
            difference = difference.max((of_truth - of_board).abs());
            largest = largest.max((of_board - 1.0).abs());
        }
    }
    (difference, largest)
}

/// Largest difference of a location in m and a speed in m/s from those that the board makes of the truth's readings,
/// and how far it moves the readings.
fn readings(effect: &TrueEffect, board: &Effect) -> (f64, f64) {
    let scenario = Scenario::default();
    let mut world = Altered {
        line: scenario.line.clone(),
        train: scenario.train,
        headwind_mps: 0.0,
        speed_scale: 1.0,
        location_lag_s: 0.0,
        up_sign: 1.0,
        draws: ChaCha8Rng::seed_from_u64(1),
    };
    effect.law().alter(&mut world);
    let (location_m, speed_mps) = (5_000.0, 30.0);
    let shown = (location_m - world.location_lag_s * speed_mps, world.speed_scale * speed_mps);
    let corrected = board.correct(1.0, shown.0, shown.1);
    let far = |a: (f64, f64), b: (f64, f64)| (a.0 - b.0).abs().max((a.1 - b.1).abs());
    (far(corrected, (location_m, speed_mps)), far(corrected, shown))
}

/// All that is missing of an effect in the truth and on the board.
fn missing(effect: &TrueEffect, board: &Effect) -> Vec<String> {
    let mut missing = Vec::new();
    let mut most = 0.0_f64;
    let wind = Effects::try_new([board.clone()]).unwrap().wind_sd_mps();
    // Of a wind of each run the board knows the spread, which a single run does not show.
    let headings = if wind.is_some() { &[][..] } else { &[Headings::Up, Headings::Down] };
    for headings in headings {
        let (difference, largest) = motion(effect, board, *headings);
        if difference > EXACT_N_PER_KG {
            let found = format!("found {difference:.6} N/kg between them");
            missing.push(format!("expected one law in truth and on board, {found} ({headings:?})"));
        }
        most = most.max(largest / ACTS_N_PER_KG);
    }
    for (what, (difference, largest)) in
        [("limit", limits(effect, board)), ("correction of readings", readings(effect, board))]
    {
        if difference > 1e-9 {
            missing.push(format!("expected one {what} in truth and on board, found {difference:.6} between them"));
        }
        most = most.max(1e3 * largest);
    }
    if most < 1.0 && wind.is_none_or(|sd_mps| sd_mps <= 0.0) {
        missing.push("expected a law in src/model/effects that adds, limits or corrects, found none".to_owned());
    }
    missing
}

#[test]
fn every_kind_acts_in_the_truth_and_the_same_on_the_board() {
    let without = shown(&[]);
    let mut findings = Vec::new();
    for kind in EffectKind::ALL {
        let hidden = hidden(kind);
        if hidden.is_empty() {
            findings.push(format!("{kind}: expected a name of what the bench hides for it, found none"));
        }
        for (name, value) in hidden {
            let place = |missing: String| format!("{kind}: {name}: {missing}");
            let effect = match value.clone().and_then(|value| true_effect(&value)) {
                Ok(effect) => effect,
                Err(error) => {
                    findings.push(place(error));
                    continue;
                }
            };
            if shown(std::slice::from_ref(&effect)) == without {
                findings.push(place("expected a law in sim-harness/truth that alters a run, found none".to_owned()));
            }
            // What the board knows as a table only is in no catalogue of the truth.
            if effect.kind() != Some(kind).filter(|kind| *kind != EffectKind::Unknown) {
                findings.push(place(format!("expected an effect of this kind, found {:?}", effect.kind())));
            }
            if kind != EffectKind::Unknown {
                match value.and_then(board_effect) {
                    Ok(board) => findings.extend(missing(&effect, &board).into_iter().map(place)),
                    Err(error) => findings.push(place(error)),
                }
            }
        }
    }
    assert!(findings.is_empty(), "\n{}", findings.join("\n"));
}
