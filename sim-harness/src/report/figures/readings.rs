//! How the readings were used: innovations, and strips of causes.

use super::super::RunView;
use super::{BAND, KMH, nothing_estimated, over_time};
use crate::report::axis::Axis;
use plotters::style::RGBColor;
use rundown::tick::estimate::{Cause, Estimate, Validity};
use rundown::{Real, filter::ukf::Reading, model::state, tick::regime::Regime};
use rundown_pages::chart::{Axes, Drawing, Layer, Panel, Point, Stroke};
use rundown_pages::colours;
use std::ops::Range;

/// Innovations of location and speed with their ±2 sd bands, over time.
pub fn innovations(run: &RunView) -> Drawing {
    over_time(
        run,
        &format!("Innovations of {}", run.name),
        "Measured less expected location and speed with the band of two standard deviations",
        |axis| innovation_panels(run, axis),
    )
}

fn innovation_panels(run: &RunView, axis: &Axis) -> Vec<Panel> {
    let panel = |reading: usize, label: &str, per_unit: Real| {
        let of = |estimate: &Estimate, wanted: fn(Reading) -> bool| {
            estimate.innovation.filter(|innovation| wanted(innovation.readings[reading]))
        };
        let there = |found| found != Reading::Missing;
        let band = axis.series(&run.estimates, |_, estimate, x| {
            let variance = of(estimate, there)?.covariance[(reading, reading)];
            let width = 2.0 * per_unit * variance.max(0.0).sqrt();
            Some((x, -width, width))
        });
        let values =
            axis.series(&run.estimates, |_, estimate, x| Some((x, per_unit * of(estimate, there)?.value[reading])));
        let gated = axis.series(&run.estimates, |_, estimate, x| {
            let innovation = of(estimate, |found| found == Reading::Gated)?;
            Some((x, per_unit * innovation.value[reading]))
        });
        let gated: Vec<Point> = gated.into_iter().flatten().collect();
        let mut layers = vec![
            Layer::band("\u{b1}2 standard deviations", colours::MEASURED, BAND, band),
            Layer::line("measured less expected", colours::ESTIMATED, Stroke::Thin, values),
        ];
        if !gated.is_empty() {
            layers.push(Layer::marks("outside the gate, not used", colours::LIMIT, gated));
        }
        Panel::new(
            label,
            220,
            layers,
            match run.estimates.is_empty() {
                true => nothing_estimated(run),
                false => "no innovation: nothing was expected of any sample of this run".to_owned(),
            },
        )
    };
    vec![
        panel(state::LOCATION, "innovation of the location, m", 1.0),
        panel(state::SPEED, "innovation of the speed, km/h", KMH),
    ]
}

/// Which samples were used, held or not to be trusted, why, and where was learned; over time.
pub fn readings(run: &RunView) -> Drawing {
    over_time(
        run,
        &format!("Use of the readings of {}", run.name),
        "Strips: whether the estimate is valid, where the resistance was learned, the regime, and each cause for which a reading was not used",
        |axis| vec![readings_panel(run, axis)],
    )
}

fn readings_panel(run: &RunView, axis: &Axis) -> Panel {
    const VALIDITIES: [(&str, RGBColor); 3] =
        [("valid", colours::VALID), ("held", colours::HELD), ("invalid", colours::INVALID)];
    const NO_GAP: Range<Real> = 0.12..0.5;
    let mut rows: Vec<(String, Vec<Layer>)> = Vec::new();
    let bars = |legend: &str, colour: RGBColor, spans: Vec<Range<Real>>| Layer::Bars {
        legend: legend.to_owned(),
        colour,
        spans,
        heights: NO_GAP,
    };
    let validity = VALIDITIES.map(|(word, colour)| {
        let spans = axis.spans(&run.estimates, |_, e| e.validity.as_str() == word);
        bars(word, colour, spans)
    });
    rows.push(("estimate".to_owned(), validity.into()));
    let learned = axis.spans(&run.estimates, |_, estimate| estimate.learning);
    rows.push(("resistance learned".to_owned(), vec![bars("learned", colours::LEARNING, learned)]));
    let regimes = Regime::ALL.map(|regime| {
        let spans = axis.spans(&run.estimates, |index, _| run.regime(index) == regime);
        bars(regime.as_str(), colours::of_regime(regime), spans)
    });
    rows.push(("regime".to_owned(), regimes.into()));
    for cause in Cause::ALL {
        let spans = axis.spans(&run.estimates, |_, e| e.validity.cause() == Some(cause));
        if !spans.is_empty() {
            let worst = run.estimates.iter().any(|e| e.validity == Validity::Invalid(cause));
            let colour = if worst { colours::INVALID } else { colours::HELD };
            rows.push((cause.as_str().replace('_', " "), vec![bars("", colour, spans)]));
        }
    }
    let count = rows.len();
    let mut layers = Vec::new();
    for (row, (name, bars)) in rows.into_iter().enumerate() {
        let foot = (count - row - 1) as Real;
        for bar in bars {
            layers.push(match bar {
                Layer::Bars { legend, colour, spans, heights } => Layer::Bars {
                    legend: if spans.is_empty() { String::new() } else { legend },
                    colour,
                    spans,
                    heights: foot + heights.start..foot + heights.end,
                },
                other => other,
            });
        }
        layers.push(Layer::Word { text: name, y: foot + 0.52 });
    }
    Panel::new("readings", 76 * count as u32, layers, nothing_estimated(run))
        .within(0.0..count as Real)
        .labelled(Axes::Strip)
}

#[cfg(test)]
mod tests {
    use super::super::super::example;
    use super::*;

    #[test]
    fn a_run_without_innovations_says_so() {
        let mut example = example::run();
        for estimate in &mut example.estimates {
            estimate.innovation = None;
        }
        assert!(innovations(&RunView::of(&example, None)).to_svg().contains("no innovation: nothing was expected"));
    }

    #[test]
    fn the_strip_names_each_cause() {
        let mut example = example::run();
        assert!(!readings(&RunView::of(&example, None)).to_svg().contains("location jump"));
        example.estimates[50].validity = Validity::Invalid(Cause::LocationJump);
        let svg = readings(&RunView::of(&example, None)).to_svg();
        assert!(svg.contains("location jump") && svg.contains("no speed"));
    }
}
