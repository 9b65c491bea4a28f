//! Whether the recorder cuts its speeds off: the distance by location against that by speed.
//!
//! In: the readings of each tick, the speed as it was read. Out: what a run, and over the runs a vehicle, says of true
//! less read speed.
//!
//! A speed that is rounded to its step is read right in the mean, one that is cut off is read half a step too low. With
//! a wheel that is not as believed and a speed that is older than the location,
//!
//! ```text
//! location - ∫ read speed dt = c + κ ∫ read speed dt + o t + τ read speed + noise
//! ```
//!
//! with t while the train moves. A small Kalman filter follows (c, κ, o, τ). The steps of the speed make c a walk: of a
//! speed that is held all readings are off by the same. κ and o part where the speed changes, so a run says little;
//! what several say is pooled with how they scatter.
//!
//! A step of the chainage would say the same in each run. Where a location is suddenly far from what the others
//! foresaw, c begins again; so it does after a pause of the speed, and where a train starts or stops between two
//! readings that are far apart. What is known of the rest stays.

use crate::Real;
use crate::extremes::Extremes;
use crate::plain::plain;
use crate::tick::plausibility::Judged;
use crate::tick::sensor::{Rounding, SensorConfig};
use crate::tick::snapshot::{InPlace as _, in_place};
use serde::{Deserialize, Serialize};

const C: usize = 0;
const SCALE: usize = 1;
const OFFSET: usize = 2;
const AGE: usize = 3;

/// Standard deviations before a run: of κ, of o in steps of the speed, and of τ, s.
const SCALE_SD: f32 = 0.04;
const OFFSET_STEPS: f32 = 1.0;
const AGE_SD_S: f32 = 2.0;
/// Time between two locations that are compared, s: errors of receivers last.
const SPACING_S: Real = 9.5;
/// Longest time between two speeds over which a distance is known, s.
const LONGEST_S: f32 = 30.0;
/// Share of a change of the change of speed by which the mean speed between two readings differs from that of the two:
/// wherever between readings an acceleration changes, the trapezium misses dt²/12 of the change in the mean, always by
/// the same sign where trains brake ...
const BENT: f32 = 1.0 / 12.0;
/// ... and the share by which it may do so.
const UNEVEN: f32 = 0.15;
/// Beyond, the distance of a start or a stop is not known, m: the train moved for a part of the time only.
const LOST_M: f32 = 3.0;
/// Growth of the error of described locations, m²/s.
const CHAINAGE: f32 = 0.25;
/// A location's errors last for about a minute: white noise of so many times their variance says as little, (1 + ρ) /
/// (1 - ρ) with ρ = exp(-10/60).
const LASTING: f32 = 12.0;
/// Locations by which the described noise counts, and least noise, m.
const DESCRIBED: f32 = 2.0;
const LEAST_NOISE_M: f32 = 10.0;
/// A location that is further from what is expected than so many usual misses: the chainage has a step there, and c
/// begins again.
const STEP: f32 = 3.0;
/// Standard deviation of c before the first location, m.
const UNKNOWN_M: f32 = 1000.0;
/// Most that a run says of o, in units of one over the squared step.
const MOST_INFORMATION: f32 = 24.0;
/// Weight of older runs when a run is added: a recorder that was swapped is recognised some tens of runs later.
const REMEMBERED: f32 = 0.97;
/// Runs that are taken to have scattered as expected before the first one, and least share of the expected variance.
const EXPECTED_RUNS: f32 = 2.0;
const LEAST_SCATTER: f32 = 0.25;
/// Logarithm of the odds beyond which it is decided: 100 to 1, where both were as likely.
const DECIDED: f32 = 4.6;
/// Share of the step by which o may miss the half of it.
const NEAR_HALF: f32 = 0.12;
/// Half a step is decided where o is nearer to it than this share of the distance to zero.
const CLEARLY: f32 = 0.5;

