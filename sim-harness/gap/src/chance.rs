//! What chance alone would make of a column: sign-flip test over runs, and for probes that know no law what drivers do
//! alike drawn beside them.

use crate::config::{EvidenceConfig, GapConfig};
use crate::data::{believed::Context, rows::Row};
use crate::fit::Base;
use crate::noise::alike::Alike;
use crate::noise::calibrate::{Calibrated, flexible};
use crate::noise::habit_sizes::Habits;
use crate::noise::habits;
use crate::noise::whitening::Whitening;
use crate::search::fits::sensors;
use nalgebra::DVector;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rundown_check::figure::Figure;

/// One draw: the signs of the runs, and how large each habit is in its standard deviations.
pub struct Draw {
    signs: Vec<f64>,
    habits: Vec<f64>,
}

/// Probability of what so many of the draws reach.
pub fn probability(reached: usize, draws: usize) -> f64 {
    (reached + 1) as f64 / (draws + 1) as f64
}

/// Residuals on which columns are tried.
pub struct Ground<'a> {
    context: &'a Context<'a>,
    pub rows: &'a [Row],
    whitening: Whitening,
    y: DVector<f64>,
    sensors: Vec<DVector<f64>>,
    /// One standard deviation of each habit that is drawn, and of errors that runs have alike.
    habits: Vec<DVector<f64>>,
}

/// Errors of rounding that runs have alike are drawn, too: signs by run say nothing of them.
fn rounded_alike(context: &Context<'_>, rows: &[Row], whitening: &Whitening) -> Vec<DVector<f64>> {
    let forces = Alike::of(context, rows).map_or_else(Vec::new, |alike| alike.forces());
    forces.iter().map(|force| whitening.whiten(force)).collect()
}

fn residuals(rows: &[Row]) -> Vec<f64> {
    rows.iter().map(|row| row.residual_n_per_kg).collect()
}

/// Driven rows count as much less as they scatter more.
fn driven_less(context: &Context<'_>, rows: &[Row], calibrated: &Calibrated) -> Calibrated {
    let mut calibrated = calibrated.clone();
    for (spread, wider) in calibrated.spread.iter_mut().zip(habits::wider(rows, &context.config.evidence)) {
        *spread *= wider;
    }
    calibrated
}

/// Where the effort changes within an interval its mean is a guess, and the guess is wrong in the same way in all runs.
fn is_steady(row: &Row, config: &EvidenceConfig) -> bool {
    row.interval.effort_change_n_per_kg <= config.steady_n_per_kg
}

/// Other rows hardly count. They do so in the fit of what a column is tried beside, too: were only the column none in
/// them, a lag of the locations, say, would take from these rows what a train length does, and then from all of them.
fn steady(context: &Context<'_>, rows: &[Row], calibrated: &Calibrated) -> Calibrated {
    let config = &context.config.evidence;
    let mut calibrated = driven_less(context, rows, calibrated);
    let unsteady = calibrated.spread.iter_mut().zip(rows).filter(|(_, row)| !is_steady(row, config));
    unsteady.for_each(|(spread, _)| *spread *= config.unsteady_wider);
    calibrated
}

/// A column that was tried: what it makes of each run.
pub struct Probe {
    /// Of each run.
    pub runs: Vec<OfRun>,
    /// Runs in which it acts.
    acting: usize,
    /// Of all runs, weighed: what signs leave as it is.
    information: f64,
    /// Variance of the score by the noise alone, and by the habits that are drawn.
    noise: f64,
    drawn: f64,
    /// The score that what does not count would make.
    small: f64,
    /// The score by one standard deviation of each habit that is drawn.
    habits: Vec<f64>,
}

/// What a column makes of a run.
#[derive(Clone, Copy, Debug)]
pub struct OfRun {
    /// Its score: so much times [`Self::information`] units of the column.
    pub score: f64,
    /// How much it would be by one unit of the column, which is its variance by the noise alone.
    pub information: f64,
    /// One run that says much is not all runs: a column differs from run to run, too.
    weight: f64,
}

impl OfRun {
    /// What a run says by itself: a multiple with its standard deviation.
    pub fn of(multiple: Figure) -> Self {
        let information = multiple.sd.powi(-2);
        Self { score: multiple.value * information, information, weight: 1.0 }
    }

    /// Its weight where the multiple has this variance between runs.
    pub fn weight_beside(&self, between: f64) -> f64 {
        1.0 / (1.0 + between * self.information)
    }
}

