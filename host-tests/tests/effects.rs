//! Does the model with a named effect come nearer to a truth that has it? The truth is integrated here, with equations
//! of its own.
//!
//! `cargo test -p host-tests --test effects -- --nocapture` prints the figures.

use host_tests::accuracy::NOMINAL as DESCRIBED;
use host_tests::prelude::*;
use rundown::model::effects::*;

/// A tenth off the description, so that there is something to learn beside the effect.
const TRUE: Davis = Davis { r0: 0.9 * DESCRIBED.r0, r1: 0.9 * DESCRIBED.r1, r2: 0.9 * DESCRIBED.r2 };
const LENGTH_M: f64 = 162.0;
const GAMMA: f64 = 1.06;
const TOP_MPS: f64 = 140.0 / 3.6;

fn train(davis: Davis) -> Train {
    Train::try_new(TrainDescription { davis, ..TrainDescription::CASE_STUDY }).unwrap()
}

fn track() -> Track {
    let gradients = [(0.0, 0.0), (9e3, 3.0), (12e3, -2.0), (16e3, 0.0)];
    let gradients = gradients.map(|(from_m, permille)| Gradient { from_m, permille });
    let curve = Curve { from_m: 9.5e3, to_m: 13e3, radius_m: 400.0 };
    Track::try_new(60e3, gradients).unwrap().with_curves([curve]).unwrap()
}

fn gradient_n_per_kg(front_m: f64) -> f64 {
    // 100 slices of the train, each on its own slope.
    let slope = |at_m: f64| match at_m {
        at_m if at_m < 9e3 => 0.0,
        at_m if at_m < 12e3 => 0.003,
        at_m if at_m < 16e3 => -0.002,
        _ => 0.0,
    };
    let mean: f64 = (0..100).map(|i| slope(front_m - LENGTH_M * (f64::from(i) + 0.5) / 100.0)).sum();
    9.80665 / GAMMA * mean / 100.0
}

/// Share of the train between two places, by slices.
fn share(front_m: f64, from_m: f64, to_m: f64) -> f64 {
    let inside = |i: &i32| {
        let at_m = front_m - LENGTH_M * (f64::from(*i) + 0.5) / 100.0;
        (from_m..to_m).contains(&at_m)
    };
    (0..100).filter(inside).count() as f64 / 100.0
}

/// Where the truth is at a moment.
struct Now {
    front_m: f64,
    v: f64,
    t: f64,
    braked: bool,
}

/// One run: stand, accelerate, cruise, brake a little, accelerate, coast long, brake. `variant` shifts it a little.
fn run(variant: u32, true_davis: Davis, extra: &dyn Fn(&Now) -> f64) -> Vec<Measurement> {
    run_as_read(variant, true_davis, extra, 1.0, 0.0)
}

/// The same with a speed that reads `scale` times too much and a location that is `lag_s` old.
fn run_as_read(
    variant: u32,
    true_davis: Davis,
    extra: &dyn Fn(&Now) -> f64,
    scale: f64,
    lag_s: f64,
) -> Vec<Measurement> {
    const STEP_S: f64 = 0.05;
    let mut now = Now { front_m: 0.0, v: 0.0, t: 0.0, braked: false };
    let mut phase = 0;
    let mut since_s = 0.0;
    let mut samples = Vec::new();
    let mut step = 0_u32;
    loop {
        if step.is_multiple_of(200) {
            let whole_kmh = (3.6 * scale * now.v).round();
            samples.push(Measurement {
                time_s: now.t,
                location_m: Some(now.front_m - lag_s * now.v),
                speed_mps: Some(whole_kmh / 3.6),
                effort_n_per_kg: None,
            });
        }
        let resistance = true_davis.resistance_n_per_kg(now.v) + gradient_n_per_kg(now.front_m) + extra(&now);
        let hold = 30.0 + 7.0 * f64::from(variant);
        let (a, over) = match phase {
            0 => (0.0, since_s > 30.0),
            1 => ((0.5_f64).min(10.0 / now.v.max(1.0)) * 0.6, now.v >= TOP_MPS),
            2 => (0.0, since_s > hold),
            3 => (-0.35, now.v <= 100.0 / 3.6),
            4 => (0.12, now.v >= TOP_MPS),
            5 => (0.0, since_s > hold),
            6 => (-resistance, now.v <= 70.0 / 3.6 || since_s > 330.0),
            7 => (-0.4, now.v <= 0.0),
            _ => (0.0, since_s > 60.0),
        };
        if phase == 8 && over {
            return samples;
        }
        now.braked |= phase == 3;
        let next = (now.v + STEP_S * a).max(0.0);
        now.front_m += STEP_S * 0.5 * (now.v + next);
        now.v = next;
        since_s += STEP_S;
        if over {
            phase += 1;
            since_s = 0.0;
        }
        step += 1;
        now.t = f64::from(step) * STEP_S;
    }
}

