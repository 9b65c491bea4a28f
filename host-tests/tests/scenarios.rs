//! Does it behave? Logs with faults cut into them; every scenario is judged against truth or against the same log
//! without the fault.

use host_tests::accuracy::{BAND_KMH, Errors, estimator, measurements, resistance};
use host_tests::prelude::*;
use rundown::estimator::StepError;
use rundown::tick::estimate::{Cause, Validity};
use rundown::tick::regime::Regime;
use rundown_truth::sensors::LocationWalk;
use rundown_truth::train::DavisTruth;

const SEED: u64 = 31;

fn clean() -> (Estimator, Run, Vec<Measurement>) {
    let scenario = Scenario::default();
    let run = simulate(&scenario, SEED);
    let log = measurements(&run);
    (estimator(Config::default(), &scenario), run, log)
}

fn replay(estimator: &Estimator, log: &[Measurement]) -> (Vec<Estimate>, RunSummary) {
    let mut vehicle = estimator.new_vehicle();
    let mut run = estimator.begin_run(&vehicle, Direction::Up);
    let estimates: Vec<Estimate> =
        log.iter().filter_map(|measurement| estimator.step(&mut run, measurement).ok()).collect();
    for estimate in &estimates {
        assert!(estimate.belief.is_finite(), "at {} s", estimate.time_s);
        assert!(estimate.belief.mean[SPEED] >= 0.0, "at {} s", estimate.time_s);
    }
    let summary = estimator.end_run(&mut run, &mut vehicle);
    (estimates, summary)
}

/// A run of a scenario, and what a new vehicle makes of it.
fn replayed(scenario: &Scenario, seed: u64) -> (Run, Vec<Estimate>, RunSummary) {
    let run = simulate(scenario, seed);
    let (estimates, summary) = replay(&estimator(Config::default(), scenario), &measurements(&run));
    (run, estimates, summary)
}

/// How far the resistance of a run at this speed is from the truth, in its standard deviations.
fn error_sd(found: &RunSummary, run: &Run, kmh: f64) -> f64 {
    let (r, sd) = resistance(&found.run_davis, kmh);
    (r - run.facts.davis.resistance_n_per_kg(kmh / 3.6)) / sd
}

/// The same, from another estimate.
fn moved_sd(found: &RunSummary, from: &RunSummary, kmh: f64) -> f64 {
    let (r, sd) = resistance(&found.run_davis, kmh);
    (r - resistance(&from.run_davis, kmh).0) / sd
}

/// Index of the first sample at or after a share of the final coast.
fn in_final_coast(run: &Run, share: f64) -> usize {
    let coast_s = run.facts.final_coast.unwrap().time_s;
    let brake_s = run.facts.final_brake.time_s;
    let at_s = coast_s + share * (brake_s - coast_s);
    run.samples.iter().position(|sample| sample.time_s >= at_s).unwrap()
}

/// A run whose log is spoilt from a share of its final coast on.
struct Spoilt {
    /// Index of the first sample that may be spoilt.
    k: usize,
    run: Run,
    estimates: Vec<Estimate>,
    summary: RunSummary,
}

/// `spoil` gets the samples from there on, and the last one before.
fn spoilt(share: f64, spoil: impl Fn(&mut [Measurement], &Measurement)) -> Spoilt {
    let (estimator, run, mut log) = clean();
    let k = in_final_coast(&run, share);
    let last = log[k - 1];
    spoil(&mut log[k..], &last);
    let (estimates, summary) = replay(&estimator, &log);
    Spoilt { k, run, estimates, summary }
}

impl Spoilt {
    /// Estimated minus true location, m.
    fn error_m(&self, i: usize) -> f64 {
        self.estimates[i].belief.mean[LOCATION] - self.run.truth[i].location_m
    }

    fn validity(&self, after: usize) -> Validity {
        self.estimates[self.k + after].validity
    }

    fn count(&self, cause: Cause) -> u32 {
        self.summary.counters.of(cause)
    }
}

