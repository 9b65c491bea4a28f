//! What an effect is to the workflow: one trait, one file below `candidates/` for each kind.
//!
//! A [`Term`] is a candidate with its shape chosen (a section, a time constant, runs): the columns of a linear fit, one
//! for each free coefficient. Effects that do not act on the resistance offer no terms; they are named from the
//! findings of another stage ([`Candidate::beside`]).

mod fitted;
mod hidden;
mod naming;
mod term;

pub use fitted::{Fitted, SectionLimits, ShapeLimits};
pub use hidden::{HiddenSize, Hide};
pub use naming::{Have, Naming};
pub use term::{Shape, Side, Term};

use crate::axis::Axis;
use crate::config::{PenaltyConfig, PriorChange};
use crate::data::{believed::Context, rows::Row};
use crate::named::{Interval95, Named};
use crate::traction::limit::FoundLimit;
use rundown::model::effects::{Effect, EffectKind};
use rundown_files::statistics::{sorted, upper_quantile};
use serde_json::Value;

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
    pub confounded: &'static str,
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
    fn sizes(&self) -> impl Iterator<Item = f64> {
        self.term.extra(self.beta, self.context, self.rows).into_iter().map(f64::abs)
    }

    /// The largest extra resistance, N/kg.
    pub fn most(&self) -> f64 {
        sorted(self.sizes()).last().copied().unwrap_or(0.0)
    }

    /// What acts always must be seen in more than the few slowest or fastest rows: exceeded in a fifth of them, N/kg.
    pub fn often(&self) -> f64 {
        upper_quantile(self.sizes(), 0.8).unwrap_or(0.0)
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
            Shape::Law
            | Shape::Powers(_)
            | Shape::Number(_)
            | Shape::Runs(_)
            | Shape::NumberInRuns(..)
            | Shape::Step(..)
            | Shape::Table(..) => self.dial(shape).map_or(0.0, |_| penalty.shape),
        };
        shape.coefficients(self.facts().nature) as f64 * penalty.coefficient + chosen
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
    fn sentence(&self, named: &Named, context: &Context<'_>) -> String;

    /// Over what its law is drawn; none: it has no law over the residuals.
    fn axis<'a>(&self, _: &'a Named, _: &Context<'a>) -> Option<Axis<'a>> {
        None
    }

    /// Names of what the bench hides for it.
    fn hidden_names(&self) -> Vec<&'static str> {
        vec![self.name()]
    }

    /// What the bench hides by such a name, as in a scenario, without the name.
    fn hidden(&self, name: &str, hide: &mut Hide<'_>) -> Option<Value>;

    /// The parameter that is the effect's size, and its value without the effect. `length_m`: of the train as
    /// described.
    fn main_parameter(&self, _length_m: f64) -> Option<(&'static str, f64)> {
        self.facts().size
    }
}
