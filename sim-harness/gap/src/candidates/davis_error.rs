//! Davis coefficients that are described wrongly.

use crate::candidates::kit::*;
use rundown::model::effects::DavisError;

/// What the workflow knows of it.
pub static CANDIDATE: &dyn Candidate = &This;

struct This;

impl Candidate for This {
    fn kind(&self) -> Option<EffectKind> {
        Some(EffectKind::DavisError)
    }

    fn page(&self) -> Option<Page> {
        Some(Page {
            what: "The described Davis coefficients are wrong.",
            law: "r0 + dr0, r1 + dr1, r2 + dr2",
            parameters: "dr0 in N/kg, dr1 in N/(kg m/s), dr2 in N/(kg (m/s)²)",
            shows: "a smooth difference over speed, the same at every place, in every run, in both directions",
            confused: "steady_wind in one direction; mass_error without an effort column. The three parts hide in each other: their sum over the speeds of the runs is what is known",
            separates: "runs in the other direction; a wide range of speeds",
        })
    }

    /// r1 alone is what a one-way wind looks like, and no way in which a description goes wrong.
    fn families(&self, _: &Offer<'_>) -> Vec<Family> {
        let wrong = [[true, false, false], [false, false, true], [true, false, true], [true, true, true]];
        vec![Family::Shapes(wrong.map(|wrong| Term { of: CANDIDATE, shape: Shape::Powers(wrong) }).to_vec())]
    }

    fn columns(&self, shape: &Shape, context: &Context<'_>, rows: &[Row]) -> Vec<Vec<f64>> {
        let Shape::Powers(wrong) = shape else {
            return Vec::new();
        };
        let wrong = (0..3).filter(|k| wrong[*k as usize]);
        wrong.map(|k| along(context, rows, |_, _, p| p.speed_mps.powi(k))).collect()
    }

    fn penalty(&self, shape: &Shape, penalty: &PenaltyConfig, _: &[Row]) -> f64 {
        let Shape::Powers(wrong) = shape else {
            return 0.0;
        };
        wrong.iter().filter(|w| **w).count() as f64 * penalty.coefficient
    }

    /// No coefficient of the train would be negative.
    fn is_plausible(&self, size: &Size<'_>) -> bool {
        let Shape::Powers(wrong) = size.term.shape else {
            return false;
        };
        let davis = size.context.believed.train().davis();
        let mut beta = size.beta.iter();
        let possible = [davis.r0, davis.r1, davis.r2].into_iter().zip(wrong).all(|(described, wrong)| {
            let change = if wrong { beta.next() } else { None };
            described + change.copied().unwrap_or(0.0) >= 0.0
        });
        possible && size.often() > size.context.config.search.least_n_per_kg
    }

    fn effect(&self, fitted: &Fitted, _: &Naming<'_>) -> Option<(Effect, Vec<Interval95>)> {
        let Shape::Powers(wrong) = fitted.term.shape else {
            return None;
        };
        let (mut d, mut intervals) = ([0.0; 3], Vec::new());
        let mut found = fitted.beta.iter().zip(&fitted.sd);
        for k in (0..3).filter(|k| wrong[*k]) {
            let (beta, sd) = found.next()?;
            d[k] = *beta;
            intervals.push(around(["dr0", "dr1", "dr2"][k], *beta, *sd));
        }
        Some((Effect::DavisError(DavisError { dr0: d[0], dr1: d[1], dr2: d[2] }), intervals))
    }

    fn separated_from(&self, other: EffectKind) -> Option<&'static str> {
        matches!(other, EffectKind::Unknown | EffectKind::SteadyWind).then_some("runs at another speed")
    }

    fn sentence(&self, named: &Named, context: &Context<'_>) -> String {
        let Effect::DavisError(e) = &named.effect else {
            return String::new();
        };
        let extra = e.dr0 + e.dr1 * 100.0 / 3.6 + e.dr2 * (100.0_f64 / 3.6).powi(2);
        let at_100 = context.believed.train().davis().resistance_n_per_kg(100.0 / 3.6);
        let coefficients = [("dr0", "r0", e.dr0), ("dr1", "r1", e.dr1), ("dr2", "r2", e.dr2)];
        let wrong = coefficients.iter().filter(|(.., v)| *v != 0.0);
        let parts = wrong.map(|(name, letter, v)| format!("{letter} by {}", with_unit(named, name, *v)));
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
