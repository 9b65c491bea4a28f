//! Claims on what the authors tried with their filter: section 4.2.

use super::{Claim, Verdict, alone, claim, points};
use crate::study::readings::pass::R0_NOISE;
use crate::study::readings::remarks::SMALL_MPS2;
use crate::study::trials::{Missed, Misses, Noise, Pace, Shaken, Trials};
use crate::study::visible::{self, Size};
use rundown_pages::numbers::number;

/// A step that takes at most this share of the 10 s between readings leaves room for more of them: 0.1 s.
const SHORT_STEP_MS: u64 = 100;
/// Share of the samples that a recogniser which is said to work may have wrong. A judgement.
const MOST_WRONG: f64 = 0.10;
/// "Slightly richer dynamics": r0 covers at most so many times its path. A judgement.
const SLIGHTLY: f64 = 2.0;

pub(super) fn trials(trials: &Trials) -> [Claim; 6] {
    let [richer, strong] = noise(&trials.noise);
    let [regimes, features] = thinned(trials.thinned.as_ref());
    [pace(trials.pace.as_ref()), regimes, features, richer, strong, davis_noise(trials.davis_noise)]
}

fn pace(pace: Option<&[Pace; 2]>) -> Claim {
    let words = |pace: &Pace| format!("a step takes less than {} ms, a run less than {} s", pace.step_ms, pace.run_s);
    let [paper, gated] = pace.map_or([None, None], |both| both.each_ref().map(|p| Some(words(p))));
    claim("4.2", "the computation time is short enough for smaller sampling intervals")
        .columns([paper, gated, None])
        .holds(pace.map(|[paper, _]| paper.step_ms <= SHORT_STEP_MS))
        .by("on this computer, rounded up to whole ms and s; a step within a hundredth of the 10 s between readings. A board: docs/firmware.md")
}

/// What the conclusion says of the second module.
pub(super) fn recognised(misses: Option<&[Misses; 2]>) -> Claim {
    let wrong = |missed: &Missed| missed.regimes.mean();
    let words = |share: Option<f64>| share.map(|share| format!("{} % wrong", number(100.0 * share, 1)));
    let [paper, gated] = misses.map_or([None, None], |[all, _]| [wrong(&all.paper), wrong(&all.gated)]);
    claim("conclusion", "the current regime is determined successfully")
        .columns([words(paper), words(gated), misses.map(|_| "0 %".to_owned())])
        .by("samples whose regime is not the true one; at most a tenth, and the paper gives no number")
        .recovered([paper.map(|share| (share <= MOST_WRONG).into()), None])
        .off_by(paper.map(points))
}

fn thinned(misses: Option<&[Misses; 2]>) -> [Claim; 2] {
    let columns = |truth: &str, words: fn(&Missed) -> String| {
        let both = |of: fn(&Misses) -> &Missed| {
            let [all, thinned] = misses?.each_ref().map(|misses| words(of(misses)));
            Some(format!("{all}; thinned: {thinned}"))
        };
        [both(|m| &m.paper), both(|m| &m.gated), misses.map(|_| truth.to_owned())]
    };
    let grows = |least: Size, of: fn(&Missed) -> Option<f64>| {
        let [all, thinned] = misses?.each_ref().map(|misses| of(&misses.paper));
        Some(least.judge(thinned? - all?))
    };
    [
        claim("4.2", "every second sample alone gives less accurate regimes")
            .columns(columns("0 %", |m| format!("{} % wrong", number(m.regimes.mean().map(|share| 100.0 * share), 1))))
            .seen(grows(visible::TIME_SHARE, |m| m.regimes.mean()), visible::TIME_SHARE)
            .by("samples whose regime is not the true one, with samples of 10 s and of 20 s; it must grow"),
        claim("4.2", "every second sample alone gives less accurate features")
            .columns(columns("0 s", |m| {
                let [coast, brake] = m.lengths_s.each_ref().map(|m| number(m.mean(), 1));
                format!("coast {coast} s, brake {brake} s")
            }))
            .seen(grows(visible::LENGTH, |m| Some(m.lengths_s[0].mean()? + m.lengths_s[1].mean()?)), visible::LENGTH)
            .by("mean distance of the lengths of the final coast and of the final brake from the truth, with samples of 10 s and of 20 s; their sum must grow, for the remark is on the features together"),
    ]
}

