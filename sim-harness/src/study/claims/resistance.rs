//! Claims on the filter and the resistance: section 4.2.

use super::{Claim, ClaimColumns, Verdict, alone, claim, from_to, near, percent, points, three};
use crate::study::gather::{Example, Gathered, PAPERS_LARGEST_BRAKE};
use crate::study::tallies::{R0_BAND, Tallies};
use crate::{
    study::case::CaseTruth,
    study::moments::Moments,
    study::trials::Sensitivity,
    study::view::{self, CLOUDS_KMH, Seen},
    study::{dynamics, visible},
};
use rundown::{model::state, model::train::Train, tick::estimate::Estimate};
use rundown_files::replay::ReplayedRun;
use rundown_pages::numbers::number;

/// Why no verdict on the resistance speaks of the truth.
const BLIND: &str =
    "In this mode the estimate does not follow the true resistance: slope.csv, and the first picture of the report";

/// Of the terms of a run's true resistance.
const WITH_WIND: &str = ", wind of this run included";
/// Why they may be others than those of the description.
const NOT_OF_THE_TRAIN: &str = "An input: these are the shares of the description, which this mode leaves as they are. In truth a wind along the run belongs to the linear term (2 r2 times it), so that the truth of one run need not have them";

/// The run of the paper's mode that shows the coefficients.
const LOOP: fn(&Example) -> &ReplayedRun = |example| &example.paper;

/// What both modes say of the run of Figs. 3, 5 and 6, and what was true. `paper`: which of the runs of the paper's
/// mode says it.
fn of_example(
    example: Option<&Example>,
    paper: fn(&Example) -> &ReplayedRun,
    words: impl Fn(Option<f64>) -> Option<String>,
    of: impl Fn(&ReplayedRun) -> Option<f64>,
    truth: impl FnOnce(&CaseTruth) -> Option<f64>,
) -> ClaimColumns {
    let mode = |run: fn(&Example) -> &ReplayedRun| words(example.and_then(|example| of(run(example))));
    let truth = example.and_then(|example| truth(example.truth.as_ref()?));
    [mode(paper), mode(|example| &example.gated), words(truth)]
}

pub(super) fn one_run(gathered: &Gathered, train: &Train) -> Vec<Claim> {
    let claim = |statement| claim("3", statement);
    let example = gathered.example.as_ref();
    let paper = example.map(|example| &example.paper);
    let features = example.map(Example::features);
    let max_brake_mps2 = train.description().max_brake_mps2;
    let brake_of = |seen: Seen| Some(seen.outcome.largest_brake_mps2? / max_brake_mps2);
    let brake = |run: &ReplayedRun| brake_of(Seen::of_replay(run, train));
    let true_brake = |truth: &CaseTruth| brake_of(Seen::of_truth(truth, train));
    let exceeds = |run: &ReplayedRun| largest_share(&Seen::of_replay(run, train), train);
    let truly_exceeds = |truth: &CaseTruth| largest_share(&Seen::of_truth(truth, train), train);
    let of_truth = |of: &dyn Fn(&CaseTruth) -> Option<f64>| example.and_then(|example| of(example.truth.as_ref()?));
    let above = |share: Option<f64>| share.map(|share| visible::SHARE.judge(share - 1.0));
    let error_of_effort = features.and_then(exceeds).zip(of_truth(&truly_exceeds)).map(|(found, was)| found - was);
    let constant = || constant(gathered);
    let path = paper.map(path);
    let of_path =
        |of: fn(&[[f64; 3]], &[f64]) -> Option<f64>| path.as_ref().and_then(|(davis, speed_mps)| of(davis, speed_mps));
    let (falls, rises) = (of_path(dynamics::falls), of_path(dynamics::rises));
    let (alike, range) = (of_path(|davis, _| dynamics::alike(davis)), of_path(|davis, _| dynamics::range(davis)));
    vec![
        claim("the speed profile is accurately reproduced")
            .columns(of_example(example, LOOP, tracked, view::speed_rms_kmh, |_| None))
            .holds(paper.and_then(view::speed_rms_kmh).map(|rms| rms < 1.0))
            .by(paper.and_then(view::dropped_words).map_or_else(String::new, |words| words + "; ") + "root mean square of filtered less measured speed of this run; below the 1 km/h of the reading. That the speed is tracked says nothing of the resistance"),
        claim("the deceleration of the final brake stays below 59 % of the largest")
            .columns(of_example(example, Example::features, percent, brake, true_brake))
            .holds(features.and_then(brake).map(|share| share < PAPERS_LARGEST_BRAKE))
            .by("largest brake rate of this run; below 59 %. The run is chosen by it")
            .input_of_runs(),
        claim("the effort exceeds the manufacturer's boundary at the end of the acceleration")
            .columns(of_example(example, Example::features, percent, exceeds, truly_exceeds))
            .by(format!("largest effort between two samples of this run above {CLOUDS_KMH} km/h, of the manufacturer's at that speed; above 100 %. Single readings in whole km/h are too large where they are the largest"))
            .recovered([features.and_then(exceeds), of_truth(&truly_exceeds)].map(above))
            .least(visible::SHARE)
            .off_by(error_of_effort.map(points)),
        claim("the coefficients decrease at the beginning of the run")
            .columns([falls.map(|fall| format!("r0 {} until 80 km/h", r0_words(-fall))), None, constant()])
            .seen(falls.map(|fall| visible::R0.judge(fall)), visible::R0)
            .by(format!("how far r0 gets from its first value until the last sample above 80 km/h; further below than above. {BLIND}")),
        claim("the coefficients increase again at lower speeds")
            .columns([rises.map(|rise| format!("r0 {} below 80 km/h", r0_words(rise))), None, constant()])
            .seen(rises.map(|rise| visible::R0.judge(rise)), visible::R0)
            .by(format!("change of r0 from the last sample above 80 km/h to the end; it rises. The true coefficients stay: what moves is how late speed or effort are. {BLIND}")),
        claim("the three coefficients show similar dynamics")
            .columns([alike.map(|c| format!("least correlation {}", number(c, 2))), None, constant()])
            .seen(alike.zip(range).map(|(c, range)| similar(c, range)), visible::R0)
            .by("least correlation of any two of r0, r1, r2 along the run; above 0.8, where r0 moves visibly"),
    ]
}