/// r and its covariance are the same to the last bit, and nothing is said to be learned.
fn assert_frozen(estimates: &[Estimate]) {
    for estimate in estimates {
        assert!(!estimate.learning, "at {} s", estimate.time_s);
        assert_eq!(davis_bits(estimate), davis_bits(&estimates[0]), "at {} s", estimate.time_s);
    }
}

fn davis_bits(estimate: &Estimate) -> Vec<u64> {
    let belief = &estimate.belief;
    (2..5)
        .flat_map(|i| (i..5).map(move |j| belief.covariance[(i, j)]).chain([belief.mean[i]]))
        .map(f64::to_bits)
        .collect()
}

#[test]
fn a_location_jump_of_5_km_is_held_for_one_tick_and_hardly_moves_the_resistance() {
    let (estimator, _, log) = clean();
    let (_, without) = replay(&estimator, &log);
    // Given a coasting train, when one location is 5 km off
    let found = spoilt(0.5, |log, _| log[0].location_m = log[0].location_m.map(|m| m + 5000.0));
    // Then it is dropped with its cause, the next tick is valid, and r is the same
    assert_eq!(found.validity(0), Validity::Held(Cause::LocationJump));
    assert_eq!(found.validity(1), Validity::Valid);
    assert!(found.error_m(found.k).abs() < 60.0);
    assert!(moved_sd(&without, &found.summary, 100.0).abs() < 0.1);
}

#[test]
fn a_location_shift_that_stays_is_believed_after_three_fixes() {
    // When all locations from here on are 1 km further
    let found = spoilt(0.3, |log, _| {
        log.iter_mut().for_each(|measurement| measurement.location_m = measurement.location_m.map(|m| m + 1000.0));
    });
    // Then two are dropped, the third is taken up
    assert_eq!(found.validity(0), Validity::Held(Cause::LocationJump));
    assert_eq!(found.validity(3), Validity::Valid);
    assert!((found.error_m(found.k + 3) - 1000.0).abs() < 60.0);
    // And this is counted
    assert_eq!((found.count(Cause::LocationJump), found.count(Cause::Contradiction)), (2, 1));
}

#[test]
fn ten_minutes_without_location_freeze_the_resistance_and_widen_the_location() {
    const LEFT: usize = 6;
    let found = spoilt(0.2, |log, _| {
        let count = 60.min(log.len() - LEFT);
        log[..count].iter_mut().for_each(|measurement| measurement.location_m = None);
    });
    let (k, estimates) = (found.k, &found.estimates);
    let end = (k + 60).min(estimates.len() - LEFT);
    // Held at once, invalid after a minute, valid with the first fixes after
    assert_eq!(found.validity(0), Validity::Held(Cause::NoLocation));
    assert_eq!(found.validity(7), Validity::Invalid(Cause::NoLocation));
    assert!((end..end + 3).any(|i| estimates[i].validity == Validity::Valid));
    // The standard deviation of the location rises until then; r stands still once the longest gap has passed
    let sd = |i: usize| estimates[i].belief.sd(LOCATION);
    assert!((k + 6..end - 1).all(|i| sd(i + 1) >= sd(i)));
    assert!((k + 8..end).all(|i| davis_bits(&estimates[i]) == davis_bits(&estimates[k + 8])));
    let error_m = found.error_m(end - 1);
    assert!(error_m.abs() < 3.0 * sd(end - 1), "{error_m}");
}

#[test]
fn minutes_without_speed_are_bridged_by_the_true_time() {
    let found = spoilt(0.4, |log, _| log[..12].iter_mut().for_each(|measurement| measurement.speed_mps = None));
    assert_eq!(found.validity(0), Validity::Held(Cause::NoSpeed));
    assert_eq!(found.validity(11), Validity::Invalid(Cause::NoSpeed));
    assert_eq!(found.validity(12), Validity::Valid);
    assert!(error_sd(&found.summary, &found.run, 100.0).abs() < 3.0);
}

