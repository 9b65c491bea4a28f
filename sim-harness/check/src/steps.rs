//! The step of a reading: whole km/h, tenths, whole metres.

use rundown_files::sample::Sample;

/// Steps of a speed, km/h, the largest first; among them a metre per second, a knot, a mile per hour and a tenth of the first.
const SPEED_STEPS_KMH: [f64; 9] = [5.0, 3.6, 2.0, 1.852, 1.609_344, 1.0, 0.5, 0.36, 0.1];
/// Steps of a location, m.
const LOCATION_STEPS_M: [f64; 6] = [1000.0, 100.0, 50.0, 10.0, 5.0, 1.0];
/// Share of the readings that are multiples of the step; a few may have been put in by hand.
const MOST: f64 = 0.98;
/// Fewer different readings say nothing.
const LEAST: usize = 8;

fn step(mut values: Vec<f64>, steps: &[f64]) -> Option<f64> {
    let is_multiple = |step: f64| {
        let whole = values.iter().filter(|value| (*value / step - (*value / step).round()).abs() < 2e-3).count();
        whole as f64 >= MOST * values.len() as f64
    };
    let found = steps.iter().copied().find(|step| is_multiple(*step));
    values.sort_by(f64::total_cmp);
    values.dedup();
    found.filter(|_| values.len() >= LEAST)
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

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(step_kmh: f64, readings: u32) -> Vec<Sample> {
        let row = |i| Sample { speed_mps: Some(step_kmh * f64::from(i) / 3.6), ..Sample::default() };
        (1..=readings).map(row).collect()
    }

    #[test]
    fn the_largest_step_that_fits_is_found_and_few_readings_say_nothing() {
        for step_kmh in SPEED_STEPS_KMH {
            assert_eq!(of_speed_kmh(rows(step_kmh, 40).iter()), Some(step_kmh));
        }
        assert_eq!(of_speed_kmh(rows(0.0137, 40).iter()), None);
        assert_eq!(of_speed_kmh(rows(1.0, 5).iter()), None);
    }
}
