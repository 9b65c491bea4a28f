//! When within an interval one regime gave way to another.
//!
//! In: the course of effort, speed and location around a [`Boundary`]. Out: a [`SwitchingPoint`].
//!
//! The effort of a tick is a mean over the interval before it, so the interval with the change has a share of both
//! levels. With I the integral of the effort over time, u1 the level before T0, u2 the level after T1 and the change
//! between them,
//!
//! ```text
//! I(T1) - I(T0) = u1 (t - T0) + u2 (T1 - t)
//! t = (u2 T1 - u1 T0 - (I(T1) - I(T0))) / (u2 - u1)
//! ```
//!
//! which is where two straight lines of speed meet, with resistance and gradient taken out. It asks only for speeds at
//! T0 and T1 and two levels, not for rates over single ticks, and so needs no other formula for ticks of 1 s. T0 and T1
//! lie a `window_s` (at least one tick) off the boundary, a level is the mean over one further `window_s` of traction
//! or brake and three of cruising or coasting. t is not let out of T0..T1; when it comes out at an edge, the
//! recognition was late or early, and the window is moved there, twice at most. Where a phase is too short to have a
//! level the boundary between the samples stands.
//!
//! Where power or a held speed gives way to a coast and a window holds [`LEAST_KNOTS`] or more, the coast is known: its
//! resistance and gradient are, so only the speed at its start is free. Before it the speed is a straight line, level
//! where it was held. Of all knots that one is the start whose line fits the speeds best (least squares: rounding and
//! noise are the same at each):
//!
//! ```text
//! v = v0 + a (t - t0)                  before t0
//! v = v0 - R(t) + R(t0)                after it; R: integral of resistance and gradient
//! ```
//!
//! A train that stops: the speed before the last interval, over the deceleration before it.
//!
//! Measured on 400 runs with a known truth, readings of whole km/h every 10 s (`host-tests/tests/features.rs`): start
//! of the final brake within 2.5 s in 90 % of the runs (median 1.4 s late, for the brake takes 1 to 6 s to build up),
//! of the final coast within 6.8 s, stop within 0.6 s. Every 1 s: 2.9, 2.6 and 0.4 s.
//!
//! Memory: 64 knots at least a sixth of `window_s` apart, 107 s of a fast log.

use super::phases::Boundary;
use super::statistic::LineFit;
use super::{FeatureConfig, Observation, SwitchingPoint};
use crate::Real;
use crate::extremes::Extremes;
use crate::plain::plain;
use crate::tick::regime::Regime;
use crate::tick::snapshot::in_place;
use heapless::Deque;

const KNOTS: usize = 64;

/// Levels closer than this give no crossing, N/kg.
const LEAST_STEP_N_PER_KG: Real = 0.02;

/// Times this near are the same, s.
const SAME_S: Real = 1e-6;

/// Knots that a window must have for the best fit; rows of 10 s have fewer, and one or two in a phase of power.
const LEAST_KNOTS: usize = 12;
/// So many times `window_s` before a boundary, and after it, belong to its fit.
const FIT_WINDOWS: [Real; 2] = [4.0, 3.0];
/// What is believed of the acceleration before a coast, that it is 0, counts as so many s² of readings.
const LEVEL_PRIOR_S2: Real = 20.0;

/// The speeds about the fit of a held speed scatter by no more than this, m/s, twice what rounding to whole km/h makes:
/// else the train did other things, too. Under power they are a curve.
const WORST_FIT_MPS: Real = 0.16;

/// A brake builds up for so long before it is seen, s.
const BUILD_UP_S: Real = 3.0;

/// The course at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Knot {
    time_s: Real,
    /// Effort integrated over time since the beginning, m/s.
    impulse_mps: Real,
    speed_mps: Real,
    location_m: Real,
}

plain! {
    struct Knot { time_s, impulse_mps, speed_mps, location_m }
}

in_place! {
    /// The last minutes.
    #[derive(Clone, Debug)]
    pub(super) struct RecentTicks {
        knots: Deque<Knot, KNOTS> = (in place);
        head: Option<Knot> = (None);
        last_good: Option<Observation> = (None, zeroed Some(Observation::ZEROED));
    }
}

