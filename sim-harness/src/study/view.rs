//! One run through one pair of eyes: what the estimator in one mode says of it, or what was true.
//!
//! The same quantities whoever looks, so that a table can set them side by side: [`ViewOutcome`] is the run in a few
//! numbers, [`Points`] is what the figures draw.

use super::{case::CaseTruth, moments::Moments, visible};
use crate::accuracy_bench::score::regime;
use rundown::filter::ukf::Reading;
use rundown::tick::measurement::Measurement;
use rundown::{model::state, model::train::Train, tick::estimate::Estimate, tick::regime::Regime};
use rundown_files::column::Column;
use rundown_files::replay::ReplayedRun;
use rundown_files::statistics::{mean, mean_median};
use rundown_pages::numbers::counted;
use rundown_truth::regime::Regime as TrueRegime;
use rundown_truth::sensors::TruthSample;
use std::ops::RangeInclusive;
use std::sync::LazyLock;

/// Steps of ATB-EG, km/h, from the fastest (section 3.3).
pub const ATB_STEPS_KMH: [f64; 4] = [130.0, 80.0, 60.0, 40.0];
pub const ATB_NAMES: [&str; 5] = ["above_130", "130_to_80", "80_to_60", "60_to_40", "below_40"];
/// Speeds of the red crosses of Fig. 9, km/h.
pub const CROSS_KMH: RangeInclusive<f64> = 50.0..=90.0;
/// A largest power that a person may use is the largest of means over this time, s. Over 10 s a reading in whole km/h
/// is off by 4 % of the power, and the largest of several such is 10 % too large; over three times as long the readings
/// between cancel out. The paper's is that of single intervals.
const LARGEST_OVER_S: f64 = 30.0;
/// A clock that is a little fast makes no shorter time, s.
const SAME_TIME_S: f64 = 2.0;
/// Window of the largest power, km/h (section 3.3): near 140 km/h the driver lets go.
pub const POWER_KMH: RangeInclusive<f64> = 50.0..=130.0;
/// Where the two clouds of Fig. 9 part, km/h.
pub const CLOUDS_KMH: f64 = 115.0;
/// A slower loss of speed is no braking, m/s² (section 3.2): a hold at 40 km/h between two brakes is not counted as
/// one.
const LEAST_BRAKE_MPS2: f64 = 0.06;
/// Speeds at which the decelerations of coasting trains are compared, km/h.
pub const COASTING_KMH: RangeInclusive<f64> = 100.0..=120.0;
/// The first acceleration is over after so many samples without traction above [`OVER_KMH`]; one may be misjudged.
const OVER_SAMPLES: usize = 2;
/// Slower, the train may hold the speed of the departure zone, km/h.
const OVER_KMH: f64 = 50.0;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct ViewOutcome {
    /// Median of the speeds held at the fastest level.
    pub cruise_kmh: Option<f64>,
    /// Plain median of the filtered speeds of all cruising, as section 3.3 takes it; as it was: the speed that was to
    /// be kept.
    pub plain_cruise_kmh: Option<f64>,
    /// Mean brake rate of each ATB-EG step, the statistic of section 3.3, m/s².
    pub brake_steps_mps2: [Option<f64>; 5],
    /// Largest brake rate between two samples, m/s².
    pub largest_brake_mps2: Option<f64>,
    pub coast_s: Option<f64>,
    pub brake_s: Option<f64>,
    /// Share of the running time in traction, cruise, coast and brake; standing time is no running time.
    pub shares: Option<[f64; 4]>,
    /// Mean tractive power, 50 to 130 km/h, kW.
    pub power_kw: Option<f64>,
    /// Largest tractive power of the first acceleration, 50 to 90 km/h, kW: as found, of means over [`LARGEST_OVER_S`];
    /// as it was, at any time.
    pub max_power_kw: Option<f64>,
    /// A red cross of Fig. 9: the largest power of a single interval of the first acceleration, 50 to 90 km/h, kW; as
    /// it was, at any time.
    pub cross_kw: Option<f64>,
    /// Mean deceleration while coasting at [`COASTING_KMH`], m/s².
    pub coast_mps2: Option<f64>,
    /// Intervals that say something of the largest tractive effort at low speed.
    pub effort_samples: Option<f64>,
    pub davis: [f64; 3],
    /// Root mean square of filtered less measured speed, km/h.
    pub speed_rms_kmh: Option<f64>,
    /// The first acceleration has power below the manufacturer's up to [`CLOUDS_KMH`] and above it at higher speeds.
    pub in_both_clouds: Option<bool>,
    /// Share of the time in which the resistance was learned.
    pub learned_share: Option<f64>,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points {
    pub davis: Vec<[f64; 3]>,
    /// Speed in km/h and brake rate in m/s² of each interval of braking.
    pub brake: Vec<(f64, f64)>,
    /// Brake rates of the first and of the last interval of the last brake above 40 km/h that are brake throughout,
    /// m/s².
    pub first_and_last_brake_mps2: Option<[f64; 2]>,
    /// Speed in km/h, power in kW and location in m of each interval of the first acceleration.
    pub power: Vec<PowerPoint>,
    /// Time in s and regime of each sample.
    pub regimes: Vec<(f64, Regime)>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerPoint {
    pub speed_kmh: f64,
    /// kW, at the wheel.
    pub power_kw: f64,
    pub location_m: f64,
    pub dt_s: f64,
    /// The interval before it is a point, too.
    pub follows: bool,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Seen {
    pub outcome: ViewOutcome,
    pub points: Points,
}

/// What is drawn of the time between two samples, whoever looks.
struct Interval {
    dt_s: f64,
    /// Mean, m/s.
    speed_mps: f64,
    /// Loss of speed, m/s²; none where it is not known.
    rate_mps2: Option<f64>,
    /// None where it changes.
    regime: Option<Regime>,
    /// It ends in traction.
    is_traction: bool,
    effort_n_per_kg: Option<f64>,
    location_m: f64,
}

impl Points {
    /// With the mean deceleration while coasting; `kw` is the power of 1 W/kg. `in_part`: so many intervals at each end
    /// of a brake may be brake in part.
    fn of(
        davis: Vec<[f64; 3]>,
        intervals: impl Iterator<Item = Interval>,
        kw: f64,
        in_part: usize,
    ) -> (Self, Option<f64>) {
        let mut points = Self { davis, ..Self::default() };
        let mut first = FirstAcceleration::default();
        let mut coasting = Moments::default();
        let mut follows = false;
        let mut brakes = vec![];
        for interval in intervals {
            let Interval { dt_s, speed_mps, location_m, .. } = interval;
            let speed_kmh = 3.6 * speed_mps;
            let rate_mps2 = interval.rate_mps2.filter(|rate_mps2| *rate_mps2 >= LEAST_BRAKE_MPS2);
            let brake = rate_mps2.filter(|_| interval.regime == Some(Regime::Brake));
            brakes.push(brake.map(|rate_mps2| (speed_kmh, rate_mps2)));
            if interval.regime == Some(Regime::Coast)
                && COASTING_KMH.contains(&speed_kmh)
                && let Some(rate_mps2) = interval.rate_mps2
            {
                coasting.add(rate_mps2);
            }
            let is_first = first.goes_on(interval.is_traction, speed_kmh);
            let effort = interval.effort_n_per_kg.filter(|_| is_first && interval.regime == Some(Regime::Traction));
            if let Some(effort_n_per_kg) = effort {
                let power_kw = kw * effort_n_per_kg * speed_mps;
                points.power.push(PowerPoint { speed_kmh, power_kw, location_m, dt_s, follows });
            }
            follows = effort.is_some();
        }
        points.first_and_last_brake_mps2 = first_and_last(&brakes, in_part);
        points.brake = brakes.into_iter().flatten().collect();
        (points, coasting.mean())
    }
}

impl Seen {
    pub fn of_replay(run: &ReplayedRun, train: &Train) -> Self {
        let features = &run.summary.features;
        let kw = train.rotating_mass_kg() / 1000.0;
        let speed_mps = |estimate: &Estimate| estimate.belief.mean[state::SPEED];
        let interval = |(index, pair): (usize, &[Estimate])| {
            let (before, now) = (&pair[0], &pair[1]);
            let regime = run.regimes.get(index + 1).copied().unwrap_or(now.regime);
            Interval {
                dt_s: now.dt_s,
                speed_mps: 0.5 * (speed_mps(now) + speed_mps(before)),
                rate_mps2: now.acceleration_mps2.map(|acceleration_mps2| -acceleration_mps2),
                regime: Some(regime),
                is_traction: regime == Regime::Traction,
                effort_n_per_kg: now.effort_n_per_kg,
                location_m: now.belief.mean[state::LOCATION],
            }
        };
        let davis = run.estimates.iter().map(|estimate| estimate.belief.mean);
        let davis = davis.map(|mean| [mean[state::R0], mean[state::R1], mean[state::R2]]).collect();
        let (mut points, coast_mps2) = Points::of(davis, run.estimates.windows(2).enumerate().map(interval), kw, 1);
        let times_s = run.estimates.iter().map(|estimate| estimate.time_s);
        points.regimes = times_s.zip(run.regimes.iter().copied()).collect();
        let moving = |regime: Regime| features.regime_time_s[regime as usize];
        let regimes = run.estimates.iter().zip(&run.regimes);
        let cruising = regimes.filter(|(_, regime)| **regime == Regime::Cruise).map(|(estimate, _)| estimate);
        let davis = &run.summary.run_davis.mean;
        let braking = run.estimates.iter().zip(&run.regimes).filter(|(_, regime)| **regime == Regime::Brake);
        let rates_mps2 = braking.filter_map(|(estimate, _)| estimate.acceleration_mps2).map(|rate_mps2| -rate_mps2);
        let of = |phase: &Option<rundown::features::Phase>| phase.as_ref().map(|p| p.duration_s);
        let duration_s: f64 = run.estimates.iter().map(|estimate| estimate.dt_s).sum();
        let learned_s = run.estimates.iter().filter(|estimate| estimate.learning).map(|estimate| estimate.dt_s);
        let outcome = ViewOutcome {
            cruise_kmh: features.cruise_speed_median_mps.map(|v| 3.6 * v),
            plain_cruise_kmh: mean_median(cruising.map(|estimate| 3.6 * speed_mps(estimate))),
            brake_steps_mps2: features.brake_rate_mps2.each_ref().map(|step| (step.count > 0).then_some(step.mean)),
            largest_brake_mps2: rates_mps2.reduce(f64::max),
            coast_s: of(&features.final_coast),
            brake_s: of(&features.final_brake),
            shares: shares([Regime::Traction, Regime::Cruise, Regime::Coast, Regime::Brake].map(moving)),
            power_kw: (features.power_w_per_kg.count > 0).then_some(kw * features.power_w_per_kg.mean),
            max_power_kw: largest_mean(&points.power, &CROSS_KMH).map(|point| point.power_kw),
            cross_kw: largest(&points.power, &CROSS_KMH).map(|point| point.power_kw),
            in_both_clouds: in_both_clouds(&points.power, train),
            coast_mps2,
            effort_samples: Some(f64::from(features.max_effort.as_ref().map_or(0, |line| line.effort.count))),
            davis: [davis[0], davis[1], davis[2]],
            speed_rms_kmh: speed_rms_kmh(run),
            learned_share: (duration_s > 0.0).then(|| learned_s.fold(0.0, |sum, dt_s| sum + dt_s) / duration_s),
        };
        Self { outcome, points }
    }

    /// With what the filter says, as it is of a replay of other readings of the same run.
    pub fn with_filter(mut self, filter: Self) -> Self {
        self.points.davis = filter.points.davis;
        let ViewOutcome { davis, speed_rms_kmh, learned_share, .. } = filter.outcome;
        self.outcome = ViewOutcome { davis, speed_rms_kmh, learned_share, ..self.outcome };
        self
    }

    /// What was true, at the times of the samples.
    pub fn of_truth(truth: &CaseTruth, described: &Train) -> Self {
        let facts = &truth.facts;
        let davis = [facts.davis.r0, facts.davis.r1, facts.davis.r2];
        let kw = facts.rotating_mass_kg / 1000.0;
        let interval = |pair: &[TruthSample]| {
            let (before, now) = (&pair[0], &pair[1]);
            let dt_s = now.time_s - before.time_s;
            Interval {
                dt_s,
                speed_mps: 0.5 * (before.speed_mps + now.speed_mps),
                rate_mps2: Some((before.speed_mps - now.speed_mps) / dt_s),
                // An interval is of one regime where it is that at both ends.
                regime: (before.regime == now.regime).then(|| regime(now.regime)),
                is_traction: now.regime == TrueRegime::Traction,
                effort_n_per_kg: Some(now.mean_effort_n_per_kg),
                location_m: now.location_m,
            }
        };
        let (mut points, coast_mps2) =
            Points::of(vec![davis; truth.samples.len()], truth.samples.windows(2).map(interval), kw, 0);
        points.regimes = truth.samples.iter().map(|sample| (sample.time_s, regime(sample.regime))).collect();
        let rate_mps2 =
            |pair: &[TruthSample]| (pair[0].speed_mps - pair[1].speed_mps) / (pair[1].time_s - pair[0].time_s);
        let mut times_s = [0.0; 5];
        for pair in truth.samples.windows(2) {
            times_s[regime(pair[1].regime) as usize] += pair[1].time_s - pair[0].time_s;
        }
        let moving = |regime: Regime| times_s[regime as usize];
        let coast = facts.final_coast.as_ref();
        let outcome = ViewOutcome {
            cruise_kmh: Some(3.6 * facts.cruise_mps),
            plain_cruise_kmh: Some(3.6 * facts.cruise_mps),
            brake_steps_mps2: step_means(&points.brake),
            largest_brake_mps2: truth.samples.windows(2).map(rate_mps2).reduce(f64::max),
            coast_s: coast.map(|coast| facts.final_brake.time_s - coast.time_s),
            brake_s: Some(facts.stop.time_s - facts.final_brake.time_s),
            shares: shares([Regime::Traction, Regime::Cruise, Regime::Coast, Regime::Brake].map(moving)),
            power_kw: facts.mean_power_50_130_w_per_kg.map(|p| kw * p),
            max_power_kw: facts.max_power_50_90_w_per_kg.map(|p| kw * p),
            cross_kw: facts.max_power_50_90_w_per_kg.map(|p| kw * p),
            in_both_clouds: in_both_clouds(&points.power, described),
            coast_mps2,
            effort_samples: None,
            davis,
            speed_rms_kmh: None,
            learned_share: None,
        };
        Self { outcome, points }
    }
}

/// Root mean square of filtered less measured speed, km/h.
pub fn speed_rms_kmh(run: &ReplayedRun) -> Option<f64> {
    let pairs = run.estimates.iter().zip(&run.measurements);
    let off_kmh = pairs.filter_map(|(e, read)| Some(3.6 * (e.belief.mean[state::SPEED] - read.speed_mps?)));
    Some(mean(off_kmh.map(|off_kmh| off_kmh.powi(2)))?.sqrt())
}

/// Where the filtered speed of the paper's mode is no reading's: those that were not believed; nothing where all were.
pub fn dropped_words(paper: &ReplayedRun) -> Option<String> {
    let is_dropped = |(estimate, read): &(&Estimate, &Measurement)| {
        let of_speed = estimate.innovation.map(|innovation| innovation.readings[1]);
        read.speed_mps.is_some() && of_speed == Some(Reading::Missing)
    };
    let count = paper.estimates.iter().zip(&paper.measurements).filter(is_dropped).count();
    (count > 0).then(|| {
        let readings = counted(count, "reading of its speed was", "readings of its speed were");
        format!("{readings} dropped as impossible for a train; the effort is held until the next one, where the forward effort makes up for the speed's change in between; the backward effort never does")
    })
}

/// Decides how long the first acceleration lasts.
#[derive(Debug, Default)]
struct FirstAcceleration {
    without: usize,
}

impl FirstAcceleration {
    fn goes_on(&mut self, is_traction: bool, speed_kmh: f64) -> bool {
        if self.without < OVER_SAMPLES {
            self.without = match is_traction {
                true => 0,
                false if speed_kmh > OVER_KMH => self.without + 1,
                false => self.without,
            };
        }
        self.without < OVER_SAMPLES
    }
}

/// Of intervals in their order, none where the train does not brake.
fn first_and_last(brakes: &[Option<(f64, f64)>], in_part: usize) -> Option<[f64; 2]> {
    let of_one = |brake: &[Option<(f64, f64)>]| {
        let inner = brake.get(in_part..brake.len().saturating_sub(in_part))?.iter().flatten();
        let mut fast = inner.filter(|(speed_kmh, _)| *speed_kmh > ATB_STEPS_KMH[3]).map(|(_, rate_mps2)| *rate_mps2);
        Some([fast.next()?, fast.next_back()?])
    };
    brakes.rsplit(Option::is_none).find_map(of_one)
}

/// Mean of each ATB-EG step, of intervals of one length.
fn step_means(brake: &[(f64, f64)]) -> [Option<f64>; 5] {
    let mut steps: [Moments; 5] = Default::default();
    brake.iter().for_each(|(speed_kmh, rate_mps2)| steps[atb_step(*speed_kmh)].add(*rate_mps2));
    steps.each_ref().map(Moments::mean)
}

fn shares(times_s: [f64; 4]) -> Option<[f64; 4]> {
    let all_s: f64 = times_s.iter().sum();
    (all_s > 0.0).then(|| times_s.map(|time_s| time_s / all_s))
}

/// The point of the largest power within these speeds.
pub fn largest(points: &[PowerPoint], within_kmh: &RangeInclusive<f64>) -> Option<PowerPoint> {
    let within = points.iter().filter(|point| within_kmh.contains(&point.speed_kmh));
    within.max_by(|a, b| a.power_kw.total_cmp(&b.power_kw)).copied()
}

/// The largest mean power over [`LARGEST_OVER_S`] of points that follow each other within these speeds, as one point;
/// where none are so long, that of the longest.
fn largest_mean(points: &[PowerPoint], within_kmh: &RangeInclusive<f64>) -> Option<PowerPoint> {
    let of = |begin: usize| mean_from(&points[begin..], within_kmh);
    let key = |point: &PowerPoint| (point.dt_s.min(LARGEST_OVER_S), point.power_kw);
    (0..points.len()).filter_map(of).max_by(|a, b| {
        let (a, b) = (key(a), key(b));
        a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
    })
}

/// The first points as one, up to [`LARGEST_OVER_S`].
fn mean_from(points: &[PowerPoint], within_kmh: &RangeInclusive<f64>) -> Option<PowerPoint> {
    let first = *points.first().filter(|point| within_kmh.contains(&point.speed_kmh))?;
    let mut sum = first;
    (sum.speed_kmh, sum.power_kw) = (first.speed_kmh * first.dt_s, first.power_kw * first.dt_s);
    for point in &points[1..] {
        if sum.dt_s >= LARGEST_OVER_S - SAME_TIME_S || !point.follows || !within_kmh.contains(&point.speed_kmh) {
            break;
        }
        sum.speed_kmh += point.speed_kmh * point.dt_s;
        sum.power_kw += point.power_kw * point.dt_s;
        sum.location_m = point.location_m;
        sum.dt_s += point.dt_s;
    }
    Some(PowerPoint { speed_kmh: sum.speed_kmh / sum.dt_s, power_kw: sum.power_kw / sum.dt_s, ..sum })
}

/// `None` where one of the two ranges of speed has no point.
fn in_both_clouds(points: &[PowerPoint], described: &Train) -> Option<bool> {
    let stated_kw = described.description().max_power_w / 1000.0;
    let within = points.iter().filter(|p| POWER_KMH.contains(&p.speed_kmh));
    let (fast, slow): (Vec<&PowerPoint>, Vec<&PowerPoint>) = within.partition(|p| p.speed_kmh > CLOUDS_KMH);
    let least = slow.iter().map(|p| p.power_kw).reduce(f64::min)?;
    let most = fast.iter().map(|p| p.power_kw).reduce(f64::max)?;
    Some(visible::SHARE.sees(1.0 - least / stated_kw) && visible::SHARE.sees(most / stated_kw - 1.0))
}

/// Index of the ATB-EG step of a speed.
pub fn atb_step(speed_kmh: f64) -> usize {
    ATB_STEPS_KMH.iter().position(|edge| speed_kmh > *edge).unwrap_or(ATB_STEPS_KMH.len())
}

/// An outcome that nobody knows.
pub static NOTHING: LazyLock<ViewOutcome> =
    LazyLock::new(|| ViewOutcome { davis: [f64::NAN; 3], ..ViewOutcome::default() });

impl ViewOutcome {
    /// The columns of an outcome, each name after the prefix. `by`: who says so.
    pub fn columns(prefix: &str, by: &str) -> Vec<Column<Self>> {
        let unknown = if prefix == "true" { "the truth is not known, or has none" } else { "the run has none" };
        let column = |name: &str, unit: &'static str, meaning: &str, value: fn(&Self) -> Option<f64>| {
            let meaning = format!("{meaning}, {by}");
            Column::number(&format!("{prefix}_{name}"), unit, &meaning, value).empty_when(unknown)
        };
        let brake_step = |step: usize| {
            let name = ATB_NAMES[step];
            let meaning = format!("mean brake rate at {} km/h, {by}", name.replace('_', " "));
            let rate = move |o: &Self| o.brake_steps_mps2[step];
            Column::number(&format!("{prefix}_brake_{name}_mps2"), "m/s²", &meaning, rate).empty_when(unknown)
        };
        let mut columns = vec![
            column("cruise_kmh", "km/h", "median cruise speed", |o| o.cruise_kmh),
            column("plain_cruise_kmh", "km/h", "plain median of the speeds while cruising", |o| o.plain_cruise_kmh),
            column("final_coast_s", "s", "duration of the final coast", |o| o.coast_s),
            column("final_brake_s", "s", "duration of the final brake", |o| o.brake_s),
            column("share_traction", "1", "share of the running time in traction", |o| o.shares.map(|s| s[0])),
            column("share_cruise", "1", "share of the running time in cruise", |o| o.shares.map(|s| s[1])),
            column("share_coast", "1", "share of the running time in coast", |o| o.shares.map(|s| s[2])),
            column("share_brake", "1", "share of the running time in brake", |o| o.shares.map(|s| s[3])),
            column("power_kw", "kW", "mean tractive power from 50 to 130 km/h", |o| o.power_kw),
            column(
                "max_power_50_90_kw",
                "kW",
                "largest tractive power of the first acceleration; a mode's is a mean over 30 s",
                |o| o.max_power_kw,
            ),
            column("coasting_mps2", "m/s²", "mean deceleration of coasts from 100 to 120 km/h", |o| o.coast_mps2),
            brake_step(0),
            brake_step(1),
            brake_step(2),
            brake_step(3),
            brake_step(4),
            column("largest_brake_mps2", "m/s²", "largest brake rate between two samples", |o| o.largest_brake_mps2),
            column("r0", "N/kg", "Davis coefficient of the run's train", |o| Some(o.davis[0])),
            column("r1", "N/kg per m/s", "Davis coefficient of the run's train", |o| Some(o.davis[1])),
            column("r2", "N/kg per (m/s)²", "Davis coefficient of the run's train", |o| Some(o.davis[2])),
        ];
        if prefix != "true" {
            columns.push(column("speed_rms_kmh", "km/h", "root mean square of filtered less measured speed", |o| {
                o.speed_rms_kmh
            }));
            columns.push(column("learned_share", "1", "share of the time in which resistance was learned", |o| {
                o.learned_share
            }));
        }
        columns
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_belongs_to_the_slower_step() {
        assert_eq!([140.0, 130.0, 61.0, 40.0, 5.0].map(atb_step), [0, 1, 2, 4, 4]);
    }

    #[test]
    fn a_largest_power_that_is_used_is_no_single_reading() {
        let point = |speed_kmh: f64, power_kw: f64| PowerPoint {
            speed_kmh,
            power_kw,
            location_m: 0.0,
            dt_s: 10.0,
            follows: true,
        };
        let mut points = vec![point(45.0, 9000.0), point(55.0, 1900.0), point(65.0, 2300.0), point(75.0, 1800.0)];
        points.extend([point(85.0, 1900.0), point(95.0, 9000.0)]);
        let of =
            |points: &[PowerPoint]| largest_mean(points, &CROSS_KMH).map(|point| (point.speed_kmh, point.power_kw));
        assert_eq!(largest(&points, &CROSS_KMH).map(|cross| cross.power_kw), Some(2300.0), "but a cross of Fig. 9 is");
        // The mean of the first and of the last three within 50 to 90 km/h: both 2000 kW.
        assert_eq!(of(&points).map(|found| found.1), Some(2000.0));
        points[3].follows = false;
        assert_eq!(of(&points), Some((60.0, 2100.0)), "two and two are the longest");
        assert_eq!(of(&points[..1]), None);
    }

    #[test]
    fn a_brake_begins_and_ends_between_its_own_intervals() {
        let brake = |rates: &[f64]| -> Vec<_> { rates.iter().map(|rate| Some((90.0, *rate))).collect() };
        let of = |parts: &[Vec<Option<(f64, f64)>>]| first_and_last(&parts.join(&None), 1);
        assert_eq!(of(&[brake(&[0.1, 0.2, 0.3, 0.4, 0.1])]), Some([0.2, 0.4]));
        assert_eq!(of(&[brake(&[0.1, 0.2, 0.1])]), None, "one interval has no beginning and end");
        assert_eq!(of(&[brake(&[0.1, 0.2, 0.3, 0.1]), brake(&[0.4; 2])]), Some([0.2, 0.3]));
        let slow = vec![Some((39.0, 0.6)); 3];
        assert_eq!(of(&[[brake(&[0.1, 0.2, 0.3]), slow].concat()]), Some([0.2, 0.3]), "that is another behaviour");
        assert_eq!(first_and_last(&brake(&[0.1, 0.2]), 0), Some([0.1, 0.2]));
    }

    #[test]
    fn one_misjudged_sample_does_not_end_the_first_acceleration() {
        let mut first = FirstAcceleration::default();
        // Holding the speed of the departure zone is no end either.
        let doing = [
            (true, 20.0),
            (false, 38.0),
            (false, 39.0),
            (true, 60.0),
            (false, 90.0),
            (true, 100.0),
            (false, 120.0),
            (false, 125.0),
            (true, 130.0),
        ];
        let goes_on: Vec<bool> = doing.iter().map(|(t, v)| first.goes_on(*t, *v)).collect();
        assert_eq!(goes_on, [true, true, true, true, true, true, true, false, false]);
    }

    #[test]
    fn a_speed_that_is_dropped_is_said() {
        use crate::study::{case::case_study, description, gather::Estimators};
        use rundown_files::{recording::Recording, replay::Tick, replay::replay_apart_by, sample::Sample};
        let believed = description::of(&case_study().unwrap()).unwrap();
        let estimators = Estimators::try_new(Default::default(), believed.train, &believed.track).unwrap();
        let of = |odd_mps| {
            let row = |t: u32| Sample {
                time_s: t.into(),
                location_m: Some(5.0 * f64::from(t)),
                speed_mps: Some(if t == 20 { odd_mps } else { 5.0 }),
                ..Sample::default()
            };
            let recording = Recording { rows: (0..40).map(row).collect(), ..Recording::default() };
            dropped_words(&replay_apart_by(&|_| &estimators.paper, &[&recording], Tick::EverySample, || ())[0])
        };
        assert_eq!(of(5.5), None);
        assert!(of(12.0).is_some_and(|words| words.starts_with("1 reading of its speed was dropped")));
    }
}
