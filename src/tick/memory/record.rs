//! The vehicle as it is stored: plain numbers, each once, and the check before they are believed again.

use super::{ByGain, MemoryConfig, SCALES, Vehicle};
use crate::Real;
use crate::filter::elimination::{NotPositiveDefinite, eliminate};
use crate::model::resistance::Davis;
use crate::plain::plain;
use crate::tick::effort_reading::Column;
use crate::tick::foresight::Trust;
use crate::tick::truncation::SpeedOffset;
use nalgebra::Matrix3;
use rundown_wire::errors;

/// A stored resistance is believed from this share of the manufacturer's ...
pub const LEAST_SHARE: Real = 0.2;
/// ... to this one.
pub const MOST_SHARE: Real = 5.0;
/// ... at these speeds, m/s. Coefficients by themselves may be far off where their sum is right.
const BELIEVED_AT_MPS: [Real; 4] = [5.0, 15.0, 25.0, 40.0];

/// A [`Vehicle`] in numbers; unchecked. The scales are [`SCALES`] and not repeated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VehicleRecord {
    /// The manufacturer's coefficients r0, r1, r2 by which the shares are taken.
    pub nominal: [Real; 3],
    /// One for each of [`SCALES`].
    pub hypotheses: [HypothesisRecord; SCALES.len()],
    /// Number of runs that said something.
    pub runs: u32,
}

plain! {
    struct VehicleRecord { nominal, hypotheses, runs }
}

/// What is believed if the run-to-run deviation has one scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HypothesisRecord {
    /// Probability of the scale.
    pub weight: Real,
    /// Coefficients, shares.
    pub mean: [Real; 3],
    /// Upper triangle of their covariance by rows: 00, 01, 02, 11, 12, 22.
    pub covariance: [Real; 6],
}

plain! {
    struct HypothesisRecord { weight, mean, covariance }
}

errors! {
    /// Why a stored vehicle is not believed.
    #[non_exhaustive]
    pub enum Implausible {
        NotFinite => "vehicle: expected finite numbers, found another",
        Weights { sum: Real } => "vehicle.weight: expected above 0 with sum 1, found sum {sum}",
        Covariance { hypothesis: usize, cause: NotPositiveDefinite } => "vehicle.hypotheses[{hypothesis}]: {cause}",
        Resistance { speed_mps: Real, share: Real } =>
            "vehicle: r({speed_mps} m/s): expected {LEAST_SHARE} to {MOST_SHARE} of the manufacturer's, found {share}",
    }
}

impl VehicleRecord {
    /// Zeros; of no vehicle.
    pub(crate) const ZEROED: Self = Self {
        nominal: [0.0; 3],
        hypotheses: [HypothesisRecord { weight: 0.0, mean: [0.0; 3], covariance: [0.0; 6] }; SCALES.len()],
        runs: 0,
    };
}

impl Vehicle {
    /// The vehicle in numbers, to be stored.
    pub fn to_record(&self) -> VehicleRecord {
        let Davis { r0, r1, r2 } = self.nominal;
        VehicleRecord {
            nominal: [r0, r1, r2],
            hypotheses: self.hypotheses.map(|hypothesis| HypothesisRecord {
                weight: hypothesis.weight,
                mean: hypothesis.vehicle.mean.into(),
                covariance: upper(&hypothesis.vehicle.covariance),
            }),
            runs: self.runs,
        }
    }

    /// The vehicle that a record describes, bit for bit, if it can be believed of a train with these manufacturer's
    /// coefficients.
    ///
    /// # Errors
    /// [`Implausible`] names the first number that cannot be.
    ///
    /// ```
    /// use rundown::tick::memory::{Implausible, MemoryConfig, Vehicle};
    /// use rundown::model::resistance::Davis;
    ///
    /// let davis = Davis { r0: 7.38e-3, r1: 1.6e-4, r2: 2.8e-5 };
    /// let vehicle = Vehicle::new(&MemoryConfig::default(), davis);
    /// assert_eq!(Vehicle::from_record(&vehicle.to_record(), &davis), Ok(vehicle));
    ///
    /// let other_train = Davis { r0: 0.1, ..davis };
    /// let refused = Vehicle::from_record(&vehicle.to_record(), &other_train);
    /// assert!(matches!(refused, Err(Implausible::Resistance { .. })));
    /// ```
    pub fn from_record(record: &VehicleRecord, manufacturer: &Davis) -> Result<Self, Implausible> {
        let [r0, r1, r2] = record.nominal;
        let mut vehicle = Self::new(&MemoryConfig::DEFAULT, Davis { r0, r1, r2 });
        for (hypothesis, stored) in vehicle.hypotheses.iter_mut().zip(&record.hypotheses) {
            hypothesis.weight = stored.weight;
            hypothesis.vehicle.mean = stored.mean.into();
            hypothesis.vehicle.covariance = symmetric(&stored.covariance);
        }
        vehicle.runs = record.runs;
        vehicle.check(manufacturer)?;
        Ok(vehicle)
    }

    /// Takes up what is known of how it foresaw coasts, of its effort column, of its speed readings and of where it was
    /// taught. Numbers that are none are left: what was learned is worth more.
    pub fn recall(&mut self, trust: Trust, column: (Column, ByGain), offset: SpeedOffset, hops_share: f32) {
        if trust.is_sound() {
            self.trust = trust;
        }
        self.column = column.0;
        if column.1.is_sound() {
            self.by_gain = column.1;
        }
        if offset.is_sound() {
            self.offset = offset;
        }
        if hops_share.abs() <= 1.0 {
            self.hops_share = hops_share;
        }
    }