#[test]
fn repeated_and_backward_times_change_nothing_but_their_counter() {
    let (estimator, _, log) = clean();
    let (expected, _) = replay(&estimator, &log);
    let mut dirty = log.clone();
    dirty.insert(40, log[39]);
    dirty.insert(60, log[20]);
    let mut vehicle = estimator.new_vehicle();
    let mut run = estimator.begin_run(&vehicle, Direction::Up);
    let mut found = Vec::new();
    for measurement in &dirty {
        match estimator.step(&mut run, measurement) {
            Ok(estimate) => found.push(estimate),
            Err(StepError::TimeNotIncreasing { last_s, found_s }) => assert!(found_s <= last_s),
            Err(other) => panic!("{other}"),
        }
    }
    assert_eq!(found, expected);
    assert_eq!(estimator.end_run(&mut run, &mut vehicle).counters.time_not_increasing, 2);
}

#[test]
fn a_stuck_speed_is_found_while_the_train_brakes() {
    let (estimator, run, mut log) = clean();
    // Given a train that brakes, when its speed reading stays what it was
    let k = run.samples.iter().position(|sample| sample.time_s >= run.facts.final_brake.time_s).unwrap();
    let stuck = log[k - 1].speed_mps;
    for measurement in &mut log[k..] {
        measurement.speed_mps = stuck;
    }
    let (estimates, summary) = replay(&estimator, &log);
    // Then it is named within six samples, and nothing is learned from then on
    assert!(summary.counters.of(Cause::StuckSpeed) > 0);
    let named = (k..k + 7).find(|&i| estimates[i].validity == Validity::Invalid(Cause::StuckSpeed));
    let named = named.expect("named within seven samples");
    assert!(estimates[named..].iter().all(|estimate| !estimate.learning));
}

#[test]
fn a_steady_speed_is_not_a_stuck_one() {
    // Given a train that holds 139.7 km/h for ten minutes, read as 140
    let (estimator, ..) = clean();
    let log: Vec<Measurement> = (0..60)
        .map(|k| {
            let time_s = 10.0 * f64::from(k);
            let noise_m = 4.0 * f64::from((k * 7) % 5 - 2);
            Measurement {
                time_s,
                location_m: Some(139.7 / 3.6 * time_s + noise_m),
                speed_mps: Some(140.0 / 3.6),
                effort_n_per_kg: None,
            }
        })
        .collect();
    let (estimates, _) = replay(&estimator, &log);
    assert!(estimates.iter().all(|estimate| estimate.validity == Validity::Valid));
}

#[test]
fn a_stuck_location_is_named_and_the_speed_is_used() {
    let found = spoilt(0.3, |log, last| {
        log[..10].iter_mut().for_each(|measurement| measurement.location_m = last.location_m);
    });
    assert!(found.count(Cause::StuckLocation) >= 8);
    let error_m = found.error_m(found.k + 9);
    assert!(error_m.abs() < 150.0, "{error_m}");
    // Named with the second sample, invalid after a minute, and r stands still once the longest gap of a segment has
    // passed
    assert_eq!(found.validity(1), Validity::Held(Cause::StuckLocation));
    assert_eq!(found.validity(9), Validity::Invalid(Cause::StuckLocation));
    assert_frozen(&found.estimates[found.k + 5..found.k + 10]);
}

#[test]
fn a_reversing_train_is_flagged_and_teaches_nothing() {
    // Given a train that coasts backwards along its direction of travel
    let (estimator, ..) = clean();
    let log: Vec<Measurement> = (0..40)
        .map(|k| {
            let time_s = 10.0 * f64::from(k);
            let speed_mps = 30.0 - 0.03 * time_s;
            Measurement {
                time_s,
                location_m: Some(20_000.0 - 30.0 * time_s + 0.015 * time_s * time_s),
                speed_mps: Some((3.6 * speed_mps).round() / 3.6),
                effort_n_per_kg: None,
            }
        })
        .collect();
    let (estimates, summary) = replay(&estimator, &log);
    assert!(summary.counters.of(Cause::Reversing) > 30);
    assert_eq!(davis_bits(&estimates[0]), davis_bits(&estimates[39]));
    assert_eq!(summary.learned_s, 0.0);
}

