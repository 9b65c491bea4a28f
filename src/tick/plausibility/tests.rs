//! The table of the module, row by row, with the edges of each.

use super::*;
use crate::model::train::TrainDescription;
use crate::tick::bounds::Check;

/// Length of the track, m.
const TRACK_M: Real = 10_000.0;

/// A train that goes up a line, read once a second or as a test says.
struct Readings {
    plausibility: Plausibility,
    config: PlausibilityConfig,
    direction: Direction,
}

impl Readings {
    fn new() -> Self {
        Self { plausibility: Plausibility::default(), config: PlausibilityConfig::default(), direction: Direction::Up }
    }

    fn measured(&mut self, measurement: &Measurement) -> Result<Judged, Option<Real>> {
        let train = Train::try_new(TrainDescription::CASE_STUDY).unwrap();
        let sensor = SensorConfig::default();
        self.plausibility.judge(&self.config, &sensor, &train, TRACK_M, self.direction, measurement)
    }

    fn read(
        &mut self,
        time_s: Real,
        location_m: impl Into<Option<Real>>,
        speed_mps: impl Into<Option<Real>>,
    ) -> Result<Judged, Option<Real>> {
        let (location_m, speed_mps) = (location_m.into(), speed_mps.into());
        self.measured(&Measurement { time_s, location_m, speed_mps, effort_n_per_kg: None })
    }

    /// A reading whose time is believed.
    fn judge(
        &mut self,
        time_s: Real,
        location_m: impl Into<Option<Real>>,
        speed_mps: impl Into<Option<Real>>,
    ) -> Judged {
        self.read(time_s, location_m, speed_mps).unwrap()
    }

    /// At 0 s, at 1000 m, with this speed.
    fn at(speed_mps: Real) -> Self {
        let mut readings = Self::new();
        readings.judge(0.0, 1000.0, speed_mps);
        readings
    }

    /// At 0 s, at 1000 m, with 20 m/s.
    fn running() -> Self {
        Self::at(20.0)
    }
}

/// What was contradictory in each of a row of readings, a second apart.
fn contradictions<const N: usize>(readings: &mut Readings, rows: [(Real, Real); N]) -> [Option<Cause>; N] {
    let mut time_s = 0.0;
    rows.map(|(location_m, speed_mps)| {
        time_s += 1.0;
        readings.judge(time_s, location_m, speed_mps).contradiction
    })
}

#[test]
fn agreeing_readings_are_at_least_one_and_not_a_whole_run() {
    for (agreeing, accepted) in [(0, false), (1, true), (100, true), (101, false)] {
        let config = PlausibilityConfig { agreeing, ..PlausibilityConfig::default() };
        let mut check = Check::default();
        config.check_ranges(&mut check);
        assert_eq!(check.result().is_ok(), accepted, "{agreeing}");
    }
}

#[test]
fn a_train_that_goes_as_it_reads_is_believed_in_both_directions() {
    for (direction, sign) in [(Direction::Up, 1.0), (Direction::Down, -1.0)] {
        let mut readings = Readings { direction, ..Readings::new() };
        for second in 0..60 {
            let (time_s, run_m) = (Real::from(second), 20.0 * Real::from(second));
            let judged = readings.judge(time_s, 5000.0 + sign * run_m, 20.0);
            let expected = Judged {
                time_s,
                sender_s: time_s,
                dt_s: if second == 0 { 0.0 } else { 1.0 },
                begins: second == 0,
                location_m: Ok(5000.0 + sign * run_m),
                speed_mps: Ok(20.0),
                effort_n_per_kg: None,
                contradiction: None,
                shifted: false,
            };
            assert_eq!(judged, expected);
        }
    }
}

