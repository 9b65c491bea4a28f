//! Fig. 8: the brake rate of each run in each ATB-EG step, the statistic of section 3.3, with mean and standard deviation over the runs.
//!
//! A rate between two samples would be too small where the train begins to brake or lets go between them; the intervals are in the table.

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
    let edges = [END_KMH, ATB_STEPS_KMH[0], ATB_STEPS_KMH[1], ATB_STEPS_KMH[2], ATB_STEPS_KMH[3], 0.0];
    // Runs side by side within a step, so that dots do not hide each other.
    let at_kmh = |step: usize, run: usize| {
        let part = (run as f64 + 1.0) / (drawn.len() as f64 + 1.0);
        edges[step + 1] + part * (edges[step] - edges[step + 1])
    };
    let of_run = |(number, run): (usize, &Drawn)| {
        let steps = eyes.of(run).outcome.brake_steps_mps2.into_iter().enumerate();
        let dots = steps.filter_map(|(step, rate)| Some((at_kmh(step, number), rate?)));
        dots.collect::<Vec<(f64, f64)>>()
    };
    let dots: Vec<(f64, f64)> = drawn.iter().enumerate().flat_map(of_run).collect();
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
        for (step, rate) in eyes.of(run).outcome.brake_steps_mps2.into_iter().enumerate() {
            let middle_kmh = 0.5 * (edges[step] + edges[step + 1]);
            records.extend(rate.map(|rate| record("run", run.name(), [Some(middle_kmh), Some(rate), None, None])));
        }
        let samples = eyes.of(run).points.brake.iter();
        records.extend(samples.map(|(kmh, rate)| record("sample", run.name(), [Some(*kmh), Some(*rate), None, None])));
    }
    let mut layers = vec![
        Layer::band("standard deviation", colours::ESTIMATED, 0.18, bands),
        Layer::dots("mean of a run in the step", colours::MEASURED, 0.5, dots),
        Layer::line("mean of the step", colours::ESTIMATED, Stroke::Solid, means),
    ];
    if !true_means.is_empty() {
        layers.push(Layer::line("true mean", colours::TRUTH, Stroke::Dashed, true_means));
    }
    layers.push(Layer::verticals("ATB-EG steps", BLACK, Stroke::Thin, ATB_STEPS_KMH.to_vec()));
    let figure = Figure::new(
        "Fig. 8: brake rates",
        "Mean brake rate of each run in each ATB-EG step, mean and standard deviation over the runs",
        "speed, km/h",
        0.0..END_KMH,
        [Panel::new("brake rate, m/s\u{b2}", 620, layers, "no brake was seen")],
    );
    Picture {
        name: format!("fig8_brake_rates_{}", eyes.word()),
        caption: format!(
            "Mean brake rate of each run in each ATB-EG step, {} mode, runs side by side; in red the mean over the runs, shaded their standard deviation.",
            eyes.word()
        ),
        drawing: figure.into(),
        records,
    }
}

fn record(kind: &str, run: &str, [kmh, rate, sd, count]: [Option<f64>; 4]) -> Record {
    let values =
        [number("speed_kmh", kmh), number("brake_rate_mps2", rate), number("sd_mps2", sd), number("count", count)];
    [text("kind", kind), text("run", run)].into_iter().chain(values).collect()
}
