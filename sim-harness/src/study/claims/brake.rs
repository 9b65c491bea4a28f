//! Claims on how trains are braked: section 4.4 and the conclusion.

use super::{Claim, Verdict, both, claim, percent, three};
use crate::study::gather::Gathered;
use crate::study::view::ATB_NAMES;
use crate::{study::moments::Moments, study::tallies::Tallies, study::visible};
use rundown_pages::numbers::number;

/// How far the brake rate of a step may be from the truth, m/s².
const FURTHEST_MPS2: f64 = 0.05;
/// Fewer runs say nothing of an ATB-EG step, nor of how brakes begin.
const FEWEST_OF_A_STEP: u64 = 10;
/// Steps of one behaviour have means that differ by no more than this share of their standard deviations.
const ALIKE: f64 = 0.5;
/// Standard errors by which two means differ that are not one: 95 %.
const APART: f64 = 1.96;
/// The conclusion's three behaviours, as steps from the fastest.
const BEHAVIOURS: [&[usize]; 3] = [&[0, 1], &[2, 3], &[4]];

/// A step with fewer runs is left out of the verdict.
fn known(step: &Moments) -> bool {
    step.count >= FEWEST_OF_A_STEP
}

/// What a claim on the steps of the brake would need and these runs do not have: a clause, or nothing.
/// `wanted`: of each some must be known.
fn lacking(t: &Tallies, wanted: &[&[usize]]) -> String {
    let has = |steps: &&&[usize]| steps.iter().any(|step| known(&t.brake_steps[*step]));
    let having = wanted.iter().filter(has).count();
    if having == wanted.len() {
        return String::new();
    }
    let name = |step: &usize| format!("{} km/h ({})", ATB_NAMES[*step].replace('_', " "), t.brake_steps[*step].count);
    let either = |steps: &&[usize]| steps.iter().map(name).collect::<Vec<_>>().join(" or ");
    let missing: Vec<_> = wanted.iter().filter(|steps| !has(steps)).map(either).collect();
    let wanted = wanted.len();
    format!(
        "of {wanted} steps that it takes {having} have {FEWEST_OF_A_STEP} runs that brake there, missing: {}; ",
        missing.join(", ")
    )
}

/// Of each step, where it is known; none where no step is.
fn all(t: &Tallies, of: fn(&Moments) -> Option<f64>) -> Option<[Option<f64>; 5]> {
    let steps = &t.brake_steps;
    let value = |step: &Moments| Some(step).filter(|step| known(step)).and_then(of);
    steps.iter().any(known).then(|| steps.each_ref().map(value))
}

/// Two steps that follow each other, the faster first; a step that is not known is passed over.
fn neighbours(t: &Tallies) -> impl Iterator<Item = [usize; 2]> {
    let known: Vec<usize> = (0..5).filter(|step| known(&t.brake_steps[*step])).collect();
    (1..known.len()).map(move |index| [known[index - 1], known[index]])
}

/// Whether the conclusion sees one behaviour in both.
fn are_of_one(pair: &[usize; 2]) -> bool {
    BEHAVIOURS.iter().any(|steps| pair.iter().all(|step| steps.contains(step)))
}

/// By how much the slower of two steps is braked harder.
fn gain(t: &Tallies, [fast, slow]: [usize; 2]) -> Option<f64> {
    let mean = |step: usize| t.brake_steps[step].mean();
    Some(mean(slow)? - mean(fast)?)
}

/// Every step below 80 km/h, and one above, are known.
fn are_enough(t: &Tallies) -> bool {
    [2, 3, 4].iter().all(|step| known(&t.brake_steps[*step])) && t.brake_steps[..2].iter().any(known)
}

/// From one behaviour to the next the rate rises visibly; within one, which the paper says has one mean, it does not
/// fall visibly.
fn rises(t: &Tallies) -> Option<Verdict> {
    let judged = |pair: [usize; 2]| {
        let change = gain(t, pair)?;
        let falls = visible::RATE.sees(-change);
        Some(if are_of_one(&pair) { Verdict::from(!falls) } else { visible::RATE.judge(change) })
    };
    are_enough(t).then(|| visible::weakest(neighbours(t).filter_map(judged)))
}

