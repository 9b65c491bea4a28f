//! How large the small errors of the described gradients are: τ of [`super::gradients`].
//!
//! It is as large as most places of the line show, by the median of their sizes, so that what acts at a few of them
//! keeps its name. In both directions it is what turns at a place, beside what does not.
//! Where none are sure: how probable typical ones are.

use crate::candidate::Shape;
use crate::candidates::{self, sensors};
use crate::columns::{self, both_directions, hats, in_the_middle, knots};
use crate::config::GradientsConfig;
use crate::data::{believed::Context, rows::Row};
use crate::fit::{Base, explained};
use crate::noise::{
    calibrate::Calibrated,
    gradients::{Errors, at},
    whitening::Whitening,
};
use nalgebra::{DMatrix, DVector};
use rundown::model::direction::Direction;
use rundown::model::effects::{Coordinate, EffectKind};
use rundown_files::statistics::{MEDIAN_TO_SD, median};
use std::collections::BTreeMap;

/// What may act along the whole line by the speed, the effort or the described line, and so is no error at a place.
fn beside(context: &Context<'_>, rows: &[Row]) -> Vec<Vec<f64>> {
    let speeds =
        knots(rows.iter().filter_map(|row| in_the_middle(Coordinate::Speed, row)), context.config.evidence.knots);
    let mut all = hats(Coordinate::Speed, &speeds, rows);
    all.push(columns::wind(context, rows, 0.0));
    all.push(rows.iter().map(|row| row.effort_n_per_kg).collect());
    all.push(rows.iter().map(|row| f64::from(row.effort_n_per_kg > context.config.evidence.coast_n_per_kg)).collect());
    let laws = [sensors::DELAY, sensors::LATE_LOCATION, sensors::LOCATION_OFFSET];
    all.extend(laws.map(|of| of.columns(&Shape::Law, context, rows).remove(0)));
    all.push(candidates::of(EffectKind::CurveResistance).columns(&Shape::Law, context, rows).remove(0));
    let length_m = context.believed.train().length_m();
    let lengths = [0.5, 1.5].map(|times| Shape::Number(times * length_m));
    all.extend(
        lengths.map(|shape| candidates::of(EffectKind::TrainLengthError).columns(&shape, context, rows).remove(0)),
    );
    all.retain(|column| column.iter().any(|value| *value != 0.0));
    all
}

/// Rows of each place.
fn places(context: &Context<'_>, rows: &[Row]) -> Vec<Vec<usize>> {
    let mut all: BTreeMap<i64, Vec<usize>> = BTreeMap::new();
    for (index, row) in rows.iter().enumerate() {
        let place = at(context, row).0 / context.config.gradients.place_m;
        all.entry(place.floor() as i64).or_default().push(index);
    }
    all.into_values().collect()
}

/// The errors of the gradients of these rows.
pub fn errors(context: &Context<'_>, rows: &[Row], calibrated: &Calibrated) -> Errors {
    let config = &context.config.gradients;
    // Of places that show nothing both are as likely as before.
    let Some(places) = Places::of(context, rows, calibrated) else {
        return Errors { sd_permille: 0.0, may_be: probability(0.0) };
    };
    let seen = places.seen(config.typical_permille, config.known_share);
    let (places, seen) = places.without_effects(seen, config.effect);
    if let Some(sd_permille) = places.found(&seen, both_directions(rows), config) {
        return Errors { sd_permille, may_be: 0.0 };
    }
    let typical = config.typical_permille * mean_of_place(config.place_m / config.alike_m);
    Errors { sd_permille: 0.0, may_be: probability(places.gain(typical).unwrap_or(0.0)) }
}

/// Of what was as likely as not before so much log-likelihood spoke for it.
fn probability(gain: f64) -> f64 {
    1.0 / (1.0 + (-gain).exp())
}

/// Rows that drivers forge alike in each run, braking and while the effort changes, hardly count.
fn whitening(context: &Context<'_>, rows: &[Row], calibrated: &Calibrated) -> Whitening {
    let (evidence, search) = (&context.config.evidence, &context.config.search);
    let mut noise = calibrated.clone();
    for (spread, row) in noise.spread.iter_mut().zip(rows) {
        let is_unsteady = row.interval.effort_change_n_per_kg > evidence.steady_n_per_kg;
        let is_weak = is_unsteady || row.effort_n_per_kg < search.braking_n_per_kg;
        *spread *= if is_weak { evidence.unsteady_wider } else { 1.0 };
    }
    noise.without_nuisances(context, rows)
}

