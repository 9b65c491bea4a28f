//! Motion of the train over one step, Eq. (1), (2), (4), (5).
//!
//! In: a state (s, v, r0, r1, r2), the applied effort, the track under the train. Out: the state a step later, and what
//! its sigma points see.
//!
//! ```text
//! s' = s + σ (Δt v + ½ Δt² a)      v' = v + Δt a                       Eq. (4), σ = +1 up, -1 down
//! a  = u - r0 - r1 w - r2 w² - g - X                                   Eq. (5); X of the named effects
//! ```
//!
//! As printed, w = v and g is taken at s: both at the beginning of the step. A coasting train slows meanwhile, so one
//! such step of 10 s takes too much resistance, and an estimate of r comes out 0.86 % too small at 100 km/h.
//! [`Evaluate::Midway`] takes w and g where the train is half a step later; the lead is a number found at the mean, the
//! same for all sigma points, so that the equation keeps its form. With steps of 2.5 s the remaining error is below
//! 0.001 % (`host-tests/tests/paper.rs` measures both).

use crate::Real;
use crate::filter::elimination::FactorColumn;
use crate::filter::ukf::{Pair, Process};
use crate::model::effects::Acting;
use crate::model::line::Line;
use crate::model::point::Point;
use crate::model::profile::UnderTrain;
use crate::model::state::{self, GAIN, LOCATION, MOVING, R0, R1, R2, SPEED};
use crate::plain::plain;
use nalgebra::SVector;
use serde::{Deserialize, Serialize};

/// Where within a step resistance and gradient are evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Evaluate {
    /// At its beginning, Eq. (4) as printed.
    Beginning,
    /// Half-way, from the speed and acceleration at the mean.
    Midway,
}

plain! {
    enum Evaluate { Beginning, Midway }
}

/// One step of the motion, bound to where it begins.
#[derive(Clone, Copy, Debug)]
pub struct Motion<'a> {
    under_train: UnderTrain<'a>,
    gravity_n_per_kg_m: Real,
    effort_n_per_kg: Real,
    dt_s: Real,
    /// σ Δt / 2.
    half_way_s: Real,
    lead_mps: Real,
    /// Resistance of the named effects, N/kg.
    extra_n_per_kg: Real,
    /// Variance of the acceleration beyond the model.
    noise_variance: Real,
}

