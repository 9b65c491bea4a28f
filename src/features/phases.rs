//! Phases: stretches of one regime, with short interruptions bridged.
//!
//! In: intervals between ticks with their regime. Out: a [`Boundary`] wherever a phase gives way to the next, and the
//! speeds that were held.
//!
//! A regime is recognised from the mean effort since the tick before, so a phase begins at the tick *before* its first
//! sample; where within the neighbouring intervals it really began is the question of [`super::onset`].
//!
//! - Bridged: an interruption of at most `bridge_samples` ticks (or that many times `window_s`) with the same regime on
//!   both sides. Without this, single samples split the final coast and its start is found 125 to 370 s late. Not
//!   bridged: a standstill, and an interruption whose effort alone moved the speed by more than `bridge_speed_kmh`, for
//!   that is a driver and no noise.
//! - Split: a coast by an interval in the midst of it whose effort moved the speed by more than that. The train coasted
//!   at both its ends and had power in between, so the regime does not show it. Without this a tenth of the final
//!   coasts of drivers who cruise by on/off cycles were found one cycle, 30 to 50 s, early.
//! - Absorbed: one cruising sample between two other regimes. It is an interval in which both had a share.
//! - An interval without effort (dropout) neither begins nor ends a phase, however long it is: when the regime is the
//!   same after it, the phase went on.

use super::FeatureConfig;
use super::cruise::HeldSpeeds;
use super::interval::Interval;
use crate::Real;
use crate::model::units::KmPerHour;
use crate::plain::plain;
use crate::tick::regime::Regime;
use crate::tick::snapshot::in_place;
use heapless::{Deque, Vec};

/// Samples of other regimes that are kept before the phase is closed. More of them are an end at any length.
const MAX_PENDING: usize = 16;

/// Where the samples change from one regime to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Boundary {
    /// End of the last sample before, s; a dropout behind it belongs to the regime after.
    pub(super) time_s: Real,
    /// End of the first sample after, s.
    pub(super) first_sample_s: Real,
    /// Regime before.
    pub(super) from: Regime,
    /// Regime after.
    pub(super) to: Regime,
}

plain! {
    struct Boundary { time_s, first_sample_s, from, to }
}

impl Boundary {
    const ZEROED: Self = Self { time_s: 0.0, first_sample_s: 0.0, from: Regime::Standstill, to: Regime::Standstill };
}

/// Samples of one regime in a row.
#[derive(Clone, Copy, Debug)]
struct SampleRow {
    regime: Regime,
    end_s: Real,
    first_sample_s: Real,
    start_mps: Real,
    end_mps: Real,
    dt_s: Real,
    samples: u32,
    impulse_mps: Real,
}

plain! {
    struct SampleRow { regime, end_s, first_sample_s, start_mps, end_mps, dt_s, samples, impulse_mps }
}

impl SampleRow {
    const ZEROED: Self = Self {
        regime: Regime::Standstill,
        end_s: 0.0,
        first_sample_s: 0.0,
        start_mps: 0.0,
        end_mps: 0.0,
        dt_s: 0.0,
        samples: 0,
        impulse_mps: 0.0,
    };

    fn new(end_s: Real, interval: &Interval) -> Self {
        Self {
            regime: interval.regime,
            end_s,
            first_sample_s: end_s,
            start_mps: interval.before_mps,
            end_mps: interval.after_mps,
            dt_s: interval.dt_s,
            samples: 1,
            impulse_mps: interval.impulse_mps,
        }
    }

    fn append(&mut self, next: &Self) {
        self.end_s = next.end_s;
        self.end_mps = next.end_mps;
        self.dt_s += next.dt_s;
        self.samples = self.samples.saturating_add(next.samples);
        self.impulse_mps += next.impulse_mps;
    }

    fn holds(&self, config: &FeatureConfig) -> bool {
        (self.end_mps - self.start_mps).abs() <= KmPerHour(config.cruise_cycle_kmh).to_mps()
    }
}

/// Boundaries that one interval can make known.
pub(super) type Boundaries = Vec<Boundary, { MAX_PENDING + 1 }>;

in_place! {
    /// Makes phases of samples.
    #[derive(Clone, Debug)]
    pub(super) struct Phases {
        phase: Option<SampleRow> = (None, zeroed Some(SampleRow::ZEROED));
        pending: Deque<SampleRow, MAX_PENDING> = (in place);
        last: Option<Boundary> = (None, zeroed Some(Boundary::ZEROED));
        held_speeds: HeldSpeeds = (in place);
    }
}

impl Phases {
    /// Speeds held so far.
    pub(super) fn held_speeds(&self) -> &HeldSpeeds {
        &self.held_speeds
    }

    /// The first tick of a run. Standing it needs no interval to be recognised, and departure is then a switching
    /// point.
    pub(super) fn begin(&mut self, time_s: Real, regime: Regime) {
        if regime == Regime::Standstill {
            self.phase = Some(SampleRow { regime, end_s: time_s, first_sample_s: time_s, ..SampleRow::ZEROED });
        }
    }

