//! What an effect is to the workflow: one trait, one file below `candidates/` for each kind.
//!
//! A [`Term`] is a candidate with its shape chosen (a section, a time constant, runs): the columns of a linear fit, one
//! for each free coefficient. Effects that do not act on the resistance offer no terms; they are named from the
//! findings of another stage ([`Candidate::beside`]).

use crate::axis::Axis;
use crate::columns::{both_directions, coordinate};
use crate::config::{PenaltyConfig, PriorChange};
use crate::data::{believed::Context, interval::Interval, rows::Row};
use crate::named::{Interval95, Named, around};
use crate::readings::kinematics::Kinematics;
use crate::traction::limit::FoundLimit;
use rand_chacha::ChaCha8Rng;
use rundown::model::effects::{Coordinate, Effect};
use rundown::model::{effects::EffectKind, resistance::Davis};
use serde_json::Value;
use std::fmt;

/// What is chosen of a term beside its coefficients.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Nothing.
    Law,
    /// Which of 1, v, v².
    Powers([bool; 3]),
    /// A section of the line, m.
    Section([f64; 2]),
    /// A time constant, a speed, a length.
    Number(f64),
    /// Such a number, and a second one.
    Numbers(f64, f64),
    /// The runs in which it acts.
    Runs(Vec<usize>),
    /// A number, and the runs in which it acts.
    NumberInRuns(f64, Vec<usize>),
    /// Constant below a value of a coordinate, or above another; a straight line between the two.
    Step(Coordinate, [f64; 2], Side),
    /// Piecewise linear along a coordinate, with these knots.
    Table(Coordinate, Vec<f64>),
}

/// On which side of its value a step acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    Below,
    Above,
}

/// What a shape is made of, for the candidate that made it: of another form it has nothing.
impl Shape {
    pub fn number(&self) -> f64 {
        match self {
            Self::Number(number) | Self::Numbers(number, _) | Self::NumberInRuns(number, _) => *number,
            _ => f64::NAN,
        }
    }

    pub fn second_number(&self) -> f64 {
        if let Self::Numbers(_, number) = self { *number } else { f64::NAN }
    }

    /// The same with another number.
    pub fn with_number(&self, number: f64) -> Self {
        match self {
            Self::Numbers(_, second) => Self::Numbers(number, *second),
            Self::NumberInRuns(_, runs) => Self::NumberInRuns(number, runs.clone()),
            _ => Self::Number(number),
        }
    }

    pub fn section(&self) -> [f64; 2] {
        if let Self::Section(section) = self { *section } else { [f64::NAN; 2] }
    }

    pub fn powers(&self) -> [bool; 3] {
        if let Self::Powers(wrong) = self { *wrong } else { [false; 3] }
    }

    pub fn runs(&self) -> &[usize] {
        if let Self::Runs(runs) | Self::NumberInRuns(_, runs) = self { runs } else { &[] }
    }
}

/// A candidate of the resistance with its shape.
#[derive(Clone)]
pub struct Term {
    pub of: &'static dyn Candidate,
    pub shape: Shape,
}

impl fmt::Debug for Term {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {:?}", self.of.name(), self.shape)
    }
}

impl PartialEq for Term {
    fn eq(&self, other: &Self) -> bool {
        self.of.name() == other.of.name() && self.shape == other.shape
    }
}

impl Term {
    /// The same candidate, with a shape of the same form.
    pub fn is_like(&self, other: &Self) -> bool {
        let form = |term: &Self| core::mem::discriminant(&term.shape);
        self.of.name() == other.of.name() && form(self) == form(other)
    }

    pub fn with(&self, shape: Shape) -> Self {
        Self { of: self.of, shape }
    }

    pub fn is(&self, kind: EffectKind) -> bool {
        self.of.facts().kind == Some(kind)
    }

    pub fn columns(&self, context: &Context<'_>, rows: &[Row]) -> Vec<Vec<f64>> {
        self.of.columns(&self.shape, context, rows)
    }

    pub fn count(&self) -> usize {
        coefficients(self.of.facts().nature, &self.shape)
    }

    /// Its column is what it is: the coefficient is 1 and not fitted.
    pub fn is_whole(&self) -> bool {
        self.of.facts().nature.whole
    }

