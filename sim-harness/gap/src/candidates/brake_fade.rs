//! A brake that weakens with speed.

use crate::candidates::kit::*;
use rundown::model::effects::BrakeFade;

/// What the workflow knows of it.
pub static CANDIDATE: &dyn Candidate = &This;

struct This;

impl Candidate for This {
    fn kind(&self) -> Option<EffectKind> {
        Some(EffectKind::BrakeFade)
    }

    fn page(&self) -> Option<Page> {
        Some(Page {
            what: "Brakes lose effort at high speed.",
            law: "brake effort x (1 - fade x (v - from) / (140 km/h - from)) above the speed `from`",
            parameters: "fade_at_140, from_kmh",
            shows: "an applied brake slows the train less than its effort says, the more the faster it is",
            confused: "davis_error at high speed, in braking only",
            separates: "an effort column (of the demanded brake effort); without one it cannot be seen",
        })
    }

    fn nature(&self) -> Nature {
        Nature { needs_effort: true, may_be_large: true, ..Nature::default() }
    }

    fn prior(&self) -> Prior {
        Prior {
            least: 0.04,
            most: f64::INFINITY,
            shapes: &[20.0, 40.0, 60.0, 80.0, 100.0],
            source: "Share that is missing at 140 km/h; speeds from which it fades, km/h. Judgement.",
        }
    }

    fn families(&self, offer: &Offer<'_>) -> Vec<Family> {
        let from = |kmh: f64| Term { of: CANDIDATE, shape: Shape::Number(kmh / 3.6) };
        let shapes = || Family::Shapes(offer.shapes(CANDIDATE).into_iter().map(from).collect());
        offer.measured.then(shapes).into_iter().collect()
    }

    /// u (v - from)/(140 km/h - from) while braking, from in m/s.
    fn columns(&self, shape: &Shape, context: &Context<'_>, rows: &[Row]) -> Vec<Vec<f64>> {
        let Shape::Number(from_mps) = *shape else {
            return Vec::new();
        };
        vec![along(context, rows, |_, row, p| {
            let over = (p.speed_mps - from_mps) / (140.0 / 3.6 - from_mps);
            row.effort_n_per_kg.min(0.0) * over.max(0.0)
        })]
    }

    fn penalty(&self, _: &Shape, penalty: &PenaltyConfig, _: &[Row]) -> f64 {
        penalty.coefficient + penalty.shape
    }

    fn is_plausible(&self, size: &Size<'_>) -> bool {
        size.beta[0] > size.least()
    }

    fn dial(&self, _: &Shape) -> Option<Dial> {
        Some(Dial { step: 2.5, range: (0.0, 32.0), exponential: false })
    }

    fn effect(&self, fitted: &Fitted, _: &Naming<'_>) -> Option<(Effect, Vec<Interval95>)> {
        let Shape::Number(from_mps) = fitted.term.shape else {
            return None;
        };
        let intervals = fitted.shape.map_or_else(Vec::new, |limits| {
            let (low, high) = limits.shape;
            vec![("fade_at_140", limits.beta.0, limits.beta.1), ("from_kmh", 3.6 * low, 3.6 * high)]
        });
        Some((Effect::BrakeFade(BrakeFade { fade_at_140: fitted.beta[0], from_kmh: 3.6 * from_mps }), intervals))
    }

    fn sentence(&self, named: &Named, _: &Context<'_>) -> String {
        let Effect::BrakeFade(e) = &named.effect else {
            return String::new();
        };
        format!(
            "The brake weakens above {} km/h: at 140 km/h it lacks {} of its effort",
            number(e.from_kmh, 0),
            told(named, "fade_at_140", e.fade_at_140, 100.0, "%")
        )
    }

    fn axis<'a>(&self, _: &'a Named, context: &Context<'a>) -> Option<Axis<'a>> {
        // Strong enough to tell what share of it is lacking.
        let braking = context.config.interval.braked_n_per_kg;
        let speed = move |row: &Row| Some(kmh(row)).filter(|_| row.effort_n_per_kg < braking);
        Some(Axis { per: Some(|row| row.effort_n_per_kg), ..Axis::over("speed, km/h, while braking", speed) })
    }

    fn hidden(&self, _: &str, hide: &mut Hide<'_>) -> Option<Value> {
        let fade_at_140 = hide.of([0.45, 0.3, 0.15]);
        Some(json!({ "fade_at_140": fade_at_140, "from_kmh": hide.rng.random_range(40.0..80.0) }))
    }

    fn main_parameter(&self, _: f64) -> Option<(&'static str, f64)> {
        Some(("fade_at_140", 0.0))
    }
}
