//! What coasting from each place on leads to: speed and time at the next stop or lower limit, beside what came.
//!
//! While a train coasts its prediction should stay where it is; under power or brake each place has another one.

use super::super::RunView;
use super::{BACKGROUND, BAND, KMH, over_location};
use crate::report::axis::Axis;
use rundown::coast_ahead::{Arrival, CoastAhead, NINETY_PERCENT, Outcome};
use rundown::{Real, model::state, model::track::Target, tick::regime::Regime};
use rundown_pages::chart::{Drawing, Layer, Panel, Point, Stroke};
use rundown_pages::colours;

const MINUTE_S: Real = 60.0;

/// Speed and time at the target with their 90 % bands; none where the train is nowhere said to arrive.
pub fn coast_ahead(run: &RunView) -> Option<Drawing> {
    if !Axis::of_motion(run).is_location() || !(0..run.coast_ahead.len()).any(|i| arrival(run, i).is_some()) {
        return None;
    }
    let first_s = run.estimates.first()?.time_s;
    Some(over_location(
        run,
        &format!("Coasting ahead in {}", run.name),
        "Speed and time at the next stop or lower limit if the train coasts from each place on, \
         with their 90 % bands, and what came",
        |axis| panels(run, axis, first_s),
    ))
}

fn panels(run: &RunView, axis: &Axis, first_s: Real) -> Vec<Panel> {
    let (speeds, times) = came(run)
        .into_iter()
        .map(|(km, kmh, time_s)| {
            let x = axis.at(1000.0 * km, time_s);
            ((x, kmh), (x, (time_s - first_s) / MINUTE_S))
        })
        .unzip();
    let mut speed = panel(run, axis, "speed at the target, km/h", speeds, |arrival| {
        (KMH * arrival.speed_mps, KMH * arrival.speed_sd_mps)
    });
    let permitted = axis.series(&run.estimates, |index, _, x| {
        let (target, _) = arrival(run, index)?;
        Some((x, KMH * target.limit_mps.unwrap_or(0.0)))
    });
    speed.layers.push(Layer::line("permitted there", colours::LIMIT, Stroke::Dashed, permitted));
    let label = "there, min since the first sample";
    let time = panel(run, axis, label, times, |arrival| {
        let after_s = arrival.time_s - first_s;
        (after_s / MINUTE_S, arrival.time_sd_s / MINUTE_S)
    });
    vec![speed, time]
}

/// The prediction of an estimate that arrives. Not the first one of a target: there the line is broken.
fn arrival(run: &RunView, index: usize) -> Option<(Target, Arrival)> {
    let of = |ahead: &CoastAhead| match (ahead.target, ahead.outcome) {
        (Some(target), Outcome::Arrives(arrival)) => Some((target, arrival)),
        _ => None,
    };
    let (target, arrival) = of(run.coast_ahead.get(index)?)?;
    let before = run.coast_ahead.get(index.checked_sub(1)?)?.target;
    (before == Some(target)).then_some((target, arrival))
}

fn panel(run: &RunView, axis: &Axis, label: &str, came: Vec<Point>, value: impl Fn(&Arrival) -> (Real, Real)) -> Panel {
    let at = |index| arrival(run, index).map(|(_, arrival)| value(&arrival));
    let band = axis.series(&run.estimates, |index, _, x| {
        let (mean, sd) = at(index)?;
        let half = NINETY_PERCENT * sd;
        Some((x, mean - half, mean + half))
    });
    let mean = axis.series(&run.estimates, |index, _, x| Some((x, at(index)?.0)));
    let mut layers = vec![
        Layer::spans(
            "the train coasts",
            colours::of_regime(Regime::Coast),
            BACKGROUND,
            axis.spans(&run.estimates, |index, _| run.regime(index) == Regime::Coast),
        ),
        Layer::band("90 % band", colours::ESTIMATED, BAND, band),
        Layer::line("if it coasts from here on", colours::ESTIMATED, Stroke::Solid, mean),
        Layer::marks("as it came", colours::MEASURED, came),
    ];
    layers.retain(|layer| match layer {
        Layer::Spans { spans, .. } => !spans.is_empty(),
        Layer::Marks { points, .. } => !points.is_empty(),
        _ => true,
    });
    Panel::new(label, 260, layers, "no prediction")
}

