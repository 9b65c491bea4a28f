//! Are the locations of all runs off along the line?
//!
//! In: intervals with their residuals, as the effort column gives them. Out: shown less true location, with its
//! standard deviation.
//!
//! The believed gradients are moved along the line until the residuals are likeliest, beside a model flexible enough
//! for any effect, with the prior of an offset. A gradient may begin elsewhere than described, so parts of the line
//! must agree: their scatter is in the standard deviation. Another length of the train moves the gradients against the
//! direction of travel; in one direction alone it looks the same.

use crate::candidate::{Family, Fitted, Offer, Shape, Term};
use crate::candidates::{self, sensors};
use crate::columns::{both_directions, in_the_middle};
use crate::config::{NuisanceConfig, SearchConfig};
use crate::data::believed::{Context, load_at};
use crate::data::interval::Point;
use crate::data::{rows::Row, runs::Run};
use crate::fit::Base;
use crate::noise::calibrate::{calibrate, flexible};
use crate::noise::dragging::RunScore;
use nalgebra::DVector;
use rundown::model::effects::{Coordinate, EffectKind};
use rundown_check::figure::Figure;

/// Shown less true location.
#[derive(Clone, Copy, Debug)]
pub struct Offset {
    /// Shown less true location along the line, m.
    pub offset_m: Figure,
    /// Spread of the offsets of single runs, m: half of them with another length of the train have one, too, and the
    /// others none.
    between_m: f64,
    /// Runs of both directions: another length moves the gradients in each its own way, and is no part of the offset.
    both_directions: bool,
    /// Log-likelihood over none, less that of the prior.
    pub gain: f64,
    /// What another length of the train brings instead.
    pub length_gain: f64,
    /// What that costs.
    length_penalty: f64,
}

impl Offset {
    /// It is beyond doubt, and no train of another length.
    pub fn matters(&self, config: &NuisanceConfig, enough: f64) -> Option<Figure> {
        let Figure { value, .. } = self.offset_m;
        let is_of_all = self.between_m < config.most_between * value.abs();
        let sure = is_of_all && value.abs() > config.least_offset_m && self.offset_m.away_from(0.0) > config.sure;
        let length_gain = self.length_gain - self.length_penalty;
        (sure && self.gain > enough && self.gain >= length_gain).then_some(self.offset_m)
    }

    /// With what was left when that had been put right.
    pub fn and(self, rest: Self) -> Self {
        let value = self.offset_m.value + rest.offset_m.value;
        Self { offset_m: Figure { value, ..rest.offset_m }, between_m: rest.between_m, ..self }
    }

    /// With a standard deviation that reaches to single runs where all go in one direction: of trains of two lengths it
    /// may be the offset of either.
    pub fn of_each(&self) -> Figure {
        let Figure { value, sd } = self.offset_m;
        Figure { value, sd: if self.both_directions { sd } else { sd.hypot(self.between_m) } }
    }

    /// Another length would do nearly as well, if it were as common.
    pub fn may_be_length(&self, near: f64) -> bool {
        self.gain - self.length_gain < near
    }
}

/// The residuals with the trains `offset_m` further back along the line than is shown.
fn moved(context: &Context<'_>, rows: &[Row], offset_m: f64) -> Vec<f64> {
    let of_row = |row: &Row| {
        let line = context.believed.line(row.direction);
        let here = row.interval.mean(|p| load_at(line, p));
        let there = row.interval.mean(|p| load_at(line, &Point { location_m: p.location_m - offset_m, ..*p }));
        row.residual_n_per_kg + here - there
    };
    rows.iter().map(of_row).collect()
}

/// No driver could have forged what this row shows: braking comes at the same places in each run, and a held speed
/// answers each change of the gradient some seconds late.
pub fn is_strong(row: &Row, config: &SearchConfig) -> bool {
    let held = row.interval.acceleration_mps2().abs() < config.held_mps2;
    let effort = row.effort_n_per_kg;
    effort >= config.braking_n_per_kg && !(held && effort > 0.0)
}