#[test]
fn an_equal_earlier_far_or_missing_time_is_dropped_and_the_last_one_named() {
    for time_s in [0.0, 0.9e-3, -50.0, 86_400.1, 4.1e12, -4.1e12, Real::NAN, Real::INFINITY, Real::NEG_INFINITY] {
        assert_eq!(Readings::running().read(time_s, 1000.0, 20.0), Err(Some(0.0)), "{time_s}");
    }
    for time_s in [1e-3, 86_400.0] {
        assert!(Readings::running().read(time_s, 1000.0, 20.0).is_ok(), "{time_s}");
    }
    for time_s in [Real::NAN, 4.1e12, -4.1e12] {
        assert_eq!(Readings::new().read(time_s, 1000.0, 20.0), Err(None), "{time_s}");
    }
    for time_s in [4e12, -4e12] {
        assert!(Readings::new().read(time_s, 1000.0, 20.0).is_ok(), "{time_s}");
    }
}

#[test]
fn no_time_and_one_too_far_ahead_are_out_of_range_and_an_early_one_is_not() {
    for time_s in [Real::NAN, 4.1e12, -4.1e12] {
        assert!(is_out_of_range(None, time_s) && is_out_of_range(Some(0.0), time_s), "{time_s}");
    }
    for (time_s, expected) in [(86_400.1, true), (86_400.0, false), (0.0, false), (-4e12, false)] {
        assert_eq!(is_out_of_range(Some(0.0), time_s), expected, "{time_s}");
        assert!(!is_out_of_range(None, time_s), "{time_s}");
    }
}

#[test]
fn a_dropped_time_costs_nothing_but_itself() {
    let mut readings = Readings::running();
    assert_eq!(readings.read(5e6, 1020.0, 20.0), Err(Some(0.0)));
    let judged = readings.judge(2.0, 1040.0, 20.0);
    assert_eq!((judged.time_s, judged.dt_s, judged.begins), (2.0, 2.0, false));
}

#[test]
fn a_clock_that_was_set_is_believed_the_third_time_and_goes_on_from_the_old_one() {
    let mut readings = Readings::running();
    assert_eq!(readings.read(5e6, 1020.0, 20.0), Err(Some(0.0)));
    assert_eq!(readings.read(5e6 + 1.0, 1040.0, 20.0), Err(Some(0.0)));
    let judged = readings.judge(5e6 + 2.0, 9000.0, 20.0);
    assert_eq!((judged.time_s, judged.sender_s, judged.dt_s, judged.begins), (600.0, 5e6 + 2.0, 0.0, true));
    assert_eq!(judged.location_m, Ok(9000.0), "location and speed begin again");
    let judged = readings.judge(5e6 + 3.0, 9020.0, 20.0);
    assert_eq!((judged.time_s, judged.dt_s, judged.begins), (601.0, 1.0, false));
    // Set back to zero, which is one more.
    assert_eq!(readings.read(0.0, 9040.0, 20.0), Err(Some(5e6 + 3.0)));
    assert_eq!(readings.read(1.0, 9060.0, 20.0), Err(Some(5e6 + 3.0)));
    assert_eq!(readings.judge(2.0, 9080.0, 20.0).time_s, 1201.0);
    // And a long pause behind it.
    let judged = readings.judge(702.0, 9080.0, 0.0);
    assert_eq!((judged.time_s, judged.dt_s, judged.begins), (1901.0, 0.0, true));
}

#[test]
fn times_that_do_not_follow_each_other_do_not_agree() {
    let believed = |times_s: [Real; 5]| {
        let mut readings = Readings::running();
        times_s.map(|time_s| readings.read(time_s, 1000.0, 20.0).is_ok())
    };
    assert_eq!(believed([1e6, 2e6, 3e6, 4e6, 5e6]), [false; 5], "far from each other");
    assert_eq!(believed([1e6, 1e6, 1e6, 1e6, 1e6]), [false; 5], "the same");
    assert_eq!(believed([1e6, 1e6 + 601.0, 1e6 + 1202.0, 1e6, 1e6 - 1.0]), [false; 5], "a long gap, and back");
    assert_eq!(believed([1e6, 1e6 + 600.0, 1e6 + 1200.0, 1e6 + 1201.0, 1.0]), [false, false, true, true, false]);
    assert_eq!(believed([1e6, 1e6 + 1.0, 1.0, 1e6 + 2.0, 1e6 + 3.0]), [false, false, true, false, false]);
}

