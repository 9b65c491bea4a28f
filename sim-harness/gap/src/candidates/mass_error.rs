//! A train that is heavier or lighter than described.

use crate::candidates::kit::*;
use crate::columns::mass;
use rundown::model::effects::MassError;
use rundown_check::figure::HALF_95;

pub struct This;

impl Candidate for This {
    fn facts(&self) -> Facts {
        Facts {
            kind: Some(EffectKind::MassError),
            what: "The train is heavier or lighter than described.",
            law: "inertia, gravity and rolling resistance in newton times 1 + relative; effort and air drag in newton stay",
            parameters: "relative: true mass / described mass - 1",
            shows: "the train answers less (or more) to its effort, powering and braking alike; gradients stay as they are",
            confounded: "without an effort column with davis_error (less air drag) and traction_scale; with one, with an effort that is shown too large",
            separates: "an effort column that is calibrated; a weighing",
            nature: Nature { needs_effort: true, may_be_large: true, ..Nature::default() },
            prior: Prior {
                least: 0.008,
                most: 0.4,
                shapes: &[],
                source: "Share of the mass. Judgement: a load of a few passengers is no finding, and no description is further off; without an effort column it would be the air drag of another train.",
            },
            size: Some(("relative", 0.0)),
        }
    }

    /// In coasting it is a wrong r2, and so a rival of that.
    fn families(&self, _: &Offer<'_>) -> Vec<Family> {
        vec![Family::Shapes(vec![Term { of: &This, shape: Shape::Law }])]
    }

    fn columns(&self, _: &Shape, context: &Context<'_>, rows: &[Row]) -> Vec<Vec<f64>> {
        vec![mass(context, rows)]
    }

    fn is_plausible(&self, size: &Size<'_>) -> bool {
        (size.least()..size.largest()).contains(&size.beta[0].abs())
    }

    /// The coefficient is e/(1 + e).
    fn effect(&self, fitted: &Fitted, _: &Naming<'_>) -> Option<(Effect, Vec<Interval95>)> {
        let relative = |b: f64| b / (1.0 - b);
        let (beta, half) = (fitted.beta[0], HALF_95 * fitted.sd[0]);
        let interval = ("relative", relative(beta - half), relative(beta + half));
        Some((MassError { relative: relative(beta) }.into(), vec![interval]))
    }

    fn sentence(&self, named: &Named, _: &Context<'_>) -> String {
        format!(
            "The train is {} than described, by {}",
            if named.value("relative") > 0.0 { "heavier" } else { "lighter" },
            scaled(named, "relative", 100.0 * named.value("relative").signum(), "%")
        )
    }

    fn axis<'a>(&self, _: &'a Named, context: &Context<'a>) -> Option<Axis<'a>> {
        let r2 = context.believed.train().davis().r2;
        Some(Axis::over("effort less believed air drag, N/kg", move |row| {
            let drag = row.interval.mean(|p| r2 * p.speed_mps * p.speed_mps);
            Some(row.effort_n_per_kg - drag)
        }))
    }

    fn hidden(&self, _: &str, hide: &mut Hide<'_>) -> Option<Value> {
        Some(json!({ "relative": hide.sign * hide.of([0.10, 0.05, 0.025]) }))
    }
}

/// What a train's mass would have to be, relative to the believed one and with its standard deviation, for a change of
/// r2 alone to be less, or more, air drag for its mass.
pub fn by_drag(fitted: &Fitted, r2: f64) -> Option<(f64, f64)> {
    let (beta, sd) = (*fitted.beta.first()?, *fitted.sd.first()?);
    if fitted.term.shape == Shape::Powers([false, false, true]) {
        let true_r2 = r2 + beta;
        return Some((-beta / true_r2, sd * r2 / (true_r2 * true_r2)));
    }
    fitted.term.is(EffectKind::MassError).then(|| (beta / (1.0 - beta), sd / (1.0 - beta).powi(2)))
}
