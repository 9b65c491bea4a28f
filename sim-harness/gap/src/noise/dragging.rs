//! Does a brake drag in some of the runs?
//!
//! A constant resistance in a quarter of the runs is also a spread between runs, and the noise of a data set has room
//! for that (wind, constant). So the two are compared as explanations of what differs from run to run:
//!
//! ```text
//! e_i = b_i (d z_i + o) + own_i + noise        z_i = 1 with probability p, own_i normal
//! ```
//!
//! with b the rows after the first brake application; d = 0 is the noise alone, and o, at most 0, what a flexible model
//! of all runs has taken from those that do not drag. Whether a run drags is integrated out,
//! so choosing the runs costs nothing. Or all runs of a unit drag, and no others.

use crate::candidate::Term;
use crate::columns::braked;
use crate::config::BetweenRunsConfig;
use crate::data::{believed::Context, rows::Row};
use crate::fit::{mixed_gain, mixed_odds, mixed_share};
use crate::noise::calibrate::{Calibrated, Deviations, Own, left, own_columns, whitening};
use crate::noise::dragging_units::{Units, choice};
use core::ops::Range;
use nalgebra::DVector;

/// What the rows of a run say of the size of a column: score and information.
#[derive(Clone)]
pub struct RunScore {
    pub run: usize,
    pub score: f64,
    pub information: f64,
}

impl RunScore {
    /// Of each run; `column` and `residual` whitened.
    pub fn of_runs(rows: &[Row], runs: &[Range<usize>], column: &DVector<f64>, residual: &DVector<f64>) -> Vec<Self> {
        let of_run = |range: &Range<usize>| {
            let b = column.rows(range.start, range.len());
            let e = residual.rows(range.start, range.len());
            Self { run: rows[range.start].interval.run, score: b.dot(&e), information: b.norm_squared() }
        };
        runs.iter().map(of_run).collect()
    }

    /// Gain of log-likelihood if the run has so much of the column.
    pub fn gain(&self, size: f64) -> f64 {
        size * self.score - 0.5 * size * size * self.information
    }
}

/// Some runs drag, the others do not.
#[derive(Clone, Copy)]
struct Mixture {
    drag: f64,
    /// What the others have, N/kg: a flexible model takes the mean of the drags from all runs, so less than nothing.
    others: f64,
    share: f64,
    gain: f64,
}

impl Mixture {
    /// What a run gains if it drags, over what it gains if it does not.
    fn gain_of(&self, run: &RunScore) -> f64 {
        run.gain(self.others + self.drag) - run.gain(self.others)
    }
}

fn mixture(runs: &[RunScore], drag: f64, config: &BetweenRunsConfig) -> Mixture {
    let mut found = Mixture { drag, others: 0.0, share: 0.0, gain: 0.0 };
    found.share = mixed_share(runs.len(), 60, config.most_dragging, |share| {
        // Score and information of those that drag, and of the others.
        let (mut sum, mut parts) = (0.0, [[0.0; 2]; 2]);
        for run in runs {
            let odds = mixed_odds(share, found.gain_of(run));
            let drags = odds / (1.0 + odds);
            sum += drags;
            for ([score, information], of) in parts.iter_mut().zip([drags, 1.0 - drags]) {
                *score += of * run.score;
                *information += of * run.information;
            }
        }
        let [dragging, others] = parts.map(|[score, information]| score / f64::max(information, 1e-12));
        found.others = others.clamp(-config.most_dragging * config.most_drag_n_per_kg, 0.0);
        found.drag = (dragging - found.others).clamp(config.least_drag_n_per_kg, config.most_drag_n_per_kg);
        sum
    });
    let without: f64 = runs.iter().map(|run| run.gain(found.others)).sum();
    let [_, common] = one_sided(runs.iter());
    found.gain = without - common + mixed_gain(found.share, runs.iter().map(|run| found.gain_of(run)));
    found
}