/// r(v) of the last run's train after four runs; and how long was learned.
fn learned(estimator: &Estimator, logs: &[Vec<Measurement>], surroundings: Surroundings) -> (Davis, f64) {
    let mut vehicle = estimator.new_vehicle();
    learned_from(estimator, &mut vehicle, logs, surroundings)
}

fn learned_from(
    estimator: &Estimator,
    vehicle: &mut Vehicle,
    logs: &[Vec<Measurement>],
    surroundings: Surroundings,
) -> (Davis, f64) {
    let mut found = (DESCRIBED, 0.0);
    for log in logs {
        let mut run = estimator.begin_run(vehicle, Direction::Up);
        estimator.set_surroundings(&mut run, surroundings);
        for measurement in log {
            estimator.step(&mut run, measurement).unwrap();
        }
        let summary = estimator.end_run(&mut run, vehicle);
        let [r0, r1, r2] = summary.run_davis.mean.into();
        found = (Davis { r0, r1, r2 }, found.1 + summary.learned_s);
    }
    found
}

/// Relative error of r(v), root mean square over the speeds that were coasted.
fn error(found: &dyn Fn(f64) -> f64, truth: &dyn Fn(f64) -> f64) -> f64 {
    let speeds = || (80..=135).step_by(5).map(|kmh| f64::from(kmh) / 3.6);
    let square = |v: f64| (found(v) / truth(v) - 1.0).powi(2);
    (speeds().map(square).sum::<f64>() / speeds().count() as f64).sqrt()
}

fn estimator(davis: Davis, effects: Effects) -> Estimator {
    Estimator::try_new(Config::default(), train(davis), track()).unwrap().with_effects(effects)
}

type Extra = Box<dyn Fn(&Now) -> f64>;

