//! Section 3.1: the unscented transform is accurate "up to the third moment when the state statistics is symmetric".
//!
//! The filter's own prediction of x', where x is a normal variable and x' one of its powers, against the closed form of
//! that moment. A filter of straight lines would miss the second power already; this one must meet the third and miss
//! the fourth.

use super::{Claim, alone, claim};
use nalgebra::SVector;
use rundown::filter::elimination::FactorColumn;
use rundown::filter::gaussian::Gaussian;
use rundown::filter::ukf::{Pair, Process, Spread, Ukf};
use rundown::model::state::SIZE;

/// Of the normal variable: mean, and standard deviation.
const MEAN: f64 = 1.0;
const SD: f64 = 0.5;
/// Of a moment, relative: what rounding leaves of differences that the paper's spread divides by 3e-6.
const ROUNDING: f64 = 1e-6;

/// x' = x^exponent in the first component; the others are constants that do nothing.
struct Power(i32);

impl Process<SIZE, 1> for Power {
    fn drive(&self, x: &SVector<f64, SIZE>) -> f64 {
        x[0].powi(self.0)
    }

    fn slope(&self, x: &SVector<f64, SIZE>) -> SVector<f64, SIZE> {
        let mut slope = SVector::zeros();
        slope[0] = f64::from(self.0) * x[0].powi(self.0 - 1);
        slope
    }

    fn pair(&self, x: &SVector<f64, SIZE>, column: &FactorColumn<SIZE, 1>, c: f64) -> Pair {
        let step = (c * column.d).sqrt();
        let [plus, centre, minus] = [1.0, 0.0, -1.0].map(|side| (x[0] + side * step * column.l[0]).powi(self.0));
        let odd = 0.5 * (plus - minus) / step - self.slope(x)[0] * column.l[0];
        Pair { odd, even: 0.5 * (plus + minus - 2.0 * centre) / c }
    }

    fn carry(&self, _x: &SVector<f64, SIZE>, a: f64) -> SVector<f64, 1> {
        SVector::<f64, 1>::new(a)
    }
}

/// Raw moment of the normal variable.
fn moment(exponent: u32) -> f64 {
    let (mu, variance) = (MEAN, SD * SD);
    match exponent {
        0 => 1.0,
        1 => mu,
        // m(n) = μ m(n-1) + (n-1) σ² m(n-2)
        n => mu * moment(n - 1) + f64::from(n - 1) * variance * moment(n - 2),
    }
}

/// Relative error of the transform's mean of x^exponent with the paper's spread; none where the filter fails.
fn error(exponent: u32) -> Option<f64> {
    let mut belief = Gaussian::independent([MEAN; SIZE], [SD; SIZE]);
    let ukf = Ukf::<SIZE, 2> { spread: Spread::PAPER, gate: [None; 2], reuse_points: true };
    ukf.predict(&mut belief, &Power(exponent as i32)).ok()?;
    Some(belief.mean[0] / moment(exponent) - 1.0)
}

pub(super) fn third_moment() -> Claim {
    let errors: Option<Vec<f64>> = (1..=4).map(error).collect();
    let words = |errors: &[f64]| {
        let listed = errors.iter().zip(1..).map(|(error, power)| format!("x^{power}: {error:.1e}"));
        listed.collect::<Vec<_>>().join(", ")
    };
    let holds = |errors: &[f64]| errors.iter().zip(1..).all(|(error, power)| (error.abs() < ROUNDING) == (power <= 3));
    claim("3.1", "the unscented transform is accurate up to the third moment of a symmetric state")
        .columns(alone(errors.as_deref().map(words)))
        .holds(errors.as_deref().map(holds))
        .by(format!(
            "a theorem, and here whether the code keeps it: relative errors of the filter's mean of powers of a normal variable (mean {MEAN}, deviation {SD}) against the closed form; below {ROUNDING:e} up to the third power and not at the fourth"
        ))
        .input()
        .of_any_train()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_those_of_the_textbook() {
        assert_eq!([1, 2, 3, 4].map(moment), [1.0, 1.25, 1.75, 2.6875]);
    }

    #[test]
    fn the_fourth_moment_is_missed_by_what_the_points_leave_out() {
        // 3 σ⁴ of μ⁴ + 6 μ² σ² + 3 σ⁴, but for c of it.
        let expected = -3.0 * SD.powi(4) / moment(4);
        assert!((error(4).unwrap() - expected).abs() < 1e-5, "{:?}", error(4));
    }
}