    pub fn section(&self) -> Option<[f64; 2]> {
        match self.shape {
            Shape::Section(section) => Some(section),
            _ => None,
        }
    }

    pub fn by_place(&self) -> bool {
        self.section().is_some() || self.of.facts().nature.by_place
    }

    /// The same all through a run, another in each.
    pub fn between_runs(&self) -> bool {
        match &self.shape {
            Shape::Runs(_) | Shape::Step(..) | Shape::Table(Coordinate::Day | Coordinate::Temperature, _) => true,
            _ => self.of.facts().nature.between_runs,
        }
    }

    pub fn is_unnamed(&self) -> bool {
        self.is(EffectKind::Unknown)
    }

    /// What it adds to the resistance in each row with these coefficients, N/kg.
    pub fn extra(&self, beta: &[f64], context: &Context<'_>, rows: &[Row]) -> Vec<f64> {
        let columns = self.columns(context, rows);
        let of_row = |i: usize| columns.iter().zip(beta).map(|(c, b)| c[i] * b).sum();
        (0..rows.len()).map(of_row).collect()
    }

    /// A table reaches this interval. Laws reach everywhere.
    pub fn covers(&self, interval: &Interval) -> bool {
        let Shape::Table(which, knots) = &self.shape else {
            return true;
        };
        // Few rows lie beyond the last knots but one.
        let inner = knots.get(1).zip(knots.get(knots.len().saturating_sub(2)));
        let at = coordinate(*which, interval, interval.middle());
        at.zip(inner).is_some_and(|(at, (first, last))| (*first..=*last).contains(&at))
    }

    /// Penalty of its freedom, of log-likelihood.
    pub fn penalty(&self, context: &Context<'_>, rows: &[Row]) -> f64 {
        self.of.penalty(&self.shape, &context.penalty(), rows)
    }

    /// What an unnamed section must be better by only because it has no name: it fits as well as one with a name that
    /// is better by no more.
    pub fn unnamed_penalty(&self, context: &Context<'_>) -> f64 {
        let is_section = self.is_unnamed() && self.section().is_some();
        if is_section { context.config.penalty.unnamed } else { 0.0 }
    }
}

/// Terms among which a search looks for the best.
#[derive(Clone, Debug)]
pub enum Family {
    /// Some shapes to try.
    Shapes(Vec<Term>),
    /// The best section of the line; the term is any of them.
    Section(Term),
    /// A law linearised at a value that is its coefficient.
    Linearised(Term),
    /// Shapes whose coefficient is 1.
    Whole(Vec<Term>),
    /// The runs in which a constant acts after the first brake application.
    Runs(Term),
}

/// The data that families are made for.
#[derive(Clone, Copy)]
pub struct Offer<'a> {
    pub context: &'a Context<'a>,
    pub rows: &'a [Row],
    pub measured: bool,
}

/// How a shape that is a number is made finer.
#[derive(Clone, Copy, Debug, Default)]
pub struct Dial {
    pub step: f64,
    /// The range in which it makes sense; the step too is of the logarithm where that is what turns.
    pub range: (f64, f64),
    /// The shape is the exponential of the value.
    pub exponential: bool,
    /// The range of the logarithm of a second number.
    pub second_range: (f64, f64),
}

/// Where an effect shows if it leaves no mean residual.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShowsIn {
    /// The fit of its own law.
    #[default]
    Law,
    /// The effort at full power: it limits the traction, and leaves the motion under a known effort as it is.
    FullPower,
    /// The differences between runs.
    Runs,
    /// Distances by location against those by speed: readings are put right before anything else.
    Readings,
}

/// How a candidate differs from the usual one, for the stages.
#[derive(Clone, Copy, Debug, Default)]
pub struct Nature {
    pub shows_in: ShowsIn,
    /// It acts by place, without being a section.
    pub by_place: bool,
    /// Its force changes its sign with the direction; nothing else does.
    pub turns: bool,
    /// Only an effort column shows it well.
    pub needs_effort: bool,
    /// The same all through a run, another in each.
    pub between_runs: bool,
    /// Its column is what it is: the coefficient is 1 and not fitted.
    pub whole: bool,
    /// Its second coefficient is a constant.
    pub constant_beside: bool,
    /// A matter of places or of the effort: it may be larger than the train's whole resistance.
    pub may_be_large: bool,
}