/// How many readings of an earlier time it takes until they are believed, the train being so far ahead of where it was.
fn needed(readings: &mut Readings, last_m: Real, ahead_m: Option<Real>) -> u32 {
    readings.judge(10_000.0, last_m, 20.0);
    let location_m = ahead_m.map(|ahead_m| last_m + readings.direction.sign() * ahead_m);
    let row = |count: &u32| readings.read(Real::from(*count), location_m, 20.0).is_ok();
    (1..100).find(row).unwrap()
}

#[test]
fn rows_that_come_late_must_be_four_times_as_many_as_those_of_a_clock_that_was_set() {
    for direction in [Direction::Up, Direction::Down] {
        let needed = |ahead_m| needed(&mut Readings { direction, ..Readings::new() }, 5000.0, ahead_m);
        for ahead_m in [Some(200.0), Some(0.0), None, Some(-15.0)] {
            assert_eq!(needed(ahead_m), 3, "{direction:?} {ahead_m:?}");
        }
        for ahead_m in [-15.1, -200.0] {
            assert_eq!(needed(Some(ahead_m)), 12, "{direction:?} {ahead_m}");
        }
    }
    let config = PlausibilityConfig { location_jump_m: 240.0, agreeing: 2, ..PlausibilityConfig::default() };
    assert_eq!(needed(&mut Readings { config, ..Readings::new() }, 5000.0, Some(-30.0)), 2);
    assert_eq!(needed(&mut Readings { config, ..Readings::new() }, 5000.0, Some(-30.1)), 8);
}

#[test]
fn a_longer_pause_than_a_long_gap_is_a_new_beginning() {
    let judged = Readings::at(1.0).judge(600.0, 1600.0, 1.0);
    assert_eq!((judged.dt_s, judged.begins, judged.location_m), (600.0, false, Ok(1600.0)));
    let judged = Readings::running().judge(600.1, 500.0, 110.0);
    assert_eq!((judged.dt_s, judged.begins), (0.0, true));
    assert_eq!((judged.location_m, judged.speed_mps), (Ok(500.0), Ok(110.0)), "any are believed");
}

/// Rows at 20 m/s, then one at this time and place; then how many of those that go on from before it are refused.
fn refused_after_one(far: &[(Real, Real)]) -> usize {
    let mut readings = Readings::running();
    for step in 1..5 {
        readings.judge(10.0 * Real::from(step), 1000.0 + 200.0 * Real::from(step), 20.0);
    }
    for (time_s, location_m) in far {
        readings.judge(*time_s, *location_m, 20.0);
    }
    let mut on = (5..40).map(|step| (10.0 * Real::from(step), 1000.0 + 200.0 * Real::from(step)));
    on.by_ref().take_while(|(time_s, location_m)| readings.read(*time_s, *location_m, 20.0).is_err()).count()
}

#[test]
fn one_row_behind_a_pause_costs_two_of_those_that_go_on_from_before_it() {
    // Wherever it lies; two rows there are no single one any more.
    for location_m in [9000.0, 1800.0, 100.0] {
        assert_eq!(refused_after_one(&[(80_000.0, location_m)]), 2, "{location_m}");
    }
    assert_eq!(refused_after_one(&[(80_000.0, 9000.0), (80_010.0, 9200.0)]), 11);
    assert_eq!(refused_after_one(&[(80_000.0, 9000.0), (80_601.0, 9200.0)]), 11);
}

#[test]
fn a_row_that_comes_late_behind_a_pause_changes_nothing() {
    let mut readings = Readings::running();
    readings.judge(700.0, 9000.0, 20.0);
    assert!(readings.read(10.0, 1200.0, 20.0).is_err());
    assert!(readings.read(20.0, None, 20.0).is_err());
    let judged = readings.judge(710.0, 9200.0, 20.0);
    assert_eq!((judged.dt_s, judged.begins), (10.0, false));
}

