//! Is each property of a recorder found, with its figure, and is a clean log accused of none?

use crate::simulated::{self, Recorder, all, clean, find, kinds, one, only, recording};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rundown_check::finding::{Done, Kind};
use rundown_check::{Check, Known, check, check_beside};
use rundown_files::sample::Sample;

/// Recorders that do nothing but round.
fn clean_recorders() -> [Recorder; 4] {
    [
        Recorder::default(),
        Recorder { step_s: 10.0, ..Recorder::default() },
        Recorder { noise_m: 0.3, odometer_m: 1.0, ..Recorder::default() },
        Recorder { noise_m: 1.0, drift_m: 6.0, quantum_kmh: 0.1, ..Recorder::default() },
    ]
}

/// What was found, but that speeds are rounded.
fn accusations(check: &Check) -> Vec<Kind> {
    kinds(check).into_iter().filter(|kind| !matches!(kind, Kind::RoundedSpeed | Kind::SteppedSpeed)).collect()
}

#[test]
fn clean_logs_are_accused_of_nothing() {
    let mut accused = Vec::new();
    for (which, recorder) in clean_recorders().iter().enumerate() {
        for seed in 0..25 {
            let (found, _) = recorder.check(1000 + seed, 4, 5);
            accused.extend(accusations(&found).into_iter().map(|kind| (which, seed, kind)));
        }
    }
    assert!(accused.len() <= 2, "of 100 sets: {accused:?}");
}

/// One run alone: there is no scatter between runs that would say how far its driver's style goes.
#[test]
fn a_clean_log_that_is_judged_alone_is_accused_of_nothing() {
    let mut accused = Vec::new();
    for (which, recorder) in clean_recorders().iter().enumerate() {
        for seed in 0..100 {
            let (found, _) = recorder.check(11_000 + seed, 1, 1 + seed as usize % 4);
            let wrong = accusations(&found);
            if !wrong.is_empty() {
                accused.push((which, seed, wrong));
            }
        }
    }
    assert!(accused.len() <= 8, "{} of 400 logs: {accused:?}", accused.len());
}

/// In one run with rows 10 s apart the doubt of what bends between them is as large as half a step.
#[test]
fn truncation_of_a_log_that_is_judged_alone_is_found_more_often_than_not_and_never_taken_for_a_wheel() {
    let truncated = [1.0, 10.0].map(|step_s| {
        let recorder = Recorder { truncates: true, step_s, ..Recorder::default() };
        let found = |seed: u64| kinds(&recorder.check(12_000 + seed, 1, 4).0);
        let found: Vec<Vec<Kind>> = (0..50_u64).map(found).collect();
        let with = |kind| found.iter().filter(|found| found.contains(&kind)).count();
        assert!(with(Kind::SpeedScale) <= 1 && with(Kind::RoundedSpeed) <= 1, "{step_s} s");
        with(Kind::TruncatedSpeed)
    });
    assert!(truncated[0] >= 35 && truncated[1] >= 10, "{truncated:?} of 50 found");
}

#[test]
fn truncation_is_found_put_right_and_is_no_wheel() {
    for step_s in [1.0, 10.0] {
        let recorder = Recorder { truncates: true, step_s, ..Recorder::default() };
        for seed in 0..8 {
            let (found, recordings) = recorder.check(2000 + seed, 6, 5);
            let finding = only(&found, Kind::TruncatedSpeed);
            assert_eq!((finding.figure.value, finding.done), (1.0, Done::PutRight));
            let offset = found.recorders[0].offset_kmh.unwrap();
            assert!(offset.away_from(0.5) < 4.0 && (offset.value - 0.5).abs() < 0.1, "{step_s} {seed}: {offset:?}");
            let scale = found.recorders[0].scale.unwrap();
            assert!((scale.value - 1.0).abs() < 0.002, "{step_s} {seed}: {scale:?}");
            let read = recordings[0].rows.iter().filter_map(|row| row.speed_mps).find(|mps| *mps > 10.0).unwrap();
            assert!(((3.6 * read).fract() - 0.5).abs() < 1e-6);
        }
    }
}