/// Finds it. `rows` of all that moves where the effort is measured, else of coasting.
pub fn offset(context: &Context<'_>, rows: &[Row], measured: bool) -> Option<Offset> {
    let config = &context.config.nuisance;
    if rows.len() < context.config.search.few_rows {
        return None;
    }
    let (calibrated, _) = calibrate(context, rows, measured, true, &[]);
    let whitening = calibrated.without_nuisances(context, rows);
    let mut beside = flexible(context, rows, &[]);
    beside.extend([sensors::DELAY, sensors::LATE_LOCATION].map(|of| of.columns(&Shape::Law, context, rows).remove(0)));
    let beside: Vec<DVector<f64>> = beside.iter().map(|column| whitening.whiten(column)).collect();
    let base = Base::new(&whitening.whiten(&moved(context, rows, 0.0)), &beside, whitening.runs())?;
    let strong: Vec<f64> = rows.iter().map(|row| f64::from(is_strong(row, &context.config.search))).collect();
    let strong = DVector::from_vec(strong);
    let left = |residual: &[f64]| base.beside(&whitening.whiten(residual)).component_mul(&strong);
    let loss = |offset_m: f64| {
        let prior = 0.5 * (offset_m / config.location_offset_sd_m).powi(2);
        0.5 * left(&moved(context, rows, offset_m)).norm_squared() + prior
    };
    let none = loss(0.0);
    let steps = (config.most_sd * config.location_offset_sd_m / config.offset_step_m.max(0.1)).round() as i32;
    let tried =
        (-steps..=steps).map(|i| f64::from(i) * config.offset_step_m).map(|offset_m| (offset_m, loss(offset_m)));
    let tried: Vec<(f64, f64)> = tried.collect();
    let (near_m, least) = tried.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1))?;
    // Between the points of the grid the residuals are straight in the offset.
    let step_m = 0.5 * config.offset_step_m;
    let [below, at, above] = [-step_m, 0.0, step_m].map(|by| left(&moved(context, rows, near_m + by)));
    let slope = (above - below) / (2.0 * step_m);
    let prior = config.location_offset_sd_m.powi(-2);
    let information = slope.norm_squared() + prior;
    let value = near_m - (slope.dot(&at) + near_m * prior) / information;
    let rest = &at + &slope * (value - near_m);
    let mut scores = vec![0.0; config.places.max(2)];
    let places = places(rows.iter(), scores.len());
    for (i, place) in places.iter().enumerate() {
        scores[*place] += slope[i] * rest[i];
    }
    let scatter = scores.iter().map(|score| score * score).sum::<f64>();
    let of_runs = RunScore::of_runs(rows, whitening.runs(), &slope, &rest);
    let sum = |of: fn(&RunScore) -> f64| of_runs.iter().map(of).sum::<f64>();
    // Scores vary by their information from the noise, and by its square times the spread between runs. (DerSimonian
    // and Laird 1986.)
    let excess = sum(|run| run.score.powi(2)) - sum(|run| run.information);
    let between = excess / sum(|run| run.information.powi(2)).max(f64::MIN_POSITIVE);
    // Where gradients come and go alike, there is more than one likely offset.
    let weighed = tried.iter().map(|(offset_m, loss)| ((least - loss).exp(), (offset_m - value).powi(2)));
    let (weight, square) = weighed.fold((0.0, 0.0), |(weight, square), (w, s)| (weight + w, square + w * s));
    let sd = (scatter.sqrt().max(information.sqrt()) / information).max((square / weight).sqrt());
    let (length_gain, length_penalty) = length_gain(&Offer { context, rows, measured }, &left, none)?;
    let between_m = between.max(0.0).sqrt();
    let both_directions = both_directions(rows);
    Some(Offset {
        offset_m: Figure { value, sd },
        between_m,
        both_directions,
        gain: none - loss(value),
        length_gain,
        length_penalty,
    })
}

