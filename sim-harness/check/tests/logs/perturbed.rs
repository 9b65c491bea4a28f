//! Are runs that were held up recognised, and the others left in peace?

use crate::simulated::recording;
use rundown::model::direction::Direction;
use rundown_check::perturbed::{Cause, Perturbation};
use rundown_check::{Check, Known, check_beside};
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;

const LENGTH_M: f64 = 20_000.0;
const CRUISE_MPS: f64 = 30.0;

/// The speed wanted at a place, m/s, and how long to stand there, s.
type Style = dyn Fn(f64) -> (f64, f64);

/// A run each second: braking and powering by 0.6 m/s² at most, so that each speed wanted is kept where it begins.
fn run(index: usize, direction: Direction, style: &Style) -> Recording {
    let (mut at_m, mut mps, mut time_s, mut stood_m) = (0.0_f64, 0.0_f64, 0.0, -1e9_f64);
    let mut rows = Vec::new();
    // No two alike: a run that is given twice counts once.
    let own = 1.0 + 0.01 * (index as f64 % 5.0 - 2.0) + 1e-5 * index as f64;
    while at_m < LENGTH_M - 1.0 && time_s < 5000.0 {
        let location_m = if direction == Direction::Up { at_m } else { LENGTH_M - at_m };
        let (location_m, speed_mps) = (Some(location_m), Some(mps));
        rows.push(Sample { time_s, location_m, speed_mps, line: rows.len() as u64 + 2, ..Sample::default() });
        time_s += 1.0;
        let (_, stand_s) = style(at_m);
        if stand_s > 0.0 && at_m - stood_m > 300.0 && mps < 1.0 {
            stood_m = at_m;
            for _ in 0..stand_s as usize {
                rows.push(Sample { time_s, speed_mps: Some(0.0), line: rows.len() as u64 + 2, ..rows[rows.len() - 1] });
                time_s += 1.0;
            }
        }
        // Within the braking distance of a place where less is wanted, brake.
        let reach = (0..60).map(|step| at_m + 25.0 * f64::from(step));
        let wanted = |place: f64| {
            let (wanted, stand_s) = style(place);
            let stops = stand_s > 0.0 && place - stood_m > 300.0 || place >= LENGTH_M - 5.0;
            if stops { 0.5 } else { own * wanted }
        };
        let may = reach.map(|place| (wanted(place).powi(2) + 2.0 * 0.6 * (place - at_m)).sqrt());
        let may_mps = may.fold(f64::INFINITY, f64::min);
        mps = may_mps.clamp(mps - 0.8, mps + 0.6).max(0.5);
        at_m += mps;
    }
    Recording { direction, ..recording(&format!("run{index:02}"), rows) }
}

fn calm(_: f64) -> (f64, f64) {
    (CRUISE_MPS, 0.0)
}

fn calling(at_m: f64) -> (f64, f64) {
    (CRUISE_MPS, if (8_000.0..8_030.0).contains(&at_m) { 40.0 } else { 0.0 })
}

fn red(at_m: f64) -> (f64, f64) {
    (CRUISE_MPS, if (12_300.0..12_330.0).contains(&at_m) { 214.0 } else { 0.0 })
}

fn restricted(at_m: f64) -> (f64, f64) {
    (if (8_000.0..11_000.0).contains(&at_m) { 11.0 } else { CRUISE_MPS }, 0.0)
}

/// A weaker train, or a careful driver.
fn leisurely(_: f64) -> (f64, f64) {
    (0.85 * CRUISE_MPS, 0.0)
}

fn checked(runs: &mut [Recording], stops_m: &[f64]) -> Check {
    check_beside(runs, &Known { stops_m: stops_m.to_vec(), ..Known::default() })
}

fn set(direction: Direction, odd: &Style, calm: &Style) -> Vec<Recording> {
    (0..12).map(|i| run(i, direction, if i == 7 { odd } else { calm })).collect()
}

fn only(check: &Check) -> Perturbation {
    let perturbed: Vec<usize> = (0..check.runs.len()).filter(|i| !check.runs[*i].perturbations.is_empty()).collect();
    assert_eq!(perturbed, [7], "{:?}", check.perturbed_note());
    let [one] = check.runs[7].perturbations.as_slice() else { panic!("{:?}", check.runs[7].perturbations) };
    one.clone()
}