/// Enough of the rows are of the rarer direction for what does not turn to be known beside what does.
fn is_passed_both_ways(rows: &[Row], place: &[usize], share: f64) -> bool {
    let up = place.iter().filter(|i| rows[**i].direction == Direction::Up).count();
    up.min(place.len() - up) as f64 > share * place.len() as f64
}

/// Standard deviation of the mean over so many lengths of correlation, of errors of 1.
fn mean_of_place(ways: f64) -> f64 {
    (2.0 / ways - 2.0 / (ways * ways) * (1.0 - (-ways).exp())).sqrt()
}

/// What places say of their gradients beside what acts everywhere: products of whitened columns of a permille with each
/// other and with the residuals.
struct Places {
    gram: DMatrix<f64>,
    with: DVector<f64>,
    /// What is there is an effect, of any size.
    freed: Vec<bool>,
}

impl Places {
    /// `None`: what acts everywhere is not independent.
    fn of(context: &Context<'_>, rows: &[Row], calibrated: &Calibrated) -> Option<Self> {
        let whitening = whitening(context, rows, calibrated);
        let places = places(context, rows);
        let only = |place: &Vec<usize>, of: &dyn Fn(&Row) -> f64| {
            let mut column = vec![0.0; rows.len()];
            place.iter().for_each(|i| column[*i] = of(&rows[*i]));
            whitening.whiten(&column)
        };
        let mut fixed: Vec<DVector<f64>> = beside(context, rows).iter().map(|one| whitening.whiten(one)).collect();
        let least_share = context.config.gradients.other_way;
        let passed_both_ways = places.iter().filter(|place| is_passed_both_ways(rows, place, least_share));
        fixed.extend(passed_both_ways.map(|place| only(place, &|_| 1.0)));
        let y: Vec<f64> = rows.iter().map(|row| row.residual_n_per_kg).collect();
        let base = Base::new(&whitening.whiten(&y), &fixed, whitening.runs())?;
        let turning = |place| base.beside(&only(place, &|row| at(context, row).1));
        let turning = DMatrix::from_columns(&places.iter().map(turning).collect::<Vec<_>>());
        let freed = vec![false; places.len()];
        Some(Self { gram: turning.tr_mul(&turning), with: turning.tr_mul(&base.residual), freed })
    }

    /// Of the prior of each place, where errors have this standard deviation, permille.
    fn precisions(&self, size: f64) -> DVector<f64> {
        let precision = |freed: &bool| if *freed { MOST_SIZE } else { size }.powi(-2);
        DVector::from_iterator(self.freed.len(), self.freed.iter().map(precision))
    }

    /// Restricted log-likelihood of errors of this size beyond that of none. `None`: it is no number.
    fn gain(&self, size: f64) -> Option<f64> {
        let likelihood = |size: f64| {
            let precisions = self.precisions(size);
            let (log_root, explained) = explained(&self.gram + DMatrix::from_diagonal(&precisions), &self.with)?;
            let of_prior: f64 = precisions.iter().map(|precision| 0.5 * precision.ln()).sum();
            Some(of_prior - log_root + 0.5 * explained)
        };
        Some(likelihood(size)? - likelihood(LEAST_SIZE)?)
    }

    /// Of errors of a standard deviation, permille: the likeliest at each place, and which share of their variance is
    /// then known.
    fn likeliest(&self, size: f64) -> Vec<(f64, f64)> {
        let precisions = self.precisions(size);
        let sum = &self.gram + DMatrix::from_diagonal(&precisions);
        let Some(left) = sum.cholesky().map(|cholesky| cholesky.inverse()) else {
            return Vec::new();
        };
        let errors = &left * &self.with;
        (0..errors.len()).map(|i| (errors[i], 1.0 - precisions[i] * left[(i, i)])).collect()
    }

    /// What is so many times further off than most is no error but an effect. It is set aside with its place, for what
    /// acts everywhere would take a part of it to all others.
    fn without_effects(mut self, mut seen: Vec<usize>, effect: f64) -> (Self, Vec<usize>) {
        loop {
            let size = self.size(&seen).unwrap_or(0.0);
            let beyond = self.beyond(&seen, size);
            let (effects, others): (Vec<_>, Vec<_>) =
                seen.iter().zip(beyond).partition(|(_, beyond)| *beyond > effect * MEDIAN_TO_SD);
            if effects.is_empty() {
                return (self, seen);
            }
            effects.into_iter().for_each(|(place, _)| self.freed[*place] = true);
            seen = others.into_iter().map(|(place, _)| *place).collect();
        }
    }

