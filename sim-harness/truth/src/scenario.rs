//! From a scenario and a seed to a run: the only place that knows the order.
//!
//! The seed feeds separate streams for the world (load, wind, stops), the driver, the driver's wander, and the sensors.
//! So another recorder sees the same run, and another driver meets the same wind.

pub use crate::conditions::{Scenario, UnscheduledStop};
use crate::driver::{Driver, Stop};
use crate::facts::{Facts, FactsRecorder};
use crate::habits::{DriverKind, Habits};
use crate::motion::Motion;
use crate::plan::{RunPlan, plan};
use crate::regime::Regime;
use crate::seeds::stream;
use crate::sensors::{Sample, Sensors, TruthSample};
use crate::timetable::Heading;
use crate::world::{History, World};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use thiserror::Error;

/// A run that takes longer has failed, s.
const LONGEST_RUN_S: f64 = 4.0 * 3600.0;
/// Standstill at a platform, s.
const DWELL_S: std::ops::Range<f64> = 30.0..60.0;

/// Why a run could not be driven.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum DriveError {
    /// The train has not arrived after 4 h.
    #[error(
        "run {run} (seed {seed}): expected the train at its platform within 4 h, found it at {location_m:.0} m with {speed_kmh:.0} km/h; is the line too steep or the resistance too large?"
    )]
    Late {
        /// Number of the run.
        run: usize,
        /// Its seed.
        seed: u64,
        /// Where it is.
        location_m: f64,
        /// How fast.
        speed_kmh: f64,
    },
    /// The train came to a stand without its brake.
    #[error("run {run} (seed {seed}): expected a brake before the stop, found none")]
    NeverBraked {
        /// Number of the run.
        run: usize,
        /// Its seed.
        seed: u64,
    },
}

/// A simulated run. `samples` and `truth` are the same times, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// What the estimator may see.
    pub samples: Vec<Sample>,
    /// What was true.
    pub truth: Vec<TruthSample>,
    /// The run as a whole.
    pub facts: Facts,
}

/// Drives one run and records it.
///
/// # Panics
/// If the scenario cannot be driven: a step that does not divide 1 s or the sampling time, or a train that does not
/// arrive within 4 h.
pub fn simulate(scenario: &Scenario, seed: u64) -> Run {
    simulate_planned(scenario, &RunPlan::alone(scenario, seed)).unwrap_or_else(|e| panic!("{e}"))
}

/// Drives one run of a plan and records it.
///
/// # Errors
/// [`DriveError`] if the train does not arrive.
///
/// # Panics
/// If the step does not divide 1 s or the sampling time.
pub fn simulate_planned(scenario: &Scenario, plan: &RunPlan) -> Result<Run, DriveError> {
    let (trace, facts, world) = drive_planned(scenario, plan)?;
    Ok(recorded(scenario, plan, &scenario.sensors, &trace, facts, &world))
}

/// Drives one run of a plan once and records it with each of these recorders. They sample as often as the scenario's.
///
/// # Errors
/// [`DriveError`] if the train does not arrive.
///
/// # Panics
/// As [`simulate_planned`].
pub fn simulate_recorders(scenario: &Scenario, plan: &RunPlan, recorders: &[Sensors]) -> Result<Vec<Run>, DriveError> {
    let (trace, facts, world) = drive_planned(scenario, plan)?;
    let by = |sensors: &Sensors| recorded(scenario, plan, sensors, &trace, facts.clone(), &world);
    Ok(recorders.iter().map(by).collect())
}

/// What a recorder makes of a trace.
fn recorded(
    scenario: &Scenario,
    plan: &RunPlan,
    sensors: &Sensors,
    trace: &[TruthSample],
    facts: Facts,
    world: &World,
) -> Run {
    let gain_unit = Normal::new(0.0, 1.0).expect("constant").sample(&mut stream(plan.seed, 8));
    let sensors = Sensors {
        speed_gain: sensors.speed_gain * world.speed_scale,
        location_lag_s: sensors.location_lag_s + world.location_lag_s,
        effort_gain: sensors.effort_gain * (1.0 + sensors.effort_gain_sd * gain_unit),
        ..sensors.clone()
    };
    let [mut readings, mut effort, mut run] = [3, 6, 11].map(|number| stream(plan.seed, number));
    let (samples, truth) = sensors.read(trace, scenario.step_s, &mut readings, &mut effort, &mut run);
    Run { samples, truth, facts }
}

