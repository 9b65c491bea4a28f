//! Steady power while a train gains speed, as a share of the believed limit.

use crate::config::TractionConfig;
use crate::data::believed::starting_effort_n_per_kg;
use crate::data::interval::Interval;
use crate::data::runs::{EffortReading, Run};
use rundown::model::train::Train;
use rundown_files::sample::Sample;

/// An interval of steady power: a part of a powering phase.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SteadyPower {
    pub run: usize,
    pub location_m: f64,
    pub speed_mps: f64,
    /// Effort over believed limit.
    pub ratio: f64,
    /// Standard deviation of the ratio.
    pub sd: f64,
    /// Largest effort over the limit at this speed: above 1 where the power limits.
    pub effort_over_limit: f64,
    /// The power is what limits, not the effort.
    pub by_power: bool,
    /// Number of the phase in its run: a driver who lets go and powers again makes another demand.
    pub number: usize,
    /// What it counts for: a driver's hand stays where it is for about 10 s, so nearer samples share one decision.
    pub weight: f64,
}

impl SteadyPower {
    /// A reading of the effort. `limits`: the largest effort at this speed and at none; `sd`: of the effort, and of a
    /// speed where the power limits.
    fn read(
        (run, location_m, speed_mps): (usize, f64, f64),
        effort: f64,
        [limit, most]: [f64; 2],
        [effort_sd, speed_sd_mps]: [f64; 2],
        config: &TractionConfig,
    ) -> Self {
        let by_power = most / limit > config.by_power;
        // Where the effort is what limits, the limit does not depend on the speed, and only a rise of the effort does.
        let speed_sd_mps = if by_power { speed_sd_mps } else { config.starting_speed_sd_mps };
        Self {
            run,
            location_m,
            speed_mps,
            ratio: effort / limit,
            sd: (effort_sd / limit).hypot(config.sensor).hypot(speed_sd_mps / speed_mps.max(1.0)),
            effort_over_limit: most / limit,
            by_power,
            number: 0,
            weight: 1.0,
        }
    }

    /// With a further doubt of the ratio, a standard deviation.
    pub fn doubted(self, sd: f64) -> Self {
        Self { sd: self.sd.hypot(sd), ..self }
    }

    /// Enough of the limit, and away from the corner of effort and power, near which a driver who demands less effort
    /// than power is limited by neither share. `begins`: the largest effort over the limit where it begins, for an
    /// interval that begins at the corner is a mean of both shares.
    fn says_something(&self, begins: f64, config: &TractionConfig) -> bool {
        self.ratio > least_ratio(config) && (!self.by_power || begins.min(self.effort_over_limit) >= config.corner)
    }
}

/// A ratio below this is no powering.
pub fn least_ratio(config: &TractionConfig) -> f64 {
    config.least_share - 0.1
}

/// Intervals of steady power of one run. `effort`: measured, or calculated from the change of speed and the model.
pub fn powering(
    train: &Train,
    intervals: &[Interval],
    effort: &[Option<f64>],
    effort_sd: f64,
    config: &TractionConfig,
) -> Vec<SteadyPower> {
    let most = starting_effort_n_per_kg(train);
    let read = |(interval, effort): (&Interval, &Option<f64>)| {
        let limit = interval.mean(|p| train.max_effort_n_per_kg(p.speed_mps.max(0.5)));
        let at = (interval.run, interval.middle().location_m, interval.mean_speed_mps());
        effort.map(|effort| SteadyPower::read(at, effort, [limit, most], [effort_sd, config.speed_sd_mps], config))
    };
    let read: Vec<Option<SteadyPower>> = intervals.iter().zip(effort).map(read).collect();
    let known = |(i, power): (usize, &Option<SteadyPower>)| Some((i, (intervals[i].begin_s, (*power)?)));
    let (at, known): (Vec<usize>, Vec<(f64, SteadyPower)>) = read.iter().enumerate().filter_map(known).unzip();
    let mut floating = vec![false; intervals.len()];
    for (place, i) in at.into_iter().enumerate() {
        // A calculated effort follows the rounding of the speed: nothing floats in it.
        floating[i] = effort_sd == 0.0 && floats(&known, place, config);
    }
    let ratios: Vec<Option<SteadyPower>> = intervals
        .iter()
        .zip(read)
        .zip(&floating)
        .map(|((interval, power), floats)| {
            let slowest = interval.speed_mps[0].min(interval.speed_mps[1]);
            let powering = *floats || interval.acceleration_mps2() > config.least_acceleration_mps2;
            let begins = most / train.max_effort_n_per_kg(slowest.max(0.5));
            power.filter(|power| powering && slowest > config.slowest_mps && power.says_something(begins, config))
        })
        .collect();
    // Steady: like a neighbour.
    let near = |a: &SteadyPower, b: &Option<SteadyPower>| {
        b.is_some_and(|b| (a.ratio - b.ratio).abs() < config.alike + config.alike_sd * a.sd.hypot(b.sd))
    };
    let steady = (0..ratios.len()).filter_map(|i| {
        let power = ratios[i]?;
        let before = i > 0 && near(&power, &ratios[i - 1]);
        let after = ratios.get(i + 1).is_some_and(|next| near(&power, next));
        // Calculated from the change of speed, the interval in which the power is raised looks like less power.
        let raised = effort_sd > 0.0 && (i == 0 || ratios[i - 1].is_none());
        ((before || after) && !raised).then_some(PhasePart {
            time_s: intervals[i].begin_s,
            speeds_mps: intervals[i].speed_mps,
            floats: floating[i],
            power,
        })
    });
    numbered(steady, config)
}

