//! A brake that weakens with speed.

use crate::candidates::kit::*;
use rundown::model::effects::BrakeFade;

pub struct This;

impl Candidate for This {
    fn facts(&self) -> Facts {
        Facts {
            kind: Some(EffectKind::BrakeFade),
            what: "Brakes lose effort at high speed.",
            law: "brake effort x (1 - fade x (v - from) / (140 km/h - from)) above the speed `from`",
            parameters: "fade_at_140, from_kmh",
            shows: "an applied brake slows the train less than its effort says, the more the faster it is",
            confounded: "davis_error at high speed, in braking only",
            separates: "an effort column (of the demanded brake effort); without one it cannot be seen",
            nature: Nature { needs_effort: true, may_be_large: true, ..Nature::default() },
            prior: Prior {
                least: 0.04,
                most: f64::INFINITY,
                shapes: &[20.0, 40.0, 60.0, 80.0, 100.0],
                source: "Share that is missing at 140 km/h; speeds from which it fades, km/h. Judgement.",
            },
            size: Some(("fade_at_140", 0.0)),
        }
    }

    fn families(&self, offer: &Offer<'_>) -> Vec<Family> {
        offer.measured.then(|| offer.numbers(&This, 3.6)).into_iter().collect()
    }

    /// u (v - from)/(140 km/h - from) while braking, from in m/s.
    fn columns(&self, shape: &Shape, context: &Context<'_>, rows: &[Row]) -> Vec<Vec<f64>> {
        let from_mps = shape.number();
        vec![along(context, rows, |_, row, p| {
            let over = (p.speed_mps - from_mps) / (140.0 / 3.6 - from_mps);
            row.effort_n_per_kg.min(0.0) * over.max(0.0)
        })]
    }

    fn is_plausible(&self, size: &Size<'_>) -> bool {
        size.beta[0] > size.least()
    }

    fn dial(&self, _: &Shape) -> Option<Dial> {
        Some(Dial { step: 2.5, range: (0.0, 32.0), exponential: false, ..Dial::default() })
    }

    fn effect(&self, fitted: &Fitted, _: &Naming<'_>) -> Option<(Effect, Vec<Interval95>)> {
        let (fade_at_140, from_kmh, intervals) = fitted.with_number("fade_at_140", "from_kmh", 3.6);
        Some((BrakeFade { fade_at_140, from_kmh }.into(), intervals))
    }

    fn sentence(&self, named: &Named, _: &Context<'_>) -> String {
        format!(
            "The brake weakens above {} km/h: at 140 km/h it lacks {} of its effort",
            number(named.value("from_kmh"), 0),
            scaled(named, "fade_at_140", 100.0, "%")
        )
    }

    fn axis<'a>(&self, _: &'a Named, context: &Context<'a>) -> Option<Axis<'a>> {
        // Strong enough to show what share of it is lacking.
        let braking = context.config.interval.braked_n_per_kg;
        let speed = move |row: &Row| Some(kmh(row)).filter(|_| row.effort_n_per_kg < braking);
        Some(Axis { per: Some(|row| row.effort_n_per_kg), ..Axis::over("speed, km/h, while braking", speed) })
    }

    fn hidden(&self, _: &str, hide: &mut Hide<'_>) -> Option<Value> {
        let fade_at_140 = hide.of([0.45, 0.3, 0.15]);
        Some(json!({ "fade_at_140": fade_at_140, "from_kmh": hide.rng.random_range(40.0..80.0) }))
    }
}
