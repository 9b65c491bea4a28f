//! Fig. 9: tractive power of the first acceleration over speed, with each run's largest and the manufacturer's value.

use super::{Drawn, Eyes, Picture, number, text};
use crate::study::view::{CROSS_KMH, PowerPoint};
use rundown::model::train::Train;
use rundown_pages::chart::{Axes, Figure, Layer, Panel, Stroke};
use rundown_pages::colours;

/// Right end of the axis, km/h.
const END_KMH: f64 = 145.0;

pub fn power(drawn: &[Drawn], eyes: Eyes, train: &Train) -> Picture {
    let stated_kw = train.description().max_power_w / 1000.0;
    let place = |p: &PowerPoint| (p.speed_kmh, p.power_kw);
    let points = |run: &Drawn| eyes.of(run).points.power.clone();
    let dots = drawn.iter().flat_map(points).map(|p| place(&p)).collect();
    let largest = |run: &Drawn| {
        let points = eyes.of(run).points.power.iter();
        let within = points.filter(|p| CROSS_KMH.contains(&p.speed_kmh));
        within.max_by(|a, b| a.power_kw.total_cmp(&b.power_kw)).copied()
    };
    let crosses: Vec<(f64, f64)> = drawn.iter().filter_map(largest).map(|p| place(&p)).collect();
    let mut records = Vec::new();
    for run in drawn {
        let largest = largest(run);
        let truth = run.truth.iter().flat_map(|truth| &truth.points.power);
        records.extend(truth.map(|point| {
            vec![
                text("kind", "true"),
                text("run", run.name()),
                number("speed_kmh", point.speed_kmh),
                number("power_kw", point.power_kw),
                number("location_m", point.location_m),
                text("largest_50_90", ""),
            ]
        }));
        records.extend(eyes.of(run).points.power.iter().map(|point| {
            vec![
                text("kind", "observed"),
                text("run", run.name()),
                number("speed_kmh", point.speed_kmh),
                number("power_kw", point.power_kw),
                number("location_m", point.location_m),
                text("largest_50_90", if largest == Some(*point) { "yes" } else { "no" }),
            ]
        }));
    }
    let true_points = drawn.iter().flat_map(|run| &run.truth);
    let true_points = true_points.flat_map(|truth| truth.points.power.iter().map(place));
    let true_points: Vec<(f64, f64)> = true_points.collect();
    let mut layers = Vec::new();
    if !true_points.is_empty() {
        layers.push(Layer::Dots {
            legend: "true".to_owned(),
            colour: colours::TRUTH,
            opacity: 0.25,
            points: true_points,
        });
    }
    layers.extend([
        Layer::Dots { legend: "observed".to_owned(), colour: colours::MEASURED, opacity: 0.55, points: dots },
        Layer::Line {
            legend: "manufacturer".to_owned(),
            colour: colours::LIMIT,
            stroke: Stroke::Dashed,
            points: vec![Some((0.0, stated_kw)), Some((END_KMH, stated_kw))],
        },
        Layer::Marks {
            legend: "largest of each run, 50 to 90 km/h".to_owned(),
            colour: colours::ESTIMATED,
            points: crosses,
        },
    ]);
    let figure = Figure {
        title: "Fig. 9: tractive power".to_owned(),
        description: "Tractive power of each interval of the first acceleration over its speed".to_owned(),
        x_label: "speed, km/h".to_owned(),
        x: 0.0..END_KMH,
        panels: vec![Panel {
            label: "tractive power, kW".to_owned(),
            height: 620,
            y: None,
            axes: Axes::Left,
            layers,
            empty: "no acceleration was seen".to_owned(),
        }],
    };
    Picture {
        name: format!("fig9_power_{}", eyes.word()),
        caption: format!(
            "Tractive power at the wheel in the first acceleration of {} runs, {} mode.",
            drawn.len(),
            eyes.word()
        ),
        svg: figure.to_svg(),
        records,
    }
}