#[test]
fn a_speed_that_no_train_has_is_dropped_and_the_location_is_used() {
    let judged = |speed_mps: Option<Real>| Readings::new().judge(0.0, 1000.0, speed_mps);
    assert_eq!(judged(None).speed_mps, Err(Cause::NoSpeed));
    for speed_mps in [-1e-3, 400.1 / 3.6, Real::NAN, Real::INFINITY] {
        let judged = judged(Some(speed_mps));
        assert_eq!((judged.speed_mps, judged.location_m), (Err(Cause::SpeedOutOfRange), Ok(1000.0)), "{speed_mps}");
    }
    for speed_mps in [0.0, 400.0 / 3.6] {
        assert_eq!(judged(Some(speed_mps)).speed_mps, Ok(speed_mps));
    }
}

#[test]
fn a_location_off_the_track_is_dropped_and_the_speed_is_used() {
    let judged = |location_m: Option<Real>| Readings::new().judge(0.0, location_m, 20.0);
    assert_eq!(judged(None).location_m, Err(Cause::NoLocation));
    for location_m in [-2000.1, TRACK_M + 2000.1, Real::NAN, Real::INFINITY, Real::NEG_INFINITY] {
        let judged = judged(Some(location_m));
        let expected = (Err(Cause::LocationOutOfRange), Ok(20.0));
        assert_eq!((judged.location_m, judged.speed_mps), expected, "{location_m}");
    }
    for location_m in [-2000.0, TRACK_M + 2000.0] {
        assert_eq!(judged(Some(location_m)).location_m, Ok(location_m));
    }
}

#[test]
fn an_effort_of_ten_times_a_trains_is_dropped() {
    let judged = |effort| {
        let (location_m, speed_mps, effort_n_per_kg) = (Some(0.0), Some(20.0), Some(effort));
        let measurement = Measurement { time_s: 0.0, location_m, speed_mps, effort_n_per_kg };
        Readings::new().measured(&measurement).unwrap().effort_n_per_kg
    };
    for effort in [10.0, -10.0, Real::NAN, Real::INFINITY] {
        assert_eq!(judged(effort), None, "{effort}");
    }
    for effort in [9.99, -9.99, 0.0] {
        assert_eq!(judged(effort), Some(effort));
    }
}

/// Margin: 1 km/h of the reading's step and six times 0.05 km/h of noise, 0.361 m/s. Upwards at 20 m/s: twice 2.036 MW
/// / 20 m/s / 385.84 t and 0.3 N/kg, 0.828 m/s². Downwards: 2 m/s².
#[test]
fn a_speed_changes_by_what_a_train_can_and_no_more() {
    let jumps = |after_s: Real, speed_mps: Real| {
        let judged = Readings::running().judge(after_s, None, speed_mps);
        assert!([Ok(speed_mps), Err(Cause::SpeedJump)].contains(&judged.speed_mps));
        judged.speed_mps.is_err()
    };
    for (after_s, lowest, highest) in [(1.0, 17.64, 21.18), (2.0, 15.64, 22.01)] {
        assert!(!jumps(after_s, lowest) && !jumps(after_s, highest), "{after_s}");
        assert!(jumps(after_s, lowest - 0.01) && jumps(after_s, highest + 0.01), "{after_s}");
    }
    // The setting is the smaller one: 0.5 m/s².
    let config = PlausibilityConfig { max_acceleration_mps2: 0.5, ..PlausibilityConfig::default() };
    for (speed_mps, is_believed) in [(20.86, true), (20.87, false), (19.14, true), (19.13, false)] {
        let judged = Readings { config, ..Readings::running() }.judge(1.0, None, speed_mps);
        assert_eq!(judged.speed_mps.is_ok(), is_believed, "{speed_mps}");
    }
}

