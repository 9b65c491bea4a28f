//! The trial of each term of a model: its column beside the other terms, by flipped signs of runs and in halves of the
//! runs.

use crate::candidate::{Fitted, ShowsIn, Term};
use crate::chance::{Ground, OfRun, Probe, beyond_noise, probability};
use crate::data::{believed::Context, rows::Row, runs::Run};
use crate::evidence::probes;
use crate::noise::{calibrate::Calibrated, gradients::Errors};
use crate::trial::{By, Halves, Trial};
use rundown::model::effects::EffectKind;
use rundown_check::figure::Figure;

/// How each term of a model fares. `None`: one that does not show in the fit of its own law, or differs from run to
/// run, is judged elsewhere. One that cannot be distinguished from chance has not stood its trial.
///
/// Where the described gradients may be off, it is tried a second time beside typical errors of them.
pub fn trials(
    context: &Context<'_>,
    rows: &[Row],
    calibrated: &Calibrated,
    model: &[Fitted],
    runs: &[Run],
) -> Vec<Option<Trial>> {
    let mut all = beside_sure_errors(context, rows, calibrated, model, runs);
    let (config, may_be) = (context.config, calibrated.gradients.may_be);
    // A wrong gradient is one of the errors.
    let doubted = |(fitted, trial): (&Fitted, &Option<Trial>)| {
        !fitted.term.is(EffectKind::GradientError) && trial.as_ref().is_some_and(|one| one.is_stood(config))
    };
    let doubted: Vec<bool> = model.iter().zip(&all).map(doubted).collect();
    // So improbable errors would raise a p-value by less than `chance`.
    if may_be < config.certainty.chance || !doubted.contains(&true) {
        return all;
    }
    let gradients = Errors { sd_permille: config.gradients.typical_permille, may_be: 0.0 };
    let beside = beside_sure_errors(context, rows, &Calibrated { gradients, ..calibrated.clone() }, model, runs);
    for ((trial, beside), _) in all.iter_mut().zip(beside).zip(doubted).filter(|(_, doubted)| *doubted) {
        if let (Some(trial), Some(beside)) = (trial, beside) {
            trial.beside_errors(may_be, &beside);
        }
    }
    all
}

/// How each term of a model fares, beside the errors of the gradients that are surely there.
fn beside_sure_errors(
    context: &Context<'_>,
    rows: &[Row],
    calibrated: &Calibrated,
    model: &[Fitted],
    runs: &[Run],
) -> Vec<Option<Trial>> {
    let flips = context.config.evidence.flips;
    if model.is_empty() {
        return Vec::new();
    }
    let ground = Ground::of_terms(context, rows, calibrated);
    let probes = probes(&ground, &ground, &context.config.evidence);
    let by_chance = |draw| (probes.iter().map(|placed| placed.probe.by_chance(&draw)).fold(0.0, f64::max), draw);
    let draws: Vec<_> = ground.draws(flips).map(by_chance).collect();
    let columns: Vec<Vec<f64>> = model.iter().map(|fitted| column(context, rows, fitted)).collect();
    let of_term = |(index, fitted): (usize, &Fitted)| {
        let others = columns.iter().enumerate().filter(|(other, _)| *other != index).map(|(_, column)| column.clone());
        let base = ground.beside(&others.collect::<Vec<_>>())?;
        let probe = ground.probe(&base, &columns[index]).filter(|probe| probe.can_be_tried(context.config))?;
        let observed = probe.observed();
        let reached = draws.iter().filter(|(most, draw)| most.max(probe.by_chance(draw)) >= observed).count();
        Some(Trial::of(probability(reached, flips), halves(&probe, &fitted.term, rows, runs)))
    };
    let tried = |one: (usize, &Fitted)| is_tried(&one.1.term).then(|| of_term(one).unwrap_or(Trial::IMPOSSIBLE));
    model.iter().enumerate().map(tried).collect()
}

/// What a term adds in each row as it was found.
pub(crate) fn column(context: &Context<'_>, rows: &[Row], fitted: &Fitted) -> Vec<f64> {
    let beta = if fitted.term.is_whole() { &[1.0][..] } else { &fitted.beta };
    fitted.term.extra(beta, context, rows)
}

fn is_tried(term: &Term) -> bool {
    term.of.facts().nature.shows_in == ShowsIn::Law && term.shape.runs().is_empty()
}

/// The multiple of a column in halves of the runs; not by date what changes with it.
fn halves(probe: &Probe, term: &Term, rows: &[Row], runs: &[Run]) -> Vec<Halves> {
    let of_rows = rows.chunk_by(|a, b| a.interval.run == b.interval.run).map(|rows| rows[0].interval.run);
    let each: Vec<(usize, OfRun)> = of_rows.zip(probe.runs.iter().copied()).collect();
    let mut all = in_halves(&each, runs);
    all.retain(|halves| !(term.between_runs() && halves.by == By::Date));
    all
}