impl RecentTicks {
    /// Takes a tick. After a dropout the effort since the last good tick comes from the speeds at both ends, Eq. (1).
    pub(super) fn push(&mut self, config: &FeatureConfig, tick: &Observation) {
        let Some(effort) = tick.effort_n_per_kg else {
            return;
        };
        let mut impulse_mps = 0.0;
        if let (Some(last), Some(head)) = (self.last_good, self.head) {
            let since_s = tick.time_s - last.time_s;
            let stands = last.regime == Regime::Standstill && tick.regime == Regime::Standstill;
            let moved_mps = if stands {
                0.0
            } else if since_s <= 1.01 * tick.dt_s {
                effort * tick.dt_s
            } else {
                let mean_mps = 0.5 * (last.speed_mps + tick.speed_mps);
                let gradient = 0.5 * (last.gradient_n_per_kg + tick.gradient_n_per_kg);
                let resistance = tick.davis.resistance_n_per_kg(mean_mps) + gradient;
                tick.speed_mps - last.speed_mps + resistance * since_s
            };
            impulse_mps = head.impulse_mps + moved_mps;
        }
        let head = Knot { time_s: tick.time_s, impulse_mps, speed_mps: tick.speed_mps, location_m: tick.location_m };
        let spaced = self.knots.back().is_none_or(|last| head.time_s - last.time_s >= config.window_s / 6.0);
        if spaced {
            if self.knots.is_full() {
                self.knots.pop_front();
            }
            // Just made room.
            let _kept = self.knots.push_back(head).is_ok();
        }
        self.head = Some(head);
        self.last_good = Some(*tick);
    }

    /// Knot `i` in order of time, the present last.
    fn knot(&self, i: usize) -> Option<&Knot> {
        match self.knots.get(i) {
            None if i == self.knots.len() => {
                self.head.as_ref().filter(|head| self.knots.back().is_none_or(|last| last.time_s < head.time_s))
            }
            knot => knot,
        }
    }