/// Many runs of the same train; run `i` has the seed [`run_seed`](crate::seeds::run_seed)`(seed, i)`. `davis_scale`
/// takes the place of the scenario's.
///
/// # Panics
/// As [`simulate`].
pub fn fleet(scenario: &Scenario, davis_scale: [f64; 3], runs: usize, seed: u64) -> Vec<Run> {
    let scenario = Scenario { davis_scale, ..scenario.clone() };
    plan(&scenario, runs, seed)
        .iter()
        .map(|plan| simulate_planned(&scenario, plan).unwrap_or_else(|e| panic!("{e}")))
        .collect()
}

/// Drives one run: every integration step, before any sensor.
///
/// # Panics
/// As [`simulate`].
pub fn drive(scenario: &Scenario, seed: u64) -> (Vec<TruthSample>, Facts) {
    let (trace, facts, _) = drive_planned(scenario, &RunPlan::alone(scenario, seed)).unwrap_or_else(|e| panic!("{e}"));
    (trace, facts)
}

/// Drives one run of a plan: every integration step, the facts, and the world it was driven in. Locations of trace and
/// facts are those of the line, they fall in a run down; those of the world are along the distance travelled.
///
/// # Errors
/// [`DriveError`] if the train does not arrive.
///
/// # Panics
/// If the step does not divide 1 s.
pub fn drive_planned(scenario: &Scenario, plan: &RunPlan) -> Result<(Vec<TruthSample>, Facts, World), DriveError> {
    let step_s = scenario.step_s;
    let each_second = (1.0 / step_s).round();
    assert!((each_second * step_s - 1.0).abs() < 1e-9, "the step {step_s} s must divide 1 s");
    let seed = plan.seed;
    let mut draws = stream(seed, 0);
    let unit = Normal::new(0.0, 1.0).expect("constant");
    let load = f64::max(1.0 + scenario.load_sd * unit.sample(&mut draws), 0.5);
    // Adding zero turns -0 into 0.
    let headwind_mps = scenario.wind_sd_mps * unit.sample(&mut draws) + 0.0;
    let world = World::new(scenario, plan, load, headwind_mps);
    let stops = stops(scenario, &world, seed, &mut draws);
    let stay_s = if scenario.final_dwell { stops.last().map_or(0.0, |s| s.dwell_s) } else { 0.0 };
    let stop_count = stops.len();
    let drawn = |seed| Habits::draw(scenario.driver, scenario.cycle_share, world.line.top_mps(), &mut stream(seed, 1));
    let mut habits = plan.driver.map_or_else(|| drawn(seed), |turn| drawn(turn.seed).on_day(&drawn(seed)));
    habits.brake = habits.brake.at_most(world.safe_deceleration_mps2());
    habits.brake_test_mps = brake_test_mps(scenario.brake_test_share, &mut stream(seed, 10));
    let mut driver = Driver::new(habits, &world, stops, stream(seed, 2));

    let mut recorder = FactsRecorder::default();
    let mut motion = Motion::default();
    let mut history = History::default();
    let mut from = row(&world, plan, history, motion, [0.0; 2], Regime::Standstill);
    let mut trace = vec![from];
    let mut rest_s = stay_s + scenario.sensors.sampling_s;
    for i in 0_u64.. {
        history.time_s = i as f64 / each_second;
        if history.time_s >= LONGEST_RUN_S {
            return Err(DriveError::Late {
                run: plan.number,
                seed,
                location_m: from.location_m,
                speed_kmh: 3.6 * motion.speed_mps,
            });
        }
        if driver.stops_made() == stop_count {
            rest_s -= step_s;
            if rest_s < 0.0 {
                break;
            }
        }
        let seen = Motion { speed_mps: motion.speed_mps * world.speed_scale, ..motion };
        let (demanded, doing) = driver.act(history, seen, step_s);
        let mut applied = 0.0;
        // A standing train is held by its brake, also on a slope.
        if doing != Regime::Standstill {
            history.departed_s.get_or_insert(history.time_s);
            history.braked |= demanded < 0.0;
            applied = world.applied_n_per_kg(demanded, motion);
            motion = world.advance(history, motion, applied, step_s);
        }
        history.time_s = (i + 1) as f64 / each_second;
        history.stand(from.speed_mps, motion.speed_mps);
        // A train that has just stopped, or has not yet moved, stands.
        let regime = if motion.speed_mps == 0.0 { Regime::Standstill } else { doing };
        let to = row(&world, plan, history, motion, [demanded, applied], regime);
        recorder.observe(&from, &to, driver.on_plateau());
        trace.push(to);
        from = to;
    }
    let facts = recorder
        .finish(plan.clone(), &world, load, habits)
        .ok_or(DriveError::NeverBraked { run: plan.number, seed })?;
    Ok((trace, facts, world))
}

