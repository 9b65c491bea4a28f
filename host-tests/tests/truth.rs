//! Does the simulator do what it says? Each effect against its law, written here a second time from the description of
//! the train and the line; energy; drivers under effects; logs read back.
//!
//! The account of a step: speed change over time against the described model under the effort in newton. What is
//! missing is what the effect took.

use host_tests::moving::moving_steps;
use host_tests::prelude::*;
use rundown_files::replay::{Tick, replay_carried_by};
use rundown_truth::driver::Regime;
use rundown_truth::effects::*;
use rundown_truth::facts::Facts;
use rundown_truth::line::Line;
use rundown_truth::plan::{Heading, Headings, RunPlan, plan};
use rundown_truth::sensors::{SpeedReading, TruthSample};
use sim_harness::simulation::folder;
use sim_harness::simulation::scenario_file::Simulation;

const GRAVITY_MPS2: f64 = 9.80665;
/// Described train of the case study.
const GAMMA: f64 = 1.06;
const ROTATING_MASS_KG: f64 = 364_000.0 * GAMMA;
const LENGTH_M: f64 = 162.0;
const DAVIS: [f64; 3] = [7.38e-3, 1.6e-4, 2.8e-5];
const MAX_POWER_W: f64 = 2_036_377.8;
const MAX_EFFORT_N: f64 = 192_920.0;

/// What the laws need to know of a step.
struct At<'a> {
    v: f64,
    /// Tail and front, smaller first.
    train_m: [f64; 2],
    /// +1 up, -1 down.
    sign: f64,
    /// Effort over described rotating mass.
    u: f64,
    since_departure_s: f64,
    braked: bool,
    temperature_c: f64,
    facts: &'a Facts,
}

impl At<'_> {
    fn share(&self, from_m: f64, to_m: f64) -> f64 {
        overlap(self.train_m, [from_m, to_m]) / LENGTH_M
    }
}

fn overlap([a, b]: [f64; 2], [from, to]: [f64; 2]) -> f64 {
    (b.min(to) - a.max(from)).max(0.0)
}

/// Mean gradient in permille between two locations, by adding up pieces.
fn mean_permille(gradients: &[(f64, f64)], [a, b]: [f64; 2]) -> f64 {
    let end = |index: usize| gradients.get(index + 1).map_or(f64::INFINITY, |g| g.0);
    let piece = |(index, g): (usize, &(f64, f64))| g.1 * overlap([a, b], [g.0, end(index)]);
    gradients.iter().enumerate().map(piece).sum::<f64>() / (b - a)
}

type Law = Box<dyn Fn(&At) -> f64>;

