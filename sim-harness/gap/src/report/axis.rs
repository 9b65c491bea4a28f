//! Over what the law of each effect is drawn.

use super::Page;
use crate::explained::extra;
use crate::named::Named;
use crate::rows::Row;
use rundown::model::effects::{Coordinate, Effect};

/// A brake application that is strong enough to tell what share of it is lacking, N/kg.
const BRAKING_N_PER_KG: f64 = -0.05;

type Of<'a, T> = Box<dyn Fn(&Row) -> T + 'a>;

/// What a law is drawn over.
pub(super) struct Axis<'a> {
    /// Name with the unit.
    pub x_label: &'static str,
    /// Where a row lies; none: it is not drawn.
    pub x: Of<'a, Option<f64>>,
    /// Each direction has its own law.
    pub by_direction: bool,
    /// A run has one value of it, about.
    pub of_run: bool,
    /// Divisor of residual and law: 1, or the effort where a share of it is drawn.
    pub per: Option<fn(&Row) -> f64>,
}

/// None: the effect has no law over the residuals.
pub(super) fn axis<'a>(page: &'a Page<'_>, one: &'a Named) -> Option<Axis<'a>> {
    let speed = |row: &Row| Some(3.6 * row.interval.mean_speed_mps());
    let km = |row: &Row| row.interval.middle().location_m / 1000.0;
    let minutes = |row: &Row| Some(row.interval.middle().since_departure_s / 60.0);
    let temperature = |row: &Row| row.interval.temperature_c;
    let first_day = page.found.findings.first_day;
    let day = move |row: &Row| Some(row.interval.day? - first_day);
    let believed = &page.believed;
    let plain = |x_label, x: Of<'a, Option<f64>>| Axis { x_label, x, by_direction: false, of_run: false, per: None };
    let of_run = |x_label, x: Of<'a, Option<f64>>| Axis { of_run: true, ..plain(x_label, x) };
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
        Effect::SteadyWind(_) => Axis { by_direction: true, ..plain("speed, km/h", Box::new(speed)) },
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
        Effect::TemperatureResistance(_) => of_run("ambient temperature, \u{b0}C", Box::new(temperature)),
        Effect::SeasonalDrift(_) => of_run("days since the first run", Box::new(day)),
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
            Coordinate::Location => plain("location of the train's front, km", Box::new(move |row| Some(km(row)))),
            Coordinate::Speed => plain("speed, km/h", Box::new(speed)),
            Coordinate::Time => plain("time since departure, min", Box::new(minutes)),
            Coordinate::Temperature => of_run("ambient temperature, \u{b0}C", Box::new(temperature)),
            Coordinate::Day => of_run("days since the first run", Box::new(day)),
        },
        _ => return None,
    };
    Some(found)
}