/// A part of a powering phase with its time and the speeds around it, m/s.
struct PhasePart {
    time_s: f64,
    speeds_mps: [f64; 2],
    /// The power stays for long while the speed floats: a limit, not a driver who has reached his speed.
    floats: bool,
    power: SteadyPower,
}

/// With the numbers of their phases. A phase that gains little speed keeps a speed rather than reaching one, and says
/// what the driver likes, not what the train gives.
fn numbered(parts: impl Iterator<Item = PhasePart>, config: &TractionConfig) -> Vec<SteadyPower> {
    let parts: Vec<PhasePart> = parts.collect();
    let of_phases = parts.chunk_by(|a, b| b.time_s - a.time_s <= config.apart_s);
    let wanted = of_phases.filter(|parts| match parts {
        parts if parts.iter().any(|part| part.floats) => true,
        [first, .., last] => last.speeds_mps[1] - first.speeds_mps[0] > config.least_gain_mps,
        [only] => only.speeds_mps[1] - only.speeds_mps[0] > config.least_gain_mps,
        [] => false,
    });
    let numbered = wanted.enumerate().flat_map(|(number, parts)| {
        let powering = without_end(parts, config).iter().map(|part| part.power);
        powering.map(move |power| SteadyPower { number, ..power })
    });
    numbered.collect()
}

/// Without its end, where a driver who has nearly reached the speed takes power back.
fn without_end<'a>(parts: &'a [PhasePart], config: &TractionConfig) -> &'a [PhasePart] {
    let reached = parts.iter().map(|part| part.speeds_mps[1]);
    let reached = reached.fold(0.0, f64::max);
    let most = parts.iter().map(|part| part.power.ratio).fold(0.0, f64::max);
    let ends = |part: &PhasePart| {
        let taken_back = part.power.ratio < config.taken_back * most && !part.floats;
        taken_back && reached - part.speeds_mps[0] < config.left_mps
    };
    let kept = parts.iter().rposition(|part| !ends(part));
    &parts[..kept.map_or(0, |last| last + 1)]
}

pub fn by_number(powering: &[SteadyPower]) -> impl Iterator<Item = &[SteadyPower]> {
    powering.chunk_by(|a, b| a.number == b.number)
}

/// The power stays while the speed goes up and down: with the gradient, at the limit of what the train gives, though it
/// gains nothing. A driver who holds a speed does the opposite.
fn floats(read: &[(f64, SteadyPower)], here: usize, config: &TractionConfig) -> bool {
    // Coasts and stops are long, and no powering.
    if read[here].1.ratio <= least_ratio(config) {
        return false;
    }
    let ratio = read[here].1.ratio;
    let same = |(_, other): &&(f64, SteadyPower)| (other.ratio - ratio).abs() < config.floating;
    let before = read[..here].iter().rev().take_while(same);
    let after = read[here..].iter().take_while(same);
    let (mut times, mut speeds) = ((f64::INFINITY, 0.0_f64), (f64::INFINITY, 0.0_f64));
    for (time_s, power) in before.chain(after) {
        times = (times.0.min(*time_s), times.1.max(*time_s));
        speeds = (speeds.0.min(power.speed_mps), speeds.1.max(power.speed_mps));
    }
    times.1 - times.0 >= config.floating_s && speeds.1 - speeds.0 >= config.floating_mps
}