/// How runs scatter about a multiple of a column, beyond what noise makes: the excess of the sum of squares, and by how
/// much it grows with the variance between runs, so that their ratio is an estimate of it. (DerSimonian and Laird
/// 1986.)
///
/// `about`: the multiple, where it is known; else the mean of these runs.
pub fn beyond_noise(runs: impl Iterator<Item = OfRun> + Clone, about: Option<f64>) -> [f64; 2] {
    let runs = runs.filter(|run| run.information > 0.0);
    let sum = |of: &dyn Fn(OfRun) -> f64| runs.clone().map(of).sum::<f64>();
    let information = sum(&|run| run.information);
    let mean = about.unwrap_or_else(|| sum(&|run| run.score) / information);
    let squares = sum(&|run| (run.score - mean * run.information).powi(2) / run.information);
    let count = runs.clone().count() as f64;
    match about {
        Some(_) => [squares - count, information],
        None => [squares - (count - 1.0), information - sum(&|run| run.information.powi(2)) / information],
    }
}

/// The product of two columns in the rows of a run.
fn within(run: &core::ops::Range<usize>, a: &DVector<f64>, b: &DVector<f64>) -> f64 {
    a.rows(run.start, run.len()).dot(&b.rows(run.start, run.len()))
}

impl<'a> Ground<'a> {
    /// For the evidence: what drivers do alike is drawn beside the signs, so no probe is more than it.
    pub fn of_probes(context: &'a Context<'a>, rows: &'a [Row], calibrated: &Calibrated, sizes: [f64; 2]) -> Self {
        let whitening = steady(context, rows, calibrated).for_probes(context, rows);
        let forces = habits::forces(rows, &context.config.evidence).into_iter();
        let habits = forces
            .filter(|(_, habit)| sizes[*habit] > 0.0)
            .map(|(force, habit)| whitening.whiten(&force) * sizes[habit]);
        let habits = habits.chain(rounded_alike(context, rows, &whitening)).collect();
        Self { habits, ..Self::on(context, rows, whitening) }
    }

    /// How large what drivers do alike is in these runs, while powering and while braking, N/kg.
    pub fn habit_sizes(context: &Context<'_>, rows: &[Row], calibrated: &Calibrated) -> [f64; 2] {
        let most = habits::judged(&calibrated.driven_n_per_kg, &context.config.evidence);
        if most == [0.0; 2] {
            return most;
        }
        let whitening = steady(context, rows, calibrated).without_nuisances(context, rows);
        let ground = Ground::on(context, rows, whitening);
        let Some(base) = ground.beside(&flexible(context, rows, &[])) else {
            return most;
        };
        let beside = |(force, habit): (Vec<f64>, usize)| (base.beside(&ground.whitening.whiten(&force)), habit);
        let forces: Vec<_> = habits::forces(rows, &context.config.evidence).into_iter().map(beside).collect();
        Habits::new(&forces, &base.residual).sizes(most)
    }

    /// For the trial of a law that is known: what drivers do alike is a random effect beside it, which leaves what only
    /// the law explains.
    pub fn of_terms(context: &'a Context<'a>, rows: &'a [Row], calibrated: &Calibrated) -> Self {
        Self::on(context, rows, steady(context, rows, calibrated).for_trials(context, rows))
    }

    /// For comparing runs by what all have alike in part: the gain of all is no random effect, which would take its
    /// share from each run.
    pub fn of_each_run(context: &'a Context<'a>, rows: &'a [Row], calibrated: &Calibrated) -> Self {
        Self::on(context, rows, driven_less(context, rows, calibrated).without_nuisances(context, rows))
    }

    fn on(context: &'a Context<'a>, rows: &'a [Row], whitening: Whitening) -> Self {
        let sensors = sensors(context, rows, &whitening);
        Self { y: whitening.whiten(&residuals(rows)), sensors, habits: Vec::new(), context, rows, whitening }
    }

    /// What these columns and those of the sensors leave. `None`: they are not independent.
    pub fn beside(&self, columns: &[Vec<f64>]) -> Option<Base> {
        let white = columns.iter().map(|column| self.whitening.whiten(column));
        let all: Vec<DVector<f64>> = white.chain(self.sensors.iter().cloned()).collect();
        Base::new(&self.y, &all, self.whitening.runs())
    }

