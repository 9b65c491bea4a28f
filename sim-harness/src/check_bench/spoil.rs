//! What is done to the rows of runs, so that they have a defect of known size.

use super::Defect;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rundown_files::statistics::{extremes, mean_of};
use rundown_files::{recording::Recording, sample::Sample};

/// What is done to rows is done to one run; what a sensor does, to all. Out: its true figure.
pub(super) fn spoilt(defect: Defect, recordings: &mut Vec<Recording>, random: &mut ChaCha8Rng) -> f64 {
    let below = |recordings: &mut Vec<Recording>, kmh: f64| {
        let rows = recordings.iter_mut().flat_map(|recording| &mut recording.rows);
        rows.for_each(|row| row.speed_mps = row.speed_mps.map(|mps| if 3.6 * mps < kmh - 0.25 { 0.0 } else { mps }));
        kmh
    };
    match defect {
        Defect::SameRows => {
            let mut copy = recordings[1].clone();
            copy.name = "copy".to_owned();
            copy.rows.iter_mut().for_each(|row| row.time_s += 3600.0);
            let rows = copy.rows.len() as f64;
            recordings.push(copy);
            rows
        }
        Defect::Saturated => {
            let speeds = recordings.iter().flat_map(|recording| &recording.rows).filter_map(|row| row.speed_mps);
            let kmh = (2.0 * 0.9 * 3.6 * speeds.fold(0.0, f64::max)).round() / 2.0;
            let rows = recordings.iter_mut().flat_map(|recording| &mut recording.rows);
            rows.for_each(|row| row.speed_mps = row.speed_mps.map(|mps| mps.min(kmh / 3.6)));
            kmh
        }
        Defect::DeadZone => below(recordings, 12.0),
        Defect::SmallDeadZone => below(recordings, 5.0),
        Defect::Held | Defect::HeldPieces => {
            recordings.iter_mut().for_each(|recording| hold(defect, &mut recording.rows, random));
            3.0
        }
        Defect::OdometerWheel => {
            let wheel = 1.0 + random.random_range(0.008..0.028) * if random.random_bool(0.5) { 1.0 } else { -1.0 };
            recordings.iter_mut().for_each(|recording| counted_by(wheel, &mut recording.rows));
            wheel
        }
        Defect::HalfEffort => {
            let efforts = recordings[1].rows.iter_mut().filter_map(|row| row.effort_n_per_kg.as_mut());
            efforts.for_each(|effort| *effort *= 0.5);
            2.0
        }
        Defect::FrozenEffort => {
            freeze(&mut recordings[1].rows, random);
            FROZEN_ROWS as f64 - 1.0
        }
        Defect::SmoothedSpeed => {
            recordings.iter_mut().for_each(|recording| smooth(&mut recording.rows, 4));
            9.0
        }
        Defect::UnsignedBrake => {
            let efforts = recordings[1].rows.iter_mut().filter_map(|row| row.effort_n_per_kg.as_mut());
            efforts.for_each(|effort| *effort = effort.abs());
            100.0
        }
        _ => spoil(defect, &mut recordings[1].rows, random),
    }
}

/// The mean of each speed and of so many on both sides.
fn smooth(rows: &mut [Sample], beside: usize) {
    let read: Vec<Option<f64>> = rows.iter().map(|row| row.speed_mps).collect();
    for (i, row) in rows.iter_mut().enumerate() {
        let near: Vec<f64> =
            read[i.saturating_sub(beside)..read.len().min(i + beside + 1)].iter().flatten().copied().collect();
        row.speed_mps = row.speed_mps.map(|_| mean_of(&near));
    }
}

/// Rows a second apart that have one effort.
const FROZEN_ROWS: usize = 30;

