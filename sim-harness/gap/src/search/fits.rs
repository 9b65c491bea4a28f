//! All that a search needs: whitened rows, the candidates' families, and the fits of models.

use crate::candidate::{Family, Offer, Shape, Term};
use crate::candidates::{self, sensors};
use crate::data::believed::{Believed, Context};
use crate::data::rows::Row;
use crate::fit::{Base, Gain};
use crate::noise::calibrate::{Calibrated, effort};
use crate::noise::dragging_units::Units;
use crate::noise::whitening::Whitening;
use crate::search::scan::Scan;
use nalgebra::DVector;
use rundown::model::effects::EffectKind;
use rundown::model::train::{Train, TrainDescription};
use rundown_check::figure::Figure;
use std::{cell::RefCell, collections::HashMap, rc::Rc};

/// Length of a train that is no more than its front, m: the shortest that is allowed.
const FRONT_M: f64 = 1.0;

pub struct Search<'a> {
    pub context: &'a Context<'a>,
    pub rows: &'a [Row],
    pub whitening: Whitening,
    /// The same without what all runs have alike: each run by itself.
    pub(super) apart: Whitening,
    y: DVector<f64>,
    /// Whitened columns of what sensors do; part of every fit.
    sensors: Vec<DVector<f64>>,
    /// The train without its length.
    front: Train,
    /// What is looked among.
    pub families: Vec<Family>,
    /// What these data cannot name, for want of an effort column: no term of a model, but it may be what one of them is
    /// taken for.
    pub(super) unsearched: Vec<Family>,
    /// Of those families that are sections.
    pub scans: Vec<Scan>,
    /// What units may differ by.
    pub(super) units: Units<'a>,
    /// The largest extra resistance of a row that a term may have, N/kg.
    pub(super) most_extra: Vec<f64>,
    /// Whitened columns of terms that were tried, by their text.
    known: RefCell<HashMap<String, Rc<Vec<DVector<f64>>>>>,
}

impl<'a> Search<'a> {
    /// Prepares the search. `measured`: with an effort column.
    pub fn new(context: &'a Context<'a>, rows: &'a [Row], calibrated: &Calibrated, measured: bool) -> Self {
        let whitening = calibrated.whitening(context, rows);
        // Winds that differ from run to run are more resistance in the mean: (v + w)² is v² + w².
        let by_winds = context.believed.train().davis().r2 * calibrated.own.wind_mps.powi(2);
        let y = rows.iter().map(|row| row.residual_n_per_kg - by_winds);
        let y = whitening.whiten(&y.collect::<Vec<f64>>());
        let offer = Offer { context, rows, measured };
        let with_effort = Offer { measured: true, ..offer };
        let (mut families, mut unsearched) = (Vec::new(), Vec::new());
        for candidate in candidates::searched() {
            let own = candidate.families(&offer);
            if own.is_empty() {
                unsearched.extend(candidate.families(&with_effort));
            }
            families.extend(own);
        }
        let scan = |family: &Family| match family {
            Family::Section(term) => Some(Scan::new(term.clone(), context, rows, &whitening)),
            Family::Shapes(_) | Family::Linearised(_) | Family::Whole(_) | Family::Runs(_) => None,
        };
        let scans = families.iter().filter_map(scan).collect();
        let sensors = sensors(context, rows, &whitening);
        let train = context.believed.train();
        // Nothing but the length differs, and this one is allowed.
        let front = Train::try_new(TrainDescription { length_m: FRONT_M, ..*train.description() }).unwrap_or(*train);
        let units = Units::of(context, rows);
        let (apart, known) = (calibrated.without_nuisances(context, rows), RefCell::default());
        let most_extra = most_extra(context, rows);
        Self {
            context,
            rows,
            whitening,
            apart,
            y,
            sensors,
            front,
            families,
            unsearched,
            scans,
            units,
            most_extra,
            known,
        }
    }

    pub fn white(&self, term: &Term) -> Rc<Vec<DVector<f64>>> {
        self.cached(format!("{term:?}"), || self.whitened(term, self.context, &self.whitening))
    }

    /// The same with each run by itself.
    pub(super) fn white_apart(&self, term: &Term) -> Rc<Vec<DVector<f64>>> {
        self.cached(format!("apart {term:?}"), || self.whitened(term, self.context, &self.apart))
    }

    fn whitened(&self, term: &Term, context: &Context<'_>, whitening: &Whitening) -> Vec<DVector<f64>> {
        term.columns(context, self.rows).iter().map(|column| whitening.whiten(column)).collect()
    }

    fn cached(&self, key: String, columns: impl FnOnce() -> Vec<DVector<f64>>) -> Rc<Vec<DVector<f64>>> {
        if let Some(known) = self.known.borrow().get(&key) {
            return Rc::clone(known);
        }
        let white = Rc::new(columns());
        self.known.borrow_mut().insert(key, Rc::clone(&white));
        white
    }

