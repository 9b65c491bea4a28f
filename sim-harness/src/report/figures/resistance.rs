//! Running resistance: its terms along a run (Fig. 5), over speed, and of the vehicle from run to run.

use super::{super::RunView, super::resistance::Resistance};
use super::{BACKGROUND, BAND, KMH, MILLI, nothing_estimated, over_location};
use crate::report::axis::Axis;
use rundown::{Real, filter::gaussian::Gaussian, model::state, model::train::Train, model::units::KmPerHour};
use rundown_pages::chart::{Axes, Drawing, Figure, Layer, Panel, Stroke};
use rundown_pages::colours;
use std::ops::Range;

/// Fig. 5: r0, r1 v, r2 v² stacked, and the resistance of the gradient in the same scale.
pub fn resistance_terms(run: &RunView) -> Drawing {
    over_location(
        run,
        &format!("Terms of the running resistance of {}", run.name),
        "Stacked areas of the constant, linear and quadratic term, and a line of the resistance of the gradient",
        |axis| vec![terms_panel(run, axis)],
    )
}

fn terms_panel(run: &RunView, axis: &Axis) -> Panel {
    let names = [
        ("constant r0", colours::CONSTANT_TERM),
        ("linear r1 v", colours::LINEAR_TERM),
        ("quadratic r2 v\u{b2}", colours::QUADRATIC_TERM),
    ];
    let mut layers = Vec::new();
    for (term, (legend, colour)) in names.into_iter().enumerate() {
        let points = axis.series(&run.estimates, |_, estimate, x| {
            let speed_mps = estimate.belief.mean[state::SPEED];
            let terms = estimate.davis().terms_n_per_kg(speed_mps);
            let below: Real = terms.iter().take(term).sum();
            Some((x, MILLI * below, MILLI * (below + terms[term])))
        });
        layers.push(Layer::band(legend, colour, 1.0, points));
    }
    layers.push(Layer::line(
        "track gradient (right axis)",
        colours::GRADIENT,
        Stroke::Thin,
        axis.series(&run.estimates, |_, estimate, x| Some((x, MILLI * estimate.gradient_n_per_kg))),
    ));
    if let Some(truth) = run.truth() {
        layers.push(Layer::line(
            "true running resistance",
            colours::TRUTH,
            Stroke::Dotted,
            axis.series(&run.estimates, |index, _, x| Some((x, MILLI * truth.resistance_n_per_kg[index]))),
        ));
    }
    Panel::new("resistance, 10\u{207b}\u{b3} N/kg", 480, layers, nothing_estimated(run)).labelled(Axes::Both)
}

