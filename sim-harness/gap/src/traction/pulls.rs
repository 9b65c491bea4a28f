//! Steady power while a train gains speed, as a share of the believed limit.

use crate::config::TractionConfig;
use crate::data::interval::Interval;
use crate::data::runs::{Readings, Run};
use rundown::model::train::Train;

/// An interval of steady power: a part of a pull.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pull {
    /// Index of its run.
    pub run: usize,
    /// Location of the front half-way, m.
    pub location_m: f64,
    /// Mean speed, m/s.
    pub speed_mps: f64,
    /// Effort over believed limit.
    pub ratio: f64,
    /// Standard deviation of the ratio.
    pub sd: f64,
    /// Largest effort over the limit at this speed: above 1 where the power limits.
    pub effort_over_limit: f64,
    /// The power is what limits, not the effort.
    pub by_power: bool,
    /// Number of the pull in its run: a driver who lets go and pulls again asks anew.
    pub number: usize,
    /// What it counts for: a driver's hand stays where it is for about 10 s, so nearer samples share one decision.
    pub weight: f64,
}

impl Pull {
    /// Enough of the limit, and away from the corner of effort and power, near which a driver who asks for less effort than power is limited by neither share.
    fn says_something(&self, config: &TractionConfig) -> bool {
        self.ratio > least_ratio(config) && !(config.by_power..config.corner).contains(&self.effort_over_limit)
    }
}

/// A ratio below this is no powering.
fn least_ratio(config: &TractionConfig) -> f64 {
    config.least_share - 0.1
}

/// Intervals of steady power of one run. `effort`: measured, or calculated from the change of speed and the model.
pub fn pulls(
    train: &Train,
    intervals: &[Interval],
    effort: &[Option<f64>],
    effort_sd: f64,
    config: &TractionConfig,
) -> Vec<Pull> {
    let read: Vec<Option<Pull>> = intervals
        .iter()
        .zip(effort)
        .map(|(interval, effort)| {
            let effort = (*effort)?;
            let limit = interval.mean(|p| train.max_effort_n_per_kg(p.speed_mps.max(0.5)));
            let most = train.max_effort_n_per_kg(0.1);
            let ratio = effort / limit;
            let pull = Pull {
                run: interval.run,
                location_m: interval.middle().location_m,
                speed_mps: interval.mean_speed_mps(),
                ratio,
                sd: (effort_sd / limit).hypot(config.sensor).hypot(
                    speed_sd_mps(config.speed_sd_mps, most / limit, config) / interval.mean_speed_mps().max(1.0),
                ),
                effort_over_limit: most / limit,
                by_power: most / limit > config.by_power,
                number: 0,
                weight: 1.0,
            };
            Some(pull)
        })
        .collect();
    let known = |(i, pull): (usize, &Option<Pull>)| Some((i, (intervals[i].begin_s, (*pull)?)));
    let (at, known): (Vec<usize>, Vec<(f64, Pull)>) = read.iter().enumerate().filter_map(known).unzip();
    let mut floating = vec![false; intervals.len()];
    for (place, i) in at.into_iter().enumerate() {
        // A calculated effort follows the rounding of the speed: nothing floats in it.
        floating[i] = effort_sd == 0.0 && floats(&known, place, config);
    }
    let ratios: Vec<Option<Pull>> = intervals
        .iter()
        .zip(read)
        .zip(&floating)
        .map(|((interval, pull), floats)| {
            let slowest = interval.speed_mps[0].min(interval.speed_mps[1]);
            let pulls = *floats || interval.acceleration_mps2() > config.least_acceleration_mps2;
            pull.filter(|pull| pulls && slowest > config.slowest_mps && pull.says_something(config))
        })
        .collect();
    // Steady: like a neighbour.
    let near = |a: &Pull, b: &Option<Pull>| {
        b.is_some_and(|b| (a.ratio - b.ratio).abs() < config.near + config.near_sd * a.sd.hypot(b.sd))
    };
    let steady = (0..ratios.len()).filter_map(|i| {
        let pull = ratios[i]?;
        let before = i > 0 && near(&pull, &ratios[i - 1]);
        let after = ratios.get(i + 1).is_some_and(|next| near(&pull, next));
        // Calculated from the change of speed, the interval in which the power is raised looks like less power.
        let raised = effort_sd > 0.0 && (i == 0 || ratios[i - 1].is_none());
        ((before || after) && !raised).then_some(Part {
            time_s: intervals[i].begin_s,
            speeds_mps: intervals[i].speed_mps,
            floats: floating[i],
            pull,
        })
    });
    numbered(steady, config)
}

/// A part of a pull with its time and the speeds around it, m/s.
struct Part {
    time_s: f64,
    speeds_mps: [f64; 2],
    /// The power stays for long while the speed floats: a limit, not a driver who has reached his speed.
    floats: bool,
    pull: Pull,
}

/// With the numbers of their pulls. A pull that gains little speed keeps a speed rather than reaching one, and says what the driver likes, not what the train gives.
fn numbered(parts: impl Iterator<Item = Part>, config: &TractionConfig) -> Vec<Pull> {
    let parts: Vec<Part> = parts.collect();
    let of_pulls = parts.chunk_by(|a, b| b.time_s - a.time_s <= config.apart_s);
    let wanted = of_pulls.filter(|parts| match parts {
        parts if parts.iter().any(|part| part.floats) => true,
        [first, .., last] => last.speeds_mps[1] - first.speeds_mps[0] > config.least_gain_mps,
        [only] => only.speeds_mps[1] - only.speeds_mps[0] > config.least_gain_mps,
        [] => false,
    });
    let numbered = wanted.enumerate().flat_map(|(number, parts)| {
        let pulls = without_end(parts, config).iter().map(|part| part.pull);
        pulls.map(move |pull| Pull { number, ..pull })
    });
    numbered.collect()
}

