//! Is it found where one run differs from its recorder and put right: another wheel, another age of the speed, readings
//! that cannot be?

use crate::simulated::{Recorder, all, check_for_replay, clean, kinds, one, only};
use rundown_check::finding::{Done, Finding, Kind};
use rundown_check::{Check, check};
use rundown_files::recording::Recording;
use rundown_files::statistics::rms;

/// Six runs of one recorder, the third of them spoilt.
fn third(seed: u64, spoil: impl Fn(&mut Recording)) -> (Check, Vec<Recording>) {
    let mut recordings = Recorder::default().runs(seed, 6, 5);
    spoil(&mut recordings[2]);
    (check_for_replay(&mut recordings), recordings)
}

fn speeds(factor: f64, plus_mps: f64) -> impl Fn(&mut Recording) {
    move |recording| {
        for row in &mut recording.rows {
            row.speed_mps = row.speed_mps.map(|mps| if mps > 0.0 { (factor * mps + plus_mps).max(0.0) } else { mps });
        }
    }
}

fn of_third(check: &Check, kind: Kind) -> Option<&Finding> {
    check.runs[2].findings.iter().find(|finding| finding.kind == kind)
}

#[test]
fn a_wheel_of_one_run_is_found_and_put_right() {
    for seed in 0..8 {
        let (found, mut recordings) = third(20_000 + seed, speeds(1.013, 0.0));
        let finding = of_third(&found, Kind::SpeedScale).unwrap_or_else(|| panic!("{seed}: {:?}", all(&found)));
        assert!((finding.figure.value - 1.013).abs() < 0.002 && finding.done == Done::PutRight, "{seed}: {finding}");
        let others = found.runs.iter().enumerate().filter(|(i, run)| *i != 2 && !run.findings.is_empty());
        assert_eq!(others.count(), 0, "{seed}: {:?}", all(&found));
        let again = check(&mut recordings);
        assert!(!kinds(&again).contains(&Kind::SpeedScale), "{seed}: {:?}", all(&again));
    }
}

/// A tram is never fast for long, so a wheel of one run alone looks much like an offset of its speeds; beside the
/// offset that most runs have it does not.
#[test]
fn a_wheel_of_one_tram_is_found_and_no_other_is_accused() {
    let recorder = Recorder { quantum_kmh: 0.1, noise_m: 0.3, drift_m: 2.5, skew_s: 0.5, ..Recorder::default() };
    let mut missed = Vec::new();
    for seed in 0..10 {
        for factor in [1.0, 0.98, 1.02] {
            let mut recordings = recorder.trams(22_000 + seed, 12, 15);
            speeds(factor, 0.0)(&mut recordings[2]);
            let found = check_for_replay(&mut recordings);
            let scales: Vec<(usize, &Finding)> = (0..12)
                .flat_map(|i| found.runs[i].findings.iter().map(move |finding| (i, finding)))
                .filter(|(_, finding)| finding.kind == Kind::SpeedScale)
                .collect();
            match scales[..] {
                [(2, finding)] if factor != 1.0 => {
                    let off = (finding.figure.value - factor).abs();
                    assert!(off < 0.006 && finding.done == Done::PutRight, "{seed} {finding}");
                }
                [] => missed.extend((factor != 1.0).then_some((seed, factor))),
                _ => panic!("{seed} {factor}: {scales:?}"),
            }
        }
    }
    assert!(missed.len() <= 2, "{missed:?}");
}

#[test]
fn an_offset_of_one_run_is_said_and_is_no_wheel() {
    for seed in 0..8 {
        let (found, _) = third(21_000 + seed, speeds(1.0, -1.5 / 3.6));
        let finding = of_third(&found, Kind::SpeedOffset).unwrap_or_else(|| panic!("{seed}: {:?}", all(&found)));
        assert!((finding.figure.value - 1.5).abs() < 0.3, "{seed}: {finding}");
        assert!(!kinds(&found).contains(&Kind::SpeedScale), "{seed}: {:?}", all(&found));
    }
}