#[test]
fn a_speed_may_change_by_more_the_longer_it_was_not_read() {
    let mut readings = Readings::running();
    assert_eq!(readings.judge(1.0, None, None).speed_mps, Err(Cause::NoSpeed));
    assert_eq!(readings.judge(2.0, None, 22.01).speed_mps, Ok(22.01));
    // From here on it counts again.
    assert_eq!(readings.judge(3.0, None, 25.0).speed_mps, Err(Cause::SpeedJump));
}

#[test]
fn three_speeds_that_agree_with_each_other_are_believed() {
    let judged = |speeds_mps: [Real; 4]| {
        let mut readings = Readings::running();
        let mut time_s = 0.0;
        speeds_mps.map(|speed_mps| {
            time_s += 1.0;
            readings.judge(time_s, None, speed_mps).speed_mps
        })
    };
    const JUMP: Result<Real, Cause> = Err(Cause::SpeedJump);
    assert_eq!(judged([60.0, 60.1, 60.2, 60.3]), [JUMP, JUMP, Ok(60.2), Ok(60.3)]);
    assert_eq!(judged([60.0, 90.0, 60.0, 90.0]), [JUMP; 4]);
    assert_eq!(judged([60.0, 60.1, 20.0, 60.2]), [JUMP, JUMP, Ok(20.0), JUMP], "one that is believed ends the row");
}

/// The lowest and the highest location that are believed at `time_s`, to 5 cm.
fn assert_reach(readings: &Readings, time_s: Real, speed_mps: Real, [lowest_m, highest_m]: [Real; 2]) {
    for (location_m, is_believed) in
        [(lowest_m + 0.05, true), (lowest_m - 0.05, false), (highest_m - 0.05, true), (highest_m + 0.05, false)]
    {
        let mut readings = Readings { ..*readings };
        let judged = readings.judge(time_s, location_m, speed_mps).location_m;
        let expected = if is_believed { Ok(location_m) } else { Err(Cause::LocationJump) };
        assert_eq!(judged, expected, "{location_m}");
    }
}

#[test]
fn a_location_lies_within_120_m_and_a_fifth_of_the_way_from_where_the_speed_leads() {
    // 1020 m ± (120 + 0.2 * 20).
    assert_reach(&Readings::running(), 1.0, 20.0, [896.0, 1144.0]);
    // Three seconds at once: 1060 m ± (120 + 0.2 * 60).
    assert_reach(&Readings::running(), 3.0, 20.0, [928.0, 1192.0]);
    // The mean of two speeds: 1020.5 m ± (120 + 0.2 * 20.5).
    assert_reach(&Readings::running(), 1.0, 21.0, [896.4, 1144.6]);
    // Down: 980 m.
    let mut down = Readings { direction: Direction::Down, ..Readings::new() };
    down.judge(0.0, 1000.0, 20.0);
    assert_reach(&down, 1.0, 20.0, [856.0, 1104.0]);
}

#[test]
fn the_speed_leads_on_while_it_or_the_location_is_missing() {
    let mut readings = Readings::running();
    readings.judge(1.0, None, 20.0);
    readings.judge(2.0, None, None);
    // 60.1 m since the last location.
    assert_reach(&readings, 3.0, 20.2, [928.08, 1192.12]);
}

#[test]
fn a_location_moves_what_is_expected_by_three_tenths_of_its_error() {
    let mut readings = Readings::running();
    readings.judge(1.0, 1120.0, 20.0);
    // 1020 m + 0.3 * 100 m, and 20 m on.
    assert_reach(&readings, 2.0, 20.0, [946.0, 1194.0]);
}

