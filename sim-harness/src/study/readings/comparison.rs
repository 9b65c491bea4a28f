//! Every combination on the runs of many seeds, or on recorded ones. The train is driven once for each simulated run,
//! and every recorder sees the same run. Recorded runs have one recorder, and where a diagnosis put something right,
//! another that recorded so.

use super::optimum::gain_per_sample;
use super::pass::{Filter, Pass};
use super::reading::{Combination, Recorder};
use super::remarks::{COUNT, JudgedRuns, TRIED, judge};
use crate::simulation::scenario_file::Simulation;
use crate::study::case::Case;
use crate::study::description::{self, Believed};
use crate::study::{Refused, moments::Moments};
use rayon::prelude::*;
use rundown::model::line::Line;
use rundown_files::recording::Recording;
use rundown_truth::plan::plan as planned;
use rundown_truth::scenario::{DriveError, simulate_recorders};

/// Between the seeds of neighbouring sets of runs.
const SEED_STEP: u64 = 1_000_003;

#[derive(Clone, Debug)]
pub struct ComparisonPlan {
    pub simulation: Simulation,
    pub runs: usize,
    pub seeds: usize,
    /// The first.
    pub seed: u64,
}

/// The runs of a set by each recorder.
pub type ByRecorder = Vec<(Recorder, Vec<Recording>)>;

/// What a combination gives; an entry for each seed.
#[derive(Clone, Debug)]
pub struct Compared {
    pub combination: Combination,
    /// Remarks that these runs say nothing of.
    pub left_out: [bool; COUNT],
    pub judged: Vec<JudgedRuns>,
    /// What the best initial deviations add to the log-likelihood of a sample, nats.
    pub gain: Vec<f64>,
}

impl Compared {
    /// Of a combination of which nothing is known yet.
    pub fn new(combination: Combination) -> Self {
        Self { combination, left_out: [false; COUNT], judged: Vec::new(), gain: Vec::new() }
    }

    /// Share of the seeds in which each remark holds; none where it is left out.
    pub fn shares(&self) -> [Option<f64>; COUNT] {
        let all = self.judged.len().max(1) as f64;
        let share = |index: usize| self.judged.iter().filter(|judged| judged.holds[index]).count() as f64 / all;
        std::array::from_fn(|index| (!self.left_out[index]).then(|| share(index)))
    }

    /// Remarks that hold in a seed, mean over the seeds.
    pub fn remarks(&self) -> f64 {
        self.shares().iter().flatten().sum()
    }

    /// Remarks that are judged.
    pub fn of_remarks(&self) -> usize {
        self.shares().iter().flatten().count()
    }

    /// Mean and standard deviation over the seeds.
    pub fn moments(&self, of: impl Fn(&JudgedRuns) -> f64) -> Moments {
        self.judged.iter().map(of).collect()
    }

    pub fn gains(&self) -> Moments {
        self.gain.iter().copied().collect()
    }
}

/// Seed of a set of runs, counted from 0.
pub fn seed_of(first: u64, set: usize) -> u64 {
    first.wrapping_add(SEED_STEP.wrapping_mul(set as u64))
}

/// Compares all combinations on simulated runs. `done` is called once a seed and combination.
pub fn compare(plan: &ComparisonPlan, done: impl Fn() + Sync) -> Result<Vec<Compared>, Refused> {
    let believed = description::of(&plan.simulation)?;
    let mut all: Vec<Compared> = Combination::all().into_iter().map(Compared::new).collect();
    for index in 0..plan.seeds {
        let recorded = recorded(plan, seed_of(plan.seed, index))?;
        add_set(&mut all, &believed, &recorded, &done)?;
    }
    Ok(all)
}

