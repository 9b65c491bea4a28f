//! The Unscented Kalman Filter of any system: any f, h, Q and R, section 3.1.
//!
//! In: a belief, a [`System`], readings. Out: the belief one step later, and the innovation.
//!
//! [`Ukf`](crate::filter::ukf::Ukf) is the same filter for motions with one number that is not linear, at a fraction of
//! the cost; where both can be used they agree to ten digits (`host-tests/tests/textbook.rs`). Points and weights are
//! those of Eq. (7)-(9). Seen from the central point, the large weights of a small α cancel: with d_i = g(χ_i) - g(x̄),
//! w = 1 / (2 c) and c = N + λ,
//!
//! ```text
//! m = w Σ d_i          mean g(x̄) + m          covariance w Σ d_i d_iᵀ + (β - α²) m mᵀ
//! ```
//!
//! which is Eq. (10), (11) and (13)-(15) without the central weight. What is left of small reaches is the difference of
//! nearly equal numbers in d_i: take α near 1. The points of the update are drawn from the predicted belief, Q
//! included.

use crate::Real;
use crate::filter::elimination::{FactorColumn, NotPositiveDefinite, eliminate};
use crate::filter::gaussian::Gaussian;
use crate::filter::ukf::{Innovation, Reading, Spread};
use nalgebra::{SMatrix, SVector};

/// What is filtered: a state of N components and M readings of it.
pub trait System<const N: usize, const M: usize> {
    /// The state one step later, f of Eq. (3).
    fn next(&self, x: &SVector<Real, N>) -> SVector<Real, N>;

    /// Covariance Q of the noise of a step, Eq. (11); symmetric.
    fn process_noise(&self) -> SMatrix<Real, N, N>;

    /// The readings that a state is expected to give, h of Eq. (6).
    fn expected(&self, x: &SVector<Real, N>) -> SVector<Real, M>;

    /// Covariance R of the readings' noise, Eq. (14); symmetric.
    fn reading_noise(&self) -> SMatrix<Real, M, M>;
}

/// The filter's settings. What changes is a [`Gaussian`], held by the caller.
///
/// How far off is a wheel? A receiver gives locations, an odometer the speed times an unknown scale:
///
/// ```
/// use nalgebra::{SMatrix, SVector, matrix, vector};
/// use rundown::filter::{gaussian::Gaussian, general::{GeneralUkf, System}, ukf::Spread};
///
/// /// Location, m; speed, m/s; reading of the odometer over speed. A reading each second.
/// struct Wheel;
///
/// impl System<3, 2> for Wheel {
///     fn next(&self, x: &SVector<f64, 3>) -> SVector<f64, 3> { vector![x[0] + x[1], x[1], x[2]] }
///     fn process_noise(&self) -> SMatrix<f64, 3, 3> { SMatrix::from_diagonal(&vector![0.25, 0.25, 0.0]) }
///     fn expected(&self, x: &SVector<f64, 3>) -> SVector<f64, 2> { vector![x[0], x[1] * x[2]] }
///     fn reading_noise(&self) -> SMatrix<f64, 2, 2> { matrix![16.0, 0.0; 0.0, 0.01] }
/// }
///
/// let filter = GeneralUkf { spread: Spread::new(1.0, 2.0, 0.0) };
/// let mut belief = Gaussian::independent([0.0, 20.0, 1.0], [10.0, 2.0, 0.03]);
/// let (mut location_m, scale) = (0.0, 1.013);
/// for second in 1..=600 {
///     let speed_mps = 25.0 + 5.0 * (0.02 * f64::from(second)).sin();
///     location_m += speed_mps;
///     let receiver_m = location_m + 4.0 * (2.4 * f64::from(second)).sin();
///     // In a tunnel there is no location.
///     let receiver_m = Some(receiver_m).filter(|_| !(200..260).contains(&second));
///     filter.step(&mut belief, &Wheel, &[receiver_m, Some(scale * speed_mps)])?;
/// }
/// assert!((belief.mean[2] - scale).abs() < 2.0 * belief.sd(2) && belief.sd(2) < 0.002);
/// # Ok::<(), rundown::filter::elimination::NotPositiveDefinite>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeneralUkf<const N: usize> {
    /// Spread of the sigma points.
    pub spread: Spread<N>,
}

/// A function of the state, by the sigma points.
struct Seen<const N: usize, const L: usize> {
    mean: SVector<Real, L>,
    covariance: SMatrix<Real, L, L>,
    /// Covariance of the state with it.
    cross: SMatrix<Real, N, L>,
}