/// An effect of clear size, the same of size zero, and its law as extra resistance in N/kg of described mass.
fn motion_effects() -> Vec<(Effect, Effect, Law)> {
    let all = || Affected::Share(1.0);
    let g = GRAVITY_MPS2 / GAMMA;
    let wind = |v: f64, w: f64| DAVIS[2] * ((v + w) * (v + w).abs() - v * v);
    let bump = |x: f64| {
        if x.abs() < 1.0 { 0.5 + 0.5 * (std::f64::consts::PI * x).cos() } else { 0.0 }
    };
    let tunnel = |k| Effect::from(TunnelDrag { from_m: 9_000.0, to_m: 11_000.0, k });
    let gradient = |delta_permille| Effect::from(GradientError { from_m: 15_000.0, to_m: 15_800.0, delta_permille });
    let davis = |s: f64| Effect::from(DavisError { dr0: 1e-3 * s, dr1: 5e-5 * s, dr2: -4e-6 * s });
    let temperature = |dr0_per_deg_c| Effect::from(TemperatureResistance { dr0_per_deg_c, ref_c: 15.0 });
    let drag = |drag_n_per_kg| Effect::from(DraggingBrake { drag_n_per_kg, runs: all() });
    let warm = |amplitude| Effect::from(WarmUp { amplitude, tau_s: 240.0 });
    let start = |amplitude| {
        Effect::from(StartingResistance { amplitude, decay_kmh: 10.0, standing_min: 5.0, cold_per_deg_c: 0.0 })
    };
    let speed = |drag_n_per_kg| Effect::from(SpeedBump { at_kmh: 100.0, half_width_kmh: 20.0, drag_n_per_kg });
    let place = |drag_n_per_kg| Effect::from(LocationBump { from_m: 12_000.0, to_m: 14_000.0, drag_n_per_kg });
    let periodic = |amplitude| Effect::from(PeriodicDrag { amplitude, period_s: 300.0 });
    let frost = |drag_n_per_kg| Effect::from(Frost { below_c: 30.0, drag_n_per_kg });
    let step = |drag_n_per_kg| Effect::from(DayStep { from_share: 0.3, drag_n_per_kg });
    let boxed = |law: fn(&At) -> f64| -> Law { Box::new(law) };
    vec![
        (tunnel(1.5e-5), tunnel(0.0), boxed(|at| 1.5e-5 * at.v * at.v * at.share(9_000.0, 11_000.0))),
        (
            Effect::from(CurveResistance { coefficient_roeckl: 1.2 }),
            Effect::from(CurveResistance { coefficient_roeckl: 0.0 }),
            Box::new(move |at| {
                let line = Line::flat_corridor();
                // All its curves are wider than 300 m.
                let of = |c: &rundown_truth::line::Curve| at.share(c.from_m, c.to_m) * 0.65 / (c.radius_m - 55.0);
                1.2 * g * line.curves().iter().map(of).sum::<f64>()
            }),
        ),
        (gradient(3.0), gradient(0.0), Box::new(move |at| at.sign * g * 3e-3 * at.share(15_000.0, 15_800.0))),
        (
            Effect::from(SteadyWind { wind_mps: 5.0 }),
            Effect::from(SteadyWind { wind_mps: 0.0 }),
            Box::new(move |at| wind(at.v, 5.0 * at.sign)),
        ),
        (
            Effect::from(RunWind { sd_mps: 3.0 }),
            Effect::from(RunWind { sd_mps: 0.0 }),
            Box::new(move |at| wind(at.v, at.facts.headwind_mps)),
        ),
        (
            Effect::from(MassError { relative: 0.08 }),
            Effect::from(MassError { relative: 0.0 }),
            boxed(|at| (at.u - DAVIS[2] * at.v * at.v) * (1.0 - 1.0 / 1.08)),
        ),
        (drag(0.01), drag(0.0), boxed(|at| if at.braked { 0.01 } else { 0.0 })),
        (temperature(-2e-4), temperature(0.0), boxed(|at| -2e-4 * (at.temperature_c - 15.0))),
        (
            Effect::from(SeasonalDrift { dr0_over_period: 6e-3 }),
            Effect::from(SeasonalDrift { dr0_over_period: 0.0 }),
            boxed(|at| 6e-3 * at.facts.plan.season),
        ),
        (
            Effect::from(TrainLengthError { true_length_m: 260.0, runs: Affected::all() }),
            Effect::from(TrainLengthError { true_length_m: LENGTH_M, runs: Affected::all() }),
            Box::new(move |at| {
                let line = Line::flat_corridor();
                let [low, high] = at.train_m;
                let longer = if at.sign > 0.0 { [high - 260.0, high] } else { [low, low + 260.0] };
                let mean = |under| mean_permille(line.gradients_permille(), under) / 1000.0;
                at.sign * g * (mean(longer) - mean(at.train_m))
            }),
        ),
        (warm(5e-3), warm(0.0), boxed(|at| 5e-3 * (-at.since_departure_s / 240.0).exp())),
        (start(0.02), start(0.0), boxed(|at| 0.02 * (-3.6 * at.v / 10.0).exp())),
        (davis(1.0), davis(0.0), boxed(|at| 1e-3 + 5e-5 * at.v - 4e-6 * at.v * at.v)),
        (Effect::from(CubicDrag { k: 2e-7 }), Effect::from(CubicDrag { k: 0.0 }), boxed(|at| 2e-7 * at.v.powi(3))),
        (speed(6e-3), speed(0.0), Box::new(move |at| 6e-3 * bump((3.6 * at.v - 100.0) / 20.0))),
        (
            place(6e-3),
            place(0.0),
            Box::new(move |at| {
                let middle_m = (at.train_m[0] + at.train_m[1]) / 2.0;
                6e-3 * bump((middle_m - 13_000.0) / 1_000.0)
            }),
        ),
        (
            periodic(4e-3),
            periodic(0.0),
            boxed(|at| 4e-3 * (at.since_departure_s * 2.0 * std::f64::consts::PI / 300.0).sin()),
        ),
        (frost(4e-3), frost(0.0), boxed(|at| 4e-3 * ((30.0 - at.temperature_c) / 2.0).clamp(0.0, 1.0))),
        (step(4e-3), step(0.0), boxed(|at| if at.facts.plan.season >= 0.3 { 4e-3 } else { 0.0 })),
    ]
}

