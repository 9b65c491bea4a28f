//! Fig. 3: speed, acceleration, effort, r0, r1, r2 of a run.

use super::super::RunView;
use super::{BACKGROUND, BAND, KMH, nothing_estimated, over_location, trusted};
use crate::report::axis::Axis;
use rundown::{Real, model::state, model::train::Train};
use rundown_check::figure::HALF_95;
use rundown_pages::chart::{Drawing, Layer, Panel, Stroke, range_of};
use rundown_pages::colours;
use std::ops::Range;

/// Readings this much above the estimated speeds do not stretch the axis.
const SPEED_HEADROOM: Real = 1.3;

/// A truth further off than this many heights of the picture is named instead of drawn.
const TRUTH_REACH: Real = 1.0;

/// Fig. 3: speed, acceleration, effort and the three coefficients with their 95 % bands.
pub fn motion(run: &RunView, train: &Train) -> Drawing {
    over_location(
        run,
        &format!("Motion and resistance parameters of {}", run.name),
        "Measured and estimated speed, acceleration, applied effort and the three resistance \
         parameters with their 95 % bands, the manufacturer's values dashed",
        |axis| motion_panels(run, axis, train),
    )
}

fn motion_panels(run: &RunView, axis: &Axis, train: &Train) -> Vec<Panel> {
    let mut panels = vec![speed_panel(run, axis), acceleration_panel(run, axis, train), effort_panel(run, axis, train)];
    let davis = train.davis();
    let coefficients = [
        (state::R0, "r0, 10\u{207b}\u{b3} N/kg", 1e3, davis.r0),
        (state::R1, "r1, 10\u{207b}\u{2074} N/(kg m/s)", 1e4, davis.r1),
        (state::R2, "r2, 10\u{207b}\u{2075} N/(kg (m/s)\u{b2})", 1e5, davis.r2),
    ];
    for (component, label, per_unit, stated) in coefficients {
        panels.push(coefficient_panel(run, axis, component, label, per_unit, stated));
    }
    panels
}

fn speed_panel(run: &RunView, axis: &Axis) -> Panel {
    let measured = axis.series(&run.estimates, |index, _, x| Some((x, KMH * run.measurement(index)?.speed_mps?)));
    let estimated = axis.series(&run.estimates, |_, estimate, x| {
        trusted(estimate).then_some((x, KMH * estimate.belief.mean[state::SPEED]))
    });
    Panel::new(
        "speed, km/h",
        380,
        vec![
            Layer::line("estimated", colours::ESTIMATED, Stroke::Solid, estimated),
            Layer::line("measured", colours::MEASURED, Stroke::Dotted, measured),
        ],
        nothing_estimated(run),
    )
    .within(speed_range(run))
}

/// From 0 to a little above everything; a wild reading does not flatten the run.
pub(super) fn speed_range(run: &RunView) -> Range<Real> {
    let estimated_kmh = run.estimates.iter().map(|e| KMH * e.belief.mean[state::SPEED]);
    let estimated_kmh = range_of(estimated_kmh).end.max(10.0);
    let measured_kmh = run.measurements.iter().filter_map(|m| m.speed_mps).map(|v| KMH * v);
    let measured_kmh = range_of(measured_kmh).end.min(SPEED_HEADROOM * estimated_kmh);
    0.0..1.06 * estimated_kmh.max(measured_kmh)
}

fn acceleration_panel(run: &RunView, axis: &Axis, train: &Train) -> Panel {
    let values = axis.series(&run.estimates, |_, estimate, x| Some((x, estimate.acceleration_mps2?)));
    let limit = -train.description().max_brake_mps2;
    Panel::new(
        "acceleration, m/s\u{b2}",
        260,
        vec![
            Layer::line("mean since the sample before", colours::ESTIMATED, Stroke::Thin, values),
            Layer::level("largest deceleration", colours::LIMIT, Stroke::Dashed, &axis.range, limit),
        ],
        no_difference(run),
    )
}

