//! r0 by the date.

use crate::candidates::kit::*;
use rundown::model::effects::SeasonalDrift;

pub struct This;

impl Candidate for This {
    fn facts(&self) -> Facts {
        Facts {
            kind: Some(EffectKind::SeasonalDrift),
            what: "r0 drifts over the dates of the runs: wear, or what nobody recorded.",
            law: "r0 + dr0_over_period x (day - first day) / period",
            parameters: "dr0_over_period in N/kg",
            shows: "each run has its own constant difference, in line with its date",
            confounded: "temperature_resistance, where temperature and date go together",
            separates: "another season; runs after a workshop visit",
            nature: Nature { between_runs: true, ..Nature::default() },
            size: Some(("dr0_over_period", 0.0)),
            ..Facts::default()
        }
    }

    fn families(&self, offer: &Offer<'_>) -> Vec<Family> {
        let dated = offer.context.conditions.period_days > 0.0;
        dated.then(|| Family::Shapes(vec![Term { of: &This, shape: Shape::Law }])).into_iter().collect()
    }

    /// Share of the period passed.
    fn columns(&self, _: &Shape, context: &Context<'_>, rows: &[Row]) -> Vec<Vec<f64>> {
        let conditions = context.conditions;
        let passed = |day: f64| (day - conditions.first_day) / conditions.period_days.max(1e-9);
        vec![along(context, rows, |_, row, _| row.interval.day.map_or(0.0, passed))]
    }

    fn effect(&self, fitted: &Fitted, naming: &Naming<'_>) -> Option<(Effect, Vec<Interval95>)> {
        let (dr0_over_period, interval) = fitted.first("dr0_over_period", 1.0);
        let conditions = naming.context.conditions;
        let (period_days, reference_day) = (conditions.period_days, conditions.first_day);
        Some((SeasonalDrift { dr0_over_period, period_days, reference_day }.into(), vec![interval]))
    }

    fn separated_from(&self, other: EffectKind) -> Option<&'static str> {
        (other == EffectKind::TemperatureResistance).then_some("another season")
    }

    fn sentence(&self, named: &Named, _: &Context<'_>) -> String {
        format!(
            "The constant resistance r0 drifts over the dates of the runs, by {} from the first to the last",
            with_unit(named, "dr0_over_period")
        )
    }

    fn axis<'a>(&self, _: &'a Named, context: &Context<'a>) -> Option<Axis<'a>> {
        Some(Axis::day(context.conditions.first_day))
    }

    fn hidden(&self, _: &str, hide: &mut Hide<'_>) -> Option<Value> {
        Some(json!({ "dr0_over_period": hide.sign * hide.of([3e-3, 1.5e-3, 8e-4]) }))
    }
}
