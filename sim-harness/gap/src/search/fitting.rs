//! The terms of a model with their coefficients, limits and rivals.

use crate::candidate::{Fitted, Term};
use crate::search::{fits::Search, selection::Found, shape};
use rundown_check::figure::{Figure, HALF_95};

/// Each term of the model with its coefficients, what it brings beside the others, and who would do as well.
pub fn fitted(search: &Search<'_>, model: &[Term]) -> Vec<Fitted> {
    let Some(base) = search.base(model) else {
        return Vec::new();
    };
    let certainty = &search.context.config.certainty;
    let score = search.score(model);
    let (naive, robust) = (base.naive(), base.robust());
    let sd_of = |i: usize| naive[(i, i)].max(robust[(i, i)]).sqrt();
    let dispersion = base.dispersion();
    let sections = |terms: &[Term]| terms.iter().filter(|term| term.section().is_some()).count();
    let mut place = 0;
    let of_term = |(index, term): (usize, &Term)| {
        let count = if term.is_whole() { 0 } else { term.count() };
        let range = place..place + count;
        place += count;
        let mut others = model.to_vec();
        others.remove(index);
        let (same, rivals): (Vec<Found>, Vec<Found>) =
            search.in_place(&others).into_iter().partition(|found| found.term.is_like(term));
        // Runs that differ in the effect say so beside the noise of all rows.
        let differ = same.first().map_or(1.0, |found| found.gain.naive_gain / found.gain.gain.max(1e-9));
        let dispersion = dispersion.max(differ);
        let rival = |found: Found| {
            let mut with = others.clone();
            with.insert(index, found.term.clone());
            let worse = score - search.score(&with) - found.term.unnamed_penalty(search.context);
            (worse < certainty.rival_most * dispersion).then_some((found.term, worse))
        };
        let sd = range
            .clone()
            .zip(search.systematic(model, index))
            .map(|(i, systematic)| sd_of(i).hypot(systematic).hypot(certainty.law * base.beta[i]));
        let sd: Vec<f64> = sd.collect();
        let half = HALF_95 * sd.first().copied().unwrap_or(0.0);
        let at_once = term.section().map(|_| {
            // The coefficients end with those of the sections' ends.
            let (at_ends, own) = (base.beta.len() - sections(&model[index..]), base.beta[range.start]);
            Figure { value: base.beta[at_ends] / own, sd: sd_of(at_ends) / own.abs() }
        });
        let beta: Vec<f64> = range.map(|i| base.beta[i]).collect();
        let beside = search.base(&others);
        let adds = if term.is_whole() { &[1.0][..] } else { &beta };
        Fitted {
            term: term.clone(),
            sd,
            gain: same.first().map_or(0.0, |found| found.gain.gain),
            dispersion,
            shape: beside.as_ref().and_then(|beside| shape::limits(beside, search, term, half)),
            may_be_brakes: beside.is_some_and(|beside| search.may_be_brakes(&beside, term, adds)),
            may_be_refused: search.may_be_refused_section(&others, term),
            section: search.section(&others, term, half, beta.first().copied().unwrap_or(1.0)),
            at_once,
            rivals: rivals.into_iter().filter_map(rival).collect(),
            beta,
        }
    };
    model.iter().enumerate().map(of_term).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::candidate::Shape;
    use crate::candidates;
    use crate::data::believed::tests::on_a_level_line;
    use crate::data::rows::Row;
    use crate::noise::calibrate::Calibrated;
    use crate::noise::whitening::Noise;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};
    use rundown::model::{direction::Direction, effects::EffectKind};

    /// Kinds of the terms that are found in 30 runs that coast at 25 to 140 km/h, each with those of its rivals that
    /// are hardly worse, where the resistance is larger by a law of the speed, m/s.
    fn found(law: impl Fn(f64) -> f64) -> Vec<(Option<EffectKind>, Vec<Option<EffectKind>>)> {
        on_a_level_line(30, |context| {
            let mut rng = ChaCha8Rng::seed_from_u64(5);
            let row = |i: usize| {
                let speed_mps: f64 = rng.random_range(7.0..39.0);
                let mut row = Row::coasting(Direction::Up, 900.0 * (i % 60) as f64, speed_mps);
                row.interval.run = i / 60;
                let noise: f64 = StandardNormal.sample(&mut rng);
                row.residual_n_per_kg = law(speed_mps) + 0.002 * noise;
                row
            };
            let rows: Vec<Row> = (0..30 * 60).map(row).collect();
            let noise = Noise { acceleration_mps2: 0.002, ..Noise::default() };
            let calibrated = Calibrated::even(noise, rows.len());
            let search = Search::new(context, &rows, &calibrated, false);
            let kind = |term: &Term| term.of.facts().kind;
            let near = |of: &Fitted| -> Vec<Option<EffectKind>> {
                let near = of
                    .rivals
                    .iter()
                    .filter(|(_, worse)| *worse < context.config.certainty.rival_within * of.dispersion);
                near.map(|(term, _)| kind(term)).collect()
            };
            fitted(&search, &search.select()).iter().map(|of| (kind(&of.term), near(of))).collect()
        })
    }

    #[test]
    fn what_a_train_that_starts_hard_leaves_in_slow_coasts_is_shared_with_it_without_an_effort_column() {
        let starting = Some(EffectKind::StartingResistance);
        let found_of_starting = found(|speed_mps| 0.12 * (-3.6 * speed_mps / 18.0).exp());
        assert!(!found_of_starting.is_empty());
        for (kind, rivals) in &found_of_starting {
            assert!(*kind != starting && rivals.contains(&starting), "{found_of_starting:?}");
        }
        // What acts at high speed is none.
        let found_of_drag = found(|speed_mps| 5e-6 * speed_mps * speed_mps);
        assert!(!found_of_drag.is_empty());
        assert!(found_of_drag.iter().all(|(_, rivals)| !rivals.contains(&starting)), "{found_of_drag:?}");
    }

    /// The terms found in 30 runs up and down a tunnel of which a share acts on the front of the train alone.
    fn found_of_tunnel(at_once: f64) -> Vec<Fitted> {
        on_a_level_line(30, |context| {
            let mut rng = ChaCha8Rng::seed_from_u64(9);
            let tunnel = Term { of: candidates::of(EffectKind::TunnelDrag), shape: Shape::Section([20e3, 25e3]) };
            let row = |k: usize| {
                let (run, i) = (k / 200, k % 200);
                let location_m = 300.0 * i as f64 + rng.random_range(0.0..300.0);
                let direction = [Direction::Up, Direction::Down][run % 2];
                let mut row = Row::coasting(direction, location_m, rng.random_range(25.0..40.0));
                row.interval.run = run;
                row
            };
            let mut rows: Vec<Row> = (0..30 * 200).map(row).collect();
            let of_train = tunnel.extra(&[1.2e-5], context, &rows);
            for (row, of_train) in rows.iter_mut().zip(of_train) {
                let middle = row.interval.middle();
                let inside = f64::from((20e3..25e3).contains(&middle.location_m));
                let of_front = 1.2e-5 * middle.speed_mps.powi(2) * inside;
                let noise: f64 = StandardNormal.sample(&mut rng);
                row.residual_n_per_kg = at_once * of_front + (1.0 - at_once) * of_train + 0.002 * noise;
            }
            let noise = Noise { acceleration_mps2: 0.002, ..Noise::default() };
            let calibrated = Calibrated::even(noise, rows.len());
            let search = Search::new(context, &rows, &calibrated, true);
            fitted(&search, &search.select())
        })
    }

    #[test]
    fn a_tunnel_that_acts_on_the_front_of_the_train_has_no_gradient_errors_at_its_ends() {
        for share in [0.0, 1.0] {
            let terms = found_of_tunnel(share);
            let [Fitted { term, at_once: Some(at_once), .. }] = terms.as_slice() else {
                panic!("{share}: {terms:?}");
            };
            assert!(term.is(EffectKind::TunnelDrag), "{term:?}");
            assert!(at_once.away_from(share) < 3.0 && at_once.sd < 0.15, "{share}: {at_once:?}");
        }
    }
}