fn effort_panel(run: &RunView, axis: &Axis, train: &Train) -> Panel {
    let values = axis.series(&run.estimates, |_, estimate, x| Some((x, estimate.effort_n_per_kg?)));
    let limit = axis.series(&run.estimates, |_, estimate, x| {
        let speed_mps = estimate.belief.mean[state::SPEED];
        let is_speed = speed_mps.is_finite() && trusted(estimate);
        is_speed.then(|| (x, train.max_effort_n_per_kg(speed_mps.max(0.0))))
    });
    let mut layers = Vec::new();
    if let Some(truth) = run.truth() {
        let points = axis.series(&run.estimates, |index, _, x| Some((x, truth.effort_n_per_kg[index])));
        layers.push(Layer::line("true", colours::TRUTH, Stroke::Solid, points));
    }
    layers.extend([
        Layer::line("mean since the sample before", colours::ESTIMATED, Stroke::Thin, values),
        Layer::line("largest tractive effort", colours::LIMIT, Stroke::Dashed, limit),
    ]);
    Panel::new("effort, N/kg", 260, layers, no_difference(run))
}

fn no_difference(run: &RunView) -> String {
    match run.estimates.len() {
        0 => nothing_estimated(run),
        1 => "no value: it takes two samples".to_owned(),
        _ => "no value: no two samples with a speed".to_owned(),
    }
}

fn coefficient_panel(run: &RunView, axis: &Axis, component: usize, label: &str, per_unit: Real, stated: Real) -> Panel {
    let mean = axis.series(&run.estimates, |_, estimate, x| Some((x, per_unit * estimate.belief.mean[component])));
    let band = axis.series(&run.estimates, |_, estimate, x| {
        let mean = per_unit * estimate.belief.mean[component];
        let width = HALF_95 * per_unit * estimate.belief.sd(component);
        Some((x, mean - width, mean + width))
    });
    let learned = axis.spans(&run.estimates, |_, estimate| estimate.learning);
    let mut layers = Vec::new();
    // Where all of the run is learning, as in the paper's mode, the background says nothing.
    let always = run.estimates.iter().skip(1).all(|e| e.learning);
    if !learned.is_empty() && !always {
        layers.push(Layer::spans("learned", colours::LEARNING, BACKGROUND, learned));
    }
    layers.extend([
        Layer::band("95 % band", colours::ESTIMATED, BAND, band),
        Layer::line("estimated", colours::ESTIMATED, Stroke::Solid, mean),
        Layer::level("manufacturer", colours::MANUFACTURER, Stroke::Dashed, &axis.range, per_unit * stated),
    ]);
    let mut y = None;
    if let Some(truth) = run.truth() {
        let true_value = per_unit * [truth.davis.r0, truth.davis.r1, truth.davis.r2][component - state::R0];
        // A truth far off must not flatten what the estimate does.
        let drawn = layers.iter().flat_map(Layer::heights);
        let near = range_of(drawn);
        let reach = TRUTH_REACH * (near.end - near.start);
        let is_near = (near.start - reach..=near.end + reach).contains(&true_value);
        if is_near {
            layers.push(Layer::level("true", colours::TRUTH, Stroke::Dotted, &axis.range, true_value));
        } else {
            let legend = format!("true {true_value:.2}, outside");
            layers.push(Layer::line(legend, colours::TRUTH, Stroke::Dotted, Vec::new()));
            let air = 0.06 * (near.end - near.start);
            y = Some(near.start - air..near.end + air);
        }
    }
    Panel { y, ..Panel::new(label, 220, layers, nothing_estimated(run)) }
}

#[cfg(test)]
mod tests {
    use super::super::super::example;
    use super::*;

    #[test]
    fn a_missing_speed_is_a_gap_of_the_measured_line_only() {
        let example = example::run();
        let view = RunView::of(&example, None);
        let panel = speed_panel(&view, &Axis::of_motion(&view));
        let gaps = |layer: &Layer| match layer {
            Layer::Line { points, .. } => points.iter().filter(|point| point.is_none()).count(),
            _ => 0,
        };
        let gaps: Vec<usize> = panel.layers.iter().map(gaps).collect();
        assert_eq!(gaps, [0, 5]);
    }

    #[test]
    fn a_wild_reading_does_not_flatten_the_run() {
        let mut example = example::run();
        let before = speed_range(&RunView::of(&example, None));
        example.measurements[40].speed_mps = Some(500.0);
        let after = speed_range(&RunView::of(&example, None));
        assert!(after.end < 1.31 * before.end);
    }
}
