//! The rate of change in the middle of readings: the slope of a cubic by least squares.
//!
//! In: readings with their times from the middle. Out: the slope there, per s. A mean over as long is too small on a
//! peak and too large in a dip, which a cubic follows: on trams with a fix each second speeds over ± 4 s looked like a
//! wheel of 2 % and an offset of 0.8 km/h, the slope over ± 5 s leaves 0.1 % and 0.07 km/h, and less noise. Too few
//! readings, or all at one time: nothing.

use nalgebra::{Matrix4, Vector4};
use rundown_files::statistics::mean_of;

/// A cubic through fewer readings than these goes through their noise.
pub const LEAST: usize = 5;

/// A cubic at the time 0.
#[derive(Clone, Copy, Debug)]
pub struct CubicFit {
    pub per_s: f64,
    /// Mean square of what it leaves of the readings.
    pub left: f64,
}

/// Through (time, reading).
pub fn fit(readings: &[(f64, f64)]) -> Option<CubicFit> {
    let longest_s = readings.iter().map(|(time_s, _)| time_s.abs()).fold(0.0, f64::max);
    if readings.len() < LEAST || longest_s <= 0.0 {
        return None;
    }
    let (mut square, mut side) = (Matrix4::zeros(), Vector4::zeros());
    let powers = |time_s: f64| {
        let u = time_s / longest_s;
        Vector4::new(1.0, u, u * u, u * u * u)
    };
    for (time_s, reading) in readings {
        let powers = powers(*time_s);
        square += powers * powers.transpose();
        side += powers * *reading;
    }
    let cubic = square.cholesky()?.solve(&side);
    let left = readings.iter().map(|(time_s, reading)| (reading - cubic.dot(&powers(*time_s))).powi(2));
    Some(CubicFit { per_s: cubic[1] / longest_s, left: mean_of(left) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slope_of_a_cubic_is_found_whatever_the_steps() {
        let times = [-4.0, -2.9, -2.0, -1.1, 0.0, 0.9, 2.1, 3.0, 4.0];
        let readings = times.map(|t: f64| (t, 7.0 + 20.0 * t - 0.4 * t * t - 0.1 * t * t * t));
        let found = fit(&readings).unwrap();
        assert!((found.per_s - 20.0).abs() < 1e-9 && found.left < 1e-9);
        let leap = readings.map(|(t, reading)| (t, if t > 1.0 { reading + 300.0 } else { reading }));
        assert!(fit(&leap).unwrap().left > 1000.0);
        assert!(fit(&readings[..4]).is_none() && fit(&[(0.0, 1.0); 9]).is_none());
    }
}