#[test]
fn three_locations_that_agree_with_each_other_are_believed_as_a_shift() {
    let judged = |step_m: Real| {
        let mut readings = Readings::running();
        let judged = [1.0, 2.0, 3.0].map(|time_s| readings.judge(time_s, 5000.0 + step_m * time_s, 20.0));
        (judged.map(|judged| judged.location_m), judged.map(|judged| judged.shifted), readings, judged[2])
    };
    const JUMP: Result<Real, Cause> = Err(Cause::LocationJump);
    // 50 m and 20 m differ by 0.3 * 50 m + 15 m.
    for step_m in [20.0, 49.9, -1.0] {
        let (locations, shifted, readings, last) = judged(step_m);
        let last_m = 5000.0 + 3.0 * step_m;
        assert_eq!(locations, [JUMP, JUMP, Ok(last_m)]);
        assert_eq!((shifted, last.contradiction, last.speed_mps), ([false, false, true], None, Ok(20.0)));
        // From there it goes on.
        assert_reach(&readings, 4.0, 20.0, [last_m - 104.0, last_m + 144.0]);
    }
    for step_m in [50.1, -1.1, 2000.0] {
        let (locations, shifted, ..) = judged(step_m);
        assert_eq!((locations, shifted), ([JUMP; 3], [false; 3]), "{step_m}");
    }
}

#[test]
fn a_location_that_stands_while_the_train_runs_is_dropped_for_as_long_as_it_lasts() {
    let mut readings = Readings::running();
    for (count, speed_mps) in (1..=5).zip([20.1, 20.0].into_iter().cycle()) {
        let judged = readings.judge(10.0 * Real::from(count), 1000.0, speed_mps);
        assert_eq!((judged.location_m, judged.speed_mps), (Err(Cause::StuckLocation), Ok(speed_mps)));
    }
    assert_eq!(readings.judge(60.0, 2200.0, 20.0).location_m, Ok(2200.0));
    // 200 m are run in 10 s: a twentieth of it is a move, though a wrong one.
    for (location_m, cause) in [(1009.9, Cause::StuckLocation), (1010.0, Cause::LocationJump)] {
        assert_eq!(Readings::running().judge(10.0, location_m, 20.0).location_m, Err(cause), "{location_m}");
    }
}

#[test]
fn locations_that_go_back_as_fast_as_the_speed_goes_on_are_reversing_the_third_time() {
    for direction in [Direction::Up, Direction::Down] {
        let mut readings = Readings { direction, ..Readings::new() };
        // The speed changes, or it would be taken for one that is stuck.
        let judged = [(0.0, 20.0), (1.0, 20.1), (2.0, 20.0), (3.0, 20.1), (4.0, 20.0)]
            .map(|(time_s, speed_mps)| readings.judge(time_s, 5000.0 - direction.sign() * 20.0 * time_s, speed_mps));
        let reversing = Some(Cause::Reversing);
        assert_eq!(judged.map(|judged| judged.contradiction), [None, None, None, reversing, reversing]);
        assert!(judged.iter().all(|judged| judged.location_m.is_ok() && judged.speed_mps.is_ok()));
    }
}

#[test]
fn only_steps_back_that_are_as_long_as_those_of_the_speed_are_reversing() {
    let reverses = |speed_mps: Real, step_m: Real| {
        let rows = [1.0, 2.0, 3.0].map(|second| (1000.0 + second * step_m, speed_mps));
        contradictions(&mut Readings::at(speed_mps), rows).contains(&Some(Cause::Reversing))
    };
    assert!(reverses(16.0, -16.0) && reverses(16.0, -10.5) && reverses(80.0, -50.0));
    assert!(!reverses(15.0, -15.0), "slow");
    assert!(!reverses(16.0, -10.0), "short steps");
    assert!(!reverses(80.0, -20.0), "other steps than those of the speed");
}

