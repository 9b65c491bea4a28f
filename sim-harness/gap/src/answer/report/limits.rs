//! Effort over the believed limit at full power, where a limit is not as believed.

use super::maps::sections;
use crate::answer::whole::Answer;
use crate::traction::pulls::Pull;
use rundown::model::effects::Effect;
use rundown_pages::chart::{Axes, Figure, Layer, Panel, Stroke, range_of};
use rundown_pages::colours;

/// Dots that a reader can still tell apart.
const MOST_DOTS: usize = 4000;

/// Picture and caption; none where the limits are as believed.
pub(super) fn limits(answer: &Answer) -> Option<(String, String)> {
    let findings = &answer.found.findings;
    let limit = findings.limit(&answer.config.search)?;
    let (section, factor) = (limit.effect.section_m(), limit.factor);
    let pulls: Vec<&Pull> = findings.pulls.iter().flatten().collect();
    let km = |pull: &Pull| pull.location_m / 1000.0;
    let kmh = |pull: &Pull| 3.6 * pull.speed_mps;
    let by_location = section.is_some();
    let at = |pull: &Pull| if by_location { km(pull) } else { kmh(pull) };
    let x = range_of(pulls.iter().map(|p| at(p)));
    let span = match (&limit.effect, section) {
        (_, Some((from_m, to_m))) => from_m / 1000.0..to_m / 1000.0,
        (Effect::LowAdhesion(e), None) => x.start..e.below_kmh,
        (_, None) => x.clone(),
    };
    let affected = |pull: &Pull| limit.runs.is_empty() || limit.runs.contains(&pull.run);
    let step = pulls.len().div_ceil(MOST_DOTS).max(1);
    let dots = |of: bool| -> Vec<(f64, f64)> {
        let those = pulls.iter().filter(|p| affected(p) == of);
        those.step_by(step).map(|p| (at(p), p.ratio)).collect()
    };
    let mut layers = vec![Layer::Dots {
        legend: "other runs".to_owned(),
        colour: colours::LIMIT,
        opacity: 0.2,
        points: dots(false),
    }];
    if limit.runs.is_empty() {
        layers.clear();
    }
    if by_location {
        layers.push(sections(answer));
    }
    layers.push(Layer::Dots {
        legend: "measured at full power".to_owned(),
        colour: colours::MEASURED,
        opacity: 0.3,
        points: dots(true),
    });
    layers.push(Layer::Line {
        legend: "limit found".to_owned(),
        colour: colours::ESTIMATED,
        stroke: Stroke::Solid,
        points: vec![Some((span.start, factor)), Some((span.end, factor))],
    });
    let figure = Figure {
        title: "Effort over believed limit".to_owned(),
        description: "Each interval of steady full power, with the limit that was found".to_owned(),
        x_label: if by_location { "location, km" } else { "speed, km/h" }.to_owned(),
        x,
        panels: vec![Panel {
            label: "effort over believed limit".to_owned(),
            height: 380,
            y: Some(0.0..1.3),
            axes: Axes::Left,
            layers,
            empty: "no interval of full power".to_owned(),
        }],
    };
    Some((
        figure.to_svg(),
        "Effort over the believed limit while the train powers with steady power. A driver may ask for less than the train gives, so only what is never exceeded counts.".to_owned(),
    ))
}