/// The same on recorded runs.
pub fn compare_recorded(
    believed: &Believed,
    recorded: &ByRecorder,
    left_out: [bool; COUNT],
    done: impl Fn() + Sync,
) -> Result<Vec<Compared>, Refused> {
    let recorders = recorded.iter().map(|(recorder, _)| *recorder);
    let of = |combination| Compared { left_out, ..Compared::new(combination) };
    let mut all: Vec<Compared> = Combination::of(recorders).into_iter().map(of).collect();
    add_set(&mut all, believed, recorded, &done)?;
    Ok(all)
}

fn add_set(
    all: &mut [Compared],
    believed: &Believed,
    recorded: &ByRecorder,
    done: &(impl Fn() + Sync),
) -> Result<(), Refused> {
    let one = |compared: &Compared| {
        let found = of_seed(compared.combination, believed, recorded);
        done();
        found
    };
    let found = all.par_iter().map(one).collect::<Result<Vec<_>, Refused>>()?;
    for (compared, (judged, gain)) in all.iter_mut().zip(found) {
        compared.judged.push(judged);
        compared.gain.push(gain);
    }
    Ok(())
}

/// The runs of a seed by each recorder.
fn recorded(plan: &ComparisonPlan, seed: u64) -> Result<ByRecorder, DriveError> {
    let scenario = &plan.simulation.scenario;
    let recorders = Recorder::all();
    let sensors: Vec<_> = recorders.iter().map(|recorder| recorder.sensors(&scenario.sensors)).collect();
    let plans = planned(scenario, plan.runs, seed);
    let drive = |run: &_| simulate_recorders(scenario, run, &sensors);
    let runs = plans.par_iter().map(drive).collect::<Result<Vec<_>, _>>()?;
    let mut by_recorder: ByRecorder = recorders.into_iter().map(|r| (r, Vec::new())).collect();
    for (number, run) in runs.into_iter().enumerate() {
        for ((_, recordings), run) in by_recorder.iter_mut().zip(run) {
            recordings.push(Case::simulated(format!("run{:02}", number + 1), String::new(), run).recording);
        }
    }
    Ok(by_recorder)
}

fn of_seed(
    combination: Combination,
    believed: &Believed,
    recorded: &[(Recorder, Vec<Recording>)],
) -> Result<(JudgedRuns, f64), Refused> {
    let Combination { reading, recorder } = combination;
    let (_, runs) = recorded.iter().find(|(by, _)| *by == recorder).ok_or("no run was recorded so")?;
    let train = reading.train(&believed.train).ok_or("the description is no train where its gradient is a point's")?;
    let passes = |filter: &Filter, runs: &[Recording]| -> Vec<Pass> {
        let one = |run: &Recording| {
            filter.pass(&Line { train: &train, track: &believed.track, direction: run.direction }, run)
        };
        runs.iter().map(one).collect()
    };
    let few = &runs[..runs.len().min(TRIED)];
    let filter = Filter::from(reading.config());
    let judged = judge(&filter, &passes(&filter, runs), |filter| passes(filter, few));
    let gain = gain_per_sample(&filter, |filter| passes(filter, few));
    Ok((judged, gain))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::case::case_study;
    use rundown::tick::paper::Difference;
    use rundown_truth::sensors::SpeedReading;

    #[test]
    fn the_backward_effort_lags_and_the_forward_one_does_not() {
        let plan = ComparisonPlan { simulation: case_study().unwrap(), runs: 3, seeds: 1, seed: 7 };
        let recorded = recorded(&plan, plan.seed).unwrap();
        let believed = description::of(&plan.simulation).unwrap();
        let rms_kmh = |difference| {
            let recorder = Recorder { skew_s: 0.0, speed: SpeedReading::Rounded };
            let combination = Combination { reading: super::super::reading::Reading::of(difference), recorder };
            of_seed(combination, &believed, &recorded).unwrap().0.rms_kmh
        };
        let [backward, forward] = [Difference::Backward, Difference::Forward].map(rms_kmh);
        assert!(backward > 3.0 && forward < 0.5, "{backward} {forward}");
    }
}
