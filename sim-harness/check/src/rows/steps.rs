//! The step of a reading: whole km/h, tenths, whole metres; of an effort any, for kN and per cent become N/kg by the
//! mass.

use rundown_files::sample::Sample;
use rundown_files::statistics::sorted;

/// Steps of a speed, km/h, the largest first; among them a metre per second, a knot, a mile per hour, their halves and
/// a tenth of the first.
pub(crate) const SPEED_STEPS_KMH: [f64; 12] =
    [5.0, 3.6, 2.0, 1.852, 1.8, 1.609_344, 1.0, 0.926, 0.804_672, 0.5, 0.36, 0.1];
const LOCATION_STEPS_M: [f64; 6] = [1000.0, 100.0, 50.0, 10.0, 5.0, 1.0];
/// Share of the readings that are multiples of the step; a few may have been put in by hand.
const MOST: f64 = 0.98;
/// Fewer different readings say nothing.
const LEAST: usize = 8;
/// A step may be such a multiple of one of the list; by chance all readings are once in 2¹² for the double.
const MULTIPLES: std::ops::RangeInclusive<u8> = 2..=12;
const LEAST_OF_MULTIPLE: usize = 12;

fn step(values: Vec<f64>, steps: &[f64]) -> Option<f64> {
    let found = steps.iter().copied().find(|step| are_multiples(&values, *step))?;
    let times = MULTIPLES.rev().map(f64::from).find(|times| are_multiples(&values, times * found)).unwrap_or(1.0);
    let mut levels = sorted(&values);
    levels.dedup();
    match levels.len() {
        0..LEAST => None,
        LEAST..LEAST_OF_MULTIPLE => Some(found),
        _ => Some(times * found),
    }
}

/// Whether these values are multiples of a step.
pub(crate) fn are_multiples(values: &[f64], step: f64) -> bool {
    let whole = values.iter().filter(|value| (*value / step - (*value / step).round()).abs() < 2e-3).count();
    whole as f64 >= MOST * values.len() as f64
}

/// The step of the speeds, km/h.
pub fn of_speed_kmh<'a>(rows: impl Iterator<Item = &'a Sample>) -> Option<f64> {
    let moving = rows.filter_map(|row| row.speed_mps).filter(|mps| *mps > 0.0);
    step(moving.map(|mps| 3.6 * mps).collect(), &SPEED_STEPS_KMH)
}

/// The step of the locations, m.
pub fn of_location_m<'a>(rows: impl Iterator<Item = &'a Sample>) -> Option<f64> {
    step(rows.filter_map(|row| row.location_m).collect(), &LOCATION_STEPS_M)
}

/// Efforts nearer to each other are one, N/kg: tables are printed with so many digits.
const PRINTED_N_PER_KG: f64 = 1e-4;
/// The same of ways between two locations in whole millimetres, m.
const PRINTED_M: f64 = 3e-3;
/// So many ways of one length are no chance.
const USUAL_WAYS: usize = 3;
/// Share of a step by which an effort may miss a multiple of it.
const MISSED: f64 = 0.05;
/// An effort with fewer levels may be that of a controller with notches.
const LEAST_LEVELS: usize = 10;

/// The step of the efforts, N/kg; none where it is below ten times the digits of a table.
pub fn of_effort_n_per_kg<'a>(rows: impl Iterator<Item = &'a Sample>) -> Option<f64> {
    any_step(rows.filter_map(|row| row.effort_n_per_kg).filter(|effort| *effort != 0.0), PRINTED_N_PER_KG)
}

/// The step of an odometer whose ways were scaled, m, by the ways from row to row; none where it is below ten times the
/// digits of a table.
pub fn of_scaled_location_m(rows: &[Sample]) -> Option<f64> {
    let way_m = |two: &[Sample]| Some((two[1].location_m? - two[0].location_m?).abs());
    let ways_m = sorted(rows.windows(2).filter_map(way_m).filter(|way_m| *way_m > PRINTED_M));
    // Where the odometer began again a way is any.
    let are_usual = |same: &&[f64]| same.len() >= USUAL_WAYS;
    let usual_m = ways_m.chunk_by(|a, b| b - a < PRINTED_M).filter(are_usual).flatten().copied();
    any_step(usual_m, PRINTED_M)
}