/// Largest power of an acceleration above [`CLOUDS_KMH`], as a share of the manufacturer's: where power is the limit,
/// that of the effort.
fn largest_share(seen: &Seen, train: &Train) -> Option<f64> {
    let largest = view::largest(&seen.points.power, &(CLOUDS_KMH..=f64::INFINITY))?;
    Some(1000.0 * largest.power_kw / train.description().max_power_w)
}

fn tracked(rms_kmh: Option<f64>) -> Option<String> {
    rms_kmh.map(|kmh| format!("{} km/h", number(kmh, 2)))
}

/// Dynamics that nobody can see are not similar, however well they correlate.
fn similar(correlation: f64, r0_range: f64) -> Verdict {
    match visible::R0.judge(r0_range) {
        Verdict::Reproduced if correlation <= 0.8 => Verdict::Not,
        seen => seen,
    }
}

/// A change of r0.
fn r0_words(n_per_kg: f64) -> String {
    format!("{} \u{b7} 10\u{207b}\u{2075} N/kg", number(1e5 * n_per_kg, 2))
}

/// The paper's coefficients move by tenths of a per cent.
fn fine_percent(share: Option<f64>) -> Option<String> {
    share.map(|share| format!("{}\u{a0}%", number(100.0 * share, 3)))
}

/// r0, r1, r2 along a run in the paper's mode, and its filtered speed, m/s.
fn path(run: &ReplayedRun) -> (Vec<[f64; 3]>, Vec<f64>) {
    let means = || run.estimates.iter().map(|estimate| estimate.belief.mean);
    let davis = means().map(|m| [m[state::R0], m[state::R1], m[state::R2]]).collect();
    (davis, means().map(|m| m[state::SPEED]).collect())
}