/// Beside runs that are found to have another length the offset is that of the others, whose train is as described:
/// that of all runs has a part of the length in it. None where no runs have one.
pub fn of_the_others(context: &Context<'_>, rows: &[Row], terms: &[Fitted], measured: bool) -> Option<Offset> {
    let length = terms.iter().find(|fitted| fitted.term.is(EffectKind::TrainLengthError))?;
    let runs = Some(length.term.shape.runs()).filter(|runs| !runs.is_empty())?;
    let is_other = |row: &&Row| !runs.contains(&row.interval.run);
    let rows: Vec<Row> = rows.iter().filter(is_other).cloned().collect();
    Some(Offset { length_gain: 0.0, length_penalty: 0.0, ..offset(context, &rows, measured)? })
}

/// In which part of the line each row lies, the parts equally filled.
pub fn places<'a>(rows: impl Iterator<Item = &'a Row>, count: usize) -> Vec<usize> {
    let at: Vec<f64> = rows.map(|row| in_the_middle(Coordinate::Location, row).unwrap_or(0.0)).collect();
    let edges = crate::columns::knots(at.iter().copied(), count + 1);
    at.iter().map(|at| edges.partition_point(|edge| edge <= at).saturating_sub(1).min(count - 1)).collect()
}

/// What the best other length of the train brings, and its penalty.
fn length_gain(offer: &Offer<'_>, left: &impl Fn(&[f64]) -> DVector<f64>, none: f64) -> Option<(f64, f64)> {
    let (context, rows) = (offer.context, offer.rows);
    let of = |term: &Term| {
        let columns = term.columns(context, rows);
        let residual: Vec<f64> = rows.iter().zip(&columns[0]).map(|(row, c)| row.residual_n_per_kg - c).collect();
        (none - 0.5 * left(&residual).norm_squared(), term.penalty(context, rows))
    };
    let families = candidates::of(EffectKind::TrainLengthError).families(offer);
    let terms = families.iter().flat_map(|family| match family {
        Family::Whole(terms) => terms.as_slice(),
        _ => &[],
    });
    terms.map(of).max_by(|a, b| a.0.total_cmp(&b.0))
}

