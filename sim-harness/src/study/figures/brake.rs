//! Fig. 8: brake rate over speed, with mean and standard deviation of each ATB-EG step.

use super::{Drawn, Eyes, Picture, number, text};
use crate::study::view::{ATB_NAMES, ATB_STEPS_KMH};
use crate::{study::moments::Moments, study::tallies::Tallies};
use plotters::style::RGBColor;
use rundown_files::table::Record;
use rundown_pages::chart::{Figure, Layer, Panel, Stroke};
use rundown_pages::colours;

const BLACK: RGBColor = RGBColor(0, 0, 0);
const END_KMH: f64 = 150.0;

/// The picture. Means and deviations are those of all runs, dots those of the drawn ones; true means where `truth` has runs.
pub fn brake(drawn: &[Drawn], eyes: Eyes, tallies: &Tallies, truth: &Tallies) -> Picture {
    let dots: Vec<(f64, f64)> = drawn.iter().flat_map(|run| eyes.of(run).points.brake.iter().copied()).collect();
    let edges = [END_KMH, ATB_STEPS_KMH[0], ATB_STEPS_KMH[1], ATB_STEPS_KMH[2], ATB_STEPS_KMH[3], 0.0];
    let (mut means, mut bands, mut true_means) = (Vec::new(), Vec::new(), Vec::new());
    let mut records = Vec::new();
    for (index, moments) in tallies.brake_steps.iter().enumerate().rev() {
        let (from, to) = (edges[index + 1], edges[index]);
        let of_step = |kind, moments: &Moments| {
            let values = [Some(0.5 * (from + to)), moments.mean(), moments.sd(), Some(moments.count as f64)];
            record(kind, ATB_NAMES[index], values)
        };
        let level = |mean| [Some((from, mean)), Some((to, mean)), None];
        if let Some(mean) = moments.mean() {
            let sd = moments.sd().unwrap_or(0.0);
            means.extend(level(mean));
            let edge = |kmh| Some((kmh, mean - sd, mean + sd));
            bands.extend([edge(from), edge(to), None]);
        }
        let true_moments = &truth.brake_steps[index];
        if let Some(mean) = true_moments.mean() {
            true_means.extend(level(mean));
            records.push(of_step("true_step", true_moments));
        }
        records.push(of_step("step", moments));
    }
    for run in drawn {
        let samples = eyes.of(run).points.brake.iter();
        records.extend(samples.map(|(kmh, rate)| record("sample", run.name(), [Some(*kmh), Some(*rate), None, None])));
    }
    let mut layers = vec![
        Layer::band("standard deviation", colours::ESTIMATED, 0.18, bands),
        Layer::dots("observed", colours::MEASURED, 0.5, dots),
        Layer::line("mean of the step", colours::ESTIMATED, Stroke::Solid, means),
    ];
    if !true_means.is_empty() {
        layers.push(Layer::line("true mean", colours::TRUTH, Stroke::Dashed, true_means));
    }
    layers.push(Layer::verticals("ATB-EG steps", BLACK, Stroke::Thin, ATB_STEPS_KMH.to_vec()));
    let figure = Figure::new(
        "Fig. 8: brake rates",
        "Brake rate of each interval over its speed, mean and standard deviation of each ATB-EG step",
        "speed, km/h",
        0.0..END_KMH,
        [Panel::new("brake rate, m/s\u{b2}", 620, layers, "no brake was seen")],
    );
    Picture {
        name: format!("fig8_brake_rates_{}", eyes.word()),
        caption: format!(
            "Brake rate of each interval between two samples over its speed, {} mode; in red the mean of each ATB-EG step, shaded its standard deviation.",
            eyes.word()
        ),
        svg: figure.to_svg(),
        records,
    }
}

fn record(kind: &str, run: &str, [kmh, rate, sd, count]: [Option<f64>; 4]) -> Record {
    let values =
        [number("speed_kmh", kmh), number("brake_rate_mps2", rate), number("sd_mps2", sd), number("count", count)];
    [text("kind", kind), text("run", run)].into_iter().chain(values).collect()
}