/// r(v) of the vehicle with its 95 % band, the manufacturer's dashed; `learned_mps` are the speeds it was learned at.
pub fn resistance_curve(vehicle: Option<&Gaussian<3>>, train: &Train, learned_mps: Option<Range<Real>>) -> Drawing {
    let fastest_kmh = learned_mps.as_ref().map_or(0.0, |speeds| KMH * speeds.end);
    let end_kmh = (20.0 * (fastest_kmh / 20.0).ceil() + 20.0).clamp(160.0, 400.0);
    let speeds_kmh: Vec<Real> = (0..=40).map(|i| end_kmh * Real::from(i) / 40.0).collect();
    let at = |kmh: Real| vehicle.and_then(|vehicle| Resistance::at(vehicle, KmPerHour(kmh).to_mps()));
    let band = speeds_kmh.iter().map(|&kmh| {
        let r = at(kmh)?;
        Some((kmh, MILLI * r.lower(), MILLI * r.upper()))
    });
    let mean = speeds_kmh.iter().map(|&kmh| Some((kmh, MILLI * at(kmh)?.mean_n_per_kg)));
    let stated = speeds_kmh.iter().map(|&kmh| {
        let r = train.davis().resistance_n_per_kg(KmPerHour(kmh).to_mps());
        Some((kmh, MILLI * r))
    });
    // A band of a percent hides behind the line of the curve; against the manufacturer's it does not.
    let against = |r: Real, kmh: Real| 100.0 * (r / train.davis().resistance_n_per_kg(KmPerHour(kmh).to_mps()) - 1.0);
    let deviation = speeds_kmh.iter().map(|&kmh| Some((kmh, against(at(kmh)?.mean_n_per_kg, kmh))));
    let deviation_band = speeds_kmh.iter().map(|&kmh| {
        let r = at(kmh)?;
        Some((kmh, against(r.lower(), kmh), against(r.upper(), kmh)))
    });
    let learned = learned_mps.map(|speeds| {
        let span = vec![KMH * speeds.start..KMH * speeds.end];
        Layer::spans("speeds it was learned at", colours::LEARNING, BACKGROUND, span)
    });
    let curve: Vec<Layer> = learned
        .clone()
        .into_iter()
        .chain([
            Layer::band("95 % band", colours::ESTIMATED, BAND, band.collect()),
            Layer::line("estimated", colours::ESTIMATED, Stroke::Solid, mean.collect()),
            Layer::line("manufacturer", colours::MANUFACTURER, Stroke::Dashed, stated.collect()),
        ])
        .collect();
    let all_kmh = 0.0..end_kmh;
    let less: Vec<Layer> = learned
        .into_iter()
        .chain([
            Layer::band("95 % band", colours::ESTIMATED, BAND, deviation_band.collect()),
            Layer::line("estimated", colours::ESTIMATED, Stroke::Solid, deviation.collect()),
            Layer::level("manufacturer", colours::MANUFACTURER, Stroke::Dashed, &all_kmh, 0.0),
        ])
        .collect();
    let none = "no estimate: no run has ended";
    let figure = Figure::new(
        "Running resistance over speed",
        "The estimated resistance with its 95 % band, the manufacturer's dashed; below, by how much it is more",
        "speed, km/h",
        all_kmh,
        [
            Panel::new("r(v), 10\u{207b}\u{b3} N/kg", 420, curve, none),
            Panel::new("more than the manufacturer's, %", 300, less, none),
        ],
    );
    figure.into()
}

/// Running resistance of the vehicle at one speed after each run, with its 95 % band.
pub fn vehicle_history(vehicle: &[(String, Gaussian<3>)], train: &Train, speed_kmh: Real) -> Drawing {
    let speed_mps = KmPerHour(speed_kmh).to_mps();
    let runs: Vec<(Real, Option<Resistance>)> = vehicle
        .iter()
        .enumerate()
        .map(|(index, (_, belief))| ((index + 1) as Real, Resistance::at(belief, speed_mps)))
        .collect();
    let ends = 0.5..vehicle.len().max(1) as Real + 0.5;
    let stated = MILLI * train.davis().resistance_n_per_kg(speed_mps);
    let band = |(run, r): &(Real, Option<Resistance>)| r.map(|r| (*run, MILLI * r.lower(), MILLI * r.upper()));
    let mean = |(run, r): &(Real, Option<Resistance>)| r.map(|r| (*run, MILLI * r.mean_n_per_kg));
    let layers = vec![
        Layer::band("95 % band", colours::ESTIMATED, BAND, runs.iter().map(band).collect()),
        Layer::line("vehicle after the run", colours::ESTIMATED, Stroke::Solid, runs.iter().map(mean).collect()),
        Layer::level("manufacturer", colours::MANUFACTURER, Stroke::Dashed, &ends, stated),
    ];
    let figure = Figure::new(
        format!("Resistance of the vehicle at {speed_kmh} km/h after each run"),
        "The estimate with its 95 % band after each run, the manufacturer's value dashed",
        "run, in the order of the table",
        ends,
        [Panel::new(
            format!("r({speed_kmh} km/h), 10\u{207b}\u{b3} N/kg"),
            360,
            layers,
            "no estimate: no run has ended",
        )],
    );
    figure.over_counts().into()
}

#[cfg(test)]
mod tests {
    use super::super::super::example::train;
    use super::*;

    #[test]
    fn the_curve_shows_the_manufacturer_even_without_an_estimate() {
        let svg = resistance_curve(None, &train(), None).to_svg();
        let (r, g, b) = (colours::MANUFACTURER.0, colours::MANUFACTURER.1, colours::MANUFACTURER.2);
        let colour = format!("stroke=\"#{r:02X}{g:02X}{b:02X}\"");
        let drawn = svg.lines().filter(|line| line.starts_with("<polyline") && line.contains(&colour)).count();
        assert!(svg.contains("no estimate") && drawn > 10, "{drawn} dashes");
    }
}
