//! A whole term in some of the runs: trains of two lengths, one of them as described.
//!
//! Each run says by its own rows whether the term acts in it:
//!
//! ```text
//! e_i = z_i c_i + d_i s_i + noise        z_i = 1 with probability p, d_i normal around the lag of all runs
//! ```
//!
//! with c the rows of the term and s what locations a metre further on would change, for those of a run may begin some
//! way off. Both z and d are integrated out; z = 0 is the rival: locations that differ from run to run, which look much
//! like another length.

use crate::candidate::{Shape, Term};
use crate::candidates::sensors;
use crate::fit::{Base, mixed_gain, mixed_odds, mixed_share};
use crate::noise::calibrate::effort;
use crate::search::fits::Search;
use core::ops::Range;
use nalgebra::{DVector, DVectorView};

/// Spreads of the locations of runs that are tried, m.
const SHIFTS_M: [f64; 7] = [1.0, 2.5, 5.0, 10.0, 20.0, 40.0, 80.0];
/// Lags of the locations of all runs that are tried, in steps of so many metres, up to so many steps.
const LAGS_M: (f64, i32) = (4.0, 10);

/// Rounds in which the share of the runs is found.
const ROUNDS: usize = 20;

/// Products of what a run has left with a shift of its locations in the direction of travel.
pub(super) struct RunLeft {
    run: usize,
    left: DVector<f64>,
    shift: DVector<f64>,
    with_left: f64,
    information: f64,
}

/// Log-likelihoods of a run, over those without the term and without a shift.
#[derive(Clone, Copy)]
struct RunGain {
    run: usize,
    /// By its shift alone.
    shifted: f64,
    /// More by the term beside it.
    acting: f64,
}

/// What a term explains that acts in each run with a common probability, beside their shifts.
fn in_some(of_runs: &[RunGain], most_share: f64) -> f64 {
    let gains = || of_runs.iter().map(|run| run.acting);
    let acts = |share: f64| gains().map(|gain| 1.0 - 1.0 / (1.0 + mixed_odds(share, gain))).sum();
    let share = mixed_share(of_runs.len(), ROUNDS, most_share, acts);
    of_runs.iter().map(|run| run.shifted).sum::<f64>() + mixed_gain(share, gains())
}

/// Shifts of the locations, m: their spread, and what all runs have in common.
fn shifts() -> impl Iterator<Item = (f64, f64)> {
    let lags = move |sd_m| (-LAGS_M.1..=LAGS_M.1).map(move |step| (sd_m, LAGS_M.0 * f64::from(step)));
    SHIFTS_M.into_iter().flat_map(lags)
}

/// The products of a term's column in a run.
struct OfTerm<'a> {
    run: &'a RunLeft,
    with_left: f64,
    with_shift: f64,
    information: f64,
}

impl<'a> OfTerm<'a> {
    fn new(run: &'a RunLeft, column: DVectorView<'_, f64>) -> Self {
        Self {
            run,
            with_left: run.left.dot(&column),
            with_shift: run.shift.dot(&column),
            information: column.norm_squared(),
        }
    }

    fn gain(&self, (sd_m, lag_m): (f64, f64)) -> RunGain {
        let RunLeft { run, with_left, information, .. } = *self.run;
        let shrunk = 1.0 / (sd_m.powi(-2) + information);
        let beyond_lag = with_left - lag_m * information;
        let lagged = lag_m * with_left - 0.5 * lag_m * lag_m * information;
        let squares = (beyond_lag - self.with_shift).powi(2) - beyond_lag.powi(2);
        RunGain {
            run,
            shifted: lagged + 0.5 * shrunk * beyond_lag.powi(2) - 0.5 * (sd_m * sd_m * information).ln_1p(),
            acting: self.with_left - lag_m * self.with_shift - 0.5 * self.information + 0.5 * shrunk * squares,
        }
    }
}