#[test]
fn speeds_that_are_rounded_up_are_found_and_put_right_beside_a_wheel_too() {
    for (seed, scale) in [(1, 1.0), (2, 1.0), (3, 1.013), (4, 0.987)] {
        let recorder = Recorder { truncates: true, scale, ..Recorder::default() };
        let mut runs = recorder.runs(2100 + seed, 6, 5);
        for speed in runs.iter_mut().flat_map(|run| &mut run.rows).filter_map(|row| row.speed_mps.as_mut()) {
            *speed += if *speed > 0.0 { 1.0 / 3.6 } else { 0.0 };
        }
        let found = check(&mut runs);
        let finding = simulated::found(&found, Kind::RoundedUpSpeed);
        assert_eq!((finding.figure.value, finding.done), (1.0, Done::PutRight), "{seed}");
        assert!((found.recorders[0].scale.unwrap().value - scale).abs() < 0.002, "{seed}: {:?}", all(&found));
        assert_eq!(kinds(&found).contains(&Kind::SpeedScale), scale != 1.0, "{seed}: {:?}", all(&found));
        let wrong = [Kind::SpeedOffset, Kind::TruncatedSpeed, Kind::RoundedSpeed];
        assert!(!kinds(&found).iter().any(|kind| wrong.contains(kind)), "{seed}: {:?}", all(&found));
    }
}

#[test]
fn a_wheel_and_a_late_speed_are_found_where_locations_are_seldom() {
    for (seed, scale, skew_s) in [(1, 1.01, 0.0), (2, 0.985, 0.0), (3, 1.0, 2.0), (4, 1.0, 0.0)] {
        let recorder = Recorder { scale, skew_s, quantum_kmh: 0.1, ..Recorder::default() };
        let mut runs = recorder.runs(2200 + seed, 6, 5);
        for (i, row) in runs.iter_mut().flat_map(|run| run.rows.iter_mut().enumerate()) {
            row.location_m = row.location_m.filter(|_| i % 30 == 0);
        }
        let found = check(&mut runs);
        let compared = &found.recorders[0];
        assert!((compared.scale.unwrap().value - scale).abs() < 0.002, "{seed}: {:?}", all(&found));
        assert_eq!(kinds(&found).contains(&Kind::SpeedScale), scale != 1.0, "{seed}: {:?}", all(&found));
        assert_eq!(kinds(&found).contains(&Kind::Skew), skew_s != 0.0, "{seed}: {:?}", all(&found));
    }
}

#[test]
fn a_wheel_is_found_within_two_permille_beside_truncation_and_skew() {
    for (seed, scale) in [(1, 1.013), (2, 0.987), (3, 1.03), (4, 0.955)] {
        for truncates in [false, true] {
            let recorder = Recorder { scale, truncates, skew_s: 2.0, skew_sd_s: 1.0, ..Recorder::default() };
            let (found, recordings) = recorder.check(3000 + seed, 5, 6);
            let finding = simulated::found(&found, Kind::SpeedScale);
            assert!((finding.figure.value - scale).abs() < 0.002, "{scale} {truncates}: {finding}");
            let [again] = check(&mut recordings.clone()).recorders.try_into().unwrap();
            assert!((again.scale.unwrap().value - 1.0).abs() < 0.001);
        }
    }
}

#[test]
fn intervals_hold_the_truth() {
    let (mut inside, mut all) = (0, 0);
    for seed in 0..40 {
        let recorder = Recorder { scale: 1.006, skew_s: 1.0, noise_m: 2.0, drift_m: 2.0, ..Recorder::default() };
        let (found, _) = recorder.check(4000 + seed, 5, 5);
        let [low, high] = found.recorders[0].scale.unwrap().interval();
        inside += usize::from((low..high).contains(&1.006));
        all += 1;
    }
    assert!(inside * 100 >= 88 * all, "{inside} of {all}");
}