    /// A column by what the base leaves of the residuals. `None`: it acts in too few runs.
    pub fn probe(&self, base: &Base, column: &[f64]) -> Option<Probe> {
        let config = &self.context.config;
        let shows = |i: usize| column[i] != 0.0 && is_steady(&self.rows[i], &config.evidence);
        let acts = |r: &&core::ops::Range<usize>| (*r).clone().any(shows);
        let acting = self.whitening.runs().iter().filter(acts).count();
        let column: DVector<f64> = base.beside(&self.whitening.whiten(column));
        let runs = self.whitening.runs();
        let mut of_runs = self.scores(base, &column);
        // About none, so that flipped signs have the same weights.
        let [excess, growth] = beyond_noise(of_runs.iter().copied(), Some(0.0));
        of_runs.iter_mut().for_each(|run| run.weight = run.weight_beside((excess / growth).max(0.0)));
        let information: f64 = of_runs.iter().map(|run| run.weight * run.information).sum();
        let weighted = |habit: &DVector<f64>| {
            runs.iter().zip(&of_runs).map(|(r, run)| run.weight * within(r, &column, habit)).sum::<f64>()
        };
        let habits: Vec<f64> = self.habits.iter().map(weighted).collect();
        let noise = of_runs.iter().map(|run| run.weight.powi(2) * run.information).sum();
        let drawn = habits.iter().map(|habit| habit * habit).sum();
        let small = config.certainty.nothing_n_per_kg * information;
        let enough = acting >= config.evidence.least_runs && information > 0.0;
        enough.then_some(Probe { runs: of_runs, acting, information, noise, drawn, small, habits })
    }

    /// What a column makes of each run beside the base, which it may be a part of: for comparing runs with each other,
    /// where what all have alike cancels.
    pub fn of_runs(&self, base: &Base, column: &[f64]) -> Vec<OfRun> {
        self.scores(base, &self.whitening.whiten(column))
    }

    /// Of a whitened column, without weights.
    fn scores(&self, base: &Base, column: &DVector<f64>) -> Vec<OfRun> {
        let of_run =
            |r| OfRun { score: within(r, column, &base.residual), information: within(r, column, column), weight: 1.0 };
        self.whitening.runs().iter().map(of_run).collect()
    }

    /// So many draws of chance, always the same ones.
    pub fn draws(&self, count: usize) -> impl Iterator<Item = Draw> {
        let (runs, habits) = (self.whitening.runs().len(), self.habits.len());
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        (0..count).map(move |_| Draw {
            signs: (0..runs).map(|_| if rng.next_u32() & 1 == 0 { 1.0 } else { -1.0 }).collect(),
            habits: (0..habits).map(|_| StandardNormal.sample(&mut rng)).collect(),
        })
    }
}

impl Probe {
    /// In standard deviations: those that the runs scatter about their mean, no less than the noise says. Few runs that
    /// agree are then as sure as they are; measured by the sum of their squares they could never be.
    ///
    /// `alike`: of its score, what all runs have alike by chance; its variance is `varies`.
    fn size(&self, beyond: f64, alike: f64, varies: f64, sign: impl Fn(usize) -> f64) -> f64 {
        let runs = || self.runs.iter().enumerate();
        let sum: f64 = runs().map(|(i, run)| sign(i) * run.weight * run.score).sum();
        let mean = sum / self.information;
        let left = |(i, run): (usize, &OfRun)| (run.weight * (sign(i) * run.score - mean * run.information)).powi(2);
        let scatter: f64 = runs().map(left).sum();
        ((sum + alike).abs() - beyond).max(0.0) / (scatter.max(self.noise) + varies).sqrt()
    }

    fn habits(&self, draw: &Draw) -> f64 {
        self.habits.iter().zip(&draw.habits).map(|(habit, size)| habit * size).sum()
    }

    /// As chance would have it.
    pub fn by_chance(&self, draw: &Draw) -> f64 {
        self.size(0.0, self.habits(draw), self.drawn, |i| draw.signs[i])
    }

    /// As it is, beyond what does not count.
    pub fn observed(&self) -> f64 {
        self.size(self.small, 0.0, self.drawn, |_| 1.0)
    }

    /// One standard deviation of what sensors leave in all runs alike: what does not count is two.
    fn left_alike(&self) -> f64 {
        0.5 * self.small
    }

    /// As it is, beside what sensors leave in all runs alike.
    pub fn observed_beside_sensors(&self) -> f64 {
        self.size(0.0, 0.0, self.drawn + self.left_alike().powi(2), |_| 1.0)
    }

    /// As chance would have it, and sensors: so many standard deviations of what they leave in all runs alike.
    pub fn by_chance_beside_sensors(&self, draw: &Draw, left: f64) -> f64 {
        let alike = self.habits(draw) + left * self.left_alike();
        self.size(0.0, alike, self.drawn + self.left_alike().powi(2), |i| draw.signs[i])
    }

    /// Signs that are all alike change nothing: of too few runs they are so in more draws than a name may be chance in.
    pub fn can_be_tried(&self, config: &GapConfig) -> bool {
        (1.0 - self.acting as f64).exp2() <= config.certainty.chance
    }
}