impl Search<'_> {
    /// What a model leaves in each run. The lag of the locations, which is much like another length in all runs, is
    /// left in it.
    pub(super) fn left_in_runs(&self, model: &[Term]) -> Option<Vec<RunLeft>> {
        let residual: Vec<f64> = self.rows.iter().map(|row| row.residual_n_per_kg).collect();
        let sensor = |of| self.white_apart(&Term { of, shape: Shape::Law });
        let (whole, free): (Vec<&Term>, Vec<&Term>) = model.iter().partition(|term| term.is_whole());
        let left = self.apart.whiten(&residual);
        let left = whole.iter().fold(left, |left, term| left - &self.white_apart(term)[0]);
        let free = free.iter().flat_map(|term| self.white_apart(term).to_vec());
        let beside = free.chain(sensor(sensors::DELAY).to_vec()).chain([self.apart.whiten(&effort(self.rows))]);
        let beside: Vec<DVector<f64>> = beside.filter(|column| column.iter().any(|value| *value != 0.0)).collect();
        let left = Base::new(&left, &beside, self.apart.runs())?.residual;
        let further_on = sensor(sensors::LOCATION_OFFSET);
        let of_run = |range: &Range<usize>| {
            let first = &self.rows[range.start];
            let [left, shift] = [&left, &further_on[0]].map(|all| all.rows(range.start, range.len()).into_owned());
            let shift = shift * first.direction.sign();
            let (with_left, information) = (shift.dot(&left), shift.norm_squared());
            RunLeft { run: first.interval.run, left, shift, with_left, information }
        };
        Some(self.apart.runs().iter().map(of_run).collect())
    }

    /// The term in those runs that it explains better. `None`: these are hardly any or nearly all, or their locations
    /// may as well be shifted.
    pub(super) fn in_some_runs(&self, term: &Term, runs: &[RunLeft]) -> Option<Term> {
        let (config, between) = (self.context.config, &self.context.config.between_runs);
        let column = &self.white_apart(term)[0];
        let of_run = |(run, range): (_, &Range<usize>)| OfTerm::new(run, column.rows(range.start, range.len()));
        let of_term: Vec<OfTerm<'_>> = runs.iter().zip(self.apart.runs()).map(of_run).collect();
        let all: Vec<Vec<RunGain>> = shifts().map(|by| of_term.iter().map(|run| run.gain(by)).collect()).collect();
        let sum = |of_runs: &[RunGain], of: fn(&RunGain) -> f64| of_runs.iter().map(of).sum::<f64>();
        let by_shifts = all.iter().map(|of_runs| sum(of_runs, |run| run.shifted)).fold(0.0, f64::max);
        let enough = by_shifts + term.penalty(self.context, self.rows) + config.certainty.rival_within;
        // No choice of the runs is worth more than one that costs nothing.
        let most = |of_runs: &&Vec<RunGain>| sum(of_runs, |run| run.shifted + run.acting.max(0.0)) > enough;
        let worth = all.iter().filter(most).map(|of_runs| (in_some(of_runs, between.most_with_term), of_runs));
        let (worth, best) = worth.max_by(|a, b| a.0.total_cmp(&b.0))?;
        let acting: Vec<usize> = best.iter().filter(|run| run.acting > 0.0).map(|run| run.run).collect();
        let least = config.evidence.least_runs.max((between.least_with_term * best.len() as f64).ceil() as usize);
        let are_some = acting.len() >= least && acting.len() + least <= best.len();
        (are_some && worth > enough).then(|| term.with(Shape::NumberInRuns(term.shape.number(), acting)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::candidates;
    use crate::data::believed::tests::on_a_hilly_line;
    use crate::data::rows::Row;
    use crate::noise::calibrate::Calibrated;
    use crate::noise::whitening::Noise;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;
    use rundown::model::direction::Direction;
    use rundown::model::effects::EffectKind;

    const RUNS: usize = 40;

    /// In which runs a length of `asked_m` is found, of 40 on a line with 30 gradients. `train`: how much longer the
    /// train of a run is, and by how much its locations are off, m.
    fn found_in(asked_m: f64, seed: u64, train: impl Fn(usize, f64) -> (f64, f64)) -> Option<Vec<usize>> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        on_a_hilly_line(RUNS, |context| {
            let believed = context.believed.train();
            let (gravity, length_m) = (believed.gravity_n_per_kg(), believed.length_m());
            let mut rows = Vec::new();
            for run in 0..RUNS {
                let direction = [Direction::Up, Direction::Down][run % 2];
                let track = context.believed.line(direction).track;
                let (longer_m, off_m) = train(run, rng.sample(StandardNormal));
                for i in 0..60 {
                    let mut row = Row::coasting(direction, 250.0 + 490.0 * f64::from(i), 25.0);
                    row.interval.run = run;
                    row.interval.begin_s = 20.0 * f64::from(i);
                    let at_m = row.interval.middle().location_m;
                    let gradient = |at_m: f64, length_m: f64| gravity * track.mean_gradient(at_m, length_m, direction);
                    let noise: f64 = rng.sample(StandardNormal);
                    row.residual_n_per_kg =
                        gradient(at_m - off_m, length_m + longer_m) - gradient(at_m, length_m) + 0.004 * noise;
                    rows.push(row);
                }
            }
            let noise = Noise { acceleration_mps2: 0.004, ..Noise::default() };
            let calibrated = Calibrated::even(noise, rows.len());
            let search = Search::new(context, &rows, &calibrated, true);
            let term = Term { of: candidates::of(EffectKind::TrainLengthError), shape: Shape::Number(asked_m) };
            let found = search.in_some_runs(&term, &search.left_in_runs(&[]).unwrap());
            found.map(|term| term.shape.runs().to_vec())
        })
    }

    #[test]
    fn runs_of_a_longer_train_are_distinguished_from_the_others() {
        for seed in 0..3 {
            let found = found_in(264.0, seed, |run, _| (if run % 3 == 0 { 102.0 } else { 0.0 }, 0.0)).unwrap();
            assert_eq!(found, (0..RUNS).step_by(3).collect::<Vec<_>>(), "{seed}");
            let both = |run: usize, normal: f64| (if run % 2 < run % 3 { 102.0 } else { 0.0 }, 15.0 * normal);
            let right = (0..RUNS).filter(|run| run % 2 < run % 3).collect::<Vec<_>>();
            assert_eq!(found_in(264.0, seed, both).unwrap(), right, "beside shifted locations, {seed}");
        }
    }

    #[test]
    fn neither_one_train_nor_locations_that_differ_are_two_lengths() {
        for seed in 10..13 {
            assert_eq!(found_in(264.0, seed, |_, _| (0.0, 0.0)), None);
            assert_eq!(found_in(264.0, seed, |_, _| (102.0, 0.0)), None);
            for shifted_m in [5.0, 15.0, 25.0] {
                assert_eq!(found_in(264.0, seed, |_, normal| (0.0, shifted_m * normal)), None, "{shifted_m}");
            }
        }
    }
}