/// Each target that the train went past: location in km, speed in km/h, time in s, between two estimates.
fn came(run: &RunView) -> Vec<(Real, Real, Real)> {
    let mut places_m: Vec<Real> =
        (0..run.coast_ahead.len()).filter_map(|index| Some(arrival(run, index)?.0.at_m)).collect();
    places_m.dedup();
    let passing = |at_m: Real| {
        run.estimates.windows(2).find_map(|pair| {
            let [before, after] = pair else { return None };
            let (from, to) = (&before.belief.mean, &after.belief.mean);
            let distance_m = to[state::LOCATION] - from[state::LOCATION];
            let share = (at_m - from[state::LOCATION]) / distance_m;
            let between = |a: Real, b: Real| a + share * (b - a);
            (0.0..=1.0).contains(&share).then(|| {
                let speed_mps = between(from[state::SPEED], to[state::SPEED]);
                let time_s = between(before.time_s, after.time_s);
                (at_m / 1000.0, KMH * speed_mps, time_s)
            })
        })
    };
    places_m.into_iter().filter_map(passing).collect()
}

#[cfg(test)]
mod tests {
    use super::super::super::example;
    use super::*;
    use rundown::model::point::Point as From;
    use rundown_files::replay::ReplayedRun;

    /// To the place where the train is after sample 60, said from sample 40 on.
    fn predictions(example: &ReplayedRun) -> Vec<CoastAhead> {
        let at_m = example.estimates[60].belief.mean[state::LOCATION] + 50.0;
        let one = |index: usize| CoastAhead {
            from: From {
                time_s: example.estimates[index].time_s,
                location_m: example.estimates[index].belief.mean[state::LOCATION],
                speed_mps: example.estimates[index].belief.mean[state::SPEED],
            },
            target: (40..=60).contains(&index).then_some(Target { at_m, limit_mps: Some(10.0) }),
            outcome: match index {
                40..=60 => Outcome::Arrives(Arrival {
                    speed_mps: 20.0,
                    speed_sd_mps: 1.0,
                    time_s: example.estimates[60].time_s + 2.0,
                    time_sd_s: 5.0,
                    speed_per_m: 0.0,
                }),
                _ => Outcome::NoTarget,
            },
        };
        (0..example.estimates.len()).map(one).collect()
    }

    #[test]
    fn predictions_stand_beside_what_came() {
        let mut example = example::run();
        example.coast_ahead = predictions(&example);
        let view = RunView::of(&example, None);
        let [(km, kmh, time_s)] = came(&view)[..] else {
            panic!("{:?}", came(&view));
        };
        let [before, after] = [60, 61].map(|index| &example.estimates[index]);
        assert!((1000.0 * km - before.belief.mean[state::LOCATION] - 50.0).abs() < 1e-6);
        assert!(before.time_s < time_s && time_s < after.time_s);
        let speeds = [before, after].map(|e| KMH * e.belief.mean[state::SPEED]);
        assert!(kmh <= speeds[0].max(speeds[1]) && kmh >= speeds[0].min(speeds[1]));
        let panel =
            panel(&view, &Axis::of_motion(&view), "", Vec::new(), |arrival| (arrival.speed_mps, arrival.speed_sd_mps));
        let bands = panel.layers.iter().find_map(|layer| match layer {
            Layer::Band { points, .. } => Some(points.iter().flatten().copied().collect()),
            _ => None,
        });
        let bands: Vec<(Real, Real, Real)> = bands.unwrap();
        assert_eq!(bands.len(), 20, "all but the first of the target");
        assert!(bands.iter().all(|(_, low, high)| (*low, *high) == (18.355, 21.645)));
        assert!(coast_ahead(&view).unwrap().to_svg().contains("as it came"));
    }

    #[test]
    fn without_a_prediction_there_is_no_figure() {
        let example = example::run();
        assert!(coast_ahead(&RunView::of(&example, None)).is_none());
    }
}
