//! Fig. 9: tractive power of the first acceleration over speed, with the largest of each run and the manufacturer's
//! value; and its part below 40 km/h apart, where the largest effort counts and section 4.4 leaves out what lies below
//! 10 and above 30 km/h.

use super::{Drawn, Eyes, Picture};
use crate::study::view::{CROSS_KMH, PowerPoint, largest};
use rundown::model::train::Train;
use rundown_files::column::{Column, filled};
use rundown_pages::chart::{Figure, Layer, Panel, Stroke};
use rundown_pages::colours;

const END_KMH: f64 = 145.0;
/// Of the picture of low speeds: the limit near the departure.
const LOW_END_KMH: f64 = 40.0;
/// Where the largest effort is read (section 3.3), km/h.
const EFFORT_KMH: std::ops::Range<f64> = 10.0..30.0;

/// An interval of the first acceleration.
#[derive(Debug)]
pub struct PowerRow {
    kind: &'static str,
    run: String,
    point: PowerPoint,
}

fn points(kinds: &str) -> Vec<Column<PowerRow>> {
    vec![
        Column::text("kind", kinds, |row: &PowerRow| row.kind),
        Column::number("speed_kmh", "km/h", "speed", |row: &PowerRow| row.point.speed_kmh),
        Column::number("power_kw", "kW", "tractive power at the wheel", |row: &PowerRow| row.point.power_kw),
    ]
}

/// The columns of `fig9_power_*.csv`.
pub fn columns() -> Vec<Column<PowerRow>> {
    let kinds = "`observed`, `true`, or `largest_50_90`: the run's largest from 50 to 90 km/h";
    let mut columns = points(kinds);
    columns.insert(1, Column::text("run", "name of the run", |row: &PowerRow| row.run.clone()));
    columns.push(Column::number("location_m", "m", "location at its end", |row: &PowerRow| row.point.location_m));
    columns
}

/// The columns of `fig9_below_40_*.csv`.
pub fn low_columns() -> Vec<Column<PowerRow>> {
    points("`observed` or `true`")
}

pub fn power(drawn: &[Drawn], eyes: Eyes, train: &Train) -> Picture {
    let stated_kw = train.description().max_power_w / 1000.0;
    let place = |p: &PowerPoint| (p.speed_kmh, p.power_kw);
    let points = |run: &Drawn| eyes.of(run).points.power.clone();
    let dots = drawn.iter().flat_map(points).map(|p| place(&p)).collect();
    let largest = |run: &Drawn| largest(&eyes.of(run).points.power, &CROSS_KMH);
    let crosses: Vec<(f64, f64)> = drawn.iter().filter_map(largest).map(|p| place(&p)).collect();
    let mut rows = Vec::new();
    for run in drawn {
        let row = |kind, point: &PowerPoint| PowerRow { kind, run: run.name().to_owned(), point: *point };
        let truth = run.truth.iter().flat_map(|truth| &truth.points.power);
        rows.extend(truth.map(|point| row("true", point)));
        rows.extend(eyes.of(run).points.power.iter().map(|point| row("observed", point)));
        rows.extend(largest(run).iter().map(|point| row("largest_50_90", point)));
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
        numbers: filled(columns(), rows),
    }
}

/// Below 40 km/h.
pub fn low_speeds(drawn: &[Drawn], eyes: Eyes, train: &Train) -> Picture {
    let kw_per_n_kg = train.rotating_mass_kg() / 1000.0;
    let limit = |kmh: f64| (kmh, kw_per_n_kg * train.max_effort_n_per_kg(kmh / 3.6) * kmh / 3.6);
    let of = |run: &Drawn, kind: &'static str, points: &[PowerPoint]| -> Vec<PowerRow> {
        let low = points.iter().filter(|point| point.speed_kmh <= LOW_END_KMH);
        low.map(|point| PowerRow { kind, run: run.name().to_owned(), point: *point }).collect()
    };
    let seen: Vec<PowerRow> = drawn.iter().flat_map(|run| of(run, "observed", &eyes.of(run).points.power)).collect();
    let with_truth = drawn.iter().filter_map(|run| Some((run, run.truth.as_ref()?)));
    let truths: Vec<PowerRow> = with_truth.flat_map(|(run, truth)| of(run, "true", &truth.points.power)).collect();
    let dots = |rows: &[PowerRow]| rows.iter().map(|row| (row.point.speed_kmh, row.point.power_kw)).collect::<Vec<_>>();
    let mut layers = vec![Layer::spans("largest effort is read here", colours::LEARNING, 0.2, vec![EFFORT_KMH])];
    if !truths.is_empty() {
        layers.push(Layer::dots("true", colours::TRUTH, 0.35, dots(&truths)));
    }
    let boundary = (0..=40).map(|kmh| Some(limit(f64::from(kmh)))).collect();
    layers.extend([
        Layer::dots("observed", colours::MEASURED, 0.7, dots(&seen)),
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
        numbers: filled(low_columns(), seen.iter().chain(&truths)),
    }
}