/// The stops alone show such a wheel: what they leave open of the locations is open of the speed, too.
#[test]
fn intervals_hold_a_wheel_that_only_described_stops_show() {
    let (mut inside, sets) = ([0, 0], 24);
    for seed in 0..sets {
        let mut random = ChaCha8Rng::seed_from_u64(9000 + seed);
        let recorder = Recorder { scale: 1.013, noise_m: 0.3, odometer_m: 1.0, ..Recorder::default() };
        let (mut recordings, stops_m) = recorder.with_one_wheel(7000 + seed, 6, 8);
        let described = |stop_m: f64| stop_m + 30.0 * Distribution::<f64>::sample(&StandardNormal, &mut random);
        let stops_m: Vec<f64> = stops_m.into_iter().map(described).collect();
        let check = check_beside(&mut recordings, &Known { stops_m, ..Known::default() });
        for (inside, kind) in inside.iter_mut().zip([Kind::LocationScale, Kind::SpeedScale]) {
            let [low, high] = simulated::found(&check, kind).figure.interval();
            *inside += u64::from((low..high).contains(&1.013));
        }
        let [low, high] = check.recorders[0].scale.unwrap().interval();
        assert!(high - low > 5e-4, "{low} {high}");
    }
    assert!(inside.iter().all(|inside| 100 * inside >= 88 * sets), "{inside:?} of {sets}");
}

/// Where nothing is left in the mean, single steps show it; in more noise their even intervals do, and where they drown
/// it is said that wheel and lost seconds are not distinguishable.
#[test]
fn lost_seconds_that_a_wheel_hides_in_full_are_found_or_said_to_be_hidden() {
    let odometer = Recorder { noise_m: 0.3, odometer_m: 1.0, ..Recorder::default() };
    let every_10_s = |noise_m| Recorder { step_s: 10.0, noise_m, ..Recorder::default() };
    let noisy = Recorder { noise_m: 12.0, ..Recorder::default() };
    let seen = [odometer, Recorder::default(), noisy, every_10_s(4.0), every_10_s(12.0)];
    let scale = 107.0 / 106.0;
    for seed in 6300..6303 {
        for recorder in seen {
            let (clean, _) = recorder.check(seed, 6, 6);
            assert!(!clean.recorders[0].hides_lost_seconds(), "{:?}", clean.recorders[0].lost_second_sd_s);
            let (found, _) = Recorder { loses_each_s: 106.0, scale, ..recorder }.check(seed, 6, 6);
            let finding = find(&found, Kind::LostSeconds);
            let finding = finding.unwrap_or_else(|| panic!("{seed}: not found, {} m", recorder.noise_m));
            assert!((finding.figure.value / recorder.step_s - 100.0 / 106.0).abs() < 0.05, "{seed}: {finding}");
            let off = found.recorders[0].scale.unwrap().value - scale;
            assert!(off.abs() < 0.002, "{seed}: {off}");
        }
        for loses_each_s in [0.0, 106.0] {
            let (found, _) = Recorder { loses_each_s, scale, ..every_10_s(60.0) }.check(seed, 6, 6);
            assert!(found.recorders[0].hides_lost_seconds(), "{seed}: {:?}", found.recorders[0].lost_second_sd_s);
        }
    }
}

