//! Speeds in whole steps: where a reading steps, the speed is known far better than between.
//!
//! In: each reading of the speed. Out: the speed on the edge between two steps when a reading has just passed it, and
//! whether the readings are such a staircase.
//!
//! A coasting train crosses 1 km/h in some 6 s, and its readings stay the same meanwhile: six of them say what one
//! does. But when the reading falls from 80 to 79 km/h the train passed 79.5 within the last row. That holds for a
//! speed that is rounded and hardly noisy. Noise makes readings go down, up and down again about an edge, and all of
//! these teach: the first comes too early, the last too late. How often they do says how large it is.

use crate::tick::sensor::SensorConfig;
use crate::tick::snapshot::in_place;

in_place! {
    /// The steps of a run.
    #[derive(Clone, Copy, Debug, Default, PartialEq)]
    pub struct Staircase {
        last_mps: f32 = (0.0);
        /// Since the last reading, s.
        unread_s: f32 = (0.0);
        /// The last change of the reading, m/s, if it was a single step; the time since, s; whether it was a turn.
        single_mps: f32 = (0.0);
        changed_s: f32 = (0.0);
        turned: bool = (false);
        /// After a reading that stood: single steps, and steps of two at once; turns that follow a turn.
        steps: u16 = (0);
        doubles: u16 = (0);
        turns: u16 = (0);
        /// What an edge is worth, if the readings looked like whole steps when the train stood last, km/h. Asked within
        /// a coast, noise would choose which of its edges teach.
        edge_sd_kmh: Option<f32> = (None);
        /// The edge that has just been passed, m/s, and the time since the reading before, s.
        edge_mps: Option<f32> = (None);
        edge_row_s: f32 = (0.0);
    }
}

/// What a row of a staircase says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Edge {
    /// The reading stayed where it was, or changed by several steps.
    None,
    /// It stepped.
    Passed {
        /// The speed that was passed within the row, m/s.
        mps: f32,
        /// Standard deviation of that, m/s.
        sd_mps: f32,
        /// How long ago it may have been passed, s: the time since the reading before.
        row_s: f32,
    },
}

/// Rows farther apart have no edges, s: within 2 s a coasting train crosses a third of a step.
pub(crate) const LONGEST_ROW_S: f32 = 2.25;
/// A step back within so many seconds is a turn, s. Power that ends makes one, noise several in a row.
const TURNED_S: f32 = 3.5;
/// A step after so many seconds is that of a coast, s: where a train powers or brakes noise does not show, and these
/// steps say nothing about it.
const STOOD_S: f32 = 2.5;
/// Single steps from which on they are believed, and turns over steps up to which they are: noise of 0.1 km/h makes a
/// tenth on metros and 0.4 where speeds are held, noise of 0.3 km/h 0.7 and more.
const LEAST_STEPS: u16 = 5;
const MOST_TURNS: f32 = 0.5;
/// Double over single steps from which on the speeds are those of another unit: whole mph that are written in km/h make
/// 1.6, knots and half m/s more; brakes on clean readings make a fiftieth.
const MOST_DOUBLES: f32 = 0.5;
/// Slower readings are those of a train that stands, steps.
const STANDS: f32 = 0.25;
/// Standard deviation of a speed on the edge of two steps, km/h, and how it grows with turns over steps: noise of 0.1
/// km/h shows in few.
const EDGE_SD_KMH: f32 = 0.1;
const TURNS_SD_KMH: f32 = 0.3;
/// By how much of a step a single one may differ from it: the numbers of a log are rounded.
const TOLERANCE: f32 = 0.1;

impl Staircase {
    /// A tick, with its speed if there is one.
    // Of its own, so that what it takes on the stack is given back before a segment goes on.
    #[inline(never)]
    pub(crate) fn observe(&mut self, sensor: &SensorConfig, dt_s: f32, speed_mps: Option<f32>) {
        self.edge_mps = None;
        self.unread_s += dt_s;
        self.changed_s += dt_s;
        let Some(speed_mps) = speed_mps else {
            return;
        };
        let row_s = core::mem::take(&mut self.unread_s);
        let last_mps = core::mem::replace(&mut self.last_mps, speed_mps);
        let change_mps = speed_mps - last_mps;
        let step_mps = sensor.speed_quantum_kmh as f32 / 3.6;
        if change_mps.abs() < TOLERANCE * step_mps {
            return;
        }
        let moved = speed_mps > STANDS * step_mps && last_mps > STANDS * step_mps;
        if !moved {
            self.judge();
        }
        let steps = change_mps.abs() / step_mps;
        let single_mps = if (steps - 1.0).abs() < TOLERANCE { change_mps } else { 0.0 };
        let stood_s = core::mem::take(&mut self.changed_s);
        let turns = single_mps * core::mem::replace(&mut self.single_mps, single_mps) < 0.0 && stood_s <= TURNED_S;
        let turned = core::mem::replace(&mut self.turned, turns);
        if row_s > LONGEST_ROW_S || !moved {
            return;
        }
        self.turns = self.turns.saturating_add(u16::from(turns && turned));
        let is_double = (steps - 2.0).abs() < TOLERANCE && stood_s > TURNED_S;
        self.doubles = self.doubles.saturating_add(u16::from(is_double));
        if single_mps != 0.0 {
            self.steps = self.steps.saturating_add(u16::from(stood_s > STOOD_S));
            self.edge_mps = Some(speed_mps - 0.5 * single_mps);
            self.edge_row_s = row_s;
        }
    }

