//! How many times as steep as described is the line? Asked before anything is searched, of logs with an effort column.
//!
//! ```text
//! y = (k - 1) g(s) + a u + b0 + b1 v + b2 v²      k: 1 described rightly, 0.5 twice too steep, -1 with the sign turned, 0 of another line
//! ```
//!
//! By least squares in rows that no driver can forge. How surely k is known is what parts of the line say of it: a
//! wrong gradient at one place is an effect, and no wrong track.

use crate::data::believed::Context;
use crate::data::rows::Row;
use crate::fit::Base;
use crate::readings::offset::{is_strong, places};
use nalgebra::DVector;
use rundown_check::figure::Figure;
use rundown_files::statistics::{MEDIAN_TO_SD, mean_of, median, squares_about};
use std::collections::BTreeMap;

/// Times the described slopes that the motion of the trains needs; none on a level line or from too few rows. `rows`:
/// of an effort column as it was read.
pub fn factor(given: &Context<'_>, rows: &[Row]) -> Option<Figure> {
    let rows: Vec<&Row> = rows.iter().filter(|row| is_strong(row, &given.config.search)).collect();
    if rows.len() < given.config.search.few_rows {
        return None;
    }
    let described = column(&rows, |row| {
        let line = given.believed.line(row.direction);
        row.interval.mean(|p| line.gradient_n_per_kg(p.location_m))
    });
    let base = by_motion(&rows)?;
    let described = base.beside(&described);
    let information = described.norm_squared();
    // A line that is all but level shows nothing.
    let slight = given.config.search.least_in_section_n_per_kg.powi(2) * rows.len() as f64;
    if information < slight {
        return None;
    }
    let beyond = described.dot(&base.residual) / information;
    let count = given.config.nuisance.places.max(2);
    let mut scores = vec![0.0; count];
    for (i, place) in places(rows.iter().copied(), count).into_iter().enumerate() {
        scores[place] += described[i] * (base.residual[i] - beyond * described[i]);
    }
    let parts = count as f64;
    let scatter = scores.iter().map(|score| score * score).sum::<f64>() * parts / (parts - 1.0);
    Some(Figure { value: 1.0 + beyond, sd: scatter.sqrt() / information })
}

fn column(rows: &[&Row], of: impl Fn(&Row) -> f64) -> DVector<f64> {
    DVector::from_iterator(rows.len(), rows.iter().map(|row| of(row)))
}

/// The residuals beside the efforts and three powers of the speed.
fn by_motion(rows: &[&Row]) -> Option<Base> {
    let speed = |power: i32| column(rows, |row| row.interval.mean_speed_mps().powi(power));
    let beside = [column(rows, |row| row.effort_n_per_kg), speed(0), speed(1), speed(2)];
    Base::new(&column(rows, |row| row.residual_n_per_kg), &beside, &[])
}