/// The speed at which the driver tries the brake, if this one does.
fn brake_test_mps(share: f64, rng: &mut ChaCha8Rng) -> Option<f64> {
    let speed_mps = rng.random_range(70.0..110.0) / 3.6;
    rng.random_bool(share).then_some(speed_mps)
}

/// A row of the trace: the end of a step with this demanded and applied effort.
fn row(
    world: &World,
    plan: &RunPlan,
    history: History,
    motion: Motion,
    [demanded, applied]: [f64; 2],
    regime: Regime,
) -> TruthSample {
    let extra_n_per_kg = world.extra_n_per_kg(history, motion);
    TruthSample {
        time_s: history.time_s,
        location_m: match plan.heading {
            Heading::Up => motion.location_m,
            Heading::Down => world.line.length_m() - motion.location_m,
        },
        speed_mps: motion.speed_mps,
        effort_n_per_kg: applied,
        mean_effort_n_per_kg: applied,
        reported_n_per_kg: world.reported_n_per_kg([demanded, applied], motion),
        regime,
        resistance_n_per_kg: world.resistance_n_per_kg(history, motion),
        extra_n_per_kg,
        gravity_n_per_kg: world.gravity_n_per_kg(motion),
        temperature_c: world.weather.temperature_c(history.time_s),
    }
}

