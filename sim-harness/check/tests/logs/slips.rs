//! Are wheels that slip or slide named, and taken for no wheel, no offset and no age of the speed?

use crate::simulated::{Recorder, all, check_for_replay, find, found, kinds, recording};
use rundown_check::finding::{Done, Kind};
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;

/// Each slip, s.
const LONG_S: usize = 6;

/// In every second place where the speed changes as `acts` says for as long as a slip, the wheel turns by `factor` of
/// the train. Out: how many slips.
fn slip(recordings: &mut [Recording], factor: f64, acts: impl Fn(f64) -> bool) -> usize {
    let mut count = 0;
    for recording in recordings {
        let speeds: Vec<f64> = recording.rows.iter().map(|row| row.speed_mps.unwrap()).collect();
        let (mut at, mut places) = (0, 0);
        while at + LONG_S + 2 < speeds.len() {
            let window = &speeds[at..at + LONG_S + 2];
            if window[0] > 3.0 && window[LONG_S + 1] > 3.0 && window.windows(2).all(|two| acts(two[1] - two[0])) {
                if places % 2 == 0 {
                    let rows = &mut recording.rows[at + 1..=at + LONG_S];
                    rows.iter_mut().for_each(|row| row.speed_mps = row.speed_mps.map(|mps| mps * factor));
                    count += 1;
                }
                (at, places) = (at + 40, places + 1);
            }
            at += 1;
        }
    }
    count
}

const WRONG: [Kind; 5] = [Kind::SpeedScale, Kind::SpeedOffset, Kind::Skew, Kind::WheelChange, Kind::LostSeconds];

fn sets(seed: u64) -> Vec<Vec<Recording>> {
    let fine = Recorder { quantum_kmh: 0.1, noise_m: 3.0, ..Recorder::default() };
    let whole = Recorder { noise_m: 3.0, ..Recorder::default() };
    vec![
        fine.trams(seed, 8, 16),
        whole.trams(seed + 1, 8, 16),
        fine.hopping(seed + 2, 8, 6),
        whole.hopping(seed + 3, 8, 6),
    ]
}

#[test]
fn slips_of_wheels_that_power_and_slides_of_wheels_that_brake_are_named_and_teach_nothing() {
    for (kind, factor, sign) in [(Kind::Slips, 1.2, 1.0), (Kind::Slides, 0.8, -1.0)] {
        for (i, mut runs) in sets(91_000).into_iter().enumerate() {
            let count = slip(&mut runs, factor, |dv| sign * dv > 0.15);
            let check = check_for_replay(&mut runs);
            let one = found(&check, kind);
            assert!(one.done == Done::LeftOut && one.count * 5 > count * 2, "{i} {one}, of {count}");
            let off = (one.figure.value - 100.0 * (factor - 1.0)).abs();
            assert!(off < 2.5 * one.figure.sd && off < 8.0, "{i} {one}");
            assert!(!kinds(&check).iter().any(|kind| WRONG.contains(kind)), "{i} {:?}", all(&check));
        }
    }
}

#[test]
fn trains_that_do_not_slip_are_not_accused_of_it() {
    for i in 0..4 {
        for mut runs in sets(92_000 + 10 * i) {
            let check = check_for_replay(&mut runs);
            assert!(find(&check, Kind::Slips).or(find(&check, Kind::Slides)).is_none(), "{i} {:?}", all(&check));
        }
    }
}

/// Runs with a stop every 400 s, on the second, whose wheels slide by 6 % in each brake.
fn evenly_braked() -> Vec<Recording> {
    let run = |number: usize| {
        let (mut rows, mut at_m, mut mps) = (Vec::new(), 0.0, 0.0_f64);
        for second in 0..2000 + number {
            let since_s = (second + 7 * number) % 400;
            let top_mps = 30.0 + 0.2 * number as f64;
            let rate = match since_s {
                0..300 => (top_mps - mps).clamp(0.0, 0.5),
                300..320 => -0.02,
                _ => -0.6,
            };
            let after = (mps + rate).max(0.0);
            at_m += 0.5 * (mps + after);
            mps = after;
            let read = if rate < -0.1 && mps > 0.0 { 0.94 * mps } else { mps };
            let speed_mps = Some((36.0 * read).round() / 36.0);
            rows.push(Sample { time_s: second as f64, location_m: Some(at_m.round()), speed_mps, ..Sample::default() });
        }
        recording(&format!("run{number}"), rows)
    };
    (0..8).map(run).collect()
}

