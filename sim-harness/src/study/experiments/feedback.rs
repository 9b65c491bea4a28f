//! Section 5: the recognised regime "could be used in real time to improve the performance of the parameter estimation
//! module".
//!
//! The paper's loop, where the effort of a step is zero when the train is said to coast, and calculated from the
//! readings otherwise. Only then do the readings say something of the resistance: otherwise it cancels out. Who says
//! that the train coasts:
//!
//! | arm | coasting is |
//! |---|---|
//! | `none` | never said: the paper |
//! | `band` | a calculated effort within the paper's ±0.025 N/kg |
//! | `recogniser` | what the recogniser of the gated mode says, at both ends of the step |
//! | `truth` | what the driver does at both ends: the most that a recogniser could bring |
//! | `recogniser, Q` | as the recogniser says; a calculated effort has the noise of the readings that it is made of |
//!
//! Without that noise the filter takes a calculated effort for exact, and so the speed with which a coast begins. With
//! Table 1's initial deviations the coefficients can hardly move, so wider ones are tried. Each run begins with the
//! description.

use super::answer::{Answer, Arm, VariantAxis};
use super::look::{Driven, Look, misses};
use super::metrics::{NEGATIVE, RESISTANCE, error_percent, mean};
use super::plan::Plan;
use super::sweep::{Estimated, over_sets};
use super::variant::Variant;
use crate::study::Refused;
use rundown::filter::gaussian::Gaussian;
use rundown::model::effects::{Acting, Effects, Journey};
use rundown::model::effort;
use rundown::model::line::Line;
use rundown::model::point::Point;
use rundown::model::state::{self, LOCATION, R0, SPEED};
use rundown::tick::paper::{Difference, PaperConfig, PaperLoop};
use rundown::tick::regime::{PaperRule, Regime};
use rundown_files::sample::Sample;
use rundown_pages::colours;
use rundown_truth::regime::Regime as TrueRegime;

/// Factors on the initial deviations of r0, r1, r2 in Table 1.
const FACTORS: [f64; 4] = [1.0, 100.0, 1000.0, 3000.0];
/// The gated mode that begins each run with the description, as the others here do.
const ONE_RUN: Arm = Arm { name: "gated, one run", colour: colours::QUADRATIC_TERM };

/// Who says that the train coasts.
#[derive(Clone, Copy, PartialEq)]
enum Feedback {
    Nobody,
    Band,
    Recogniser,
    /// A calculated effort then has the noise of its readings.
    RecogniserWithNoise,
    Truth,
}

impl Feedback {
    const ALL: [Self; 5] = [Self::Nobody, Self::Band, Self::Recogniser, Self::RecogniserWithNoise, Self::Truth];

    fn arm(self) -> Arm {
        let (name, colour) = match self {
            Self::Nobody => ("none", colours::ESTIMATED),
            Self::Band => ("band", colours::HELD),
            Self::Recogniser => ("recogniser", colours::LINEAR_TERM),
            Self::RecogniserWithNoise => ("recogniser, Q", colours::CONSTANT_TERM),
            Self::Truth => ("truth", colours::TRUTH),
        };
        Arm { name, colour }
    }

    fn coasting(self, gated: &Look<'_>, run: usize) -> Coasting {
        match self {
            Self::Nobody => Coasting::Never,
            Self::Band => Coasting::Band,
            Self::Recogniser | Self::RecogniserWithNoise => Coasting::Said(recognised(gated, run)),
            Self::Truth => Coasting::Said(truly(gated.driven, run)),
        }
    }
}

/// Of a difference of two speeds in whole km/h, km/h: twice the variance of a rounding.
const DIFFERENCE_SD_KMH: f64 = 0.408_248_290_463_863;

/// At which samples the train coasts.
enum Coasting {
    Never,
    Band,
    /// At each row.
    Said(Vec<bool>),
}

