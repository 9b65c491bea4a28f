use super::*;
use crate::tick::snapshot::InPlace as _;

const TICK_S: Real = 10.0;

/// The row of a time.
type Row = fn(Real) -> Real;

/// A driver's effort, N/kg: power on and off with ramps of 6 s, at odds with the ticks.
fn effort_n_per_kg(time_s: Real) -> Real {
    let phase_s = time_s % 83.0;
    0.3 * (phase_s / 6.0).min((46.0 - phase_s) / 6.0).clamp(0.0, 1.0)
}

fn mean_n_per_kg(from_s: Real, to_s: Real) -> Real {
    let steps = 200;
    let at = |i: i32| from_s + (to_s - from_s) * (Real::from(i) + 0.5) / Real::from(steps);
    (0..steps).map(|i| effort_n_per_kg(at(i))).sum::<Real>() / Real::from(steps)
}

/// The reading after 200 ticks of a column, and the errors of the last 100 means in their standard deviations, root
/// mean square.
fn learned(column: Row, tick_s: Real) -> (EffortReading, Real) {
    let config = EffortReadingConfig::default();
    let mut reading = EffortReading::ZEROED;
    reading.begin_interval();
    let (mut square, mut count) = (0.0, 0.0);
    for tick in 0..200 {
        let time_s = Real::from(tick) * tick_s;
        let known = reading.read(&config, 0.05, tick_s, Some(column(time_s)));
        let effort_n_per_kg = mean_n_per_kg(time_s - tick_s, time_s);
        let effort = Effort { effort_n_per_kg, acceleration_mps2: 0.0, resistance_n_per_kg: 0.0 };
        reading.compare(&config, tick_s, &effort, [0.1, 2e-3], (1.0, 0.01));
        if let Some(mean) = known.filter(|_| tick >= 100) {
            let error = Real::from(mean.n_per_kg) - mean_n_per_kg(time_s - 2.0 * tick_s, time_s - tick_s);
            // What was not seen before the tick and after it.
            let variance = Real::from(mean.variance) + 2.0 * Real::from(mean.unseen) / (tick_s * tick_s);
            square += error * error / variance;
            count += 1.0;
        }
    }
    (reading, crate::roots::square_root(square / count))
}

/// Trains that power from a stop and then brake show the end of each powering phase alone.
#[test]
fn a_resistance_that_is_off_is_no_age_however_often_the_effort_falls() {
    let config = EffortReadingConfig::default();
    let mut reading = EffortReading::ZEROED;
    // The resistance is larger than learned by a standard deviation.
    let (resistance_sd, off_n_per_kg) = (3e-3, 3e-3);
    for _ in 0..300 {
        reading.begin_interval();
        for tick in 0..60 {
            let effort_n_per_kg: Real = if tick < 30 { 0.7 } else { 0.1 };
            reading.read(&config, 0.05, 1.0, Some(effort_n_per_kg));
            if tick % 10 == 9 {
                let mean_n_per_kg = if tick < 30 { 0.7 } else { 0.1 } + off_n_per_kg;
                let effort =
                    Effort { effort_n_per_kg: mean_n_per_kg, acceleration_mps2: 0.0, resistance_n_per_kg: 0.0 };
                reading.compare(&config, 10.0, &effort, [0.1, resistance_sd], (1.0, 2e-3));
            }
        }
        reading.interrupt();
    }
    let Share { mean: share, variance, .. } = reading.share;
    assert!(share.abs() < 2.0 * root(variance) && root(variance) < 0.4, "{share} {}", root(variance));
}

#[test]
fn a_mean_a_moment_and_a_late_column_are_told_apart() {
    let cases: [(&str, Row, Real); 4] = [
        ("mean", |t| mean_n_per_kg(t - TICK_S, t), 0.0),
        ("moment", effort_n_per_kg, 0.5),
        ("mean, 1 s late", |t| mean_n_per_kg(t - TICK_S - 1.0, t - 1.0), -0.1),
        ("mean, 2 s late", |t| mean_n_per_kg(t - TICK_S - 2.0, t - 2.0), -0.2),
    ];
    for (name, column, expected) in cases {
        let (reading, deviations) = learned(column, TICK_S);
        let (share, variance) = (Real::from(reading.share.mean), Real::from(reading.share.variance));
        let off = (share - expected) / variance.sqrt();
        assert!(
            (share - expected).abs() < 0.05 && off.abs() < 2.5,
            "{name}: {share}, off by {off} standard deviations"
        );
        assert!(deviations < 2.0, "{name}: errors of {deviations} standard deviations");
    }
}

