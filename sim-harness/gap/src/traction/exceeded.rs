//! Did trains give more than a limit allows?
//!
//! Drivers who creep up to the same speed on the same slope all demand the same power there, and that looks like a
//! limit. A limit is refuted by runs that exceed it, however briefly: here every reading of the effort counts, not only
//! steady power; of a calculated one, what it is at least. Where runs exceed it near its ends alone, it is shorter.

use crate::config::TractionConfig;
use crate::data::believed::starting_effort_n_per_kg;
use crate::data::interval::{Interval, POINTS};
use crate::data::runs::{EffortReading, Run};
use crate::traction::limit::FoundLimit;
use rundown::model::{effects::Effect, train::Train};
use rundown_files::sample::Sample;
use std::cmp::Ordering;

/// A reading of the effort where the power limits.
#[derive(Clone, Copy, Debug)]
pub struct Reading {
    /// Where it was read, from and to, m: a mean belongs to all of the distance since the reading before.
    span_m: [f64; 2],
    /// Effort over believed limit.
    ratio: f64,
}

/// All readings of traction of a run where the power limits.
pub fn traction(train: &Train, run: &Run, effort: EffortReading) -> Vec<Reading> {
    let most = starting_effort_n_per_kg(train);
    let limit = |s: &Sample| Some(train.max_effort_n_per_kg(s.speed_mps?.max(0.5))).filter(|limit| *limit < most);
    let read = (0..run.samples.len()).filter_map(|i| {
        let here = &run.samples[i];
        let from = match effort {
            EffortReading::Momentary => here,
            EffortReading::MeanSinceLast => &run.samples[i.checked_sub(1)?],
        };
        let effort = here.effort_n_per_kg.filter(|effort| *effort > 0.0)?;
        Some(Reading { span_m: [from.location_m?, here.location_m?], ratio: effort / limit(from)?.max(limit(here)?) })
    });
    read.collect()
}

/// The same where the effort is calculated, with this standard deviation: what each interval gives at least.
pub fn calculated(
    train: &Train,
    intervals: &[Interval],
    effort: &[Option<f64>],
    effort_sd: f64,
    config: &TractionConfig,
) -> Vec<Reading> {
    let most = starting_effort_n_per_kg(train);
    let read = intervals.iter().zip(effort).filter_map(|(interval, effort)| {
        let limit = interval.mean(|p| train.max_effort_n_per_kg(p.speed_mps.max(0.5)));
        let least = (*effort)? - config.sure * effort_sd;
        let [begin, end] = interval.speed_mps;
        let by_power = train.max_effort_n_per_kg(begin.min(end).max(0.5)) < most;
        (by_power && least > 0.0)
            .then_some(Reading { span_m: [0, POINTS - 1].map(|i| interval.path[i].location_m), ratio: least / limit })
    });
    read.collect()
}

/// A limit of a section as far as the readings allow it, if they do.
pub fn allowed(mut found: FoundLimit, traction: &[Vec<Reading>], config: &TractionConfig) -> Option<FoundLimit> {
    let factor = found.factor;
    let Effect::PowerLimitSection(section) = &mut found.effect else {
        return Some(found);
    };
    let (from_m, to_m) = (&mut section.from_m, &mut section.to_m);
    let exceeded = |part, inwards: fn(&f64, &f64) -> Ordering| exceeded(traction, part, factor, inwards, config);
    let (low, high) = (*from_m, *to_m);
    let middle = 0.5 * (low + high);
    if let Some(at) = exceeded(low..middle, |a, b| a.total_cmp(b)) {
        *from_m = at;
    }
    if let Some(at) = exceeded(middle..high, |a, b| b.total_cmp(a)) {
        *to_m = at;
    }
    if *to_m - *from_m < config.left_share * (high - low) {
        return None;
    }
    if let Some([from, to]) = &mut found.edges_m {
        let (before, beyond) = (config.before_m, config.beyond_m);
        if *from_m > low {
            *from = (*from_m - before, from.1.max(*from_m + beyond));
        }
        if *to_m < high {
            *to = (to.0.min(*to_m - beyond), *to_m + before);
        }
    }
    Some(found)
}

