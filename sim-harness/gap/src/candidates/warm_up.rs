//! Cold bearings in the first minutes.

use crate::candidates::kit::*;
use rundown::model::effects::WarmUp;

pub struct This;

impl Candidate for This {
    fn facts(&self) -> Facts {
        Facts {
            kind: Some(EffectKind::WarmUp),
            what: "Cold bearings and gears: r0 is larger in the first minutes.",
            law: "r0 + amplitude x exp(-t / tau), t since the departure",
            parameters: "amplitude in N/kg, tau_s",
            shows: "more resistance early in every run, at every place and speed, fading with time",
            confounded: "a difference at the first kilometres, where all runs begin at one station; less traction, without an effort column",
            separates: "runs that begin elsewhere; long halts; warm starts after a short turn-round",
            prior: Prior {
                least: 6e-4,
                most: 0.03,
                shapes: &[60.0, 120.0, 200.0, 300.0, 450.0, 700.0, 1000.0],
                source: "Amplitude, N/kg; time constants, s. Judgement: the largest value belongs to the first rows alone, and more than stiff bearings add is a law of something else, carried back to the departure.",
            },
            size: Some(("amplitude", 0.0)),
            ..Facts::default()
        }
    }

    fn families(&self, offer: &Offer<'_>) -> Vec<Family> {
        vec![offer.numbers(&This, 1.0)]
    }

    /// exp(-t/τ), τ in s.
    fn columns(&self, shape: &Shape, context: &Context<'_>, rows: &[Row]) -> Vec<Vec<f64>> {
        let tau_s = shape.number();
        vec![along(context, rows, |_, _, p| (-p.since_departure_s / tau_s).exp())]
    }

    fn is_plausible(&self, size: &Size<'_>) -> bool {
        (0.0..size.largest()).contains(&size.beta[0]) && size.most() > size.least()
    }

    /// 20 s to 40 min.
    fn dial(&self, _: &Shape) -> Option<Dial> {
        Some(Dial { step: 0.25, range: (3.0, 7.8), exponential: true, ..Dial::default() })
    }

    fn effect(&self, fitted: &Fitted, _: &Naming<'_>) -> Option<(Effect, Vec<Interval95>)> {
        let (amplitude, tau_s, intervals) = fitted.with_number("amplitude", "tau_s", 1.0);
        Some((WarmUp { amplitude, tau_s }.into(), intervals))
    }

    fn separated_from(&self, other: EffectKind) -> Option<&'static str> {
        matches!(other, EffectKind::Unknown | EffectKind::DavisError)
            .then_some("runs that begin at another place or speed")
    }

    fn sentence(&self, named: &Named, _: &Context<'_>) -> String {
        format!(
            "A cold train runs heavier: {} more at the departure, 37\u{a0}% of it left after {} min",
            with_unit(named, "amplitude"),
            number(named.value("tau_s") / 60.0, 1)
        )
    }

    fn axis<'a>(&self, _: &'a Named, _: &Context<'a>) -> Option<Axis<'a>> {
        Some(Axis::time())
    }

    fn hidden(&self, _: &str, hide: &mut Hide<'_>) -> Option<Value> {
        let amplitude = hide.of([6e-3, 3e-3, 1.5e-3]);
        Some(json!({ "amplitude": amplitude, "tau_s": hide.rng.random_range(150.0..600.0) }))
    }
}