#[test]
fn a_red_signal_is_a_stop_that_no_other_run_makes() {
    for direction in [Direction::Up, Direction::Down] {
        let mut runs = set(direction, &red, &calm);
        let check = checked(&mut runs, &[]);
        let one = only(&check);
        let at_m = if direction == Direction::Up { 12_315.0 } else { LENGTH_M - 12_315.0 };
        assert_eq!(one.cause, Cause::UnscheduledStop);
        assert!((one.from_m - at_m).abs() < 60.0 && (one.duration_s - 214.0).abs() < 4.0, "{one:?}");
        assert_eq!((one.others_stopping, one.others), (0, 11));
        assert!(runs[7].perturbed.as_deref().is_some_and(|words| words.starts_with("stopped 21")), "{runs:?}");
        assert!(runs[6].perturbed.is_none());
    }
}

#[test]
fn a_restriction_is_a_stretch_where_the_others_are_fast() {
    for direction in [Direction::Up, Direction::Down] {
        let one = only(&checked(&mut set(direction, &restricted, &calm), &[]));
        let (from_m, to_m) = if direction == Direction::Up { (8_000.0, 11_000.0) } else { (9_000.0, 12_000.0) };
        assert_eq!(one.cause, Cause::HeldBack);
        assert!((one.from_m - from_m).abs() < 500.0 && (one.to_m - to_m).abs() < 500.0, "{one:?}");
        assert!((one.speed_kmh - 39.6).abs() < 2.0 && (one.others_kmh.unwrap() - 108.0).abs() < 15.0, "{one:?}");
        // 3 km at 11 in place of 30 m/s, and a little less than the way down and up.
        assert!((one.duration_s - 172.0).abs() < 30.0, "{one:?}");
    }
}

#[test]
fn a_station_where_others_call_and_one_that_is_described_are_none() {
    let mut runs: Vec<Recording> =
        (0..12).map(|i| run(i, Direction::Up, if i < 3 { &calling } else { &calm })).collect();
    assert_eq!(checked(&mut runs, &[]).perturbed_note(), None);
    let mut runs = set(Direction::Up, &red, &calm);
    assert_eq!(checked(&mut runs, &[12_250.0]).perturbed_note(), None);
}

/// A phone's speeds are noise there.
#[test]
fn a_slower_departure_than_that_of_others_is_none() {
    let departs = |mps: f64| move |at_m: f64| (if at_m < 100.0 { mps } else { CRUISE_MPS }, 0.0);
    let mut runs = set(Direction::Up, &departs(1.0), &departs(1.8));
    runs.iter_mut().for_each(|run| run.rows.retain(|row| row.location_m > Some(5.0)));
    assert_eq!(checked(&mut runs, &[]).perturbed_note(), None);
}

#[test]
fn a_leisurely_run_is_none() {
    assert_eq!(checked(&mut set(Direction::Up, &leisurely, &calm), &[]).perturbed_note(), None);
}

#[test]
fn few_runs_and_runs_without_a_timetable_are_not_compared() {
    let mut few: Vec<Recording> = (0..4).map(|i| run(i, Direction::Up, if i == 2 { &red } else { &calm })).collect();
    let check = checked(&mut few, &[]);
    assert_eq!((check.perturbed_note(), check.not_compared), (None, 4));
    let check = checked(&mut few, &[5_000.0]);
    assert_eq!((check.perturbed_note(), check.not_compared), (None, 4), "a described stop makes no company");
    // Each stops at a place of its own.
    let own = |i: usize| {
        move |at_m: f64| {
            let stop_m = 4_000.0 + 1_000.0 * i as f64;
            (CRUISE_MPS, if (stop_m..stop_m + 30.0).contains(&at_m) { 60.0 } else { 0.0 })
        }
    };
    let mut runs: Vec<Recording> = (0..12).map(|i| run(i, Direction::Up, &own(i))).collect();
    let check = checked(&mut runs, &[]);
    assert_eq!((check.perturbed_note(), check.not_compared), (None, 12));
}
