//! Running sums: mean and standard deviation of weighted values, and a straight line through points.
//!
//! In: one value at a time. Out: [`Statistic`], [`EffortLine`]. No value is kept.

use super::{EffortLine, Statistic};
use crate::Real;
use crate::extremes::Extremes;
use crate::model::pieces::whole;
use crate::plain::plain;

/// Mean and standard deviation of values that lasted for different times (Welford's recurrence with weights).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct WeightedMoments {
    count: u32,
    weight: Real,
    mean: Real,
    squares: Real,
}

plain! {
    struct WeightedMoments { count, weight, mean, squares }
}

impl WeightedMoments {
    /// No value.
    pub(super) const ZEROED: Self = Self { count: 0, weight: 0.0, mean: 0.0, squares: 0.0 };

    /// Adds a value; a weight that is not above 0 adds nothing.
    pub(super) fn add(&mut self, value: Real, weight: Real) {
        if weight > 0.0 {
            self.count = self.count.saturating_add(1);
            self.weight += weight;
            let change = value - self.mean;
            self.mean += change * weight / self.weight;
            self.squares += weight * change * (value - self.mean);
        }
    }

    /// Mean of the values.
    pub(super) fn mean(&self) -> Real {
        self.mean
    }

    /// Standard deviation of the values, with so many times their variance.
    #[inline(never)]
    pub(super) fn sd(&self, times: Real) -> Real {
        crate::roots::square_root((self.squares / self.weight * times).at_least(0.0))
    }

    /// Standard deviation with n - 1 in the denominator.
    pub(super) fn statistic(&self) -> Statistic {
        let n = Real::from(self.count);
        let sd = if self.count < 2 { 0.0 } else { self.sd(n / (n - 1.0)) };
        Statistic { count: self.count, mean: self.mean, sd }
    }
}

/// Least squares of y = a + b x.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct LineFit {
    count: Real,
    x: Real,
    y: Real,
    xx: Real,
    xy: Real,
    yy: Real,
}

plain! {
    struct LineFit { count, x, y, xx, xy, yy }
}

impl LineFit {
    /// No point.
    pub(super) const ZEROED: Self = Self { count: 0.0, x: 0.0, y: 0.0, xx: 0.0, xy: 0.0, yy: 0.0 };

    /// Adds a point.
    pub(super) fn add(&mut self, x: Real, y: Real) {
        self.count += 1.0;
        self.x += x;
        self.y += y;
        self.xx += x * x;
        self.xy += x * y;
        self.yy += y * y;
    }

    /// And those of `all` that are not `before`, at one x: their values were taken as x there, and each is `less` here.
    pub(super) fn and_level(&self, x: Real, [all, before]: [&Self; 2], less: Real) -> Self {
        let count = all.count - before.count;
        let sum = all.x - before.x;
        let y = sum - count * less;
        Self {
            count: all.count,
            x: self.x + count * x,
            y: self.y + y,
            xx: self.xx + count * x * x,
            xy: self.xy + x * y,
            yy: self.yy + all.xx - before.xx - less * (sum + y),
        }
    }

    /// Least squares. A `prior` slope of 0 counts as much as points whose squares of x about their mean add up to it.
    /// Points at one x give the mean and no slope.
    pub(super) fn least_squares(&self, prior: Real) -> FittedLine {
        let n = self.count;
        let xx = self.xx + prior;
        let mean = self.y / n;
        let determinant = n * xx - self.x * self.x;
        // One x only: what is left of the difference is rounding.
        let sloped = determinant > 1e-9 * n * xx;
        let slope = if sloped { (n * self.xy - self.x * self.y) / determinant } else { 0.0 };
        let at_0 = mean - slope * self.x / n;
        FittedLine { at_0, slope, rest: self.yy - at_0 * self.y - slope * self.xy, sloped }
    }

    /// None without points. The standard deviation is that about the line, 0 where nothing is left for it.
    pub(super) fn line(&self) -> Option<EffortLine> {
        let n = self.count;
        if n == 0.0 {
            return None;
        }
        let line = self.least_squares(0.0);
        let free = n - if line.sloped { 2.0 } else { 1.0 };
        let sd = if free > 0.0 { crate::roots::square_root(line.rest.at_least(0.0) / free) } else { 0.0 };
        let effort = Statistic { count: whole(n), mean: self.y / n, sd };
        Some(EffortLine { effort, at_lower_n_per_kg: line.at_0, slope: line.slope })
    }
}

/// y = `at_0` + `slope` x, and the sum of squares that it leaves.
pub(super) struct FittedLine {
    pub(super) at_0: Real,
    pub(super) slope: Real,
    pub(super) rest: Real,
    sloped: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_repeated_values() {
        let (mut weighted, mut repeated) = (WeightedMoments::default(), WeightedMoments::default());
        weighted.add(1.0, 2.0);
        weighted.add(4.0, 1.0);
        for value in [1.0, 1.0, 4.0] {
            repeated.add(value, 1.0);
        }
        assert_eq!(weighted.statistic().mean, 2.0);
        assert_eq!(repeated.statistic(), Statistic { count: 3, mean: 2.0, sd: libm::sqrt(3.0) });
        weighted.add(Real::NAN, 0.0);
        assert_eq!(weighted.statistic().count, 2);
    }

    #[test]
    fn line_through_three_points() {
        let mut fit = LineFit::default();
        assert_eq!(fit.line(), None);
        fit.add(2.0, 5.0);
        let one = fit.line().unwrap();
        assert_eq!((one.at_lower_n_per_kg, one.slope, one.effort.sd), (5.0, 0.0, 0.0));
        fit.add(0.0, 1.0);
        fit.add(4.0, 9.0);
        let line = fit.line().unwrap();
        assert!((line.at_lower_n_per_kg - 1.0).abs() < 1e-12);
        assert!((line.slope - 2.0).abs() < 1e-12);
        assert!(line.effort.sd < 1e-6);
        assert_eq!(line.effort.mean, 5.0);
    }
}