    fn check(&self, manufacturer: &Davis) -> Result<(), Implausible> {
        let Davis { r0, r1, r2 } = self.nominal;
        // The shares' guard against a coefficient of 0 would hide a nominal that is not a number.
        let nominal_is_finite = r0.is_finite() && r1.is_finite() && r2.is_finite();
        if !nominal_is_finite || !self.davis().is_finite() {
            return Err(Implausible::NotFinite);
        }
        let sum: Real = self.hypotheses.iter().map(|h| h.weight).sum();
        let above_zero = self.hypotheses.iter().all(|h| h.weight > 0.0);
        if !above_zero || libm::fabs(sum - 1.0) > 1e-6 {
            return Err(Implausible::Weights { sum });
        }
        for (hypothesis, held) in self.hypotheses.iter().enumerate() {
            eliminate::<3, 3>(&held.vehicle.covariance)
                .map_err(|cause| Implausible::Covariance { hypothesis, cause })?;
        }
        let mean = self.davis().mean;
        let learned = Davis { r0: mean[0], r1: mean[1], r2: mean[2] };
        for speed_mps in BELIEVED_AT_MPS {
            let at = |davis: &Davis| davis.resistance_n_per_kg(speed_mps);
            let share = at(&learned) / at(manufacturer);
            if !(LEAST_SHARE..=MOST_SHARE).contains(&share) {
                return Err(Implausible::Resistance { speed_mps, share });
            }
        }
        Ok(())
    }
}

fn upper(matrix: &Matrix3<Real>) -> [Real; 6] {
    let m = |row, column| matrix[(row, column)];
    [m(0, 0), m(0, 1), m(0, 2), m(1, 1), m(1, 2), m(2, 2)]
}

fn symmetric([a, b, c, d, e, f]: &[Real; 6]) -> Matrix3<Real> {
    Matrix3::new(*a, *b, *c, *b, *d, *e, *c, *e, *f)
}

#[cfg(test)]
mod tests {
    use super::super::MemoryConfig;
    use super::*;
    use crate::tick::foresight::Foresight;

    const DAVIS: Davis = Davis { r0: 7.38e-3, r1: 1.6e-4, r2: 2.8e-5 };

    fn learned() -> Vehicle {
        let config = MemoryConfig::default();
        let mut vehicle = Vehicle::new(&config, DAVIS);
        let begin = vehicle.constants(&config, 0.03);
        let mut end = begin;
        end.mean *= 1.1;
        end.covariance *= 0.3;
        vehicle.learn(&config, [&begin, &end], Column::default(), &Foresight::NONE, 0.0);
        assert_eq!(vehicle.runs(), 1);
        vehicle
    }

    #[test]
    fn a_vehicle_comes_back_bit_for_bit() {
        let learned = learned();
        let mut paper = learned;
        paper.replace(&learned.davis());
        for vehicle in [learned, paper] {
            let back = Vehicle::from_record(&vehicle.to_record(), &DAVIS);
            assert_eq!(back, Ok(vehicle));
        }
    }

    #[test]
    fn what_cannot_be_is_named() {
        let good = learned().to_record();
        let refused = |change: fn(&mut VehicleRecord)| {
            let mut record = good;
            change(&mut record);
            Vehicle::from_record(&record, &DAVIS).unwrap_err()
        };
        assert_eq!(refused(|r| r.hypotheses[2].mean[1] = Real::NAN), Implausible::NotFinite);
        assert_eq!(refused(|r| r.nominal[0] = Real::INFINITY), Implausible::NotFinite);
        assert_eq!(refused(|r| r.nominal[1] = Real::NAN), Implausible::NotFinite);
        assert_eq!(refused(|r| r.hypotheses[3].covariance[4] = Real::INFINITY), Implausible::NotFinite);
        assert!(matches!(refused(|r| r.hypotheses[0].weight += 0.1), Implausible::Weights { .. }));
        assert!(matches!(refused(|r| r.hypotheses[1].weight = -r.hypotheses[1].weight), Implausible::Weights { .. }));
        assert!(matches!(
            refused(|r| r.hypotheses[1].covariance[5] = 0.0),
            Implausible::Covariance { hypothesis: 1, cause } if cause.row == 2
        ));
        // At 5 m/s the constant has most, at 40 m/s the air.
        assert!(matches!(
            refused(|r| r.hypotheses.iter_mut().for_each(|h| h.mean[0] = 7.0)),
            Implausible::Resistance { speed_mps: 5.0, .. }
        ));
        assert!(matches!(
            refused(|r| r.hypotheses.iter_mut().for_each(|h| h.mean[2] = -0.1)),
            Implausible::Resistance { speed_mps: 40.0, .. }
        ));
    }

    #[test]
    fn a_coefficient_that_is_far_off_is_believed_where_the_resistance_is_not() {
        // Of a freight wagon, described as a fast train.
        let mut record = learned().to_record();
        record.hypotheses.iter_mut().for_each(|held| held.mean = [2.57, 0.63, 0.18]);
        assert_eq!(Vehicle::from_record(&record, &DAVIS).map(|vehicle| vehicle.to_record()), Ok(record));
    }
}