#[test]
fn eight_hours_of_standstill_change_nothing() {
    let (estimator, _, mut log) = clean();
    let last = *log.last().unwrap();
    let at = log.len();
    for k in 1..=2880 {
        let mut still = last;
        still.time_s += 10.0 * f64::from(k);
        still.speed_mps = Some(0.0);
        log.push(still);
    }
    let (estimates, _) = replay(&estimator, &log);
    let first = davis_bits(&estimates[at + 1]);
    assert!(estimates[at + 1..].iter().all(|estimate| davis_bits(estimate) == first));
    assert!(estimates[at + 1..].iter().all(|estimate| estimate.regime == Regime::Standstill));
    assert!(estimates.last().unwrap().belief.sd(LOCATION) <= 40.0);
}

/// The final coast of 20 runs with a spike of the speed in its middle: when, the truth, and what is said with it and
/// without.
fn spikes(change_kmh: f64) -> impl Iterator<Item = (usize, Run, Vec<Estimate>, [RunSummary; 2])> {
    let scenario = Scenario::default();
    let estimator = estimator(Config::default(), &scenario);
    (0..20).map(move |seed| {
        let run = simulate(&scenario, seed);
        let mut log = measurements(&run);
        let k = in_final_coast(&run, 0.5);
        let (_, without) = replay(&estimator, &log);
        log[k].speed_mps = log[k].speed_mps.map(|v| v + change_kmh / 3.6);
        let (estimates, with) = replay(&estimator, &log);
        (k, run, estimates, [without, with])
    })
}

#[test]
fn a_slip_of_30_kmh_is_dropped() {
    for (seed, (k, run, estimates, [without, with])) in spikes(30.0).enumerate() {
        assert_eq!(estimates[k].validity, Validity::Held(Cause::SpeedJump), "seed {seed}");
        assert_eq!(estimates[k + 1].validity, Validity::Valid, "seed {seed}");
        let error_mps = estimates[k].belief.mean[SPEED] - run.truth[k].speed_mps;
        assert!(error_mps.abs() < 0.3, "seed {seed}: {error_mps} m/s");
        let moved = moved_sd(&without, &with, 100.0);
        assert!(moved.abs() < 0.1, "seed {seed}: {moved} sd");
    }
}

/// It looks like a brake, so the speed is believed until the train is fast again. What it teaches is nothing.
#[test]
fn a_slide_of_30_kmh_ends_the_segment_and_is_over_with_the_fourth_sample() {
    for (seed, (k, run, estimates, [_, with])) in spikes(-30.0).enumerate() {
        assert!(!estimates[k].learning, "seed {seed}");
        let after = &estimates[k + 3];
        assert_eq!(after.validity, Validity::Valid, "seed {seed}");
        let error_mps = after.belief.mean[SPEED] - run.truth[k + 3].speed_mps;
        assert!(error_mps.abs() < 0.5, "seed {seed}: {error_mps} m/s");
        let error = error_sd(&with, &run, 100.0);
        assert!(error.abs() < 3.5, "seed {seed}: {error} sd");
    }
}

#[test]
fn unreadable_fields_are_dropped_and_the_others_used() {
    let found = spoilt(0.5, |log, _| {
        for (i, wild) in [f64::NAN, f64::INFINITY, -5.0, 1e300, f64::NEG_INFINITY].into_iter().enumerate() {
            log[2 * i].speed_mps = Some(wild);
            log[2 * i + 1].location_m = Some(if wild == -5.0 { 1e9 } else { wild });
        }
    });
    assert_eq!(found.count(Cause::SpeedOutOfRange), 5);
    assert!(found.count(Cause::LocationOutOfRange) >= 4);
    assert_eq!(found.validity(0), Validity::Held(Cause::SpeedOutOfRange));
    assert_eq!(found.validity(12), Validity::Valid);
}

