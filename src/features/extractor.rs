//! One run, tick by tick, to its features.
//!
//! In: [`Observation`]s in order of time, one a tick. Out: [`Features`] at any time. Memory is fixed (11.3 kB, most of
//! it the histogram of held speeds and the course of the last minutes); a tick costs some hundred operations, a few
//! thousand where a switching point is new.
//!
//! A tick without effort (dropout) adds its time to its regime and nothing else. It cuts the intervals that rates,
//! powers and efforts are taken from, but not the phases: these go on when the regime after the gap is that before it.

use super::approach::final_phases;
use super::hindsight::Hindsight;
use super::interval::{Interval, Stretches};
use super::onset::RecentTicks;
use super::phases::{Boundary, Phases};
use super::statistic::{LineFit, WeightedMoments};
use super::steady::SteadyIntervals;
use super::{Energy, FeatureConfig, Features, MAX_SWITCHING_POINTS, Observation, SwitchingPoint};
use crate::Real;
use crate::extremes::Extremes;
use crate::model::resistance::Davis;
use crate::model::units::KmPerHour;
use crate::tick::regime::Regime;
use crate::tick::snapshot::{InPlace, in_place};
use heapless::{Deque, Vec};

/// Boundaries kept with what is needed to place them; the final approach must lie within them.
const MAX_RECENT: usize = 24;

/// So many times `window_s` without a tick are a pause of the recorder.
const PAUSE_WINDOWS: Real = 2.0;
/// As near a train goes on from where it was about to stand, m.
const PLATFORM_M: Real = 100.0;
/// A train that is farther from where it stood last has left, m: its final phases are still to come.
const LEFT_M: Real = 300.0;

in_place! {
    /// Collects the features of a run.
    #[derive(Clone, Debug)]
    pub struct FeatureExtractor {
        before: Option<Observation> = (None, zeroed Some(Observation::ZEROED));
        stretches: Stretches = (in place);
        steady_effort: SteadyIntervals = (in place);
        steady_power: SteadyIntervals = (in place);
        steady_brake: SteadyIntervals = (in place);
        effort: LineFit = (LineFit::ZEROED);
        power: WeightedMoments = (WeightedMoments::ZEROED);
        power_hindsight: Hindsight = (Hindsight::ZEROED);
        max_power_w_per_kg: Option<Real> = (None);
        brake_rates: [WeightedMoments; 5] = ([WeightedMoments::ZEROED; 5]);
        phases: Phases = (in place);
        course: RecentTicks = (in place);
        recent: Deque<(Boundary, SwitchingPoint), MAX_RECENT> = (in place);
        older: Vec<SwitchingPoint, MAX_SWITCHING_POINTS> = (in place);
        lost: u32 = (0);
        top_speed_mps: Real = (0.0);
        arrival_top_speed_mps: Real = (0.0);
        regime_time_s: [Real; 5] = ([0.0; 5]);
        energy: Energy = (Energy::ZEROED);
    }
}

impl Default for FeatureExtractor {
    fn default() -> Self {
        Self::new()
    }
}

impl FeatureExtractor {
    /// Before the first tick of a run.
    pub fn new() -> Self {
        let mut extractor = Self::ZEROED;
        extractor.clear_fields();
        extractor.begin();
        extractor
    }

    /// After [`InPlace::clear_fields`]: which regime each of the filters is for.
    pub(crate) fn begin(&mut self) {
        self.steady_effort.begin(Regime::Traction);
        self.steady_power.begin(Regime::Traction);
        self.steady_brake.begin(Regime::Brake);
    }

    /// Takes the next tick, with its confirmed regime.
    pub fn observe(&mut self, config: &FeatureConfig, tick: &Observation) {
        let since_s = self.before.map_or(0.0, |before| tick.time_s - before.time_s);
        if since_s <= PAUSE_WINDOWS * config.window_s || !self.stops_before(config, tick) {
            return self.take(config, tick);
        }
        self.take(config, &Observation { dt_s: config.window_s, ..*tick });
    }

