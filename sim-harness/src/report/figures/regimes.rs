//! Fig. 6: the speed profile in the colours of the regimes.

use super::super::{RunView, regime_shares};
use super::motion::speed_range;
use super::{KMH, nothing_estimated, over_location, trusted};
use crate::report::axis::Axis;
use plotters::style::RGBColor;
use rundown::{features::Phase, model::state, tick::regime::Regime};
use rundown_pages::chart::{Drawing, Layer, Panel, Point};
use rundown_pages::{colours, numbers::percent};

/// Fig. 6: the speed profile in the colours of the regimes, their shares in the legend.
pub fn regimes(run: &RunView) -> Drawing {
    over_location(
        run,
        &format!("Driving regimes of {}", run.name),
        "The estimated speed, each stretch in the colour of its driving regime",
        |axis| vec![panel(run, axis)],
    )
}

fn panel(run: &RunView, axis: &Axis) -> Panel {
    let shares = regime_shares(run);
    let present = |regime: &Regime| (0..run.estimates.len()).any(|i| run.regime(i) == *regime);
    let legends = Regime::ALL.into_iter().filter(present).map(|regime| {
        let share = shares.map(|shares| shares[regime as usize]);
        let legend = format!("{regime} {}", percent(share));
        (legend, colours::of_regime(regime))
    });
    let mut layers = vec![Layer::Pieces { legends: legends.collect(), pieces: regime_pieces(run, axis) }];
    let phases = [&run.summary.features.final_coast, &run.summary.features.final_brake];
    let start = |phase: &Phase| (axis.at(phase.start_location_m, phase.start_time_s), KMH * phase.start_speed_mps);
    let starts = phases.into_iter().flatten().map(start).collect();
    layers.push(Layer::marks("start of final coast, brake", RGBColor(255, 140, 0), starts));
    if let Some(truth) = run.truth().filter(|_| axis.is_location()) {
        let starts = truth.starts.iter().map(|(s, v)| (s / 1000.0, KMH * v)).collect();
        layers.push(Layer::marks("true start", colours::TRUTH, starts));
    }
    layers.retain(|layer| !matches!(layer, Layer::Marks { points, .. } if points.is_empty()));
    Panel::new("speed, km/h", 420, layers, nothing_estimated(run)).within(speed_range(run))
}

/// A piece for each stretch of one regime; it begins where the one before it ended.
fn regime_pieces(run: &RunView, axis: &Axis) -> Vec<(RGBColor, Vec<Point>)> {
    let mut pieces: Vec<(Regime, Vec<Point>)> = Vec::new();
    let mut last: Option<Point> = None;
    for (index, estimate) in run.estimates.iter().enumerate() {
        let speed_kmh = KMH * estimate.belief.mean[state::SPEED];
        let place = axis.x[index].filter(|_| speed_kmh.is_finite() && trusted(estimate));
        let Some(x) = place else {
            last = None;
            continue;
        };
        let last_here = last.filter(|_| !axis.has_pause_before(index));
        let point = (x, speed_kmh);
        let regime = run.regime(index);
        match (pieces.last_mut(), last_here) {
            (Some((same, points)), Some(_)) if *same == regime => points.push(point),
            (_, last_here) => {
                pieces.push((regime, last_here.into_iter().chain([point]).collect()));
            }
        }
        last = Some(point);
    }
    let coloured = |(regime, points)| (colours::of_regime(regime), points);
    pieces.into_iter().map(coloured).collect()
}

#[cfg(test)]
mod tests {
    use super::super::super::example;
    use super::*;

    #[test]
    fn each_regime_has_its_colour_and_share() {
        let example = example::run();
        let svg = regimes(&RunView::of(&example, None)).to_svg();
        for regime in Regime::ALL {
            let RGBColor(r, g, b) = colours::of_regime(regime);
            assert!(svg.contains(&format!("stroke=\"#{r:02X}{g:02X}{b:02X}\"")), "{regime}");
        }
        let share = regime_shares(&example).unwrap()[Regime::Coast as usize];
        assert!(share > 0.4 && svg.contains(&format!("coast {}", percent(share))));
        assert!(!regimes(&RunView::of(&example::first(5), None)).to_svg().contains("coast"));
    }

    #[test]
    fn the_pieces_of_the_regimes_join() {
        let example = example::run();
        let view = RunView::of(&example, None);
        let pieces = regime_pieces(&view, &Axis::of_motion(&view));
        let changes = example.regimes.windows(2).filter(|pair| pair[0] != pair[1]).count();
        assert_eq!(pieces.len(), 1 + changes);
        for pair in pieces.windows(2) {
            assert_eq!(pair[0].1.last(), pair[1].1.first());
        }
    }
}