/// A wheel that reads high takes from the excess of the locations what the lost seconds add: in the mean little is
/// left.
#[test]
fn lost_seconds_are_found_beside_a_wheel_that_hides_them() {
    for (seed, scale) in [(6200, 1.013), (6201, 1.0125), (6202, 1.011), (6203, 1.009)] {
        let recorder = Recorder {
            loses_each_s: 106.0,
            noise_m: 0.3,
            odometer_m: 1.0,
            truncates: true,
            scale,
            ..Recorder::default()
        };
        let (found, _) = recorder.check(seed, 6, 6);
        let finding = simulated::found(&found, Kind::LostSeconds);
        assert!((finding.figure.value - 100.0 / 106.0).abs() < 0.05, "{scale}: {finding}");
        let off = found.recorders[0].scale.unwrap().value - scale;
        assert!(off.abs() < 0.0005, "{scale}: {off}");
    }
}

#[test]
fn intervals_of_the_skew_hold_the_truth() {
    let clean = clean_recorders();
    let (mut inside, mut all) = ([0; 4], [0; 4]);
    for (which, recorder) in clean.iter().enumerate() {
        for seed in 0..30 {
            let (found, _) = Recorder { skew_s: 2.5, ..*recorder }.check(4500 + seed, 4, 4);
            for skew in found.runs.iter().filter_map(|run| run.skew_s) {
                let [low, high] = skew.interval();
                inside[which] += usize::from((low..high).contains(&2.5));
                all[which] += 1;
            }
        }
    }
    let [inside_all, count] = [inside, all].map(|each| each.iter().sum::<usize>());
    assert!(inside_all * 100 >= 92 * count, "{inside:?} of {all:?}");
}

#[test]
fn skew_is_found_run_by_run() {
    let recorder = Recorder { skew_s: 2.5, skew_sd_s: 1.0, noise_m: 1.0, ..Recorder::default() };
    let (found, _) = recorder.check(5000, 12, 6);
    let finding = only(&found, Kind::Skew);
    assert!((finding.figure.value - 2.5).abs() < 1.0, "{finding}");
    assert!((0.4..2.0).contains(&found.recorders[0].skew_spread_s.unwrap()));
}

#[test]
fn lost_seconds_are_found_and_put_right_and_are_no_wheel() {
    let recorder = Recorder { loses_each_s: 106.0, noise_m: 0.3, odometer_m: 1.0, ..Recorder::default() };
    for seed in 0..6 {
        let (found, _) = recorder.check(6000 + seed, 3, 6);
        let finding = only(&found, Kind::LostSeconds);
        assert!((finding.figure.value - 100.0 / 106.0).abs() < 0.25, "{finding}");
        assert!((found.recorders[0].scale.unwrap().value - 1.0).abs() < 0.002);
    }
}

/// Single seconds do not stand out here; some dozens at even intervals do.
#[test]
fn lost_seconds_are_found_beside_receivers_and_every_10_s_and_are_no_wheel() {
    let rounded = Recorder { loses_each_s: 106.0, ..Recorder::default() };
    let recorders = [
        ("1 s", rounded),
        ("1 s, drifts", Recorder { noise_m: 1.0, drift_m: 6.0, loses_each_s: 87.0, ..rounded }),
        ("10 s", Recorder { step_s: 10.0, loses_each_s: 123.4, ..rounded }),
        ("10 s, truncated", Recorder { step_s: 10.0, truncates: true, ..rounded }),
    ];
    for (which, recorder) in recorders {
        for seed in 6100..6104 {
            let (found, _) = recorder.check(seed, 6, 6);
            let wrong: Vec<Kind> = accusations(&found)
                .into_iter()
                .filter(|kind| *kind != Kind::LostSeconds && (*kind != Kind::TruncatedSpeed || !recorder.truncates))
                .collect();
            let truth = 100.0 * recorder.step_s / recorder.loses_each_s;
            for run in &found.runs {
                let lost = run.findings.iter().find(|finding| finding.kind == Kind::LostSeconds);
                let lost = lost.unwrap_or_else(|| panic!("{which}, {seed}: none in {}", run.name));
                assert!((lost.figure.value / truth - 1.0).abs() < 0.02, "{which}, {seed}: {lost}");
            }
            let scale = found.recorders[0].scale.unwrap();
            assert!(wrong.is_empty() && (scale.value - 1.0).abs() < 0.002, "{which}, {seed}: {wrong:?} {scale:?}");
        }
    }
}

