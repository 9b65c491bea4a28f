//! What is wrong with the readings of all runs alike: found, reported, put right, and never the name of an effect.
//!
//! The age of the effort and the offset of the locations are put right in the samples, one after the other, before
//! effects are looked for. The gain of the effort column is straight in the residuals: it stays in every fit with its
//! prior, and what the chosen model leaves for it is put right afterwards.

use crate::analysis::coasts;
use crate::config::GapConfig;
use crate::data::believed::Context;
use crate::data::cut;
use crate::data::runs::Run;
use crate::efforts::{Looked, measured};
use crate::named::Named;
use crate::readings::brakes::{self, Brakes, brakes};
use crate::readings::delay::{self, Delay, delay};
use crate::readings::offset::{self, Offset, offset};
use rundown::model::effects::EffectKind;
use rundown_check::figure::Figure;
use rundown_check::figure::HALF_95;
use serde_json::{Value, json};

/// What was found of all runs.
#[derive(Clone, Copy, Debug, Default)]
pub struct Readings {
    /// How the effort column is read, and its age.
    pub effort: Delay,
    /// How its readings of the brake compare with those of powering; none without an effort column, or where trains
    /// hardly brake.
    pub brakes: Option<Brakes>,
    /// None from too few rows.
    pub offset: Option<Offset>,
}

/// What may be wrong with the readings of all runs alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NuisanceKind {
    /// The effort column reads too much or too little.
    EffortGain,
    /// Its readings of the brake do, beside those of powering.
    BrakeGain,
    /// The effort is late.
    EffortDelay,
    /// The locations are off along the line.
    LocationOffset,
}

impl NuisanceKind {
    /// As in `gap.json`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::EffortGain => "effort_gain",
            Self::BrakeGain => "brake_gain",
            Self::EffortDelay => "effort_delay",
            Self::LocationOffset => "location_offset",
        }
    }

    /// Of value and standard deviation; empty: a share.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::EffortGain | Self::BrakeGain => "",
            Self::EffortDelay => "s",
            Self::LocationOffset => "m",
        }
    }
}

/// A nuisance as it is reported.
#[derive(Clone, Debug, PartialEq)]
pub struct Nuisance {
    /// What is wrong.
    pub kind: NuisanceKind,
    /// Gain less 1, age of the effort, shown less true location.
    pub value: f64,
    /// Its standard deviation.
    pub sd: f64,
    /// Beyond doubt, and large enough to matter.
    pub told: bool,
    /// What these data cannot separate from it.
    pub ambiguous_with: Vec<EffectKind>,
}

/// The runs put right, and what was put right.
pub fn righted(context: &Context<'_>, runs: &[Run]) -> (Vec<Run>, Readings) {
    let config = context.config;
    if !measured(runs, &config.effort) {
        let offset = offset_of_coasts(context, runs);
        return (in_place(context, runs, offset), Readings { offset, ..Readings::default() });
    }
    let in_time = |with_brakes: bool| {
        let effort = delay(context, runs, with_brakes);
        let moved = |late_s: f64| delay::put_right(context, runs, effort.reading, late_s);
        (effort.put_right_s(config.search.enough).map_or_else(|| runs.to_vec(), moved), effort)
    };
    let (mut runs, mut effort) = in_time(true);
    let brakes = brakes(context, &runs, effort.reading);
    if brakes.is_some_and(|brakes| brakes.are_apart(&config.nuisance)) {
        (runs, effort) = in_time(false);
        runs = brakes::set_aside(context, &runs, effort.reading);
    }
    let cut = cut::all(context, &runs, effort.reading);
    let looked = Looked { context, runs: &runs, cut: &cut, effort: effort.reading, measured: true, model: (&[], &[]) };
    let offset = offset(context, &looked.rows(None, 0.0), true);
    (in_place(context, &runs, offset), Readings { effort, brakes, offset })
}

/// The offset without an effort column. Coasts that were recognised by wrong locations favour these: they are
/// recognised once more by the ones put right.
fn offset_of_coasts(context: &Context<'_>, runs: &[Run]) -> Option<Offset> {
    let of = |runs: &[Run]| offset(context, &coasts(context, runs)?, false);
    let first = of(runs)?;
    if first.matters(&context.config.nuisance, context.config.search.enough).is_none() {
        return Some(first);
    }
    of(&in_place(context, runs, Some(first))).map(|rest| first.and(rest))
}