/// The effort of a powering train stands still, eight times.
fn freeze(rows: &mut [Sample], random: &mut ChaCha8Rng) {
    let powers = |i: &usize| rows[*i].effort_n_per_kg.is_some_and(|effort| effort > 0.05);
    let mut places: Vec<usize> = (1..rows.len().saturating_sub(FROZEN_ROWS)).filter(powers).collect();
    for _ in 0..8 {
        if places.is_empty() {
            return;
        }
        let at = places[random.random_range(0..places.len())];
        let held = rows[at].effort_n_per_kg;
        rows[at..at + FROZEN_ROWS].iter_mut().for_each(|row| row.effort_n_per_kg = held);
        places.retain(|place| place.abs_diff(at) > 2 * FROZEN_ROWS);
    }
}

/// An odometer that begins right and counts with another wheel, and a speed of the same.
fn counted_by(wheel: f64, rows: &mut [Sample]) {
    let Some(begin_m) = rows.iter().find_map(|row| row.location_m) else { return };
    for row in rows {
        row.location_m = row.location_m.map(|m| begin_m + wheel * (m - begin_m));
        row.speed_mps = row.speed_mps.map(|mps| wheel * mps);
    }
}

/// Where a run begins to coast for at least so many seconds, by rows a second apart; its middle where it never does.
fn coast(rows: &[Sample], seconds: usize) -> usize {
    let coasts = |row: &Sample| {
        row.effort_n_per_kg.is_some_and(|effort| effort.abs() < 0.01) && row.speed_mps.is_some_and(|mps| mps > 10.0)
    };
    let slows = |rows: &&[Sample]| {
        let ends = rows[0].speed_mps.zip(rows[rows.len() - 1].speed_mps);
        rows.iter().all(coasts) && ends.is_some_and(|(first, last)| first - last > 1.5)
    };
    rows.windows(seconds).position(|rows| slows(&rows)).unwrap_or(rows.len() / 2)
}

/// Holds 3 % of the speeds.
fn hold(defect: Defect, rows: &mut [Sample], random: &mut ChaCha8Rng) {
    let mut left = 0;
    for i in 1..rows.len() {
        let is_piece = defect == Defect::HeldPieces;
        if left == 0 && random.random_bool(if is_piece { 0.03 / 4.0 } else { 0.03 }) {
            left = if is_piece { random.random_range(2..=6) } else { 1 };
        }
        if left > 0 {
            rows[i].speed_mps = rows[i - 1].speed_mps;
            left -= 1;
        }
    }
}

/// From a place of one run on, or from a run on, the readings of another wheel, `turned`.
pub(super) fn turn(defect: Defect, recordings: &mut [Recording], turned: &[Recording], random: &mut ChaCha8Rng) {
    if defect == Defect::WheelTurned {
        recordings[2..]
            .iter_mut()
            .zip(&turned[2..])
            .for_each(|(recording, turned)| recording.rows.clone_from(&turned.rows));
    } else {
        let rows = &mut recordings[1].rows;
        let from = random.random_range(rows.len() / 3..2 * rows.len() / 3);
        rows[from..].copy_from_slice(&turned[1].rows[from..]);
    }
}

/// Rows of a place where the train runs fast for a while.
fn fast(rows: &[Sample], random: &mut ChaCha8Rng) -> usize {
    let fast = |i: &usize| rows[*i..*i + 90].iter().all(|row| row.speed_mps.is_some_and(|mps| mps > 12.0));
    let places: Vec<usize> = (60..rows.len().saturating_sub(150)).filter(fast).collect();
    if places.is_empty() { rows.len() / 2 } else { places[random.random_range(0..places.len())] }
}