    /// The run is over. One that ends where the train would stand within `window_s` ends with that stop.
    pub fn end(&mut self, config: &FeatureConfig) {
        if let Some(stands) = self.course.stop_ahead(config) {
            self.take(config, &stands);
        }
    }

    /// A recorder that has no rows while the train stands often lacks the last seconds before, too: it stood where it
    /// goes on from.
    fn stops_before(&mut self, config: &FeatureConfig, tick: &Observation) -> bool {
        let here = |stands: &Observation| (tick.location_m - stands.location_m).abs() < PLATFORM_M;
        let Some(mut stands) = self.course.stop_ahead(config).filter(here) else {
            return false;
        };
        self.take(config, &stands);
        let until_s = tick.time_s - config.window_s;
        stands.dt_s = until_s - stands.time_s;
        stands.time_s = until_s;
        stands.effort_n_per_kg = Some(stands.gradient_n_per_kg);
        stands.acceleration_mps2 = Some(0.0);
        self.take(config, &stands);
        true
    }

    fn take(&mut self, config: &FeatureConfig, tick: &Observation) {
        let before = self.before.replace(*tick);
        self.course.push(config, tick);
        let Some(before) = before else {
            self.phases.begin(tick.time_s, tick.regime);
            return;
        };
        self.add_time(&before, tick);
        self.add_top_speed(&before, tick);
        if let Some(interval) = Interval::between(&before, tick) {
            self.energy.add(&before, tick, &interval);
            self.add_rates(config, &tick.davis, &interval);
            self.add_boundaries(config, tick.time_s, &interval);
        } else {
            self.stretches.interrupt();
            self.steady_effort.interrupt();
            self.steady_power.interrupt();
            self.steady_brake.interrupt();
        }
        self.place_recent(config, tick);
    }

    /// What the run has said up to now.
    pub fn features(&self, config: &FeatureConfig) -> Features {
        let mut features = Features::NONE;
        self.features_in(config, &mut features);
        features
    }

    /// As [`FeatureExtractor::features`], in the place of others: they take 2.6 kB, which the board does not have on
    /// its stack.
    pub fn features_in(&self, config: &FeatureConfig, features: &mut Features) {
        let line_speed_mps = config.approach_share * self.arrival_top_speed_mps;
        let at = |i| self.recent.get(i).map(|(_, point)| point);
        let is_there =
            |stop: &SwitchingPoint| self.before.is_none_or(|last| (last.location_m - stop.location_m).abs() < LEFT_M);
        (features.final_coast, features.final_brake) = final_phases(self.recent.len(), at, is_there, line_speed_mps);
        features.switching_points.clear();
        features.switching_points_lost = self.lost;
        for i in 0..self.older.len() + self.recent.len() {
            let point = self.older.get(i).or_else(|| at(i.wrapping_sub(self.older.len())));
            let Some(point) = point else { break };
            if features.switching_points.push(*point).is_err() {
                features.switching_points_lost = features.switching_points_lost.saturating_add(1);
            }
        }
        let cruise = self.phases.held_speeds().cruise_speed(config.cruise_band_kmh);
        features.cruise_speed_mps = cruise.map(|(_, statistic)| statistic).unwrap_or_default();
        features.cruise_speed_median_mps = cruise.map(|(median_mps, _)| median_mps);
        features.power_w_per_kg = self.power.statistic();
        if let Some(last) = &self.before {
            features.power_w_per_kg.mean += self.power_hindsight.correction_w_per_kg(&last.davis);
        }
        features.max_effort = self.effort.line();
        features.max_power_w_per_kg = self.max_power_w_per_kg;
        for (statistic, rates) in features.brake_rate_mps2.iter_mut().zip(&self.brake_rates) {
            *statistic = rates.statistic();
        }
        features.regime_time_s = self.regime_time_s;
        features.energy = self.energy;
    }