/// The step that these values are multiples of, whatever it is. `printed`: nearer ones are one.
fn any_step(values: impl Iterator<Item = f64>, printed: f64) -> Option<f64> {
    let values = sorted(values);
    let mut levels = values.clone();
    levels.dedup_by(|next, kept| *next - *kept < printed);
    let gaps = levels.windows(2).map(|pair| pair[1] - pair[0]);
    // The smallest gap is a step, but for its digits; the multiples of the far levels say it better, one by one from
    // zero on.
    let mut step = gaps.min_by(f64::total_cmp).filter(|_| levels.len() >= LEAST_LEVELS)?;
    levels.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    let [mut with, mut square] = [0.0; 2];
    for level in levels {
        let times = (level / step).round();
        with += times * level;
        square += times * times;
        step = if square > 0.0 { with / square } else { step };
    }
    let off = |value: f64| (value / step - (value / step).round()).abs();
    let fit = values.iter().filter(|value| off(**value) < MISSED).count();
    (step > 10.0 * printed && fit as f64 >= MOST * values.len() as f64).then_some(step)
}

/// Standard deviation of what rounding to a step takes from one reading.
pub fn rounding(step: f64) -> f64 {
    step / 12.0_f64.sqrt()
}

/// Standard deviation of what rounding takes from one speed, m/s.
pub fn rounding_mps(step_kmh: f64) -> f64 {
    rounding(step_kmh / 3.6)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(step_kmh: f64, readings: u32) -> Vec<Sample> {
        let row = |i| Sample { speed_mps: Some(step_kmh * f64::from(i) / 3.6), ..Sample::default() };
        (1..=readings).map(row).collect()
    }

    #[test]
    fn the_step_of_an_effort_is_found_whatever_it_is_and_notches_have_none() {
        let sample = |effort: f64| Sample { effort_n_per_kg: Some(effort), ..Sample::default() };
        let efforts = |step: f64, printed: f64| {
            let of = move |i: u32| 1.1 * (f64::from(i) * 0.618).sin();
            let stepped = move |effort: f64| if step > 0.0 { (effort / step).round() * step } else { effort };
            let rows: Vec<Sample> = (0..400).map(|i| sample((stepped(of(i)) / printed).round() * printed)).collect();
            of_effort_n_per_kg(rows.iter())
        };
        for step in [0.004_937, 0.012_5, 0.051_3] {
            for printed in [1e-9, 1e-4] {
                let found = efforts(step, printed).unwrap_or_default();
                assert!((found / step - 1.0).abs() < 0.01, "{step} {printed}: {found}");
            }
        }
        assert_eq!([efforts(0.0, 1e-9), efforts(0.0, 1e-4), efforts(5e-4, 1e-4)], [None; 3]);
        let notches: Vec<Sample> = (0..400).map(|i| sample(0.08 * f64::from(i % 7))).collect();
        assert_eq!(of_effort_n_per_kg(notches.iter()), None);
    }

    #[test]
    fn the_step_of_a_scaled_odometer_is_found_and_a_receiver_has_none() {
        let rows = |count: u32, written: &dyn Fn(f64) -> f64| -> Vec<Sample> {
            let at_m = |i: u32| f64::from(i).powi(2) * 0.05;
            (0..count).map(|i| Sample { location_m: Some(written(at_m(i))), ..Sample::default() }).collect()
        };
        // Four hops; at each the odometer begins again elsewhere.
        let hop = |more_m: f64| rows(100, &|at_m| (987.2 * at_m.round()).round() / 1000.0 + 500.0 + more_m);
        let found = of_scaled_location_m(&[0.0, 0.4, 0.7, 0.9].map(hop).concat()).unwrap();
        assert!((found - 0.9872).abs() < 1e-4, "{found}");
        assert_eq!(of_scaled_location_m(&rows(300, &|at_m| (1000.0 * at_m).round() / 1000.0)), None);
    }

    #[test]
    fn the_largest_step_that_fits_is_found_and_few_readings_say_nothing() {
        // A quarter of a metre per second, and three km/h, are multiples of one of the list.
        for step_kmh in SPEED_STEPS_KMH.into_iter().chain([0.9, 3.0]) {
            let found = of_speed_kmh(rows(step_kmh, 40).iter()).unwrap_or_default();
            assert!((found / step_kmh - 1.0).abs() < 1e-9, "{step_kmh}: {found}");
        }
        assert_eq!(of_speed_kmh(rows(0.0137, 40).iter()), None);
        assert_eq!(of_speed_kmh(rows(1.0, 5).iter()), None);
    }
}
