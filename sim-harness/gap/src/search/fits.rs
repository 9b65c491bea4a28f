//! All that a search needs: whitened rows, the candidates' families, and the fits of models.

use crate::candidate::{Family, Offer, Shape, Term};
use crate::candidates::{self, sensors};
use crate::data::{believed::Context, rows::Row};
use crate::fit::{Base, Gain};
use crate::noise::{calibrate::Calibrated, whitening::Whitening};
use crate::search::scan::Scan;
use nalgebra::DVector;
use std::{cell::RefCell, collections::HashMap, rc::Rc};

pub struct Search<'a> {
    pub context: &'a Context<'a>,
    pub rows: &'a [Row],
    pub whitening: Whitening,
    y: DVector<f64>,
    /// Whitened columns of what sensors do; part of every fit.
    sensors: Vec<DVector<f64>>,
    /// What is looked among.
    pub families: Vec<Family>,
    /// Of those families that are sections.
    pub scans: Vec<Scan>,
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
        let families: Vec<Family> = candidates::searched().flat_map(|candidate| candidate.families(&offer)).collect();
        let scan = |family: &Family| match family {
            Family::Section(term) => Some(Scan::new(term.clone(), context, rows, &whitening)),
            Family::Shapes(_) | Family::Linearised(_) | Family::Whole(_) | Family::Runs(_) => None,
        };
        let scans = families.iter().filter_map(scan).collect();
        let sensors = sensors(context, rows, &whitening);
        Self { context, rows, whitening, y, sensors, families, scans, known: RefCell::default() }
    }

    pub fn white(&self, term: &Term) -> Rc<Vec<DVector<f64>>> {
        let key = format!("{term:?}");
        if let Some(known) = self.known.borrow().get(&key) {
            return Rc::clone(known);
        }
        let columns = term.columns(self.context, self.rows);
        let white = Rc::new(columns.iter().map(|c| self.whitening.whiten(c)).collect());
        self.known.borrow_mut().insert(key, Rc::clone(&white));
        white
    }

    /// The fit of a model: its coefficients in the order of the terms, then those of sensors.
    pub fn base(&self, model: &[Term]) -> Option<Base> {
        let whole = model.iter().filter(|term| term.is_whole());
        let y = whole.fold(self.y.clone(), |y, term| y - &self.white(term)[0]);
        let free = model.iter().filter(|term| !term.is_whole());
        let free: Vec<_> =
            free.flat_map(|term| self.white(term).to_vec()).chain(self.sensors.iter().cloned()).collect();
        Base::new(&y, &free, self.whitening.runs())
    }

    /// What a term brings beside a model. The coefficient of a whole term is 1, so its gain is not that of a free fit.
    pub fn gain(&self, base: &Base, term: &Term) -> Option<Gain> {
        let columns: Vec<DVector<f64>> =
            term.columns(self.context, self.rows).iter().map(|column| self.whitening.whiten(column)).collect();
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

/// Whitened columns of what sensors do, as far as these rows can show it.
pub fn sensors(context: &Context<'_>, rows: &[Row], whitening: &Whitening) -> Vec<DVector<f64>> {
    let columns = [sensors::DELAY, sensors::LATE_LOCATION].map(|of| of.columns(&Shape::Law, context, rows).remove(0));
    let shown = columns.iter().filter(|c| c.iter().any(|v| *v != 0.0));
    shown.map(|column| whitening.whiten(column)).collect()
}