/// The runs with their locations put right, where that matters.
fn in_place(context: &Context<'_>, runs: &[Run], offset: Option<Offset>) -> Vec<Run> {
    let off_m = offset.and_then(|offset| offset.matters(&context.config.nuisance, context.config.search.enough));
    off_m.map_or_else(|| runs.to_vec(), |off_m| offset::put_right(runs, off_m.value))
}

/// The runs put right by what is left of an offset, and all that was put right; none where nothing is left. `left`: of
/// runs that were put right.
pub fn further(context: &Context<'_>, runs: &[Run], readings: &Readings, left: Offset) -> Option<(Vec<Run>, Readings)> {
    let (nuisance, enough) = (&context.config.nuisance, context.config.search.enough);
    let off_m = left.matters(nuisance, enough)?;
    let before = readings.offset.filter(|before| before.matters(nuisance, enough).is_some());
    let offset = Some(before.map_or(left, |before| before.and(left)));
    Some((offset::put_right(runs, off_m.value), Readings { offset, ..*readings }))
}

/// A gain of the effort column that is neither small nor unsure.
pub fn is_reported(gain: Figure, config: &GapConfig) -> bool {
    gain.value.abs() > config.nuisance.least_gain && gain.away_from(0.0) > config.nuisance.sure
}

/// All nuisances, reported or not; without an effort column the offset of the locations alone. `gain`: of the effort
/// column less 1.
pub fn nuisances(readings: &Readings, gain: Option<Figure>, config: &GapConfig) -> Vec<Nuisance> {
    let (nuisance, enough) = (&config.nuisance, config.search.enough);
    let one = |kind, figure: Figure, told| Nuisance {
        kind,
        value: figure.value,
        sd: figure.sd,
        told,
        ambiguous_with: Vec::new(),
    };
    let gain = gain.map(|gain| one(NuisanceKind::EffortGain, gain, is_reported(gain, config)));
    let brakes = readings.brakes.map(|brakes| one(NuisanceKind::BrakeGain, brakes.off, brakes.are_apart(nuisance)));
    let told = readings.effort.matters(nuisance, enough).is_some();
    let delay = readings.effort.age_s(nuisance).map(|delay| one(NuisanceKind::EffortDelay, delay, told));
    let offset = readings.offset.map(|offset| {
        let told = offset.matters(nuisance, enough).is_some();
        let rival = told && offset.may_be_length(config.certainty.rival_within);
        let ambiguous_with = rival.then_some(EffectKind::TrainLengthError).into_iter().collect();
        Nuisance { ambiguous_with, ..one(NuisanceKind::LocationOffset, offset.of_each(), told) }
    });
    [gain, brakes, delay, offset].into_iter().flatten().collect()
}

/// A gain that was put right may as well be the mass, where these data cannot tell; and beside wrong Davis
/// coefficients, for a mass changes both.
pub fn beside(nuisances: &mut [Nuisance], named: &[Named], gain_may_be_mass: bool) {
    let may_be_mass = gain_may_be_mass || named.iter().any(|one| one.ambiguous_with.contains(&EffectKind::MassError));
    for gain in nuisances.iter_mut().filter(|one| may_be_mass && one.told && one.kind == NuisanceKind::EffortGain) {
        gain.ambiguous_with.push(EffectKind::MassError);
    }
}

impl Nuisance {
    /// As in `gap.json`.
    pub fn json(&self) -> Value {
        let (low, high) = (self.value - HALF_95 * self.sd, self.value + HALF_95 * self.sd);
        let rivals: Vec<&str> = self.ambiguous_with.iter().map(|kind| kind.name()).collect();
        json!({
            "name": self.kind.name(),
            "unit": self.kind.unit(),
            "value": self.value,
            "sd": self.sd,
            "interval_95": [low, high],
            "told": self.told,
            "ambiguous_with": rivals,
        })
    }

