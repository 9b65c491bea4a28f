//! A wind that all runs have.

use crate::candidates::kit::*;
use crate::columns::wind;
use rundown::model::effects::SteadyWind;

pub struct This;

impl Candidate for This {
    fn facts(&self) -> Facts {
        Facts {
            kind: Some(EffectKind::SteadyWind),
            what: "A headwind that all runs have.",
            law: "r2 (v + w)|v + w| instead of r2 v²; w changes its sign with the direction",
            parameters: "wind_mps, against the `up` direction positive",
            shows: "a difference that grows with the speed, with one sign in one direction and the other sign in the other",
            confounded: "davis_error (r1 above all), where all runs go in one direction",
            separates: "runs in the other direction; a weather station",
            nature: Nature { turns: true, ..Nature::default() },
            size: Some(("wind_mps", 0.0)),
            ..Facts::default()
        }
    }

    fn families(&self, _: &Offer<'_>) -> Vec<Family> {
        vec![Family::Linearised(Term { of: &This, shape: Shape::Number(0.0) })]
    }

    fn columns(&self, shape: &Shape, context: &Context<'_>, rows: &[Row]) -> Vec<Vec<f64>> {
        vec![wind(context, rows, shape.number())]
    }

    fn is_plausible(&self, size: &Size<'_>) -> bool {
        let config = size.context.config;
        size.beta[0].abs() <= config.certainty.most_wind_mps && size.often() > config.search.least_n_per_kg
    }

    fn effect(&self, fitted: &Fitted, _: &Naming<'_>) -> Option<(Effect, Vec<Interval95>)> {
        let (wind_mps, interval) = fitted.first("wind_mps", 1.0);
        Some((SteadyWind { wind_mps }.into(), vec![interval]))
    }

    fn sentence(&self, named: &Named, _: &Context<'_>) -> String {
        format!(
            "A steady wind blows {} the line, in every run: {}",
            if named.value("wind_mps") > 0.0 { "down" } else { "up" },
            scaled(named, "wind_mps", named.value("wind_mps").signum(), "m/s")
        )
    }

    fn axis<'a>(&self, _: &'a Named, _: &Context<'a>) -> Option<Axis<'a>> {
        Some(Axis { by_direction: true, ..Axis::speed() })
    }

    fn hidden(&self, _: &str, hide: &mut Hide<'_>) -> Option<Value> {
        Some(json!({ "wind_mps": hide.sign * hide.of([5.0, 2.5, 1.2]) }))
    }
}
