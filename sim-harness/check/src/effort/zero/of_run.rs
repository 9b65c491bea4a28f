//! Zeros of an effort column that differ from run to run, as of a sensor that is set to zero once a day.
//!
//! In: stretches of moving trains, run by run. Out: the effort that recurs in the coasts of each run, where these
//! differ by far more between runs than within them.
//!
//! One zero for all runs is wrong in each. A light power that a driver leaves while the train seems to coast differs
//! from run to run, too, but it acts: what the motion needs rises with it from run to run, by as much; beside a zero it
//! does not.

use crate::effort::coasting::{DOUBTED_SHARE, HALF_WIDTHS_N_PER_KG, MovingStretch, densest, sort, within};
use crate::figure::{Figure, HALF_95};
use rundown_files::statistics::{Pairs, mean, median};

/// So many stretches of a run show its zero, so many times as many as in all beside them, in so many half-widths on
/// either side.
const LEAST: usize = 4;
const DENSER: usize = 2;
const BESIDE: f64 = 5.0;
/// So many runs, and this share of all, tell.
const LEAST_RUNS: usize = 6;
const LEAST_SHARE: f64 = 0.6;
/// Zeros differ that are off from that of most runs by so many half-widths of what recurs in a single run, and by more
/// than rounding to the step of the column makes, in so many runs, and this share of all: half of the runs may have one
/// zero, and the others another.
const DIFFER: f64 = 3.0;
const DIFFER_STEPS: f64 = 1.5;
const LEAST_OFF: usize = 3;
const LEAST_OFF_SHARE: f64 = 0.2;
/// Half of a zero that acts is neither.
const HALF: f64 = 0.5;

/// Zeros that differ.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ZerosOfRuns {
    /// Run by run, N/kg; none where too little shows it.
    pub(crate) of_runs: Vec<Option<f64>>,
    /// Median of all, N/kg.
    pub(crate) middle_n_per_kg: f64,
    /// Standard deviation of all, N/kg.
    pub(crate) spread_n_per_kg: f64,
    /// They do not act.
    pub(crate) is_sure: bool,
}

impl ZerosOfRuns {
    /// By how much r may be wrong where they act, N/kg.
    pub(crate) fn doubt_n_per_kg(&self) -> f64 {
        HALF_95 * self.spread_n_per_kg
    }
}

/// Of so many runs of a unit; nothing where they have one zero, or what recurs acts. `step`: of the efforts, N/kg.
pub(crate) fn differing(all: &[MovingStretch], runs: usize, step: Option<f64>) -> Option<ZerosOfRuns> {
    let mut of_runs: Vec<Vec<MovingStretch>> = vec![Vec::new(); runs];
    all.iter().for_each(|one| of_runs[one.run].push(*one));
    of_runs.iter_mut().for_each(|own| sort(own));
    let least = LEAST_RUNS.max((LEAST_SHARE * runs as f64).ceil() as usize);
    let (half_width, crowds) = HALF_WIDTHS_N_PER_KG.into_iter().find_map(|half_width| {
        let crowds: Vec<Option<Crowd>> = of_runs.iter().map(|own| Crowd::of(own, half_width)).collect();
        (crowds.iter().flatten().count() >= least).then_some((half_width, crowds))
    })?;
    let zeros = || crowds.iter().flatten().map(|crowd| crowd.effort_n_per_kg);
    let middle_n_per_kg = median(zeros())?;
    let spread_n_per_kg = mean(zeros().map(|zero| (zero - middle_n_per_kg).powi(2)))?.sqrt();
    let least_off = (DIFFER * half_width).max(DIFFER_STEPS * step.unwrap_or_default());
    let off = zeros().filter(|zero| (zero - middle_n_per_kg).abs() > least_off).count();
    if off < LEAST_OFF || (off as f64) < LEAST_OFF_SHARE * zeros().count() as f64 {
        return None;
    }
    let acts = share_that_acts(&crowds)?;
    let [low, high] = acts.interval();
    (low < HALF).then(|| ZerosOfRuns {
        of_runs: crowds.iter().map(|crowd| crowd.as_ref().map(|crowd| crowd.effort_n_per_kg)).collect(),
        middle_n_per_kg,
        spread_n_per_kg,
        is_sure: high < HALF,
    })
}

/// What recurs in a run.
#[derive(Clone, Copy, Debug)]
struct Crowd {
    effort_n_per_kg: f64,
    /// By acceleration, gradient and described resistance.
    needed_n_per_kg: f64,
}

