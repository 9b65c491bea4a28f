//! Two-level memory: the vehicle's resistance, carried from run to run, and each run's deviation from it.
//!
//! In: what one run said about its train. Out: the vehicle's Davis coefficients, and the belief with which the next run
//! begins.
//!
//! A run's train is the vehicle plus a deviation of that day, δ. It has the shape of wind and load: with a headwind w ~
//! N(0, σ²) and σ = s x `wind_sd_mps`,
//!
//! ```text
//! r2 (v + w)² = r2 v² + 2 r2 w v + r2 w²        δ = (r2 w², 2 r2 w, load share of r2)
//! mean of δ = (r2 σ², 0, 0)                     variances of δ = (2 r2² σ⁴, 4 r2² σ², s² load²)
//! ```
//!
//! The mean is not zero: wind from either side adds to r0. Left out, it would stay in the vehicle, +1.2 % of r at 20
//! km/h for σ = 2 m/s.
//!
//! How windy a line is, is not known beforehand, and both wrong answers hurt: taken too calm, the first windy run is
//! believed to be the vehicle; taken too windy, 67 calm runs teach little to the next one. So a few scales s are
//! carried side by side, each with its own vehicle, weighted by how well it foresaw the runs (Bayesian model
//! averaging), in fixed memory.
//!
//! Everything is in shares of the manufacturer's coefficients (1 = as described), which keeps the numbers near one.
//! What a run said is a normal likelihood: the difference of information between the end and the beginning of its
//! filter.

mod by_gain;
mod record;

pub use by_gain::{ByGain, beside_gain};
pub use record::{HypothesisRecord, Implausible, LEAST_SHARE, MOST_SHARE, VehicleRecord};

use crate::Real;
use crate::extremes::Extremes;
use crate::filter::gaussian::Gaussian;
use crate::model::resistance::Davis;
use crate::tick::bounds::settings;
use crate::tick::effort_reading::Column;
use crate::tick::foresight::{Foresight, Trust};
use crate::tick::truncation::SpeedOffset;
use by_gain::Said;
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// Scales of the run-to-run deviation that are carried side by side.
pub const SCALES: [Real; 4] = [0.0, 0.3, 0.7, 1.5];
/// What is believed of them before the first run.
const SCALE_WEIGHTS: [Real; 4] = [0.4, 0.3, 0.2, 0.1];
/// By how much more each counts in the reported doubt of a vehicle. The estimate is best where most winds are taken for
/// gentle; but what a windy first run taught is off by its wind, and nothing says so before the second one. With these
/// the scale before the first run is 1 in the root mean square, the wind that is set.
const SCALE_DOUBTS: [Real; 4] = [0.5, 2.0 / 3.0, 1.0, 4.0];
const EVEN: [Real; 4] = [1.0; 4];

/// Standard deviation of r(v) that is common to all coasts of short hops, share: a coast of 10 to 40 s that begins or
/// ends with a second of something else is off by several per cent, all of a driver's by the same, and their scatter
/// does not say so. Judged by what other simulators' trams and suburban trains were off by (docs/limits.md).
const SHORT_HOPS_SD: Real = 0.05;
/// The same at least where speeds are finer than whole km/h, for which a second of something else is visible. Judged by
/// trains of a third simulator (docs/measured.md).
const FINE_HOPS_SD: Real = 0.015;
/// So many of these coasts may have been none, more where they scatter, and be off by all of r(v): a speed that a
/// regulator or a notch holds falls for 7 s like a coast now and then. Where nobody coasts these few are all that there
/// is; drivers who coast do so several times a run.
const FALSE_COASTS: Real = 3.0;
/// Runs over which the share of short hops is a mean.
const RUNS_OF_HOPS: u32 = 32;
/// Share of what is known that is forgotten where it came from readings that were not what they seemed.
const MISREAD: Real = 0.8;

settings! {
    /// What may differ between vehicles, and between runs of one vehicle.
    MemoryConfig in "memory" {
        /// Standard deviation of a vehicle's whole resistance from its description, share.
        vehicle_scale_sd: Real = 0.15, 0.0 to 2.0;
        /// Standard deviation of each coefficient beyond that, share.
        vehicle_shape_sd: Real = 0.15, 1e-3 to 2.0;
        /// Run-to-run standard deviation of the wind along the line at scale 1, m/s.
        wind_sd_mps: Real = 2.0, 0.0 to 20.0;
        /// Run-to-run standard deviation of the quadratic term by load at scale 1, share.
        load_sd: Real = 0.02, 0.0 to 1.0;
        /// Standard deviation by which the vehicle itself changes from one run to the next, share.
        drift_sd: Real = 5e-4, 0.0 to 0.1;
    }
}