    /// In a sentence.
    pub fn sentence(&self) -> String {
        let (size, more) = (self.value.abs(), self.value > 0.0);
        let mut text = match self.kind {
            NuisanceKind::EffortGain => format!(
                "The effort column reads {:.1} ± {:.1} % too {} for the motion of the train",
                100.0 * size,
                100.0 * self.sd,
                if more { "high" } else { "low" }
            ),
            NuisanceKind::BrakeGain => format!(
                "The column's brake readings are {:.0} ± {:.0} % too {} beside its power readings{}; they are set aside",
                100.0 * size,
                100.0 * self.sd,
                if more { "high" } else { "low" },
                if more { "" } else { ", as of a column without all brakes" },
            ),
            NuisanceKind::EffortDelay => {
                format!("The effort is {size:.1} ± {:.1} s {}", self.sd, if more { "late" } else { "early" })
            }
            NuisanceKind::LocationOffset => format!(
                "The locations of all runs are {size:.0} ± {:.0} m too far {} the line",
                self.sd,
                if more { "up" } else { "down" }
            ),
        };
        let rivals: Vec<&str> = self.ambiguous_with.iter().map(|kind| kind.name()).collect();
        if !rivals.is_empty() {
            text.push_str(&format!(" (not distinguishable from {} in these data)", rivals.join(", ")));
        }
        text + match (self.kind, self.ambiguous_with.is_empty()) {
            (NuisanceKind::BrakeGain, _) => ", and no effect of the train.",
            (NuisanceKind::EffortGain | NuisanceKind::EffortDelay | NuisanceKind::LocationOffset, true) => {
                "; put right, and no effect of the train."
            }
            (NuisanceKind::EffortGain | NuisanceKind::EffortDelay | NuisanceKind::LocationOffset, false) => {
                "; put right."
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::believed::tests::on_a_level_line;
    use crate::data::runs::Recorded;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;
    use rundown::model::direction::Direction;
    use rundown_files::sample::Sample;

    const STEPS: usize = 10;

    /// Runs that start with all of the power, coast and brake by turns, read every second; the effort column is the
    /// mean since the reading before.
    fn runs(context: &Context<'_>) -> Vec<Run> {
        let line = context.believed.line(Direction::Up);
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let one = |index: usize| {
            let (mut speed_mps, mut location_m, mut until, mut powers) = (3.0_f64, 2_000.0, 0, false);
            let (mut samples, mut mean, mut effort) = (Vec::new(), 0.0, 0.0_f64);
            for second in 0..900_u32 {
                if second >= until {
                    (until, powers) = (second + rng.random_range(25..70), !powers);
                }
                let mut noise = |sd: f64| -> f64 { sd * rng.sample::<f64, _>(StandardNormal) };
                samples.push(Sample {
                    time_s: f64::from(second),
                    location_m: Some(location_m),
                    speed_mps: Some((36.0 * speed_mps + noise(2.0)).round() / 36.0),
                    effort_n_per_kg: Some(mean + noise(0.004)),
                    ..Sample::default()
                });
                mean = 0.0;
                for _ in 0..STEPS {
                    let wanted = match (powers, speed_mps > 8.0) {
                        (true, _) => line.train.max_effort_n_per_kg(speed_mps),
                        (false, true) => -0.3,
                        (false, false) => 0.0,
                    };
                    // Handles and brakes take some seconds.
                    effort = wanted.clamp(effort - 0.02, effort + 0.02);
                    mean += effort / STEPS as f64;
                    speed_mps += (effort - line.train.davis().resistance_n_per_kg(speed_mps)) / STEPS as f64;
                    location_m += speed_mps / STEPS as f64;
                }
            }
            Run { name: index.to_string(), direction: Direction::Up, day: None, samples, recorded: Recorded::default() }
        };
        (0..12).map(one).collect()
    }

    #[test]
    fn a_mean_since_the_second_before_leaves_no_resistance_where_trains_power() {
        on_a_level_line(12, |context| {
            let (righted, readings) = righted(context, &runs(context));
            assert!(nuisances(&readings, None, context.config).iter().all(|one| !one.told), "{readings:?}");
            let effort = readings.effort.reading;
            let cut = cut::all(context, &righted, effort);
            let looked = Looked { context, runs: &righted, cut: &cut, effort, measured: true, model: (&[], &[]) };
            let rows = looked.rows(None, 0.0);
            let powering = rows.iter().filter(|row| row.effort_n_per_kg > 0.2);
            let left: Vec<f64> = powering.map(|row| row.residual_n_per_kg).collect();
            let mean = left.iter().sum::<f64>() / left.len() as f64;
            assert!(left.len() > 100 && mean.abs() < 5e-4, "{mean}, {}: {readings:?}", left.len());
        });
    }
}