/// Effects on traction, brake and readings: of a clear size, and of none.
fn other_effects() -> Vec<(Effect, Effect)> {
    let all = || Affected::Share(1.0);
    let section = |factor| Effect::from(PowerLimitSection { from_m: 0.0, to_m: 4_000.0, factor, runs: all() });
    let slip = |factor| Effect::from(LowAdhesion { factor, below_kmh: 35.0, runs: all() });
    let fade = |fade_at_140| Effect::from(BrakeFade { fade_at_140, from_kmh: 60.0 });
    vec![
        (section(0.7), section(1.0)),
        (Effect::from(TractionScale { factor: 0.85 }), Effect::from(TractionScale { factor: 1.0 })),
        (slip(0.5), slip(1.0)),
        (fade(0.35), fade(0.0)),
        (Effect::from(SpeedScale { measured_over_true: 1.03 }), Effect::from(SpeedScale { measured_over_true: 1.0 })),
        (Effect::from(LocationLag { lag_s: 3.0 }), Effect::from(LocationLag { lag_s: 0.0 })),
    ]
}

fn every_effect() -> Vec<(Effect, Effect)> {
    let moving = motion_effects().into_iter().map(|(clear, zero, _)| (clear, zero));
    moving.chain(other_effects()).collect()
}

/// All brakes are tried after the departure, so that what begins with a brake shows.
fn scenario(effects: &[Effect], headings: Headings) -> Scenario {
    Scenario { effects: effects.to_vec(), headings, brake_test_share: 1.0, ..Scenario::default() }
}

/// The middle one of three runs.
fn planned(scenario: &Scenario, seed: u64) -> RunPlan {
    plan(scenario, 3, seed).swap_remove(1)
}

fn driven(scenario: &Scenario, seed: u64) -> (Vec<TruthSample>, Facts) {
    let (trace, facts, _) = drive_planned(scenario, &planned(scenario, seed)).unwrap();
    (trace, facts)
}

#[test]
fn every_effect_takes_what_its_law_says() {
    for (effect, _, law) in motion_effects() {
        for headings in [Headings::Up, Headings::Down] {
            let scenario = scenario(std::slice::from_ref(&effect), headings);
            let (trace, facts) = driven(&scenario, 5);
            let (errors, largest) = account(&scenario, &trace, &facts, &law);
            let worst = errors.iter().copied().fold(0.0, f64::max);
            // A step across the edge of a gradient or section sees both sides of a kink.
            let kinks = errors.iter().filter(|e| **e > 1e-5).count();
            let context = format!("{} {headings:?}: {worst:e} of {largest:e} N/kg, {kinks} kinks", effect.name());
            assert!(worst < 2e-4 && 200 * kinks < errors.len(), "{context}");
            assert!(largest > 5e-4, "{context}");
        }
    }
}

