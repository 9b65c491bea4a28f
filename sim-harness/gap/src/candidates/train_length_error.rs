//! A train of another length.

use crate::candidates::kit::*;
use crate::noise::dragging_units::choice;
use rundown::model::effects::TrainLengthError;

pub struct This;

impl Candidate for This {
    fn facts(&self) -> Facts {
        Facts {
            kind: Some(EffectKind::TrainLengthError),
            what: "The train is longer or shorter than described, so the gradient under it is averaged over another length.",
            law: "gradient mean over the true length",
            parameters: "true_length_m; the runs in which it acts, where these are not all",
            shows: "differences at every change of gradient, up and down with the change of slope",
            confounded: "location_lag, which shifts the gradients by the distance of the lag; a location of the antenna instead of the front",
            separates: "both directions; a line with short steep gradients; the list of the vehicles",
            nature: Nature { by_place: true, turns: true, whole: true, ..Nature::default() },
            prior: Prior {
                least: 0.15,
                most: 1.95,
                shapes: &[],
                source: "Smallest share by which the length differs; largest length as a share of the described one. Judgement.",
            },
            ..Facts::default()
        }
    }

    fn families(&self, offer: &Offer<'_>) -> Vec<Family> {
        let believed_m = offer.context.believed.train().length_m();
        let (least, most) = range(self, offer.context);
        let steps = (4..=(20.0 * most).round() as i32).filter(|i| f64::from((i - 20).abs()) >= 20.0 * least);
        let length = |i: i32| Term { of: &This, shape: Shape::Number(believed_m * f64::from(i) / 20.0) };
        vec![Family::Whole(steps.map(length).collect())]
    }

    /// Gradient over another length, m, minus that over the believed one.
    fn columns(&self, shape: &Shape, context: &Context<'_>, rows: &[Row]) -> Vec<Vec<f64>> {
        let (true_m, runs) = (shape.number(), shape.runs());
        let gravity = context.believed.train().gravity_n_per_kg();
        vec![along(context, rows, |line, row, p| {
            if !runs.is_empty() && !runs.contains(&row.interval.run) {
                return 0.0;
            }
            gravity
                * (line.track.mean_gradient(p.location_m, true_m, line.direction)
                    - line.track.mean_gradient(p.location_m, line.train.length_m(), line.direction))
        })]
    }

    fn penalty(&self, shape: &Shape, penalty: &PenaltyConfig, rows: &[Row]) -> f64 {
        let which = if shape.runs().is_empty() { 0.0 } else { choice(shape.runs(), rows) };
        penalty.coefficient + penalty.shape + penalty.shift + which
    }

    fn dial(&self, shape: &Shape) -> Option<Dial> {
        let log_m = shape.number().ln();
        Some(Dial { step: 0.03, range: (log_m - 0.3, log_m + 0.3), exponential: true, ..Dial::default() })
    }

    fn effect(&self, fitted: &Fitted, naming: &Naming<'_>) -> Option<(Effect, Vec<Interval95>)> {
        let true_length_m = fitted.term.shape.number();
        // Where only some runs have it, which these are has been chosen by it, and the lag of the locations of all was,
        // too.
        let apart_m = (true_length_m - naming.context.believed.train().length_m()).abs();
        let certainty = &naming.context.config.certainty;
        let chosen = match (fitted.term.shape.runs().is_empty(), naming.have().both_directions) {
            (true, _) => 0.0,
            (false, true) => certainty.chosen,
            (false, false) => certainty.chosen_one_way,
        };
        let more_m = chosen * apart_m;
        let interval = fitted.shape.map(|limits| ("true_length_m", limits.shape.0 - more_m, limits.shape.1 + more_m));
        Some((TrainLengthError { true_length_m }.into(), interval.into_iter().collect()))
    }

    fn sentence(&self, named: &Named, context: &Context<'_>) -> String {
        format!(
            "The train is not as long as described: {} instead of {} m",
            with_unit(named, "true_length_m"),
            number(context.believed.train().length_m(), 0)
        )
    }

    fn axis<'a>(&self, named: &'a Named, context: &Context<'a>) -> Option<Axis<'a>> {
        let believed = context.believed;
        Some(Axis::over("gradient under the length found less that under the believed one, N/kg", move |row| {
            Some(extra(&believed, &named.effect, row))
        }))
    }

    fn hidden(&self, _: &str, hide: &mut Hide<'_>) -> Option<Value> {
        Some(json!({ "true_length_m": hide.length_m * hide.of([0.5, 0.67, 0.8]) }))
    }

    fn main_parameter(&self, length_m: f64) -> Option<(&'static str, f64)> {
        Some(("true_length_m", length_m))
    }
}
