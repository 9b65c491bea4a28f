//! The law of each effect over the data: mean residuals over the variable that the law depends on, with the fitted law through them.

use super::Page;
use super::binned::{Bin, Value, binned, width};
use super::maps::{colour, word};
use super::words::plain;
use crate::gap::explained::{acts, extra};
use crate::gap::named::Named;
use crate::gap::rows::Row;
use crate::report::chart::{Axes, Figure, Layer, Panel, Stroke, range_of};
use crate::report::colours;
use rundown::effects::{Coordinate, Effect};
use rundown::track::Direction;

/// Standard errors to either side of a mean.
const TWO_SIDED: f64 = 1.96;
/// Points of a law.
const MOST_BINS: usize = 24;
/// A brake application that is strong enough to tell what share of it is lacking, N/kg.
const BRAKING_N_PER_KG: f64 = -0.05;

type Of<'a, T> = Box<dyn Fn(&Row) -> T + 'a>;

/// What a law is drawn over.
struct Axis<'a> {
    x_label: &'static str,
    /// None: the row is not drawn.
    x: Of<'a, Option<f64>>,
    /// Each direction has its own law.
    by_direction: bool,
    /// Divisor of residual and law: 1, or the effort where a share of it is drawn.
    per: Option<fn(&Row) -> f64>,
}

/// Picture and caption of each effect that has a law over the residuals.
pub(super) fn laws(page: &Page<'_>, explained: &[f64]) -> Vec<(String, String)> {
    let each = page.found.named.iter();
    each.filter_map(|one| match &one.effect {
        Effect::RunWind(_) => winds(one),
        _ => law(page, one, explained),
    })
    .collect()
}

fn axis<'a>(page: &'a Page<'_>, one: &'a Named) -> Option<Axis<'a>> {
    let speed = |row: &Row| Some(3.6 * row.interval.mean_speed_mps());
    let km = |row: &Row| row.interval.middle().location_m / 1000.0;
    let minutes = |row: &Row| Some(row.interval.middle().since_departure_s / 60.0);
    let temperature = |row: &Row| row.interval.temperature_c;
    let first_day = page.found.findings.first_day;
    let day = move |row: &Row| Some(row.interval.day? - first_day);
    let believed = &page.believed;
    let plain = |x_label, x: Of<'a, Option<f64>>| Axis {
        x_label,
        x,
        by_direction: false,
        per: None,
    };
    let found = match &one.effect {
        // Where the whole train is inside: there the law is one of the speed alone.
        Effect::TunnelDrag(e) => plain(
            "speed, km/h, with the whole train in the section",
            Box::new(move |row| {
                let v2 = row.interval.mean(|p| p.speed_mps * p.speed_mps);
                let inside = extra(believed, &one.effect, row) / (e.k * v2);
                speed(row).filter(|_| inside > 0.98)
            }),
        ),
        Effect::GradientError(e) => {
            let around = (0.5 * (e.to_m - e.from_m)).max(1000.0);
            let near = (e.from_m - around) / 1000.0..(e.to_m + around) / 1000.0;
            Axis {
                by_direction: true,
                ..plain(
                    "location of the train's front, km",
                    Box::new(move |row| Some(km(row)).filter(|at| near.contains(at))),
                )
            }
        }
        Effect::CurveResistance(e) => plain(
            "R\u{f6}ckl's resistance of the curves under the train, N/kg",
            Box::new(move |row| Some(extra(believed, &one.effect, row) / e.coefficient_roeckl)),
        ),
        Effect::SteadyWind(_) => Axis {
            by_direction: true,
            ..plain("speed, km/h", Box::new(speed))
        },
        Effect::MassError(_) => plain(
            "effort less believed air drag, N/kg",
            Box::new(move |row| {
                let r2 = believed.train().davis().r2;
                let drag = row.interval.mean(|p| r2 * p.speed_mps * p.speed_mps);
                Some(row.effort_n_per_kg - drag)
            }),
        ),
        Effect::DraggingBrake(_) => plain(
            "number of the run, after its first brake application",
            Box::new(|row| row.interval.braked.then_some(row.interval.run as f64 + 1.0)),
        ),
        Effect::TemperatureResistance(_) => {
            plain("ambient temperature, \u{b0}C", Box::new(temperature))
        }
        Effect::SeasonalDrift(_) => plain("days since the first run", Box::new(day)),
        Effect::BrakeFade(_) => Axis {
            per: Some(|row| row.effort_n_per_kg),
            ..plain(
                "speed, km/h, while braking",
                Box::new(move |row| speed(row).filter(|_| row.effort_n_per_kg < BRAKING_N_PER_KG)),
            )
        },
        Effect::TrainLengthError(_) => plain(
            "gradient under the length found less that under the believed one, N/kg",
            Box::new(move |row| Some(extra(believed, &one.effect, row))),
        ),
        Effect::WarmUp(_) => plain("time since departure, min", Box::new(minutes)),
        Effect::DavisError(_) => plain("speed, km/h", Box::new(speed)),
        Effect::Unknown(e) => match e.coordinate {
            Coordinate::Location => plain(
                "location of the train's front, km",
                Box::new(move |row| Some(km(row))),
            ),
            Coordinate::Speed => plain("speed, km/h", Box::new(speed)),
            Coordinate::Time => plain("time since departure, min", Box::new(minutes)),
            Coordinate::Temperature => plain("ambient temperature, \u{b0}C", Box::new(temperature)),
            Coordinate::Day => plain("days since the first run", Box::new(day)),
        },
        _ => return None,
    };
    Some(found)
}

