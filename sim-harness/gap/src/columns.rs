//! Columns of a linear fit: what a law adds to the resistance in each row, averaged along the path of its interval.

use crate::data::interval::{Interval, Point};
use crate::data::{believed::Context, rows::Row};
use rundown::model::{direction::Direction, effects::Coordinate, effects::share_inside, line::Line};
use rundown_files::statistics::sorted;

/// One column by a law of the line, the row and the point.
pub fn along(context: &Context<'_>, rows: &[Row], law: impl Fn(&Line<'_>, &Row, &Point) -> f64) -> Vec<f64> {
    let of_row = |row: &Row| {
        let line = context.believed.line(row.direction);
        row.interval.mean(|point| law(line, row, point))
    };
    rows.iter().map(of_row).collect()
}

/// Share of the train within a section.
pub fn share(line: &Line<'_>, front_m: f64, [from_m, to_m]: [f64; 2]) -> f64 {
    share_inside(from_m, to_m, front_m, line.train.length_m(), line.direction)
}

/// r2 (2 v σ + w): air drag by each m/s of a wind along the line, linearised at `wind_mps`, w.
pub fn wind(context: &Context<'_>, rows: &[Row], wind_mps: f64) -> Vec<f64> {
    let r2 = context.believed.train().davis().r2;
    along(context, rows, |line, _, p| r2 * (2.0 * p.speed_mps * line.direction.sign() + wind_mps))
}

/// u - r2 v²: what a heavier train lacks, per share of its mass.
pub fn mass(context: &Context<'_>, rows: &[Row]) -> Vec<f64> {
    let r2 = context.believed.train().davis().r2;
    along(context, rows, |_, row, p| row.effort_n_per_kg - r2 * p.speed_mps * p.speed_mps)
}

/// 1 after the first brake application of these runs.
pub fn braked(context: &Context<'_>, rows: &[Row], runs: &[usize]) -> Vec<f64> {
    along(context, rows, |_, row, _| f64::from(row.interval.braked && runs.contains(&row.interval.run)))
}

/// The value of a coordinate at a point of an interval.
pub fn coordinate(which: Coordinate, interval: &Interval, point: &Point) -> Option<f64> {
    match which {
        Coordinate::Location => Some(point.location_m),
        Coordinate::Speed => Some(point.speed_mps),
        Coordinate::Time => Some(point.since_departure_s),
        Coordinate::Temperature => interval.temperature_c,
        Coordinate::Day => interval.day,
    }
}

pub fn in_the_middle(which: Coordinate, row: &Row) -> Option<f64> {
    coordinate(which, &row.interval, row.interval.middle())
}

pub fn coordinate_name(which: Coordinate) -> &'static str {
    match which {
        Coordinate::Location => "location",
        Coordinate::Speed => "speed",
        Coordinate::Time => "time",
        Coordinate::Temperature => "temperature",
        Coordinate::Day => "day",
    }
}

/// Hat functions on knots, averaged along each interval.
pub fn hats(which: Coordinate, knots: &[f64], rows: &[Row]) -> Vec<Vec<f64>> {
    let mut columns = vec![vec![0.0; rows.len()]; knots.len()];
    for (i, row) in rows.iter().enumerate() {
        let weight = 1.0 / row.interval.path.len() as f64;
        for point in &row.interval.path {
            let Some(at) = coordinate(which, &row.interval, point) else {
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

/// Knots between the smallest and the largest value, equally filled.
pub fn knots(values: impl Iterator<Item = f64>, count: usize) -> Vec<f64> {
    let sorted = sorted(values);
    if sorted.is_empty() {
        return Vec::new();
    }
    let mut knots: Vec<f64> = (0..count).map(|i| sorted[i * (sorted.len() - 1) / (count - 1).max(1)]).collect();
    knots.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    knots
}

pub fn both_directions(rows: &[Row]) -> bool {
    rows.iter().any(|row| row.direction == Direction::Up) && rows.iter().any(|row| row.direction == Direction::Down)
}
