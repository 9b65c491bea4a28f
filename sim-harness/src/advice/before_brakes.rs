//! Do trains coast before their brakes as short hops have taught it?
//!
//! In: the runs of each unit as replayed. Out: the same with a wider interval of r where they do not, and a note.
//!
//! A speed that is held by turns of coasting and of power that is weaker than the running resistance falls evenly:
//! location and speed show a coast of a train that runs more easily. Before a brake drivers coast without power; a fall
//! there that is steeper than what was learned, alike at most of the stops, says that what was learned has power in it.
//! Only that way round: power that was missed makes a fall smaller. A brake that drags before each stop looks the same,
//! and gradients that are steeper there than described; which of them it is nobody says, and the interval holds all.
//!
//! Where no fall is seen, for rows are too far apart, power may have been missed as well, and what was learned below
//! the description has an interval that includes it.
//!
//! ```text
//! fall = -dv/dt - g/γ dh/dx        over 10 s that end 4 s before the brake is seen, N/kg
//! doubt = median over the stops of (median over the runs of fall / r(v)) - 1, where that is no chance
//! ```

use super::vehicle::{MANY_HOPS, named};
use crate::report::resistance::Resistance;
use crate::report::taught_mps;
use rundown::estimator::Estimator;
use rundown::estimator::config::Mode;
use rundown::filter::gaussian::Gaussian;
use rundown::model::direction::Direction;
use rundown::model::effects::Effects;
use rundown::tick::measurement::Measurement;
use rundown::tick::published::{FORGOTTEN_SHARE, sds};
use rundown_check::figure::HALF_95;
use rundown_files::replay::ReplayedRun;
use rundown_files::statistics::{Pairs, mean_median, mean_of, sd_of_median, spread};
use rundown_wire::Learned;
use std::collections::{BTreeMap, VecDeque};

/// Runs that are remembered, as many as a vehicle's share of short hops is a mean of.
const RUNS: usize = 32;
/// A train that is slower stands, m/s: below what is read in whole km/h.
const STANDS_MPS: f64 = 0.5 / 3.6;
/// Over so long the speed shows a brake, s ...
const BRAKE_SEEN_S: f64 = 4.0;
/// ... that is stronger than this, N/kg: twice what the resistance of a fast train is, and less than a first step of
/// the brake.
const BRAKE_N_PER_KG: f64 = 0.12;
/// A brake is seen so much later than it is applied, s: it builds up within 2 to 3 s.
const CUT_S: f64 = 4.0;
/// Length of a fall, s: short hops have coasts of 10 s and more.
const FALL_S: f64 = 10.0;
/// Rows farther apart say nothing of so short a fall, s.
const LONGEST_STEP_S: f64 = 2.0;
/// Times are equal but for the rounding of the numbers, s.
const ROUNDING_S: f64 = 1e-6;
/// A fall by a larger share of r is braked, one by a smaller one powered.
const COASTED: std::ops::Range<f64> = 0.25..2.0;
/// Stops that are less far apart are one, m: a train does not halt at the same metre.
const ONE_STOP_M: f64 = 200.0;
/// Fewer stops say nothing: errors of a gradient are alike at each.
const LEAST_STOPS: usize = 6;

/// The last seconds before a brake.
#[derive(Clone, Copy, Debug)]
struct Fall {
    direction: Direction,
    stop_m: f64,
    speed_mps: f64,
    fall_n_per_kg: f64,
}

/// What a unit does before its brakes.
#[derive(Clone, Debug, Default)]
struct UnitFalls {
    /// Of the last runs.
    falls: VecDeque<Vec<Fall>>,
    /// What is missing in r, share of it, after the last of them.
    found: Option<Missing>,
}

/// What is, or may be, missing in a learned resistance.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Missing {
    /// Standard deviation, share of it.
    share: f64,
    /// Those that show it; none where nothing would.
    stops: usize,
}

/// The units, as their runs come.
#[derive(Debug, Default)]
pub struct BeforeBrakes {
    units: BTreeMap<String, UnitFalls>,
}

