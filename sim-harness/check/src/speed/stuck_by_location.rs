//! Whether a speed that stays the same in a few rows far apart is stuck, by the locations: a train that had begun to
//! change its speed went farther, or less far, than the reading says.
//!
//! In: rows of a run. Out: distance by location less distance by a speed that stays the same, m.
//!
//! ```text
//! v    80    80    80    80    43        o = distance by location - κ distance by speed - τ (change of the speed)
//! o        0   -30   -85   -45           κ, τ: wheel and age of this run's readings, the usual ones
//! ```
//!
//! A location that leaps does so between two rows. A train that brakes late between the last 80 and a 43 that are both
//! right goes farther than their mean, one that has braked before goes less far. So at least two steps in a row, the
//! one to the next speed among them, are off towards it, and none by more than that speed would make.

use crate::rows::stuck::StuckRows;
use crate::rows::times;
use rundown_files::sample::Sample;
use rundown_files::statistics::{median, spread};

/// The least by which a step is off, in units of the usual scatter, and the least of their sum.
const STEP_NOISE: f64 = 2.0;
const ALL_NOISE: f64 = 6.0;
/// No train brakes or powers by more, m/s².
pub(crate) const LARGEST_MPS2: f64 = 1.4;
/// Together they are off by no less, m.
const LEAST_M: f64 = 15.0;
/// So many steps: one alone may be a location that leaps.
const LEAST_STEPS: usize = 2;
/// Steps of a run that say what is usual: so many, faster than this, m/s; the age shows where the speed changes by more
/// than that, m/s.
const LEAST_USUAL: usize = 10;
const LEAST_MPS: f64 = 3.0;
const LEAST_CHANGE_MPS: f64 = 1.0;

/// From one row to the next: the time, s, the ways by location and by speed, m, and the change of the speed, m/s.
#[derive(Clone, Copy)]
struct Step {
    lasts_s: f64,
    by_location_m: f64,
    by_speed_m: f64,
    change_mps: f64,
}

impl Step {
    fn of(pair: &[Sample], sign: f64) -> Option<Self> {
        let [a, b] = [pair[0], pair[1]];
        let (lasts_s, [a_mps, b_mps]) = (b.time_s - a.time_s, [a.speed_mps?, b.speed_mps?]);
        (lasts_s > 0.0).then_some(Self {
            lasts_s,
            by_location_m: sign * (b.location_m? - a.location_m?),
            by_speed_m: 0.5 * lasts_s * (a_mps + b_mps),
            change_mps: b_mps - a_mps,
        })
    }

    fn is_fast(&self) -> bool {
        self.by_speed_m > LEAST_MPS * self.lasts_s
    }
}

/// What a train may miss of the way of its speed where it brakes and powers between two rows that have it, m.
pub(crate) fn between_m(apart_s: f64) -> f64 {
    LARGEST_MPS2 * (0.5 * apart_s).powi(2)
}

/// The steps of a run: of each how far its way by location is from what speeds usually say, m.
pub(crate) struct Steps {
    steps: Vec<Option<(Step, f64)>>,
    noise_m: f64,
    fastest_mps: f64,
}

impl Steps {
    /// None where too few steps say what is usual. `sign`: of the locations in the direction of travel.
    pub(crate) fn of(rows: &[Sample], sign: f64, fastest_mps: f64) -> Option<Self> {
        let longest_s = times::longest_step_s(times::usual_step_s(rows));
        let step = |pair: &[Sample]| Step::of(pair, sign).filter(|step| step.lasts_s <= longest_s);
        let steps: Vec<Option<Step>> = rows.windows(2).map(step).collect();
        let fast: Vec<Step> = steps.iter().flatten().filter(|step| step.is_fast()).copied().collect();
        if fast.len() < LEAST_USUAL {
            return None;
        }
        let wheel = median(fast.iter().map(|step| step.by_location_m / step.by_speed_m))?;
        let apart_m = |step: &Step| step.by_location_m - wheel * step.by_speed_m;
        let changes = fast.iter().filter(|step| step.change_mps.abs() > LEAST_CHANGE_MPS);
        let ages_s: Vec<f64> = changes.map(|step| apart_m(step) / step.change_mps).collect();
        let age_s = if ages_s.len() < LEAST_USUAL { 0.0 } else { median(ages_s)? };
        let off_m = |step: &Step| apart_m(step) - age_s * step.change_mps;
        let noise_m = spread(fast.iter().map(off_m));
        Some(Self {
            steps: steps.iter().map(|step| step.map(|step| (step, off_m(&step)))).collect(),
            noise_m,
            fastest_mps,
        })
    }