/// For each step the difference between what is missing in the described model and the law, and the largest value of
/// the law, N/kg.
fn account(scenario: &Scenario, trace: &[TruthSample], facts: &Facts, law: &Law) -> (Vec<f64>, f64) {
    let up = facts.plan.heading == Heading::Up;
    let sign = if up { 1.0 } else { -1.0 };
    let (mut errors, mut largest) = (Vec::new(), 0.0_f64);
    for step in moving_steps(trace) {
        let v = step.mean(|at| at.speed_mps);
        let front_m = step.mean(|at| at.location_m);
        let train_m = if up { [front_m - LENGTH_M, front_m] } else { [front_m, front_m + LENGTH_M] };
        let at = At {
            v,
            train_m,
            sign,
            u: step.to.effort_n_per_kg * facts.train.rotating_mass_kg() / ROTATING_MASS_KG,
            since_departure_s: step.since_departure_s,
            braked: step.braked,
            temperature_c: step.mean(|at| at.temperature_c),
            facts,
        };
        let permille = mean_permille(scenario.line.gradients_permille(), train_m);
        let gravity = sign * GRAVITY_MPS2 / GAMMA * permille / 1000.0;
        let described = at.u - DAVIS[0] - DAVIS[1] * v - DAVIS[2] * v * v - gravity;
        let missing = described - step.acceleration_mps2();
        let expected = law(&at);
        errors.push((missing - expected).abs());
        largest = largest.max(expected.abs());
    }
    (errors, largest)
}

#[test]
fn an_effect_of_size_zero_changes_nothing() {
    for (_, zero) in every_effect() {
        for headings in [Headings::Up, Headings::Down] {
            let with = scenario(std::slice::from_ref(&zero), headings);
            let without = scenario(&[], headings);
            let a = simulate_planned(&with, &planned(&with, 8)).unwrap();
            let b = simulate_planned(&without, &planned(&without, 8)).unwrap();
            assert_eq!(a.samples.len(), b.samples.len(), "{}", zero.name());
            for (a, b) in a.truth.iter().zip(&b.truth) {
                let moved_m = (a.location_m - b.location_m).abs();
                assert!(moved_m < 1e-6, "{} {headings:?}: {moved_m} m", zero.name());
                assert_eq!(a.regime, b.regime, "{}", zero.name());
            }
            let readings =
                |run: &rundown_truth::scenario::Run| -> Vec<_> { run.samples.iter().map(|s| s.speed_kmh).collect() };
            assert_eq!(readings(&a), readings(&b), "{}", zero.name());
        }
    }
}

#[test]
fn caps_of_traction_hold_and_are_reached() {
    // Largest power in watt and effort in newton of a part of the steps, over ten runs.
    let most = |effects: &[Effect], part: &dyn Fn(&TruthSample) -> bool| {
        let scenario = scenario(effects, Headings::Up);
        let (mut power, mut effort) = (0.0_f64, 0.0_f64);
        for seed in 0..10 {
            let (trace, _) = driven(&scenario, seed);
            for pair in trace.windows(2).filter(|p| part(&p[0])) {
                let force_n = pair[1].effort_n_per_kg * ROTATING_MASS_KG;
                effort = effort.max(force_n);
                power = power.max(force_n * pair[0].speed_mps);
            }
        }
        (power / MAX_POWER_W, effort / MAX_EFFORT_N)
    };
    let others = other_effects();
    let (section, scale, slip) = (&others[0].0, &others[1].0, &others[2].0);
    let inside = |at: &TruthSample| at.location_m < 4_000.0;
    let outside = |at: &TruthSample| at.location_m > 4_001.0;
    let slow = |at: &TruthSample| at.speed_mps < 34.9 / 3.6;
    let (free, free_effort) = (most(&[], &inside).0, most(&[], &slow).1);
    assert!(free > 0.8 && free_effort > 0.9, "{free} {free_effort}");
    let capped = most(std::slice::from_ref(section), &inside).0;
    assert!((capped - 0.7).abs() < 1e-9, "{capped}");
    let beyond = most(std::slice::from_ref(section), &outside).0;
    assert!((beyond - most(&[], &outside).0).abs() < 1e-3, "{beyond}");
    // A lever at a share of the maximum gives that share of the smaller one.
    let scaled = most(std::slice::from_ref(scale), &|_| true).0;
    assert!((scaled - 0.85 * most(&[], &|_| true).0).abs() < 1e-3, "{scaled}");
    let slipping = most(std::slice::from_ref(slip), &slow).1;
    assert!((slipping - 0.5).abs() < 1e-9, "{slipping}");
}