#[test]
fn a_wheel_beside_lost_seconds_is_the_wheel_that_it_is() {
    for (seed, scale) in [(6201, 1.013), (6202, 0.985)] {
        let recorder = Recorder { scale, loses_each_s: 106.0, ..Recorder::default() };
        let (found, _) = recorder.check(seed, 6, 6);
        assert!(kinds(&found).contains(&Kind::LostSeconds), "{:?}", kinds(&found));
        let figure = found.recorders[0].scale.unwrap();
        assert!((figure.value - scale).abs() < 0.002, "{figure:?} for {scale}");
    }
}

/// A wheel, truncation and a speed that is old are no staircase.
#[test]
fn no_seconds_are_lost_where_the_speed_reads_wrong() {
    let recorders = [
        Recorder { truncates: true, ..Recorder::default() },
        Recorder { truncates: true, step_s: 10.0, ..Recorder::default() },
        Recorder { scale: 0.99, drift_m: 6.0, ..Recorder::default() },
        Recorder { scale: 1.02, skew_s: 3.0, step_s: 10.0, ..Recorder::default() },
    ];
    for (which, recorder) in recorders.iter().enumerate() {
        for seed in 6300..6308 {
            let (found, _) = recorder.check(seed, 4, 5);
            assert!(!kinds(&found).contains(&Kind::LostSeconds), "{which}, {seed}: {:?}", kinds(&found));
        }
    }
}

#[test]
fn clocks_that_jump_are_put_right() {
    let truth = clean(7);
    let middle = truth.iter().position(|row| row.time_s > 300.0 && row.speed_mps.unwrap() > 10.0).unwrap();
    let steps: [(Kind, f64); 4] = [
        (Kind::Midnight, -86_400.0),
        (Kind::ClockSetBack, -3600.0),
        (Kind::ClockSetForward, 3600.0),
        (Kind::ClockSetBack, -61.0),
    ];
    for (kind, by_s) in steps {
        let (found, rows) = one(truth.clone(), |rows| rows[middle..].iter_mut().for_each(|row| row.time_s += by_s));
        let finding = only(&found, kind);
        assert_eq!(finding.line, truth[middle].line);
        let off = rows.iter().zip(&truth).map(|(found, truth)| (found.time_s - truth.time_s).abs()).fold(0.0, f64::max);
        assert!(off < 1.0, "{kind:?}: {off} s");
    }
}

/// One location of such a receiver is off by half of what the train moves in a second.
#[test]
fn a_clock_set_forward_is_seen_at_any_place_of_a_noisy_log() {
    for seed in 20..30 {
        let truth = clean(seed);
        let moves = |i: &usize| truth[i - 5..i + 5].iter().all(|row| row.speed_mps.unwrap() > 8.0);
        for at in (30..truth.len() - 30).filter(moves).step_by(40) {
            let (found, _) = one(truth.clone(), |rows| rows[at..].iter_mut().for_each(|row| row.time_s += 600.0));
            assert_eq!(only(&found, Kind::ClockSetForward).line, truth[at].line, "{seed}, {at}: {:?}", all(&found));
        }
    }
}

#[test]
fn a_gap_with_a_location_that_is_stuck_is_no_clock_set_forward() {
    let truth = clean(7);
    let at = truth.iter().position(|row| row.time_s > 300.0 && row.speed_mps.unwrap() > 10.0).unwrap();
    // On both sides, and as receivers have it after a tunnel: the first fixes repeat the last one.
    for before in [5, 1] {
        let (found, _) = one(truth.clone(), |rows| {
            rows[at..].iter_mut().for_each(|row| row.time_s += 600.0);
            let stuck = rows[at - 1].location_m;
            rows[at - before..at + 5].iter_mut().for_each(|row| row.location_m = stuck);
        });
        assert!(!kinds(&found).contains(&Kind::ClockSetForward), "{before}: {:?}", all(&found));
    }
}

