//! Is it more than chance, and does it repeat? What a term of the resistance must stand before it has a name; else it is told as a candidate.
//!
//! The column of the term, its shape and coefficients as found, is tried beside the other terms as the probes of the [evidence](crate::evidence) are: by signs
//! of whole runs and habits of drivers. It was looked for, so it must exceed the largest that chance makes of it or of any probe. And it must say the same in
//! both halves of the runs: by their order, by the date, by direction, by unit.

use crate::candidate::{Fitted, ShowsIn, Term};
use crate::chance::{Ground, Probe, probability};
use crate::config::GapConfig;
use crate::data::{believed::Context, rows::Row, runs::Run};
use crate::evidence::probes;
use crate::fit::median;
use crate::noise::calibrate::Calibrated;
use rundown::model::direction::Direction;
use rundown_check::agreement::Figure;
use serde_json::{Value, json};

/// How a term fared.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// Probability that chance alone makes as much of this term, or of any probe.
    pub p_value: f64,
    /// Where the runs could be halved: the term in both halves, as a multiple of what all runs say.
    pub halves: Vec<Halves>,
}

/// A term in two halves of the runs, as a multiple of what all runs say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Halves {
    /// What the halves are.
    pub by: By,
    /// In each of them.
    pub multiples: [Figure; 2],
}

/// Into which halves runs are split.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum By {
    /// Every second one.
    Turn,
    /// Earlier and later days.
    Date,
    /// Up and down.
    Direction,
    /// The unit with the most runs, and the others.
    Unit,
}

impl By {
    /// All of them.
    const ALL: [Self; 4] = [Self::Turn, Self::Date, Self::Direction, Self::Unit];

    /// As in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Turn => "turn",
            Self::Date => "date",
            Self::Direction => "direction",
            Self::Unit => "unit",
        }
    }

    /// What the two halves are called.
    pub fn halves(self) -> [&'static str; 2] {
        match self {
            Self::Turn => ["every second run", "the others"],
            Self::Date => ["the earlier days", "the later ones"],
            Self::Direction => ["up", "down"],
            Self::Unit => ["the unit with the most runs", "the others"],
        }
    }

    /// Whether each run is in the first half. `None`: nothing divides them.
    fn first(self, runs: &[Run]) -> Option<Vec<bool>> {
        let first: Vec<bool> = match self {
            Self::Turn => (0..runs.len()).map(|i| i % 2 == 0).collect(),
            Self::Direction => runs.iter().map(|run| run.direction == Direction::Up).collect(),
            Self::Date => {
                let middle = median(runs.iter().filter_map(|run| run.day))?;
                runs.iter().map(|run| run.day.is_some_and(|day| day < middle)).collect()
            }
            Self::Unit => {
                let count = |unit: &str| runs.iter().filter(|run| run.recorded.unit == unit).count();
                let most = runs.iter().map(|run| run.recorded.unit.as_str()).max_by_key(|unit| count(unit))?;
                runs.iter().map(|run| run.recorded.unit == most).collect()
            }
        };
        (first.contains(&true) && first.contains(&false)).then_some(first)
    }
}

impl Halves {
    /// The halves differ by more than chance, or one of them that could show it shows none.
    pub fn contradict(&self, config: &GapConfig) -> bool {
        let [a, b] = self.multiples;
        let telling = |half: &Figure| half.sd < config.certainty.telling_half;
        (a.value - b.value).abs() > config.certainty.halves * a.sd.hypot(b.sd)
            || self.multiples.iter().any(|half| telling(half) && half.value <= 0.0)
    }
}

impl Trial {
    /// It is no chance, and repeats.
    pub fn is_stood(&self, config: &GapConfig) -> bool {
        self.p_value <= config.certainty.chance && !self.halves.iter().any(|halves| halves.contradict(config))
    }

    /// As in `gap.json`.
    pub fn json(&self) -> Value {
        let of = |half: &Figure| json!({ "multiple": half.value, "sd": half.sd });
        let halves = self.halves.iter().map(|halves| {
            let [first, second] = halves.by.halves();
            let [a, b] = &halves.multiples;
            json!({ "by": halves.by.name(), "halves": [first, second], "multiples": [of(a), of(b)] })
        });
        json!({ "p_value": self.p_value, "halves": halves.collect::<Vec<_>>() })
    }

    /// Why it has no name, in a clause.
    pub fn sentence(&self, config: &GapConfig) -> String {
        if let Some(halves) = self.halves.iter().find(|halves| halves.contradict(config)) {
            let of = |which: usize| {
                let Figure { value, sd } = halves.multiples[which];
                format!("{value:.1} \u{b1} {sd:.1} times as large in {}", halves.by.halves()[which])
            };
            return format!("it does not repeat: it is {} and {}", of(0), of(1));
        }
        format!("chance alone makes as much of it in {:.0} % of draws", 100.0 * self.p_value)
    }
}