    /// The interval at whose end the train stands is divided where the deceleration before it leads to a stop.
    fn add_time(&mut self, before: &Observation, tick: &Observation) {
        if tick.dt_s.is_nan() || tick.dt_s <= 0.0 {
            return;
        }
        let stops = tick.regime == Regime::Standstill && before.regime != Regime::Standstill;
        let moving_s = match before.acceleration_mps2 {
            Some(rate) if stops && rate < 0.0 => (before.speed_mps / -rate).at_most(tick.dt_s),
            _ => 0.0,
        };
        for (regime, dt_s) in [(before.regime, moving_s), (tick.regime, tick.dt_s - moving_s)] {
            if let Some(time_s) = self.regime_time_s.get_mut(regime as usize) {
                *time_s += dt_s;
            }
        }
    }

    fn add_top_speed(&mut self, before: &Observation, tick: &Observation) {
        match (before.regime, tick.regime) {
            (Regime::Standstill, Regime::Standstill) => {}
            (_, Regime::Standstill) => self.arrival_top_speed_mps = self.top_speed_mps,
            (Regime::Standstill, _) => self.top_speed_mps = tick.speed_mps,
            _ => self.top_speed_mps = self.top_speed_mps.at_least(tick.speed_mps),
        }
    }

    fn add_rates(&mut self, config: &FeatureConfig, davis: &Davis, interval: &Interval) {
        let bridge = config.bridge_samples;
        for steady in self.steady_effort.shown_by(interval) {
            let [lower_kmh, _] = config.effort_window_kmh;
            let mean_mps = steady.mean_mps();
            let inside = FeatureConfig::contains(config.effort_window_kmh, mean_mps, mean_mps);
            if inside && steady.after_mps > steady.before_mps {
                self.effort.add(mean_mps - KmPerHour(lower_kmh).to_mps(), steady.effort_n_per_kg());
            }
        }
        self.steady_effort.push(bridge, interval);
        let Some(stretch) = self.stretches.push(config.window_s, interval) else {
            return;
        };
        for steady in self.steady_power.shown_by(&stretch) {
            let inside = |window| FeatureConfig::contains(window, steady.before_mps, steady.after_mps);
            let power_w_per_kg = steady.power_w_per_kg();
            if inside(config.power_window_kmh) {
                self.power.add(power_w_per_kg, steady.dt_s);
                self.power_hindsight.add(davis, steady.mean_mps(), steady.dt_s);
            }
            if inside(config.max_power_window_kmh) {
                let max = self.max_power_w_per_kg;
                self.max_power_w_per_kg = Some(max.map_or(power_w_per_kg, |max| max.at_least(power_w_per_kg)));
            }
        }
        self.steady_power.push(bridge, &stretch);
        for steady in self.steady_brake.shown_by(&stretch) {
            let mean_mps = steady.mean_mps();
            let step =
                config.brake_steps_kmh.iter().filter(|edge_kmh| mean_mps <= KmPerHour(**edge_kmh).to_mps()).count();
            let moves = steady.after_mps > KmPerHour(config.stop_speed_kmh).to_mps();
            if let Some(rate) = self.brake_rates.get_mut(step).filter(|_| moves) {
                rate.add(-steady.acceleration_mps2(), steady.dt_s);
            }
        }
        self.steady_brake.push(bridge, &stretch);
    }

    fn add_boundaries(&mut self, config: &FeatureConfig, end_s: Real, interval: &Interval) {
        for boundary in &self.phases.push(config, end_s, interval) {
            let same =
                |(old, _): &(Boundary, SwitchingPoint)| (old.time_s, old.from) == (boundary.time_s, boundary.from);
            if self.recent.back().is_some_and(same) {
                self.recent.pop_back();
            }
            if self.recent.is_full()
                && let Some((_, oldest)) = self.recent.pop_front()
                && self.older.push(oldest).is_err()
            {
                self.lost = self.lost.saturating_add(1);
            }
            let point = self.course.locate(config, boundary, [Real::MIN, Real::MIN, Real::MAX, Real::MAX]);
            // There is room now.
            let _kept = self.recent.push_back((*boundary, point)).is_ok();
        }
    }