/// Does to the rows of a run what makes the defect. Out: its true figure.
fn spoil(defect: Defect, rows: &mut Vec<Sample>, random: &mut ChaCha8Rng) -> f64 {
    let at = fast(rows, random);
    let shift_clock = |rows: &mut [Sample], by_s: f64| rows.iter_mut().for_each(|row| row.time_s += by_s);
    let shift = |rows: &mut [Sample], by_m: f64| {
        rows.iter_mut().for_each(|row| row.location_m = row.location_m.map(|m| m + by_m));
    };
    let run_m = |rows: &[Sample]| rows.windows(2).map(|pair| pair[0].speed_mps.unwrap_or(0.0)).sum::<f64>();
    match defect {
        Defect::SetBack => {
            shift_clock(&mut rows[at..], -3600.0);
            -3600.0
        }
        Defect::SetForward => {
            shift_clock(&mut rows[at..], 600.0);
            600.0
        }
        Defect::Wrap => {
            shift(&mut rows[at..], -65_536.0);
            -65_536.0
        }
        Defect::Reset => {
            let here_m = rows[at].location_m.unwrap_or(0.0);
            shift(&mut rows[at..], -here_m);
            -here_m
        }
        Defect::Spikes => {
            for k in 0..5 {
                shift(&mut rows[at + 15 * k..=at + 15 * k], 1000.0);
            }
            1000.0
        }
        Defect::StuckSpeed => {
            let missed_m = run_m(&rows[at..at + 60]);
            rows[at..at + 60].iter_mut().for_each(|row| row.speed_mps = Some(0.0));
            missed_m
        }
        Defect::StuckCoasting => {
            let at = coast(rows, 70) + 5;
            let held = rows[at].speed_mps;
            let missed_m = run_m(&rows[at..at + 60]) - 59.0 * held.unwrap_or_default();
            rows[at..at + 60].iter_mut().for_each(|row| row.speed_mps = held);
            missed_m.abs()
        }
        Defect::StuckLocation => {
            let held = rows[at].location_m;
            rows[at..at + 60].iter_mut().for_each(|row| row.location_m = held);
            run_m(&rows[at..at + 60])
        }
        Defect::Interpolated => {
            *rows = between(rows, 10);
            10.0
        }
        Defect::TwoDirections => back_again(rows),
        Defect::OtherChainage | Defect::NearChainage => {
            let size_m = if defect == Defect::OtherChainage { 2300.0 } else { 300.0 };
            let by_m = if random.random_bool(0.5) { size_m } else { -size_m };
            shift(rows, by_m);
            by_m
        }
        Defect::TurnedChainage => turned(rows),
        Defect::OtherUnit => {
            rows.iter_mut().for_each(|row| row.speed_mps = row.speed_mps.map(|mps| mps / 3.6));
            3.6
        }
        _ => 0.0,
    }
}

/// Each row as a straight line between every so many of them has it.
fn between(rows: &[Sample], each: usize) -> Vec<Sample> {
    let of = |i: usize| {
        let (from, to) = (&rows[i - i % each], rows.get(i - i % each + each).unwrap_or(&rows[i - i % each]));
        let share = (i % each) as f64 / each as f64;
        let on_line = |from: Option<f64>, to: Option<f64>| Some(from? * (1.0 - share) + to? * share);
        let (location_m, speed_mps) = (on_line(from.location_m, to.location_m), on_line(from.speed_mps, to.speed_mps));
        Sample { location_m, speed_mps, ..rows[i] }
    };
    (0..rows.len()).map(of).collect()
}

/// The same rows in the other order, a minute later. Out: the way back, m.
fn back_again(rows: &mut Vec<Sample>) -> f64 {
    let last = rows.len() - 1;
    let (end_s, line) = (rows[last].time_s, rows[last].line);
    let way_m = rows[last].location_m.zip(rows[0].location_m).map_or(0.0, |(a, b)| (a - b).abs());
    let back: Vec<Sample> = rows.iter().rev().copied().collect();
    let later = |(i, row): (usize, Sample)| {
        let i = i as u64 + 1;
        Sample { time_s: end_s + 60.0 + i as f64, line: line + i, ..row }
    };
    rows.extend(back.into_iter().enumerate().map(later));
    way_m
}

/// As the run back would read with its own zero: the places in reverse order, and growing. Out: sum of both locations
/// of a place, m.
fn turned(rows: &mut [Sample]) -> f64 {
    let (low_m, high_m) = extremes(rows.iter().filter_map(|row| row.location_m));
    let sum_m = low_m + high_m;
    let end_s = rows.last().map_or(0.0, |row| row.time_s);
    rows.reverse();
    for row in rows {
        (row.time_s, row.location_m) = (end_s - row.time_s, row.location_m.map(|m| sum_m - m));
    }
    sum_m
}
