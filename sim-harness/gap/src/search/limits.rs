//! How sure a term is: what no spread of rows or runs shows, and where the edges of a section may lie.

use crate::candidate::{SectionLimits, Shape, Term};
use crate::fit::{Base, Gain, LOSS_AT_LIMIT};
use crate::search::fits::Search;
use rundown_check::figure::HALF_95;

impl Search<'_> {
    /// Its sign is sure, whatever differs in all rows alike.
    pub fn is_sure(&self, term: &Term, gain: &Gain) -> bool {
        // The other coefficient of a temperature is a constant.
        let one = gain.beta.len() == 1 || term.of.facts().nature.constant_beside;
        let (beta, systematic) = (gain.beta.iter().next(), self.in_all_rows(term));
        let (true, Some(beta), Some(systematic)) = (one, beta, systematic.first()) else {
            return true;
        };
        let sd = gain.naive[(0, 0)].max(gain.robust[(0, 0)]).sqrt();
        beta.abs() > HALF_95 * sd.hypot(*systematic)
    }

    /// What a difference that sensors make in all rows alike would make of each coefficient of a term where it acts.
    fn in_all_rows(&self, term: &Term) -> Vec<f64> {
        let columns = term.columns(self.context, self.rows);
        let size = |column: Vec<f64>| {
            let acting = || column.iter().filter(|value| **value != 0.0);
            let square = acting().map(|value| value * value).sum::<f64>();
            (square / acting().count().max(1) as f64).sqrt()
        };
        let of = |size: f64| {
            if size > 0.0 { self.context.config.certainty.nothing_n_per_kg / size } else { 0.0 }
        };
        columns.into_iter().map(size).map(of).collect()
    }

    /// Standard deviations of a term's coefficients that no spread of rows or runs shows: a difference in all rows
    /// alike, and Davis coefficients that were taken as described.
    pub fn systematic(&self, model: &[Term], index: usize) -> Vec<f64> {
        let mut sd = self.in_all_rows(&model[index]);
        let Shape::Powers(wrong) = model[index].shape else {
            return sd;
        };
        let free = |term: &&Term| !term.is_whole();
        let before: usize = model[..index].iter().filter(free).map(Term::count).sum();
        let columns: Vec<_> = model.iter().filter(free).flat_map(|term| self.white(term).to_vec()).collect();
        let davis = self.context.believed.train().davis();
        for (k, described) in [davis.r0, davis.r1, davis.r2].into_iter().enumerate().filter(|(k, _)| !wrong[*k]) {
            let mut alone = [false; 3];
            alone[k] = true;
            let left_out = self.white(&model[index].with(Shape::Powers(alone)));
            if let Some(base) = Base::new(&left_out[0], &columns, self.whitening.runs()) {
                for (sd, beta) in sd.iter_mut().zip(base.beta.iter().skip(before)) {
                    *sd = sd.hypot(self.context.config.certainty.described * described * beta);
                }
            }
        }
        sd
    }

    /// 95 % limits of a section: how far its edges may move, one by one and both together, before the log-likelihood
    /// has lost what is allowed, and where its coefficient goes meanwhile. `half`: how far the limits of the
    /// coefficient `fitted` are from it where the edges stay.
    pub fn section(&self, others: &[Term], term: &Term, half: f64, fitted: f64) -> Option<SectionLimits> {
        let section = term.section()?;
        let base = self.base(others)?;
        let gain = |section: [f64; 2]| self.gain(&base, &term.with(Shape::Section(section)));
        let best = gain(section)?;
        let (mut edges_m, mut of_beta) = (section.map(|at| (at, at)), (best.beta[0], best.beta[0]));
        let mut include = |section: [f64; 2], beta: f64, lost: f64| {
            let half = half * (1.0 - lost / LOSS_AT_LIMIT).max(0.0).sqrt();
            of_beta = (of_beta.0.min(beta - half), of_beta.1.max(beta + half));
            for (limits, at) in edges_m.iter_mut().zip(section) {
                *limits = (limits.0.min(at), limits.1.max(at));
            }
        };
        include(section, best.beta[0], 0.0);
        for (edge, by) in [(0, -40.0), (0, 40.0), (1, -40.0), (1, 40.0)] {
            let mut moved = section;
            for _ in 0..60 {
                moved[edge] += by;
                let lost = |gain: &Gain| (best.gain - gain.gain).max(0.0);
                let found = gain(moved).filter(|gain| lost(gain) < LOSS_AT_LIMIT);
                let Some(found) = found.filter(|_| moved[1] - moved[0] >= 50.0) else {
                    // The limit is no nearer than this.
                    include(moved, best.beta[0], LOSS_AT_LIMIT);
                    break;
                };
                include(moved, found.beta[0], lost(&found));
            }
        }
        // Where runs differ more than the noise model says, so much more may be lost.
        let wider = (best.naive_gain / best.gain.max(1e-9)).max(1.0);
        for scan in self.scans.iter().filter(|scan| scan.term.is_like(term)) {
            for (section, beta, lost) in scan.within(&base, best.naive_gain, wider * LOSS_AT_LIMIT) {
                include(section, beta, lost / wider);
            }
        }
        Some(SectionLimits { edges_m, share: (of_beta.0 / fitted, of_beta.1 / fitted) })
    }
}