pub(super) fn all_runs(gathered: &Gathered, train: &Train) -> [Claim; 4] {
    let claim = |statement| claim("4", statement);
    let paper = &gathered.paper;
    let in_band = |t: &Tallies| {
        let count = t.davis_samples[0].count;
        (count > 0).then(|| t.r0_in_band as f64 / count as f64)
    };
    let skewness = |t: &Tallies| t.davis_samples.iter().map(Moments::skewness).collect::<Option<Vec<f64>>>();
    let stated = train.davis().r0;
    let below = |t: &Tallies| t.davis_samples[0].mean().map(|mean| stated - mean);
    [
        claim("besides outliers, r0 lies between 0.0072 and 0.00738 N/kg")
            .columns(three(gathered, |t| {
                let (ends, band) = (from_to(&t.davis_samples[0], 1e-3, 2)?, percent(in_band(t))?);
                Some(format!("{ends} \u{b7} 10\u{207b}\u{b3} N/kg, {band} inside"))
            }))
            .of_the_train()
            .seen(in_band(paper).map(|share| bounded(share, &paper.davis_samples[0])), visible::R0)
            .by(format!(
                "share of samples that print as {} to {} N/kg; at least 90 %, where r0 moves at all. These are the bounds that Table 1's initial deviations allow, not those of the train",
                R0_BAND.start(),
                R0_BAND.end()
            )),
        claim("the distributions of r0, r1, r2 have negative skewness")
            .columns(three(gathered, |t| {
                skewness(t).map(|all| all.iter().map(|s| number(*s, 2)).collect::<Vec<String>>().join(" / "))
            }))
            .seen(skewness(paper).map(|all| skewed(&all, &paper.davis_samples)), visible::SKEWNESS)
            .by(format!("skewness over all samples, all three negative, where the standard deviation of r0 is above {}", visible::R0.reason)),
        claim("the manufacturer overestimates r0")
            .columns(three(gathered, |t| below(t).map(|below| format!("mean of r0 {} off", r0_words(-below)))))
            .seen(below(paper).map(|below| visible::R0.judge(below)), visible::R0)
            .by(format!("mean over all samples against the manufacturer's; below it. {BLIND}"))
            .of_the_train(),
        claim("the coefficients are never negative with Table 1")
            .columns(three(gathered, |t| (t.runs > 0).then(|| format!("{} of {} runs negative", t.negative_runs, t.runs))))
            .holds((paper.runs > 0).then_some(paper.negative_runs == 0))
            .by("no run with a coefficient below zero. Of coefficients that hardly move it is idle"),
    ]
}

/// A value that does not move is bounded by anything.
fn bounded(inside: f64, r0: &Moments) -> Verdict {
    match r0.sd().is_some_and(|sd| visible::R0.sees(sd)) {
        _ if inside < 0.9 => Verdict::Not,
        true => Verdict::Reproduced,
        false => Verdict::NotVisible,
    }
}

/// The distribution of r0 is wide enough to be a histogram, and all three lean to the left.
fn skewed(skewness: &[f64], samples: &[Moments; 3]) -> Verdict {
    match samples[0].sd().is_some_and(|sd| visible::R0.sees(sd)) {
        true => visible::weakest(skewness.iter().map(|skewness| visible::SKEWNESS.judge(-skewness))),
        false => Verdict::NotVisible,
    }
}

/// What is put in is the description; in truth the wind along the run adds to the linear term.
fn with_wind([paper, gated, truth]: ClaimColumns) -> ClaimColumns {
    [paper, gated, truth.map(|words| words + WITH_WIND)]
}