/// Between behaviours means differ by more than chance, and by more than within any.
fn are_three(t: &Tallies) -> Option<bool> {
    let (within, between): (Vec<_>, Vec<_>) = neighbours(t).partition(are_of_one);
    let apart = |pair: &[usize; 2]| gain(t, *pair).map(f64::abs);
    let largest_within = within.iter().filter_map(apart).fold(0.0, f64::max);
    let is_apart = |pair: &[usize; 2]| {
        let square = |step: &usize| Some(t.brake_steps[*step].sd()?.powi(2) / t.brake_steps[*step].count as f64);
        let error = (square(&pair[0])? + square(&pair[1])?).sqrt();
        Some(apart(pair)? > largest_within.max(APART * error))
    };
    are_enough(t).then(|| between.iter().all(|pair| is_apart(pair) == Some(true)))
}

fn alike(t: &Tallies, pair: [usize; 2]) -> Option<bool> {
    let [Some(a), Some(b)] = pair.map(|step| all(t, Moments::sd)?[step]) else { return None };
    Some(gain(t, pair)?.abs() < ALIKE * (a + b))
}

fn widest_when_slow(t: &Tallies) -> Option<Verdict> {
    let [upper @ .., lowest] = all(t, Moments::sd)?;
    let largest = upper.into_iter().flatten().reduce(f64::max)?;
    Some(visible::RATE.judge(lowest? - largest))
}

pub(super) fn brake(gathered: &Gathered) -> [Claim; 6] {
    let claim = |statement| claim("8", statement);
    let words = |values: [Option<f64>; 5]| values.map(|v| number(v, 2)).join(" / ") + " m/s\u{b2}";
    let (paper, truth) = (&gathered.paper, &gathered.truth);
    let lacking = |wanted: &[&[usize]]| lacking(paper, wanted);
    // Of the step that is furthest from the truth.
    let furthest = |steps: &[usize], of: fn(&Moments) -> Option<f64>| {
        let pairs = steps.iter().map(|step| (&paper.brake_steps[*step], &truth.brake_steps[*step]));
        let pairs = pairs.filter(|(a, b)| known(a) && known(b));
        let errors = pairs.filter_map(|(found, was)| Some(of(found)? - of(was)?));
        errors.max_by(|a, b| a.abs().total_cmp(&b.abs()))
    };
    let recovered = |claim: Claim, verdicts: [Option<Verdict>; 2], steps: &[usize], of: fn(&Moments) -> _| {
        let error = furthest(steps, of);
        claim.columns(three(gathered, |t| all(t, of).map(words))).recovered(verdicts).within(
            error,
            error.map(|_| 0.0),
            FURTHEST_MPS2,
            |rate| format!("{} m/s\u{b2}", number(rate, 2)),
        )
    };
    let each = [0, 1, 2, 3, 4];
    let rising = claim("the lower the speed, the higher the mean brake rate")
        .by(lacking(&[&[4], &[3], &[2], &[0, 1]]) + "mean over runs of each run's mean rate above 130, 130 to 80, 80 to 60, 60 to 40, below 40 km/h; each step above the next faster one, but for two of the same behaviour, which share a mean in the paper, too: there it does not fall. Steps of fewer than 10 runs are left out")
        .least(visible::RATE);
    let varying = claim("brake rates vary more at lower speeds, most below 40 km/h")
        .by(lacking(&[&[4], &[0, 1, 2, 3]]) + "standard deviations of the same steps; the largest below 40 km/h")
        .least(visible::RATE);
    let pair = |statement, steps: [usize; 2]| {
        let claim = claim(statement).by(lacking(&[&steps[..1], &steps[1..]])
            + "means of both steps nearer than their standard deviation; no data where one has fewer than 10 runs");
        recovered(claim, both(gathered, |t| alike(t, steps)), &steps, Moments::mean)
    };
    let three_ways = claim("three behaviours of braking: above 80, from 80 to 40 and below 40 km/h")
        .by(lacking(&[&[4], &[3], &[2], &[0, 1]]) + "means of the same steps; those next to each other differ between behaviours by 1.96 standard errors (95 %) and more, and by more than within one");
    [
        gentle_first(gathered),
        recovered(rising, both(gathered, rises), &each, Moments::mean),
        recovered(varying, both(gathered, widest_when_slow), &each, Moments::sd),
        pair("steps from 40 to 80 km/h are alike", [2, 3]),
        pair("steps above 80 km/h are alike", [0, 1]),
        recovered(three_ways, both(gathered, are_three), &each, Moments::mean),
    ]
}

