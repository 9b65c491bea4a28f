//! Fig. 8: the brake rates of all runs over their speeds, and of each ATB-EG step the statistic of section 3.3, the
//! mean rate of a run in it, with mean and standard deviation over the runs.
//!
//! A rate is that between two samples: where the train begins to brake or lets go between them it is too small.

use super::{Drawn, Eyes, Picture};
use crate::study::view::{ATB_NAMES, ATB_STEPS_KMH};
use crate::{study::moments::Moments, study::tallies::Tallies};
use plotters::style::RGBColor;
use rundown_files::column::{Column, filled};
use rundown_files::table::Cell;
use rundown_pages::chart::{Figure, Layer, Panel, Stroke};
use rundown_pages::colours;

const BLACK: RGBColor = RGBColor(0, 0, 0);
const END_KMH: f64 = 150.0;

/// A brake rate, of one interval or of many.
#[derive(Debug)]
pub struct BrakeRow {
    kind: &'static str,
    run: String,
    speed_kmh: f64,
    rate_mps2: Option<f64>,
    sd_mps2: Option<f64>,
    count: Option<u64>,
}

/// The columns of `fig8_brake_rates_*.csv`.
pub fn columns() -> Vec<Column<BrakeRow>> {
    let kind = "`step`: mean over the runs, `true_step`: the same in truth, `run`: mean of a run in a step, `sample`: \
        between two samples";
    let one = "it is one value";
    vec![
        Column::text("kind", kind, |row: &BrakeRow| row.kind),
        Column::text("run", "name of the run, or of the step", |row: &BrakeRow| row.run.clone()),
        Column::number("speed_kmh", "km/h", "speed; of a step its middle", |row: &BrakeRow| row.speed_kmh),
        Column::number("brake_rate_mps2", "m/s²", "brake rate, positive", |row: &BrakeRow| row.rate_mps2)
            .empty_when("nobody braked in the step"),
        Column::number("sd_mps2", "m/s²", "standard deviation over the runs", |row: &BrakeRow| row.sd_mps2)
            .empty_when(one),
        Column::count("count", "runs", |row: &BrakeRow| row.count.map_or(Cell::Missing, Cell::Count)).empty_when(one),
    ]
}

/// The picture. Means and deviations are those of all runs, dots those of the drawn ones; true means where `truth` has
/// runs.
pub fn brake(drawn: &[Drawn], eyes: Eyes, tallies: &Tallies, truth: &Tallies) -> Picture {
    let edges = [END_KMH, ATB_STEPS_KMH[0], ATB_STEPS_KMH[1], ATB_STEPS_KMH[2], ATB_STEPS_KMH[3], 0.0];
    let dots = drawn.iter().flat_map(|run| eyes.of(run).points.brake.iter().copied()).collect();
    let (mut means, mut bands, mut true_means) = (Vec::new(), Vec::new(), Vec::new());
    let mut rows = Vec::new();
    for (index, moments) in tallies.brake_steps.iter().enumerate().rev() {
        let (from, to) = (edges[index + 1], edges[index]);
        let of_step = |kind, moments: &Moments| BrakeRow {
            sd_mps2: moments.sd(),
            count: Some(moments.count),
            ..row(kind, ATB_NAMES[index], 0.5 * (from + to), moments.mean())
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
            rows.push(of_step("true_step", true_moments));
        }
        rows.push(of_step("step", moments));
    }
    for run in drawn {
        for (step, rate) in eyes.of(run).outcome.brake_steps_mps2.into_iter().enumerate() {
            let middle_kmh = 0.5 * (edges[step] + edges[step + 1]);
            rows.extend(rate.map(|rate| row("run", run.name(), middle_kmh, Some(rate))));
        }
        let samples = eyes.of(run).points.brake.iter();
        rows.extend(samples.map(|(kmh, rate)| row("sample", run.name(), *kmh, Some(*rate))));
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
        "Brake rates over their speeds, mean and standard deviation over the runs in each ATB-EG step",
        "speed, km/h",
        0.0..END_KMH,
        [Panel::new("brake rate, m/s\u{b2}", 620, layers, "no brake was seen")],
    );
    Picture {
        name: format!("fig8_brake_rates_{}", eyes.word()),
        caption: format!(
            "Brake rates between two readings over their mean speed, {} mode; in red the mean over the runs of each run's mean rate in the ATB-EG step, shaded their standard deviation.",
            eyes.word()
        ),
        drawing: figure.into(),
        numbers: filled(columns(), rows),
    }
}

/// Of one value.
fn row(kind: &'static str, run: &str, speed_kmh: f64, rate_mps2: Option<f64>) -> BrakeRow {
    BrakeRow { kind, run: run.to_owned(), speed_kmh, rate_mps2, sd_mps2: None, count: None }
}