#[test]
fn a_location_off_the_track_is_named_and_freezes_the_resistance() {
    // Given a coasting train, when its locations lie off the track for two minutes and its speed is read as before
    let found = spoilt(0.3, |log, _| {
        log[..12].iter_mut().for_each(|measurement| measurement.location_m = measurement.location_m.map(|m| m + 1e5));
    });
    // Then the cause is said at once, and r stands still once the longest gap of a segment has passed
    assert_eq!(found.count(Cause::LocationOutOfRange), 12);
    assert!((0..6).all(|after| found.validity(after) == Validity::Held(Cause::LocationOutOfRange)));
    assert_eq!(found.validity(11), Validity::Invalid(Cause::LocationOutOfRange));
    assert_frozen(&found.estimates[found.k + 4..found.k + 12]);
    let error_m = found.error_m(found.k + 11);
    assert!(error_m.abs() < 60.0, "{error_m}");
}

#[test]
fn a_pause_of_eleven_minutes_initialises_again_and_keeps_what_was_learned() {
    let found = spoilt(0.7, |log, _| log.iter_mut().for_each(|measurement| measurement.time_s += 660.0));
    assert_eq!(found.count(Cause::LongGap), 1);
    let [before, after] = [&found.estimates[found.k - 1], &found.estimates[found.k]];
    assert_eq!(after.dt_s, 0.0);
    assert_eq!(davis_bits(after), davis_bits(before));
}

#[test]
fn random_loss_of_samples_costs_precision_and_no_truth() {
    for share in [0.1, 0.3, 0.5] {
        let scenario =
            Scenario { sensors: Sensors { dropout_probability: share, ..Sensors::default() }, ..Scenario::default() };
        for seed in 0..10 {
            let (run, _, summary) = replayed(&scenario, seed);
            assert!(error_sd(&summary, &run, 100.0).abs() < 3.5, "loss {share}, seed {seed}");
        }
    }
}

#[test]
fn clean_logs_raise_no_alarm() {
    for (name, sensors) in [
        ("10 s", Sensors::default()),
        ("1 s", Sensors { sampling_s: 1.0, ..Sensors::default() }),
        ("worn wheel", Sensors { speed_gain: 1.013, ..Sensors::default() }),
    ] {
        let scenario = Scenario { sensors, ..Scenario::default() };
        for seed in 0..20 {
            let (_, _, summary) = replayed(&scenario, seed);
            for (cause, count) in summary.counters.iter() {
                assert_eq!(count, 0, "{name}, seed {seed}: {}", cause.as_str());
            }
        }
    }
}

#[test]
fn a_hostile_configuration_is_refused_whole() {
    for spoil in [
        |config: &mut Config| config.learning.gate = f64::NAN,
        |config: &mut Config| config.sensor.location_sd_m = 0.0,
        |config: &mut Config| config.memory.vehicle_shape_sd = -1.0,
        |config: &mut Config| config.recogniser.interval_s = 1e9,
        |config: &mut Config| config.plausibility.long_gap_s = f64::INFINITY,
    ] {
        let mut config = Config::with_mode(Mode::Measured);
        spoil(&mut config);
        assert!(config.check().is_err());
    }
}

