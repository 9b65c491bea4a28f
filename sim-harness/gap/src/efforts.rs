//! The effort of each interval: measured, known to be zero in coasting, or what the model says it takes; and so the
//! rows and the powering phases of a set.

use crate::candidate::Term;
use crate::coasting::{Driven, Extra, Recognised, coasted};
use crate::config::EffortConfig;
use crate::data::believed::{Context, believed_load, starting_effort_n_per_kg};
use crate::data::runs::{EffortReading, Run, usual_step_s};
use crate::data::{cut, interval::Interval, rows::Row};
use crate::noise::calibrate::{Calibrated, Own};
use crate::traction::exceeded::{Reading, calculated, traction};
use crate::traction::powering::{SteadyPower, powering, sampled_powering};
use core::f64::consts::SQRT_2;
use rundown_check::rows::steps;
use rundown_files::statistics::median;

/// Runs with their intervals, and the model that they are looked at with.
#[derive(Clone, Copy)]
pub struct Looked<'a> {
    pub context: &'a Context<'a>,
    pub runs: &'a [Run],
    pub cut: &'a [Vec<Interval>],
    pub effort: EffortReading,
    pub measured: bool,
    pub model: (&'a [Term], &'a [f64]),
}

/// What the rounding of speeds 10 s apart leaves in an effort calculated from them, standard deviation, N/kg.
fn rounded_n_per_kg(runs: &[Run], config: &EffortConfig) -> f64 {
    // Speeds of a fast log are means of several readings.
    let fast = median(runs.iter().map(usual_step_s)).is_some_and(|step_s| step_s < config.fast_s);
    let step_mps = median(runs.iter().map(|run| run.recorded.speed_step_mps)).unwrap_or(0.0);
    let of_reading = step_mps / 12.0_f64.sqrt() * if fast { config.fast_share } else { 1.0 };
    SQRT_2 * of_reading / 10.0
}

/// The same with all else that disturbs it, as found.
fn calculated_n_per_kg(found: &Calibrated) -> f64 {
    (SQRT_2 * found.noise.reading_mps / 10.0).hypot(found.noise.acceleration_mps2)
}

/// Whether the effort counts as measured.
pub fn measured(runs: &[Run], config: &EffortConfig) -> bool {
    let moves = |v: f64| v > config.moving_mps;
    if runs.iter().any(|run| run.recorded.brakes_aside) {
        return true;
    }
    let moving = || runs.iter().flat_map(|run| &run.samples).filter(|s| s.speed_mps.is_some_and(moves));
    let with = moving().filter(|s| s.effort_n_per_kg.is_some()).count();
    // A column of zeros is none.
    let any = moving().any(|s| s.effort_n_per_kg.is_some_and(|effort| effort != 0.0));
    any && with as f64 > config.measured_share * moving().count() as f64
}

/// The rows of a measured effort column as it was read, nothing put right yet; none without the column.
pub fn rows_as_read(context: &Context<'_>, runs: &[Run]) -> Option<Vec<Row>> {
    if !measured(runs, &context.config.effort) {
        return None;
    }
    let effort = EffortReading::default();
    let cut = cut::all(context, runs, effort);
    let looked = Looked { context, runs, cut: &cut, effort, measured: true, model: (&[], &[]) };
    Some(looked.rows(None, 0.0))
}

/// Extra resistance of a model along intervals, N/kg.
fn extra(context: &Context<'_>, run: &Run, intervals: &[Interval], (model, beta): (&[Term], &[f64])) -> Vec<f64> {
    let row = |interval: &Interval| Row {
        interval: interval.clone(),
        direction: run.direction,
        effort_n_per_kg: interval.effort_n_per_kg.unwrap_or(0.0),
        residual_n_per_kg: 0.0,
    };
    let rows: Vec<Row> = intervals.iter().map(row).collect();
    let mut extra = vec![0.0; rows.len()];
    let columns = model.iter().flat_map(|term| term.columns(context, &rows));
    for (column, beta) in columns.zip(beta) {
        for (sum, value) in extra.iter_mut().zip(column) {
            *sum += beta * value;
        }
    }
    extra
}

/// A model without what acts by place.
fn beyond_places((model, beta): (&[Term], &[f64])) -> (Vec<Term>, Vec<f64>) {
    let mut betas = beta.iter().copied();
    let mut kept = (Vec::new(), Vec::new());
    for term in model {
        let of_term = betas.by_ref().take(term.count());
        if term.by_place() {
            of_term.for_each(drop);
        } else {
            kept.0.push(term.clone());
            kept.1.extend(of_term);
        }
    }
    kept
}

/// Rows with others that coast on both sides: at the ends of coasts there is a rest of what was before or comes after,
/// at the same places in all runs, and no single row shows it. All of them, where fewer than `few` would be left.
fn within_coasts(rows: Vec<Row>, few: usize) -> Vec<Row> {
    let goes_on = |pair: &[Row]| {
        let [a, b] = [&pair[0].interval, &pair[1].interval];
        a.run == b.run && (b.begin_s - a.begin_s - a.dt_s).abs() < 0.5 * a.dt_s
    };
    let inner: Vec<Row> = rows
        .windows(3)
        .filter(|three| goes_on(&three[..2]) && goes_on(&three[1..]))
        .map(|three| three[1].clone())
        .collect();
    if inner.len() < few { rows } else { inner }
}

