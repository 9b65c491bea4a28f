//! Fig. 9: tractive power of the first acceleration over speed, with each run's largest and the manufacturer's value; and its part below 40 km/h
//! apart, where the largest effort counts and section 4.4 leaves out what lies below 10 and above 30 km/h.

use super::{Drawn, Eyes, Picture, number, text};
use crate::study::view::{CROSS_KMH, PowerPoint};
use rundown::model::train::Train;
use rundown_pages::chart::{Figure, Layer, Panel, Stroke};
use rundown_pages::colours;

const END_KMH: f64 = 145.0;
/// Of the picture of low speeds: the limit near the departure.
const LOW_END_KMH: f64 = 40.0;
/// Where the largest effort is read (section 3.3), km/h.
const EFFORT_KMH: std::ops::Range<f64> = 10.0..30.0;

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
        let record = |kind, point: &PowerPoint, largest| {
            vec![
                text("kind", kind),
                text("run", run.name()),
                number("speed_kmh", point.speed_kmh),
                number("power_kw", point.power_kw),
                number("location_m", point.location_m),
                text("largest_50_90", largest),
            ]
        };
        let largest = largest(run);
        let truth = run.truth.iter().flat_map(|truth| &truth.points.power);
        records.extend(truth.map(|point| record("true", point, "")));
        let observed = eyes.of(run).points.power.iter();
        let word = |point: &PowerPoint| if largest == Some(*point) { "yes" } else { "no" };
        records.extend(observed.map(|point| record("observed", point, word(point))));
    }
    let true_points = drawn.iter().flat_map(|run| &run.truth);
    let true_points = true_points.flat_map(|truth| truth.points.power.iter().map(place));
    let true_points: Vec<(f64, f64)> = true_points.collect();
    let mut layers = Vec::new();
    if !true_points.is_empty() {
        layers.push(Layer::dots("true", colours::TRUTH, 0.25, true_points));
    }
    layers.extend([
        Layer::dots("observed", colours::MEASURED, 0.55, dots),
        Layer::level("manufacturer", colours::LIMIT, Stroke::Dashed, &(0.0..END_KMH), stated_kw),
        Layer::marks("largest of each run, 50 to 90 km/h", colours::ESTIMATED, crosses),
    ]);
    let figure = Figure::new(
        "Fig. 9: tractive power",
        "Tractive power of each interval of the first acceleration over its speed",
        "speed, km/h",
        0.0..END_KMH,
        [Panel::new("tractive power, kW", 620, layers, "no acceleration was seen")],
    );
    Picture {
        name: format!("fig9_power_{}", eyes.word()),
        caption: format!(
            "Tractive power at the wheel in the first acceleration of {} runs, {} mode.",
            drawn.len(),
            eyes.word()
        ),
        drawing: figure.into(),
        records,
    }
}

/// Below 40 km/h.
pub fn low_speeds(drawn: &[Drawn], eyes: Eyes, train: &Train) -> Picture {
    let kw_per_n_kg = train.rotating_mass_kg() / 1000.0;
    let limit = |kmh: f64| (kmh, kw_per_n_kg * train.max_effort_n_per_kg(kmh / 3.6) * kmh / 3.6);
    let of = |points: &[PowerPoint]| -> Vec<(f64, f64)> {
        let low = points.iter().filter(|point| point.speed_kmh <= LOW_END_KMH);
        low.map(|point| (point.speed_kmh, point.power_kw)).collect()
    };
    let seen: Vec<(f64, f64)> = drawn.iter().flat_map(|run| of(&eyes.of(run).points.power)).collect();
    let truths = drawn.iter().filter_map(|run| run.truth.as_ref());
    let truths: Vec<(f64, f64)> = truths.flat_map(|truth| of(&truth.points.power)).collect();
    let row = |kind: &'static str| {
        move |(speed_kmh, power_kw): &(f64, f64)| {
            vec![text("kind", kind), number("speed_kmh", *speed_kmh), number("power_kw", *power_kw)]
        }
    };
    let records = seen.iter().map(row("observed")).chain(truths.iter().map(row("true"))).collect();
    let mut layers = vec![Layer::spans("largest effort is read here", colours::LEARNING, 0.2, vec![EFFORT_KMH])];
    if !truths.is_empty() {
        layers.push(Layer::dots("true", colours::TRUTH, 0.35, truths));
    }
    let boundary = (0..=40).map(|kmh| Some(limit(f64::from(kmh)))).collect();
    layers.extend([
        Layer::dots("observed", colours::MEASURED, 0.7, seen),
        Layer::line("manufacturer", colours::LIMIT, Stroke::Dashed, boundary),
    ]);
    let figure = Figure::new(
        "Fig. 9 below 40 km/h",
        "Tractive power of each interval of the first acceleration over its speed, where the largest effort is the limit",
        "speed, km/h",
        0.0..LOW_END_KMH,
        [Panel::new("tractive power, kW", 420, layers, "no acceleration was seen")],
    );
    Picture {
        name: format!("fig9_below_40_{}", eyes.word()),
        caption: format!(
            "The same below 40 km/h, {} mode: at 10 s sampling a run has one or two values where the largest effort is read, and the driver tapers off towards the limit of 40 km/h.",
            eyes.word()
        ),
        drawing: figure.into(),
        records,
    }
}