#[test]
fn a_train_going_down_a_mirrored_line_learns_the_same() {
    // Given a run up a line, and the same run down the line mirrored
    let scenario = Scenario { line: rundown_truth::line::Line::hilly(7), ..Scenario::default() };
    let run = simulate(&scenario, SEED);
    let up = estimator(Config::default(), &scenario);
    let (_, expected) = replay(&up, &measurements(&run));
    let length_m = scenario.line.length_m();
    let gradients = scenario.line.gradients_permille();
    let ends_m = gradients.iter().skip(1).map(|&(from_m, _)| from_m);
    let ends_m = ends_m.chain([length_m + 1000.0]);
    let mut mirrored: Vec<Gradient> = gradients
        .iter()
        .zip(ends_m)
        .map(|(&(_, permille), end_m)| Gradient { from_m: length_m - end_m, permille: -permille })
        .collect();
    mirrored.reverse();
    mirrored.push(Gradient { from_m: length_m - gradients[0].0, permille: 0.0 });
    let track = Track::try_new(length_m, mirrored).unwrap();
    let down = Estimator::try_new(Config::default(), *up.train(), track).unwrap();
    let mut vehicle = down.new_vehicle();
    let mut state = down.begin_run(&vehicle, Direction::Down);
    for mut measurement in measurements(&run) {
        measurement.location_m = measurement.location_m.map(|m| length_m - m);
        let estimate = down.step(&mut state, &measurement).unwrap();
        assert_eq!(estimate.validity, Validity::Valid);
    }
    let found = down.end_run(&mut state, &mut vehicle);
    // Then both say the same of the train
    assert!(expected.learned_s > 100.0);
    assert_eq!(found.learned_s, expected.learned_s);
    for kmh in [60.0, 100.0, 140.0] {
        let (r, _) = resistance(&expected.run_davis, kmh);
        assert!((resistance(&found.run_davis, kmh).0 / r - 1.0).abs() < 1e-9);
    }
}

#[test]
fn a_location_that_wanders_over_a_minute_does_not_bend_the_resistance() {
    // Given a receiver whose error of 10 m s.d. keeps its sign for about 60 s, as multipath and satellite geometry do
    let wandering = Scenario {
        sensors: Sensors { location_walk: Some(LocationWalk::of(10.0)), ..Sensors::default() },
        ..Scenario::default()
    };
    for seed in 0..10 {
        let (run, estimates, found) = replayed(&wandering, seed);
        // The same run with the white part of the noise only
        let (_, _, white) = replayed(&Scenario::default(), seed);
        // Then no reading is doubted, and r is that of the white log and of the truth
        assert!(estimates.iter().all(|e| e.validity == Validity::Valid), "seed {seed}");
        for kmh in [60.0, 100.0, 140.0] {
            let (moved, error) = (moved_sd(&found, &white, kmh), error_sd(&found, &run, kmh));
            let truth = run.facts.davis.resistance_n_per_kg(kmh / 3.6);
            let percent = 100.0 * (resistance(&found.run_davis, kmh).0 / truth - 1.0);
            println!("wander {seed} {kmh}: moved {moved:.3} sd, error {error:.3} sd, {percent:.2} %");
            assert!(moved.abs() < 0.5, "seed {seed}, {kmh} km/h: {moved} sd");
            assert!(error.abs() < 3.0, "seed {seed}, {kmh} km/h: {error} sd");
        }
    }
}

/// Share of the time that went to another regime than the true one, as far as the sums show it. Both enumerations have
/// one order.
fn misjudged_share(run: &Run, summary: &RunSummary) -> f64 {
    let times_s = summary.features.regime_time_s;
    let total_s: f64 = times_s.iter().sum();
    let moved = Regime::ALL.into_iter().map(|found| {
        let truly = run.truth.iter().filter(|at| at.regime as usize == found as usize).count();
        (times_s[found as usize] / total_s - truly as f64 / run.truth.len() as f64).abs()
    });
    0.5 * moved.sum::<f64>()
}

