//! A limit of the traction in halves of the runs: where it acts stays, how much it takes is found again in each half.
//!
//! The likelihood of multiples of what all runs say; its 95 % limits are those that lose what an interval allows.

use crate::config::TractionConfig;
use crate::data::runs::Run;
use crate::fit::LOSS_AT_LIMIT;
use crate::traction::limit::FoundLimit;
use crate::traction::powering::SteadyPower;
use crate::traction::shares::Shares;
use crate::trial::{By, Halves};
use rundown::model::effects::{Effect, LowAdhesion, PowerLimitSection};
use rundown_check::figure::Figure;
use rundown_check::figure::HALF_95;

/// Multiples that are tried: from none to twice as much.
const STEPS: usize = 41;
const STEP: f64 = 0.05;

/// What each multiple of a limit adds to the log-likelihood of a run.
struct RunMultiples {
    run: usize,
    gains: [f64; STEPS],
}

/// A limit in halves of the runs. `powering` by run, as it was found from.
pub fn halves(found: &FoundLimit, powering: &[Vec<SteadyPower>], runs: &[Run], config: &TractionConfig) -> Vec<Halves> {
    let acts = |run: usize| found.runs.is_empty() || found.runs.contains(&run);
    let of_run = |powering: &Vec<SteadyPower>| {
        let run = powering.first().map(|part| part.run).filter(|run| powering.len() >= 2 && acts(*run))?;
        let shares = Shares::new(powering, config);
        let factor = |i: usize| 1.0 - i as f64 * STEP * (1.0 - found.factor);
        let gains = core::array::from_fn(|i| gain(&shares, &found.effect, factor(i)));
        // A run that powers nowhere where the limit acts says nothing.
        gains.iter().any(|gain| *gain != 0.0).then_some(RunMultiples { run, gains })
    };
    let each: Vec<RunMultiples> = powering.iter().filter_map(of_run).collect();
    By::ALL.into_iter().filter_map(|by| split(&each, by, runs)).collect()
}

/// What the same kind of limit, with another factor, adds to the log-likelihood of a run.
fn gain(run: &Shares<'_>, effect: &Effect, factor: f64) -> f64 {
    if let Effect::PowerLimitSection(PowerLimitSection { from_m, to_m, .. }) = effect {
        let within = *from_m..*to_m;
        return run.gain(|power| if power.by_power && within.contains(&power.location_m) { factor } else { 1.0 });
    }
    if let Effect::LowAdhesion(LowAdhesion { below_kmh, .. }) = effect {
        let limited = |power: &SteadyPower| 3.6 * power.speed_mps < *below_kmh;
        return run.gain(|power| if limited(power) { factor * power.effort_over_limit } else { 1.0 });
    }
    // All of the traction. Drivers demand more than the train gives, or what they demand scales with it.
    let most = run.gain_up_to(factor);
    if factor < 1.0 { run.gain(|_| factor).max(most) } else { most }
}

/// Both halves. `None`: one of them says nothing.
fn split(each: &[RunMultiples], by: By, runs: &[Run]) -> Option<Halves> {
    let half_of = by.halves_of(runs);
    let of = |wanted: usize| each.iter().filter(|one| half_of[one.run] == Some(wanted)).collect();
    let [first, second]: [Vec<&RunMultiples>; 2] = [of(0), of(1)];
    let freedom = (first.len() + second.len()) as f64 - 2.0;
    Some(Halves { by, multiples: [likeliest(&first)?, likeliest(&second)?], freedom: freedom.max(0.0) })
}

/// The likeliest multiple in some runs, the nearest to 1 of those that are alike.
fn likeliest(runs: &[&RunMultiples]) -> Option<Figure> {
    let gain = |i: &usize| runs.iter().map(|run| run.gains[*i]).sum::<f64>();
    let off = |i: &usize| (STEP * *i as f64 - 1.0).abs();
    let better = |a: &usize, b: &usize| gain(a).total_cmp(&gain(b)).then(off(b).total_cmp(&off(a)));
    let best = (0..STEPS).max_by(better).filter(|_| !runs.is_empty())?;
    let allowed = || (0..STEPS).filter(|i| gain(&best) - gain(i) < LOSS_AT_LIMIT);
    let width = STEP * (allowed().max()? - allowed().min()?) as f64;
    // To a step, to which multiples are known.
    let sd = (0.5 * width / HALF_95).hypot(STEP);
    Some(Figure { value: STEP * best as f64, sd })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::GapConfig;
    use crate::data::runs::Recorded;
    use rundown::model::direction::Direction;

    /// Halves of a section of 70 % in 20 runs, in which the later ones reach a share of the power.
    fn found(later: f64) -> Vec<Halves> {
        let part = |run: usize, number: usize, location_m: f64, ratio: f64| SteadyPower {
            run,
            location_m,
            speed_mps: 25.0,
            ratio: ratio + 0.01 * ((run * 7 + number) as f64).sin(),
            sd: 0.01,
            effort_over_limit: 2.0,
            by_power: true,
            number,
            weight: 1.0,
        };
        let of_run = |run: usize| {
            let inside = if run < 10 { 0.7 } else { later };
            (0..4).map(|i| part(run, i, 1_000.0, 1.0)).chain((4..8).map(|i| part(run, i, 5_000.0, inside))).collect()
        };
        let powering: Vec<Vec<SteadyPower>> = (0..20).map(of_run).collect();
        let run = |run: usize| Run {
            name: run.to_string(),
            direction: Direction::Up,
            day: Some(run as f64),
            samples: Vec::new(),
            recorded: Recorded::default(),
        };
        let runs: Vec<Run> = (0..20).map(run).collect();
        let limit = FoundLimit {
            effect: PowerLimitSection { from_m: 4_000.0, to_m: 6_000.0, factor: 0.7 }.into(),
            factor: 0.7,
            factor_sd: 0.01,
            runs: Vec::new(),
            gain: 50.0,
            value: 40.0,
            edges_m: None,
            below_kmh: None,
            demanded: 0.0,
        };
        halves(&limit, &powering, &runs, &TractionConfig::default())
    }

    #[test]
    fn a_section_that_is_there_on_all_days_repeats_and_one_of_the_earlier_days_does_not() {
        let config = GapConfig::default();
        let always = found(0.7);
        let by: Vec<By> = always.iter().map(|halves| halves.by).collect();
        assert_eq!(by, [By::Turn, By::Date], "one direction, one unit");
        for halves in &always {
            assert!(halves.multiples.iter().all(|half| (half.value - 1.0).abs() < 0.15), "{halves:?}");
            assert!(!halves.contradict(&config), "{halves:?}");
        }
        let earlier = found(1.0);
        let by_date = earlier.iter().find(|halves| halves.by == By::Date).unwrap();
        assert!(by_date.contradict(&config), "{by_date:?}");
        assert!(by_date.multiples[1].value < 0.2, "{by_date:?}");
    }
}