#[test]
fn wraps_and_resets_are_joined() {
    let truth = clean(8);
    let at = truth[truth.len() / 2].location_m.unwrap();
    type Change = fn(f64, f64) -> f64;
    let steps: [(Kind, Change); 3] = [
        (Kind::Wrap, |m, at| if m > at { m - 65_536.0 } else { m }),
        (Kind::Wrap, |m, at| if m > at { m - 10_000.0 } else { m }),
        (Kind::Reset, |m, at| if m > at { m - at } else { m }),
    ];
    for (kind, change) in steps {
        let (found, rows) = one(truth.clone(), |rows| {
            // By row, not by location: the noise must not cross the edge twice.
            let edge = rows.iter().position(|row| row.location_m.unwrap() > at).unwrap();
            rows[edge..]
                .iter_mut()
                .for_each(|row| row.location_m = row.location_m.map(|m| change(m.max(at + 1e-9), at)));
        });
        let finding = simulated::found(&found, kind);
        assert_eq!(finding.done, Done::PutRight, "{finding}");
        let off =
            rows.iter().zip(&truth).filter_map(|(found, truth)| Some((found.location_m? - truth.location_m?).abs()));
        assert!(off.fold(0.0, f64::max) < 90.0, "{kind:?}");
    }
}

#[test]
fn sensors_that_stand_still_are_left_out() {
    let truth = clean(9);
    let from = truth.iter().position(|row| row.time_s > 200.0 && row.speed_mps.unwrap() > 12.0).unwrap();
    let (found, rows) = one(truth.clone(), |rows| {
        let held = rows[from].location_m;
        rows[from..from + 40].iter_mut().for_each(|row| row.location_m = held);
    });
    let finding = only(&found, Kind::StuckLocation);
    assert!((finding.line as i64 - truth[from].line as i64).abs() <= 1);
    assert!(rows[from + 5].location_m.is_none());
    let (found, rows) =
        one(truth.clone(), |rows| rows[from..from + 60].iter_mut().for_each(|row| row.speed_mps = Some(0.0)));
    assert_eq!(only(&found, Kind::StuckSpeed).done, Done::LeftOut);
    assert!(rows[from + 5].speed_mps.is_none());
}

/// A receiver that says the same for 5 or 10 s: what it repeats is left out, and speeds are neither older nor offset
/// for it.
#[test]
fn locations_that_are_held_between_fixes_are_left_out() {
    let wrong = [Kind::SpeedOffset, Kind::SpeedScale, Kind::Skew, Kind::TruncatedSpeed];
    for located_each in [5, 10] {
        let recorder = Recorder { located_each, ..Recorder::default() };
        for seed in 0..8 {
            let (found, _) = recorder.check(13_000 + seed, 4, 3);
            let kinds = kinds(&found);
            assert!(kinds.contains(&Kind::StuckLocation), "{located_each} {seed}: {:?}", all(&found));
            assert!(!kinds.iter().any(|kind| wrong.contains(kind)), "{located_each} {seed}: {:?}", all(&found));
        }
    }
}

#[test]
fn one_row_that_comes_late_is_no_way_back() {
    let (found, _) = one(clean(11), |rows| rows.push(Sample { time_s: 5.0, location_m: Some(20.0), ..rows[5] }));
    assert!(kinds(&found).iter().all(|kind| *kind == Kind::RoundedSpeed), "{:?}", all(&found));
}