    /// When this switching point is, where there is one.
    #[inline(never)]
    fn place_s(&self, i: usize, otherwise_s: Real) -> Real {
        self.recent.get(i).map_or(otherwise_s, |(_, point)| point.time_s)
    }

    /// Places those points again whose surroundings are still coming in.
    fn place_recent(&mut self, config: &FeatureConfig, tick: &Observation) {
        let open_since_s = tick.time_s - 8.0 * config.window_s.at_least(tick.dt_s);
        for i in (0..self.recent.len()).rev() {
            let Some((boundary, _)) = self.recent.get(i).copied() else {
                return;
            };
            if boundary.time_s < open_since_s {
                return;
            }
            let after_s = self.place_s(i.wrapping_sub(1), Real::MIN);
            // What looks like a short cruise between power and coast may be their mean.
            let was_powered =
                self.recent.get(i.wrapping_sub(1)).is_some_and(|(before, _)| before.from == Regime::Traction);
            let is_short = boundary.from == Regime::Cruise && boundary.time_s - after_s < 3.0 * config.window_s;
            let since_s = if was_powered && is_short { self.place_s(i.wrapping_sub(2), after_s) } else { after_s };
            let next_s = self.place_s(i + 1, Real::MAX);
            // A coast that was found before this boundary ends it there.
            let before_s = match self.recent.get(i + 1) {
                Some((next, _)) if next_s >= boundary.time_s => next.time_s,
                _ => next_s,
            };
            let point = self.course.locate(config, &boundary, [since_s, after_s, before_s, next_s]);
            if let Some((_, place)) = self.recent.get_mut(i) {
                *place = point;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::super::Statistic;
    use super::*;
    use crate::model::resistance::Davis;
    use Regime::{Brake, Coast, Cruise, Standstill, Traction};

    const NO_RESISTANCE: Davis = Davis { r0: 0.0, r1: 0.0, r2: 0.0 };

    /// Ticks of 10 s on a flat track without resistance: speed in km/h, regime.
    fn run_of(rows: &[(Real, Regime)], davis: Davis) -> FeatureExtractor {
        let mut extractor = FeatureExtractor::new();
        let mut before: Option<Observation> = None;
        for &(kmh, regime) in rows {
            let speed_mps = kmh / 3.6;
            let last_mps = before.map_or(speed_mps, |last| last.speed_mps);
            let rate = (speed_mps - last_mps) / 10.0;
            let tick = Observation {
                time_s: before.map_or(0.0, |last| last.time_s + 10.0),
                dt_s: before.map_or(0.0, |_| 10.0),
                location_m: before.map_or(0.0, |last| last.location_m + 5.0 * (speed_mps + last_mps)),
                speed_mps,
                effort_n_per_kg: Some(rate + davis.resistance_n_per_kg(0.5 * (speed_mps + last_mps))),
                acceleration_mps2: Some(rate),
                gradient_n_per_kg: 0.0,
                davis,
                regime,
            };
            extractor.observe(&FeatureConfig::default(), &tick);
            before = Some(tick);
        }
        extractor
    }

    fn features_of(rows: &[(Real, Regime)]) -> Features {
        run_of(rows, NO_RESISTANCE).features(&FeatureConfig::default())
    }

    fn near(found: Real, expected: Real) -> bool {
        (found - expected).abs() < 1e-9
    }

    #[test]
    fn nothing_seen_says_so() {
        assert_eq!(FeatureExtractor::new().features(&FeatureConfig::default()), Features::default());
        let stands = features_of(&[(0.0, Standstill); 4]);
        assert_eq!(stands.regime_time_s, [30.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(stands.final_brake, None);
        assert_eq!(stands.cruise_speed_median_mps, None);
    }

    #[test]
    fn power_takes_whole_intervals_inside_the_window() {
        // 40-50 begins outside, 120-131 ends outside, 50-60 has the smallest power, 110-120 the largest.
        let speeds = [40.0, 50.0, 60.0, 90.0, 110.0, 120.0, 131.0, 140.0, 140.0];
        let rows: std::vec::Vec<_> = speeds.into_iter().map(|kmh| (kmh, Traction)).collect();
        let features = features_of(&rows);
        let half_squares = |a: Real, b: Real| (b * b - a * a) / (3.6 * 3.6) / 20.0;
        assert_eq!(features.power_w_per_kg.count, 4);
        assert!(near(features.power_w_per_kg.mean, half_squares(50.0, 120.0) / 4.0));
        assert!(near(features.max_power_w_per_kg.unwrap(), half_squares(60.0, 90.0)));
    }

    #[test]
    fn power_leaves_out_where_traction_begins_and_ends() {
        let rows = [
            (60.0, Coast),
            (65.0, Traction),
            (75.0, Traction),
            (85.0, Traction),
            (88.0, Traction),
            (88.0, Cruise),
            (88.0, Coast),
            (88.0, Coast),
        ];
        let features = features_of(&rows);
        assert_eq!(features.power_w_per_kg.count, 2);
        assert!(near(features.power_w_per_kg.mean, 10.0 / 36.0 * 75.0 / 3.6));
    }

    #[test]
    fn effort_line_of_two_intervals() {
        // Mean speeds 12 and 24 km/h; the first interval and the one about 36 km/h are out.
        let rows =
            [(0.0, Standstill), (6.0, Traction), (18.0, Traction), (30.0, Traction), (40.0, Traction), (40.0, Coast)];
        let line = features_of(&rows).max_effort.unwrap();
        assert_eq!(line.effort.count, 2);
        assert!(near(line.effort.mean, 12.0 / 36.0));
        assert!(near(line.slope, 0.0));
        assert!(near(line.at_lower_n_per_kg, 12.0 / 36.0));
    }

    #[test]
    fn brake_rates_fall_into_their_steps() {
        let rows = [
            (140.0, Coast),
            (138.0, Brake),
            (134.0, Brake),
            (125.0, Brake),
            (100.0, Brake),
            (82.0, Brake),
            (74.0, Brake),
            (64.0, Brake),
            (52.0, Brake),
            (44.0, Brake),
            (30.0, Brake),
            (12.0, Brake),
            (0.0, Standstill),
        ];
        let steps = features_of(&rows).brake_rate_mps2;
        // The first interval (140-138) and the last (12-0) are out.
        assert_eq!(steps.map(|step| step.count), [1, 3, 2, 2, 2]);
        let kmh_in_10_s: std::vec::Vec<_> = steps.iter().map(|step| step.mean * 36.0).collect();
        let expected = [4.0, 52.0 / 3.0, 9.0, 10.0, 16.0];
        assert!(kmh_in_10_s.iter().zip(expected).all(|(found, expected)| near(*found, expected)), "{kmh_in_10_s:?}");
    }

    #[test]
    fn final_phases_begin_between_ticks() {
        // Braked at 0.4 m/s² (14.4 km/h in 10 s), begun 4 s before the end of its first interval; stands within its
        // last.
        let mut rows =
            std::vec![(100.0, Cruise), (100.0, Cruise), (100.0, Coast), (100.0, Coast), (100.0, Coast), (100.0, Coast)];
        rows.extend((0..7).map(|k| (100.0 - 5.76 - 14.4 * Real::from(k), Brake)));
        rows.extend([(0.0, Standstill), (0.0, Standstill)]);
        // 100 - 5.76 - 86.4 = 7.84 km/h are gone after 5.44 s.
        let brake = features_of(&rows).final_brake.unwrap();
        assert!(near(brake.start_time_s, 56.0));
        assert!(near(brake.start_speed_mps, 100.0 / 3.6));
        assert!(near(brake.start_location_m, 56.0 * 100.0 / 3.6));
        assert!(near(brake.duration_s, 100.0 / 3.6 / 0.4));
    }

    /// Braked at 0.4 m/s² from 100 km/h after a coast; the last tick before the stop has 13.6 km/h.
    fn arrival() -> std::vec::Vec<(Real, Regime)> {
        let mut rows = std::vec![(60.0, Traction), (80.0, Traction), (100.0, Traction)];
        rows.extend((1..=5).map(|k| (100.0 - Real::from(k), Coast)));
        rows.extend((1..=6).map(|k| (100.0 - 14.4 * Real::from(k), Brake)));
        rows
    }

    #[test]
    fn a_run_that_ends_before_it_stands_has_a_final_brake() {
        let config = FeatureConfig::default();
        let mut whole = arrival();
        whole.extend([(0.0, Standstill), (0.0, Standstill)]);
        let whole = features_of(&whole);
        let mut cut = run_of(&arrival(), NO_RESISTANCE);
        assert_eq!(cut.features(&config).final_brake, None);
        cut.end(&config);
        let cut = cut.features(&config);
        let (found, expected) = (cut.final_brake.unwrap(), whole.final_brake.unwrap());
        assert!((found.duration_s - expected.duration_s).abs() < 0.1, "{found:?} {expected:?}");
        assert!((found.length_m - expected.length_m).abs() < 25.0, "{found:?} {expected:?}");
        assert_eq!(found.start_time_s, expected.start_time_s);
        assert_eq!(cut.final_coast, whole.final_coast);
        assert!(cut.final_coast.is_some());
    }

    #[test]
    fn a_run_that_ends_at_speed_has_no_final_brake() {
        let config = FeatureConfig::default();
        for ticks in 1..=5 {
            let rows = arrival();
            let mut cut = run_of(&rows[..rows.len() - ticks], NO_RESISTANCE);
            cut.end(&config);
            assert_eq!(cut.features(&config).final_brake, None);
        }
    }

    #[test]
    fn a_train_that_has_left_its_last_stop_has_no_final_brake() {
        let mut rows = arrival();
        rows.extend([(0.0, Standstill), (0.0, Standstill), (30.0, Traction)]);
        assert!(features_of(&rows).final_brake.is_some());
        rows.extend([(60.0, Traction), (80.0, Traction), (80.0, Cruise)]);
        let left = features_of(&rows);
        assert_eq!((left.final_brake, left.final_coast), (None, None));
    }

    /// Rows are missing while the train stands at a platform: it stood, and did not brake for five minutes.
    #[test]
    fn a_pause_where_the_train_was_about_to_stand_is_a_stop() {
        let config = FeatureConfig::default();
        let goes_on = |metres: Real| {
            let mut run = run_of(&arrival(), NO_RESISTANCE);
            let last = run.before.unwrap();
            let tick = |after_s: Real, kmh: Real, location_m: Real| Observation {
                time_s: last.time_s + after_s,
                dt_s: if after_s > 300.0 { 10.0 } else { after_s },
                location_m,
                speed_mps: kmh / 3.6,
                effort_n_per_kg: (after_s > 300.0).then_some(0.4),
                acceleration_mps2: Some(0.4),
                regime: Traction,
                ..last
            };
            let begin_m = last.location_m + metres;
            for tick in [tick(300.0, 14.4, begin_m), tick(310.0, 28.8, begin_m + 60.0)] {
                run.observe(&config, &tick);
            }
            run.features(&config)
        };
        let mut whole = arrival();
        whole.extend([(0.0, Standstill), (0.0, Standstill)]);
        let expected = features_of(&whole).final_brake.unwrap();
        let stood = goes_on(60.0);
        assert!((stood.final_brake.unwrap().duration_s - expected.duration_s).abs() < 0.1, "{stood:?}");
        assert!(stood.regime_time_s[Brake as usize] < 80.0, "{stood:?}");
        assert!((stood.regime_time_s[Standstill as usize] - 280.6).abs() < 0.1, "{stood:?}");
        let elsewhere = goes_on(3000.0);
        assert_eq!(elsewhere.final_brake, None);
    }

    #[test]
    fn time_is_divided_where_the_train_stops() {
        let rows = [(36.0, Coast), (27.0, Brake), (18.0, Brake), (9.0, Brake), (0.0, Standstill), (0.0, Standstill)];
        // At 0.25 m/s² it needs all of the 10 s.
        assert_eq!(features_of(&rows).regime_time_s, [10.0, 0.0, 0.0, 0.0, 40.0]);
        let sooner = [(36.0, Coast), (27.0, Brake), (18.0, Brake), (0.0, Standstill)];
        assert_eq!(features_of(&sooner).regime_time_s, [0.0, 0.0, 0.0, 0.0, 30.0]);
        let soonest = [(36.0, Coast), (22.5, Brake), (4.5, Brake), (0.0, Standstill)];
        let times = features_of(&soonest).regime_time_s;
        assert!(near(times[Brake as usize], 22.5) && near(times[Standstill as usize], 7.5));
    }

    #[test]
    fn energies_add_up_to_the_change_of_speed() {
        let davis = Davis { r0: 0.01, r1: 0.0, r2: 0.0 };
        let rows =
            [(0.0, Standstill), (18.0, Traction), (36.0, Traction), (36.0, Cruise), (18.0, Brake), (0.0, Standstill)];
        let energy = run_of(&rows, davis).features(&FeatureConfig::default()).energy;
        // 25 + 75 + 100 + 75 + 25 m against 0.01 N/kg; 50 J/kg of kinetic energy gained and taken out again.
        assert!(near(energy.r0_j_per_kg, 3.0));
        assert!(near(energy.traction_j_per_kg, 50.0 + 2.0));
        assert!(near(energy.brake_j_per_kg, 50.0 - 1.0));
        assert_eq!((energy.r1_j_per_kg, energy.r2_j_per_kg, energy.gradient_j_per_kg), (0.0, 0.0, 0.0));
    }

    #[test]
    fn a_dropout_adds_time_only() {
        let mut extractor = run_of(&[(100.0, Coast), (99.0, Coast), (98.0, Coast)], NO_RESISTANCE);
        let config = FeatureConfig::default();
        let energy = extractor.features(&config).energy;
        let last = extractor.before.unwrap();
        for k in 1..=60 {
            let time_s = last.time_s + 10.0 * Real::from(k);
            extractor.observe(&config, &Observation { time_s, effort_n_per_kg: None, acceleration_mps2: None, ..last });
        }
        let after = Observation { time_s: last.time_s + 610.0, effort_n_per_kg: Some(0.0), speed_mps: 20.0, ..last };
        extractor.observe(&config, &after);
        let features = extractor.features(&config);
        assert_eq!(features.regime_time_s[Coast as usize], 20.0 + 610.0);
        assert!(features.switching_points.is_empty());
        assert_eq!(features.energy, energy);
        assert_eq!(features.brake_rate_mps2, [Statistic::default(); 5]);
    }

    #[test]
    fn more_switching_points_than_fit_are_counted_and_the_final_brake_is_still_found() {
        let mut rows = std::vec::Vec::new();
        for _ in 0..40 {
            rows.extend([(0.0, Standstill), (20.0, Traction), (40.0, Traction), (20.0, Brake), (5.0, Brake)]);
        }
        rows.push((0.0, Standstill));
        let features = features_of(&rows);
        assert_eq!(features.switching_points.len(), MAX_SWITCHING_POINTS);
        assert_eq!(features.switching_points_lost, 120 - 48);
        assert!(features.final_brake.unwrap().start_time_s > 1950.0);
    }
}
