//! How r0, r1 and r2 move along a run of the paper's loop: what section 4.2 says of Fig. 3, as numbers. The readings
//! and the claims are judged by the same.

use rundown_files::statistics::correlation;

/// "At lower speeds": below, m/s.
pub const SLOW_MPS: f64 = 80.0 / 3.6;

/// By how much r0 falls from the beginning on, N/kg: how far it gets from its first value until the speed is low;
/// negative where it gets further above than below.
pub fn falls(davis: &[[f64; 3]], speed_mps: &[f64]) -> Option<f64> {
    let first = davis.first()?[0];
    let until = last_fast(speed_mps)? + 1;
    let beginning = || davis.iter().take(until).map(|davis| first - davis[0]);
    let (most, least) = (beginning().reduce(f64::max)?, beginning().reduce(f64::min)?);
    Some(if most >= -least { most } else { least })
}

/// By how much r0 rises at lower speeds, N/kg: from the last sample above [`SLOW_MPS`] to the end.
pub fn rises(davis: &[[f64; 3]], speed_mps: &[f64]) -> Option<f64> {
    Some(davis.last()?[0] - davis.get(last_fast(speed_mps)?)?[0])
}

/// Index of the last sample above [`SLOW_MPS`].
fn last_fast(speed_mps: &[f64]) -> Option<usize> {
    speed_mps.iter().rposition(|speed_mps| *speed_mps > SLOW_MPS)
}

/// Index of the sample of the largest speed.
pub fn fastest(speed_mps: &[f64]) -> usize {
    let speeds = speed_mps.iter().enumerate();
    speeds.max_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(index, _)| index)
}

/// Of r0, N/kg.
pub fn range(davis: &[[f64; 3]]) -> Option<f64> {
    let r0 = || davis.iter().map(|davis| davis[0]);
    Some(r0().reduce(f64::max)? - r0().reduce(f64::min)?)
}

/// The least correlation of any two of the three.
pub fn alike(davis: &[[f64; 3]]) -> Option<f64> {
    let of = |a: usize, b: usize| correlation(&davis.iter().map(|davis| (davis[a], davis[b])).collect::<Vec<_>>());
    Some(of(0, 1)?.min(of(0, 2)?).min(of(1, 2)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn davis(r0: &[f64]) -> Vec<[f64; 3]> {
        r0.iter().map(|r0| [*r0, 2.0 * r0, 3.0 * r0]).collect()
    }

    #[test]
    fn a_fall_goes_on_until_the_speed_is_low() {
        let speeds = [0.0, 39.0, 38.0, 30.0, 10.0];
        let of = |r0: [f64; 5]| falls(&davis(&r0), &speeds).unwrap();
        assert_eq!(of([5.0, 2.0, 4.0, 4.5, 0.0]), 3.0);
        assert_eq!(of([5.0, 4.0, 8.0, 5.0, 0.0]), -3.0, "it rises further");
    }

    #[test]
    fn a_rise_at_lower_speeds_can_be_a_fall() {
        let speeds = [0.0, 38.0, 23.0, 20.0, 10.0];
        assert_eq!(rises(&davis(&[5.0, 1.0, 3.0, 2.0, 4.0]), &speeds), Some(1.0));
        assert_eq!(rises(&davis(&[5.0, 1.0, 3.0, 4.0, 2.0]), &speeds), Some(-1.0));
        assert_eq!(rises(&davis(&[5.0, 1.0]), &[10.0, 20.0]), None, "never fast");
    }
}