fn gentle_first(gathered: &Gathered) -> Claim {
    let share = |t: &Tallies| {
        let [gentle, all] = t.gentle_first;
        (all >= FEWEST_OF_A_STEP).then(|| gentle as f64 / all as f64)
    };
    let verdicts = both(gathered, |t| Some(share(t)? > usually(t.gentle_first[1])));
    let error = share(&gathered.paper).zip(share(&gathered.truth)).map(|(found, was)| found - was);
    claim("8", "brakes begin gentler than they end")
        .columns(three(gathered, |t| {
            let gain = format!("by {} m/s\u{b2} in the mean", number(t.brake_gain_mps2.mean()?, 2));
            Some(format!("{} of {} runs, {gain}", percent(share(t))?, t.gentle_first[1]))
        }))
        .by("brake rate of the first and of the last interval of the last brake above 40 km/h, without those in which it begins or ends: they are brake in part. The first is lower, by what could be seen, in more runs than half of them and chance (one-sided, 95 %); no data with fewer than 10 runs")
        .recovered(verdicts)
        .least(visible::RATE)
        .off_by(error.map(super::points))
}

/// More than this share of so many runs is more than half of them, and no chance: the sign test, one-sided, 95 %.
fn usually(runs: u64) -> f64 {
    0.5 + 0.5 * 1.645 / (runs as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten runs and more that brake with each rate in each step, ± `sd`.
    fn braked(rates: [f64; 5], sd: f64) -> Tallies {
        let mut tallies = Tallies::default();
        for (step, rate) in tallies.brake_steps.iter_mut().zip(rates) {
            (0..20).for_each(|run| step.add(rate + if run % 2 == 0 { sd } else { -sd }));
        }
        tallies
    }

    #[test]
    fn each_step_is_compared_with_the_next() {
        let of = |rates| rises(&braked(rates, 0.0)).unwrap();
        assert_eq!(of([0.25, 0.25, 0.32, 0.32, 0.40]), Verdict::Reproduced);
        assert_eq!(of([0.25, 0.25, 0.32, 0.30, 0.40]), Verdict::Not, "within a behaviour");
        assert_eq!(of([0.25, 0.33, 0.32, 0.33, 0.40]), Verdict::Not, "between two");
        assert_eq!(of([0.25, 0.25, 0.32, 0.32, 0.325]), Verdict::NotVisible);
    }

    #[test]
    fn three_behaviours_are_further_apart_than_steps_of_one_and_than_chance() {
        let of = |rates, sd| are_three(&braked(rates, sd)).unwrap();
        assert!(of([0.25, 0.26, 0.32, 0.33, 0.40], 0.08));
        assert!(!of([0.25, 0.26, 0.32, 0.39, 0.46], 0.08), "an even rise");
        assert!(!of([0.25, 0.26, 0.29, 0.30, 0.33], 0.08), "1.96 standard errors are 0.036 m/s\u{b2}");
        let mut few = braked([0.25, 0.26, 0.32, 0.33, 0.40], 0.08);
        few.brake_steps[2] = Moments::default();
        assert_eq!(are_three(&few), None);
    }

    #[test]
    fn more_than_half_of_the_runs_is_no_chance_from_41_of_67_on() {
        assert!([40, 41].map(|runs| f64::from(runs) / 67.0 > usually(67)) == [false, true]);
    }
}
