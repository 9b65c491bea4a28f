//! Claims on what the authors tried with their filter: section 4.2.

use super::{Claim, alone, claim};
use crate::study::moments::Moments;
use crate::study::trials::{Misses, Noise, Pace, Trials};
use rundown_pages::numbers::number;

/// A step that takes at most this share of the 10 s between readings leaves room for more of them: 0.1 s.
const SHORT_STEP_MS: u64 = 100;

pub(super) fn trials(trials: &Trials) -> [Claim; 3] {
    [pace(trials.pace.as_ref()), thinned(trials.thinned.as_ref()), noise(&trials.noise)]
}

fn pace(pace: Option<&[Pace; 2]>) -> Claim {
    let words = |pace: &Pace| format!("a step takes less than {} ms, a run less than {} s", pace.step_ms, pace.run_s);
    let [paper, gated] = pace.map_or([None, None], |both| both.each_ref().map(|p| Some(words(p))));
    claim("4.2", "the computation time is short enough for smaller sampling intervals")
        .columns([paper, gated, None])
        .holds(pace.map(|[paper, _]| paper.step_ms <= SHORT_STEP_MS))
        .by("on this computer, rounded up to whole ms and s; a step within a hundredth of the 10 s between readings. A board: docs/firmware.md")
}

fn thinned(misses: Option<&[Misses; 2]>) -> Claim {
    let words = |of: fn(&Misses) -> &[Moments; 2]| {
        let [all, thinned] = misses?;
        let pair = |m: &[Moments; 2]| {
            let [coast, brake] = m.each_ref().map(|m| number(m.mean(), 1));
            format!("coast {coast} s, brake {brake} s")
        };
        Some(format!("{}; thinned: {}", pair(of(all)), pair(of(thinned))))
    };
    let grows = |[all, thinned]: &[Misses; 2]| {
        let mut pairs = all.paper.iter().zip(&thinned.paper);
        pairs.try_fold(true, |grows, (all, thinned)| Some(grows && thinned.mean()? > all.mean()?))
    };
    claim("4.2", "every second sample alone gives less accurate regimes and features")
        .columns([words(|m| &m.paper), words(|m| &m.gated), misses.map(|_| "0 s".to_owned())])
        .holds(misses.and_then(grows))
        .by("mean distance of the lengths of the final coast and of the final brake from the truth, with samples of 10 s and of 20 s; both must grow")
}

fn noise(noises: &[Noise]) -> Claim {
    let words = |n: &Noise| format!("{} m/s\u{b2}: {} of {} runs", n.sd_mps2, n.negative_runs, n.runs);
    let listed: Vec<String> = noises.iter().map(words).collect();
    let last = noises.last().filter(|noise| noise.runs > 0);
    claim("4.2", "strong noise of the acceleration gives negative coefficients")
        .columns(alone(last.map(|_| listed.join("; "))))
        .holds(last.map(|noise| noise.negative_runs > 0))
        .by("runs with a negative coefficient, by standard deviation of the noise; some at the largest. Noise of the coefficients themselves, which the paper names too, is not in this filter")
}
