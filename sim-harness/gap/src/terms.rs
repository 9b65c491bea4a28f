//! Terms that may be missing in the model, as columns of a linear fit.
//!
//! A term with its shape fixed (a section, a time constant, ...) gives one column for each free coefficient: the extra resistance per unit of the
//! coefficient, averaged along the path of each interval.

use super::rows::{Believed, Row};
use super::runs::{Interval, Point};
use rundown::model::direction::Direction;
use rundown::model::line::Line;

/// A coordinate along which something unknown may act.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Coordinate {
    /// Location, m.
    Location,
    /// Speed, m/s.
    Speed,
    /// Time since departure, s.
    Time,
    /// Ambient temperature, °C.
    Temperature,
    /// Days since 1970-01-01.
    Day,
}

/// Where a step acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Below its value.
    Below,
    /// Above it.
    Above,
}

/// A term, its shape fixed.
#[derive(Clone, Debug, PartialEq)]
pub enum Term {
    /// Those of the Davis coefficients that are wrong: 1, v, v².
    Davis([bool; 3]),
    /// Speed read later than the effort: step of the effort over the interval's length; coefficient in s. A matter of sensors, not of the train.
    Delay,
    /// Location read late, beyond what was put right: the gradient of v seconds back less the one here, over 1 s. A matter of sensors, too.
    Late,
    /// v³: no named law, and hard to tell from wrong Davis coefficients.
    Cube,
    /// v² while in the section, m.
    Tunnel([f64; 2]),
    /// g/γ times the share of the train in the section, sign of the direction; coefficient m/m.
    Gradient([f64; 2]),
    /// Constant in the section, both directions alike.
    Bump([f64; 2]),
    /// Röckl's formula of the track's curves.
    Curve,
    /// 2 r2 v σ + r2 |w|: the wind at which it is linearised, m/s.
    Wind(f64),
    /// u - r2 v²: coefficient e/(1 + e).
    Mass,
    /// u: an effort that is shown too large by this share. A matter of the gauge, and no named law.
    Gauge,
    /// Temperature above the mean of the set, and a constant.
    Temperature,
    /// Share of the period passed.
    Season,
    /// exp(-t/τ), τ in s.
    WarmUp(f64),
    /// Gradient over another length, m, minus that over the believed one.
    Length(f64),
    /// u (v - from)/(140 km/h - from) while braking, from in m/s.
    BrakeFade(f64),
    /// After the first brake application, in these runs.
    DraggingBrake(Vec<usize>),
    /// Constant below a value of a coordinate, or above another; a straight line between the two.
    Step(Coordinate, [f64; 2], Side),
    /// Piecewise linear along a coordinate, with these knots.
    Smooth(Coordinate, Vec<f64>),
}

/// What the columns are made from.
#[derive(Clone, Copy, Debug)]
pub struct Context<'a> {
    /// The believed model.
    pub believed: Believed<'a>,
    /// Radii of the track: (from, to, Röckl's number), m, N/N.
    pub curves: &'a [(f64, f64, f64)],
    /// Mean temperature, °C.
    pub temperature_c: f64,
    /// Day of the first run, since 1970-01-01.
    pub first_day: f64,
    /// Days from the first run to the last.
    pub period_days: f64,
}

/// Half the distance over which the change of the gradient is taken, m.
const SLOPE_M: f64 = 15.0;

/// Share of the train within a section.
fn share(line: &Line<'_>, front_m: f64, [from_m, to_m]: [f64; 2]) -> f64 {
    let length_m = line.train.length_m();
    let tail_m = front_m - line.direction.sign() * length_m;
    let (low, high) = (front_m.min(tail_m), front_m.max(tail_m));
    (high.min(to_m) - low.max(from_m)).max(0.0) / length_m
}

impl Term {
    /// How many coefficients it has.
    pub fn count(&self) -> usize {
        match self {
            Self::Davis(wrong) => wrong.iter().filter(|w| **w).count(),
            Self::Temperature => 2,
            Self::Smooth(_, knots) => knots.len(),
            _ => 1,
        }
    }

    /// What it adds to the resistance in each row with these coefficients, N/kg.
    pub fn extra(&self, beta: &[f64], context: &Context<'_>, rows: &[Row]) -> Vec<f64> {
        let columns = self.columns(context, rows);
        let of_row = |i: usize| columns.iter().zip(beta).map(|(c, b)| c[i] * b).sum();
        (0..rows.len()).map(of_row).collect()
    }

    /// A table reaches this interval. Laws reach everywhere.
    pub fn covers(&self, interval: &Interval) -> bool {
        let Self::Smooth(which, knots) = self else {
            return true;
        };
        // Few rows lie beyond the last knots but one.
        let inner = knots.get(1).zip(knots.get(knots.len().saturating_sub(2)));
        let at = of_interval(*which, interval, interval.middle());
        at.zip(inner).is_some_and(|(at, (first, last))| (*first..=*last).contains(&at))
    }