/// Gains of log-likelihood of the best constant of these runs: not below zero, and not above.
fn one_sided<'a>(runs: impl Iterator<Item = &'a RunScore>) -> [f64; 2] {
    let (score, information) = runs.fold((0.0, 0.0), |(g, i), run| (g + run.score, i + run.information));
    let gain = 0.5 * score * score / f64::max(information, 1e-12);
    if score > 0.0 { [gain, 0.0] } else { [0.0, gain] }
}

/// Largest gain of log-likelihood of a constant in all runs on one side of some value of a coordinate.
fn step(runs: &[RunScore], of: impl Fn(&RunScore) -> Option<f64>) -> f64 {
    let mut along: Vec<(f64, &RunScore)> = runs.iter().filter_map(|run| Some((of(run)?, run))).collect();
    along.sort_by(|a, b| a.0.total_cmp(&b.0));
    let parts = |k: usize| [&along[..k], &along[k..]].map(|side| one_sided(side.iter().map(|(_, run)| *run)));
    // The others have what a flexible model has taken from all runs.
    let [_, common] = one_sided(along.iter().map(|(_, run)| *run));
    let gains = |k: usize| {
        let [before, since] = parts(k);
        [before[0] + since[1], since[0] + before[1]]
    };
    let sides = (0..along.len()).flat_map(gains).map(|gain| gain - common);
    sides.fold(0.0, f64::max)
}

/// Which runs drag, and what that gains.
struct Dragging {
    gain: f64,
    dragging: Vec<usize>,
}

impl Dragging {
    /// Any runs.
    fn of_runs(of_runs: &[RunScore], config: &BetweenRunsConfig) -> Self {
        let found = [0.003, 0.01].map(|start| mixture(of_runs, start, config));
        let best = if found[1].gain > found[0].gain { found[1] } else { found[0] };
        let (share, gain) = (best.share, best.gain);
        let odds = |run: &&RunScore| share * best.gain_of(run).clamp(-500.0, 500.0).exp() > 1.0 - share;
        let dragging = of_runs.iter().filter(odds).map(|run| run.run).collect();
        Self { gain, dragging }
    }

    /// Those of a unit, all alike.
    fn of_unit(unit: Vec<usize>, of_runs: &[RunScore], rows: &[Row]) -> Self {
        let (own, others): (Vec<&RunScore>, Vec<&RunScore>) = of_runs.iter().partition(|run| unit.contains(&run.run));
        let ([own, _], [_, others]) = (one_sided(own.into_iter()), one_sided(others.into_iter()));
        let [_, common] = one_sided(of_runs.iter());
        let gain = own + others - common - choice(&unit, rows);
        Self { gain, dragging: unit }
    }
}

/// The runs in which a brake drags, if that explains what differs between runs better than their own constants and
/// winds.
pub fn dragging(context: &Context<'_>, rows: &[Row], calibrated: &Calibrated, model: &[Term]) -> Option<Vec<usize>> {
    let config = &context.config.between_runs;
    let columns = own_columns(context, rows);
    let all: Vec<usize> = rows.iter().map(|row| row.interval.run).collect();
    let braked = braked(context, rows, &all);
    let (residual, freedom) = left(context, rows, calibrated, model)?;
    let whitened = |own: Own| {
        let whitening = whitening(&Deviations { noise: calibrated.noise, own }, &calibrated.spread, rows, &columns);
        let e = whitening.whiten(&residual);
        let reached = -whitening.log_determinant() - 0.5 * freedom * e.norm_squared();
        (whitening, e, reached)
    };
    let (.., plain) = whitened(calibrated.own);
    let units = Units::of(context, rows);
    let mut best: Option<(f64, Dragging, Vec<RunScore>)> = None;
    for constant in SHARES {
        for wind in SHARES {
            let own = Own {
                constant_n_per_kg: constant * calibrated.own.constant_n_per_kg,
                wind_mps: wind * calibrated.own.wind_mps,
                ..calibrated.own
            };
            let (whitening, e, without) = whitened(own);
            let mut runs = RunScore::of_runs(rows, whitening.runs(), &whitening.whiten(&braked), &e);
            for run in &mut runs {
                run.score *= freedom;
                run.information *= freedom;
            }
            let units = units.dragging(|column| whitening.whiten(column), &e).into_iter();
            let units = units.map(|unit| Dragging::of_unit(unit, &runs, rows));
            for found in units.chain([Dragging::of_runs(&runs, config)]) {
                if best.as_ref().is_none_or(|(reached, ..)| without + found.gain > *reached) {
                    best = Some((without + found.gain, found, runs.clone()));
                }
            }
        }
    }
    let (reached, Dragging { gain, dragging }, of_runs) = best?;
    // From a day on, or on cold days, is another law.
    let at =
        |run: &RunScore, of: fn(&Row) -> Option<f64>| rows.iter().find(|row| row.interval.run == run.run).and_then(of);
    let day = |run: &RunScore| at(run, |row| row.interval.day);
    let temperature = |run: &RunScore| at(run, |row| row.interval.temperature_c);
    if step(&of_runs, day).max(step(&of_runs, temperature)) > gain {
        return None;
    }
    (reached - plain > config.drag_gain && !dragging.is_empty()).then_some(dragging)
}

