//! What all runs say together, through one pair of eyes: in as few numbers as one run.

use super::moments::Moments;
use super::view::Seen;
use super::visible;

/// Where the paper finds r0, N/kg (section 4.2).
pub const R0_BAND: std::ops::RangeInclusive<f64> = 0.0072..=0.00738;
/// Speed that the line permits, km/h.
pub const LIMIT_KMH: f64 = 140.0;

/// Statistics over runs, and over samples where the name says so.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tallies {
    pub runs: u64,
    pub davis_samples: [Moments; 3],
    pub davis: [Moments; 3],
    /// Runs in which a coefficient fell below zero.
    pub negative_runs: u64,
    /// Samples whose r0 lies in [`R0_BAND`] as it would be printed.
    pub r0_in_band: u64,
    pub cruise_kmh: Moments,
    /// Plain medians.
    pub plain_cruise_kmh: Moments,
    /// Runs whose cruise speed is above the limit of 140 km/h.
    pub cruise_over_limit: u64,
    pub coast_s: Moments,
    pub brake_s: Moments,
    pub shares: [Moments; 4],
    pub power_kw: Moments,
    pub max_power_kw: Moments,
    /// Red crosses of Fig. 9, kW.
    pub cross_kw: Moments,
    pub coast_mps2: Moments,
    /// Mean brake rate of each run in each ATB-EG step, m/s².
    pub brake_steps: [Moments; 5],
    /// Runs whose brake begins visibly gentler than it ends, of those of which both are known.
    pub gentle_first: [u64; 2],
    /// By how much it ends harder, m/s².
    pub brake_gain_mps2: Moments,
    /// Runs with power in both clouds, of those with power on both sides of [`super::view::CLOUDS_KMH`].
    pub in_both_clouds: [u64; 2],
    /// Intervals of each run that say something of the largest tractive effort.
    pub effort_samples: Moments,
    /// Square of r(100 km/h) at the end of each run less the true one, as a share of that; as it was: of the described
    /// one.
    pub resistance_error2: Moments,
    /// Share of the time in which the resistance was learned.
    pub learned_share: Moments,
}

impl Tallies {
    pub fn add(&mut self, view: &Seen) {
        let (outcome, points) = (&view.outcome, &view.points);
        self.runs += 1;
        for davis in &points.davis {
            for (moments, value) in self.davis_samples.iter_mut().zip(davis) {
                moments.add(*value);
            }
        }
        let half = 0.5 * visible::R0.least;
        let band = R0_BAND.start() - half..=R0_BAND.end() + half;
        let is_in_band = |davis: &&[f64; 3]| band.contains(&davis[0]);
        self.r0_in_band += points.davis.iter().filter(is_in_band).count() as u64;
        if outcome.plain_cruise_kmh.is_some_and(|kmh| kmh > LIMIT_KMH) {
            self.cruise_over_limit += 1;
        }
        let is_negative = |davis: &[f64; 3]| davis.iter().any(|value| *value < 0.0);
        if points.davis.iter().any(is_negative) {
            self.negative_runs += 1;
        }
        for (moments, value) in self.davis.iter_mut().zip(outcome.davis) {
            moments.add(value);
        }
        for (moments, value) in [
            (&mut self.cruise_kmh, outcome.cruise_kmh),
            (&mut self.plain_cruise_kmh, outcome.plain_cruise_kmh),
            (&mut self.coast_s, outcome.coast_s),
            (&mut self.brake_s, outcome.brake_s),
            (&mut self.power_kw, outcome.power_kw),
            (&mut self.max_power_kw, outcome.max_power_kw),
            (&mut self.cross_kw, outcome.cross_kw),
            (&mut self.coast_mps2, outcome.coast_mps2),
            (&mut self.effort_samples, outcome.effort_samples),
            (&mut self.learned_share, outcome.learned_share),
        ] {
            value.into_iter().for_each(|value| moments.add(value));
        }
        for (moments, share) in self.shares.iter_mut().zip(outcome.shares.into_iter().flatten()) {
            moments.add(share);
        }
        if let Some([first, last]) = points.first_and_last_brake_mps2 {
            self.brake_gain_mps2.add(last - first);
            self.gentle_first[0] += u64::from(visible::RATE.sees(last - first));
            self.gentle_first[1] += 1;
        }
        if let Some(is_in_both) = outcome.in_both_clouds {
            self.in_both_clouds[0] += u64::from(is_in_both);
            self.in_both_clouds[1] += 1;
        }
        for (moments, rate_mps2) in self.brake_steps.iter_mut().zip(outcome.brake_steps_mps2) {
            rate_mps2.into_iter().for_each(|value| moments.add(value));
        }
    }
}
