//! A wind that all runs have.

use crate::candidates::kit::*;
use crate::columns::wind;
use rundown::model::effects::SteadyWind;

/// What the workflow knows of it.
pub static CANDIDATE: &dyn Candidate = &This;

struct This;

impl Candidate for This {
    fn kind(&self) -> Option<EffectKind> {
        Some(EffectKind::SteadyWind)
    }

    fn page(&self) -> Option<Page> {
        Some(Page {
            what: "A headwind that all runs have.",
            law: "r2 (v + w)² instead of r2 v²; w changes its sign with the direction",
            parameters: "wind_mps, against the `up` direction positive",
            shows: "a difference that grows with the speed, one way in one direction and the other way in the other",
            confused: "davis_error (r1 above all), where all runs go in one direction",
            separates: "runs in the other direction; a weather station",
        })
    }

    fn nature(&self) -> Nature {
        Nature { turns: true, ..Nature::default() }
    }

    fn families(&self, _: &Offer<'_>) -> Vec<Family> {
        vec![Family::Linearised(Term { of: CANDIDATE, shape: Shape::Number(0.0) })]
    }

    fn columns(&self, shape: &Shape, context: &Context<'_>, rows: &[Row]) -> Vec<Vec<f64>> {
        let Shape::Number(wind_mps) = *shape else {
            return Vec::new();
        };
        vec![wind(context, rows, wind_mps)]
    }

    fn is_plausible(&self, size: &Size<'_>) -> bool {
        size.often() > size.context.config.search.least_n_per_kg
    }

    fn effect(&self, fitted: &Fitted, _: &Naming<'_>) -> Option<(Effect, Vec<Interval95>)> {
        let (wind_mps, interval) = fitted.first("wind_mps", 1.0);
        Some((Effect::SteadyWind(SteadyWind { wind_mps }), vec![interval]))
    }

    fn sentence(&self, named: &Named, _: &Context<'_>) -> String {
        let Effect::SteadyWind(e) = &named.effect else {
            return String::new();
        };
        format!(
            "A steady wind blows {} the line, in every run: {}",
            if e.wind_mps > 0.0 { "down" } else { "up" },
            told(named, "wind_mps", e.wind_mps, e.wind_mps.signum(), "m/s")
        )
    }

    fn axis<'a>(&self, _: &'a Named, _: &Context<'a>) -> Option<Axis<'a>> {
        Some(Axis { by_direction: true, ..Axis::speed() })
    }

    fn hidden(&self, _: &str, hide: &mut Hide<'_>) -> Option<Value> {
        Some(json!({ "wind_mps": hide.sign * hide.of([5.0, 2.5, 1.2]) }))
    }

    fn main_parameter(&self, _: f64) -> Option<(&'static str, f64)> {
        Some(("wind_mps", 0.0))
    }
}