    /// Number of the first knot that is not before this time, with so many shares of its interval, at most 0, added to
    /// its own. Halving, because a comparison costs a processor without doubles much.
    #[inline(never)]
    fn first(&self, time_s: Real, shares: Real) -> usize {
        let has_present = self.knot(self.knots.len()).is_some();
        let (mut low, mut high) = (0, self.knots.len() + usize::from(has_present));
        while low < high {
            let middle = low.midpoint(high);
            // The first one has no interval.
            let before_s = self.knot(middle.wrapping_sub(1)).map(|before| before.time_s);
            let is_before =
                |knot: &Knot| knot.time_s + shares * (knot.time_s - before_s.unwrap_or(knot.time_s)) < time_s;
            if self.knot(middle).is_some_and(is_before) {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        low
    }

    /// Number of the last knot not later than this, 0.3 of its interval after it still counts (a clock is not exact);
    /// of the first one when there is none.
    fn back_to(&self, time_s: Real) -> usize {
        self.first(time_s, -0.3).max(1) - 1
    }

    /// Number of the first knot not earlier than this, with the same tolerance. Behind a gap the tolerance falls, so
    /// that halving would not do.
    fn on_to(&self, time_s: Real) -> usize {
        let begin_s = self.knot(0).map_or(time_s, |knot| knot.time_s);
        // A knot's interval is not longer than the whole course; a second for the rounding.
        let mut i = self.first((time_s + 0.3 * begin_s) / 1.3 - 1.0, 0.0);
        while let Some(knot) = self.knot(i) {
            let before_s = self.knot(i.wrapping_sub(1)).map_or(knot.time_s, |before| before.time_s);
            if knot.time_s + 0.3 * (knot.time_s - before_s) >= time_s {
                break;
            }
            i += 1;
        }
        i
    }

    /// The course at a time, in a straight line between knots.
    fn at(&self, time_s: Real) -> Option<Knot> {
        let after = self.first(time_s, 0.0);
        let Some(knot) = self.knot(after) else {
            // Behind the last one.
            return self.knot(after.checked_sub(1)?).copied();
        };
        let before = after.checked_sub(1).and_then(|i| self.knot(i));
        let before = before.unwrap_or(knot);
        let interval_s = knot.time_s - before.time_s;
        let share = if interval_s > 0.0 { ((time_s - before.time_s) / interval_s).clamp(0.0, 1.0) } else { 0.0 };
        let mix = |a: Real, b: Real| a + share * (b - a);
        Some(Knot {
            time_s,
            impulse_mps: mix(before.impulse_mps, knot.impulse_mps),
            speed_mps: mix(before.speed_mps, knot.speed_mps),
            location_m: mix(before.location_m, knot.location_m),
        })
    }

    /// The switching point of a boundary, between `after_s` and `before_s`, where there are neighbours; since `since_s`
    /// the train held its speed or had power, and what follows begins at `next_s`.
    pub(super) fn locate(
        &self,
        config: &FeatureConfig,
        boundary: &Boundary,
        [since_s, after_s, before_s, next_s]: [Real; 4],
    ) -> SwitchingPoint {
        let found = if boundary.to == Regime::Standstill {
            self.stop(config, boundary)
        } else {
            self.coast_onset(config, boundary, since_s, next_s)
                .or_else(|| self.crossing(config, boundary, after_s, before_s))
        };
        let nowhere = Knot { time_s: boundary.time_s, impulse_mps: 0.0, speed_mps: 0.0, location_m: 0.0 };
        let knot = found.or_else(|| self.at(boundary.time_s.at_most(before_s))).unwrap_or(nowhere);
        SwitchingPoint {
            time_s: knot.time_s,
            location_m: knot.location_m,
            speed_mps: knot.speed_mps,
            from: boundary.from,
            to: boundary.to,
        }
    }

    /// Where the coast after a boundary begins, by the best fit.
    fn coast_onset(&self, config: &FeatureConfig, boundary: &Boundary, since_s: Real, next_s: Real) -> Option<Knot> {
        if boundary.to != Regime::Coast || !matches!(boundary.from, Regime::Traction | Regime::Cruise) {
            return None;
        }
        let [back, on] = FIT_WINDOWS.map(|windows| windows * config.window_s);
        let end_s = (boundary.time_s + on).at_most(next_s - BUILD_UP_S);
        let start = self.first(since_s.at_least(boundary.time_s - back), 0.0);
        // The present is no knot on every tick.
        let end = self.first(end_s, 0.0).min(self.knots.len());
        if end < start + LEAST_KNOTS {
            return None;
        }
        let [mut all, mut before, mut driven] = [LineFit::ZEROED; 3];
        for i in start..end {
            all.add(self.knots.get(i)?.impulse_mps, 0.0);
        }
        let (mut least, mut best, mut speed_mps) = (Real::MAX, start, 0.0);
        for i in start..end {
            let knot = self.knots.get(i)?;
            let time_s = knot.time_s - end_s;
            let line = driven.and_level(time_s, [&all, &before], knot.impulse_mps - knot.speed_mps);
            let line = line.least_squares(LEVEL_PRIOR_S2);
            if line.rest < least {
                least = line.rest;
                best = i;
                speed_mps = line.at_0 + line.slope * time_s;
            }
            before.add(knot.impulse_mps, 0.0);
            driven.add(time_s, knot.speed_mps);
        }
        let is_straight = least < Real::from((end - start) as u32) * WORST_FIT_MPS * WORST_FIT_MPS;
        let fits = is_straight || boundary.from == Regime::Traction;
        fits.then_some(Knot { speed_mps: speed_mps.at_least(0.0), ..*self.knots.get(best)? })
    }

    fn stop(&self, config: &FeatureConfig, boundary: &Boundary) -> Option<Knot> {
        let last = self.at(boundary.time_s)?;
        let (_, rate_mps2) = self.slowing(&last, boundary.time_s - config.window_s)?;
        let end = self.at(boundary.first_sample_s)?;
        let interval_s = end.time_s - last.time_s;
        // Not `at_least`, of which the compiler would not know that the bounds of `clamp` are in order.
        let most_s = if interval_s > 0.0 { interval_s } else { 0.0 };
        let time_s = last.time_s + (last.speed_mps / rate_mps2).clamp(0.0, most_s);
        Some(Knot { time_s, speed_mps: 0.0, ..end })
    }

    /// The course at a time before, and the deceleration from there to `last`, m/s²; none where the train did not slow
    /// down, or there is nothing before.
    fn slowing(&self, last: &Knot, since_s: Real) -> Option<(&Knot, Real)> {
        let before = self.knot(self.back_to(since_s))?;
        let rate_mps2 = (before.speed_mps - last.speed_mps) / (last.time_s - before.time_s);
        (rate_mps2 > 0.0 && rate_mps2.is_finite()).then_some((before, rate_mps2))
    }

    /// The train as it will stand, if it would within `window_s` as it slows down now: for a log that ends or pauses
    /// before that.
    pub(super) fn stop_ahead(&self, config: &FeatureConfig) -> Option<Observation> {
        let (head, last) = (self.head?, self.last_good?);
        let (before, rate_mps2) = self.slowing(&head, head.time_s - config.window_s)?;
        let in_s = head.speed_mps / rate_mps2;
        let heading = (head.location_m - before.location_m).signum();
        let resistance = last.davis.resistance_n_per_kg(0.5 * head.speed_mps) + last.gradient_n_per_kg;
        let is_near = in_s > 0.0 && in_s <= config.window_s;
        (is_near && last.regime != Regime::Standstill).then_some(Observation {
            time_s: head.time_s + in_s,
            dt_s: in_s,
            location_m: head.location_m + heading * 0.5 * head.speed_mps * in_s,
            speed_mps: 0.0,
            effort_n_per_kg: Some(resistance - rate_mps2),
            acceleration_mps2: Some(-rate_mps2),
            regime: Regime::Standstill,
            ..last
        })
    }

    fn crossing(&self, config: &FeatureConfig, boundary: &Boundary, after_s: Real, before_s: Real) -> Option<Knot> {
        let mut middle_s = boundary.time_s;
        let mut found = None;
        for _ in 0..3 {
            let (knot, moved) = self.crossing_near(config, boundary, middle_s, after_s, before_s)?;
            found = Some(knot);
            if moved == 0.0 {
                break;
            }
            middle_s += moved * config.window_s;
        }
        found
    }

    /// The crossing, and where it lies outside the window: -1 before, 1 after, 0 inside.
    fn crossing_near(
        &self,
        config: &FeatureConfig,
        boundary: &Boundary,
        middle_s: Real,
        after_s: Real,
        before_s: Real,
    ) -> Option<(Knot, Real)> {
        let window_s = config.window_s;
        // Knots between the neighbouring switching points.
        let least = self.first(after_s, 0.0);
        let most = self.first(before_s + SAME_S, 0.0).checked_sub(1)?;
        let within = |i: usize| self.knot(i.max(least).min(most));
        let t0 = within(self.back_to(middle_s - window_s))?;
        let t1 = within(self.on_to(middle_s + window_s))?;
        let start = within(self.back_to(t0.time_s - level_s(config, boundary.from)))?;
        let end = within(self.on_to(t1.time_s + level_s(config, boundary.to)))?;
        let u1 = level(config, boundary.from, start, t0)?;
        let u2 = level(config, boundary.to, t1, end)?;
        let step = u2 - u1;
        let span_s = t1.time_s - t0.time_s;
        // A time that is not a number would make a range without order.
        if step.abs() < LEAST_STEP_N_PER_KG || span_s.is_nan() || span_s <= 0.0 {
            return None;
        }
        // From T0, to keep large times out of the products.
        let from_t0_s = (u2 * span_s - (t1.impulse_mps - t0.impulse_mps)) / step;
        let tolerance_s = 0.1 * window_s;
        let moved = if from_t0_s < -tolerance_s {
            -1.0
        } else if from_t0_s > span_s + tolerance_s {
            1.0
        } else {
            0.0
        };
        let from_t0_s = from_t0_s.clamp(0.0, span_s);
        // The speed has its corner here: the mean of both lines, not the chord.
        let forward = t0.speed_mps + slope(start, t0) * from_t0_s;
        let backward = t1.speed_mps - slope(t1, end) * (span_s - from_t0_s);
        let speed_mps = (0.5 * (forward + backward)).at_least(0.0);
        let length_m = 0.5 * (t0.speed_mps + speed_mps) * from_t0_s;
        let sign = if t1.location_m < t0.location_m { -1.0 } else { 1.0 };
        let knot = Knot {
            time_s: t0.time_s + from_t0_s,
            impulse_mps: t0.impulse_mps,
            speed_mps,
            location_m: t0.location_m + sign * length_m,
        };
        Some((knot, moved))
    }
}

fn level_s(config: &FeatureConfig, regime: Regime) -> Real {
    match regime {
        Regime::Traction | Regime::Brake => config.window_s,
        Regime::Cruise | Regime::Coast | Regime::Standstill => 3.0 * config.window_s,
    }
}

/// Mean effort between two knots; without half a window between them that of the regime, where it has one.
fn level(config: &FeatureConfig, regime: Regime, from: &Knot, to: &Knot) -> Option<Real> {
    let dt_s = to.time_s - from.time_s;
    match regime {
        Regime::Standstill => Some(0.0),
        _ if dt_s >= 0.5 * config.window_s => Some((to.impulse_mps - from.impulse_mps) / dt_s),
        Regime::Coast => Some(0.0),
        Regime::Traction | Regime::Cruise | Regime::Brake => None,
    }
}

fn slope(from: &Knot, to: &Knot) -> Real {
    let dt_s = to.time_s - from.time_s;
    if dt_s > 0.0 { (to.speed_mps - from.speed_mps) / dt_s } else { 0.0 }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::super::{FeatureExtractor, Features};
    use super::*;
    use crate::model::resistance::Davis;
    use Regime::{Brake, Coast, Cruise, Standstill, Traction};

    const DAVIS: Davis = Davis { r0: 7.38e-3, r1: 1.6e-4, r2: 2.8e-5 };

    /// A train read in whole km/h every second: from this speed, with an effort (none: the speed is held) and a
    /// recognised regime in each second, and a brake of 1 m/s² to the stop in the end.
    fn features_of(kmh: Real, seconds: &[(Option<Real>, Regime)]) -> Features {
        let config = FeatureConfig::default();
        let mut extractor = FeatureExtractor::new();
        let (mut speed_mps, mut location_m, mut time_s) = (kmh / 3.6, 0.0, 0.0);
        let mut before: Option<Real> = None;
        let mut tick = |speed_mps: Real, location_m: Real, regime: Regime| {
            let read_mps = (3.6 * speed_mps).round() / 3.6;
            let last_mps = before.replace(read_mps).unwrap_or(read_mps);
            let rate = read_mps - last_mps;
            let effort = rate + DAVIS.resistance_n_per_kg(0.5 * (read_mps + last_mps));
            let tick = Observation {
                time_s,
                dt_s: 1.0,
                location_m,
                speed_mps: read_mps,
                effort_n_per_kg: Some(effort),
                acceleration_mps2: Some(rate),
                gradient_n_per_kg: 0.0,
                davis: DAVIS,
                regime,
            };
            extractor.observe(&config, &tick);
            time_s += 1.0;
        };
        for &(effort, regime) in seconds {
            let rate = effort.map_or(0.0, |effort| effort - DAVIS.resistance_n_per_kg(speed_mps));
            location_m += speed_mps + 0.5 * rate;
            speed_mps += rate;
            tick(speed_mps, location_m, regime);
        }
        while speed_mps > 0.0 {
            speed_mps = (speed_mps - 1.0).max(0.0);
            location_m += speed_mps;
            tick(speed_mps, location_m, if speed_mps > 0.0 { Brake } else { Standstill });
        }
        extractor.features(&config)
    }

    fn row(seconds: usize, effort: Option<Real>, regime: Regime) -> std::vec::Vec<(Option<Real>, Regime)> {
        std::vec![(effort, regime); seconds]
    }

    /// How far off the final coast begins in the worst of ten runs, s. Its points are in order.
    fn worst_s(seconds: &[(Option<Real>, Regime)], start_s: Real) -> Real {
        let of_run = |i: u32| {
            let features = features_of(128.0 + 0.3 * Real::from(i), seconds);
            let points = &features.switching_points;
            assert!(points.windows(2).all(|pair| pair[0].time_s <= pair[1].time_s), "{points:?}");
            (features.final_coast.unwrap().start_time_s - start_s).abs()
        };
        (0..10).map(of_run).fold(0.0, Real::max)
    }

    #[test]
    fn a_coast_begins_where_the_held_speed_ends_and_not_where_that_is_recognised() {
        let rows = [row(100, None, Cruise), row(24, Some(0.0), Cruise), row(60, Some(0.0), Coast)].concat();
        let worst_s = worst_s(&rows, 99.0);
        assert!(worst_s <= 5.0, "{worst_s}");
    }

    /// Power and coast together look like a held speed for some seconds.
    #[test]
    fn a_mean_of_power_and_coast_is_no_cruise() {
        let power = [row(30, Some(0.0), Coast), row(14, Some(0.16), Traction)].concat();
        let rows = [power, row(15, Some(0.0), Cruise), row(60, Some(0.0), Coast)].concat();
        let worst_s = worst_s(&rows, 43.0);
        assert!(worst_s <= 4.0, "{worst_s}");
    }

    #[test]
    fn a_coast_behind_a_brake_and_a_short_hold_begins_where_the_hold_ends() {
        let braked = [row(60, None, Cruise), row(24, Some(-0.3), Brake), row(20, None, Cruise)].concat();
        let rows = [braked, row(60, Some(0.0), Coast)].concat();
        let worst_s = worst_s(&rows, 103.0);
        assert!(worst_s <= 6.0, "{worst_s}");
    }
}