impl Crowd {
    /// `own`: sorted by their efforts.
    fn of(own: &[MovingStretch], half_width: f64) -> Option<Self> {
        let inside = &own[densest(own, half_width)?];
        let effort_n_per_kg = mean(inside.iter().map(|one| one.effort_n_per_kg))?;
        let reach = BESIDE * half_width;
        let beside = within(own, effort_n_per_kg - reach, effort_n_per_kg + reach).len() - inside.len();
        let taken: Vec<[f64; 2]> = inside.iter().map(|one| one.taken_n_per_kg).collect::<Option<_>>()?;
        let resistance = mean(taken.iter().map(|taken| taken[1]))?;
        let needed_n_per_kg = mean(inside.iter().zip(&taken).map(|(one, taken)| one.mps2 + taken[0] + taken[1]))?;
        let acts = effort_n_per_kg.abs() >= DOUBTED_SHARE * resistance
            && (needed_n_per_kg - effort_n_per_kg).abs() < needed_n_per_kg.abs();
        let is_crowd = inside.len() >= LEAST && inside.len() >= DENSER * beside;
        (is_crowd && !acts).then_some(Self { effort_n_per_kg, needed_n_per_kg })
    }
}

/// By how much what the motion needs rises with what recurs, from run to run: 1 of efforts that act, 0 of zeros.
fn share_that_acts(crowds: &[Option<Crowd>]) -> Option<Figure> {
    let both: Vec<(f64, f64)> =
        crowds.iter().flatten().map(|crowd| (crowd.effort_n_per_kg, crowd.needed_n_per_kg)).collect();
    let pairs = Pairs::of(&both);
    let value = pairs.slope();
    let left: f64 = both.iter().map(|(effort, needed)| ((needed - pairs.y) - value * (effort - pairs.x)).powi(2)).sum();
    let sd = (left / (both.len() as f64 - 2.0) / pairs.xx).sqrt();
    Some(Figure { value, sd }).filter(|share| share.value.is_finite() && share.sd.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten runs of coasts with these efforts, by run, beside some that power; what the motion needs of each is `acts`
    /// of it, by a wind of each run more or less.
    fn found(effort_n_per_kg: impl Fn(usize) -> f64, acts: f64, wind_n_per_kg: f64) -> Option<ZerosOfRuns> {
        let one = |i: usize| {
            let run = i % 10;
            let effort = effort_n_per_kg(run) + 1e-5 * (i / 10 % 3) as f64;
            let wind = wind_n_per_kg * f64::sin(2.3 * run as f64);
            let powers = i.is_multiple_of(7);
            MovingStretch {
                effort_n_per_kg: if powers { 0.06 + 1e-3 * (i % 13) as f64 } else { effort },
                mps2: if powers { 0.04 } else { acts * effort - 0.02 + wind },
                taken_n_per_kg: Some([0.0, 0.02]),
                run,
            }
        };
        differing(&(0..100).map(one).collect::<Vec<_>>(), 10, None)
    }

    fn of_run(run: usize) -> f64 {
        0.003 * f64::sin(1.7 * run as f64)
    }

    #[test]
    fn zeros_of_runs_are_found_where_the_motion_does_not_follow_them() {
        let zeros = found(of_run, 0.0, 5e-4).unwrap();
        assert!(zeros.is_sure && zeros.spread_n_per_kg > 1e-3, "{zeros:?}");
        for (run, zero) in zeros.of_runs.iter().enumerate() {
            assert!((zero.unwrap() - of_run(run)).abs() < 2e-5, "{run} {zero:?}");
        }
        assert_eq!(found(|_| 0.003, 0.0, 5e-4), None, "one zero");
    }

    /// The median of the distances from the median is 0.
    #[test]
    fn a_third_of_the_runs_may_have_another_zero() {
        let zeros = found(|run| if run % 3 == 0 { 0.004 } else { 0.0 }, 0.0, 5e-4).unwrap();
        assert!(zeros.is_sure && zeros.middle_n_per_kg.abs() < 2e-5, "{zeros:?}");
        assert_eq!(found(|run| if run == 3 { 0.004 } else { 0.0 }, 0.0, 5e-4), None, "one run");
    }

    #[test]
    fn a_light_power_is_no_zero_and_what_may_be_one_is_doubt() {
        assert_eq!(found(of_run, 1.0, 5e-4), None);
        let zeros = found(of_run, 0.0, 6e-3).unwrap();
        assert!(!zeros.is_sure && zeros.doubt_n_per_kg() > 2e-3, "{zeros:?}");
    }

    #[test]
    fn a_run_with_too_few_coasts_has_no_zero() {
        let all: Vec<MovingStretch> = (0..80)
            .map(|i| {
                let run = i % 10;
                let coasts = run < 9 || i < 20;
                MovingStretch {
                    effort_n_per_kg: if coasts { of_run(run) } else { 0.1 },
                    mps2: -0.02,
                    taken_n_per_kg: Some([0.0, 0.02]),
                    run,
                }
            })
            .collect();
        let zeros = differing(&all, 10, None).unwrap();
        assert_eq!(differing(&all, 10, Some(0.005)), None, "a column of such steps shows no zero so near to another");
        assert_eq!(
            zeros.of_runs.iter().map(Option::is_some).collect::<Vec<_>>(),
            [[true; 9].as_slice(), &[false]].concat()
        );
    }
}
