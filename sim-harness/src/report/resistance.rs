//! Running resistance at a speed with its 95 % interval, out of the belief of the three coefficients.
//!
//! ```text
//! r(v) = h · (r0, r1, r2),   sd² = h P hᵀ,   h = (1, v, v²)
//! ```

use rundown::{Real, filter::gaussian::Gaussian, model::resistance::Davis};
use rundown_check::figure::HALF_95;
use rundown_wire::Learned;

/// Running resistance at a speed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "named with their units")]
pub struct Resistance {
    pub mean_n_per_kg: Real,
    pub sd_n_per_kg: Real,
}

impl Resistance {
    /// None when the belief is not finite.
    pub fn at(belief: &Gaussian<3>, speed_mps: Real) -> Option<Self> {
        let mut h = belief.mean;
        (h[0], h[1], h[2]) = (1.0, speed_mps, speed_mps * speed_mps);
        let variance = h.dot(&(belief.covariance * h));
        let found = Self { mean_n_per_kg: belief.mean.dot(&h), sd_n_per_kg: variance.max(0.0).sqrt() };
        let is_finite = found.mean_n_per_kg.is_finite() && variance.is_finite();
        is_finite.then_some(found)
    }

    /// Lower end of the 95 % interval, N/kg.
    pub fn lower(&self) -> Real {
        self.mean_n_per_kg - HALF_95 * self.sd_n_per_kg
    }

    /// Upper end of the 95 % interval, N/kg.
    pub fn upper(&self) -> Real {
        self.mean_n_per_kg + HALF_95 * self.sd_n_per_kg
    }

    /// How it stands to the manufacturer's value at the same speed.
    pub fn against(&self, davis: &Davis, speed_mps: Real) -> Comparison {
        let stated = davis.resistance_n_per_kg(speed_mps);
        Comparison {
            stated_n_per_kg: stated,
            deviation: self.mean_n_per_kg / stated - 1.0,
            within: (self.lower()..=self.upper()).contains(&stated),
        }
    }
}

/// Why a learned resistance is not published as it is.
pub(crate) const fn doubt(learned: Learned) -> &'static str {
    match learned {
        Learned::OutOfBounds => ", out of bounds",
        Learned::PredictsWorse => ", not published: predicts worse than the description",
        Learned::NotYet => ", not published yet",
        _ => "",
    }
}

/// An estimate beside the manufacturer's value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// The manufacturer's value, N/kg.
    pub stated_n_per_kg: Real,
    /// Estimated over stated, less one.
    pub deviation: Real,
    /// The stated value lies in the 95 % interval.
    pub within: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_holds_all_three_terms_and_their_correlation() {
        let mut belief = Gaussian::independent([0.01, 0.0, 1e-4], [3e-3, 0.0, 4e-5]);
        let r = Resistance::at(&belief, 10.0).unwrap();
        assert!((r.mean_n_per_kg - 0.02).abs() < 1e-15);
        assert!((r.sd_n_per_kg - 5e-3).abs() < 1e-15);
        assert!((r.upper() - r.lower() - 2.0 * 1.96 * 5e-3).abs() < 1e-15);
        belief.covariance[(0, 2)] = -3e-3 * 4e-5;
        belief.covariance[(2, 0)] = -3e-3 * 4e-5;
        assert!((Resistance::at(&belief, 10.0).unwrap().sd_n_per_kg - 1e-3).abs() < 1e-15);
        belief.covariance[(2, 2)] = Real::NAN;
        assert_eq!(Resistance::at(&belief, 10.0), None);
    }

    #[test]
    fn the_manufacturer_is_within_or_not() {
        let belief = Gaussian::independent([0.011, 0.0, 0.0], [1e-3, 0.0, 0.0]);
        let stated = |r0| Davis { r0, r1: 0.0, r2: 0.0 };
        let r = Resistance::at(&belief, 10.0).unwrap();
        let found = r.against(&stated(0.010), 10.0);
        assert!(found.within && (found.deviation - 0.1).abs() < 1e-12);
        assert!(!r.against(&stated(0.008), 10.0).within);
    }
}