pub(super) fn terms(gathered: &Gathered, train: &Train) -> [Claim; 4] {
    let claim = |statement| claim("5", statement);
    let share = |terms: [f64; 3], term: usize| terms[term] / terms.iter().sum::<f64>();
    let example = gathered.example.as_ref();
    let paper = example.map(|example| &example.paper);
    // At the largest speed: what the paper calls "up to". The linear term has a larger share at a lower one.
    let of_run = |run: &ReplayedRun| {
        let speed_mps = |estimate: &Estimate| estimate.belief.mean[state::SPEED];
        let fastest = run.estimates.iter().max_by(|a, b| speed_mps(a).total_cmp(&speed_mps(b)))?;
        Some(fastest.davis().terms_n_per_kg(speed_mps(fastest)))
    };
    let of_truth = |truth: &CaseTruth| {
        let v = truth.samples.iter().map(|s| s.speed_mps).reduce(f64::max)?;
        let d = truth.facts.davis;
        Some([d.r0, d.r1 * v, d.r2 * v * v])
    };
    let stated = train.davis().terms_n_per_kg(140.0 / 3.6);
    let up_to = |statement, term: usize, wanted: f64| {
        let of = |terms| share(terms, term);
        claim(statement)
            .columns(with_wind(of_example(example, LOOP, percent, |run| of_run(run).map(of), |truth| {
                of_truth(truth).map(of)
            })))
            .holds(near(paper.and_then(of_run).map(of), wanted, 0.015))
            .by(format!(
                "share of the running resistance at the largest speed of the run, within 1.5 points; the manufacturer's coefficients give {} at 140 km/h. {NOT_OF_THE_TRAIN}",
                percent(Some(of(stated))).unwrap_or_default()
            ))
            .input()
    };
    let above = |terms| 100.0 * (share(terms, 0) - share(terms, 1));
    let of_points = |value: Option<f64>| value.map(|v| format!("{} points", number(v, 1)));
    let [moves_paper, moves_gated, _] = of_example(example, LOOP, fine_percent, constant_moves, |_| None);
    [
        up_to("the linear term accounts for 11 % at the largest speed", 1, 0.11),
        claim("the linear term is only 2 points below the constant one")
            .columns(with_wind(of_example(example, LOOP, of_points, |run| of_run(run).map(above), |truth| {
                of_truth(truth).map(above)
            })))
            .holds(near(paper.and_then(of_run).map(above), 2.0, 1.0))
            .by(format!(
                "difference of their shares at the largest speed of the run, within 1 point; the manufacturer's coefficients give {} at 140 km/h. {NOT_OF_THE_TRAIN}",
                of_points(Some(above(stated))).unwrap_or_default()
            ))
            .input(),
        up_to("the quadratic term accounts for up to 76 %", 2, 0.76),
        claim("variations of the constant term do not vary the whole significantly")
            .columns([moves_paper, moves_gated, constant(gathered)])
            .holds(paper.and_then(constant_moves).map(|moves| moves < 0.01))
            .by(format!("range of r0 in this run over the running resistance at its largest speed; below 1 %. Of an r0 that hardly moves it is idle. {BLIND}")),
    ]
}

/// Range of r0 in a run, of its running resistance at the largest speed.
fn constant_moves(run: &ReplayedRun) -> Option<f64> {
    let range = dynamics::range(&path(run).0)?;
    let resistances = run.estimates.iter().map(|estimate| {
        let terms = estimate.davis().terms_n_per_kg(estimate.belief.mean[state::SPEED]);
        terms.iter().sum::<f64>()
    });
    Some(range / resistances.reduce(f64::max)?)
}

/// What the conclusion says of the first module. A filter that learns nothing leaves the description as it is.
pub(super) fn estimated(gathered: &Gathered) -> Claim {
    let rms = |t: &Tallies| t.resistance_error2.mean().map(f64::sqrt);
    let [paper, gated, described] = three(gathered, |t| fine_percent(rms(t)));
    let truth = described.map(|described| format!("the manufacturer's: {described}"));
    claim("conclusion", "the filter estimates the running resistance of the train")
        .columns([paper, gated, truth])
        .holds(rms(&gathered.paper).zip(rms(&gathered.truth)).map(|(filter, described)| filter < 0.5 * described))
        .by(format!("root mean square over the runs of r(100 km/h) after the run less the true one, load and wind included; below half of what the manufacturer's is off. {BLIND}"))
}

pub(super) fn initial(sensitivity: &[Sensitivity]) -> Claim {
    let words = |s: &Sensitivity| format!("\u{d7}{} on {}: {} of {} runs", s.factor, s.which, s.negative_runs, s.runs);
    let of = |factor: f64| sensitivity.iter().filter(move |s| s.factor == factor);
    let listed = |factor| of(factor).map(words).collect::<Vec<_>>().join("; ");
    let some = !sensitivity.is_empty();
    let negative = |which: &str| sensitivity.iter().any(|s| s.factor > 1.0 && s.which == which && s.negative_runs > 0);
    let any = || ["r0", "r1", "r2"].into_iter().all(negative);
    claim("4.2", "two orders of magnitude more in one initial covariance of any coefficient give negative coefficients")
        .columns(alone(some.then(|| format!("{}; {}", listed(10.0), listed(100.0)))))
        .holds(some.then(|| any() && of(1.0).all(|s| s.negative_runs == 0)))
        .by("runs with a negative coefficient when the initial standard deviation is 10 times (covariance 100 times) or 100 times as large; some with that of r0, some with that of r1, some with that of r2, none with Table 1")
}

/// What is true of the coefficients of a simulated run; of a recorded one nobody knows.
fn constant(gathered: &Gathered) -> Option<String> {
    (!super::is_recorded(gathered)).then(|| "constant within a run".to_owned())
}