/// A row with where it lies, what is left for this effect, and what its law says.
struct At {
    run: usize,
    x: f64,
    left: f64,
    law: f64,
    weight: f64,
}

fn law(page: &Page<'_>, one: &Named, explained: &[f64]) -> Option<(String, String)> {
    let axis = axis(page, one)?;
    let findings = &page.found.findings;
    let rows = findings.rows.iter().zip(explained);
    let rows = rows.zip(&findings.calibrated.spread);
    let of_row = |((row, explained), spread): ((&Row, &f64), &f64)| {
        if !acts(one, page.runs, row) && !matches!(one.effect, Effect::DraggingBrake(_)) {
            return None;
        }
        let law = if acts(one, page.runs, row) {
            extra(&page.believed, &one.effect, row)
        } else {
            0.0
        };
        let per = axis.per.map_or(1.0, |per| per(row));
        Some((
            row.direction,
            At {
                x: (axis.x)(row)?,
                // What the other effects explain is taken off.
                left: (row.residual_n_per_kg - explained + law) / per,
                law: law / per,
                // Outliers count as little as they do in the fit.
                weight: (per / spread).powi(2),
                run: row.interval.run,
            },
        ))
    };
    let rows: Vec<(Direction, At)> = rows.filter_map(of_row).collect();
    if rows.is_empty() {
        return None;
    }
    let x = range_of(rows.iter().map(|(_, at)| at.x));
    let width = match one.effect {
        Effect::DraggingBrake(_) => 1.0,
        _ => width(&x, MOST_BINS),
    };
    let mut layers = Vec::new();
    let groups: Vec<Option<Direction>> = if axis.by_direction {
        let travelled = |d: &Direction| rows.iter().any(|(direction, _)| direction == d);
        let all = [Direction::Up, Direction::Down].into_iter();
        all.filter(travelled).map(Some).collect()
    } else {
        vec![None]
    };
    for (i, group) in groups.into_iter().enumerate() {
        let mine = rows.iter().filter(|(d, _)| group.is_none_or(|g| g == *d));
        let mine: Vec<&At> = mine.map(|(_, at)| at).collect();
        layers.extend(layers_of(&mine, group, width, i == 0));
    }
    let y_label = match axis.per {
        Some(_) => "lacking share of the braking effort",
        None => "residual, N/kg",
    };
    let name = plain(one.effect.name());
    let figure = Figure {
        title: format!("The law of the {name} over the data"),
        description: format!("Mean {y_label}, over {}", axis.x_label),
        x_label: axis.x_label.to_owned(),
        x,
        panels: vec![Panel {
            label: y_label.to_owned(),
            height: 380,
            y: None,
            axes: Axes::Left,
            layers,
            empty: "no intervals".to_owned(),
        }],
    };
    let bars = match one.effect {
        Effect::DraggingBrake(_) => "one dot a run",
        _ => "bars: 95 % intervals of the means from the spread between runs",
    };
    Some((
        figure.to_svg(),
        format!(
            "The law of the {name} through the data: mean residuals less what the other effects explain ({bars}), and the law as fitted, on the very same intervals."
        ),
    ))
}