impl BeforeBrakes {
    /// Gives what these runs taught the doubt that belongs to it. Each run is judged by those before it and itself;
    /// `carried`: what a unit learned in them, too. Where effects act, falls have them in them, and nothing is said; a
    /// run that `has_own` description is not judged either.
    pub fn judge(
        &mut self,
        estimator: &Estimator,
        carried: bool,
        has_own: impl Fn(&str) -> bool,
        runs: &mut [ReplayedRun],
    ) {
        if estimator.config().mode == Mode::Paper || *estimator.effects() != Effects::NONE {
            return;
        }
        for run in runs.iter_mut().filter(|run| !has_own(&run.name)) {
            let unit = self.units.entry(run.unit.clone()).or_default();
            if !carried {
                unit.falls.clear();
            } else if let Some(missing) = unit.found {
                widen(&mut run.vehicle_before, missing.share);
            }
            if run.is_used {
                unit.take(falls(estimator, run));
            }
            let is_unseen = unit.falls.iter().all(Vec::is_empty);
            let found = match run.hops_share >= MANY_HOPS {
                true if is_unseen => unseen(estimator, run),
                true => missing(&unit.falls, &run.vehicle_after),
                false => None,
            };
            // What is said of runs that stand alone is said of any of them.
            unit.found = if carried { found } else { found.or(unit.found) };
            if let Some(missing) = found {
                widen(&mut run.vehicle_after, missing.share);
                widen(&mut run.summary.run_davis, missing.share);
                withhold_if_unknown(estimator, run);
            }
        }
    }

    /// What is to be said of the units after their last runs.
    pub fn notes(&self) -> Vec<String> {
        let note = |(unit, UnitFalls { found, .. }): (&String, &UnitFalls)| {
            let Missing { share, stops } = (*found)?;
            if stops == 0 {
                return Some(format!(
                    "{}: rows are too far apart to see whether trains coast before their brakes as short hops have taught \
                     it: coasts that taught it may have had power in them, and the interval of r(v) has ± {:.0} % for that, \
                     as far as the description",
                    named(unit),
                    100.0 * HALF_95 * share
                ));
            }
            Some(format!(
                "{}: before the brakes at {stops} stops speeds fall by {:.0} % more than by the learned \
                 resistance: coasts that taught it may have had power in them, weaker than the resistance, or the brakes \
                 drag there, or the gradients are others; the interval of r(v) has ± {:.0} % for that",
                named(unit),
                100.0 * share,
                100.0 * HALF_95 * share
            ))
        };
        self.units.iter().filter_map(note).collect()
    }
}

impl UnitFalls {
    fn take(&mut self, falls: Vec<Fall>) {
        if self.falls.len() == RUNS {
            self.falls.pop_front();
        }
        self.falls.push_back(falls);
    }
}

fn widen(davis: &mut Gaussian<3>, share: f64) {
    davis.covariance += davis.mean * davis.mean.transpose() * (share * share);
}

/// What is hardly known once it is doubted is not published.
pub(super) fn withhold_if_unknown(estimator: &Estimator, run: &mut ReplayedRun) {
    if run.learned == Learned::Learned && !is_published(estimator, &run.vehicle_after) {
        run.learned = Learned::NotYet;
    }
}

/// As a vehicle is published that was published before.
fn is_published(estimator: &Estimator, davis: &Gaussian<3>) -> bool {
    let described = sds(&estimator.new_vehicle().davis());
    sds(davis).into_iter().zip(described).any(|(sd, described)| sd < FORGOTTEN_SHARE * described)
}

/// What the learned resistance is below the described one, at the speeds that taught it, as half of an interval.
fn unseen(estimator: &Estimator, run: &ReplayedRun) -> Option<Missing> {
    let taught_mps = taught_mps(core::slice::from_ref(run))?;
    let speed_mps = 0.5 * (taught_mps.start + taught_mps.end);
    let described = estimator.train().davis().resistance_n_per_kg(speed_mps);
    let share = (described / Resistance::at(&run.vehicle_after, speed_mps)?.mean_n_per_kg - 1.0) / HALF_95;
    (share > 0.0).then_some(Missing { share, stops: 0 })
}

