//! The running resistance as it is published: with hysteresis in its validity, and never a value that no train has.
//!
//! - *Not yet*, until the standard deviation of r(v) at one of [`JUDGED_KMH`] has fallen below [`LEARNED_SHARE`] of the
//!   description's; and again only where both are above [`FORGOTTEN_SHARE`].
//! - *Predicts worse*: the description foresaw the coasts better than what was learned
//!   ([`Trust::worse_by`](crate::tick::foresight::Trust::worse_by) [`WORSE_BY`] standard deviations, until it is less
//!   than [`NO_LONGER_WORSE_BY`]); it is published.
//! - *Out of bounds*, when r(v) at one of [`BOUND_KMH`] leaves 0.5 to 2 times the manufacturer's; until all are back
//!   within 0.55 to 1.9 times; or when it rises by less than [`LEAST_RISE`] from 20 to 80 km/h or falls beyond: where
//!   r1 and r2 of a description are per km/h, what was learned is as flat as it. The curve is judged and not each
//!   coefficient: a headwind alone may double r1 or make it negative. Out of bounds the published coefficients are cut
//!   off at 0.5 and 2 times; the filter goes on with its own.

use crate::Real;
use crate::extremes::Extremes;
use crate::filter::gaussian::Gaussian;
use crate::model::resistance::Davis;
use crate::model::state::resistance_sd;
use crate::model::units::KmPerHour;
use crate::plain::plain;
use rundown_wire::Learned;

/// Speeds at which learning is judged, km/h: the middle of those at which trains coast, on a tram line and on others. A
/// tram says little of the second.
pub const JUDGED_KMH: [Real; 2] = [50.0, 100.0];
/// Share of the initial standard deviation below which the resistance counts as learned.
pub const LEARNED_SHARE: Real = 0.5;
/// Share above which it counts as forgotten.
pub const FORGOTTEN_SHARE: Real = 0.6;
/// Speeds at which the bounds are checked, km/h.
pub const BOUND_KMH: [Real; 3] = [20.0, 80.0, 140.0];

/// The resistance of a train rises by more from 20 to 80 km/h, share: of loaded freight trains by a third and more, of
/// others by half to twice; by a tenth where r1 is 3.6 and r2 13 times too small.
pub const LEAST_RISE: Real = 0.2;

/// The description foresees coasts better by so many standard deviations: it is published.
pub const WORSE_BY: Real = 2.0;
/// Below, what was learned is published again.
pub const NO_LONGER_WORSE_BY: Real = 1.0;

/// What is remembered from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Published {
    learned: bool,
    out_of_bounds: bool,
    worse: bool,
}

plain! {
    struct Published { learned, out_of_bounds, worse }
}

impl Published {
    /// What was learned is not published as it is: nothing is to be predicted with it.
    pub fn is_withheld(&self) -> bool {
        self.out_of_bounds || self.worse
    }

    /// The coefficients to publish and how far they may be trusted. `initial_sds` are those of r at [`JUDGED_KMH`] by
    /// the description alone; `worse_by`: the description foresaw the coasts better by so many standard deviations.
    pub fn judge(
        &mut self,
        nominal: &Davis,
        initial_sds: [Real; 2],
        found: &Gaussian<3>,
        worse_by: Real,
    ) -> (Davis, Learned) {
        let least = if self.learned { FORGOTTEN_SHARE } else { LEARNED_SHARE };
        self.learned = sds(found).iter().zip(initial_sds).any(|(sd, initial)| *sd < least * initial);

        self.worse = worse_by > if self.worse { NO_LONGER_WORSE_BY } else { WORSE_BY };
        let [r0, r1, r2] = found.mean.into();
        let davis = Davis { r0, r1, r2 };
        let (low, high) = if self.out_of_bounds { (0.55, 1.9) } else { (0.5, 2.0) };
        let found_n_per_kg = at_bounds(&davis);
        let is_within =
            |(r, kmh): (Real, Real)| (low..=high).contains(&(r / nominal.resistance_n_per_kg(KmPerHour(kmh).to_mps())));
        self.out_of_bounds = !(does_rise(found_n_per_kg) && found_n_per_kg.into_iter().zip(BOUND_KMH).all(is_within));
        if self.out_of_bounds {
            let cut = |found: Real, nominal: Real| found.at_least(0.5 * nominal).at_most(2.0 * nominal);
            let davis = Davis { r0: cut(r0, nominal.r0), r1: cut(r1, nominal.r1), r2: cut(r2, nominal.r2) };
            return (davis, Learned::OutOfBounds);
        }
        if self.worse {
            return (*nominal, Learned::PredictsWorse);
        }
        let learned = if self.learned { Learned::Learned } else { Learned::NotYet };
        (davis, learned)
    }
}