    /// The standard deviation of errors that are surely there, permille.
    fn found(&self, seen: &[usize], both_directions: bool, config: &GradientsConfig) -> Option<f64> {
        let size = self.size(seen)?;
        let least = if both_directions { config.least_places } else { config.least_places_one_way };
        let is_sure = seen.len() >= least && self.gain(size)? > config.sure;
        let permille = size / mean_of_place(config.place_m / config.alike_m);
        (is_sure && permille > config.least_permille).then_some(permille.min(config.most_permille))
    }

    /// Places of which typical errors are known to this share of their variance.
    fn seen(&self, typical: f64, share: f64) -> Vec<usize> {
        let known = self.likeliest(typical).into_iter().map(|(_, known)| known);
        known.enumerate().filter(|(_, known)| *known > share).map(|(place, _)| place).collect()
    }

    /// The likeliest errors in standard deviations of what they are expected to be, over the median of a normal
    /// distribution. Of a size of none: of their noise.
    fn beyond(&self, seen: &[usize], size: f64) -> Vec<f64> {
        let size = size.max(LEAST_SIZE);
        let likeliest = self.likeliest(size);
        let of_place = |place: &usize| {
            let (error, known) = likeliest.get(*place)?;
            Some(MEDIAN_TO_SD * error.abs() / (size * known.sqrt()))
        };
        seen.iter().filter_map(of_place).collect()
    }

    /// The standard deviation of errors by which the middle place is as far off as expected, permille. None: it is
    /// within noise.
    fn size(&self, seen: &[usize]) -> Option<f64> {
        let exceeds = |size: f64| median(self.beyond(seen, size)).map(|middle| middle > 1.0);
        if !exceeds(0.0)? {
            return None;
        }
        let (mut low, mut high) = (LEAST_SIZE, MOST_SIZE);
        for _ in 0..30 {
            let middle = (low * high).sqrt();
            if exceeds(middle)? { low = middle } else { high = middle }
        }
        Some(low)
    }
}