in_place! {
    /// What is followed in a run.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Distances {
        /// Location that was compared last, m.
        location_m: Option<Real> = (None);
        /// When that was, s.
        compared_s: Real = (0.0);
        /// By how much it was ahead of the distance by speed, and that distance since, m.
        ahead_m: f32 = (0.0);
        run_m: f32 = (0.0);
        /// When a speed was read last, s, and what it was, m/s.
        read_s: Option<Real> = (None);
        speed_mps: f32 = (0.0);
        /// By how much it changed, m/s; infinite where the train moved for a part of the time only.
        change_mps: f32 = (0.0);
        /// For how long it has read the same, s.
        held_s: f32 = (0.0);
        /// c in m, κ, o in m/s, τ in s.
        mean: [f32; 4] = ([0.0; 4]);
        /// Number of locations that were compared, and sum of the squares by which they missed, m².
        missed: (f32, f32) = ((0.0, 0.0));
        covariance: [[f32; 4]; 4] = ([[0.0; 4]; 4]);
    }
}

/// What the runs of a vehicle said of o: sums over runs that each give o with an information, one over its variance.
/// Nothing is known of the default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SpeedOffset {
    /// Number of runs.
    pub(crate) runs: f32,
    /// Information, s²/m².
    pub(crate) information: f32,
    /// Information times o, s/m.
    pub(crate) vector: f32,
    /// Information times o².
    pub(crate) squares: f32,
}

plain! {
    struct SpeedOffset { runs, information, vector, squares }
}

impl SpeedOffset {
    /// o, true less read speed, m/s, with its standard deviation; none before the first run that says something.
    #[inline(never)]
    pub fn found(&self) -> Option<(f32, f32)> {
        // The root of double precision is in the flash already.
        let sd = crate::roots::square_root((self.scatter() / self.information).into()) as f32;
        (self.information > 0.0).then(|| (self.vector / self.information, sd))
    }

    /// Variance between the runs over what is expected. The expected one is on the safe side; few runs may agree by
    /// chance.
    fn scatter(&self) -> f32 {
        let squares = self.squares - self.vector * self.vector / self.information;
        ((EXPECTED_RUNS + squares) / (EXPECTED_RUNS + self.runs - 1.0)).at_least(LEAST_SCATTER)
    }

    /// The speeds are cut off, beyond doubt.
    #[inline(never)]
    pub fn is_truncated(&self, sensor: &SensorConfig) -> bool {
        let step_mps = sensor.speed_quantum_kmh as f32 / 3.6;
        let half = 0.5 * step_mps;
        self.found().is_some_and(|(found, sd)| {
            let off = (found - half).abs();
            // Logarithm of the odds of half a step against none.
            let odds = half * (found - 0.5 * half) / (sd * sd);
            odds > DECIDED && off < NEAR_HALF * step_mps + 2.0 * sd && off < CLEARLY * found
        })
    }

    /// Adds what a run said.
    #[inline(never)]
    pub(crate) fn add(&mut self, sensor: &SensorConfig, run: &Distances) {
        let step_mps = sensor.speed_quantum_kmh as f32 / 3.6;
        let Some((information, offset)) = run.said(step_mps) else {
            return;
        };
        let information = information.at_most(MOST_INFORMATION / (step_mps * step_mps));
        let sum = |before: f32, run: f32| REMEMBERED * before + run;
        let vector = information * offset;
        let next = Self {
            runs: sum(self.runs, 1.0),
            information: sum(self.information, information),
            vector: sum(self.vector, vector),
            squares: sum(self.squares, vector * offset),
        };
        *self = if next.is_sound() { next } else { Self::default() };
    }

    /// Numbers that sums over runs can be.
    pub(crate) fn is_sound(&self) -> bool {
        let sums = [self.runs, self.information, self.squares];
        self.vector.is_finite() && sums.iter().all(|sum| (0.0..f32::MAX).contains(sum))
    }
}

/// What the speeds of a run are read with.
pub(crate) fn sensor(told: &SensorConfig, truncated: bool) -> SensorConfig {
    SensorConfig { rounding: if truncated { Rounding::Truncated } else { told.rounding }, ..*told }
}