    /// Takes the interval that ends at `end_s`. A boundary with the same `time_s` and `from` as one given before takes
    /// its place.
    pub(super) fn push(&mut self, config: &FeatureConfig, end_s: Real, interval: &Interval) -> Boundaries {
        let mut known = Boundaries::new();
        let mut sample = SampleRow::new(end_s, interval);
        if self.is_powering_phase(config, interval) {
            sample.regime = Regime::Traction;
        }
        match self.pending.back_mut() {
            Some(last) if last.regime == sample.regime => last.append(&sample),
            _ => {
                if self.pending.is_full() {
                    self.close(config, &mut known);
                }
                // Closing has made room.
                let _kept = self.pending.push_back(sample).is_ok();
            }
        }
        self.settle(config, &mut known);
        known
    }

    /// An interval of a coast with too much effort for one: power was taken for a few seconds and let go again, and at
    /// both its ends the train coasted. Where a coast begins the effort is that of the regime before, and over ticks
    /// that come faster it is noise.
    fn is_powering_phase(&self, config: &FeatureConfig, interval: &Interval) -> bool {
        let coast = Some(Regime::Coast);
        let before = self.pending.back().or(self.phase.as_ref());
        interval.regime == Regime::Coast
            && before.map(|row| row.regime) == coast
            && interval.dt_s >= 0.5 * config.window_s
            && interval.impulse_mps > KmPerHour(config.bridge_speed_kmh).to_mps()
    }

    /// Decides what can be decided about the samples that wait.
    fn settle(&mut self, config: &FeatureConfig, known: &mut Boundaries) {
        while !self.pending.is_empty() {
            let Some(phase) = &self.phase else {
                self.close(config, known);
                continue;
            };
            let regime = phase.regime;
            let back = self.pending.iter().position(|row| row.regime == regime);
            let gap = self.pending.iter().take(back.unwrap_or(MAX_PENDING));
            if !bridgeable(config, regime, gap) {
                self.close(config, known);
            } else if let Some(back) = back {
                for _ in 0..=back {
                    if let Some(next) = self.pending.pop_front() {
                        self.extend(&next);
                    }
                }
            } else {
                return;
            }
        }
    }

    /// The phase goes on with these samples.
    fn extend(&mut self, next: &SampleRow) {
        if let Some(phase) = &mut self.phase {
            if phase.regime == Regime::Cruise {
                self.held_speeds.add(next.start_mps, next.end_mps, next.dt_s);
            }
            phase.append(next);
        }
    }

    /// The phase is over; the first of the waiting segments is the next phase.
    fn close(&mut self, config: &FeatureConfig, known: &mut Boundaries) {
        let Some(next) = self.pending.pop_front() else {
            return;
        };
        if next.regime == Regime::Cruise {
            self.held_speeds.add(next.start_mps, next.end_mps, next.dt_s);
        }
        let Some(over) = self.phase.replace(next) else {
            return;
        };
        let before = self.last.map(|boundary| boundary.from);
        let cycle = match over.regime {
            Regime::Coast => matches!(next.regime, Regime::Traction | Regime::Cruise),
            Regime::Traction => {
                matches!(next.regime, Regime::Coast | Regime::Cruise)
                    && matches!(before, Some(Regime::Coast | Regime::Cruise))
            }
            Regime::Standstill | Regime::Cruise | Regime::Brake => false,
        };
        if cycle && over.holds(config) {
            self.held_speeds.add(over.start_mps, over.end_mps, over.dt_s);
        }
        let mut boundary =
            Boundary { time_s: over.end_s, first_sample_s: next.first_sample_s, from: over.regime, to: next.regime };
        let one_sample = over.samples == 1 || over.dt_s <= config.window_s;
        if let Some(last) = self.last
            && over.regime == Regime::Cruise
            && one_sample
            && last.from != next.regime
        {
            boundary.time_s = last.time_s;
            boundary.from = last.from;
        }
        // As many as there are waiting segments at most: there is room.
        let _kept = known.push(boundary).is_ok();
        self.last = Some(boundary);
    }
}