#[test]
fn wheels_that_slide_in_every_brake_are_no_clock_that_loses_seconds() {
    let check = check_for_replay(&mut evenly_braked());
    assert!(!kinds(&check).contains(&Kind::LostSeconds), "{:?}", all(&check));
}

/// Wherever the train brakes by more than 0.3 m/s² over 5 s the wheel turns by `factor` of it.
fn slide_in_each_brake(recordings: &mut [Recording], quantum_kmh: f64, factor: f64) {
    for recording in recordings {
        let speeds: Vec<f64> = recording.rows.iter().map(|row| row.speed_mps.unwrap()).collect();
        let times_s: Vec<f64> = recording.rows.iter().map(|row| row.time_s).collect();
        for (i, row) in recording.rows.iter_mut().enumerate() {
            let from = times_s.partition_point(|time_s| *time_s < times_s[i] - 2.5);
            let to = times_s.partition_point(|time_s| *time_s <= times_s[i] + 2.5) - 1;
            if speeds[to] - speeds[from] < -0.3 * (times_s[to] - times_s[from]) {
                row.speed_mps = Some((3.6 * factor * speeds[i] / quantum_kmh).round() * quantum_kmh / 3.6);
            }
        }
    }
}

/// Trains that hop, trams, and longer runs, every second and every two.
fn braking(seed: u64, quantum_kmh: f64, scale: f64) -> Vec<Vec<Recording>> {
    let near = Recorder { quantum_kmh, noise_m: 3.0, scale, ..Recorder::default() };
    let recorders = [near, Recorder { step_s: 2.0, ..near }];
    let of = |(i, recorder): (u64, Recorder)| {
        let seed = seed + 10 * i;
        [recorder.hopping(seed, 8, 8), recorder.trams(seed + 1, 8, 16), recorder.runs(seed + 2, 8, 3)]
    };
    (0..).zip(recorders).flat_map(of).collect()
}

#[test]
fn wheels_that_slide_in_each_brake_are_named_and_no_wheel_and_no_age_is_put_right() {
    for (quantum_kmh, factor) in [(0.1, 0.94), (1.0, 0.94), (0.1, 0.98)] {
        for (i, mut runs) in braking(96_000, quantum_kmh, 1.0).into_iter().enumerate() {
            slide_in_each_brake(&mut runs, quantum_kmh, factor);
            let check = check_for_replay(&mut runs);
            let is_changed = |kind: &Kind| find(&check, *kind).is_some_and(|one| one.done == Done::PutRight);
            assert!(!WRONG.iter().any(is_changed), "{i} {:?}", all(&check));
            // Of trams, which hold one speed, a wheel is not distinguished from slides.
            if i % 3 != 1 {
                let slides = found(&check, Kind::Slides);
                let off = (slides.figure.value - 100.0 * (factor - 1.0)).abs();
                assert!(
                    slides.done == Done::Said && off < 1.5 && off < 3.0 * slides.figure.sd.max(0.5),
                    "{i} {slides}"
                );
                assert!(!kinds(&check).iter().any(|kind| WRONG.contains(kind)), "{i} {:?}", all(&check));
                assert!(check.notes().iter().any(|note| note.contains("slide")), "{:?}", check.notes());
            }
        }
    }
}

#[test]
fn wheels_that_are_off_slide_in_no_brake() {
    for (quantum_kmh, scale) in [(0.1, 1.0), (0.1, 1.013), (1.0, 0.987)] {
        for (i, mut runs) in braking(97_000, quantum_kmh, scale).into_iter().enumerate() {
            let check = check_for_replay(&mut runs);
            assert!(find(&check, Kind::Slides).is_none(), "{scale} {i} {:?}", all(&check));
        }
    }
}