    /// The fit of a model: its coefficients in the order of the terms, then those of sensors, then those of the ends of
    /// its sections, in their order.
    pub fn base(&self, model: &[Term]) -> Option<Base> {
        let whole = model.iter().filter(|term| term.is_whole());
        let y = whole.fold(self.y.clone(), |y, term| y - &self.white(term)[0]);
        let free = model.iter().filter(|term| !term.is_whole());
        let free = free.flat_map(|term| self.white(term).to_vec()).chain(self.sensors.iter().cloned());
        let sections = model.iter().filter(|term| term.section().is_some());
        let free: Vec<_> = free.chain(sections.map(|section| self.at_ends(section)[0].clone())).collect();
        Base::new(&y, &free, self.whitening.runs())
    }

    /// What a section would do at its ends, more than its law has it, if it acted on the front of the train alone: how
    /// a resistance grows where a train comes in differs from tunnel to tunnel, and is no further effect.
    fn at_ends(&self, section: &Term) -> Rc<Vec<DVector<f64>>> {
        let front = Context { believed: Believed::new(&self.front, self.context.believed.track()), ..*self.context };
        self.cached(format!("ends {section:?}"), || {
            let of_front = self.whitened(section, &front, &self.whitening);
            of_front.iter().zip(self.white(section).iter()).map(|(front, train)| front - train).collect()
        })
    }

    /// What a term brings beside a model. The coefficient of a whole term is 1, so its gain is not that of a free fit.
    pub fn gain(&self, base: &Base, term: &Term) -> Option<Gain> {
        let columns = self.whitened(term, self.context, &self.whitening);
        if !term.is_whole() {
            return base.gain(&columns);
        }
        let column = base.beside(&columns[0]);
        let mut gain = base.gain(core::slice::from_ref(&column))?;
        let naive = base.residual.dot(&column) - 0.5 * column.norm_squared();
        gain.gain *= naive / gain.naive_gain.max(1e-12);
        gain.naive_gain = naive;
        Some(gain)
    }

    /// Gain of the effort column less 1 beside a model, as the prior and the rows have it; none without the column.
    pub fn effort_gain(&self, model: &[Term]) -> Option<Figure> {
        let config = &self.context.config.nuisance;
        let effort = effort(self.rows);
        if effort.iter().all(|effort| *effort == 0.0) {
            return None;
        }
        let base = self.base(model)?;
        let column = self.whitening.whiten(&effort);
        let variance = config.effort_gain_sd.powi(2);
        let value = variance * column.dot(&base.residual);
        let left = variance - variance * variance * base.beside(&column).norm_squared();
        // Of the effort that is read; the gain is one of the true one.
        let of_true = 1.0 / (1.0 - value);
        Some(Figure { value: value * of_true, sd: left.max(0.0).sqrt().hypot(config.gain_sd) * of_true * of_true })
    }

    /// Another mass beside a column that reads right would do nearly what this gain does: it would change the air drag
    /// by so little that these rows do not show it.
    pub fn may_be_mass(&self, model: &[Term], gain: Figure) -> bool {
        let mass = Term { of: candidates::of(EffectKind::MassError), shape: Shape::Law };
        let Some(base) = self.base(model).filter(|_| !model.iter().any(|term| term.is_like(&mass))) else {
            return false;
        };
        let instead = base.beside(&self.white(&mass)[0]) * gain.value;
        let better = base.residual.dot(&instead) - 0.5 * instead.norm_squared();
        better > -self.context.config.certainty.rival_within * base.dispersion()
    }

    /// Penalised log-likelihood of a model.
    pub fn score(&self, model: &[Term]) -> f64 {
        let Some(base) = self.base(model) else {
            return f64::NEG_INFINITY;
        };
        let enough = self.context.config.search.enough;
        let penalties: f64 = model.iter().map(|term| term.penalty(self.context, self.rows) + enough).sum();
        0.5 * self.y.norm_squared() - base.half_sum() - penalties
    }
}

/// More than so much extra resistance is too few rows for so many coefficients, N/kg. A share of what is believed and
/// of what the described curves may add to it: a tram in a curve of 100 m has twice its resistance on straight track,
/// and in a tight one of an old town ten times.
fn most_extra(context: &Context<'_>, rows: &[Row]) -> Vec<f64> {
    let (davis, config) = (context.believed.train().davis(), &context.config.search);
    let curves = Term { of: candidates::of(EffectKind::CurveResistance), shape: Shape::Law };
    let curves = curves.columns(context, rows).remove(0);
    let most = |(row, in_curves): (&Row, f64)| {
        let believed = davis.resistance_n_per_kg(row.interval.mean_speed_mps());
        config.most_share * (believed + in_curves) + config.most_beyond_n_per_kg
    };
    rows.iter().zip(curves).map(most).collect()
}