fn bridgeable<'a>(config: &FeatureConfig, regime: Regime, gap: impl Iterator<Item = &'a SampleRow>) -> bool {
    let (mut samples, mut dt_s, mut moved_mps) = (0, 0.0, 0.0);
    for row in gap {
        if regime == Regime::Standstill || row.regime == Regime::Standstill {
            return false;
        }
        samples = row.samples.saturating_add(samples);
        dt_s += row.dt_s;
        moved_mps += row.impulse_mps.abs();
    }
    let short = samples <= config.bridge_samples || dt_s <= Real::from(config.bridge_samples) * config.window_s;
    short && (regime != Regime::Coast || moved_mps <= KmPerHour(config.bridge_speed_kmh).to_mps())
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::tick::snapshot::InPlace;
    use Regime::{Brake, Coast, Cruise, Standstill, Traction};

    /// Boundaries of samples of 10 s with a weak effort, except braking: time, from, to.
    fn boundaries(regimes: &[Regime], brake: Real) -> std::vec::Vec<(Real, Regime, Regime)> {
        let config = FeatureConfig::default();
        let mut phases = Phases::ZEROED;
        phases.clear_fields();
        let mut found: std::vec::Vec<Boundary> = std::vec::Vec::new();
        for (k, &regime) in regimes.iter().enumerate() {
            let effort = if regime == Brake { brake } else { 0.02 };
            let interval = Interval {
                before_mps: 30.0,
                after_mps: 30.0,
                dt_s: 10.0,
                impulse_mps: 10.0 * effort,
                work_j_per_kg: 0.0,
                regime,
            };
            for boundary in phases.push(&config, 10.0 * (k + 1) as Real, &interval) {
                found.retain(|old| (old.time_s, old.from) != (boundary.time_s, boundary.from));
                found.push(boundary);
            }
        }
        found.iter().map(|b| (b.time_s, b.from, b.to)).collect()
    }

    #[test]
    fn two_samples_are_bridged_and_three_are_not() {
        let two = [Coast, Coast, Cruise, Cruise, Coast, Brake, Brake, Brake];
        assert_eq!(boundaries(&two, -0.3), [(50.0, Coast, Brake)]);
        let three = [Coast, Coast, Cruise, Cruise, Cruise, Coast, Coast, Coast];
        assert_eq!(boundaries(&three, -0.3), [(20.0, Coast, Cruise), (50.0, Cruise, Coast)]);
    }

    #[test]
    fn a_strong_brake_splits_a_coast_and_a_weak_one_does_not() {
        let rows = [Coast, Coast, Brake, Coast, Coast, Coast];
        assert_eq!(boundaries(&rows, -0.04), []);
        assert_eq!(boundaries(&rows, -0.3), [(20.0, Coast, Brake), (30.0, Brake, Coast)]);
    }

    /// Coasting at the end of each interval says nothing of the seconds between: power for 4 s moves the speed by 1.8
    /// km/h.
    #[test]
    fn a_turn_of_power_inside_one_interval_splits_a_coast() {
        let found = |efforts: &[Real], dt_s: Real| {
            let config = FeatureConfig::default();
            let mut phases = Phases::ZEROED;
            phases.clear_fields();
            let mut found = std::vec::Vec::new();
            for (k, &effort) in efforts.iter().enumerate() {
                let interval = Interval {
                    before_mps: 30.0,
                    after_mps: 30.0,
                    dt_s,
                    impulse_mps: dt_s * effort,
                    work_j_per_kg: 0.0,
                    regime: Coast,
                };
                let boundaries = phases.push(&config, dt_s * (k + 1) as Real, &interval);
                found.extend(boundaries.iter().map(|b| (b.time_s, b.from, b.to)));
            }
            found
        };
        let turn = [(30.0, Coast, Traction), (40.0, Traction, Coast)];
        assert_eq!(found(&[0.0, 0.0, 0.0, 0.05, 0.0, 0.0, 0.0], 10.0), turn);
        // Rounding; the rest of the traction that the coast follows; one tick of a fast log.
        assert_eq!(found(&[0.0, 0.0, 0.0, 0.035, 0.0, 0.0], 10.0), []);
        assert_eq!(found(&[0.05, 0.0, 0.0, 0.0], 10.0), []);
        assert_eq!(found(&[0.0, 0.0, 0.0, 0.5, 0.0, 0.0], 1.0), []);
    }

    #[test]
    fn a_standstill_is_never_bridged() {
        let rows = [Brake, Standstill, Brake, Brake, Standstill];
        let expected = [(10.0, Brake, Standstill), (20.0, Standstill, Brake), (40.0, Brake, Standstill)];
        assert_eq!(boundaries(&rows, -0.3), expected);
    }

    #[test]
    fn one_cruising_sample_between_two_regimes_belongs_to_both() {
        let rows = [Coast, Coast, Cruise, Brake, Brake, Brake];
        assert_eq!(boundaries(&rows, -0.3), [(20.0, Coast, Brake)]);
        let two = [Traction, Traction, Cruise, Cruise, Coast, Coast, Coast];
        assert_eq!(boundaries(&two, -0.3), [(20.0, Traction, Cruise), (40.0, Cruise, Coast)]);
    }

    #[test]
    fn a_flicker_longer_than_the_memory_closes_the_phase() {
        let rows: std::vec::Vec<_> = (0..60).map(|k| if k == 0 { Traction } else { [Coast, Cruise][k % 2] }).collect();
        assert!(!boundaries(&rows, 0.0).is_empty());
    }
}
