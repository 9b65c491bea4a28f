//! Effort over the believed limit at full power, where a limit is not as believed.

use super::maps::sections;
use crate::answer::whole::Answer;
use crate::traction::powering::SteadyPower;
use rundown::model::effects::Effect;
use rundown_pages::chart::{Drawing, Figure, Layer, Panel, Stroke, range_of};
use rundown_pages::colours;

/// Dots that a reader can still separate.
const MOST_DOTS: usize = 4000;

/// Picture and caption; none where the limits are as believed.
pub(super) fn limits(answer: &Answer) -> Option<(Drawing, String)> {
    let findings = &answer.found.findings;
    let limit = findings.limit(&answer.config.search)?;
    let (section, factor) = (limit.effect.section_m(), limit.factor);
    let powering: Vec<&SteadyPower> = findings.powering.iter().flatten().collect();
    let km = |power: &SteadyPower| power.location_m / 1000.0;
    let kmh = |power: &SteadyPower| 3.6 * power.speed_mps;
    let by_location = section.is_some();
    let at = |power: &SteadyPower| if by_location { km(power) } else { kmh(power) };
    let x = range_of(powering.iter().map(|p| at(p)));
    let span = match (&limit.effect, section) {
        (_, Some((from_m, to_m))) => from_m / 1000.0..to_m / 1000.0,
        (Effect::LowAdhesion(e), None) => x.start..e.below_kmh,
        (_, None) => x.clone(),
    };
    let affected = |power: &SteadyPower| limit.runs.is_empty() || limit.runs.contains(&power.run);
    let step = powering.len().div_ceil(MOST_DOTS).max(1);
    let dots = |of: bool| -> Vec<(f64, f64)> {
        let those = powering.iter().filter(|p| affected(p) == of);
        those.step_by(step).map(|p| (at(p), p.ratio)).collect()
    };
    let others = || Layer::dots("other runs", colours::LIMIT, 0.2, dots(false));
    let layers = [(!limit.runs.is_empty()).then(others), by_location.then(|| sections(answer))].into_iter().flatten();
    let measured = Layer::dots("measured at full power", colours::MEASURED, 0.3, dots(true));
    let found = Layer::level("limit found", colours::ESTIMATED, Stroke::Solid, &span, factor);
    let layers: Vec<Layer> = layers.chain([measured, found]).collect();
    let figure = Figure::new(
        "Effort over believed limit",
        "Each interval of steady full power, with the limit that was found",
        if by_location { "location, km" } else { "speed, km/h" },
        x,
        [Panel::new("effort over believed limit", 380, layers, "no interval of full power").within(0.0..1.3)],
    );
    Some((
        figure.into(),
        "Effort over the believed limit while the train powers with steady power. A driver may demand less than the train gives, so only what is never exceeded counts.".to_owned(),
    ))
}