impl MemoryConfig {
    /// A vehicle before its first run, in shares.
    fn described(&self) -> Gaussian<3> {
        let common = self.vehicle_scale_sd * self.vehicle_scale_sd;
        let own = self.vehicle_shape_sd * self.vehicle_shape_sd;
        let covariance = Matrix3::from_element(common) + Matrix3::from_diagonal_element(own);
        Gaussian { mean: Vector3::from_element(1.0), covariance }
    }

    /// A run's deviation at a scale, in shares.
    fn deviation(&self, nominal: &Davis, scale: Real) -> Gaussian<3> {
        let wind_sd_mps = scale * self.wind_sd_mps;
        let constant = nominal.r2 * wind_sd_mps * wind_sd_mps / guarded(nominal.r0);
        let linear = 2.0 * nominal.r2 * wind_sd_mps / guarded(nominal.r1);
        let sd = [core::f64::consts::SQRT_2 * constant, linear, scale * self.load_sd];
        Gaussian::independent([constant, 0.0, 0.0], sd)
    }
}

/// A coefficient by which shares are taken; a description may state 0 for r1 or r2, and a share of 0 says nothing.
fn guarded(coefficient: Real) -> Real {
    coefficient.at_least(1e-9)
}

/// One scale of the deviation with its vehicle, in shares of the manufacturer's coefficients.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Hypothesis {
    scale: Real,
    weight: Real,
    vehicle: Gaussian<3>,
}

/// What is known of the vehicle. Survives the run; the only thing that is persisted of the resistance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Vehicle {
    nominal: Davis,
    hypotheses: [Hypothesis; SCALES.len()],
    runs: u32,
    trust: Trust,
    /// Of its effort column.
    #[serde(default)]
    pub(crate) column: Column,
    /// What its resistance and the gain of that column have in common.
    #[serde(default)]
    pub(crate) by_gain: ByGain,
    /// Of its speed readings.
    #[serde(default)]
    pub(crate) offset: SpeedOffset,
    /// Share of what it was taught that short hops taught, of late; below zero where the speeds of the last run were
    /// finer than whole km/h.
    #[serde(default)]
    pub(crate) hops_share: f32,
}

impl Vehicle {
    /// A vehicle as its manufacturer describes it.
    pub fn new(config: &MemoryConfig, nominal: Davis) -> Self {
        Self::with_prior(nominal, config.described())
    }

    /// A vehicle with independent standard deviations of its coefficients (SI units), as Table 1 states them.
    pub fn independent(nominal: Davis, sd: [Real; 3]) -> Self {
        let unit = shares(&nominal);
        let relative = [sd[0] / unit[0], sd[1] / unit[1], sd[2] / unit[2]];
        Self::with_prior(nominal, Gaussian::independent([1.0; 3], relative))
    }

    fn with_prior(nominal: Davis, vehicle: Gaussian<3>) -> Self {
        let hypothesis = |(scale, weight)| Hypothesis { scale, weight, vehicle };
        let mut hypotheses = [hypothesis((0.0, 0.0)); SCALES.len()];
        for (slot, entry) in hypotheses.iter_mut().zip(SCALES.into_iter().zip(SCALE_WEIGHTS)) {
            *slot = hypothesis(entry);
        }
        Self {
            nominal,
            hypotheses,
            runs: 0,
            trust: Trust::NONE,
            column: Column::default(),
            by_gain: ByGain::default(),
            offset: SpeedOffset::default(),
            hops_share: 0.0,
        }
    }

    /// The vehicle's Davis coefficients, N/kg, N/(kg m/s), N/(kg (m/s)²), with all doubt that is known.
    pub fn davis(&self) -> Gaussian<3> {
        let mut shares = self.mixture(None);
        self.widen(&mut shares, 0.0);
        self.in_si(&shares)
    }

    /// What is believed of the train of the next run: the vehicle and the deviation of a day.
    pub fn next_run(&self, config: &MemoryConfig) -> Gaussian<3> {
        self.in_si(&self.mixture(Some(config)))
    }

