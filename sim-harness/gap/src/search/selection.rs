//! Which terms are missing: forward selection by penalised gain of log-likelihood, with a backward re-check of each
//! term.
//!
//! Each family (one named effect, or a smooth function of one coordinate) offers its best shape beside the current
//! model. Its value is the gain, scaled down where runs differ more than the noise model says, minus the penalty of its
//! freedom.

use crate::candidate::{Family, Shape, Size, Term};
use crate::fit::{Base, Gain, choices};
use crate::noise::{dragging::RunScore, dragging_units::choice};
use crate::search::{fits::Search, scan::Scan, shape};
use std::collections::BTreeMap;

/// A term with what was found of it.
#[derive(Clone, Debug)]
pub struct Found {
    /// The term, its shape chosen.
    pub term: Term,
    /// What it brings beside the others.
    pub gain: Gain,
    /// `gain` less the penalty of its freedom.
    pub value: f64,
}

fn best(found: impl Iterator<Item = Found>) -> Option<Found> {
    found.max_by(|a, b| a.value.total_cmp(&b.value))
}

impl Search<'_> {
    fn enough(&self) -> f64 {
        self.context.config.search.enough
    }

    /// The best shape of each family beside a model, best first.
    pub fn candidates(&self, model: &[Term]) -> Vec<Found> {
        self.offered(self.families.iter(), model)
    }

    /// All that would explain what a term does, best first: the candidates beside the other terms, and what these data
    /// cannot name.
    pub fn in_place(&self, others: &[Term]) -> Vec<Found> {
        self.offered(self.families.iter().chain(&self.unsearched), others)
    }

    /// Sections beside a model, one of each kind, that gain enough and are refused all the same: drivers may have made
    /// what shows them, or a part of the rows denies them.
    fn refused_sections(&self, base: &Base) -> Vec<Term> {
        let refused = |scan: &Scan| {
            let term = scan.term.with(Shape::Section(scan.refined(base)?));
            let gain = base.gain(&self.white(&term))?;
            let beta = gain.beta.as_slice();
            let value = gain.gain.min(gain.without_best) - term.penalty(self.context, self.rows);
            let refused = value > self.enough() && self.is_plausible(&term, beta) && !self.agrees(base, &term, beta);
            refused.then_some(term)
        };
        self.scans.iter().filter_map(refused).collect()
    }

    /// Whether a section that is refused explains what a term does: beside it the term gains too little. What is
    /// refused as an effect is there all the same, and the term may be its shadow.
    pub fn may_be_refused_section(&self, others: &[Term], term: &Term) -> bool {
        let penalty = term.penalty(self.context, self.rows);
        let explains = |section: Term| {
            let base = self.base(&[others, &[section]].concat());
            let gain = base.and_then(|base| self.gain(&base, term));
            gain.is_none_or(|gain| gain.gain - penalty < self.enough())
        };
        self.base(others).is_some_and(|base| self.refused_sections(&base).into_iter().any(explains))
    }

    fn offered<'f>(&self, families: impl Iterator<Item = &'f Family>, model: &[Term]) -> Vec<Found> {
        let Some(base) = self.base(model) else {
            return Vec::new();
        };
        let mut found: Vec<Found> = families.filter_map(|family| self.best_of(family, &base, model)).collect();
        found.sort_by(|a, b| b.value.total_cmp(&a.value));
        found
    }

    fn best_of(&self, family: &Family, base: &Base, model: &[Term]) -> Option<Found> {
        let terms = match family {
            Family::Whole(terms) => return self.best_whole(terms, base, model),
            Family::Shapes(terms) => terms.clone(),
            Family::Section(term) => {
                let scan = self.scans.iter().find(|scan| scan.term.is_like(term))?;
                vec![term.with(Shape::Section(scan.refined(base)?))]
            }
            Family::Linearised(term) => {
                let mut at = 0.0;
                for _ in 0..3 {
                    at = base.gain(&self.white(&term.with(Shape::Number(at))))?.beta[0];
                }
                vec![term.with(Shape::Number(at))]
            }
            Family::Runs(term) => vec![self.best_runs(term, base)?],
        };
        let terms = terms.into_iter().filter(|term| {
            // A board takes one table.
            let second = term.is_unnamed() && model.iter().any(Term::is_unnamed);
            !second && (term.section().is_some() || !model.iter().any(|other| other.is_like(term)))
        });
        let best = best(terms.filter_map(|term| self.found(term, base)))?;
        if best.value < self.enough() {
            return Some(best);
        }
        match shape::refined(self, base, best.term.clone()) {
            same if same == best.term => Some(best),
            finer => self.found(finer, base).or(Some(best)),
        }
    }

    /// What a term brings, if it is plausible and nothing contradicts it.
    fn found(&self, term: Term, base: &Base) -> Option<Found> {
        let gain = base.gain(&self.white(&term))?;
        if !self.is_plausible(&term, gain.beta.as_slice()) {
            return None;
        }
        let penalty = term.penalty(self.context, self.rows);
        let (value, sure) = (gain.naive_gain - penalty, gain.gain - penalty);
        // A gain that rests on a few runs is worth what it is worth run by run.
        let few = matches!(term.shape, Shape::Runs(_));
        let sure = if few { sure } else { sure.min(gain.without_best - penalty) };
        let value = if sure > self.enough() { value } else { value.min(sure) };
        let sure = || self.is_sure(&term, &gain);
        let agrees = || self.agrees(base, &term, gain.beta.as_slice());
        if value > self.enough() && !(sure() && agrees()) {
            return None;
        }
        Some(Found { term, gain, value })
    }

    /// Large enough to matter to a train: what is smaller is left to the Davis coefficients' uncertainty and to
    /// sensors. Nor more than the train's whole resistance, by too few rows for so many coefficients.
    fn is_plausible(&self, term: &Term, beta: &[f64]) -> bool {
        let absurd = || {
            let extra = term.extra(beta, self.context, self.rows);
            self.most_extra.iter().zip(extra).any(|(most, extra)| extra.abs() > *most)
        };
        let may_be_large = term.section().is_some() || term.of.facts().nature.may_be_large;
        let size = Size { term, beta, context: self.context, rows: self.rows };
        (may_be_large || !absurd()) && term.of.is_plausible(&size)
    }

    /// A whole term is a column of its own: its coefficient is 1.
    fn best_whole(&self, terms: &[Term], base: &Base, model: &[Term]) -> Option<Found> {
        let found = |term: Term| {
            let gain = self.gain(base, &term)?;
            let value = gain.gain - term.penalty(self.context, self.rows);
            if value > self.enough() && !self.agrees(base, &term, &[1.0]) {
                return None;
            }
            Some(Found { term, gain, value })
        };
        // One train has one length beside the one described.
        let name = terms.first()?.of.name();
        if model.iter().any(|other| other.of.name() == name) {
            return None;
        }
        let left = self.left_in_runs(model);
        let in_some = left.iter().flat_map(|left| terms.iter().filter_map(|term| self.in_some_runs(term, left)));
        let best = best(terms.iter().cloned().chain(in_some).filter_map(found))?;
        if best.value < self.enough() {
            return Some(best);
        }
        found(shape::refined(self, base, best.term))
    }

    /// The runs in which a constant resistance after the first brake application, the same in all of them, explains
    /// most.
    fn best_runs(&self, term: &Term, base: &Base) -> Option<Term> {
        let all: Vec<usize> = self.rows.iter().map(|row| row.interval.run).collect();
        let column = base.beside(&self.white(&term.with(Shape::Runs(all)))[0]);
        let mut of_runs = RunScore::of_runs(self.rows, self.whitening.runs(), &column, &base.residual);
        of_runs.retain(|run| run.information > 0.0);
        let sums = |chosen: &[&RunScore]| {
            let add = |(a, b): (f64, f64), run: &&RunScore| (a + run.score, b + run.information);
            chosen.iter().fold((0.0, 0.0), add)
        };
        let mut best: Option<(f64, Vec<usize>)> = None;
        for RunScore { score, information, .. } in &of_runs {
            let mut drag = score / information;
            if drag <= 0.0 {
                continue;
            }
            let mut chosen: Vec<&RunScore> = Vec::new();
            for _ in 0..6 {
                chosen = of_runs.iter().filter(|run| run.gain(drag) > self.context.config.between_runs.drags).collect();
                let (g, i) = sums(&chosen);
                if i <= 0.0 {
                    break;
                }
                drag = g / i;
            }
            let (g, i) = sums(&chosen);
            let runs: Vec<usize> = chosen.iter().map(|run| run.run).collect();
            let value = if i > 0.0 { 0.5 * g * g / i } else { 0.0 } - choices(runs.len(), of_runs.len());
            if !runs.is_empty() && best.as_ref().is_none_or(|b| value > b.0) {
                best = Some((value, runs));
            }
        }
        let white = |column: &[f64]| base.beside(&self.whitening.whiten(column));
        for runs in self.units.dragging(white, &base.residual) {
            let chosen: Vec<&RunScore> = of_runs.iter().filter(|run| runs.contains(&run.run)).collect();
            let (g, i) = sums(&chosen);
            let value = 0.5 * g * g / i - choice(&runs, self.rows);
            if best.as_ref().is_none_or(|b| value > b.0) {
                best = Some((value, runs));
            }
        }
        let best = best.filter(|(_, runs)| !self.are_of_a_direction(runs));
        best.map(|(_, runs)| term.with(Shape::Runs(runs)))
    }

    /// Most runs of one direction and none of the other: what acts in them is a slope, or a wind.
    fn are_of_a_direction(&self, runs: &[usize]) -> bool {
        let mut of_each = BTreeMap::new();
        for row in self.rows {
            of_each.insert(row.interval.run, row.direction);
        }
        let mut directions = runs.iter().filter_map(|run| of_each.get(run));
        let Some(first) = directions.next().filter(|first| directions.all(|other| other == *first)) else {
            return false;
        };
        let of_first = of_each.values().filter(|direction| *direction == first).count();
        let most = self.context.config.between_runs.most_dragging;
        of_first < of_each.len() && runs.len() as f64 > most * of_first as f64
    }

    pub fn select(&self) -> Vec<Term> {
        let first = self.candidates(&[]);
        let mut best: (f64, Vec<Term>) = (0.0, Vec::new());
        for start in first.iter().filter(|f| f.value > self.enough()).take(self.context.config.search.starts) {
            let mut model = vec![start.term.clone()];
            self.grow(&mut model);
            let score = self.score(&model);
            if score > best.0 + 1e-6 {
                best = (score, model);
            }
        }
        best.1
    }

    fn grow(&self, model: &mut Vec<Term>) {
        let config = &self.context.config.search;
        let left = |model: &[Term]| self.base(model).map(|base| base.half_sum());
        let Some(at_first) = left(&[]) else {
            return;
        };
        // A term that comes and goes would do so for ever.
        for _ in 0..2 * config.most_terms {
            self.reconsider(model);
            if model.len() >= config.most_terms {
                return;
            }
            let Some(now) = left(model) else {
                return;
            };
            let brought = at_first - now;
            let next = self.candidates(model).into_iter().find(|found| {
                // What differs from run to run is no shadow of what acts along the line, nor the reverse.
                let alike = |term: &Term| term.between_runs() == found.term.between_runs();
                let shadow = if model.iter().any(alike) { config.shadow * brought } else { 0.0 };
                found.value > self.enough().max(shadow)
            });
            match next {
                Some(next) => model.push(next.term),
                None => return,
            }
        }
    }

    /// Takes each term out in turn: what would now be best in its place, if anything?
    fn reconsider(&self, model: &mut Vec<Term>) {
        for _ in 0..3 {
            let mut changed = false;
            let mut index = 0;
            while index < model.len() {
                let mut others = model.clone();
                others.remove(index);
                let score = self.score(model);
                match self.candidates(&others).into_iter().next() {
                    Some(found) if found.value > self.enough() => {
                        let mut with = others.clone();
                        with.insert(index, found.term);
                        if with != *model && self.score(&with) > score + self.context.config.search.better {
                            *model = with;
                            changed = true;
                        }
                        index += 1;
                    }
                    _ => {
                        *model = others;
                        changed = true;
                    }
                }
            }
            if !changed {
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::candidates;
    use crate::data::{believed::tests::on_a_level_line, rows::Row};
    use crate::noise::{calibrate::Calibrated, whitening::Noise};
    use rundown::model::{direction::Direction, effects::EffectKind};

    /// Whether a wind may be a section that is refused, of runs that coast in one direction with this much extra
    /// resistance at each place.
    fn may_be_refused(n_per_kg: impl Fn(f64) -> f64) -> bool {
        on_a_level_line(30, |context| {
            let row = |i: usize| {
                let location_m = 500.0 + 1_000.0 * (i % 60) as f64;
                let mut row = Row::coasting(Direction::Up, location_m, 30.0);
                row.interval.run = i / 60;
                row.interval.begin_s = 20.0 * (i % 60) as f64;
                row.residual_n_per_kg = n_per_kg(location_m) + if i.is_multiple_of(2) { 0.001 } else { -0.001 };
                row
            };
            let rows: Vec<Row> = (0..30 * 60).map(row).collect();
            let noise = Noise { acceleration_mps2: 0.002, ..Noise::default() };
            let calibrated = Calibrated::even(noise, rows.len());
            let search = Search::new(context, &rows, &calibrated, false);
            let wind = Term { of: candidates::of(EffectKind::SteadyWind), shape: Shape::Number(0.0) };
            search.may_be_refused_section(&[], &wind)
        })
    }

    #[test]
    fn a_wind_that_is_all_in_a_section_which_drivers_may_have_made_may_be_that_section() {
        let within = |location_m: f64| (20_000.0..30_000.0).contains(&location_m);
        // Less resistance there: light power. More of it no driver without brakes can make, and it is not refused.
        assert!(may_be_refused(|location_m| if within(location_m) { -0.01 } else { 0.0 }));
        assert!(!may_be_refused(|location_m| if within(location_m) { 0.01 } else { 0.0 }));
        // Less everywhere is the wind; beside it a section is another matter.
        assert!(!may_be_refused(|_| -0.005));
        assert!(!may_be_refused(|location_m| if within(location_m) { -0.02 } else { -0.005 }));
    }
}