#[test]
fn samples_5_to_15_s_apart_say_the_same_as_regular_ones() {
    // Given one recorder, read every 10 s, and the same one read whenever the bus delivers: 5 to 15 s apart
    let each_second = Scenario {
        sensors: Sensors { sampling_s: 1.0, ..Sensors::default() },
        final_dwell: true,
        ..Scenario::default()
    };
    let estimator = estimator(Config::default(), &each_second);
    let (mut regular_errors, mut jittered_errors) = (Errors::default(), Errors::default());
    let (mut regular_misjudged, mut jittered_misjudged) = (0.0, 0.0);
    let mut brake_errors_s = Vec::new();
    for seed in 0..20 {
        let run = simulate(&each_second, seed);
        let log = measurements(&run);
        let regular: Vec<Measurement> = log.iter().copied().step_by(10).collect();
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let mut jittered = Vec::new();
        let mut next = 0;
        while let Some(&measurement) = log.get(next) {
            jittered.push(measurement);
            next += rng.random_range(5..=15);
        }
        let gaps = || jittered.windows(2).map(|pair| pair[1].time_s - pair[0].time_s);
        assert!(gaps().any(|gap_s| gap_s < 6.0) && gaps().any(|gap_s| gap_s > 14.0));
        let (_, expected) = replay(&estimator, &regular);
        let (estimates, found) = replay(&estimator, &jittered);
        // Then every sample is believed, and train and driver are the same. Other samples have other rounding errors:
        // hence the tolerances.
        assert!(estimates.iter().all(|e| e.validity == Validity::Valid), "seed {seed}");
        let DavisTruth { r0, r1, r2 } = run.facts.davis;
        regular_errors.add(BAND_KMH, &expected.run_davis, &Davis { r0, r1, r2 });
        jittered_errors.add(BAND_KMH, &found.run_davis, &Davis { r0, r1, r2 });
        for kmh in [60.0, 100.0, 140.0] {
            let moved = moved_sd(&found, &expected, kmh);
            // Two sets of rounding errors, each of one sd: 3 sd is 2 of their difference, over 20 runs.
            assert!(moved.abs() < 3.0, "seed {seed}, {kmh} km/h: {moved} sd");
        }
        regular_misjudged += misjudged_share(&run, &expected);
        jittered_misjudged += misjudged_share(&run, &found);
        let brake = found.features.final_brake;
        let error_s = brake.map(|brake| brake.start_time_s - run.facts.final_brake.time_s);
        brake_errors_s.push(error_s.map_or(f64::INFINITY, f64::abs));
    }
    brake_errors_s.sort_by(f64::total_cmp);
    let [ninety, all] = [brake_errors_s[17], brake_errors_s[19]];
    println!("start of the final brake: 90 % within {ninety:.1} s, all within {all:.1} s");
    assert!(ninety < 5.0 && all < 15.0, "{brake_errors_s:?} s");
    let [regular, jittered] = [&regular_errors, &jittered_errors].map(Errors::rmse_percent);
    println!("rms error of r(v): regular {regular:.2} %, jittered {jittered:.2} %");
    let [regular_share, jittered_share] = [regular_misjudged, jittered_misjudged].map(|sum| sum / 20.0);
    println!("time in the wrong regime: regular {regular_share:.4}, jittered {jittered_share:.4}");
    // The recogniser's evidence is whole ticks of together 10 s at least: here 10 to 20 s, so a change of regime is
    // placed less well.
    assert!(jittered_share < regular_share + 0.03);
    assert!(jittered < 1.3 * regular + 0.1, "{jittered} % against {regular} %");
}