/// Without its end, where a driver who has nearly reached the speed takes power back.
fn without_end<'a>(parts: &'a [Part], config: &TractionConfig) -> &'a [Part] {
    let reached = parts.iter().map(|part| part.speeds_mps[1]);
    let reached = reached.fold(0.0, f64::max);
    let most = parts.iter().map(|part| part.pull.ratio).fold(0.0, f64::max);
    let ends = |part: &Part| {
        let taken_back = part.pull.ratio < config.taken_back * most && !part.floats;
        taken_back && reached - part.speeds_mps[0] < config.left_mps
    };
    let kept = parts.iter().rposition(|part| !ends(part));
    &parts[..kept.map_or(0, |last| last + 1)]
}

/// The parts of each pull.
pub fn by_number(pulls: &[Pull]) -> impl Iterator<Item = &[Pull]> {
    pulls.chunk_by(|a, b| a.number == b.number)
}

/// What the reading of the speed is to the ratio, m/s: where the effort is what limits, the limit does not depend on the speed, and only a rise of the effort does.
fn speed_sd_mps(at_power: f64, effort_over_limit: f64, config: &TractionConfig) -> f64 {
    if effort_over_limit > config.by_power { at_power } else { config.starting_speed_sd_mps }
}

/// The power stays while the speed goes up and down: with the gradient, at the limit of what the train gives, though it gains nothing. A driver who holds a speed does the opposite.
fn floats(read: &[(f64, Pull)], here: usize, config: &TractionConfig) -> bool {
    // Coasts and stops are long, and no pulls.
    if read[here].1.ratio <= least_ratio(config) {
        return false;
    }
    let ratio = read[here].1.ratio;
    let same = |(_, other): &&(f64, Pull)| (other.ratio - ratio).abs() < config.floating;
    let before = read[..here].iter().rev().take_while(same);
    let after = read[here..].iter().take_while(same);
    let (mut times, mut speeds) = ((f64::INFINITY, 0.0_f64), (f64::INFINITY, 0.0_f64));
    for (time_s, pull) in before.chain(after) {
        times = (times.0.min(*time_s), times.1.max(*time_s));
        speeds = (speeds.0.min(pull.speed_mps), speeds.1.max(pull.speed_mps));
    }
    times.1 - times.0 >= config.floating_s && speeds.1 - speeds.0 >= config.floating_mps
}

/// Intervals of steady power where the effort is measured at the moments of its samples: no mean over an interval is needed, and a fast log shows more of the first
/// seconds.
pub fn sampled_pulls(
    train: &Train,
    index: usize,
    run: &Run,
    readings: &Readings,
    config: &TractionConfig,
) -> Vec<Pull> {
    let most = train.max_effort_n_per_kg(0.1);
    let at_power = config.sampled_speed_sd_mps;
    let read: Vec<(f64, Pull)> = run
        .samples
        .iter()
        .filter_map(|s| {
            let speed_mps = readings.true_speed_mps(s.speed_mps?);
            let limit = train.max_effort_n_per_kg(speed_mps.max(0.5));
            let pull = Pull {
                run: index,
                location_m: s.location_m?,
                speed_mps,
                ratio: s.effort_n_per_kg? / limit,
                sd: config.sensor.hypot(speed_sd_mps(at_power, most / limit, config) / speed_mps.max(1.0)),
                effort_over_limit: most / limit,
                by_power: most / limit > config.by_power,
                number: 0,
                weight: 1.0,
            };
            Some((s.time_s, pull))
        })
        .collect();
    let mut pulls: Vec<Part> = Vec::new();
    let mut last_s = f64::NEG_INFINITY;
    for (i, (time_s, pull)) in read.iter().enumerate() {
        // Neighbours far enough for a rounded speed to have changed, and for a rising effort to have risen.
        let (before, after) = (&read[..i], &read[i + 1..]);
        let before = before.iter().rfind(|b| time_s - b.0 >= config.neighbour_s);
        let after = after.iter().find(|a| a.0 - time_s >= config.neighbour_s);
        let (Some(before), Some(after)) = (before, after) else {
            continue;
        };
        let near = |other: &(f64, Pull)| (other.1.ratio - pull.ratio).abs() < config.near + config.near_sd * pull.sd;
        let gains = (after.1.speed_mps - before.1.speed_mps) / (after.0 - before.0);
        // The power was raised since the reading before: by the speed gained, long enough ago?
        let rises_mps = config.rise_s * (after.1.speed_mps - pull.speed_mps) / (after.0 - time_s);
        if !near(before) && pull.speed_mps - before.1.speed_mps < rises_mps {
            continue;
        }
        let floats = floats(&read, i, config);
        if pull.says_something(config)
            && pull.speed_mps > config.slowest_mps
            && (gains > config.least_acceleration_mps2 || floats)
            && (near(before) || near(after))
            && time_s - last_s >= config.least_s
        {
            let weight = ((time_s - last_s) / config.decision_s).min(1.0);
            pulls.push(Part {
                time_s: *time_s,
                speeds_mps: [before.1.speed_mps, after.1.speed_mps],
                floats,
                pull: Pull { weight, ..*pull },
            });
            last_s = *time_s;
        }
    }
    numbered(pulls.into_iter(), config)
}