/// How each term of a model fares. `None`: one that does not show in the fit of its own law, or differs from run to run, is judged elsewhere.
pub fn trials(
    context: &Context<'_>,
    rows: &[Row],
    calibrated: &Calibrated,
    model: &[Fitted],
    runs: &[Run],
) -> Vec<Option<Trial>> {
    let flips = context.config.evidence.flips;
    if rows.is_empty() || model.is_empty() {
        return vec![None; model.len()];
    }
    let ground = Ground::new(context, rows, calibrated);
    let Some((_, probes)) = probes(&ground, &context.config.evidence) else {
        return vec![None; model.len()];
    };
    let by_chance = |draw| (probes.iter().map(|(_, _, probe)| probe.by_chance(&draw)).fold(0.0, f64::max), draw);
    let draws: Vec<_> = ground.draws(flips).map(by_chance).collect();
    let columns: Vec<Vec<f64>> = model.iter().map(|fitted| column(context, rows, fitted)).collect();
    let of_term = |(index, fitted): (usize, &Fitted)| {
        if !is_tried(&fitted.term) {
            return None;
        }
        let others = columns.iter().enumerate().filter(|(other, _)| *other != index).map(|(_, column)| column.clone());
        let base = ground.beside(&others.collect::<Vec<_>>())?;
        let probe = ground.probe(&base, &columns[index])?;
        let observed = probe.observed();
        let reached = draws.iter().filter(|(most, draw)| most.max(probe.by_chance(draw)) >= observed).count();
        Some(Trial { p_value: probability(reached, flips), halves: halves(&probe, &fitted.term, rows, runs) })
    };
    model.iter().enumerate().map(of_term).collect()
}

/// What a term adds in each row as it was found.
fn column(context: &Context<'_>, rows: &[Row], fitted: &Fitted) -> Vec<f64> {
    let beta = if fitted.term.is_whole() { &[1.0][..] } else { &fitted.beta };
    fitted.term.extra(beta, context, rows)
}

fn is_tried(term: &Term) -> bool {
    term.of.facts().nature.shows_in == ShowsIn::Law && !matches!(term.shape, crate::candidate::Shape::Runs(_))
}

/// The multiple of a column in halves of the runs; not by date what changes with it.
fn halves(probe: &Probe, term: &Term, rows: &[Row], runs: &[Run]) -> Vec<Halves> {
    let of_rows: Vec<usize> =
        rows.chunk_by(|a, b| a.interval.run == b.interval.run).map(|rows| rows[0].interval.run).collect();
    let of = |by: By| {
        let first = by.first(runs)?;
        let half = |wanted: bool| {
            let inside = || of_rows.iter().enumerate().filter(|(_, run)| first[**run] == wanted).map(|(i, _)| i);
            let information: f64 = inside().map(|i| probe.information[i]).sum();
            let value = inside().map(|i| probe.scores[i]).sum::<f64>() / information;
            // As runs scatter about it; no less than the noise says.
            let left = inside().map(|i| (probe.scores[i] - value * probe.information[i]).powi(2)).sum::<f64>();
            let sd = left.max(information).sqrt() / information;
            (information > 0.0).then_some(Figure { value, sd })
        };
        Some(Halves { by, multiples: [half(true)?, half(false)?] })
    };
    let told = |by: &By| !(term.between_runs() && *by == By::Date);
    By::ALL.into_iter().filter(told).filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::candidate::Shape;
    use crate::candidates;
    use crate::data::believed::tests::on_a_level_line;
    use crate::data::runs::Recorded;
    use crate::noise::whitening::Noise;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};
    use rundown::model::effects::EffectKind;

    const RUNS: usize = 30;
    const ROWS: usize = 60;
    /// Largest resistance of the section, N/kg.
    const DRAG_N_PER_KG: f64 = 0.01;

    /// The trial of a tunnel from km 20 to 25 of which so many times as much is there in each run as was found; noise of 0.01 N/kg.
    fn trial(seed: u64, multiple: fn(usize) -> f64) -> Trial {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let directions = [Direction::Up, Direction::Down];
        let mut rows = Vec::new();
        for run in 0..RUNS {
            for i in 0..ROWS {
                let mut row = Row::coasting(directions[run % 2], 1000.0 * i as f64, 25.0);
                row.interval.run = run;
                rows.push(row);
            }
        }
        let run = |run: usize| Run {
            name: run.to_string(),
            direction: directions[run % 2],
            day: Some(run as f64),
            samples: Vec::new(),
            recorded: Recorded::default(),
        };
        let runs: Vec<Run> = (0..RUNS).map(run).collect();
        let noise = Noise { acceleration_mps2: 0.01, ..Noise::default() };
        let calibrated = Calibrated { noise, spread: vec![1.0; rows.len()], ..Calibrated::default() };
        on_a_level_line(RUNS, |context| {
            let shape = Shape::Section([20_000.0, 25_000.0]);
            let term = Term { of: candidates::of(EffectKind::TunnelDrag), shape };
            let beta = vec![DRAG_N_PER_KG / term.extra(&[1.0], context, &rows).into_iter().fold(0.0, f64::max)];
            let extra = term.extra(&beta, context, &rows);
            for (row, extra) in rows.iter_mut().zip(extra) {
                let noise: f64 = StandardNormal.sample(&mut rng);
                row.residual_n_per_kg = 0.01 * noise + multiple(row.interval.run) * extra;
            }
            let fitted =
                Fitted { term, beta, sd: vec![0.0], gain: 0.0, section: None, shape: None, rivals: Vec::new() };
            trials(context, &rows, &calibrated, &[fitted], &runs).remove(0).unwrap()
        })
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

    #[test]
    fn what_is_not_there_is_chance() {
        let stood = (0..20).filter(|seed| trial(*seed, |_| 0.0).p_value <= 0.05).count();
        // The section is given and not looked for, so fewer than one in twenty.
        assert!(stood <= 3, "{stood} of 20");
    }

    #[test]
    fn what_is_there_on_later_days_only_does_not_repeat() {
        for seed in 0..5 {
            let trial = trial(seed, |run| if run < RUNS / 2 { 0.0 } else { 2.0 });
            let config = GapConfig::default();
            assert!(trial.p_value <= config.certainty.chance && !trial.is_stood(&config), "{trial:?}");
            assert!(trial.sentence(&config).contains("in the earlier days"), "{}", trial.sentence(&config));
        }
    }
}
