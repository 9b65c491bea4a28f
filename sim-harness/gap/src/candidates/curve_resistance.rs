//! Resistance of curves.

use crate::candidates::kit::*;
use rundown::model::effects::CurveResistance;

pub struct This;

impl Candidate for This {
    fn facts(&self) -> Facts {
        Facts {
            kind: Some(EffectKind::CurveResistance),
            what: "Curves cost resistance that the model does not have.",
            law: "resistance + coefficient x Roeckl's formula of the radii, mean under the train",
            parameters: "coefficient_roeckl, 1 for the formula as it stands",
            shows: "more resistance in every curve of the track file, the same at every speed, as much as the curve is tight",
            confounded: "gradient_error, on a line with a single curve; davis_error (r0), where the whole line is curved alike",
            separates: "the radii in the track file; several curves with straight track between them",
            nature: Nature { by_place: true, ..Nature::default() },
            size: Some(("coefficient_roeckl", 0.0)),
            ..Facts::default()
        }
    }

    fn families(&self, offer: &Offer<'_>) -> Vec<Family> {
        let described = !offer.context.surroundings.curves.is_empty();
        described.then(|| Family::Shapes(vec![Term { of: &This, shape: Shape::Law }])).into_iter().collect()
    }

    fn columns(&self, _: &Shape, context: &Context<'_>, rows: &[Row]) -> Vec<Vec<f64>> {
        let gravity = context.believed.train().gravity_n_per_kg();
        let curves = &context.surroundings.curves;
        vec![along(context, rows, |line, _, p| {
            let of = |&(from_m, to_m, roeckl)| roeckl * share(line, p.location_m, [from_m, to_m]);
            gravity * curves.iter().map(of).sum::<f64>()
        })]
    }

    fn is_plausible(&self, size: &Size<'_>) -> bool {
        size.beta[0] > 0.0 && size.most() > size.context.config.search.least_n_per_kg
    }

    fn effect(&self, fitted: &Fitted, _: &Naming<'_>) -> Option<(Effect, Vec<Interval95>)> {
        let (coefficient_roeckl, interval) = fitted.first("coefficient_roeckl", 1.0);
        Some((CurveResistance { coefficient_roeckl }.into(), vec![interval]))
    }

    fn sentence(&self, named: &Named, _: &Context<'_>) -> String {
        format!(
            "The curves of the track add resistance: R\u{f6}ckl's formula times {}",
            with_unit(named, "coefficient_roeckl")
        )
    }

    fn axis<'a>(&self, named: &'a Named, context: &Context<'a>) -> Option<Axis<'a>> {
        let (coefficient, believed) = (named.value("coefficient_roeckl"), context.believed);
        Some(Axis::over("R\u{f6}ckl's resistance of the curves under the train, N/kg", move |row| {
            Some(extra(&believed, &named.effect, row) / coefficient)
        }))
    }

    fn hidden(&self, _: &str, hide: &mut Hide<'_>) -> Option<Value> {
        Some(json!({ "coefficient_roeckl": hide.of([1.0, 0.6, 0.3]) }))
    }
}
