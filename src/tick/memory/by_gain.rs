//! What a vehicle's resistance and the gain of its effort column have in common.
//!
//! An effort that reads too little looks like less resistance in each run. So the vehicle's coefficients are carried as
//! they would be under a gain, with how they move with it:
//!
//! ```text
//! r | g = mean + slope (g - ĝ)        covariance of r = covariance of r | g + slope slopeᵀ var(g)
//! ```
//!
//! Left out, each run would take the gain for known as well as the last one left it, and the resistance for known
//! beside it: what all runs are off by alike would be averaged away on paper, and the resistance stay where the first
//! runs put it.

use super::{Vehicle, inverse, shares};
use crate::Real;
use crate::filter::gaussian::Gaussian;
use crate::plain::plain;
use nalgebra::{Matrix3, Vector3, Vector4};
use serde::{Deserialize, Serialize};

/// How the vehicle's coefficients move with the gain of its column, shares for a unit of the gain. As it is stored, for
/// a board that was restarted goes on with the same bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ByGain {
    slope: [f32; 3],
}

plain! {
    struct ByGain { slope }
}

impl ByGain {
    pub(crate) fn of(slope: &Vector3<Real>) -> Self {
        Self { slope: [slope.x as f32, slope.y as f32, slope.z as f32] }
    }

    pub(super) fn slope(self) -> Vector3<Real> {
        let [r0, r1, r2] = self.slope;
        Vector3::new(r0.into(), r1.into(), r2.into())
    }

    /// Numbers that a vehicle may have.
    pub(super) fn is_sound(self) -> bool {
        self.slope.iter().all(|slope| slope.is_finite())
    }
}

/// What a run said of the resistance under one gain: information matrix and vector, and how the vector falls with that
/// gain. In shares.
#[derive(Clone, Copy)]
pub(super) struct Said {
    pub information: Matrix3<Real>,
    pub vector: Vector3<Real>,
    pub by_gain: Vector3<Real>,
}

impl Said {
    /// With a factor on all of it.
    pub fn weighed(&self, weight: Real) -> Self {
        Self { information: self.information * weight, vector: self.vector * weight, by_gain: self.by_gain * weight }
    }
}

/// r0, r1, r2 and a gain of the effort column with its variance; `common`: the covariance of both.
pub fn beside_gain(davis: &Gaussian<3>, (gain, variance): (Real, Real), common: &Vector3<Real>) -> Gaussian<4> {
    let mut joint = Gaussian::<4>::ZEROED;
    joint.mean = Vector4::new(davis.mean.x, davis.mean.y, davis.mean.z, gain);
    joint.covariance.fixed_view_mut::<3, 3>(0, 0).copy_from(&davis.covariance);
    joint.covariance[(3, 3)] = variance;
    for row in 0..3 {
        joint.covariance[(row, 3)] = common[row];
        joint.covariance[(3, row)] = common[row];
    }
    joint
}

impl Vehicle {
    /// What the run itself said under a gain, free of the belief it began with.
    #[inline(never)]
    pub(super) fn said(&self, begin: &Gaussian<4>, end: &Gaussian<4>, gain: Real) -> Option<Said> {
        let (before, after) = (self.under(begin, gain)?, self.under(end, gain)?);
        let information = after.information - before.information;
        Some(Said {
            information: (information + information.transpose()) * 0.5,
            vector: after.vector - before.vector,
            by_gain: after.by_gain - before.by_gain,
        })
    }

    /// The first three rows of the information of a belief, by the inverse of its blocks.
    fn under(&self, belief: &Gaussian<4>, gain: Real) -> Option<Said> {
        let unit = shares(&self.nominal).map(|unit| 1.0 / unit);
        let in_shares = Matrix3::from_diagonal(&unit);
        let mean = in_shares * belief.mean.fixed_rows::<3>(0);
        let common = in_shares * belief.covariance.fixed_view::<3, 1>(0, 3);
        let mut information = inverse(&(in_shares * belief.covariance.fixed_view::<3, 3>(0, 0) * in_shares))?;
        let mut by_gain = Vector3::zeros();
        if common != by_gain {
            let moved = information * common;
            let left = belief.covariance[(3, 3)] - common.dot(&moved);
            // What has nothing left of its own is one with the resistance.
            if left <= 0.0 {
                return None;
            }
            information += moved * moved.transpose() / left;
            by_gain = -moved / left;
        }
        let vector = information * mean + by_gain * (belief.mean[3] - gain);
        Some(Said { information, vector, by_gain })
    }
}