    /// The same beside the gain of its effort column, of which nothing more is known before the first run than
    /// `gain_sd`.
    pub fn constants(&self, config: &MemoryConfig, gain_sd: Real) -> Gaussian<4> {
        let (gain, variance) = self.column.next_gain(gain_sd);
        let common = self.by_gain.slope().component_mul(&shares(&self.nominal)) * self.column.gain_variance();
        beside_gain(&self.next_run(config), (gain, variance), &common)
    }

    /// Number of runs that said something.
    pub fn runs(&self) -> u32 {
        self.runs
    }

    /// Standard deviation of the wind from run to run as learned so far, m/s.
    pub fn wind_sd_mps(&self, config: &MemoryConfig) -> Real {
        let variance: Real =
            self.hypotheses.iter().map(|hypothesis| hypothesis.weight * hypothesis.scale * hypothesis.scale).sum();
        config.wind_sd_mps * crate::roots::square_root(variance)
    }

    /// What is known of its effort column.
    pub fn column(&self) -> Column {
        self.column
    }

    /// What is known of true less read speed.
    pub fn speed_offset(&self) -> SpeedOffset {
        self.offset
    }

    /// Share of what it was taught that short hops taught, of late.
    pub fn hops_share(&self) -> Real {
        self.hops_share.abs().into()
    }

    /// Standard deviation of r(v) for that, share.
    pub fn hops_sd(&self) -> Real {
        self.hops_sd_of(self.hops_share.into()).abs()
    }

    fn hops_sd_of(&self, share: Real) -> Real {
        let sd = if share.is_sign_negative() {
            (FALSE_COASTS * self.trust.of_one()).at_least(FINE_HOPS_SD)
        } else {
            SHORT_HOPS_SD
        };
        sd * share
    }

    /// How far this may be trusted, by how it foresaw coasts.
    pub fn trust(&self) -> &Trust {
        &self.trust
    }

    /// Gives a belief of the resistance, in any units, the doubt that no number of coasts averages away: that of coasts
    /// that scatter, see [`Trust::widen`], and that of short hops. Of a vehicle before its first run, `run_share` of
    /// what that run has taught so far came from them. In its place: the stack has no room for another one.
    pub fn widen(&self, found: &mut Gaussian<3>, run_share: Real) {
        self.trust.widen(found);
        let share = if self.runs == 0 { run_share } else { self.hops_share.into() };
        let sd = self.hops_sd_of(share);
        // Two rows at once are a call of nalgebra, which the flash has no room for.
        for row in 0..3 {
            for column in 0..3 {
                found.covariance[(row, column)] += sd * sd * found.mean[row] * found.mean[column];
            }
        }
    }

    /// Takes up what a run said: its belief at the beginning and at the end, and how its coasts had been foreseen. A
    /// run that learned nothing changes nothing.
    ///
    /// What scatters more than it should says less. What the doubt of the track has in it is shared by the runs: so
    /// much of what is known is forgotten first, and no number of runs says more than the track allows. `column`: what
    /// is known of the effort column by now.
    pub fn learn(
        &mut self,
        config: &MemoryConfig,
        [begin, end]: [&Gaussian<4>; 2],
        column: Column,
        run: &Foresight,
        hops_share: Real,
    ) {
        if begin == end {
            return;
        }
        let [(gain, _), _] = column.next_run();
        let gain = Real::from(gain);
        // One after the other, for the stack's sake.
        if let Some(said) = self.said(begin, end, gain) {
            self.forget(config, &said.information, run.track_share());
            self.take_up(config, &said, gain - begin.mean[3], run);
            let among = self.runs.clamp(1, RUNS_OF_HOPS) as f32;
            let before = self.hops_share.abs();
            let run = hops_share as f32;
            self.hops_share = (before + (run.abs() - before) / among).copysign(run);
        }
    }

    /// What was learned so far came from readings that are read otherwise from now on: it is kept as what one run or so
    /// says, with the interval of that.
    pub(crate) fn doubt_readings(&mut self, config: &MemoryConfig) {
        self.forget(config, &Matrix3::from_diagonal_element(Real::MAX), MISREAD);
    }

