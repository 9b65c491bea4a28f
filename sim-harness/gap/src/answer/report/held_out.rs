//! Simulated against measured speed on hold-out runs.

use super::binned::{Bin, Value, binned, width};
use super::maps::sections;
use crate::answer::whole::Answer;
use crate::fit::HALF_95;
use crate::holdout::forward::Compared;
use plotters::style::RGBColor;
use rundown_pages::chart::{Axes, Figure, Grid, Layer, Panel, Stroke, range_of};
use rundown_pages::colours;
use rundown_pages::numbers::number;

const BEFORE: RGBColor = colours::HELD;
const AFTER: RGBColor = colours::TRUTH;

/// Pictures and captions; none where nothing was compared.
pub(super) fn held_out(answer: &Answer) -> Vec<(String, String)> {
    if answer.found.compared.is_empty() {
        return Vec::new();
    }
    let mut all = vec![errors(answer)];
    all.extend(one_run(answer));
    all
}

/// Root mean square errors over location and speed.
fn errors(answer: &Answer) -> (String, String) {
    let km = |c: &Compared| c.location_m / 1000.0;
    let kmh = |c: &Compared| 3.6 * c.measured_mps;
    let figure = |label: &str, at: &dyn Fn(&Compared) -> f64, backs: Vec<Layer>| {
        let compared = &answer.found.compared;
        let x = range_of(compared.iter().map(at));
        let width = width(&x, 30);
        let line = |legend: &str, colour, stroke, square: &dyn Fn(&Compared) -> f64| {
            let values = compared.iter().map(|c| Value { run: c.run, at: at(c), value: square(c), weight: 1.0 });
            let bins = binned(&values.collect::<Vec<_>>(), width);
            let point = |bin: &Bin| Some((bin.at, bin.mean.sqrt()));
            Layer::Line { legend: legend.to_owned(), colour, stroke, points: bins.iter().map(point).collect() }
        };
        let mut layers = backs;
        layers.extend([
            line("noise floor", colours::LIMIT, Stroke::Dotted, &|c| c.floor),
            line("before", BEFORE, Stroke::Solid, &|c| c.before_mps.powi(2)),
            line("after", AFTER, Stroke::Solid, &|c| c.after_mps.powi(2)),
        ]);
        let top = layers.iter().flat_map(Layer::heights).fold(0.0, f64::max);
        Figure {
            title: String::new(),
            description: String::new(),
            x_label: label.to_owned(),
            x,
            panels: vec![Panel {
                label: "error of speed, m/s".to_owned(),
                height: 340,
                y: Some(0.0..1.08 * top),
                axes: Axes::Left,
                layers,
                empty: "nothing was compared".to_owned(),
            }],
        }
    };
    let grid = Grid {
        title: "Error of the simulated speed before and after".to_owned(),
        description: "Root mean square over location and over speed, held-out runs".to_owned(),
        columns: 2,
        figures: vec![figure("location, km", &km, vec![sections(answer)]), figure("speed, km/h", &kmh, Vec::new())],
    };
    (
        grid.to_svg(),
        "Root mean square of simulated less measured speed on the held-out runs: with the believed model, with the effects, and what noise alone would leave.".to_owned(),
    )
}

/// The run whose error before is the middle one of all held-out runs: a typical one.
fn typical(compared: &[&Compared]) -> Option<usize> {
    let mut runs: Vec<usize> = compared.iter().map(|c| c.run).collect();
    runs.sort_unstable();
    runs.dedup();
    let error = |run: usize| {
        let of_run = || compared.iter().filter(|c| c.run == run);
        of_run().map(|c| c.before_mps.powi(2)).sum::<f64>() / of_run().count().max(1) as f64
    };
    let mut errors: Vec<(f64, usize)> = runs.iter().map(|run| (error(*run), *run)).collect();
    errors.sort_by(|a, b| a.0.total_cmp(&b.0));
    errors.get(errors.len() / 2).map(|(_, run)| *run)
}

fn one_run(answer: &Answer) -> Option<(String, String)> {
    let windows = answer.found.compared.iter().filter(|c| c.since_s > 0.0);
    let windows: Vec<&Compared> = windows.collect();
    let run = typical(&windows)?;
    let of_run: Vec<&Compared> = windows.into_iter().filter(|c| c.run == run).collect();
    // A window begins anew at the measured speed: its line must not be joined to the one before.
    let line = |legend: &str, colour, stroke, of: &dyn Fn(&Compared) -> f64| {
        let mut points = Vec::new();
        let mut last_s = 0.0;
        for c in &of_run {
            if c.since_s <= last_s {
                points.push(None);
            }
            last_s = c.since_s;
            points.push(Some((c.location_m / 1000.0, of(c))));
        }
        Layer::Line { legend: legend.to_owned(), colour, stroke, points }
    };
    let mut band = Vec::new();
    let mut last_s = 0.0;
    for c in &of_run {
        if c.since_s <= last_s {
            band.push(None);
        }
        last_s = c.since_s;
        let half = HALF_95 * c.floor.sqrt();
        band.push(Some((c.location_m / 1000.0, -half, half)));
    }
    let dots = |of: &dyn Fn(&Compared) -> f64| -> Vec<(f64, f64)> {
        of_run.iter().map(|c| (c.location_m / 1000.0, of(c))).collect()
    };
    let kmh = |mps: f64| 3.6 * mps;
    let panel = |label: &str, height, layers| Panel {
        label: label.to_owned(),
        height,
        y: None,
        axes: Axes::Left,
        layers,
        empty: "nothing was compared".to_owned(),
    };
    let index = answer.found.held_out.get(run)?;
    let name = answer.input.runs.get(*index).map_or("", |run| run.name.as_str());
    let figure = Figure {
        title: format!("Held-out run {name}"),
        description: "Measured and simulated speed over location, and their difference".to_owned(),
        x_label: "location, km".to_owned(),
        x: range_of(of_run.iter().map(|c| c.location_m / 1000.0)),
        panels: vec![
            panel(
                "speed, km/h",
                360,
                vec![
                    sections(answer),
                    line("simulated before", BEFORE, Stroke::Thin, &|c| kmh(c.measured_mps + c.before_mps)),
                    line("simulated after", AFTER, Stroke::Thin, &|c| kmh(c.measured_mps + c.after_mps)),
                    Layer::Dots {
                        legend: "measured".to_owned(),
                        colour: colours::MEASURED,
                        opacity: 0.7,
                        points: dots(&|c| kmh(c.measured_mps)),
                    },
                ],
            ),
            panel(
                "simulated \u{2212} measured, m/s",
                300,
                vec![
                    Layer::Band {
                        legend: "95 % of noise".to_owned(),
                        colour: colours::LIMIT,
                        opacity: 0.15,
                        points: band,
                    },
                    line("before", BEFORE, Stroke::Thin, &|c| c.before_mps),
                    line("after", AFTER, Stroke::Thin, &|c| c.after_mps),
                ],
            ),
        ],
    };
    let caption = format!(
        "Held-out run {name}, a typical one: half of the held-out runs had a larger error before. Windows of up to {} s begin at the measured speed and are driven by the recorded effort, or by none while coasting.",
        number(answer.holdout().window_s, 0)
    );
    Some((figure.to_svg(), caption))
}