#[test]
fn a_fading_brake_gives_less_than_it_reports() {
    let scenario = scenario(&[other_effects()[3].0.clone()], Headings::Up);
    let mut compared = 0;
    for seed in 0..5 {
        let (trace, _) = driven(&scenario, seed);
        for pair in trace.windows(2).filter(|p| p[1].reported_n_per_kg < -0.05) {
            let kmh = 3.6 * pair[0].speed_mps;
            let left = 1.0 - 0.35 * (kmh - 60.0).max(0.0) / 80.0;
            let found = pair[1].effort_n_per_kg / pair[1].reported_n_per_kg;
            assert!((found - left).abs() < 1e-9, "seed {seed} at {kmh} km/h");
            compared += usize::from(kmh > 80.0);
        }
    }
    assert!(compared > 1_000, "{compared} steps above 80 km/h");
}

#[test]
fn a_wrong_wheel_misleads_the_driver_and_a_late_receiver_the_log() {
    let exact = Sensors { speed: SpeedReading::Exact, location_noise_m: 0.0, sampling_s: 1.0, ..Sensors::default() };
    let others = other_effects();
    let run = |effects: &[Effect], seed: u64| {
        let scenario = Scenario { sensors: exact.clone(), ..scenario(effects, Headings::Up) };
        simulate_planned(&scenario, &planned(&scenario, seed)).unwrap()
    };
    let fastest = |run: &rundown_truth::scenario::Run| run.truth.iter().map(|t| t.speed_mps).fold(0.0, f64::max);
    for seed in 0..5 {
        let (right, wrong) = (run(&[], seed), run(&[others[4].0.clone()], seed));
        for (sample, truth) in wrong.samples.iter().zip(&wrong.truth) {
            let shown = sample.speed_kmh.unwrap();
            assert!((shown - 3.6 * truth.speed_mps * 1.03).abs() < 1e-9, "seed {seed}");
        }
        let slower = fastest(&right) / fastest(&wrong);
        assert!((slower - 1.03).abs() < 0.006, "seed {seed}: {slower}");

        let late = run(&[others[5].0.clone()], seed);
        for (index, sample) in late.samples.iter().enumerate().skip(3) {
            let then = late.truth[index - 3].location_m;
            assert!((sample.location_m.unwrap() - then).abs() < 1e-9, "seed {seed}");
        }
    }
}

#[test]
fn wind_of_the_runs_has_its_size_and_some_runs_are_some() {
    let scenario = scenario(
        &[RunWind { sd_mps: 3.0 }.into(), DraggingBrake { drag_n_per_kg: 0.01, runs: Affected::Share(0.25) }.into()],
        Headings::Both,
    );
    let plans = plan(&scenario, 200, 4);
    assert_eq!(plans.iter().filter(|p| p.acting[1]).count(), 50);
    let worlds = plans.iter().map(|plan| rundown_truth::world::World::new(&scenario, plan, 1.0, 0.0));
    let winds: Vec<f64> = worlds.map(|world| world.headwind_mps).collect();
    let mean = winds.iter().sum::<f64>() / 200.0;
    let sd = (winds.iter().map(|w| w * w).sum::<f64>() / 200.0).sqrt();
    assert!((sd - 3.0).abs() < 0.5 && mean.abs() < 0.7, "{mean} ± {sd} m/s");
}