fn layers_of(rows: &[&At], group: Option<Direction>, width: f64, first: bool) -> Vec<Layer> {
    let bins = |of: &dyn Fn(&At) -> f64| -> Vec<Bin> {
        let value = |at: &&At| Value {
            run: at.run,
            at: at.x,
            value: of(at),
            weight: at.weight,
        };
        binned(&rows.iter().map(value).collect::<Vec<_>>(), width)
    };
    // The same rows make the same bins: each stands at the mean of its rows.
    let (places, data, law) = (bins(&|at| at.x), bins(&|at| at.left), bins(&|at| at.law));
    let bar = |(place, bin): (&Bin, &Bin)| {
        let half = TWO_SIDED * bin.se?;
        let end = |by: f64| Some((place.mean, bin.mean + by));
        Some(vec![end(-half), end(half)])
    };
    let point = |(place, bin): (&Bin, &Bin)| (place.mean, bin.mean);
    let dots = group.map_or(colours::MEASURED, colour);
    vec![
        Layer::Threads {
            legend: String::new(),
            colour: dots,
            opacity: 0.7,
            lines: places.iter().zip(&data).filter_map(bar).collect(),
        },
        Layer::Dots {
            legend: match group {
                Some(direction) => format!("measured, {} the line", word(direction)),
                None => "measured".to_owned(),
            },
            colour: dots,
            opacity: 1.0,
            points: places.iter().zip(&data).map(point).collect(),
        },
        Layer::Line {
            legend: if first { "law as fitted" } else { "" }.to_owned(),
            colour: colours::ESTIMATED,
            stroke: Stroke::Solid,
            points: places.iter().zip(&law).map(|p| Some(point(p))).collect(),
        },
    ]
}

/// Each run's own wind.
fn winds(one: &Named) -> Option<(String, String)> {
    let at = |i: usize| i as f64 + 1.0;
    let each = || one.per_run.iter().enumerate();
    if one.per_run.is_empty() {
        return None;
    }
    let bar = |(i, (_, wind, sd)): (usize, &(String, f64, f64))| {
        let end = |by: f64| Some((at(i), wind + by));
        vec![end(-TWO_SIDED * sd), end(TWO_SIDED * sd)]
    };
    let figure = Figure {
        title: "The wind of each run".to_owned(),
        description: "Wind against the direction up the line, run by run".to_owned(),
        x_label: "number of the run".to_owned(),
        x: 0.0..at(one.per_run.len()),
        panels: vec![Panel {
            label: "headwind up the line, m/s".to_owned(),
            height: 340,
            y: None,
            axes: Axes::Left,
            layers: vec![
                Layer::Threads {
                    legend: String::new(),
                    colour: colours::MEASURED,
                    opacity: 0.7,
                    lines: each().map(bar).collect(),
                },
                Layer::Dots {
                    legend: "wind of a run".to_owned(),
                    colour: colours::MEASURED,
                    opacity: 1.0,
                    points: each().map(|(i, (_, wind, _))| (at(i), *wind)).collect(),
                },
            ],
            empty: "no runs".to_owned(),
        }],
    };
    let caption = "The wind of each run from its own residuals, against travel up the line; bars: 95 % intervals.";
    Some((figure.to_svg(), caption.to_owned()))
}