/// By which share of itself the learned resistance is less than what falls before brakes say; none where that may be
/// chance, by the interval of both.
fn missing(falls: &VecDeque<Vec<Fall>>, davis: &Gaussian<3>) -> Option<Missing> {
    let mut ratios = Vec::new();
    for fall in falls.iter().flatten() {
        let ratio = fall.fall_n_per_kg / Resistance::at(davis, fall.speed_mps)?.mean_n_per_kg;
        if COASTED.contains(&ratio) {
            ratios.push((*fall, ratio));
        }
    }
    let along = |fall: &Fall| (fall.direction == Direction::Down, fall.stop_m);
    ratios.sort_by(|(a, _), (b, _)| {
        let ((a_down, a_m), (b_down, b_m)) = (along(a), along(b));
        a_down.cmp(&b_down).then(a_m.total_cmp(&b_m))
    });
    let is_one = |a: &Fall, b: &Fall| a.direction == b.direction && b.stop_m - a.stop_m < ONE_STOP_M;
    let of_stops = ratios.chunk_by(|(a, _), (b, _)| is_one(a, b));
    let of_stops: Vec<f64> =
        of_stops.filter_map(|of_one| mean_median(of_one.iter().map(|(_, ratio)| *ratio))).collect();
    let (stops, middle) = (of_stops.len(), mean_median(&of_stops)?);
    let speed_mps = mean_median(ratios.iter().map(|(fall, _)| fall.speed_mps))?;
    let learned = Resistance::at(davis, speed_mps)?;
    let error = sd_of_median(spread(of_stops.iter().map(|ratio| ratio - middle)), stops);
    let share = middle - 1.0;
    let chance = HALF_95 * (learned.sd_n_per_kg / learned.mean_n_per_kg).hypot(error);
    (stops >= LEAST_STOPS && share > chance).then_some(Missing { share, stops })
}

/// The falls before the stops of a run.
fn falls(estimator: &Estimator, run: &ReplayedRun) -> Vec<Fall> {
    let least = estimator.config().short_hops.min_resistance_n_per_kg;
    let described = estimator.train().davis();
    let rows: Vec<Row> = run.measurements.iter().filter_map(Row::of).collect();
    let stops = (1..rows.len()).filter(|at| rows[*at].speed_mps < STANDS_MPS && rows[at - 1].speed_mps >= STANDS_MPS);
    let of_stop = |at: usize| {
        let since = rows[..at].iter().rposition(|row| row.speed_mps < STANDS_MPS).map_or(0, |stood| stood + 1);
        let hop = &rows[since..at];
        let until =
            hop.len() - hop.iter().rev().position(|row| described.resistance_n_per_kg(row.speed_mps) > least)?;
        let before = before_brake(&hop[..until], |rows| fall_n_per_kg(estimator, run.direction, rows))?;
        let fall_n_per_kg = fall_n_per_kg(estimator, run.direction, before)?;
        let speed_mps = mean_of(before.iter().map(|row| row.speed_mps));
        Some(Fall { direction: run.direction, stop_m: rows[at].location_m, speed_mps, fall_n_per_kg })
    };
    stops.filter_map(of_stop).collect()
}

/// A row with both readings.
#[derive(Clone, Copy)]
struct Row {
    time_s: f64,
    location_m: f64,
    speed_mps: f64,
}

impl Row {
    fn of(measurement: &Measurement) -> Option<Self> {
        let Measurement { time_s, location_m, speed_mps, .. } = *measurement;
        Some(Self { time_s, location_m: location_m?, speed_mps: speed_mps? })
    }
}

/// The last rows before the last brake, as long as a fall.
fn before_brake(rows: &[Row], fall_n_per_kg: impl Fn(&[Row]) -> Option<f64>) -> Option<&[Row]> {
    let span = |end_s: f64, seconds: f64| {
        let first = rows.partition_point(|row| row.time_s < end_s - seconds - ROUNDING_S);
        let end = rows.partition_point(|row| row.time_s <= end_s + ROUNDING_S);
        &rows[first..end]
    };
    // What nobody knows may be a brake.
    let is_braked = |row: &&Row| fall_n_per_kg(span(row.time_s, BRAKE_SEEN_S)).is_none_or(|fall| fall > BRAKE_N_PER_KG);
    let unbraked = rows.iter().rev().find(|row| !is_braked(row))?;
    let before = span(unbraked.time_s - CUT_S, FALL_S);
    let is_whole = before.last()?.time_s - before.first()?.time_s > FALL_S - LONGEST_STEP_S;
    let is_dense = before.windows(2).all(|pair| pair[1].time_s - pair[0].time_s <= LONGEST_STEP_S + ROUNDING_S);
    (is_whole && is_dense).then_some(before)
}

