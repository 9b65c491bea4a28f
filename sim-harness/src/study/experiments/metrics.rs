//! What is measured of a set: a number of what a mode says, against the truth or beside it.

use super::look::{Driven, Look, Miss};
use crate::accuracy_bench::score::regime;
use crate::study::moments::Moments;
use crate::study::view::{Seen, ViewOutcome};
use rundown::model::state;
use rundown_files::replay::ReplayedRun;
use rundown_truth::regime::Regime;

/// Of the largest power: readings in whole km/h make one power vary by as much.
const NEAR_TOP: f64 = 0.96;
/// Window of the largest effort (section 3.3).
const LOW_KMH: std::ops::RangeInclusive<f64> = 10.0..=30.0;

/// A number of a set; none where nothing is known.
#[derive(Clone, Copy, Debug)]
pub struct Metric {
    /// Column of the table, with its unit.
    pub name: &'static str,
    /// Axis of the picture.
    pub label: &'static str,
    pub seen: fn(&Look<'_>) -> Option<f64>,
    /// The same in truth, where it is not an error.
    pub truth: Option<fn(&Driven) -> Option<f64>>,
}

/// All of them, for the document of outputs.
pub const ALL: [Metric; 15] = [
    RESISTANCE,
    BIAS,
    INSIDE,
    TRACKING,
    REGIMES,
    COAST,
    BRAKE,
    POWER,
    POWER_SPREAD,
    LARGEST_POWER,
    MEAN_POWER,
    AT_THE_TOP,
    LARGEST_EFFORT,
    LOW_EFFORT,
    NEGATIVE,
];

pub const RESISTANCE: Metric = Metric {
    name: "resistance_error_percent",
    label: "error of r(v), rms, %",
    seen: |look| error_percent(&look.misses()),
    truth: None,
};

pub const BIAS: Metric = Metric {
    name: "resistance_bias_percent",
    label: "mean error of r(v), %",
    seen: |look| {
        let misses = look.misses();
        let sum = |of: fn(&Miss) -> f64| misses.iter().map(of).sum::<f64>();
        finite(100.0 * sum(|miss| miss.error) / sum(|miss| miss.truth))
    },
    truth: None,
};

pub const INSIDE: Metric = Metric {
    name: "inside_95_percent",
    label: "r(v) inside its 95 % interval, %",
    seen: |look| {
        let misses = look.misses();
        finite(100.0 * misses.iter().filter(|miss| miss.is_inside).count() as f64 / misses.len() as f64)
    },
    truth: None,
};

pub const TRACKING: Metric = Metric {
    name: "speed_error_kmh",
    label: "filtered less true speed, rms, km/h",
    seen: |look| {
        let samples = look.samples().into_iter();
        let errors = samples.map(|(estimate, _, truth)| estimate.belief.mean[state::SPEED] - truth.speed_mps);
        mean(errors.map(|mps| (3.6 * mps).powi(2))).map(f64::sqrt)
    },
    truth: None,
};

pub const REGIMES: Metric = Metric {
    name: "regimes_right_percent",
    label: "samples with the right regime, %",
    seen: |look| {
        let samples = look.samples().into_iter();
        let right = samples.map(|(_, found, truth)| f64::from(u8::from(found == regime(truth.regime))));
        mean(right).map(|share| 100.0 * share)
    },
    truth: None,
};

pub const COAST: Metric = Metric {
    name: "coast_error_s",
    label: "error of the final coast, s",
    seen: |look| absolute(look, |outcome| outcome.coast_s),
    truth: None,
};

pub const BRAKE: Metric = Metric {
    name: "brake_error_s",
    label: "error of the final brake, s",
    seen: |look| absolute(look, |outcome| outcome.brake_s),
    truth: None,
};

pub const POWER: Metric = Metric {
    name: "power_error_percent",
    label: "error of the mean power 50 to 130 km/h, %",
    seen: |look| {
        let pairs = outcomes(look, |outcome| outcome.power_kw);
        mean(pairs.map(|(seen, was)| 100.0 * (seen / was - 1.0).abs()))
    },
    truth: None,
};

pub const POWER_SPREAD: Metric = Metric {
    name: "power_variation_percent",
    label: "variation of the largest power 50 to 90 km/h, %",
    seen: |look| variation(&look.seen, |outcome| outcome.max_power_kw),
    truth: Some(|driven| variation(&driven.truth, |outcome| outcome.max_power_kw)),
};

pub const LARGEST_POWER: Metric = Metric {
    name: "largest_power_kw",
    label: "largest power of all runs, 50 to 90 km/h, kW",
    seen: |look| largest(&look.seen, |outcome| outcome.max_power_kw),
    truth: Some(|driven| largest(&driven.truth, |outcome| outcome.max_power_kw)),
};

pub const MEAN_POWER: Metric = Metric {
    name: "mean_power_kw",
    label: "mean power 50 to 130 km/h, kW",
    seen: |look| mean(look.seen.iter().filter_map(|seen| seen.outcome.power_kw)),
    truth: Some(|driven| mean(driven.truth.iter().filter_map(|seen| seen.outcome.power_kw))),
};

/// Where a limit of the train or the supply is met many runs lie; where drivers stay below it few do.
pub const AT_THE_TOP: Metric = Metric {
    name: "runs_at_the_top_percent",
    label: "runs within 4 % of the largest power, %",
    seen: |look| at_the_top(&look.seen),
    truth: Some(|driven| at_the_top(&driven.truth)),
};

pub const LARGEST_EFFORT: Metric = Metric {
    name: "largest_effort_n_per_kg",
    label: "largest effort of all runs, 10 to 30 km/h, N/kg",
    seen: |look| look.runs.iter().filter_map(effort).reduce(f64::max),
    truth: Some(|driven| true_efforts(driven).into_iter().reduce(f64::max)),
};

pub const LOW_EFFORT: Metric = Metric {
    name: "least_effort_n_per_kg",
    label: "least effort of the runs, 10 to 30 km/h, N/kg",
    seen: |look| look.runs.iter().filter_map(effort).reduce(f64::min),
    truth: Some(|driven| true_efforts(driven).into_iter().reduce(f64::min)),
};

pub const NEGATIVE: Metric = Metric {
    name: "negative_runs_percent",
    label: "runs with a negative coefficient, %",
    seen: |look| {
        let negative = |run: &ReplayedRun| {
            let mut means = run.estimates.iter().map(|estimate| estimate.belief.mean);
            f64::from(u8::from(means.any(|mean| (0..3).any(|index| mean[state::R0 + index] < 0.0))))
        };
        mean(look.runs[look.driven.judged()].iter().map(negative)).map(|share| 100.0 * share)
    },
    truth: None,
};

/// Root mean square of the error, of that of what was met, %.
pub fn error_percent(misses: &[Miss]) -> Option<f64> {
    let sum = |of: fn(&Miss) -> f64| misses.iter().map(|miss| of(miss).powi(2)).sum::<f64>();
    finite(100.0 * (sum(|miss| miss.error) / sum(|miss| miss.truth)).sqrt())
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

pub fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    values.collect::<Moments>().mean()
}

/// What was seen and what was, of the judged runs that have both.
fn outcomes(look: &Look<'_>, of: fn(&ViewOutcome) -> Option<f64>) -> impl Iterator<Item = (f64, f64)> {
    look.driven.judged().filter_map(move |run| of(&look.seen[run].outcome).zip(of(&look.driven.truth[run].outcome)))
}

fn absolute(look: &Look<'_>, of: fn(&ViewOutcome) -> Option<f64>) -> Option<f64> {
    mean(outcomes(look, of).map(|(seen, was)| (seen - was).abs()))
}

/// Coefficient of variation over the runs, %.
fn variation(runs: &[Seen], of: fn(&ViewOutcome) -> Option<f64>) -> Option<f64> {
    let moments: Moments = runs.iter().filter_map(|seen| of(&seen.outcome)).collect();
    moments.variation().map(|share| 100.0 * share)
}

fn largest(runs: &[Seen], of: fn(&ViewOutcome) -> Option<f64>) -> Option<f64> {
    runs.iter().filter_map(|seen| of(&seen.outcome)).reduce(f64::max)
}

fn at_the_top(runs: &[Seen]) -> Option<f64> {
    let of = |seen: &Seen| seen.outcome.max_power_kw;
    let top = largest(runs, |outcome| outcome.max_power_kw)?;
    mean(runs.iter().filter_map(of).map(|kw| 100.0 * f64::from(u8::from(kw >= NEAR_TOP * top))))
}

/// Mean effort of continuous acceleration at low speed, as the features have it.
fn effort(run: &ReplayedRun) -> Option<f64> {
    let line = run.summary.features.max_effort.as_ref()?;
    (line.effort.count > 0).then_some(line.effort.mean)
}

/// The same in truth.
fn true_efforts(driven: &Driven) -> Vec<f64> {
    let of_run = |run: usize| {
        let pairs = driven.samples(run).windows(2);
        let within = pairs.filter(|pair| {
            let is_traction = pair.iter().all(|sample| sample.regime == Regime::Traction);
            is_traction && pair.iter().all(|sample| LOW_KMH.contains(&(3.6 * sample.speed_mps)))
        });
        mean(within.map(|pair| pair[1].mean_effort_n_per_kg))
    };
    (0..driven.cases.len()).filter_map(of_run).collect()
}
