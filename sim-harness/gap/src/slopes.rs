//! How many times as steep as described is the line? Asked before anything is searched, of logs with an effort column.
//!
//! ```text
//! y = (k - 1) g(s) + a u + b0 + b1 v + b2 v²      k: 1 described rightly, 0.5 twice too steep, -1 with the sign turned, 0 of another line
//! ```
//!
//! By least squares in rows that no driver can forge. How surely k is known is what parts of the line say of it: a wrong gradient at one place is an effect,
//! and no wrong track.

use crate::data::believed::Context;
use crate::data::rows::Row;
use crate::fit::Base;
use crate::readings::offset::{is_strong, places};
use nalgebra::DVector;
use rundown_check::agreement::Figure;

/// Times the described slopes that the motion of the trains needs; none on a level line or from too few rows. `rows`: of an effort column as it was read.
pub fn factor(given: &Context<'_>, rows: &[Row]) -> Option<Figure> {
    let rows: Vec<&Row> = rows.iter().filter(|row| is_strong(row, &given.config.search)).collect();
    if rows.len() < given.config.search.few_rows {
        return None;
    }
    let column = |of: &dyn Fn(&Row) -> f64| DVector::from_iterator(rows.len(), rows.iter().map(|row| of(row)));
    let described = column(&|row| {
        let line = given.believed.line(row.direction);
        row.interval.mean(|p| line.gradient_n_per_kg(p.location_m))
    });
    let speed = |power: i32| column(&move |row| row.interval.mean_speed_mps().powi(power));
    let beside = [column(&|row| row.effort_n_per_kg), speed(0), speed(1), speed(2)];
    let base = Base::new(&column(&|row| row.residual_n_per_kg), &beside, &[])?;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::believed::tests::on_a_hilly_line;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};
    use rundown::model::direction::Direction;

    /// What 20 runs on a line of 30 km say, of which the slopes are so many times those described, with another gradient of 4 permille from km 10 to 12, or without.
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

    #[test]
    fn a_gradient_that_is_wrong_at_one_place_is_no_wrong_track() {
        let found = found(1.0, true, 5);
        assert!((found.value - 1.0).abs() < 0.4 && found.away_from(1.0) < 4.0, "{found:?}");
    }
}