/// Times between rows with an effort, in turn, s.
const UNEVEN: [(&str, &[Real]); 3] = [
    ("1 and 2 s in turn", &[1.0, 2.0]),
    ("jittered by 0.2 s", &[1.1, 0.7, 1.2, 0.9]),
    ("2 to 8 s", &[2.0, 8.0, 3.0, 5.0]),
];

/// Nothing was known of a tick of more than one and a half times the shortest: of such columns that was every one,
/// or every other one.
#[test]
fn rows_that_are_not_evenly_spaced_say_what_their_means_are() {
    type UnevenRow = fn(Real, Real) -> Real;
    let columns: [(&str, UnevenRow); 3] = [
        ("mean", |before_s, time_s| mean_n_per_kg(before_s, time_s)),
        ("moment", |_, time_s| effort_n_per_kg(time_s)),
        ("mean, 1 s late", |before_s, time_s| mean_n_per_kg(before_s - 1.0, time_s - 1.0)),
    ];
    let config = EffortReadingConfig::default();
    for ((spacing, ticks_s), (column, row)) in UNEVEN.into_iter().flat_map(|one| columns.map(|two| (one, two))) {
        let mut reading = EffortReading::ZEROED;
        reading.begin_interval();
        let (mut time_s, mut anchor_s) = (0.0, 0.0);
        let (mut square, mut known, mut last) = (0.0, 0, [0.0; 2]);
        for tick in 0..2000 {
            let before_s = time_s;
            time_s += ticks_s[tick % ticks_s.len()];
            let mean = reading.read(&config, 0.05, time_s - before_s, Some(row(before_s, time_s)));
            if time_s - anchor_s >= 9.5 {
                let effort_n_per_kg = mean_n_per_kg(anchor_s, time_s);
                let effort = Effort { effort_n_per_kg, acceleration_mps2: 0.0, resistance_n_per_kg: 0.0 };
                reading.compare(&config, time_s - anchor_s, &effort, [0.1, 2e-3], (1.0, 0.01));
                anchor_s = time_s;
            }
            if let Some(mean) = mean.filter(|_| tick >= 1000) {
                let tick_s = last[1] - last[0];
                let error = Real::from(mean.n_per_kg) - mean_n_per_kg(last[0], last[1]);
                let variance = Real::from(mean.variance) + 2.0 * Real::from(mean.unseen) / (tick_s * tick_s);
                square += error * error / variance;
                known += 1;
            }
            last = [before_s, time_s];
        }
        let deviations = crate::roots::square_root(square / Real::from(known));
        assert!(known > 990, "{column}, {spacing}: {known} of 1000 are known");
        assert!(deviations < 2.0, "{column}, {spacing}: errors of {deviations} standard deviations");
    }
}

/// Between two efforts the mean is that of the later one, and what rows without an effort have taken of the last
/// one is given back.
#[test]
fn rows_without_an_effort_wait_for_the_next_one() {
    let config = EffortReadingConfig::default();
    let mut reading = EffortReading::ZEROED;
    let mut known = 0;
    for second in 0..60 {
        let effort = (second % 3 == 0).then_some(if second < 30 { 0.3 } else { 0.1 });
        known += usize::from(reading.read(&config, 0.05, 1.0, effort).is_some());
        assert_eq!(reading.waits(), effort.is_none(), "{second}");
        if second == 0 {
            reading.begin_interval();
        }
    }
    assert_eq!(known, 18, "ticks end with 19 of the rows, and the first two have none before them");
    let [read, ..] = reading.interval.unwrap();
    assert!((read - (27.0 * 0.3 + 32.0 * 0.1)).abs() < 1e-4, "{read}");
    for _ in 0..20 {
        reading.read(&config, 0.05, 1.0, None);
    }
    assert!(!reading.waits(), "what no effort has ended for long is not known");
}