impl<const N: usize> GeneralUkf<N> {
    /// One step: predict, then update with what there is of the readings.
    ///
    /// # Errors
    /// [`NotPositiveDefinite`] with row and pivot, of the belief or of P_z; `belief` is then as it was.
    pub fn step<const M: usize>(
        &self,
        belief: &mut Gaussian<N>,
        system: &impl System<N, M>,
        z: &[Option<Real>; M],
    ) -> Result<Innovation<M>, NotPositiveDefinite> {
        let mut next = *belief;
        self.predict(&mut next, system)?;
        let innovation = self.update(&mut next, system, z)?;
        *belief = next;
        Ok(innovation)
    }

    /// Prediction alone, Eq. (7)-(11).
    ///
    /// # Errors
    /// [`NotPositiveDefinite`]; `belief` is then as it was.
    pub fn predict<const M: usize>(
        &self,
        belief: &mut Gaussian<N>,
        system: &impl System<N, M>,
    ) -> Result<(), NotPositiveDefinite> {
        let Seen { mean, covariance, .. } = self.seen(belief, |x| system.next(x))?;
        *belief = Gaussian { mean, covariance: covariance + system.process_noise() };
        Ok(())
    }

    /// Update, Eq. (12)-(18); a missing reading is left out.
    ///
    /// # Errors
    /// [`NotPositiveDefinite`]; `belief` is then as it was.
    pub fn update<const M: usize>(
        &self,
        belief: &mut Gaussian<N>,
        system: &impl System<N, M>,
        z: &[Option<Real>; M],
    ) -> Result<Innovation<M>, NotPositiveDefinite> {
        let seen = self.seen(belief, |x| system.expected(x))?;
        let covariance = seen.covariance + system.reading_noise();
        // Without its covariances a missing reading says nothing.
        let is_there = |i: usize| z.get(i).is_some_and(|reading| reading.is_some());
        let counts =
            SMatrix::from_fn(|i, j| if i == j || is_there(i) && is_there(j) { covariance[(i, j)] } else { 0.0 });
        let value = SVector::from_fn(|i, _| z[i].map_or(0.0, |reading| reading - seen.mean[i]));
        let columns: [FactorColumn<M, M>; M] = eliminate(&counts)?;
        // The readings one after another, each without what those before it say: L⁻¹ (z - z̄), with P_xz L⁻ᵀ.
        let mut apart = value;
        let mut cross = SMatrix::<Real, N, M>::from_fn(|i, j| if is_there(j) { seen.cross[(i, j)] } else { 0.0 });
        let mut next = *belief;
        for (j, column) in columns.iter().enumerate() {
            for after in j + 1..M {
                apart[after] -= column.l[after] * apart[j];
                let of_this = cross.column(j) * column.l[after];
                cross.set_column(after, &(cross.column(after) - of_this));
            }
            let gain = cross.column(j) / column.d;
            next.mean += gain * apart[j];
            next.covariance -= cross.column(j) * cross.column(j).transpose() / column.d;
        }
        *belief = next;
        let readings = z.map(|reading| if reading.is_some() { Reading::Used } else { Reading::Missing });
        let sequential = core::array::from_fn(|j| (apart[j], columns[j].d));
        Ok(Innovation { value, covariance, readings, sequential })
    }