/// Work at the wheels = kinetic + potential energy + losses, with every effect alone and all at once, in both
/// directions, on hills.
#[test]
fn energy_is_kept_under_every_effect() {
    let mut sets: Vec<Vec<Effect>> = every_effect().into_iter().map(|(e, _)| vec![e]).collect();
    sets.push(Vec::new());
    sets.push(every_effect().into_iter().map(|(e, _)| e).collect());
    for effects in sets {
        let names: Vec<&str> = effects.iter().map(Effect::name).collect();
        for headings in [Headings::Up, Headings::Down] {
            let mut scenario = scenario(&effects, headings);
            let mut hilly = Line::hilly(3);
            hilly.set_curves(scenario.line.curves().to_vec());
            scenario.line = hilly;
            scenario.load_sd = 0.03;
            let plan = planned(&scenario, 6);
            let (trace, facts, world) = drive_planned(&scenario, &plan).unwrap();
            let train = facts.train;
            // Mean height of the train in slices, on the line as it is.
            let height_m = |front_m: f64| {
                let slice = |i: i32| {
                    let behind_m = (f64::from(i) + 0.5) * train.length_m / 1000.0;
                    world.line.height_m(front_m - behind_m)
                };
                (0..1000).map(slice).sum::<f64>() / 1000.0
            };
            let way_m = |at: &TruthSample| (at.location_m - trace[0].location_m).abs();
            let end = trace.partition_point(|step| step.time_s <= facts.final_brake.time_s);
            let (mut work, mut traction, mut losses) = (0.0, 0.0, 0.0);
            for pair in trace[..=end].windows(2) {
                let ds = way_m(&pair[1]) - way_m(&pair[0]);
                work += pair[1].effort_n_per_kg * ds;
                traction += pair[1].effort_n_per_kg.max(0.0) * ds;
                losses += (pair[0].resistance_n_per_kg + pair[1].resistance_n_per_kg) / 2.0 * ds;
            }
            let kinetic = trace[end].speed_mps.powi(2) / 2.0;
            let potential = GRAVITY_MPS2 / train.gamma * (height_m(way_m(&trace[end])) - height_m(0.0));
            let gap = (work - kinetic - potential - losses).abs() / traction;
            assert!(gap < 1e-3, "{names:?} {headings:?}: {gap:e} of the traction");
        }
    }
}

#[test]
fn drivers_stop_within_two_metres_under_every_effect_and_a_finer_step_changes_little() {
    for (effect, _) in every_effect() {
        for headings in [Headings::Up, Headings::Down] {
            for seed in 0..3 {
                let coarse = scenario(std::slice::from_ref(&effect), headings);
                let (_, facts) = driven(&coarse, seed);
                let platform_m = if headings == Headings::Up { 32_103.0 } else { 0.0 };
                let off_m = facts.stop.location_m - platform_m;
                let context = format!("{} {headings:?} seed {seed}", effect.name());
                assert!(off_m.abs() < 2.0, "{context}: {off_m} m");
                let fine = Scenario { step_s: 0.025, ..coarse };
                let (_, finer) = driven(&fine, seed);
                let moved_m = (finer.stop.location_m - facts.stop.location_m).abs();
                let moved_s = (finer.stop.time_s - facts.stop.time_s).abs();
                assert!(moved_m < 0.1 && moved_s < 2.0, "{context}: {moved_m} m, {moved_s} s");
            }
        }
    }
}

#[test]
#[ignore = "needs a folder of real lines: RUNDOWN_TRACKS=FOLDER"]
fn every_real_line_can_be_driven_both_ways() {
    let folder = std::env::var("RUNDOWN_TRACKS").expect("a folder of real lines in RUNDOWN_TRACKS");
    let mut lines = 0;
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "toml") {
            continue;
        }
        lines += 1;
        for kind in ["intercity", "short_hops"] {
            let text = format!(
                "runs = 6\ndirections = \"both\"\n[line]\nfile = '{}'\n[driver]\nkind = \"{kind}\"\n",
                path.display()
            );
            let simulation = Simulation::parse(Path::new("lines.toml"), &text).unwrap();
            for plan in plan(&simulation.scenario, 6, 1) {
                let run = simulate_planned(&simulation.scenario, &plan).unwrap();
                let up = plan.heading == Heading::Up;
                let end_m = if up { simulation.track.length_m } else { 0.0 };
                let off_m = run.facts.stop.location_m - end_m;
                assert!(off_m.abs() < 2.0, "{} {kind}: {off_m} m", path.display());
            }
        }
    }
    assert_eq!(lines, 5);
}

