//! How well any unbiased estimator can know the resistance from these readings: the Cramér-Rao bound.
//!
//! In: the true motion at the samples of a run, and what the sensors are worth. Out: Fisher information of r0, r1, r2.
//!
//! ```text
//! dv/dt = u - r0 - r1 v - r2 v² - g          φ = ∂(s, v)/∂(s0, v0, r0, r1, r2, gain) along the true motion
//! dφ_s/dt = φ_v,  dφ_v/dt = -(r1 + 2 r2 v) φ_v - (0, 0, 1, v, v², -u)
//! I = Σ φᵀ R⁻¹ φ over the samples of a stretch, s0 and v0 of each stretch eliminated (Schur complement)
//! ```
//!
//! A stretch is consecutive intervals in which the effort is known: zero while coasting, or measured. A speed in whole
//! km/h counts as one with normal noise of quantum/√12. That the gradient changes with an error of the location is left
//! out: 4 m move it by nothing. The gain of a measured effort is a nuisance of each run with the prior of the
//! configuration.

use nalgebra::{Matrix2, Matrix3, Matrix3x1, SMatrix, SVector};
use rundown_truth::sensors::{Sample, Sensors, SpeedReading, TruthSample};

/// s0, v0, r0, r1, r2, gain.
const SIZE: usize = 6;
const STEP_S: f64 = 0.5;
/// Slower trains stand, m/s.
const STANDING_MPS: f64 = 1e-6;
/// A mean effort below this is that of an interval of coasting, N/kg.
const NO_EFFORT_N_PER_KG: f64 = 1e-12;

type Jacobian = SMatrix<f64, 2, SIZE>;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Known {
    /// Where it is zero: while coasting.
    Coasting,
    /// Everywhere but at standstill, up to a constant gain of this standard deviation.
    Measured { gain_sd: f64 },
}

/// What the readings are worth, as variances in m² and (m/s)².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Worth {
    pub location: f64,
    pub speed: f64,
}

impl Worth {
    /// Of these sensors. Slow noise of the location counts as white: the bound is then too low.
    pub fn of(sensors: &Sensors) -> Self {
        let quantum_kmh: f64 = match sensors.speed {
            SpeedReading::Exact => 0.0,
            SpeedReading::Rounded | SpeedReading::Truncated => sensors.speed_quantum_kmh,
        };
        let kmh2 = quantum_kmh.powi(2) / 12.0 + sensors.speed_noise_kmh.powi(2);
        let walk_m = sensors.location_walk.map_or(0.0, |walk| walk.sd_m);
        Self {
            location: (sensors.location_noise_m.powi(2) + walk_m.powi(2)).max(1e-12),
            speed: (kmh2 / 3.6_f64.powi(2)).max(1e-12),
        }
    }
}

pub fn information(
    truth: &[TruthSample],
    samples: &[Sample],
    davis: [f64; 3],
    worth: Worth,
    known: Known,
) -> Matrix3<f64> {
    // Of r0, r1, r2 and the gain.
    let mut of_run = SMatrix::<f64, 4, 4>::zeros();
    if let Known::Measured { gain_sd } = known {
        of_run[(3, 3)] = gain_sd.powi(-2);
    }
    let mut stretch: Option<KnownStretch> = None;
    for index in 1..truth.len().min(samples.len()) {
        let (before, now) = (&truth[index - 1], &truth[index]);
        let moves = before.speed_mps > STANDING_MPS && now.speed_mps > STANDING_MPS;
        let is_known = moves
            && match known {
                Known::Coasting => now.mean_effort_n_per_kg.abs() < NO_EFFORT_N_PER_KG,
                Known::Measured { .. } => true,
            };
        if !is_known {
            of_run += stretch.take().map_or_else(SMatrix::zeros, |s| s.information());
            continue;
        }
        let open = stretch.get_or_insert_with(|| KnownStretch::begin(&samples[index - 1], worth));
        open.advance(before, now, davis);
        open.read(&samples[index], worth);
    }
    of_run += stretch.map_or_else(SMatrix::zeros, |s| s.information());
    let davis_part = of_run.fixed_view::<3, 3>(0, 0).into_owned();
    let cross: Matrix3x1<f64> = of_run.fixed_view::<3, 1>(0, 3).into_owned();
    match of_run[(3, 3)] {
        gain if gain > 0.0 => davis_part - cross * cross.transpose() / gain,
        _ => davis_part,
    }
}

struct KnownStretch {
    sensitivity: Jacobian,
    information: SMatrix<f64, SIZE, SIZE>,
}

impl KnownStretch {
    fn begin(sample: &Sample, worth: Worth) -> Self {
        let mut begun = Self { sensitivity: Jacobian::identity(), information: SMatrix::zeros() };
        begun.read(sample, worth);
        begun
    }