    /// Forgets a share of what is known beyond the description; for a run that says little, no more than it says.
    #[inline(never)]
    fn forget(&mut self, config: &MemoryConfig, information: &Matrix3<Real>, share: Real) {
        if share > 0.0 {
            for hypothesis in &mut self.hypotheses {
                // Where it cannot be inverted it stays as it is.
                let _forgot = hypothesis.forget(share, information, &config.described());
            }
        }
    }

    /// `moved`: by how much the gain is another one than when the run began.
    #[inline(never)]
    fn take_up(&mut self, config: &MemoryConfig, said: &Said, moved: Real, run: &Foresight) {
        let mut trust = self.trust;
        trust.add(&run.trust);
        if !trust.is_sound() {
            trust = Trust::NONE;
        }
        let said = said.weighed(1.0 / trust.inflation());
        let mut drift = Matrix3::from_diagonal_element(config.drift_sd * config.drift_sd);
        let mut slope = self.by_gain.slope();
        // The gain drifts between runs, and what was learned was learned under the one before.
        let (kept, variance) = self.column.kept();
        if variance > 0.0 {
            drift += slope * slope.transpose() * (variance * (1.0 - kept));
            slope *= kept;
        }
        let mut next = *self;
        let mut exponents = [0.0; SCALES.len()];
        let mut slopes = [slope; SCALES.len()];
        for ((hypothesis, exponent), slope) in next.hypotheses.iter_mut().zip(&mut exponents).zip(&mut slopes) {
            hypothesis.vehicle.covariance += drift;
            hypothesis.vehicle.mean += *slope * moved;
            let deviation = config.deviation(&self.nominal, hypothesis.scale);
            let Some(found) = hypothesis.learn(&deviation, &said, slope) else {
                return;
            };
            *exponent = found;
        }
        let most = exponents.iter().copied().fold(Real::MIN, Extremes::at_least);
        let mut largest = 0.0;
        for (hypothesis, exponent) in next.hypotheses.iter_mut().zip(exponents) {
            hypothesis.weight *= libm::exp(exponent - most);
            largest = hypothesis.weight.at_least(largest);
        }
        let mut sum = 0.0;
        for hypothesis in &mut next.hypotheses {
            // A scale is never given up for good: winds change with the seasons.
            hypothesis.weight = (hypothesis.weight / largest).at_least(1e-3);
            sum += hypothesis.weight;
        }
        let mut slope = Vector3::zeros();
        for (hypothesis, own) in next.hypotheses.iter_mut().zip(&slopes) {
            hypothesis.weight /= sum;
            slope += own * hypothesis.weight;
        }
        next.by_gain = ByGain::of(&slope);
        next.runs = next.runs.saturating_add(1);
        next.trust = trust;
        let is_finite = |one: &Hypothesis| one.weight.is_finite() && one.vehicle.is_finite();
        if next.by_gain.is_sound() && next.hypotheses.iter().all(is_finite) {
            *self = next;
        }
    }

    /// The paper has one level: what the run ended with is the vehicle.
    pub fn replace(&mut self, end: &Gaussian<3>) {
        let mut vehicle = self.in_shares(end);
        // The change of units rounds the two halves differently.
        vehicle.covariance = (vehicle.covariance + vehicle.covariance.transpose()) * 0.5;
        for hypothesis in &mut self.hypotheses {
            hypothesis.vehicle = vehicle;
        }
        self.trust = Trust::NONE;
        self.by_gain = ByGain::default();
        self.runs = self.runs.saturating_add(1);
    }

    /// One normal distribution with the mean and the covariance of the weighted hypotheses, and what the gain of the
    /// column adds. With the settings: of the next run; else its covariance is by the doubted weights.
    fn mixture(&self, of_run: Option<&MemoryConfig>) -> Gaussian<3> {
        let of = |hypothesis: &Hypothesis| match of_run {
            Some(config) => hypothesis.of_run(&config.deviation(&self.nominal, hypothesis.scale)),
            None => hypothesis.vehicle,
        };
        let mean: Vector3<Real> =
            self.hypotheses.iter().map(|hypothesis| of(hypothesis).mean * hypothesis.weight).sum();
        let doubts = if of_run.is_some() { &EVEN } else { &SCALE_DOUBTS };
        let mut covariance = Matrix3::zeros();
        let mut sum = 0.0;
        for (hypothesis, doubt) in self.hypotheses.iter().zip(doubts) {
            let one = of(hypothesis);
            let apart = one.mean - mean;
            let weight = hypothesis.weight * doubt;
            covariance += (one.covariance + apart * apart.transpose()) * weight;
            sum += weight;
        }
        if of_run.is_none() {
            covariance /= sum;
        }
        let variance = self.column.gain_variance();
        if variance > 0.0 {
            let slope = self.by_gain.slope();
            covariance += slope * slope.transpose() * variance;
        }
        Gaussian { mean, covariance }
    }