/// A scale in halves of the runs that say something of it; none where they cannot be halved. `each`: index of a run,
/// and the scale by it alone.
pub(crate) fn of_scale(scale: f64, each: &[(usize, Figure)], runs: &[Run]) -> Option<Trial> {
    let off = scale - 1.0;
    let multiple = |one: &Figure| Figure { value: (one.value - 1.0) / off, sd: one.sd / off.abs() };
    let each: Vec<(usize, OfRun)> = each.iter().map(|(run, one)| (*run, OfRun::of(multiple(one)))).collect();
    Trial::by_halves(in_halves(&each, runs))
}

/// Wherever runs can be halved, the mean of both halves. `each`: index of a run, and what it says.
pub(crate) fn in_halves(each: &[(usize, OfRun)], runs: &[Run]) -> Vec<Halves> {
    let of = |by: By| {
        let half_of = by.halves_of(runs);
        let inside = |wanted: usize| {
            let of_half = each.iter().filter(|(run, _)| half_of[*run] == Some(wanted));
            of_half.map(|(_, of_run)| *of_run).collect::<Vec<OfRun>>()
        };
        let both = [inside(0), inside(1)];
        // As runs scatter within the halves.
        let [[a, of_a], [b, of_b]] = both.each_ref().map(|half| beyond_noise(half.iter().copied(), None));
        let between = ((a + b) / (of_a + of_b)).max(0.0);
        let figure = |half: &Vec<OfRun>| {
            let sum =
                |of: &dyn Fn(&OfRun) -> f64| half.iter().map(|run| run.weight_beside(between) * of(run)).sum::<f64>();
            let information = sum(&|run| run.information);
            let square: f64 = half.iter().map(|run| (run.weight_beside(between) * run.information).powi(2)).sum();
            let figure = Figure { value: sum(&|run| run.score) / information, sd: 1.0 / information.sqrt() };
            (information > 0.0).then_some((figure, information * information / square - 1.0))
        };
        let [(first, free), (second, also)] = [figure(&both[0])?, figure(&both[1])?];
        Some(Halves { by, multiples: [first, second], freedom: (free + also).max(0.0) })
    };
    By::ALL.into_iter().filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::candidate::Shape;
    use crate::candidates;
    use crate::config::GapConfig;
    use crate::data::believed::tests::{on_a_hilly_line, on_a_level_line};
    use crate::data::runs::Recorded;
    use crate::noise::whitening::Noise;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};
    use rundown::model::{direction::Direction, effects::EffectKind};

    const RUNS: usize = 30;
    const ROWS: usize = 60;
    /// Largest resistance of the section, N/kg.
    const DRAG_N_PER_KG: f64 = 0.01;

    fn run(run: usize) -> Run {
        Run {
            name: run.to_string(),
            direction: [Direction::Up, Direction::Down][run % 2],
            day: Some(run as f64),
            samples: Vec::new(),
            recorded: Recorded::default(),
        }
    }

    /// The trial of a tunnel from km 20 to 25 of which so many times as much is there in each run as was found; noise
    /// of 0.01 N/kg.
    fn trial(seed: u64, multiple: fn(usize) -> f64) -> Trial {
        trial_of(EffectKind::TunnelDrag, &[Direction::Up, Direction::Down], 0.0, seed, multiple)
    }

    /// The same of a section of one kind, and of runs in these directions in turn, whose gradients may be off.
    fn trial_of(
        kind: EffectKind,
        directions: &[Direction],
        may_be: f64,
        seed: u64,
        multiple: fn(usize) -> f64,
    ) -> Trial {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut rows = Vec::new();
        for run in 0..RUNS {
            for i in 0..ROWS {
                let mut row = Row::coasting(directions[run % directions.len()], 1000.0 * i as f64, 25.0);
                row.interval.run = run;
                rows.push(row);
            }
        }
        let runs: Vec<Run> = (0..RUNS).map(run).collect();
        let noise = Noise { acceleration_mps2: 0.01, ..Noise::default() };
        let gradients = Errors { sd_permille: 0.0, may_be };
        let calibrated = Calibrated { noise, spread: vec![1.0; rows.len()], gradients, ..Calibrated::default() };
        on_a_level_line(RUNS, |context| {
            let shape = Shape::Section([20_000.0, 25_000.0]);
            let term = Term { of: candidates::of(kind), shape };
            let beta = vec![DRAG_N_PER_KG / term.extra(&[1.0], context, &rows).into_iter().fold(0.0, f64::max)];
            let extra = term.extra(&beta, context, &rows);
            for (row, extra) in rows.iter_mut().zip(extra) {
                let noise: f64 = StandardNormal.sample(&mut rng);
                row.residual_n_per_kg = 0.01 * noise + multiple(row.interval.run) * extra;
            }
            let fitted = Fitted::certain(term, beta);
            trials(context, &rows, &calibrated, &[fitted], &runs).remove(0).unwrap()
        })
    }

    /// A half of 0.01 N/kg is half a permille over five kilometres, where 0.3 are typical.
    #[test]
    fn a_resistance_that_errors_of_the_gradients_may_make_has_no_name() {
        let config = GapConfig::default();
        // How many of four stand, and how many are of errors.
        let of = |kind: EffectKind, directions: &[Direction], may_be: f64, multiple: fn(usize) -> f64| {
            let trials: Vec<Trial> = (0..4).map(|seed| trial_of(kind, directions, may_be, seed, multiple)).collect();
            let count = |is: &dyn Fn(&Trial) -> bool| trials.iter().filter(|trial| is(trial)).count();
            let candidate = |trial: &Trial| trial.is_of_errors(&config) && trial.is_beyond_chance(&config);
            [count(&|trial| trial.is_stood(&config)), count(&candidate)]
        };
        let (up, both) = (&[Direction::Up][..], &[Direction::Up, Direction::Down][..]);
        let [stood, candidates] = of(EffectKind::TunnelDrag, up, 0.95, |_| 0.5);
        assert!(stood <= 1 && candidates == 4 - stood, "{stood} {candidates}");
        assert_eq!(of(EffectKind::TunnelDrag, up, 0.01, |_| 0.5), [4, 0], "they are hardly off");
        assert_eq!(of(EffectKind::TunnelDrag, up, 0.95, |_| 3.0), [4, 0], "no errors are as large");
        // They turn with the direction, and a gradient is one of them.
        for (kind, directions) in [(EffectKind::TunnelDrag, both), (EffectKind::GradientError, up)] {
            let [stood, candidates] = of(kind, directions, 0.95, |_| 0.5);
            assert!(stood >= 3 && candidates == 0, "{kind:?} {stood} {candidates}");
        }
    }

    #[test]
    fn what_is_there_in_all_runs_stands() {
        for seed in 0..5 {
            let trial = trial(seed, |_| 1.0);
            assert!(trial.is_stood(&GapConfig::default()), "{trial:?}");
            let by: Vec<By> = trial.halves.iter().map(|halves| halves.by).collect();
            assert_eq!(by, [By::Turn, By::Date, By::Direction], "all runs are of one unit");
            for figure in trial.halves.iter().flat_map(|halves| halves.multiples) {
                assert!(figure.away_from(1.0) < 4.0, "{figure:?}");
            }
        }
    }

    /// A lag of the locations does what another length does, where all trains run as fast; it must not learn from rows
    /// that the length is not tried in.
    #[test]
    fn rows_whose_effort_changes_take_nothing_from_a_length_that_the_others_show() {
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        on_a_hilly_line(RUNS, |context| {
            let row = |k: usize| {
                let (run, i) = (k / 100, k % 100);
                let at_m = 290.0 * i as f64;
                let mut row =
                    Row::coasting([Direction::Up, Direction::Down][run % 2], at_m, 25.0 + 0.1 * (i % 50) as f64);
                row.interval.run = run;
                row.interval.effort_n_per_kg = Some(0.0);
                row.interval.effort_change_n_per_kg = if k.is_multiple_of(3) { 0.0 } else { 0.1 };
                row
            };
            let mut rows: Vec<Row> = (0..RUNS * 100).map(row).collect();
            let length_m = 0.5 * context.believed.train().length_m();
            let term = Term { of: candidates::of(EffectKind::TrainLengthError), shape: Shape::Number(length_m) };
            let extra = term.extra(&[1.0], context, &rows);
            for (row, extra) in rows.iter_mut().zip(extra) {
                let noise: f64 = StandardNormal.sample(&mut rng);
                row.residual_n_per_kg = 0.004 * noise + extra;
            }
            let noise = Noise { acceleration_mps2: 0.004, ..Noise::default() };
            let calibrated = Calibrated::even(noise, rows.len());
            let runs: Vec<Run> = (0..RUNS).map(run).collect();
            let trial =
                trials(context, &rows, &calibrated, &[Fitted::certain(term, vec![1.0])], &runs).remove(0).unwrap();
            assert!(trial.is_stood(&GapConfig::default()), "{trial:?}");
            for figure in trial.halves.iter().flat_map(|halves| halves.multiples) {
                assert!(figure.away_from(1.0) < 3.0, "{figure:?}");
            }
        });
    }

    #[test]
    fn what_is_not_there_is_chance() {
        let stood = (0..20).filter(|seed| trial(*seed, |_| 0.0).p_value.is_some_and(|p| p <= 0.05)).count();
        // The section is given and not looked for, so fewer than one in twenty.
        assert!(stood <= 3, "{stood} of 20");
    }

    #[test]
    fn what_is_there_on_later_days_only_does_not_repeat() {
        for seed in 0..5 {
            let trial = trial(seed, |run| if run < RUNS / 2 { 0.0 } else { 2.0 });
            let config = GapConfig::default();
            assert!(
                trial.p_value.is_some_and(|p| p <= config.certainty.chance) && !trial.is_stood(&config),
                "{trial:?}"
            );
            assert!(trial.sentence(&config).contains("in the earlier days"), "{}", trial.sentence(&config));
        }
    }
}