/// By how much the speed falls, but for the slopes; of three rows and more.
fn fall_n_per_kg(estimator: &Estimator, direction: Direction, rows: &[Row]) -> Option<f64> {
    let [first, .., last] = rows else { return None };
    let speeds: Vec<(f64, f64)> = rows.iter().map(|row| (row.time_s, row.speed_mps)).collect();
    let train = estimator.train();
    let height_m = |row: &Row| {
        estimator.track().height_integral_m2(row.location_m, train.length_m(), direction) / train.length_m()
    };
    let way_m = direction.sign() * (last.location_m - first.location_m);
    let climb = train.gravity_n_per_kg() * (height_m(last) - height_m(first)) / way_m;
    (rows.len() > 2 && way_m > 0.0).then(|| -Pairs::of(&speeds).slope() - climb)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rundown::estimator::config::Config;
    use rundown::model::resistance::Davis;
    use rundown::model::track::{Gradient, Track};
    use rundown::model::train::{Train, TrainDescription};
    use rundown_files::recording::Recording;
    use rundown_files::replay::{Tick, replay_carried_by};
    use rundown_files::sample::Sample;

    const TRAIN: Davis = Davis { r0: 0.0145, r1: 3.5e-4, r2: 2.4e-5 };
    const STOPS_M: [f64; 10] =
        [500.0, 3200.0, 6500.0, 9300.0, 12_400.0, 15_800.0, 18_500.0, 21_700.0, 24_900.0, 27_900.0];
    const STEP_S: f64 = 0.1;

    fn estimator() -> Estimator {
        let described = TrainDescription {
            mass_kg: 120e3,
            rotating_mass_factor: 1.08,
            length_m: 70.0,
            davis: TRAIN,
            max_tractive_effort_n: 110e3,
            max_power_w: 1.5e6,
            max_brake_mps2: 1.1,
        };
        let track = Track::try_new(28_500.0, [Gradient { from_m: 0.0, permille: 0.0 }]).unwrap();
        Estimator::try_new(Config::default(), Train::try_new(described).unwrap(), track).unwrap()
    }

    /// A run that holds its speed by turns of 4 s of coasting and of power of so large a share of the resistance,
    /// coasts for 20 s or so, and brakes; speeds in tenths of a km/h each second.
    fn recording(run: u32, power_share: f64) -> Recording {
        let drawn = f64::from(run * 7 % 20) / 20.0;
        let held_mps = (94.0 + 6.0 * drawn) / 3.6;
        let (brake_mps2, coast_s) = (0.6 + 0.2 * drawn, 17.0 + 6.0 * drawn);
        let mut rows = Vec::new();
        let (mut x, mut v, mut tick) = (STOPS_M[0], 0.0_f64, 0_u32);
        let mut take = |x: f64, v: f64| {
            if tick.is_multiple_of(10) {
                let read = |value: f64, step: f64| Some((value / step).round() * step);
                let (location_m, speed_mps) = (read(x, 1.0), read(3.6 * v, 0.1).map(|kmh| kmh / 3.6));
                let time_s = f64::from(tick) * STEP_S;
                rows.push(Sample { time_s, location_m, speed_mps, ..Sample::default() });
            }
            tick += 1;
        };
        for stop_m in &STOPS_M[1..] {
            for _ in 0..300 {
                take(x, 0.0);
            }
            let mut held_s = None;
            while x < *stop_m - 0.3 && (v > 0.3 || held_s.is_none()) {
                let r = TRAIN.resistance_n_per_kg(v);
                let left_m = *stop_m - x;
                held_s = held_s.map(|held_s| held_s + STEP_S).or((v >= held_mps).then_some(0.0));
                let coasts = left_m < v * coast_s + v * v / (2.0 * brake_mps2);
                let accelerates = if left_m < v * v / (2.0 * brake_mps2) {
                    -v * v / (2.0 * left_m)
                } else {
                    match held_s {
                        None => 0.8,
                        Some(held_s) if coasts || held_s % 8.0 < 4.0 => -r,
                        Some(_) => (power_share - 1.0) * r,
                    }
                };
                v = (v + STEP_S * accelerates).max(0.0);
                x += STEP_S * v;
                take(x, v);
            }
            v = 0.0;
            take(x, v);
        }
        Recording { name: format!("run{run}"), rows, ..Recording::default() }
    }

    /// The runs of a train that holds its speed with such a power, and what is said of them.
    fn judged(power_share: f64) -> (Vec<ReplayedRun>, Vec<ReplayedRun>, Vec<String>) {
        let estimator = estimator();
        let recordings: Vec<Recording> = (0..20).map(|run| recording(run, power_share)).collect();
        let runs = replay_carried_by(&|_| &estimator, &recordings, Tick::EverySample, || ());
        let mut judged = runs.clone();
        let mut before_brakes = BeforeBrakes::default();
        before_brakes.judge(&estimator, true, |_| false, &mut judged);
        (runs, judged, before_brakes.notes())
    }

    /// True resistance at 90 km/h less the ends of its interval, over the truth: below and above.
    fn ends(run: &ReplayedRun) -> [f64; 2] {
        let r = TRAIN.resistance_n_per_kg(25.0);
        let found = Resistance::at(&run.vehicle_after, 25.0).unwrap();
        [found.lower() / r - 1.0, found.upper() / r - 1.0]
    }

    #[test]
    fn power_weaker_than_the_resistance_is_not_silently_missing_in_it() {
        let (runs, judged, notes) = judged(0.7);
        let (before, after) = (runs.last().unwrap(), judged.last().unwrap());
        assert!(before.learned == Learned::Learned && ends(before)[1] < -0.1, "{:?}", ends(before));
        assert!(ends(after)[0] < 0.0 && ends(after)[1] > 0.0, "{:?}", ends(after));
        assert_eq!(after.learned, Learned::NotYet);
        assert_eq!(after.vehicle_after.mean, before.vehicle_after.mean);
        assert!(matches!(&notes[..], [note] if note.contains("the brakes at 9 stops")), "{notes:?}");
    }

    #[test]
    fn where_rows_are_too_far_apart_to_see_it_the_interval_holds_the_description() {
        let estimator = estimator();
        let thin = |run| {
            let recording = recording(run, 0.7);
            Recording { rows: recording.rows.into_iter().step_by(5).collect(), ..recording }
        };
        let recordings: Vec<Recording> = (0..20).map(thin).collect();
        let runs = replay_carried_by(&|_| &estimator, &recordings, Tick::EverySample, || ());
        let (mut judged, mut before_brakes) = (runs.clone(), BeforeBrakes::default());
        before_brakes.judge(&estimator, true, |_| false, &mut judged);
        let (before, after) = (runs.last().unwrap(), judged.last().unwrap());
        assert!(before.hops_share >= MANY_HOPS && ends(before)[1] < 0.0, "{:?}", ends(before));
        assert!(ends(after)[1] > -0.01, "{:?}", ends(after));
        let notes = before_brakes.notes();
        assert!(matches!(&notes[..], [note] if note.contains("rows are too far apart to see")), "{notes:?}");
    }

    #[test]
    fn speeds_held_by_strong_power_leave_the_interval_as_it_is() {
        let (runs, judged, notes) = judged(3.0);
        let (before, after) = (runs.last().unwrap(), judged.last().unwrap());
        assert_eq!(after.vehicle_after, before.vehicle_after);
        assert_eq!(after.learned, Learned::Learned);
        assert_eq!(notes, Vec::<String>::new());
    }

    #[test]
    fn a_slope_is_no_fall_whichever_way_the_train_goes() {
        let hill = [Gradient { from_m: 0.0, permille: 0.0 }, Gradient { from_m: 2000.0, permille: 8.0 }];
        let level = estimator();
        let track = Track::try_new(28_500.0, hill).unwrap();
        let estimator = Estimator::try_new(Config::default(), *level.train(), track).unwrap();
        let rises_n_per_kg = estimator.train().gravity_n_per_kg() * 8e-3;
        for (direction, way, climbs_n_per_kg) in
            [(Direction::Up, 1.0, rises_n_per_kg), (Direction::Down, -1.0, -rises_n_per_kg)]
        {
            let falls_mps2 = 0.03 + climbs_n_per_kg;
            let row = |second: u32| {
                let t = f64::from(second);
                let location_m = 8000.0 + way * (20.0 * t - 0.5 * falls_mps2 * t * t);
                Row { time_s: t, location_m, speed_mps: 20.0 - falls_mps2 * t }
            };
            let rows: Vec<Row> = (0..=10).map(row).collect();
            let fall = fall_n_per_kg(&estimator, direction, &rows).unwrap();
            assert!((fall - 0.03).abs() < 1e-6, "{direction:?}: {fall}");
        }
    }

    #[test]
    fn rows_two_seconds_apart_show_a_fall_and_rows_farther_apart_none() {
        let of = |step_s: f64, is_read: &dyn Fn(f64) -> bool| {
            let mps = |time_s: f64| 20.0 - 0.03 * time_s.min(30.0) - 0.5 * (time_s - 30.0).max(0.0);
            let row = |index: u32| {
                // As a clock with decimals shows it.
                let time_s = 0.1 + step_s * f64::from(index);
                Row { time_s, location_m: 20.0 * time_s, speed_mps: mps(time_s) }
            };
            let rows: Vec<Row> = (0..).map(row).take_while(|row| row.time_s < 50.0).collect();
            let rows: Vec<Row> = rows.into_iter().filter(|row| is_read(row.time_s)).collect();
            let fall = |rows: &[Row]| {
                let [first, _, .., last] = rows else { return None };
                Some((first.speed_mps - last.speed_mps) / (last.time_s - first.time_s))
            };
            before_brake(&rows, fall).and_then(fall)
        };
        for step_s in [1.0, 2.0] {
            let found = of(step_s, &|_| true);
            assert!(found.is_some_and(|fall| (fall - 0.03).abs() < 1e-9), "{step_s}: {found:?}");
        }
        assert_eq!(of(3.0, &|_| true), None);
        assert_eq!(of(1.0, &|time_s| !(20.5..22.5).contains(&time_s)), None, "a hole of 3 s");
    }

    #[test]
    fn runs_that_stand_alone_are_judged_alone_and_said() {
        let estimator = estimator();
        let recordings: Vec<Recording> = (0..4).map(|run| recording(run, 0.7)).collect();
        let runs = replay_carried_by(&|_| &estimator, &recordings, Tick::EverySample, || ());
        let of = |has_own: &dyn Fn(&str) -> bool| {
            let (mut judged, mut before_brakes) = (runs.clone(), BeforeBrakes::default());
            before_brakes.judge(&estimator, false, has_own, &mut judged);
            let befores = judged.iter().zip(&runs).all(|(now, then)| now.vehicle_before == then.vehicle_before);
            assert!(befores, "no run knows of another");
            assert!(before_brakes.units.values().all(|unit| unit.falls.len() == 1), "nor is judged by another");
            let doubted = judged.iter().zip(&runs).filter(|(now, then)| now.vehicle_after != then.vehicle_after);
            (doubted.count() > 0, before_brakes.notes().len())
        };
        assert_eq!(of(&|_| false), (true, 1));
        assert_eq!(of(&|_| true), (false, 0));
    }

    /// What is missing where the falls are so many times those of the described train, at each of so many stops.
    fn missing_at(ratios: impl IntoIterator<Item = f64>) -> Option<Missing> {
        let davis = Gaussian::independent([TRAIN.r0, TRAIN.r1, TRAIN.r2], [1e-3, 0.0, 0.0]);
        let fall = |(stop, ratio): (usize, f64)| Fall {
            direction: Direction::Up,
            stop_m: 1000.0 * stop as f64,
            speed_mps: 25.0,
            fall_n_per_kg: ratio * TRAIN.resistance_n_per_kg(25.0),
        };
        missing(&VecDeque::from([ratios.into_iter().enumerate().map(fall).collect()]), &davis)
    }

    #[test]
    fn only_steeper_falls_alike_at_most_stops_say_that_something_is_missing() {
        let found = missing_at([1.2; 6]).unwrap();
        assert!((found.share - 0.2).abs() < 1e-9 && found.stops == 6, "{found:?}");
        assert_eq!(missing_at([0.8; 6]), None, "powered up to the brake");
        assert_eq!(missing_at([1.2; 5]), None, "few stops");
        assert_eq!(missing_at([1.04; 6]), None, "within the interval");
        assert_eq!(missing_at([0.6, 1.0, 1.4, 0.5, 1.8, 1.3]), None, "chance");
        assert_eq!(missing_at([3.0; 6]), None, "brakes");
    }
}