/// From the middle of a segment on, `bend` makes location and speed contradict each other for 80 s.
fn frozen_while_readings_contradict(cause: Cause, bend: impl Fn(&mut Measurement, &Measurement)) {
    let scenario = Scenario::default();
    let estimator = estimator(Config::default(), &scenario);
    let mut judged = 0;
    for seed in 0..20 {
        let run = simulate(&scenario, seed);
        let mut log = measurements(&run);
        // Given a segment that has taught for a minute and goes on teaching
        let k = in_final_coast(&run, 0.5);
        let (untouched, _) = replay(&estimator, &log);
        let teaches = untouched[k - 10..k + 8].iter().all(|e| e.learning);
        if !teaches || davis_bits(&untouched[0]) == davis_bits(&untouched[k - 1]) {
            continue;
        }
        judged += 1;
        // When location and speed contradict each other
        let last = log[k - 1];
        for measurement in &mut log[k..k + 8] {
            bend(measurement, &last);
        }
        let (estimates, _) = replay(&estimator, &log);
        // Then this is named while it lasts, and from there on r and its covariance do not move by a bit
        let contradicts = |i: &usize| estimates[*i].validity == Validity::Invalid(cause);
        let validities: Vec<_> = estimates[k..k + 8].iter().map(|e| e.validity).collect();
        let named = (k..k + 8).find(contradicts).unwrap_or_else(|| panic!("seed {seed}: {validities:?}"));
        assert!(named < k + 4, "seed {seed}: {validities:?}");
        for i in named..k + 8 {
            assert!(contradicts(&i), "seed {seed}: {validities:?}");
            assert!(!estimates[i].learning, "seed {seed}, sample {i}");
            assert_eq!(davis_bits(&estimates[i]), davis_bits(&estimates[named]), "seed {seed}, sample {i}");
        }
        // and nothing that was read since the contradiction began has reached them: the end of a segment does not count
        let frozen = davis_bits(&estimates[k + 7]);
        let reached_before = |e: &Estimate| davis_bits(e) == frozen;
        assert!(untouched[k - 1..=k + 1].iter().any(reached_before), "seed {seed}");
    }
    assert!(judged >= 5, "{judged} of 20 runs had such a segment");
}

#[test]
fn locations_that_run_back_in_the_middle_of_a_segment_freeze_the_resistance() {
    frozen_while_readings_contradict(Cause::Reversing, |measurement, last| {
        let run_m = measurement.location_m.unwrap() - last.location_m.unwrap();
        measurement.location_m = last.location_m.map(|m| m - run_m);
    });
}

#[test]
fn a_speed_that_sticks_in_the_middle_of_a_segment_freezes_the_resistance() {
    // The train slows down to three fifths, its speed reading does not
    frozen_while_readings_contradict(Cause::StuckSpeed, |measurement, last| {
        let run_m = measurement.location_m.unwrap() - last.location_m.unwrap();
        measurement.location_m = last.location_m.map(|m| m + 0.6 * run_m);
        measurement.speed_mps = last.speed_mps;
    });
}

/// Means over a second in rows 1 and 2 s apart, and in every fifth row: of a tick longer than the shortest one nothing
/// was known, and nothing learned.
#[test]
fn efforts_in_rows_that_are_not_evenly_spaced_teach() {
    let sensors = Sensors { sampling_s: 1.0, effort_noise_share: 0.02, ..Sensors::default() };
    let scenario = Scenario { sensors, ..Scenario::default() };
    let run = simulate(&scenario, SEED);
    let estimator = estimator(Config::with_mode(Mode::Measured), &scenario);
    let rows_are_lost = |log: Vec<Measurement>| -> Vec<Measurement> {
        log.into_iter().enumerate().filter(|(index, _)| index % 3 != 0).map(|(_, row)| row).collect()
    };
    let sparse = |mut log: Vec<Measurement>| {
        log.iter_mut().enumerate().filter(|(index, _)| index % 5 != 0).for_each(|(_, row)| row.effort_n_per_kg = None);
        log
    };
    let (_, expected) = replay(&estimator, &measurements(&run));
    for (name, log) in
        [("rows are lost", rows_are_lost(measurements(&run))), ("efforts are sparse", sparse(measurements(&run)))]
    {
        let (_, found) = replay(&estimator, &log);
        assert!(found.learned_s > 0.9 * expected.learned_s, "{name}: {} s of {}", found.learned_s, expected.learned_s);
        for kmh in [60.0, 100.0, 140.0] {
            assert!(error_sd(&found, &run, kmh).abs() < 2.5, "{name}: {} at {kmh}", error_sd(&found, &run, kmh));
        }
    }
}