/// What is measured: name, and label with unit.
const MEASURED: [(&str, &str); 2] =
    [(RESISTANCE.name, "error of r(v) at the end of a run, rms, %"), (NEGATIVE.name, NEGATIVE.label)];

pub fn answer(plan: &Plan<'_>) -> Result<Answer, Refused> {
    let of = |factor: f64| {
        let variant = Variant::parse(format!("Table 1 \u{d7} {factor}"), factor.log10(), "")?;
        Ok::<_, Refused>(variant.estimated_by(|config| {
            config.paper.initial_davis_sd = config.paper.initial_davis_sd.map(|sd| factor * sd);
        }))
    };
    let variants = FACTORS.into_iter().map(of).collect::<Result<Vec<_>, _>>()?;
    let rows = over_sets(plan, &variants, |variant, driven| {
        let gated = driven.look(variant, (Estimated::GATED.config)(variant.config))?;
        let fed = Feedback::ALL.map(|feedback| (feedback.arm(), fed(variant, &gated, feedback)));
        let apart = driven.look_apart(variant, (Estimated::GATED.config)(variant.config))?;
        let own = [(ONE_RUN, &apart), (Estimated::GATED.arm, &gated)];
        let own = own.map(|(arm, look)| (arm, vec![error_percent(&look.misses()), (NEGATIVE.seen)(look)]));
        Ok(fed.into_iter().chain(own).collect())
    })?;
    Ok(Answer::new(
        plan,
        VariantAxis::Values("initial deviations of r0, r1, r2, decades above Table 1"),
        MEASURED.to_vec(),
        rows,
    )
    .noting("The gated mode carries the vehicle from run to run; of Table 1 it takes nothing.".to_owned()))
}

/// Error of the resistance and share of negative runs with a filter that is fed.
fn fed(variant: &Variant, gated: &Look<'_>, feedback: Feedback) -> Vec<Option<f64>> {
    let driven = gated.driven;
    let (mut all, mut negative) = (Vec::new(), Vec::new());
    for run in driven.judged() {
        let coasting = feedback.coasting(gated, run);
        let rows = &driven.cases[run].recording.rows;
        let line =
            Line { train: &driven.train, track: &variant.track, direction: driven.cases[run].recording.direction };
        let is_noisy = feedback == Feedback::RecogniserWithNoise;
        let fed = Fed { rule: &variant.config.paper_rule, coasting: &coasting, is_noisy };
        let (davis, was_negative) = filter(&variant.config.paper, &line, rows, &fed);
        all.extend(misses(&davis, driven.samples(run)));
        negative.push(f64::from(u8::from(was_negative)));
    }
    vec![error_percent(&all), mean(negative.into_iter()).map(|share| 100.0 * share)]
}

/// Whether the recogniser of the gated mode says coasting at each row; rows without an estimate do not.
fn recognised(gated: &Look<'_>, run: usize) -> Vec<bool> {
    let replayed = &gated.runs[run];
    let coasts = |row: &Sample| {
        let place = replayed.estimates.iter().position(|estimate| estimate.time_s == row.time_s);
        place.is_some_and(|place| replayed.regimes[place] == Regime::Coast)
    };
    gated.driven.cases[run].recording.rows.iter().map(coasts).collect()
}

fn truly(driven: &Driven, run: usize) -> Vec<bool> {
    driven.samples(run).iter().map(|sample| sample.regime == TrueRegime::Coast).collect()
}

/// What is fed to the filter.
struct Fed<'a> {
    rule: &'a PaperRule,
    coasting: &'a Coasting,
    /// A calculated effort has the noise of its readings.
    is_noisy: bool,
}

