//! Speeds in whole steps: where a reading steps, the speed is known far better than between.
//!
//! In: each reading of the speed. Out: the speed on the edge between two steps when a reading has just passed it, and
//! whether the readings are such a staircase.
//!
//! A coasting train crosses 1 km/h in some 6 s, and its readings stay the same meanwhile: six of them say what one
//! does. But when the reading falls from 80 to 79 km/h the train passed 79.5 within the last row. That holds for a
//! speed that is rounded and not noisy; noise makes readings go up and down about an edge.

use crate::tick::sensor::SensorConfig;
use crate::tick::snapshot::in_place;

in_place! {
    /// The steps of a run.
    #[derive(Clone, Copy, Debug, Default, PartialEq)]
    pub struct Staircase {
        last_mps: f32 = (0.0);
        /// Since the last reading, s.
        unread_s: f32 = (0.0);
        /// The last change of the reading, m/s, if it was a single step, and the time since, s.
        single_mps: f32 = (0.0);
        changed_s: f32 = (0.0);
        /// Single steps, and changes that a train does not make or a rounded speed does not show.
        steps: u16 = (0);
        odd: u16 = (0);
        /// The edge that has just been passed, m/s.
        edge_mps: Option<f32> = (None);
    }
}

/// What a row of a staircase says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Edge {
    /// The reading stayed where it was, or changed by several steps.
    None,
    /// It stepped: the speed that was passed within the row, m/s.
    Passed(f32),
}

/// Rows farther apart have no edges, s: within 2 s a coasting train crosses a third of a step.
pub(crate) const LONGEST_ROW_S: f32 = 2.0;
/// A step back within so many seconds is noise, s: no train accelerates and decelerates so fast.
const TURNED_S: f32 = 3.0;
/// Single steps from which on they are believed, and the share of odd changes up to which they are.
const LEAST_STEPS: u16 = 5;
const MOST_ODD: u16 = 20;
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
        let change_mps = speed_mps - core::mem::replace(&mut self.last_mps, speed_mps);
        let step_mps = sensor.speed_quantum_kmh as f32 / 3.6;
        if change_mps.abs() < TOLERANCE * step_mps {
            return;
        }
        let steps = change_mps.abs() / step_mps;
        let single_mps = if (steps - 1.0).abs() < TOLERANCE { change_mps } else { 0.0 };
        let turned = single_mps * core::mem::replace(&mut self.single_mps, single_mps) < 0.0;
        let changed_s = core::mem::take(&mut self.changed_s);
        if (turned && changed_s <= TURNED_S) || steps < 1.0 - TOLERANCE {
            self.odd = self.odd.saturating_add(1);
        }
        if single_mps != 0.0 && row_s <= LONGEST_ROW_S {
            self.steps = self.steps.saturating_add(1);
            self.edge_mps = Some(speed_mps - 0.5 * single_mps);
        }
    }

    /// The readings look like whole steps without noise.
    pub(crate) fn is_clean(&self) -> bool {
        self.steps >= LEAST_STEPS && u32::from(self.odd) * u32::from(MOST_ODD) <= u32::from(self.steps)
    }

    /// What the last row says, if the readings are clean.
    pub(crate) fn edge(&self) -> Option<Edge> {
        self.is_clean().then(|| self.edge_mps.map_or(Edge::None, Edge::Passed))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use heapless::Vec;

    fn passed_mps(staircase: &Staircase) -> Option<f32> {
        match staircase.edge()? {
            Edge::Passed(mps) => Some(mps),
            Edge::None => None,
        }
    }

    /// A train that coasts from 80 km/h on, read with a step and a noise, km/h; the edges with the true speed in the
    /// middle of their row, km/h, and whether the readings are a clean staircase.
    fn coast(step_kmh: f32, noise_kmh: f32) -> (Vec<(f32, f32), 120>, bool) {
        let mut staircase = Staircase::default();
        let mut edges = Vec::new();
        let at_kmh = |time_s: f32| 80.0 - 0.17 * time_s;
        for tick in 0..120_u8 {
            let time_s = f32::from(tick);
            let noisy_kmh = at_kmh(time_s) + noise_kmh * libm::sinf(2.5 * time_s);
            let read_kmh = libm::roundf(noisy_kmh / step_kmh) * step_kmh;
            staircase.observe(&SensorConfig::default(), 1.0, Some(read_kmh / 3.6));
            edges.extend(passed_mps(&staircase).map(|edge_mps| (3.6 * edge_mps, at_kmh(time_s - 0.5))));
        }
        (edges, staircase.is_clean())
    }

    #[test]
    fn edges_of_a_rounded_speed_are_known_to_a_tenth_of_a_kmh() {
        let (edges, clean) = coast(1.0, 0.0);
        assert!(clean && edges.len() >= 14, "{edges:?}");
        assert!(edges.iter().all(|(edge_kmh, true_kmh)| (edge_kmh - true_kmh).abs() < 0.1), "{edges:?}");
    }

    #[test]
    fn noisy_speeds_and_finer_ones_have_no_edges() {
        for (step_kmh, noise_kmh) in [(1.0, 0.5), (0.1, 0.0), (0.5, 0.0), (1.609_344, 0.0)] {
            let (edges, clean) = coast(step_kmh, noise_kmh);
            assert!(!clean && edges.len() < 5, "{step_kmh} {noise_kmh}: {edges:?}");
        }
    }

    #[test]
    fn an_edge_beyond_missing_readings_is_none() {
        let mut staircase = Staircase { steps: 10, last_mps: 20.0, ..Staircase::default() };
        let sensor = SensorConfig::default();
        for _ in 0..3 {
            staircase.observe(&sensor, 1.0, None);
            assert_eq!(staircase.edge(), Some(Edge::None));
        }
        staircase.observe(&sensor, 1.0, Some(20.0 - 1.0 / 3.6));
        assert_eq!(staircase.edge(), Some(Edge::None));
        staircase.observe(&sensor, 1.0, Some(20.0 - 2.0 / 3.6));
        assert!(passed_mps(&staircase).is_some_and(|edge_mps| (edge_mps - (20.0 - 1.5 / 3.6)).abs() < 1e-5));
    }
}