    fn in_si(&self, relative: &Gaussian<3>) -> Gaussian<3> {
        let unit = Matrix3::from_diagonal(&shares(&self.nominal));
        Gaussian { mean: unit * relative.mean, covariance: unit * relative.covariance * unit }
    }

    fn in_shares(&self, si: &Gaussian<3>) -> Gaussian<3> {
        let unit = Matrix3::from_diagonal(&shares(&self.nominal).map(|u| 1.0 / u));
        Gaussian { mean: unit * si.mean, covariance: unit * si.covariance * unit }
    }
}

/// Once in the flash, for all that need it.
#[inline(never)]
fn inverse(matrix: &Matrix3<Real>) -> Option<Matrix3<Real>> {
    matrix.try_inverse()
}

/// What is one share of each coefficient.
fn shares(nominal: &Davis) -> Vector3<Real> {
    Vector3::new(nominal.r0, nominal.r1, nominal.r2).map(guarded)
}

impl Hypothesis {
    #[inline(never)]
    fn forget(&mut self, share: Real, run: &Matrix3<Real>, described: &Gaussian<3>) -> Option<()> {
        let (prior, known) = (inverse(&described.covariance)?, inverse(&self.vehicle.covariance)?);
        let gained = known.trace() - prior.trace();
        let share = if gained > 0.0 { share.at_most(run.trace() / gained).at_least(0.0) } else { 0.0 };
        let covariance = inverse(&(prior * share + known * (1.0 - share)))?;
        let vector = prior * described.mean * share + known * self.vehicle.mean * (1.0 - share);
        self.vehicle = Gaussian { mean: covariance * vector, covariance: (covariance + covariance.transpose()) * 0.5 };
        Some(())
    }

    /// The train of a run: the vehicle and its deviation of the day.
    fn of_run(&self, deviation: &Gaussian<3>) -> Gaussian<3> {
        Gaussian {
            mean: self.vehicle.mean + deviation.mean,
            covariance: self.vehicle.covariance + deviation.covariance,
        }
    }

    /// Takes up a likelihood exp(-½ rᵀΛr + ηᵀr) of a run whose train is the vehicle plus a deviation. `slope`: how the
    /// vehicle moves with the gain of the column. How well the run was foreseen is the new weight over the old one,
    /// times e to the power of what is returned.
    fn learn(&mut self, deviation: &Gaussian<3>, said: &Said, slope: &mut Vector3<Real>) -> Option<Real> {
        let Said { information, vector, by_gain } = said;
        let one = Matrix3::identity();
        let of_run = self.of_run(deviation);
        let mean = of_run.mean;
        let eta = vector - information * mean;
        let foreseen = one + information * of_run.covariance;
        let gain = of_run.covariance * inverse(&foreseen)?;
        self.weight /= crate::roots::square_root(foreseen.determinant().at_least(Real::MIN_POSITIVE));
        let exponent = 0.5 * eta.dot(&(gain * eta)) + vector.dot(&mean) - 0.5 * mean.dot(&(information * mean));

        // What is left of the run's information once its own deviation is integrated out.
        let blurred = inverse(&(one + information * deviation.covariance))?;
        // Without a column there is nothing to move, and each product takes the board its time.
        let none = Vector3::zeros();
        let falls = (*by_gain != none || *slope != none).then(|| -by_gain - information * *slope);
        let information = blurred * information;
        let covariance = self.vehicle.covariance * inverse(&(one + information * self.vehicle.covariance))?;
        if let Some(falls) = falls {
            *slope += covariance * (blurred * falls);
        }
        self.vehicle = Gaussian {
            mean: self.vehicle.mean + covariance * (blurred * eta),
            covariance: (covariance + covariance.transpose()) * 0.5,
        };
        Some(exponent)
    }
}

#[cfg(test)]
mod tests;