fn noise(noises: &[Noise]) -> [Claim; 2] {
    let listed = |words: &dyn Fn(&Noise) -> String| {
        let listed: Vec<String> = noises.iter().filter(|noise| noise.q.runs > 0).map(words).collect();
        (!listed.is_empty()).then(|| listed.join("; "))
    };
    let ways = |n: &Noise| {
        let [q, drawn] = [n.q, n.drawn].map(|shaken| {
            format!(
                "{} ({} \u{b7} 10\u{207b}\u{2075} N/kg)",
                number(shaken.way, 2),
                number(1e5 * shaken.more_n_per_kg, 2)
            )
        });
        format!("{} m/s\u{b2}: {q} as Q, {drawn} drawn", n.sd_mps2)
    };
    let negative = |n: &Noise| {
        format!(
            "{} m/s\u{b2}: {} as Q, {} drawn, of {} runs",
            n.sd_mps2, n.q.negative_runs, n.drawn.negative_runs, n.q.runs
        )
    };
    let both = |n: &Noise| [n.q, n.drawn];
    let (small, strong): (Vec<&Noise>, Vec<&Noise>) =
        noises.iter().filter(|noise| noise.q.runs > 0).partition(|noise| SMALL_MPS2.contains(&noise.sd_mps2));
    let some = |of: &[&Noise], is: fn(&Shaken) -> bool| {
        (!of.is_empty()).then(|| of.iter().copied().flat_map(both).any(|shaken| is(&shaken)))
    };
    [
        claim("4.2", "small noise of the acceleration gives slightly richer dynamics")
            .columns(alone(listed(&ways)))
            .seen(richer(&small), visible::R0)
            .by("what r0 covers with noise, of what it covers without, and how much more that is in a run: more with one of the small ones by what could be seen, at most twice as much, none negative. As Q it covers less, for noise then explains what r explained; drawn and added it covers more"),
        claim("4.2", "strong noise of the acceleration gives negative coefficients")
            .columns(alone(listed(&negative)))
            .holds(some(&strong, |shaken| shaken.negative_runs > 0))
            .by("runs with a negative coefficient, with noise as Q of the filter and with noise that is drawn and added; some with a strong one (0.1 or 1 m/s\u{b2})"),
    ]
}

/// Some small noise adds to what r0 covers, slightly, and turns no coefficient negative.
fn richer(small: &[&Noise]) -> Option<Verdict> {
    let is_slight = |shaken: &Shaken| shaken.negative_runs == 0 && shaken.way <= SLIGHTLY;
    let slight = small.iter().flat_map(|noise| [noise.q, noise.drawn]).filter(is_slight);
    let most = slight.map(|shaken| shaken.more_n_per_kg).reduce(f64::max);
    (!small.is_empty()).then(|| most.map_or(Verdict::Not, |most| visible::R0.judge(most)))
}

fn davis_noise(shaken: Option<[Shaken; 2]>) -> Claim {
    let words = |[q, drawn]: [Shaken; 2]| {
        format!("{} as Q, {} drawn, of {} runs", q.negative_runs, drawn.negative_runs, q.runs)
    };
    claim("4.2", "small noise of the coefficients gives negative ones")
        .columns(alone(shaken.map(words)))
        .holds(shaken.map(|both| both.iter().any(|shaken| shaken.negative_runs > 0)))
        .by(format!("runs with a negative coefficient with noise of r0 of {R0_NOISE:e} N/kg a step as Q, and drawn and added, which adds up to 4 % of r0 over a run"))
}