/// How far into a part of the line enough runs give more than `factor`. `inwards`: in which order locations lie towards
/// the middle.
fn exceeded(
    traction: &[Vec<Reading>],
    part: core::ops::Range<f64>,
    factor: f64,
    inwards: impl Fn(&f64, &f64) -> Ordering,
    config: &TractionConfig,
) -> Option<f64> {
    let within = |r: &&Reading| r.span_m.iter().all(|at| part.contains(at));
    let inside = |run: &&Vec<Reading>| run.iter().any(|r| within(&r));
    let powering = traction.iter().filter(inside).count();
    let few = config.few_runs.max((config.few_share * powering as f64).ceil() as usize);
    let innermost = |run: &Vec<Reading>| {
        let above = run.iter().filter(|r| r.ratio > config.above * factor);
        // Somewhere along its path: no further in than the end that is nearer to the edge.
        let outer = |r: &Reading| {
            let [a, b] = r.span_m;
            if inwards(&a, &b).is_lt() { a } else { b }
        };
        above.filter(within).map(outer).max_by(&inwards)
    };
    let mut of_runs: Vec<f64> = traction.iter().filter_map(innermost).collect();
    of_runs.sort_by(|a, b| inwards(b, a));
    of_runs.get(few - 1).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::rows::Row;
    use rundown::model::train::{Train, TrainDescription};
    use rundown::model::{direction::Direction, effects::PowerLimitSection};

    /// Twenty runs that read the effort every 100 m; so many give 0.6 at these places, and otherwise 0.3.
    fn runs(above: usize, at_m: &[f64]) -> Vec<Vec<Reading>> {
        let run = |i: usize| {
            let reading = |k: u32| {
                let location_m = 100.0 * f64::from(k);
                let much = i < above && at_m.contains(&location_m);
                Reading { span_m: [location_m; 2], ratio: if much { 0.6 } else { 0.3 } }
            };
            (0..200).map(reading).collect()
        };
        (0..20).map(run).collect()
    }

    fn section(traction: &[Vec<Reading>]) -> Option<(f64, f64)> {
        let found = FoundLimit {
            effect: Effect::PowerLimitSection(PowerLimitSection { from_m: 4_000.0, to_m: 8_000.0, factor: 0.33 }),
            factor: 0.33,
            runs: Vec::new(),
            gain: 20.0,
            value: 13.0,
            factor_sd: 0.01,
            edges_m: None,
            below_kmh: None,
            demanded: 0.0,
        };
        allowed(found, traction, &TractionConfig::default())?.effect.section_m()
    }

    #[test]
    fn strays_and_what_lies_outside_change_nothing() {
        assert_eq!(section(&runs(2, &[6_000.0])), Some((4_000.0, 8_000.0)));
        assert_eq!(section(&runs(20, &[3_000.0, 9_000.0])), Some((4_000.0, 8_000.0)));
        assert_eq!(section(&[]), Some((4_000.0, 8_000.0)));
    }

    #[test]
    fn many_runs_near_an_end_shorten_a_limit_and_in_its_middle_refute_it() {
        assert_eq!(section(&runs(5, &[4_500.0, 7_800.0])), Some((4_500.0, 7_800.0)));
        assert_eq!(section(&runs(5, &[5_900.0, 6_100.0])), None);
    }

    #[test]
    fn a_mean_over_the_edge_says_nothing_and_one_inside_counts_from_its_outer_end() {
        let mean = |span_m: [f64; 2]| vec![vec![Reading { span_m, ratio: 0.6 }]; 10];
        assert_eq!(section(&mean([3_800.0, 4_200.0])), Some((4_000.0, 8_000.0)));
        assert_eq!(section(&mean([4_100.0, 4_500.0])), Some((4_100.0, 8_000.0)));
        assert_eq!(section(&mean([7_900.0, 7_500.0])), Some((4_000.0, 7_900.0)));
    }

    #[test]
    fn a_calculated_effort_counts_for_what_it_is_at_least_and_only_where_the_power_limits() {
        let train = Train::try_new(TrainDescription::CASE_STUDY).unwrap();
        let corner_mps = train.description().max_power_w / train.description().max_tractive_effort_n;
        let interval = |from_mps: f64| {
            let mut interval = Row::coasting(Direction::Up, 1000.0, from_mps + 1.0).interval;
            interval.speed_mps = [from_mps, from_mps + 2.0];
            interval
        };
        let intervals = [corner_mps - 0.5, corner_mps + 0.5].map(interval);
        let limit = train.max_effort_n_per_kg(corner_mps + 1.5);
        let read = calculated(&train, &intervals, &[Some(limit); 2], 0.02 * limit, &TractionConfig::default());
        let ratios: Vec<f64> = read.iter().map(|reading| reading.ratio).collect();
        assert_eq!(ratios.len(), 1, "{ratios:?}");
        assert!((ratios[0] - 0.92).abs() < 1e-9, "{ratios:?}");
    }
}