/// Shares of the constants and winds of runs that are tried beside drags.
const SHARES: [f64; 4] = [0.0, 0.25, 0.5, 1.0];

#[cfg(test)]
mod tests {
    use super::*;

    fn runs(constants: impl Iterator<Item = f64>) -> Vec<RunScore> {
        let information = 1.0 / (1.5e-3_f64 * 1.5e-3);
        constants
            .enumerate()
            .map(|(run, constant)| RunScore { run, score: constant * information, information })
            .collect()
    }

    #[test]
    fn a_quarter_of_the_runs_drags() {
        let runs = runs((0..60).map(|i| if i % 4 == 0 { 6e-3 } else { 0.0 }));
        let Mixture { drag, share, gain, .. } = mixture(&runs, 0.003, &BetweenRunsConfig::default());
        assert!((drag - 6e-3).abs() < 1e-4);
        assert!((share - 0.25).abs() < 0.02);
        assert!(gain > 50.0);
    }

    #[test]
    fn runs_that_drag_are_seen_where_the_mean_of_all_is_taken_away() {
        let runs = runs((0..60).map(|i| if i % 4 == 0 { 4.5e-3 } else { -1.5e-3 }));
        let Mixture { drag, others, share, gain } = mixture(&runs, 0.003, &BetweenRunsConfig::default());
        assert!((drag - 6e-3).abs() < 1e-4 && (others + 1.5e-3).abs() < 1e-4, "{drag} {others}");
        assert!((share - 0.25).abs() < 0.02 && gain > 50.0, "{share} {gain}");
    }

    #[test]
    fn a_constant_from_a_day_on_is_a_step() {
        for taken in [0.0, 1.5e-3] {
            let late = runs((0..60).map(|i| if i >= 45 { 6e-3 - taken } else { -taken }));
            let gain = mixture(&late, 0.003, &BetweenRunsConfig::default()).gain;
            assert!(step(&late, |run| Some(run.run as f64)) > gain, "{taken}");
        }
        let scattered = runs((0..60).map(|i| if i % 4 == 0 { 6e-3 } else { 0.0 }));
        let gain = mixture(&scattered, 0.003, &BetweenRunsConfig::default()).gain;
        assert!(step(&scattered, |run| Some(run.run as f64)) < gain);
    }

    #[test]
    fn no_run_drags_where_none_differs() {
        let runs = runs((0..60).map(|i| 1.5e-3 * f64::from(i % 3 - 1)));
        let gain = mixture(&runs, 0.003, &BetweenRunsConfig::default()).gain;
        assert!(gain < 3.0);
        // Nor where a model has taken too much from all.
        let runs = self::runs((0..60).map(|i| -1.5e-3 + 1e-4 * f64::from(i % 3 - 1)));
        let gain = mixture(&runs, 0.003, &BetweenRunsConfig::default()).gain;
        assert!(gain < 3.0, "{gain}");
    }
}