/// r at [`BOUND_KMH`], N/kg.
fn at_bounds(davis: &Davis) -> [Real; 3] {
    BOUND_KMH.map(|kmh| davis.resistance_n_per_kg(KmPerHour(kmh).to_mps()))
}

fn does_rise([slow, middle, fast]: [Real; 3]) -> bool {
    middle >= (1.0 + LEAST_RISE) * slow && fast >= middle
}

/// Rises with speed as the resistance of a train does: by [`LEAST_RISE`] from 20 to 80 km/h, and not less beyond.
///
/// ```
/// use rundown::{model::resistance::Davis, tick::published::rises};
///
/// let freight = Davis { r0: 0.0131, r1: 1.93e-4, r2: 1.6e-5 };
/// let per_kmh = Davis { r1: freight.r1 / 3.6, r2: freight.r2 / 12.96, ..freight };
/// assert!(rises(&freight) && !rises(&per_kmh));
/// ```
pub fn rises(davis: &Davis) -> bool {
    does_rise(at_bounds(davis))
}

/// Standard deviations of r at [`JUDGED_KMH`], N/kg.
pub fn sds(davis: &Gaussian<3>) -> [Real; 2] {
    JUDGED_KMH.map(|kmh| resistance_sd(davis, KmPerHour(kmh).to_mps()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    const NOMINAL: Davis = Davis { r0: 7.38e-3, r1: 1.6e-4, r2: 2.8e-5 };

    fn belief(scale: Real, sd: Real) -> Gaussian<3> {
        let mean = [scale * NOMINAL.r0, scale * NOMINAL.r1, scale * NOMINAL.r2];
        Gaussian::independent(mean, [sd, 0.0, 0.0])
    }

    #[test]
    fn validity_has_hysteresis() {
        let mut published = Published::default();
        let mut say = |scale, sd| published.judge(&NOMINAL, [1e-3; 2], &belief(scale, sd), 0.0).1;
        assert_eq!(say(1.0, 5.5e-4), Learned::NotYet);
        assert_eq!(say(1.0, 4.9e-4), Learned::Learned);
        assert_eq!(say(1.0, 5.5e-4), Learned::Learned);
        assert_eq!(say(1.0, 6.1e-4), Learned::NotYet);
        assert_eq!(say(1.95, 1e-4), Learned::Learned);
        assert_eq!(say(2.01, 1e-4), Learned::OutOfBounds);
        assert_eq!(say(1.95, 1e-4), Learned::OutOfBounds);
        assert_eq!(say(1.85, 1e-4), Learned::Learned);
        assert_eq!(say(0.49, 1e-4), Learned::OutOfBounds);
    }

    #[test]
    fn a_tram_need_not_say_what_it_has_at_100_kmh() {
        let say = |sds| Published::default().judge(&NOMINAL, sds, &belief(1.0, 1e-3), 0.0).1;
        assert_eq!(say([2.1e-3, 1.9e-3]), Learned::Learned);
        assert_eq!(say([1.9e-3, 2.1e-3]), Learned::Learned);
        assert_eq!(say([1.9e-3, 1.9e-3]), Learned::NotYet);
    }

    #[test]
    fn values_that_no_train_has_are_cut_off() {
        let mut published = Published::default();
        let mut wild = belief(1.0, 1e-4);
        wild.mean = Vector3::new(-1.0, 1.0, NOMINAL.r2);
        let (davis, learned) = published.judge(&NOMINAL, [1e-3; 2], &wild, 0.0);
        assert_eq!(learned, Learned::OutOfBounds);
        assert_eq!((davis.r0, davis.r1, davis.r2), (0.5 * NOMINAL.r0, 2.0 * NOMINAL.r1, NOMINAL.r2));
        let none = Gaussian::independent([Real::NAN; 3], [1.0; 3]);
        let (davis, learned) = published.judge(&NOMINAL, [1e-3; 2], &none, 0.0);
        assert_eq!(learned, Learned::OutOfBounds);
        assert!(davis.r0.is_finite() && davis.r1.is_finite() && davis.r2.is_finite());
    }

    #[test]
    fn where_the_description_foresees_better_it_is_published() {
        let mut published = Published::default();
        let mut say = |scale, worse_by| published.judge(&NOMINAL, [1e-3; 2], &belief(scale, 1e-4), worse_by);
        assert_eq!(say(1.2, 1.9).1, Learned::Learned);
        assert_eq!(say(1.2, 2.1), (NOMINAL, Learned::PredictsWorse));
        assert_eq!(say(1.2, 1.1), (NOMINAL, Learned::PredictsWorse));
        assert_eq!(say(1.2, 0.9).1, Learned::Learned);
        assert_eq!(say(3.0, 2.1).1, Learned::OutOfBounds);
    }

    #[test]
    fn a_resistance_that_hardly_rises_with_speed_is_out_of_bounds() {
        // Within 0.5 to 2 times everywhere.
        let of = |r0: Real, r1: Real, r2: Real| {
            let mut belief = belief(1.0, 1e-4);
            belief.mean = Vector3::new(r0, r1, r2);
            let shares = BOUND_KMH.map(|kmh| {
                let v = kmh / 3.6;
                (r0 + v * (r1 + v * r2)) / NOMINAL.resistance_n_per_kg(v)
            });
            assert!(shares.iter().all(|share| (0.5..2.0).contains(share)), "{shares:?}");
            Published::default().judge(&NOMINAL, [1e-3; 2], &belief, 0.0).1
        };
        assert_eq!(of(0.02106, -6.8e-4, 2.34e-5), Learned::OutOfBounds);
        assert_eq!(of(0.01684, 1.95e-4, 2.7e-6), Learned::Learned);
        assert_eq!(of(0.018, -4.5e-5, 8.1e-6), Learned::OutOfBounds);
    }

    /// A freight train's r1 and r2, described per km/h and (km/h)².
    #[test]
    fn a_description_per_km_per_hour_is_out_of_bounds_and_its_train_is_not() {
        let freight = Davis { r0: 0.0131, r1: 1.93e-4, r2: 1.6e-5 };
        let judged = |nominal: Davis| {
            let found = Gaussian::independent([nominal.r0, nominal.r1, nominal.r2], [1e-4, 0.0, 0.0]);
            Published::default().judge(&nominal, [1e-3; 2], &found, 0.0).1
        };
        assert_eq!(judged(freight), Learned::Learned);
        let per_kmh = Davis { r1: freight.r1 / 3.6, r2: freight.r2 / 12.96, ..freight };
        assert_eq!(judged(per_kmh), Learned::OutOfBounds);
    }

    #[test]
    fn a_headwind_that_doubles_the_linear_term_is_no_fault() {
        let mut wind = belief(1.0, 1e-4);
        // 3 m/s against a quadratic term: 2 r2 w v and r2 w^2.
        wind.mean[0] += NOMINAL.r2 * 9.0;
        wind.mean[1] += 2.0 * NOMINAL.r2 * 3.0;
        assert!(wind.mean[1] > 2.0 * NOMINAL.r1);
        let (davis, learned) = Published::default().judge(&NOMINAL, [1e-3; 2], &wind, 0.0);
        assert_eq!((davis.r1, learned), (wind.mean[1], Learned::Learned));
    }
}