    /// How far the locations of a train that was on its way to the next speed are from a speed that stays the same, m,
    /// above zero; none where they are not.
    pub(crate) fn missed_m(&self, rows: &[Sample], stuck: &StuckRows) -> Option<f64> {
        let stays_mps = rows[stuck.from].speed_mps.filter(|mps| *mps > 0.0)?;
        let change_mps = rows.get(stuck.to + 1)?.speed_mps? - stays_mps;
        let towards = |step: &(Step, f64)| {
            let (Step { lasts_s, by_location_m, .. }, off_m) = *step;
            let (off_m, noise_m) = (change_mps.signum() * off_m, STEP_NOISE * self.noise_m);
            let goes_so = (-noise_m..=self.fastest_mps * lasts_s + noise_m).contains(&by_location_m);
            let is_off = off_m > noise_m && off_m < change_mps.abs() * lasts_s + noise_m;
            (goes_so && is_off).then_some((off_m, lasts_s))
        };
        // Back from the step to the next speed; the speed may have stood still since before its first row.
        let back = self.steps[stuck.from.saturating_sub(1)..=stuck.to].iter().rev();
        let off: Vec<(f64, f64)> = back.map_while(|step| step.as_ref().and_then(towards)).collect();
        let (all_m, longest_s) = off
            .iter()
            .fold((0.0, 0.0_f64), |(sum_m, longest_s), (off_m, lasts_s)| (sum_m + off_m, longest_s.max(*lasts_s)));
        let is_missed =
            off.len() >= LEAST_STEPS && all_m > between_m(longest_s).max(ALL_NOISE * self.noise_m).max(LEAST_M);
        is_missed.then_some(all_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::finding::{Finding, Kind};
    use crate::speed::stuck;

    /// Rows 10 s apart in whole km/h of a train at 90 km/h that brakes at 0.5 m/s² from a time on, s, to 47 km/h,
    /// powers, and does the same again; locations scatter by some metres.
    fn braked(from_s: f64) -> Vec<Sample> {
        let (mut at_m, mut rows) = (0.0, Vec::new());
        for i in 0..900_u32 {
            let t = f64::from(i);
            let braked_mps = [0.0, 330.0].map(|late_s| (0.5 * (t - from_s - late_s)).clamp(0.0, 12.0));
            let gained_mps = [230.0, 430.0].map(|late_s| (0.3 * (t - from_s - late_s)).clamp(0.0, 12.0));
            let mps = 25.0 + gained_mps.iter().sum::<f64>() - braked_mps.iter().sum::<f64>();
            if i % 10 == 0 {
                let read = (3.6 * mps).round() / 3.6;
                let location_m = at_m + 4.0 * (f64::from(i) * 0.7).sin();
                rows.push(Sample {
                    time_s: t,
                    location_m: Some(location_m),
                    speed_mps: Some(read),
                    ..Sample::default()
                });
            }
            at_m += mps;
        }
        rows
    }

    fn said(mut rows: Vec<Sample>) -> Vec<Finding> {
        let mut findings = Vec::new();
        stuck::leave_out(&mut rows, None, &mut findings);
        findings
    }

    #[test]
    fn a_speed_that_stands_still_in_few_rows_far_apart_is_seen_by_the_steps_to_the_next_speed() {
        for (from_s, rows) in [(255.0, 26..29), (245.0, 25..28), (272.0, 20..30)] {
            let mut held = braked(from_s);
            assert_eq!(said(held.clone()), [], "{from_s}");
            let stays = held[rows.start - 1].speed_mps;
            held[rows.clone()].iter_mut().for_each(|row| row.speed_mps = stays);
            let found = said(held);
            assert_eq!(
                found.iter().map(|found| found.kind).collect::<Vec<_>>(),
                [Kind::StuckSpeed],
                "{from_s} {rows:?}"
            );
            assert!((50.0..500.0).contains(&found[0].figure.value), "{found:?}");
        }
    }

    #[test]
    fn a_location_that_leaps_before_a_brake_is_no_speed_that_stands_still() {
        for leap_m in [-120.0, -60.0, -48.0, 60.0] {
            for from in 20..29 {
                let mut rows = braked(271.0);
                rows[from..].iter_mut().for_each(|row| row.location_m = row.location_m.map(|m| m + leap_m));
                assert_eq!(said(rows), [], "{leap_m} {from}");
            }
        }
    }

    /// By eight seconds, as of a sensor that takes means; and of a wheel that is off.
    #[test]
    fn a_speed_that_is_late_or_off_by_its_wheel_does_not_stand_still() {
        let (now, late) = (braked(262.0), braked(270.0));
        let rows = now.iter().zip(&late).map(|(now, late)| {
            let speed_mps = late.speed_mps.map(|mps| 1.05 * mps);
            Sample { speed_mps, ..*now }
        });
        assert_eq!(said(rows.collect()), []);
    }
}