/// Whitened columns of what sensors do, as far as these rows can show it.
pub fn sensors(context: &Context<'_>, rows: &[Row], whitening: &Whitening) -> Vec<DVector<f64>> {
    let columns = [sensors::DELAY, sensors::BEND, sensors::LATE_LOCATION]
        .map(|of| of.columns(&Shape::Law, context, rows).remove(0));
    let shown = columns.iter().filter(|c| c.iter().any(|v| *v != 0.0));
    shown.map(|column| whitening.whiten(column)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::believed::{Surroundings, tests::on_a_level_line};
    use crate::noise::whitening::Noise;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};
    use rundown::model::{curves::roeckl, direction::Direction};

    /// What a search finds.
    struct Found {
        terms: Vec<Term>,
        /// What it leaves to the effort column.
        gain: Figure,
        may_be_mass: bool,
    }

    /// Of 30 runs that power, coast and brake at these speeds, m/s, of a train that is heavier by a share of its mass,
    /// beside an effort column that reads too much by a share.
    fn found(heavier: f64, gain: f64, speeds: core::ops::Range<f64>, seed: u64) -> Found {
        on_a_level_line(30, |context| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let r2 = context.believed.train().davis().r2;
            let mut rows = Vec::new();
            for i in 0..30 * 60 {
                let mut row = Row::coasting(Direction::Up, 900.0 * f64::from(i % 60), rng.random_range(speeds.clone()));
                row.interval.run = i as usize / 60;
                let effort: f64 = [0.0, 0.05, 0.2, -0.15][i as usize % 4];
                let speed = row.interval.mean_speed_mps();
                let noise: f64 = StandardNormal.sample(&mut rng);
                row.effort_n_per_kg = effort * (1.0 + gain);
                row.residual_n_per_kg =
                    effort * gain + heavier / (1.0 + heavier) * (effort - r2 * speed * speed) + 0.005 * noise;
                row.interval.effort_n_per_kg = Some(row.effort_n_per_kg);
                rows.push(row);
            }
            let noise = Noise { acceleration_mps2: 0.005, ..Noise::default() };
            let calibrated = Calibrated::even(noise, rows.len());
            let search = Search::new(context, &rows, &calibrated, true);
            let terms = search.select();
            let gain = search.effort_gain(&terms).unwrap();
            Found { may_be_mass: search.may_be_mass(&terms, gain), terms, gain }
        })
    }

    #[test]
    fn an_effort_column_that_reads_too_much_is_no_mass() {
        for (seed, gain) in [(1, 0.1), (2, -0.08), (3, 0.0)] {
            let found = found(0.0, gain, 8.0..45.0, seed);
            assert_eq!(found.terms, []);
            let figure = found.gain;
            assert!((figure.value - gain).abs() < 3.0 * figure.sd && figure.sd < 0.01, "{figure:?} for {gain}");
            // None is as well a train of no other mass.
            assert_eq!(found.may_be_mass, gain == 0.0);
        }
    }

    #[test]
    fn a_heavier_train_is_one_and_leaves_the_effort_column_as_it_is() {
        for (seed, heavier) in [(4, 0.1), (5, -0.06)] {
            let Found { terms, gain, may_be_mass } = found(heavier, 0.0, 8.0..45.0, seed);
            assert!(matches!(terms.as_slice(), [term] if term.is(EffectKind::MassError)), "{terms:?}");
            assert!(gain.away_from(0.0) < 3.0 && !may_be_mass, "{gain:?}");
        }
    }

    #[test]
    fn of_trains_that_are_slow_the_gain_of_the_effort_may_be_the_mass() {
        for (seed, heavier, gain) in [(6, 0.0, 0.05), (7, 0.05, 0.0)] {
            let found = found(heavier, gain, 3.0..9.0, seed);
            assert_eq!(found.terms, []);
            assert!((found.gain.value - 0.05).abs() < 0.01 && found.may_be_mass, "{:?}", found.gain);
        }
    }

    #[test]
    fn curves_may_cost_more_than_the_train_on_straight_track() {
        on_a_level_line(30, |context| {
            // A kilometre in three is a curve of 120 m: four times the resistance of the slow train.
            let curve = |i: u32| (3e3 * f64::from(i), 3e3 * f64::from(i) + 1e3, roeckl(120.0));
            let surroundings = Surroundings { curves: (0..20).map(curve).collect(), ..Surroundings::default() };
            let context = &Context { surroundings: &surroundings, ..*context };
            let mut rng = ChaCha8Rng::seed_from_u64(8);
            let row = |i: usize| {
                let mut row = Row::coasting(Direction::Up, 900.0 * (i % 60) as f64, rng.random_range(6.0..14.0));
                row.interval.run = i / 60;
                row
            };
            let mut rows: Vec<Row> = (0..30 * 60).map(row).collect();
            let curves = Term { of: candidates::of(EffectKind::CurveResistance), shape: Shape::Law };
            let extra = curves.extra(&[1.0], context, &rows);
            for (row, extra) in rows.iter_mut().zip(extra) {
                let noise: f64 = StandardNormal.sample(&mut rng);
                row.residual_n_per_kg = extra + 0.003 * noise;
            }
            let noise = Noise { acceleration_mps2: 0.003, ..Noise::default() };
            let calibrated = Calibrated::even(noise, rows.len());
            assert_eq!(Search::new(context, &rows, &calibrated, false).select(), [curves]);
        });
    }
}
