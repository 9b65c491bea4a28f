//! A brake that does not come off.

use crate::candidates::kit::*;
use crate::columns::braked;
use crate::noise::dragging_units::choice;
use rundown::model::effects::DraggingBrake;

pub struct This;

impl Candidate for This {
    fn facts(&self) -> Facts {
        Facts {
            kind: Some(EffectKind::DraggingBrake),
            what: "A brake does not come off after its first application, in some runs.",
            law: "resistance + constant, from the first application on",
            parameters: "drag_n_per_kg; the runs in which it acts",
            shows: "more resistance at every speed after the first braking, in some runs and not in others",
            confounded: "a load that differs; warm_up with the other sign",
            separates: "runs that go on after a braking; temperatures of axle boxes and discs",
            nature: Nature { shows_in: ShowsIn::Runs, may_be_large: true, ..Nature::default() },
            prior: Prior::least(1.5e-3, "N/kg. Judgement: winds and loads of single runs do less."),
            size: Some(("drag_n_per_kg", 0.0)),
        }
    }

    fn families(&self, _: &Offer<'_>) -> Vec<Family> {
        vec![Family::Runs(Term { of: &This, shape: Shape::Runs(Vec::new()) })]
    }

    fn columns(&self, shape: &Shape, context: &Context<'_>, rows: &[Row]) -> Vec<Vec<f64>> {
        vec![braked(context, rows, shape.runs())]
    }

    fn penalty(&self, shape: &Shape, penalty: &PenaltyConfig, rows: &[Row]) -> f64 {
        penalty.coefficient + choice(shape.runs(), rows)
    }

    fn is_plausible(&self, size: &Size<'_>) -> bool {
        size.beta[0] > size.least()
    }

    fn effect(&self, fitted: &Fitted, _: &Naming<'_>) -> Option<(Effect, Vec<Interval95>)> {
        let (drag_n_per_kg, interval) = fitted.first("drag_n_per_kg", 1.0);
        Some((DraggingBrake { drag_n_per_kg }.into(), vec![interval]))
    }

    fn sentence(&self, named: &Named, _: &Context<'_>) -> String {
        format!("A brake drags after an application: {} of extra resistance", with_unit(named, "drag_n_per_kg"))
    }

    fn axis<'a>(&self, _: &'a Named, _: &Context<'a>) -> Option<Axis<'a>> {
        let number = |row: &Row| row.interval.braked.then_some(row.interval.run as f64 + 1.0);
        Some(Axis { run_by_run: true, ..Axis::over("number of the run, after its first brake application", number) })
    }

    fn hidden(&self, _: &str, hide: &mut Hide<'_>) -> Option<Value> {
        Some(json!({ "drag_n_per_kg": hide.of([0.01, 0.006, 0.003]), "runs": 0.25 }))
    }
}