#[test]
fn there_and_back_other_units_and_missing_standstill_are_said() {
    let truth = clean(10);
    let (found, _) = one(truth.clone(), |rows| {
        let back: Vec<Sample> = rows.iter().rev().copied().collect();
        let end_s = rows.last().unwrap().time_s;
        for (i, row) in back.into_iter().enumerate() {
            rows.push(Sample { time_s: end_s + 60.0 + i as f64, line: 5000 + i as u64, ..row });
        }
    });
    assert_eq!(simulated::found(&found, Kind::TwoDirections).done, Done::Refused);

    for factor in [1.0 / 3.6, 0.621, 1.852, 60.0] {
        let (found, _) = one(truth.clone(), |rows| {
            rows.iter_mut().for_each(|row| row.speed_mps = row.speed_mps.map(|v| v * factor))
        });
        let finding = simulated::found(&found, Kind::OtherUnit);
        assert!((finding.figure.value * factor - 1.0).abs() < 0.05 && finding.done == Done::Refused, "{finding}");
    }

    // An odometer that is set right at the last stop goes nowhere.
    let (found, _) = one(truth.clone(), |rows| {
        let last = *rows.last().unwrap();
        let set_right = |i: u32| Sample {
            line: last.line + u64::from(i),
            time_s: last.time_s + f64::from(i),
            location_m: last.location_m.map(|m| m - 800.0),
            speed_mps: Some(0.0),
            ..last
        };
        rows.extend((1..60).map(set_right));
    });
    assert!(!kinds(&found).contains(&Kind::TwoDirections), "{:?}", all(&found));

    let standing: usize = truth.iter().filter(|row| row.speed_mps == Some(0.0)).count();
    let (found, _) = one(truth.clone(), |rows| rows.retain(|row| row.speed_mps != Some(0.0)));
    let finding = only(&found, Kind::MissingStandstill);
    assert!((finding.figure.value - standing as f64).abs() < 90.0, "{finding} {standing}");
}

/// Their readings have another step, which is none of the others'.
#[test]
fn logs_in_another_unit_do_not_hide_what_the_recorder_did() {
    let mut recordings = Recorder { truncates: true, ..Recorder::default() }.runs(4711, 12, 5);
    for row in &mut recordings[3].rows {
        row.speed_mps = row.speed_mps.map(|mps| (100.0 * mps).round() / 360.0);
    }
    let found = check(&mut recordings);
    assert!(found.runs[3].refusal().is_some_and(|finding| finding.kind == Kind::OtherUnit), "{:?}", found.notes());
    assert_eq!(found.recorders[0].speed_step_kmh, Some(1.0));
    assert!(found.has(Kind::TruncatedSpeed) && !found.has(Kind::SpeedOffset), "{:?}", found.notes());
}

/// Rounding is off by the same as long as a speed is held: a few held speeds are no wheel, however well they are
/// located.
#[test]
fn held_speeds_that_are_rounded_are_no_wheel() {
    let run = |k: u32| {
        let (mut location_m, mut speed) = (0.0, 0.0_f64);
        let row = |i: u32| {
            let shown = Some((3.6 * speed).round() / 3.6);
            let row = Sample {
                time_s: 10.0 * f64::from(i),
                location_m: Some(location_m),
                speed_mps: shown,
                ..Sample::default()
            };
            let next = if i > 70 { (speed - 6.0).max(0.0) } else { (speed + 4.0).min(25.0 + f64::from(k)) };
            location_m += 5.0 * (speed + next);
            speed = next;
            row
        };
        recording(&format!("run{k}"), (0..80).map(row).collect())
    };
    let found = check(&mut (0..6).map(run).collect::<Vec<_>>());
    assert!(!kinds(&found).contains(&Kind::SpeedScale), "{:?}", all(&found));
}

#[test]
fn a_skew_that_differs_from_run_to_run_is_found_in_few_runs() {
    let recorder = Recorder { skew_s: 2.5, skew_sd_s: 0.9, noise_m: 1.0, ..Recorder::default() };
    for seed in 0..6 {
        let (found, _) = recorder.check(5100 + seed, 4, 6);
        assert_eq!(only(&found, Kind::Skew).done, Done::Said, "{seed}");
    }
}