/// The stops of a run along its way: those of the line, or every 4 to 6 km for short hops on a line without; the red
/// signal; the platform at the end.
fn stops(scenario: &Scenario, world: &World, seed: u64, rng: &mut ChaCha8Rng) -> Vec<Stop> {
    let end_m = world.line.length_m();
    let mut stops = Vec::new();
    for at_m in world.line.calls_m() {
        stops.push(Stop { at_m: *at_m, dwell_s: rng.random_range(DWELL_S), planned: true });
    }
    if scenario.driver == DriverKind::ShortHop && stops.is_empty() {
        let mut at_m = rng.random_range(4_000.0..6_000.0);
        while at_m < end_m - 3_000.0 {
            stops.push(Stop { at_m, dwell_s: rng.random_range(DWELL_S), planned: true });
            at_m += rng.random_range(4_000.0..6_000.0);
        }
    }
    // A stream of its own, so that the other draws of the run stay.
    let met = |red: &UnscheduledStop| stream(seed, 9).random_bool(red.share);
    if let Some(red) = scenario.unscheduled_stop.filter(met) {
        stops.push(Stop { at_m: red.at_m, dwell_s: red.dwell_s, planned: false });
        stops.sort_by(|a, b| a.at_m.total_cmp(&b.at_m));
    }
    stops.push(Stop { at_m: end_m, dwell_s: rng.random_range(DWELL_S), planned: true });
    stops
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::StartingResistance;
    use crate::line::Line;
    use crate::seeds::run_seed;
    use crate::sensors::SpeedReading;
    use crate::train::{DavisTruth, GRAVITY_MPS2, TrainTruth};
    use rayon::prelude::*;

    fn scenarios() -> [(&'static str, Scenario); 4] {
        let red = UnscheduledStop { at_m: 14_000.0, dwell_s: 45.0, share: 1.0 };
        [
            ("case study", Scenario::default()),
            ("hilly", Scenario { line: Line::hilly(5), wind_sd_mps: 4.0, load_sd: 0.05, ..Scenario::default() }),
            ("short hops", Scenario { driver: DriverKind::ShortHop, final_dwell: true, ..Scenario::default() }),
            ("red signal", Scenario { unscheduled_stop: Some(red), ..Scenario::default() }),
        ]
    }

    #[test]
    fn the_same_seed_is_the_same_run_and_another_is_not() {
        for (name, scenario) in scenarios() {
            let run = simulate(&scenario, 7);
            assert!(run == simulate(&scenario, 7), "{name}");
            assert!(run.samples != simulate(&scenario, 8).samples, "{name}");
        }
    }

    #[test]
    fn another_recorder_sees_the_same_run() {
        let exact = Sensors { speed: SpeedReading::Exact, location_noise_m: 9.0, ..Sensors::default() };
        let a = simulate(&Scenario::default(), 11);
        let b = simulate(&Scenario { sensors: exact, ..Scenario::default() }, 11);
        assert_eq!(a.truth, b.truth);
    }

    #[test]
    fn a_run_that_is_recorded_twice_is_the_run_recorded_once_by_each() {
        let scenario = Scenario { wind_sd_mps: 2.0, ..Scenario::default() };
        let late = Sensors { speed_lag_s: [8.0; 2], speed: SpeedReading::Truncated, ..Sensors::default() };
        let early = Sensors { location_lag_s: 8.0, ..Sensors::default() };
        let planned = RunPlan::alone(&scenario, 11);
        let both = simulate_recorders(&scenario, &planned, &[late.clone(), early.clone()]).unwrap();
        for (run, sensors) in both.iter().zip([late, early]) {
            let alone = simulate_planned(&Scenario { sensors, ..scenario.clone() }, &planned).unwrap();
            assert_eq!((&run.samples, &run.truth), (&alone.samples, &alone.truth));
        }
        assert!(both[0].samples != both[1].samples);
    }

    #[test]
    fn every_run_stops_within_two_metres_of_the_platform() {
        for (name, scenario) in scenarios() {
            for seed in 0..40 {
                let (_, facts) = drive(&scenario, seed);
                let off_m = facts.stop.location_m - scenario.line.length_m();
                assert!(off_m.abs() < 2.0, "{name}, seed {seed}: {off_m} m");
            }
        }
    }

    #[test]
    fn nobody_drives_faster_than_four_km_h_above_the_limit() {
        for (name, scenario) in scenarios() {
            for seed in 0..40 {
                let (trace, facts) = drive(&scenario, seed);
                for step in trace {
                    let permitted = scenario.line.permitted_mps(step.location_m, facts.train.length_m);
                    let over_kmh = 3.6 * (step.speed_mps - permitted);
                    assert!(over_kmh < 4.0, "{name}, seed {seed}: {over_kmh} km/h at {} m", step.location_m);
                }
            }
        }
    }

    #[test]
    fn halving_the_step_moves_the_stop_by_less_than_half_a_metre() {
        for (name, scenario) in scenarios() {
            for seed in 0..20 {
                let (_, coarse) = drive(&Scenario { step_s: 0.1, ..scenario.clone() }, seed);
                let (_, fine) = drive(&Scenario { step_s: 0.05, ..scenario.clone() }, seed);
                let moved_m = coarse.stop.location_m - fine.stop.location_m;
                assert!(moved_m.abs() < 0.5, "{name}, seed {seed}: {moved_m} m");
                assert!((coarse.stop.time_s - fine.stop.time_s).abs() < 2.0, "{name}, seed {seed}");
            }
        }
    }

    #[test]
    fn work_equals_kinetic_and_potential_energy_and_losses() {
        for (name, scenario) in scenarios() {
            let (trace, facts) = drive(&scenario, 3);
            let train = facts.train;
            // Mean height of the train in 1620 slices, not through the gradients.
            let height = |front_m: f64| {
                let slice = |i: i32| scenario.line.height_m(front_m - (f64::from(i) + 0.5) * train.length_m / 1620.0);
                (0..1620).map(slice).sum::<f64>() / 1620.0
            };
            // With speed, and at the end without.
            let braking = trace.partition_point(|step| step.time_s <= facts.final_brake.time_s);
            for end in [braking, trace.len() - 1] {
                let (mut work, mut traction, mut losses) = (0.0, 0.0, 0.0);
                for pair in trace[..=end].windows(2) {
                    let distance_m = pair[1].location_m - pair[0].location_m;
                    work += pair[1].effort_n_per_kg * distance_m;
                    traction += pair[1].effort_n_per_kg.max(0.0) * distance_m;
                    losses += (pair[0].resistance_n_per_kg + pair[1].resistance_n_per_kg) / 2.0 * distance_m;
                }
                let kinetic = trace[end].speed_mps * trace[end].speed_mps / 2.0;
                let potential = GRAVITY_MPS2 / train.gamma * (height(trace[end].location_m) - height(0.0));
                let gap = work - kinetic - potential - losses;
                assert!(gap.abs() < 1e-3 * traction, "{name}: {gap} of {traction} J/kg at step {end}");
            }
        }
    }

    #[test]
    fn every_regime_occurs_and_a_coast_has_no_effort() {
        let runs = scenarios().into_iter().flat_map(|(_, scenario)| (0..10).map(move |seed| drive(&scenario, seed).0));
        let trace: Vec<TruthSample> = runs.flatten().collect();
        for regime in [Regime::Standstill, Regime::Traction, Regime::Cruise, Regime::Coast, Regime::Brake] {
            let count = trace.iter().filter(|s| s.regime == regime).count();
            assert!(count > 1_000, "{regime:?}: {count} steps");
        }
        for step in &trace {
            match step.regime {
                Regime::Coast => assert_eq!(step.effort_n_per_kg, 0.0),
                Regime::Traction => assert!(step.effort_n_per_kg >= 0.0),
                Regime::Brake => assert!(step.effort_n_per_kg <= 0.0),
                Regime::Standstill | Regime::Cruise => {}
            }
            assert_eq!(step.regime == Regime::Standstill, step.speed_mps == 0.0);
        }
    }

    #[test]
    fn a_final_coast_on_the_level_follows_the_closed_form_for_constant_resistance() {
        let davis = DavisTruth { r0: 0.03, r1: 0.0, r2: 0.0 };
        let train = TrainTruth { davis, ..TrainTruth::default() };
        let scenario = Scenario { train, line: Line::level(32_000.0, 140.0), ..Scenario::default() };
        for seed in 0..10 {
            let facts = drive(&scenario, seed).1;
            let (from, to) = (facts.final_coast.unwrap(), facts.final_brake);
            let t = to.time_s - from.time_s;
            assert!((to.speed_mps - (from.speed_mps - 0.03 * t)).abs() < 1e-9, "seed {seed}");
            let distance_m = from.speed_mps * t - 0.015 * t * t;
            assert!((to.location_m - from.location_m - distance_m).abs() < 1e-6, "seed {seed}");
        }
    }

    #[test]
    fn the_case_study_looks_like_the_paper() {
        let runs: Vec<Run> = (0..670).into_par_iter().map(|i| simulate(&Scenario::default(), run_seed(1, i))).collect();
        let facts: Vec<&Facts> = runs.iter().map(|run| &run.facts).collect();
        let mean_and_cv = |values: &[f64]| {
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / values.len() as f64;
            (mean, variance.sqrt() / mean)
        };
        let coasts: Vec<f64> = facts.iter().map(|f| f.final_brake.time_s - f.final_coast.unwrap().time_s).collect();
        let (mean, cv) = mean_and_cv(&coasts);
        assert!((330.0..400.0).contains(&mean) && (0.27..0.33).contains(&cv), "coast {mean} s, cv {cv}");
        let within = coasts.iter().filter(|c| (150.0..600.0).contains(*c)).count();
        assert!(within > 640, "{within} of 670 final coasts of 2.5 to 10 min");
        let brakes: Vec<f64> = facts.iter().map(|f| f.stop.time_s - f.final_brake.time_s).collect();
        let (mean, cv) = mean_and_cv(&brakes);
        assert!((80.0..120.0).contains(&mean) && (0.17..0.23).contains(&cv), "brake {mean} s, cv {cv}");
        // Readings of whole km/h, as the paper's.
        let above = runs.iter().filter(|run| run.samples.iter().any(|s| s.speed_kmh > Some(140.0))).count();
        assert!((0.09..0.15).contains(&(above as f64 / 670.0)), "{above} of 670 runs above 140 km/h");
        let cruises: Vec<f64> = facts.iter().map(|f| 3.6 * f.cruise_mps).collect();
        let (mean, _) = mean_and_cv(&cruises);
        let most = cruises.iter().copied().fold(0.0, f64::max);
        assert!((134.0..139.0).contains(&mean) && most <= 141.0, "cruise {mean} km/h, most {most}");
        let named = TrainTruth::default();
        let largest = named.max_power_w / named.rotating_mass_kg();
        for f in facts {
            let share = f.mean_power_50_130_w_per_kg.unwrap() / largest;
            assert!((0.7..=1.01).contains(&share), "power {share}");
            assert!(f.max_power_w_per_kg < 1.01 * largest);
        }
    }

    #[test]
    fn a_red_signal_stops_the_train_there_for_its_dwell() {
        let (_, scenario) = scenarios()[3].clone();
        for seed in 0..20 {
            let (trace, facts) = drive(&scenario, seed);
            assert_eq!(facts.stops.len(), 2, "seed {seed}");
            assert!((facts.stops[0].location_m - 14_000.0).abs() < 2.0, "seed {seed}: {:?}", facts.stops[0]);
            let stood =
                trace.iter().filter(|s| s.speed_mps == 0.0 && s.location_m > 100.0 && s.location_m < 20_000.0).count();
            assert!((stood as f64 * scenario.step_s - 45.0).abs() < 1.5, "seed {seed}: {stood} steps");
        }
    }

    #[test]
    fn a_train_is_hard_to_start_before_the_run_and_a_little_after_a_short_stop() {
        let red = UnscheduledStop { at_m: 14_000.0, dwell_s: 45.0, share: 1.0 };
        let grease = StartingResistance { amplitude: 0.04, decay_kmh: 5.0, standing_min: 10.0, cold_per_deg_c: 0.0 };
        let scenario = Scenario { unscheduled_stop: Some(red), effects: vec![grease.into()], ..Scenario::default() };
        let (trace, _) = drive(&scenario, 3);
        let moving = |pair: &&[TruthSample]| pair[0].speed_mps == 0.0 && pair[1].speed_mps > 0.0;
        let starts: Vec<f64> = trace.windows(2).filter(moving).map(|pair| pair[0].extra_n_per_kg).collect();
        let [first, second] = starts[..] else { panic!("two starts, found {starts:?}") };
        assert_eq!(first, 0.04);
        // 45 s and the time until the effort has overcome it.
        let least = 0.04 * (1.0 - (-45.0_f64 / 600.0).exp());
        assert!(second >= least && second < 1.1 * least, "{second} {least}");
    }

    #[test]
    fn short_hops_stop_often_and_dwell_at_the_end() {
        let (_, scenario) = scenarios()[2].clone();
        for seed in 0..20 {
            let (trace, facts) = drive(&scenario, seed);
            assert!((5..=8).contains(&facts.stops.len()), "seed {seed}: {}", facts.stops.len());
            let fastest_kmh = trace.iter().map(|s| 3.6 * s.speed_mps).fold(0.0, f64::max);
            assert!((79.0..104.0).contains(&fastest_kmh), "seed {seed}: {fastest_kmh} km/h");
            let rest_s = trace.last().unwrap().time_s - facts.stop.time_s;
            assert!((30.0..=71.0).contains(&rest_s), "seed {seed}: {rest_s} s");
        }
    }

    #[test]
    fn wind_and_load_reach_the_facts() {
        let (_, scenario) = scenarios()[1].clone();
        let run = simulate(&scenario, 2);
        assert!(run.facts.headwind_mps != 0.0 && run.facts.train.mass_kg != scenario.train.mass_kg);
        for at in &run.truth {
            let expected = run.facts.davis.resistance_n_per_kg(at.speed_mps);
            let upwind = at.speed_mps + run.facts.headwind_mps >= 0.0;
            assert!(!upwind || (at.resistance_n_per_kg - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn a_fleet_is_its_runs() {
        let scenario = Scenario::default();
        let runs = fleet(&scenario, [1.1, 1.0, 0.9], 2, 5);
        let scenario = Scenario { davis_scale: [1.1, 1.0, 0.9], ..scenario };
        assert!(runs[1] == simulate_planned(&scenario, &plan(&scenario, 2, 5)[1]).unwrap());
        // Only the date is another.
        let alone = simulate(&scenario, run_seed(5, 1));
        assert_eq!(runs[1].facts.stop, alone.facts.stop);
    }

    #[test]
    fn a_notched_lever_gives_the_power_of_a_notch() {
        let scenario = Scenario { notches: 4, cycle_share: 0.0, ..Scenario::default() };
        let (trace, facts) = drive(&scenario, 6);
        let power_w = |row: &TruthSample| row.effort_n_per_kg * row.speed_mps * facts.train.rotating_mass_kg();
        // Above the range of constant effort, while the effort does not move from one notch to the next.
        let steady = trace.windows(2).filter(|pair| {
            let [a, b] = [power_w(&pair[0]), power_w(&pair[1])];
            pair[0].speed_mps > 15.0 && pair[1].regime == Regime::Traction && (b / a - 1.0).abs() < 1e-4
        });
        let shares: Vec<f64> = steady.map(|pair| power_w(&pair[1]) / scenario.train.max_power_w).collect();
        assert!(shares.len() > 500, "{}", shares.len());
        assert!(shares.iter().all(|share| (4.0 * share - (4.0 * share).round()).abs() < 0.01));
        assert!(shares.iter().any(|share| *share > 0.7));
    }

    #[test]
    fn half_of_the_coasts_keep_a_little_brake_on() {
        let scenario = Scenario { coast_brake_n_per_kg: 0.02, cycle_share: 1.0, ..Scenario::default() };
        let is_light = |row: &&TruthSample| row.regime == Regime::Brake && (row.effort_n_per_kg + 0.02).abs() < 1e-9;
        let count = |scenario: &Scenario| {
            let rows: Vec<TruthSample> = (6..12).flat_map(|seed| drive(scenario, seed).0).collect();
            (rows.iter().filter(|row| row.regime == Regime::Coast).count(), rows.iter().filter(is_light).count())
        };
        let (free, light) = count(&scenario);
        let share = light as f64 / (light + free) as f64;
        assert!((0.3..0.7).contains(&share), "{light} {free}");
        assert_eq!(count(&Scenario { coast_brake_n_per_kg: 0.0, ..scenario }).1, 0);
    }

    #[test]
    fn automatic_operation_is_alike_every_day_and_uses_all_power() {
        let scenario = Scenario { driver: DriverKind::Automatic, ..Scenario::default() };
        let facts: Vec<Facts> = fleet(&scenario, [1.0; 3], 4, 8).into_iter().map(|run| run.facts).collect();
        for one in &facts {
            let power = one.max_power_w_per_kg * one.train.rotating_mass_kg() / scenario.train.max_power_w;
            assert!((power - 1.0).abs() < 0.01, "{power}");
            let [coast_s, first_s] = [one, &facts[0]].map(|f| f.final_brake.time_s - f.final_coast.unwrap().time_s);
            assert!((coast_s - first_s).abs() < 2.0, "{coast_s} {first_s}");
        }
    }

    #[test]
    fn drivers_differ_by_more_than_their_days() {
        let scenario = Scenario { drivers: 4, ..Scenario::default() };
        let plans = plan(&scenario, 60, 3);
        let habits: Vec<(usize, f64)> = plans
            .par_iter()
            .map(|plan| (plan.driver.unwrap().number, drive_planned(&scenario, plan).unwrap().1.habits.power_share))
            .collect();
        let of = |number: usize| -> Vec<f64> { habits.iter().filter(|h| h.0 == number).map(|h| h.1).collect() };
        let sd = |values: &[f64]| {
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
        };
        let means: Vec<f64> = (1..=4).map(|n| of(n).iter().sum::<f64>() / of(n).len() as f64).collect();
        let within = (1..=4).map(|n| sd(&of(n))).fold(0.0, f64::max);
        assert!(sd(&means) > 1.3 * within, "{means:?} {within}");
    }
}