/// Each effect that changes coasting, with the law as the truth has it, written here a second time.
fn hidden() -> Vec<(Effect, Extra)> {
    let r2 = TRUE.r2;
    vec![
        (
            Effect::TunnelDrag(TunnelDrag { from_m: 10e3, to_m: 17e3, k: 1e-5 }),
            Box::new(|now| 1e-5 * now.v * now.v * share(now.front_m, 10e3, 17e3)),
        ),
        (
            Effect::CurveResistance(CurveResistance { coefficient_roeckl: 1.2 }),
            Box::new(|now| 1.2 * 0.65 / 345.0 * 9.80665 / GAMMA * share(now.front_m, 9.5e3, 13e3)),
        ),
        (
            Effect::GradientError(GradientError { from_m: 10e3, to_m: 14e3, delta_permille: 1.5 }),
            Box::new(|now| 0.0015 * 9.80665 / GAMMA * share(now.front_m, 10e3, 14e3)),
        ),
        (Effect::SteadyWind(SteadyWind { wind_mps: 4.0 }), Box::new(move |now| r2 * (8.0 * now.v + 16.0))),
        (Effect::MassError(MassError { relative: 0.25 }), Box::new(move |now| -0.2 * r2 * now.v * now.v)),
        (
            Effect::DraggingBrake(DraggingBrake { drag_n_per_kg: 0.008 }),
            Box::new(|now| if now.braked { 0.008 } else { 0.0 }),
        ),
        (
            Effect::TemperatureResistance(TemperatureResistance { dr0_per_deg_c: -2e-4, ref_c: 15.0 }),
            Box::new(|_| 0.005),
        ),
        (
            Effect::SeasonalDrift(SeasonalDrift { dr0_over_period: 8e-3, period_days: 200.0, reference_day: 20_000.0 }),
            Box::new(|_| 0.004),
        ),
        (
            Effect::WarmUp(WarmUp { amplitude: 0.02, tau_s: 400.0 }),
            Box::new(|now| 0.02 * (-(now.t - 30.0) / 400.0).exp()),
        ),
        (
            Effect::DavisError(DavisError { dr0: 2e-3, dr1: 5e-5, dr2: 2e-6 }),
            Box::new(|now| 2e-3 + 5e-5 * now.v + 2e-6 * now.v * now.v),
        ),
        (
            Effect::Unknown(Unknown {
                coordinate: Coordinate::Location,
                table: [(10e3, 0.0), (12e3, 0.01), (14e3, 0.0)].into_iter().collect(),
            }),
            Box::new(|now| 0.01 * (1.0 - (now.front_m - 12e3).abs() / 2e3).max(0.0)),
        ),
    ]
}

/// Given a truth with an effect / When the model has the same effect / Then the learned r(v) is near the truth's, and
/// further without it.
#[test]
fn an_effect_in_the_model_does_not_hide_in_the_resistance() {
    let surroundings = Surroundings { temperature_c: Some(-10.0), day: Some(20_100.0) };
    let truth = |v| TRUE.resistance_n_per_kg(v);
    println!("effect                    without   with (rms error of r(v), 80-135 km/h, 4 runs)");
    for (effect, extra) in hidden() {
        let logs: Vec<_> = (0..4).map(|variant| run(variant, TRUE, &*extra)).collect();
        let find = |effects: Effects| {
            let (davis, learned_s) = learned(&estimator(DESCRIBED, effects), &logs, surroundings);
            assert!(learned_s > 200.0, "{}: learned for {learned_s} s", effect.name());
            error(&|v| davis.resistance_n_per_kg(v), &truth)
        };
        let without = find(Effects::NONE);
        let with = find(Effects::try_new([effect.clone()]).unwrap());
        println!("{:<25} {:6.2} %  {:6.2} %", effect.name(), 100.0 * without, 100.0 * with);
        assert!(with < 0.015, "{}: {with}", effect.name());
        assert!(with < 0.5 * without, "{}: {with}, without it {without}", effect.name());
    }
}

/// What the docs of `effects::Acting` say: the effect adds no slope to the covariance, and that costs little.
#[test]
fn an_extra_term_without_a_slope_costs_little() {
    let k = DESCRIBED.r2 / 3.0;
    let true_davis = Davis { r2: TRUE.r2 + k, ..TRUE };
    let logs: Vec<_> = (0..4).map(|variant| run(variant, true_davis, &|_| 0.0)).collect();
    let sd = [1.5e-3, 3e-5, 5e-6];
    let of = |davis: Davis, effects: Effects| {
        let estimator = estimator(davis, effects);
        let mut vehicle = Vehicle::independent(davis, sd);
        learned_from(&estimator, &mut vehicle, &logs, Surroundings::default()).0
    };
    let tunnel = Effect::TunnelDrag(TunnelDrag { from_m: -1e6, to_m: 1e6, k });
    let by_effect = of(DESCRIBED, Effects::try_new([tunnel]).unwrap());
    // The same term inside the state, with its slope.
    let in_state = of(Davis { r2: DESCRIBED.r2 + k, ..DESCRIBED }, Effects::NONE);
    let cost = error(&|v| by_effect.resistance_n_per_kg(v) + k * v * v, &|v| in_state.resistance_n_per_kg(v));
    println!("tunnel as an extra term against the same term in the state: {:.4} % of r(v)", 100.0 * cost);
    assert!(cost < 1e-3, "{cost}");
}