    /// Mean, covariance and covariance with the state of g, Eq. (7)-(10).
    fn seen<const L: usize>(
        &self,
        belief: &Gaussian<N>,
        g: impl Fn(&SVector<Real, N>) -> SVector<Real, L>,
    ) -> Result<Seen<N, L>, NotPositiveDefinite> {
        let c = self.spread.reach();
        let w = 0.5 / c;
        let centre = g(&belief.mean);
        let mut m = SVector::<Real, L>::zeros();
        let mut covariance = SMatrix::<Real, L, L>::zeros();
        let mut cross = SMatrix::<Real, N, L>::zeros();
        for FactorColumn { d, dl, .. } in eliminate::<N, N>(&belief.covariance)? {
            let away = dl * crate::roots::square_root(c / d);
            let [above, below] = [g(&(belief.mean + away)) - centre, g(&(belief.mean - away)) - centre];
            m += (above + below) * w;
            covariance += (above * above.transpose() + below * below.transpose()) * w;
            cross += away * (above - below).transpose() * w;
        }
        let [alpha, beta, _] = self.spread.parameters();
        covariance += m * m.transpose() * (beta - alpha * alpha);
        Ok(Seen { mean: centre + m, covariance, cross })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{matrix, vector};

    const FILTER: GeneralUkf<2> = GeneralUkf { spread: Spread::new(1.0, 2.0, 1.0) };

    fn belief() -> Gaussian<2> {
        Gaussian { mean: vector![2.0, -1.0], covariance: matrix![0.5, 0.2; 0.2, 0.3] }
    }

    #[test]
    fn means_are_exact_to_the_third_moment_and_no_further() {
        let Gaussian { mean, covariance } = belief();
        let ([x, y], [xx, xy, yy]) = ([mean[0], mean[1]], [covariance[(0, 0)], covariance[(0, 1)], covariance[(1, 1)]]);
        for spread in [Spread::new(1.0, 2.0, 1.0), Spread::new(0.3, 0.0, 5.0)] {
            let filter = GeneralUkf { spread };
            let seen = |s: &SVector<Real, 2>| vector![s[0].powi(3), s[0].powi(2) * s[1], s[1].powi(3), s[0] * s[1]];
            let seen = filter.seen(&belief(), seen).unwrap();
            let moments = vector![
                x.powi(3) + 3.0 * x * xx,
                x * x * y + y * xx + 2.0 * x * xy,
                y.powi(3) + 3.0 * y * yy,
                x * y + xy
            ];
            assert!((seen.mean - moments).amax() < 1e-12, "{}", seen.mean - moments);
            let fourth = filter.seen(&belief(), |s| vector![s[1].powi(4)]).unwrap().mean[0];
            assert!(
                (fourth - (y.powi(4) + 6.0 * y * y * yy + 3.0 * yy * yy)).abs() > 1e-3,
                "no filter of 2 N + 1 points is"
            );
        }
    }

    /// z = H x + noise with noises that are correlated.
    struct Linear;

    impl System<2, 2> for Linear {
        fn next(&self, x: &SVector<Real, 2>) -> SVector<Real, 2> {
            matrix![1.0, 10.0; 0.0, 0.9] * x
        }

        fn process_noise(&self) -> SMatrix<Real, 2, 2> {
            matrix![0.2, 0.05; 0.05, 0.1]
        }

        fn expected(&self, x: &SVector<Real, 2>) -> SVector<Real, 2> {
            matrix![1.0, 0.5; 0.0, 2.0] * x
        }

        fn reading_noise(&self) -> SMatrix<Real, 2, 2> {
            matrix![0.4, 0.1; 0.1, 0.3]
        }
    }

    #[test]
    fn where_all_is_linear_it_is_the_kalman_filter() {
        let mut found = belief();
        let innovation = FILTER.step(&mut found, &Linear, &[Some(-7.0), Some(-2.5)]).unwrap();
        let (f, h) = (matrix![1.0, 10.0; 0.0, 0.9], matrix![1.0, 0.5; 0.0, 2.0]);
        let (x, p) = (f * belief().mean, f * belief().covariance * f.transpose() + Linear.process_noise());
        let value = vector![-7.0, -2.5] - h * x;
        let pz = h * p * h.transpose() + Linear.reading_noise();
        let inverse = pz.try_inverse().unwrap();
        let gain = p * h.transpose() * inverse;
        assert!((found.mean - (x + gain * value)).amax() < 1e-12);
        assert!((found.covariance - (p - gain * pz * gain.transpose())).amax() < 1e-12);
        let squared = (value.transpose() * inverse * value)[0];
        let normalisation = 2.0 * (2.0 * core::f64::consts::PI).ln() + pz.determinant().ln();
        assert!((innovation.distance_squared() - squared).abs() < 1e-12);
        assert!((innovation.log_likelihood() + 0.5 * (squared + normalisation)).abs() < 1e-12);
    }

    #[test]
    fn a_missing_reading_is_as_if_there_were_none() {
        struct First;

        impl System<2, 1> for First {
            fn next(&self, x: &SVector<Real, 2>) -> SVector<Real, 2> {
                Linear.next(x)
            }

            fn process_noise(&self) -> SMatrix<Real, 2, 2> {
                Linear.process_noise()
            }

            fn expected(&self, x: &SVector<Real, 2>) -> SVector<Real, 1> {
                vector![Linear.expected(x)[0]]
            }

            fn reading_noise(&self) -> SMatrix<Real, 1, 1> {
                matrix![Linear.reading_noise()[(0, 0)]]
            }
        }

        let (mut missing, mut alone) = (belief(), belief());
        let both = FILTER.step(&mut missing, &Linear, &[Some(-7.0), None]).unwrap();
        let one = FILTER.step(&mut alone, &First, &[Some(-7.0)]).unwrap();
        assert_eq!(missing, alone);
        assert_eq!(both.log_likelihood(), one.log_likelihood());
        assert_eq!(both.readings, [Reading::Used, Reading::Missing]);
    }

    #[test]
    fn a_refused_belief_is_named_by_its_row_and_stays() {
        let mut indefinite = Gaussian { covariance: matrix![1.0, 2.0; 2.0, 1.0], ..belief() };
        let before = indefinite;
        let refused = FILTER.step(&mut indefinite, &Linear, &[Some(0.0), Some(0.0)]).unwrap_err();
        assert_eq!(refused, NotPositiveDefinite { row: 1, pivot: -3.0 });
        assert_eq!(indefinite, before);
    }
}