    /// Its columns, one for each coefficient.
    pub fn columns(&self, context: &Context<'_>, rows: &[Row]) -> Vec<Vec<f64>> {
        let train = context.believed.train();
        let r2 = train.davis().r2;
        let gravity = train.gravity_n_per_kg();
        let along = |law: &dyn Fn(&Line<'_>, &Row, &Point) -> f64| -> Vec<f64> {
            rows.iter()
                .map(|row| {
                    let line = context.believed.line(row.direction);
                    row.interval.mean(|point| law(line, row, point))
                })
                .collect()
        };
        match self {
            Self::Davis(wrong) => {
                (0..3).filter(|k| wrong[*k as usize]).map(|k| along(&|_, _, p| p.speed_mps.powi(k))).collect()
            }
            Self::Delay => vec![along(&|_, row, _| row.interval.effort_step_n_per_kg / row.interval.dt_s)],
            Self::Late => vec![along(&|line, _, p| {
                let sign = line.direction.sign();
                let ahead = line.gradient_n_per_kg(p.location_m + sign * SLOPE_M);
                let behind = line.gradient_n_per_kg(p.location_m - sign * SLOPE_M);
                p.speed_mps * (ahead - behind) / (2.0 * SLOPE_M)
            })],
            Self::Cube => vec![along(&|_, _, p| p.speed_mps.powi(3))],
            Self::Tunnel(section) => {
                vec![along(&|line, _, p| p.speed_mps * p.speed_mps * share(line, p.location_m, *section))]
            }
            Self::Gradient(section) => {
                vec![along(&|line, _, p| gravity * line.direction.sign() * share(line, p.location_m, *section))]
            }
            Self::Bump(section) => {
                vec![along(&|line, _, p| share(line, p.location_m, *section))]
            }
            Self::Curve => vec![along(&|line, _, p| {
                gravity
                    * context
                        .curves
                        .iter()
                        .map(|&(from_m, to_m, roeckl)| roeckl * share(line, p.location_m, [from_m, to_m]))
                        .sum::<f64>()
            })],
            Self::Wind(wind_mps) => {
                vec![along(&|line, _, p| r2 * (2.0 * p.speed_mps * line.direction.sign() + wind_mps))]
            }
            Self::Mass => vec![along(&|_, row, p| row.effort_n_per_kg - r2 * p.speed_mps * p.speed_mps)],
            Self::Gauge => vec![along(&|_, row, _| row.effort_n_per_kg)],
            Self::Temperature => vec![
                along(&|_, row, _| row.interval.temperature_c.map_or(0.0, |t| t - context.temperature_c)),
                along(&|_, _, _| 1.0),
            ],
            Self::Season => vec![along(&|_, row, _| {
                row.interval.day.map_or(0.0, |day| (day - context.first_day) / context.period_days.max(1e-9))
            })],
            Self::WarmUp(tau_s) => {
                vec![along(&|_, _, p| (-p.since_departure_s / tau_s).exp())]
            }
            Self::Length(true_m) => vec![along(&|line, _, p| {
                gravity
                    * (line.track.mean_gradient(p.location_m, *true_m, line.direction)
                        - line.track.mean_gradient(p.location_m, line.train.length_m(), line.direction))
            })],
            Self::BrakeFade(from_mps) => vec![along(&|_, row, p| {
                let over = (p.speed_mps - from_mps) / (140.0 / 3.6 - from_mps);
                row.effort_n_per_kg.min(0.0) * over.max(0.0)
            })],
            Self::DraggingBrake(runs) => {
                vec![along(&|_, row, _| f64::from(row.interval.braked && runs.contains(&row.interval.run)))]
            }
            Self::Step(which, [below, above], side) => vec![along(&|_, row, p| {
                let Some(at) = coordinate(*which, row, p) else {
                    return 0.0;
                };
                let up = ((at - below) / (above - below)).clamp(0.0, 1.0);
                match side {
                    Side::Below => 1.0 - up,
                    Side::Above => up,
                }
            })],
            Self::Smooth(coordinate, knots) => smooth(*coordinate, knots, rows),
        }
    }
}

/// The coordinate's value at a point.
pub fn coordinate(which: Coordinate, row: &Row, point: &Point) -> Option<f64> {
    of_interval(which, &row.interval, point)
}

fn of_interval(which: Coordinate, interval: &Interval, point: &Point) -> Option<f64> {
    match which {
        Coordinate::Location => Some(point.location_m),
        Coordinate::Speed => Some(point.speed_mps),
        Coordinate::Time => Some(point.since_departure_s),
        Coordinate::Temperature => interval.temperature_c,
        Coordinate::Day => interval.day,
    }
}

/// Hat functions on knots, averaged along each interval.
fn smooth(which: Coordinate, knots: &[f64], rows: &[Row]) -> Vec<Vec<f64>> {
    let mut columns = vec![vec![0.0; rows.len()]; knots.len()];
    for (i, row) in rows.iter().enumerate() {
        let weight = 1.0 / row.interval.path.len() as f64;
        for point in &row.interval.path {
            let Some(at) = coordinate(which, row, point) else {
                continue;
            };
            let above = knots.partition_point(|k| *k <= at);
            if above == 0 {
                columns[0][i] += weight;
            } else if above == knots.len() {
                columns[above - 1][i] += weight;
            } else {
                let t = (at - knots[above - 1]) / (knots[above] - knots[above - 1]);
                columns[above - 1][i] += weight * (1.0 - t);
                columns[above][i] += weight * t;
            }
        }
    }
    columns
}

/// Whether both directions occur.
pub fn both_directions(rows: &[Row]) -> bool {
    rows.iter().any(|row| row.direction == Direction::Up) && rows.iter().any(|row| row.direction == Direction::Down)
}