impl Looked<'_> {
    fn each(&self) -> impl Iterator<Item = (&Run, &Vec<Interval>)> {
        self.runs.iter().zip(self.cut)
    }

    /// The rows: from every moving interval where the effort is measured, else from coasting. `known`: the noise, if it
    /// was found; `uncertain`: how well the resistance is described.
    pub fn rows(&self, known: Option<&Calibrated>, uncertain: f64) -> Vec<Row> {
        let context = self.context;
        let efforts: Vec<Vec<Option<f64>>> = if self.measured {
            self.cut.iter().map(|intervals| intervals.iter().map(|i| i.effort_n_per_kg).collect()).collect()
        } else {
            let zero = |run: Vec<bool>| run.into_iter().map(|coasted| coasted.then_some(0.0)).collect();
            self.coasted(known, uncertain).into_iter().map(zero).collect()
        };
        let of_run = |((run, intervals), efforts): ((&Run, &Vec<Interval>), Vec<Option<f64>>)| {
            let line = context.believed.line(run.direction);
            let config = &context.config.interval;
            let rows = intervals.iter().zip(efforts).filter_map(|(i, effort)| Row::new(line, i, effort, config));
            rows.collect::<Vec<_>>()
        };
        let rows = self.each().zip(efforts).flat_map(of_run).collect();
        if self.measured { rows } else { within_coasts(rows, context.config.search.few_rows) }
    }

    /// Which intervals coasted.
    fn coasted(&self, known: Option<&Calibrated>, uncertain: f64) -> Vec<Vec<bool>> {
        let (context, config) = (self.context, &self.context.config.effort);
        let at_first = || rounded_n_per_kg(self.runs, config).hypot(config.disturbed_n_per_kg);
        let of = |found| calculated_n_per_kg(found).clamp(config.least_sd_n_per_kg, config.most_sd_n_per_kg);
        let recognised = Recognised {
            noise_n_per_kg: known.map_or_else(at_first, of),
            uncertain,
            own: known.map_or_else(Own::default, |found| found.own),
            config: &context.config.coasting,
        };
        let (terms, betas) = beyond_places(self.model);
        let driven = |(run, intervals): (&Run, &Vec<Interval>)| {
            let extra = Extra {
                all: extra(context, run, intervals, self.model),
                beyond_places: extra(context, run, intervals, (&terms, &betas)),
            };
            Driven::new(context.believed.line(run.direction), intervals, &extra, recognised)
        };
        coasted(&self.each().map(driven).collect::<Vec<_>>())
    }

    /// The effort of each interval: measured, or what the model says it takes.
    fn efforts(&self, run: &Run, intervals: &[Interval]) -> Vec<Option<f64>> {
        let line = self.context.believed.line(run.direction);
        let config = &self.context.config.effort;
        if self.measured {
            let steady = |i: &Interval| i.effort_n_per_kg.filter(|_| i.effort_change_n_per_kg < config.steady_n_per_kg);
            return intervals.iter().map(steady).collect();
        }
        // What a table was found from ends somewhere; beyond it is a guess, and no ground for judging the traction.
        let within = |interval: &Interval| self.model.0.iter().all(|term| term.covers(interval));
        let extra = extra(self.context, run, intervals, self.model);
        let calculated = |(interval, extra): (&Interval, f64)| {
            let load = believed_load(line, interval) + extra;
            within(interval).then(|| interval.acceleration_mps2() + load)
        };
        intervals.iter().zip(extra).map(calculated).collect()
    }

    /// Powering phases of each run, and all that it gives where the power limits.
    pub fn traction(&self, calibrated: &Calibrated) -> (Vec<Vec<SteadyPower>>, Vec<Vec<Reading>>) {
        let believed = &self.context.believed;
        let (config, traction_config) = (&self.context.config.effort, &self.context.config.traction);
        // The noise was found where coasting was recognised, and there it is at its smallest.
        let sd = match self.measured {
            true => 0.0,
            false => calculated_n_per_kg(calibrated).max(rounded_n_per_kg(self.runs, config)),
        };
        let of_run = |(index, (run, intervals)): (usize, (&Run, &Vec<Interval>))| {
            let line = believed.line(run.direction);
            if !self.measured {
                let effort = self.efforts(run, intervals);
                let given = calculated(line.train, intervals, &effort, sd, traction_config);
                return (powering(line.train, intervals, &effort, sd, traction_config), given);
            }
            let rounding_n_per_kg = steps::rounding(run.recorded.effort_step_n_per_kg);
            let sampled = self.effort == EffortReading::Momentary || usual_step_s(run) < config.fast_s;
            let powering = if sampled {
                sampled_powering(line.train, index, run, self.effort, traction_config)
            } else {
                powering(line.train, intervals, &self.efforts(run, intervals), sd, traction_config)
            };
            let most = starting_effort_n_per_kg(line.train);
            let rounded = |power: SteadyPower| power.doubted(rounding_n_per_kg * power.effort_over_limit / most);
            (powering.into_iter().map(rounded).collect(), traction(line.train, run, self.effort))
        };
        self.each().enumerate().map(of_run).unzip()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rundown::model::direction::Direction;

    #[test]
    fn the_ends_of_coasts_do_not_count_where_enough_is_left() {
        let row = |i: usize| {
            let mut row = Row::coasting(Direction::Up, 0.0, 25.0);
            // Coasts of four intervals, then two that are none.
            row.interval.begin_s = (10 * (i + 2 * (i / 4))) as f64;
            row.interval.run = i / 8;
            row
        };
        let rows: Vec<Row> = (0..16).map(row).collect();
        let inner = within_coasts(rows.clone(), 8);
        let at = |row: &Row| rows.iter().position(|other| other.interval == row.interval);
        assert_eq!(inner.iter().filter_map(at).collect::<Vec<_>>(), [1, 2, 5, 6, 9, 10, 13, 14]);
        assert_eq!(within_coasts(rows, 9).len(), 16);
    }
}