impl Distances {
    /// A run begins.
    pub(crate) fn begin_run(&mut self, sensor: &SensorConfig) {
        self.clear_fields();
        let offset_sd = OFFSET_STEPS * sensor.speed_quantum_kmh as f32 / 3.6;
        self.covariance[SCALE][SCALE] = SCALE_SD * SCALE_SD;
        self.covariance[OFFSET][OFFSET] = offset_sd * offset_sd;
        self.covariance[AGE][AGE] = AGE_SD_S * AGE_SD_S;
    }

    /// A tick. `read_mps`: the speed as it was read. `sign` is +1 where locations grow.
    #[inline(never)]
    pub(crate) fn observe(&mut self, sensor: &SensorConfig, sign: Real, judged: &Judged, read_mps: Option<Real>) {
        if judged.begins || judged.contradiction.is_some() || judged.shifted {
            (self.location_m, self.read_s) = (None, None);
        }
        let Some(speed_mps) = read_mps.filter(|_| judged.speed_mps.is_ok()) else {
            return;
        };
        let speed_mps = speed_mps as f32;
        let last_mps = core::mem::replace(&mut self.speed_mps, speed_mps);
        let dt_s = self.read_s.replace(judged.time_s).map_or(LONGEST_S, |read_s| (judged.time_s - read_s) as f32);
        if dt_s < LONGEST_S {
            let change_mps = speed_mps - last_mps;
            let bend_mps = change_mps - core::mem::replace(&mut self.change_mps, change_mps);
            let (bent_m, uneven_m) = if bend_mps.is_finite() {
                (BENT * bend_mps * dt_s, UNEVEN * bend_mps * dt_s)
            } else {
                (0.0, UNEVEN * change_mps * dt_s)
            };
            let run_m = 0.5 * (last_mps + speed_mps) * dt_s;
            let before_s = if change_mps == 0.0 { self.held_s } else { 0.0 };
            self.held_s = before_s + dt_s;
            if run_m > 0.0 {
                let step_mps = sensor.speed_quantum_kmh as f32 / 3.6;
                let held = step_mps * step_mps / 12.0 * (self.held_s * self.held_s - before_s * before_s);
                self.carry_on(run_m - bent_m, dt_s, held + uneven_m * uneven_m + CHAINAGE * dt_s);
            }
            if (speed_mps == 0.0 || last_mps == 0.0) && run_m > LOST_M {
                (self.location_m, self.change_mps) = (None, f32::INFINITY);
            }
        } else {
            self.location_m = None;
        }
        if judged.time_s - self.compared_s > SPACING_S || self.location_m.is_none() {
            self.compare(sensor, sign, judged);
        }
    }

    /// c grows by κ and o.
    fn carry_on(&mut self, run_m: f32, dt_s: f32, variance: f32) {
        let dot = |row: &[f32; 4]| run_m * row[SCALE] + dt_s * row[OFFSET];
        self.run_m += run_m;
        self.mean[C] += dot(&self.mean);
        let [_, scale, offset, _] = self.covariance;
        let mut row = [0.0; 4];
        for ((row, scale), offset) in row.iter_mut().zip(scale).zip(offset) {
            *row = run_m * scale + dt_s * offset;
        }
        // F P Fᵀ: the column of c, then its row.
        self.covariance.iter_mut().zip(row).for_each(|(of, more)| of[C] += more);
        self.covariance[C].iter_mut().zip(row).for_each(|(of, more)| *of += more);
        self.covariance[C][C] += dot(&row) + variance;
    }