/// A data set on disk is what a workflow reads: same runs, both directions, all columns; and the estimator finds the
/// true train in it.
#[test]
fn a_data_set_is_read_back_and_replayed() {
    let text = "runs = 12\nseed = 3\ndirections = \"both\"\n[train]\ntrue_davis_over_described = [1.1, 1.1, 1.1]\n\
        [effort]\ncolumn = true\n[temperature]\ncolumn = true\n[sensors]\ngap_share = 0.01\n";
    let simulation = Simulation::parse(Path::new("s.toml"), text).unwrap();
    let out = tempfile::tempdir().unwrap();
    let facts = folder::write(&simulation, out.path(), false, || ()).unwrap();
    assert!(folder::write(&simulation, out.path(), false, || ()).is_err());

    let set = RunSet::find(&[out.path().join("runs")]).unwrap();
    assert_eq!(set.files.len(), 12);
    assert!(set.notes.is_empty(), "{:?}", set.notes);
    let (_, train) = TrainFile::read(&out.path().join("train.toml")).unwrap();
    let (_, track) = TrackFile::read(&out.path().join("track.toml")).unwrap();
    let mut recordings = Vec::new();
    for (index, file) in set.files.iter().enumerate() {
        let log = RunLog::read(&file.path, BadRows::Refuse).unwrap();
        assert!(log.other_columns.is_empty() && log.warnings.is_empty());
        assert!(log.samples.iter().all(|s| s.effort_n_per_kg.is_some()));
        assert!(log.samples.iter().all(|s| s.temperature_c.is_some()));
        let up = facts[index].plan.heading == Heading::Up;
        assert_eq!(file.direction == Some(rundown::model::direction::Direction::Up), up);
        recordings.push(Recording::new(file, &log, None, DirectionChoice::Auto).unwrap());
    }
    for mode in [Mode::Gated, Mode::Measured] {
        let estimator = Estimator::try_new(Config::with_mode(mode), train, track.clone()).unwrap();
        let runs = replay_carried_by(&|_| &estimator, &recordings, Tick::EverySample, || ());
        let learned = &runs[11].vehicle_after.mean;
        let at = |r: [f64; 3], v: f64| r[0] + v * (r[1] + v * r[2]);
        for kmh in [60.0, 100.0, 140.0] {
            let found = at([learned[0], learned[1], learned[2]], kmh / 3.6) / at(DAVIS, kmh / 3.6);
            assert!((found - 1.1).abs() < 0.03, "{mode:?} at {kmh} km/h: {found}");
        }
    }
    let rows = csv::Reader::from_path(out.path().join("truth/run001.csv")).unwrap().into_records().count();
    assert_eq!(rows, recordings[0].rows.len());
}

/// Fig. 9 of the paper: below the described power in the section of the departure, above it beyond, in every run.
#[test]
fn the_scenario_of_two_clouds_has_them() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/scenarios/two_clouds.toml");
    let simulation = Simulation::read(&path).unwrap();
    for plan in plan(&simulation.scenario, 67, 1) {
        let (trace, facts, _) = drive_planned(&simulation.scenario, &plan).unwrap();
        let mass_kg = facts.train.rotating_mass_kg();
        let most = |near: bool| {
            let there = |p: &&[TruthSample]| (p[0].location_m < 4_000.0) == near && p[1].regime == Regime::Traction;
            let powers = trace.windows(2).filter(there);
            powers.map(|p| p[1].effort_n_per_kg * p[0].speed_mps * mass_kg / MAX_POWER_W).fold(0.0, f64::max)
        };
        let (near, beyond) = (most(true), most(false));
        assert!(near < 0.98 && beyond > 1.0, "run {}: {near} {beyond}", plan.number);
    }
}
