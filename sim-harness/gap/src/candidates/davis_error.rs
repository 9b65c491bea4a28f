//! Davis coefficients that are described wrongly.

use crate::candidates::kit::*;
use rundown::model::effects::DavisError;

pub struct This;

impl Candidate for This {
    fn facts(&self) -> Facts {
        Facts {
            kind: Some(EffectKind::DavisError),
            what: "The described Davis coefficients are wrong.",
            law: "r0 + dr0, r1 + dr1, r2 + dr2",
            parameters: "dr0 in N/kg, dr1 in N/(kg m/s), dr2 in N/(kg (m/s)²)",
            shows: "a smooth difference over speed, the same at every place, in every run, in both directions",
            confounded: "steady_wind in one direction; mass_error without an effort column. The three parts hide in each other: their sum over the speeds of the runs is what is known",
            separates: "runs in the other direction; a wide range of speeds",
            ..Facts::default()
        }
    }

    /// r1 alone is what a one-way wind looks like, and no form in which a description goes wrong.
    fn families(&self, _: &Offer<'_>) -> Vec<Family> {
        let wrong = [[true, false, false], [false, false, true], [true, false, true], [true, true, true]];
        vec![Family::Shapes(wrong.map(|wrong| Term { of: &This, shape: Shape::Powers(wrong) }).to_vec())]
    }

    fn columns(&self, shape: &Shape, context: &Context<'_>, rows: &[Row]) -> Vec<Vec<f64>> {
        let wrong = shape.powers();
        (0..3).filter(|k| wrong[*k as usize]).map(|k| along(context, rows, |_, _, p| p.speed_mps.powi(k))).collect()
    }

    /// No coefficient of the train would be negative.
    fn is_plausible(&self, size: &Size<'_>) -> bool {
        let wrong = size.term.shape.powers();
        let davis = size.context.believed.train().davis();
        let mut beta = size.beta.iter();
        let possible = [davis.r0, davis.r1, davis.r2].into_iter().zip(wrong).all(|(described, wrong)| {
            let change = if wrong { beta.next() } else { None };
            described + change.copied().unwrap_or(0.0) >= 0.0
        });
        possible && size.often() > size.context.config.search.least_n_per_kg
    }

    fn effect(&self, fitted: &Fitted, _: &Naming<'_>) -> Option<(Effect, Vec<Interval95>)> {
        let wrong = fitted.term.shape.powers();
        let (mut d, mut intervals) = ([0.0; 3], Vec::new());
        let mut found = fitted.beta.iter().zip(&fitted.sd);
        for k in (0..3).filter(|k| wrong[*k]) {
            let (beta, sd) = found.next()?;
            d[k] = *beta;
            intervals.push(around(["dr0", "dr1", "dr2"][k], *beta, *sd));
        }
        Some((DavisError { dr0: d[0], dr1: d[1], dr2: d[2] }.into(), intervals))
    }

    fn separated_from(&self, other: EffectKind) -> Option<&'static str> {
        matches!(other, EffectKind::Unknown | EffectKind::SteadyWind).then_some("runs at another speed")
    }

    fn sentence(&self, named: &Named, context: &Context<'_>) -> String {
        let [dr0, dr1, dr2] = ["dr0", "dr1", "dr2"].map(|name| named.value(name));
        let extra = dr0 + dr1 * 100.0 / 3.6 + dr2 * (100.0_f64 / 3.6).powi(2);
        let at_100 = context.believed.train().davis().resistance_n_per_kg(100.0 / 3.6);
        let wrong = ["dr0", "dr1", "dr2"].into_iter().filter(|name| named.value(name) != 0.0);
        let parts = wrong.map(|name| format!("{} by {}", &name[1..], with_unit(named, name)));
        format!(
            "The described Davis coefficients are wrong: at 100 km/h the train meets {}\u{a0}% {} running resistance than described ({})",
            number(100.0 * extra.abs() / at_100, 1),
            side(extra > 0.0),
            parts.collect::<Vec<_>>().join(", ")
        )
    }

    fn axis<'a>(&self, _: &'a Named, _: &Context<'a>) -> Option<Axis<'a>> {
        Some(Axis::speed())
    }

    fn hidden(&self, _: &str, hide: &mut Hide<'_>) -> Option<Value> {
        let share = hide.sign * hide.of([0.2, 0.1, 0.05]);
        let davis = hide.davis;
        let mut part = |of: f64| of * share * hide.rng.random_range(0.6..1.4);
        Some(json!({ "dr0": part(davis.r0), "dr1": part(davis.r1), "dr2": part(davis.r2) }))
    }
}