/// The runs with their locations put right.
pub fn put_right(runs: &[Run], offset_m: f64) -> Vec<Run> {
    let mut runs = runs.to_vec();
    for sample in runs.iter_mut().flat_map(|run| &mut run.samples) {
        sample.location_m = sample.location_m.map(|at| at - offset_m);
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::believed::tests::on_a_hilly_line;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};
    use rundown::model::direction::Direction;

    /// What is found of 40 runs on a line with 30 gradients, whose locations are shown `offset_m` too far on;
    /// `stretch_m`: how much longer the train is.
    fn found(offset_m: f64, stretch_m: f64, seed: u64) -> (Offset, bool) {
        found_of(&|_| (offset_m, stretch_m), &[Direction::Up, Direction::Down], seed)
    }

    /// The same with an offset and a stretch for each run, and these directions by turns.
    fn found_of(of_run: &dyn Fn(usize) -> (f64, f64), directions: &[Direction], seed: u64) -> (Offset, bool) {
        on_a_hilly_line(40, |context| {
            let found = offset(context, &rows_of(context, of_run, directions, (seed, 0.01)), true).unwrap();
            let told = found.matters(&context.config.nuisance, context.config.search.enough).is_some();
            (found, told)
        })
    }

    /// The rows of these runs. `random`: seed and standard deviation of the noise, N/kg.
    fn rows_of(
        context: &Context<'_>,
        of_run: &dyn Fn(usize) -> (f64, f64),
        directions: &[Direction],
        (seed, noise_n_per_kg): (u64, f64),
    ) -> Vec<Row> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let train = context.believed.train();
        let gravity = train.gravity_n_per_kg();
        let mut rows = Vec::new();
        for run in 0..40 {
            let direction = directions[run % directions.len()];
            let (offset_m, stretch_m) = of_run(run);
            let speed_mps = rng.random_range(20.0..40.0);
            let track = context.believed.line(direction).track;
            for i in 0..60 {
                let mut row = Row::coasting(direction, 0.0, speed_mps);
                let begin_m = 500.0 * f64::from(i);
                for (k, point) in row.interval.path.iter_mut().enumerate() {
                    point.location_m = begin_m + direction.sign() * speed_mps * k as f64;
                }
                // Nobody holds this speed.
                row.interval.speed_mps[1] += 0.5;
                row.interval.run = run;
                row.interval.begin_s = 20.0 * f64::from(i);
                row.effort_n_per_kg = rng.random_range(-0.1..0.2);
                row.interval.effort_n_per_kg = Some(row.effort_n_per_kg);
                let length_m = train.length_m() + stretch_m;
                let g = |p: &Point| gravity * track.mean_gradient(p.location_m - offset_m, length_m, direction);
                let here =
                    gravity * row.interval.mean(|p| track.mean_gradient(p.location_m, train.length_m(), direction));
                let noise: f64 = StandardNormal.sample(&mut rng);
                row.residual_n_per_kg = row.interval.mean(g) - here + noise_n_per_kg * noise;
                rows.push(row);
            }
        }
        rows
    }

    #[test]
    fn beside_runs_of_another_length_the_offset_is_that_of_the_others() {
        on_a_hilly_line(40, |context| {
            for seed in 40..43 {
                let rows = rows_of(
                    context,
                    &|run| (60.0, if run % 2 == 0 { 150.0 } else { 0.0 }),
                    &[Direction::Up],
                    (seed, 0.003),
                );
                let of = candidates::of(EffectKind::TrainLengthError);
                let length_m = context.believed.train().length_m() + 150.0;
                let term = Term { of, shape: Shape::NumberInRuns(length_m, (0..40).step_by(2).collect()) };
                let others = of_the_others(context, &rows, &[Fitted::certain(term, Vec::new())], true).unwrap();
                let error_m = |offset: &Offset| (offset.offset_m.value - 60.0).abs();
                assert!(error_m(&others) < 15.0, "{others:?}");
                // That of all has a part of the length in it, and says so.
                let all = offset(context, &rows, true).unwrap();
                assert!(error_m(&all) > 20.0 && error_m(&all) < 2.0 * all.of_each().sd, "{all:?}");
                assert!(of_the_others(context, &rows, &[], true).is_none());
            }
        });
    }

    #[test]
    fn locations_that_are_off_in_all_runs_are_reported_by_how_much() {
        for (seed, offset_m) in [(1, 60.0), (2, -45.0), (3, 90.0)] {
            let (found, told) = found(offset_m, 0.0, seed);
            let error_m = found.offset_m.value - offset_m;
            assert!(told && error_m.abs() < 4.0 * found.offset_m.sd && found.offset_m.sd < 8.0, "{found:?}");
        }
    }

    #[test]
    fn locations_that_are_right_are_left() {
        for seed in 10..14 {
            let (found, told) = found(0.0, 0.0, seed);
            assert!(!told, "{found:?}");
        }
    }

    #[test]
    fn a_longer_train_in_both_directions_is_no_offset() {
        for seed in 20..23 {
            let (found, told) = found(0.0, 80.0, seed);
            assert!(!told, "{found:?}");
        }
    }

    #[test]
    fn half_of_the_runs_with_a_longer_train_in_one_direction_are_no_offset_of_all() {
        for seed in 30..33 {
            let (found, told) = found_of(&|run| (0.0, if run % 2 == 0 { 100.0 } else { 0.0 }), &[Direction::Up], seed);
            assert!(!told, "{found:?}");
            let (found, told) = found_of(&|run| (60.0 + (run % 5) as f64 * 6.0, 0.0), &[Direction::Up], seed);
            assert!(told, "{found:?}");
        }
    }
}