    /// A location beside what the speeds make of it.
    fn compare(&mut self, sensor: &SensorConfig, sign: Real, judged: &Judged) {
        let Ok(location_m) = judged.location_m else {
            return;
        };
        self.compared_s = judged.time_s;
        let speed_mps = self.speed_mps;
        let location_sd_m = sensor.location_sd_m as f32;
        let (count, squares) = self.missed;
        let variance = (DESCRIBED * location_sd_m * location_sd_m + LASTING * squares) / (DESCRIBED + count);
        let variance = variance.at_least(LEAST_NOISE_M * LEAST_NOISE_M);

        let foreseen_m = self.mean[C] + speed_mps * self.mean[AGE];
        let last_m = self.location_m.replace(location_m);
        let run_m = core::mem::take(&mut self.run_m);
        let most = STEP * STEP * (LEAST_NOISE_M * LEAST_NOISE_M + squares) / (1.0 + count);
        self.ahead_m += last_m.map_or(f32::NAN, |last_m| (sign * (location_m - last_m)) as f32) - run_m;
        let mut missed_m = self.ahead_m - foreseen_m;
        if missed_m * missed_m < most {
            self.missed = (count + 1.0, squares + missed_m * missed_m);
        } else {
            // The first one, or one beyond a step: nothing is known of c.
            (self.ahead_m, self.mean[C]) = (0.0, 0.0);
            missed_m = -speed_mps * self.mean[AGE];
            self.covariance[C] = [0.0; 4];
            self.covariance.iter_mut().for_each(|row| row[C] = 0.0);
            self.covariance[C][C] = UNKNOWN_M * UNKNOWN_M;
        }
        let column = self.covariance.map(|row| row[C] + speed_mps * row[AGE]);
        let expected = column[C] + speed_mps * column[AGE] + variance;
        for ((mean, row), of) in self.mean.iter_mut().zip(&mut self.covariance).zip(column) {
            *mean += of / expected * missed_m;
            row.iter_mut().zip(column).for_each(|(covariance, other)| *covariance -= of / expected * other);
        }
    }