#[test]
fn an_offset_that_no_rounding_explains_is_put_right_and_is_no_wheel() {
    let mut recordings = Recorder::default().runs(21_500, 6, 5);
    recordings.iter_mut().for_each(speeds(1.0, 2.0 / 3.6));
    let before: Vec<Option<f64>> = recordings[0].rows.iter().map(|row| row.speed_mps).collect();
    let found = check(&mut recordings);
    let offset = all(&found).into_iter().find(|finding| finding.kind == Kind::SpeedOffset).unwrap();
    assert!((offset.figure.value + 2.0).abs() < 0.15 && offset.done == Done::PutRight, "{offset}");
    assert!(!kinds(&found).contains(&Kind::SpeedScale), "{:?}", all(&found));
    for (row, before) in recordings[0].rows.iter().zip(before) {
        let expected = before.map(|mps| (mps + offset.figure.value / 3.6).max(0.0));
        assert!((row.speed_mps.unwrap() - expected.unwrap()).abs() < 1e-9 || before == Some(0.0));
    }
}

#[test]
fn an_offset_beside_a_wheel_is_put_right_with_it() {
    let mut recordings = Recorder::default().runs(21_600, 6, 5);
    let truths = recordings.clone();
    recordings.iter_mut().for_each(speeds(1.012, 1.0 / 3.6));
    let found = check(&mut recordings);
    for kind in [Kind::SpeedOffset, Kind::SpeedScale] {
        let finding = all(&found).into_iter().find(|finding| finding.kind == kind).unwrap();
        assert_eq!(finding.done, Done::PutRight, "{finding}");
    }
    assert!((found.recorders[0].scale.unwrap().value - 1.012).abs() < 0.002, "{:?}", found.recorders);
    let pairs = recordings.iter().zip(&truths).flat_map(|(run, truth)| run.rows.iter().zip(&truth.rows));
    let moving = pairs.filter(|(_, truth)| truth.speed_mps > Some(3.0));
    let off = moving.map(|(row, truth)| (row.speed_mps.unwrap() - truth.speed_mps.unwrap()).abs());
    assert!(off.fold(0.0, f64::max) < 0.5 / 3.6);
}

/// Root mean square of the distance between locations.
fn off_m(a: &Recording, b: &Recording) -> f64 {
    rms(a.rows.iter().zip(&b.rows).filter_map(|(a, b)| Some(a.location_m? - b.location_m?)))
}

/// Locations as old as the speeds are those of the same train by a recorder without skew, that many rows later.
#[test]
fn locations_are_moved_to_the_age_of_the_speed() {
    for (seed, skew_s) in [(1, 3.0), (2, -2.0), (3, 8.0)] {
        let of = |skew_s| Recorder { skew_s, noise_m: 1.0, ..Recorder::default() }.runs(22_000 + seed, 5, 5);
        let mut late = of(skew_s);
        let found = check_for_replay(&mut late);
        assert_eq!(only(&found, Kind::Skew).done, Done::PutRight);
        let mut straight = of(0.0);
        let by = skew_s as i32;
        for (late, straight) in late.iter_mut().zip(&mut straight) {
            late.rows.drain(..by.max(0) as usize);
            straight.rows.drain(..(-by).max(0) as usize);
            // The figure is of first order in the skew: of 8 s it finds 7.7.
            let most_m = 2.0 + skew_s.abs();
            assert!(off_m(late, straight) < most_m, "{skew_s}: {} m", off_m(late, straight));
        }
    }
    // A model that asks for the lag itself gets what was recorded.
    let mut late = Recorder { skew_s: 3.0, ..Recorder::default() }.runs(22_009, 5, 5);
    let before = late.clone();
    assert_eq!(only(&check(&mut late), Kind::Skew).done, Done::Said);
    assert_eq!(off_m(&late[0], &before[0]), 0.0);
}

#[test]
fn a_skew_of_one_run_is_found_and_put_right() {
    for seed in 0..6 {
        let late = |recording: &mut Recording| {
            let speeds: Vec<Option<f64>> = recording.rows.iter().map(|row| row.speed_mps).collect();
            recording.rows.iter_mut().skip(8).zip(speeds).for_each(|(row, speed_mps)| row.speed_mps = speed_mps);
        };
        let (found, mut recordings) = third(23_000 + seed, late);
        let finding = of_third(&found, Kind::Skew).unwrap_or_else(|| panic!("{seed}: {:?}", all(&found)));
        assert!((finding.figure.value - 8.0).abs() < 0.5 && finding.done == Done::PutRight, "{seed}: {finding}");
        let again = check(&mut recordings).runs[2].skew_s.unwrap();
        assert!(again.value.abs() < 0.5, "{seed}: {again:?}");
    }
}