impl Offer<'_> {
    /// The numbers of a candidate that are tried first. `unit`: how many of the prior's units are one of the shape.
    pub fn numbers(&self, of: &'static dyn Candidate, unit: f64) -> Family {
        let numbers = self.first_numbers(of).into_iter();
        Family::Shapes(numbers.map(|number| Term { of, shape: Shape::Number(number / unit) }).collect())
    }

    /// The same in the prior's unit.
    pub fn first_numbers(&self, of: &dyn Candidate) -> Vec<f64> {
        let changed = self.context.config.prior.get(of.name()).and_then(|change| change.shapes.clone());
        changed.unwrap_or_else(|| of.facts().prior.shapes.to_vec())
    }
}

/// What is always so of a candidate. The first texts are for `--explain`.
#[derive(Clone, Copy, Default)]
pub struct Facts {
    /// None: a matter of sensors, which the board does not need to know.
    pub kind: Option<EffectKind>,
    pub what: &'static str,
    pub law: &'static str,
    pub parameters: &'static str,
    /// How it shows in the residuals.
    pub shows: &'static str,
    /// What it is confounded with.
    pub confused: &'static str,
    /// Which data would separate it.
    pub separates: &'static str,
    pub nature: Nature,
    /// Without a source it has none of its own.
    pub prior: Prior,
    /// The parameter that is the effect's size, and its value without the effect.
    pub size: Option<(&'static str, f64)>,
}

/// The size of a term with its coefficients, on the rows.
pub struct Size<'a> {
    pub term: &'a Term,
    pub beta: &'a [f64],
    pub context: &'a Context<'a>,
    pub rows: &'a [Row],
}

impl Size<'_> {
    fn sorted(&self) -> Vec<f64> {
        let extra = self.term.extra(self.beta, self.context, self.rows).into_iter();
        let mut sizes: Vec<f64> = extra.map(f64::abs).collect();
        sizes.sort_by(f64::total_cmp);
        sizes
    }

    /// The largest extra resistance, N/kg.
    pub fn most(&self) -> f64 {
        self.sorted().last().copied().unwrap_or(0.0)
    }

    /// What acts always must be seen in more than the few slowest or fastest rows: exceeded in a fifth of them, N/kg.
    pub fn often(&self) -> f64 {
        self.sorted().get(self.rows.len() * 4 / 5).copied().unwrap_or(0.0)
    }

    pub fn least(&self) -> f64 {
        range(self.term.of, self.context).0
    }

    pub fn largest(&self) -> f64 {
        range(self.term.of, self.context).1
    }
}

/// Smallest size of a candidate that matters, and the largest that is possible.
pub fn range(of: &dyn Candidate, context: &Context<'_>) -> (f64, f64) {
    let prior = of.facts().prior;
    let change = context.config.prior.get(of.name());
    let of = |one: fn(&PriorChange) -> Option<f64>, other: f64| change.and_then(one).unwrap_or(other);
    (of(|change| change.least, prior.least), of(|change| change.most, prior.most))
}

/// What is believed of the size of an effect, and the shapes that are tried first; a file may change it.
#[derive(Clone, Copy, Debug)]
pub struct Prior {
    pub least: f64,
    pub most: f64,
    pub shapes: &'static [f64],
    /// Units and source of these.
    pub source: &'static str,
}

impl Default for Prior {
    fn default() -> Self {
        Self::least(0.0, "")
    }
}

impl Prior {
    /// Sizes from `least` on.
    pub const fn least(least: f64, source: &'static str) -> Self {
        Self { least, most: f64::INFINITY, shapes: &[], source }
    }
}

/// 95 % limits of a section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionLimits {
    pub edges_m: [(f64, f64); 2],
    /// Of its coefficient, as shares of it: the section may be another, and go by another name.
    pub share: (f64, f64),
}