    /// What this run said of o, free of what it began with: information, and o.
    fn said(&self, step_mps: f32) -> Option<(f32, f32)> {
        let variance = self.covariance[OFFSET][OFFSET];
        let offset_sd = OFFSET_STEPS * step_mps;
        let information = 1.0 / variance - 1.0 / (offset_sd * offset_sd);
        (information > 0.0).then(|| (information, self.mean[OFFSET] / (variance * information)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    extern crate std;

    const SENSOR: SensorConfig = SensorConfig {
        speed_quantum_kmh: 1.0,
        rounding: Rounding::Rounded,
        speed_noise_kmh: 0.05,
        location_sd_m: 40.0,
    };

    /// What a recorder makes of a speed, km/h, and of a location, m.
    type Reads = (fn(Real) -> Real, fn(Real) -> Real);

    /// A train that starts, cruises, coasts and brakes, a little different in each run.
    fn speed_mps(time_s: Real, run: Real) -> Real {
        let cruise_mps = 34.0 + 0.37 * run;
        let coast_mps = cruise_mps - 0.03 * (time_s - 500.0 - 7.0 * run).max(0.0);
        (0.4 * time_s).min(coast_mps).min(0.5 * (1130.0 - time_s)).max(0.0)
    }

    /// A train that stops every 6 km, at 10 s: it starts and brakes within a few rows.
    fn hopping_mps(time_s: Real, run: Real) -> Real {
        let (since_s, top_mps) = ((time_s + 1.7 * run) % 282.3, 31.0 + (0.7312 * run) % 3.0);
        (0.8 * (since_s - 37.0)).min(top_mps).min(0.7 * (273.0 + 0.6 * (run % 7.0) - since_s)).max(0.0)
    }

    fn after(runs: u32, reads: Reads) -> SpeedOffset {
        driven(speed_mps, runs, reads)
    }

    fn driven(speed_mps: fn(Real, Real) -> Real, runs: u32, (speed, location): Reads) -> SpeedOffset {
        let mut offset = SpeedOffset::default();
        for run in 0..runs {
            let mut distances = Distances::ZEROED;
            distances.begin_run(&SENSOR);
            let (mut location_m, step_s) = (0.0, 0.1);
            for step in 0..11_300 {
                let time_s = step_s * Real::from(step);
                let now_mps = speed_mps(time_s, run.into());
                if step % 100 == 0 {
                    let read_mps = speed(3.6 * now_mps) / 3.6;
                    let judged = Judged {
                        time_s,
                        sender_s: time_s,
                        dt_s: if step == 0 { 0.0 } else { 10.0 },
                        begins: step == 0,
                        location_m: Ok(location(location_m)),
                        speed_mps: Ok(read_mps),
                        effort_n_per_kg: None,
                        contradiction: None,
                        shifted: false,
                    };
                    distances.observe(&SENSOR, 1.0, &judged, Some(read_mps));
                }
                location_m += step_s * now_mps;
            }
            offset.add(&SENSOR, &distances);
        }
        offset
    }

    #[test]
    fn speeds_that_are_cut_off_are_told_from_rounded_ones_after_some_runs() {
        let exact: fn(Real) -> Real = |m| m;
        for (name, speed, truncated) in [
            ("rounded", libm::round as fn(Real) -> Real, false),
            ("cut off", libm::floor, true),
            ("exact", |kmh| kmh, false),
            ("cut off, a wheel that is worn", |kmh| libm::floor(1.02 * kmh), true),
            ("rounded, a wheel that is worn", |kmh| libm::round(1.02 * kmh), false),
            ("a whole step too low", |kmh| (libm::round(kmh) - 1.0).max(0.0), false),
        ] {
            let offset = after(6, (speed, exact));
            assert_eq!(offset.is_truncated(&SENSOR), truncated, "{name}: {offset:?} {:?}", offset.found());
        }
        assert!(!after(1, (libm::floor, exact)).is_truncated(&SENSOR), "one run does not decide");
    }

    /// The trapezium of two speeds misses up to 10 m where a brake begins between them, by the same sign in each hop.
    #[test]
    fn starts_and_brakes_between_readings_are_no_offset() {
        let [rounded, cut] =
            [libm::round as fn(Real) -> Real, libm::floor].map(|speed| driven(hopping_mps, 60, (speed, |m| m)));
        let (found, sd) = rounded.found().unwrap();
        assert!(found.abs() < 3.0 * sd && found.abs() < 0.1 / 3.6, "{found} {sd}");
        assert!(!rounded.is_truncated(&SENSOR) && cut.is_truncated(&SENSOR), "{rounded:?} {cut:?} {:?}", cut.found());
    }

    /// The same step in each run would look like a speed that is cut off.
    #[test]
    fn a_step_of_the_chainage_decides_nothing() {
        for location in [
            |m| if m > 1500.0 { m + 40.0 } else { m },
            |m| if m > 24_000.0 { m + 40.0 } else { m },
            |m| if m > 6000.0 { m - 100.0 } else { m },
        ] as [fn(Real) -> Real; 3]
        {
            let [rounded, cut] =
                [libm::round as fn(Real) -> Real, libm::floor].map(|speed| after(8, (speed, location)));
            assert!(!rounded.is_truncated(&SENSOR) && cut.is_truncated(&SENSOR), "{rounded:?} {cut:?}");
        }
    }

    #[test]
    fn a_recorder_that_was_swapped_is_recognised() {
        let mut offset = after(10, (libm::floor, |m| m));
        assert!(offset.is_truncated(&SENSOR));
        let rounded = after(1, (libm::round, |m| m));
        let swapped = (0..40).find(|_| {
            offset = SpeedOffset {
                runs: REMEMBERED * offset.runs + 1.0,
                information: REMEMBERED * offset.information + rounded.information,
                vector: REMEMBERED * offset.vector + rounded.vector,
                squares: REMEMBERED * offset.squares + rounded.squares,
            };
            !offset.is_truncated(&SENSOR)
        });
        assert!(swapped.is_some_and(|runs| runs < 10), "{swapped:?}");
    }

    #[test]
    fn numbers_that_are_none_decide_nothing() {
        let offset = SpeedOffset { runs: 3.0, information: f32::NAN, vector: 1.0, squares: 1.0 };
        assert!(!offset.is_sound() && !offset.is_truncated(&SENSOR));
        assert_eq!(SpeedOffset::default().found(), None);
        let exact = SensorConfig { speed_quantum_kmh: 0.0, ..SENSOR };
        let mut offset = SpeedOffset::default();
        let mut distances = Distances::ZEROED;
        distances.begin_run(&exact);
        offset.add(&exact, &distances);
        assert_eq!(offset, SpeedOffset::default());
    }
}