/// Intervals of steady power where the effort is read off the samples: no mean over an interval is needed, and a fast
/// log shows more of the first seconds. A mean since the sample before belongs half-way between the two, where the
/// train was slower.
pub fn sampled_powering(
    train: &Train,
    index: usize,
    run: &Run,
    reading: EffortReading,
    config: &TractionConfig,
) -> Vec<SteadyPower> {
    let most = starting_effort_n_per_kg(train);
    let read = |(i, s): (usize, &Sample)| {
        let from = match reading {
            EffortReading::Momentary => s,
            EffortReading::MeanSinceLast => &run.samples[i.checked_sub(1)?],
        };
        let speed_mps = 0.5 * (from.speed_mps? + s.speed_mps?);
        let location_m = 0.5 * (from.location_m? + s.location_m?);
        let limits = [train.max_effort_n_per_kg(speed_mps.max(0.5)), most];
        let sd = [0.0, config.sampled_speed_sd_mps];
        Some((s.time_s, SteadyPower::read((index, location_m, speed_mps), s.effort_n_per_kg?, limits, sd, config)))
    };
    let read: Vec<(f64, SteadyPower)> = run.samples.iter().enumerate().filter_map(read).collect();
    let mut powering: Vec<PhasePart> = Vec::new();
    let mut last_s = f64::NEG_INFINITY;
    for (i, (time_s, power)) in read.iter().enumerate() {
        // Neighbours far enough for a rounded speed to have changed, and for a rising effort to have risen.
        let (before, after) = (&read[..i], &read[i + 1..]);
        let before = before.iter().rfind(|b| time_s - b.0 >= config.neighbour_s);
        let after = after.iter().find(|a| a.0 - time_s >= config.neighbour_s);
        let (Some(before), Some(after)) = (before, after) else {
            continue;
        };
        let near = |other: &(f64, SteadyPower)| {
            (other.1.ratio - power.ratio).abs() < config.alike + config.alike_sd * power.sd
        };
        // Gained by this power: a speed that was held until the power was raised was no limit's.
        let gained = |from: &(f64, SteadyPower), to: &(f64, SteadyPower)| {
            let gained_mps = to.1.speed_mps - from.1.speed_mps;
            if gained_mps > config.rounding_mps { gained_mps / (to.0 - from.0) } else { 0.0 }
        };
        let here = &read[i];
        let of_this_power = match (near(before), near(after)) {
            (true, true) => f64::INFINITY,
            (true, false) => gained(before, here),
            (false, true) => gained(here, after),
            (false, false) => continue,
        };
        let gains = gained(before, after).min(of_this_power);
        // The power was raised since the reading before: by the speed gained, long enough ago?
        let rises_mps = config.rise_s * (after.1.speed_mps - power.speed_mps) / (after.0 - time_s);
        if !near(before) && power.speed_mps - before.1.speed_mps < rises_mps {
            continue;
        }
        let floats = floats(&read, i, config);
        if power.says_something(power.effort_over_limit, config)
            && power.speed_mps > config.slowest_mps
            && (gains > config.least_acceleration_mps2 || floats)
            && time_s - last_s >= config.least_s
        {
            let weight = ((time_s - last_s) / config.decision_s).min(1.0);
            powering.push(PhasePart {
                time_s: *time_s,
                speeds_mps: [before.1.speed_mps, after.1.speed_mps],
                floats,
                power: SteadyPower { weight, ..*power },
            });
            last_s = *time_s;
        }
    }
    numbered(powering.into_iter(), config)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::interval::{POINTS, Point};
    use crate::data::rows::Row;
    use rundown::model::direction::Direction;
    use rundown::model::train::TrainDescription;

    /// A driver who asks for all of the power and for three quarters of the effort does not slip where the one takes
    /// over from the other.
    #[test]
    fn an_interval_that_begins_at_the_corner_says_nothing_of_the_power() {
        let described = TrainDescription::CASE_STUDY;
        let max_tractive_effort_n = 2.0 * described.max_tractive_effort_n;
        let train = Train::try_new(TrainDescription { max_tractive_effort_n, ..described }).unwrap();
        let most = starting_effort_n_per_kg(&train);
        let given = |mps: f64| train.max_effort_n_per_kg(mps).min(0.75 * most);
        for begin_mps in [1.5, 2.0, 3.0, 4.0, 5.0, 6.0] {
            let mut speed_mps: f64 = begin_mps;
            let (mut intervals, mut efforts) = (Vec::new(), Vec::new());
            for i in 0..8 {
                let mut path = [Point::default(); POINTS];
                let begins = speed_mps;
                for (k, point) in path.iter_mut().enumerate() {
                    let since_departure_s = 10.0 * f64::from(i) + k as f64 + 0.5;
                    *point = Point { location_m: 100.0 * since_departure_s, speed_mps, since_departure_s };
                    speed_mps += given(speed_mps);
                }
                efforts.push(Some(path.iter().map(|point| given(point.speed_mps)).sum::<f64>() / POINTS as f64));
                let of_row = Row::coasting(Direction::Up, 0.0, begins).interval;
                let (begin_s, speed_mps) = (10.0 * f64::from(i), [begins, speed_mps]);
                intervals.push(Interval { begin_s, speed_mps, path, follows: i > 0, ..of_row });
            }
            let found = powering(&train, &intervals, &efforts, 0.0, &TractionConfig::default());
            let by_power: Vec<f64> = found.iter().filter(|one| one.by_power).map(|one| one.ratio).collect();
            assert!(by_power.len() >= 4, "{begin_mps}: {by_power:?}");
            assert!(by_power.iter().all(|ratio| (ratio - 1.0).abs() < 0.005), "{begin_mps}: {by_power:?}");
        }
    }
}