    fn advance(&mut self, before: &TruthSample, now: &TruthSample, davis: [f64; 3]) {
        let dt_s = now.time_s - before.time_s;
        let steps = (dt_s / STEP_S).ceil().max(1.0);
        let h = dt_s / steps;
        for step in 0..steps as usize {
            let part = (step as f64 + 0.5) / steps;
            let v = before.speed_mps + part * (now.speed_mps - before.speed_mps);
            let damping = davis[1] + 2.0 * davis[2] * v;
            let mut drive = SVector::<f64, SIZE>::zeros();
            (drive[2], drive[3], drive[4]) = (1.0, v, v * v);
            drive[5] = -now.mean_effort_n_per_kg;
            let speed = self.sensitivity.row(1).into_owned();
            // Implicit midpoint: the equation is linear in φ.
            let next = (speed * (1.0 - 0.5 * h * damping) - h * drive.transpose()) / (1.0 + 0.5 * h * damping);
            let location = self.sensitivity.row(0) + 0.5 * h * (speed + next);
            self.sensitivity.set_row(0, &location);
            self.sensitivity.set_row(1, &next);
        }
    }

    fn read(&mut self, sample: &Sample, worth: Worth) {
        let readings = [(sample.location_m.is_some(), worth.location), (sample.speed_kmh.is_some(), worth.speed)];
        for (row, (is_there, variance)) in readings.into_iter().enumerate() {
            if is_there {
                let h = self.sensitivity.row(row);
                self.information += h.transpose() * h / variance;
            }
        }
    }

    /// Of r0, r1, r2 and the gain; nothing where location and speed of the beginning stay unknown.
    fn information(&self) -> SMatrix<f64, 4, 4> {
        let begin: Matrix2<f64> = self.information.fixed_view::<2, 2>(0, 0).into_owned();
        let cross = self.information.fixed_view::<2, 4>(0, 2).into_owned();
        let rest = self.information.fixed_view::<4, 4>(2, 2).into_owned();
        begin.try_inverse().map_or_else(SMatrix::zeros, |inverse| rest - cross.transpose() * inverse * cross)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rundown_truth::regime::Regime;

    /// A train that coasts against a constant resistance: v = v0 - r0 t, s = s0 + v0 t - r0 t²/2.
    fn coasting(count: usize, effort_n_per_kg: f64) -> (Vec<TruthSample>, Vec<Sample>) {
        let truth = (0..count).map(|i| {
            let t = 10.0 * i as f64;
            TruthSample {
                time_s: t,
                location_m: 40.0 * t - 0.015 * t * t,
                speed_mps: 40.0 - 0.03 * t,
                effort_n_per_kg,
                mean_effort_n_per_kg: effort_n_per_kg,
                reported_n_per_kg: effort_n_per_kg,
                regime: Regime::Coast,
                resistance_n_per_kg: 0.03,
                extra_n_per_kg: 0.0,
                gravity_n_per_kg: 0.0,
                temperature_c: 10.0,
            }
        });
        let samples = (0..count).map(|i| Sample {
            time_s: 10.0 * i as f64,
            location_m: Some(0.0),
            speed_kmh: Some(0.0),
            effort_n_per_kg,
            temperature_c: 10.0,
        });
        (truth.collect(), samples.collect())
    }

    #[test]
    fn the_slope_of_a_straight_line_is_known_as_well_as_least_squares_say() {
        let (truth, samples) = coasting(11, 0.0);
        // The location is worth nothing: what is left is a line through 11 speeds.
        let worth = Worth { location: 1e12, speed: 0.04 };
        let found = information(&truth, &samples, [0.03, 0.0, 0.0], worth, Known::Coasting);
        let spread: f64 = (0..11).map(|i| (10.0 * f64::from(i) - 50.0).powi(2)).sum();
        assert!((found[(0, 0)] / (spread / 0.04) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn only_coasting_teaches_where_the_effort_is_unknown() {
        let (truth, samples) = coasting(11, 0.1);
        let worth = Worth::of(&Sensors::default());
        let davis = [0.03, 0.0, 0.0];
        let none = information(&truth, &samples, davis, worth, Known::Coasting);
        assert_eq!(none, Matrix3::zeros());
        let known = |gain_sd| information(&truth, &samples, davis, worth, Known::Measured { gain_sd });
        // A constant effort of unknown gain is confounded with r0.
        assert!(known(1e-9)[(0, 0)] > 100.0 * known(0.1)[(0, 0)]);
    }

    #[test]
    fn rounding_is_noise_of_its_own() {
        let worth = Worth::of(&Sensors::default());
        assert!((worth.speed.sqrt() - 1.0 / 3.6 / 12.0_f64.sqrt()).abs() < 1e-12);
        assert_eq!(worth.location, 16.0);
    }
}