#[test]
fn readings_that_cannot_be_are_left_out() {
    for [location_m, speed_mps] in [[f64::NAN, f64::NAN], [f64::INFINITY, f64::NEG_INFINITY], [1e308, 1e308]] {
        let (found, rows) = one(clean(24), |rows| {
            let spoilt = rows.iter_mut().skip(7).step_by(50);
            spoilt.for_each(|row| (row.location_m, row.speed_mps) = (Some(location_m), Some(speed_mps)));
        });
        assert_eq!(only(&found, Kind::Impossible).line, clean(24)[7].line);
        assert_eq!((rows[7].location_m, rows[57].speed_mps), (None, None));
    }
}

#[test]
fn single_speeds_that_cannot_be_are_left_out_and_are_no_wheel() {
    for kmh in [0.0, 255.0, 655.35] {
        let mut recordings = Recorder::default().runs(25_000, 4, 5);
        for recording in &mut recordings {
            let moving = recording.rows.iter_mut().filter(|row| row.speed_mps.is_some_and(|mps| mps > 15.0));
            moving.skip(20).step_by(60).for_each(|row| row.speed_mps = Some(kmh / 3.6));
        }
        let found = check(&mut recordings);
        let finding = only(&found, Kind::SpeedSpikes);
        assert_eq!(finding.done, Done::LeftOut);
        assert!(found.recorders[0].scale.unwrap().away_from(1.0) < 4.0, "{kmh}");
    }
}

#[test]
fn rows_without_a_reading_are_said_from_one_in_twenty() {
    let lost =
        |share: usize| one(clean(26), |rows| rows.iter_mut().step_by(share).for_each(|row| row.location_m = None)).0;
    assert!((only(&lost(10), Kind::MissingReadings).figure.value - 10.0).abs() < 0.2);
    assert!(!kinds(&lost(40)).contains(&Kind::MissingReadings));
}

/// A location that stands still, or comes in large steps, is in its unit.
#[test]
fn coarse_and_stuck_locations_are_no_other_unit() {
    let (coarse, _) = one(clean(27), |rows| {
        rows.iter_mut().for_each(|row| row.location_m = row.location_m.map(|m| (m / 100.0).floor() * 100.0));
    });
    assert!(!kinds(&coarse).contains(&Kind::OtherUnit), "{:?}", all(&coarse));
    let (stuck, _) = one(clean(27), |rows| {
        let held = rows[60].location_m;
        rows[60..].iter_mut().for_each(|row| row.location_m = held);
    });
    let found = kinds(&stuck);
    assert!(found.contains(&Kind::StuckLocation) && !found.contains(&Kind::OtherUnit), "{:?}", all(&stuck));
}

#[test]
fn a_speed_that_is_held_while_the_train_slows_down_is_left_out() {
    for quantum_kmh in [0.1, 1.0] {
        let recorder = Recorder { quantum_kmh, ..Recorder::default() };
        let truth = recorder.runs(28_000, 1, 5).remove(0).rows;
        // From where it is fastest the train coasts and brakes.
        let fastest = truth.iter().max_by(|a, b| a.speed_mps.partial_cmp(&b.speed_mps).unwrap()).unwrap();
        let from = truth.iter().rposition(|row| row.speed_mps == fastest.speed_mps).unwrap();
        // Until an eighth of the distance is missing, and 200 m: less than of a location that stands still.
        let held_mps = fastest.speed_mps.unwrap();
        let missing_m = |to: usize| truth[from..to].iter().map(|row| held_mps - row.speed_mps.unwrap()).sum::<f64>();
        let is_enough = |to: &usize| missing_m(*to) > 200.0_f64.max(0.125 * held_mps * (to - from) as f64);
        let to = (from..truth.len()).find(is_enough).unwrap();
        let (found, rows) = one(truth.clone(), |rows| {
            rows[from..to].iter_mut().for_each(|row| row.speed_mps = Some(held_mps));
        });
        assert!(kinds(&found).contains(&Kind::StuckSpeed), "{quantum_kmh}: {:?}", all(&found));
        assert_eq!(rows[from + 5].speed_mps, None);
    }
}

#[test]
fn a_shift_of_the_location_is_said_where_the_location_is_known_better() {
    for by_m in [150.0, 300.0, -150.0] {
        let truth = clean(29);
        let from = truth.iter().position(|row| row.time_s > 300.0 && row.speed_mps.unwrap() > 10.0).unwrap();
        let (found, _) = one(truth, |rows| {
            rows[from..].iter_mut().for_each(|row| row.location_m = row.location_m.map(|m| m + by_m));
        });
        let finding = only(&found, Kind::Reset);
        assert!((finding.figure.value - by_m).abs() < 30.0 && finding.done == Done::Said, "{by_m}: {finding}");
    }
}