/// The slopes, permille, of a line that is described as level: standard deviation over places of 1 km, from the median
/// of their sizes, so that what acts at a few places is none. None where most places are within noise. `rows` as above.
pub fn of_level(given: &Context<'_>, rows: &[Row]) -> Option<f64> {
    let config = &given.config.track;
    let rows: Vec<&Row> = rows.iter().filter(|row| is_strong(row, &given.config.search)).collect();
    let base = by_motion(&rows)?;
    let mut places: BTreeMap<i64, Vec<f64>> = BTreeMap::new();
    for (row, residual) in rows.iter().zip(base.residual.iter()) {
        let km = row.interval.middle().location_m / 1000.0;
        places.entry(km.floor() as i64).or_default().push(row.direction.sign() * residual);
    }
    let of_place = |residuals: &Vec<f64>| {
        let count = residuals.len() as f64;
        let mean = mean_of(residuals);
        let variance = squares_about(mean, residuals) / (count - 1.0);
        (mean, (variance / count).sqrt())
    };
    let seen: Vec<(f64, f64)> = places.values().filter(|rows| rows.len() >= config.level_rows).map(of_place).collect();
    // A wind turns with the train as slopes do, and is the same everywhere.
    let wind = median(seen.iter().map(|(mean, _)| *mean))?;
    let (size, noise) =
        (median(seen.iter().map(|(mean, _)| (mean - wind).abs()))?, median(seen.iter().map(|(_, sd)| *sd))?);
    let permille = 1000.0 / given.believed.train().gravity_n_per_kg();
    let is_sure = seen.len() >= config.level_places && size > config.level_sure * noise;
    is_sure.then_some(MEDIAN_TO_SD * size * permille)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::believed::tests::{on_a_hilly_line, on_a_level_line};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};
    use rundown::model::direction::Direction;

    /// What 20 runs on a line of 30 km say, of which the slopes are so many times those described, with another
    /// gradient of 4 permille from km 10 to 12, or without.
    fn found(times: f64, wrong_at_one_place: bool, seed: u64) -> Figure {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        on_a_hilly_line(20, |context| {
            let mut rows = Vec::new();
            for i in 0..20 * 60 {
                let direction = [Direction::Up, Direction::Down][i % 2];
                let mut row = Row::coasting(direction, 500.0 * (i % 60) as f64, rng.random_range(15.0..40.0));
                // Nobody holds this speed.
                row.interval.speed_mps[1] += 0.5;
                row.interval.run = i / 60;
                row.effort_n_per_kg = rng.random_range(0.0..0.2);
                let described = context.believed.line(direction).gradient_n_per_kg(row.interval.middle().location_m);
                let here = wrong_at_one_place && (10_000.0..12_000.0).contains(&row.interval.middle().location_m);
                let noise: f64 = StandardNormal.sample(&mut rng);
                row.residual_n_per_kg =
                    (times - 1.0) * described + if here { direction.sign() * 0.04 } else { 0.0 } + 0.01 * noise;
                rows.push(row);
            }
            factor(context, &rows).unwrap()
        })
    }

    #[test]
    fn slopes_of_the_whole_line_are_found_with_their_sign() {
        for (seed, times) in [(1, 0.5), (2, -1.0), (3, 1.0), (4, 2.0)] {
            let found = found(times, false, seed);
            assert!((found.value - times).abs() < 0.1 && found.sd < 0.05, "{found:?} for {times}");
        }
    }

    /// The slopes that are found on a level line, of which these places are so steep.
    fn on_level(permille: impl Fn(f64) -> f64, seed: u64) -> Option<f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        on_a_level_line(20, |context| {
            let row = |i: usize| {
                let direction = [Direction::Up, Direction::Down][i % 2];
                let mut row = Row::coasting(direction, 500.0 * (i % 60) as f64, rng.random_range(15.0..40.0));
                row.interval.speed_mps[1] += 0.5;
                row.effort_n_per_kg = rng.random_range(0.0..0.2);
                let noise: f64 = StandardNormal.sample(&mut rng);
                let slope = permille(row.interval.middle().location_m / 1000.0) / 1000.0;
                let gravity = context.believed.train().gravity_n_per_kg();
                row.residual_n_per_kg = direction.sign() * gravity * slope + 0.01 * noise;
                row
            };
            of_level(context, &(0..20 * 60).map(row).collect::<Vec<Row>>())
        })
    }

    #[test]
    fn a_line_described_as_level_that_has_slopes_is_seen() {
        let slopes = on_level(|km| 6.0 * (km / 3.0).sin(), 6).unwrap();
        assert!((2.0..9.0).contains(&slopes), "{slopes}");
    }

    #[test]
    fn a_level_line_is_one_with_a_wrong_gradient_or_without() {
        for seed in 0..20 {
            let one_place = |km: f64| if (10.0..13.0).contains(&km) { 5.0 } else { 0.0 };
            assert!(on_level(one_place, seed).is_none_or(|slopes| slopes < 0.7));
            assert_eq!(on_level(|_| 0.0, seed), None);
        }
    }

    /// 2 r2 w v of a wind of 5 m/s: to each direction of travel a slope of its own.
    #[test]
    fn a_wind_on_a_level_line_is_no_slope() {
        for seed in 0..10 {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let slopes = on_a_level_line(20, |context| {
                let r2 = context.believed.train().davis().r2;
                let row = |i: usize| {
                    let direction = [Direction::Up, Direction::Down][i % 2];
                    let mut row = Row::coasting(direction, 500.0 * (i % 60) as f64, rng.random_range(15.0..40.0));
                    row.interval.speed_mps[1] += 0.5;
                    let noise: f64 = StandardNormal.sample(&mut rng);
                    row.residual_n_per_kg =
                        10.0 * direction.sign() * r2 * row.interval.mean_speed_mps() + 0.003 * noise;
                    row.effort_n_per_kg = rng.random_range(0.0..0.2);
                    row
                };
                of_level(context, &(0..20 * 60).map(row).collect::<Vec<Row>>())
            });
            assert!(slopes.is_none_or(|permille| permille < 0.2), "{slopes:?}");
        }
    }

    #[test]
    fn a_gradient_that_is_wrong_at_one_place_is_no_wrong_track() {
        let found = found(1.0, true, 5);
        assert!((found.value - 1.0).abs() < 0.4 && found.away_from(1.0) < 4.0, "{found:?}");
    }
}