/// Given readings that are off / When the model knows it / Then the resistance is as near as with good readings.
#[test]
fn readings_are_put_right() {
    let (scale, lag_s) = (1.03, 4.0);
    let truth = |v| TRUE.resistance_n_per_kg(v);
    let logs = |scale, lag_s| -> Vec<Vec<Measurement>> {
        let log = |variant| run_as_read(variant, TRUE, &|_| 0.0, scale, lag_s);
        (0..4).map(log).collect()
    };
    let (good, bad) = (logs(1.0, 0.0), logs(scale, lag_s));
    let find = |logs: &[Vec<Measurement>], effects: &[Effect]| {
        let effects = Effects::try_new(effects.iter().cloned()).unwrap();
        let (davis, _) = learned(&estimator(DESCRIBED, effects), logs, Surroundings::default());
        error(&|v| davis.resistance_n_per_kg(v), &truth)
    };
    let scale = Effect::SpeedScale(SpeedScale { measured_over_true: scale });
    let lag = Effect::LocationLag(LocationLag { lag_s });
    let [good, without, with] = [find(&good, &[]), find(&bad, &[]), find(&bad, &[scale, lag])];
    println!(
        "speed 3 % and location 4 s off: error {:.2} %, put right {:.2} %, good readings {:.2} %",
        100.0 * without,
        100.0 * with,
        100.0 * good
    );
    assert!(with < 0.015, "{with}, good readings {good}");
    assert!(with < 0.5 * without, "{with}, without {without}");
}

#[test]
fn limits_are_those_of_the_model() {
    let effects = Effects::try_new([
        Effect::PowerLimitSection(PowerLimitSection { from_m: 5e3, to_m: 9e3, factor: 0.5 }),
        Effect::BrakeFade(BrakeFade { fade_at_140: 0.4, from_kmh: 90.0 }),
        Effect::LowAdhesion(LowAdhesion { factor: 0.5, below_kmh: 30.0 }),
    ])
    .unwrap();
    let believed = estimator(DESCRIBED, Effects::NONE);
    let weak = estimator(DESCRIBED, effects);
    let share = |location_m, v| {
        let (t0, b0) = believed.limits_n_per_kg(location_m, v);
        let (t, b) = weak.limits_n_per_kg(location_m, v);
        ((t / t0 * 1e6).round() / 1e6, (b / b0 * 1e6).round() / 1e6)
    };
    assert_eq!(share(6e3, 30.0), (0.5, 1.0 - 0.4 * 18.0 / 50.0));
    assert_eq!(share(4e3, 20.0), (1.0, 1.0));
    assert_eq!(share(4e3, 5.0), (0.5, 1.0));
}

/// A wind that differs from run to run widens what a new run may be, and what it is now takes no part.
#[test]
fn a_known_run_wind_is_the_memorys_wind() {
    let calm = estimator(DESCRIBED, Effects::try_new([Effect::RunWind(RunWind { sd_mps: 0.0 })]).unwrap());
    let windy = estimator(DESCRIBED, Effects::try_new([Effect::RunWind(RunWind { sd_mps: 6.0 })]).unwrap());
    assert_eq!(calm.memory_config().wind_sd_mps, 0.0);
    let sd = |estimator: &Estimator| {
        let next = estimator.new_vehicle().next_run(&estimator.memory_config());
        rundown::model::state::resistance_sd(&next, 30.0)
    };
    assert!(sd(&windy) > 1.2 * sd(&calm), "{} {}", sd(&windy), sd(&calm));
}