/// The coefficients at the end of a run, and whether one was ever below zero.
fn filter(config: &PaperConfig, line: &Line<'_>, rows: &[Sample], fed: &Fed<'_>) -> (Gaussian<3>, bool) {
    // The effort that is set drives the step: the loop's own would be a sample late.
    let mut config = PaperConfig { difference: Difference::Backward, ..*config };
    // Q that the gain does not know, as printed, would come a step late.
    config.reuse_points &= !fed.is_noisy;
    let effects = Effects::NONE;
    let acting = Acting::new(&effects, Journey::default());
    let described = line.train.davis();
    let start = Gaussian::independent([described.r0, described.r1, described.r2], config.initial_davis_sd);
    let at_first = config;
    let begin =
        |row: &Sample| PaperLoop::begin(&at_first, line, &acting, row.time_s, &start, row.location_m, row.speed_mps);
    let Some(first) = rows.first() else {
        return (start, false);
    };
    let (mut state, mut was_negative) = (begin(first), false);
    for (index, pair) in rows.windows(2).enumerate() {
        let (before, now) = (&pair[0], &pair[1]);
        let dt_s = now.time_s - before.time_s;
        if let (Some(from), Some(to)) = (before.speed_mps, now.speed_mps) {
            let mean = &state.belief.mean;
            let at = Point { time_s: now.time_s, location_m: mean[LOCATION], speed_mps: mean[SPEED] };
            let calculated = effort::of_paper(line, &acting, &state::davis(mean), (to - from) / dt_s, &at);
            let is_zero = match fed.coasting {
                Coasting::Never => false,
                Coasting::Band => calculated.abs() <= fed.rule.coast_n_per_kg && from > 0.0,
                Coasting::Said(said) => said.get(index..index + 2).is_some_and(|ends| ends.iter().all(|end| *end)),
            };
            state.effort_n_per_kg = if is_zero { 0.0 } else { calculated };
            if fed.is_noisy {
                config.acceleration_noise_mps2 = if is_zero { 0.0 } else { DIFFERENCE_SD_KMH / 3.6 / dt_s };
            }
        }
        if state.step(&config, line, &acting, now.time_s, dt_s, [now.location_m, now.speed_mps]).is_err() {
            state = begin(now);
        }
        was_negative |= (0..3).any(|i| state.belief.mean[R0 + i] < 0.0);
    }
    let belief = &state.belief;
    let davis = Gaussian {
        mean: belief.mean.fixed_rows::<3>(R0).into_owned(),
        covariance: belief.covariance.fixed_view::<3, 3>(R0, R0).into_owned(),
    };
    (davis, was_negative)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::readings::pass::Filter;

    #[test]
    fn without_feedback_it_is_the_paper_s_filter() {
        let variant = Variant::parse("a", 0.0, "").unwrap();
        let driven = Driven::new(&variant, 2, 3, 0).unwrap();
        let recording = &driven.cases[1].recording;
        let line = Line { train: &variant.train, track: &variant.track, direction: recording.direction };
        let config = variant.config;
        let fed = Fed { rule: &config.paper_rule, coasting: &Coasting::Never, is_noisy: false };
        let (davis, was_negative) = filter(&config.paper, &line, &recording.rows, &fed);
        let pass = Filter::from(config.paper).pass(&line, recording);
        let last = pass.davis.last().unwrap();
        assert!((davis.mean[0] / last[0] - 1.0).abs() < 1e-12, "{davis:?} {last:?}");
        assert!(!was_negative);
    }

    #[test]
    fn a_known_coast_teaches_the_resistance_where_the_deviations_let_it() {
        let variant = Variant::parse("a", 0.0, "[train]\ntrue_davis_over_described = [0.8, 0.8, 0.8]").unwrap();
        let variant = variant.estimated_by(|c| c.paper.initial_davis_sd = c.paper.initial_davis_sd.map(|sd| 1e3 * sd));
        let driven = Driven::new(&variant, 4, 3, 0).unwrap();
        let gated = driven.look(&variant, (Estimated::GATED.config)(variant.config)).unwrap();
        let [none, known] =
            [Feedback::Nobody, Feedback::Truth].map(|feedback| fed(&variant, &gated, feedback)[0].unwrap());
        assert!(none > 15.0 && known < 0.6 * none, "{none} {known}");
    }
}