/// 95 % limits of a shape that is a number, and of the coefficient that goes with it: where the shape moves, the
/// coefficient follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeLimits {
    pub shape: (f64, f64),
    pub beta: (f64, f64),
    /// Of its second number.
    pub second: Option<(f64, f64)>,
}

/// A term with its coefficients.
#[derive(Clone, Debug)]
pub struct Fitted {
    pub term: Term,
    pub beta: Vec<f64>,
    /// Their standard deviations: the larger of noise model and spread between runs, and what sensors may do in all
    /// runs alike.
    pub sd: Vec<f64>,
    /// Log-likelihood that would be lost without it.
    pub gain: f64,
    /// How many times less than the noise says a difference of log-likelihood counts for it, at least 1: the noise does
    /// not fit, or runs differ.
    pub dispersion: f64,
    pub section: Option<SectionLimits>,
    /// Limits of a shape that is a number.
    pub shape: Option<ShapeLimits>,
    /// Others that would do nearly as well in its place, with how much worse they are.
    pub rivals: Vec<(Term, f64)>,
    /// Without an effort column: drivers who brake lightly on descents would show it as well.
    pub may_be_brakes: bool,
}

impl Fitted {
    /// A term whose coefficients are known.
    #[cfg(test)]
    pub(crate) fn certain(term: Term, beta: Vec<f64>) -> Self {
        let sd = vec![0.0; beta.len()];
        Self {
            term,
            beta,
            sd,
            gain: 0.0,
            dispersion: 1.0,
            section: None,
            shape: None,
            rivals: Vec::new(),
            may_be_brakes: false,
        }
    }

    /// The value of the first coefficient in a unit, and its 95 % interval; that of a coefficient whose section may be
    /// another is a share of it.
    pub fn first(&self, parameter: &'static str, scale: f64) -> (f64, Interval95) {
        let value = self.beta[0] * scale;
        let interval = match &self.section {
            Some(SectionLimits { share: (a, b), .. }) => {
                (parameter, (value * a).min(value * b), (value * a).max(value * b))
            }
            None => around(parameter, value, self.sd[0] * scale),
        };
        (value, interval)
    }

    /// The first coefficient, the number that is its shape in another unit, and the intervals of both.
    pub fn with_number(&self, parameter: &'static str, number: &'static str, unit: f64) -> (f64, f64, Vec<Interval95>) {
        let intervals = self.shape.map_or_else(Vec::new, |ShapeLimits { shape, beta, .. }| {
            vec![(parameter, beta.0, beta.1), (number, unit * shape.0, unit * shape.1)]
        });
        (self.beta[0], unit * self.term.shape.number(), intervals)
    }

    pub fn edges(&self) -> Vec<Interval95> {
        self.section.as_ref().map_or_else(Vec::new, |SectionLimits { edges_m: [from, to], .. }| {
            vec![("from_m", from.0, from.1), ("to_m", to.0, to.1)]
        })
    }
}

/// What was found, for naming it.
#[derive(Clone, Copy)]
pub struct Naming<'a> {
    pub context: &'a Context<'a>,
    pub runs: &'a [String],
    pub rows: &'a [Row],
    pub measured: bool,
    pub kinematics: &'a Kinematics,
    /// Spread of the wind between runs with its standard deviation, m/s, where runs surely differ by it.
    pub run_wind: Option<(f64, f64)>,
    pub wind_gain: f64,
    /// Limits of the traction, the best first.
    pub limits: &'a [FoundLimit],
}

impl Naming<'_> {
    /// What the data have already.
    pub fn have(&self) -> Have {
        Have { effort: self.measured, both_directions: both_directions(self.rows) }
    }
}

#[cfg(test)]
impl<'a> Naming<'a> {
    /// Of data with an effort column in which nothing else was found.
    pub(crate) fn plain(context: &'a Context<'a>, kinematics: &'a Kinematics) -> Self {
        Self { context, runs: &[], rows: &[], measured: true, kinematics, run_wind: None, wind_gain: 0.0, limits: &[] }
    }
}

/// What the data at hand have already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Have {
    pub effort: bool,
    pub both_directions: bool,
}

/// How large an effect is that the bench hides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum HiddenSize {
    /// Nobody would overlook it.
    Clear,
    /// In between.
    Medium,
    /// At the limit.
    Faint,
}