/// Row by row a late column is off by what a change of the effort makes; over the change it is not.
#[test]
fn what_a_late_column_has_not_seen_comes_with_the_next_rows() {
    let config = EffortReadingConfig::default();
    let late = |t: Real| mean_n_per_kg(t - TICK_S - 1.0, t - 1.0);
    let (mut reading, _) = learned(late, TICK_S);
    (reading.share.mean, reading.share.variance) = (-0.1, 1e-6);
    // Power is on from 2075 s on; before and long after the effort is steady.
    let (mut error, mut largest, mut unseen) = (0.0_f64, 0.0_f64, 0.0_f64);
    for tick in 200..213 {
        let time_s = Real::from(tick) * TICK_S;
        let known = reading.read(&config, 0.05, TICK_S, Some(late(time_s)));
        let Some(mean) = known.filter(|_| tick > 206) else { continue };
        error += TICK_S * (Real::from(mean.n_per_kg) - mean_n_per_kg(time_s - 2.0 * TICK_S, time_s - TICK_S));
        (largest, unseen) = (largest.max(error.abs()), unseen.max(Real::from(mean.unseen).sqrt()));
    }
    assert!(largest > 0.03 && largest < 2.0 * unseen, "{largest} m/s, {unseen} m/s expected");
    assert!(error.abs() < 0.03, "{error} m/s stay");
}

#[test]
fn a_column_is_carried_in_steps_with_its_doubt_and_a_drift() {
    let mut reading = EffortReading::ZEROED;
    assert_eq!(Column::default().next_run(), [(1.0, 0.0), (0.0, 0.0)]);
    let unknown = Column::of_run((1.0312, 0.004), &reading).next_run();
    assert!(unknown[0].1 > 0.0 && unknown[1].1 == 0.0, "{unknown:?}");
    for share in [-0.1, 0.0, 0.5, -7.25, 16.3] {
        reading.share = Share { mean: share, variance: 1e-8, tick_s: TICK_S as f32 };
        let [gain, found] = Column::of_run((1.0312, 0.004), &reading).next_run();
        assert!((gain.0 - 1.0312).abs() < 1e-4 && (gain.1.sqrt() - 0.004_f32.hypot(GAIN_DRIFT_SD)).abs() < 1.1e-4);
        assert!((found.0 - share).abs() < 1e-3 && (found.1.sqrt() - SHARE_DRIFT_SD).abs() < 1e-3, "{found:?}");
    }
}

#[test]
fn a_gain_that_no_sensor_has_is_not_taken_up() {
    for (gain, is_sound) in [(0.2, true), (0.49, true), (-0.49, true), (0.5, false), (-3.2, false)] {
        let column = Column::of_run((1.0 + gain, 0.01), &EffortReading::ZEROED);
        let [(mean, variance), _] = column.next_run();
        assert_eq!((variance > 0.0, (f64::from(mean) - 1.0 - gain).abs() < 1e-3), (is_sound, is_sound), "{gain}");
    }
}

#[test]
fn a_missing_row_or_a_brake_gives_no_mean_and_teaches_nothing() {
    let config = EffortReadingConfig::default();
    for spoilt in [None, Some(-0.3)] {
        let mut reading = EffortReading::ZEROED;
        reading.begin_interval();
        let mut read = |effort| reading.read(&config, 0.05, TICK_S, effort);
        assert!([Some(0.1), Some(0.1)].map(&mut read).iter().all(Option::is_none), "two rows before a mean");
        assert!(read(Some(0.3)).is_some());
        assert!([spoilt, Some(0.3), Some(0.3)].map(read).iter().all(Option::is_none), "{spoilt:?}");
        let effort = Effort { effort_n_per_kg: 0.2, acceleration_mps2: 0.0, resistance_n_per_kg: 0.0 };
        let before = reading.share(&config);
        for _ in 0..3 {
            reading.compare(&config, TICK_S, &effort, [0.1, 0.0], (1.0, 0.03));
        }
        assert_eq!(reading.share(&config), before);
    }
}