/// Sizes that are tried, permille.
const LEAST_SIZE: f64 = 1e-3;
const MOST_SIZE: f64 = 10.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::candidate::Term;
    use crate::data::believed::tests::on_a_level_line;
    use crate::evidence::evidence;
    use crate::noise::whitening::Noise;
    use crate::search::fits::Search;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    const RUNS: usize = 30;
    const NOISE_N_PER_KG: f64 = 0.005;

    /// Errors of so many permille over 60 km, by the kilometre, alike over two.
    fn drawn(sd: f64, seed: u64) -> Vec<f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let alike = (-0.5_f64).exp();
        let mut last = sd * normal();
        let mut next = || {
            last = alike * last + (1.0 - alike * alike).sqrt() * sd * normal();
            last
        };
        core::iter::repeat_with(&mut next).take(60).collect()
    }

    /// Of runs in both directions, or up alone, over 60 km of which the gradients are off by these, and in which more
    /// acts by kilometre, speed and time.
    fn rows(context: &Context<'_>, both: bool, off: &[f64], more: impl Fn(usize, f64) -> f64, seed: u64) -> Vec<Row> {
        let mut rng = ChaCha8Rng::seed_from_u64(1_000 + seed);
        let row = |i: usize| {
            let (run, km) = (i / off.len(), i % off.len());
            let direction = if both && run % 2 == 1 { Direction::Down } else { Direction::Up };
            let speed_mps = 25.0 + 6.0 * (0.7 * km as f64).sin() + rng.random_range(-4.0..4.0);
            let front_m = 1_000.0 * km as f64 + 500.0;
            let mut row = Row::coasting(direction, front_m, speed_mps);
            row.interval.run = run;
            let along = if direction == Direction::Up { km } else { off.len() - 1 - km };
            row.interval.path.iter_mut().for_each(|point| point.since_departure_s = 40.0 * along as f64);
            let noise: f64 = StandardNormal.sample(&mut rng);
            let force = at(context, &row).1 * off[km];
            row.residual_n_per_kg = NOISE_N_PER_KG * noise + force + more(km, speed_mps);
            row
        };
        (0..RUNS * off.len()).map(row).collect()
    }

    fn calibrated(rows: &[Row], sd_permille: f64) -> Calibrated {
        let noise = Noise { acceleration_mps2: NOISE_N_PER_KG, ..Noise::default() };
        let gradients = Errors { sd_permille, may_be: 0.0 };
        Calibrated { noise, spread: vec![1.0; rows.len()], gradients, ..Calibrated::default() }
    }

    /// What is found of errors of so many permille.
    fn size(both: bool, sd: f64, more: fn(usize, f64) -> f64, seed: u64) -> f64 {
        on_a_level_line(RUNS, |context| {
            let rows = rows(context, both, &drawn(sd, seed), more, seed);
            errors(context, &rows, &calibrated(&rows, 0.0)).sd_permille
        })
    }

    #[test]
    fn small_errors_of_gradients_are_found_as_large_as_they_are() {
        for both in [true, false] {
            let mean = (0..8).map(|seed| size(both, 0.4, |_, _| 0.0, seed)).sum::<f64>() / 8.0;
            assert!((0.28..0.5).contains(&mean), "{both}: {mean}");
        }
    }

    #[test]
    fn right_gradients_and_what_acts_at_a_few_places_or_by_the_speed_are_no_errors() {
        for both in [true, false] {
            for seed in 0..6 {
                assert_eq!(size(both, 0.0, |_, _| 0.0, seed), 0.0);
                assert_eq!(size(both, 0.0, |km, _| if (20..26).contains(&km) { 0.02 } else { 0.0 }, seed), 0.0);
                assert_eq!(size(both, 0.0, |_, speed_mps| 2e-5 * speed_mps * speed_mps, seed), 0.0);
            }
        }
        // What does not turn is none where trains go both ways.
        assert_eq!(size(true, 0.0, |km, _| 0.01 * (0.8 * km as f64).sin(), 1), 0.0);
    }

    #[test]
    fn whether_they_may_be_off_is_what_few_places_say() {
        let may_be = |sd: f64, places: usize| {
            let of = |seed: u64| {
                on_a_level_line(RUNS, |context| {
                    let off = &drawn(sd, seed)[..places];
                    let rows = rows(context, false, off, |_, _| 0.0, seed);
                    let found = errors(context, &rows, &calibrated(&rows, 0.0));
                    assert_eq!(found.sd_permille, 0.0, "{found:?}");
                    found.may_be
                })
            };
            (0..4).map(of).sum::<f64>() / 4.0
        };
        let (off, right) = (may_be(0.4, 15), may_be(0.0, 15));
        assert!(off > 0.95 && right < 0.02, "{off} {right}");
        let few = may_be(0.0, 3);
        assert!((0.02..0.6).contains(&few), "{few}");
        // Many places that show none rule them out.
        let none = may_be(0.0, 60);
        assert!(none < 1e-6, "{none}");
    }

    #[test]
    fn an_effect_at_a_few_places_does_not_make_errors_larger() {
        let at_places = |km: usize, _: f64| if (20..25).contains(&km) { 0.05 } else { 0.0 };
        for seed in 0..4 {
            let (with, without) = (size(false, 0.4, at_places, seed), size(false, 0.4, |_, _| 0.0, seed));
            assert!(with < 1.5 * without, "{with} for {without}");
        }
    }

    /// What is named beside errors of 0.4 permille that are known to be there, or not.
    fn named(is_known: bool, tunnel_n_per_kg: f64, seed: u64) -> Vec<Term> {
        on_a_level_line(RUNS, |context| {
            let tunnel = |km: usize, _: f64| if (30..34).contains(&km) { tunnel_n_per_kg } else { 0.0 };
            let rows = rows(context, true, &drawn(0.4, seed), tunnel, seed);
            let calibrated = calibrated(&rows, if is_known { 0.4 } else { 0.0 });
            Search::new(context, &rows, &calibrated, false).select()
        })
    }

    #[test]
    fn errors_that_most_places_have_are_no_effect_and_hide_none_that_is_larger() {
        for seed in 0..4 {
            assert_eq!(named(true, 0.0, seed), [], "{seed}");
            assert!(!named(false, 0.0, seed).is_empty(), "{seed}");
            let terms = named(true, 0.02, seed);
            let is_there =
                |term: &Term| term.section().is_some_and(|[from_m, to_m]| from_m < 32_500.0 && to_m > 31_500.0);
            assert!(terms.len() == 1 && is_there(&terms[0]), "{seed}: {terms:?}");
        }
    }

    #[test]
    fn errors_that_most_places_have_are_no_gap_without_a_name() {
        let p_value = |permille: f64, seed: u64| {
            on_a_level_line(RUNS, |context| {
                let rows = rows(context, false, &drawn(0.4, seed), |_, _| 0.0, seed);
                evidence(context, &rows, &calibrated(&rows, permille)).1
            })
        };
        let low = |permille: f64| (0..8).filter(|seed| p_value(permille, *seed) < 0.05).count();
        assert!(low(0.4) <= 2 && low(0.0) >= 7, "{} {}", low(0.4), low(0.0));
    }
}