    /// Whether the steps are believed on this hop.
    fn judge(&mut self) {
        let turns = f32::from(self.turns) / f32::from(self.steps);
        let are_clean = self.steps >= LEAST_STEPS && turns <= MOST_TURNS && !self.is_another_unit();
        self.edge_sd_kmh = are_clean.then_some(EDGE_SD_KMH + TURNS_SD_KMH * turns);
    }

    /// The steps are those of a larger unit, of which many are written as two: the readings are coarser than they look.
    pub(crate) fn is_another_unit(&self) -> bool {
        self.doubles >= LEAST_STEPS && f32::from(self.doubles) > MOST_DOUBLES * f32::from(self.steps)
    }

    /// The readings look like whole steps with little noise.
    pub(crate) fn is_clean(&self) -> bool {
        self.edge_sd_kmh.is_some()
    }

    /// What the last row says, if the readings are clean.
    pub(crate) fn edge(&self) -> Option<Edge> {
        let sd_mps = self.edge_sd_kmh? / 3.6;
        Some(self.edge_mps.map_or(Edge::None, |mps| Edge::Passed { mps, sd_mps, row_s: self.edge_row_s }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::extremes::Extremes;
    use heapless::Vec;

    fn passed_mps(staircase: &Staircase) -> Option<f32> {
        match staircase.edge()? {
            Edge::Passed { mps, .. } => Some(mps),
            Edge::None => None,
        }
    }

    const HOP_S: u16 = 120;

    /// A train that powers to 70 km/h, coasts and brakes.
    fn hop_kmh(time_s: f32) -> f32 {
        let powers_kmh = 3.2 * time_s;
        let coasts_kmh = 70.0 - 0.17 * (time_s - 22.0);
        let brakes_kmh = 3.6 * (115.0 - time_s);
        powers_kmh.at_most(coasts_kmh).at_most(brakes_kmh).at_least(0.0)
    }

    /// After three hops, with speeds in whole units that are written in steps, and with noise.
    fn after_hops(unit_kmh: f32, written_kmh: f32, noise_kmh: f32) -> Staircase {
        after_hops_rounded(libm::roundf, unit_kmh, written_kmh, noise_kmh)
    }

    /// `round`: rounded or cut off.
    fn after_hops_rounded(round: fn(f32) -> f32, unit_kmh: f32, written_kmh: f32, noise_kmh: f32) -> Staircase {
        let mut staircase = Staircase::default();
        for tick in 0..3 * HOP_S {
            // Three waves of unlike length are normal noise, nearly.
            let waves = [2.5, 1.3, 0.7].map(|pace| libm::sinf(pace * f32::from(tick)));
            let noise_kmh = noise_kmh * libm::sqrtf(2.0 / 3.0) * waves.iter().sum::<f32>();
            let true_kmh = hop_kmh(f32::from(tick % HOP_S));
            let noisy_kmh = if true_kmh > 0.0 { (true_kmh + noise_kmh).at_least(0.0) } else { 0.0 };
            let unit_kmh = round(noisy_kmh / unit_kmh) * unit_kmh;
            let read_kmh = libm::roundf(unit_kmh / written_kmh) * written_kmh;
            staircase.observe(&SensorConfig::default(), 1.0, Some(read_kmh / 3.6));
        }
        staircase
    }

    #[test]
    fn edges_of_a_rounded_speed_are_known_to_a_tenth_of_a_kmh() {
        let mut staircase = after_hops(1.0, 1.0, 0.0);
        let mut edges = Vec::<_, 120>::new();
        for second in 0..HOP_S {
            let time_s = f32::from(second);
            staircase.observe(&SensorConfig::default(), 1.0, Some(libm::roundf(hop_kmh(time_s)) / 3.6));
            let coasts = (25.0..94.0).contains(&time_s);
            let edge = passed_mps(&staircase).filter(|_| coasts);
            edges.extend(edge.map(|edge_mps| (3.6 * edge_mps, hop_kmh(time_s - 0.5))));
        }
        assert!(edges.len() >= 10, "{edges:?}");
        assert!(edges.iter().all(|(edge_kmh, true_kmh)| (edge_kmh - true_kmh).abs() < 0.1), "{edges:?}");
    }

    #[test]
    fn noise_makes_edges_worth_less_and_much_of_it_nothing() {
        let sd_kmh = |noise_kmh| after_hops(1.0, 1.0, noise_kmh).edge_sd_kmh;
        assert_eq!(sd_kmh(0.0), Some(0.1));
        assert!(sd_kmh(0.15).is_some_and(|sd_kmh| (0.13..0.25).contains(&sd_kmh)), "{:?}", sd_kmh(0.15));
        for noise_kmh in [0.3, 0.5, 1.0] {
            assert_eq!(sd_kmh(noise_kmh), None, "{noise_kmh}");
        }
    }

    #[test]
    fn finer_and_coarser_units_have_no_edges_however_they_are_written() {
        let [mph, knot, mps] = [1.609_344, 1.852, 3.6];
        for (unit_kmh, written_kmh) in [(0.1, 0.1), (0.5, 0.5), (mph, 0.01), (mph, 1.0), (knot, 1.0), (0.5 * mps, 1.0)]
        {
            assert!(!after_hops(unit_kmh, written_kmh, 0.0).is_clean(), "{unit_kmh} {written_kmh}");
        }
        for unit_kmh in [mph, knot, 0.5 * mps] {
            for round in [libm::roundf, libm::floorf] {
                assert!(after_hops_rounded(round, unit_kmh, 1.0, 0.0).is_another_unit(), "{unit_kmh}");
            }
        }
        for noise_kmh in [0.0, 0.5, 1.0] {
            assert!(!after_hops(1.0, 1.0, noise_kmh).is_another_unit(), "{noise_kmh}");
        }
    }

    #[test]
    fn steps_are_believed_from_the_next_standstill_on() {
        let after = |row_s: f32, steps: u8| {
            let mut staircase = Staircase::default();
            for third in 0..3 * u16::from(steps) + 3 {
                let kmh = 40.0 - f32::from(third / 3);
                staircase.observe(&SensorConfig::default(), row_s, Some(kmh / 3.6));
            }
            assert!(!staircase.is_clean(), "the train has not stood since");
            staircase.observe(&SensorConfig::default(), row_s, Some(0.0));
            staircase.is_clean()
        };
        // Of clocks that count milliseconds.
        assert!(after(1.0, 5) && after(2.001, 5));
        assert!(!after(1.0, 4), "few");
        assert!(!after(2.5, 5), "rows too far apart for edges");
    }

    #[test]
    fn a_brake_after_a_short_coast_is_no_noise() {
        for row_s in [1.0, 2.0] {
            let mut staircase = Staircase::default();
            for tick in 0..200_u8 {
                let time_s = f32::from(tick) * row_s % 50.0;
                let kmh =
                    (3.2 * time_s).at_most(64.0 - 0.17 * (time_s - 20.0)).at_most(3.6 * (48.0 - time_s)).at_least(0.0);
                staircase.observe(&SensorConfig::default(), row_s, Some(libm::roundf(kmh) / 3.6));
            }
            assert_eq!(staircase.edge_sd_kmh, Some(0.1), "rows of {row_s} s");
        }
    }

    #[test]
    fn an_edge_beyond_a_missing_reading_has_the_time_since_the_one_before_and_beyond_more_of_them_there_is_none() {
        let passed = |missing: u8| {
            let mut staircase = Staircase { edge_sd_kmh: Some(0.1), last_mps: 20.0, ..Staircase::default() };
            let sensor = SensorConfig::default();
            for _ in 0..missing {
                staircase.observe(&sensor, 1.0, None);
                assert_eq!(staircase.edge(), Some(Edge::None));
            }
            staircase.observe(&sensor, 1.0, Some(20.0 - 1.0 / 3.6));
            match staircase.edge() {
                Some(Edge::Passed { mps, sd_mps, row_s }) => Some([3.6 * (20.0 - mps), 3.6 * sd_mps, row_s]),
                _ => None,
            }
        };
        for (missing, row_s) in [(0, 1.0), (1, 2.0)] {
            let found = passed(missing).unwrap();
            assert!(found.iter().zip([0.5, 0.1, row_s]).all(|(found, is)| (found - is).abs() < 1e-5), "{found:?}");
        }
        assert_eq!(passed(2), None);
    }
}
