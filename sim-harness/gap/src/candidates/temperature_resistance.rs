//! r0 by the ambient temperature.

use crate::candidates::kit::*;
use rundown::model::effects::TemperatureResistance;

pub struct This;

impl Candidate for This {
    fn facts(&self) -> Facts {
        Facts {
            kind: Some(EffectKind::TemperatureResistance),
            what: "Bearings and grease: r0 depends on the ambient temperature.",
            law: "r0 + dr0_per_degC x (temperature - ref_c)",
            parameters: "dr0_per_degC in N/kg per degree; ref_c is a choice of origin",
            shows: "each run has its own constant difference, in line with its temperature",
            confounded: "seasonal_drift, where temperature and date go together",
            separates: "another season; days on which temperature and date do not agree; a column ambient_temperature_c",
            nature: Nature { between_runs: true, constant_beside: true, ..Nature::default() },
            size: Some(("dr0_per_degC", 0.0)),
            ..Facts::default()
        }
    }

    fn families(&self, offer: &Offer<'_>) -> Vec<Family> {
        let known = offer.rows.iter().any(|row| row.interval.temperature_c.is_some());
        known.then(|| Family::Shapes(vec![Term { of: &This, shape: Shape::Law }])).into_iter().collect()
    }

    /// Temperature above the mean of the set, and a constant.
    fn columns(&self, _: &Shape, context: &Context<'_>, rows: &[Row]) -> Vec<Vec<f64>> {
        let mean_c = context.conditions.temperature_c;
        let above = |row: &Row| row.interval.temperature_c.map_or(0.0, |t| t - mean_c);
        vec![along(context, rows, |_, row, _| above(row)), along(context, rows, |_, _, _| 1.0)]
    }

    fn effect(&self, fitted: &Fitted, naming: &Naming<'_>) -> Option<(Effect, Vec<Interval95>)> {
        let (slope, constant) = (fitted.beta[0], fitted.beta[1]);
        let ref_c = naming.context.conditions.temperature_c - constant / slope;
        let effect = TemperatureResistance { dr0_per_deg_c: slope, ref_c };
        Some((effect.into(), vec![around("dr0_per_degC", slope, fitted.sd[0])]))
    }

    fn sentence(&self, named: &Named, _: &Context<'_>) -> String {
        format!(
            "The constant resistance r0 depends on the temperature: {} for each degree, as described at {} \u{b0}C",
            scaled(named, "dr0_per_degC", 1.0, "N/kg"),
            number(named.value("ref_c"), 0)
        )
    }

    fn axis<'a>(&self, _: &'a Named, _: &Context<'a>) -> Option<Axis<'a>> {
        Some(Axis::temperature())
    }

    fn hidden(&self, _: &str, hide: &mut Hide<'_>) -> Option<Value> {
        Some(json!({ "dr0_per_degC": -hide.of([3e-4, 1.5e-4, 7e-5]), "ref_c": 10.0 }))
    }
}