/// What the bench has drawn of a set when it hides an effect.
pub struct Hide<'a> {
    /// How large the effect is.
    pub size: HiddenSize,
    /// Where an effect of a section acts, m.
    pub section_m: [f64; 2],
    /// Of effects that may have either.
    pub sign: f64,
    /// The true coefficients.
    pub davis: Davis,
    /// The described length of the train, m.
    pub length_m: f64,
    /// For all else.
    pub rng: &'a mut ChaCha8Rng,
}

impl Hide<'_> {
    /// By size: clear, medium, faint.
    pub fn of(&self, values: [f64; 3]) -> f64 {
        values[self.size as usize]
    }
}

/// What may as well be it, with its odds.
pub type Odds = Vec<(EffectKind, f64)>;

/// A kind of effect to the workflow.
pub trait Candidate: Sync {
    fn facts(&self) -> Facts;

    fn name(&self) -> &'static str {
        self.facts().kind.map_or("sensors", EffectKind::name)
    }

    /// The terms that these data can show.
    fn families(&self, _: &Offer<'_>) -> Vec<Family> {
        Vec::new()
    }

    /// Its columns, one for each coefficient: extra resistance per unit of it, in each row.
    fn columns(&self, _: &Shape, _: &Context<'_>, _: &[Row]) -> Vec<Vec<f64>> {
        Vec::new()
    }

    /// Penalty of a shape's freedom, of log-likelihood.
    fn penalty(&self, shape: &Shape, penalty: &PenaltyConfig, _: &[Row]) -> f64 {
        let chosen = match shape {
            Shape::Section(_) => penalty.section,
            Shape::Numbers(..) => 2.0 * penalty.shape,
            _ if self.dial(shape).is_some() => penalty.shape,
            _ => 0.0,
        };
        coefficients(self.facts().nature, shape) as f64 * penalty.coefficient + chosen
    }

    /// Large enough to matter to a train, and not too large to be it.
    fn is_plausible(&self, size: &Size<'_>) -> bool {
        size.most() > size.context.config.search.least_n_per_kg
    }

    /// How a shape that is a number is made finer.
    fn dial(&self, _: &Shape) -> Option<Dial> {
        None
    }

    /// A term as the effect that the board runs, with the 95 % intervals of its parameters.
    fn effect(&self, _: &Fitted, _: &Naming<'_>) -> Option<(Effect, Vec<Interval95>)> {
        None
    }

    /// The effect by what readings or differences between runs show.
    fn beside(&self, _: &Naming<'_>) -> Option<(Named, Odds)> {
        None
    }

    /// The effect by a limit of the traction.
    fn limit(&self, _: &FoundLimit, _: &Naming<'_>) -> Option<(Named, Odds)> {
        None
    }

    /// What would separate it from another, where that is special to the two; said by one of them.
    fn separated_from(&self, _: EffectKind) -> Option<&'static str> {
        None
    }

    /// The effect in a sentence.
    fn sentence(&self, named: &Named, _: &Context<'_>) -> String {
        named.effect.name().to_owned()
    }

    /// Over what its law is drawn; none: it has no law over the residuals.
    fn axis<'a>(&self, _: &'a Named, _: &Context<'a>) -> Option<Axis<'a>> {
        None
    }

    /// Names of what the bench hides for it.
    fn hidden_names(&self) -> Vec<&'static str> {
        vec![self.name()]
    }

    /// What the bench hides by such a name, as in a scenario, without the name.
    fn hidden(&self, _: &str, _: &mut Hide<'_>) -> Option<Value> {
        None
    }

    /// The parameter that is the effect's size, and its value without the effect. `length_m`: of the train as
    /// described.
    fn main_parameter(&self, _length_m: f64) -> Option<(&'static str, f64)> {
        self.facts().size
    }
}

/// How many coefficients a shape has.
fn coefficients(nature: Nature, shape: &Shape) -> usize {
    match shape {
        Shape::Powers(wrong) => wrong.iter().filter(|w| **w).count(),
        Shape::Table(_, knots) => knots.len(),
        _ => 1 + usize::from(nature.constant_beside),
    }
}