impl<'a> Motion<'a> {
    /// A step of `dt_s` from the mean `x` under a constant effort per mass.
    ///
    /// ```
    /// use nalgebra::SVector;
    /// use rundown::model::line::Line;
    /// use rundown::model::motion::{Evaluate, Motion};
    /// use rundown::filter::ukf::Process;
    /// use rundown::model::resistance::Davis;
    /// use rundown::model::{direction::Direction, track::*};
    /// use rundown::model::train::*;
    ///
    /// # let description = TrainDescription::CASE_STUDY;
    /// let train = Train::try_new(description)?;
    /// let flat = Track::try_new(1000.0, [])?;
    /// let line = Line { train: &train, track: &flat, direction: Direction::Up };
    /// let x = SVector::from([0.0, 30.0, 7.38e-3, 1.6e-4, 2.8e-5]);
    /// let coasting = Motion::new(&line, &x, 0.0, 10.0, Evaluate::Beginning);
    /// let moved = coasting.advance(&x);
    /// assert!((moved[1] - (30.0 - 10.0 * 0.03738)).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new<const N: usize>(
        line: &Line<'a>,
        x: &SVector<Real, N>,
        effort_n_per_kg: Real,
        dt_s: Real,
        evaluate: Evaluate,
    ) -> Self {
        let mut motion = Self {
            under_train: line.under_train(x[LOCATION]),
            gravity_n_per_kg_m: line.train.gravity_n_per_kg_m(),
            effort_n_per_kg,
            dt_s,
            half_way_s: 0.5 * line.direction.sign() * dt_s,
            lead_mps: 0.0,
            extra_n_per_kg: 0.0,
            noise_variance: 0.0,
        };
        if evaluate == Evaluate::Midway {
            let lead_mps = 0.5 * dt_s * motion.acceleration_mps2(x);
            let midway_m = motion.half_way_s * (x[SPEED] + 0.5 * lead_mps);
            motion.lead_mps = lead_mps;
            motion.under_train = motion.under_train.shifted(midway_m);
        }
        motion
    }

    /// The same step with the effects of the model, where the train is at the mean `x`: at the beginning, or half-way
    /// as all else. `begin_s` is the time of the beginning.
    pub fn with_effects<const N: usize>(
        mut self,
        line: &Line<'_>,
        acting: &Acting<'_>,
        x: &SVector<Real, N>,
        begin_s: Real,
        evaluate: Evaluate,
    ) -> Self {
        if acting.is_empty() {
            return self;
        }
        let lead_s = match evaluate {
            Evaluate::Beginning => 0.0,
            Evaluate::Midway => 0.5 * self.dt_s,
        };
        let mean_mps = x[SPEED] + 0.5 * self.lead_mps;
        let at = Point {
            time_s: begin_s + lead_s,
            location_m: x[LOCATION] + line.direction.sign() * lead_s * mean_mps,
            speed_mps: x[SPEED] + self.lead_mps,
        };
        let effort_n_per_kg = self.effort_at(x);
        self.extra_n_per_kg = acting.extra_n_per_kg(line, &state::davis(x), &at, effort_n_per_kg);
        // It slows the train on its way to where resistance and gradient are taken, too.
        self.lead_mps -= lead_s * self.extra_n_per_kg;
        self
    }

    /// The same step with white noise of this standard deviation in the acceleration, constant over the step (Q of Eq.
    /// 3).
    pub fn with_noise(self, noise_mps2: Real) -> Self {
        Self { noise_variance: noise_mps2 * noise_mps2, ..self }
    }

    /// Acceleration at a state, Eq. (5), m/s².
    pub fn acceleration_mps2<const N: usize>(&self, x: &SVector<Real, N>) -> Real {
        let w = x[SPEED] + self.lead_mps;
        self.effort_at(x)
            - (x[R0] + w * (x[R1] + w * x[R2]))
            - self.gravity_n_per_kg_m * self.under_train.rise_m()
            - self.extra_n_per_kg
    }

    #[inline]
    fn effort_at<const N: usize>(&self, x: &SVector<Real, N>) -> Real {
        if N > GAIN { x[GAIN] * self.effort_n_per_kg } else { self.effort_n_per_kg }
    }
}

impl<const N: usize> Process<N, MOVING> for Motion<'_> {
    #[inline]
    fn drive(&self, x: &SVector<Real, N>) -> Real {
        self.acceleration_mps2(x)
    }

    #[inline]
    fn slope(&self, x: &SVector<Real, N>) -> SVector<Real, N> {
        let w = x[SPEED] + self.lead_mps;
        let mut slope = SVector::zeros();
        slope[LOCATION] = -self.gravity_n_per_kg_m * self.under_train.rise_slope();
        slope[SPEED] = -(x[R1] + 2.0 * w * x[R2]);
        slope[R0] = -1.0;
        slope[R1] = -w;
        slope[R2] = -w * w;
        if N > GAIN {
            slope[GAIN] = self.effort_n_per_kg;
        }
        slope
    }

    /// Of r1 v + r2 v² what is not linear, written down. The gradient is looked up at both points if its slope changes
    /// between them.
    #[inline]
    fn pair(&self, x: &SVector<Real, N>, column: &FactorColumn<N, MOVING>, c: Real) -> Pair {
        let FactorColumn { d, l, dl } = column;
        let w = x[SPEED] + self.lead_mps;
        let dv = l[SPEED];
        let mut pair = Pair { odd: -c * dv * dv * dl[R2], even: -dv * (dl[R1] + x[R2] * dl[SPEED] + 2.0 * w * dl[R2]) };
        // Only the column of the location shifts the train, by √(c D).
        if l[LOCATION] != 0.0
            && let Some((odd, even)) = self.under_train.rise_over_edges(c * d)
        {
            pair.odd -= self.gravity_n_per_kg_m * odd;
            pair.even -= self.gravity_n_per_kg_m * even / c;
        }
        pair
    }

    /// Eq. (4): v' = v + Δt a, s' = s + σ Δt (v + v') / 2.
    #[inline(always)]
    fn carry(&self, x: &SVector<Real, N>, a: Real) -> SVector<Real, MOVING> {
        let speed = x[SPEED] + self.dt_s * a;
        let location = x[LOCATION] + self.half_way_s * (x[SPEED] + speed);
        SVector::from([location, speed])
    }

    #[inline]
    fn noise_variance(&self) -> Real {
        self.noise_variance
    }
}