#[test]
fn a_step_on_or_a_stand_ends_reversing_and_a_short_one_does_not() {
    let last = |steps_m: [Real; 4]| {
        let (mut location_m, mut speed_mps) = (1000.0, 20.0);
        let rows = steps_m.map(|step_m| {
            location_m += step_m;
            speed_mps += 0.1;
            (location_m, speed_mps)
        });
        contradictions(&mut Readings::running(), rows)[3]
    };
    assert_eq!(last([-20.0, -20.0, 20.0, -20.0]), None);
    assert_eq!(last([-20.0, -20.0, -5.0, -20.0]), Some(Cause::Reversing));
    assert_eq!(last([-20.0, -20.0, 0.0, -20.0]), Some(Cause::Reversing));
    let mut readings = Readings::running();
    let rows = [(10.0, 930.0, 0.0), (20.0, 930.0, 0.0), (30.0, 870.0, 12.0), (40.0, 750.0, 12.0), (50.0, 750.0, 0.0)];
    for (time_s, location_m, speed_mps) in rows {
        assert_eq!(readings.judge(time_s, location_m, speed_mps).contradiction, None, "{time_s}");
    }
}

/// How many steps of a second it takes until a speed that always reads 20 m/s is dropped, the locations going on by so
/// much.
fn stuck_after(step_m: Real) -> Option<usize> {
    let mut readings = Readings::running();
    (1..200).find(|second| {
        let time_s = *second as Real;
        // On a line without end.
        let location_m = (1000.0 + time_s * step_m) % TRACK_M;
        let judged = readings.judge(time_s, location_m, 20.0);
        assert_eq!(judged.speed_mps.err(), judged.contradiction);
        judged.contradiction == Some(Cause::StuckSpeed)
    })
}

#[test]
fn a_speed_that_stays_the_same_is_dropped_where_the_locations_say_otherwise() {
    // The locations lag by 10 m a second, which is more than 60 m and a twentieth of the way after seven.
    assert_eq!(stuck_after(10.0), Some(7));
    assert_eq!(stuck_after(30.0), Some(7));
    // By a tenth of the way: 2 m a second, beyond 60 m and 1 m a second after 61.
    assert_eq!(stuck_after(18.0), Some(61));
    assert_eq!(stuck_after(22.0), Some(61));
    // A twentieth is rounding and worn wheels.
    assert_eq!(stuck_after(19.0), None);
    assert_eq!(stuck_after(21.0), None);
    // However far, it must have been read three times.
    assert_eq!(stuck_after(99.0), Some(2));
}

#[test]
fn a_leap_of_the_location_with_which_the_speed_changes_says_nothing_of_a_stuck_one() {
    let rows = [(1070.5, 21.0), (1101.5, 21.0), (1132.5, 21.0), (1163.5, 21.0)];
    assert_eq!(contradictions(&mut Readings::running(), rows), [None; 4]);
}

#[test]
fn a_speed_is_not_dropped_for_locations_that_jump_or_stand_nor_while_it_changes_or_is_zero() {
    let stuck = Some(Cause::StuckSpeed);
    let rows = |step_m: Real, speeds: [Real; 2]| {
        let mut row = 0.0;
        core::array::from_fn::<_, 30, _>(|second| {
            row += 1.0;
            (1000.0 + row * step_m, speeds[second % 2])
        })
    };
    assert!(contradictions(&mut Readings::running(), rows(10.0, [20.0, 20.0])).contains(&stuck));
    assert!(!contradictions(&mut Readings::running(), rows(10.0, [20.1, 20.0])).contains(&stuck), "it changes");
    assert!(!contradictions(&mut Readings::running(), rows(0.0, [20.0, 20.0])).contains(&stuck), "they stand");
    assert!(!contradictions(&mut Readings::at(0.0), rows(10.0, [0.0, 0.0])).contains(&stuck), "it is zero");
    // One jump of a location to the side is no matter of the speed: 60 m and twice 20 m.
    for (jump_m, expected) in [(99.0, stuck), (100.0, None)] {
        let rows = [(1020.0, 20.0), (1040.0, 20.0), (1040.0 + jump_m, 20.0)];
        assert_eq!(contradictions(&mut Readings::running(), rows)[2], expected, "{jump_m}");
    }
}
